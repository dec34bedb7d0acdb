"""Cards of designs in a list: the gallery and the table of all designs have pictures, buttons and mouse in common."""

from __future__ import annotations

import math
import time
from abc import abstractmethod
from collections.abc import Callable, Collection, Mapping
from enum import Enum
from typing import TYPE_CHECKING

from PySide6.QtCore import QEvent, QModelIndex, QPersistentModelIndex, QPoint, QRect, QRectF, QSize, Qt, QTimer, Signal
from PySide6.QtGui import (
    QColor,
    QContextMenuEvent,
    QHelpEvent,
    QHideEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPixmap,
    QRegion,
    QResizeEvent,
)
from PySide6.QtWidgets import (
    QAbstractItemView,
    QListView,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QToolTip,
    QWidget,
)

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.gallery.gallery_model import (
    ALIKE_ROLE,
    CANDIDATE_ROLE,
    DESIGN_ROLE,
    MARK_ROLE,
    OPEN_ROLE,
    THIN_ROLE,
    GalleryModel,
    alike_tip,
)
from kirigami_studio.gui.stage.piece_reader import PieceReader
from kirigami_studio.gui.widgets import icons
from kirigami_studio.gui.widgets.layouts import TOUCH
from kirigami_studio.gui.widgets.paths import ink
from kirigami_studio.gui.widgets.theme import LIGHT, Palette
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Mark

if TYPE_CHECKING:
    from kirigami_studio.assembly.posed_pieces import PosedPieces

#: Pixels between two cards.
GAP = 8
#: Pixels always reserved for the scroll bar, so that cards do not jump when it appears.
SCROLL_BAR = 14
#: Edge of the buttons under the mouse, pixels.
BUTTON = TOUCH
#: Edge of the dot on new designs, pixels.
DOT = 7
#: Opacity of a rejected design's picture.
DIMMED = 0.3
#: Seconds for new pictures in one paint event; a large window shows dozens of cards, a large design takes 7 ms.
PAINT_SECONDS = 0.015
#: Pictures that are kept; one of 400 x 130 pixels takes 0.2 MB.
CAPACITY = 400
Index = QModelIndex | QPersistentModelIndex


class CardButton(Enum):
    """What can be done to a design on its card; the value is the icon."""

    PIN = "pin"
    REJECT = "reject"


class Cards(QStyledItemDelegate):
    """Paints one design on a card; pictures that are missing are drawn a few in each paint event."""

    def __init__(self, view: QWidget, width: int) -> None:
        super().__init__(view)
        self._view = view
        self.palette_: Palette = LIGHT
        self.target: Outline | None = None
        self.pieces_of: Callable[[Candidate], PosedPieces | None] = lambda _: None  #: None while panels are drawn
        self.card = self.size_for(width)
        self.under_mouse: Candidate | None = None  #: the design under the mouse
        self.hovered_button: CardButton | None = None  #: the button there
        self._pictures: dict[tuple[PosedDesign, int, float, str, bool, PosedPieces | None], QPixmap] = {}
        self._paint_until = math.inf
        self.waiting: list[QRect] = []  #: cells of the view that still lack their pictures

    # for subclasses to say -------------------------------------------------------------------------------------------

    @abstractmethod
    def size_for(self, width: int) -> QSize:
        """Size of a card of a width, pixels."""

    @abstractmethod
    def picture_of(self, card: QRect) -> QRect:
        """The part of a card that shows the design."""

    @abstractmethod
    def draw(self, design: PosedDesign, thin: bool, size: QSize, ratio: float, pieces: PosedPieces | None) -> QPixmap:
        """Draw the picture; ``thin`` panels break in the material, ``pieces`` take their place."""

    @abstractmethod
    def write(self, painter: QPainter, card: QRect, index: Index) -> None:
        """Write on a card what is known of its design."""

    @abstractmethod
    def alike_box(self, cell: QRect, index: Index) -> QRect:
        """Place of the mark of look-alikes in a cell of the list."""

    @abstractmethod
    def buttons_at(self, picture: QRect) -> tuple[QPoint, QPoint]:
        """Upper left corners of the buttons on a picture: to pin and to reject."""

    # pictures --------------------------------------------------------------------------------------------------------

    @property
    def pending(self) -> bool:
        """Whether cards in sight still lack their pictures."""
        return bool(self.waiting)

    def begin(self, region: QRegion) -> None:
        """A paint event for a part of the view starts: some pictures are drawn in it, the rest in the next one."""
        self._paint_until = math.inf
        self.waiting = [cell for cell in self.waiting if not region.intersects(cell)]

    def forget_pictures(self, keep: Collection[PosedDesign] = ()) -> None:
        """Drop all pictures but those of the designs in ``keep``; they are painted again when needed."""
        staying = set(keep)
        self._pictures = {key: picture for key, picture in self._pictures.items() if key[0] in staying}

    def _picture(self, index: Index, size: QSize, ratio: float) -> QPixmap | None:
        """The design's picture, None where it has to wait for the next paint event."""
        design, thin = index.data(DESIGN_ROLE), bool(index.data(THIN_ROLE))
        pieces = self.pieces_of(index.data(CANDIDATE_ROLE))
        key = (design, size.width(), ratio, self.palette_.name, thin, pieces)
        found = self._pictures.pop(key, None)
        if found is None:
            now = time.perf_counter()
            if now > self._paint_until:
                return None
            self._paint_until = min(self._paint_until, now + PAINT_SECONDS)
            found = self.draw(design, thin, size, ratio, None if pieces is None else pieces.small)
        self._pictures[key] = found  # the last used is the last
        while len(self._pictures) > CAPACITY:
            del self._pictures[next(iter(self._pictures))]
        return found

    # painting --------------------------------------------------------------------------------------------------------

    def sizeHint(self, option: QStyleOptionViewItem, index: Index) -> QSize:  # noqa: N802 - Qt's name
        return self.card + QSize(GAP, GAP)

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        mark: Mark = index.data(MARK_ROLE)
        cell: QRect = option.rect
        card, ratio = card_of(cell), painter.device().devicePixelRatio()
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if index.data(ALIKE_ROLE) and not index.data(OPEN_ROLE):  # the edge of another card under this one
            ink(painter, self.palette_.strong_border, fill=self.palette_.raised)
            painter.drawRoundedRect(QRectF(card).adjusted(4, 4, 2.5, 2.5), 8, 8)
        paint_back(painter, card, option.state, self.palette_)
        picture = self.picture_of(card)
        painter.setOpacity(DIMMED if mark is Mark.REJECTED else 1.0)
        drawn = self._picture(index, picture.size(), ratio)
        if drawn is None:
            self.waiting.append(QRect(cell))
        else:
            painter.drawPixmap(picture.topLeft(), drawn)
        painter.setOpacity(1.0)
        self.write(painter, card, index)
        if index.data(ALIKE_ROLE):
            self._paint_alike(painter, self.alike_box(cell, index), index)
        if index.data(CANDIDATE_ROLE) is self.under_mouse:
            paint_buttons(painter, self.button_boxes(cell), mark, self.hovered_button, self.palette_)
        painter.restore()

    def _paint_alike(self, painter: QPainter, box: QRect, index: Index) -> None:
        """How many more designs look the same, as a button."""
        metrics, text = painter.fontMetrics(), alike_text(index)
        if metrics.horizontalAdvance(text) + 12 > box.width():
            text = tr("hide") if index.data(OPEN_ROLE) else f"+{index.data(ALIKE_ROLE)}"
        width = min(metrics.horizontalAdvance(text) + 12, box.width())
        chip = QRectF(box.right() - width + 1, box.top() + 0.5, width, box.height() - 1)
        ink(painter, self.palette_.strong_border, fill=self.palette_.raised)
        painter.drawRoundedRect(chip, 5, 5)
        painter.setPen(QColor(self.palette_.text))
        shown = metrics.elidedText(text, Qt.TextElideMode.ElideRight, width - 6)
        painter.drawText(chip, int(Qt.AlignmentFlag.AlignCenter), shown)

    # buttons and tooltips --------------------------------------------------------------------------------------------

    def button_boxes(self, cell: QRect) -> dict[CardButton, QRect]:
        """Places of the buttons in a cell of the list."""
        pin, reject = self.buttons_at(self.picture_of(card_of(cell)))
        size = QSize(BUTTON, BUTTON)
        return {CardButton.PIN: QRect(pin, size), CardButton.REJECT: QRect(reject, size)}

    def button_at(self, cell: QRect, place: QPoint) -> CardButton | None:
        """The button at a place of the view."""
        return next((button for button, box in self.button_boxes(cell).items() if box.contains(place)), None)

    def tip_at(self, cell: QRect, place: QPoint, index: Index) -> str:
        """Tooltip of the button or mark at a place of the view, "" elsewhere."""
        button = self.button_at(cell, place)
        if button is not None:
            return button_tip(button, index.data(MARK_ROLE))
        on_alike = index.data(ALIKE_ROLE) and self.alike_box(cell, index).contains(place)
        return alike_tip(index.data(ALIKE_ROLE), index.data(OPEN_ROLE)) if on_alike else ""

    def helpEvent(  # noqa: N802 - Qt's name
        self, event: QHelpEvent, view: QAbstractItemView, option: QStyleOptionViewItem, index: Index
    ) -> bool:
        """Over a button or a mark its own tooltip, elsewhere the design's numbers."""
        tip = self.tip_at(view.visualRect(index), event.pos(), index) if index.isValid() else ""
        if not tip:
            return super().helpEvent(event, view, option, index)
        QToolTip.showText(event.globalPos(), tip, view)
        return True


class CardList(QListView):
    """Cards in a grid that fills the width and never scrolls sideways; the mouse presses their buttons."""

    pin_wanted = Signal(Candidate)  #: pin it, or unpin it
    reject_wanted = Signal(Candidate)  #: reject it, or take it back
    menu_wanted = Signal(Candidate, QPoint)  #: place on the screen
    alike_toggled = Signal(Candidate)
    clear_wanted = Signal()  #: the filter leaves nothing; show everything

    def __init__(self, parent: QWidget | None) -> None:
        super().__init__(parent)
        self.pieces: PieceReader | None = None  #: of designs that are made of pieces
        # A timer of its own: what QTimer.singleShot(0) posts is handled before the loop looks for clicks and keys.
        self._later = QTimer(self, singleShot=True, interval=0)
        self._later.timeout.connect(self._draw_waiting)

    def lay_out(self, model: GalleryModel, cards: Cards, least_width: int, name: str) -> None:
        """Show a model on cards at least so wide (pixels), for screen readers under a ``name``."""
        self._cards, self._model, self._least_width = cards, model, least_width
        self.setModel(model)
        self.setItemDelegate(cards)
        self.setViewMode(QListView.ViewMode.IconMode)
        self.setResizeMode(QListView.ResizeMode.Adjust)
        self.setMovement(QListView.Movement.Static)
        self.setUniformItemSizes(True)
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setMouseTracking(True)
        self.setObjectName("gallery")
        self.setAccessibleName(name)

    @abstractmethod
    def empty_text(self) -> str:
        """What is said where there are no cards."""

    @abstractmethod
    def compare(self, candidate: Candidate) -> None:
        """Compare a design: its card was clicked with Ctrl."""

    def show_pieces(self, reader: PieceReader) -> None:
        """Draw the pieces of designs that are made of them, as soon as they are there."""
        self.pieces, self._cards.pieces_of = reader, reader.of
        reader.changed.connect(self.viewport().update)

    def set_palette(self, palette: Palette) -> None:
        self._cards.palette_ = palette
        self.viewport().update()

    def share_width(self) -> None:
        """Share the width among as many cards as fit into a row."""
        width = self.width() - SCROLL_BAR
        columns = max(1, width // (self._least_width + GAP))
        wanted = self._cards.size_for(width // columns - GAP)
        if wanted != self._cards.card:
            self._cards.card = wanted
            self._cards.forget_pictures()
            self.scheduleDelayedItemsLayout()

    def at(self, place: QPoint) -> tuple[QModelIndex, Candidate | None, CardButton | None]:
        """What is at a place of the view: row, design, button."""
        index = self.indexAt(place)
        if not index.isValid():
            return index, None, None
        return index, index.data(CANDIDATE_ROLE), self._cards.button_at(self.visualRect(index), place)

    # events ----------------------------------------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        place = event.position().toPoint()
        index, candidate, button = self.at(place)
        if event.button() != Qt.MouseButton.LeftButton:
            event.accept()  # the menu comes with its own event and leaves the choice alone
        elif candidate is None:
            if self._model.rowCount() == 0 and self._model.all_entries:
                self.clear_wanted.emit()
        elif button is not None:
            (self.pin_wanted if button is CardButton.PIN else self.reject_wanted).emit(candidate)
        elif index.data(ALIKE_ROLE) and self._cards.alike_box(self.visualRect(index), index).contains(place):
            self.alike_toggled.emit(candidate)
        elif event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            self.compare(candidate)
        else:
            super().mousePressEvent(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        _, candidate, button = self.at(event.position().toPoint())
        self._hover(candidate, button)
        if event.buttons() == Qt.MouseButton.NoButton:  # a drag over the cards chooses nothing
            super().mouseMoveEvent(event)

    def leaveEvent(self, event: QEvent) -> None:  # noqa: N802 - Qt's name
        self._hover(None, None)
        super().leaveEvent(event)

    def _hover(self, candidate: Candidate | None, button: CardButton | None) -> None:
        """Show the buttons of the card under the mouse, and which of them is meant."""
        if (candidate, button) != (self._cards.under_mouse, self._cards.hovered_button):
            self._cards.under_mouse, self._cards.hovered_button = candidate, button
            self.viewport().update()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:  # noqa: N802 - Qt's name
        _, candidate, _ = self.at(event.pos())
        place = event.globalPos()
        if candidate is None and event.reason() == QContextMenuEvent.Reason.Keyboard and self.currentIndex().isValid():
            candidate = self.currentIndex().data(CANDIDATE_ROLE)
            place = self.viewport().mapToGlobal(self.visualRect(self.currentIndex()).center())
        if candidate is not None:
            self.menu_wanted.emit(candidate, place)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        self.share_width()
        super().resizeEvent(event)

    def hideEvent(self, event: QHideEvent) -> None:  # noqa: N802 - Qt's name
        """Cards that were to be drawn in the next turn are drawn when the list is seen again."""
        self._later.stop()
        super().hideEvent(event)

    def scrollContentsBy(self, dx: int, dy: int) -> None:  # noqa: N802 - Qt's name
        super().scrollContentsBy(dx, dy)
        if self._cards.pending:  # their cells are elsewhere now
            self._cards.waiting.clear()
            self.viewport().update()

    def _draw_waiting(self) -> None:
        """Paint the cards that lack their pictures, and no others: a large screen shows dozens that are done."""
        region = QRegion()
        for cell in self._cards.waiting:
            region += cell
        self.viewport().update(region)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        self._cards.begin(event.region())
        super().paintEvent(event)
        if self._cards.pending:
            self._later.start()
        if self._model.rowCount() > 0:
            return
        painter = QPainter(self.viewport())
        painter.setPen(QColor(self._cards.palette_.muted))
        flags = int(Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap)
        painter.drawText(self.viewport().rect().adjusted(20, 0, -20, 0), flags, self.empty_text())
        painter.end()


def card_of(rect: QRect) -> QRect:
    """The card inside the cell that the list gives it."""
    return rect.adjusted(GAP // 2, GAP // 2, -GAP // 2, -GAP // 2)


def paint_back(painter: QPainter, card: QRect, state: QStyle.StateFlag, palette: Palette) -> None:
    """The card's ground and edge: plain, under the mouse, or selected."""
    selected = bool(state & QStyle.StateFlag.State_Selected)
    over = bool(state & QStyle.StateFlag.State_MouseOver)
    colour = palette.accent_soft if selected else palette.raised if over else palette.surface
    edge = palette.accent if selected else palette.strong_border if over else palette.border
    ink(painter, edge, 2.0 if selected else 1.0, fill=colour)
    painter.drawRoundedRect(QRectF(card).adjusted(1, 1, -1, -1), 8, 8)


def paint_buttons(
    painter: QPainter, boxes: Mapping[CardButton, QRect], mark: Mark, hovered: CardButton | None, palette: Palette
) -> None:
    """The buttons of the card under the mouse; lit are the one under it, and the one that the design is marked by."""
    ratio = painter.device().devicePixelRatio()
    for button, box in boxes.items():
        lit = button is hovered or mark is (Mark.PINNED if button is CardButton.PIN else Mark.REJECTED)
        ink(
            painter,
            palette.accent if lit else palette.strong_border,
            fill=palette.accent_soft if lit else palette.surface,
        )
        painter.drawRoundedRect(QRectF(box).adjusted(0.5, 0.5, -0.5, -0.5), 6, 6)
        icon = icons.pixmap(button.value, palette.text, BUTTON - 8, ratio)
        painter.drawPixmap(box.topLeft() + QPoint(4, 4), icon)


def button_tip(button: CardButton, mark: Mark) -> str:
    """What a button of a card does."""
    if button is CardButton.PIN:
        return tr("Unpin this design") if mark is Mark.PINNED else tr("Pin: keep this design when you generate again")
    return tr("Restore this design") if mark is Mark.REJECTED else tr("Reject: hide this design")


def alike_text(index: Index) -> str:
    """What the button for look-alikes says."""
    return tr("hide alike") if index.data(OPEN_ROLE) else tr("+{count} alike", count=index.data(ALIKE_ROLE))
