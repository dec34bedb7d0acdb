"""A name on the sheet: inside one whole panel, clear of what is cut, readable, as large as fits; no cut itself."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import shapely
from cut_sheets import bitten, drawn_line, mouths
from shapely.geometry import LineString, Point, Polygon

from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.cut_plan import CutPlan, plan_cuts
from kirigami_studio.fabricate.engraving import LARGEST_MM, LEAST_MM, MARGIN_MM, engraved
from kirigami_studio.fabricate.lettering import lettered
from kirigami_studio.fabricate.options import STRAIGHT, ConnectorStyle, CutOptions
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.sheet import Sheet

MakeDesign = Callable[..., Deployment]


def rounded(design: Deployment) -> Deployment:
    turn = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)[::-1] + 0.75 * np.pi
    half = 0.5 * (design.field.columns + 1), 0.5 * (design.field.rows + 1)
    start = np.stack([half[0] * np.cos(turn), half[1] * np.sin(turn)], axis=1)
    return deploy(Sheet(design.field, None, start))


def plan_for(kind: str, seed: int, style: ConnectorStyle, make_design: MakeDesign) -> CutPlan:
    design = make_design(5, 6, seed=seed, spread=0.3)
    options = CutOptions(style=style)
    if kind == "round":
        return plan_cuts(rounded(design), 90.0, 0.4, 0.15, options=options)
    kept = bitten(design, mouths(design), 0.2) if kind == "trimmed" else None
    return plan_cuts(design, 90.0, 0.4, 0.15, options=options, kept=kept)


@pytest.mark.parametrize("style", [ConnectorStyle.CENTRED, ConnectorStyle.TEARDROP, ConnectorStyle.ARC])
@pytest.mark.parametrize("kind", ["plain", "trimmed", "round"])
@pytest.mark.parametrize("seed", [0, 4])
def test_that_a_name_lies_in_one_whole_panel_clear_of_cuts_and_connectors(
    kind: str, seed: int, style: ConnectorStyle, make_design: MakeDesign
) -> None:
    before = plan_for(kind, seed, style, make_design)
    plan = engraved(before, "B12")
    name = plan.engraving
    assert name is not None and name.text == "B12" and plan.notes == before.notes
    assert LEAST_MM <= name.height_mm <= LARGEST_MM
    strokes = [LineString(line) for line in name.lines]
    panel = plan.panels[name.panel]
    assert len(panel) == 4 and all(stroke.within(Polygon(panel)) for stroke in strokes)
    cuts = shapely.union_all([drawn_line(path) for path in plan.paths])
    least = 0.5 * plan.kerf_mm + 0.5 * plan.kerf_mm + MARGIN_MM
    assert min(stroke.distance(cuts) for stroke in strokes) >= least - 1e-3
    beside = shapely.union_all(
        [
            Point(place).buffer(width)
            for place, width in zip(plan.hinges.position, plan.hinges.requested_mm, strict=True)
        ]
    )
    assert min(stroke.distance(beside) for stroke in strokes) >= MARGIN_MM


def test_that_a_name_changes_nothing_that_is_told_of_the_cuts(make_design: MakeDesign) -> None:
    before = plan_cuts(make_design(4, 5, seed=1), 100.0)
    plan = engraved(before, "A1")
    assert plan.engraving is not None and plan.paths == before.paths
    assert (plan.cut_length_mm, plan.travel_mm, plan.times) == (before.cut_length_mm, before.travel_mm, before.times)
    report, bare = check_plan(plan), check_plan(before)
    assert (report.pieces, report.min_ligament_mm) == (bare.pieces, bare.min_ligament_mm)
    assert [problem.text for problem in report.problems] == [problem.text for problem in bare.problems]


def test_that_a_name_is_upright_with_capitals_of_the_height_told_and_the_same_each_time(
    make_design: MakeDesign,
) -> None:
    plan = plan_cuts(make_design(3, 3, seed=2, spread=0.05), 100.0)
    first, again = engraved(plan, "H").engraving, engraved(plan, "H").engraving
    assert first is not None and again is not None
    assert all(np.array_equal(one, other) for one, other in zip(first.lines, again.lines, strict=True))
    points = np.concatenate(first.lines)
    assert np.ptp(points[:, 1]) == pytest.approx(first.height_mm, abs=1e-3) and first.height_mm == LARGEST_MM
    left, right, bar = first.lines
    assert np.ptp(left[:, 0]) < 1e-3 and np.ptp(right[:, 0]) < 1e-3 and np.ptp(bar[:, 1]) < 1e-3
    assert right[0, 0] > left[0, 0]


def test_that_a_larger_sheet_has_a_larger_name_up_to_the_largest(make_design: MakeDesign) -> None:
    design = make_design(6, 6, seed=3, spread=0.2)
    names = [engraved(plan_cuts(design, width, 0.3, 0.1), "B12").engraving for width in (40.0, 60.0, 300.0)]
    small, middling, large = (math.nan if name is None else name.height_mm for name in names)
    assert small < middling < large == LARGEST_MM


def test_that_a_sheet_without_room_says_so_in_one_sentence_and_is_cut_as_before(make_design: MakeDesign) -> None:
    before = plan_cuts(make_design(8, 8, seed=3, spread=0.2), 25.0, 0.2, 0.1)
    plan = engraved(before, "B12")
    assert plan.engraving is None and plan.paths == before.paths
    (note,) = plan.notes[len(before.notes) :]
    assert note.code == "plan.name_without_room" and "B12" in note.text and note.text.count(".") == 1


def test_that_letters_without_strokes_are_left_out_and_told(make_design: MakeDesign) -> None:
    before = plan_cuts(make_design(2, 2, spread=0.1), 150.0)
    plan = engraved(before, "A\N{SNOWMAN}1\N{SNOWMAN}")
    assert plan.engraving is not None and plan.engraving.text == "A1"
    (note,) = plan.notes[len(before.notes) :]
    assert note.code == "plan.name_letters_left_out" and note.text.count("\N{SNOWMAN}") == 3  # in the name, and once
    nothing = engraved(before, "\N{SNOWMAN} ")
    assert nothing.engraving is None and nothing.notes[-1].code == "plan.name_without_letters"


def test_that_every_printable_letter_has_open_strokes_within_its_line() -> None:
    for number in range(33, 127):
        written = lettered(chr(number))
        points = np.concatenate(written.lines)
        assert written.text == chr(number) and not written.missing
        assert all(len(line) >= 2 for line in written.lines)
        assert points[:, 1].min() >= -0.4 and points[:, 1].max() <= 1.3


def test_that_accented_letters_are_their_letters_with_a_mark_above() -> None:
    plain, marked = lettered("u"), lettered("\N{LATIN SMALL LETTER U WITH DIAERESIS}")
    assert len(marked.lines) == len(plain.lines) + 2 and not marked.missing
    top = np.concatenate(plain.lines)[:, 1].max()
    assert all(dot[:, 1].min() > top for dot in marked.lines[len(plain.lines) :])
    assert len(lettered("\N{LATIN SMALL LETTER SHARP S}").lines) == len(lettered("ss").lines)


@pytest.mark.parametrize(
    ("text", "written", "missing"),
    [
        ("\N{LATIN CAPITAL LETTER I WITH DOT ABOVE}z\N{LATIN CAPITAL LETTER I WITH DOT ABOVE}", "IzI", "\u25cc\u0307"),
        ("\N{LATIN CAPITAL LETTER A WITH DOT BELOW}", "A", "\u25cc\u0323"),
        (
            "A\N{COMBINING DOT BELOW}\N{COMBINING DIAERESIS}",
            "\N{LATIN CAPITAL LETTER A WITH DIAERESIS}",
            "\u25cc\u0323",
        ),
        ("q\u0308", "q\u0308", ""),
        ("\u0308A", "A", "\u25cc\u0308"),
        ("A \u0308B", "A B", "\u25cc\u0308"),
    ],
)
def test_that_a_mark_without_strokes_is_told_and_its_letter_is_written(
    text: str, written: str, missing: str, make_design: MakeDesign
) -> None:
    found = lettered(text)
    assert (found.text, found.missing) == (written, missing)
    before = plan_cuts(make_design(2, 2, spread=0.1), 150.0)
    plan = engraved(before, text)
    assert plan.engraving is not None and plan.engraving.text == written
    told = [note.text for note in plan.notes[len(before.notes) :]]
    assert len(told) == (1 if missing else 0) and all(missing in text for text in told)


def test_that_removed_connectors_and_tabs_leave_the_name_where_it_is_clear(make_design: MakeDesign) -> None:
    design = make_design(4, 4, seed=5, spread=0.2)
    plan = plan_cuts(design, 100.0, 0.4, 0.1, options=replace(STRAIGHT, tabs=3, removed=(4,)))
    name = engraved(plan, "C3").engraving
    assert name is not None
    cuts = shapely.union_all([drawn_line(path) for path in plan.paths])
    assert min(LineString(line).distance(cuts) for line in name.lines) >= plan.kerf_mm + MARGIN_MM - 1e-3


def test_that_a_plan_without_panels_has_no_room(make_design: MakeDesign) -> None:
    plan = replace(plan_cuts(make_design(2, 2), 100.0), panels=())
    assert engraved(plan, "A1").notes[-1].code == "plan.name_without_room"
