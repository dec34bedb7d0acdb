"""One switch shows inches wherever a length is shown, and mm again: fields, captions, numbers, labels, rulers."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtWidgets import QAbstractButton, QAbstractSpinBox, QApplication, QComboBox, QLabel, QLineEdit, QWidget

from kirigami_studio.foundation.words import ShownUnit
from kirigami_studio.gui.target.rulers import RULER
from kirigami_studio.gui.widgets.fitted_text import CONTROLS
from kirigami_studio.gui.widgets.readable import (
    readable_area,
    readable_feature,
    readable_length,
    readable_mm,
    readable_place,
    readable_size,
    readable_width,
    round_step,
)
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage

Until = Callable[[Callable[[], bool]], None]
MM = re.compile(r"\bmm\b(?!/)|illimet")
#: Files and names of materials stay in mm, and mm may still be typed.
FILES = re.compile(
    r"(file|sheet|solid|plan as SVG|elements|Tables|FOLD|print|true|from)[^.;]{0,12}\bmm\b|\d mm, |mm can .*|in mm, or|"
    r"(?s:material_?(note|name|gaps|s|) (ComboBox|QLineEdit).*)"
)


@pytest.fixture
def inches(designed: MainWindow, tmp_path: Path) -> Iterator[MainWindow]:
    """A studio with designs, switched to inches."""
    designed.services.preferences.use(tmp_path / "preferences.toml")
    designed.pages.turn(WindowPage.MAKE)
    designed.commands["inches"].trigger()
    QApplication.processEvents()
    yield designed
    ShownUnit.inches = False


def texts(root: QWidget) -> dict[str, str]:
    """What is read on labels, in fields and tooltips, and by a screen reader, by where it stands."""
    found = {}
    for number, part in enumerate((root, *root.findChildren(QWidget))):
        name = f"{number} {part.objectName()} {part.metaObject().className()}"
        if isinstance(part, QLabel | QAbstractSpinBox | QLineEdit | QAbstractButton):
            found[name] = part.text()
        if isinstance(part, (*CONTROLS, QComboBox)):
            found[f"{name}: spoken"] = f"{part.accessibleName()} {part.accessibleDescription()}"
        found[f"{name}: tip"] = part.toolTip()
        for action in part.actions():
            found[f"{name}: {action.text()}"] = f"{action.text()} {action.toolTip()} {action.statusTip()}"
    return found


def in_mm(root: QWidget) -> dict[str, str]:
    return {place: text for place, text in texts(root).items() if MM.search(FILES.sub("", f"{place} {text}"))}


def test_that_no_label_field_tooltip_or_spoken_name_tells_of_mm_in_inches(inches: MainWindow) -> None:
    for page in WindowPage:
        inches.pages.turn(page)
        assert in_mm(inches) == {}, page


def test_that_verdicts_and_refusals_are_in_inches(inches: MainWindow, until: Until) -> None:
    services, verdict = inches.services, inches.services.verdict
    services.fabrication.change(kerf_mm=4.0)
    until(lambda: not inches.fabrication.export.isEnabled() and verdict.state.verdict is not None)
    assert in_mm(inches) == {} and " in " in inches.fabrication.warnings.text()
    services.fabrication.change(kerf_mm=None, material="card-co2", connector_mm=0.9)
    until(lambda: verdict.state.verdict is not None and verdict.state.verdict.as_cut is not None)
    assert in_mm(inches) == {}


def test_that_dialogs_are_in_inches(inches: MainWindow) -> None:
    inches.commands["print"].trigger()
    inches.dialogs.show_materials()
    for dialog in (inches.dialogs.printing, inches.dialogs.materials):
        assert dialog is not None and in_mm(dialog) == {}
        dialog.close()


def test_that_plots_are_in_inches_and_in_mm_again(inches: MainWindow, until: Until) -> None:
    inches.pages.turn(WindowPage.DESIGN)
    inches.stage.plots_switch.click()
    plots = inches.stage.plots
    until(lambda: plots.complete)
    chart = next(chart for chart in plots.charts if chart.accessibleName().endswith(", in"))
    shown = chart.curves[0].getData()[1].copy()
    inches.commands["inches"].trigger()
    assert chart.accessibleName().endswith(", mm")
    np.testing.assert_allclose(chart.curves[0].getData()[1], 25.4 * shown)


def test_that_fields_captions_and_numbers_are_in_inches(inches: MainWindow) -> None:
    form = inches.fabrication.form
    assert form.fields["kerf_mm"].accessibleName() == "Kerf in inches"
    captions = [label.text() for label in inches.fabrication.findChildren(QLabel)]
    assert "&Kerf, in" in captions and "Tab, in" in captions
    assert inches.fabrication.numbers["size"].text().endswith(" in")
    assert inches.fabrication.numbers["length"].text() == readable_length(
        inches.services.cutting.made.plan.cut_length_mm  # type: ignore[union-attr]
    )
    assert inches.target.opened.unit.text() == "in"


def test_that_millimetres_come_back_everywhere(inches: MainWindow) -> None:
    inches.commands["inches"].trigger()
    captions = [label.text() for label in inches.fabrication.findChildren(QLabel)]
    assert "&Kerf, mm" in captions and not any(caption.endswith(", in") for caption in captions)
    assert inches.fabrication.form.fields["kerf_mm"].accessibleName() == "Kerf in millimetres"
    assert inches.fabrication.numbers["size"].text().endswith(" mm") and inches.target.opened.unit.text() == "mm"


def test_that_labels_on_drawings_and_the_rulers_are_in_inches(inches: MainWindow) -> None:
    stage, cuts, board = inches.stage.view, inches.cuts.view, inches.target.view
    inches.resize(1400, 900)  # areas have room
    chips = [chip.text for chip, _ in stage.legend(stage.fontMetrics())]
    assert chips and any("in²" in text for text in chips)
    assert not any(MM.search(text) for text in chips)
    assert not any(MM.search(chip.text) for chip in cuts._chips())
    assert any("in" in chip.text.split() for chip in cuts._chips())
    inches.pages.turn(WindowPage.SHAPE)
    step = board.context.step / 25.4
    assert any(step == pytest.approx(factor * 10.0**power) for factor in (1, 2, 5) for power in (-3, -2, -1, 0, 1))
    assert board.grab().width() > RULER


@pytest.mark.parametrize(
    ("shown", "mm", "inch"),
    [
        (lambda: readable_length(254.0), "254 mm", "10.0 in"),
        (lambda: readable_length(2540.0), "2.54 m", "100.0 in"),
        (lambda: readable_feature(2.54), "2.54 mm", "0.100 in"),
        (lambda: readable_width(0.2), "0.20 mm", "0.0079 in"),
        (
            lambda: readable_size(101.6, 50.8),
            "102 \N{MULTIPLICATION SIGN} 51 mm",
            "4.00 \N{MULTIPLICATION SIGN} 2.00 in",
        ),
        (lambda: readable_area(645.16), "645 mm²", "1 in²"),
        (lambda: readable_place(25.4, -50.8), "25.4, -50.8 mm", "1, -2 in"),
        (lambda: readable_mm(20.0), "20 mm", "0.7874 in"),
    ],
)
def test_that_lengths_read_alike_in_both_units(shown, mm: str, inch: str, monkeypatch: pytest.MonkeyPatch) -> None:  # type: ignore[no-untyped-def]
    assert shown() == mm
    monkeypatch.setattr(ShownUnit, "inches", True)
    assert shown() == inch


def test_that_steps_are_round_in_the_unit() -> None:
    assert round_step(3.0, 1.0) == 5.0 and round_step(10.0, 1.0) == 10.0
    assert round_step(3.0, 25.4) == pytest.approx(0.2 * 25.4) and round_step(26.0, 25.4) == pytest.approx(2.0 * 25.4)
