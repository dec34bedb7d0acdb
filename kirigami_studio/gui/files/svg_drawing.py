"""SVG documents -> pictures, drawn by Qt: for the window, and for the command line, which has no drawing of its own.

Qt draws SVG Tiny 1.2 and a part of SVG 1.1: shapes, gradients, pictures and text; no clip paths and no filters that it
does not know.
"""

from __future__ import annotations

from PySide6.QtCore import QBuffer, QByteArray, QIODevice, QSize, Qt
from PySide6.QtGui import QGuiApplication, QImage, QImageWriter, QPainter
from PySide6.QtSvg import QSvgRenderer

from kirigami_studio.foundation.errors import TargetError

#: Command lines have no display; text needs an application all the same, because it has the fonts.
_APPLICATION: list[QGuiApplication] = []


def svg_to_png(content: bytes, side: int) -> bytes:
    """Draw a document on nothing.

    Parameters
    ----------
    content : bytes
    side : int
        Pixels along the longer side of the document's page.

    Returns
    -------
    png : bytes

    Raises
    ------
    TargetError
        It cannot be drawn, or nothing is in it.
    """
    if QGuiApplication.instance() is None:
        _APPLICATION.append(QGuiApplication(["kirigami-studio", "-platform", "offscreen"]))
    renderer = QSvgRenderer(QByteArray(content))
    page = renderer.viewBoxF().size() if not renderer.viewBoxF().isEmpty() else renderer.defaultSize().toSizeF()
    if not renderer.isValid() or page.isEmpty():
        raise TargetError("artwork.svg_not_drawn")
    size = QSize(1, 1).expandedTo((page * (side / max(page.width(), page.height()))).toSize())
    image = QImage(size, QImage.Format.Format_ARGB32_Premultiplied)
    image.fill(Qt.GlobalColor.transparent)
    painter = QPainter(image)
    renderer.render(painter)
    painter.end()
    stored = QByteArray()
    buffer = QBuffer(stored)
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    QImageWriter(buffer, QByteArray(b"PNG")).write(image)
    return bytes(stored.data())
