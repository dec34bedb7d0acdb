"""Small pinned designs for tests: panels shrunk until they pass each other, arms to ears on the nodes, round holes."""

from __future__ import annotations

import math

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon

from kirigami_studio.assembly.pieces import Assembly, Hinge, Piece, RoundHole
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines import silhouettes
from kirigami_studio.project.document import Document
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import new_settings


def plain_pinwheel(*factors: float) -> Document:
    """A square of 3 x 3 voids whose panels alternate in size, to be cut of plywood 160 mm wide.

    For each of ``factors`` there is another design whose ratios are nearer to 1, or farther from it.
    """
    target = silhouettes.load("square")
    candidates = []
    for number, factor in enumerate((1.0, *factors)):
        ratios = 10 ** (0.2 * factor * (-1.0) ** np.add.outer(range(3), range(3)))
        sheet = Sheet(RatioField(ratios))
        candidates.append(Candidate(sheet, evaluate(deploy(sheet), target), 0, number))
    settings = new_settings({"material": "plywood-co2", "width_mm": 160.0})
    return Document(target, DesignSettings(), tuple(candidates), 0, fabrication=settings)


CELL_MM, EAR_MM, HOLE_MM, CLEARANCE_MM = 30.0, 7.0, 3.2, 0.6


def pinwheel(rows: int, columns: int, seed: int = 0) -> Deployment:
    """A random field whose signs alternate like a checkerboard, never near 1."""
    random = np.random.default_rng(seed)
    signs = np.where(np.indices((rows, columns)).sum(axis=0) % 2 == 0, 1.0, -1.0)
    return deploy(RatioField.from_log10(signs * random.uniform(0.17, 0.25, (rows, columns))))


def small_assembly(
    rows: int = 2, columns: int = 3, seed: int = 0, cell_mm: float = CELL_MM, phi_target: float = 0.0
) -> Assembly:
    """Pieces of a random pinwheel with an ear and a hole on every node that two panels share."""
    deployment = pinwheel(rows, columns, seed)
    panels, tables = deployment.panels(math.pi) * cell_mm, deployment.topology
    scale = cell_mm / CELL_MM
    ear, hole, clearance = scale * EAR_MM, scale * HOLE_MM, scale * CLEARANCE_MM
    owners: dict[int, list[tuple[int, int, int]]] = {}
    for (row, column, corner), node in np.ndenumerate(tables.panel_nodes):
        owners.setdefault(int(node), []).append((row, column, corner))
    shared = {node: found for node, found in owners.items() if len(found) == 2}
    hinged = {place for found in shared.values() for place in found}
    pieces, names, counts = [], {}, [0, 0]
    for row, column in np.ndindex(rows + 1, columns + 1):
        layer = 1 + (row + column) % 2
        counts[layer - 1] += 1
        names[row, column] = f"{'AB'[layer - 1]}{counts[layer - 1]}"
        corners = panels[row, column] - panels[row, column].mean(axis=0)
        ends = [corners[corner] for corner in range(4) if (row, column, corner) in hinged]
        arms = [LineString([(0.0, 0.0), end]).buffer(0.5 * ear, quad_segs=8) for end in ends]
        middle = Polygon(corners).buffer(-0.5 * ear - clearance)
        area = shapely.union_all([middle, *arms])
        assert isinstance(area, Polygon) and not len(area.interiors)
        pieces.append(
            Piece(
                names[row, column],
                layer,
                (row, column),
                shapely.get_coordinates(shapely.orient_polygons(area).exterior)[:-1],
                tuple(RoundHole(end, hole) for end in ends),
            )
        )
    hinges = []
    for node, found in shared.items():
        sides = sorted(found, key=lambda place: (place[0] + place[1]) % 2)
        at = tuple(panels[place] - panels[place[:2]].mean(axis=0) for place in sides)
        hinges.append(Hinge((names[sides[0][:2]], names[sides[1][:2]]), at, node))
    return Assembly(deployment, cell_mm, phi_target, tuple(pieces), tuple(hinges))
