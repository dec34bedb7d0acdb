"""One card of the gallery: picture, name, numbers, mark, and its buttons under the mouse."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QPoint, QPointF, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFont, QPainter, QPixmap
from PySide6.QtWidgets import QWidget

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.words import number, tr
from kirigami_studio.gui.gallery.cards import BUTTON, DOT, Cards, Index, card_of
from kirigami_studio.gui.gallery.gallery_model import (
    CANDIDATE_ROLE,
    FRESH_ROLE,
    GRID_ROLE,
    MARK_ROLE,
    MATCH_ROLE,
    NAME_ROLE,
    NOTE_ROLE,
    RISE_ROLE,
    START_ROLE,
    UNCHECKED_ROLE,
    VALUE_ROLE,
    VERDICT_ROLE,
)
from kirigami_studio.gui.stage.layout_items import TARGET_SHARE, candidate_pixmap
from kirigami_studio.gui.widgets import icons
from kirigami_studio.gui.widgets.paths import ink
from kirigami_studio.gui.widgets.verdict_marks import ABOUT, ICONS, PALE, closing_text, colour_of, level_of
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.project.document import Mark

if TYPE_CHECKING:
    from kirigami_studio.assembly.posed_pieces import PosedPieces
    from kirigami_studio.studio.verdict import Verdict

SMALLEST_CARD = 132
#: Pixels above the picture, for the name and the marks, and below it, for two lines of text.
HEAD_HEIGHT, TEXT_HEIGHT = 24, 48
#: What polishing must have added to sIoU at least for a card to say so.
SMALLEST_RISE = 5e-4
#: Pixels that the match takes at the left of the first line of text.
MATCH_WIDTH = 66
#: Share of a card's head that a long name may take.
NAME_SHARE = 0.45
#: Icons of symmetric designs.
SIGNS = {
    Symmetry.LEFT_RIGHT: "mirror",
    Symmetry.TOP_BOTTOM: "mirror",
    Symmetry.TWO_MIRRORS: "axis-both",
    Symmetry.HALF_TURN: "turn",
    Symmetry.QUARTER_TURN: "turn",
}


class CardDelegate(Cards):
    """Paints one candidate: pictures, name, match, sort value, verdict and mark."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent, SMALLEST_CARD)
        self.compared: Candidate | None = None  #: the design that is compared with the chosen one

    def size_for(self, width: int) -> QSize:
        """Size of a card of a width, pixels: the sheet over its target is drawn in a square."""
        return QSize(width, round(TARGET_SHARE * (width - 8)) + HEAD_HEIGHT + TEXT_HEIGHT)

    def picture_of(self, card: QRect) -> QRect:
        height = card.height() - HEAD_HEIGHT - TEXT_HEIGHT
        return QRect(card.left() + 4, card.top() + HEAD_HEIGHT, card.width() - 8, height)

    def draw(self, design: PosedDesign, thin: bool, size: QSize, ratio: float, pieces: PosedPieces | None) -> QPixmap:
        return candidate_pixmap(design, self.target, size, ratio, self.palette_, pieces)

    def alike_box(self, cell: QRect, index: Index) -> QRect:
        """At the right of the first line of text."""
        card = card_of(cell)
        width = min(78, card.width() - 22 - MATCH_WIDTH)
        return QRect(card.right() - 9 - width, card.bottom() - TEXT_HEIGHT + 2, width, 20)

    def buttons_at(self, picture: QRect) -> tuple[QPoint, QPoint]:
        """One above the other at the lower right corner of the picture: the middle of a narrow card is free."""
        reject = QPoint(picture.right() - 3 - BUTTON, picture.bottom() - BUTTON - 1)
        return reject - QPoint(0, BUTTON + 2), reject

    def write(self, painter: QPainter, card: QRect, index: Index) -> None:
        candidate: Candidate = index.data(CANDIDATE_ROLE)
        verdict: Verdict = index.data(VERDICT_ROLE)
        left = self._paint_name(painter, card, index, index.data(MARK_ROLE))
        left = self._paint_symmetry(painter, card, left, candidate.symmetry)
        rise: float = index.data(RISE_ROLE)
        if candidate == self.compared:
            self._paint_chip(painter, card, "", "compare")
        elif candidate.trim is not None:
            self._paint_chip(painter, card, f"\N{MINUS SIGN}{number(100 * candidate.given_up, '.0f')} %", "trim")
        elif rise >= SMALLEST_RISE:
            self._paint_chip(painter, card, number(100 * rise, "+.1f"))
        else:
            self._paint_closing(painter, card, left, verdict)
        told_apart: str = index.data(START_ROLE) or index.data(GRID_ROLE)
        value: str = index.data(UNCHECKED_ROLE) or index.data(VALUE_ROLE)
        self._paint_numbers(painter, card, index.data(MATCH_ROLE), value, told_apart)
        self._paint_level(painter, card, verdict)

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
            ink(painter, None, fill=self.palette_.accent)
            painter.drawEllipse(QRectF(left, place.top() + 0.5 * metrics.height() - 0.5 * DOT, DOT, DOT))
            left += DOT + 5
        if mark is Mark.NONE:
            return left
        name, colour = ("pinned", self.palette_.accent) if mark is Mark.PINNED else ("reject", self.palette_.muted)
        box = QRectF(left, place.top() - 2, metrics.height() + 4, metrics.height() + 4)
        ink(painter, colour, fill=self.palette_.surface)
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
        ink(painter, self.palette_.accent, fill=self.palette_.accent_soft)
        painter.drawRoundedRect(chip, 5, 5)
        if icon:
            drawn = icons.pixmap(icon, self.palette_.accent, edge, painter.device().devicePixelRatio())
            painter.drawPixmap(round(chip.left()) + 5, round(chip.center().y() - 0.5 * edge), drawn)
        painter.setPen(QColor(self.palette_.text))
        painter.drawText(
            chip.adjusted(0, 0, -5, 0), int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter), text
        )

    def _paint_numbers(self, painter: QPainter, card: QRect, match: float, value: str, apart: str) -> None:
        """Match and sort value; ``apart`` tells designs of several grids or starts apart."""
        text = _text_of(card)
        left, right = int(Qt.AlignmentFlag.AlignLeft), int(Qt.AlignmentFlag.AlignRight)
        top, bottom = int(Qt.AlignmentFlag.AlignTop), int(Qt.AlignmentFlag.AlignBottom)
        plain = QFont(painter.font())
        bold = QFont(plain)
        bold.setPointSizeF(plain.pointSizeF() * 1.2)
        bold.setWeight(QFont.Weight.DemiBold)
        painter.setFont(bold)
        painter.setPen(QColor(self.palette_.text))
        painter.drawText(text, left | top, f"{number(100 * match, '.1f')} %")
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


def _text_of(card: QRect) -> QRect:
    """The two lines of text at the bottom of a card."""
    return card.adjusted(11, card.height() - TEXT_HEIGHT + 2, -11, -7)
