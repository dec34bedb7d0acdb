"""Typed numbers: comma and point mean the same, and lengths take other units."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from PySide6.QtCore import QLocale, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QDoubleSpinBox, QWidget
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.widgets.number_field import DecimalField, LengthField
from kirigami_studio.gui.window.main_window import MainWindow

pytestmark = pytest.mark.qt

LANGUAGES = ("C", "en_US", "de_DE", "fr_CH")


@pytest.fixture(params=LANGUAGES)
def language(request: pytest.FixtureRequest) -> Iterator[QLocale]:
    before = QLocale()
    QLocale.setDefault(QLocale(request.param))
    yield QLocale()
    QLocale.setDefault(before)


def typed(qtbot: QtBot, field: QDoubleSpinBox, text: str, digits: int = 3) -> float:
    field.setRange(0.0, 2000.0)
    field.setDecimals(digits)
    field.setSuffix(" mm")
    field.setKeyboardTracking(False)
    field.setValue(7.0)
    qtbot.addWidget(field)
    field.selectAll()
    QTest.keyClicks(field, text)
    QTest.keyClick(field, Qt.Key.Key_Return)
    return field.value()


@pytest.mark.parametrize("text", ["85.5", "85,5"])
def test_that_comma_and_point_mean_the_same_in_every_language(qtbot: QtBot, language: QLocale, text: str) -> None:
    field = DecimalField()
    assert typed(qtbot, field, text) == 85.5
    assert field.text() == f"85{language.decimalPoint()}500 mm"


@pytest.mark.parametrize(
    ("text", "mm"),
    [
        ("3 in", 76.2),
        ("3,5 inch", 88.9),
        ('3/8"', 9.525),
        ("1/8 in", 3.175),
        ("8.5cm", 85.0),
        ("90 mm", 90.0),
        ("250 um", 0.25),
        ("250 \N{MICRO SIGN}m", 0.25),
        ("30 thou", 0.762),
        ("2 IN", 50.8),
        ("3/4", 0.75),
    ],
)
def test_that_a_length_is_read_in_the_unit_that_it_is_typed_in(
    qtbot: QtBot, language: QLocale, text: str, mm: float
) -> None:
    assert typed(qtbot, LengthField(), text) == mm


@pytest.mark.parametrize("text", ["3 i", "999 in", "1/0 in", "in"])
def test_that_an_unfinished_or_too_large_length_leaves_the_old_one(qtbot: QtBot, text: str) -> None:
    assert typed(qtbot, LengthField(), text) == 7.0


def test_that_a_plain_number_takes_no_unit(qtbot: QtBot) -> None:
    assert typed(qtbot, DecimalField(), "3 in") == 3.0


def test_that_text_before_or_instead_of_a_number_stays_readable(qtbot: QtBot) -> None:
    ratio, least = DecimalField(), DecimalField()
    ratio.setPrefix("x ")
    assert typed(qtbot, ratio, "1,25") == 1.25
    least.setSpecialValueText("any")
    assert typed(qtbot, least, "0") == 0.0
    assert least.text() == "any"
    least.stepUp()
    assert least.value() == 1.0


def test_that_every_decimal_number_of_the_window_takes_a_comma(window: MainWindow) -> None:
    fields = [box for box in window.findChildren(QWidget) if isinstance(box, QDoubleSpinBox)]
    assert len(fields) >= 10
    assert [box.objectName() for box in fields if not isinstance(box, DecimalField)] == []


def test_that_lengths_in_mm_take_units(window: MainWindow) -> None:
    named = {box.objectName() for box in window.findChildren(LengthField)}
    assert {"width_mm", "connector_mm", "kerf_mm", "tabWidth", "hingeWidth"} <= named
    refine = window.target.refine
    assert isinstance(refine.width_, LengthField) and isinstance(refine.height_, LengthField)
