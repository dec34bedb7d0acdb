"""Jobs on pictures of views: draw them large, write them, draw the cuts for the clipboard.

A view is recorded in the window's thread, which takes a few milliseconds; the recording is played back here, where it
may take as long as a large picture takes.  Qt allows painting into pictures in any thread, but the interpreter's lock
is kept while Qt paints: painting a whole window four times as large in one go was a UI freeze of 0.4 to 0.8 s.  Hence
it is painted in bands, and its pixels are handed on without a copy.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from PySide6.QtCore import QSize
from PySide6.QtGui import QColor, QImage, QPainter, QPicture

from kirigami_studio.gui.jobs.cut_jobs import CutRequest, export_job, planned
from kirigami_studio.gui.jobs.queue import Cancel

#: Pixels that are painted at a time; each band costs the whole recording again, less what lies outside it.
BAND = 1_000_000


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """How a view was painted.

    Attributes
    ----------
    strokes : QPicture
    size : QSize
        Of the view, pixels.
    ground : QColor
    facts : mapping of str to str
        Where the design that is shown comes from.
    """

    strokes: QPicture
    size: QSize
    ground: QColor
    facts: Mapping[str, str] = field(default_factory=dict)

    def image(self, scale: int) -> QImage:
        """The view in pixels, ``scale`` of them for one that was seen."""
        image = QImage(self.size * scale, QImage.Format.Format_RGB32)
        pixels, stride = memoryview(image.bits()), image.bytesPerLine()
        step = max(1, BAND // image.width())
        for top in range(0, image.height(), step):
            height = min(step, image.height() - top)
            own = pixels[top * stride : (top + height) * stride]
            band = QImage(own, image.width(), height, stride, image.format())
            band.fill(self.ground)
            painter = QPainter(band)
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.translate(0, -top)
            painter.scale(scale, scale)
            painter.drawPicture(0, 0, self.strokes)
            painter.end()
        return image


def drawing(recording: Recording, scale: int, cancel: Cancel) -> Iterator[QImage]:
    """Draw a view, for the clipboard."""
    yield recording.image(scale)


def writing_png(recording: Recording, scale: int, path: Path, cancel: Cancel) -> Iterator[Path]:
    """Draw a view and write it as PNG; every fact becomes a text chunk."""
    from PIL import Image

    from kirigami_studio.export.picture import text_chunks
    from kirigami_studio.export.provenance import origin_facts
    from kirigami_studio.foundation.files import write_atomically

    image = recording.image(scale)
    size = (image.width(), image.height())
    pixels = Image.frombytes("RGB", size, image.constBits(), "raw", "BGRX", image.bytesPerLine(), 1)
    stream = io.BytesIO()
    pixels.save(stream, format="PNG", pnginfo=text_chunks(origin_facts(recording.facts)))
    write_atomically(path, stream.getvalue())
    yield path


def writing_svg(content: bytes, path: Path, cancel: Cancel) -> Iterator[Path]:
    """Write a drawing that is SVG already."""
    from kirigami_studio.foundation.files import write_atomically

    write_atomically(path, content)
    yield path


def drawing_cuts(request: CutRequest, cancel: Cancel) -> Iterator[bytes]:
    """Plan the cuts and yield them as SVG in mm, the very bytes of an exported file."""
    from kirigami_studio.export.svg import cut_svg_bytes

    yield cut_svg_bytes(export_job(request, planned(request, cancel)))
