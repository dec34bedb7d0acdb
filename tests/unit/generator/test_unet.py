"""The U-Net and its ControlNet branch."""

from __future__ import annotations

import pytest
import torch

from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.generator.flow import integrate
from kirigami_studio.generator.network import NetworkShape
from kirigami_studio.generator.unet import UNetShape, UNetVelocity
from kirigami_studio.generator.velocity import Code, backbone_of, joined, network_of

pytestmark = pytest.mark.torch
TINY = UNetShape(4, 6, channels=(8, 16))
SQUARE = torch.tensor([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
DIAMOND = torch.tensor([[0.0, -0.7], [0.7, 0.0], [0.0, 0.7], [-0.7, 0.0]])
TARGETS = torch.stack([SQUARE, DIAMOND])


def opened(shape: UNetShape = TINY) -> UNetVelocity:
    """A network whose last convolution is no longer zero, so that something comes out; in evaluation mode."""
    torch.manual_seed(0)
    network = UNetVelocity(shape)
    for layer in network.up.leave:
        if isinstance(layer, torch.nn.Conv2d):
            torch.nn.init.normal_(layer.weight)
    return network.eval()


def noise(count: int, shape: UNetShape = TINY) -> torch.Tensor:
    return torch.randn(count, shape.rows * shape.columns, generator=torch.Generator().manual_seed(1))


def test_that_velocities_have_the_shape_of_the_fields() -> None:
    network, z = opened(), noise(4)
    code = network.code(TARGETS).repeated(2)
    assert network(z, torch.linspace(0, 1, 4), code).shape == z.shape == (4, 24)
    assert integrate(network, z, code, 3).shape == z.shape


def test_that_every_target_is_repeated_in_a_row_and_codes_join_in_order() -> None:
    network = opened()
    torch.nn.init.normal_(network.hint[-1].weight)
    both = network.code(TARGETS)
    assert not torch.allclose(both.hint[0], both.hint[1])
    assert torch.equal(both.repeated(2).hint, both.hint[[0, 0, 1, 1]])
    apart = joined([network.code(TARGETS[:1]), network.code(TARGETS[1:])])
    torch.testing.assert_close(apart.hint, both.hint)


def test_that_field_and_time_change_the_velocity() -> None:
    network, z = opened(), noise(1)
    for stage in network.down.stages:  # blocks begin as identities, which time cannot enter
        torch.nn.init.normal_(stage.block.second[-1].weight)
    code = network.code(TARGETS[:1])
    early, late = (network(z, torch.tensor([t]), code) for t in (0.1, 0.9))
    assert not torch.allclose(early, late)
    assert not torch.allclose(early, network(-z, torch.tensor([0.1]), code))


def test_that_the_control_branch_adds_nothing_at_first_but_learns() -> None:
    network, z, t = opened(), noise(2), torch.tensor([0.3, 0.6])
    torch.nn.init.normal_(network.hint[-1].weight)
    with_control = network(z, t, network.code(TARGETS))
    assert torch.equal(with_control, network(z, t, network.code(TARGETS.flip(0))))
    image = torch.nn.functional.interpolate(z.view(2, 1, 4, 6) / TINY.z_scale, size=(32, 32), mode="bilinear")
    features, middle, time = network.down(image, t)
    alone = torch.nn.functional.interpolate(network.up(middle, time, features), (4, 6), mode="bilinear", antialias=True)
    assert torch.equal(with_control, alone.flatten(1))
    with_control.square().mean().backward()
    gates = [*network.gates, network.middle_gate]
    assert all(gate.weight.grad.abs().max() > 0 for gate in gates)
    assert all(value.grad.abs().max() == 0 for value in network.control.enter.parameters())
    with torch.no_grad():
        for gate in gates:
            gate.weight -= 0.1 * gate.weight.grad
    changed = network(z, t, network.code(TARGETS))
    assert not torch.equal(changed, network(z, t, network.code(TARGETS.flip(0))))
    changed.square().mean().backward()
    assert network.hint[0].weight.grad.abs().max() > 0


def test_that_the_control_branch_begins_as_a_copy_of_its_own() -> None:
    network = opened()
    theirs = network.control.state_dict()
    assert all(torch.equal(value, theirs[name]) for name, value in network.down.state_dict().items())
    assert network.down.enter.weight.data_ptr() != network.control.enter.weight.data_ptr()


def test_that_where_the_contour_starts_makes_no_difference() -> None:
    network = opened()
    torch.nn.init.normal_(network.hint[-1].weight)
    code = network.code(TARGETS, torch.tensor([0.4, -0.4]))
    assert torch.equal(code.hint, network.code(TARGETS.roll(1, dims=1)).hint)


def test_that_the_default_is_the_papers_network() -> None:
    shape = UNetShape()
    assert (shape.channels, shape.latent, shape.mask, shape.groups) == ((64, 128, 256, 384), 32, 128, 32)
    with torch.device("meta"):
        network = UNetVelocity(shape)
    assert len(network.down.skips) == 4 * 2 + 3 + 1
    attends = [type(stage.attention).__name__ for stage in network.down.stages]
    assert attends == ["Identity"] * 3 + ["SelfAttention", "SelfAttention", "Identity"] * 2 + ["SelfAttention"] * 2
    assert 60e6 < sum(value.numel() for value in network.parameters()) < 70e6


@pytest.mark.parametrize(
    ("channels", "said"),
    [((), "even numbers"), ((8, 15), "even numbers"), ((2,), "even numbers"), ((4,) * 7, "7 levels cannot halve 32")],
)
def test_that_impossible_shapes_are_refused(channels: tuple[int, ...], said: str) -> None:
    with pytest.raises(UsageError, match=said):
        UNetShape(channels=channels)


def test_that_a_mask_that_does_not_divide_is_refused() -> None:
    with pytest.raises(UsageError) as caught:
        UNetShape(mask=100)
    assert caught.value.code == "model.unet_levels"


def test_that_a_shape_knows_its_backbone() -> None:
    perceptron = NetworkShape(4, 4, 32, 64, 2, 16, 24, 32, 48)
    assert (backbone_of(TINY), backbone_of(perceptron)) == ("unet", "perceptron")
    assert network_of(TINY).shape == TINY
    assert network_of(perceptron).shape == perceptron


def test_that_codes_of_the_perceptron_join_as_well() -> None:
    network = network_of(NetworkShape(4, 4, 32, 64, 2, 16, 24, 32, 48))
    parts: list[Code] = [network.code(TARGETS[:1]), network.code(TARGETS[1:])]
    whole = network.code(TARGETS)
    torch.testing.assert_close(joined(parts).loop, whole.loop)
    torch.testing.assert_close(joined(parts).encoded, whole.encoded)
