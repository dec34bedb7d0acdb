"""Room for centred connectors: ratios move, the closed silhouette stays, and the sheet closes at full width."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from cut_sheets import bitten, mouths

from kirigami_studio.evaluate.siou import siou_of_many
from kirigami_studio.fabricate.centred import LEAST_SHARE
from kirigami_studio.fabricate.centres import void_hinges
from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.cut_plan import CutPlan, largest_move, plan_cuts
from kirigami_studio.fabricate.making_room import FACING_SPANS, ROUNDS, with_room
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.foundation.errors import Cancelled, FabricationError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.mechanics.closing import closing
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.redesign import Room
from kirigami_studio.studio.as_cut import planned_sheet

MakeDesign = Callable[..., Deployment]
WIDTH = 100.0


def planned(design: Deployment, connector: float) -> CutPlan:
    return plan_cuts(design, WIDTH, connector, options=CutOptions(style=ConnectorStyle.CENTRED))


def facing_mm(design: Deployment) -> np.ndarray:
    """Distances of the two connectors on every slit."""
    table = cut_table(*design.sheet.grid)
    flat = design.compact * WIDTH / float(np.ptp(design.compact[:, 0]))
    place = flat[table.hinge_node]
    pairs = [np.flatnonzero(table.hinge_through == cut) for cut in range(table.slit_count)]
    return np.array([np.linalg.norm(place[one] - place[other]) for one, other in pairs])


def test_that_facing_connectors_get_room_and_the_silhouette_stays(make_design: MakeDesign) -> None:
    design = make_design(6, 6, seed=1, spread=0.2)
    table, span = cut_table(6, 6), 0.52
    made = with_room(design, WIDTH, np.full(table.hinge_count, span), table)
    assert facing_mm(design).min() < 0.2 and facing_mm(made).min() >= FACING_SPANS * span - 1e-3
    (score,) = siou_of_many([made.outline(0.0)], Outline.from_points(design.outline(0.0)))
    assert score.iou_exact > 0.995


def test_that_an_even_sheet_stays_nearly_a_square() -> None:
    design, table = deploy(RatioField.uniform(8, 8)), cut_table(8, 8)
    made = with_room(design, WIDTH, np.full(table.hinge_count, 0.52), table)
    assert facing_mm(made).min() >= FACING_SPANS * 0.52 - 3e-3
    (score,) = siou_of_many([made.outline(0.0)], Outline.from_points(design.outline(0.0)))
    assert score.iou_exact > 0.99


def test_that_connectors_wider_than_all_cuts_are_long_are_refused_before_a_search(make_design: MakeDesign) -> None:
    design, rounds = make_design(6, 6, seed=1, spread=0.2), []
    table = cut_table(6, 6)
    assert with_room(design, WIDTH, np.full(table.hinge_count, 15.0), table, (), lambda: rounds.append(1)) is design
    assert not rounds
    with pytest.raises(FabricationError, match="connector of 15 mm"):
        planned(design, 15.0)


def test_that_a_width_that_no_share_of_its_room_fits_is_tried_twice(make_design: MakeDesign) -> None:
    design, rounds = make_design(6, 6, seed=1, spread=0.2), []
    table = cut_table(6, 6)
    assert with_room(design, WIDTH, np.full(table.hinge_count, 9.0), table, (), lambda: rounds.append(1)) is design
    assert 0 < len(rounds) <= 2 * ROUNDS


@pytest.mark.parametrize(("seed", "span", "share", "most"), [(1, 3.7, 0.4, 36), (2, 2.6, 0.6, 36)])
def test_that_searches_without_prospects_end_early_and_the_largest_share_that_fits_is_found(
    seed: int, span: float, share: float, most: int, make_design: MakeDesign
) -> None:
    """Rounds are the work: those of broad connectors on many voids took up to 50, and a minute."""
    design, rounds = make_design(7, 7, seed=seed, spread=0.1), []
    table = cut_table(7, 7)
    made = with_room(design, WIDTH, np.full(table.hinge_count, span), table, (), lambda: rounds.append(1))
    assert facing_mm(made).min() == pytest.approx(FACING_SPANS * share * span, rel=5e-3)
    assert len(rounds) <= most


def test_that_sheets_with_room_are_left_alone(make_design: MakeDesign) -> None:
    design = make_design(5, 6, seed=1, spread=0.4)
    table = cut_table(5, 6)
    assert with_room(design, 300.0, np.full(table.hinge_count, 0.05), table) is design
    assert planned(deploy(RatioField(np.full((4, 4), 2.0))), 0.2).made is None


@pytest.mark.parametrize("seed", [1, 2])
def test_that_sheets_of_wide_connectors_close_without_stretch(seed: int, make_design: MakeDesign) -> None:
    design = make_design(5, 5, seed=seed, spread=0.25)
    plan = planned(design, 0.8)
    assert plan.made is not None and not plan.hinges.narrowed.size
    found = closing(planned_sheet(design, plan, WIDTH))
    assert found.jam_phi() == 0.0 and math.degrees(found.phi.min()) < 2.1
    assert found.stretch.max() < 0.05
    assert check_plan(plan).ok


def test_that_removed_connectors_need_no_room(make_design: MakeDesign) -> None:
    design = make_design(4, 4, seed=3, spread=0.05)
    table = cut_table(4, 4)
    cut = int(np.argmin(facing_mm(design)))
    gone = int(np.flatnonzero(table.hinge_through == cut)[0])
    made = with_room(design, WIDTH, np.full(table.hinge_count, 0.5), table, (gone,))
    free = ~np.any(void_hinges(table) == gone, axis=1)
    assert facing_mm(made)[free].min() > FACING_SPANS * 0.5 - 1e-3 > facing_mm(made)[cut]


def test_that_what_has_no_room_is_narrower_and_listed(make_design: MakeDesign) -> None:
    plan = planned(make_design(8, 8, seed=4, spread=0.9), 2.2)
    narrowed = plan.hinges.narrowed
    (note,) = (note for note in plan.notes if note.code == "plan.connectors_narrowed")
    assert narrowed.size == note.fields["count"] > 0
    assert plan.hinges.requested_mm.min() >= LEAST_SHARE * 2.2 - 1e-9
    assert (plan.hinges.finished_mm - plan.hinges.requested_mm).min() > -1e-3
    np.testing.assert_array_equal(plan.hinges.asked_mm, 2.2)
    assert f"instead of {2.2:.3f} mm" in note.text


def test_that_a_plan_tells_by_how_much_the_sheet_is_not_the_design(make_design: MakeDesign) -> None:
    design = make_design(5, 5, seed=1, spread=0.25)
    plan = planned(design, 0.8)
    (note,) = (note for note in plan.notes if note.code == "plan.room_made")
    made = plan.cut_from(design)
    panels = [
        sheet.compact[sheet.topology.panel_nodes.reshape(-1, 4)] * (WIDTH / float(np.ptp(sheet.compact[:, 0])))
        for sheet in (design, made)
    ]
    apart = panels[1] - panels[0]
    moved = float(str(note.fields["moved_mm"]))
    # The two sheets may lie anywhere to each other; half of what corners move apart is the least of all largest moves.
    assert 0.5 * np.ptp(apart.reshape(-1, 2), axis=0).max() <= moved <= 2.0 * np.ptp(apart.reshape(-1, 2), axis=0).max()
    assert f"up to {moved:.2f} mm" in note.text and moved == largest_move(design, made, WIDTH) > 0.1
    assert not [note for note in planned(design, 0.05).notes if note.code == "plan.room_made"]


def test_that_crowded_trimmed_sheets_are_cut_as_designed_and_told(make_design: MakeDesign) -> None:
    design = make_design(5, 5, seed=1, spread=0.25)
    kept = bitten(design, mouths(design), 0.2)
    for connector, crowded in ((0.8, True), (0.02, False)):
        plan = plan_cuts(design, WIDTH, connector, options=CutOptions(style=ConnectorStyle.CENTRED), kept=kept)
        assert plan.made is None and plan.cut_from(design) is design
        assert [note.code for note in plan.notes].count("plan.no_room_made_in_trimmed") == crowded
        assert (planned(design, connector).made is not None) == crowded


@pytest.mark.parametrize("asked", [1, 3, 5])
def test_that_planning_stops_when_it_is_asked_to_even_while_room_is_made(make_design: MakeDesign, asked: int) -> None:
    """The first questions are asked while ratios are looked for."""
    questions = iter([False] * (asked - 1) + [True])
    with pytest.raises(Cancelled) as caught:
        plan_cuts(
            make_design(6, 6, seed=1, spread=0.25),
            WIDTH,
            0.8,
            options=CutOptions(style=ConnectorStyle.CENTRED),
            cancel=lambda: next(questions),
        )
    assert caught.value.code == "plan.stopped"
    assert next(questions, None) is None


def test_that_room_for_a_fit_is_called_off_between_rounds(make_design: MakeDesign) -> None:
    design, asked = make_design(6, 6, seed=1, spread=0.2), []
    room = Room(WIDTH, 9.0)
    assert room.made(design, lambda: bool(asked.append(1)) or len(asked) > 2) is design
    assert len(asked) == 3
