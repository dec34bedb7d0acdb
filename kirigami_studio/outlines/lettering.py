"""Letters -> one piece, as a sheet is: each is moved until it overlaps the one before.

The dot of an i and the dots of an umlaut are joined to their letter by a bridge.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from shapely.affinity import translate
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines.figures import BoundingBox
from kirigami_studio.outlines.pieces import largest_piece

#: Least width of the joint between two letters, as a share of the height of the text.
JOINT = 0.08
#: Steps in which letters are moved together, as a share of the height of the text.
STEP = 0.02
MOST_LETTERS = 24


def joined_letters(letters: Sequence[Sequence[FloatArray]]) -> tuple[Polygon, tuple[str, ...]]:
    """Return the outline of a word, with counters such as that of an o.

    Parameters
    ----------
    letters : sequence of letters, each a sequence of (L, 2) float rings, any unit, y up
        Each letter where it stands in the line; its rings by the even-odd rule.

    Returns
    -------
    word : shapely.Polygon
    notes : tuple of str
        What was left out.

    Raises
    ------
    TargetError
        No letter has an outline, or too many do.
    """
    shapes = [_bridged(shape) for shape in (_painted(rings) for rings in letters) if shape.area > 0]
    if not shapes:
        raise TargetError("text.no_letters")
    if len(shapes) > MOST_LETTERS:
        raise TargetError("text.too_many_letters", limit=MOST_LETTERS, letters=len(shapes))
    height = max(shape.bounds[3] - shape.bounds[1] for shape in shapes)
    word = shapes[0]
    for shape in shapes[1:]:
        word = word.union(_pushed(word, shape, height))
    return largest_piece(word)


def _painted(rings: Sequence[FloatArray]) -> BaseGeometry:
    shape: BaseGeometry = Polygon()
    for ring in rings:
        if len(ring) >= 3:
            shape = shape.symmetric_difference(shapely.make_valid(Polygon(ring)))
    return shape


def _bridged(letter: BaseGeometry) -> BaseGeometry:
    """Hold the parts of a letter together by bridges between their nearest places."""
    parts = sorted(shapely.get_parts(letter), key=lambda part: float(part.area), reverse=True)
    whole: BaseGeometry = parts[0]
    height = letter.bounds[3] - letter.bounds[1]
    for part in parts[1:]:
        # From the middle of the smaller part straight to the larger one, and a little into it.
        way = shapely.shortest_line(part.centroid, whole)
        whole = whole.union(part).union(way.buffer(0.5 * JOINT * height, cap_style="square"))
    return whole


def _pushed(word: BaseGeometry, letter: BaseGeometry, height: float) -> BaseGeometry:
    """Move a letter left until it overlaps the word over a joint that holds."""
    low, high = letter.bounds[0], word.bounds[2]
    far = letter.bounds[2] - word.bounds[0]
    apart = high - low + 0.05 * height  # as if the letter stood right behind the word
    for shift in np.arange(apart, apart - far, -STEP * height).tolist():
        common = word.intersection(translate(letter, shift))
        if common.area > 0 and common.bounds[3] - common.bounds[1] >= JOINT * height:
            return translate(letter, shift)
    return translate(letter, high - low - JOINT * height)


def lettered(letters: Sequence[Sequence[FloatArray]], box: BoundingBox) -> tuple[Polygon, tuple[str, ...]]:
    """The word that fills a box as far as its proportions allow, in the middle of it.

    Raises
    ------
    TargetError
        As :func:`joined_letters`, or a flat box.
    """
    word, notes = joined_letters(letters)
    if min(box.size) <= 0:
        raise TargetError("text.flat_box")
    low, high = np.array(word.bounds).reshape(2, 2)
    scale = float(np.min(np.array(box.size) / (high - low)))
    return shapely.transform(word, lambda points: (points - 0.5 * (low + high)) * scale + box.middle), notes
