"""One card of the table of all designs: flat, half open and open side by side, figures, and badges on cutting it."""

from __future__ import annotations

import math
import time
from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QPoint, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFont, QFontMetrics, QHelpEvent, QPainter, QPen, QPixmap, QRegion
from PySide6.QtWidgets import QAbstractItemView, QStyledItemDelegate, QStyleOptionViewItem, QToolTip, QWidget

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.gallery.badges import Badge, badges_of
from kirigami_studio.gui.gallery.card_delegate import (
    BUTTON,
    DIMMED,
    DOT,
    GAP,
    PAINT_SECONDS,
    SIGNS,
    CardButton,
    button_tip,
    paint_back,
    paint_buttons,
)
from kirigami_studio.gui.gallery.gallery_model import (
    ALIKE_ROLE,
    CANDIDATE_ROLE,
    DESIGN_ROLE,
    FEATURE_ROLE,
    FRESH_ROLE,
    MARK_ROLE,
    NAME_ROLE,
    NOTE_ROLE,
    OPEN_ROLE,
    THIN_ROLE,
    VERDICT_ROLE,
    alike_tip,
)
from kirigami_studio.gui.stage.layout_items import states_pixmap
from kirigami_studio.gui.widgets import icons
from kirigami_studio.gui.widgets.theme import LIGHT, Palette
from kirigami_studio.gui.widgets.verdict_marks import ICONS, PALE, colour_of
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Mark

if TYPE_CHECKING:
    from kirigami_studio.studio.verdict import Verdict

#: Pixels above the pictures, for the name; below them, for their captions, the figures and the badges.
HEAD, CAPTIONS, FIGURES, BADGES = 30, 15, 22, 28
#: Pixels between a card's edge and what is on it.
INSET = 9
#: Pictures that are kept; one of 400 x 130 pixels takes 0.2 MB.
CAPACITY = 400
Index = QModelIndex | QPersistentModelIndex


class TableCards(QStyledItemDelegate):
    """Paints one design; pictures that are missing are drawn a few in each paint event."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._view = parent
        self.palette_: Palette = LIGHT
        self.target: Outline | None = None
        self.card = card_size(300)
        self.under_mouse: Candidate | None = None
        self.hovered_button: CardButton | None = None
        self.on_stage: Candidate | None = None  #: the chosen design
        self.compared: Sequence[Candidate] = ()
        self._pictures: dict[tuple[PosedDesign, int, float, str, bool], QPixmap] = {}
        self._paint_until = math.inf
        self.waiting: list[QRect] = []  #: cells of the view that still lack their pictures

    @property
    def pending(self) -> bool:
        """Whether cards in sight still lack their pictures."""
        return bool(self.waiting)

    def begin(self, region: QRegion) -> None:
        """A paint event for a part of the view starts: some pictures are drawn in it, the rest in the next one."""
        self._paint_until = math.inf
        self.waiting = [cell for cell in self.waiting if not region.intersects(cell)]

    def forget_pictures(self, keep: Collection[PosedDesign] = ()) -> None:
        """Drop all pictures but those of the designs in ``keep``."""
        staying = set(keep)
        self._pictures = {key: picture for key, picture in self._pictures.items() if key[0] in staying}

    def sizeHint(self, option: QStyleOptionViewItem, index: Index) -> QSize:  # noqa: N802 - Qt's name
        return self.card + QSize(GAP, GAP)

    def helpEvent(  # noqa: N802 - Qt's name
        self, event: QHelpEvent, view: QAbstractItemView, option: QStyleOptionViewItem, index: Index
    ) -> bool:
        """Over a button or a badge its own tooltip, elsewhere the design's numbers."""
        if index.isValid():
            cell, place = view.visualRect(index), event.pos()
            button, tip = button_at(cell, place), ""
            if button is not None:
                tip = button_tip(button, index.data(MARK_ROLE))
            elif index.data(ALIKE_ROLE) and self.alike_box(cell, index).contains(place):
                tip = alike_tip(index.data(ALIKE_ROLE), index.data(OPEN_ROLE))
            else:
                chips = self._chips(cell, badges_of(index.data(VERDICT_ROLE)), view.fontMetrics())
                tip = next((badge.tip for badge, box in chips if box.contains(place)), "")
            if tip:
                QToolTip.showText(event.globalPos(), tip, view)
                return True
        return super().helpEvent(event, view, option, index)

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        candidate: Candidate = index.data(CANDIDATE_ROLE)
        design: PosedDesign = index.data(DESIGN_ROLE)
        mark: Mark = index.data(MARK_ROLE)
        rect: QRect = option.rect
        card = _card_of(rect)
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if index.data(ALIKE_ROLE) and not index.data(OPEN_ROLE):
            painter.setBrush(QColor(self.palette_.raised))
            painter.setPen(QPen(QColor(self.palette_.strong_border), 1.0))
            painter.drawRoundedRect(QRectF(card).adjusted(4, 4, 3, 3), 8, 8)
        paint_back(painter, card, option.state, self.palette_)
        picture = _picture_of(card)
        painter.setOpacity(DIMMED if mark is Mark.REJECTED else 1.0)
        drawn = self._picture(design, index.data(THIN_ROLE), picture.size(), painter.device().devicePixelRatio())
        if drawn is None:
            self.waiting.append(QRect(rect))
        else:
            painter.drawPixmap(picture.topLeft(), drawn)
        painter.setOpacity(1.0)
        self._paint_captions(painter, picture)
        self._paint_head(painter, card, index, candidate, mark)
        self._paint_figures(painter, card, index, candidate)
        verdict: Verdict = index.data(VERDICT_ROLE)
        for badge, box in self._chips(rect, badges_of(verdict), painter.fontMetrics()):
            self._paint_chip(painter, box, badge, verdict.is_estimate)
        if index.data(ALIKE_ROLE):
            self._paint_alike(painter, self.alike_box(rect, index), index)
        if candidate is self.under_mouse:
            paint_buttons(painter, button_boxes(rect), mark, self.hovered_button, self.palette_)
        painter.restore()

    def _picture(self, design: PosedDesign, thin: bool, size: QSize, ratio: float) -> QPixmap | None:
        """The design's picture, None where it has to wait for the next paint event."""
        key = (design, size.width(), ratio, self.palette_.name, thin)
        found = self._pictures.pop(key, None)
        if found is None:
            now = time.perf_counter()
            if now > self._paint_until:
                return None
            self._paint_until = min(self._paint_until, now + PAINT_SECONDS)
            found = states_pixmap(design, self.target, size, ratio, self.palette_, as_cut=True, ringed=thin)
        self._pictures[key] = found  # the last used is the last
        while len(self._pictures) > CAPACITY:
            del self._pictures[next(iter(self._pictures))]
        return found

    def _paint_captions(self, painter: QPainter, picture: QRect) -> None:
        small = QFont(painter.font())
        small.setPointSizeF(0.85 * small.pointSizeF())
        painter.save()
        painter.setFont(small)
        painter.setPen(QColor(self.palette_.muted))
        captions = (tr("flat"), tr("half open"), tr("open"))
        width = picture.width() // len(captions)
        for place, caption in enumerate(captions):
            box = QRect(picture.left() + place * width, picture.bottom() + 1, width, CAPTIONS)
            painter.drawText(box, int(Qt.AlignmentFlag.AlignCenter), caption)
        painter.restore()

    def _paint_head(self, painter: QPainter, card: QRect, index: Index, candidate: Candidate, mark: Mark) -> None:
        """Name and what is marked at the left, the match at the right."""
        box = QRect(card.left() + INSET, card.top() + 3, card.width() - 2 * INSET, HEAD - 2)
        plain, bold = QFont(painter.font()), QFont(painter.font())
        bold.setPointSizeF(1.15 * plain.pointSizeF())
        bold.setWeight(QFont.Weight.DemiBold)
        painter.setFont(bold)
        painter.setPen(QColor(self.palette_.text))
        middle = int(Qt.AlignmentFlag.AlignVCenter)
        match = tr("{match:.1f} %", match=100.0 * candidate.score.iou_exact)
        painter.drawText(box, middle | int(Qt.AlignmentFlag.AlignRight), match)
        room = box.width() - painter.fontMetrics().horizontalAdvance(match) - 12
        signs = self._signs(index, candidate, mark)
        taken = 22 * len(signs) + (70 if candidate == self.on_stage else 0) + (25 if candidate in self.compared else 0)
        name_room = max(40, room - taken)
        name = painter.fontMetrics().elidedText(index.data(NAME_ROLE), Qt.TextElideMode.ElideRight, name_room)
        painter.drawText(box, middle | int(Qt.AlignmentFlag.AlignLeft), name)
        left = box.left() + painter.fontMetrics().horizontalAdvance(name) + 7
        painter.setFont(plain)
        if candidate == self.on_stage:
            chosen = tr("chosen")
            painter.setPen(QColor(self.palette_.accent))
            painter.drawText(box.adjusted(left - box.left(), 1, 0, 1), middle, chosen)
            left += painter.fontMetrics().horizontalAdvance(chosen) + 8
        ratio = painter.device().devicePixelRatio()
        if index.data(FRESH_ROLE):
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(QColor(self.palette_.accent))
            painter.drawEllipse(QRectF(left, box.center().y() - 0.5 * DOT + 1, DOT, DOT))
            left += DOT + 6
        if candidate in self.compared:
            left = self._paint_place(painter, box, left, self.compared.index(candidate) + 1)
        for sign, colour in signs:
            painter.drawPixmap(left, box.center().y() - 7, icons.pixmap(sign, colour, 16, ratio))
            left += 22

    def _signs(self, index: Index, candidate: Candidate, mark: Mark) -> list[tuple[str, str]]:
        """Icons that follow the name, each with its colour."""
        signs = []
        if mark is not Mark.NONE:
            pinned = mark is Mark.PINNED
            signs.append(("pinned", self.palette_.accent) if pinned else ("reject", self.palette_.muted))
        if index.data(NOTE_ROLE):
            signs.append(("note", self.palette_.muted))
        if candidate.symmetry is not None:
            signs.append((SIGNS[candidate.symmetry], self.palette_.muted))
        if candidate.trim is not None:
            signs.append(("trim", self.palette_.muted))
        return signs

    def _paint_place(self, painter: QPainter, box: QRect, left: int, place: int) -> int:
        """The number of a design among those that are compared, in a disc; returns where there is room left."""
        disc = QRectF(left, box.center().y() - 8, 18, 18)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(self.palette_.accent))
        painter.drawEllipse(disc)
        painter.setPen(QColor(self.palette_.on_accent))
        painter.drawText(disc, int(Qt.AlignmentFlag.AlignCenter), str(place))
        return left + 25

    def _paint_figures(self, painter: QPainter, card: QRect, index: Index, candidate: Candidate) -> None:
        score, trim = candidate.score, candidate.trim
        box = QRect(card.left() + INSET, card.bottom() - BADGES - FIGURES, card.width() - 2 * INSET, FIGURES)
        painter.setPen(QColor(self.palette_.muted))
        parts = [
            tr("panels ±{percent:.0f} %", percent=100.0 * score.evenness.area_cv),
            tr("smallest {size:.1f} mm", size=index.data(FEATURE_ROLE)),
        ]
        if trim is not None:
            parts.append(tr("trimmed {iou:.1f} %", iou=100.0 * trim.iou))
        if candidate.second is not None:
            parts.append(tr("second {match:.1f} %", match=100.0 * candidate.second.match.iou_exact))
        text = "  ·  ".join(parts)
        metrics = painter.fontMetrics()
        middle = int(Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft)
        taken = self.alike_box(card, index).width() + 6 if index.data(ALIKE_ROLE) else 0
        room = box.width() - taken
        painter.drawText(box, middle, metrics.elidedText(text, Qt.TextElideMode.ElideRight, room))

    # badges and buttons -------------------------------------------------------------------------------------------

    def _chips(self, rect: QRect, badges: Sequence[Badge], metrics: QFontMetrics) -> list[tuple[Badge, QRect]]:
        """The badges that there is room for, with their places in the view."""
        card = _card_of(rect)
        left, top, found = card.left() + INSET, card.bottom() - BADGES + 1, []
        for badge in badges:
            width = metrics.horizontalAdvance(badge.text) + (28 if badge.is_level else 16)
            if left + width > card.right() - INSET + 2:
                break
            found.append((badge, QRect(left, top, width, 20)))
            left += width + 6
        return found

    def _paint_chip(self, painter: QPainter, box: QRect, badge: Badge, estimate: bool) -> None:
        """A fact in its frame; icons and colours of verdicts, pale for estimates."""
        palette, well = self.palette_, badge.state in ("good", "ready_to_cut", "")
        colour = colour_of(badge.state, palette)
        painter.setPen(QPen(QColor(palette.border if well else colour), 1.0))
        painter.setBrush(QColor(palette.raised if well else palette.warning_soft))
        painter.drawRoundedRect(QRectF(box).adjusted(0.5, 0.5, -0.5, -0.5), 10, 10)
        if badge.is_level:
            painter.setOpacity(PALE if estimate else 1.0)
            icon = icons.pixmap(ICONS[badge.state], colour, 12, painter.device().devicePixelRatio())
            painter.drawPixmap(box.left() + 7, box.center().y() - 5, icon)
            painter.setOpacity(1.0)
        painter.setPen(QColor(palette.text))
        words = box.adjusted(22 if badge.is_level else 8, 0, 0, 0)
        painter.drawText(words, int(Qt.AlignmentFlag.AlignVCenter), badge.text)

    def alike_box(self, rect: QRect, index: Index) -> QRect:
        """Place of the mark of look-alikes in a cell of the list: at the right of the figures, as wide as its text."""
        card = _card_of(rect)
        width = max(78, self._view.fontMetrics().horizontalAdvance(_alike_text(index)) + 12)
        return QRect(card.right() - INSET - width, card.bottom() - BADGES - FIGURES + 1, width, 20)

    def _paint_alike(self, painter: QPainter, box: QRect, index: Index) -> None:
        """How many more designs look the same, as a button."""
        painter.setPen(QPen(QColor(self.palette_.strong_border), 1.0))
        painter.setBrush(QColor(self.palette_.raised))
        painter.drawRoundedRect(QRectF(box).adjusted(0.5, 0.5, -0.5, -0.5), 5, 5)
        painter.setPen(QColor(self.palette_.text))
        painter.drawText(box, int(Qt.AlignmentFlag.AlignCenter), _alike_text(index))


def _alike_text(index: Index) -> str:
    """What the button for look-alikes says."""
    return tr("hide alike") if index.data(OPEN_ROLE) else tr("+{count} alike", count=index.data(ALIKE_ROLE))


def card_size(width: int) -> QSize:
    """Size of a card of a width, pixels: each of the three pictures is a square."""
    return QSize(width, (width - 2 * INSET) // 3 + HEAD + CAPTIONS + FIGURES + BADGES)


def _card_of(rect: QRect) -> QRect:
    return rect.adjusted(GAP // 2, GAP // 2, -GAP // 2, -GAP // 2)


def _picture_of(card: QRect) -> QRect:
    """The part of a card that shows the three states."""
    width = card.width() - 2 * INSET
    return QRect(card.left() + INSET, card.top() + HEAD, width, width // 3)


def button_boxes(rect: QRect) -> dict[CardButton, QRect]:
    """Places of the buttons in a cell of the list: at the lower right corner of the pictures."""
    picture = _picture_of(_card_of(rect))
    top, right = picture.top() + 2, picture.right()
    return {
        CardButton.PIN: QRect(right - 2 * BUTTON - 4, top, BUTTON, BUTTON),
        CardButton.REJECT: QRect(right - BUTTON, top, BUTTON, BUTTON),
    }


def button_at(rect: QRect, place: QPoint) -> CardButton | None:
    """The button at a place of the view, in the cell ``rect``."""
    return next((button for button, box in button_boxes(rect).items() if box.contains(place)), None)
