"""One card of the table of all designs: flat, half open and open side by side, figures, and badges on cutting it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from PySide6.QtCore import QPoint, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFont, QFontMetrics, QPainter, QPixmap
from PySide6.QtWidgets import QWidget

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.gallery.card_delegate import SIGNS
from kirigami_studio.gui.gallery.cards import DOT, Cards, Index, alike_text, card_of
from kirigami_studio.gui.gallery.gallery_model import (
    ALIKE_ROLE,
    CANDIDATE_ROLE,
    FEATURE_ROLE,
    FRESH_ROLE,
    MARK_ROLE,
    NAME_ROLE,
    NOTE_ROLE,
    VERDICT_ROLE,
)
from kirigami_studio.gui.stage.layout_items import states_pixmap
from kirigami_studio.gui.widgets import icons
from kirigami_studio.gui.widgets.paths import ink
from kirigami_studio.gui.widgets.verdict_marks import ICONS, PALE, Badge, badges_of, colour_of
from kirigami_studio.project.document import Mark

if TYPE_CHECKING:
    from kirigami_studio.studio.verdict import Verdict

#: Pixels above the pictures, for the name; below them, for their captions, the figures and the badges.
HEAD, CAPTIONS, FIGURES, BADGES = 30, 15, 22, 28
#: Pixels between a card's edge and what is on it.
INSET = 9


class TableCards(Cards):
    """Paints one design; pictures that are missing are drawn a few in each paint event."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent, 300)
        self.on_stage: Candidate | None = None  #: the chosen design
        self.compared: Sequence[Candidate] = ()

    def size_for(self, width: int) -> QSize:
        """Size of a card of a width, pixels: each of the three pictures is a square."""
        return QSize(width, (width - 2 * INSET) // 3 + HEAD + CAPTIONS + FIGURES + BADGES)

    def picture_of(self, card: QRect) -> QRect:
        """The part of a card that shows the three states."""
        width = card.width() - 2 * INSET
        return QRect(card.left() + INSET, card.top() + HEAD, width, width // 3)

    def draw(self, design: PosedDesign, thin: bool, size: QSize, ratio: float) -> QPixmap:
        return states_pixmap(design, self.target, size, ratio, self.palette_, as_cut=True, ringed=thin)

    def alike_box(self, cell: QRect, index: Index) -> QRect:
        """At the right of the figures, as wide as its text."""
        card = card_of(cell)
        width = max(78, self._view.fontMetrics().horizontalAdvance(alike_text(index)) + 12)
        return QRect(card.right() - INSET - width, card.bottom() - BADGES - FIGURES + 1, width, 20)

    def buttons_at(self, picture: QRect) -> QPoint:
        """At the upper right corner of the pictures."""
        return QPoint(picture.right(), picture.top() + 2)

    def tip_at(self, cell: QRect, place: QPoint, index: Index) -> str:
        """Badges have tooltips, too."""
        chips = self._chips(card_of(cell), badges_of(index.data(VERDICT_ROLE)), self._view.fontMetrics())
        badge = next((badge.tip for badge, box in chips if box.contains(place)), "")
        return super().tip_at(cell, place, index) or badge

    def write(self, painter: QPainter, card: QRect, index: Index) -> None:
        candidate: Candidate = index.data(CANDIDATE_ROLE)
        verdict: Verdict = index.data(VERDICT_ROLE)
        self._paint_captions(painter, self.picture_of(card))
        self._paint_head(painter, card, index, candidate, index.data(MARK_ROLE))
        self._paint_figures(painter, card, index, candidate)
        for badge, box in self._chips(card, badges_of(verdict), painter.fontMetrics()):
            self._paint_chip(painter, box, badge, verdict.is_estimate)

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
            ink(painter, None, fill=self.palette_.accent)
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
        ink(painter, None, fill=self.palette_.accent)
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

    def _chips(self, card: QRect, badges: Sequence[Badge], metrics: QFontMetrics) -> list[tuple[Badge, QRect]]:
        """The badges that there is room for, with their places in the view."""
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
        ink(painter, palette.border if well else colour, fill=palette.raised if well else palette.warning_soft)
        painter.drawRoundedRect(QRectF(box).adjusted(0.5, 0.5, -0.5, -0.5), 10, 10)
        if badge.is_level:
            painter.setOpacity(PALE if estimate else 1.0)
            icon = icons.pixmap(ICONS[badge.state], colour, 12, painter.device().devicePixelRatio())
            painter.drawPixmap(box.left() + 7, box.center().y() - 5, icon)
            painter.setOpacity(1.0)
        painter.setPen(QColor(palette.text))
        words = box.adjusted(22 if badge.is_level else 8, 0, 0, 0)
        painter.drawText(words, int(Qt.AlignmentFlag.AlignVCenter), badge.text)
