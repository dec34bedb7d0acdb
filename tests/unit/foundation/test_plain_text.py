"""Text from outside is bounded and printable, and text that is so already stays as it is."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kirigami_studio.foundation.plain_text import LONGEST_NAME, LONGEST_NOTE, plain_line, plain_lines, printable
from kirigami_studio.foundation.sentences import sentence


@given(st.text(max_size=1200))
def test_that_a_name_is_one_bounded_printable_line_and_stays_so(text: str) -> None:
    line = plain_line(text)
    assert line.isprintable() and len(line) <= LONGEST_NAME
    assert plain_line(line) == line


@given(st.text(max_size=3000))
def test_that_a_note_keeps_its_lines_and_nothing_else_that_cannot_be_shown(text: str) -> None:
    note = plain_lines(text)
    assert len(note) <= LONGEST_NOTE and all(line.isprintable() for line in note.split("\n"))
    assert plain_lines(note) == note


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("Fox  of\tpaper ", "Fox of paper"),
        (" two  spaces", " two  spaces"),
        ("red\x1b[31m", "red [31m"),
        ("left\u202eright", "left right"),
        ("half a pair \ud800", "half a pair"),
        ("n" * 10_000_000, "n" * (LONGEST_NAME - 1) + "…"),
        (" " * 10_000_000 + "far", "…"),
        ("<img src='/dev/zero'>", "<img src='/dev/zero'>"),
    ],
)
def test_that_a_name_from_outside_becomes_this_line(text: str, line: str) -> None:
    assert plain_line(text) == line


def test_that_what_cannot_be_shown_is_replaced_letter_by_letter() -> None:
    assert printable("a\x00b\u2028c", "?") == "a?b?c"


def test_that_a_sentence_about_a_file_has_no_escape_sequence_of_a_terminal() -> None:
    text = sentence("source.empty", {"name": "a\x1b]0;owned\x07.svg"})
    assert text.isprintable() and "owned" in text
