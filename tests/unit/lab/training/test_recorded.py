"""Steps that a GPU replays; without one only that they are refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
import torch

from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.generator.unet import UNetShape
from kirigami_studio.lab.training.fitted_fields import fitted_block
from kirigami_studio.lab.training.recorded import own_stream
from kirigami_studio.lab.training.train_baseline import BaselineRun, BaselineSettings, train_baseline
from kirigami_studio.lab.training.train_flow import FlowRun, FlowSettings, Sources, train_flow

pytestmark = pytest.mark.torch
CPU, GPU = torch.device("cpu"), torch.device("cuda")
FLOW = FlowSettings(
    batch=16,
    noises=1,
    chunk=64,
    outline_weight=0.0,
    shape=UNetShape(4, 4, channels=(8, 16), residuals=1, latent=8, mask=32, dropout=0.0),
)
CGAN = BaselineSettings("cgan", {"rows": 4, "columns": 4, "latent": 8, "mask": 32, "channels": [8, 16]}, chunk=64)


def test_that_steps_are_recorded_on_a_gpu_only(tmp_path: Path) -> None:
    with pytest.raises(UsageError) as caught:
        next(train_flow(FLOW, tmp_path, CPU, lambda network: {}, recorded=True))
    assert caught.value.code == "training.cannot_record"
    with pytest.raises(UsageError) as caught:
        next(train_baseline(CGAN, tmp_path, CPU, lambda network: {}, recorded=True))
    assert caught.value.code == "training.cannot_record"


def test_that_fits_are_not_recorded(tmp_path: Path) -> None:
    fits = fitted_block(0, seed=1, grid=(4, 4), size=4)
    settings = replace(FLOW, fits=fits.digest)
    with pytest.raises(UsageError) as caught:
        next(train_flow(settings, tmp_path, CPU, lambda network: {}, sources=Sources(fits=fits), recorded=True))
    assert caught.value.code == "training.fits_not_recorded"


@pytest.mark.skipif(not torch.cuda.is_available(), reason="no GPU")
@pytest.mark.parametrize("kind", ["independent", "ot", "conditional-ot", "cgan"])
def test_that_recorded_steps_lose_as_much_as_plain_ones(kind: str, tmp_path: Path) -> None:
    def losses(recorded: bool) -> list[float]:
        with own_stream(GPU, recorded):
            run = (
                BaselineRun(CGAN, tmp_path / "none", GPU, None, recorded)
                if kind == "cgan"
                else FlowRun(replace(FLOW, coupling=kind), tmp_path / "none", GPU, Sources(), recorded)
            )
            return [run.advance()["loss"] for _ in range(12)]

    assert losses(recorded=True) == pytest.approx(losses(recorded=False), rel=1e-4)
