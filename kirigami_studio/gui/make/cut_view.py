"""The cut plan at kerf width: cuts, connectors, problems, and the job up to any step."""

from __future__ import annotations

from enum import Enum

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QHelpEvent, QKeyEvent, QKeySequence, QMouseEvent, QPainter, QPen, QPixmap
from PySide6.QtWidgets import QToolTip, QWidget

from kirigami_studio.fabricate.cut_plan import CutPlan, Layer
from kirigami_studio.fabricate.findings import Problem
from kirigami_studio.foundation.words import mark, tr, tr_n
from kirigami_studio.gui.make.cut_items import (
    CutDrawing,
    layer_colour,
    paint_cut_sheet,
    paint_cuts,
    paint_name,
    paint_start,
    paint_travel,
)
from kirigami_studio.gui.make.hinge_gestures import HingeGestures, adds
from kirigami_studio.gui.stage.connector_items import Connectors, paint_connectors
from kirigami_studio.gui.stage.fault_items import FaultKind, paint_fault
from kirigami_studio.gui.widgets.canvas import Canvas
from kirigami_studio.gui.widgets.legends import (
    LONGEST,
    Chip,
    legend_boxes,
    paint_caption,
    paint_legend,
    paint_scale_bar,
)
from kirigami_studio.gui.widgets.paths import blank, painter_on
from kirigami_studio.gui.widgets.readable import in_unit, readable_size, readable_width
from kirigami_studio.gui.widgets.view_transform import Bounds, ViewTransform

#: Layer names for the legend.
LAYER_NAMES = {
    Layer.RELIEF: mark("relief ends"),
    Layer.SLITS: mark("slits"),
    Layer.EDGE_SLITS: mark("edge slits"),
    Layer.HOLES: mark("holes"),
    Layer.OUTLINE: mark("outline"),
}
#: Narrower than this (pixels) the legend leaves the outline out.
ROOM_FOR_OUTLINE = 480
#: A problem that is gone to appears this much enlarged.
CLOSE_UP = 6.0
#: Distance (pixels) from a problem's mark that still takes a click.
PROBLEM_REACH = 11.0
HINT = mark(
    "Wheel: zoom. Drag: pan. Click a connector to select it; Shift+click or Shift+drag: "
    "more; Ctrl+A: all. Drag it to resize (Alt: fine) or type a width. Double-click or "
    "Delete cuts through; double-click again restores."
)


class CutOverlay(Enum):
    """What may be drawn over the cuts."""

    TRAVEL = "travel"
    CONNECTORS = "connectors"
    PROBLEMS = "problems"
    BED = "bed"


class CutView(Canvas):
    """Draws one plan and reports what the mouse and the keyboard want of its connectors."""

    selection_changed = Signal(frozenset)  #: numbers of connectors
    remove_wanted = Signal()
    typed = Signal(str)  #: the first letter of a width
    problem_picked = Signal(int)  #: its number in the report

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._drawing: CutDrawing | None = None
        self._connectors: Connectors | None = None
        self._problems: tuple[Problem, ...] = ()
        self._problem = -1
        self._step = 0
        self._bed = (0.0, 0.0)
        self.overlays: frozenset[CutOverlay] = frozenset({CutOverlay.CONNECTORS, CutOverlay.PROBLEMS})
        self._caption = ""
        self._markers: tuple[tuple[object, ...], QPixmap] | None = None
        self.gestures = HingeGestures(self)
        self.gestures.changed.connect(self._take_selection)
        self.setObjectName("cutView")
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAccessibleName(tr("Cut preview"))
        self.setAccessibleDescription(tr(HINT))
        self.setMouseTracking(True)

    @property
    def step(self) -> int:
        """How many cuts are shown as made."""
        return self._step

    @property
    def selected(self) -> frozenset[int]:
        """Numbers of the selected connectors."""
        return self.gestures.selected

    @property
    def shows_name(self) -> bool:
        """Whether a name is engraved on the sheet."""
        return self._drawing is not None and not self._drawing.name.isEmpty()

    def show_plan(self, plan: CutPlan | None, problems: tuple[Problem, ...]) -> None:
        """Show another plan, all cut; None shows the empty state."""
        self._drawing = None if plan is None else CutDrawing(plan)
        self._connectors = None if plan is None else Connectors(plan)
        self._problems, self._problem = problems, -1
        self._step = 0 if plan is None else len(plan.paths)
        self.gestures.set_connectors(self._connectors)
        self.update()

    def show_step(self, step: int) -> None:
        """Show the job after so many cuts."""
        self._step = step
        self.update()

    def set_overlays(self, overlays: frozenset[CutOverlay]) -> None:
        """Choose what is drawn over the cuts."""
        turned = (CutOverlay.BED in overlays) is not (CutOverlay.BED in self.overlays)
        self.overlays = overlays
        if turned:
            self.fit()
        if CutOverlay.CONNECTORS not in overlays:
            self.gestures.select(frozenset())
        self.update()

    def show_bed(self, reach_mm: tuple[float, float]) -> None:
        """Set the bed that the sheet lies on (width, height; mm); zeros where there is none."""
        self._bed = reach_mm
        self.update()

    @property
    def on_bed(self) -> bool:
        """Whether the bed is shown."""
        return CutOverlay.BED in self.overlays and min(self._bed) > 0.0

    def set_caption(self, text: str) -> None:
        """Say in the upper left corner why the picture is not the newest."""
        self._caption = text
        self.update()

    def go_to(self, problem: int) -> None:
        """Bring the place of a problem to the middle, if it has one."""
        self._problem = problem
        where = self._problems[problem].where if 0 <= problem < len(self._problems) else None
        if where is not None:
            self.zoom_to(where, CLOSE_UP)
        self.update()

    # drawing -------------------------------------------------------------------------------------------------------

    def empty_state(self) -> tuple[str, str, str]:
        return "trim", tr("No cuts yet"), tr("The cut plan of the chosen design appears here.")

    def scene_bounds(self) -> Bounds | None:
        if self._drawing is None or not self.on_bed:
            return None if self._drawing is None else self._drawing.bounds
        sheet = self._drawing.bounds
        return Bounds.of(np.array([[sheet.left, sheet.bottom], [sheet.right, sheet.top], [0.0, 0.0], self._bed]))

    def paint_scene(self, painter: QPainter, transform: ViewTransform) -> None:
        if self._drawing is None or self._connectors is None:
            return
        if self.on_bed:
            (left, bottom), (right, top) = transform.to_pixels(np.array([[0.0, 0.0], self._bed])).tolist()
            painter.setPen(QPen(QColor(self.palette_.muted), 1.0, Qt.PenStyle.DashLine))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(QRectF(left, top, right - left, bottom - top))
        paint_cut_sheet(painter, self._drawing, transform, self.palette_)
        paint_cuts(painter, self._drawing, transform, self.palette_, self._step, QRectF(self.rect()))
        paint_name(painter, self._drawing, transform, self.palette_)
        if CutOverlay.TRAVEL in self.overlays:
            paint_travel(painter, self._drawing, transform, self.palette_, self._step)
        if CutOverlay.CONNECTORS in self.overlays and self.rendering:
            paint_connectors(painter, self._connectors, transform, self.palette_, self.selected)
        elif CutOverlay.CONNECTORS in self.overlays:
            painter.drawPixmap(0, 0, self._connector_picture(self._connectors, transform))
        paint_start(painter, self._drawing, transform, self.palette_)
        if CutOverlay.PROBLEMS in self.overlays:
            self._paint_problems(painter, transform)
        if self.gestures.band is not None:
            painter.setPen(QPen(QColor(self.palette_.accent), 1.2, Qt.PenStyle.DashLine))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(self.gestures.band)

    def _connector_picture(self, connectors: Connectors, transform: ViewTransform) -> QPixmap:
        """The markers; cached while the job is played, because a thousand round dots take longer than all cuts."""
        ratio = self.devicePixelRatioF()
        key = (connectors, transform, self.selected, self.palette_.name, self.width(), self.height(), ratio)
        if self._markers is None or self._markers[0] != key:
            picture = blank(self.size(), ratio)
            painter = painter_on(picture)
            paint_connectors(painter, connectors, transform, self.palette_, self.selected)
            painter.end()
            self._markers = (key, picture)
        return self._markers[1]

    def _paint_problems(self, painter: QPainter, transform: ViewTransform) -> None:
        for number, problem in enumerate(self._problems):
            if problem.where is not None:
                size = 12.0 if number == self._problem else 9.0
                paint_fault(
                    painter, transform.to_pixels(np.array(problem.where)), FaultKind.CONTACT, self.palette_, size
                )

    def paint_notes(self, painter: QPainter) -> None:
        transform = self.transform()
        if transform is None or self._drawing is None:
            return
        chips = self._chips()
        paint_legend(painter, chips, self._legend_boxes(chips), self.palette_)
        end = QPointF(self.width() - 16.0, self.height() - 18.0)
        paint_scale_bar(painter, transform.scale, end, self.palette_)
        caption = self._caption
        if self.gestures.dragged_mm is not None:
            caption = tr_n(
                "Connector: {width_mm:.3f} mm",
                "{count} connectors: {width_mm:.3f} mm",
                len(self.selected),
                width_mm=self.gestures.dragged_mm,
            )
        if caption:
            paint_caption(painter, caption, self.width(), self.palette_)

    def scene_box(self) -> QRectF:
        """Above the legend."""
        boxes = self._legend_boxes(self._chips())
        top = min((box.top() for box in boxes), default=float(self.height()))
        return QRectF(0.0, 0.0, self.width(), max(top - 6.0, 0.4 * self.height()))

    def _legend_boxes(self, chips: list[Chip]) -> list[QRectF]:
        return legend_boxes(chips, self.fontMetrics(), self.width(), self.height() + 4.0, LONGEST + 8.0)

    def _chips(self) -> list[Chip]:
        if self._drawing is None or self._connectors is None:
            return []
        layers = tuple(self._drawing.on_layer)
        if self.width() < ROOM_FOR_OUTLINE:  # which everyone knows without a label
            layers = tuple(layer for layer in layers if layer is not Layer.OUTLINE)
        chips = [Chip((layer_colour(layer, self.palette_),), tr(LAYER_NAMES[layer])) for layer in layers]
        if self.on_bed:
            chips.append(Chip((self.palette_.muted,), tr("bed {size}", size=readable_size(*self._bed))))
        if self.shows_name:
            chips.append(Chip((self.palette_.engraved,), tr("engraved name")))
        if CutOverlay.CONNECTORS in self.overlays and len(self._connectors):
            low, high = self._connectors.span_mm
            if self._connectors.varied:
                text = tr("connectors {low}\N{EN DASH}{high}", low=in_unit(low, 2), high=readable_width(high))
                chips.append(Chip(self.palette_.widths, text))
            else:
                chips.append(Chip(self.palette_.widths[:1], tr("connectors {width}", width=readable_width(low))))
        return chips

    # gestures ------------------------------------------------------------------------------------------------------

    def _take_selection(self) -> None:
        self.update()
        self.selection_changed.emit(self.selected)

    def _problem_at(self, place: QPointF, transform: ViewTransform) -> int | None:
        if CutOverlay.PROBLEMS not in self.overlays:
            return None
        for number, problem in enumerate(self._problems):
            if problem.where is not None:
                x, y = transform.to_pixels(np.array(problem.where)).tolist()
                if (place - QPointF(x, y)).manhattanLength() <= PROBLEM_REACH:
                    return number
        return None

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        transform = self.transform()
        if event.button() is Qt.MouseButton.LeftButton and transform is not None:
            problem = self._problem_at(event.position(), transform)
            if problem is not None and not adds(event.modifiers()):
                self.problem_picked.emit(problem)
                return
            shown = CutOverlay.CONNECTORS in self.overlays
            if shown and self.gestures.press(event.position(), transform, adds(event.modifiers())):
                return
        super().mousePressEvent(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        held = bool(event.buttons() & Qt.MouseButton.LeftButton)
        fine = bool(event.modifiers() & Qt.KeyboardModifier.AltModifier)
        if not (held and self.gestures.move(event.position(), fine)):
            super().mouseMoveEvent(event)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        transform, shown = self.transform(), CutOverlay.CONNECTORS in self.overlays
        if not (shown and transform is not None and self.gestures.double_click(event.position(), transform)):
            super().mouseDoubleClickEvent(event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        transform = self.transform()
        if event.button() is Qt.MouseButton.LeftButton and transform is not None:
            self.gestures.release(event.position(), transform)
        super().mouseReleaseEvent(event)

    def event(self, event: QEvent) -> bool:
        """Hover text, and the keys that belong to a selection instead of the window."""
        if isinstance(event, QHelpEvent) and event.type() == QEvent.Type.ToolTip:
            QToolTip.showText(event.globalPos(), self._hover(QPointF(event.pos())), self)
            return True
        if isinstance(event, QKeyEvent) and event.type() == QEvent.Type.ShortcutOverride and self._wants(event):
            event.accept()
            return True
        return super().event(event)

    def _hover(self, place: QPointF) -> str:
        transform = self.transform()
        if transform is None or self._connectors is None:
            return ""
        problem = self._problem_at(place, transform)
        if problem is not None:
            return self._problems[problem].text
        hinge = self._connectors.nearest(place, transform) if CutOverlay.CONNECTORS in self.overlays else None
        return tr(HINT) if hinge is None else self._connectors.described(hinge)

    def _wants(self, event: QKeyEvent) -> bool:
        if event.matches(QKeySequence.StandardKey.SelectAll):
            return True
        keys = (Qt.Key.Key_Delete, Qt.Key.Key_Backspace, Qt.Key.Key_Escape)
        return bool(self.selected) and (event.key() in keys or _starts_number(event))

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        key = event.key()
        if key in (Qt.Key.Key_Left, Qt.Key.Key_Right) and self._connectors is not None:
            self.gestures.walk(1 if key == Qt.Key.Key_Right else -1)
        elif event.matches(QKeySequence.StandardKey.SelectAll):
            if self._connectors is not None and CutOverlay.CONNECTORS in self.overlays:
                self.gestures.select(frozenset(range(len(self._connectors))))
        elif not self.selected:
            super().keyPressEvent(event)
        elif key in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace):
            self.remove_wanted.emit()
        elif key == Qt.Key.Key_Escape:
            self.gestures.select(frozenset())
        elif _starts_number(event):
            self.typed.emit(event.text())
        else:
            super().keyPressEvent(event)


def _starts_number(event: QKeyEvent) -> bool:
    return len(event.text()) == 1 and event.text() in "0123456789.,"
