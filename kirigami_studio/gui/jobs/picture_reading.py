"""A photo behind a target, reduced for drawing by the worker: a large one takes a third of a second to read."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QImage, QImageReader

#: Longer side of the picture as it is kept for drawing, pixels.
LARGEST_SIDE = 1600


def reduced_picture(path: Path) -> QImage | None:
    """The picture turned upright, its longer side at most ``LARGEST_SIDE`` pixels; None when it cannot be read."""
    reader = QImageReader(str(path))
    reader.setAutoTransform(True)
    size = reader.size()
    if size.isValid() and max(size.width(), size.height()) > LARGEST_SIDE:
        reader.setScaledSize(size.scaled(QSize(LARGEST_SIDE, LARGEST_SIDE), Qt.AspectRatioMode.KeepAspectRatio))
    image = reader.read()
    return None if image.isNull() else image
