"""From the chosen design to a cut file, without leaving the window."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import pairwise
from pathlib import Path

import ezdxf
import pytest
from ezdxf.math import Vec3
from ezdxf.path import make_path
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication, QCheckBox, QComboBox, QLabel, QWidget
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.widgets.readable import readable_length, readable_range, readable_time
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton


def test_that_the_exported_file_holds_the_sheet_in_mm(
    designed: MainWindow, files: object, qtbot: QtBot, until: Until, tmp_path: Path
) -> None:
    files.answer = tmp_path / "cut.dxf"  # type: ignore[attr-defined]
    designed.fabrication.lengths["width_mm"].setValue(80.0)
    until(lambda: designed.fabrication.numbers["size"].text().startswith("80"))
    qtbot.mouseClick(designed.fabrication.export, LEFT)
    until(lambda: bool(designed.messages.messages))
    assert designed.messages.messages[-1].tone is Tone.DONE
    drawing = ezdxf.readfile(tmp_path / "cut.dxf")
    assert drawing.header["$INSUNITS"] == 4
    outline = [entity for entity in drawing.modelspace() if entity.dxf.layer == "OUTLINE"]
    assert len(outline) == 1 and outline[0].closed
    width = max(x for x, *_ in outline[0].get_points()) - min(x for x, *_ in outline[0].get_points())
    assert width == pytest.approx(80.0, abs=0.1)
    assert len(drawing.modelspace()) == int(designed.fabrication.numbers["slits"].text())


def test_that_numbers_follow_the_settings_and_one_field_is_one_undo_step(designed: MainWindow, until: Until) -> None:
    length = designed.fabrication.numbers["length"].text()
    box = designed.fabrication.lengths["width_mm"]
    for width in (110.0, 130.0, 200.0):
        box.setValue(width)
    until(lambda: designed.fabrication.numbers["length"].text() != length)
    assert designed.session.document.fabrication.width_mm == 200.0
    designed.commands["undo"].trigger()
    assert box.value() == 100.0
    until(lambda: designed.fabrication.numbers["length"].text() == length)


def test_that_a_material_brings_its_own_connector_and_kerf(designed: MainWindow, qtbot: QtBot) -> None:
    panel = designed.fabrication
    panel.lengths["connector_mm"].setValue(0.33)
    index = panel.material.findData("drag-knife")
    panel.material.setCurrentIndex(index)
    panel.material.activated.emit(index)
    settings = designed.session.document.fabrication
    assert (settings.material, settings.connector_mm, settings.kerf_mm) == ("drag-knife", None, None)
    assert panel.lengths["kerf_mm"].value() == 0.0
    assert panel.lengths["connector_mm"].value() != 0.33


def test_that_impossible_connectors_are_explained_in_the_panel(designed: MainWindow, until: Until) -> None:
    designed.fabrication.lengths["connector_mm"].setValue(19.0)
    until(lambda: not designed.fabrication.export.isEnabled())
    assert "mm" in designed.fabrication.warnings.text()
    designed.commands["undo"].trigger()
    until(lambda: designed.fabrication.export.isEnabled())


def test_that_an_unwritable_place_leads_to_a_message(
    designed: MainWindow, files: object, until: Until, tmp_path: Path
) -> None:
    (tmp_path / "wall").write_text("a file, not a folder", encoding="utf-8")
    files.answer = tmp_path / "wall" / "cut.dxf"  # type: ignore[attr-defined]
    designed.commands["export"].trigger()
    until(lambda: bool(designed.messages.messages))
    assert designed.messages.messages[-1].tone is Tone.ERROR
    assert "wall" in designed.messages.messages[-1].sentence


def test_that_export_without_a_design_says_what_to_do_first(heart: MainWindow) -> None:
    assert not heart.fabrication.export.isEnabled() and not heart.commands["export"].isEnabled()
    heart.files.export()
    assert "Generate one first" in heart.messages.messages[-1].sentence


def test_that_slots_are_summed_up_with_the_length_that_their_file_has(
    designed: MainWindow, until: Until, tmp_path: Path
) -> None:
    panel, said = designed.fabrication, designed.fabrication.numbers["length"]
    open_cuts = said.text()
    designed.services.fabrication.change(profile="slots")
    until(lambda: said.text() != open_cuts)
    designed.services.exporter.export(tmp_path / "slots.dxf")
    until(lambda: designed.dialogs.report is not None)
    entities = ezdxf.readfile(tmp_path / "slots.dxf").modelspace()
    drawn = sum(length(entity.flattening(0.001)) for entity in map(make_path, entities))
    assert said.text() == readable_length(drawn)
    assert open_cuts in said.toolTip()
    assert panel.export.isEnabled()


def length(vertices: Iterable[Vec3]) -> float:
    points = list(vertices)
    return sum(one.distance(other) for one, other in pairwise(points))


def test_that_undo_names_the_material_that_was_changed(designed: MainWindow) -> None:
    """Before, it was "Change the connector width", which a material brings along."""
    box = designed.fabrication.material
    other = next(row for row in range(box.count()) if row != box.currentIndex())
    box.setCurrentIndex(other)
    box.activated.emit(other)
    assert designed.session.document.fabrication.material == box.itemData(other)
    assert designed.session.history.undo_label == "Change the material"


def test_that_undo_names_each_setting_that_a_form_changes(designed: MainWindow) -> None:
    panel, history = designed.fabrication, designed.session.history
    changed = {}
    for form in (panel.form, panel.options.cuts, panel.options.files):
        for name, field in form.fields.items():
            before = history.position
            if isinstance(field, QComboBox):
                other = next((row for row in range(field.count()) if row != field.currentIndex()), None)
                if other is None:
                    continue
                field.setCurrentIndex(other)
                field.activated.emit(other)
            elif isinstance(field, QCheckBox):
                field.toggle()
            else:
                field.setValue(field.value() + field.singleStep())
            assert history.position == before + 1, name
            changed[name] = history.undo_label
            designed.commands["undo"].trigger()
    assert len(changed) > 15 and len(set(changed.values())) == len(changed), changed
    assert changed["connector_mm"] == "Change the connector width"


def test_that_the_summary_no_longer_says_trimmed_once_the_trim_is_off(designed: MainWindow, until: Until) -> None:
    designed.commands["trim"].trigger()
    until(lambda: "trimmed" in designed.fabrication.summary.text())
    designed.commands["trim"].trigger()  # and at once, not when the new plan has been made
    said = [label.text() for label in designed.findChildren(QLabel) if label.isVisible() and "trimmed" in label.text()]
    assert said == []
    tips = [one.toolTip() for one in designed.findChildren(QWidget) if "Trimmed:" in one.toolTip()]
    assert tips == []


def test_that_a_long_cut_takes_hours() -> None:
    assert [readable_time(seconds) for seconds in (90.0, 600.0, 7200.0)] == ["90 s", "10.0 min", "2.0 h"]
    assert readable_range(6900.0, 7080.0).endswith(" min")
    assert readable_range(23_208.0, 24_408.0) == "6.4\N{EN DASH}6.8 h"


def test_that_a_figure_without_room_ends_in_dots_and_is_whole_in_its_tooltip(designed: MainWindow) -> None:
    designed.pages.turn(WindowPage.MAKE)
    QApplication.processEvents()
    shown = designed.fabrication.numbers["pieces"]
    shown.setText("81 + 138 pins and a few more")
    assert shown.drawn_text().endswith("\N{HORIZONTAL ELLIPSIS}") and shown.toolTip() == shown.text()
