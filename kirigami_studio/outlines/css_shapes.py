"""Basic shapes of CSS, such as ``circle(40% at 50% 50%)``, as the rings of clip paths."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import tinycss2 as untyped_tinycss2
from shapely.geometry import box

from kirigami_studio.foundation.arrays import FloatArray

#: Its calls carry no types.
tinycss2: Any = untyped_tinycss2

#: Vertices of an ellipse, whose chords are nearer to it than to what is flattened otherwise, and of a quarter circle.
ELLIPSE_VERTICES, QUARTER = 128, 32
#: Share of a side that a rounded corner takes at most: at half of it nothing would be left between two.
ROUNDEST = 0.499999
PLACES = {"left": 0.0, "top": 0.0, "center": 0.5, "right": 1.0, "bottom": 1.0}
#: Which of one to four stated widths are those of the top, right, bottom and left.
SIDES = {1: (0, 0, 0, 0), 2: (0, 1, 0, 1), 3: (0, 1, 2, 1), 4: (0, 1, 2, 3)}
#: Length of a word in user units; percentages are of the second argument.
Length = Callable[[str, float], float]


@dataclass(frozen=True, slots=True)
class BasicShape:
    """A stated shape that is laid into a box when it is known."""

    kind: str
    arguments: tuple[tuple[str, ...], ...]  #: the words between commas
    reference: str  #: "fill-box", "stroke-box", "view-box" ... or ""

    def ring(self, around: tuple[float, float, float, float], length: Length) -> tuple[FloatArray, bool] | None:
        """The ring (L, 2) in a box of left, top, right and bottom, and whether it is even-odd.

        None where it is not understood.
        """
        left, top, right, bottom = around
        size = np.array([right - left, bottom - top])
        corner = np.array([left, top])
        words = [word for some in self.arguments for word in some]
        if self.kind == "polygon":
            return _polygon(self.arguments, corner, size, length)
        if self.kind == "inset":
            found = _inset(words, around, size, length)
        elif self.kind in ("circle", "ellipse"):
            found = _ellipse(self.kind, words, corner, size, length)
        else:
            return None
        return None if found is None or not np.isfinite(found).all() else (found, False)


def basic_shape(text: str) -> BasicShape | None:
    """The shape that a value of ``clip-path`` states; None where it states none."""
    tokens = [one for one in tinycss2.parse_component_value_list(text) if one.type not in ("whitespace", "comment")]
    functions = [one for one in tokens if one.type == "function"]
    words = [one.lower_value for one in tokens if one.type == "ident"]
    if len(functions) != 1 or len(words) > 1 or len(tokens) != len(words) + 1:
        return None
    parts: list[list[str]] = [[]]
    for one in functions[0].arguments:
        if one == ",":
            parts.append([])
        elif one.type not in ("whitespace", "comment"):
            parts[-1].append(tinycss2.serialize([one]).lower())
    return BasicShape(functions[0].lower_name, tuple(map(tuple, parts)), words[0] if words else "")


def _polygon(
    arguments: Sequence[tuple[str, ...]], corner: FloatArray, size: FloatArray, length: Length
) -> tuple[FloatArray, bool] | None:
    rule = arguments[0][0] if len(arguments[0]) == 1 else ""
    pairs = arguments[1:] if rule else arguments
    if len(pairs) < 3 or any(len(pair) != 2 for pair in pairs):
        return None
    points = [[length(word, size[axis]) for axis, word in enumerate(pair)] for pair in pairs]
    ring = corner + np.array(points)
    return (ring, rule == "evenodd") if np.isfinite(ring).all() else None


def _ellipse(kind: str, words: list[str], corner: FloatArray, size: FloatArray, length: Length) -> FloatArray | None:
    at = words.index("at") if "at" in words else len(words)
    stated, place = words[:at], words[at + 1 :] or ["center"]
    if len(place) > 2 or len(stated) > (1 if kind == "circle" else 2):
        return None
    place = [*place, "center"][:2]
    if place[0] in ("top", "bottom") or place[1] in ("left", "right"):
        place.reverse()
    middle = np.array(
        [PLACES[word] * size[axis] if word in PLACES else length(word, size[axis]) for axis, word in enumerate(place)]
    )
    to_sides = np.column_stack([middle, size - middle])
    stated = stated or ["closest-side"]
    radii = []
    for axis, word in enumerate(stated if kind == "circle" else [*stated, stated[-1]][:2]):
        sides = np.abs(to_sides if kind == "circle" else to_sides[axis])
        whole = float(np.hypot(*size)) / np.sqrt(2.0) if kind == "circle" else float(size[axis])
        known = {"closest-side": float(np.min(sides)), "farthest-side": float(np.max(sides))}
        radii.append(known[word] if word in known else length(word, whole))
    if not min(radii) >= 0.0:
        return None
    angle = np.linspace(0.0, 2.0 * np.pi, ELLIPSE_VERTICES, endpoint=False)
    ring = np.column_stack([radii[0] * np.cos(angle), radii[-1] * np.sin(angle)])
    return np.asarray(corner + middle + ring, dtype=np.float64)


def _inset(
    words: list[str], around: tuple[float, float, float, float], size: FloatArray, length: Length
) -> FloatArray | None:
    at = words.index("round") if "round" in words else len(words)
    stated, radii = words[:at], words[at + 1 :]
    if not 1 <= len(stated) <= 4 or len(radii) > 1:
        return None
    top, right, bottom, left = (stated[index] for index in SIDES[len(stated)])
    x0, x1 = around[0] + length(left, size[0]), around[2] - length(right, size[0])
    y0, y1 = around[1] + length(top, size[1]), around[3] - length(bottom, size[1])
    if x0 >= x1 or y0 >= y1:
        return np.zeros((0, 2))
    radius = min(length(radii[0], size[0]), ROUNDEST * (x1 - x0), ROUNDEST * (y1 - y0)) if radii else 0.0
    inner = box(x0 + radius, y0 + radius, x1 - radius, y1 - radius)
    rounded = inner.buffer(radius, quad_segs=QUARTER) if radius > 0.0 else inner
    return np.asarray(rounded.exterior.coords[:-1], dtype=np.float64)
