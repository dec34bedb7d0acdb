"""The velocity network: what it looks at, and how it corrects finished fields."""

from __future__ import annotations

from dataclasses import replace

import pytest
import torch
from small_networks import SMALL, random_fields, random_network, silhouettes

from kirigami_studio.generator.conditioning import contour_points
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.generator.network import VARIATION_COST, NetworkShape, VelocityNetwork
from kirigami_studio.generator.velocity import joined
from kirigami_studio.lab.training.preference_loss import boundary_gap

pytestmark = pytest.mark.torch
OWN = DeployedGrid(4, 4)
OTHERS = [DeployedGrid(6, 5), DeployedGrid(4, 4, 0.9), DeployedGrid(7, 6, 0.6)]
TARGETS = silhouettes(random_fields(OWN, 4), OWN)


def gaps(z: torch.Tensor, targets: torch.Tensor, grid: DeployedGrid) -> torch.Tensor:
    return boundary_gap(silhouettes(z, grid), contour_points(targets, 384))


@pytest.mark.parametrize("grid", [OWN, *OTHERS], ids=str)
def test_that_a_correction_brings_outlines_nearer_to_their_targets(grid: DeployedGrid) -> None:
    network = random_network()
    wanted = random_fields(grid, 6)
    targets = silhouettes(wanted, grid)
    z = wanted + random_fields(grid, 6, 0.1, seed=1)
    code = network.code(targets, grid=grid)
    change = network.correction(z, code)
    assert change.shape == z.shape
    assert float((gaps(z + change, targets, grid) / gaps(z, targets, grid)).max()) < 0.7
    assert float((gaps(z - change, targets, grid) / gaps(z, targets, grid)).min()) > 1.2


@pytest.mark.parametrize("grid", [OWN, *OTHERS], ids=str)
def test_that_gates_at_zero_leave_the_plain_gauss_newton_step(grid: DeployedGrid) -> None:
    network = random_network()
    z = random_fields(grid, 4, seed=2)
    code = network.code(TARGETS, grid=grid)
    assert code.feedback is not None
    assert torch.equal(network.correction(z, code), code.feedback(z, code.loop, True).direction)


@pytest.mark.parametrize("grid", [OWN, *OTHERS], ids=str)
def test_that_the_gates_scale_the_step_and_add_to_it(grid: DeployedGrid) -> None:
    plain, gated = random_network(), random_network()
    assert gated.follow is not None and gated.amend is not None
    gated.follow.bias.fill_(-0.75)
    gated.amend.bias.fill_(0.1)
    z = random_fields(grid, 4, seed=2)
    step = plain.correction(z, plain.code(TARGETS, grid=grid))
    change = gated.correction(z, gated.code(TARGETS, grid=grid))
    # Numbers that are the same all over the network's grid are the same all over every other one.
    torch.testing.assert_close(change, 0.25 * step + 0.1, atol=1e-4, rtol=1e-3)


def test_that_the_corrector_learns_from_what_it_returns() -> None:
    network = random_network().requires_grad_(True)
    z = random_fields(OTHERS[0], 4, seed=2)
    network.correction(z, network.code(TARGETS, grid=OTHERS[0])).square().sum().backward()
    assert network.follow is not None and network.amend is not None
    for layer in (network.follow, network.amend):
        assert layer.weight.grad is not None and float(layer.weight.grad.abs().max()) > 0


@pytest.mark.parametrize("direction", [False, True])
def test_that_networks_without_the_geometry_correct_nothing(direction: bool) -> None:
    network = random_network(loop_points=0, direction=direction)
    z = random_fields(OWN, 4)
    assert not network.corrects
    assert torch.equal(network.correction(z, network.code(TARGETS)), torch.zeros_like(z))


@pytest.mark.parametrize("grid", [OWN, *OTHERS], ids=str)
@pytest.mark.parametrize("asked", [0.0, 1.0])
def test_that_networks_that_were_not_trained_to_correct_take_the_plain_gauss_newton_step(
    grid: DeployedGrid, asked: float
) -> None:
    network, trained = random_network(direction=False), random_network()
    assert network.corrects and network.follow is network.amend is None
    z, preference = random_fields(grid, 4, seed=2), torch.full((4,), asked)
    code = network.code(TARGETS, preference=preference, grid=grid)
    assert code.feedback is not None
    change = network.correction(z, code)
    assert float(change.abs().mean()) > 0.01
    assert torch.equal(change, code.feedback(z, code.loop, True, code.variation_cost).direction)
    # The same as where gates begin.
    assert torch.equal(change, trained.correction(z, trained.code(TARGETS, preference=preference, grid=grid)))
    # Its velocity does without the direction, so it has fewer inputs.
    assert network.enter.in_features == trained.enter.in_features - 16


@pytest.mark.parametrize("grid", [OWN, *OTHERS], ids=str)
@pytest.mark.parametrize("loop_points", [0, 96])
def test_that_velocities_lie_on_the_networks_grid_whatever_the_sheet(grid: DeployedGrid, loop_points: int) -> None:
    network = random_network(loop_points=loop_points)
    code = network.code(TARGETS, grid=grid)
    velocity = network(random_fields(OWN, 4), torch.full((4,), 0.3), code)
    assert velocity.shape == (4, 16)
    assert code.transfer.on_grid(velocity).shape == (4, grid.rows * grid.columns)
    own = network(random_fields(OWN, 4), torch.full((4,), 0.3), network.code(TARGETS))
    # Only what it sees of the sheet's geometry can make a difference.
    assert torch.allclose(velocity, own, atol=1e-5) == (grid == OWN or not loop_points)


def test_that_a_preference_counts_once_its_weights_are_not_zero() -> None:
    network = random_network(preference=True)
    z, t = random_fields(OWN, 4), torch.full((4,), 0.5)

    def velocity(preference: torch.Tensor | None) -> torch.Tensor:
        result: torch.Tensor = network(z, t, network.code(TARGETS, preference=preference))
        return result

    assert torch.equal(velocity(torch.ones(4)), velocity(torch.zeros(4)))
    assert network.prefer is not None
    torch.nn.init.normal_(network.prefer.weight)
    assert torch.equal(velocity(None), velocity(torch.zeros(4)))
    whole, mixed = velocity(torch.ones(4)), velocity(torch.tensor([1.0, 0.0, 1.0, 0.5]))
    changed = (whole - velocity(None)).abs().amax(dim=1)
    assert float(changed.min()) > 1e-3
    torch.testing.assert_close(mixed[[0, 2]], whole[[0, 2]])
    torch.testing.assert_close(mixed[1], velocity(None)[1])
    assert not torch.allclose(mixed[3], whole[3], atol=1e-4)
    # What gates make of the preference, with the Gauss-Newton step itself held to the match alone.
    codes = [network.code(TARGETS, preference=torch.full((4,), p)) for p in (0.0, 1.0)]
    codes = [replace(code, variation_cost=torch.zeros(4)) for code in codes]
    before = [network.correction(z, code) for code in codes]
    assert torch.equal(before[0], before[1])
    assert network.follow is not None
    torch.nn.init.normal_(network.follow.weight)
    after = [network.correction(z, code) for code in codes]
    assert not torch.allclose(after[0], after[1], atol=1e-4) and not torch.allclose(after[1], before[1], atol=1e-4)


@pytest.mark.parametrize("direction", [False, True])
def test_that_networks_without_a_preference_draw_the_same_but_correct_by_it(direction: bool) -> None:
    network = random_network(direction=direction)
    preferences = (None, torch.zeros(4), torch.ones(4))
    codes = [network.code(TARGETS, preference=preference) for preference in preferences]
    assert all(torch.equal(code.encoded, codes[0].encoded) for code in codes)
    z, t = random_fields(OWN, 4, seed=2), torch.full((4,), 0.5)
    assert torch.equal(network(z, t, codes[2]), network(z, t, codes[0]))
    none, match, even = (network.correction(z, code) for code in codes)
    assert torch.equal(none, match)
    assert float((even - match).abs().amax(dim=1).min()) > 1e-3


def test_that_the_cost_of_variation_grows_with_the_square_of_the_preference() -> None:
    network = random_network()
    cost = network.code(TARGETS, preference=torch.tensor([0.0, 0.5, 1.0, 0.25])).variation_cost
    torch.testing.assert_close(cost, VARIATION_COST * torch.tensor([0.0, 0.25, 1.0, 0.0625]))
    assert not network.code(TARGETS).variation_cost.any()
    z = random_fields(OWN, 4, seed=2)
    mixed = network.correction(z, network.code(TARGETS, preference=torch.tensor([0.0, 0.0, 1.0, 1.0])))
    match, even = (network.correction(z, network.code(TARGETS, preference=torch.full((4,), p))) for p in (0.0, 1.0))
    torch.testing.assert_close(mixed[:2], match[:2], atol=1e-3, rtol=1e-3)
    torch.testing.assert_close(mixed[2:], even[2:], atol=1e-3, rtol=1e-3)


def test_that_the_sheets_numbers_are_zero_on_the_own_sheet_and_tell_others_apart() -> None:
    network, told = random_network(), random_network(sheets=True)
    assert told.lie is not None
    assert torch.equal(told.code(TARGETS, grid=OTHERS[0]).encoded, told.code(TARGETS).encoded)
    torch.nn.init.normal_(told.lie.weight)
    described = [
        told.code(TARGETS, grid=grid).encoded for grid in [OWN, *OTHERS, DeployedGrid(5, 6), DeployedGrid(4, 4, 0.5)]
    ]
    assert torch.equal(described[0], told.code(TARGETS).encoded)
    assert described[0].shape == network.code(TARGETS).encoded.shape
    for place, one in enumerate(described):
        assert all(not torch.allclose(one, other, atol=1e-3) for other in described[place + 1 :])


@pytest.mark.parametrize("grid", [OWN, OTHERS[2]], ids=str)
def test_that_repeated_picked_and_joined_codes_act_like_their_targets(grid: DeployedGrid) -> None:
    network = random_network(preference=True, sheets=True)
    asked = torch.tensor([1.0, 0.5, 0.0, 1.0])
    whole = network.code(TARGETS, preference=asked, grid=grid)
    z, t = random_fields(grid, 4, seed=3), torch.linspace(0, 0.9, 4)
    noise = random_fields(OWN, 4, 0.5)
    velocity, change = network(noise, t, whole), network.correction(z, whole)
    apart = joined([network.code(TARGETS[:1], None, asked[:1], grid),
                    network.code(TARGETS[1:], None, asked[1:], grid)])  # fmt: skip
    assert apart.feedback is not None and apart.feedback.grid == grid
    torch.testing.assert_close(network(noise, t, apart), velocity, atol=1e-3, rtol=1e-3)
    torch.testing.assert_close(network.correction(z, apart), change, atol=1e-3, rtol=1e-3)
    picked = whole.picked(slice(1, None, 2))
    torch.testing.assert_close(network(noise[1::2], t[1::2], picked), velocity[1::2], atol=1e-3, rtol=1e-3)
    torch.testing.assert_close(network.correction(z[1::2], picked), change[1::2], atol=1e-3, rtol=1e-3)
    twice = whole.repeated(2)
    doubled = network.correction(z.repeat_interleave(2, dim=0), twice)
    torch.testing.assert_close(doubled, change.repeat_interleave(2, dim=0), atol=1e-3, rtol=1e-3)
    assert twice.feedback is picked.feedback is whole.feedback is not None


def test_that_repeated_codes_give_each_target_to_consecutive_rows() -> None:
    code = random_network().code(TARGETS)
    repeated = code.repeated(3)
    assert torch.equal(repeated.loop[2], code.loop[0])
    assert torch.equal(repeated.encoded[3], code.encoded[1])


def test_that_a_shape_survives_being_written_down() -> None:
    shape = NetworkShape(4, 6, preference=True, sheets=True, direction=False)
    assert NetworkShape(**shape.to_json()) == shape  # type: ignore[arg-type]
    # Weights of before these inputs existed do not name them.
    new = {"direction", "preference", "sheets"}
    old = VelocityNetwork(NetworkShape(**{k: v for k, v in SMALL.to_json().items() if k not in new}))  # type: ignore[arg-type]
    assert old.follow is old.amend is old.prefer is old.lie is None
