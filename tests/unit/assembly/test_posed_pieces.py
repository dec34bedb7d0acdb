"""Pieces over their target: where they lie at every angle, what is left out of small pictures, how they look."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely

from kirigami_studio.assembly.posed_pieces import PieceLook, PosedPieces
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.fabricate.fastener import Fastener
from kirigami_studio.fabricate.material import find_material
from tests.pinned_assemblies import HOLE_MM, small_assembly

ANGLES = (math.pi, 2.0, 1.0, 0.0)


@pytest.fixture(scope="module")
def posed() -> PosedPieces:
    assembly = small_assembly()
    pose = Similarity(0.25, 0.7, (0.3, -0.2))
    return PosedPieces(assembly, PosedDesign(assembly.deployment, pose, 0.0), PieceLook(), head_mm=5.0)


@pytest.mark.parametrize("phi", ANGLES)
def test_that_outlines_are_those_of_the_assembly_carried_to_the_target(posed: PosedPieces, phi: float) -> None:
    assembly = posed.assembly
    for piece, rings in zip(assembly.pieces, posed.rings(phi), strict=True):
        placed = assembly.placed(piece, piece.outline, phi) / assembly.cell_mm
        np.testing.assert_allclose(rings[0], posed.design.pose_at(phi).apply(placed), atol=1e-12)
        assert len(rings) == 1 + len(piece.holes)


@pytest.mark.parametrize("phi", ANGLES)
def test_that_heads_lie_over_the_holes_of_both_layers(posed: PosedPieces, phi: float) -> None:
    heads, radius = posed.heads(phi), 0.5 * HOLE_MM / posed.mm_per_world
    assert len(heads) == len(posed.assembly.hinges)
    rings = dict(zip((piece.id for piece in posed.assembly.pieces), posed.rings(phi), strict=True))
    for hinge, head in zip(posed.assembly.hinges, heads, strict=True):
        for piece in hinge.pieces:
            centres = [ring.mean(axis=0) for ring in rings[piece][1:]]
            assert min(np.hypot(*(centre - head)) for centre in centres) < 1e-6 * radius


def test_that_layers_come_from_the_lowest_and_hold_every_piece_once(posed: PosedPieces) -> None:
    numbers = [posed.assembly.pieces[place].layer for layer in posed.layers for place in layer]
    assert numbers == sorted(numbers, reverse=True) and len(posed.layers) == 2
    assert sorted(place for layer in posed.layers for place in layer) == list(range(len(posed.assembly.pieces)))


def test_that_tiles_of_a_single_layer_without_pins_are_drawn_in_full_light(posed: PosedPieces) -> None:
    upper = tuple(piece for piece in posed.assembly.pieces if piece.layer == 2)
    tiles = PosedPieces(replace(posed.assembly, pieces=upper, hinges=()), posed.design, posed.look, head_mm=0.0)
    assert len(tiles.layers) == 1 and tiles.heads(1.0).shape == (0, 2)
    assert tiles.look.layer(0, 1) == tiles.look.face != tiles.look.layer(0, 2)


def test_that_small_pictures_have_fewer_corners_and_the_same_shapes(posed: PosedPieces) -> None:
    finest = float(np.ptp(posed.assembly.deployment.compact[:, 0])) * posed.assembly.cell_mm / 800.0
    corners = [sum(len(piece.outline) for piece in one.assembly.pieces) for one in (posed, posed.small)]
    assert corners[1] < 0.8 * corners[0]
    for before, after in zip(posed.assembly.pieces, posed.small.assembly.pieces, strict=True):
        assert shapely.Polygon(after.outline).is_valid
        apart = shapely.hausdorff_distance(shapely.LinearRing(before.outline), shapely.LinearRing(after.outline))
        assert apart < 2.0 * finest


def test_that_flat_pieces_by_themselves_stand_upright(posed: PosedPieces) -> None:
    upright, pose = posed.upright(), Similarity(posed.design.pose.scale)
    piece = posed.assembly.pieces[0]
    placed = posed.assembly.placed(piece, piece.outline, math.pi) / posed.assembly.cell_mm
    np.testing.assert_allclose(upright.rings(math.pi)[0][0], pose.apply(placed), atol=1e-12)


def test_that_plywood_is_brown_acrylic_is_blue_and_screws_are_of_steel() -> None:
    plywood = PieceLook.of(find_material("plywood-co2"), Fastener.BRAD)
    acrylic = PieceLook.of(find_material("acrylic-co2"), Fastener.M3)
    assert plywood.face[0] > plywood.face[1] > plywood.face[2] and acrylic.face[2] > acrylic.face[0]
    assert plywood.head[0] > 1.5 * plywood.head[2] and max(acrylic.head) - min(acrylic.head) < 20
    assert plywood.thickness_mm == 3.0 and sum(plywood.line) < sum(plywood.layer(0, 2)) < sum(plywood.face)
