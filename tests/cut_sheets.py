"""Sheets to cut and ways to measure them that share no code with the product: arcs by ezdxf, kerfs by shapely."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from ezdxf.entities.lwpolyline import LWPolyline
from ezdxf.path import make_path
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.fabricate.cut_plan import CutPath, CutPlan, Layer
from kirigami_studio.fabricate.slits import SHEET_EDGE, cut_table
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import Deployment

Kept = Sequence[FloatArray | None]
#: Chord tolerance (mm) of the independent flattening.
CHORD_MM = 1e-4


def bitten(deployment: Deployment, places: Sequence[tuple[float, float]], radius: float) -> Kept:
    """Panels with round bites out of the compact sheet's edge, in its own frame."""
    bites = shapely.union_all([Point(place).buffer(radius) for place in places])
    corners = deployment.compact[deployment.topology.panel_nodes.reshape(-1, 4)]
    kept: list[FloatArray | None] = []
    for panel in corners:
        rest = Polygon(panel).difference(bites, grid_size=1e-9)
        whole = rest.area > Polygon(panel).area - 1e-9
        kept.append(None if whole else shapely.get_coordinates(shapely.orient_polygons(rest).exterior)[:-1])
    return kept


def mouths(deployment: Deployment) -> list[tuple[float, float]]:
    """Where edge cuts begin on the compact sheet's edge."""
    table = cut_table(deployment.field.rows, deployment.field.columns)
    return [(float(x), float(y)) for x, y in deployment.compact[table.ends[table.slit_count :, 0]]]


def drawn_line(path: CutPath) -> LineString:
    """The centre line of a path, arcs flattened by ezdxf."""
    entity = LWPolyline.new()
    bulges = np.zeros(len(path.points)) if path.bulges is None else path.bulges
    entity.append_points(np.column_stack([path.points, bulges]).tolist(), format="xyb")
    entity.closed = path.closed
    return LineString([(vertex.x, vertex.y) for vertex in make_path(entity).flattening(CHORD_MM)])


def burned(path: CutPath, kerf_mm: float) -> BaseGeometry:
    """What the kerf takes away along a path; all inside a relief hole, which falls out."""
    line = drawn_line(path)
    area: BaseGeometry = Polygon(line) if path.closed else line
    return area.buffer(0.5 * kerf_mm, quad_segs=48) if kerf_mm else area


def connector_distances(plan: CutPlan) -> FloatArray:
    """Distance (H,), mm, between what is burned away on both sides of every connector."""
    bands: dict[int, BaseGeometry] = {}
    for path in plan.paths:
        if path.layer is not Layer.OUTLINE:
            band = burned(path, plan.kerf_mm)
            bands[path.cut] = band if path.cut not in bands else bands[path.cut].union(band)
    rims = [drawn_line(path) for path in plan.on_layer(Layer.OUTLINE)]
    outline = shapely.union_all(rims)
    if plan.kerf_mm:
        outline = outline.buffer(0.5 * plan.kerf_mm, join_style="mitre")
    hinges = plan.hinges
    return np.array(
        [
            bands[int(cut)].distance(outline if through == SHEET_EDGE else bands[int(through)])
            for cut, through in zip(hinges.cut, hinges.through, strict=True)
        ]
    )


def covered_hinges(plan: CutPlan) -> np.ndarray:
    """Which connectors (H,) have their through cut beside junction and tip of the slit; others come out wider."""
    lines: dict[int, list[LineString]] = {}
    for path in plan.paths:
        if path.layer is not Layer.OUTLINE:
            lines.setdefault(path.cut, []).append(drawn_line(path))
    there = []
    for hinge, through in enumerate(plan.hinges.through.tolist()):
        junction = plan.hinges.position[hinge]
        slit, resting = (max(lines.get(cut, [None]), key=_extent) for cut in (int(plan.hinges.cut[hinge]), through))
        if through == SHEET_EDGE or resting is None or slit is None:
            there.append(through == SHEET_EDGE)
            continue
        tip = min((np.array(slit.coords[end]) for end in (0, -1)), key=lambda end: float(np.hypot(*(end - junction))))
        along = np.subtract(resting.coords[-1], resting.coords[0]) / _extent(resting)
        foot = junction + np.dot(tip - junction, along) * along
        near = shapely.union_all(lines[through])
        # Around a centred connector, the through cut makes way by less than the connector's width and the kerf.
        beside = 1e-3 if plan.centres is None else float(plan.hinges.requested_mm[hinge]) + plan.kerf_mm
        there.append(max(near.distance(Point(place)) for place in (junction, foot)) < beside)
    return np.array(there)


def _extent(line: LineString | None) -> float:
    """Distance between both ends."""
    return 0.0 if line is None else float(np.hypot(*np.subtract(line.coords[-1], line.coords[0])))


def finished_pieces(plan: CutPlan, kerf_mm: float) -> int:
    """Number of pieces, by subtracting what is burned from the area inside the outline."""
    area = Polygon(plan.outline).buffer(-0.5 * kerf_mm, join_style="mitre")
    cuts = [burned(path, kerf_mm) for path in plan.paths if path.layer is not Layer.OUTLINE]
    return sum(part.area > 1e-6 for part in shapely.get_parts(area.difference(shapely.union_all(cuts))))


def hanging_together(deployment: Deployment, removed: Sequence[int]) -> int:
    """Number of parts that the panels form when they hang together by all connectors but the removed ones."""
    table = cut_table(deployment.field.rows, deployment.field.columns)
    panels = deployment.topology.panel_nodes.reshape(-1, 4)
    part = list(range(len(panels)))
    for hinge, node in enumerate(table.hinge_node.tolist()):
        if hinge not in removed:
            one, other = (part[index] for index in np.flatnonzero((panels == node).any(axis=1)))
            part = [one if number == other else number for number in part]
    return len(set(part))
