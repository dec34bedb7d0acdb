"""The sheet at any angle, over its target."""

from __future__ import annotations

import math
from enum import Enum

import numpy as np
import numpy.typing as npt
from PySide6.QtGui import QPainter
from PySide6.QtWidgets import QWidget

from kirigami_studio.evaluate.score import Score
from kirigami_studio.gui.scene.chips import Chip, legend_boxes, paint_caption, paint_legend
from kirigami_studio.gui.scene.fault_items import Fault, contact_place, faults, inverted_panels, paint_fault
from kirigami_studio.gui.scene.frame import Bounds, Frame
from kirigami_studio.gui.scene.layout_items import paint_panels, turning_left
from kirigami_studio.gui.scene.mismatch_items import Mismatch, mismatch, paint_mismatch
from kirigami_studio.gui.scene.posed import PosedDesign
from kirigami_studio.gui.scene.target_items import paint_target_line
from kirigami_studio.gui.views.canvas import Canvas
from kirigami_studio.target.outline import Outline

#: Radians around the target angle within which sheet and target are compared; elsewhere a difference means nothing.
COMPARED_WITHIN = math.radians(12.0)
#: Opacity of the target's outline there.
FAINT = 0.4


class Overlay(Enum):
    """What may be drawn over the panels."""

    TARGET = "target"
    MISMATCH = "mismatch"
    FAULTS = "faults"


class LayoutView(Canvas):
    """Draws one design at the current angle; all is computed while painting, so slider storms cost nothing."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._design: PosedDesign | None = None
        self._inverted: npt.NDArray[np.bool_] = np.zeros(0, dtype=np.bool_)
        self._contact: npt.NDArray[np.float64] | None = None
        self._target: Outline | None = None
        self._bounds: Bounds | None = None
        self._phi = math.pi
        self._overlays: frozenset[Overlay] = frozenset(Overlay)
        self._areas: Mismatch | None = None
        self._faults: tuple[Fault, ...] = ()
        self._hint = ("generate", "No design yet", "Choose a target on the left, then press Generate (Ctrl+G).")
        self._caption = ""
        self.frames_painted = 0
        self.setObjectName("layoutView")
        self.setAccessibleName("Layout of the chosen design")
        self.setToolTip("Wheel: zoom. Drag: move. Double-click: show everything.")

    @property
    def phi(self) -> float:
        """Angle that is shown, radians."""
        return self._phi

    @property
    def areas(self) -> Mismatch | None:
        """Missing and extra area of the last painted picture, when that overlay is on."""
        return self._areas

    @property
    def faults(self) -> tuple[Fault, ...]:
        """Marked places of the last painted picture."""
        return self._faults

    @property
    def overlays(self) -> frozenset[Overlay]:
        return self._overlays

    def show_design(self, design: PosedDesign | None, score: Score | None, target: Outline | None) -> None:
        """Show another design; None shows the empty state."""
        self._design, self._target = design, target
        self._areas, self._faults = None, ()
        self._bounds = None
        if design is not None:
            self._bounds = design.bounds()
            self._inverted = inverted_panels(design.panels(design.nodes(design.phi_target)))
            self._contact = None if score is None else contact_place(design, score)
            if target is not None:
                self._bounds = self._bounds.united(Bounds.of(target.points))
        self.update()

    def set_phi(self, phi: float) -> None:
        """Show another angle, radians."""
        self._phi = phi
        self.update()

    def set_overlays(self, overlays: frozenset[Overlay]) -> None:
        """Choose what is drawn over the panels."""
        self._overlays = overlays
        self.update()

    def set_hint(self, icon: str, headline: str, hint: str) -> None:
        """Say in the empty view what to do next."""
        self._hint = (icon, headline, hint)
        self.update()

    @property
    def caption(self) -> str:
        """What the upper left corner says."""
        return self._caption

    def set_caption(self, text: str) -> None:
        """Say in the upper left corner what the header has no room for."""
        self._caption = text
        self.update()

    def empty_state(self) -> tuple[str, str, str]:
        return self._hint

    def scene_bounds(self) -> Bounds | None:
        return self._bounds

    def paint_scene(self, painter: QPainter, frame: Frame) -> None:
        if self._design is None:
            return
        self.frames_painted += 1
        nodes = self._design.nodes(self._phi)
        field = self._design.deployment.field
        panels = frame.to_pixels(self._design.panels(nodes))
        kept = {row: frame.to_pixels(part) for row, part in self._design.kept(nodes, self._phi).items()}
        paint_panels(painter, panels, turning_left(field.rows, field.columns), self.palette_, kept)
        if self._target is not None:
            self._paint_comparison(painter, frame, nodes)
        self._paint_faults(painter, frame, self._design.panels(nodes))

    def _paint_comparison(self, painter: QPainter, frame: Frame, nodes: npt.NDArray[np.float64]) -> None:
        self._areas = None
        if self._design is None or self._target is None:
            return
        nearness = 1.0 - abs(self._phi - self._design.phi_target) / COMPARED_WITHIN
        if Overlay.MISMATCH in self._overlays and nearness > 0.0:
            outline, removed = self._design.outline(nodes, self._phi), self._design.removed(nodes, self._phi)
            self._areas = mismatch(self._target.points, outline, removed)
            painter.setOpacity(min(1.0, 2.0 * nearness))
            paint_mismatch(painter, self._areas, frame, self.palette_)
            painter.setOpacity(1.0)
        if Overlay.TARGET in self._overlays:
            painter.setOpacity(min(1.0, max(FAINT, 2.0 * nearness)))
            paint_target_line(painter, frame.to_pixels(self._target.points), self.palette_)
            painter.setOpacity(1.0)

    def _paint_faults(self, painter: QPainter, frame: Frame, panels: npt.NDArray[np.float64]) -> None:
        self._faults = ()
        if Overlay.FAULTS not in self._overlays:
            return
        self._faults = faults(panels, self._inverted, self._contact)
        for fault in self._faults:
            paint_fault(painter, frame.to_pixels(np.array(fault.where)), fault.kind, self.palette_)

    def paint_notes(self, painter: QPainter) -> None:
        if self._design is None:
            return
        chips = []
        if self._areas is not None:
            chips.append(Chip(self.palette_.missing, f"missing {100 * self._areas.missing_share:.1f} %"))
            chips.append(Chip(self.palette_.extra, f"extra {100 * self._areas.extra_share:.1f} %"))
        if self._faults:
            count = len(self._faults)
            chips.append(Chip(self.palette_.fault, "1 fault" if count == 1 else f"{count} faults"))
        boxes = legend_boxes(chips, painter.fontMetrics(), self.width(), self.height())
        paint_legend(painter, chips, boxes, self.palette_)
        if self._caption:
            paint_caption(painter, self._caption, self.width(), self.palette_)
