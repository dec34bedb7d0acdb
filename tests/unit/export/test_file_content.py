"""Strokes as a reader has them, beside those that were meant."""

from __future__ import annotations

import math

import numpy as np

from kirigami_studio.export.file_content import bent_otherwise
from kirigami_studio.export.strokes import Stroke


def bent(*bulges: float, closed: bool = True) -> Stroke:
    """A stroke with a bulge at each of its points; straight without."""
    points = np.zeros((len(bulges) or 2, 2))
    return Stroke(points, closed, "SLITS", 1, bulges=np.array(bulges) if bulges else None)


def test_that_strokes_with_other_arcs_are_counted_whatever_others_have() -> None:
    open_end = bent(0.5, 0.9, closed=False), bent(0.5, 0.1, closed=False)  # nothing follows its last point
    pairs = [(bent(), bent()), (bent(1.0, 1.0), bent(1.0, 1.001)), (bent(0.5, 0.2), bent()), open_end]
    found, meant = zip(*pairs, strict=True)
    assert bent_otherwise(found, meant, 1e-6) == 2
    assert bent_otherwise(found, meant, 1e-2) == 1
    assert bent_otherwise(found, found, 1e-6) == bent_otherwise(found[:1], meant[:1], 1e-6) == 0
    assert bent_otherwise([bent(math.nan, 1.0)], [bent(1.0, 1.0)], 1.0) == 1
