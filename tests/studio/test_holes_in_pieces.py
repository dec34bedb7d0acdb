"""Targets with holes on pins, on a backed sheet and in print: panels go, pieces are cut along the hole, files agree."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely
from piece_reader import put_together
from shapely.geometry import Point, Polygon, box
from shapely.geometry.base import BaseGeometry
from solid_reader import read_stl

from kirigami_studio.assembly.cut_away import kept_voids, rim_loops
from kirigami_studio.assembly.motion import LayerMotion, freedom
from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.evaluate.kept_panels import all_panels
from kirigami_studio.evaluate.notches import hinges_of
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.evaluate.trimming import trim
from kirigami_studio.foundation.steps import never
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Document
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import material_for, new_settings
from kirigami_studio.studio.assembling import Assembled, assembled
from kirigami_studio.studio.cutting import kerf_mm
from kirigami_studio.studio.making import CutRequest, Output, exporting
from tests.unit.assembly.pinned_designs import bodies_at

WIDTH_MM = 180.0
PLYWOOD: dict[str, object] = {"material": "plywood-co2"}
#: Holes near the rim take of the flat outline, too.
SPOILT = "pinned.flat_outline_spoilt"
HOLES: dict[str, list[BaseGeometry]] = {
    "ring": [Point(0.0, 0.0).buffer(0.22)],
    "D": [Point(-0.12, 0.0).buffer(0.28).intersection(box(-0.12, -1.0, 1.0, 1.0))],
    "8": [Point(0.0, 0.24).buffer(0.14), Point(0.0, -0.23).buffer(0.16)],
}


def square_with(*holes: BaseGeometry) -> Outline:
    rings = [shapely.get_coordinates(hole)[:-1] for hole in holes]
    return Outline.from_points(shapely.get_coordinates(box(-0.5, -0.5, 0.5, 0.5))[:-1], "square", holes=rings)


def pinwheel(target: Outline, count: int = 4) -> Candidate:
    """A sheet whose panels alternate in size, over a square with holes."""
    sheet = Sheet(RatioField(10 ** (0.2 * (-1.0) ** np.add.outer(range(count), range(count)))))
    return Candidate(sheet, evaluate(deploy(sheet), target), 0, 0)


def document(name: str, choices: dict[str, object], trimmed: bool = False, count: int = 4) -> Document:
    target = square_with(*HOLES[name])
    candidate = pinwheel(target, count)
    if trimmed:
        cut = trim(deploy(candidate.sheet), target, 0.0, candidate.score.transform, keep=0.2)
        candidate = replace(candidate, trim=cut)
    settings = new_settings({"width_mm": WIDTH_MM, **choices})
    return Document(target, DesignSettings(), (candidate,), 0, fabrication=settings)


@cache
def made(name: str) -> Assembled:
    """The pieces of plywood for one of the shapes."""
    found = document(name, PLYWOOD)
    assert found.target is not None
    return assembled(found.candidates[0], found.fabrication, found.target)


def united(record: dict, step: dict) -> BaseGeometry:
    """All pieces of a ``pieces.json`` at one of its angles, pin holes filled: NumPy and shapely alone."""
    placed = []
    for piece in record["pieces"]:
        x, y, turn = step["poses"][piece["id"]]
        turned = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
        openings = [ring for ring in piece["holes"] if Polygon(ring).area > 30.0]
        rings = [np.array(ring) @ turned.T + (x, y) for ring in (piece["outline"], *openings)]
        placed.append(Polygon(rings[0], rings[1:]))
    return shapely.union_all(placed)


@pytest.mark.parametrize("name", HOLES)
def test_that_pieces_leave_the_holes_of_their_target_open_and_move_in_one_way(name: str) -> None:
    found = made(name)
    report, assembly = found.report, found.assembly
    assert not report.problems or (name == "8" and [one.code for one in report.problems] == [SPOILT])
    assert report.figures.match > 0.97 and report.figures.overlap_mm2 < 0.01
    assert report.figures.wall_mm > found.plan.options.asked_wall_mm - 0.03
    assert len(assembly.hinges) <= 36
    assert all(Polygon(piece.outline, piece.openings).is_valid for piece in assembly.pieces)
    panels = all_panels(4, 4).at(assembly.numbers, all_panels(4, 4).hinged)
    motion = LayerMotion.of(assembly.deployment, assembly.cell_mm, 0.0, panels=panels)
    pinned = np.isin(motion.nodes, [hinge.node for hinge in assembly.hinges])
    assert freedom(replace(motion, hinged=motion.hinged & pinned)) == 1


@pytest.mark.parametrize("name", ["ring", "8"])
def test_that_written_pieces_show_the_holes_and_never_overlap_in_their_layer(name: str, tmp_path: Path) -> None:
    choices = document(name, PLYWOOD)
    *_, found = exporting(CutRequest.of(choices), Output(tmp_path / "x.dxf"), True, never)
    assert found.ok and found.verdict is not None and found.verdict.read
    record = json.loads((tmp_path / "x" / "pieces.json").read_text())
    plan = made(name).plan
    whole = united(record, next(step for step in record["motion"] if step["phi_deg"] == 0.0))
    holes = shapely.union_all([Polygon(ring) for ring in plan.opened.interiors])
    rings = [Polygon(ring) for part in shapely.get_parts(whole) for ring in part.interiors]
    silhouette = shapely.union_all([Polygon(part.exterior) for part in shapely.get_parts(whole)])
    silhouette = silhouette.difference(shapely.union_all([ring for ring in rings if ring.intersects(holes)]))
    shared = silhouette.intersection(plan.opened).area
    match = shared / (silhouette.area + plan.opened.area - shared)
    assert match == pytest.approx(made(name).report.figures.match, abs=1e-4)
    assert holes.intersection(whole).area < 0.15 * holes.area
    if name == "ring":
        thinned = record | {"motion": record["motion"][::9]}
        (tmp_path / "x" / "pieces.json").write_text(json.dumps(thinned))
        together = put_together(tmp_path / "x", ".dxf", kerf_mm(choices.fabrication, material_for(choices.fabrication)))
        assert together.pieces == len(record["pieces"]) and together.outline_mm < 0.01
        assert together.pins_mm < 1e-3 and together.overlap_mm2 < 0.01


def test_that_the_flat_sheet_is_open_where_panels_went_and_keeps_its_outline() -> None:
    found = made("ring")
    flat = shapely.union_all([body for _, body in bodies_at(found.assembly, math.pi)])
    gone = 25 - len(found.assembly.pieces)
    assert found.plan.flat.area - flat.area > 0.5 * gone * found.plan.flat.area / 25.0 > 0.0
    assert found.report.figures.flat_match > 0.97


def test_that_a_hole_that_pieces_cannot_leave_open_is_told_with_its_place() -> None:
    whole = pinwheel(square_with(), 3)
    middle = whole.score.transform.apply(deploy(whole.sheet).panels(0.0)[1, 1].mean(axis=0))
    target, settings = square_with(Point(middle).buffer(0.012)), new_settings(PLYWOOD | {"width_mm": 160.0})
    found = assembled(pinwheel(target, 3), settings, target)
    (problem,) = [one for one in found.report.problems if one.code == "pinned.hole_too_small"]
    assert (problem.fields["count"], problem.fields["total"]) == (1, 1)
    assert problem.where is not None and found.plan.flat.contains(Point(problem.where))
    assert len(found.assembly.pieces) == 16 and found.report.figures.match > 0.97


def test_that_a_cover_on_pins_is_made_without_the_panels_that_it_gives_up() -> None:
    notched = box(-0.5, -0.5, 0.5, 0.5).difference(box(-0.18, 0.05, 0.18, 1.0))
    target = Outline.from_points(shapely.get_coordinates(shapely.orient_polygons(notched))[:-1], "notch")
    whole = deploy(pinwheel(square_with()).sheet)
    pose = evaluate(whole, square_with(), 0.0).transform
    low, high = target.points.min(axis=0), target.points.max(axis=0)
    x, y = (high - low)[0] * np.array(pose.shift) + 0.5 * (low + high)
    pose = replace(pose, scale=pose.scale * (high - low)[0], shift=(x, y))
    cut = trim(whole, target, 0.0, pose, keep=0.2, deep=True)
    cover = Candidate(whole.sheet, evaluate(whole, target), 0, 0, trim=cut, origin=Origin.COVERED)
    found = assembled(cover, new_settings(PLYWOOD | {"width_mm": WIDTH_MM}), target)
    assert len(found.assembly.pieces) == 25 - cut.given_up < 25
    assert found.report.figures.match > cut.iou > cut.untrimmed_iou + 0.1
    assert found.report.figures.overlap_mm2 < 0.01 and [one.code for one in found.report.problems] == [SPOILT]


def test_that_rims_of_holes_are_loops_of_sides_that_border_no_void() -> None:
    voids, every = np.ones((6, 6), dtype=np.bool_), all_panels(6, 6)
    voids[1:3, 1:3] = voids[3:5, 4] = voids[0, 5] = False
    hinged = hinges_of(voids)
    panels = every.at(np.flatnonzero(hinged.any(axis=1)), hinged)
    assert np.array_equal(kept_voids(panels, (6, 6)), voids)
    design, loops, areas = deploy(RatioField(np.full((6, 6), 1.3))), rim_loops(panels), []
    for loop in loops:
        x, y = design.nodes(1.0)[panels.corners[loop[:, 0], loop[:, 1]]].T
        areas.append(0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))))
    assert sorted(area > 0.0 for area in areas) == [False, False, True]
    assert sum(map(len, loops)) + 4 * int(voids.sum()) == panels.corners.size
    (whole,) = rim_loops(every)
    corners = every.corners[whole[:, 0], whole[:, 1]].tolist()
    outline = design.topology.outline_nodes.tolist()
    first = outline.index(corners[0])
    assert corners == [*outline[first:], *outline[:first]]


def test_that_tiles_lie_on_the_panels_that_a_trim_leaves(tmp_path: Path) -> None:
    choices = document("ring", PLYWOOD | {"construction": "backed"}, trimmed=True)
    trimmed = choices.candidates[0].trim
    assert trimmed is not None and not trimmed.closed_holes
    *_, found = exporting(CutRequest.of(choices), Output(tmp_path / "x.dxf"), True, never)
    assert found.ok
    record = json.loads((tmp_path / "x" / "pieces.json").read_text())
    tiles = [piece for piece in record["pieces"] if piece["id"] != "FRAME"]
    assert len(tiles) == 25 - trimmed.given_up < 25
    flat = next(step for step in record["motion"] if step["phi_deg"] == 180.0)
    tiled = united(record | {"pieces": tiles}, flat)
    panels = deploy(trimmed.sheet).panels(math.pi).reshape(-1, 4, 2)
    left = [whole if part is None else part for whole, part in zip(panels, trimmed.kept, strict=True)]
    kept = shapely.union_all([Polygon(part) for part in left if len(part)])
    scale = WIDTH_MM / np.ptp(shapely.get_coordinates(kept)[:, 0])
    assert 0.6 < tiled.area / (kept.area * scale**2) < 1.0


@pytest.mark.parametrize("kind", ["sheet", "tiles", "pins"])
def test_that_prints_of_a_ring_are_watertight(kind: str, tmp_path: Path) -> None:
    choices: dict[str, object] = {
        "sheet": {"material": "tpu-print"},
        "tiles": PLYWOOD | {"construction": "backed"},
        "pins": {"construction": "printed"},
    }[kind]
    found = document("ring", choices, trimmed=kind != "pins", count=3 if kind == "pins" else 4)
    *_, written = exporting(CutRequest.of(found), Output(tmp_path / "x.stl"), True, never)
    places = sorted(tmp_path.rglob("*.stl"))
    assert written.ok and places
    for place in places:
        body = read_stl(place)
        assert body.closed and body.volume > 0.0
