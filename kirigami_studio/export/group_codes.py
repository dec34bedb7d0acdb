"""The second reader of DXF: group codes straight from the text, without any DXF library.

A DXF is a list of pairs: a line with a code, a line with a value.  This reader knows the few pairs that a cut file
consists of and names everything else, so that it can disagree with the library that wrote the file.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from kirigami_studio.export.dxf_reading import LARGEST_FILE
from kirigami_studio.export.file_content import FileContent
from kirigami_studio.export.strokes import Stroke
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import read_at_most

Pair = tuple[int, str]
CLOSED_FLAG = 1
#: Kinds of entities that a cut file consists of.
STROKES = ("LWPOLYLINE", "POLYLINE", "CIRCLE")


@dataclass(slots=True)
class _Entity:
    """Pairs of one entity, and the vertices that follow a POLYLINE."""

    kind: str
    pairs: list[Pair] = field(default_factory=list)
    vertices: list[_Entity] = field(default_factory=list)

    def first(self, code: int, otherwise: str) -> str:
        return next((value for number, value in self.pairs if number == code), otherwise)


def read_group_codes(path: Path) -> FileContent:
    """Read a DXF's header, layers and polylines.

    Raises
    ------
    ExportError
        Not a list of pairs, or a polyline without coordinates.
    """
    try:
        sections = _sections(list(_pairs(read_at_most(path, LARGEST_FILE).decode("latin-1"))))
        header = _header(sections.get("HEADER", []))
        layers = {
            entity.first(2, ""): int(entity.first(62, "0"))
            for entity in _entities(sections.get("TABLES", []))
            if entity.kind == "LAYER"
        }
        entities = _with_vertices(_entities(sections.get("ENTITIES", [])))
        strokes = tuple(_stroke(entity) for entity in entities if entity.kind in STROKES)
        unit = header.get("$INSUNITS", {}).get(70)
        code = None if unit is None else int(unit)
        corner = header.get("$EXTMAX", {})
        size = (float(corner[10]), float(corner[20])) if 10 in corner and 20 in corner else None
    except (ValueError, ArithmeticError, LookupError, OSError) as error:
        raise ExportError("dxf.not_readable", path=path, reason=str(error)) from error
    others = tuple(entity.kind for entity in entities if entity.kind not in STROKES)
    return FileContent(
        reader="the group-code reader",
        strokes=strokes,
        unit=code,
        extent=size,
        layers=layers,
        others=others,
    )


def _pairs(text: str) -> Iterator[Pair]:
    lines = text.splitlines()
    for code, value in zip(lines[::2], lines[1::2], strict=False):
        yield int(code), value.strip()


def _sections(pairs: list[Pair]) -> dict[str, list[Pair]]:
    found: dict[str, list[Pair]] = {}
    name: str | None = None
    for index, pair in enumerate(pairs):
        if pair == (0, "SECTION"):
            name = pairs[index + 1][1] if index + 1 < len(pairs) else ""
            found[name] = []
        elif pair == (0, "ENDSEC"):
            name = None
        elif name is not None:
            found[name].append(pair)
    if not pairs or pairs[-1] != (0, "EOF"):
        raise ValueError("its end is missing")
    return found


def _header(pairs: list[Pair]) -> dict[str, dict[int, str]]:
    variables: dict[str, dict[int, str]] = {}
    name = ""
    for code, value in pairs:
        if code == 9:
            name = value
            variables[name] = {}
        elif name:
            variables[name][code] = value
    return variables


def _entities(pairs: list[Pair]) -> list[_Entity]:
    found: list[_Entity] = []
    for code, value in pairs:
        if code == 0:
            found.append(_Entity(value))
        elif found:
            found[-1].pairs.append((code, value))
    return found


def _with_vertices(entities: list[_Entity]) -> list[_Entity]:
    """Give every POLYLINE the VERTEX entities that follow it."""
    found: list[_Entity] = []
    for entity in entities:
        if entity.kind == "VERTEX" and found and found[-1].kind == "POLYLINE":
            found[-1].vertices.append(entity)
        elif entity.kind != "SEQEND":
            found.append(entity)
    return found


def _stroke(entity: _Entity) -> Stroke:
    layer, colour = entity.first(8, ""), int(entity.first(62, "256"))
    if entity.kind == "CIRCLE":
        x, y, radius = (float(entity.first(code, "nan")) for code in (10, 20, 40))
        return Stroke.round(np.array([x, y]), 2.0 * radius, layer, colour)
    rows: list[list[float]] = []
    if entity.kind == "POLYLINE":
        rows = [[float(vertex.first(code, "0")) for code in (10, 20, 42)] for vertex in entity.vertices]
    else:
        for code, value in entity.pairs:
            if code == 10:
                rows.append([float(value), 0.0, 0.0])
            elif code in (20, 42) and rows:
                rows[-1][1 if code == 20 else 2] = float(value)
    table = np.array(rows, dtype=np.float64).reshape(-1, 3)
    if not len(table):
        raise ValueError("a polyline has no points")
    return Stroke(
        points=table[:, :2],
        closed=bool(int(entity.first(70, "0")) & CLOSED_FLAG),
        layer=layer,
        colour=colour,
        bulges=table[:, 2] if table[:, 2].any() else None,
    )
