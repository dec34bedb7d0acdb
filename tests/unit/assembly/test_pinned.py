"""Pinned designs: every piece whole, walls and necks, no collision, both outlines; each planted fault is found."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import scipy.linalg
import shapely
from threadpoolctl import threadpool_info, threadpool_limits

from kirigami_studio.assembly import rim_pieces
from kirigami_studio.assembly.checks import PinnedReport, check_pinned, neck_mm, pins_apart, wall_mm
from kirigami_studio.assembly.motion import LayerMotion, freedom
from kirigami_studio.assembly.options import PinOptions
from kirigami_studio.assembly.pieces import Piece, RoundHole
from kirigami_studio.assembly.pinned import PinnedPlan, _fewest_panels, pinned
from kirigami_studio.assembly.rim_pieces import iou, shortest_links
from kirigami_studio.assembly.shaping import Shaping, less
from kirigami_studio.evaluate.alignment import align
from kirigami_studio.evaluate.kept_panels import PanelTable, all_panels
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.arrays import IntArray
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.outlines.outline import Outline
from tests.unit.assembly.pinned_designs import bodies_at, overlap_at, pinwheel

DATA = Path(__file__).resolve().parents[2] / "data"
WIDTH_MM = 150.0
#: Of designs of 3 x 3 voids.
SMALL_MM = 120.0
#: Sizes for brads in plywood, whose pieces may stick out of the flat outline.
BRADS = PinOptions(pin_mm=1.6, ear_mm=5.6, neck_mm=2.0, head_mm=5.0, weight=0.75)
#: Angles at which pieces of one layer may not overlap; random ones, beside those of the checks.
ANGLES = np.random.default_rng(5).uniform(0.0, math.pi, 41)


@pytest.fixture(scope="module")
def plan() -> PinnedPlan:
    return pinned(*pinwheel(), WIDTH_MM)


@pytest.fixture(scope="module")
def report(plan: PinnedPlan) -> PinnedReport:
    return check_pinned(plan)


def codes(report: PinnedReport) -> set[str]:
    return {problem.code for problem in report.problems}


def test_that_a_pinwheel_has_no_problems_and_shows_both_outlines(report: PinnedReport) -> None:
    assert report.problems == ()
    assert report.figures.match > 0.99 and report.figures.flat_match > 0.98
    assert report.figures.covered > 0.985 and report.figures.flat_covered > 0.985
    assert report.figures.overlap_mm2 < 0.01


def test_that_figures_are_those_of_the_pieces_as_posed(plan: PinnedPlan, report: PinnedReport) -> None:
    for phi, outline, found in (
        (0.0, plan.opened, report.figures.match),
        (math.pi, plan.flat, report.figures.flat_match),
    ):
        united = shapely.union_all([body for _, body in bodies_at(plan.assembly, phi)])
        whole = shapely.union_all([shapely.Polygon(part.exterior) for part in shapely.get_parts(united)])
        assert found == pytest.approx(whole.intersection(outline).area / whole.union(outline).area, abs=1e-9)
    assert np.ptp(plan.flat.exterior.coords, axis=0)[0] == pytest.approx(WIDTH_MM)


@pytest.mark.parametrize("seed", [1, 2])
def test_that_pieces_of_uneven_pinwheels_are_whole_and_never_overlap_in_their_layer(seed: int) -> None:
    design, target = pinwheel(3, 4, 0.24, 0.06, seed, phi=(0.0, 0.5)[seed - 1])
    assembly = pinned(design, target, WIDTH_MM).assembly
    assert all(shapely.Polygon(piece.outline, piece.openings).is_valid for piece in assembly.pieces)
    opening = math.pi - assembly.phi_target
    assert max(overlap_at(assembly, float(math.pi - opening * share)) for share in ANGLES / math.pi) < 1e-6


def test_that_pins_stay_in_both_of_their_pieces_at_all_angles(plan: PinnedPlan) -> None:
    assembly = plan.assembly
    assert len(assembly.hinges) == 40
    for phi in (0.0, 1.0, 2.5, math.pi):
        poses = {piece.id: pose for piece, pose in zip(assembly.pieces, assembly.poses(phi), strict=True)}
        for hinge in assembly.hinges:
            places = []
            for name, (x, y) in zip(hinge.pieces, hinge.at, strict=True):
                left, up, turn = poses[name]
                places.append(complex(left, up) + complex(x, y) * np.exp(1j * turn))
                holes = [hole.centre for hole in assembly.by_id[name].holes]
                assert np.min(np.abs(np.array(holes) - (x, y)).max(axis=1)) < 1e-9
            assert abs(places[0] - places[1]) < 1e-6


def test_that_layers_alternate_and_names_count_in_reading_order(plan: PinnedPlan) -> None:
    assert [piece.id for piece in plan.assembly.pieces[:7]] == ["A1", "B1", "A2", "B2", "A3", "B3", "A4"]
    assert {piece.layer for piece in plan.assembly.pieces if sum(piece.panel) % 2 == 0} == {1}
    for piece in plan.assembly.pieces:
        body = shapely.Polygon(piece.outline, piece.openings)
        drilled = body.difference(
            shapely.union_all([shapely.Point(hole.centre).buffer(0.5 * hole.diameter_mm) for hole in piece.holes])
        )
        assert drilled.contains(shapely.Point(piece.label_at).buffer(0.5 * piece.label_mm))
        assert piece.label_mm > 3.0


def test_that_a_slit_with_nothing_in_it_is_closed_and_other_pieces_stay() -> None:
    shaping = Shaping.of(pinwheel(3, 3)[0].deployment, 40.0, 0.0, PinOptions())
    slit = shapely.Polygon([(0, 0), (30, 0), (30, 30), (15 + 1e-7, 30), (15, 10), (15 - 1e-7, 30), (0, 30)])
    before = shaping.bodies.copy()
    shaping.bodies[0] = slit
    shaping.close_slits()
    assert shaping.bodies[0].length == pytest.approx(120.0) and shaping.bodies[0].area == pytest.approx(900.0)
    assert all(one is other for one, other in zip(shaping.bodies[1:], before[1:], strict=True))


def test_that_extensions_draw_the_outlines_that_panels_alone_do_not(report: PinnedReport) -> None:
    short = check_pinned(pinned(*pinwheel(), WIDTH_MM, PinOptions(reach=0.0, margin_mm=0.0)), 2)
    assert report.figures.match > short.figures.match + 0.01
    assert report.figures.kept > short.figures.kept + 0.1


def test_that_pieces_are_cut_along_another_target_and_the_flat_outline_limits_it() -> None:
    design, _ = pinwheel(3, 3)
    angle = 2.0 * math.pi * np.arange(60) / 60
    circle = Outline.from_points(np.column_stack([np.cos(angle), np.sin(angle)]), "circle")
    loose, firm = (
        check_pinned(pinned(design, circle, SMALL_MM, PinOptions(least_flat=least)), 2).figures for least in (0.5, 0.99)
    )
    assert loose.match > firm.match + 0.02
    assert loose.flat_match < firm.flat_match - 0.002
    assert firm.lost_flat < 0.03


def test_that_the_weight_decides_which_outline_pieces_may_stick_out_of() -> None:
    design, _ = pinwheel(3, 3)
    target = Outline.from_points([(0, 0), (1.12, 0), (1, 1), (0, 1)], "wedge")
    flat, even, opened = (
        check_pinned(pinned(design, target, SMALL_MM, PinOptions(weight=weight)), 2).figures
        for weight in (0.2, 0.5, 0.9)
    )
    assert flat.match < even.match <= opened.match + 1e-9
    assert opened.beyond_flat > even.beyond_flat + 1e-4
    assert flat.flat_match > even.flat_match


def test_that_too_small_a_gap_is_found_with_its_place(plan: PinnedPlan) -> None:
    tight = check_pinned(pinned(*pinwheel(3, 3, 0.06), SMALL_MM), 5)
    assert {"pinned.ears_meet", "pinned.wall_too_thin"} <= codes(tight)
    found = next(problem for problem in tight.problems if problem.code == "pinned.ears_meet")
    assert found.where is not None and plan.flat.contains(shapely.Point(found.where))
    assert found.fields["gap_mm"] < found.fields["needed_mm"] == pytest.approx(9.8)
    assert tight.figures.overlap_mm2 < 0.01


def test_that_pieces_that_fall_apart_are_found() -> None:
    assert "pinned.falls_apart" in codes(check_pinned(pinned(*pinwheel(3, 3, 0.02), 70.0), 2))


def test_that_a_planted_collision_is_found(plan: PinnedPlan) -> None:
    pieces = list(plan.assembly.pieces)
    pieces[12] = replace(pieces[12], outline=pieces[12].outline * 1.4)
    faulty = replace(plan, assembly=replace(plan.assembly, pieces=tuple(pieces)))
    assert "pinned.pieces_collide" in codes(check_pinned(faulty, 7))


def test_that_wide_heads_and_wide_necks_are_found(plan: PinnedPlan) -> None:
    assert "pinned.heads_meet" in codes(check_pinned(replace(plan, options=replace(plan.options, head_mm=20.0)), 2))
    assert "pinned.neck_too_narrow" in codes(check_pinned(replace(plan, options=replace(plan.options, neck_mm=9.1)), 2))


def test_that_the_distance_of_pins_is_exact_over_the_motion(plan: PinnedPlan) -> None:
    assembly = plan.assembly
    nodes = [hinge.node for hinge in assembly.hinges]
    for phi in (0.0, 1.2, 2.9):
        found, pair = pins_apart(assembly.deployment, nodes, assembly.cell_mm, phi)
        least = math.inf
        for angle in np.linspace(phi, math.pi, 301):
            x, y = (assembly.deployment.nodes(float(angle))[nodes] * assembly.cell_mm).T
            apart = np.abs(np.subtract.outer(x + 1j * y, x + 1j * y))
            least = min(least, float(apart[np.triu_indices(len(nodes), 1)].min()))
        assert found <= least + 1e-9 and found == pytest.approx(least, abs=0.01)
        assert set(pair) <= set(nodes)


def test_that_walls_and_necks_are_measured() -> None:
    dumbbell = shapely.union_all([shapely.box(0, 0, 10, 10), shapely.box(9, 3, 21, 7.5), shapely.box(20, 0, 30, 10)])
    holes = (RoundHole(np.array([5.0, 5.0]), 3.0), RoundHole(np.array([26.0, 5.0]), 3.0))
    piece = Piece("A1", 1, (0, 0), shapely.get_coordinates(dumbbell)[:-1], holes)
    assert wall_mm(piece, dumbbell) == pytest.approx(2.5)
    assert neck_mm(piece, dumbbell, 3.0, 8.0) == pytest.approx(4.5, abs=0.1)
    assert neck_mm(piece, dumbbell, 6.0, 8.0) == pytest.approx(4.5, abs=0.1)
    outside = replace(piece, holes=(RoundHole(np.array([40.0, 5.0]), 3.0),))
    assert wall_mm(outside, dumbbell) == 0.0


@pytest.mark.parametrize(
    ("wrong", "code"),
    [
        ({"pin_mm": -1.0}, "pins.out_of_range"),
        ({"clearance_mm": math.nan}, "pins.out_of_range"),
        ({"weight": 1.5}, "pins.out_of_range"),
        ({"ear_mm": 3.0}, "pins.ear_within_hole"),
    ],
)
def test_that_sizes_that_make_no_sense_are_refused(wrong: dict[str, float], code: str) -> None:
    with pytest.raises(UsageError) as refused:
        PinOptions(**wrong)
    assert refused.value.code == code


def test_that_a_sheet_without_room_for_its_margins_is_refused() -> None:
    with pytest.raises(UsageError) as refused:
        pinned(*pinwheel(), 15.0)
    assert refused.value.code == "pins.sheet_too_narrow"


def test_that_the_margin_keeps_the_pins_of_the_rim_inside_of_both_outlines(plan: PinnedPlan) -> None:
    for phi, outline in ((0.0, plan.opened), (math.pi, plan.flat)):
        nodes = plan.assembly.deployment.nodes(phi) * plan.assembly.cell_mm
        pins = shapely.points(nodes[[hinge.node for hinge in plan.assembly.hinges]])
        assert np.all(shapely.contains(outline, pins))
        assert shapely.distance(outline.exterior, pins).min() > 0.5 * plan.options.pin_mm + 1.0
    assert iou(plan.flat, plan.flat.envelope) == pytest.approx(1.0)


def test_that_ears_become_smaller_where_they_would_cut_a_neighbour_through() -> None:
    design, target = pinwheel(3, 3, 0.16, 0.03, 4)
    firm, soft = (
        check_pinned(pinned(design, target, 110.0, PinOptions(pin_mm=1.6, head_mm=5.0, wall_mm=wall)), 9)
        for wall in (3.8, 1.6)
    )
    assert soft.figures.neck_mm > firm.figures.neck_mm
    assert soft.figures.wall_mm >= 1.6 - 0.02
    assert soft.figures.overlap_mm2 < 0.01 and firm.figures.overlap_mm2 < 0.01


def test_that_extensions_keep_clear_of_ears_that_pass_beyond_their_panels() -> None:
    design, target = pinwheel(4, 4, 0.2, 0.7, 5)
    assembly = pinned(design, target, WIDTH_MM, PinOptions(reach=2.0)).assembly
    assert max(overlap_at(assembly, float(phi)) for phi in np.linspace(math.pi, 0.0, 41)) < 1e-6


def test_that_ears_at_sharp_corners_hang_on_straps_as_wide_as_a_neck() -> None:
    plan = pinned(*pinwheel(4, 4, 0.2, 0.6), 130.0, PinOptions(pin_mm=1.6, ear_mm=5.6, neck_mm=2.0, head_mm=5.0))
    corners = plan.assembly.deployment.panels(math.pi)[..., 0] + 1j * plan.assembly.deployment.panels(math.pi)[..., 1]
    angle = np.abs(np.angle((np.roll(corners, 1, -1) - corners) / (np.roll(corners, -1, -1) - corners)))
    assert 5.6 * math.sin(0.5 * angle.min()) < 1.8, "an ear alone hangs on this much of the panel"
    report = check_pinned(plan, 9)
    assert plan.assembly.left_out == 0 and report.problems == () and report.figures.neck_mm >= 2.0


def test_that_pins_without_a_wall_are_left_out_and_the_pieces_are_sound_then(monkeypatch: pytest.MonkeyPatch) -> None:
    design, options = pinwheel(4, 4, 0.25, 0.6, 5), PinOptions(pin_mm=1.6, ear_mm=5.6, neck_mm=2.0, head_mm=5.0)
    options = replace(options, least_flat=0.0)
    plan = pinned(*design, 130.0, options)
    report = check_pinned(plan, 5)
    assert plan.assembly.left_out == 1 and len(plan.assembly.hinges) == 39
    assert report.problems == () and report.figures.wall_mm > options.asked_wall_mm - 0.02
    monkeypatch.setattr(LayerMotion, "without", lambda motion, nodes: motion)
    assert [one.code for one in check_pinned(pinned(*design, 130.0, options), 5).problems] == ["pinned.neck_too_narrow"]


def test_that_necks_between_pins_outside_of_an_outline_stay_in_the_piece_and_near_the_outline() -> None:
    # A U whose arms end in pins; the outline takes the upper half of both.
    body = shapely.box(0, 0, 40, 30).difference(shapely.box(8, -1, 32, 20))
    inside, pins = shapely.box(-10, 16, 50, 40), np.array([[4.0, 4.0], [36.0, 4.0]])
    links = shortest_links(body, pins, inside, 1.0)
    assert body.buffer(1e-9).covers(links) and links.geom_type == "Polygon"
    assert all(links.contains(shapely.Point(pin)) for pin in pins)
    held = links.union(body.intersection(inside)).buffer(-0.99)
    assert held.geom_type == "Polygon" and held.contains(shapely.Point(20, 25))
    assert links.difference(inside).area < 2.0 * 2.2 * 14.0
    assert shortest_links(body, np.array([[20.0, 5.0], [36.0, 4.0]]), inside, 1.0).is_empty


def test_that_extensions_of_both_end_states_keep_clear_of_ears_far_from_their_panel() -> None:
    design, _ = pinwheel(3, 3)
    options = PinOptions(ear_mm=6.0, pin_mm=2.0, neck_mm=2.0)
    shaping = Shaping.of(design.deployment, 40.0, 0.0, options)
    motion, radius = shaping.motion, 0.5 * options.ear_mm + options.clearance_mm
    seen, looked_at = 0, 0
    for one, other in shaping.pairs.tolist():
        panel = shapely.Polygon(np.column_stack([motion.corners[other].real, motion.corners[other].imag]))
        for corner in np.flatnonzero(motion.hinged[one] & ~np.isin(motion.nodes[one], motion.nodes[other])):
            ear = shapely.Point(motion.corners[one, corner].real, motion.corners[one, corner].imag).buffer(0.5 * radius)
            if panel.distance(ear) < 2.0 * shaping.reach_mm and looked_at < 60:
                looked_at += 1
                seen += shaping.free(other, ear).is_empty
    assert seen == looked_at > 20


def test_that_pieces_keep_clear_of_ears_but_for_a_share_and_printed_ones_by_all_of_it(plan: PinnedPlan) -> None:
    assert PinOptions(clearance_mm=0.3).rounded_mm == pytest.approx(0.0075)
    assert PinOptions(clearance_mm=0.0).rounded_mm == 0.0 and PinOptions(clearance_mm=5.0).rounded_mm == 0.01
    assert PinOptions(in_one_plane=True).rounded_mm == 0.0
    options, assembly = plan.options, plan.assembly
    layer, least = np.array([piece.layer for piece in assembly.pieces]), math.inf
    for phi in ANGLES[:9]:
        bodies = np.array([body for _, body in bodies_at(assembly, float(phi))], dtype=object)
        place = assembly.placing(float(phi))
        for number, piece in enumerate(assembly.pieces):
            pins = shapely.points([place(piece, np.asarray(hole.centre)) for hole in piece.holes])
            others = np.flatnonzero((layer == piece.layer) & (np.arange(len(layer)) != number))
            least = min(least, float(shapely.distance(bodies[others][:, None], pins).min()))
    assert least > 0.5 * options.ear_mm + options.clearance_mm - options.rounded_mm - 1e-6


@pytest.fixture(scope="module")
def notched() -> tuple[PosedDesign, Outline]:
    """A square whose target has a notch."""
    design, _ = pinwheel(3, 4)
    target = Outline.from_points([(0, 0), (1.25, 0), (1.25, 1), (0.8, 1), (0.62, 0.7), (0.45, 1), (0, 1)], "notched")
    return replace(design, pose=align(design.deployment.outline(0.0), target.points)), target


def test_that_pins_outside_of_the_target_are_left_out_where_the_motion_does_not_need_them(
    notched: tuple[PosedDesign, Outline],
) -> None:
    plan = pinned(*notched, 130.0, BRADS)
    assembly, tables = plan.assembly, plan.assembly.deployment.topology
    places = assembly.deployment.nodes(0.0) * assembly.cell_mm
    pinned_nodes = {hinge.node for hinge in assembly.hinges}
    outside = [node for node in np.unique(tables.void_nodes) if not plan.opened.contains(shapely.Point(places[node]))]
    assert assembly.left_out > 0 and not pinned_nodes & set(outside)
    motion = LayerMotion.of(assembly.deployment, assembly.cell_mm, 0.0)
    assert freedom(replace(motion, hinged=motion.hinged & np.isin(motion.nodes, list(pinned_nodes)))) == 1
    assert max(overlap_at(assembly, float(phi)) for phi in np.linspace(math.pi, 0.0, 25)) < 1e-6


def test_that_what_cutting_leaves_of_the_flat_outline_is_spent_on_a_target_that_is_not_shown_well() -> None:
    """Neighbours fill most of what is cut: at first the pieces match by 0.972, and the flat ones by 0.959."""
    points = [(0, 0), (1.25, 0), (1.25, 1), (0.9, 1), (0.62, 0.6), (0.35, 1), (0, 1)]
    design, target = pinwheel(3, 4)[0], Outline.from_points(points, "deeply notched")
    design = replace(design, pose=align(design.deployment.outline(0.0), target.points))
    figures = check_pinned(pinned(design, target, 130.0, replace(BRADS, least_flat=0.95)), 2).figures
    assert figures.match > 0.975 and figures.flat_match > 0.95


def test_that_pieces_are_made_on_one_thread_of_blas(
    notched: tuple[PosedDesign, Outline], monkeypatch: pytest.MonkeyPatch
) -> None:
    """On two threads the conditions of 121 pieces took 0.4 to 1.1 s of processor in the place of 0.03."""
    threads: list[int] = []
    decomposed = scipy.linalg.qr

    def counting(*given: Any, **named: Any) -> Any:
        threads.extend(one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas")
        return decomposed(*given, **named)

    monkeypatch.setattr("kirigami_studio.assembly.motion.qr", counting)
    with threadpool_limits(2, "blas"):
        pinned(*notched, 130.0, BRADS)
    assert threads and set(threads) == {1}


def test_that_only_pieces_that_could_gain_are_extended_a_second_time(
    notched: tuple[PosedDesign, Outline], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of 121 pieces of a gear in plywood 34 are tried again, with the outlines that trying all of them gives."""
    passes: list[set[int]] = []
    extended, extend = rim_pieces._extended, rim_pieces.extend_to

    def counting(shaping: Shaping, index: int, *given: Any) -> Any:
        passes[-1].add(index)
        return extended(shaping, index, *given)

    def passing(*given: Any) -> set[int]:
        passes.append(set())
        return extend(*given)

    def all_again(*given: Any) -> set[int]:
        return extend(*given[:4])

    monkeypatch.setattr(rim_pieces, "_extended", counting)
    monkeypatch.setattr("kirigami_studio.assembly.pinned.extend_to", passing)
    found = check_pinned(pinned(*notched, 130.0, BRADS), 2).figures
    first, _, again = map(len, passes)
    monkeypatch.setattr("kirigami_studio.assembly.pinned.extend_to", all_again)
    every = check_pinned(pinned(*notched, 130.0, BRADS), 2).figures
    assert 0 < again < first
    assert found.match == pytest.approx(every.match, abs=2e-4)
    assert found.flat_match == pytest.approx(every.flat_match, abs=2e-4)


def test_that_pins_without_a_wall_go_before_needless_ones() -> None:
    deployment, phi = pinwheel(4, 4, 0.25, 0.6, 5)[0].deployment, 0.0
    cell_mm = (130.0 - 2.0 * BRADS.rim_mm) / float(np.ptp(deployment.compact[:, 0]))
    motion = LayerMotion.of(deployment, cell_mm, phi)
    nodes = np.unique(motion.nodes[motion.hinged])
    weak = set(nodes.tolist()) - set(_pins_of(Shaping.of(deployment, cell_mm, phi, BRADS)).tolist())
    needless = [int(node) for node in nodes if node not in weak]
    made = Shaping.of(deployment, cell_mm, phi, BRADS, needless=needless)
    assert made.faults == 0 and len(weak) == 1 and not weak & set(_pins_of(made).tolist())
    assert len(_pins_of(made)) < len(nodes) - 1 and freedom(made.motion) == 1


def test_that_panels_the_target_shows_nothing_of_go_where_the_motion_does_not_need_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    design, _ = pinwheel(4, 4)
    less_a_corner = shapely.Polygon(np.array([(0, 0), (1, 0), (1, 0.6), (0.6, 1), (0, 1)]) - 0.5)
    target, scale = Outline.from_points(less_a_corner.exterior.coords[:-1], "square"), less_a_corner.area**-0.5
    x, y = shapely.get_coordinates(less_a_corner.centroid)[0] * -scale
    design = replace(design, pose=Similarity(scale, 0.0, (float(x), float(y))).compose(design.pose))
    sizes = replace(BRADS, least_flat=0.9)
    plan = pinned(design, target, 200.0, sizes)
    assert len(plan.assembly.pieces) == 24
    motion = LayerMotion.of(plan.assembly.deployment, plan.assembly.cell_mm, 0.0)
    panels, nodes = plan.assembly.numbers, [hinge.node for hinge in plan.assembly.hinges]
    hinged = motion.hinged & np.isin(motion.nodes, nodes)
    left = {"panel", "corners", "nodes", "layer", "plane", "drift", "sense"}
    some = replace(motion, hinged=hinged[panels], **{name: getattr(motion, name)[panels] for name in left})
    assert freedom(some) == 1
    monkeypatch.setattr("kirigami_studio.assembly.pinned.DROPPED", 0.0)
    whole = pinned(design, target, 200.0, sizes)
    assert len(whole.assembly.pieces) == 25
    fewer, every = check_pinned(plan, 9), check_pinned(whole, 2)
    assert fewer.figures.match > every.figures.match + 0.04
    assert fewer.figures.flat_match > 0.9 and not codes(fewer)


@pytest.mark.parametrize(("spoilt", "left", "tries"), [({0: 1}, [24], [[], [0]]), ({0: 1, 24: 23}, [], [[], [0, 24]])])
def test_that_only_panels_stay_without_which_pins_lose_their_wall(
    spoilt: dict[int, int], left: list[int], tries: list[list[int]]
) -> None:
    """Two corners of a sheet of 5 x 5 panels may go; without some, the pins of the panel beside have no wall."""
    panels, asked = all_panels(4, 4), []

    def fewer(stay: IntArray) -> PanelTable:
        asked.append(sorted(stay.tolist()))
        gone = np.setdiff1d([0, 24], stay)
        return panels.at(np.setdiff1d(panels.index, gone), panels.hinged) if len(gone) else panels

    def notched(some: PanelTable) -> Shaping:
        beside = [place for panel, place in spoilt.items() if panel not in some.index]
        weak = set(panels.corners[beside].ravel().tolist())
        return cast(Shaping, SimpleNamespace(weak=weak, cutting=set(), faults=len(weak)))

    found, shaping = _fewest_panels(panels, fewer, notched)
    assert shaping.faults == 0 and asked == tries
    assert np.setdiff1d(np.arange(25), found.index).tolist() == left


def _pins_of(shaping: Shaping) -> IntArray:
    return np.unique(shaping.motion.nodes[shaping.motion.hinged])


def test_that_gaps_within_the_flat_outline_do_not_count_as_lost_and_are_limited(
    notched: tuple[PosedDesign, Outline], monkeypatch: pytest.MonkeyPatch
) -> None:
    loose = check_pinned(pinned(*notched, 130.0, BRADS), 2).figures
    monkeypatch.setattr("kirigami_studio.assembly.rim_pieces.GAPS", 0.0)
    firm = check_pinned(pinned(*notched, 130.0, BRADS), 2).figures
    assert loose.match > firm.match + 0.002 and loose.flat_match > 0.97


def test_that_gaps_are_known_where_floating_point_gets_what_is_left_of_them_wrong() -> None:
    known = json.loads((DATA / "making" / "gaps_less_extension.json").read_text())
    gaps, extension = (shapely.from_wkb(known[name]) for name in ("gaps", "extension"))
    left = less(gaps, extension)  # which only touches them
    assert left.is_valid and left.area == pytest.approx(gaps.area, abs=1e-3)
