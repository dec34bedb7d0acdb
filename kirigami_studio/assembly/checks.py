"""Findings on a pinned plan: whole pieces, walls, necks, pins, collisions, both outlines."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.assembly.motion import GeometryArray
from kirigami_studio.assembly.nesting import smallest_rectangle
from kirigami_studio.assembly.passing import passing
from kirigami_studio.assembly.pieces import Assembly, Piece
from kirigami_studio.assembly.pinned import PinnedPlan
from kirigami_studio.assembly.rim_pieces import filled, iou, silhouette
from kirigami_studio.assembly.shaping import united
from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.evaluate.trimming import MOSTLY_OPEN, SMALL_HOLE, TrimmedHole
from kirigami_studio.fabricate.findings import Problem, Severity
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import Deployment

#: Angles at which a plan is looked over for collisions, beside the swept areas that it is made by.
ANGLES = 31
#: Overlap within a layer, mm2, that rounding explains.
OVERLAP_MM2 = 0.01
#: How much (mm) polygons that stand for discs may lie inside of these.
ROUNDNESS_MM = 0.02
#: Below this IoU with the target a plan is warned of.
LEAST_MATCH = 0.95
#: Codes of pieces that meet: in layers, and in one plane.
COLLISIONS = ("pinned.pieces_collide", "printed.pieces_too_near")
#: Halvings when the narrowest neck is looked for.
HALVINGS = 6


@dataclass(frozen=True, slots=True)
class PinnedFigures:
    """Measures of a pinned plan.

    Attributes
    ----------
    match, flat_match : float, 0..1
        Exact IoU of the assembled silhouette (both layers, openings filled but for those at holes of the target) with
        the target, and of the flat one, filled, with the start outline.
    covered, flat_covered : float, 0..1
        Share of both outlines that no hole or gap shows through.
    lost_flat, beyond_flat : float, 0..1
        Area missing of the start outline, and sticking out of it, relative to it.
    gap_mm : float
        Least distance over the motion of two pins in one layer, in different pieces.
    pins_apart_mm : float
        Least distance of any two pins over the motion.
    wall_mm : float
        Least material round a hole.
    neck_mm : float
        Least width of a connection between ears; at most as wide as ears allow to measure.
    overlap_mm2 : float
        Largest overlap within a plane at any angle looked at; in one plane of pieces that are larger by half of their
        clearance all round.
    kept, least_kept : float
        Area of pieces relative to their panels: mean and least.
    """

    match: float
    flat_match: float
    covered: float
    flat_covered: float
    lost_flat: float
    beyond_flat: float
    gap_mm: float
    pins_apart_mm: float
    wall_mm: float
    neck_mm: float
    overlap_mm2: float
    kept: float
    least_kept: float


@dataclass(frozen=True, slots=True)
class PinnedReport:
    """Figures and problems of a pinned plan; places are in the flat sheet, mm."""

    figures: PinnedFigures
    problems: tuple[Problem, ...]


def check_pinned(plan: PinnedPlan, angles: int = ANGLES) -> PinnedReport:
    """Measure a plan and list its problems, worst first.

    Parameters
    ----------
    plan : PinnedPlan
    angles : int, at least 2
        How many angles from flat to target are looked at for collisions.
    """
    assembly, options = plan.assembly, plan.options
    phi = assembly.phi_target
    bodies = [body_of(piece) for piece in assembly.pieces]
    overlap, worst_phi = largest_overlap(plan, bodies, np.linspace(math.pi, phi, angles).tolist())
    opened, flat = (united(*placed_bodies(assembly, bodies, angle)) for angle in (phi, math.pi))
    walls = [wall_mm(piece, body) for piece, body in zip(assembly.pieces, bodies, strict=True)]
    necks: list[float] = []
    widest = 0.999 * 2.0 * options.keep_mm
    for piece, body in zip(assembly.pieces, bodies, strict=True):
        whole = piece.id not in plan.broken
        necks.append(neck_mm(piece, body, options.neck_mm, widest) if whole else 0.0)
        if necks[-1] >= options.neck_mm:
            widest = min(widest, necks[-1])  # wider ones need not be measured
    corners = assembly.deployment.panels(math.pi).reshape(-1, 4, 2)[assembly.numbers]
    panels = shapely.area(shapely.polygons(corners * assembly.cell_mm))
    kept = shapely.area(bodies) / panels
    apart, pair = pins_apart(assembly.deployment, [hinge.node for hinge in assembly.hinges], assembly.cell_mm, phi)
    seen, flat_seen = filled(opened, plan.opened), silhouette(flat)
    figures = PinnedFigures(
        match=iou(seen, plan.opened),
        flat_match=iou(flat_seen, plan.flat),
        covered=float(plan.opened.intersection(opened).area / plan.opened.area),
        flat_covered=float(plan.flat.intersection(flat).area / plan.flat.area),
        lost_flat=float(plan.flat.difference(flat_seen).area / plan.flat.area),
        beyond_flat=float(flat_seen.difference(plan.flat).area / plan.flat.area),
        gap_mm=plan.gap_mm,
        pins_apart_mm=apart,
        wall_mm=min(walls),
        neck_mm=min(necks),
        overlap_mm2=overlap,
        kept=float(kept.mean()),
        least_kept=float(kept.min()),
    )
    places = {
        piece.id: (float(x), float(y))
        for piece, (x, y, _) in zip(assembly.pieces, assembly.poses(math.pi), strict=True)
    }
    problems = _broken(plan, places)
    ear = 0.25 * math.pi * (options.ear_mm / assembly.cell_mm) ** 2
    shown = shown_holes(plan, bodies, seen)
    problems += closed_holes(shown, np.zeros(2), assembly.cell_mm, "pinned.hole_too_small", ear)
    needed = options.ear_mm + options.clearance_mm
    if plan.gap_mm < needed - ROUNDNESS_MM:
        problems.append(
            Problem.warning("pinned.ears_meet", plan.gap_at, count=plan.tight, gap_mm=plan.gap_mm, needed_mm=needed)
        )
    if overlap > OVERLAP_MM2:
        collision = {"angle_deg": math.degrees(worst_phi), "clearance_mm": options.clearance_mm}
        problems.append(Problem.error(COLLISIONS[options.in_one_plane], overlap_mm2=overlap, **collision))
    least_wall = options.asked_wall_mm
    thin = sorted((wall, piece.id) for piece, wall in zip(assembly.pieces, walls, strict=True))
    thin = [one for one in thin if one[0] < least_wall - ROUNDNESS_MM]
    if thin:
        wall, name = thin[0]
        values = {"count": len(thin), "piece": name, "wall_mm": wall, "needed_mm": least_wall}
        problems.append(Problem.error("pinned.wall_too_thin", places[name], **values))
    narrow = sorted((neck, piece.id) for piece, neck in zip(assembly.pieces, necks, strict=True) if neck > 0.0)
    narrow = [one for one in narrow if one[0] < options.neck_mm - ROUNDNESS_MM]
    if narrow:
        neck, name = narrow[0]
        values = {"count": len(narrow), "piece": name, "neck_mm": neck, "needed_mm": options.neck_mm}
        problems.append(Problem.warning("pinned.neck_too_narrow", places[name], **values))
    if apart < options.head_mm:
        where = tuple(assembly.deployment.nodes(math.pi)[pair].mean(axis=0) * assembly.cell_mm)
        problems.append(
            Problem.error("pinned.heads_meet", (where[0], where[1]), apart_mm=apart, head_mm=options.head_mm)
        )
    if figures.flat_match < options.least_flat:
        problems.append(
            Problem.warning(
                "pinned.flat_outline_spoilt", lost=100.0 * figures.lost_flat, beyond=100.0 * figures.beyond_flat
            )
        )
    if figures.match < LEAST_MATCH:
        missing, beyond = plan.opened.difference(seen).area, seen.difference(plan.opened).area
        problems.append(
            Problem.warning(
                "pinned.target_missed",
                lost=100.0 * missing / plan.opened.area,
                beyond=100.0 * beyond / plan.opened.area,
            )
        )
    return PinnedReport(figures, tuple(sorted(problems, key=lambda problem: problem.severity is Severity.WARNING)))


def bed_problems(
    assembly: Assembly, bed: tuple[float, float], kerf_mm: float, width_mm: float, fixed_mm: float
) -> list[Problem]:
    """Warn about pieces that lie on no bed of a machine; several beds are no problem.

    Parameters
    ----------
    assembly : Assembly
    bed : (width, height), mm
        0 for a side that has no end.
    kerf_mm : float
        That is cut round a piece.
    width_mm : float
        Of the flat sheet.
    fixed_mm : float
        How much of the sides of pieces stays the same on smaller sheets: an ear.
    """
    room = sorted((side if side > 0.0 else math.inf for side in bed), reverse=True)
    found: list[tuple[float, str, float, float]] = []
    for piece in assembly.pieces:
        sides = [side + kerf_mm for side in smallest_rectangle(piece.outline)]
        if any(side > most for side, most in zip(sides, room, strict=True)):
            shares = [(most - fixed_mm) / max(side - fixed_mm, 1.0) for side, most in zip(sides, room, strict=True)]
            found.append((min(shares), piece.id, sides[0], sides[1]))
    if not found:
        return []
    share, name, long, short = min(found)
    places = zip(assembly.pieces, assembly.poses(math.pi).tolist(), strict=True)
    where = next((x, y) for piece, (x, y, _) in places if piece.id == name)
    told = {
        "count": len(found),
        "piece": name,
        "long_mm": long,
        "short_mm": short,
        "width_mm": bed[0],
        "height_mm": bed[1],
        "largest_mm": math.floor(share * width_mm),
    }
    return [Problem.warning("pieces.larger_than_bed" if share > 0.0 else "pieces.bed_below_ear", where, **told)]


def _broken(plan: PinnedPlan, places: Mapping[str, tuple[float, float]]) -> list[Problem]:
    if not plan.broken:
        return []
    first = plan.broken[0]
    return [Problem.error("pinned.falls_apart", places[first], piece=first, count=len(plan.broken))]


def body_of(piece: Piece) -> Polygon:
    """A piece as a polygon with its openings, its round holes not drilled."""
    return Polygon(piece.outline, piece.openings)


def placed_bodies(assembly: Assembly, bodies: Sequence[BaseGeometry], phi: float) -> GeometryArray:
    """Bodies of all pieces where they are at ``phi``, frame of the deployment, mm."""
    x, y, turn = assembly.poses(phi).T
    points, owner = shapely.get_coordinates(bodies, return_index=True)
    moved = as_plane(points) * np.exp(1j * turn)[owner] + (x + 1j * y)[owner]
    placed: GeometryArray = shapely.set_coordinates(np.array(bodies, dtype=object), as_points(moved))
    return placed


def largest_overlap(plan: PinnedPlan, bodies: Sequence[Polygon], angles: Sequence[float]) -> tuple[float, float]:
    """Largest overlap within a plane, mm2, over some angles (radians), and where it is.

    Pieces in one plane are looked at outside of their joints, and have to keep their clearance.
    """
    assembly, options = plan.assembly, plan.options
    poses = np.array([assembly.poses(phi) for phi in angles])
    plane, shapes = np.array([piece.layer for piece in assembly.pieces]), np.array(bodies, dtype=object)
    if options.in_one_plane:
        plane = np.ones_like(plane)
        joint = 0.5 * options.ear_mm + options.clearance_mm
        pins = [
            shapely.union_all(shapely.buffer(shapely.points([hole.centre for hole in piece.holes]), joint))
            for piece in assembly.pieces
        ]
        shapes = np.asarray(
            shapely.buffer(shapely.difference(shapes, pins), 0.5 * options.clearance_mm - ROUNDNESS_MM), dtype=object
        )
    found = [one for number in (1, 2) for one in passing(shapes[plane == number], poses[:, plane == number]).overlaps]
    worst = max(found, key=lambda one: one.area_mm2, default=None)
    return (0.0, math.pi) if worst is None else (worst.area_mm2, angles[worst.pose])


def wall_mm(piece: Piece, body: Polygon) -> float:
    """Least material between a hole and the edge of its piece, or another hole."""
    centres = np.array([hole.centre for hole in piece.holes])
    radii = np.array([0.5 * hole.diameter_mm for hole in piece.holes])
    walls = shapely.distance(body.boundary, shapely.points(centres)) - radii
    walls[~shapely.contains(body, shapely.points(centres))] = 0.0
    between = np.abs(as_plane(centres)[:, None] - as_plane(centres)) - radii[:, None] - radii
    np.fill_diagonal(between, np.inf)
    return float(min(walls.min(), between.min()))


def neck_mm(piece: Piece, body: Polygon, least: float, most: float) -> float:
    """Width of the narrowest connection between ears, mm, from 0 to ``most``."""
    centres = shapely.points([hole.centre for hole in piece.holes])

    def holds(width: float) -> bool:
        core = shapely.buffer(body, -0.5 * width)
        return any(np.all(shapely.contains(part, centres)) for part in shapely.get_parts(core))

    if holds(most):
        return most
    low, high = (least, most) if least < most and holds(least) else (0.0, min(least, most))
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


def pins_apart(deployment: Deployment, nodes: Sequence[int], cell_mm: float, phi: float) -> tuple[float, list[int]]:
    """Exact least distance of any two pins from flat to ``phi``, mm, and their nodes.

    The difference of two nodes is R(-a) u + R(+a) v: its square is |u|^2 + |v|^2 + 2 |u| |v| cos(t + arg v - arg u)
    with t = 2 a.
    """
    index = np.array(nodes)
    even, odd = as_plane(deployment.even_part)[index] * cell_mm, as_plane(deployment.odd_part)[index] * cell_mm
    one, other = np.triu_indices(len(index), 1)
    u, v = even[one] - even[other], odd[one] - odd[other]
    turned = np.mod(np.angle(v) - np.angle(u), 2.0 * math.pi)
    opening = math.pi - phi
    # The cosine is least at pi, if that is on the way.
    ends = np.minimum(np.cos(turned), np.cos(turned + opening))
    passed = (turned <= math.pi) & (turned + opening >= math.pi) | (turned + opening >= 3.0 * math.pi)
    least = np.abs(u) ** 2 + np.abs(v) ** 2 + 2.0 * np.abs(u) * np.abs(v) * np.where(passed, -1.0, ends)
    nearest = int(np.argmin(least))
    pair = [int(index[one[nearest]]), int(index[other[nearest]])]
    return math.sqrt(max(float(least[nearest]), 0.0)), pair


def shown_holes(plan: PinnedPlan, bodies: Sequence[BaseGeometry], seen: BaseGeometry) -> tuple[TrimmedHole, ...]:
    """How the pieces leave the holes of their target open."""
    assembly = plan.assembly
    placed = placed_bodies(assembly, bodies, assembly.phi_target)
    places = assembly.poses(math.pi)[:, :2] / assembly.cell_mm
    found = []
    for ring in plan.opened.interiors:
        hole = Polygon(ring)
        x, y = places[int(np.argmax(shapely.area(shapely.intersection(placed, hole))))].tolist()
        covered = hole.intersection(seen).area / hole.area
        found.append(TrimmedHole(1.0 - covered, hole.area / assembly.cell_mm**2, (x, y)))
    return tuple(found)


def closed_holes(
    holes: Sequence[TrimmedHole],
    low: FloatArray,
    cell_mm: float,
    too_small: str = "trim.hole_too_small",
    least: float = SMALL_HOLE,
) -> list[Problem]:
    """Warn of holes of the target that stay closed, and where on the flat sheet they would be.

    Parameters
    ----------
    holes : sequence of TrimmedHole
        All holes of the target.
    low : (2,) float, unit cells
        Of the frame of these places; problems count from there.
    cell_mm : float
    too_small : str
        Code for holes below ``least``, unit cells squared.
    """
    problems = []
    closed = [hole for hole in holes if hole.open < MOSTLY_OPEN]
    for code, some in (
        (too_small, [hole for hole in closed if hole.cells < least]),
        ("trim.hole_holds_sheet", [hole for hole in closed if hole.cells >= least]),
    ):
        if some:
            x, y = ((np.array(some[0].place) - low) * cell_mm).tolist()
            problems.append(Problem.warning(code, (x, y), count=len(some), total=len(holes), x=x, y=y))
    return problems
