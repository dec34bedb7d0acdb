"""The candidates as cards that can be clicked or walked through with the arrow keys."""

from __future__ import annotations

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QRect, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFont, QPainter, QPaintEvent, QPen, QPixmap, QResizeEvent
from PySide6.QtWidgets import QAbstractItemView, QListView, QStyle, QStyledItemDelegate, QStyleOptionViewItem, QWidget

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.gui import icons
from kirigami_studio.gui.scene.posed import PosedDesign
from kirigami_studio.gui.scene.thumbnail import candidate_pixmap
from kirigami_studio.gui.theme import LIGHT, Palette
from kirigami_studio.gui.views.gallery_model import CANDIDATE_ROLE, DESIGN_ROLE, RISE_ROLE, Entry, GalleryModel
from kirigami_studio.target.outline import Outline

SMALLEST_CARD = 132
TEXT_HEIGHT = 58
GAP = 8
#: Room that is always kept for the scroll bar, so that cards do not jump when it appears.
SCROLL_BAR = 14
#: What polishing must have added to sIoU at least for a card to say so.
SMALLEST_RISE = 5e-4
Index = QModelIndex | QPersistentModelIndex


class CardDelegate(QStyledItemDelegate):
    """Paints one candidate: picture, rank, sIoU, gain, TV, whether it is feasible, what polishing or trimming did."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.palette_: Palette = LIGHT
        self.target: Outline | None = None
        self.card = QSize(SMALLEST_CARD, SMALLEST_CARD + TEXT_HEIGHT - 26)
        self._pictures: dict[tuple[PosedDesign, int, float, str], QPixmap] = {}

    def forget_pictures(self) -> None:
        """Drop all thumbnails; they are painted again when needed."""
        self._pictures.clear()

    def sizeHint(self, option: QStyleOptionViewItem, index: Index) -> QSize:  # noqa: N802 - Qt's name
        return self.card + QSize(GAP, GAP)

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        candidate: Candidate = index.data(CANDIDATE_ROLE)
        design: PosedDesign = index.data(DESIGN_ROLE)
        rect: QRect = option.rect
        state: QStyle.StateFlag = option.state
        card = rect.adjusted(GAP // 2, GAP // 2, -GAP // 2, -GAP // 2)
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self._paint_back(painter, card, state)
        picture = QRect(card.left() + 4, card.top() + 4, card.width() - 8, card.height() - TEXT_HEIGHT)
        painter.drawPixmap(
            picture.topLeft(), self._picture(design, picture.size(), painter.device().devicePixelRatio())
        )
        self._paint_rank(painter, card, index.row() + 1)
        rise: float = index.data(RISE_ROLE)
        if candidate.trim is not None:
            self._paint_chip(painter, card, f"{100 * candidate.trim.iou:.1f} %", "trim")
        elif rise >= SMALLEST_RISE:
            self._paint_chip(painter, card, f"{100 * rise:+.1f}")
        self._paint_numbers(painter, card, candidate)
        painter.restore()

    def _paint_back(self, painter: QPainter, card: QRect, state: QStyle.StateFlag) -> None:
        chosen = bool(state & QStyle.StateFlag.State_Selected)
        over = bool(state & QStyle.StateFlag.State_MouseOver)
        colour = self.palette_.accent_soft if chosen else self.palette_.raised if over else self.palette_.surface
        edge = self.palette_.accent if chosen else self.palette_.strong_border if over else self.palette_.border
        painter.setBrush(QColor(colour))
        painter.setPen(QPen(QColor(edge), 2.0 if chosen else 1.0))
        painter.drawRoundedRect(QRectF(card).adjusted(1, 1, -1, -1), 8, 8)

    def _picture(self, design: PosedDesign, size: QSize, ratio: float) -> QPixmap:
        key = (design, size.width(), ratio, self.palette_.name)
        if key not in self._pictures:
            self._pictures[key] = candidate_pixmap(design, self.target, size, ratio, self.palette_)
        return self._pictures[key]

    def _paint_rank(self, painter: QPainter, card: QRect, rank: int) -> None:
        painter.setPen(QColor(self.palette_.muted))
        painter.drawText(
            card.adjusted(10, 8, -10, 0), int(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignTop), f"{rank}"
        )

    def _paint_chip(self, painter: QPainter, card: QRect, text: str, icon: str = "") -> None:
        """A small mark in the upper right corner of the picture."""
        metrics = painter.fontMetrics()
        edge = metrics.ascent() + 2 if icon else 0
        width = metrics.horizontalAdvance(text) + 10 + (edge + 3 if icon else 0)
        chip = QRectF(card.right() - 7 - width, card.top() + 7, width, metrics.height() + 3)
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

    def _paint_numbers(self, painter: QPainter, card: QRect, candidate: Candidate) -> None:
        score = candidate.score
        text = card.adjusted(11, card.height() - TEXT_HEIGHT + 4, -11, -8)
        left, right = int(Qt.AlignmentFlag.AlignLeft), int(Qt.AlignmentFlag.AlignRight)
        top, bottom = int(Qt.AlignmentFlag.AlignTop), int(Qt.AlignmentFlag.AlignBottom)
        plain = QFont(painter.font())
        bold = QFont(plain)
        bold.setPointSizeF(plain.pointSizeF() * 1.2)
        bold.setWeight(QFont.Weight.DemiBold)
        painter.setFont(bold)
        painter.setPen(QColor(self.palette_.text))
        painter.drawText(text, left | top, f"{100 * score.siou:.1f} %")
        painter.setFont(plain)
        gain = self.palette_.accent if score.siou_gain >= 0 else self.palette_.warning
        painter.setPen(QColor(gain))
        painter.drawText(text.adjusted(0, 2, 0, 0), right | top, f"{100 * score.siou_gain:+.1f}")
        painter.setPen(QColor(self.palette_.muted))
        painter.drawText(text, left | bottom, f"TV {score.tv:.2f}")
        self._paint_badge(painter, text, score.feasible)

    def _paint_badge(self, painter: QPainter, text: QRect, feasible: bool) -> None:
        name, colour = ("check", self.palette_.accent) if feasible else ("warning", self.palette_.warning)
        edge = 16
        ratio = painter.device().devicePixelRatio()
        painter.drawPixmap(text.right() - edge + 1, text.bottom() - edge + 1, icons.pixmap(name, colour, edge, ratio))


class GalleryView(QListView):
    """Cards in a grid that fills the width; the current card is the chosen design."""

    chosen = Signal(object)  #: Candidate

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.model_ = GalleryModel(self)
        self.cards = CardDelegate(self)
        self.setModel(self.model_)
        self.setItemDelegate(self.cards)
        self.setViewMode(QListView.ViewMode.IconMode)
        self.setResizeMode(QListView.ResizeMode.Adjust)
        self.setMovement(QListView.Movement.Static)
        self.setUniformItemSizes(True)
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setMouseTracking(True)
        self.setObjectName("gallery")
        self.setAccessibleName("Candidate designs, best first")
        self._telling = True
        self._hint = ("No designs yet", "Candidates appear here, best first, while they are generated.")
        self.selectionModel().currentChanged.connect(self._tell)

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self.cards.palette_ = palette
        self.viewport().update()

    def set_hint(self, headline: str, hint: str) -> None:
        """Say in the empty gallery what to do next."""
        self._hint = (headline, hint)
        self.viewport().update()

    def show_entries(self, entries: list[Entry], target: Outline | None) -> None:
        """Show other candidates."""
        self.cards.target = target
        self.cards.forget_pictures()
        self._telling = False
        self.model_.replace(entries)
        self._telling = True

    def add(self, entry: Entry) -> None:
        """Add one candidate at its rank."""
        self._telling = False
        self.model_.insert(entry)
        self._telling = True

    def mark(self, candidate: Candidate | None) -> None:
        """Highlight the chosen candidate without reporting it as a gesture."""
        row = self.model_.row_of(candidate) if candidate is not None else -1
        self._telling = False
        if row < 0:
            self.selectionModel().clear()
        elif self.currentIndex().row() != row:
            self.setCurrentIndex(self.model_.index(row, 0))
        self._telling = True

    def _tell(self, current: QModelIndex, previous: QModelIndex) -> None:
        if self._telling and current.isValid():
            self.chosen.emit(current.data(CANDIDATE_ROLE))

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        width = self.width() - SCROLL_BAR
        columns = max(1, width // (SMALLEST_CARD + GAP))
        card = width // columns - GAP
        wanted = QSize(card, round(card * 0.86) + TEXT_HEIGHT - 16)
        if wanted != self.cards.card:
            self.cards.card = wanted
            self.cards.forget_pictures()
            self.scheduleDelayedItemsLayout()
        super().resizeEvent(event)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        super().paintEvent(event)
        if self.model_.rowCount() > 0:
            return
        painter = QPainter(self.viewport())
        flags = int(Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap)
        box = self.viewport().rect().adjusted(20, 0, -20, 0)
        painter.setPen(QColor(self.cards.palette_.muted))
        painter.drawText(box, flags, f"{self._hint[0]}\n\n{self._hint[1]}")
        painter.end()
