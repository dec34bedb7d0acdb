"""The target: shown, and drawn on with the tools beside it; the picture under it lies still while it is traced."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QFocusEvent,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPainter,
)
from PySide6.QtWidgets import QWidget

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.target.point_tool import PointTool
from kirigami_studio.gui.target.pose_tool import PoseTool
from kirigami_studio.gui.target.rulers import RULER, Rulers
from kirigami_studio.gui.target.shape_tools import BoxTool, Freehand, Pen, figure_tool, text_tool
from kirigami_studio.gui.target.sketch_context import BOARD, PointerEvent, SketchContext, SketchTool
from kirigami_studio.gui.widgets.canvas import ZOOM_STEP, Canvas
from kirigami_studio.gui.widgets.file_drops import FileDrops
from kirigami_studio.gui.widgets.paths import ink
from kirigami_studio.gui.widgets.target_items import (
    paint_axes,
    paint_design_preview,
    paint_grid,
    paint_object,
    paint_proposal,
    paint_reach,
    paint_target_line,
    paint_target_shape,
)
from kirigami_studio.gui.widgets.view_transform import Bounds, ViewTransform
from kirigami_studio.outlines.figures import Figure
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.placed import Placed
from kirigami_studio.outlines.reach import Reach
from kirigami_studio.studio.targets import Picture

if TYPE_CHECKING:
    from kirigami_studio.outlines.read_image import Traced

#: Room around the target on the board while it is edited, as a share of its size.
ROOM = 0.2
#: Scales this near (relative) are one scale.
SAME_SCALE = 1e-6
#: Millimetres of an inch.
INCH = 25.4
#: How much of the picture below the board shines through.
OPACITY = 0.5


class Tool(Enum):
    """What the pointer does on the target."""

    LOOK = "look"
    POINTS = "points"
    POSE = "pose"
    FREEHAND = "freehand"
    POLYGON = "polygon"
    RECTANGLE = "rectangle"
    ELLIPSE = "ellipse"
    REGULAR = "regular"
    STAR = "star"
    TEXT = "text"


class TargetView(Canvas):
    """Shows one outline on a board in mm and lets the user change it."""

    tool_left = Signal()
    typed = Signal(str)  #: a letter for the text tool
    editing_left = Signal()
    hint = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.outline: Outline | None = None
        self._proposal: Placed | None = None
        self._preview: PosedDesign | None = None
        self.reach: Reach | None = None
        self.underlay: Underlay | None = None
        self._editing = False
        self._panning = False
        self._board = BOARD
        self.context = SketchContext(self)
        self.context.repaint.connect(self.update)
        self.context.tool_done.connect(self.tool_left)
        self.tool = Tool.LOOK
        self._tools = _tools(self.context)
        self.rulers = Rulers(self.context)
        self.drops = FileDrops(self, with_content=True)
        self.setMouseTracking(True)
        self.setObjectName("targetView")
        self.setAccessibleName(tr("Target silhouette"))
        self.setToolTip(tr("The shape the sheet opens into. Drop a PNG, JPG, SVG, DXF or JSON file here."))

    @property
    def active(self) -> SketchTool:
        """What follows the pointer now."""
        return self._tools[self.tool]

    def lay_text(self) -> None:
        """Lay the text that was typed on the board, as Enter does for every shape."""
        tool = self.active
        if isinstance(tool, BoxTool):
            tool.lay()
            self.setFocus()

    def show_outline(
        self, outline: Outline | None, picture: Picture | None = None, objects: tuple[Outline, ...] = ()
    ) -> None:
        """Show another target; an unfinished sketch is dropped.

        ``objects`` are those that it was made of, if they are several.  A target that was drawn here, or traced from
        the picture that lies here, stays where it is, with the board as it is seen; another one is fitted.  All have
        the size in mm that they are shown in; a picture lies under its contour.
        """
        drawn = None if outline is None else self.context.recall(outline)
        traced = None if picture is None else picture.traced
        under = self.underlay
        same = under is not None and picture is not None and under.path == picture.path
        if outline is not None and under is not None and same and traced is not None:
            there, here = under.place(traced), Placed.on_board(outline)
            if drawn is None and math.isclose(here.scale, there.scale, rel_tol=SAME_SCALE):
                drawn = there  # the picture lies still
            else:
                drawn = drawn or (here if outline.place is not None else replace(here, centre=there.centre))
                under = under.laid_under(drawn, traced)
        elif drawn is None:
            under = None
        self.outline, self._proposal, self.reach = outline, None, None
        target = drawn or (None if outline is None else Placed.on_board(outline))
        alone = () if target is None else (target,)
        self.context.show(target, tuple(map(self._placed, objects)) if len(objects) > 1 else alone)
        seen = None if picture is None else picture.seen
        if under is None and picture is not None and seen is not None and traced is not None and self.context.placed:
            under = Underlay.under(self.context.placed, picture.path, picture_image(seen), traced)
        self.underlay = under
        if drawn is None or not self._editing:
            self._choose_board()
            self.fit()
        self.active.sync()
        self.update()

    def _placed(self, outline: Outline) -> Placed:
        return self.context.recall(outline) or Placed.on_board(outline)

    def on_picture(self, outline: Outline, traced: Traced | None) -> Outline:
        """Give a contour its size and place on the picture that lies on the open board."""
        if not self._editing or self.underlay is None or traced is None:
            return outline
        placed = self.underlay.place(traced)
        return replace(outline, size=placed.size, unit="mm", place=placed.centre)

    def show_reach(self, reach: Reach | None) -> None:
        """Mark what the chosen grid can hardly show of this target."""
        self.reach = reach
        self.update()

    def show_proposal(self, placed: Placed | None) -> None:
        """Show what the target would become, or stop doing so."""
        self._proposal = placed
        self.update()

    def show_preview(self, design: PosedDesign | None) -> None:
        """Show a quick fit to the target, or to what it would become, over it; or none."""
        self._preview = design
        self.update()

    def set_tool(self, tool: Tool) -> None:
        """Change what the pointer does."""
        self.active.drop()
        self.tool = tool
        self.active.sync()
        self.setCursor(self.active.cursor)
        if tool is not Tool.LOOK:
            self.setFocus()
        self.hint.emit(tr(self.active.hint))
        self.update()

    def set_editing(self, on: bool) -> None:
        """Show the board with its grid around the target, or the target alone."""
        self._editing = on
        self._choose_board()
        self.fit()

    def fit(self) -> None:
        self._choose_board()
        super().fit()

    def zoom_to_selection(self) -> None:
        """Show what is selected as large as possible."""
        transform, chosen = self.transform(), self.active.selected_box()
        if transform is None or chosen is None:
            return
        box = self.scene_box()
        wanted = ViewTransform.fitting(chosen, box, 2 * self.margin()).scale
        self.zoom(wanted / transform.scale)
        now = self.transform() or transform
        middle = np.array([0.5 * (chosen.left + chosen.right), 0.5 * (chosen.bottom + chosen.top)])
        self._shift += box.center() - QPointF(*now.to_pixels(middle).tolist())
        self._show_view()

    def zoom_to_real_size(self) -> None:
        """Show a millimetre as long as it is on paper."""
        transform = self.transform()
        if transform is not None:
            self.zoom(self.screen().physicalDotsPerInch() / INCH / transform.scale)

    def _choose_board(self) -> None:
        """Room to draw in: around the target, or the empty board."""
        placed = self.context.placed
        if placed is None:
            self._board = BOARD
            return
        tight = Bounds.of(placed.ring)
        for each in self.context.drawing.objects:
            tight = tight.united(Bounds.of(each.ring))
        room = ROOM * max(tight.right - tight.left, tight.top - tight.bottom)
        self._board = Bounds(tight.left - room, tight.bottom - room, tight.right + room, tight.top + room)

    def empty_state(self) -> tuple[str, str, str]:
        return (
            "target",
            tr("No target yet"),
            tr("Drop an image, SVG or DXF here, choose one from the library, or draw."),
        )

    def minimumSizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        """Lower than other canvases: in a low window with a message the settings below need the room."""
        return QSize(140, 56)

    def scene_bounds(self) -> Bounds | None:
        if self._editing:
            return self._board
        if self.context.placed is not None:
            return Bounds.of(self.context.placed.ring)
        return None if self.tool is Tool.LOOK else BOARD

    def scene_box(self) -> QRectF:
        """The view, on the board without its rulers."""
        edge = RULER if self._editing else 0.0
        return QRectF(self.rect()).adjusted(edge, edge, 0.0, 0.0)

    def paint_scene(self, painter: QPainter, transform: ViewTransform) -> None:
        self.context.transform = transform
        if self._editing and self.context.snapping:
            inside = QRectF(self.rect()).adjusted(2, 2, -2, -2)
            paint_grid(painter, transform, self.context.step, inside, self.palette_)
        if self.underlay is not None:
            self.underlay.paint(painter, transform)
        if self.context.placed is not None:
            if self._editing and len(self.context.drawing.objects) > 1:
                self._paint_objects(painter, transform)
                paint_target_line(painter, transform.rings_to_pixels(self.context.placed.rings), self.palette_)
            else:
                self.paint_outline(painter, transform.rings_to_pixels(self.context.placed.rings))
            self._paint_reach(painter, transform, self.context.placed)
        if self._proposal is not None:
            paint_proposal(painter, transform.rings_to_pixels(self._proposal.rings), self.palette_)
        if self._editing:
            self._paint_preview(painter, transform, self._proposal or self.context.placed)
            paint_axes(painter, transform, self.context.mirror, QRectF(self.rect()), self.palette_)
        self.active.paint(painter, transform, self.palette_)

    def _paint_preview(self, painter: QPainter, transform: ViewTransform, placed: Placed | None) -> None:
        """Draw the preview of a design over the shape that it is fitted to."""
        if self._preview is None or placed is None:
            return
        nodes = transform.to_pixels(self._preview.nodes(self._preview.phi_target) * placed.scale + placed.centre)
        paint_design_preview(painter, self._preview.panels(nodes), self.palette_)
        paint_target_line(painter, transform.rings_to_pixels(placed.rings), self.palette_)

    def paint_outline(self, painter: QPainter, rings: tuple[FloatArray, ...]) -> None:
        """Draw the outline and its holes on the board: (L, 2) pixels each."""
        paint = paint_target_shape if self.underlay is None else paint_target_line
        paint(painter, rings, self.palette_)

    def _paint_objects(self, painter: QPainter, transform: ViewTransform) -> None:
        drawing = self.context.drawing
        for index, each in enumerate(drawing.objects):
            points = transform.rings_to_pixels(each.rings)
            selected, loose = index in drawing.selected, index in self.context.loose
            filled = self.underlay is None  # the picture below is what one draws after
            paint_object(painter, points, self.palette_, selected=selected, loose=loose, filled=filled)

    def select_at(self, pixel: QPointF) -> None:
        """Select the object there, as a right click does before its menu opens."""
        self.active.select_at(pixel)
        self.update()

    def _paint_reach(self, painter: QPainter, transform: ViewTransform, placed: Placed) -> None:
        if self.reach is None or self._proposal is not None:
            return
        undercuts = (self.reach.undercut,) if self.reach.turns_back else ()
        arms, notches = (
            [transform.to_pixels(ring * placed.scale + placed.centre) for ring in rings]
            for rings in (self.reach.arms, self.reach.notches + undercuts)
        )
        paint_reach(painter, arms, notches, self.palette_)

    def paint_notes(self, painter: QPainter) -> None:
        transform = self.transform()
        if self._editing and transform is not None and not self.rendering:
            self.rulers.paint(painter, transform, QRectF(self.rect()), self.palette_)
        if self.drops.here:
            ink(painter, self.palette_.accent, 2.0, dashed=True)
            painter.drawRoundedRect(self.rect().adjusted(6, 6, -6, -6), 8, 8)

    # the pointer and the keys --------------------------------------------------------------------------------------

    @property
    def _looking(self) -> bool:
        """Whether a drag moves the view."""
        return self._panning or self.tool is Tool.LOOK

    def event(self, event: QEvent) -> bool:
        """Keys of the board come before the window's commands: Qt asks first whose key it is (ShortcutOverride)."""
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent) and self._wants(event):
            event.accept()
            return True
        return super().event(event)

    def _wants(self, event: QKeyEvent) -> bool:
        return self._types(event) or self._zooms_or_pans(event)

    def _types(self, event: QKeyEvent) -> bool:
        """Whether a key is a letter for the text tool, not a command."""
        others = (
            Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.AltModifier | Qt.KeyboardModifier.MetaModifier
        )
        letter = event.text()
        return (
            self.tool is Tool.TEXT and not event.modifiers() & others and letter.isprintable() and bool(letter.strip())
        )

    def _zooms_or_pans(self, event: QKeyEvent) -> bool:
        plain = not event.modifiers() & ~(Qt.KeyboardModifier.ShiftModifier | Qt.KeyboardModifier.KeypadModifier)
        return self._editing and plain and (event.key() == Qt.Key.Key_Space or event.key() in self._zooms())

    def _zooms(self) -> dict[int, Callable[[], None]]:
        closer, away = partial(self.zoom, ZOOM_STEP), partial(self.zoom, 1.0 / ZOOM_STEP)
        return {
            Qt.Key.Key_Plus: closer,
            Qt.Key.Key_Equal: closer,
            Qt.Key.Key_Minus: away,
            Qt.Key.Key_0: self.fit,
        }

    def _pointer_event(self, event: QMouseEvent) -> PointerEvent:
        self.context.transform = self.transform() or self.context.transform
        return self.context.pointer(event.position(), event.modifiers())

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        if self._looking or event.button() is not Qt.MouseButton.LeftButton:
            super().mousePressEvent(event)
            return
        pointer = self._pointer_event(event)
        takes = self.tool is Tool.POSE and self.context.drawing.at(pointer.free) is None
        if not (self._editing and self.rulers.press(pointer.pixel, takes=takes)):
            self.active.press(pointer)
        self.update()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        if self._looking or event.buttons() & Qt.MouseButton.MiddleButton:
            super().mouseMoveEvent(event)
            return
        pointer = self._pointer_event(event)
        free = bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier)
        if not self.rulers.move(pointer.pixel, free=free):
            self.active.move(pointer, bool(event.buttons() & Qt.MouseButton.LeftButton))
        self.update()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        if self._looking or event.button() is not Qt.MouseButton.LeftButton:
            super().mouseReleaseEvent(event)
            self.setCursor(self.active.cursor)
            return
        pointer = self._pointer_event(event)
        if not self.rulers.release(pointer.pixel):
            self.active.release(pointer)
        self.update()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        if self._looking:
            super().mouseDoubleClickEvent(event)
            return
        self.active.double_click(self._pointer_event(event))
        self.update()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        if event.key() == Qt.Key.Key_Escape and self._editing:
            self._step_back()
        elif self._editing and event.key() == Qt.Key.Key_Space:
            if not event.isAutoRepeat():
                self._panning = True
                self.setCursor(Qt.CursorShape.OpenHandCursor)
        elif self._types(event):
            self.typed.emit(event.text())
        elif self._wants(event):
            self._zooms()[event.key()]()
        elif not self.active.key(event):
            super().keyPressEvent(event)
        self.update()

    def keyReleaseEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        if event.key() == Qt.Key.Key_Space and self._panning and not event.isAutoRepeat():
            self._stop_panning()
        else:
            super().keyReleaseEvent(event)

    def focusOutEvent(self, event: QFocusEvent) -> None:  # noqa: N802 - Qt's name
        self._stop_panning()
        super().focusOutEvent(event)

    def _stop_panning(self) -> None:
        self._panning = False
        self.setCursor(self.active.cursor)

    def _step_back(self) -> None:
        """Esc takes back the least there is: a gesture, then the selection, then the tool, then the board."""
        if self.active.busy:
            self.active.drop()
        elif self.active.deselect():
            return
        elif self.tool not in (Tool.POSE, Tool.LOOK):
            self.tool_left.emit()
        else:
            self.editing_left.emit()


def _tools(context: SketchContext) -> dict[Tool, SketchTool]:
    looking = SketchTool(context)
    looking.cursor = Qt.CursorShape.ArrowCursor
    return {
        Tool.LOOK: looking,
        Tool.POINTS: PointTool(context),
        Tool.POSE: PoseTool(context),
        Tool.FREEHAND: Freehand(context),
        Tool.POLYGON: Pen(context),
        Tool.RECTANGLE: figure_tool(context, Figure.RECTANGLE),
        Tool.ELLIPSE: figure_tool(context, Figure.ELLIPSE),
        Tool.REGULAR: figure_tool(context, Figure.REGULAR),
        Tool.STAR: figure_tool(context, Figure.STAR),
        Tool.TEXT: text_tool(context),
    }


def picture_image(levels: NDArray[np.uint8]) -> QImage:
    """Return a picture to draw, made of (H, W, 4) levels: red, green, blue, opacity."""
    height, width = levels.shape[:2]
    return QImage(levels.tobytes(), width, height, 4 * width, QImage.Format.Format_RGBA8888).copy()


@dataclass(frozen=True, slots=True, eq=False)
class Underlay:
    """A picture at its place on the board."""

    path: Path
    image: QImage  #: reduced for drawing
    corner: tuple[float, float]  #: (x, y), mm; its lower left corner
    pixel: float  #: mm; side of one source pixel
    size: tuple[int, int]  #: (width, height)

    @classmethod
    def under(cls, placed: Placed, path: Path, image: QImage, traced: Traced) -> Underlay:
        """Lay a picture under the target that was traced from it."""
        return cls(path, image, (0.0, 0.0), 1.0, traced.picture).laid_under(placed, traced)

    def laid_under(self, placed: Placed, traced: Traced) -> Underlay:
        """The same picture where its contour lies as the target does."""
        pixel = placed.scale / traced.scale
        x, y = (centre - pixel * own for centre, own in zip(placed.centre, traced.centre, strict=True))
        return replace(self, corner=(x, y), pixel=pixel)

    def place(self, traced: Traced) -> Placed:
        """Where another contour of the same picture lies on the board."""
        x, y = (corner + self.pixel * own for corner, own in zip(self.corner, traced.centre, strict=True))
        return Placed(traced.outline, self.pixel * traced.scale, (x, y))

    def paint(self, painter: QPainter, transform: ViewTransform) -> None:
        """Draw the picture, half transparent."""
        width, height = (self.pixel * count * transform.scale for count in self.size)
        left = transform.origin[0] + transform.scale * self.corner[0]
        bottom = transform.origin[1] - transform.scale * self.corner[1]
        painter.save()
        painter.setOpacity(OPACITY)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        painter.drawImage(QRectF(QPointF(left, bottom - height), QPointF(left + width, bottom)), self.image)
        painter.restore()
