"""Targets with holes: what is scored, what a trim cuts out of the sheet, and what it leaves closed."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
import shapely.affinity
from shapely.geometry import Point, Polygon, box

from kirigami_studio.evaluate.kept_panels import all_panels
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.siou import iou_of_area, siou_of_many
from kirigami_studio.evaluate.trimming import Trim, trim
from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.cut_path import Layer
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.turning import turn_back

GRID = (7, 7)


def frame(half: float, x: float = 0.0, y: float = 0.0) -> Outline:
    """A square of area 1 with a square hole, 2 ``half`` wide."""
    hole = shapely.get_coordinates(box(x - half, y - half, x + half, y + half))[:-1]
    return Outline.from_points(shapely.get_coordinates(box(-0.5, -0.5, 0.5, 0.5))[:-1], holes=[hole])


@pytest.fixture(scope="module")
def sheet() -> Deployment:
    return deploy(RatioField(np.ones(GRID)))


def laid(sheet: Deployment) -> Similarity:
    """The pose in which the closed uniform sheet fills the square."""
    (match,) = siou_of_many([sheet.outline(0.0)], frame(0.2).filled)
    return match.transform


@pytest.fixture(scope="module")
def cut(sheet: Deployment) -> Trim:
    return trim(sheet, frame(0.22), 0.0, laid(sheet))


def shown(sheet: Deployment, made: Trim) -> Polygon:
    parts = PosedDesign(sheet, made.pose, 0.0, made).parts(0.0)
    whole: Polygon = shapely.union_all([Polygon(part) for part in parts], grid_size=1e-8).buffer(1e-6).buffer(-1e-6)
    return whole


def test_that_a_hole_counts_in_exact_and_raster_iou(sheet: Deployment) -> None:
    (filled,), (open_,) = (siou_of_many([sheet.outline(0.0)], one) for one in (frame(0.2).filled, frame(0.2)))
    assert filled.iou_exact > 0.99 and open_.iou_exact == pytest.approx(1.0 - 0.4**2, abs=0.01)
    assert open_.siou == pytest.approx(open_.iou_exact, abs=0.01)


def test_that_a_target_with_a_hole_is_trimmed_with_the_hole_open(sheet: Deployment, cut: Trim) -> None:
    assert cut.deep and cut.given_up > 0 and not cut.closed_holes
    assert cut.untrimmed_iou < 0.85 < 0.97 < cut.iou
    assert cut.holes[0].open > 0.95


def test_that_the_match_of_a_trim_is_that_of_its_parts(sheet: Deployment, cut: Trim) -> None:
    area, target = shown(sheet, cut), frame(0.22).polygon
    assert area.geom_type == "Polygon" and len(area.interiors) == 1
    common = area.intersection(target).area
    assert cut.iou == pytest.approx(common / (area.area + target.area - common), abs=1e-4)


def test_that_a_hole_that_was_moved_gives_another_trim(sheet: Deployment, cut: Trim) -> None:
    other = trim(sheet, frame(0.22, 0.15), 0.0, cut.pose)
    assert other != cut
    assert shown(sheet, other).intersection(box(0.3, -0.1, 0.33, 0.1)).area < 1e-3


def test_that_a_hole_smaller_than_a_panel_is_told_to_stay_closed(sheet: Deployment) -> None:
    made = trim(sheet, frame(0.02, 0.06, 0.06), 0.0, laid(sheet))
    (hole,) = made.closed_holes
    assert hole.is_small and hole.open < 0.1


def test_that_the_hole_is_a_contour_of_its_own_and_the_sheet_one_piece(sheet: Deployment, cut: Trim) -> None:
    plan = plan_cuts(sheet, 120.0, kept=cut.kept)
    report = check_plan(plan)
    (outline,), holes = plan.on_layer(Layer.OUTLINE), plan.on_layer(Layer.HOLES)
    assert holes and all(hole.closed for hole in holes) and plan.paths[-1] is outline
    assert report.pieces == 1 and report.ok
    inside = Polygon(outline.flattened)
    assert all(inside.contains(Polygon(hole.flattened)) for hole in holes)
    assert plan.boundary.area == pytest.approx(inside.area - sum(Polygon(hole.flattened).area for hole in holes))


def test_that_no_cut_lies_in_a_hole(sheet: Deployment, cut: Trim) -> None:
    plan = plan_cuts(sheet, 120.0, kept=cut.kept)
    missing = shapely.union_all([Polygon(hole.flattened).buffer(-0.5) for hole in plan.on_layer(Layer.HOLES)])
    lines = [shapely.LineString(path.travelled) for path in plan.inner]
    assert sum(line.intersection(missing).length for line in lines) == 0.0


def test_that_an_area_is_scored_with_openings_in_holes_of_its_target_alone() -> None:
    target = frame(0.2)
    right, wrong = box(-0.5, -0.5, 0.5, 0.5) - box(-0.2, -0.2, 0.2, 0.2), Point(0.35, 0.35).buffer(0.05)
    assert iou_of_area(right, target) == pytest.approx(1.0, abs=1e-6)
    assert iou_of_area(right - wrong, target) == pytest.approx(1.0, abs=1e-6)
    assert iou_of_area(right, target.filled) > 0.99


def test_that_a_hole_does_not_make_a_shape_turn_back() -> None:
    assert turn_back(frame(0.2)).angle == turn_back(frame(0.2).filled).angle


def test_that_an_area_with_holes_is_scored_at_the_turn_at_which_these_match() -> None:
    disc = Point(0.0, 0.0).buffer(0.5642, quad_segs=64)
    eye = shapely.get_coordinates(Point(0.0, 0.3).buffer(0.12).exterior)[:-1]
    target = Outline.from_points(shapely.get_coordinates(disc.exterior)[:-1], holes=[eye])
    shown = shapely.affinity.rotate(target.polygon, 171.0, origin=(0.0, 0.0))
    assert iou_of_area(shown, target) > 0.99


def test_that_no_rim_runs_into_a_slit_near_a_connector_that_rests_on_it_from_beyond() -> None:
    uneven = deploy(RatioField.from_log10(0.2 * np.random.default_rng(3).normal(size=GRID)))
    target, keep = frame(0.22), 0.1
    (match,) = siou_of_many([uneven.outline(0.0)], target.filled)
    made, table = trim(uneven, target, 0.0, match.transform, keep), all_panels(*GRID)
    places, there = uneven.compact, np.zeros(uneven.topology.node_count, dtype=np.intp)
    parts = [Polygon(places[table.corners[k]] if part is None else part) for k, part in enumerate(made.kept)]
    for k, part in enumerate(parts):
        reached = [not part.is_empty and part.distance(Point(places[node])) < 0.02 for node in table.corners[k]]
        np.add.at(there, table.corners[k][reached], 1)
    tried = 0
    for k in np.flatnonzero([part is not None and len(part) > 0 for part in made.kept]):
        side = Polygon(places[table.corners[k]]).exterior
        for guest in table.guests[k][table.guests[k] >= 0]:
            near = side.intersection(Point(places[guest]).buffer(0.95 * keep))
            if there[guest] == 2 and near.length > 0.0:
                covered = near.intersection(parts[k].buffer(1e-6)).length / near.length
                assert covered < 0.02 or covered > 0.98
                tried += 1
    assert tried > 10
