"""Two minutes of real use as a film: the real window, driven like a user, with a pointer and captions.

``python -m kirigami_studio.lab.demonstrations.screencast --out docs/pictures`` plays it off-screen and writes
``session.mp4`` and its first picture, ``session.jpg``.  The film runs on a clock of its own: what takes long, such as a
run, is shown faster, and what a viewer has to read stays as long as reading takes.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Generator
from importlib import import_module
from pathlib import Path

import numpy as np
from PySide6.QtCore import QPoint, QPointF, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFont, QImage, QPainter, QPainterPath, QPen, QPolygonF
from PySide6.QtWidgets import QApplication, QWidget

from kirigami_studio.export.dxf_reading import DxfContent, read_content
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.lab.demonstrations.offscreen_session import (
    DESIGNS,
    OffscreenSession,
    SessionError,
    click,
    hover,
    main,
    press,
    press_key,
)

#: Size of the window and of the band for captions below it, pixels.
SIZE, BAND = QSize(1280, 720), 56
FRAMES_A_SECOND = 10
#: Pixels that the pointer goes in a second, and how long it takes at least.
POINTER_SPEED, LEAST_MOVE = 900.0, 0.4
#: While the generator is loaded, so many seconds become one of the film.
SHORTER = 4.0
#: Seconds that a press of the button is seen.
PRESSED = 0.2
#: The heart's width, and the width given to one connector, mm.
HEART_MM, WIDE_MM = 80.0, 0.4
PAPER, INK, BAR, WORDS, RING = "#ffffff", "#1d2733", "#14202e", "#f3f7fb", "#f08c1a"
LAYERS = {"SLITS": "#2f6fb5", "EDGE_SLITS": "#00805f", "OUTLINE": "#1d2733"}


class Film:
    """Frames of equal length in H.264; equal pictures cost next to nothing.

    Parameters
    ----------
    path : Path
    size : QSize
    """

    def __init__(self, path: Path, size: QSize) -> None:
        self.seconds = 0.0
        self._size = size
        self._writer: Generator[None, bytes, None] = import_module("imageio_ffmpeg").write_frames(
            str(path),
            (size.width(), size.height()),
            fps=FRAMES_A_SECOND,
            codec="libx264",
            quality=None,
            macro_block_size=8,
            output_params=["-crf", "27", "-preset", "slow", "-tune", "animation", "-movflags", "+faststart"],
        )
        self._writer.send(None)

    def add(self, image: QImage, seconds: float) -> None:
        """Show a picture for some seconds, to the nearest frame."""
        picture = image.convertToFormat(QImage.Format.Format_RGB888)
        rows = np.frombuffer(picture.constBits(), np.uint8).reshape(picture.height(), picture.bytesPerLine())
        frame = rows[:, : 3 * picture.width()].tobytes()
        for _ in range(max(1, round(seconds * FRAMES_A_SECOND))):
            self._writer.send(frame)
            self.seconds += 1.0 / FRAMES_A_SECOND

    def close(self) -> None:
        """Finish the file."""
        self._writer.close()


class Screencast(OffscreenSession):
    """Plays the session and films it."""

    def __init__(self, out: Path) -> None:
        super().__init__(out)
        self.window.resize(SIZE)
        self.frame = QSize(SIZE.width(), SIZE.height() + BAND)
        self.path = out / "session.mp4"
        self.film = Film(self.path, self.frame)
        self.pointer = QPointF(0.62 * SIZE.width(), 0.55 * SIZE.height())
        self.caption = ""
        self.pressed = False

    def play(self) -> list[Path]:
        """Film every step and return the files."""
        window = self.window
        window.show()
        window.presenters.welcome.begin()  # reads the sample that moves
        self.until(lambda: window.welcome.ready, "the sample did not come")
        window.presenters.welcome.decline()
        self.say("Kirigami Studio: from a silhouette to a cut file, in two minutes")
        self.live(6.0)
        self.choose_target()
        self.size_and_material()
        self.generate_designs()
        self.compare()
        self.open_and_close()
        self.connectors()
        self.export_file()
        self.show_file()
        self.film.close()
        self.files += [self.path, self.out / "session.jpg"]
        window.session.history.mark_saved()
        window.close()
        return self.files

    # what is done ------------------------------------------------------------------------------------------------

    def choose_target(self) -> None:
        """The heart, from the library."""
        self.say("1   Choose a target: library, file, photo, or draw it")
        self.press_on(self.window.target.buttons["library"])
        picker = self.window.dialogs.picker
        if picker is None:
            raise SessionError("The library did not open.")
        self.live(1.0)
        for letter in "heart":
            press(picker.search, letter)
            self.hold(0.2)
        self.hold(0.8)
        press_key(picker, Qt.Key.Key_Return)
        self.until(lambda: self._target_name() == "heart", "the heart did not load")
        self.live(3.5)

    def size_and_material(self) -> None:
        """How large the heart is to be, and what it is cut from."""
        self.say("2   How large, and what it is cut from")
        width = self.window.target.opened.width_
        self.press_on(width)
        width.setValue(HEART_MM)
        self.hold(1.6)
        self.turn(WindowPage.MAKE)
        material = self.window.fabrication.material
        self.go_to(material)
        material.showPopup()
        self.hold(3.2)
        material.hidePopup()
        self.hold(0.6)
        self.turn(WindowPage.DESIGN)

    def generate_designs(self) -> None:
        """Eight designs, while they come and are fitted."""
        self.say("3   Generate: a model draws designs, and each is fitted on the exact geometry")
        self.window.settings.candidates.setValue(DESIGNS)
        self.press_on(self.window.run.generate)
        self.during(lambda: not self.window.gallery.view.model_.entries, 4.0, SHORTER)
        self.during(lambda: self.window.services.run.running, 20.0)
        self.say("Best first: match, evenness, and whether it can be cut")
        self.during(self._not_judged, 6.0)
        self.hold(4.5)

    def _not_judged(self) -> bool:
        verdict = self.window.services.verdict
        return not self.window.fabrication.export.isEnabled() or verdict.state.verdict is None or verdict.busy

    def compare(self) -> None:
        """Two designs beside each other, half open."""
        self.say("4   Compare two designs at the same angle")
        self.press_on(self.window.gallery.bar.compare)
        self.hold(1.5)
        bar = self.window.stage.compare.bar
        self.drag(bar.slider, bar.set_phi, 0.0, 80.0, 2.5)
        self.hold(3.5)
        bar.set_phi(0.0)
        self.press_on(self.window.stage.compare.leave)
        self.hold(0.5)

    def open_and_close(self) -> None:
        """From flat to the heart, with the slider."""
        self.say("5   Watch it open: flat at 180°, the heart at 0°")
        bar = self.window.stage.deployment
        self.drag(bar.slider, bar.set_phi, 0.0, 180.0, 3.5)
        self.hold(1.5)
        self.drag(bar.slider, bar.set_phi, 180.0, 0.0, 5.0)
        self.say("The line below tells how the real sheet does, closed on its connectors in a simulation")
        self.go_to(self.window.stage.as_cut)
        self.hold(5.0)

    def connectors(self) -> None:
        """The cuts, one wider connector, and the order of cutting."""
        self.say("6   The cuts: every line is cut once, every dot is a connector")
        self.turn(WindowPage.MAKE)
        self.hold(3.0)
        page = self.window.cuts
        transform = page.view.transform()
        if transform is None or page.view.gestures.connectors is None:
            raise SessionError("The cuts were not shown.")
        places = page.view.gestures.connectors.plan.hinges.position
        hinge = int(np.argmin(np.linalg.norm(places - np.median(places, axis=0), axis=1)))
        x, y = transform.to_pixels(places[hinge]).tolist()
        self.say("Any connector can be wider, narrower, or cut through")
        self.go_to(page.view, QPoint(round(x), round(y)))
        page.view.gestures.select(frozenset({hinge}))
        self.tap()
        self.hold(1.2)
        self.press_on(page.hinges.width_mm)
        page.hinges.width_mm.setValue(WIDE_MM)
        self.during(lambda: not self.window.fabrication.export.isEnabled(), 3.0)
        self.hold(2.0)
        page.view.gestures.select(frozenset())
        self.say("The order of cutting, step by step")
        slider = page.bar.slider
        self.go_to(slider)
        for share in np.linspace(0.0, 1.0, 50):
            slider.setValue(round(share * slider.maximum()))
            self.pointer = self.place_of(slider, QPoint(round(share * slider.width()), slider.height() // 2))
            self.shoot(1.0 / FRAMES_A_SECOND)
        self.hold(1.0)

    def turn(self, page: WindowPage) -> None:
        """Press a page's button in the bar on top."""
        self.press_on(self.window.page_buttons[page])

    def export_file(self) -> None:
        """The file and the report on it."""
        self.during(self._not_judged, 4.0)
        self.say("7   Export: two readers read the file back before it is there")
        (self.out / "cut.dxf").unlink(missing_ok=True)
        self.press_on(self.window.fabrication.export)
        dialogs = self.window.dialogs
        self.during(lambda: dialogs.report is None, 3.0)
        self.hold(8.0)
        dialogs.close_report()

    def show_file(self) -> None:
        """What the file holds, as an independent program finds it."""
        path = self.out / "cut.dxf"
        content = read_content(path)
        cuts, size = len(content.paths), path.stat().st_size / 1024
        self.say(f"{path.name}: {cuts} paths in {content.unit}, {size:.0f} kB, and the design itself inside")
        drawn = file_picture(content, SIZE)
        path.unlink()
        order = len(content.paths)
        for step in range(1, 26):
            self.film.add(self.composed(file_picture(content, SIZE, math.ceil(order * step / 25)), False), 0.1)
        self.film.add(self.composed(drawn, False), 4.0)
        self.say("Cut it, push two opposite corners together, and it is a heart")
        self.film.add(self.composed(drawn, False), 5.0)

    # how it is filmed ------------------------------------------------------------------------------------------------

    def say(self, caption: str) -> None:
        """Another caption from here on."""
        self.caption = caption

    def hold(self, seconds: float) -> None:
        """Stay as it is."""
        for _ in range(4):
            QApplication.processEvents()
        self.shoot(seconds)

    def live(self, seconds: float) -> None:
        """Film what moves by itself, as fast as it is."""
        begin = time.monotonic()
        frames = round(seconds * FRAMES_A_SECOND)
        for frame in range(1, frames + 1):
            while time.monotonic() < begin + frame / FRAMES_A_SECOND:
                QApplication.processEvents()
            self.shoot(1.0 / FRAMES_A_SECOND)

    def during(self, busy: Callable[[], bool], most: float, shorter: float = 1.0) -> None:
        """Film while something is busy, ``shorter`` seconds in one of the film; no more than ``most`` seconds of film,
        however long it takes.
        """
        filmed, begin = 0.0, time.monotonic()
        while busy():
            if time.monotonic() - begin > 300.0:
                raise SessionError("The window did not come to an end.")
            QApplication.processEvents()
            if filmed < most and time.monotonic() - begin > shorter * filmed:
                self.shoot(1.0 / FRAMES_A_SECOND)
                filmed += 1.0 / FRAMES_A_SECOND
        self.hold(0.3)

    def place_of(self, widget: QWidget, place: QPoint | None = None) -> QPointF:
        """A place of a widget (its middle unless given) in the film."""
        point = widget.rect().center() if place is None else place
        if widget.window() is self.window:
            return QPointF(widget.mapTo(self.window, point))
        return QPointF(widget.mapTo(widget.window(), point)) + QPointF(self.corner_of(widget.window()))

    def go_to(self, widget: QWidget, place: QPoint | None = None) -> None:
        """Move the pointer there, slower at both ends."""
        begin, end = self.pointer, self.place_of(widget, place)
        length = math.hypot(end.x() - begin.x(), end.y() - begin.y())
        frames = round(max(LEAST_MOVE, length / POINTER_SPEED) * FRAMES_A_SECOND)
        for frame in range(1, frames + 1):
            share = 0.5 - 0.5 * math.cos(math.pi * frame / frames)
            self.pointer = begin + (end - begin) * share
            self.shoot(1.0 / FRAMES_A_SECOND)
        hover(widget, widget.rect().center() if place is None else place)

    def press_on(self, widget: QWidget) -> None:
        """Go to a widget and click it."""
        self.go_to(widget)
        self.tap()
        click(widget)
        self.hold(0.3)

    def tap(self) -> None:
        """Show that the button is pressed."""
        self.pressed = True
        self.shoot(PRESSED)
        self.pressed = False

    def drag(self, slider: QWidget, turn: Callable[[float], None], begin: float, end: float, seconds: float) -> None:
        """Drag an angle slider from one angle to another (degrees)."""

        def at(degrees: float) -> QPoint:
            return QPoint(round(8 + (slider.width() - 16) * (180.0 - degrees) / 180.0), slider.height() // 2)

        self.go_to(slider, at(begin))
        self.pressed = True
        frames = round(seconds * FRAMES_A_SECOND)
        for frame in range(frames + 1):
            degrees = begin + (end - begin) * (0.5 - 0.5 * math.cos(math.pi * frame / frames))
            turn(math.radians(degrees))
            self.pointer = self.place_of(slider, at(degrees))
            QApplication.processEvents()
            self.shoot(1.0 / FRAMES_A_SECOND)
        self.pressed = False

    def shoot(self, seconds: float) -> None:
        """Film the window as it is for some seconds."""
        image = self.composed(self.window.grab().toImage(), True)
        if self.film.seconds == 0.0:
            image.save(str(self.out / "session.jpg"), quality=82)
        self.film.add(image, seconds)

    def corner_of(self, dialog: QWidget) -> QPoint:
        """Where a dialog or popup lies over the window: popups where they are, dialogs in the middle."""
        if dialog.windowFlags() & Qt.WindowType.Popup == Qt.WindowType.Popup:
            place = dialog.pos() - self.window.pos()
            return QPoint(
                max(0, min(place.x(), SIZE.width() - dialog.width())),
                max(0, min(place.y(), SIZE.height() - dialog.height())),
            )
        return QPoint((SIZE.width() - dialog.width()) // 2, (SIZE.height() - dialog.height()) // 2)

    def composed(self, shown: QImage, with_pointer: bool) -> QImage:
        """A picture with everything that lies over it, and the caption below."""
        image = QImage(self.frame, QImage.Format.Format_RGB32)
        image.fill(QColor(BAR))
        painter = QPainter(image)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.drawImage(QRect(QPoint(0, 0), SIZE), shown)
        if with_pointer:
            others = [one for one in QApplication.topLevelWidgets() if one is not self.window and one.isVisible()]
            for dialog in others:
                corner = self.corner_of(dialog)
                painter.fillRect(QRect(corner, dialog.size()).adjusted(-1, -1, 1, 1), QColor("#5b6b7c"))
                painter.drawPixmap(corner, dialog.grab())
            self._paint_pointer(painter)
        font = QFont(self.window.font())
        font.setPixelSize(22)
        painter.setFont(font)
        painter.setPen(QColor(WORDS))
        band = QRectF(0.0, SIZE.height(), SIZE.width(), BAND)
        painter.fillRect(band, QColor(BAR))
        painter.drawText(band, Qt.AlignmentFlag.AlignCenter, self.caption)
        painter.end()
        return image

    def _paint_pointer(self, painter: QPainter) -> None:
        """An arrow, and a ring around it while the button is pressed."""
        if self.pressed:
            painter.setPen(QPen(QColor(RING), 3.0))
            painter.setBrush(QColor(240, 140, 26, 60))
            painter.drawEllipse(self.pointer, 15.0, 15.0)
        arrow = [(0, 0), (0, 19), (4.6, 14.8), (7.9, 22), (10.8, 20.7), (7.6, 13.7), (13.6, 13.3)]
        path = QPainterPath()
        path.addPolygon(QPolygonF([self.pointer + QPointF(x, y) for x, y in arrow]))
        path.closeSubpath()
        painter.setPen(QPen(QColor(PAPER), 1.6))
        painter.setBrush(QColor("#000000"))
        painter.drawPath(path)


def file_picture(content: DxfContent, size: QSize, most: int | None = None) -> QImage:
    """The first paths of a cut file, drawn by their layers."""
    image = QImage(size, QImage.Format.Format_RGB32)
    image.fill(QColor(PAPER))
    every = np.concatenate([path.points for path in content.paths])
    low, high = every.min(axis=0), every.max(axis=0)
    scale = 0.92 * min(size.width() / (high[0] - low[0]), size.height() / (high[1] - low[1]))
    left, top = 0.5 * (size.width() - scale * (high[0] - low[0])), 0.5 * (size.height() - scale * (high[1] - low[1]))

    def placed(points: FloatArray) -> QPolygonF:
        return QPolygonF(
            [QPointF(left + scale * (x - low[0]), top + scale * (high[1] - y)) for x, y in points.tolist()]
        )

    painter = QPainter(image)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    for path in content.paths[:most]:
        painter.setPen(QPen(QColor(LAYERS.get(path.layer, INK)), 1.8))
        polygon = placed(path.points)
        if path.closed:
            painter.drawPolygon(polygon)
        else:
            painter.drawPolyline(polygon)
    painter.end()
    return image


if __name__ == "__main__":
    sys.exit(main(kind=Screencast))
