"""From noise to design: Euler steps, then corrections."""

from __future__ import annotations

import pytest
import torch
from small_networks import random_fields, random_network, silhouettes

from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.generator.conditioning import contour_points
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.generator.flow import integrate, trail
from kirigami_studio.generator.network import TargetCode, VelocityNetwork
from kirigami_studio.lab.training.preference_loss import boundary_gap

pytestmark = pytest.mark.torch
OWN = DeployedGrid(4, 4)
OTHER = DeployedGrid(6, 5, 0.7)


class Recorded(VelocityNetwork):
    """The network itself, writing down when it is asked for what."""

    def forward(self, z: torch.Tensor, t: torch.Tensor, code: TargetCode) -> torch.Tensor:
        self.__dict__.setdefault("asked", []).append(float(t[0]))
        return super().forward(z, t, code)

    def correction(self, z: torch.Tensor, code: TargetCode) -> torch.Tensor:
        self.__dict__.setdefault("asked", []).append("correct")
        assert float(z.abs().max()) <= LOG_RATIO_LIMIT
        return super().correction(z, code)


def targets(grid: DeployedGrid, count: int = 3) -> torch.Tensor:
    return silhouettes(random_fields(grid, count), grid)


@pytest.mark.parametrize(("loop_points", "steps"), [(0, 2), (96, 4)])
def test_that_euler_steps_follow_the_velocity(loop_points: int, steps: int) -> None:
    network = random_network(loop_points=loop_points, direction=False)
    code = network.code(targets(OWN))
    noise = random_fields(OWN, 3, 0.5, seed=1)
    half = noise + 0.5 * network(noise, torch.zeros(3), code)
    expected = half + 0.5 * network(half, torch.full((3,), 0.5), code)
    finished = trail(network, noise, code, steps)
    assert torch.allclose(finished[0], expected, atol=1e-6)
    assert len(finished) == (3 if loop_points else 1)
    assert not torch.allclose(expected, noise, atol=1e-3)


@pytest.mark.parametrize(
    ("steps", "asked"),
    [
        (1, [0.0]), (2, [0.0, "correct"]), (4, [0.0, 0.5, "correct", "correct"]),
        (5, [0.0, pytest.approx(1 / 3), pytest.approx(2 / 3), "correct", "correct"]),
    ],
)  # fmt: skip
@pytest.mark.parametrize("direction", [False, True])
@pytest.mark.parametrize("grid", [OWN, OTHER], ids=str)
def test_that_half_of_the_steps_are_corrections(
    grid: DeployedGrid, direction: bool, steps: int, asked: list[object]
) -> None:
    network = random_network(Recorded, direction=direction)
    integrate(network, random_fields(OWN, 3, 1.0, seed=1), network.code(targets(grid), grid=grid), steps)
    assert network.__dict__["asked"] == asked


@pytest.mark.parametrize("direction", [False, True])
def test_that_networks_without_the_geometry_take_euler_steps_only(direction: bool) -> None:
    network = random_network(Recorded, loop_points=0, direction=direction)
    code = network.code(targets(OTHER), grid=OTHER)
    noise = random_fields(OWN, 3, 0.5, seed=1)
    drawn = integrate(network, noise, code, 4)
    assert network.__dict__["asked"] == [0.0, 0.25, 0.5, 0.75]
    own = noise
    for step in range(4):
        own = own + 0.25 * network(own, torch.full((3,), 0.25 * step), code)
    torch.testing.assert_close(drawn, code.transfer.on_grid(own))
    assert drawn.shape == (3, 30)


@pytest.mark.parametrize("grid", [OWN, OTHER], ids=str)
def test_that_corrections_are_added_to_the_euler_steps_on_the_sheet(grid: DeployedGrid) -> None:
    network = random_network()
    code, noise = network.code(targets(grid), grid=grid), random_fields(OWN, 3, 1.0, seed=1)
    first, second, last = trail(network, noise, code, 4)
    half = noise + 0.5 * network(noise, torch.zeros(3), code)
    torch.testing.assert_close(first, code.transfer.on_grid(half + 0.5 * network(half, torch.full((3,), 0.5), code)))
    bounded = first.clamp(-LOG_RATIO_LIMIT, LOG_RATIO_LIMIT)
    torch.testing.assert_close(second, bounded + network.correction(bounded, code))
    bounded = second.clamp(-LOG_RATIO_LIMIT, LOG_RATIO_LIMIT)
    torch.testing.assert_close(last, bounded + network.correction(bounded, code))
    assert torch.equal(integrate(network, noise, code, 4), last)


@pytest.mark.parametrize("direction", [False, True])
@pytest.mark.parametrize("grid", [OWN, DeployedGrid(6, 6), DeployedGrid(5, 6, 0.7)], ids=str)
def test_that_corrections_bring_samples_nearer_to_their_targets(grid: DeployedGrid, direction: bool) -> None:
    network = random_network(direction=direction)
    shapes = targets(grid, 12)
    code = network.code(shapes, grid=grid)
    finished = trail(network, random_fields(OWN, 12, 0.4, seed=1), code, 8)
    loop = contour_points(shapes, 384)
    gaps = [float(boundary_gap(silhouettes(z.clamp(-1, 1), grid), loop).mean()) for z in finished]
    assert len(gaps) == 5
    assert gaps[1] < 0.75 * gaps[0]
    assert gaps[-1] < 0.5 * gaps[0]


def test_that_gradients_reach_the_velocity_and_the_corrector_through_the_trail() -> None:
    network = random_network().requires_grad_(True)
    code = network.code(targets(OTHER), grid=OTHER)
    integrate(network, random_fields(OWN, 3, 0.4, seed=1), code, 4).square().sum().backward()
    for name in ("leave.weight", "follow.weight", "amend.weight", "encode.0.weight"):
        grad = network.get_parameter(name).grad
        assert grad is not None and float(grad.abs().max()) > 0, name
