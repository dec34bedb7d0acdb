"""The generators that the paper compares with: shapes, losses, noise schedule, storage."""

from __future__ import annotations

from pathlib import Path

import pytest
import torch

from kirigami_studio.foundation.errors import ModelError, UsageError
from kirigami_studio.generator.unet import UNetShape
from kirigami_studio.lab.baselines.cgan import Cgan
from kirigami_studio.lab.baselines.conditional import ConditionalGenerator, FieldPixels
from kirigami_studio.lab.baselines.cvae import Cvae
from kirigami_studio.lab.baselines.diffusion import Diffusion, kept_signal
from kirigami_studio.lab.baselines.stored import KINDS, generator_of, load_generator, store_generator

pytestmark = pytest.mark.torch

PIXELS = FieldPixels(4, 4, latent=8, mask=32)
SMALL = {
    "cvae": lambda: Cvae(PIXELS, (8, 8)),
    "cgan": lambda: Cgan(PIXELS, (8, 8), 8),
    "diffusion": lambda: Diffusion(UNetShape(4, 4, channels=(8, 16), residuals=1, latent=8, mask=32)),
}


def small(kind: str, seed: int = 0) -> ConditionalGenerator:
    torch.manual_seed(seed)
    return SMALL[kind]()


def square() -> torch.Tensor:
    return torch.tensor([[[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]])


@pytest.mark.parametrize("kind", KINDS)
def test_that_a_sample_has_a_field_for_every_mask_and_repeats_with_its_seed(kind: str) -> None:
    network = small(kind).eval()
    masks = network.pixels.masks(square().expand(3, -1, -1))
    first, again, other = (
        network.draw(masks, torch.Generator().manual_seed(seed), steps=3).detach() for seed in (1, 1, 2)
    )
    assert first.shape == (3, 16) and torch.equal(first, again) and not torch.equal(first, other)
    assert torch.isfinite(first).all()


@pytest.mark.parametrize("kind", KINDS)
def test_that_training_lowers_the_loss_on_one_batch(kind: str) -> None:
    network = small(kind)
    generator = torch.Generator().manual_seed(0)
    z = torch.linspace(-0.8, 0.8, 16).expand(16, -1)
    masks = network.pixels.masks(square().expand(16, -1, -1))
    optimiser = torch.optim.Adam(network.parameters(), lr=5e-3)
    losses = []
    for _ in range(30):
        loss = network.loss(z, masks, generator)
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        losses.append(float(loss.detach()))
    assert sum(losses[-10:]) < 0.9 * sum(losses[:10])


def test_that_the_divergence_of_an_autoencoder_counts_by_its_weight(tmp_path: Path) -> None:
    z, masks = torch.linspace(-0.8, 0.8, 16).expand(2, -1), PIXELS.masks(square().expand(2, -1, -1))
    losses = []
    for weight in (0.0, 0.01, 0.02):
        torch.manual_seed(0)
        network = Cvae(PIXELS, (8, 8), kl_weight=weight)
        losses.append(float(network.loss(z, masks, torch.Generator().manual_seed(1)).detach()))
    assert losses[1] - losses[0] == pytest.approx(losses[2] - losses[1], rel=1e-3) and losses[1] > losses[0]
    path = store_generator("cvae", network, tmp_path / "cvae.safetensors", {})
    assert load_generator(path).network.settings()["kl_weight"] == 0.02


def test_that_the_diffusion_backbone_gets_the_mask() -> None:
    """Its gates begin at zero, so that it has to learn to look; with other weights, the noise depends on the mask."""
    network = small("diffusion").eval()
    masks = network.pixels.masks(torch.cat([square(), square() * torch.tensor([0.5, 2.0])]))
    with torch.no_grad():
        blind = network.draw(masks[:1], torch.Generator().manual_seed(0), 2)
        assert torch.equal(network.draw(masks[1:], torch.Generator().manual_seed(0), 2), blind)
        for parameter in network.parameters():
            parameter += 0.1 * torch.randn(parameter.shape, generator=torch.Generator().manual_seed(0))
        drawn = [network.draw(masks[place : place + 1], torch.Generator().manual_seed(0), 2) for place in (0, 1)]
    assert float((drawn[0] - drawn[1]).abs().max()) > 1e-3


@pytest.mark.parametrize("kind", ["cvae", "cgan"])
def test_that_what_is_drawn_follows_the_mask(kind: str) -> None:
    network = small(kind)
    optimiser = torch.optim.Adam(network.parameters(), lr=1e-2)
    generator = torch.Generator().manual_seed(0)
    tall = square() * torch.tensor([0.5, 2.0])
    masks = network.pixels.masks(torch.cat([square(), tall]))
    z = torch.stack([torch.full((16,), 0.6), torch.full((16,), -0.6)])
    for _ in range(80):
        loss = network.loss(z.repeat(4, 1), masks.repeat(4, 1, 1, 1), generator)
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
    with torch.no_grad():
        network.eval()
        right, wrong = (
            torch.stack([network.loss(z, seen, torch.Generator().manual_seed(seed)) for seed in range(20)]).mean()
            for seen in (masks, masks.flip(0))
        )
    assert float(right) < 0.9 * float(wrong)


def test_that_neither_player_of_the_cgan_moves_the_other() -> None:
    network = small("cgan")
    assert isinstance(network, Cgan)
    masks = network.pixels.masks(square().expand(2, -1, -1))
    for parameter in network.generator.parameters():
        parameter.requires_grad_(False)
    network.loss(torch.zeros((2, 16)), masks, torch.Generator().manual_seed(0)).backward()
    alone = [parameter.grad.clone() for parameter in network.discriminator.parameters() if parameter.grad is not None]
    network.zero_grad()
    for parameter in network.generator.parameters():
        parameter.requires_grad_(True)
    network.loss(torch.zeros((2, 16)), masks, torch.Generator().manual_seed(0)).backward()
    together = [parameter.grad for parameter in network.discriminator.parameters()]
    assert len(alone) == len(together)
    assert all(torch.allclose(a, b, atol=1e-7) for a, b in zip(alone, together, strict=True) if b is not None)
    assert any(
        float(parameter.grad.abs().max()) > 0
        for parameter in network.generator.parameters()
        if parameter.grad is not None
    )


def test_that_the_noise_schedule_is_the_papers() -> None:
    kept = kept_signal()
    assert kept.shape == (1000,) and bool((kept.diff() < 0).all())
    assert float(kept[0]) == pytest.approx(1 - 5e-4)
    assert float(kept[-1] / kept[-2]) == pytest.approx(1 - 1.95e-2)


def test_that_ddim_recovers_a_design_from_a_network_that_knows_it() -> None:
    """With the true noise in every state, each number of steps ends at the design."""

    class Knowing(Diffusion):
        def _noise(self, x: torch.Tensor, step: torch.Tensor, code: object) -> torch.Tensor:
            kept = self.signal[step][:, None]
            return (x - kept.sqrt() * design / self.pixels.z_scale) / (1.0 - kept).sqrt()

    design = torch.linspace(-0.8, 0.8, 16).expand(2, -1)
    network = Knowing(UNetShape(4, 4, channels=(8, 16), residuals=1, latent=8, mask=32))
    masks = network.pixels.masks(square().expand(2, -1, -1))
    for steps in (1, 4, 25, 1000):
        drawn = network.draw(masks, torch.Generator().manual_seed(0), steps).detach()
        assert torch.allclose(drawn, design, atol=1e-3)


@pytest.mark.parametrize("steps", [0, 1001])
def test_that_other_numbers_of_steps_are_refused(steps: int) -> None:
    network = small("diffusion")
    with pytest.raises(UsageError) as caught:
        network.draw(network.pixels.masks(square()), torch.Generator(), steps)
    assert caught.value.code == "model.diffusion_steps"


@pytest.mark.parametrize("kind", KINDS)
def test_that_stored_weights_draw_the_same(kind: str, tmp_path: Path) -> None:
    network = small(kind).half().float().eval()
    stored = load_generator(store_generator(kind, network, tmp_path / f"{kind}.safetensors", {"steps": 3}))
    masks = network.pixels.masks(square())
    ours, theirs = (
        one.draw(masks, torch.Generator().manual_seed(0), steps=2).detach() for one in (network, stored.network)
    )
    assert stored.kind == kind and stored.about == {"steps": 3} and torch.equal(ours, theirs)


def test_that_damaged_weights_and_unknown_kinds_are_refused(tmp_path: Path) -> None:
    (tmp_path / "cvae.safetensors").write_bytes(b"\x10" * 40)
    with pytest.raises(ModelError) as caught:
        load_generator(tmp_path / "cvae.safetensors")
    assert caught.value.code == "model.baseline_unreadable"
    with pytest.raises(UsageError) as unknown:
        generator_of("gan")
    assert unknown.value.code == "model.unknown_baseline"


@pytest.mark.parametrize("latent", [0, 6, 24])
def test_that_pixels_that_do_not_divide_are_refused(latent: int) -> None:
    with pytest.raises(UsageError) as caught:
        FieldPixels(latent=latent)
    assert caught.value.code == "model.baseline_pixels"


def test_that_fields_survive_their_way_through_pixels() -> None:
    pixels = FieldPixels(10, 10, latent=32)
    smooth = torch.linspace(-0.5, 0.5, 100)[None]
    assert torch.allclose(pixels.field(pixels.image(smooth)), smooth, atol=0.05)
