"""The physics check of a plan: one piece, widths as asked, nothing cut twice, connectors that bear their bending."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from shapely.geometry import LineString, Polygon

from kirigami_studio.fabricate.bulges import measured_line
from kirigami_studio.fabricate.cut_plan import CutPath, CutPlan, Layer
from kirigami_studio.fabricate.findings import Problem, Severity
from kirigami_studio.fabricate.finished_sheet import (
    Ligament,
    Overlap,
    overlap,
    remaining_pieces,
    smallest_ligament,
)
from kirigami_studio.fabricate.joints import joined_pairs
from kirigami_studio.fabricate.options import ConnectorStyle
from kirigami_studio.fabricate.panel_sizes import smallest_edge, smallest_neck
from kirigami_studio.fabricate.sheet_checks import (
    WIDTH_TOLERANCE_MM,
    connector_problems,
    panel_problems,
    piece_problems,
    tab_problems,
)
from kirigami_studio.foundation.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Flexing:
    """What the connectors go through.

    Attributes
    ----------
    turn : float, radians
        By which every connector turns.
    strain : float
        Estimate for the connector that is strained most.
    where : (x, y), mm
        That connector.
    flexure_mm, softer_mm : float
        Length over which it bends, and the smaller of its width and its thickness.
    """

    turn: float
    strain: float
    where: tuple[float, float]
    flexure_mm: float
    softer_mm: float


def hinge_turn(phi: float) -> float:
    """Angle (radians) by which every connector turns between the flat sheet and ``phi``."""
    return math.pi - phi


def hinge_strains(plan: CutPlan, phi: float) -> FloatArray:
    """Estimated strain of every connector (H,) at an angle (radians); 0 for removed ones."""
    hinges = plan.hinges
    softer = np.minimum(hinges.finished_mm, plan.material.thickness_mm)
    strain: FloatArray = np.where(
        hinges.removed, 0.0, hinge_turn(phi) * np.maximum(softer, 0.0) / (2.0 * _lengths(plan))
    )
    return strain


def flexing(plan: CutPlan, phi: float) -> Flexing | None:
    """Estimate what opening the sheet to an angle (radians) does to its connectors; None for a sheet without any."""
    if np.all(plan.hinges.removed):
        return None
    strains = hinge_strains(plan, phi)
    worst = int(np.argmax(strains))
    x, y = plan.hinges.position[worst]
    softer = min(float(plan.hinges.finished_mm[worst]), plan.material.thickness_mm)
    return Flexing(hinge_turn(phi), float(strains[worst]), (float(x), float(y)), float(_lengths(plan)[worst]), softer)


def strain_problems(plan: CutPlan, found: Flexing, strain_limit: float) -> list[Problem]:
    """Warn when the estimate is above what the material bears (breaking strain, 0.05 for 5 %)."""
    if found.strain <= strain_limit:
        return []
    x, y = found.where
    return [
        Problem(
            f"Opened to the target angle, every connector turns by {math.degrees(found.turn):.0f} degrees. If the one "
            f"at x = {x:.2f}, y = {y:.2f} mm bends evenly over {found.flexure_mm:.3f} mm about its softer side of "
            f"{found.softer_mm:g} mm (the assumption of this estimate), it is strained by about "
            f"{100.0 * found.strain:.0f} %; {plan.material.name!r} is taken to break at {100.0 * strain_limit:g} %. "
            f"{_advice(plan)}, thinner material or a target angle nearer to flat.",
            Severity.WARNING,
            found.where,
        )
    ]


def _lengths(plan: CutPlan) -> FloatArray:
    lengths: FloatArray = np.maximum(plan.hinges.flexure_mm, 1e-9)
    return lengths


def _advice(plan: CutPlan) -> str:
    """What to try first: another style, or room for the ends that this style could not be made at."""
    if plan.options.style in (ConnectorStyle.ARC, ConnectorStyle.DOUBLE):
        return "Choose a larger sheet, so that every slit end has room for its style"
    return "Choose arc or double connectors"


#: Overlaps shorter than this (mm) are rounding.
OVERLAP_TOLERANCE_MM = 1e-6


@dataclass(frozen=True, slots=True)
class Report:
    """What the check found.

    Attributes
    ----------
    problems : tuple of Problem
    pieces : int
        Pieces that the sheet is in after cutting; must be 1.
    min_connector_mm : float
        Smallest finished connector.
    min_ligament_mm : float
        Smallest finished distance between any two cuts.
    overlap_mm : float
        Length cut more than once.
    min_edge_mm, min_neck_mm : float or None
        Smallest finished edge and neck of the untrimmed panels; None without any.
    flexing : Flexing or None
        How far the connectors turn and how much that strains them; None without a target angle.
    """

    problems: tuple[Problem, ...]
    pieces: int
    min_connector_mm: float
    min_ligament_mm: float
    overlap_mm: float
    min_edge_mm: float | None = None
    min_neck_mm: float | None = None
    flexing: Flexing | None = None

    @property
    def ok(self) -> bool:
        """No errors; there may be warnings."""
        return not any(problem.severity is Severity.ERROR for problem in self.problems)


def check_plan(plan: CutPlan, kerf_mm: float | None = None, phi: float | None = None) -> Report:
    """Cut the plan in the computer and look at what is left.

    Parameters
    ----------
    plan : CutPlan
    kerf_mm : float, optional
        The kerf the machine really has; the plan's own unless given.
    phi : float, radians, optional
        Target angle of the deployment; without it nothing is said about how far the connectors bend.
    """
    kerf = plan.kerf_mm if kerf_mm is None else kerf_mm
    inner = [path for path in plan.paths if path.layer is not Layer.OUTLINE]
    lines = [measured_line(path.points, path.bulges, path.closed) for path in inner]
    boundary = Polygon(plan.outline)
    pieces = _pieces(inner, boundary, kerf)
    ligament = smallest_ligament(lines, boundary.exterior, kerf, joined_pairs(plan, inner, lines))
    twice = overlap([LineString(path.travelled) for path in plan.paths])
    edge, neck = smallest_edge(plan.panels, kerf), smallest_neck(plan.panels, kerf)
    bent = None if phi is None else flexing(plan, phi)
    problems = [
        *piece_problems(pieces, boundary, kerf, len(plan.options.removed)),
        *tab_problems(plan),
        *connector_problems(plan, kerf),
        *_overlap_problems(twice),
        *_ligament_problems(plan, kerf, ligament),
        *panel_problems(plan, kerf, edge, neck),
        *([] if bent is None else strain_problems(plan, bent, plan.material.strain_limit)),
    ]
    return Report(
        problems=tuple(problems),
        pieces=len(pieces),
        min_connector_mm=plan.min_connector_mm + plan.kerf_mm - kerf,
        min_ligament_mm=ligament.width_mm if ligament is not None else float("inf"),
        overlap_mm=twice.length_mm,
        min_edge_mm=None if edge is None else edge.size_mm,
        min_neck_mm=None if neck is None else neck.size_mm,
        flexing=bent,
    )


def _pieces(inner: Sequence[CutPath], boundary: Polygon, kerf: float) -> list[Polygon]:
    """What is left of the sheet once its tabs are broken; what falls out of relief holes does not count."""
    cuts = [Polygon(path.flattened) if path.closed else LineString(path.flattened) for path in inner]
    return remaining_pieces(boundary, cuts, kerf)


def _overlap_problems(twice: Overlap) -> list[Problem]:
    if twice.where is None or twice.length_mm <= OVERLAP_TOLERANCE_MM:
        return []
    text = (
        f"{twice.length_mm:.4f} mm would be cut twice, near x = {twice.where[0]:.2f}, y = {twice.where[1]:.2f} mm; "
        f"report this design, it should not happen."
    )
    return [Problem(text, Severity.ERROR, twice.where)]


def _ligament_problems(plan: CutPlan, kerf: float, ligament: Ligament | None) -> list[Problem]:
    """Two cuts nearer to each other than the connectors are wide."""
    if ligament is None or ligament.width_mm >= plan.min_connector_mm - plan.kerf_mm + kerf - WIDTH_TOLERANCE_MM:
        return []
    x, y = ligament.where
    return [
        Problem(
            f"Two cuts leave only {ligament.width_mm:.3f} mm of material at x = {x:.2f}, y = {y:.2f} mm, less than "
            f"the connectors; a larger sheet or a calmer design widens it.",
            Severity.ERROR if ligament.width_mm <= 0 else Severity.WARNING,
            ligament.where,
        )
    ]
