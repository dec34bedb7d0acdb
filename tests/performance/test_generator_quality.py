"""What the bundled generator is worth: one sample, four steps, no polish.  ``pytest -s`` prints the figures."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from kirigami_studio.lab.benchmark.generator_suite import measure_generator
from kirigami_studio.lab.training.dataset import SPLITS, generate_split
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.read_image import outline_of_mask

pytestmark = pytest.mark.torch


@cache
def unseen_targets(family: str) -> tuple[Outline, ...]:
    """The first 60 test targets of a family; every variant is given the same."""
    split = generate_split(family, 60, SPLITS["test"][1])
    return tuple(outline_of_mask(mask, family) for mask in split.masks)


@pytest.mark.parametrize(
    ("family", "variant", "bar"),
    [
        # One family after the other: what is tabulated of 60 targets is kept for the second variant.
        ("structured", "prior", 0.98),
        ("structured", "accuracy", 0.985),
        ("sobol", "prior", 0.97),
        ("sobol", "accuracy", 0.975),
    ],
)
def test_that_one_sample_matches_unseen_targets(family: str, variant: str, bar: float) -> None:
    figures = measure_generator(list(unseen_targets(family)), variant, seeds=(0,))
    print(f"\n{family}, {variant}: mean sIoU {figures['siou']:.4f} (uniform layout {figures['uniform_siou']:.4f})")
    assert figures["siou"] >= bar
    assert figures["infeasible"] == 0


@pytest.mark.parametrize(("family", "part", "bar"), [("sobol", slice(16), 0.97), ("structured", slice(16, 32), 0.98)])
def test_that_one_sample_matches_the_reference_silhouettes(
    oracle_file: Path, family: str, part: slice, bar: float
) -> None:
    with np.load(oracle_file) as archive:
        masks = np.unpackbits(archive["10x10_mask"], axis=-1).astype(bool)[part]
    figures = measure_generator([outline_of_mask(mask, family) for mask in masks], "prior")
    print(f"\nreference {family}: mean sIoU {figures['siou']:.4f} (uniform layout {figures['uniform_siou']:.4f})")
    assert figures["siou"] >= bar
    assert figures["infeasible"] == 0
