"""The pictures of the user guide, taken from the real window: ``make pictures`` writes them into ``resources/guide``,
those of the German window into ``resources/guide/de``.

They are taken as a reader of the guide sees the program, on the bundled sample, and kept small: few colours, no wider
than the guide's text.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

from PIL import Image
from PySide6.QtCore import QPoint, QRect, QSize
from PySide6.QtWidgets import QApplication, QWidget

from kirigami_studio.foundation.resources import resource
from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.lab.demonstrations.offscreen_session import GUIDE_WIDTH, OffscreenSession, main

#: Colours of a picture: the window has few, and smooth edges need the rest.
COLOURS = 96
#: The window in which parts are pictured.
SIZE = QSize(1180, 760)


class GuidePictures(OffscreenSession):
    """Takes one window through what the guide tells, in its order."""

    def play(self) -> list[Path]:
        """Take all pictures and return their files."""
        window, services = self.window, self.window.services
        window.resize(SIZE)
        window.show()
        services.targeting.start_with("heart")
        window.pages.turn(WindowPage.SHAPE)
        window.presenters.welcome.begin()
        page = window.welcome
        self.until(lambda: page.ready and self._target_name() == "heart", "the sample did not come")
        page.stop()
        page.view.set_phi(math.radians(100.0))
        self.take("start", window.target, window.welcome)
        window.presenters.welcome.decline()
        window.target.set_tool(Tool.POLYGON)
        self.settle()
        self.take("board", window.target)
        window.target.set_editing(False)
        services.project.new()
        services.project.open(resource("examples", "heart.kiri"))
        self.until(lambda: services.session.stage is not None, "the sample did not open")
        self._judged()
        self.take("target", window.target, window.settings)
        self.take("designs", window.gallery)
        window.stage.deployment.set_phi(math.radians(60.0))
        self.take("opening", window.stage)
        window.stage.deployment.set_phi(0.0)
        window.commands["cuts"].trigger()
        self.take("cuts", window.cuts)
        self.take("fabrication", window.fabrication)
        services.session.history.mark_saved()
        window.close()
        return self.files

    def settle(self) -> None:
        """Let the window lay itself out."""
        for _ in range(4):
            QApplication.processEvents()

    def take(self, name: str, *parts: QWidget) -> None:
        """Picture the box around some parts of the window."""
        self.settle()
        box = QRect()
        for part in parts:
            box = box.united(QRect(part.mapTo(self.window, QPoint()), part.size()))
        file = self.out / f"{name}.png"
        self.window.grab(box).save(str(file))
        with Image.open(file) as picture:
            small = picture.convert("RGB")
        if small.width > GUIDE_WIDTH:
            height = round(small.height * GUIDE_WIDTH / small.width)
            small = small.resize((GUIDE_WIDTH, height), Image.Resampling.LANCZOS)
        small.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(file, optimize=True)
        self.files.append(file)


if __name__ == "__main__":
    sys.exit(main(kind=GuidePictures))
