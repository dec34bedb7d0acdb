"""The studio without a display: one whole session through the real widgets, with screenshots and a cut file.

``python -m kirigami_studio.lab.demonstrations.offscreen_session --out out`` picks the heart from the library,
generates, chooses a design, scrubs, exports DXF and saves the project, as a user's mouse and keyboard would.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from PIL import Image
from PySide6.QtCore import QEvent, QEventLoop, QObject, QPoint, QPointF, QRect, Qt
from PySide6.QtGui import QImage, QKeyEvent, QMouseEvent
from PySide6.QtWidgets import QApplication, QWidget

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.gui.files.file_dialogs import FileToOpen
from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.widgets.language import SYSTEM, speak
from kirigami_studio.gui.widgets.theme import DARK, LIGHT
from kirigami_studio.gui.window.application import create_application, create_window
from kirigami_studio.gui.window.main_window import FIRST, MainWindow

DESIGNS = 8
#: Timeout of a step in seconds; the first run loads the generator.
PATIENCE = 180.0
#: Width of the pairs in three columns, pixels.
PAIRS_WIDTH = 850
#: Width of the guide's text, pixels.
GUIDE_WIDTH = 620


class SessionError(RuntimeError):
    """A step of the session did not happen."""


class PresetFiles:
    """File dialogs that answer with files in the output folder."""

    def __init__(self, out: Path) -> None:
        self._out = out

    def open(self, wanted: FileToOpen) -> Path | None:
        return self._out / "session.kiri" if wanted is FileToOpen.PROJECT else None

    def save(self, proposal: str) -> Path | None:
        return self._out / "session.kiri"

    def export(self, proposal: str, to_folder: bool = False) -> Path | None:
        return self._out / Path(proposal).with_stem("cut").name

    def picture(self, proposal: str) -> Path | None:
        return self._out / Path(proposal).name

    def folder(self) -> Path | None:
        return self._out


class OffscreenSession:
    """Plays the steps on one window and takes screenshots."""

    #: Parts of a session that can be played alone, in their order.
    chapters: Sequence[str] = ()

    def __init__(self, out: Path) -> None:
        self.out = out
        self.files: list[Path] = []
        self.application = create_application(["kirigami-studio"])
        self.window: MainWindow = create_window(LIGHT, file_dialogs=PresetFiles(out))
        self.window.resize(FIRST)  # the off-screen platform's own screen is smaller than any real one

    def play(self) -> list[Path]:
        """Run every step and return the files made.

        Raises
        ------
        SessionError
            A step did not lead to what it should.
        """
        self.window.show()
        self.picture("1-empty")
        self.choose_heart()
        self.generate()
        self.choose_second()
        self.scrub()
        self.export()
        self.save()
        self.window.close()
        return self.files

    def choose_heart(self) -> None:
        """Open the library, search, press Enter."""
        click(self.window.target.buttons["library"])
        picker = self.window.dialogs.picker
        if picker is None:
            raise SessionError("The library did not open.")
        press(picker.search, "heart")
        press_key(picker, Qt.Key.Key_Return)
        self.until(lambda: self._target_name() == "heart", "the heart did not load")
        self.picture("2-target")

    def _target_name(self) -> str:
        target = self.window.session.document.target
        return "" if target is None else target.name

    def generate(self) -> None:
        """Ask for a few designs and wait for them."""
        self.window.settings.candidates.setValue(DESIGNS)
        click(self.window.run.generate)
        self.until(lambda: len(self.window.gallery.view.model_.entries) > 0, "no design arrived")
        self.picture("3-generating")
        self.until(lambda: not self.window.services.run.running, "the run did not end")
        if len(self.window.session.document.candidates) != DESIGNS:
            raise SessionError(f"Expected {DESIGNS} designs, got {len(self.window.session.document.candidates)}.")
        self._judged()
        self.picture("4-designs")

    def choose_second(self) -> None:
        """Go from the best design to the next card."""
        press_key(self.window.gallery.view, Qt.Key.Key_Right)
        self.until(lambda: bool(self.window.session.document.chosen), "the second card was not chosen")
        self._judged()

    def _judged(self) -> None:
        """Wait for the cut plan and for the verdict on the sheet as cut, fixes included."""
        self.until(lambda: self.window.fabrication.export.isEnabled(), "no cut plan was made")
        verdict = self.window.services.verdict
        self.until(lambda: verdict.state.verdict is not None and not verdict.busy, "the verdict did not come")

    def scrub(self) -> None:
        """Move the slider from flat to half open, there in the dark theme, then to the target."""
        slider = self.window.stage.deployment.slider
        for degrees, name, palette in ((180, "5-flat", LIGHT), (90, "6-half-open", DARK)):
            self.window.appearance.set_theme(palette)
            slider.setFocus()
            slider.setValue(10 * (180 - degrees))
            self.picture(name)
        self.window.appearance.set_theme(LIGHT)
        slider.setValue(slider.maximum())

    def export(self) -> None:
        """Press Export DXF."""
        path = self.out / "cut.dxf"
        path.unlink(missing_ok=True)
        click(self.window.fabrication.export)
        self.until(
            lambda: any(one.tone is Tone.DONE for one in self.window.messages.messages), "the export did not end"
        )
        self.picture("7-exported")
        self.files.append(path)

    def save(self) -> None:
        """Save the project."""
        path = self.out / "session.kiri"
        path.unlink(missing_ok=True)
        self.window.commands["save"].trigger()
        self.until(lambda: not self.window.session.history.unsaved, "the project was not saved")
        self.files.append(path)

    def until(self, happened: Callable[[], bool], otherwise: str) -> None:
        """Process events until something has happened."""
        end = time.monotonic() + PATIENCE
        while not happened():
            refusals = [one.sentence for one in self.window.messages.messages if one.tone is Tone.ERROR]
            if refusals:
                raise SessionError(refusals[-1])
            if time.monotonic() > end:
                raise SessionError(f"Gave up after {PATIENCE:.0f} s: {otherwise}.")
            QApplication.processEvents(QEventLoop.ProcessEventsFlag.AllEvents, 50)

    def picture(self, name: str, widget: QWidget | None = None) -> None:
        """Save a screenshot of the window or of another widget."""
        QApplication.processEvents()
        path = self.out / f"{name}.png"
        if not (widget or self.window).grab().save(str(path)):
            raise SessionError(f"Cannot write the screenshot {path}.")
        self.files.append(path)


class PairPictures(OffscreenSession):
    """Pictures the bundled pairs for README and guide: the gallery that the window shows of them."""

    def play(self) -> list[Path]:
        """Save it as large as it is drawn, and as wide as the guide's text."""
        self.window.show()
        self.window.commands["pairs"].trigger()
        gallery = self.window.welcome.pairs
        gallery.list.setFixedWidth(PAIRS_WIDTH)
        self.until(lambda: gallery.complete, "the examples were not drawn")
        gallery.list.clearSelection()
        used = gallery.list.visualItemRect(gallery.list.item(gallery.list.count() - 1)).bottom()
        picture = (
            gallery.list.viewport()
            .grab(QRect(0, 0, gallery.list.viewport().width(), used))
            .toImage()
            .convertToFormat(QImage.Format.Format_RGB888)
        )
        whole = Image.frombytes(
            "RGB", (picture.width(), picture.height()), bytes(picture.constBits()), "raw", "RGB", picture.bytesPerLine()
        )
        small = whole.copy()
        small.thumbnail((GUIDE_WIDTH, GUIDE_WIDTH), Image.Resampling.LANCZOS)
        for name, image, colours in (("pairs", whole, 128), ("pairs-small", small, 128)):
            path = self.out / f"{name}.png"
            image.quantize(colours).save(path, optimize=True)
            self.files.append(path)
        self.window.close()
        return self.files


def click(widget: QWidget) -> None:
    """Press and release the left button on a widget's middle."""
    place = QPointF(QPoint(widget.width() // 2, widget.height() // 2))
    left, none = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton
    where = widget.mapToGlobal(place)
    for kind, held in ((QEvent.Type.MouseButtonPress, left), (QEvent.Type.MouseButtonRelease, none)):
        send(widget, QMouseEvent(kind, place, where, left, held, Qt.KeyboardModifier.NoModifier))


def hover(widget: QWidget, place: QPoint) -> None:
    """Move the mouse over a place of a widget, no button pressed."""
    none = Qt.MouseButton.NoButton
    where, nothing = widget.mapToGlobal(QPointF(place)), Qt.KeyboardModifier.NoModifier
    send(widget, QMouseEvent(QEvent.Type.MouseMove, QPointF(place), where, none, none, nothing))


def press(widget: QWidget, text: str) -> None:
    """Type a text."""
    for letter in text:
        press_key(widget, Qt.Key(ord(letter.upper())), letter)


def press_key(widget: QWidget, key: Qt.Key, text: str = "") -> None:
    """Press and release a key."""
    for kind in (QEvent.Type.KeyPress, QEvent.Type.KeyRelease):
        send(widget, QKeyEvent(kind, key, Qt.KeyboardModifier.NoModifier, text))


def send(widget: QObject, event: QEvent) -> None:
    """Deliver an input event."""
    QApplication.sendEvent(widget, event)


def main(argv: list[str] | None = None, kind: type[OffscreenSession] = OffscreenSession) -> int:
    """Play the session, or another one made like it; 0 when every step succeeded."""
    parser = argparse.ArgumentParser(description="Play one studio session without a display.")
    parser.add_argument("--out", type=Path, default=Path("out"), help="folder for screenshots, DXF and project")
    parser.add_argument("--pairs", action="store_true", help="picture the bundled pairs instead")
    parser.add_argument("--scale", type=float, default=1.0, help="device pixels per pixel, such as 2 (default 1)")
    parser.add_argument("--language", default=SYSTEM, help="language of the window, such as de (default the desktop's)")
    if kind.chapters:
        parser.add_argument("--chapters", nargs="+", choices=kind.chapters, help="only these (default all)")
    chosen = parser.parse_args(argv)
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    if chosen.scale != 1.0:
        os.environ["QT_SCALE_FACTOR"] = str(chosen.scale)
    session: OffscreenSession | None = None
    try:
        chosen.out.mkdir(parents=True, exist_ok=True)
        create_application(["kirigami-studio"])
        speak(chosen.language)
        session = PairPictures(chosen.out) if chosen.pairs else kind(chosen.out)
        session.chapters = getattr(chosen, "chapters", None) or session.chapters
        files = session.play()
    except (SessionError, KirigamiError, OSError) as error:
        sys.stderr.write(f"The session failed: {error}\n")
        if session is not None:
            session.window.services.close()
        return 1
    sys.stdout.write("The session was played off-screen through the real window. It wrote\n")
    sys.stdout.writelines(f"  {path}\n" for path in files)
    return 0


if __name__ == "__main__":
    sys.exit(main())
