"""Which strain a connector is judged by, and whether the material survives it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kirigami_studio.fabricate.material import find_material
from kirigami_studio.fabricate.strain import ESCAPES_BELOW, StrainFigure, escapes, strain_note, survival, used_up

CARD = replace(find_material("card-co2"), thickness_mm=0.3, yield_strain=0.01, break_strain=0.03, bend_strain=0.25)


def judged(width_mm: float, in_plane: float, out_of_plane: float) -> tuple[StrainFigure, bool]:
    found = survival(CARD, np.array([width_mm]), np.array([in_plane]), np.array([out_of_plane]))
    return found.figure, found.breaks


def test_that_a_wide_connector_is_judged_by_its_bend_and_a_narrow_one_by_its_pull() -> None:
    assert judged(2.0, 0.8, 0.2) == (StrainFigure.OUT_OF_PLANE, False)
    assert judged(2.0, 0.8, 0.3) == (StrainFigure.OUT_OF_PLANE, True)
    assert judged(0.5, 0.8, 0.2) == (StrainFigure.IN_PLANE, True)
    assert judged(0.5, 0.02, 0.02) == (StrainFigure.IN_PLANE, False)


def test_that_a_sheet_escapes_only_below_the_threshold() -> None:
    widths = np.array([0.5, 1.0, 2.0]) * 0.3 / ESCAPES_BELOW
    assert escapes(0.3, widths).tolist() == [False, False, True]


def test_that_the_connector_nearest_to_breaking_is_judged_not_the_most_strained() -> None:
    # The wide one is strained more, out of the plane, where card bears more.
    widths, flat, bent = np.array([2.0, 0.5]), np.array([[0.0, 0.0], [0.9, 0.05]]), np.array([[0.0, 0.0], [0.2, 0.05]])
    assert used_up(CARD, widths, flat, bent)[1] == pytest.approx([0.8, 0.05 / 0.03])
    found = survival(CARD, widths, flat, bent)
    assert (found.strain, found.limit, found.thinness) == (0.05, 0.03, pytest.approx(0.6))
    assert found.breaks and found.figure is StrainFigure.IN_PLANE


@pytest.mark.parametrize(
    ("bent", "code"), [(0.3, "as_cut.breaks"), (0.2, "as_cut.stays_bent"), (0.005, "as_cut.survives")]
)
def test_that_breaking_staying_bent_and_surviving_are_told_apart(bent: float, code: str) -> None:
    found = survival(CARD, np.array([2.0]), np.array([4.0 * bent]), np.array([bent]))
    note = strain_note(CARD, found)
    assert note.code == code
    assert "0.15 times" in note.text and "0.5" in note.text and note.fields["limit_percent"] == 25.0
    never = replace(CARD, yield_strain=0.0)
    assert not survival(never, np.array([2.0]), np.array([0.8]), np.array([0.2])).stays_bent
