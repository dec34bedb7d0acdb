"""Sheet files: what is written is read back exactly, and what cannot be a sheet is refused in a sentence."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from uneven_sheets import uneven_sheet

from kirigami_studio.foundation.errors import KirigamiError, RatioError, SheetError
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.sheet_files import read_sheet, sheet_json, sheet_of_json
from tests.refusals import refused

RATIO = [[1.0, 2.0, 0.5], [0.8, 1.5, 1.0]]
RIM = {"top": [2.2], "right": [1.4], "bottom": [0.7, 2.9], "left": [1.1]}


def written(path: Path, content: object) -> Path:
    path.write_text(json.dumps(content))
    return path


@pytest.mark.parametrize("start", [False, True])
def test_that_a_sheet_comes_back_exactly(tmp_path: Path, start: bool) -> None:
    sheet = uneven_sheet(5, 6, seed=3, start=start)
    again = read_sheet(written(tmp_path / "sheet.json", sheet_json(sheet)))
    assert again == sheet and not again.has_even_rim
    assert set(sheet_json(sheet)) == {"ratio", "rim", "start", "cell"}


def test_that_only_the_ratios_are_required(tmp_path: Path) -> None:
    expected = Sheet(RatioField(np.array(RATIO)))
    np.save(tmp_path / "table.npy", np.array(RATIO))
    empty = {"ratio": RATIO, "rim": None, "start": None, "cell": None, "siou": 0.9}
    files = [
        written(tmp_path / f"{number}.json", content) for number, content in enumerate(({"ratio": RATIO}, RATIO, empty))
    ]
    for path in (*files, tmp_path / "table.npy"):
        assert read_sheet(path) == expected and read_sheet(path).is_default


def test_that_sides_that_a_rim_does_not_name_are_even() -> None:
    sheet = sheet_of_json({"ratio": RATIO, "rim": {"left": [1.25]}})
    assert sheet.rim.left.tolist() == [1.25]
    assert sheet.rim.bottom.tolist() == Sheet(sheet.field).rim.bottom.tolist()


def test_that_mouths_are_told_left_to_right_and_top_to_bottom() -> None:
    even = sheet_json(Sheet.uniform(4, 6))["rim"]
    assert isinstance(even, dict)
    assert all(values == sorted(values) for values in even.values())
    assert [len(even[side]) for side in ("top", "right", "bottom", "left")] == [3, 2, 3, 2]


SQUARE = [[0, 0], [3, 0], [3, -3], [0, -3]]


@pytest.mark.parametrize(
    ("change", "code", "words"),
    [
        ({"rim": [1, 2]}, "rim.not_four_sides", "A rim must be"),
        ({"rim": {**RIM, "front": []}}, "rim.not_four_sides", "A rim must be"),
        ({"rim": {**RIM, "top": [1.0, 2.0]}}, "rim.wrong_count", "top side: 2; a sheet of 2 x 3 voids needs 1"),
        (
            {"rim": {**RIM, "bottom": [2.9, 0.7]}},
            "rim.not_in_order",
            "bottom side must lie between 0 and 4 cells, in rising order",
        ),
        ({"rim": {**RIM, "left": [3.0]}}, "rim.not_in_order", "left side"),
        ({"rim": {**RIM, "left": [1e300]}}, "rim.not_in_order", "left side"),
        ({"rim": {**RIM, "left": [float("nan")]}}, "rim.not_numbers", "left side must be a list of finite"),
        ({"rim": {**RIM, "left": ["1.1"]}}, "rim.not_numbers", "left side must be a list of finite"),
        ({"rim": {**RIM, "left": [True]}}, "rim.not_numbers", "left side must be a list of finite"),
        ({"rim": {**RIM, "left": [[1.1]]}}, "rim.not_numbers", "left side must be a list of finite"),
        ({"rim": {**RIM, "left": {}}}, "rim.not_numbers", "left side must be a list of finite"),
        ({"rim": {**RIM, "left": [10**400]}}, "rim.not_numbers", "left side must be a list of finite"),
        ({"start": [[0, 0], [4, 0], [1, -1], [0, -4]]}, "start.not_convex", "not convex"),
        ({"start": [[0, 0], [3, -3], [3, 0], [0, -3]]}, "start.crosses_itself", "crosses itself"),
        ({"start": [[0, 0], [3, 0]]}, "start.not_points", "at least three points"),
        ({"start": "circle"}, "start.not_points", "at least three points"),
        ({"start": [[0, 0], [3, 0], [3, float("inf")]]}, "start.not_points", "at least three points"),
        ({"start": [[0, 0], [1e300, 0], [0, -1e300]]}, "start.size_out_of_range", "0.5 to 1000 cells"),
        ({"start": [[0, 0], [1e-9, 0], [0, -1e-9]]}, "start.size_out_of_range", "0.5 to 1000 cells"),
        ({"start": [[1e5, 0], [1e5 + 4, 0], [1e5, -4]]}, "start.too_far_away", "within 10000 cells"),
        ({"start": SQUARE * 3000}, "start.too_many_points", "at most 10000 points"),
        ({"cell": [1.0, 0.0]}, "cell.not_positive", "above 0"),
        ({"cell": [1.0]}, "cell.not_positive", "above 0"),
        ({"cell": ["1", "2"]}, "cell.not_positive", "above 0"),
        ({"cell": [1.0, 1e6]}, "cell.out_of_range", "0.05 to 20 times"),
    ],
)
def test_that_an_impossible_sheet_is_refused_with_file_and_reason(
    tmp_path: Path, change: dict[str, Any], code: str, words: str
) -> None:
    content = {"ratio": RATIO, "rim": RIM, **change}
    with pytest.raises(KirigamiError) as plain:
        sheet_of_json(content)
    assert plain.value.code == code
    with pytest.raises(SheetError, match=rf"bad\.json: .*{words}") as caught:
        read_sheet(written(tmp_path / "bad.json", content))
    assert len(str(caught.value)) < 300


def test_that_impossible_ratios_are_still_refused_first(tmp_path: Path) -> None:
    with refused(RatioError, "input.not_valid", name="bad.json"):
        read_sheet(written(tmp_path / "bad.json", {"ratio": [[1, -1], [1, 1]], "rim": RIM}))
    with refused(RatioError, "ratios.not_a_table", name="bad.json"):
        read_sheet(written(tmp_path / "bad.json", {"rim": RIM}))
