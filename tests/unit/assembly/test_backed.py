"""Tiles on a hinge layer: inside their panels, clear of connectors, in register; strain of the layer."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import shapely
from refusals import refused
from shapely.geometry import Point, Polygon

from kirigami_studio.assembly.backed import BackedSheet, BoardCut, Jig, TileSizes
from kirigami_studio.fabricate.checks import check_plan, flexing
from kirigami_studio.fabricate.cut_panels import cut_panels
from kirigami_studio.fabricate.cut_plan import CutPlan, plan_cuts
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.fabricate.strain import StrainFigure, survival
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.mechanics.connectors import ElasticSheet, cut_connectors, junctions
from kirigami_studio.mechanics.sheet_network import sheet_network

KERF, WIDTH = 0.2, 150.0
#: Thin enough to bend out of the plane.
FILM = replace(find_material("film-uv"), thickness_mm=0.2, break_strain=0.5, bend_strain=0.8)


@pytest.fixture(scope="module")
def design() -> Deployment:
    return deploy(RatioField.from_log10(np.random.default_rng(4).uniform(-0.3, 0.3, (3, 4))))


@pytest.fixture(scope="module")
def plan(design: Deployment) -> CutPlan:
    return plan_cuts(design, WIDTH, 1.5, KERF, FILM, CutOptions(ConnectorStyle.STRAIGHT))


@pytest.fixture(scope="module")
def backed(plan: CutPlan, design: Deployment) -> BackedSheet:
    return BackedSheet.of(plan, design, 0.0, TileSizes())


def test_that_every_tile_is_a_gap_smaller_than_its_finished_panel(backed: BackedSheet) -> None:
    panels = cut_panels(backed.plan).outlines
    for ring, tile in zip(panels.split(panels.points), backed.flat_tiles.values(), strict=True):
        panel = Polygon(ring)
        assert panel.contains(tile)
        assert panel.exterior.distance(tile) == pytest.approx(1.0 + 0.5 * KERF, abs=1e-6)


def test_that_tiles_leave_connectors_free_over_their_flexure_length(backed: BackedSheet) -> None:
    hinges = backed.plan.hinges
    tiles = shapely.union_all(list(backed.flat_tiles.values()))
    away = shapely.distance(shapely.points(hinges.position), tiles)
    assert np.all(away >= 0.998 * hinges.flexure_mm)
    wide = BackedSheet.of(backed.plan, backed.deployment, 0.0, TileSizes(relief_mm=6.0))
    away = shapely.distance(shapely.points(hinges.position), list(wide.flat_tiles.values())[5])
    assert away.min() == pytest.approx(6.0, rel=5e-3)


def test_that_no_two_tiles_meet_at_any_angle(backed: BackedSheet) -> None:
    assembly = backed.assembly
    for phi in np.linspace(0.0, math.pi, 13):
        tiles = [Polygon(assembly.placed(piece, piece.outline, phi)) for piece in assembly.pieces]
        _, distance = shapely.STRtree(tiles).query_nearest(tiles, exclusive=True, return_distance=True)
        assert distance.min() >= 1.9


def test_that_tiles_are_numbered_in_reading_order_and_lie_on_their_panels(backed: BackedSheet) -> None:
    pieces = backed.assembly.pieces
    assert [piece.id for piece in pieces] == [f"A{number}" for number in range(1, 21)]
    assert all(one.panel < other.panel for one, other in pairwise(pieces))
    for piece, (x, y, turn) in zip(pieces, backed.assembly.poses(math.pi), strict=True):
        tile = Polygon(piece.outline + np.array([x, y]) + backed.shift)
        assert turn == 0.0 and tile.symmetric_difference(backed.flat_tiles[piece.panel]).area < 0.01
        number = Point(*piece.label_at).buffer(0.5 * piece.label_mm)
        assert Polygon(piece.outline).contains(number)


def test_that_panels_without_room_have_no_tile_and_are_counted(backed: BackedSheet) -> None:
    assert backed.missing == 0 and 0.7 < backed.covered < 0.95
    wide = BackedSheet.of(backed.plan, backed.deployment, 0.0, TileSizes(gap_mm=11.0))
    assert 0 < wide.missing < 20 and len(wide.flat_tiles) == 20 - wide.missing
    assert wide.covered < backed.covered


@pytest.mark.parametrize("cut", list(BoardCut))
def test_that_board_and_hinge_layer_fit_one_way_only(backed: BackedSheet, cut: BoardCut) -> None:
    board = backed.board(Jig(cut))
    frame, outline = board.pieces[-1], Polygon(backed.plan.outline)
    holes = np.array([hole.centre for hole in board.registration])
    assert all(outline.distance(Point(hole)) > 0.5 * 3.0 + 1.0 for hole in holes)
    middle = 0.5 * (frame.outline.min(axis=0) + frame.outline.max(axis=0)) - board.layer_at
    for turned in ((-1, -1), (-1, 1), (1, -1)):
        other = middle + np.array(turned) * (holes - middle)
        nearest = np.linalg.norm(other[:, None] - holes, axis=2).min(axis=1)
        assert nearest.max() > 5.0
    body = Polygon(frame.outline, [frame.openings[0]])
    assert all(body.contains(Point(*hole.centre).buffer(0.5 * hole.diameter_mm + 2.0)) for hole in frame.holes)
    assert board.kissed == (frozenset(backed.assembly.by_id) if cut is BoardCut.KISS else frozenset())


def test_that_tiles_lie_in_the_frame_as_on_the_hinge_layer(backed: BackedSheet) -> None:
    board = backed.board(Jig())
    assert board.places.min() >= 0.0
    opening = Polygon(board.pieces[-1].openings[0])
    for piece, place in zip(board.pieces[:-1], board.places[:-1], strict=True):
        tile = Polygon(piece.outline + place)
        assert opening.contains(tile)
        assert tile.symmetric_difference(
            shapely.affinity.translate(backed.flat_tiles[piece.panel], *board.layer_at)
        ).area < 0.01  # fmt: skip


#: Over which a connector bends, by the mechanics: l = k + 1.275 w.
FLEXURE = KERF + 1.275 * 1.5


def figures(plan: CutPlan, design: Deployment, phi: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Widths of all connectors and both figures of the mechanics, bent evenly to an angle."""
    found = junctions(design, plan.size_mm[0])
    connectors = cut_connectors(found, plan.hinges.finished_mm, KERF)
    sheet = ElasticSheet(1e3 * plan.material.young_gpa, plan.material.thickness_mm)
    network = sheet_network(found.corners, connectors, sheet)
    turn = np.full(len(connectors), math.pi - phi)
    return connectors.width_mm, *network.strains(turn, np.zeros(len(turn)))


def test_that_tiles_off_the_flexure_length_leave_the_strain_of_the_mechanics(
    backed: BackedSheet, plan: CutPlan, design: Deployment
) -> None:
    known = figures(plan, design, 0.0)
    tiles = backed.rigid_panels(0.0, np.full(len(plan.hinges), FLEXURE))
    alone, under = survival(FILM, *known), survival(FILM, *known, tiles)
    assert under == alone and under.figure is StrainFigure.OUT_OF_PLANE and not under.held
    assert under.strain == pytest.approx(math.pi * 0.2 / (2.0 * FLEXURE), rel=1e-3)


def test_that_tiles_nearer_to_a_connector_strain_it_more(plan: CutPlan, design: Deployment) -> None:
    known = figures(plan, design, 2.4)  # a quarter of a turn, which takes little room
    free = survival(FILM, *known)
    near = BackedSheet.of(plan, design, 2.4, TileSizes(gap_mm=0.1, relief_mm=0.8))
    closer = survival(FILM, *known, near.rigid_panels(2.4, np.full(len(plan.hinges), FLEXURE)))
    assert closer.strain == pytest.approx(free.strain * FLEXURE / 1.6, rel=1e-3)
    assert closer.figure is StrainFigure.OUT_OF_PLANE


def test_that_a_thin_layer_stays_flat_where_tiles_leave_it_no_length(plan: CutPlan, design: Deployment) -> None:
    known = figures(plan, design, 0.0)
    tight = BackedSheet.of(plan, design, 0.0, TileSizes(gap_mm=0.1, relief_mm=1.4)).rigid_panels(0.0)
    held = survival(FILM, *known, tight)
    assert held.held and held.figure is StrainFigure.IN_PLANE and held.why.code == "strain.held_by_tiles"
    assert held.strain == pytest.approx(math.pi * 1.5 / (2.0 * FLEXURE), rel=1e-3) and held.breaks
    wide = BackedSheet.of(plan, design, 0.0, TileSizes(gap_mm=0.1, relief_mm=1.6)).rigid_panels(0.0)
    assert survival(FILM, *known, wide).figure is StrainFigure.OUT_OF_PLANE


def test_that_the_check_of_a_plan_judges_the_layer_between_tiles(plan: CutPlan, design: Deployment) -> None:
    tight = BackedSheet.of(plan, design, 0.0, TileSizes(gap_mm=0.1, relief_mm=0.5)).rigid_panels(0.0)
    alone, under = flexing(plan, 0.0), flexing(plan, 0.0, tight)
    assert alone is not None and under is not None
    assert under.flexure_mm == pytest.approx(1.0) and under.strain > alone.strain
    codes = [{problem.code for problem in check_plan(plan, phi=0.0, rigid=one).problems} for one in (None, tight)]
    assert "plan.strain_choose_style" in codes[1] - codes[0]


def test_that_lengths_that_make_no_sense_are_refused() -> None:
    with refused(FabricationError, "backed.relief_negative"):
        TileSizes(relief_mm=-1.0)
    with refused(FabricationError, "backed.pin_too_wide"):
        Jig(frame_mm=5.0, pin_mm=3.0)
    for jig in ({"frame_mm": 0.0}, {"pin_mm": math.nan}):
        with pytest.raises(FabricationError):
            Jig(**jig)  # type: ignore[arg-type]
