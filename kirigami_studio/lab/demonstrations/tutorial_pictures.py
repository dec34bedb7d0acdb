"""The pictures of the tutorials, taken from the real window: ``make pictures`` writes them into
``docs/pictures/tutorials``.

The window goes through what the tutorials tell: the heart from the library to its cut file, a logo of three parts, and
a material from a preset to a calibrated one.  Materials are kept in a folder of their own meanwhile.
"""

from __future__ import annotations

import math
import os
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw
from PySide6.QtCore import QSize, Qt
from PySide6.QtWidgets import QApplication, QScrollArea, QWidget

from kirigami_studio.fabricate.coupon import plan_coupon
from kirigami_studio.fabricate.cut_path import Layer
from kirigami_studio.fabricate.material import FOLDER_VARIABLE, find_material
from kirigami_studio.gui.make.shelf_editors import MaterialEditor
from kirigami_studio.lab.demonstrations.offscreen_session import (
    OffscreenSession,
    SessionError,
    click,
    main,
    press,
    press_key,
)
from kirigami_studio.outlines.merging import Join

#: The window, and the width of pages, pixels.
SIZE, PAGE_WIDTH = QSize(1280, 800), 900
COLOURS = 128
LOGO, CUT_FILE = Path("docs/tutorials/logo.svg"), Path("out/heart.dxf")
#: Width of the opened heart, mm.
HEART_MM = 80.0
#: The material of the tutorial on calibration, who measures it, and three gaps beside the comb.
PRESET, AUTHOR, GAPS = "card-co2", "Ada", "1.21 1.18 1.24"
#: Pixels of a millimetre in the picture of the coupon, and around it.
COUPON_SCALE, COUPON_MARGIN = 13.0, 16
INKS = {
    Layer.SLITS: "#2f6fb5",
    Layer.EDGE_SLITS: "#00805f",
    Layer.HOLES: "#1d2733",
    Layer.OUTLINE: "#1d2733",
    Layer.RELIEF: "#c2410c",
}


class TutorialPictures(OffscreenSession):
    """Takes one window through the three tutorials."""

    def play(self) -> list[Path]:
        """Take all pictures and return their files."""
        window = self.window
        window.resize(SIZE)
        window.show()
        self.heart()
        self.logo()
        self.material()
        self.coupon()
        window.session.history.mark_saved()
        window.close()
        return self.files

    def heart(self) -> None:
        """From the library to the report on the file."""
        window = self.window
        click(window.target.buttons["library"])
        picker = window.dialogs.picker
        if picker is None:
            raise SessionError("The library did not open.")
        self.settle()
        self.shrunk("library", picker)
        press(picker.search, "heart")
        press_key(picker, Qt.Key.Key_Return)
        self.until(lambda: self._target_name() == "heart", "the heart did not load")
        window.target.opened.width_.setValue(HEART_MM)
        self.generate_all()
        self.shrunk("designs")
        window.stage.deployment.set_phi(math.radians(75.0))
        self.shrunk("half-open", window.stage)
        window.stage.deployment.set_phi(0.0)
        window.commands["cuts"].trigger()
        self.shrunk("cuts", window.cuts)
        window.commands["cuts"].trigger()
        window.services.exporter.export(CUT_FILE)
        self.until(lambda: window.dialogs.report is not None, "no report was shown")
        if window.dialogs.report is not None:
            self.shrunk("report", window.dialogs.report)
        window.dialogs.close_report()
        self.clear_messages()

    def logo(self) -> None:
        """Parts of a drawing, and the designs for them."""
        window = self.window
        window.session.history.mark_saved()
        window.services.project.new()
        window.services.targeting.open(str(LOGO))
        self.until(lambda: window.dialogs.parts is not None and window.dialogs.parts.isVisible(), "no picker opened")
        parts = window.dialogs.parts
        if parts is None:
            raise SessionError("The picker of parts did not open.")
        click(parts.all)
        parts.join.setCurrentIndex(parts.join.findData(Join.TIGHT))
        self.until(lambda: parts.take.isEnabled() and parts.result_ is not None, "the parts were not joined")
        self.shrunk("parts", parts)
        click(parts.take)
        self.until(lambda: bool(self._target_name()), "the logo was not taken")
        self.generate_all()
        self.shrunk("logo-designs")
        self.clear_messages()

    def material(self) -> None:
        """A copy of a preset, its kerf from three gaps, and the calibrated material."""
        dialogs = self.window.dialogs
        dialogs.show_materials()
        editor = dialogs.materials
        if editor is None:
            raise SessionError("The materials did not open.")
        editor.choose(PRESET)
        click(editor.buttons["copy"])
        editor.form.texts["name"].setText("My card 0.3 mm")
        editor.form.texts["machine"].setText("CO2 laser 40 W")
        for text in ("name", "machine"):
            editor.form.texts[text].setCursorPosition(0)
        editor.form.changed.emit()
        click(editor.buttons["save"])
        self.shrunk("materials", editor)
        self.calibrate(editor)
        editor.close()

    def calibrate(self, editor: MaterialEditor) -> None:
        """Measured gaps, and who measured them."""
        press_text(editor.gaps.gaps, GAPS)
        click(editor.gaps.button)
        self.shrunk("kerf", editor)
        editor.form.numbers["min_ligament_mm"].setValue(0.5)
        editor.author.setText(AUTHOR)
        click(editor.buttons["calibrate"])
        self.shrunk("calibrated", editor)

    def coupon(self) -> None:
        """The test piece of the preset."""
        plan = plan_coupon(find_material(PRESET))
        size = [round(COUPON_SCALE * side) + 2 * COUPON_MARGIN for side in plan.size_mm]
        image = Image.new("RGB", (size[0], size[1]), "white")
        draw = ImageDraw.Draw(image)
        for path in plan.paths:
            points = np.vstack([path.points, path.points[:1]]) if path.closed else path.points
            pixels = points * (COUPON_SCALE, -COUPON_SCALE) + (COUPON_MARGIN, size[1] - COUPON_MARGIN)
            draw.line([tuple(pixel) for pixel in pixels.tolist()], fill=INKS[path.layer], width=2)
        file = self.out / "coupon.png"
        image.quantize(32).save(file, optimize=True)
        self.files.append(file)

    def generate_all(self) -> None:
        """Eight designs, and the verdict on the best."""
        window = self.window
        window.settings.candidates.setValue(8)
        click(window.run.generate)
        self.until(lambda: len(window.gallery.view.model_.entries) > 0, "no design arrived")
        self.until(lambda: not window.services.run.running, "the run did not end")
        self._judged()
        self.until(lambda: not window.gallery.view.cards.pending, "the cards got no pictures")

    def clear_messages(self) -> None:
        """No message stays."""
        while self.window.messages.messages:
            self.window.messages.close_message()

    def settle(self) -> None:
        """Let the window lay itself out."""
        for _ in range(6):
            QApplication.processEvents()

    def shrunk(self, name: str, widget: QWidget | None = None) -> None:
        """Picture the window or a part of it, no wider than a page, in few colours; what scrolls is at its top."""
        self.settle()
        for scrolled in [] if widget is None else widget.findChildren(QScrollArea):
            scrolled.verticalScrollBar().setValue(0)
        self.settle()
        file = self.out / f"{name}.png"
        (widget or self.window).grab().save(str(file))
        with Image.open(file) as picture:
            image = picture.convert("RGB")
        if image.width > PAGE_WIDTH:
            height = round(image.height * PAGE_WIDTH / image.width)
            image = image.resize((PAGE_WIDTH, height), Image.Resampling.LANCZOS)
        image.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(file, optimize=True)
        self.files.append(file)


def press_text(widget: QWidget, text: str) -> None:
    """Type digits, points and blanks."""
    for letter in text:
        press(widget, letter)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as materials:
        os.environ[FOLDER_VARIABLE] = materials
        code = main(kind=TutorialPictures)
    sys.exit(code)
