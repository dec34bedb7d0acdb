"""Words on the screen stand out from their ground as WCAG's level AA asks: 4.5 to 1, in both themes."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterator

import pytest
from contrast import contrast
from PySide6.QtCore import QPoint, QRect, QSignalBlocker, Qt
from PySide6.QtGui import QColor, QImage, QPixmap
from PySide6.QtWidgets import QAbstractButton, QApplication, QComboBox, QLabel, QLineEdit, QTabBar, QToolButton, QWidget

from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.widgets.theme import DARK, LIGHT, Palette
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage

#: Device pixels per pixel of the pictures that are measured: strokes of letters have their whole colour there.
SCALE = 3
GROUNDS = ("window", "surface", "raised", "canvas", "accent_soft", "warning_soft", "error_soft")
DIALOGS = ("print", "materials", "shortcuts", "about", "library", "rename", "history", "all_designs", "compare")


def words(root: QWidget) -> Iterator[tuple[str, QRect]]:
    """What is written in sight and can be used, and where."""
    for one in root.findChildren(QWidget):
        if not one.isVisible() or not one.isEnabled() or one.visibleRegion().isEmpty():
            continue
        corner = one.mapTo(root, QPoint())
        if isinstance(one, QTabBar):
            for tab in range(one.count()):
                yield one.tabText(tab), one.tabRect(tab).translated(corner)
        elif isinstance(one, QComboBox):
            yield one.currentText(), QRect(corner, one.size())
        elif isinstance(one, QToolButton) and one.toolButtonStyle() == Qt.ToolButtonStyle.ToolButtonIconOnly:
            continue  # what it is called is written nowhere
        elif isinstance(one, QLabel | QAbstractButton | QLineEdit) and one.text().strip():
            yield one.text(), one.visibleRegion().boundingRect().translated(corner)


def faint(root: QWidget) -> list[str]:
    """Words that do not stand out from the commonest colour around them."""
    picture = QPixmap(root.size() * SCALE)
    picture.setDevicePixelRatio(SCALE)
    picture.fill(Qt.GlobalColor.transparent)
    root.render(picture)
    image, found = picture.toImage().convertToFormat(QImage.Format.Format_RGB32), []
    for text, box in words(root):
        inner = box.adjusted(3, 3, -3, -3) if min(box.width(), box.height()) > 24 else box
        area = QRect(inner.topLeft() * SCALE, inner.size() * SCALE) & image.rect()
        bits = bytes(image.copy(area).constBits())
        counted = Counter(bits[place : place + 3] for place in range(0, len(bits), 4))
        colours = [(QColor(code[2], code[1], code[0]).name(), count) for code, count in counted.most_common(12)]
        ground = colours[0][0]
        most = max((contrast(ground, one) for one, _ in colours[1:]), default=1.0)
        if most < 4.5:
            found.append(f"{text[:40]!r}: {most:.2f} on {ground}")
    return found


@pytest.mark.parametrize("palette", [LIGHT, DARK], ids=lambda palette: palette.name)
def test_that_every_colour_of_words_is_read_on_every_ground(palette: Palette) -> None:
    for ink, ground in itertools.product(("text", "muted", "accent", "warning", "good", "bad"), GROUNDS):
        assert contrast(getattr(palette, ink), getattr(palette, ground)) >= 4.5, (ink, ground)


@pytest.mark.parametrize("palette", [LIGHT, DARK], ids=lambda palette: palette.name)
def test_that_words_of_all_pages_and_dialogs_stand_out(designed: MainWindow, palette: Palette) -> None:
    designed.resize(1280, 720)
    designed.appearance.set_theme(palette)
    with QSignalBlocker(designed.pages.parts):
        for name in ("dot", "stem"):
            designed.pages.parts.addTab(name)
        designed.pages.parts.show()
    designed.messages.add(Message("Look at this.", Tone.WARNING, "details", actions=(("Mend it", lambda: None),)))
    count = 0
    for page in WindowPage:
        designed.pages.turn(page)
        QApplication.processEvents()
        assert faint(designed) == [], page
        count += sum(1 for _ in words(designed))
    assert count > 60
    for command in DIALOGS:
        designed.commands[command].trigger()
        QApplication.processEvents()
        for one in QApplication.topLevelWidgets():
            if one.isVisible() and (one is not designed or command in ("all_designs", "compare")):
                assert faint(one) == [], command
            if one is not designed and one.isVisible():
                one.close()


def test_that_a_faint_word_is_found(designed: MainWindow) -> None:
    designed.stage.title.setStyleSheet("color: #999999;")
    designed.pages.turn(WindowPage.DESIGN)
    QApplication.processEvents()
    assert [one.split(":")[0] for one in faint(designed)] == [repr(designed.stage.title.text())]
