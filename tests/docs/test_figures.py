"""The figures of the mathematics are those that the program draws, and what they say is true."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from kirigami_studio.lab.demonstrations.mathematics_figures import FIGURES, errors

#: Those that depend on nothing but the exact geometry; the others hold results of fits and rounding errors.
EXACT = ("parity", "void", "compact", "motion", "paths")


def numbers_and_words(svg: str) -> tuple[list[float], str]:
    """The numbers of a drawing, and all that is none."""
    number = r"-?\d+(?:\.\d+)?"
    return [float(one) for one in re.findall(number, svg)], re.sub(number, "#", svg)


@pytest.mark.parametrize("name", EXACT)
def test_that_a_figure_is_what_the_program_draws(name: str, repository: Path) -> None:
    kept = (repository / "docs" / "pictures" / "mathematics" / f"{name}.svg").read_text(encoding="utf-8")
    (numbers, words), (drawn, drawn_words) = numbers_and_words(kept), numbers_and_words(FIGURES[name]().decode())
    assert words == drawn_words
    assert np.allclose(numbers, drawn, atol=0.02)


def test_that_the_page_shows_every_figure(repository: Path) -> None:
    page = (repository / "docs" / "mathematics.md").read_text(encoding="utf-8")
    assert set(re.findall(r"mathematics/(\w+)\.svg", page)) == set(FIGURES)


def test_that_solved_sheets_are_exact_where_marched_ones_are_not() -> None:
    marched, solved = errors()
    assert max(value for _, value in solved.points) < -12
    assert dict(marched.points)[24] > 6
