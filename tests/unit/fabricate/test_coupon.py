"""The calibration coupon: one piece, connectors as wide as written, and a kerf from what is measured on it."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import shapely
from shapely.geometry import LineString, Polygon

from kirigami_studio.export.dxf import write_dxf
from kirigami_studio.export.dxf_check import check_file
from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.coupon import (
    COMB_SLITS,
    FLAP_WIDTHS_MM,
    kerf_from_gaps,
    ligament_rungs,
    plan_coupon,
)
from kirigami_studio.fabricate.cut_path import Layer
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.finished_sheet import remaining_pieces
from kirigami_studio.fabricate.material import find_material, presets
from kirigami_studio.foundation.errors import FabricationError
from tests.refusals import refused


def flaps(plan: CutPlan) -> list[tuple[LineString, LineString]]:
    """Each path round a flap with the slit at its fourth side."""
    slits = [LineString(path.points) for path in plan.on_layer(Layer.SLITS)]
    arms = [slit for slit in slits if len(slit.coords) == 4]
    level = [slit for slit in slits if len(slit.coords) == 2 and slit.bounds[1] == slit.bounds[3]]
    return [(arm, next(slit for slit in level if arm.convex_hull.contains(slit))) for arm in arms]


@pytest.mark.parametrize("key", presets())
def test_that_the_coupon_is_one_piece_with_nothing_wrong(key: str) -> None:
    plan = plan_coupon(find_material(key))
    report = check_plan(plan)
    assert report.pieces == 1
    assert report.ok and not report.problems
    assert report.overlap_mm == 0.0
    assert plan.paths[-1].layer is Layer.OUTLINE and plan.paths[-1].closed
    assert plan.min_connector_mm == plan.connector_mm == ligament_rungs(plan.material)[0]
    times = max(1.0, plan.material.min_ligament_mm)
    assert plan.size_mm == pytest.approx((60.0 * times, 40.0 * times))
    assert max(plan.bounds_mm[0] - plan.size_mm[0], plan.bounds_mm[1] - plan.size_mm[1]) < 1.0


@pytest.mark.parametrize("key", presets())
def test_that_finished_connectors_are_as_wide_as_the_rungs_say(key: str) -> None:
    plan = plan_coupon(find_material(key))
    rungs = ligament_rungs(plan.material)
    pairs = flaps(plan)
    assert len(pairs) == len(FLAP_WIDTHS_MM) * len(rungs)
    burned = 0.5 * plan.kerf_mm
    for arm, slit in pairs:
        finished = arm.distance(slit) - 2.0 * burned
        assert min(abs(finished - rung) for rung in rungs) < 2e-4
        ends = [shapely.Point(end).distance(arm) for end in slit.coords]
        assert ends[0] == pytest.approx(ends[1], abs=2e-4)
    by_column = sorted(pairs, key=lambda pair: round(pair[0].envelope.centroid.x, 1))
    assert np.all(np.diff([arm.distance(slit) for arm, slit in by_column]) > -1e-4)


def test_that_rungs_lie_round_the_smallest_ligament_of_the_material() -> None:
    for material in presets().values():
        rungs = ligament_rungs(material)
        assert material.min_ligament_mm in rungs
        assert len(rungs) == 7
        assert rungs[0] >= 0.05 and rungs[-1] <= max(1.0, material.min_ligament_mm)
        assert all(1.2 < wide / narrow < 1.6 for narrow, wide in pairwise(rungs))


@pytest.mark.parametrize("kerf", [0.0, 0.02, 0.15])
def test_that_the_gap_beside_the_comb_tells_the_kerf_that_the_machine_really_had(kerf: float) -> None:
    plan = plan_coupon(find_material("pet-co2"))
    (sheet,) = remaining_pieces(Polygon(plan.paths[-1].points), [LineString(p.points) for p in plan.paths[:-1]], kerf)
    # What a ruler along the fingers misses, in the cut sheet.
    across = LineString([(0.0, 5.0), (70.0, 5.0)])
    width = np.ptp(shapely.get_coordinates(across.intersection(sheet))[:, 0])
    gap = width - across.intersection(sheet).length
    assert kerf_from_gaps([gap]).kerf_mm == pytest.approx(max(kerf, 0.002), abs=1e-6)


def test_that_readings_are_averaged_and_their_spread_is_said() -> None:
    measured = kerf_from_gaps([1.4, 1.6, 1.5])
    assert measured.kerf_mm == pytest.approx(0.15)
    assert measured.doubt_mm == pytest.approx(0.01)
    assert kerf_from_gaps([0.3], slits=3).kerf_mm == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("gaps", "expected"), [([], "at least once"), ([-1.0], "0 mm or more"), ([float("nan")], "gap")]
)
def test_that_impossible_readings_are_refused(gaps: list[float], expected: str) -> None:
    with pytest.raises(FabricationError, match=expected):
        kerf_from_gaps(gaps)


def test_that_a_larger_kerf_than_planned_is_noticed() -> None:
    plan = plan_coupon(find_material("film-uv"))
    assert check_plan(plan, kerf_mm=0.02).ok
    report = check_plan(plan, kerf_mm=0.1)
    assert report.pieces > 1
    assert not report.ok


def test_that_columns_and_rows_are_counted_by_marks() -> None:
    plan = plan_coupon(find_material("film-uv"))
    marks = [p for p in plan.on_layer(Layer.SLITS) if len(p.points) == 2 and np.ptp(p.points[:, 0]) == 0.0]
    assert len(marks) == sum(range(1, 8))
    left = [p for p in plan.on_layer(Layer.EDGE_SLITS) if np.ptp(p.points[:, 1]) == 0.0]
    assert len(left) == 1 + 2 + 3
    assert len(plan.on_layer(Layer.EDGE_SLITS)) == len(left) + COMB_SLITS


def test_that_the_coupon_becomes_a_dxf_that_passes_its_check(tmp_path: Path) -> None:
    plan = plan_coupon(find_material("card-co2"))
    write_dxf(plan, tmp_path / "coupon.dxf")
    entities = list(ezdxf.readfile(tmp_path / "coupon.dxf").modelspace())
    assert {entity.dxftype() for entity in entities} == {"LWPOLYLINE"}
    assert [entity.dxf.layer for entity in entities] == [path.layer.value for path in plan.paths]
    report = check_file(tmp_path / "coupon.dxf")
    assert report.pieces == 1
    assert report.overlap_mm == 0.0


def test_that_kerfs_and_ligaments_that_the_coupon_cannot_show_are_refused() -> None:
    with refused(FabricationError, "coupon.kerf_too_wide", kerf_mm=0.6, widest_mm=0.5):
        plan_coupon(find_material("card-co2"), 0.6)
    with refused(FabricationError, "coupon.ligament_out_of_range", key="card-co2", ligament_mm=200.0):
        plan_coupon(replace(find_material("card-co2"), min_ligament_mm=200.0))
    with refused(FabricationError, "coupon.flap_too_narrow", connector_mm=1.0, kerf_mm=0.5, flap_mm=3.5):
        plan_coupon(find_material("acrylic-co2"), 0.5)


def test_that_a_larger_coupon_takes_wider_kerfs_and_is_refused_in_its_own_millimetres() -> None:
    wide = replace(find_material("card-co2"), min_ligament_mm=2.0)
    assert plan_coupon(wide, 0.6).kerf_mm == 0.6
    with refused(FabricationError, "coupon.kerf_too_wide", kerf_mm=1.2, widest_mm=1.0):
        plan_coupon(wide, 1.2)
    with refused(FabricationError, "coupon.flap_too_narrow", connector_mm=2.0, kerf_mm=1.0, flap_mm=7.0):
        plan_coupon(wide, 1.0)


def test_that_the_note_beside_a_larger_coupon_has_the_widths_that_are_cut() -> None:
    plan = plan_coupon(find_material("felt-co2"))
    (note,) = (note for note in plan.notes if note.code == "coupon.how_to_read_ligament")
    assert note.fields["widths"].endswith(", 4.05")
    widths = sorted({round(float(np.ptp(shapely.get_coordinates(arm)[:, 0])), 3) for arm, _ in flaps(plan)})
    assert note.fields["flaps"] == ", ".join(f"{width:g}" for width in widths)
