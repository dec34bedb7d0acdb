"""Values of the Python API go through pickles and copies: work over many targets runs in several processes."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from multiprocessing import get_context
from typing import Any

import numpy as np
import pytest

import kirigami_studio as ks

WAYS: tuple[Callable[[Any], Any], ...] = (
    lambda value: pickle.loads(pickle.dumps(value)),
    copy.deepcopy,
    copy.copy,
)


def same(one: object, other: object) -> bool:
    """Whether two values hold the same, field by field."""
    if type(one) is not type(other):
        return False
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other)
    if isinstance(one, (list, tuple)):
        return len(one) == len(other) and all(same(a, b) for a, b in zip(one, other, strict=True))
    if is_dataclass(one):
        return all(same(getattr(one, field.name), getattr(other, field.name)) for field in fields(one))
    return one == other


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("value", ["hearts", "heart", "cuts", "design", "uneven"])
def test_that_values_come_back_from_pickles_and_copies(
    value: str, way: Callable[[Any], Any], request: pytest.FixtureRequest
) -> None:
    before = request.getfixturevalue("hearts").best if value == "heart" else request.getfixturevalue(value)
    after = way(before)
    if isinstance(before, ks.Designs):
        assert len(after) == len(before) and after.best.name == before.best.name
        before, after = before.best, after.best
    assert same(after, before)
    assert repr(after) == repr(before)


def test_that_cuts_of_a_design_of_a_project_come_back_with_their_origin(hearts: ks.Designs) -> None:
    made = hearts.best.plan_cuts(material="film-uv", width_mm=80)
    again = pickle.loads(pickle.dumps(made))
    assert same(again.plan, made.plan) and again.design.document.provenance == made.design.document.provenance
    assert len(made.design.document.provenance) > 0
    with pytest.raises(TypeError):
        again.design.document.provenance["model"] = "another"


def _matched(design: ks.Design) -> float:
    return design.iou


def test_that_designs_go_to_another_process(hearts: ks.Designs) -> None:
    with get_context("spawn").Pool(1) as pool:
        assert pool.map(_matched, list(hearts)[:2]) == [design.iou for design in list(hearts)[:2]]
