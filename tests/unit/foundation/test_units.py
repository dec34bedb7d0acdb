"""Sentences about mm are in inches where the window shows these."""

from __future__ import annotations

import re

import pytest

from kirigami_studio.foundation.units import in_inches
from kirigami_studio.foundation.words import ShownUnit, choose, fill, tr
from tests.catalogues import catalogue, forms

#: Fields that are followed by mm; solids keep mm³, as files and speeds do.
LEFT = re.compile(r"\}\)? mm(?![\w/³])")


@pytest.mark.parametrize(
    ("text", "values", "inches"),
    [
        ("A connector of {width_mm:.2f} mm.", {"width_mm": 2.54}, "A connector of 0.1000 in."),
        ("{width:g} x {height:g} mm", {"width": 254, "height": 127.0}, "10 x 5 in"),
        ("x = {x:.2f}, y = {y:.2f} mm: cut", {"x": 25.4, "y": -50.8}, "x = 1.0000, y = -2.0000 in: cut"),
        ("down to ({x:.1f}, {y:.1f}) mm;", {"x": 25.4, "y": 2.54}, "down to (1.000, 0.100) in;"),
        ("{least_mm:g} to {most_mm:g} mm", {"least_mm": 25.4, "most_mm": 50.8}, "1 to 2 in"),
        ("{count} to {width_mm:g} mm", {"count": 3, "width_mm": 25.4}, "3 to 1 in"),
        ("layer {layer}, {clear_mm:.0f} mm", {"layer": "A", "clear_mm": 25.4}, "layer A, 1.00 in"),
        ("share {area_mm2:.4f} mm² each", {"area_mm2": 645.16}, "share 1 in² each"),
        ("{name} is cut at {speed:g} mm/s", {"name": "3 mm card", "speed": 4.0}, "3 mm card is cut at 4 mm/s"),
        ("{widths} mm, {body_mm3:g} mm³", {"widths": "1, 2", "body_mm3": 8}, "1, 2 mm, 8 mm³"),
    ],
)
def test_that_lengths_of_a_sentence_are_in_inches(
    text: str, values: dict[str, object], inches: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = fill(text, values)
    monkeypatch.setattr(ShownUnit, "inches", True)
    assert fill(text, values) == inches and "mm" in before


def test_that_no_sentence_keeps_a_length_in_mm() -> None:
    for message in catalogue("de"):
        for text in (*forms(message.id), *forms(message.string)):
            fields = dict.fromkeys(re.findall(r"\{(\w+)", text), 1.0)
            assert not LEFT.search(in_inches(text, fields)[0]), text


def test_that_captions_and_tooltips_say_the_unit_and_its_range(monkeypatch: pytest.MonkeyPatch) -> None:
    choose("en")
    monkeypatch.setattr(ShownUnit, "inches", True)
    assert ShownUnit.words("Kerf, mm") == "Kerf, in"
    assert ShownUnit.words("A width in mm; 3 in work too.") == "A width in inches; 3 in work too."
    assert ShownUnit.words("Width, mm (5 to 3000).") == "Width, in (0.197 to 118)."
    assert tr("{mm:.0f} mm", mm=254.0) == "10.00 in"


def test_that_lengths_of_cuts_from_a_metre_on_are_metres_in_sentences_as_in_the_window() -> None:
    """Before, the report had a cut length of 19.16 m above one of 19160.123 mm."""
    said = fill(
        "The cut length is {length_mm:.3f} mm; {planned_mm:.3f} mm were planned.",
        {"length_mm": 19160.123, "planned_mm": 999.9},
    )
    assert said == "The cut length is 19.1601 m; 999.900 mm were planned."
    assert fill("{cut_length_mm:.0f} mm", {"cut_length_mm": 1234.0}) == "1.23 m"
    # Sizes and places stay in mm, and so does what is no number.
    assert fill("{width_mm:g} mm at x = {x:.1f} mm", {"width_mm": 1500.0, "x": 2000.0}) == "1500 mm at x = 2000.0 mm"
    assert fill("{length_mm} mm", {"length_mm": "none"}) == "none mm"
