"""JSON tables of vertices -> Outline."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NoReturn

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.source_file import decoding, read_bytes

#: Keys under which an object may hold its vertices, the first present one counts.
VERTEX_KEYS = ("outline", "points")
UNITS = ("mm", "px")


def read_json(path: str | Path) -> Outline:
    """Read ``[[x, y], ...]``, ``{"outline": [[x, y], ...]}`` or ``{"points": [[x, y], ...]}``, y up.

    An object may also carry ``"name"`` and ``"unit"`` ("mm" or "px").

    Raises
    ------
    TargetError
        Not JSON, not such a table, not finite numbers, or not one simple shape.
    """
    path = Path(path)
    content = read_bytes(path)
    with decoding(path, "a JSON outline"):
        stored = json.loads(content.decode("utf-8-sig"), parse_constant=_refuse_constant)
        name, unit = path.stem, ""
        while isinstance(stored, dict):
            name = stored["name"] if isinstance(stored.get("name"), str) else name
            unit = stored["unit"] if stored.get("unit") in UNITS else unit
            key = next((key for key in VERTEX_KEYS if key in stored), None)
            if key is None:
                raise TargetError('The file has no "outline": [[x, y], ...] and no "points": [[x, y], ...].')
            stored = stored[key]
        return Outline.from_points(_vertices(stored), name=name, unit=unit)


def _refuse_constant(constant: str) -> NoReturn:
    raise TargetError(f"The file contains {constant}; every coordinate must be a finite number.")


def _vertices(stored: Any) -> list[tuple[float, float]]:
    """Check every vertex by hand: numpy would read the text "1" and the truth value true as numbers."""
    if not isinstance(stored, list):
        raise TargetError(f"The outline must be a list of [x, y] pairs, got {_shown(stored)}.")
    for index, vertex in enumerate(stored, start=1):
        if not (isinstance(vertex, list) and len(vertex) == 2 and all(_is_number(value) for value in vertex)):
            raise TargetError(
                f"Vertex {index} of the outline is {_shown(vertex)}; it must be a pair [x, y] of numbers."
            )
    return [(float(x), float(y)) for x, y in stored]


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _shown(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) <= 40 else text[:37] + "..."
