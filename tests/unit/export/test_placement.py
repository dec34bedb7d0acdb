"""Where the cuts of a file lie."""

from __future__ import annotations

import numpy as np
import pytest
from shapely.geometry import box

from kirigami_studio.export.dxf_check import placement_problems
from kirigami_studio.export.dxf_reading import FilePath
from kirigami_studio.fabricate.findings import Severity

SHEET = box(0, 0, 50, 40)
OUTLINE = FilePath(np.array(SHEET.exterior.coords), "OUTLINE", True)


def cut(layer: str, *points: tuple[float, float]) -> FilePath:
    return FilePath(np.array(points, dtype=float), layer, False)


def test_that_well_placed_cuts_have_no_problems() -> None:
    paths = [cut("SLITS", (10, 10), (20, 10)), cut("EDGE_SLITS", (30, 5), (30, -0.2)), OUTLINE]
    problems = placement_problems(paths, SHEET)
    assert [problem.severity for problem in problems] == [Severity.WARNING]
    assert problems[0].code == "cut_file.below_origin"
    shifted = [FilePath(drawn.points + 1.0, drawn.layer, drawn.closed) for drawn in paths]
    assert placement_problems(shifted, box(1, 1, 51, 41)) == []


@pytest.mark.parametrize(
    ("path", "word"),
    [
        (cut("SLITS", (60, 10), (70, 10)), "leaves the sheet"),
        (cut("0", (10, 10), (60, 10)), "leaves the sheet"),
        (cut("SLITS", (10, 10), (50.5, 10)), "reaches the outline"),
        (cut("SLITS", (10, 10), (50, 10)), "reaches the outline"),
    ],
)
def test_that_misplaced_cuts_are_errors_with_a_place(path: FilePath, word: str) -> None:
    (problem,) = placement_problems([path, OUTLINE], SHEET)
    assert problem.severity is Severity.ERROR
    assert word in problem.text
    assert problem.where == tuple(path.points[0])


def test_that_an_outline_before_the_cuts_is_warned_about() -> None:
    (problem,) = placement_problems([OUTLINE, cut("SLITS", (10, 10), (20, 10))], SHEET)
    assert problem.severity is Severity.WARNING
    assert problem.code == "cut_file.cuts_after_outline"
