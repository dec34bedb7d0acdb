"""Files as people have them: inputs that failed once, and those that must stay right."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.read import read_target

WILD = Path(__file__).resolve().parents[2] / "data" / "wild"
EXPECTED = {
    f"{folder}/{name}": expected
    for folder in ("svg", "other")
    for name, expected in json.loads((WILD / folder / "expected.json").read_text(encoding="utf-8")).items()
}


@pytest.mark.parametrize("name", EXPECTED)
def test_that_the_silhouette_is_the_one_that_is_seen(name, iou) -> None:
    expected = EXPECTED[name]
    try:
        outline = read_target(WILD / name)
    except TargetError:
        assert expected["kind"] == "shape_or_refusal"
        return
    assert iou(outline.filled, Outline.from_points(expected["ring"])) >= expected["min_iou"]
    if "size_mm" in expected:
        assert outline.unit == "mm" and outline.size == pytest.approx(expected["size_mm"], rel=0.02)
