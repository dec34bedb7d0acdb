"""The physical check of a plan: is the sheet one piece, are all widths as asked, do the connectors survive bending?

:func:`check_plan` cuts the sheet in the computer (``finished_sheet``) and returns a :class:`PlanReport` of problems,
each with a place.  The strain of the connectors is an estimate: a strip that bends evenly over its flexure length,
across its thickness where it escapes out of the plane, across its width where it does not (``strain``).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from shapely.geometry import LineString, Point, Polygon

from kirigami_studio.fabricate.cut_path import measured_line
from kirigami_studio.fabricate.cut_plan import CutPath, CutPlan, Layer
from kirigami_studio.fabricate.findings import Problem, Severity
from kirigami_studio.fabricate.finished_sheet import (
    Ligament,
    RepeatedCut,
    overlap,
    remaining_pieces,
    smallest_ligament,
)
from kirigami_studio.fabricate.joints import joined_pairs
from kirigami_studio.fabricate.machine import Machine, kinds_for
from kirigami_studio.fabricate.material import Material
from kirigami_studio.fabricate.options import ConnectorStyle
from kirigami_studio.fabricate.panel_sizes import SmallPlace, smallest_edge, smallest_neck, trimmed_neck_below
from kirigami_studio.fabricate.strain import RigidPanels, Survival, escapes, survival, used_up
from kirigami_studio.foundation.arrays import FloatArray

#: Overlaps shorter than this (mm) are rounding.
OVERLAP_TOLERANCE_MM = 1e-6
#: Tolerance (mm) for finished widths; coordinates are rounded to a tenth of it.
WIDTH_TOLERANCE_MM = 1e-3
#: Connectors that are gone count as this wide and long (mm), where something is divided by it.
LEAST_MM = 1e-9


@dataclass(frozen=True, slots=True)
class PlanReport:
    """What the check found."""

    problems: tuple[Problem, ...]
    pieces: int  #: pieces that the sheet is in after cutting; must be 1
    min_connector_mm: float  #: smallest finished connector
    min_ligament_mm: float  #: smallest finished distance between any two cuts
    overlap_mm: float  #: length cut more than once

    @property
    def ok(self) -> bool:
        """No errors; there may be warnings."""
        return not any(problem.severity is Severity.ERROR for problem in self.problems)


def check_plan(
    plan: CutPlan, kerf_mm: float | None = None, phi: float | None = None, rigid: RigidPanels | None = None
) -> PlanReport:
    """Cut the plan in the computer and look at what is left.

    Parameters
    ----------
    kerf_mm : float, optional
        The kerf the machine really has; the plan's own unless given.
    phi : float, radians, optional
        Target angle of the deployment; without it nothing is said about how far the connectors bend.
    rigid : RigidPanels, optional
        Tiles on the sheet, which is the hinge layer under them; those of the plan unless given.
    """
    kerf = plan.kerf_mm if kerf_mm is None else kerf_mm
    if rigid is None and phi is not None and plan.tiles is not None:
        rigid = plan.tiles.rigid_panels(plan.hinges, kerf, phi)
    inner = plan.inner
    lines = [measured_line(path.points, path.bulges, path.closed) for path in inner]
    boundary = plan.boundary
    pieces = finished_pieces(plan, kerf)
    ligament = smallest_ligament(lines, boundary.boundary, kerf, joined_pairs(plan, inner, lines))
    twice = overlap([LineString(path.travelled) for path in plan.paths])
    edge, neck = smallest_edge(plan.panels, kerf), smallest_neck(plan.panels, kerf)
    bent = None if phi is None else flexing(plan, phi, rigid)
    problems = [
        *piece_problems(pieces, boundary, kerf, len(plan.options.removed)),
        *tab_problems(plan),
        *connector_problems(plan, kerf),
        *slit_problems(plan),
        *_overlap_problems(twice),
        *_ligament_problems(plan, kerf, ligament),
        *panel_problems(plan, kerf, edge, neck),
        *bed_problems(plan),
        *machine_problems(plan.chosen_machine, plan.material),
        *([] if phi is None or rigid is not None else _limits(plan)),
        *([] if bent is None else strain_problems(plan, bent)),
    ]
    return PlanReport(
        problems=tuple(problems),
        pieces=len(pieces),
        min_connector_mm=plan.min_connector_mm + plan.kerf_mm - kerf,
        min_ligament_mm=ligament.width_mm if ligament is not None else float("inf"),
        overlap_mm=twice.length_mm,
    )


def finished_pieces(plan: CutPlan, kerf_mm: float | None = None) -> list[Polygon]:
    """Pieces of the finished sheet with its tabs broken, largest first.

    The middle of relief holes falls out.

    Parameters
    ----------
    plan : CutPlan
    kerf_mm : float, optional
        The plan's own unless given.
    """
    cuts = [Polygon(path.flattened) if path.closed else LineString(path.flattened) for path in plan.inner]
    return remaining_pieces(plan.boundary, cuts, plan.kerf_mm if kerf_mm is None else kerf_mm)


def piece_problems(pieces: Sequence[Polygon], boundary: Polygon, kerf_mm: float, removed: int) -> list[Problem]:
    """Errors of a sheet that does not stay in one piece; ``removed`` connectors are named as a possible reason."""
    if len(pieces) == 1:
        return []
    if not pieces:
        return [Problem.error("plan.nothing_left", place_of(boundary.centroid), kerf_mm=kerf_mm)]
    where, count = place_of(pieces[1].representative_point()), len(pieces)
    if removed:
        return [Problem.error("plan.falls_apart_after_removal", where, kerf_mm=kerf_mm, pieces=count, count=removed)]
    return [Problem.error("plan.falls_apart", where, kerf_mm=kerf_mm, pieces=count)]


def place_of(point: Point) -> tuple[float, float]:
    """Coordinates of a point."""
    return float(point.x), float(point.y)


def tab_problems(plan: CutPlan) -> list[Problem]:
    """Errors of an outline with other gaps than its tabs."""
    paths = plan.on_layer(Layer.OUTLINE)
    tabs = plan.options.tabs
    opened = [path for path in paths if not path.closed]
    if len(opened) != tabs or len(paths) != max(tabs, 1):
        x, y = (opened or paths)[0].points[-1] if paths else np.zeros(2)
        where = (float(x), float(y))
        return [Problem.error("plan.tab_count", where, paths=len(paths), open_paths=len(opened), tabs=tabs)]
    asked = plan.options.tab_mm
    for path, following in zip(opened, [*opened[1:], *opened[:1]], strict=True):
        width = float(np.linalg.norm(following.points[0] - path.points[-1])) - plan.kerf_mm
        if abs(width - asked) > WIDTH_TOLERANCE_MM:
            x, y = 0.5 * (following.points[0] + path.points[-1])
            return [Problem.error("plan.tab_width", (float(x), float(y)), width_mm=width, asked_mm=asked)]
    return []


def connector_problems(plan: CutPlan, kerf_mm: float) -> list[Problem]:
    """Connectors narrower than asked (an error) or than the material needs (a warning); removed ones are as asked."""
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
            Problem.error(
                "plan.connectors_narrower",
                (float(x), float(y)),
                count=int(np.sum(short > WIDTH_TOLERANCE_MM)),
                finished_mm=float(finished[worst]),
                asked_mm=float(hinges.requested_mm[there[worst]]),
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
    x, y = hinges.position[left[0]]
    return [Problem.warning("plan.removed_not_cut_through", (float(x), float(y)), count=int(left.size))]


def _thin(plan: CutPlan, finished_mm: float, position: FloatArray) -> list[Problem]:
    """What the narrowest connector is too narrow for, if it is."""
    where, material = (float(position[0]), float(position[1])), plan.material
    if finished_mm <= 0.0:
        return [Problem.error("plan.connector_gone", where)]
    if finished_mm < material.min_ligament_mm - WIDTH_TOLERANCE_MM:
        least = material.min_ligament_mm
        return [
            Problem.warning(
                "plan.connector_may_tear", where, finished_mm=finished_mm, material=material.name, least_mm=least
            )
        ]
    return []


def slit_problems(plan: CutPlan) -> list[Problem]:
    """Warn about cuts shorter than the material's shortest slit; shapes at the ends of a slit belong to it."""
    longest: dict[int, CutPath] = {}
    for path in plan.on_layer(Layer.SLITS) + plan.on_layer(Layer.EDGE_SLITS):
        if path.cut not in longest or path.length > longest[path.cut].length:
            longest[path.cut] = path
    least = plan.material.min_slit_mm
    short = [path for cut, path in longest.items() if cut >= 0 and path.length < least - WIDTH_TOLERANCE_MM]
    if not short:
        return []
    shortest = min(short, key=lambda path: path.length)
    x, y = shortest.points.mean(axis=0)
    return [
        Problem.warning(
            "plan.slits_short",
            (float(x), float(y)),
            count=len(short),
            least_mm=least,
            material=plan.material.name,
            length_mm=shortest.length,
        )
    ]


def _overlap_problems(twice: RepeatedCut) -> list[Problem]:
    if twice.where is None or twice.length_mm <= OVERLAP_TOLERANCE_MM:
        return []
    return [Problem.error("plan.cut_twice", twice.where, length_mm=twice.length_mm)]


def _ligament_problems(plan: CutPlan, kerf: float, ligament: Ligament | None) -> list[Problem]:
    """Two cuts nearer to each other than the connectors are wide."""
    if ligament is None or ligament.width_mm >= plan.min_connector_mm - plan.kerf_mm + kerf - WIDTH_TOLERANCE_MM:
        return []
    weighed = Problem.error if ligament.width_mm <= 0 else Problem.warning
    return [weighed("plan.cuts_too_near", ligament.where, width_mm=ligament.width_mm)]


def panel_problems(plan: CutPlan, kerf_mm: float, edge: SmallPlace | None, neck: SmallPlace | None) -> list[Problem]:
    """Warn about panels smaller than what the material needs."""
    name, least = plan.material.name, max(plan.material.min_ligament_mm, plan.material.min_panel_mm)
    problems = []
    for code, small in (("plan.panel_edge_small", edge), ("plan.panel_neck_small", neck)):
        if small is not None and small.size_mm < least - WIDTH_TOLERANCE_MM:
            problems.append(Problem.warning(code, small.where, size_mm=small.size_mm, material=name, least_mm=least))
    place = trimmed_neck_below(plan.panels, kerf_mm, least)
    if place is not None:
        problems.append(Problem.warning("plan.trimmed_neck_small", place, material=name, least_mm=least))
    return problems


def _limits(plan: CutPlan) -> list[Problem]:
    """Warn about a material of which no single sheet works."""
    material = plan.material
    note = material.limits_note if material.backing or not material.connectors_hold else None
    return [] if note is None else [Problem(note.code, note.fields, Severity.WARNING)]


def bed_problems(plan: CutPlan) -> list[Problem]:
    """Warn about a sheet that the machine cannot reach all of, whichever way round it lies."""
    bed, (width, height) = plan.machine.reach_mm, plan.bounds_mm
    if fits_on(bed, (width, height)):
        return []
    largest = width * max(min(across / width, along / height) for across, along in (bed, bed[::-1]))
    return [
        Problem.warning(
            "plan.larger_than_bed",
            width_mm=width,
            height_mm=height,
            bed_width_mm=bed[0],
            bed_height_mm=bed[1],
            largest_mm=largest,
        )
    ]


def fits_on(bed: tuple[float, float], size: tuple[float, float]) -> bool:
    """Whether a size (width, height; mm) fits on a bed, 0 for any, either way round."""
    return min(bed) == 0.0 or any(size[0] <= across and size[1] <= along for across, along in (bed, bed[::-1]))


def machine_problems(machine: Machine | None, material: Material) -> list[Problem]:
    """Warn about a material that is too thick for a machine that was chosen, or unknown to it."""
    if machine is None or machine.takes(material):
        return []
    if machine.kind not in kinds_for(material):
        return [Problem.warning("plan.machine_does_not_cut", machine=machine.name, material=material.name)]
    return [
        Problem.warning(
            "plan.too_thick_for_machine",
            machine=machine.name,
            material=material.name,
            thickest_mm=machine.thickest_mm,
            thickness_mm=material.thickness_mm,
        )
    ]


@dataclass(frozen=True, slots=True)
class Flexing:
    """What the connectors go through."""

    turn: float  #: radians; by which every connector turns
    strain: float  #: estimate for the connector that is nearest to breaking
    where: tuple[float, float]  #: (x, y), mm; that connector
    flexure_mm: float  #: length over which it bends
    survival: Survival


def flexing(plan: CutPlan, phi: float, rigid: RigidPanels | None = None) -> Flexing | None:
    """Estimate how opening the sheet to an angle (radians) bends its connectors; None for a sheet without any.

    With ``rigid`` panels, whose arrays are of all hinges, connectors bend only where they are free.
    """
    if np.all(plan.hinges.removed):
        return None
    there = np.flatnonzero(~plan.hinges.removed)
    in_plane, out_of_plane = (figure[there] for figure in _both_figures(plan, phi))
    widths = np.maximum(plan.hinges.finished_mm[there], LEAST_MM)
    tiles = None if rigid is None else rigid.of(there)
    worst = there[int(np.argmax(used_up(plan.material, widths, in_plane, out_of_plane, tiles)))]
    found = survival(plan.material, widths, in_plane, out_of_plane, tiles)
    x, y = plan.hinges.position[worst]
    length = _lengths(plan)[worst] if rigid is None else min(_lengths(plan)[worst], rigid.free_mm[worst])
    return Flexing(hinge_turn(phi), found.strain, (float(x), float(y)), float(length), found)


def hinge_turn(phi: float) -> float:
    """Angle (radians) by which every connector turns between the flat sheet and ``phi``."""
    return math.pi - phi


def hinge_strains(plan: CutPlan, phi: float) -> FloatArray:
    """Estimated strain of every connector (H,) at an angle (radians); 0 for removed ones."""
    bent = escapes(plan.material.thickness_mm, plan.hinges.finished_mm)
    strain: FloatArray = np.where(bent, *_both_figures(plan, phi)[::-1])
    return strain


def _both_figures(plan: CutPlan, phi: float) -> tuple[FloatArray, FloatArray]:
    """Strains (H,) in the plane and out of it, of evenly bent strips; 0 for removed connectors."""
    widths = np.where(plan.hinges.removed, 0.0, np.maximum(plan.hinges.finished_mm, 0.0))
    curvature = hinge_turn(phi) / (2.0 * _lengths(plan))
    return curvature * widths, curvature * np.minimum(widths, plan.material.thickness_mm)


def strain_problems(plan: CutPlan, found: Flexing) -> list[Problem]:
    """Warn when the material does not survive the estimate."""
    judged = found.survival
    if not judged.breaks:
        return []
    # What to try first: another style, or room for the ends that this style could not be made at.
    styled = plan.options.style in (ConnectorStyle.ARC, ConnectorStyle.DOUBLE)
    return [
        Problem.warning(
            "plan.strain_larger_sheet" if styled else "plan.strain_choose_style",
            found.where,
            turn_deg=math.degrees(found.turn),
            strain_percent=100.0 * found.strain,
            material=plan.material.name,
            limit_percent=100.0 * judged.limit,
            flexure_mm=found.flexure_mm,
            why=judged.why.text,
        )
    ]


def _lengths(plan: CutPlan) -> FloatArray:
    lengths: FloatArray = np.maximum(plan.hinges.flexure_mm, LEAST_MM)
    return lengths
