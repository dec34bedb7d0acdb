"""All that is said about one design, in one frozen value."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import shapely

from kirigami_studio.evaluate.alignment import align_many
from kirigami_studio.evaluate.boundary import checked_polygon
from kirigami_studio.evaluate.feasibility import TAU_OVERLAP, Contact, invalid_quads, overlap_ratio, path_contact
from kirigami_studio.evaluate.regularity import log_variation, total_variation
from kirigami_studio.evaluate.silhouette import Frame, rasterise_in_frame
from kirigami_studio.evaluate.similarity import FloatArray, Similarity
from kirigami_studio.lattice.deployment import Deployment, check_phi, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.target.outline import Outline


@dataclass(frozen=True, slots=True)
class Score:
    """Shape agreement, regularity and feasibility of one design against one target at one angle.

    Attributes
    ----------
    siou : float, 0..1
        IoU of the 128 x 128 masks under the best similarity.
    siou_gain : float
        ``siou - uniform_siou``.
    uniform_siou : float, 0..1
        The same number for the uniform layout of the same grid: the floor.
    iou_exact : float, 0..1
        IoU of the polygons under the same similarity, without a raster.
    uniform_iou : float, 0..1
        ``iou_exact`` of the uniform layout.
    tv : float
        The paper's total variation of the ratios divided by m n.
    tv_log10 : float
        Mean ``|d log10 x|`` per pair of neighbouring voids.
    feasible : bool
        No invalid quad, overlap ratio at most 0.02, and no contact on the way.
    n_invalid : int
        Collapsed or self-crossing quads at the angle.
    overlap_ratio : float, 0..1
        ``1 - area of the union / sum of areas``.
    contact : Contact or None
        First self-contact on the way from the compact sheet, if any.
    transform : Similarity
        Layout frame at the angle (unit cells) -> target frame (area 1).
    phi : float, radians
        The angle that all of this is about.
    """

    siou: float
    siou_gain: float
    uniform_siou: float
    iou_exact: float
    uniform_iou: float
    tv: float
    tv_log10: float
    feasible: bool
    n_invalid: int
    overlap_ratio: float
    contact: Contact | None
    transform: Similarity
    phi: float = 0.0

    def to_json(self) -> dict[str, object]:
        """The keys of the command line's ``score``, plain numbers only."""
        return {
            "siou": self.siou,
            "siou_gain": self.siou_gain,
            "uniform_siou": self.uniform_siou,
            "iou_exact": self.iou_exact,
            "uniform_iou": self.uniform_iou,
            "tv": self.tv,
            "tv_log10": self.tv_log10,
            "feasible": self.feasible,
            "n_invalid": self.n_invalid,
            "overlap_ratio": self.overlap_ratio,
            "contact": None if self.contact is None else self.contact.to_json(),
            "transform": self.transform.to_json(),
            "phi": self.phi,
        }


def evaluate(deployment: Deployment, outline: Outline, phi: float = 0.0) -> Score:
    """Score one design against a target at an angle.

    Parameters
    ----------
    deployment : Deployment
    outline : Outline
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
    matches = _matches([deployment.outline(phi) for deployment in deployments], outline)
    return [_complete(deployment, outline, phi, match) for deployment, match in zip(deployments, matches, strict=True)]


@dataclass(frozen=True, slots=True)
class _Match:
    """Shape agreement alone."""

    siou: float
    iou_exact: float
    transform: Similarity


def _complete(deployment: Deployment, outline: Outline, phi: float, match: _Match) -> Score:
    floor = _uniform_match(deployment.field.rows, deployment.field.columns, _cell(deployment), phi, outline)
    n_invalid = invalid_quads(deployment, phi)
    overlap = overlap_ratio(deployment, phi)
    contact = path_contact(deployment, phi)
    return Score(
        siou=match.siou,
        siou_gain=match.siou - floor.siou,
        uniform_siou=floor.siou,
        iou_exact=match.iou_exact,
        uniform_iou=floor.iou_exact,
        tv=total_variation(deployment.field),
        tv_log10=log_variation(deployment.field),
        feasible=n_invalid == 0 and overlap <= TAU_OVERLAP and contact is None,
        n_invalid=n_invalid,
        overlap_ratio=overlap,
        contact=contact,
        transform=match.transform,
        phi=phi,
    )


def _matches(shapes: list[FloatArray], outline: Outline) -> list[_Match]:
    """Align shapes (L, 2) and measure them, exactly and on the raster."""
    frame = Frame.around(outline.points)
    found: dict[int, _Match] = {}
    # Shapes with equal numbers of vertices are aligned together.
    for length in dict.fromkeys(len(shape) for shape in shapes):
        members = [index for index, shape in enumerate(shapes) if len(shape) == length]
        transforms = align_many([shapes[index] for index in members], outline.points)
        for index, transform in zip(members, transforms, strict=True):
            laid = transform.apply(shapes[index])
            found[index] = _Match(drawn_iou(laid, outline.points, frame), exact_iou(laid, outline), transform)
    return [found[index] for index in range(len(shapes))]


def exact_iou(laid: FloatArray, outline: Outline) -> float:
    """Intersection over union of an aligned silhouette (L, 2) and the target, on the polygons themselves."""
    polygon = shapely.Polygon(checked_polygon(laid))
    shape = polygon if polygon.is_valid else shapely.make_valid(polygon)
    common = shape.intersection(outline.polygon).area
    return float(common / (shape.area + outline.polygon.area - common))


def drawn_iou(laid: FloatArray, target: FloatArray, frame: Frame) -> float:
    """The same on the pixels of ``frame``, continued so far that nothing is cut off."""
    wide = frame.covering(laid)
    first, second = rasterise_in_frame(laid, wide), rasterise_in_frame(target, wide)
    return float(np.count_nonzero(first & second) / np.count_nonzero(first | second))


def _cell(deployment: Deployment) -> tuple[float, float]:
    """Size of a cell of the compact sheet, from the sheet's own size."""
    width, height = np.ptp(deployment.compact, axis=0)
    field = deployment.field
    return round(float(width) / (field.columns + 1), 9), round(float(height) / (field.rows + 1), 9)


@lru_cache(maxsize=256)
def _uniform_match(rows: int, columns: int, cell: tuple[float, float], phi: float, outline: Outline) -> _Match:
    """The floor that a target sets: the match of the uniform layout, kept per grid, angle and target."""
    uniform = deploy(RatioField.uniform(rows, columns), cell)
    return _matches([uniform.outline(phi)], outline)[0]
