"""The start beside the target: what sheets look like while they are flat, with its name and size, and where from."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial

import numpy as np
from PySide6.QtCore import QPoint, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QAction, QColor, QIcon, QKeyEvent, QPainter, QPaintEvent, QResizeEvent
from PySide6.QtWidgets import QAbstractButton, QMenu, QSizePolicy, QToolButton, QWidget

from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.widgets import icons
from kirigami_studio.gui.widgets.file_drops import FileDrops
from kirigami_studio.gui.widgets.fitted_text import fitted
from kirigami_studio.gui.widgets.layouts import TOUCH
from kirigami_studio.gui.widgets.paths import blank, ink, painter_on
from kirigami_studio.gui.widgets.target_items import paint_start_shape
from kirigami_studio.gui.widgets.theme import LIGHT, Palette
from kirigami_studio.gui.widgets.view_transform import Bounds, ViewTransform
from kirigami_studio.outlines.starts import AUTO, RECTANGLE, StartShape, start_shape
from kirigami_studio.studio.two_states import size_words, start_outline, start_words

#: Starts that are a click away: name, label, what it means.
STARTS = (
    (AUTO, mark("Auto"), mark("A rectangle, or what short fits of the target find better.")),
    (RECTANGLE.name, mark("Rectangle"), mark("As many square cells as the grid has: the paper's sheet.")),
    ("square", mark("Square"), mark("A square, whatever the grid.")),
    ("circle", mark("Circle"), mark("A disk. Its rim is a polygon with corners where cuts meet it.")),
    ("ellipse:3:2", mark("Ellipse 3:2"), mark("An ellipse, half as wide again as high.")),
    ("triangle", mark("Triangle"), mark("A triangle with equal sides.")),
    ("hexagon", mark("Hexagon"), mark("A hexagon with equal sides.")),
)
#: Starts of the list, made when they are first wanted.
listed_start = cache(start_shape)
LIBRARY_START, FILE_START, DRAWN_START, PAIRS = "library", "file", "draw", "pairs"
#: Entries below them: value, label, what it does.
OTHER_STARTS = (
    (LIBRARY_START, mark("Library …"), mark("Choose a library silhouette.")),
    (FILE_START, mark("File …"), mark("Open a file with a shape. PNG, JPG, BMP, SVG, DXF or JSON.")),
    (DRAWN_START, mark("Draw …"), mark("Draw a shape on a board of its own.")),
)
WIDTH = 108
#: Edge of the button that goes back to the rectangle, and of the pictures in the menu, pixels.
BACK_EDGE, MENU_EDGE = TOUCH, 22
#: Pixels around the picture, and that a line of text takes.
MARGIN, LINE = 9.0, 17.0
TIP = mark("Start as: the flat sheet. Click to change it, or drop a file here.")


class StartTile(QAbstractButton):
    """A small board with the start; a click opens the menu, Delete goes back to the rectangle."""

    chosen = Signal(StartShape)
    other_wanted = Signal(str)  #: one of OTHER_STARTS, or PAIRS

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("startTile")
        self._start = RECTANGLE
        self._grid = (10, 10)
        self._width_mm = 100.0
        self._flat: tuple[float, float] | None = None
        self._palette: Palette = LIGHT
        self.setFixedWidth(WIDTH)
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Expanding)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setCursor(Qt.CursorShape.PointingHandCursor)
        self.drops = FileDrops(self)
        self.back = QToolButton(self)
        self.back.setObjectName("plainStart")
        self.back.setFixedSize(BACK_EDGE, BACK_EDGE)
        self.back.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.back.setToolTip(tr("Back to the rectangle (Delete)"))
        self.back.setAccessibleName(tr("Start as a rectangle"))
        self.back.clicked.connect(lambda: self.chosen.emit(RECTANGLE))
        self.menu = QMenu(self)
        self.menu.setToolTipsVisible(True)
        self._fill_menu()
        self.clicked.connect(self.open_menu)
        self.show_start(RECTANGLE, self._grid, self._width_mm)

    def _fill_menu(self) -> None:
        self.entries: dict[str, QAction] = {}
        for name, label, about in STARTS:
            self._add(label, about, name, partial(self._choose_listed, name))
        self.menu.addSeparator()
        for name, label, about in OTHER_STARTS:
            self._add(label, about, name, partial(self.other_wanted.emit, name))
        self.menu.addSeparator()
        label, about = mark("Examples of pairs …"), mark("Twelve finished designs from one shape to another.")
        self._add(label, about, PAIRS, partial(self.other_wanted.emit, PAIRS))

    def _add(self, label: str, about: str, name: str, act: Callable[[], None]) -> None:
        action = self.entries[name] = self.menu.addAction(tr(label))
        action.setToolTip(tr(about))
        action.triggered.connect(lambda _=False: act())

    def _choose_listed(self, name: str) -> None:
        self.chosen.emit(listed_start(name))

    def show_start(
        self, start: StartShape, grid: tuple[int, int], width_mm: float, flat: tuple[float, float] | None = None
    ) -> None:
        """Show a start on a sheet of a width, mm.

        ``flat`` (width and height, mm) is the size of a design that starts so, if there is one; without it ``grid``
        (rows, columns) gives a plain rectangle its height.
        """
        self._start, self._grid, self._width_mm, self._flat = start, grid, width_mm, flat
        self.back.setVisible(not start.is_plain)
        size = "{name}, {size}" if flat is None else tr("{name}, {size} (design on the stage)")
        self.setToolTip(f"{tr(TIP)}\n{size.format(name=self.name, size=self.size_text)}")
        self.setAccessibleName(tr("Start as {name}, {size}", name=self.name, size=self.size_text))
        self.update()

    @property
    def name(self) -> str:
        """What sheets start as, in words."""
        return start_words(self._start.name)

    @property
    def size_text(self) -> str:
        """Size of the flat sheet."""
        return self._size(self._width_mm, self._height_mm)

    @property
    def brief_size(self) -> str:
        """The same in whole millimetres."""
        return self._size(round(self._width_mm), round(self._height_mm))

    def _size(self, width_mm: float, height_mm: float) -> str:
        return size_words(width_mm, height_mm)

    @property
    def _height_mm(self) -> float:
        if self._flat is not None:
            return self._flat[1]
        across, up = np.ptp(start_outline(self._start, self._grid), axis=0).tolist()
        return float(self._width_mm * up / across)

    def open_menu(self) -> None:
        """Open the list of starts below the tile."""
        if self.entries[RECTANGLE.name].icon().isNull():
            self._draw_icons()
        self.menu.popup(self.mapToGlobal(QPoint(0, min(self.height(), 150))))

    def set_palette(self, palette: Palette) -> None:
        self._palette = palette
        self.back.setIcon(icons.icon("close", palette))
        self.back.setIconSize(QSize(BACK_EDGE - 20, BACK_EDGE - 20))
        for name, _, _ in STARTS:
            self.entries[name].setIcon(QIcon())  # drawn again when the menu opens
        self.update()

    def _draw_icons(self) -> None:
        ratio = self.devicePixelRatioF()
        for name, _, _ in STARTS:
            picture = blank(QSize(MENU_EDGE, MENU_EDGE), ratio)
            painter = painter_on(picture)
            self._paint_shape(painter, QRectF(0, 0, MENU_EDGE, MENU_EDGE), listed_start(name), 2.0)
            painter.end()
            self.entries[name].setIcon(QIcon(picture))

    def _paint_shape(
        self, painter: QPainter, box: QRectF, start: StartShape, margin: float, flat: tuple[float, float] | None = None
    ) -> None:
        points = start_outline(start, self._grid)
        if flat is not None:  # of the grid that the design has, and moved at its rim
            points = points * (np.array(flat) / np.ptp(points, axis=0))
        transform = ViewTransform.fitting(Bounds.of(points), box, margin)
        paint_start_shape(painter, transform.to_pixels(points), self._palette, 1.4)

    # events --------------------------------------------------------------------------------------------------------

    def sizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return QSize(WIDTH, 130)

    def minimumSizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return QSize(WIDTH, 56)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        super().resizeEvent(event)
        self.back.move(self.width() - BACK_EDGE - 3, 3)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        if event.key() in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace) and not self._start.is_plain:
            self.chosen.emit(RECTANGLE)
        elif event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter, Qt.Key.Key_Down):
            self.open_menu()
        else:
            super().keyPressEvent(event)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        painter = painter_on(self)
        palette, lit = self._palette, self.hasFocus() or self.underMouse() or self.drops.here
        colour, width = palette.accent if lit else palette.border, 2.0 if self.drops.here else 1.0
        ink(painter, colour, width, fill=palette.canvas)
        painter.drawRoundedRect(QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5), 7, 7)
        lines = 2 if self.height() >= 4 * LINE + 34 else 1 if self.height() >= 3 * LINE + 30 else 0
        caption = LINE + 4.0 if lines else 2.0
        box = QRectF(self.rect()).adjusted(0, caption, 0, -lines * LINE - (4.0 if lines else 0.0))
        self._paint_shape(painter, box, self._start, MARGIN, self._flat)
        painter.setPen(QColor(palette.muted))
        left = int(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
        if lines:
            room = self.width() - 9 - (9 if self.back.isHidden() else BACK_EDGE)
            painter.drawText(QRectF(9, 4, room, LINE), left, tr("Start as"))
        centred = int(Qt.AlignmentFlag.AlignCenter)
        texts, metrics = (self.name, self.size_text)[:lines], painter.fontMetrics()
        for number, text in enumerate(texts):
            place = QRectF(2, self.height() - (lines - number) * LINE - 4.0, self.width() - 4, LINE)
            painter.setPen(QColor(palette.text if number == 0 else palette.muted))
            versions = (text, self.brief_size) if number else (text,)
            painter.drawText(place, centred, fitted(metrics, versions, place.width()))
        painter.end()
