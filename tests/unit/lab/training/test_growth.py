"""Weights carried over to a network that sees more."""

from __future__ import annotations

from dataclasses import replace

import pytest
import torch
from small_networks import SMALL, random_fields, random_network, silhouettes

from kirigami_studio.foundation.errors import ModelError
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.generator.network import NetworkShape, VelocityNetwork
from kirigami_studio.generator.unet import UNetShape, UNetVelocity
from kirigami_studio.lab.training.learner import grown_state

pytestmark = pytest.mark.torch
OWN = DeployedGrid(4, 4)
ALL = {"direction": True, "preference": True, "sheets": True, "rims": True}


def grown(network: VelocityNetwork, shape: NetworkShape) -> VelocityNetwork:
    result = VelocityNetwork(shape)
    result.load_state_dict(grown_state(network, shape))
    return result.eval().requires_grad_(False)


@pytest.mark.parametrize("new", [{"direction": True}, {"preference": True}, {"sheets": True}, ALL], ids=str)
@pytest.mark.parametrize("grid", [OWN, DeployedGrid(6, 5, 0.7)], ids=str)
def test_that_a_grown_network_gives_the_same_velocity(new: dict[str, bool], grid: DeployedGrid) -> None:
    network = random_network(direction=False)
    larger = grown(network, replace(network.shape, **new))
    targets = silhouettes(random_fields(grid, 4), grid)
    z, t = random_fields(OWN, 4, 0.6, seed=1), torch.linspace(0, 0.9, 4)
    asked = torch.tensor([0.0, 1.0, 0.5, 1.0])
    ours = larger(z, t, larger.code(targets, preference=asked, grid=grid))
    theirs = network(z, t, network.code(targets, grid=grid))
    assert float(theirs.abs().mean()) > 0.05
    torch.testing.assert_close(ours, theirs, atol=1e-4, rtol=1e-4)
    assert larger.corrects
    assert (larger.follow is not None) == (larger.amend is not None) == new.get("direction", False)


def test_that_a_grown_corrector_begins_as_the_plain_gauss_newton_step() -> None:
    network = random_network(direction=False)
    larger = grown(network, replace(SMALL, **ALL))
    z, targets = random_fields(OWN, 4, seed=1), silhouettes(random_fields(OWN, 4), OWN)
    code = larger.code(targets, preference=torch.ones(4))
    assert code.feedback is not None
    step = code.feedback(z, code.loop, True, code.variation_cost).direction
    assert float(step.abs().mean()) > 0.01
    assert torch.equal(larger.correction(z, code), step)
    assert torch.equal(network.correction(z, network.code(targets, preference=torch.ones(4))), step)


def test_that_a_corrector_that_has_learnt_keeps_what_it_knows() -> None:
    network = random_network()
    assert network.follow is not None
    torch.nn.init.normal_(network.follow.weight)
    larger = grown(network, replace(SMALL, **ALL))
    z, targets = random_fields(OWN, 4, seed=1), silhouettes(random_fields(OWN, 4), OWN)
    torch.testing.assert_close(
        larger.correction(z, larger.code(targets)), network.correction(z, network.code(targets)), atol=1e-4, rtol=1e-4
    )


def test_that_the_same_shape_keeps_every_weight() -> None:
    network = random_network(preference=True)
    state = grown_state(network, network.shape)
    assert state.keys() == network.state_dict().keys()
    assert all(torch.equal(value, state[name]) for name, value in network.state_dict().items())


def test_that_the_network_it_grew_from_is_not_written_to() -> None:
    network = random_network(direction=False)
    before = {name: value.clone() for name, value in network.state_dict().items()}
    larger = grown(network, replace(SMALL, **ALL))
    for value in larger.parameters():
        value.add_(1.0)
    assert all(torch.equal(value, before[name]) for name, value in network.state_dict().items())


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ({}, {"width": 40}), ({}, {"blocks": 2}), ({}, {"loop_points": 48}), ({}, {"rows": 5}), ({}, {"z_scale": 0.4}),
        ({}, {"direction": False}), ({"preference": True}, {"preference": False}),
        ({"sheets": True}, {"sheets": False}),
        ({"direction": False, "sheets": True}, {"direction": True, "sheets": False}),
        ({"sheets": True, "rims": True}, {"rims": False}),
    ],
)  # fmt: skip
def test_that_shapes_that_differ_elsewhere_or_see_less_are_refused(
    old: dict[str, object], new: dict[str, object]
) -> None:
    network = random_network(**old)
    with pytest.raises(ModelError) as caught:
        grown_state(network, replace(network.shape, **new))  # type: ignore[arg-type]
    assert caught.value.code == "training.other_network"


def test_that_a_unet_does_not_grow_into_a_perceptron_or_back() -> None:
    picture = UNetShape(4, 4, channels=(8, 16))
    with pytest.raises(ModelError) as caught:
        grown_state(UNetVelocity(picture), SMALL)
    assert caught.value.code == "training.other_network"
    with pytest.raises(ModelError) as caught:
        grown_state(random_network(), picture)
    assert caught.value.code == "training.other_network"
