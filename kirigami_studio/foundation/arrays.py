"""Array types of signatures; shape and unit stand in the docstring beside them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.intp]
BoolArray = npt.NDArray[np.bool_]
#: An outer ring (L, 2), or one and the holes in it; None for no shape.
ShapeRings: TypeAlias = FloatArray | Sequence[FloatArray] | None


def as_rings(shape: ShapeRings) -> tuple[FloatArray, ...]:
    """The outer ring of a shape, then its holes; nothing for none."""
    if shape is None:
        return ()
    return (shape,) if isinstance(shape, np.ndarray) else tuple(shape)
