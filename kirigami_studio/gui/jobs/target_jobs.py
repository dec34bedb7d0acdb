"""Jobs on targets: read a file or a library silhouette, trace a picture at a threshold."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QImage, QImageReader

from kirigami_studio.gui.jobs.queue import Cancel
from kirigami_studio.outlines.outline import Outline

if TYPE_CHECKING:
    from kirigami_studio.outlines.read_image import Traced

#: Extensions of targets that are traced at a threshold.
PICTURES = (".png", ".jpg", ".jpeg", ".bmp")
#: Longer side of the picture as it is kept for drawing, pixels.
LARGEST_SIDE = 1600


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture that a target is traced from; grey levels run from 0 (black) to 1 (white).

    Attributes
    ----------
    path : Path
    automatic, threshold : float, 0..1
        The grey level that suits the picture best, and the one it is traced at.
    traced : Traced or None
        Where the target lies in it.
    seen : QImage or None
        The picture reduced for drawing.
    """

    path: Path
    automatic: float
    threshold: float
    traced: Traced | None = None
    seen: QImage | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class TargetRead:
    """A target that was read, with the picture that it was traced from, if it was."""

    outline: Outline
    picture: Picture | None = None


def reading_target(source: str, cancel: Cancel) -> Iterator[TargetRead]:
    """Read a file or a library silhouette."""
    from kirigami_studio.outlines.read import read_target

    path = Path(source)
    if path.suffix.lower() in PICTURES:
        from kirigami_studio.outlines.read_image import automatic_threshold, trace_image

        level = automatic_threshold(path)
        traced = trace_image(path)
        yield TargetRead(traced.outline, Picture(path, level, level, traced, reduced_picture(path)))
    else:
        yield TargetRead(read_target(source))


def tracing(picture: Picture, cancel: Cancel) -> Iterator[Traced]:
    """Trace a picture at its threshold."""
    from kirigami_studio.outlines.read_image import trace_image

    yield trace_image(picture.path, picture.threshold)


def reduced_picture(path: Path) -> QImage | None:
    """The picture turned upright, its longer side at most ``LARGEST_SIDE`` pixels; None when it cannot be read.

    A large photo takes a third of a second to read, hence this is done in the worker.
    """
    reader = QImageReader(str(path))
    reader.setAutoTransform(True)
    size = reader.size()
    if size.isValid() and max(size.width(), size.height()) > LARGEST_SIDE:
        reader.setScaledSize(size.scaled(QSize(LARGEST_SIDE, LARGEST_SIDE), Qt.AspectRatioMode.KeepAspectRatio))
    image = reader.read()
    return None if image.isNull() else image
