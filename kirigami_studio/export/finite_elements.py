"""Finite element input: the finished sheet for Gmsh, and a deck for CalculiX and Abaqus.

Lengths are in millimetres, forces in newtons, stresses in MPa.  The sheet is what the cuts leave, in plane stress.
Every panel and every connector is a surface of its own with a name, which becomes a set of elements and of nodes.
One panel is held and the farthest one that turns like it is led along the exact motion, which for it is a straight
shift in the held panel's frame.
"""

from __future__ import annotations

import math
import shlex
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import shapely
from shapely.geometry import Point, Polygon

from kirigami_studio import __version__
from kirigami_studio.assembly.pieces import Assembly, Piece
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.jam_angle import MPA_PER_GPA
from kirigami_studio.export.linkage import linkage_of
from kirigami_studio.fabricate.checks import finished_pieces
from kirigami_studio.fabricate.cut_panels import necks_of, panels_of
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.finished_sheet import BLADE_MM
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.lattice.deployment import rotate

#: Elements across a connector, and across a panel.
ACROSS_CONNECTOR, ACROSS_PANEL = 3, 3
#: Element sizes grow by this part of the distance from a connector.
GROWTH = 1.0
#: Outlines keep within this (mm) of the finished sheet's.
SIMPLER_MM = 2e-3
#: Corners lie on a grid (mm) that is finer than the slots of a blade are wide.
GRID_MM = 5e-4
#: The set of what belongs to no panel, as tabs.
REST = "REST"
#: Degrees by which the deck turns the panels against each other, and in how many steps.
TURN_DEG, STEPS = 10.0, 20
#: Poisson's ratio: materials of the studio have none of their own.
POISSON = 0.35


@dataclass(frozen=True, slots=True, eq=False)
class Surfaces:
    """Parts that fill a finished sheet: polygons (mm) with the names of their sets."""

    faces: tuple[tuple[str, Polygon], ...]
    middles: FloatArray  #: (H, 2), mm; of connectors
    widths: FloatArray  #: (H,), mm; of connectors
    panel_mm: float  #: side of a panel, about

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the sets, each once."""
        return tuple(dict.fromkeys(name for name, _ in self.faces))

    def size(self, points: FloatArray) -> FloatArray:
        """Lengths (P,), mm, of elements at points (P, 2)."""
        largest = np.full(len(points), self.panel_mm / ACROSS_PANEL)
        for middle, width in zip(self.middles, self.widths, strict=True):
            from_edge = np.maximum(np.hypot(*(points - middle).T) - 0.5 * width, 0.0)
            largest = np.minimum(largest, width / ACROSS_CONNECTOR + GROWTH * from_edge)
        return largest


def write_elements(job: ExportJob, path: Path) -> tuple[Path, Path]:
    """Write ``NAME.inp``, the deck, and ``NAME.geo``, the geometry; return both.

    Raises
    ------
    ExportError
        A sheet that falls apart, an unwritable place, or a file that did not read back.
    """
    plan, linkage = job.required_plan, linkage_of(job)
    surfaces = surfaces_of(plan, linkage)
    geometry = path.with_suffix(".geo")
    _write(geometry, geometry_text(surfaces, path.stem))
    _write(path, deck_text(surfaces, plan, linkage, path.stem))
    return path, geometry


def surfaces_of(plan: CutPlan, linkage: Assembly) -> Surfaces:
    """Divide a plan's finished sheet into panels and connectors, numbered from 1 on.

    Raises
    ------
    ExportError
        The sheet falls apart.
    """
    pieces = finished_pieces(plan)
    if len(pieces) != 1:
        raise ExportError("elements.in_pieces", pieces=len(pieces))
    panel_mm = math.sqrt(pieces[0].area / len(linkage.pieces))
    sheet = pieces[0].simplify(max(SIMPLER_MM, 0.15 * plan.kerf_mm)).segmentize(panel_mm / ACROSS_PANEL)
    columns = linkage.deployment.topology.panel_nodes.shape[1]
    by_number = {row * columns + column: set_name(piece) for piece in linkage.pieces for row, column in [piece.panel]}
    numbers, necks = necks_of(plan)
    kerf = max(plan.kerf_mm, BLADE_MM)
    widths = np.maximum(np.hypot(*(necks[:, 1] - necks[:, 0]).T) - kerf, 0.0)
    middles = necks.mean(axis=1)
    # Into the cuts at both ends, but not over them.
    reach = 0.5 * widths + np.minimum(0.5 * kerf, 0.25 * widths)
    rings = shapely.boundary(shapely.buffer(shapely.points(middles), reach, quad_segs=3))
    lines = shapely.union_all([sheet.boundary, *rings], grid_size=GRID_MM)
    faces = shapely.orient_polygons(shapely.get_parts(shapely.polygonize(shapely.get_parts(lines))))
    faces = faces[shapely.covers(sheet.buffer(GRID_MM), shapely.point_on_surface(faces))]
    named = [by_number.get(number, REST) for number in panels_of(faces, plan).tolist()]
    tree = shapely.STRtree(faces)
    for number, middle in zip(numbers.tolist(), middles, strict=True):
        for face in tree.query(Point(middle), predicate="within").tolist():
            named[face] = f"HINGE_{number + 1}"
    return Surfaces(tuple(zip(named, faces.tolist(), strict=True)), middles, widths, panel_mm)


def set_name(piece: Piece) -> str:
    """Name of a panel's set, without the point of its own name."""
    return piece.id.replace(".", "_")


def geometry_text(surfaces: Surfaces, name: str) -> str:
    """Return the sheet as a script for Gmsh 4; neighbouring surfaces share their lines."""
    script = [
        f"// Kirigami Studio {__version__}; millimetres",
        f"// {meshing(name)}",
        "Mesh.ElementOrder = 2;",
        "Mesh.SecondOrderLinear = 1;",
        "Mesh.SaveGroupsOfNodes = 1;",
    ]
    rings = [[ring.coords[:-1] for ring in (face.exterior, *face.interiors)] for _, face in surfaces.faces]
    corners = list(dict.fromkeys(corner for face in rings for ring in face for corner in ring))
    for number, ((x, y), size) in enumerate(zip(corners, surfaces.size(np.array(corners)).tolist(), strict=True), 1):
        script.append(f"Point({number}) = {{{x:.9g}, {y:.9g}, 0, {size:.4g}}};")
    point = {corner: number for number, corner in enumerate(corners, start=1)}
    line: dict[tuple[int, int], int] = {}
    loop = 0
    for surface, face in enumerate(rings, start=1):
        loops = []
        for ring in face:
            edges = pairwise([point[corner] for corner in (*ring, ring[0])])
            loop += 1
            loops.append(loop)
            along = []
            for start, end in edges:
                if (end, start) not in line:
                    line[start, end] = len(line) + 1
                    script.append(f"Line({len(line)}) = {{{start}, {end}}};")
                along.append(line[start, end] if (start, end) in line else -line[end, start])
            script.append(f"Curve Loop({loop}) = {_listed(along)};")
        script.append(f"Plane Surface({surface}) = {_listed(loops)};")
    for name_ in surfaces.names:
        own = [number for number, (one, _) in enumerate(surfaces.faces, start=1) if one == name_]
        script.append(f'Physical Surface("{name_}") = {_listed(own)};')
    return "\n".join(script) + "\n"


def meshing(name: str) -> str:
    """Command that makes the mesh which a deck includes."""
    return shlex.join(["gmsh", f"{name}.geo", "-2", "-format", "inp", "-o", f"{name}-mesh.inp"])


def _listed(numbers: Sequence[int]) -> str:
    return "{" + ", ".join(map(str, numbers)) + "}"


def deck_text(surfaces: Surfaces, plan: CutPlan, linkage: Assembly, name: str) -> str:
    """Return the deck: material, thickness, the held panel, the way of the led one, results."""
    held, led = grips(linkage, surfaces.names)
    way = way_of(linkage, held, led)
    lines = [
        f"** Kirigami Studio {__version__}; mm, N, MPa",
        f"** {meshing(name)}",
        f"** ccx {shlex.quote(name)}",
        f"*INCLUDE, INPUT={name}-mesh.inp",
        "*ELSET, ELSET=SHEET",
        *(f"{one}," for one in surfaces.names),
        "*MATERIAL, NAME=SHEET",
        "*ELASTIC",
        f"{MPA_PER_GPA * plan.material.young_gpa:.9g}, {POISSON}",
        "*SOLID SECTION, ELSET=SHEET, MATERIAL=SHEET",
        f"{plan.material.thickness_mm:.9g}",
    ]
    for axis, along in zip("XY", way.T.tolist(), strict=True):
        lines.append(f"*AMPLITUDE, NAME=LEAD_{axis}")
        lines += [
            f"{time:.9g}, {shift:.9g}" for time, shift in zip(np.linspace(0.0, 1.0, len(way)), along, strict=True)
        ]
    lines += [
        "*STEP, NLGEOM, INC=1000",
        f"** phi goes from 180 to {180.0 - TURN_DEG:g} degrees",
        "*STATIC",
        f"{1.0 / STEPS:.9g}, 1.0, 1e-5, {1.0 / STEPS:.9g}",
        "*BOUNDARY",
        f"{set_name(held)}, 1, 2",
        "*BOUNDARY, AMPLITUDE=LEAD_X",
        f"{set_name(led)}, 1, 1, 1.0",
        "*BOUNDARY, AMPLITUDE=LEAD_Y",
        f"{set_name(led)}, 2, 2, 1.0",
        f"*NODE PRINT, NSET={set_name(led)}, TOTALS=ONLY",
        "RF",
        "*NODE FILE",
        "U",
        "*EL FILE",
        "S, E",
        "*END STEP",
    ]
    return "\n".join(lines) + "\n"


def grips(linkage: Assembly, names: Collection[str]) -> tuple[Piece, Piece]:
    """Return the panel to hold and the one to lead, the farthest apart of those that turn alike."""
    alike = [number for number, piece in enumerate(linkage.pieces) if sum(piece.panel) % 2 == 0]
    there = [number for number in alike if set_name(linkage.pieces[number]) in names]
    at = linkage.poses(math.pi)[there, :2]
    pair = np.unravel_index(int(np.argmax(np.hypot(*(at[:, None] - at[None]).T))), (len(there), len(there)))
    held, led = (linkage.pieces[there[int(number)]] for number in sorted(pair))
    return held, led


def way_of(linkage: Assembly, held: Piece, led: Piece) -> FloatArray:
    """Shifts (STEPS + 1, 2), mm, of the led panel in the frame of the held one."""
    numbers = [linkage.pieces.index(piece) for piece in (held, led)]
    seen = []
    for turn in np.linspace(0.0, math.radians(TURN_DEG), STEPS + 1).tolist():
        here, there = linkage.poses(math.pi - turn)[numbers]
        seen.append(rotate(there[:2] - here[:2], -here[2]))
    way: FloatArray = np.array(seen) - seen[0]
    return way


def _write(path: Path, content: str) -> None:
    def verify(written: Path) -> None:
        if written.read_text(encoding="utf-8") != content:
            raise ExportError("linkage.not_as_written", name=path.name)

    write_atomically(path, content.encode("utf-8"), verify)
