"""What each construction looks like, half open: pictures for the first question of the window.

``python -m kirigami_studio.lab.demonstrations.construction_pictures --out resources/constructions`` designs the same
square in a material of each construction and pictures it from the stage.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

from PIL import Image, ImageChops
from PySide6.QtCore import QSize
from PySide6.QtGui import QImage, QPainter

from kirigami_studio.fabricate.material import Construction
from kirigami_studio.lab.demonstrations.offscreen_session import OffscreenSession, main
from kirigami_studio.outlines.starts import RECTANGLE

#: A material of each construction.
MATERIALS = {
    Construction.ONE_SHEET: "card-co2",
    Construction.PINNED: "plywood-co2",
    Construction.BACKED: "cotton-co2",
    Construction.PRINTED: "pla-print",
}
GRID, WIDTH_MM, OPEN = (3, 3), 100.0, math.radians(70.0)
#: The picture as drawn, its margin, as kept (pixels), and its colours.
DRAWN, MARGIN, KEPT, COLOURS = QSize(560, 560), 16, (112, 112), 64


class ConstructionPictures(OffscreenSession):
    """Takes one window from construction to construction."""

    def play(self) -> list[Path]:
        """Make all pictures and return their files."""
        window, services = self.window, self.window.services
        window.show()
        services.targeting.open("square")
        self.until(lambda: self._target_name() == "square", "the square did not load")
        services.settings.change(auto_grid=False, grid=GRID, k=2, start=RECTANGLE)
        for construction, material in MATERIALS.items():
            services.fabrication.change(material=material, construction=None, width_mm=WIDTH_MM)
            services.generation.generate()
            self.until(lambda: not services.run.running, "the run did not end")
            self._judged()
            self.take(construction)
        services.session.history.mark_saved()
        window.close()
        return self.files

    def take(self, construction: Construction) -> None:
        """Picture the design on the stage, half open, without what is drawn over it."""
        view = self.window.stage.view
        view.set_overlays(frozenset())
        view.set_phi(OPEN)
        picture = QImage(DRAWN, QImage.Format.Format_RGB888)
        picture.fill(view.palette_.canvas)
        painter = QPainter(picture)
        with view.without_overlays():
            view.render_to(painter, DRAWN)
        painter.end()
        path = self.out / f"{construction.value}.png"
        size = (DRAWN.width(), DRAWN.height())
        whole = Image.frombytes("RGB", size, bytes(picture.constBits()), "raw", "RGB", picture.bytesPerLine())
        ground = Image.new("RGB", size, view.palette_.canvas)
        left, top, right, bottom = ImageChops.difference(whole, ground).getbbox() or (0, 0, *size)
        square = Image.new("RGB", (2 * MARGIN + max(right - left, bottom - top),) * 2, view.palette_.canvas)
        square.paste(whole.crop((left, top, right, bottom)), (MARGIN, MARGIN))
        small = square.resize(KEPT, Image.Resampling.LANCZOS)
        small.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(path, optimize=True)
        self.files.append(path)


if __name__ == "__main__":
    sys.exit(main(kind=ConstructionPictures))
