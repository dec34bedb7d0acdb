"""The physical check of a plan: is the sheet one piece, are all widths as asked, do the connectors survive bending?

:func:`check_plan` cuts the sheet in the computer (``finished_sheet``) and returns a :class:`Report` of problems, each
with a place.  The strain of the connectors is an estimate: a strip as thick as the smaller of width and thickness that
bends evenly over its flexure length.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from shapely.geometry import LineString, Polygon

from kirigami_studio.fabricate.cut_path import measured_line
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
from kirigami_studio.fabricate.panel_sizes import SmallPlace, smallest_edge, smallest_neck, trimmed_neck_below
from kirigami_studio.foundation.arrays import FloatArray

#: Overlaps shorter than this (mm) are rounding.
OVERLAP_TOLERANCE_MM = 1e-6
#: Tolerance (mm) for finished widths; coordinates are rounded to a tenth of it.
WIDTH_TOLERANCE_MM = 1e-3


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


def piece_problems(pieces: Sequence[Polygon], boundary: Polygon, kerf_mm: float, removed: int) -> list[Problem]:
    """Errors of a sheet that does not stay in one piece; ``removed`` connectors are named as a possible reason."""
    if len(pieces) == 1:
        return []
    if not pieces:
        text = f"Nothing is left of the sheet with a kerf of {kerf_mm:g} mm; use a smaller kerf."
        return [Problem(text, Severity.ERROR, (float(boundary.centroid.x), float(boundary.centroid.y)))]
    loose = pieces[1].representative_point()
    reason = f"; {removed} connectors were removed, so put some of them back" if removed else ""
    return [
        Problem(
            f"With a kerf of {kerf_mm:g} mm the sheet falls into {len(pieces)} pieces, one of them at "
            f"x = {loose.x:.2f}, y = {loose.y:.2f} mm{reason or '; widen the connectors or use a smaller kerf'}.",
            Severity.ERROR,
            (float(loose.x), float(loose.y)),
        )
    ]


def tab_problems(plan: CutPlan) -> list[Problem]:
    """Errors of an outline with other gaps than its tabs."""
    paths = plan.on_layer(Layer.OUTLINE)
    tabs = plan.options.tabs
    opened = [path for path in paths if not path.closed]
    if len(opened) != tabs or len(paths) != max(tabs, 1):
        where = (opened or paths)[0].points[-1] if paths else np.zeros(2)
        text = (
            f"The outline consists of {len(paths)} paths, {len(opened)} of them open, but the plan has {tabs} tabs; "
            f"report this design, it should not happen."
        )
        return [Problem(text, Severity.ERROR, (float(where[0]), float(where[1])))]
    wanted = plan.options.tab_mm + plan.kerf_mm
    for path, following in zip(opened, [*opened[1:], *opened[:1]], strict=True):
        gap = float(np.linalg.norm(following.points[0] - path.points[-1]))
        if abs(gap - wanted) > WIDTH_TOLERANCE_MM:
            x, y = 0.5 * (following.points[0] + path.points[-1])
            text = (
                f"The tab at x = {x:.2f}, y = {y:.2f} mm is {gap - plan.kerf_mm:.3f} instead of "
                f"{plan.options.tab_mm:g} mm wide; report this design, it should not happen."
            )
            return [Problem(text, Severity.ERROR, (float(x), float(y)))]
    return []


def connector_problems(plan: CutPlan, kerf_mm: float) -> list[Problem]:
    """Connectors narrower than asked (an error) or than the material bears (a warning); removed ones are as asked."""
    hinges = plan.hinges
    there = np.flatnonzero(~hinges.removed)
    problems = _uncut(plan)
    if not there.size:
        return problems
    finished = hinges.finished_mm[there] + plan.kerf_mm - kerf_mm
    short = hinges.requested_mm[there] - finished
    if np.any(short > WIDTH_TOLERANCE_MM):
        worst = int(np.argmax(short))
        x, y = hinges.position[there[worst]]
        problems.append(
            Problem(
                f"{int(np.sum(short > WIDTH_TOLERANCE_MM))} connectors come out narrower than asked, the worst "
                f"{finished[worst]:.3f} instead of {hinges.requested_mm[there[worst]]:.3f} mm at x = {x:.2f}, "
                f"y = {y:.2f} mm; plan the cuts with the kerf that the machine really has.",
                Severity.ERROR,
                (float(x), float(y)),
            )
        )
    thinnest = int(np.argmin(finished))
    return problems + _thin(plan, float(finished[thinnest]), hinges.position[there[thinnest]])


def _uncut(plan: CutPlan) -> list[Problem]:
    """Removed connectors of which something is left."""
    hinges = plan.hinges
    left = np.flatnonzero(hinges.removed & (hinges.finished_mm > 0.0))
    if not left.size:
        return []
    x, y = (float(value) for value in hinges.position[left[0]])
    text = (
        f"{left.size} removed connectors are not cut through, the first at x = {x:.2f}, y = {y:.2f} mm; "
        f"keep them or make the sheet larger."
    )
    return [Problem(text, Severity.WARNING, (x, y))]


def _thin(plan: CutPlan, finished_mm: float, position: FloatArray) -> list[Problem]:
    x, y = float(position[0]), float(position[1])
    if finished_mm <= 0.0:
        text = (
            f"Nothing is left of the connector at x = {x:.2f}, y = {y:.2f} mm: the sheet would fall into "
            f"pieces there; widen the connectors."
        )
        return [Problem(text, Severity.ERROR, (x, y))]
    if finished_mm < plan.material.min_ligament_mm - WIDTH_TOLERANCE_MM:
        text = (
            f"The connector at x = {x:.2f}, y = {y:.2f} mm is {finished_mm:.3f} mm wide; "
            f"{plan.material.name!r} is known to bear {plan.material.min_ligament_mm:g} mm."
        )
        return [Problem(text, Severity.WARNING, (x, y))]
    return []


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


def panel_problems(plan: CutPlan, kerf_mm: float, edge: SmallPlace | None, neck: SmallPlace | None) -> list[Problem]:
    """Warn about panels smaller than what the material bears."""
    least = plan.material.min_ligament_mm
    problems = []
    for name, small in (("edge", edge), ("neck", neck)):
        if small is not None and small.size_mm < least - WIDTH_TOLERANCE_MM:
            x, y = small.where
            text = (
                f"A panel at x = {x:.2f}, y = {y:.2f} mm has a finished {name} of {small.size_mm:.3f} mm; "
                f"{plan.material.name!r} is known to bear {least:g} mm. A larger sheet, a calmer design or a least "
                f"panel size in the fit widens it."
            )
            problems.append(Problem(text, Severity.WARNING, small.where))
    place = trimmed_neck_below(plan.panels, kerf_mm, least)
    if place is not None:
        text = (
            f"A trimmed panel at x = {place[0]:.2f}, y = {place[1]:.2f} mm has a neck below the {least:g} mm that "
            f"{plan.material.name!r} is known to bear; keep more material when trimming or make the sheet larger."
        )
        problems.append(Problem(text, Severity.WARNING, place))
    return problems


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


def flexing(plan: CutPlan, phi: float) -> Flexing | None:
    """Estimate what opening the sheet to an angle (radians) does to its connectors; None for a sheet without any."""
    if np.all(plan.hinges.removed):
        return None
    strains = hinge_strains(plan, phi)
    worst = int(np.argmax(strains))
    x, y = plan.hinges.position[worst]
    softer = min(float(plan.hinges.finished_mm[worst]), plan.material.thickness_mm)
    return Flexing(hinge_turn(phi), float(strains[worst]), (float(x), float(y)), float(_lengths(plan)[worst]), softer)


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


def _advice(plan: CutPlan) -> str:
    """What to try first: another style, or room for the ends that this style could not be made at."""
    if plan.options.style in (ConnectorStyle.ARC, ConnectorStyle.DOUBLE):
        return "Choose a larger sheet, so that every slit end has room for its style"
    return "Choose arc or double connectors"


def _lengths(plan: CutPlan) -> FloatArray:
    lengths: FloatArray = np.maximum(plan.hinges.flexure_mm, 1e-9)
    return lengths
