"""What is done with one design after it was found: score it with other ratios, trim it, fit it again.

Every function takes a candidate and returns a new one; window, command line and worker processes all call these.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.evaluate.score import evaluate, evaluate_near
from kirigami_studio.evaluate.second_target import matched_again
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.siou import ShapeMatch, siou_of_many
from kirigami_studio.evaluate.trimming import KEEP, LARGEST_KEEP, Trim, trim
from kirigami_studio.fabricate.making_room import roomy
from kirigami_studio.fabricate.material import Material
from kirigami_studio.fabricate.trimmed_sheet import needed_keep
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.errors import Cancelled, FabricationError, KirigamiError
from kirigami_studio.foundation.threads import one_blas_thread
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.symmetry import Symmetry, symmetry_of
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.polish.covering import Cover, fit_cover
from kirigami_studio.polish.even_panels import even_weight
from kirigami_studio.polish.levenberg import polish
from kirigami_studio.polish.panel_size import least_in_cells
from kirigami_studio.polish.pinwheel import gap_in_cells
from kirigami_studio.polish.preferences import PREFERENCES, FitPreference
from kirigami_studio.polish.vertex_drag import VertexDrag

#: Steps of the fit before trimming.
COVER_STEPS = 12
#: Even panels count so many times as much in a cover as in whole sheets: it has match to spare, and small panels in a
#: thin arm run into each other before it has closed.  In film, a leaf's covers jammed at 5 degrees and showed 0.972
#: and 0.928 of it as cut; with this they close at 0.989.  Twice as much is not enough for them, eight times too much
#: for a plug.  Covers that are cut along the edge alone have the weight of the last steps of whole sheets: with 1 a
#: mushroom's matches by 0.982 in the place of 0.990 (at 0 by 0.992, with panels that differ more), closed it does by
#: 0.983.
COVER_EVENNESS, EDGE_EVENNESS = 4.0, 0.3

#: Accepted steps of one fit that the user asks for; most end before that because nothing more is gained.
REFIT_STEPS = 20


@dataclass(frozen=True, slots=True)
class Room:
    """Room for the connectors of a sheet that is to be trimmed."""

    width_mm: float = 100.0  #: of the flat sheet
    span_mm: float = 0.0  #: width of a connector and of the cut; 0 where connectors need no room

    def made(self, deployment: Deployment, cancel: Callable[[], bool] = lambda: False) -> Deployment:
        """Sheet with the room that planning makes for whole sheets; itself if called off."""

        def go_on() -> None:
            if cancel():
                raise Cancelled("plan.stopped")

        try:
            return roomy(deployment, self.width_mm, self.span_mm, go_on) if self.span_mm else deployment
        except Cancelled:
            return deployment


NO_ROOM = Room()


@dataclass(frozen=True, slots=True)
class Trimmed:
    """What trimming has made of a candidate."""

    candidate: Candidate  #: with its trim: another sheet in another pose, beside its own
    evaluations: int  #: layouts decoded on the way


@dataclass(frozen=True, slots=True)
class Refit:
    """What a fit from a design's present sheet has found."""

    candidate: Candidate  #: the fitted design, trimmed if the one it began with was
    better: bool  #: whether it ranks before the one it began with, both untrimmed
    #: Why it could not be trimmed again, None if that was not to be done or was.
    trim_problem: KirigamiError | None = None


def sampled(candidate: Candidate, target: Outline) -> Candidate | None:
    """The candidate as the generator sampled it, in the pose that suits it best; None where no fit has changed it."""
    sheet = candidate.sampled_sheet
    if sheet is None:
        return None
    with one_blas_thread():
        deployment = deploy(sheet)
        score = evaluate(deployment, target, candidate.score.phi)
        second = matched_again(deployment, candidate.second)
    return replace(candidate, sheet=sheet, score=score, polished=False, sampled_sheet=None, trim=None, second=second)


def rescored(candidate: Candidate, sheet: Sheet, target: Outline) -> Candidate:
    """The candidate with another sheet, changed by hand, near its present pose; one that is trimmed is trimmed again.

    It is cut as deep as before, and not fitted again.  It loses its trim only where the changed sheet has no outside.
    """
    with one_blas_thread():
        deployment = deploy(sheet)
        score = evaluate_near(deployment, target, candidate.score.phi, candidate.final_pose)
        second = matched_again(deployment, candidate.second)
        cut = None if candidate.trim is None else _trimmed_as(candidate.trim, deployment, target, score.transform)
    changed = replace(candidate, sheet=sheet, score=score, polished=False, trim=cut, second=second)
    return replace(changed, origin=Origin.EDITED)


def _trimmed_as(before: Trim, deployment: Deployment, target: Outline, pose: Similarity) -> Trim | None:
    """Trim a changed sheet where the one before it lay, or in another pose if that matches better."""
    poses = dict.fromkeys((before.pose, pose))
    try:
        cuts = [trim(deployment, target, before.phi, one, before.keep, before.deep) for one in poses]
    except KirigamiError:
        return None
    return max(cuts, key=lambda one: one.iou)


def keep_for_connectors(
    sheet: Sheet,
    material: Material,
    width_mm: float,
    connector_mm: float | None,
    kerf_mm: float | None,
    least: float = KEEP,
) -> float:
    """How deep material has to stay at the hinges of a trimmed sheet so that its connectors hold.

    Parameters
    ----------
    sheet : Sheet
        Its grid, start outline and cell decide; ratios and rim do not.
    material : Material
    width_mm : float
        Width of the flat sheet.
    connector_mm, kerf_mm : float or None
        Widths of connectors and of the cut; None for the material's own.
    least : float, unit cells
        That stays in any case.

    Returns
    -------
    float, unit cells

    Raises
    ------
    FabricationError
        The connectors need more than any trim can leave.
    """
    connector = material.connector_mm if connector_mm is None else connector_mm
    kerf = material.kerf_mm if kerf_mm is None else kerf_mm
    needed = needed_keep(deploy(sheet.plain()), width_mm, connector, kerf)
    if needed > LARGEST_KEEP:
        raise FabricationError(
            "trim.connectors_too_wide",
            connector_mm=connector,
            width_mm=width_mm,
            least_mm=math.ceil(width_mm * needed / LARGEST_KEEP),
        )
    return max(least, needed)


def kept_symmetry(sheet: Sheet) -> Symmetry | None:
    """The symmetry that a fit from a sheet keeps: its own; none from the uniform sheet, which has them by chance."""
    return None if np.ptp(sheet.field.ratio) == 0.0 else symmetry_of(sheet)


def trimmed(
    candidate: Candidate,
    target: Outline,
    keep: float,
    cancel: Callable[[], bool],
    locked: BoolArray | None = None,
    least_panel: float = 0.0,
    room: Room = NO_ROOM,
    start_weight: float = 1.0,
) -> Trimmed:
    """Fit a candidate so that it covers the target, and trim its edge panels.

    Parameters
    ----------
    candidate : Candidate
    target : Outline
    keep : float, unit cells
        Depth of the material that stays at every hinge, see :func:`keep_for_connectors`.
    cancel : callable
        Asked before every step; the best so far is returned.
    locked : (m, n) bool, optional
        Voids that keep their ratios.
    least_panel : float, unit cells
        Panel edges and necks before trimming, see :func:`kirigami_studio.polish.levenberg.polish`.
    room : Room
        For the connectors.
    start_weight : float, > 0
        How firmly a round start is held.

    Raises
    ------
    KirigamiError
        The candidate's outline crosses itself.
    """
    cover = _cover(
        candidate, target, keep, cancel, locked, least_panel=least_panel, room=room, start_weight=start_weight
    )
    return Trimmed(replace(candidate, trim=cover.trim), cover.fit.evaluations + 1)


def covered(
    candidate: Candidate,
    target: Outline,
    keep: float,
    cancel: Callable[[], bool],
    locked: BoolArray | None = None,
    least_panel: float = 0.0,
    even: float = 0.0,
    room: Room = NO_ROOM,
    least_gap: float = 0.0,
    *,
    notched: bool = True,
    start_weight: float = 1.0,
) -> Trimmed:
    """Make a cover of a candidate: a sheet over the target of which parts are cut away.

    Parameters
    ----------
    candidate, target, keep, cancel, locked, least_panel, room, start_weight
        As for :func:`trimmed`.
    even : float
        Weight of even panels in whole sheets; a cover that is cut out of one sheet is fitted with
        :data:`COVER_EVENNESS` times as much, without notches with :data:`EDGE_EVENNESS` times.
    least_gap : float, unit cells
        How far apart pins stay; 0 for sheets without.
    notched : bool
        Whether notches are filled and cut out, whole panels among them; else the edge is cut along the target.

    Returns
    -------
    Trimmed
        With a candidate whose score is that of the whole sheet as fitted to be cut, not of the one it began with.

    Raises
    ------
    KirigamiError
        The candidate's outline crosses itself.
    """
    cover = _cover(
        candidate,
        target,
        keep,
        cancel,
        locked,
        least_panel=least_panel,
        even=even if least_gap else (COVER_EVENNESS if notched else EDGE_EVENNESS) * even,
        notched=notched,
        afresh=True,
        room=room,
        least_gap=least_gap,
        start_weight=start_weight,
    )
    with one_blas_thread():
        deployment = deploy(cover.trim.sheet)
        score = evaluate(deployment, target, candidate.score.phi)
        second = matched_again(deployment, candidate.second)
    made = replace(candidate, sheet=cover.trim.sheet, score=score, polished=True, sampled_sheet=None, second=second)
    return Trimmed(replace(made, trim=cover.trim, origin=Origin.COVERED), cover.fit.evaluations + 2)


def _cover(
    candidate: Candidate,
    target: Outline,
    keep: float,
    cancel: Callable[[], bool],
    locked: BoolArray | None,
    *,
    least_panel: float,
    even: float = 0.0,
    notched: bool = False,
    afresh: bool = False,
    room: Room,
    least_gap: float = 0.0,
    start_weight: float,
) -> Cover:
    """Fit a candidate's sheet so that it covers the target, within its own rim and symmetry."""
    sheet, score = candidate.sheet, candidate.score
    free = locked is None or not locked.any()
    with one_blas_thread():
        return fit_cover(
            sheet,
            target,
            score.phi,
            COVER_STEPS,
            score.transform,
            keep,
            cancel,
            locked,
            free_rim=not sheet.has_even_rim,
            symmetry=kept_symmetry(sheet) if free else None,
            even=even,
            least_panel=least_panel,
            least_gap=least_gap,
            notched=notched,
            afresh=afresh,
            # Locked voids keep their ratios, whatever room there is.
            room=partial((room if free else NO_ROOM).made, cancel=cancel),
            start_weight=start_weight,
        )


def refitted(
    candidate: Candidate,
    target: Outline,
    prefer: FitPreference,
    locked: Collection[tuple[int, int]],
    keep: Callable[[], float],
    cancel: Callable[[], bool],
    *,
    regular: float = 0.0,
    free_rim: bool = False,
    width_mm: float = 100.0,
    least_feature_mm: float = 0.0,
    room_mm: float = 0.0,
    least_gap_mm: float = 0.0,
    span_mm: float = 0.0,
    start_weight: float = 1.0,
) -> Refit:
    """Fit a candidate on the exact geometry from its present sheet, and trim it again if it is trimmed.

    Parameters
    ----------
    candidate : Candidate
    target : Outline
    prefer : FitPreference
    locked : collection of (row, column)
        Voids that keep the ratios that are seen: those of the trim, if the candidate is trimmed.
    keep : callable
        Tells how deep (unit cells) material stays at the hinges; asked only where the candidate is trimmed.  An error
        it raises is the result's ``trim_problem``.
    cancel : callable
        Asked before every step.
    regular : float, 0..1
        How much even panels count, in the fit (:func:`kirigami_studio.polish.even_panels.even_weight`) and for
        ``better``.
    free_rim : bool
        Whether the mouths may move.
    width_mm, least_feature_mm : float
        Width of the flat sheet, and the least panel edge and neck that the material allows, 0 where that is not known.
    room_mm : float
        Panel edge and neck that leaves connectors their full width.
    least_gap_mm : float
        How far apart the pins of a pinned sheet stay; 0 for others.
    span_mm : float
        See :class:`Room`.
    start_weight : float, > 0
        How firmly a round start is held.

    Raises
    ------
    Cancelled
        ``cancel`` returned true.
    """
    table = np.zeros(candidate.sheet.grid, dtype=np.bool_)
    for void in locked:
        table[void] = True
    ratios = np.where(table, candidate.final_sheet.field.ratio, candidate.sheet.field.ratio)
    start = candidate.sheet.with_field(RatioField(ratios))
    score, preference = candidate.score, PREFERENCES[prefer]
    least = max(least_in_cells(size, width_mm, score.evenness.width) for size in (least_feature_mm, room_mm))
    gap = gap_in_cells(least_gap_mm, width_mm, score.evenness.width)
    ranking, room = Ranking(regular, width_mm, least_feature_mm, least_gap_mm), Room(width_mm, span_mm)
    if candidate.origin is Origin.COVERED:
        even, notched = even_weight(regular), candidate.trim is None or candidate.trim.deep
        made = covered(
            candidate,
            target,
            keep(),
            cancel,
            table,
            least,
            even,
            room,
            gap,
            notched=notched,
            start_weight=start_weight,
        )
        cover = made.candidate
        _stop_if(cancel)
        return Refit(cover, ranking.worth_as_made(cover) > ranking.worth_as_made(candidate))
    with one_blas_thread():
        fit = polish(
            start,
            target.filled,
            score.phi,
            REFIT_STEPS,
            preference,
            score.transform,
            cancel,
            even=even_weight(regular),
            free_rim=free_rim,
            symmetry=None if table.any() else kept_symmetry(start),
            locked=table,
            least_panel=least,
            least_gap=gap,
            second=None if candidate.second is None else candidate.second.target,
            start_weight=start_weight,
        )
        _stop_if(cancel)
        deployment = deploy(fit.sheet)
        found = evaluate_near(deployment, target, score.phi, fit.pose)
        second = matched_again(deployment, candidate.second)
    first = candidate.sampled_sheet or candidate.sheet
    fitted = replace(
        candidate, sheet=fit.sheet, score=found, polished=True, sampled_sheet=first, trim=None, second=second
    )
    better = ranking.improves(fitted, replace(candidate, trim=None), prefer)
    if candidate.trim is None:
        return Refit(fitted, better)
    try:
        again = trimmed(fitted, target, keep(), cancel, table, least, room, start_weight)
    except KirigamiError as problem:
        return Refit(fitted, better, problem)
    _stop_if(cancel)
    return Refit(again.candidate, better)


def drag_step(drag: VertexDrag, place: FloatArray) -> None:
    """Bring a vertex of the outline one step nearer to ``place`` (2,), unit cells."""
    with one_blas_thread():
        drag.move(place, steps=1)


def matched(outlines: Sequence[FloatArray], target: Outline) -> list[ShapeMatch]:
    """How well a design matches the target at several angles, given its outlines (L, 2); each in its best pose."""
    with one_blas_thread():
        return siou_of_many(outlines, target)


def _stop_if(cancel: Callable[[], bool]) -> None:
    if cancel():
        raise Cancelled("fit.stopped")
