"""Pieces of an assembly: frames, poses, pins."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kirigami_studio.assembly.pieces import Assembly, Hinge, Piece
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField

CELL_MM = 30.0


@pytest.fixture(scope="module")
def bare() -> Assembly:
    """The panels of a random 3 x 4 sheet as they are, with all hinges that two of them share."""
    ratios = np.random.default_rng(7).uniform(0.5, 2.0, (3, 4))
    deployment = deploy(RatioField(ratios))
    panels, tables = deployment.panels(math.pi), deployment.topology
    pieces, owners = [], {}
    for row, column in np.ndindex(4, 5):
        origin = panels[row, column].mean(axis=0)
        layer = 1 + (row + column) % 2
        piece = Piece(
            f"{'AB'[layer - 1]}{row * 5 + column}", layer, (row, column), (panels[row, column] - origin) * CELL_MM
        )
        pieces.append(piece)
        for corner, node in enumerate(tables.panel_nodes[row, column]):
            owners.setdefault(int(node), []).append((piece, piece.outline[corner]))
    hinges = [
        Hinge((first.id, second.id), (at, other), node)
        for node, shared in owners.items()
        if len(shared) == 2
        for (first, at), (second, other) in [sorted(shared, key=lambda one: one[0].layer)]
    ]
    return Assembly(deployment, CELL_MM, 0.0, tuple(pieces), tuple(hinges))


@pytest.mark.parametrize("phi", [math.pi, 2.0, 0.7, 0.0])
def test_that_poses_carry_every_panel_to_its_place(bare: Assembly, phi: float) -> None:
    wanted = bare.deployment.panels(phi) * CELL_MM
    for piece in bare.pieces:
        assert np.abs(bare.placed(piece, piece.outline, phi) - wanted[piece.panel]).max() < 1e-9


@pytest.mark.parametrize("phi", [math.pi, 1.3, 0.0])
def test_that_both_pieces_of_a_pin_have_it_at_one_place(bare: Assembly, phi: float) -> None:
    assert len(bare.hinges) == 31
    for hinge in bare.hinges:
        first, second = (
            bare.placed(bare.by_id[name], at, phi) for name, at in zip(hinge.pieces, hinge.at, strict=True)
        )
        assert np.abs(first - second).max() < 1e-9


def test_that_pieces_of_one_layer_never_turn_against_each_other(bare: Assembly) -> None:
    turns = bare.poses(0.4)[:, 2]
    layers = np.array([piece.layer for piece in bare.pieces])
    assert len(set(turns[layers == 1])) == len(set(turns[layers == 2])) == 1
    assert turns[layers == 1][0] == -turns[layers == 2][0] != 0.0
