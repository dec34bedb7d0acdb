"""The score of a design against a target: sIoU, total variation, evenness and feasibility, in one frozen value.

Each is defined in the module of its name.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import asdict, astuple, dataclass, replace
from functools import lru_cache

import numpy as np

from kirigami_studio.evaluate.evenness import Evenness, evenness_of_many
from kirigami_studio.evaluate.feasibility import Contact, Feasibility, feasibility_of_many
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.siou import PIXELS_OFF, ROUNDING, ShapeMatch, matches_in_poses, siou_near, siou_of_many
from kirigami_studio.evaluate.total_variation import log_variation, total_variation
from kirigami_studio.lattice.deployment import Deployment, check_phi, deploy
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.symmetry import Symmetry, symmetry_of
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.symmetry import TOLERANCE, turn_overlap

#: Turns below this (radians) come with any change.
SAME_TURN = 0.1
#: Exact IoU that a design may lack to stay turned as it was.  After changes of single ratios by 16 % staying cost a
#: circle, star or hexagon at most 0.00013 (12 changes each); a design that is clearly better turned may turn.
STAY = 0.003
#: The same for a mirror axis that stands upright.
AS_GOOD = 0.001


@dataclass(frozen=True, slots=True)
class Score:
    """Shape match, total variation, evenness and feasibility of one design against one target at one angle."""

    siou: float  #: 0..1; IoU of the 128 x 128 masks under the best similarity
    siou_gain: float  #: ``siou - uniform_siou``
    uniform_siou: float  #: 0..1; the same number for the uniform layout of the same grid: the floor
    iou_exact: float  #: 0..1; IoU of the polygons under the same similarity, without a raster
    uniform_iou: float  #: 0..1; ``iou_exact`` of the uniform layout
    tv: float  #: the paper's total variation of the ratios divided by m n
    tv_log10: float  #: mean ``|d log10 x|`` per pair of neighbouring voids
    feasible: bool  #: no invalid quad, overlap ratio at most 0.02, and no contact on the way
    n_invalid: int  #: collapsed or self-crossing quads at the angle
    overlap_ratio: float  #: 0..1; ``1 - area of the union / sum of areas``
    contact: Contact | None  #: first self-contact on the way from the compact sheet, if any
    transform: Similarity  #: layout frame at the angle (unit cells) -> target frame (area 1)
    evenness: Evenness  #: of the flat sheet: how even its panels are, and how small
    phi: float = 0.0  #: radians; the angle that all of this is about

    def to_json(self) -> dict[str, object]:
        """The keys of the command line's ``score``, plain numbers only."""
        return {
            **asdict(self),
            "contact": None if self.contact is None else self.contact.to_json(),
            "transform": self.transform.to_json(),
        }


def evaluate(deployment: Deployment, outline: Outline, phi: float = 0.0) -> Score:
    """Score one design against a target at an angle.

    Parameters
    ----------
    phi : float, radians, in [0, pi]

    Raises
    ------
    AngleError
        ``phi`` is not a number in that range.
    """
    return evaluate_many([deployment], outline, phi)[0]


def evaluate_many(deployments: Sequence[Deployment], outline: Outline, phi: float = 0.0) -> list[Score]:
    """Score several designs at once: the same values as :func:`evaluate`, faster.

    Designs are feasible when no quad is invalid, at most 2 % of the material overlaps (tau_ov of the paper) and the
    outline does not cross itself anywhere between the compact sheet and ``phi``.
    """
    phi = check_phi(phi)
    found: dict[int, Score] = {}
    # Designs of one grid are scored together.
    for grid in dict.fromkeys(deployment.sheet.grid for deployment in deployments):
        members = [index for index, deployment in enumerate(deployments) if deployment.sheet.grid == grid]
        sheets = [deployments[index] for index in members]
        matches = siou_of_many([sheet.outline(phi) for sheet in sheets], outline)
        checks, figures = feasibility_of_many(sheets, phi), evenness_of_many(sheets)
        for index, sheet, match, check, even in zip(members, sheets, matches, checks, figures, strict=True):
            floor = _uniform_match(sheet.sheet.plain(), phi, outline)
            found[index] = _complete(sheet, _upright(sheet, match, outline, phi), check, even, floor, phi)
    return [found[index] for index in range(len(deployments))]


def confirmed(deployments: Sequence[Deployment], scores: Sequence[Score], outline: Outline) -> list[Score]:
    """Keep scores from a file that say what their designs have; designs with another score are scored again.

    A design is measured in the pose that its score names, which takes a hundredth of the time of scoring it.
    """
    found = list(scores)
    kinds = [(deployment.sheet.grid, score.phi) for deployment, score in zip(deployments, scores, strict=True)]
    for kind in dict.fromkeys(kinds):
        members = [index for index, each in enumerate(kinds) if each == kind]
        measured = _in_their_poses([deployments[k] for k in members], [scores[k] for k in members], outline)
        for index, own in zip(members, measured, strict=True):
            if own is None or not _is_same(own, scores[index]):
                found[index] = evaluate(deployments[index], outline, scores[index].phi)
    return found


def _in_their_poses(deployments: Sequence[Deployment], scores: Sequence[Score], outline: Outline) -> list[Score | None]:
    """What designs of one grid have at one angle, in the poses of their scores; None far off the target."""
    phi = scores[0].phi
    matches = matches_in_poses(
        [each.outline(phi) for each in deployments], outline, [score.transform for score in scores]
    )
    checks, figures = feasibility_of_many(deployments, phi), evenness_of_many(deployments)
    floors = [ShapeMatch(score.uniform_siou, score.uniform_iou, score.transform) for score in scores]
    return [
        None if match is None else _complete(deployment, match, check, even, floor, phi)
        for deployment, match, check, even, floor in zip(deployments, matches, checks, figures, floors, strict=True)
    ]


def _is_same(own: Score, read: Score) -> bool:
    """Whether a score that was read is the measured one but for rounding, with a floor that can be one."""
    kinds = [(score.feasible, score.n_invalid, score.contact is None) for score in (own, read)]
    off = max(abs(own.siou - read.siou), abs(own.siou_gain - read.siou_gain))
    return (
        kinds[0] == kinds[1]
        and 0.0 <= read.uniform_siou <= 1.0
        and 0.0 <= read.uniform_iou <= 1.0
        # Not the other way round, so that a number that is none counts as another one.
        and off <= PIXELS_OFF
        and np.allclose(_figures(own), _figures(read), rtol=ROUNDING, atol=ROUNDING)
    )


def _figures(score: Score) -> list[float]:
    """All numbers of a score that are measured without a raster."""
    contact = [] if score.contact is None else [score.contact.phi, *score.contact.where]
    return [score.iou_exact, score.tv, score.tv_log10, score.overlap_ratio, *contact, *astuple(score.evenness)]


def evaluate_near(deployment: Deployment, outline: Outline, phi: float, pose: Similarity) -> Score:
    """Score a design as :func:`evaluate` does, but keep it near ``pose`` where that costs at most :data:`STAY`.

    Parameters
    ----------
    phi : float, radians, in [0, pi]
    pose : Similarity
        Layout frame at ``phi`` -> target frame, of the design before it was changed.

    Returns
    -------
    Score
        With sIoU and IoU under the similarity that it names.
    """
    best = evaluate(deployment, outline, phi)
    if abs(cmath.phase(best.transform.factor / pose.factor)) < SAME_TURN:
        return best
    near = siou_near(deployment.outline(phi), outline, pose)
    if near.iou_exact < best.iou_exact - STAY:
        return best
    gain = near.siou - best.uniform_siou
    return replace(best, siou=near.siou, siou_gain=gain, iou_exact=near.iou_exact, transform=near.transform)


def _upright(deployment: Deployment, match: ShapeMatch, outline: Outline, phi: float) -> ShapeMatch:
    """Turn a match so that the mirror axis of its design is upright.

    Only where the target looks the same turned so.

    A star has five axes: which of them a design has is decided by rounding, and one that leans looks like a mistake.
    """
    symmetry = symmetry_of(deployment.sheet)
    if symmetry is None or not symmetry.mirrors or np.ptp(deployment.field.ratio) == 0.0:
        return match
    sheets_own, apart = 0.0 if symmetry is Symmetry.TOP_BOTTOM else 0.5 * math.pi, math.pi
    if symmetry is Symmetry.TWO_MIRRORS:
        apart = 0.5 * math.pi
    off = math.remainder(0.5 * math.pi - sheets_own - match.transform.angle, apart)
    if abs(off) < SAME_TURN:
        return match
    turns = [off + apart * number for number in range(round(2.0 * math.pi / apart))]
    same = [turn for turn in turns if turn_overlap(outline, turn) >= TOLERANCE]
    poses = [Similarity(1.0, turn).compose(match.transform) for turn in same]
    found = [siou_near(deployment.outline(phi), outline, pose) for pose in poses]
    best = max(found, key=lambda one: one.iou_exact, default=match)
    return best if best.iou_exact >= match.iou_exact - AS_GOOD else match


def _complete(
    deployment: Deployment, match: ShapeMatch, check: Feasibility, even: Evenness, floor: ShapeMatch, phi: float
) -> Score:
    return Score(
        siou=match.siou,
        siou_gain=match.siou - floor.siou,
        uniform_siou=floor.siou,
        iou_exact=match.iou_exact,
        uniform_iou=floor.iou_exact,
        tv=total_variation(deployment.field),
        tv_log10=log_variation(deployment.field),
        feasible=check.feasible,
        n_invalid=check.n_invalid,
        overlap_ratio=check.overlap_ratio,
        contact=check.contact,
        transform=match.transform,
        evenness=even,
        phi=phi,
    )


@lru_cache(maxsize=256)
def _uniform_match(plain: Sheet, phi: float, outline: Outline) -> ShapeMatch:
    """The floor that a target sets: how well the uniform sheet matches it, kept per sheet, angle and target."""
    return siou_of_many([deploy(plain).outline(phi)], outline)[0]
