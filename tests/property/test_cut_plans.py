"""Whatever the design, style, widths and kerf: the cut sheet is one piece and its connectors are as wide as asked."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from cut_sheets import bitten, connector_distances, covered_hinges, drawn_line, finished_pieces, mouths
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from lattice_strategies import grids, ratio_fields, sheets
from shapely.geometry import Polygon

from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.cut_plan import CutPlan, Layer, plan_cuts
from kirigami_studio.fabricate.joints import ending_on_others, touching
from kirigami_studio.fabricate.material import default_material
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Rim, Sheet

#: Half of the profile's examples: each makes and checks plans for 0.1 to 0.2 s.
FEWER = settings(max_examples=settings.default.max_examples // 2)


@dataclass(frozen=True, slots=True, eq=False)
class Wish:
    """What a plan is made from."""

    sheet: Sheet
    width_mm: float
    connector_mm: float
    kerf_mm: float
    radius_mm: float
    options: CutOptions
    bite: float

    def plan(self) -> CutPlan:
        """The plan; an impossible wish is no example."""
        design = deploy(self.sheet)
        material = replace(default_material(), relief_radius_mm=self.radius_mm, min_ligament_mm=1e-3)
        kept = bitten(design, mouths(design), self.bite) if self.bite else None
        try:
            return plan_cuts(
                design, self.width_mm, self.connector_mm, self.kerf_mm, material, options=self.options, kept=kept
            )
        except FabricationError:
            assume(False)
            raise


@st.composite
def wishes(draw: st.DrawFn, trimmed: bool = False) -> Wish:
    """Sheets of 8 to 30 mm a cell; connectors up to a seventh of that."""
    decades = 0.5 if trimmed else 0.75
    sheet = draw(st.one_of(ratio_fields(grids(5), decades).map(Sheet), sheets(5, decades, narrowest=0.5, flattest=0.8)))
    cell = draw(st.floats(8.0, 30.0))
    connector = draw(st.floats(0.05, 0.07 * cell))
    kerf = draw(st.sampled_from([0.0, 0.02, 0.15, 0.4]))
    options = CutOptions(
        style=draw(st.sampled_from(list(ConnectorStyle))),
        tabs=draw(st.integers(0, 4)),
        hinge_mm=tuple((hinge, draw(st.floats(0.05, 0.07 * cell))) for hinge in (0, 5)),
    )
    bite = draw(st.floats(0.05, 0.2)) if trimmed else 0.0
    return Wish(sheet, cell * (sheet.columns + 1), connector, kerf, draw(st.floats(0.03, 0.5)), options, bite)


@FEWER
@given(wish=wishes())
def test_that_connectors_are_as_wide_as_asked_and_the_sheet_is_one_piece(wish: Wish) -> None:
    plan = wish.plan()
    finished, there = connector_distances(plan), covered_hinges(plan)
    error = finished - plan.hinges.requested_mm
    assert np.abs(error[there]).max(initial=0.0) <= 1e-3
    assert error.min() >= -1e-3
    np.testing.assert_allclose(plan.hinges.finished_mm, finished, atol=5e-4)
    assert check_plan(plan).pieces == 1
    if plan.kerf_mm:
        assert finished_pieces(plan, plan.kerf_mm) == 1


def test_that_a_connector_beside_a_nearly_straight_corner_of_the_sheet_is_as_wide_as_asked() -> None:
    """The rim edges at a mouth turn by so little that an outline without that corner is a micrometre off."""
    corners = [(-1.57477825, -4.84368728), (-5.15221644, -1.04353254), (-2.26103317, 5.63711771)]
    corners += [(3.74885613, 3.53750315), (5.63187893, 1.63562784), (6.7705131, -1.20264103), (5.39280624, -1.80646768)]
    field = RatioField(np.array([[4.10388192, 0.29656633], [4.44050771, 3.57761954]]))
    rim = Rim(np.array([1.81768148]), np.array([1.9782498]), np.array([1.12010961]), np.array([1.29184185]))
    sheet = Sheet(field, rim, np.array(corners))
    plan = Wish(sheet, 30.0, 0.5, 0.0, 0.5, CutOptions(style=ConnectorStyle.STRAIGHT), 0.0).plan()
    assert np.abs(connector_distances(plan) - plan.hinges.requested_mm).max() <= 2e-4


@FEWER
@given(wish=wishes())
def test_that_a_kerf_wider_than_every_gap_frees_every_panel(wish: Wish) -> None:
    plan = wish.plan()
    assume(plan.hinges.finished_mm.max() - plan.hinges.requested_mm.min() < 2.0)
    report = check_plan(plan, kerf_mm=plan.kerf_mm + float(plan.hinges.finished_mm.max()) + 0.01)
    assert report.pieces != 1 and not report.ok
    assert report.min_connector_mm < 0.0


@FEWER
@given(wish=wishes(trimmed=True))
def test_that_trimmed_sheets_are_one_piece_with_no_connector_narrower_than_asked(wish: Wish) -> None:
    plan = wish.plan()
    assert (plan.hinges.finished_mm - plan.hinges.requested_mm).min() >= -1e-3
    report = check_plan(plan)
    assert report.pieces == 1
    assert not any(problem.code == "plan.connectors_narrower" for problem in report.problems)


@FEWER
@given(wish=st.one_of(wishes(), wishes(trimmed=True)))
def test_that_plans_are_finite_above_the_origin_closed_where_they_must_be_and_cut_nothing_twice(wish: Wish) -> None:
    plan = wish.plan()
    points = np.concatenate([path.points for path in plan.paths])
    assert np.all(np.isfinite(points))
    if plan.centres is None:
        assert points.min(axis=0).tolist() == [0.0, 0.0]
    else:
        drawn = np.concatenate([np.array(drawn_line(path).coords) for path in plan.paths])
        np.testing.assert_allclose(drawn.min(axis=0), 0.0, atol=3e-4)
    assert check_plan(plan).overlap_mm < 1e-6
    closed = {path.layer for path in plan.paths if path.closed}
    assert closed <= {Layer.RELIEF, Layer.OUTLINE}
    assert len(plan.on_layer(Layer.OUTLINE)) == max(1, plan.options.tabs)
    layers = [path.layer for path in plan.paths]
    assert layers == sorted(layers, key=list(Layer).index)
    assert Polygon(plan.outline).is_valid


@FEWER
@given(wish=wishes())
def test_that_cuts_meet_only_where_a_slit_ends_on_its_own_shape(wish: Wish) -> None:
    inner = [path for path in wish.plan().paths if path.layer is not Layer.OUTLINE]
    lines = [drawn_line(path) for path in inner]
    meeting = set(ending_on_others(lines))
    assert touching(lines) == meeting
    assert all(inner[one].cut == inner[other].cut for one, other in meeting)


@FEWER
@given(wish=wishes())
def test_that_finished_widths_and_panels_do_not_change_with_the_kerf(wish: Wish) -> None:
    plans = [
        replace(wish, kerf_mm=kerf, options=replace(wish.options, style=ConnectorStyle.STRAIGHT)).plan()
        for kerf in (0.0, 0.05, 0.3)
    ]
    there = np.all([covered_hinges(plan) for plan in plans], axis=0)
    for plan in plans:
        np.testing.assert_allclose(plan.hinges.finished_mm[there], plan.hinges.requested_mm[there], atol=1e-3)
        assert plan.size_mm == plans[0].size_mm
    nominal = Polygon(plans[0].outline)
    left, bottom, right, top = nominal.bounds
    np.testing.assert_allclose((right - left, top - bottom), plans[0].size_mm, atol=2e-4)
