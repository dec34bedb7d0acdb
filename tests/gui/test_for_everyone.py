"""The window without a mouse and without sight: every control has a name, is reached by Tab and shows its focus."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import pytest
from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtGui import QAccessible, QKeySequence
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QLabel,
    QLineEdit,
    QMenu,
    QPlainTextEdit,
    QSlider,
    QTextBrowser,
    QWidget,
)
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.widgets.canvas import Canvas
from kirigami_studio.gui.widgets.theme import DARK, LIGHT, Palette
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.studio.making import ExportedFiles

CONTROLS = (
    QAbstractButton,
    QAbstractSpinBox,
    QComboBox,
    QLineEdit,
    QSlider,
    QAbstractItemView,
    QPlainTextEdit,
    QTextBrowser,
    Canvas,
)
Open = Callable[[MainWindow], QWidget]
Until = Callable[[Callable[[], bool]], None]


def library(window: MainWindow) -> QWidget:
    window.commands["library"].trigger()
    assert window.dialogs.picker is not None
    return window.dialogs.picker


def materials(window: MainWindow) -> QWidget:
    window.commands["materials"].trigger()
    assert window.dialogs.materials is not None
    return window.dialogs.materials


def guide(window: MainWindow) -> QWidget:
    window.commands["guide"].trigger()
    assert window.dialogs.guide is not None
    return window.dialogs.guide


def shortcuts(window: MainWindow) -> QWidget:
    window.commands["shortcuts"].trigger()
    assert window.dialogs.shortcuts is not None
    return window.dialogs.shortcuts


def board(window: MainWindow) -> QWidget:
    window.target.set_editing(True)
    return window.target


def cuts(window: MainWindow) -> QWidget:
    window.commands["cuts"].trigger()
    return window.cuts


def whole(window: MainWindow) -> QWidget:
    return window


def told(widget: QWidget) -> str:
    """What a screen reader says of a widget."""
    found = QAccessible.queryAccessibleInterface(widget)
    return found.text(QAccessible.Text.Name) if found is not None else ""


def inner(widget: QWidget) -> bool:
    """Whether a widget is a part of another control, or of Qt's own, which speaks for it."""
    parent = widget.parentWidget()
    return widget.objectName().startswith("qt_") or isinstance(
        parent, QAbstractSpinBox | QComboBox | QAbstractItemView | QLineEdit
    )


def test_that_a_screen_reader_has_a_name_for_every_control(designed: MainWindow) -> None:
    for opened in (whole, cuts, materials, guide, shortcuts, library, board):
        place = opened(designed)
        QApplication.processEvents()
        controls = [one for one in place.findChildren(QWidget) if isinstance(one, CONTROLS) and not inner(one)]
        assert controls
        nameless = [
            one.objectName() or one.metaObject().className()
            for one in controls
            if one.isVisible() and not told(one).strip("&… ")
        ]
        assert nameless == [], opened.__name__
    assert designed.dialogs.picker is not None
    designed.dialogs.picker.close()


def test_that_a_screen_reader_says_what_every_label_shows(designed: MainWindow) -> None:
    for page in WindowPage:
        designed.pages.turn(page)
        QApplication.processEvents()
        labels = [one for one in designed.findChildren(QLabel) if one.isVisible() and one.text() and not inner(one)]
        plain = [one for one in labels if one.textFormat() != Qt.TextFormat.RichText]
        assert len(plain) > 10
        assert [(one.text(), told(one)) for one in plain if told(one) != one.text().replace("&", "")] == [], page


def test_that_the_report_of_an_export_is_named_too(designed: MainWindow, files: object, until: Until, tmp_path) -> None:  # type: ignore[no-untyped-def]
    files.answer = tmp_path / "cut.dxf"  # type: ignore[attr-defined]
    told_: list[ExportedFiles] = []
    designed.services.exporter.exported.connect(told_.append)
    designed.commands["export"].trigger()
    until(lambda: bool(told_) and designed.dialogs.report is not None)
    assert designed.dialogs.report is not None
    for one in designed.dialogs.report.findChildren(QWidget):
        if isinstance(one, CONTROLS) and one.isVisible() and not inner(one):
            assert told(one).strip(), one.metaObject().className()


def test_that_painted_controls_say_their_value(designed: MainWindow) -> None:
    slider = designed.stage.deployment.slider
    designed.stage.deployment.set_phi(1.0)
    found = QAccessible.queryAccessibleInterface(slider)
    assert found is not None and "57.3°" in found.text(QAccessible.Text.Description)
    view = designed.gallery.view
    gallery = QAccessible.queryAccessibleInterface(view)
    assert gallery is not None and gallery.childCount() == 3
    card = gallery.child(0)
    assert card is not None and card.text(QAccessible.Text.Name).startswith("Design A1: match")


def test_that_tab_visits_every_column_from_left_to_right_and_comes_back(designed: MainWindow, qtbot: QtBot) -> None:
    designed.activateWindow()
    designed.settings.more.click()
    designed.settings.rows.setFocus()
    visited: list[QWidget] = []
    while (focused := QApplication.focusWidget()) is not None and focused not in visited and len(visited) < 120:
        visited.append(focused)
        qtbot.keyClick(focused, Qt.Key.Key_Tab)
    assert QApplication.focusWidget() is visited[0]
    assert all(one.isVisible() and one.isEnabled() for one in visited)
    for wanted in (
        designed.settings.rows,
        designed.settings.search,
        designed.run.generate,
        designed.stage.plots_switch,
        designed.stage.deployment.slider,
        designed.gallery.view,
    ):
        assert wanted in visited, wanted.objectName()
    columns = [
        next((number for number, part in enumerate(parts(designed)) if part.isAncestorOf(one)), None)
        for one in visited
    ]  # fmt: skip
    order = [column for column in columns if column is not None]
    order = order[order.index(0) :] + order[: order.index(0)]  # the walk began in the second of them
    turns = [(one, other) for one, other in itertools.pairwise(order) if one != other]
    assert len(turns) == len(parts(designed)) - 1, turns
    assert order == sorted(order)


def parts(window: MainWindow) -> tuple[QWidget, ...]:
    return window.target, window.settings, window.stage, window.gallery


@pytest.mark.parametrize("palette", [LIGHT, DARK], ids=["light", "dark"])
def test_that_the_focus_shows_on_every_control_that_tab_reaches(
    palette: Palette, designed: MainWindow, qtbot: QtBot
) -> None:
    designed.appearance.set_theme(palette)
    designed.activateWindow()
    designed.settings.rows.setFocus()
    invisible = []
    seen: list[QWidget] = []
    while (focused := QApplication.focusWidget()) is not None and focused not in seen and len(seen) < 120:
        seen.append(focused)
        QApplication.processEvents()
        place, box = designed, QRect(focused.mapTo(designed, QPoint()), focused.size()).adjusted(-6, -6, 6, 6)
        with_focus = place.grab(box).toImage()
        qtbot.keyClick(focused, Qt.Key.Key_Tab)
        QApplication.processEvents()
        if place.grab(box).toImage() == with_focus:
            invisible.append(focused.objectName() or focused.metaObject().className())
    assert len(seen) > 20
    assert invisible == []


def test_that_alt_and_a_letter_of_a_menu_open_the_menu_and_nothing_else(window: MainWindow) -> None:
    menus = {QKeySequence.mnemonic(action.text()) for action in window.menuBar().actions()}
    assert len(menus) == len(window.menuBar().actions())
    captions = [label for label in window.findChildren(QLabel) if label.buddy() is not None]
    texts = [caption.text() for caption in captions] + [one.text() for one in window.findChildren(QAbstractButton)]
    assert any("&" in text for text in texts)
    assert [text for text in texts if "&" in text and QKeySequence.mnemonic(text) in menus] == []


@pytest.mark.parametrize("palette", [LIGHT, DARK], ids=["light", "dark"])
def test_that_one_letter_means_one_entry_in_each_menu(window: MainWindow, palette: Palette) -> None:
    window.appearance.set_theme(palette)
    for bar_entry in window.menuBar().actions():
        menu = bar_entry.menu()
        assert isinstance(menu, QMenu)
        letters = [QKeySequence.mnemonic(entry.text()).toString() for entry in menu.actions() if "&" in entry.text()]
        assert len(letters) == len(set(letters)), f"{menu.title()}: {sorted(letters)}"
