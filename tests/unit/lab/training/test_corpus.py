"""Batches of a data set, visited over and over."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lab.training.corpus import ChunkBatches, FixedDesigns
from kirigami_studio.lab.training.dataset import designs_of, digest_of_designs, generate_split
from kirigami_studio.lab.training.fields import released_fields

pytestmark = pytest.mark.torch
CPU = torch.device("cpu")


def test_that_a_pass_visits_every_design_once_and_the_next_one_in_another_order() -> None:
    z = released_fields(12, 4, 4, np.random.default_rng(0))
    batches = ChunkBatches(FixedDesigns(10.0**z, 4, 4, seed=1, device=CPU), batch=4, passes=2)
    passes = [torch.cat([batches.at(3 * sweep + step).z for step in range(3)]) for sweep in range(3)]
    for seen in passes:
        assert torch.allclose(
            seen.sort(dim=0).values, torch.tensor(z, dtype=torch.float32).flatten(1).sort(dim=0).values, atol=1e-6
        )
    assert not torch.equal(passes[0], passes[1])
    assert not torch.equal(passes[1], passes[2])


def test_that_designs_of_another_grid_or_too_few_are_refused() -> None:
    split = generate_split("released", 3, seed=0, grid=(4, 4))
    with pytest.raises(UsageError) as caught:
        designs_of("released", split, 5, 5, 0, 64, CPU)
    assert caught.value.code == "training.designs_of_other_grid"
    with pytest.raises(UsageError) as caught:
        ChunkBatches(designs_of("released", split, 4, 4, 0, 64, CPU), batch=4, passes=1)
    assert caught.value.code == "training.too_few_designs"
    with pytest.raises(UsageError, match="released"):
        designs_of("fractal", None, 4, 4, 0, 64, CPU)
    assert digest_of_designs(split) == split.about["sha256"] and digest_of_designs(None) == ""
