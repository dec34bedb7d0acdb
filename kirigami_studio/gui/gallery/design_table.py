"""All designs as a table of large cards, walked through by keys and mouse; nothing here changes the choice by itself.

A card shows flat, half open and open side by side, figures, and badges on cutting.  The arrow keys move the current
card; Enter takes its design to the stage.  The table shares the gallery's model, so that order, filters and groups
are the same in both.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from PySide6.QtCore import QEvent, QModelIndex, QPoint, QRect, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QFont,
    QFontMetrics,
    QKeyEvent,
    QKeySequence,
    QMouseEvent,
    QPainter,
    QPixmap,
    QShowEvent,
)
from PySide6.QtWidgets import QAbstractItemView, QWidget

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.gallery.card_delegate import SIGNS
from kirigami_studio.gui.gallery.cards import BUTTON, DOT, CardList, Cards, Index, alike_text, card_of
from kirigami_studio.gui.gallery.compare_page import MOST
from kirigami_studio.gui.gallery.gallery_model import (
    ALIKE_ROLE,
    CANDIDATE_ROLE,
    FEATURE_ROLE,
    FRESH_ROLE,
    MARK_ROLE,
    MATCH_ROLE,
    NAME_ROLE,
    NOTE_ROLE,
    VERDICT_ROLE,
    GalleryModel,
)
from kirigami_studio.gui.stage.layout_items import states_pixmap
from kirigami_studio.gui.widgets import icons
from kirigami_studio.gui.widgets.paths import ink
from kirigami_studio.gui.widgets.readable import readable_width
from kirigami_studio.gui.widgets.verdict_marks import ICONS, PALE, Badge, badges_of, colour_of
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Mark

if TYPE_CHECKING:
    from kirigami_studio.assembly.posed_pieces import PosedPieces
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

    def draw(self, design: PosedDesign, thin: bool, size: QSize, ratio: float, pieces: PosedPieces | None) -> QPixmap:
        return states_pixmap(design, self.target, size, ratio, self.palette_, as_cut=True, ringed=thin, pieces=pieces)

    def alike_box(self, cell: QRect, index: Index) -> QRect:
        """At the right of the figures, as wide as its text."""
        card = card_of(cell)
        width = max(78, self._view.fontMetrics().horizontalAdvance(alike_text(index)) + 12)
        return QRect(card.right() - INSET - width, card.bottom() - BADGES - FIGURES + 1, width, 20)

    def buttons_at(self, picture: QRect) -> tuple[QPoint, QPoint]:
        """Side by side at the upper right corner of the pictures."""
        reject = QPoint(picture.right() - BUTTON, picture.top() + 2)
        return reject - QPoint(BUTTON + 4, 0), reject

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
        match = tr("{match:.1f} %", match=100.0 * index.data(MATCH_ROLE))
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
            tr("smallest {size}", size=readable_width(index.data(FEATURE_ROLE), 1)),
        ]
        if trim is not None:
            parts.append(tr("gives up {percent:.0f} %", percent=100.0 * candidate.given_up))
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


#: Least widths of a card, pixels, from small to large.
WIDTHS = (270, 340, 430, 560)
#: Keys that give a design a place in the comparison.
PLACES = tuple(Qt.Key(Qt.Key.Key_1 + place) for place in range(MOST))


class DesignTable(CardList):
    """Cards in a grid that fills the window; the current card is the one that keys act on."""

    taken = Signal(Candidate)  #: to the stage
    left = Signal()  #: back to the window
    compare_wanted = Signal()
    compared_changed = Signal()
    size_wanted = Signal(int)  #: by how many steps cards should become larger
    current_changed = Signal()

    def __init__(self, model: GalleryModel, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.model_ = model
        self.cards = TableCards(self)
        self.hint: Callable[[], str] = str  #: text of an empty table
        self._compared: list[Candidate] = []
        self._current: Candidate | None = None
        self.lay_out(model, self.cards, WIDTHS[1], tr("Table of all designs"))
        model.arranged.connect(self._follow)
        self.selectionModel().currentChanged.connect(self._note_current)

    @property
    def current(self) -> Candidate | None:
        """The design that keys act on."""
        return self._current if self.model_.row_of(self._current) >= 0 else None

    @property
    def compared(self) -> tuple[Candidate, ...]:
        """Those that were marked to be compared, in the order of their places."""
        return tuple(self._compared)

    def set_target(self, target: Outline | None) -> None:
        """Draw over another target; pictures of designs that are gone are dropped."""
        same = target == self.cards.target
        self.cards.target = target
        self.cards.forget_pictures([entry.design for entry in self.model_.all_entries] if same else ())
        self.viewport().update()

    def set_on_stage(self, candidate: Candidate | None) -> None:
        """Mark the design that is on the stage."""
        if candidate is not self.cards.on_stage:
            self.cards.on_stage = candidate
            self.viewport().update()

    def set_size(self, size: int) -> None:
        """Show larger or smaller cards, from 0 on."""
        self._least_width = WIDTHS[min(max(size, 0), len(WIDTHS) - 1)]
        self.share_width()

    def empty_text(self) -> str:
        return self.hint()

    def compare(self, candidate: Candidate) -> None:
        """Mark it to be compared."""
        self.toggle_compared(candidate)

    def go_to(self, candidate: Candidate | None) -> None:
        """Make a design, or the card that it lies under, the current one and scroll to it."""
        row = self.model_.row_of(candidate)
        if row < 0:
            row = self.model_.row_of(self.model_.head_of(candidate)) if candidate is not None else -1
        index = self.model_.index(max(row, 0), 0)
        if index.isValid():
            self.setCurrentIndex(index)
            self.scrollTo(index, QAbstractItemView.ScrollHint.EnsureVisible)

    def _note_current(self, current: QModelIndex) -> None:
        if current.isValid():
            self._current = current.data(CANDIDATE_ROLE)
            self.current_changed.emit()

    def _follow(self) -> None:
        """Rows have changed: the same design stays current, those that are gone are no longer compared."""
        there = set(map(id, (entry.candidate for entry in self.model_.all_entries)))
        staying = [one for one in self._compared if id(one) in there or self.model_.number_of(one)]
        if len(staying) != len(self._compared):
            self._set_compared(staying)
        if self.isVisible() and self.model_.rowCount():
            row = self.model_.row_of(self._current)
            if row < 0 or self.currentIndex().row() != row:
                self.go_to(self._current)
        self.current_changed.emit()

    # comparing -----------------------------------------------------------------------------------------------------

    def toggle_compared(self, candidate: Candidate | None, place: int | None = None) -> None:
        """Mark a design to be compared, at a place (from 0) or the next free one, or take it out again."""
        if candidate is None:
            return
        marked = list(self._compared)
        before = marked.index(candidate) if candidate in marked else None
        if before is not None:
            marked.remove(candidate)
        if before is None or (place is not None and place != before):
            at = len(marked) if place is None else min(place, len(marked))
            if place is not None and before is None and len(marked) > place:
                marked[at] = candidate  # it takes the place of the one there
            else:
                marked.insert(at, candidate)
        self._set_compared(marked[-MOST:])

    def mark_all(self) -> None:
        """Mark the first designs that are shown, as many as can be compared."""
        self._set_compared([entry.candidate for entry in self.model_.entries[:MOST]])

    def clear_compared(self) -> None:
        """Nothing is to be compared."""
        self._set_compared([])

    def _set_compared(self, candidates: list[Candidate]) -> None:
        self._compared = candidates
        self.cards.compared = tuple(candidates)
        self.viewport().update()
        self.compared_changed.emit()

    # events --------------------------------------------------------------------------------------------------------

    def event(self, event: QEvent) -> bool:
        """Keys without Ctrl and Alt belong to the table: what they do elsewhere would happen out of sight."""
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent):
            plain = not event.modifiers() & (Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.AltModifier)
            function = Qt.Key.Key_F1 <= event.key() <= Qt.Key.Key_F12
            if (plain and not function and event.text() != "?") or event.matches(QKeySequence.StandardKey.SelectAll):
                event.accept()
                return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        key, candidate = event.key(), self.current
        if event.matches(QKeySequence.StandardKey.SelectAll):
            self.mark_all()
        elif key in (Qt.Key.Key_Escape, Qt.Key.Key_A):
            self.left.emit()
        elif key in (Qt.Key.Key_Plus, Qt.Key.Key_Equal, Qt.Key.Key_Minus):
            self.size_wanted.emit(-1 if key == Qt.Key.Key_Minus else 1)
        elif key in (Qt.Key.Key_C, Qt.Key.Key_K):
            self.compare_wanted.emit()
        elif candidate is None or not self._act(key, candidate):
            if key in _MOVING:
                super().keyPressEvent(event)
            else:
                event.ignore()  # Qt would look for a design whose name begins with the letter

    def _act(self, key: int, candidate: Candidate) -> bool:
        """Do what a key does to the current design; whether it does anything."""
        if key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.taken.emit(candidate)
        elif key == Qt.Key.Key_Space:
            self.toggle_compared(candidate)
        elif key in PLACES:
            self.toggle_compared(candidate, PLACES.index(Qt.Key(key)))
        elif key == Qt.Key.Key_I:
            self.pin_wanted.emit(candidate)
        elif key in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace):
            self.reject_wanted.emit(candidate)
        elif key == Qt.Key.Key_G and self.currentIndex().data(ALIKE_ROLE):
            self.alike_toggled.emit(candidate)
        else:
            return False
        return True

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        _, candidate, button = self.at(event.position().toPoint())
        if candidate is not None and button is None and event.button() == Qt.MouseButton.LeftButton:
            self.taken.emit(candidate)

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802 - Qt's name
        super().showEvent(event)
        self._follow()


_MOVING = frozenset(
    {
        Qt.Key.Key_Left,
        Qt.Key.Key_Right,
        Qt.Key.Key_Up,
        Qt.Key.Key_Down,
        Qt.Key.Key_Home,
        Qt.Key.Key_End,
        Qt.Key.Key_PageUp,
        Qt.Key.Key_PageDown,
        Qt.Key.Key_Tab,
        Qt.Key.Key_Backtab,
    }
)
