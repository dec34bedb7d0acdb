"""The clipboard as a source: pictures, files, SVG, path data, points; and what is no target."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QByteArray, QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QColor, QDragEnterEvent, QDropEvent, QGuiApplication, QImage, QPainter
from PySide6.QtWidgets import QApplication

from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.target.pasting import recognised
from kirigami_studio.gui.window.main_window import MainWindow

Until = Callable[[Callable[[], bool]], None]
SVG = """<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="20mm" viewBox="0 0 40 20">
<path d="M0 0H40V20H0Z"/></svg>"""


@pytest.fixture(autouse=True)
def clipboard() -> Iterator[None]:
    yield
    QGuiApplication.clipboard().clear()


def pasted(window: MainWindow, content: QMimeData, until: Until) -> tuple[float, float]:
    """Width and height of the target that pasting leads to."""
    QGuiApplication.clipboard().setMimeData(content)
    window.commands["paste"].trigger()
    until(lambda: window.session.document.target is not None)
    width, height = np.ptp(window.session.document.target.points, axis=0)  # type: ignore[union-attr]
    return float(width), float(height)


def text(content: str) -> QMimeData:
    mime = QMimeData()
    mime.setText(content)
    return mime


@pytest.mark.parametrize("content", [SVG, "M 0 0 h 40 v 20 h -40 z", "[[0, 0], [40, 0], [40, 20], [0, 20]]"])
def test_that_svg_paths_and_points_are_pasted(window: MainWindow, until: Until, content: str) -> None:
    width, height = pasted(window, text(content), until)
    assert width / height == pytest.approx(2.0)


def test_that_svg_under_its_own_type_is_pasted_in_mm(window: MainWindow, until: Until) -> None:
    mime = QMimeData()
    mime.setData("image/svg+xml", QByteArray(SVG.encode()))
    pasted(window, mime, until)
    target = window.session.document.target
    assert target is not None and target.unit == "mm" and target.size == pytest.approx((40, 20))


def test_that_a_picture_is_pasted_and_its_threshold_can_be_moved(window: MainWindow, until: Until) -> None:
    image = QImage(90, 60, QImage.Format.Format_RGB32)
    image.fill(QColor("white"))
    painter = QPainter(image)
    painter.setBrush(QColor("black"))
    painter.drawEllipse(10, 20, 60, 30)
    painter.end()
    mime = QMimeData()
    mime.setImageData(image)
    width, height = pasted(window, mime, until)
    assert width / height == pytest.approx(2.0, rel=0.05)
    assert window.target.threshold.isVisible()
    before = window.session.document.target
    window.target.threshold.slider.setValue(180)
    until(lambda: not window.session.queue.busy)
    assert window.session.document.target is not None and before is not None


def test_that_a_copied_file_is_opened(window: MainWindow, until: Until, tmp_path: Path) -> None:
    path = tmp_path / "bar.svg"
    path.write_text(SVG, encoding="utf-8")
    mime = QMimeData()
    mime.setUrls([QUrl.fromLocalFile(str(path))])
    pasted(window, mime, until)
    assert window.session.document.target is not None and window.session.document.target.name == "bar"


@pytest.mark.parametrize("content", ["", "My holidays in 2021", "12.5", '"text"'])
def test_that_what_is_no_target_leads_to_a_hint(window: MainWindow, content: str) -> None:
    QGuiApplication.clipboard().setMimeData(text(content))
    window.commands["paste"].trigger()
    message = window.messages.messages[-1]
    assert message.tone is Tone.HINT and "Copy a picture, file, SVG or path" in message.sentence


def test_that_a_path_that_is_broken_leads_to_a_sentence(window: MainWindow, until: Until) -> None:
    QGuiApplication.clipboard().setMimeData(text("M 0 0 L 10 0"))
    window.commands["paste"].trigger()
    until(lambda: bool(window.messages.messages))
    assert window.messages.messages[-1].tone is Tone.ERROR and window.session.document.target is None


def test_that_a_text_dropped_on_the_target_is_taken_like_a_pasted_one(window: MainWindow, until: Until) -> None:
    mime, place = text("M 0 0 h 40 v 20 h -40 z"), QPoint(30, 30)
    copy, left, plain = Qt.DropAction.CopyAction, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    QApplication.sendEvent(window.target.view, QDragEnterEvent(place, copy, mime, left, plain))
    QApplication.sendEvent(window.target.view, QDropEvent(QPointF(place), copy, mime, left, plain))
    until(lambda: window.session.document.target is not None)
    assert len(window.session.document.target.points) == 4  # type: ignore[union-attr]


def test_that_text_nested_beyond_reason_is_no_target() -> None:
    assert recognised("[" * 100_000) is None
