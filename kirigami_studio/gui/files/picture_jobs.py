"""Jobs on pictures of views: draw them large, write them, draw the cuts for the clipboard.

A view is recorded in the window's thread, which takes a few milliseconds; the recording is played back here, where it
may take as long as a large picture takes.  Qt allows painting into pictures in any thread, but the interpreter's lock
is kept while Qt paints: painting a whole window four times as large in one go was a UI freeze of 0.4 to 0.8 s.  Hence
it is painted in bands, a file never holds them all at once, and after each band the window's thread may work for as
long as it has something to do.  Without that every 5 ms of its work had to wait for a band of 20 ms.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QSize
from PySide6.QtGui import QColor, QImage, QPainter, QPicture

from kirigami_studio.foundation.errors import Cancelled, ExportError
from kirigami_studio.foundation.steps import Cancel
from kirigami_studio.foundation.words import tr
from kirigami_studio.studio import importing
from kirigami_studio.studio.making import CutRequest, closed, export_job, judged, planned

#: Pixels that are painted at a time; each band costs the whole recording again, less what lies outside it.
BAND = 1_000_000
#: Seconds: a sleep, how late one wakes from it when another thread holds the interpreter's lock, and how long a band
#: waits for that thread at most.
NAP, LATE, GIVEN = 0.0005, 0.002, 0.25


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """How a view was painted."""

    strokes: QPicture
    size: QSize  #: Of the view, pixels
    ground: QColor
    facts: Mapping[str, str] = field(default_factory=dict)  #: Where the design that is shown comes from

    def bands(self, scale: int, cancel: Cancel) -> Iterator[QImage]:
        """The view in pixels, ``scale`` of them for one that was seen: strips of it, from the top."""
        width, height = self.size.width() * scale, self.size.height() * scale
        step = max(1, BAND // width)
        for top in range(0, height, step):
            if cancel():
                raise Cancelled(tr("Stopped {name}.", name=tr("copying a picture")))
            band = QImage(width, min(step, height - top), QImage.Format.Format_RGB32)
            band.fill(self.ground)
            painter = QPainter(band)
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.translate(0, -top)
            painter.scale(scale, scale)
            painter.drawPicture(0, 0, self.strokes)
            painter.end()
            yield band
            give_way()

    def image(self, scale: int, cancel: Cancel = lambda: False) -> QImage:
        """The whole view in pixels."""
        image = QImage(self.size * scale, QImage.Format.Format_RGB32)
        pixels, done = memoryview(image.bits()), 0
        for band in self.bands(scale, cancel):
            pixels[done : done + band.sizeInBytes()] = band.constBits()
            done += band.sizeInBytes()
        return image


def give_way() -> None:
    """Sleep while other threads compute: whoever wakes late had to wait for the interpreter's lock."""
    end = time.perf_counter() + GIVEN
    began = time.perf_counter()
    time.sleep(NAP)
    while time.perf_counter() - began - NAP > LATE and time.perf_counter() < end:
        time.sleep(LATE)
        began = time.perf_counter()
        time.sleep(NAP)


def drawing(recording: Recording, scale: int, cancel: Cancel) -> Iterator[QImage]:
    """Draw a view, for the clipboard."""
    yield recording.image(scale, cancel)


def writing_png(recording: Recording, scale: int, path: Path, cancel: Cancel) -> Iterator[Path]:
    """Draw a view and write it as PNG; every fact becomes a text chunk."""
    from kirigami_studio.export.picture import png_of_bands
    from kirigami_studio.export.provenance import origin_facts
    from kirigami_studio.foundation.files import write_atomically

    colours = map(red_green_blue, recording.bands(scale, cancel))
    size = (recording.size.width() * scale, recording.size.height() * scale)
    write_atomically(path, png_of_bands(size, colours, origin_facts(recording.facts)))
    yield path


def red_green_blue(image: QImage) -> NDArray[np.uint8]:
    """The pixels of an RGB32 image, (height, width, 3); valid as long as the image."""
    shape = (image.height(), image.width(), 4)
    return np.frombuffer(image.constBits(), np.uint8).reshape(shape)[:, :, 2::-1]


def writing_svg(content: bytes, path: Path, cancel: Cancel) -> Iterator[Path]:
    """Write a drawing that is SVG already."""
    from kirigami_studio.foundation.files import write_atomically

    write_atomically(path, content)
    yield path


def drawing_cuts(request: CutRequest, cancel: Cancel) -> Iterator[bytes]:
    """Plan the cuts, judge them and yield them as SVG in mm, the very bytes of an exported file.

    Raises
    ------
    ExportError
        Pieces, which are cut from several files.
    """
    if request.is_pinned:
        raise ExportError("pieces.not_copied")
    importing.import_as_cut()
    from kirigami_studio.export.svg import cut_svg_bytes

    made = planned(request, cancel)
    verdict = judged(request, made, closed(request, made))
    yield cut_svg_bytes(replace(export_job(request, made), verdict=verdict.level.value))
