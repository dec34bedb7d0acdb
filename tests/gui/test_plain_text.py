"""Names, paths and messages come from files of other people: the window shows them letter by letter, never as HTML.

Qt's labels and tooltips guess whether a text is HTML, and HTML names pictures that are opened: a device, a pipe, a
file on another machine.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtGui import QAction, QHelpEvent, QImage
from PySide6.QtGui import Qt as GuiQt
from PySide6.QtWidgets import (
    QAbstractItemView,
    QApplication,
    QLabel,
    QMessageBox,
    QToolTip,
)
from pytestqt.qtbot import QtBot

from kirigami_studio.fabricate.machine import SHELF as MACHINES
from kirigami_studio.fabricate.machine import changed_machine
from kirigami_studio.fabricate.material import SHELF as MATERIALS
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.fabricate.material_copies import changed_copy
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.widgets.card import ElidedLabel, own_markup
from kirigami_studio.gui.widgets.chart import Chart
from kirigami_studio.gui.window.about import AboutWindow
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.project import store
from kirigami_studio.project.document import Document
from kirigami_studio.project.edits import Edit, set_fabrication
from kirigami_studio.project.labels import Label

Until = Callable[[Callable[[], bool]], None]
#: Edge of the picture, pixels: what shows it as a picture is larger than anything the window has in one line.
TALL = 4000


@pytest.fixture
def name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A name that is a picture where it is taken for HTML."""
    picture = QImage(TALL, TALL, QImage.Format.Format_Mono)
    picture.fill(1)
    assert picture.save(str(tmp_path / "p.png"))
    monkeypatch.chdir(tmp_path)
    return "<img src='p.png'> &amp; <b>x</b>"


def shown_as_html(label: QLabel) -> bool:
    """Whether a label takes its text for HTML."""
    text_format, own = label.textFormat(), isinstance(label.parent(), Chart) or isinstance(label.window(), AboutWindow)
    guessed = text_format is Qt.TextFormat.AutoText and GuiQt.mightBeRichText(label.text())
    marked = text_format in (Qt.TextFormat.RichText, Qt.TextFormat.MarkdownText)
    return guessed or (marked and not own)


def html_labels() -> list[QLabel]:
    """All labels of the program, those of tooltips and dialogs too, that take a text for HTML."""
    QApplication.processEvents()
    labels = [widget for widget in QApplication.allWidgets() if isinstance(widget, QLabel)]
    return [label for label in labels if shown_as_html(label)]


def tips() -> Iterator[tuple[str, str]]:
    """All tooltips, of widgets, actions and entries of lists, with whose they are."""
    for widget in QApplication.allWidgets():
        yield type(widget).__name__, widget.toolTip()
        for action in widget.findChildren(QAction, options=Qt.FindChildOption.FindDirectChildrenOnly):
            yield action.objectName(), action.toolTip()
        model = widget.model() if isinstance(widget, QAbstractItemView) else None
        for row in range(model.rowCount() if model is not None else 0):
            assert model is not None
            yield type(model).__name__, str(model.index(row, 0).data(Qt.ItemDataRole.ToolTipRole) or "")


def tip_label() -> QLabel:
    """The label of the tooltip that is shown."""
    found = [one for one in QApplication.topLevelWidgets() if one.inherits("QTipLabel") and one.isVisible()]
    assert len(found) == 1 and isinstance(found[0], QLabel)
    return found[0]


@pytest.fixture
def hostile(window: MainWindow, designs: Document, name: str, tmp_path: Path, until: Until) -> MainWindow:
    """A project open whose names are all HTML: target, design, note, machine, material, file and folder."""
    assert designs.target is not None
    MACHINES.save(replace(changed_machine("co2-laser", "evil", {}), name=name, note=name))
    MATERIALS.save(replace(changed_copy("card-co2", "evil", {}), name=name, note=name))
    target = replace(designs.target, name=name)
    labels = (Label("A1", name[:40], name), *designs.labels[1:])
    document = replace(designs, target=target, labels=labels, drawing=(target,))
    document = set_fabrication(document, machine="evil", material="evil").document
    folder = tmp_path / "<b>folder<i>"
    folder.mkdir()
    path = folder / "<img src='p.png'>.kiri"
    store.save(document, path)
    MACHINES.delete("evil")
    MATERIALS.save(replace(find_material("evil"), kerf_mm=0.3))
    window.fabrication.chooser.reload()
    window.services.project.recent.load(tmp_path / "recent.toml")
    window.services.project.open(path)
    until(lambda: window.session.stage is not None and window.fabrication.export.isEnabled())
    window.session.apply(Edit(name, replace(window.session.document, chosen=1)))
    window.services.project.undo()
    assert window.session.document.target is not None and window.session.document.target.name == name
    until(lambda: not window.session.queue.busy)
    return window


def test_that_no_label_takes_a_name_for_html(hostile: MainWindow, name: str) -> None:
    session = hostile.session
    session.post(Message(f"{name} could not be read.", Tone.ERROR, name, ((name, lambda: None),)))
    session.set_status(f"Opened {name}.")
    hostile.dialogs.show_history()
    hostile.presenters.all_designs.rename_current()
    QApplication.processEvents()
    said = [one.text() for one in QApplication.allWidgets() if isinstance(one, QLabel) and name[:17] in one.text()]
    assert len(said) >= 3, said  # message, status line and title: else nothing is tested
    assert [label.text() for label in html_labels()] == []
    assert max(label.sizeHint().height() for label in hostile.findChildren(QLabel)) < 1000
    assert hostile.messages.sentence.sizeHint().height() < 1000
    assert session.history.redo_label == name


def test_that_no_tooltip_takes_a_name_for_html(hostile: MainWindow, name: str) -> None:
    found = [(whose, tip) for whose, tip in tips() if "<img" in tip or "<b>" in tip]
    assert len(found) >= 3, found
    for whose, tip in found:
        QToolTip.showText(QPoint(10, 10), tip, hostile)
        assert not shown_as_html(tip_label()), (whose, tip)
        assert tip_label().height() < 1000
        QToolTip.hideText()


def test_that_the_tooltip_of_a_card_is_plain(hostile: MainWindow) -> None:
    view = hostile.gallery.view
    place = view.visualRect(view.model_.index(0, 0)).center()
    help_event = QHelpEvent(QEvent.Type.ToolTip, place, view.viewport().mapToGlobal(place))
    QApplication.sendEvent(view.viewport(), help_event)
    assert "<img" in tip_label().text() and not shown_as_html(tip_label()) and tip_label().height() < 1000


def test_that_dialogs_are_plain(hostile: MainWindow, name: str) -> None:
    box = QMessageBox(hostile)
    box.setText(name)
    box.setInformativeText(name)
    box.show()
    assert [label.text() for label in html_labels()] == []
    box.close()
    box.deleteLater()


def test_that_names_have_no_mnemonics_and_no_placeholders(
    window: MainWindow, tmp_path: Path, designs: Document
) -> None:
    path = tmp_path / "Tom & Jerry[*].kiri"
    store.save(designs, path)
    window.services.project.recent.take_project(path)
    assert next(iter(window.recent_menu.entries.values())).text() == "&1  Tom && Jerry[*].kiri"
    window.session.path = path
    window.session.document_changed.emit(designs)
    assert window.windowTitle() == "Tom & Jerry[*][*].kiri[*] \N{EN DASH} Kirigami Studio"


def test_that_the_rule_finds_a_label_with_markup(hostile: MainWindow, name: str) -> None:
    planted = QLabel(name, hostile)
    own_markup(planted)
    planted.show()
    assert html_labels() == [planted]
    planted.deleteLater()


def test_that_without_the_rule_a_label_takes_a_name_for_html(hostile: MainWindow, name: str) -> None:
    """What the style sheet says is what makes labels plain: one that is made without it is found by this test."""
    application = QApplication.instance()
    assert isinstance(application, QApplication)
    sheet = application.styleSheet()
    application.setStyleSheet("")
    planted = QLabel(name, hostile)
    planted.show()
    assert html_labels() == [planted] and planted.sizeHint().height() >= TALL
    planted.hide()
    application.setStyleSheet(sheet)
    planted.deleteLater()


def test_that_a_project_that_names_a_device_opens(window: MainWindow, repository: Path, until: Until) -> None:
    """Before, the window read the device to no end."""
    path = repository / "tests" / "data" / "attacks" / "rich_text_dev_zero.kiri"
    window.services.project.open(path)
    until(lambda: window.session.document.target is not None)
    until(lambda: not window.session.queue.busy)
    assert window.session.document.target is not None
    assert "/dev/zero" in window.session.document.target.name
    assert [label.text() for label in html_labels()] == []


def test_that_own_markup_stays_markup(window: MainWindow, qtbot: QtBot) -> None:
    window.dialogs.show_about()
    chart = Chart("Match", "%", ("IoU",))
    qtbot.addWidget(chart)
    chart.show()
    QApplication.processEvents()
    about = window.dialogs.about
    assert about is not None
    for label in (about.shown, about.paper, chart.numbers):
        assert label.textFormat() is Qt.TextFormat.RichText


def test_that_a_name_of_ten_million_letters_does_not_hold_the_window(qtbot: QtBot) -> None:
    """Before, each paint measured all of it: minutes for one name that takes 15 kB in a file."""
    label = ElidedLabel()
    qtbot.addWidget(label)
    label.resize(300, 30)
    label.setText("x" * 10_000_000, "x" * 9_000_000)
    label.show()
    began = time.process_time()
    for _ in range(20):
        label.repaint()
    assert time.process_time() - began < 2.0
    assert len(label.drawn_text()) < 300
    assert len(label.toolTip()) < 5000
