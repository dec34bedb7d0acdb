"""A sheet with its connectors on the nodes closes freely; with shifted ones it jams, and the estimate knows."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from stopwatch import paced

from kirigami_studio.fabricate.slits import SHEET_EDGE, cut_table, sheet_lines
from kirigami_studio.foundation.errors import MechanicsError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.mechanics.closing import (
    CLOSED,
    Closing,
    carried_on,
    closing,
    even_closing,
    ideal_motion,
    jam_angle,
    silhouette,
)
from kirigami_studio.mechanics.connectors import (
    ElasticSheet,
    Junctions,
    centre_height,
    cut_connectors,
    flexure_length,
    junctions,
    turning_stiffness,
)
from kirigami_studio.mechanics.drive import Drive, rated
from kirigami_studio.mechanics.energy import NetworkEnergy
from kirigami_studio.mechanics.equilibrium import follow
from kirigami_studio.mechanics.estimate import estimate_stretch
from kirigami_studio.mechanics.gripping import find_grips, grips, panels_to_pin
from kirigami_studio.mechanics.sheet_network import SheetNetwork, polygons_as_rows, sheet_network

FILM = ElasticSheet(2500.0, 0.05)
WIDTH_MM, KERF_MM = 60.0, 0.02


@pytest.fixture(scope="module")
def design() -> Deployment:
    return deploy(RatioField.from_log10(np.random.default_rng(3).uniform(-0.4, 0.4, (4, 5))))


@pytest.fixture(scope="module")
def found(design: Deployment) -> Junctions:
    return junctions(design, WIDTH_MM)


def as_cut(found: Junctions, connector_mm: float, on_nodes: bool, kerf_mm: float = KERF_MM) -> SheetNetwork:
    widths = np.full(len(found.node), connector_mm)
    connectors = cut_connectors(found, widths, kerf_mm, found.place if on_nodes else None)
    return sheet_network(found.corners, connectors, FILM)


@pytest.fixture(scope="module")
def exact(found: Junctions) -> Closing:
    return closing(as_cut(found, 0.3, True))


@pytest.fixture(scope="module")
def shifted(found: Junctions) -> Closing:
    """Centres a tenth of a millimetre off their nodes, each another way."""
    off = np.random.default_rng(5).normal(size=found.place.shape) * 0.08
    connectors = cut_connectors(found, np.full(len(found.node), 0.3), KERF_MM, found.place + off)
    return closing(sheet_network(found.corners, connectors, FILM))


def test_that_exact_nodes_close_without_stretch(exact: Closing) -> None:
    assert exact.jam_phi() == 0.0
    assert exact.phi[0] == pytest.approx(math.pi) and exact.phi[-1] == pytest.approx(CLOSED)
    assert exact.stretch[:-3].max() < 1e-6
    assert exact.stretch.max() < 0.05
    opened = exact.sheet.opening(exact.path.motion[15])
    assert opened == pytest.approx(np.full(opened.shape, math.pi - exact.phi[15]), abs=1e-8)


def test_that_shifted_centres_jam(shifted: Closing) -> None:
    assert math.radians(10.0) < shifted.jam_phi() < math.radians(150.0)
    assert shifted.stretch[-1].max() > 0.45
    tight, loose = (shifted.jam_phi(limit) for limit in (0.1, 0.4))
    assert tight > loose


def test_that_wide_cut_connectors_touch_before_the_sheet_has_closed(found: Junctions) -> None:
    wide = closing(as_cut(found, 1.2, False))
    assert len(wide.phi) < wide.asked
    assert wide.jam_phi(1e9) == pytest.approx(wide.phi[-1]) and wide.phi[-1] > CLOSED
    assert wide.sheet.network.void_angles(wide.path.motion[-1]).min() < math.radians(3.0)


def test_that_the_energy_of_an_exact_sheet_is_that_of_its_hinges(exact: Closing) -> None:
    turning = float(exact.sheet.network.ligaments.turning.sum())
    turn = math.pi - exact.phi
    free = exact.phi > math.radians(6.0)
    assert exact.path.energy[free] == pytest.approx(0.5 * turning * turn[free] ** 2, rel=1e-6, abs=1e-9)
    assert exact.path.force[free] == pytest.approx(turning * turn[free], rel=1e-6, abs=1e-9)
    # Just before it is closed the contacts push back.
    assert exact.path.force[-1] > 1.5 * turning * turn[-1]
    assert np.all(exact.path.least > 0.0) and not np.any(exact.path.snapped)
    assert exact.stable_phi == pytest.approx([math.pi])


def test_that_the_strain_is_that_of_a_bent_strip(exact: Closing) -> None:
    flexure = 0.02 + 1.275 * 0.3
    turn = math.pi - exact.phi[15]
    assert exact.in_plane[15] == pytest.approx(np.full(len(exact.in_plane[15]), turn * 0.3 / (2.0 * flexure)), rel=1e-6)
    assert exact.out_of_plane[15].max() == pytest.approx(turn * 0.05 / (2.0 * flexure), rel=1e-6)


def test_that_a_sharp_slit_strains_by_the_handbook_value_at_half_a_turn() -> None:
    width = np.array([0.2, 1.0])
    stiffness = turning_stiffness(FILM, width, flexure_length(width, 0.0))
    assert stiffness == pytest.approx(2500.0 * 0.05 * width**2 / 15.8, rel=0.04)
    strain = math.pi * width / (2.0 * flexure_length(width, 0.0))
    assert strain == pytest.approx([1.19, 1.19], rel=0.04)
    assert centre_height(width, 0.0) == pytest.approx(0.73 * width)
    assert centre_height(width, 4.0) == pytest.approx([0.56 * 0.2, 0.56])


def test_that_the_ideal_motion_is_that_of_the_deployment(design: Deployment, found: Junctions) -> None:
    sheet = as_cut(found, 0.3, True)
    scale = WIDTH_MM / float(np.ptp(design.compact[:, 0]))
    for phi in (2.5, 1.0, 0.0):
        motion = ideal_motion(design, sheet.network, WIDTH_MM, phi)
        assert NetworkEnergy(sheet.network).stretch(motion) == pytest.approx(np.zeros(len(found.node)), abs=1e-9)
        moved = sheet.network.moved_outlines(motion).reshape(-1, 2)
        placed = design.panels(phi).reshape(-1, 2) * scale
        assert moved - moved.mean(axis=0) == pytest.approx(placed - placed.mean(axis=0), abs=1e-9)


def test_that_a_closed_sheet_is_carried_on_to_phi_zero(design: Deployment, exact: Closing, shifted: Closing) -> None:
    network, ideal = exact.sheet.network, ideal_motion(design, exact.sheet.network, WIDTH_MM, 0.0)
    ring = silhouette(design, network, WIDTH_MM, carried_on(exact, design, WIDTH_MM, 0.0))
    expected = silhouette(design, network, WIDTH_MM, ideal)
    assert shapely.Polygon(ring).area == pytest.approx(shapely.Polygon(expected).area, rel=2e-3)
    assert exact.sheet.opening(carried_on(exact, design, WIDTH_MM, 0.0)).mean() == pytest.approx(math.pi)
    for found in (exact, shifted):
        energy = NetworkEnergy(found.sheet.network)
        before, after = (energy.stretch(carried_on(found, design, WIDTH_MM, phi)) for phi in (found.phi[-1], 0.0))
        assert after == pytest.approx(before, abs=0.02)
        assert carried_on(found, design, WIDTH_MM, 1.0) == pytest.approx(found.motion_at(1.0))


def test_that_the_silhouette_of_the_ideal_motion_is_the_outline(design: Deployment, found: Junctions) -> None:
    sheet = as_cut(found, 0.3, True)
    scale = WIDTH_MM / float(np.ptp(design.compact[:, 0]))
    for phi in (2.5, 0.6):
        ring = silhouette(design, sheet.network, WIDTH_MM, ideal_motion(design, sheet.network, WIDTH_MM, phi))
        area = shapely.Polygon(ring).area
        assert area == pytest.approx(shapely.Polygon(design.outline(phi)).area * scale**2, rel=1e-4)


def test_that_the_estimate_agrees_with_the_simulator(design: Deployment, shifted: Closing, found: Junctions) -> None:
    estimate = estimate_stretch(design, shifted.sheet, WIDTH_MM)
    angles = [phi for phi in estimate.phi if phi > math.radians(40.0)]
    simulated = follow(shifted.sheet.network, even_closing(shifted.sheet, float(angles[-1]), 12))
    stretch = NetworkEnergy(shifted.sheet.network).stretch(simulated.motion[-1]) / 0.3
    guessed = estimate.stretch[len(angles) - 1]
    assert guessed.max() == pytest.approx(stretch.max(), rel=0.15)
    assert np.sqrt(np.mean((guessed - stretch) ** 2)) < 0.2 * np.sqrt(np.mean(stretch**2))
    assert math.degrees(estimate.jam_phi()) == pytest.approx(math.degrees(shifted.jam_phi()), abs=12.0)
    on_nodes = as_cut(found, 0.3, True)
    assert estimate_stretch(design, on_nodes, WIDTH_MM).stretch.max() < 1e-6
    assert estimate_stretch(design, on_nodes, WIDTH_MM).jam_phi() == 0.0


def test_that_turning_all_panels_stretches_more_than_letting_them_find_their_way(shifted: Closing) -> None:
    network, turns = shifted.sheet.network, np.linspace(0.0, 1.2, 7)
    parity = np.zeros(network.panel_count)
    parity[shifted.sheet.connectors.panels[:, 0]] = -shifted.sheet.connectors.sign
    parity[shifted.sheet.connectors.panels[:, 1]] = shifted.sheet.connectors.sign
    # Every panel turns as told, and the first one's middle is held.
    freedoms = np.concatenate([3 * np.arange(network.panel_count) + 2, [0, 1]])
    path = np.concatenate([0.5 * turns[:, None] * parity, np.zeros((len(turns), 2))], axis=1)
    forced = follow(network, Drive(freedoms, path, turns, rated(path, turns)))
    free = follow(network, even_closing(shifted.sheet, math.pi - 1.2, 7))
    assert shifted.sheet.opening(forced.motion[-1]) == pytest.approx(1.2)
    assert forced.energy[-1] > free.energy[-1]
    stretch = [NetworkEnergy(network).stretch(path.motion[-1]) for path in (forced, free)]
    assert np.sum(stretch[0] ** 2) > 3.0 * np.sum(stretch[1] ** 2)


def test_that_all_panels_led_along_the_ideal_path_follow_it(design: Deployment, found: Junctions) -> None:
    sheet = as_cut(found, 0.05, True)
    drive = grips(design, sheet, WIDTH_MM, [0], list(range(1, 30)), math.radians(60.0), 25)
    path = closing(sheet, drive)
    # Pins drive turns by way of the connectors, which give a little.
    assert path.stretch_mm.max() < 0.02
    assert sheet.opening(path.path.motion[-1]) == pytest.approx(np.full(len(found.node), math.radians(120.0)), abs=0.05)


def test_that_the_force_at_the_grips_does_the_work(design: Deployment, found: Junctions) -> None:
    sheet = as_cut(found, 0.05, True)
    drive = grips(design, sheet, WIDTH_MM, [0, 5], [24, 29], math.radians(60.0), 49)
    path = closing(sheet, drive).path
    assert np.trapezoid(path.force, drive.displacement) == pytest.approx(path.energy[-1], rel=0.01)


def test_that_two_corners_do_not_lead_a_large_sheet_but_the_grips_that_are_found_do() -> None:
    large = deploy(RatioField.from_log10(np.random.default_rng(1).uniform(-0.3, 0.3, (6, 6))))
    sheet = as_cut(junctions(large, WIDTH_MM), 0.05, True)
    end = math.radians(20.0)
    corners = closing(sheet, grips(large, sheet, WIDTH_MM, [0], [48], end, 15))
    assert corners.phi[-1] > math.radians(140.0)
    assert corners.phi.min() > math.radians(60.0)
    found = find_grips(large, sheet, WIDTH_MM, end, 15)
    assert found.follows
    assert len(found.held) == 1 and 3 <= len(found.moved) <= 19
    assert found.closing.phi[-1] == pytest.approx(end, abs=math.radians(5.0))
    assert panels_to_pin(large, sheet, WIDTH_MM, 20)[: len(found.moved) + 1] == [*found.held, *found.moved]


def test_that_grips_must_name_panels(design: Deployment, exact: Closing) -> None:
    for held, moved, code in (
        ([0], [99], "drive.unknown_panel"),
        ([], [3], "drive.no_grips"),
        ([3], [], "drive.no_grips"),
        ([3], [3], "drive.nothing_moves"),
    ):
        with pytest.raises(MechanicsError) as caught:
            grips(design, exact.sheet, WIDTH_MM, held, moved)
        assert caught.value.code == code


def test_that_junctions_lie_where_the_cuts_end(design: Deployment) -> None:
    table = cut_table(*design.sheet.grid)
    found = junctions(design, WIDTH_MM, table.hinge_node)
    lines, _ = sheet_lines(design, WIDTH_MM)
    assert found.place == pytest.approx(lines[table.hinge_cut, table.hinge_end])
    run = lines[table.hinge_cut, 1 - table.hinge_end] - found.place
    assert found.along == pytest.approx(run / np.linalg.norm(run, axis=1)[:, None])
    assert np.array_equal(found.on_edge, table.hinge_through == SHEET_EDGE)
    through = lines[table.hinge_through, 1] - lines[table.hinge_through, 0]
    crossed = through[:, 0] * found.through[:, 1] - through[:, 1] * found.through[:, 0]
    assert np.abs(crossed[~found.on_edge]).max() < 1e-9 * WIDTH_MM


def test_that_straight_connectors_turn_below_the_tips_of_their_slits(found: Junctions) -> None:
    widths = np.full(len(found.node), 0.3)
    straight = cut_connectors(found, widths, KERF_MM)
    # The tip of the kerf is a finished width above the edge of the through cut, however its slit slants.
    flank = np.where(found.on_edge, 0.0, 0.5 * KERF_MM)
    tip = found.place + ((flank + widths + 0.5 * KERF_MM) / found.sine)[:, None] * found.along
    below = straight.centres[:, 0] - tip
    assert np.sum(below * found.through, axis=1) == pytest.approx(np.zeros(len(widths)), abs=1e-12)
    expected = flank + centre_height(widths, KERF_MM)
    assert np.sum((straight.centres[:, 0] - found.place) * found.normal, axis=1) == pytest.approx(expected)
    assert np.abs(np.sum(found.along * found.through, axis=1)).max() > 0.2


def test_that_given_centres_and_widths_are_checked(found: Junctions, design: Deployment) -> None:
    widths = np.full(len(found.node), 0.3)
    torn = widths.copy()
    torn[np.any(found.panels == 0, axis=1)] = 0.0
    cases = (
        (lambda: cut_connectors(found, widths[1:], KERF_MM), "sheet.widths_wrong"),
        (lambda: cut_connectors(found, -widths, KERF_MM), "sheet.widths_wrong"),
        (lambda: cut_connectors(found, widths, math.nan), "sheet.constant_not_positive"),
        (lambda: cut_connectors(found, widths, KERF_MM, found.place[1:]), "sheet.centres_wrong"),
        (
            lambda: cut_connectors(found, widths, KERF_MM, np.full(found.place.shape, math.nan)),
            "sheet.centres_wrong",
        ),
        (lambda: junctions(design, WIDTH_MM, np.array([0])), "sheet.no_junction"),
        (lambda: junctions(design, -1.0), "sheet.constant_not_positive"),
        (lambda: ElasticSheet(0.0, 1.0), "sheet.constant_not_positive"),
        (
            lambda: sheet_network(found.corners, cut_connectors(found, torn, KERF_MM), FILM),
            "network.not_connected",
        ),
        (
            lambda: sheet_network(found.corners[:3], cut_connectors(found, widths, KERF_MM), FILM),
            "network.number_out_of_range",
        ),
        (
            lambda: sheet_network(found.corners[..., :1], cut_connectors(found, widths, KERF_MM), FILM),
            "network.wrong_shape",
        ),
    )
    for attempt, code in cases:
        with pytest.raises(MechanicsError) as caught:
            attempt()
        assert caught.value.code == code
        assert str(caught.value) != code


def test_that_centres_may_be_given_apart_for_both_panels(found: Junctions) -> None:
    both = np.stack([found.place, found.place + np.array([0.02, 0.0])], axis=1)
    connectors = cut_connectors(found, np.full(len(found.node), 0.3), KERF_MM, both)
    assert connectors.centres == pytest.approx(both)
    sheet = sheet_network(found.corners, connectors, FILM)
    energy = NetworkEnergy(sheet.network)
    still = np.zeros((sheet.network.panel_count, 3))
    assert energy.value(still) == pytest.approx(0.0, abs=1e-20)
    assert energy.stretch(still) == pytest.approx(np.zeros(len(found.node)), abs=1e-12)


def test_that_panels_with_gaps_left_may_pass_phi_zero_and_thick_ones_touch_before(found: Junctions) -> None:
    widths = np.full(len(found.node), 0.3)
    with_gap = cut_connectors(found, widths, 0.4, found.place)
    assert np.all(with_gap.touch[~found.on_edge] < 0.0)
    thick = cut_connectors(found, widths, 0.0)
    assert np.all(thick.touch > 0.0)
    reach = found.reach_mm
    assert thick.touch == pytest.approx(2.0 * np.arctan(0.73 * 0.3 / reach))


def test_that_longer_connectors_are_softer_and_turn_about_their_middle(found: Junctions) -> None:
    widths = np.full(len(found.node), 0.3)
    short, long = (
        cut_connectors(found, widths, KERF_MM, longer_mm=np.full(len(found.node), more)) for more in (0.0, 1.2)
    )
    assert long.flexure_mm == pytest.approx(short.flexure_mm + 1.2)
    one, other = (sheet_network(found.corners, connectors, FILM).network.ligaments for connectors in (short, long))
    assert other.turning == pytest.approx(one.turning * short.flexure_mm / long.flexure_mm)
    film = FILM.young_mpa * FILM.thickness_mm
    assert film / other.stretching - film / one.stretching == pytest.approx(np.full(len(widths), 4.0))
    assert film / other.shearing - film / one.shearing == pytest.approx(np.full(len(widths), 64.0))
    away = np.sum((long.centres[:, 0] - found.place) * found.normal, axis=1)
    assert away == pytest.approx(np.where(found.on_edge, 0.15, 0.16))
    with pytest.raises(MechanicsError) as caught:
        cut_connectors(found, widths, KERF_MM, longer_mm=widths[1:])
    assert caught.value.code == "sheet.widths_wrong"


def test_that_trimmed_panels_are_trimmed_in_the_silhouette(design: Deployment, found: Junctions) -> None:
    polygons = list(found.corners)
    whole = as_cut(found, 0.3, True)
    polygons[0] = np.concatenate([polygons[0][:3], polygons[0][2:3] + 0.4 * (polygons[0][3:] - polygons[0][2:3])])
    triangle = list(found.corners)
    triangle[0] = polygons[0][:3]
    motion = np.zeros((len(polygons), 3))
    for shapes in (polygons, triangle):
        rows = polygons_as_rows(shapes)
        assert rows.shape == (30, 4, 2)
        trimmed = sheet_network(rows, whole.connectors, FILM)
        lost = shapely.Polygon(found.corners[0]).area - shapely.Polygon(shapes[0]).area
        areas = [
            shapely.Polygon(silhouette(design, sheet.network, WIDTH_MM, motion)).area for sheet in (whole, trimmed)
        ]
        assert areas[0] - areas[1] == pytest.approx(lost, rel=1e-3)


def test_that_the_jam_angle_is_where_stretch_passes_the_limit() -> None:
    phi, stretch = np.radians([180.0, 120.0, 60.0, 2.0]), np.array([0.0, 0.2, 0.6, 0.7])
    assert math.degrees(jam_angle(phi, stretch, 0.4, True)) == pytest.approx(90.0)
    assert jam_angle(phi, stretch, 0.8, True) == 0.0
    assert math.degrees(jam_angle(phi, stretch, 0.8, False)) == pytest.approx(2.0)
    assert math.degrees(jam_angle(phi[:3], stretch[:3], 0.8, True)) == pytest.approx(60.0)


def test_that_a_larger_kerf_and_a_stiffer_sheet_count_as_they_should(found: Junctions) -> None:
    film, wide = as_cut(found, 0.3, True), as_cut(found, 0.3, True, kerf_mm=0.3)
    assert wide.network.ligaments.turning.sum() < film.network.ligaments.turning.sum()
    stiff = sheet_network(found.corners, film.connectors, replace(FILM, young_mpa=5000.0))
    for name in ("turning", "stretching", "shearing"):
        one, other = (np.asarray(vars_of(sheet)[name]) for sheet in (film, stiff))
        assert other == pytest.approx(2.0 * one)


def vars_of(sheet: SheetNetwork) -> dict[str, np.ndarray]:
    joints = sheet.network.ligaments
    return {"turning": joints.turning, "stretching": joints.stretching, "shearing": joints.shearing}


def test_that_a_large_sheet_closes_in_seconds() -> None:
    large = deploy(RatioField.from_log10(np.random.default_rng(0).uniform(-0.3, 0.3, (24, 24))))
    sheet = as_cut(junctions(large, 200.0), 0.2, True)
    angles: list[float] = []
    assert paced(lambda: angles.append(closing(sheet).jam_phi()), 1) < 60.0
    assert angles == [0.0]
