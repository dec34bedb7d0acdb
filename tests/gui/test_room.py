"""A small window stays usable: the gallery and the layout keep their share."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import pytest
from PySide6.QtCore import QPoint, QRect, QSize
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QLabel,
    QListWidgetItem,
    QToolBar,
    QToolButton,
    QWidget,
)
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.make.fabrication_panel import LEAST_CHOICES
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.widgets.card import Card
from kirigami_studio.gui.widgets.search_window import PictureList
from kirigami_studio.gui.widgets.theme import DARK
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.gui.window.stage_panel import LOW
from kirigami_studio.project.labels import LONGEST_NAME

Until = Callable[[Callable[[], bool]], None]


def resized(window: MainWindow, width: int, height: int) -> None:
    window.resize(width, height)
    QApplication.processEvents()
    QApplication.processEvents()


def test_that_the_smallest_window_shows_more_than_one_row_of_whole_cards(designed: MainWindow) -> None:
    resized(designed, 1000, 640)
    view = designed.gallery.view
    assert view.viewport().height() >= 1.5 * view.cards.card.height()
    assert designed.stage.width() >= 330


@pytest.mark.parametrize(
    ("width", "height", "rows"),
    [(1000, 640, 1.5), (1280, 720, 2.0), (1366, 768, 2.0), (1440, 900, 2.0), (1600, 1000, 2.0), (1920, 1080, 2.0)],
)
def test_that_the_gallery_keeps_whole_rows_of_cards(designed: MainWindow, width: int, height: int, rows: float) -> None:
    resized(designed, width, height)
    view = designed.gallery.view
    card = view.visualRect(view.model_.index(0, 0))
    assert card.height() >= view.cards.card.height() and view.viewport().height() >= rows * card.height()


@pytest.mark.parametrize(("width", "height"), [(1000, 640), (1280, 720), (1440, 900), (1920, 1080)])
def test_that_the_page_of_making_shows_choices_numbers_stage_and_sheet_at_once(
    designed: MainWindow, width: int, height: int
) -> None:
    designed.pages.turn(WindowPage.MAKE)
    resized(designed, width, height)
    panel, stage, cuts = designed.fabrication, designed.stage, designed.cuts
    shown = (panel.machine, panel.material, panel.construction, *panel.numbers.values(), panel.warnings, panel.export)
    for part in (*shown, stage.view, stage.deployment.slider, stage.verdict, cuts.view, cuts.bar.slider):
        assert part.isVisible() and not part.visibleRegion().isEmpty(), part.objectName()
    assert min(stage.view.width(), cuts.view.width()) >= 240 and min(stage.view.height(), cuts.view.height()) >= 150
    whole = panel.options.profile.mapTo(panel.scrolled.viewport(), panel.options.profile.rect().topRight())
    assert whole.x() < panel.scrolled.viewport().width(), "no choice is cut off at its side"


def test_that_what_is_wrong_is_said_beside_the_numbers(designed: MainWindow, until: Until) -> None:
    designed.pages.turn(WindowPage.MAKE)
    resized(designed, 1000, 640)
    designed.services.fabrication.change(connector_mm=20.0)
    until(lambda: not designed.fabrication.export.isEnabled())
    assert designed.fabrication.warnings.isVisible() and "connector" in designed.fabrication.warnings.text()


def test_that_moved_columns_stay_when_the_window_is_resized(designed: MainWindow) -> None:
    resized(designed, 1300, 800)
    designed.pages.splitter.splitterMoved.emit(400, 1)
    designed.pages.splitter.setSizes([420, 500, 360])
    left = designed.pages.splitter.sizes()[0]
    resized(designed, 1400, 800)
    assert abs(designed.pages.splitter.sizes()[0] - left) <= 2


def test_that_the_title_of_a_narrow_stage_is_never_cut_off(designed: MainWindow, qtbot: QtBot) -> None:
    for width in (1000, 1040, 1280):
        resized(designed, width, 640)
        for _ in range(2):
            designed.commands["cuts"].trigger()
            QApplication.processEvents()
            for title in (designed.stage.title, designed.cuts.title):
                shown = title.isVisible()
                assert not shown or title.width() >= title.sizeHint().width(), (width, designed.pages.page)
    assert designed.stage.whole.isVisible()


def test_that_a_low_stage_gives_up_the_ends_of_the_slider_and_not_what_is_wrong(designed: MainWindow) -> None:
    resized(designed, 1440, 900)
    stage = designed.stage
    above, lines = designed.height() - stage.height(), 2 * stage.verdict.sentence.fontMetrics().lineSpacing()
    resized(designed, 1000, LOW + above)
    assert stage.height() == LOW and stage.ends.isVisible() and stage.verdict.sentence.height() >= lines
    resized(designed, 1000, LOW + above - 1)
    assert not stage.ends.isVisible() and stage.verdict.sentence.height() >= lines


LONG = "Cannot read drawing.svg: it is damaged. " + "Save it again as plain SVG, with all text converted to paths. " * 3


@pytest.mark.parametrize(("width", "height"), [(1000, 640), (1280, 720), (1440, 900)])
def test_that_messages_move_nothing_and_hide_no_button_of_the_tool_bar(
    designed: MainWindow, width: int, height: int
) -> None:
    resized(designed, width, height)
    parts = [part for part in designed.findChildren(QWidget) if not designed.messages.isAncestorOf(part)]

    def places() -> list[QRect]:
        return [QRect(part.mapTo(designed, QPoint(0, 0)), part.size()) for part in parts if part.isVisible()]

    designed.messages.dismiss(*Tone)
    resized(designed, width, height)
    before = places()
    designed.messages.add(Message("Saved heart.kiri.", Tone.WARNING))
    designed.messages.add(Message(LONG, Tone.ERROR, "line\n" * 9, actions=(("Open another …", lambda: None),)))
    designed.messages.details.click()
    resized(designed, width, height)
    assert designed.messages.isVisible() and places()[: len(before)] == before
    buttons = [part for part in designed.findChildren(QToolButton) if isinstance(part.parent(), QToolBar)]
    lying = designed.messages.geometry()
    assert buttons and not any(
        lying.intersects(QRect(button.mapTo(designed, QPoint(0, 0)), button.size()))
        for button in buttons
        if button.isVisible()
    )
    assert lying.top() > designed.menuBar().geometry().bottom() and designed.rect().contains(lying)
    words = designed.messages.sentence
    assert words.height() >= words.heightForWidth(words.width()), "all of the sentence is seen"


def test_that_a_long_name_of_the_project_leaves_the_tool_bar_and_messages_in_the_window(designed: MainWindow) -> None:
    designed.heading.setText(LONG)
    resized(designed, 1000, 640)
    designed.messages.add(Message("Saved heart.kiri.", Tone.WARNING))
    resized(designed, 1000, 640)
    buttons = [part for part in designed.findChildren(QToolButton) if part.defaultAction() is not None]
    buttons = [button for button in buttons if isinstance(button.parent(), QToolBar)]
    assert len(buttons) > 8
    for part in (*buttons, designed.messages):
        corner = part.mapTo(designed, QPoint())
        assert part.isVisible() and designed.rect().contains(QRect(corner, part.size())), part.objectName()


def test_that_a_message_is_low_where_its_buttons_stand_below_it(designed: MainWindow) -> None:
    resized(designed, 1000, 640)
    designed.messages.add(Message("Saved heart.kiri.", Tone.DONE))
    resized(designed, 1000, 640)
    short = designed.messages.height()
    designed.messages.add(Message(LONG[:170], Tone.ERROR, "line", actions=(("Open another …", lambda: None),)))
    resized(designed, 1000, 640)
    assert short <= 48 and designed.messages.height() <= 96


def test_that_the_answers_to_a_question_are_whole_in_a_small_window(designed: MainWindow) -> None:
    designed.resize(1000, 640)
    answers = (("Zuerst speichern", lambda: None), ("Nicht speichern", lambda: None))
    for sentence in ("Gespeichert.", "Vor dem Beginn eines neuen Projekts speichern?"):
        designed.messages.add(Message(sentence, Tone.WARNING, "line", actions=answers))
    resized(designed, 1000, 640)
    buttons = [one for one in designed.messages.findChildren(QAbstractButton) if one.isVisible()]
    assert len(buttons) == 8
    for one in buttons:
        assert one.width() >= one.sizeHint().width(), one.text()


def test_that_details_that_are_read_stay_while_the_theme_changes(designed: MainWindow) -> None:
    designed.messages.add(Message("Cannot read it.", Tone.ERROR, "line"))
    designed.messages.details.click()
    designed.appearance.set_theme(DARK)
    assert designed.messages.trace.isVisible()
    designed.messages.add(Message("Cannot read the other.", Tone.ERROR, "line"))
    assert not designed.messages.trace.isVisible()


def test_that_a_long_name_of_a_design_leaves_the_columns_their_widths(designed: MainWindow) -> None:
    chosen = designed.session.stage
    label = None if chosen is None else designed.session.document.label_of(chosen.candidate)
    assert label is not None
    widths = {}
    for name in ("", "W" * LONGEST_NAME):
        designed.services.labels.set(label, name, "")
        for page in (WindowPage.DESIGN, WindowPage.MAKE):
            designed.pages.turn(page)
            resized(designed, 1000, 640)
            widths[name, page] = designed.pages.splitter.sizes()
            assert designed.stage.title.drawn_text().endswith("…") == bool(name)
    for page in (WindowPage.DESIGN, WindowPage.MAKE):
        for width, beside in zip(widths["", page], widths["W" * LONGEST_NAME, page], strict=True):
            assert abs(width - beside) <= 4
    assert designed.fabrication.scrolled.widget().width() <= designed.fabrication.scrolled.viewport().width()


def test_that_sliders_are_long_enough_to_use_and_legends_leave_the_drawing_room(designed: MainWindow) -> None:
    for page in (WindowPage.DESIGN, WindowPage.MAKE):
        designed.pages.turn(page)
        resized(designed, 1000, 640)
        view, metrics = designed.stage.view, designed.stage.view.fontMetrics()
        assert designed.stage.deployment.slider.width() >= 200
        legend = view.legend(metrics)
        assert legend and len({box.top() for _, box in legend}) <= 2
        assert all(chip.width(metrics) <= box.width() for chip, box in legend), "no label is cut off"
    assert designed.cuts.bar.slider.width() >= 90


def test_that_pictures_stand_in_the_middle_of_their_list_whatever_its_width(qtbot: QtBot) -> None:
    made = PictureList("list", "Pictures", QSize(80, 40), QSize(100, 60))
    qtbot.addWidget(made)
    made.show()
    assert not made.verticalScrollBar().isVisible()
    for number in range(9):
        item = QListWidgetItem(f"{number}", made)
        item.setSizeHint(QSize(100, 60))
    for width, columns in ((150, 1), (180, 1), (290, 2)):
        made.resize(width, 100)
        qtbot.waitUntil(made.verticalScrollBar().isVisible)
        boxes = [made.visualItemRect(made.item(row)) for row in range(made.count())]
        assert len({box.left() for box in boxes}) == columns
        left, right = min(box.left() for box in boxes), made.viewport().width() - max(box.right() for box in boxes)
        assert abs(left - right) <= 3 + columns, (width, left, right)


def test_that_the_largest_limit_of_a_filter_is_shown_whole(designed: MainWindow) -> None:
    designed.gallery.bar.filter.click()
    field = designed.gallery.bar.filters.least
    field.setValue(100.0)
    QApplication.processEvents()
    words = field.lineEdit()
    assert words.text() == "≥ 100.0 %"
    room = words.width() - words.textMargins().left() - words.textMargins().right() - 4
    assert words.fontMetrics().horizontalAdvance(words.text()) <= room


@pytest.mark.parametrize("page", WindowPage)
def test_that_fields_beside_each_other_are_equally_high(designed: MainWindow, page: WindowPage) -> None:
    designed.pages.turn(page)
    resized(designed, 1280, 720)
    beside = 0
    for panel in designed.findChildren(Card):
        fields = [one for one in panel.findChildren(QWidget) if isinstance(one, QAbstractSpinBox | QComboBox)]
        boxes = [QRect(one.mapTo(designed, QPoint()), one.size()) for one in fields if one.isVisible()]
        for one, other in itertools.combinations(boxes, 2):
            if abs(one.center().y() - other.center().y()) < 8:
                beside += 1
                assert (one.top(), one.height()) == (other.top(), other.height()), panel.title.text()
    assert beside >= 2


@pytest.mark.parametrize(("width", "height"), [(1280, 720), (1000, 640)])
def test_that_the_choices_of_making_end_below_a_whole_row(designed: MainWindow, width: int, height: int) -> None:
    designed.pages.turn(WindowPage.MAKE)
    designed.resize(width, height)
    QApplication.processEvents()
    scrolled = designed.fabrication.scrolled
    seen = scrolled.viewport().rect()
    assert seen.height() >= LEAST_CHOICES // 2 and scrolled.verticalScrollBar().value() == 0
    for field in (*designed.fabrication.form.fields.values(), *designed.fabrication.options.cuts.fields.values()):
        if field.isVisible():
            top = field.mapTo(scrolled.viewport(), QPoint()).y()
            assert top + field.height() <= seen.height() or top >= seen.height(), field.objectName()
    for size in range(height, height + 120, 9):  # nor does a caption stand alone
        resized(designed, width, size)
        for caption in scrolled.widget().findChildren(QLabel):
            field = caption.buddy()
            if field is not None and field.isVisible() and not caption.visibleRegion().isEmpty():
                assert field.visibleRegion().boundingRect().height() == field.height(), (size, caption.text())


@pytest.mark.parametrize("page", WindowPage)
def test_that_the_primary_button_is_whole_in_a_small_window(designed: MainWindow, page: WindowPage) -> None:
    designed.resize(1000, 640)
    designed.pages.turn(page)
    QApplication.processEvents()
    button = designed.fabrication.export if page is WindowPage.MAKE else designed.run.generate
    corner = button.mapTo(designed, QPoint())
    assert button.isVisible() and designed.rect().contains(QRect(corner, button.size()))
    assert button.width() >= button.sizeHint().width()
