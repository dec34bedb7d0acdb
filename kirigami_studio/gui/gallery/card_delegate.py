"""One card of the gallery: picture, name, numbers, mark, and its buttons under the mouse."""

from __future__ import annotations

import math
import time
from collections.abc import Collection, Mapping
from enum import Enum
from typing import TYPE_CHECKING

from PySide6.QtCore import (
    QAbstractItemModel,
    QModelIndex,
    QPersistentModelIndex,
    QPoint,
    QPointF,
    QRect,
    QRectF,
    QSize,
    Qt,
)
from PySide6.QtGui import QColor, QFont, QHelpEvent, QPainter, QPen, QPixmap
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
from kirigami_studio.foundation.words import number, tr
from kirigami_studio.gui.gallery.badges import closing_text
from kirigami_studio.gui.gallery.gallery_model import (
    ALIKE_ROLE,
    CANDIDATE_ROLE,
    DESIGN_ROLE,
    FRESH_ROLE,
    GRID_ROLE,
    MARK_ROLE,
    NAME_ROLE,
    NOTE_ROLE,
    OPEN_ROLE,
    RISE_ROLE,
    START_ROLE,
    VALUE_ROLE,
    VERDICT_ROLE,
    alike_tip,
)
from kirigami_studio.gui.stage.layout_items import TARGET_SHARE, candidate_pixmap
from kirigami_studio.gui.widgets import icons
from kirigami_studio.gui.widgets.theme import LIGHT, Palette
from kirigami_studio.gui.widgets.verdict_marks import ABOUT, ICONS, PALE, colour_of, level_of
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Mark

if TYPE_CHECKING:
    from kirigami_studio.studio.verdict import Verdict

SMALLEST_CARD = 132
#: Pixels above the picture, for the name and the marks, and below it, for two lines of text.
HEAD_HEIGHT, TEXT_HEIGHT = 24, 48
GAP = 8
#: Pixels always reserved for the scroll bar, so that cards do not jump when it appears.
SCROLL_BAR = 14
#: What polishing must have added to sIoU at least for a card to say so.
SMALLEST_RISE = 5e-4
#: Edge of the buttons under the mouse, pixels.
BUTTON = 24
#: Edge of the dot on new designs, pixels.
DOT = 7
#: Pixels that the match takes at the left of the first line of text.
MATCH_WIDTH = 66
#: Share of a card's head that a long name may take.
NAME_SHARE = 0.45
#: Opacity of a rejected design's picture.
DIMMED = 0.3
#: Seconds for new pictures in one paint event; a large window shows dozens of cards, a large design takes 7 ms.
PAINT_SECONDS = 0.015
#: Icons of symmetric designs.
SIGNS = {
    Symmetry.LEFT_RIGHT: "mirror",
    Symmetry.TOP_BOTTOM: "mirror",
    Symmetry.TWO_MIRRORS: "axis-both",
    Symmetry.HALF_TURN: "turn",
    Symmetry.QUARTER_TURN: "turn",
}
Index = QModelIndex | QPersistentModelIndex


class CardButton(Enum):
    """What can be done to a design on its card; the value is the icon."""

    PIN = "pin"
    REJECT = "reject"


class CardDelegate(QStyledItemDelegate):
    """Paints one candidate: pictures, name, match, sort value, verdict and mark."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.palette_: Palette = LIGHT
        self.target: Outline | None = None
        self.card = card_size(SMALLEST_CARD)
        self.under_mouse: Candidate | None = None  #: the design under the mouse
        self.hovered_button: CardButton | None = None  #: the button there
        self.compared: Candidate | None = None  #: the design that is compared with the chosen one
        self._pictures: dict[tuple[PosedDesign, int, float, str], QPixmap] = {}
        self._paint_until = math.inf
        self.pending = False  #: whether cards still lack their pictures since :meth:`begin`

    def begin(self) -> None:
        """A paint event starts: some pictures are drawn in it, the rest in the next one."""
        self._paint_until = math.inf
        self.pending = False

    def forget_pictures(self, keep: Collection[PosedDesign] = ()) -> None:
        """Drop all thumbnails but those of the designs in ``keep``; they are painted again when needed."""
        staying = set(keep)
        self._pictures = {key: picture for key, picture in self._pictures.items() if key[0] in staying}

    def helpEvent(  # noqa: N802 - Qt's name
        self, event: QHelpEvent, view: QAbstractItemView, option: QStyleOptionViewItem, index: Index
    ) -> bool:
        """Over a button its own tooltip, elsewhere the design's numbers."""
        button = button_at(view.visualRect(index), event.pos()) if index.isValid() else None
        if index.isValid() and index.data(ALIKE_ROLE) and alike_box(view.visualRect(index)).contains(event.pos()):
            QToolTip.showText(event.globalPos(), alike_tip(index.data(ALIKE_ROLE), index.data(OPEN_ROLE)), view)
            return True
        if button is None:
            return super().helpEvent(event, view, option, index)
        mark: Mark = index.data(MARK_ROLE)
        QToolTip.showText(event.globalPos(), button_tip(button, mark), view)
        return True

    def sizeHint(self, option: QStyleOptionViewItem, index: Index) -> QSize:  # noqa: N802 - Qt's name
        return self.card + QSize(GAP, GAP)

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        candidate: Candidate = index.data(CANDIDATE_ROLE)
        design: PosedDesign = index.data(DESIGN_ROLE)
        mark: Mark = index.data(MARK_ROLE)
        verdict: Verdict = index.data(VERDICT_ROLE)
        rect: QRect = option.rect
        state: QStyle.StateFlag = option.state
        card = card_of(rect)
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        alike: int = index.data(ALIKE_ROLE)
        if alike and not index.data(OPEN_ROLE):
            self._paint_stack(painter, card)
        paint_back(painter, card, state, self.palette_)
        picture = picture_of(card)
        painter.setOpacity(DIMMED if mark is Mark.REJECTED else 1.0)
        drawn = self._picture(design, picture.size(), painter.device().devicePixelRatio())
        if drawn is not None:
            painter.drawPixmap(picture.topLeft(), drawn)
        painter.setOpacity(1.0)
        left = self._paint_name(painter, card, index, mark)
        left = self._paint_symmetry(painter, card, left, candidate.symmetry)
        rise: float = index.data(RISE_ROLE)
        if candidate == self.compared:
            self._paint_chip(painter, card, "", "compare")
        elif candidate.trim is not None:
            self._paint_chip(painter, card, f"{number(100 * candidate.trim.iou, '.1f')} %", "trim")
        elif rise >= SMALLEST_RISE:
            self._paint_chip(painter, card, number(100 * rise, "+.1f"))
        else:
            self._paint_closing(painter, card, left, verdict)
        told_apart: str = index.data(START_ROLE) or index.data(GRID_ROLE)
        self._paint_numbers(painter, card, candidate, index.data(VALUE_ROLE), told_apart)
        self._paint_level(painter, card, verdict)
        if alike:
            self._paint_alike(painter, alike_box(rect), alike, index.data(OPEN_ROLE))
        if candidate is self.under_mouse:
            paint_buttons(painter, button_boxes(rect), mark, self.hovered_button, self.palette_)
        painter.restore()

    def _paint_stack(self, painter: QPainter, card: QRect) -> None:
        """The edge of another card under this one."""
        painter.setBrush(QColor(self.palette_.raised))
        painter.setPen(QPen(QColor(self.palette_.strong_border), 1.0))
        painter.drawRoundedRect(QRectF(card).adjusted(4, 4, 2.5, 2.5), 8, 8)

    def _paint_closing(self, painter: QPainter, card: QRect, left: int, verdict: Verdict) -> None:
        """In the upper right corner, whether the sheet closes as cut, as long as there is room."""
        from kirigami_studio.studio.verdict import Question

        texts, found = [closing_text(verdict)], verdict.as_cut
        if found is not None and not found.closes:
            about = ABOUT if found.source.value == "estimate" else ""
            texts.append(about + tr("{jam}°!", jam=round(found.jam_deg)))
        state = verdict.answer(Question.CLOSES).state.value
        place, metrics = card.adjusted(left - card.left() + 6, 6, -10, 0), painter.fontMetrics()
        text = next((text for text in texts if metrics.horizontalAdvance(text) <= place.width()), "")
        painter.setPen(QColor(self.palette_.muted if state == "good" else colour_of(state, self.palette_)))
        painter.drawText(place, int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignTop), text)

    def _paint_symmetry(self, painter: QPainter, card: QRect, left: int, symmetry: Symmetry | None) -> int:
        """The sign of a symmetric design, right of its name and marks; returns where there is room left."""
        if symmetry is None:
            return left
        edge = painter.fontMetrics().height()
        icon = icons.pixmap(SIGNS[symmetry], self.palette_.accent, edge, painter.device().devicePixelRatio())
        painter.drawPixmap(left, card.top() + 6, icon)
        return left + edge

    def _paint_alike(self, painter: QPainter, box: QRect, count: int, opened: bool) -> None:
        """How many more designs look the same, as a button."""
        metrics = painter.fontMetrics()
        text = tr("hide alike") if opened else tr("+{count} alike", count=count)
        if metrics.horizontalAdvance(text) + 12 > box.width():
            text = tr("hide") if opened else f"+{count}"
        width = min(metrics.horizontalAdvance(text) + 12, box.width())
        chip = QRectF(box.right() - width + 1, box.top() + 0.5, width, box.height() - 1)
        painter.setPen(QPen(QColor(self.palette_.strong_border), 1.0))
        painter.setBrush(QColor(self.palette_.raised))
        painter.drawRoundedRect(chip, 5, 5)
        painter.setPen(QColor(self.palette_.text))
        painter.drawText(
            chip, int(Qt.AlignmentFlag.AlignCenter), metrics.elidedText(text, Qt.TextElideMode.ElideRight, width - 6)
        )

    def _picture(self, design: PosedDesign, size: QSize, ratio: float) -> QPixmap | None:
        """The design's picture, None where it has to wait for the next paint event."""
        key = (design, size.width(), ratio, self.palette_.name)
        if key not in self._pictures:
            now = time.perf_counter()
            if now > self._paint_until:
                self.pending = True
                return None
            self._paint_until = min(self._paint_until, now + PAINT_SECONDS)
            self._pictures[key] = candidate_pixmap(design, self.target, size, ratio, self.palette_)
        return self._pictures[key]

    def _paint_name(self, painter: QPainter, card: QRect, index: Index, mark: Mark) -> int:
        """The design's name, a sheet where it has a note, a dot where it is new, a pin or a sign where it is rejected.

        Returns where there is room left, pixels from the left.
        """
        painter.setPen(QColor(self.palette_.muted))
        place, metrics, fresh = card.adjusted(10, 6, -10, 0), painter.fontMetrics(), index.data(FRESH_ROLE)
        room = round(NAME_SHARE * place.width())
        text = metrics.elidedText(index.data(NAME_ROLE), Qt.TextElideMode.ElideRight, room)
        painter.drawText(place, int(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignTop), text)
        left = place.left() + metrics.horizontalAdvance(text) + 5
        if index.data(NOTE_ROLE):
            edge = metrics.height() - 3
            icon = icons.pixmap("note", self.palette_.muted, edge, painter.device().devicePixelRatio())
            painter.drawPixmap(left, place.top() + 1, icon)
            left += edge + 5
        if fresh:
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(QColor(self.palette_.accent))
            painter.drawEllipse(QRectF(left, place.top() + 0.5 * metrics.height() - 0.5 * DOT, DOT, DOT))
            left += DOT + 5
        if mark is Mark.NONE:
            return left
        name, colour = ("pinned", self.palette_.accent) if mark is Mark.PINNED else ("reject", self.palette_.muted)
        box = QRectF(left, place.top() - 2, metrics.height() + 4, metrics.height() + 4)
        painter.setPen(QPen(QColor(colour), 1.0))
        painter.setBrush(QColor(self.palette_.surface))
        painter.drawRoundedRect(box, 5, 5)
        icon = icons.pixmap(name, colour, metrics.height() - 2, painter.device().devicePixelRatio())
        painter.drawPixmap(box.topLeft() + QPointF(3, 3), icon)
        return round(box.right()) + 5

    def _paint_chip(self, painter: QPainter, card: QRect, text: str, icon: str = "") -> None:
        """A small mark in the upper right corner."""
        metrics = painter.fontMetrics()
        edge = metrics.ascent() + 2 if icon else 0
        width = metrics.horizontalAdvance(text) + 10 + (edge + (3 if text else 0) if icon else 0)
        chip = QRectF(card.right() - 7 - width, card.top() + 5, width, metrics.height() + 3)
        painter.setPen(QPen(QColor(self.palette_.accent), 1.0))
        painter.setBrush(QColor(self.palette_.accent_soft))
        painter.drawRoundedRect(chip, 5, 5)
        if icon:
            drawn = icons.pixmap(icon, self.palette_.accent, edge, painter.device().devicePixelRatio())
            painter.drawPixmap(round(chip.left()) + 5, round(chip.center().y() - 0.5 * edge), drawn)
        painter.setPen(QColor(self.palette_.text))
        painter.drawText(
            chip.adjusted(0, 0, -5, 0), int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter), text
        )

    def _paint_numbers(self, painter: QPainter, card: QRect, candidate: Candidate, value: str, apart: str) -> None:
        """Match and sort value; ``apart`` tells designs of several grids or starts apart."""
        score = candidate.score
        text = _text_of(card)
        left, right = int(Qt.AlignmentFlag.AlignLeft), int(Qt.AlignmentFlag.AlignRight)
        top, bottom = int(Qt.AlignmentFlag.AlignTop), int(Qt.AlignmentFlag.AlignBottom)
        plain = QFont(painter.font())
        bold = QFont(plain)
        bold.setPointSizeF(plain.pointSizeF() * 1.2)
        bold.setWeight(QFont.Weight.DemiBold)
        painter.setFont(bold)
        painter.setPen(QColor(self.palette_.text))
        painter.drawText(text, left | top, f"{number(100 * score.iou_exact, '.1f')} %")
        painter.setFont(plain)
        painter.setPen(QColor(self.palette_.muted))
        metrics, line = painter.fontMetrics(), text.adjusted(0, 0, -22, 0)
        painter.drawText(line, right | bottom, apart)
        room = line.width() - (metrics.horizontalAdvance(apart) + 6 if apart else -2)
        painter.drawText(text, left | bottom, metrics.elidedText(value, Qt.TextElideMode.ElideRight, room))

    def _paint_level(self, painter: QPainter, card: QRect, verdict: Verdict) -> None:
        """The icon of the verdict in the lower right corner, pale where it is an estimate."""
        edge, text, level = 16, _text_of(card), level_of(verdict)
        icon = icons.pixmap(ICONS[level], colour_of(level, self.palette_), edge, painter.device().devicePixelRatio())
        painter.setOpacity(PALE if verdict.is_estimate else 1.0)
        painter.drawPixmap(text.right() - edge + 1, text.bottom() - edge + 1, icon)
        painter.setOpacity(1.0)


def lay_out_cards(view: QListView, model: QAbstractItemModel, cards: QStyledItemDelegate) -> None:
    """Make a list view a grid of cards that never scrolls sideways; only one of them is selected."""
    view.setModel(model)
    view.setItemDelegate(cards)
    view.setViewMode(QListView.ViewMode.IconMode)
    view.setResizeMode(QListView.ResizeMode.Adjust)
    view.setMovement(QListView.Movement.Static)
    view.setUniformItemSizes(True)
    view.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
    view.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
    view.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
    view.setMouseTracking(True)
    view.setObjectName("gallery")


def paint_back(painter: QPainter, card: QRect, state: QStyle.StateFlag, palette: Palette) -> None:
    """The card's ground and edge: plain, under the mouse, or selected."""
    selected = bool(state & QStyle.StateFlag.State_Selected)
    over = bool(state & QStyle.StateFlag.State_MouseOver)
    colour = palette.accent_soft if selected else palette.raised if over else palette.surface
    edge = palette.accent if selected else palette.strong_border if over else palette.border
    painter.setBrush(QColor(colour))
    painter.setPen(QPen(QColor(edge), 2.0 if selected else 1.0))
    painter.drawRoundedRect(QRectF(card).adjusted(1, 1, -1, -1), 8, 8)


def paint_buttons(
    painter: QPainter, boxes: Mapping[CardButton, QRect], mark: Mark, hovered: CardButton | None, palette: Palette
) -> None:
    """The buttons of the card under the mouse; lit are the one under it, and the one that the design is marked by."""
    ratio = painter.device().devicePixelRatio()
    for button, box in boxes.items():
        lit = button is hovered or mark is (Mark.PINNED if button is CardButton.PIN else Mark.REJECTED)
        painter.setPen(QPen(QColor(palette.accent if lit else palette.strong_border), 1.0))
        painter.setBrush(QColor(palette.accent_soft if lit else palette.surface))
        painter.drawRoundedRect(QRectF(box).adjusted(0.5, 0.5, -0.5, -0.5), 6, 6)
        icon = icons.pixmap(button.value, palette.text, BUTTON - 8, ratio)
        painter.drawPixmap(box.topLeft() + QPoint(4, 4), icon)


def button_tip(button: CardButton, mark: Mark) -> str:
    """What a button of a card does."""
    if button is CardButton.PIN:
        return tr("Unpin this design") if mark is Mark.PINNED else tr("Pin: keep this design when you generate again")
    return tr("Restore this design") if mark is Mark.REJECTED else tr("Reject: hide this design")


def card_of(rect: QRect) -> QRect:
    """The card inside the cell that the list gives it."""
    return rect.adjusted(GAP // 2, GAP // 2, -GAP // 2, -GAP // 2)


def _text_of(card: QRect) -> QRect:
    """The two lines of text at the bottom of a card."""
    return card.adjusted(11, card.height() - TEXT_HEIGHT + 2, -11, -7)


def card_size(width: int) -> QSize:
    """Size of a card of a width, pixels: the sheet over its target is drawn in a square."""
    return QSize(width, round(TARGET_SHARE * (width - 8)) + HEAD_HEIGHT + TEXT_HEIGHT)


def picture_of(card: QRect) -> QRect:
    """The part of a card that shows the design."""
    height = card.height() - HEAD_HEIGHT - TEXT_HEIGHT
    return QRect(card.left() + 4, card.top() + HEAD_HEIGHT, card.width() - 8, height)


def alike_box(rect: QRect) -> QRect:
    """Place of the mark of look-alikes in a cell of the list: at the right of the first line of text."""
    card = card_of(rect)
    width = min(78, card.width() - 22 - MATCH_WIDTH)
    return QRect(card.right() - 9 - width, card.bottom() - TEXT_HEIGHT + 2, width, 20)


def button_boxes(rect: QRect) -> dict[CardButton, QRect]:
    """Places of the buttons in a cell of the list: at the lower right corner of the picture."""
    picture = picture_of(card_of(rect))
    top = picture.bottom() - BUTTON - 1
    right = picture.right() - 3
    return {
        CardButton.PIN: QRect(right - 2 * BUTTON - 4, top, BUTTON, BUTTON),
        CardButton.REJECT: QRect(right - BUTTON, top, BUTTON, BUTTON),
    }


def button_at(rect: QRect, place: QPoint) -> CardButton | None:
    """The button at a place of the view, in the cell ``rect``."""
    return next((button for button, box in button_boxes(rect).items() if box.contains(place)), None)
