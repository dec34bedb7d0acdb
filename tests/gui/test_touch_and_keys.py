"""The window by finger and by keys alone: what is pressed is large enough, and Tab reaches all of it on every page."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtGui import QAccessible
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSlider,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QLineEdit,
    QScrollBar,
    QWidget,
)

from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.widgets.canvas import Canvas
from kirigami_studio.gui.widgets.layouts import TOUCH
from kirigami_studio.gui.widgets.theme import DARK, LIGHT, Palette
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage

Until = Callable[[Callable[[], bool]], None]
PRESSED = (QAbstractButton, QAbstractSpinBox, QComboBox, QLineEdit, QAbstractSlider)
OWNERS = (QAbstractSpinBox, QComboBox, QLineEdit, QAbstractItemView)


def pressed(root: QWidget, kinds: tuple[type, ...] = PRESSED) -> list[QWidget]:
    """What is in sight below a widget to be pressed, dragged or typed into, without the parts of others."""
    return [
        one
        for one in root.findChildren(QWidget)
        if isinstance(one, kinds)
        and one.isVisible()
        and not isinstance(one, QScrollBar)
        and not isinstance(one.parentWidget(), OWNERS)
        and not one.objectName().startswith("qt_")
    ]


def named(one: QWidget) -> str:
    return f"{one.metaObject().className()} {one.objectName()} {one.accessibleName()} {one.width()} x {one.height()}"


def small(root: QWidget) -> list[str]:
    return [named(one) for one in pressed(root) if min(one.width(), one.height()) < TOUCH]


def settle() -> None:
    for _ in range(3):
        QApplication.processEvents()


@pytest.mark.parametrize("palette", [LIGHT, DARK], ids=["light", "dark"])
def test_that_all_that_is_pressed_on_the_pages_is_32_pixels_at_least(designed: MainWindow, palette: Palette) -> None:
    designed.appearance.set_theme(palette)
    designed.resize(1280, 720)
    designed.messages.add(Message("Look at this.", Tone.WARNING, "details", actions=(("Mend it", lambda: None),)))
    designed.settings.more.click()
    designed.commands["hand"].trigger()
    count = 0
    for page in WindowPage:
        designed.pages.turn(page)
        settle()
        assert small(designed) == [], page
        count += len(pressed(designed))
    assert count > 100
    for tool in (Tool.POINTS, Tool.STAR, Tool.TEXT, Tool.POSE):
        designed.target.set_tool(tool)
        settle()
        assert small(designed.target) == [], tool
    for command in ("compare", "all_designs"):
        designed.commands[command].trigger()
        settle()
        assert small(designed) == [], command


def test_that_tabs_of_parts_are_as_large_and_reached_by_keys(designed: MainWindow) -> None:
    bar = designed.pages.parts
    with QSignalBlocker(bar):
        for name in ("i", "stem"):
            bar.addTab(name)
    bar.show()
    settle()
    for tab in range(bar.count()):
        box = bar.tabRect(tab)
        assert min(box.width(), box.height()) >= TOUCH, box
    assert bar.focusPolicy() & Qt.FocusPolicy.TabFocus and bar.accessibleName()


def test_that_starts_second_targets_and_questions_are_pressed_as_easily(designed: MainWindow, until: Until) -> None:
    designed.services.start.open("circle")
    designed.services.second.open("hexagon")
    until(lambda: designed.session.document.settings.second is not None)
    until(lambda: not designed.session.document.settings.start.is_plain)
    designed.presenters.welcome.begin()
    designed.welcome.question.offer()
    designed.welcome.ask(True)
    for page in WindowPage:
        designed.pages.turn(page)
        settle()
        assert small(designed) == [], page
    listed = designed.welcome.question.list
    assert listed.sizeHintForRow(0) >= TOUCH - 1


DIALOGS = ["print", "materials", "shortcuts", "about", "guide", "artwork", "history", "library", "rename"]


@pytest.mark.parametrize("command", DIALOGS)
def test_that_dialogs_are_pressed_as_easily(designed: MainWindow, command: str) -> None:
    designed.commands[command].trigger()
    settle()
    dialogs = [one for one in QApplication.topLevelWidgets() if one.isVisible() and one is not designed]
    assert dialogs
    for one in dialogs:
        assert small(one) == [], command
        one.close()


@pytest.mark.parametrize("page", WindowPage)
def test_that_tab_reaches_every_control_of_each_page(designed: MainWindow, page: WindowPage) -> None:
    designed.activateWindow()
    designed.pages.turn(page)
    designed.commands["hand"].trigger()
    settle()
    wanted = {
        one
        for one in pressed(designed, (*PRESSED, QAbstractItemView, Canvas))
        if one.isEnabled() and not isinstance(one.parentWidget(), Canvas)
    }
    first = designed.focusWidget() or designed
    seen: set[QWidget] = {first}
    for _ in range(250):
        QTest.keyClick(designed.focusWidget() or designed, Qt.Key.Key_Tab)
        focused = QApplication.focusWidget()
        if focused is None or (focused is first and len(seen) > 20):
            break
        seen.add(focused)
        first = first if first is not designed else focused
    for one in wanted - seen:  # of buttons that exclude each other Tab reaches the one that is down, arrows the others
        group = one.group() if isinstance(one, QAbstractButton) else None
        if group is not None and group.exclusive() and seen & set(group.buttons()):
            seen.add(one)
    skipped = {one for one in wanted - seen if one.focusPolicy() == Qt.FocusPolicy.NoFocus}
    assert {named(one) for one in wanted - seen - skipped} == set()
    # What Tab passes by is a command with a key, in a menu.
    assert {named(one) for one in skipped if not reached_otherwise(designed, one)} == set()


def reached_otherwise(window: MainWindow, one: QWidget) -> bool:
    """Whether a button shows a command of the menus, or a view only pictures what others say."""
    actions = set(window.commands.actions.values())
    return (isinstance(one, QAbstractButton) and bool(actions & set(one.actions()))) or one is window.welcome.view


@pytest.mark.parametrize("page", WindowPage)
def test_that_a_screen_reader_has_a_name_and_a_role_for_all_that_is_reached(
    designed: MainWindow, page: WindowPage
) -> None:
    designed.pages.turn(page)
    settle()
    root = QAccessible.queryAccessibleInterface(designed)
    assert root is not None
    found, waiting = 0, [root]
    while waiting:
        one = waiting.pop()
        for number in range(one.childCount()):
            child = one.child(number)
            if child is not None and child.isValid():
                waiting.append(child)
        widget = one.object()
        if not isinstance(widget, QWidget) or not widget.isVisible() or widget.focusPolicy() == Qt.FocusPolicy.NoFocus:
            continue
        if isinstance(widget.parentWidget(), OWNERS) or widget.objectName().startswith("qt_"):
            continue
        found += 1
        assert one.text(QAccessible.Text.Name).strip("&… "), named(widget)
        assert one.role() not in (QAccessible.Role.NoRole, QAccessible.Role.Client), (named(widget), one.role())
    assert found > 15


def test_that_buttons_on_cards_are_as_large_and_leave_the_picture_room(designed: MainWindow) -> None:
    view, cards = designed.gallery.view, designed.gallery.view.itemDelegate()
    cell = view.visualRect(view.model_.index(0, 0))
    boxes = list(cards.button_boxes(cell).values())  # type: ignore[attr-defined]
    assert len(boxes) == 2 and not boxes[0].intersects(boxes[1])
    for box in boxes:
        assert min(box.width(), box.height()) >= TOUCH and cell.contains(box)


def test_that_the_picker_of_parts_and_the_report_are_pressed_as_easily(
    designed: MainWindow, files: object, until: Until, tmp_path: Path
) -> None:
    drawing = '<circle cx="20" cy="20" r="15"/><rect x="50" y="5" width="40" height="30"/>'
    (tmp_path / "logo.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg">{drawing}</svg>', encoding="utf-8")
    designed.files.open(str(tmp_path / "logo.svg"))
    until(lambda: designed.dialogs.parts is not None and designed.dialogs.parts.isVisible())
    assert designed.dialogs.parts is not None
    settle()
    assert small(designed.dialogs.parts) == []
    designed.dialogs.parts.reject()
    files.answer = tmp_path / "cut.dxf"  # type: ignore[attr-defined]
    designed.commands["export"].trigger()
    until(lambda: designed.dialogs.report is not None and designed.dialogs.report.isVisible())
    assert designed.dialogs.report is not None
    settle()
    assert small(designed.dialogs.report) == []
