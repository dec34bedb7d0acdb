"""A candidate as a small picture: its layout at the target angle under the target's outline."""

from __future__ import annotations

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QPainter, QPixmap

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.gui.look.theme import Palette
from kirigami_studio.gui.scene.layout_items import paint_panels, turning_left
from kirigami_studio.gui.scene.target_items import paint_target_line, paint_target_shape
from kirigami_studio.gui.scene.view_transform import Bounds, ViewTransform
from kirigami_studio.outlines.outline import Outline

MARGIN = 6.0


def paint_candidate(
    painter: QPainter, rect: QRectF, design: PosedDesign, target: Outline | None, palette: Palette
) -> None:
    """Draw one design and its target into ``rect``."""
    nodes = design.nodes(design.phi_target)
    bounds = Bounds.of(nodes)
    if target is not None:
        bounds = bounds.united(Bounds.of(target.points))
    transform = ViewTransform.fitting(bounds, rect, MARGIN)
    field = design.deployment.field
    kept = {row: transform.to_pixels(part) for row, part in design.kept(nodes, design.phi_target).items()}
    panels = transform.to_pixels(design.panels(nodes))
    paint_panels(painter, panels, turning_left(field.rows, field.columns), palette, kept)
    if target is not None:
        paint_target_line(painter, transform.to_pixels(target.points), palette, width=1.4)


def candidate_pixmap(
    design: PosedDesign, target: Outline | None, size: QSize, ratio: float, palette: Palette
) -> QPixmap:
    """Return the picture for a gallery card, ``size`` in logical pixels."""
    pixmap = _blank(size, ratio)
    painter = _painter(pixmap)
    paint_candidate(painter, QRectF(0, 0, size.width(), size.height()), design, target, palette)
    painter.end()
    return pixmap


def target_pixmap(target: Outline, size: QSize, ratio: float, palette: Palette) -> QPixmap:
    """Return a target's picture for the library, ``size`` in logical pixels."""
    pixmap = _blank(size, ratio)
    painter = _painter(pixmap)
    transform = ViewTransform.fitting(Bounds.of(target.points), QRectF(0, 0, size.width(), size.height()), MARGIN)
    paint_target_shape(painter, transform.to_pixels(target.points), palette)
    painter.end()
    return pixmap


def _blank(size: QSize, ratio: float) -> QPixmap:
    pixmap = QPixmap(round(size.width() * ratio), round(size.height() * ratio))
    pixmap.setDevicePixelRatio(ratio)
    pixmap.fill(Qt.GlobalColor.transparent)
    return pixmap


def _painter(pixmap: QPixmap) -> QPainter:
    painter = QPainter(pixmap)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    return painter
