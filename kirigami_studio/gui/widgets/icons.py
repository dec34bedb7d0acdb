"""The program's own line icons, tinted for the palette and sharp at every screen scale."""

from __future__ import annotations

import atexit
from functools import cache, lru_cache

from PySide6.QtCore import QByteArray, QRectF
from PySide6.QtGui import QColor, QIcon, QImage, QPainter, QPixmap
from PySide6.QtSvg import QSvgRenderer

from kirigami_studio.foundation.resources import resource
from kirigami_studio.gui.widgets.theme import Palette

#: Edge lengths (pixels) that are rendered: 16, 20 and 24 at 100 %, 200 % and 300 % scale.
SIZES = (16, 20, 24, 32, 40, 48, 60, 72)


@cache
def source(name: str) -> str:
    """Return the SVG text of one bundled icon, drawn in ``currentColor``."""
    return resource("icons", f"{name}.svg").read_text(encoding="utf-8")


def pixmap(name: str, colour: str, size: int, ratio: float = 1.0) -> QPixmap:
    """Render one icon in one colour.

    Parameters
    ----------
    size : int, logical pixels
    ratio : float
        Device pixels per logical pixel.
    """
    result = QPixmap.fromImage(_image(name, colour, max(1, round(size * ratio))))
    result.setDevicePixelRatio(ratio)
    return result


def coloured(name: str, size: int, ratio: float = 1.0) -> QPixmap:
    """Render one icon in the colours of its own drawing, as :func:`pixmap` does in one colour."""
    result = QPixmap.fromImage(_shape(name, max(1, round(size * ratio))))
    result.setDevicePixelRatio(ratio)
    return result


def icon(name: str, palette: Palette, colour: str | None = None) -> QIcon:
    """Return the icon for buttons and menus: text colour when enabled, faint when disabled."""
    return _icon(name, colour or palette.text, palette.disabled)


@cache
def _icon(name: str, colour: str, disabled: str) -> QIcon:
    """One icon in all sizes: a window shows most of them several times."""
    result = QIcon()
    for size in SIZES:
        result.addPixmap(pixmap(name, colour, size), QIcon.Mode.Normal)
        result.addPixmap(pixmap(name, disabled, size), QIcon.Mode.Disabled)
    return result


# No pixmap may outlive the application, which ends after this.
atexit.register(_icon.cache_clear)


@cache
def _image(name: str, colour: str, edge: int) -> QImage:
    """One icon, drawn once: a theme has hundreds of them, and switching back to it should cost nothing."""
    result = QImage(_shape(name, edge))
    painter = QPainter(result)
    painter.setCompositionMode(QPainter.CompositionMode.CompositionMode_SourceIn)
    painter.fillRect(result.rect(), QColor(colour))
    painter.end()
    return result


@cache
def _shape(name: str, edge: int) -> QImage:
    """One icon in black: drawing it costs ten times as much as giving it a colour."""
    result = QImage(edge, edge, QImage.Format.Format_ARGB32_Premultiplied)
    result.fill(0)
    painter = QPainter(result)
    _drawing(name).render(painter, QRectF(0, 0, edge, edge))
    painter.end()
    return result


@lru_cache(maxsize=4)
def _drawing(name: str) -> QSvgRenderer:
    """The parsed icon, kept while its sizes are drawn."""
    return QSvgRenderer(QByteArray(source(name).replace("currentColor", "black").encode()))
