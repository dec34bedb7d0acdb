"""Geometry feedback, the network and its integration."""

from __future__ import annotations

import pytest
import torch

from kirigami_studio.generator.conditioning import contour_points, normalised
from kirigami_studio.generator.feedback import GAP_SCALE, Feedback
from kirigami_studio.generator.flow import integrate
from kirigami_studio.generator.network import NetworkShape, VelocityNetwork
from kirigami_studio.lattice.batched import BatchedLattice

pytestmark = pytest.mark.torch


def own_loop(z: torch.Tensor, points: int) -> torch.Tensor:
    lattice = BatchedLattice(6, 6)
    outline = lattice.outline(torch.pow(10.0, z.view(-1, 6, 6)), 0.0)[:, lattice.unzipped]
    return contour_points(normalised(outline), points)


def test_that_a_field_is_no_distance_away_from_its_own_outline() -> None:
    z = 0.3 * torch.randn((3, 36), generator=torch.Generator().manual_seed(0))
    feedback = Feedback(6, 6, torch.device("cpu"))
    described = feedback(z, own_loop(z, 960))
    gaps = described[:, 2 * feedback.vertices :] * GAP_SCALE
    assert float(gaps.abs().max()) < 2e-3


def test_that_feedback_points_from_the_outline_to_the_target() -> None:
    z = torch.zeros(1, 36)
    feedback = Feedback(6, 6, torch.device("cpu"))
    moved = own_loop(z, 960) + torch.tensor([0.02, 0.0])
    described = feedback(z, moved)[0, 2 * feedback.vertices :].view(-1, 2) * GAP_SCALE
    out = described[: 2 * feedback.vertices]
    upright_sides = out[:, 1].abs() < 1e-4
    assert float(out[upright_sides, 0].max()) == pytest.approx(0.02, abs=1e-3)
    assert float(out[:, 0].min()) > -1e-3


def test_that_the_promised_feature_count_is_delivered() -> None:
    feedback = Feedback(4, 6, torch.device("cpu"))
    described = feedback(torch.zeros(2, 24), torch.rand(2, 64, 2))
    assert described.shape == (2, Feedback.width(4, 6, 64))


def untrained(loop_points: int) -> VelocityNetwork:
    torch.manual_seed(0)
    network = VelocityNetwork(NetworkShape(4, 4, 32, 64, 2, 16, 24, 32, loop_points))
    torch.nn.init.normal_(network.leave.weight, std=0.1)
    return network.eval().requires_grad_(False)


@pytest.mark.parametrize("loop_points", [0, 48])
def test_that_euler_steps_follow_the_velocity(loop_points: int) -> None:
    network = untrained(loop_points)
    polygon = normalised(torch.tensor([[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]])).expand(3, -1, -1)
    code = network.code(polygon)
    noise = torch.randn((3, 16), generator=torch.Generator().manual_seed(1))
    half = noise + 0.5 * network(noise, torch.zeros(3), code)
    expected = half + 0.5 * network(half, torch.full((3,), 0.5), code)
    assert torch.allclose(integrate(network, noise, code, 2), expected, atol=1e-6)
    assert not torch.allclose(expected, noise, atol=1e-3)


def test_that_repeated_codes_give_each_target_to_consecutive_rows() -> None:
    network = untrained(48)
    polygons = normalised(torch.rand((2, 3, 2), generator=torch.Generator().manual_seed(2)))
    code = network.code(polygons)
    repeated = code.repeated(3)
    assert torch.equal(repeated.loop[2], code.loop[0])
    assert torch.equal(repeated.encoded[3], code.encoded[1])
