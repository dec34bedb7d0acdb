"""Finished connector widths: what is asked for is what is left after the kerf."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from shapely.geometry import LineString, Polygon

from kirigami_studio.fabricate.cut_plan import CutPlan, Layer, plan_cuts
from kirigami_studio.fabricate.options import STRAIGHT
from kirigami_studio.fabricate.slits import SHEET_EDGE
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment
from tests.refusals import refused

MakeDesign = Callable[..., Deployment]


def burned_distances(plan: CutPlan) -> np.ndarray:
    """Distance of each hinge between the cuts as the beam leaves them: round ended bands, by shapely alone."""
    bands = {
        path.cut: LineString(path.points).buffer(0.5 * plan.kerf_mm, quad_segs=48)
        for path in plan.paths
        if not path.closed
    }
    outline = LineString(plan.on_layer(Layer.OUTLINE)[0].travelled).buffer(0.5 * plan.kerf_mm, join_style="mitre")
    hinges = plan.hinges
    return np.array(
        [
            bands[int(cut)].distance(outline if through == SHEET_EDGE else bands[int(through)])
            for cut, through in zip(hinges.cut, hinges.through, strict=True)
        ]
    )


@pytest.mark.parametrize(("rows", "columns", "width"), [(4, 5, 60.0), (10, 10, 100.0), (3, 8, 200.0)])
@pytest.mark.parametrize(("connector", "kerf"), [(0.2, 0.02), (0.3, 0.15), (0.5, 0.001)])
def test_that_every_finished_connector_is_as_wide_as_asked_within_a_micrometre(
    rows: int, columns: int, width: float, connector: float, kerf: float, make_design: MakeDesign
) -> None:
    for seed in range(3):
        plan = plan_cuts(make_design(rows, columns, seed), width, connector_mm=connector, kerf_mm=kerf)
        finished = burned_distances(plan)
        np.testing.assert_allclose(finished, connector, atol=1e-3)
        np.testing.assert_allclose(plan.hinges.finished_mm, finished, atol=1e-4)


def test_that_a_24_x_24_sheet_keeps_its_connectors_too(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(24, 24, seed=5), 100.0, connector_mm=0.2, kerf_mm=0.02)
    np.testing.assert_allclose(burned_distances(plan), 0.2, atol=1e-3)


def test_that_finished_widths_do_not_change_with_the_kerf(make_design: MakeDesign) -> None:
    design = make_design(5, 5, seed=2)
    for kerf in (0.0, 0.05, 0.3):
        plan = plan_cuts(design, 120.0, connector_mm=0.4, kerf_mm=kerf)
        np.testing.assert_allclose(plan.hinges.finished_mm, 0.4, atol=1e-3)
        assert plan.size_mm == pytest.approx((120.0, 120.0))


def test_that_a_single_hinge_can_be_wider_than_the_rest(make_design: MakeDesign) -> None:
    plan = plan_cuts(
        make_design(4, 4),
        connector_mm=0.5,
        kerf_mm=0.1,
        options=replace(STRAIGHT, hinge_mm=((7, 1.25),)),
    )
    expected = np.full(len(plan.hinges), 0.5)
    expected[7] = 1.25
    np.testing.assert_allclose(burned_distances(plan), expected, atol=1e-3)
    assert plan.min_connector_mm == pytest.approx(0.5, abs=1e-3)


def test_that_a_cut_without_room_for_its_connectors_is_named_with_its_length_and_the_remedy(
    make_design: MakeDesign,
) -> None:
    design = make_design(6, 6, spread=0.0)
    with pytest.raises(FabricationError) as refusal:
        plan_cuts(design, 20.0, connector_mm=3.0, kerf_mm=0.1)
    sentence = str(refusal.value)
    assert re.search(
        r"edge cut at the void in row \d, column \d is 2\.86 mm long, but a connector of 3 mm and a kerf of 0\.1 mm",
        sentence,
    )
    factor = float(sentence.split("at least ")[1].split(" times")[0])
    plan_cuts(design, 20.0 * factor, connector_mm=3.0, kerf_mm=0.1)


@pytest.mark.parametrize("value", [0.0, -0.2, math.nan, math.inf, "wide", None])
def test_that_an_impossible_connector_width_is_refused(value: object, make_design: MakeDesign) -> None:
    with refused(FabricationError, "hinge.width_not_positive", hinge=3):
        plan_cuts(make_design(3, 3), options=replace(STRAIGHT, hinge_mm=((3, value),)))  # type: ignore[arg-type]
    if value is not None:
        with refused(FabricationError, "connector.width_not_positive"):
            plan_cuts(make_design(3, 3), connector_mm=value)  # type: ignore[arg-type]


def test_that_an_unknown_hinge_is_refused(make_design: MakeDesign) -> None:
    with refused(FabricationError, "hinge.unknown", hinge=999):
        plan_cuts(make_design(3, 3), options=replace(STRAIGHT, hinge_mm=((999, 1.0),)))


def test_that_connectors_that_come_out_wider_are_said(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(10, 10, seed=24, spread=0.9), 100.0, connector_mm=1.2, kerf_mm=0.1)
    wider = plan.hinges.finished_mm > 1.2 + 1e-3
    assert plan.hinges.finished_mm.min() > 1.2 - 1e-3
    assert any(note.code == "plan.connectors_wider" for note in plan.notes) == bool(wider.any())
    assert wider.any()


def test_that_the_finished_sheet_has_the_size_asked_for(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(3, 5), 80.0, kerf_mm=0.3)
    burned = Polygon(plan.on_layer(Layer.OUTLINE)[0].points).buffer(-0.15, join_style="mitre")
    left, bottom, right, top = burned.bounds
    assert (right - left, top - bottom) == pytest.approx((80.0, 80.0 * 4 / 6), abs=2e-4)
