"""Cut SVGs as svgelements reads them: path data by its own lexer, without an object for each corner."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
import svgelements
from ezdxf.entities.lwpolyline import LWPolylinePoints
from ezdxf.lldxf.types import DXFTag

from kirigami_studio.export import dxf
from kirigami_studio.export.strokes import Stroke, extent
from kirigami_studio.export.svg import strokes_svg, write_svg
from kirigami_studio.export.svg_reading import read_with_svgelements, read_with_xml
from kirigami_studio.foundation.errors import ExportError

SQUARE = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 5.0], [0.0, 5.0]])
#: An outline with a bend, and a hole.
STROKES = (
    Stroke(SQUARE, True, "CUT", 1, np.array([0.0, 0.5, 0.0, 0.0])),
    Stroke.round(np.array([4.0, 2.5]), 2.0, "CUT", 1),
)


def svg_of(path: Path, data: str) -> Path:
    """A drawing of 20 x 10 mm with one path."""
    head = '<svg xmlns="http://www.w3.org/2000/svg" width="20mm" height="10mm" viewBox="0 0 20 10">'
    path.write_text(f'{head}<g id="CUT"><path d="{data}" stroke="#ff0000"/></g></svg>')
    return path


@pytest.mark.parametrize(
    "data",
    ["M1,2 L5,2 L5,6 Z", "m1 2 4 0 0 4z", "M1,2H5V6h-2v-1Z", "M1,2 A2,2 0 0 1 5,2 L5,6", "m1,2a2 2 0 1 0 4 0l1 1"],
)
def test_that_path_data_is_read_as_svgelements_reads_it(tmp_path: Path, data: str) -> None:
    (found,) = read_with_svgelements(svg_of(tmp_path / "one.svg", data)).strokes
    parts = [part for part in cast(Any, svgelements).Path(data) if not isinstance(part, svgelements.Close)]
    assert found.closed == (data[-1] in "zZ")
    assert found.points == pytest.approx(np.array([[part.end.x, 10.0 - part.end.y] for part in parts]), abs=1e-12)
    bent = {number: part for number, part in enumerate(parts, start=-1) if isinstance(part, svgelements.Arc)}
    assert (found.bulges is None) == (not bent)
    for number, arc in bent.items():
        assert found.bulges is not None
        assert found.bulges[number] == pytest.approx(-math.tan(float(cast(Any, arc).sweep) / 4.0), abs=1e-12)


def test_that_a_curve_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ExportError):
        read_with_svgelements(svg_of(tmp_path / "one.svg", "M1,2 C1,3 2,4 5,6 Z"))


def test_that_damaged_path_data_is_refused_with_its_words(tmp_path: Path) -> None:
    with pytest.raises(ExportError, match="path data 'M1,2 L5' is damaged"):
        read_with_svgelements(svg_of(tmp_path / "one.svg", "M1,2 L5"))


def test_that_no_corner_becomes_an_object_and_both_readers_agree(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[object] = []
    monkeypatch.setattr(svgelements.Line, "__init__", lambda self, *_, **__: made.append(self))
    path = tmp_path / "bed.svg"
    write_svg(strokes_svg(STROKES, "bed", {}, 96.0, b""), path, len(STROKES), extent(STROKES))
    one, other = read_with_svgelements(path).strokes, read_with_xml(path).strokes
    assert not made
    for first, second, meant in zip(one, other, STROKES, strict=True):
        assert first.points == pytest.approx(second.points, abs=1e-9)
        assert first.points == pytest.approx(meant.points, abs=1e-4)
        assert first.bulges == pytest.approx(second.bulges, abs=1e-6)


def test_that_corners_in_dxf_are_written_in_one_go_as_ezdxf_writes_them(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[object] = []
    written = LWPolylinePoints.dxftags

    def counted(self: LWPolylinePoints) -> Iterator[DXFTag]:
        made.append(self)
        return written(self)

    monkeypatch.setattr(LWPolylinePoints, "dxftags", counted)
    at_once = dxf.strokes_dxf(STROKES, extent(STROKES), "R2010", {})
    assert not made
    monkeypatch.setattr(dxf, "_Corners", LWPolylinePoints)
    assert dxf.strokes_dxf(STROKES, extent(STROKES), "R2010", {}) == at_once
    assert made
