"""Copies in rows: as many as asked for, no more than the bed has room for, on the grid of coordinates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kirigami_studio.fabricate.copies import alike, copy_numbers, lay_out, moved
from kirigami_studio.fabricate.options import AS_MANY_AS_FIT, MOST_COPIES, STRAIGHT, CutOptions
from kirigami_studio.foundation.errors import FabricationError
from tests.refusals import refused

SIZE, BED, ANY_BED = (100.3, 80.2), (320.0, 180.0), (0.0, 0.0)


def options(copies: int, gap: float = 5.0) -> CutOptions:
    return replace(STRAIGHT, copies=copies, copy_gap_mm=gap)


def test_that_as_many_as_fit_fill_the_bed_in_rows() -> None:
    found = lay_out(SIZE, BED, options(AS_MANY_AS_FIT), 0.1)
    # Three of 100.3 mm and two gaps of 5 mm are 310.9 mm; two of 80.2 mm and one gap 165.4 mm.
    assert found.rows_and_columns == (2, 3) and len(found) == 6 and not found.notes
    np.testing.assert_allclose(found.places[:4], [[0, 0], [105.3, 0], [210.6, 0], [0, 85.2]], atol=1e-9)
    assert found.spread_mm == pytest.approx((310.9, 165.4))


def test_that_one_more_gap_decides_whether_another_copy_fits() -> None:
    assert len(lay_out((100.0, 50.0), (205.0, 50.0), options(AS_MANY_AS_FIT), 0.0)) == 2
    assert len(lay_out((100.0, 50.0), (204.9, 50.0), options(AS_MANY_AS_FIT), 0.0)) == 1


def test_that_fewer_than_fit_leave_the_last_row_short() -> None:
    found = lay_out(SIZE, BED, options(4), 0.1)
    assert len(found) == 4 and found.rows_and_columns == (2, 3) and not found.notes


def test_that_more_than_fit_are_cut_down_and_told() -> None:
    found = lay_out(SIZE, BED, options(20), 0.1)
    assert len(found) == 6
    assert [note.code for note in found.notes] == ["copies.fewer_fit"]
    assert "Of 20 copies 6 fit on the bed of 320 x 180 mm" in found.notes[0].text


def test_that_a_sheet_larger_than_the_bed_is_there_once_and_told() -> None:
    found = lay_out((400.0, 90.0), BED, options(3), 0.1)
    assert len(found) == 1 and [note.code for note in found.notes] == ["copies.none_fits"]


def test_that_a_bed_is_turned_only_where_the_sheet_fits_no_other_way() -> None:
    found = lay_out((80.0, 300.0), BED, options(AS_MANY_AS_FIT), 0.1)
    assert found.rows_and_columns == (1, 2) and found.spread_mm == (165.0, 300.0)


def test_that_without_a_bed_a_number_is_laid_out_nearly_square_and_as_many_as_fit_is_one() -> None:
    assert lay_out((50.0, 100.0), ANY_BED, options(8), 0.1).rows_and_columns == (2, 4)
    alone = lay_out(SIZE, ANY_BED, options(AS_MANY_AS_FIT), 0.1)
    assert len(alone) == 1 and [note.code for note in alone.notes] == ["copies.no_bed"]


def test_that_a_gap_as_narrow_as_the_kerf_and_senseless_numbers_are_refused() -> None:
    with pytest.raises(FabricationError) as caught:
        lay_out(SIZE, BED, options(2, 0.1), 0.1)
    assert caught.value.code == "copies.gap_too_narrow"
    assert len(lay_out(SIZE, BED, options(1, 0.1), 0.1)) == 1  # nothing lies beside it
    for wrong in (-1, MOST_COPIES + 1, 1.5, True):
        with refused(FabricationError, "copies.number", most=200):
            replace(STRAIGHT, copies=wrong)  # type: ignore[arg-type]
    with refused(FabricationError, "copies.gap_not_positive"):
        replace(STRAIGHT, copy_gap_mm=0.0)


def test_that_strokes_are_told_apart_whether_written_by_copy_or_by_layer() -> None:
    by_copy = ["S", "S", "O"] * 3
    assert copy_numbers(by_copy, 3).tolist() == [0, 0, 0, 1, 1, 1, 2, 2, 2]
    by_layer = ["S"] * 6 + ["O"] * 3
    assert copy_numbers(by_layer, 3).tolist() == [0, 0, 1, 1, 2, 2, 0, 1, 2]


def test_that_copies_which_differ_or_lie_too_near_are_not_alike() -> None:
    one = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 5.0]])
    right = moved(one, np.array([15.0, 0.0]))
    assert alike([one, right, moved(one, np.array([0.0, 10.0]))], 5.0, 1e-4)
    assert not alike([one, moved(one, np.array([14.9, 0.0]))], 5.0, 1e-4)
    bent = right.copy()
    bent[2, 1] += 0.01
    assert not alike([one, bent], 4.0, 1e-4)
    assert not alike([one, right[:2]], 5.0, 1e-4)
