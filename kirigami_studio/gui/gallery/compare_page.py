"""The third page of the stage: two designs side by side, moved together, with their differences."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from PySide6.QtCore import QPointF, QSize, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QToolButton, QVBoxLayout, QWidget

from kirigami_studio.fabricate.panel_sizes import least_panel_share
from kirigami_studio.foundation.words import number, tr
from kirigami_studio.gui.gallery.gallery_selection import differences
from kirigami_studio.gui.session.overlays import Overlay
from kirigami_studio.gui.session.session import Entry
from kirigami_studio.gui.stage.deployment_bar import DeploymentBar
from kirigami_studio.gui.stage.layout_view import LayoutView
from kirigami_studio.gui.widgets.card import FittingLabel, ToolButton
from kirigami_studio.gui.widgets.view_transform import Bounds
from kirigami_studio.outlines.outline import Outline

#: Figures after the point of the numbers that can be subtracted, row by row.
DIGITS = (1, 0, 2, 1, 2)


class ComparedDesign(NamedTuple):
    """A design beside others, what it is called, and the width of its flat sheet, mm."""

    entry: Entry
    name: str
    width_mm: float


class ComparedView(LayoutView):
    """A layout that is fitted together with another one, so that both have one scale."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._shared: Bounds | None = None

    def share(self, bounds: Bounds | None) -> None:
        """Fit this part of the world instead of the design's own."""
        self._shared = bounds
        self.update()

    def own_bounds(self) -> Bounds | None:
        """Box of this design alone."""
        return super().scene_bounds()

    def scene_bounds(self) -> Bounds | None:
        own = super().scene_bounds()
        return own if own is None else self._shared or own

    def minimumSizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return QSize(120, 140)


class Side(QWidget):
    """One of the two designs: its name, its layout, its numbers and by how much they differ."""

    def __init__(self, name: str, accessible: str, button: QToolButton) -> None:
        super().__init__()
        self.title = FittingLabel()
        self.title.setObjectName("number")
        self._button = button
        self.view = ComparedView()
        self.view.setObjectName(name)
        self.view.setAccessibleName(accessible)
        self._grid = QGridLayout()
        self._grid.setVerticalSpacing(0)
        self._grid.setHorizontalSpacing(4)
        self._grid.setColumnStretch(1, 1)
        self.values: list[QLabel] = []
        self.gaps: list[QLabel] = []
        for row, (text, tip) in enumerate(_rows()):
            caption, value, gap = QLabel(text), QLabel(), QLabel()
            for label in (caption, gap):
                label.setObjectName("muted")
            for label in (value, gap):
                label.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
            gap.setMinimumWidth(gap.fontMetrics().horizontalAdvance("+0.0"))
            for column, label in enumerate((caption, value, gap)):
                label.setToolTip(tip)
                self._grid.addWidget(label, row, column)
            self.values.append(value)
            self.gaps.append(gap)
        head = QHBoxLayout()
        head.addWidget(self.title)
        head.addStretch(1)
        head.addWidget(button)
        column_ = QVBoxLayout(self)
        column_.setContentsMargins(0, 0, 0, 0)
        column_.setSpacing(4)
        column_.addLayout(head)
        column_.addWidget(self.view, 1)
        column_.addLayout(self._grid)

    def name(self, *titles: str) -> None:
        """Show the longest of these titles that there is room for."""
        self.title.set_texts(*titles)
        self._fit()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        super().resizeEvent(event)
        self._fit()

    def _fit(self) -> None:
        self.title.fit(self.width() - self._button.sizeHint().width() - 12)

    def show_design(self, one: ComparedDesign, target: Outline | None) -> None:
        """Show the layout of a design over the target."""
        candidate = one.entry.candidate
        # Contacts and the second target's pose are known of the sheet that was scored.
        scored = candidate.final_sheet == candidate.sheet
        known = (candidate.score, candidate.second) if scored else (None, None)
        self.view.set_sheet_width(one.width_mm)
        self.view.show_design(one.entry.design, known[0], target, known[1])

    def show_numbers(self, values: Sequence[str], gaps: Sequence[str]) -> None:
        """Show the numbers of this design, and by how much they are above or below the other's."""
        for labels, texts in ((self.values, values), (self.gaps, gaps)):
            for label, text in zip(labels, texts, strict=True):
                label.setText(text)


class ComparePage(QWidget):
    """Shows the chosen design on the left and another one on the right, at one angle, zoom and place."""

    pair_changed = Signal()
    phi_changed = Signal(float)  #: radians

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._entries: tuple[Entry | None, Entry | None] = (None, None)
        self.swap = ToolButton("swap", "swap", tr("Swap: choose the other design (Shift+K)."))
        self.leave = ToolButton("leaveCompare", "close", tr("Close the comparison (K)."))
        self.left = Side("comparedLeft", tr("Layout of the chosen design"), self.swap)
        self.right = Side("comparedRight", tr("Layout of the design it is compared with"), self.leave)
        self.bar = DeploymentBar()
        sides = QHBoxLayout()
        sides.setSpacing(8)
        sides.addWidget(self.left, 1)
        sides.addWidget(self.right, 1)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(8)
        column.addLayout(sides, 1)
        column.addWidget(self.bar)
        for side, other in ((self.left, self.right), (self.right, self.left)):
            side.view.view_changed.connect(other.view.set_view)
            self.bar.phi_changed.connect(side.view.set_phi)
        self.bar.phi_changed.connect(self.phi_changed)

    @property
    def sides(self) -> tuple[Side, Side]:
        return self.left, self.right

    @property
    def summary(self) -> tuple[str, ...]:
        """What the stage's header says, longest first."""
        one, other = self._entries
        if one is None or other is None:
            return ()
        apart = differences([one.candidate], other.candidate.sheet)[0]
        return tr("the designs differ by {apart:.2f}", apart=apart), tr("differ by {apart:.2f}", apart=apart)

    @property
    def entries(self) -> tuple[Entry | None, Entry | None]:
        """The chosen design and the one it is compared with."""
        return self._entries

    def show_pair(self, chosen: ComparedDesign | None, other: ComparedDesign | None, target: Outline | None) -> None:
        """Show two designs; zoom and place stay."""
        pair = (chosen, other)
        self._entries = None if chosen is None else chosen.entry, None if other is None else other.entry
        for side, one in zip(self.sides, pair, strict=True):
            self._show_side(side, one, target)
        bounds = [side.view.own_bounds() for side in self.sides]
        shared = None
        if bounds[0] is not None and bounds[1] is not None:
            shared = bounds[0].united(bounds[1])
        for place, side in enumerate(self.sides):
            side.view.share(shared)
            side.show_numbers(*number_texts(pair[place], pair[1 - place]))
        self.bar.set_ready(chosen is not None)
        if chosen is not None:
            contacts = [one.entry.candidate.score.contact for one in pair if one is not None]
            first = max((contact.phi for contact in contacts if contact is not None), default=None)
            second = chosen.entry.candidate.second
            self.bar.set_marks(chosen.entry.design.phi_target, first, None if second is None else second.target.phi)
        self.pair_changed.emit()

    def _show_side(self, side: Side, one: ComparedDesign | None, target: Outline | None) -> None:
        if one is None:
            side.name("")
            side.view.set_hint("compare", tr("Nothing to compare with"), tr("Ctrl+click a card in the gallery."))
            side.view.show_design(None, None, None)
            return
        name = one.name
        chosen = side is self.left
        alone = tr("Design {name}", name=name)
        side.name(*((tr("Design {name}, chosen", name=name), tr("{name}, chosen", name=name)) if chosen else ()), alone)
        side.show_design(one, target)

    def set_phi(self, phi: float) -> None:
        """Show both at another angle, radians."""
        self.bar.set_phi(phi)

    def set_overlays(self, overlays: frozenset[Overlay]) -> None:
        """Choose what is drawn over both."""
        for side in self.sides:
            side.view.set_overlays(overlays)

    def fit(self) -> None:
        """Show everything of both."""
        self.left.view.fit()

    def zoom(self, factor: float) -> None:
        """Enlarge both."""
        self.left.view.zoom(factor)

    def set_view(self, zoom: float, shift: QPointF) -> None:
        """Show one part of both."""
        for side in self.sides:
            side.view.set_view(zoom, shift)


def _rows() -> tuple[tuple[str, str], ...]:
    return (
        (tr("Match"), tr("Exact IoU with the target, %; then the difference from the other design, points.")),
        (
            tr("Panels"),
            tr("Evenness: how much panel sizes vary, % (coefficient of variation); then the difference, points."),
        ),
        (tr("Smallest"), tr("Smallest panel edge or neck, mm; then the difference from the other design.")),
        (
            tr("Match gained"),
            tr("Points of sIoU gained over a sheet of equal cuts; then the difference from the other design."),
        ),
        (
            tr("Roughness"),
            tr("Total variation (TV) of the ratios, lower is smoother; then the difference from the other design."),
        ),
        (tr("Symmetric"), tr("Whether the sheet is its own mirror image, or the same after a turn.")),
        (tr("Rim"), tr("Where cuts meet the sheet's sides: free, or at even distances.")),
        (tr("Feasible"), tr("Whether the sheet can be built and opens without touching itself.")),
    )


def number_texts(one: ComparedDesign | None, other: ComparedDesign | None) -> tuple[list[str], list[str]]:
    """What is said below one design, and by how much it is above or below another; one text for every row."""
    rows = len(_rows())
    if one is None:
        return [""] * rows, [""] * rows
    mine, candidate = _numbers(one), one.entry.candidate
    values = [
        tr("{match:.1f} %", match=mine[0]),
        tr("±{variation:.0f} %", variation=mine[1]),
        tr("{size:.2f} mm", size=mine[2]),
        tr("{gain:+.1f}", gain=mine[3]),
        tr("{tv:.2f}", tv=mine[4]),
        tr("no") if candidate.symmetry is None else tr("yes"),
        tr("even") if candidate.final_sheet.has_even_rim else tr("free"),
        tr("yes") if candidate.score.feasible else tr("no"),
    ]
    if other is None:
        return values, [""] * rows
    gaps = [here - there for here, there in zip(mine, _numbers(other), strict=True)]
    gap_texts = [
        number(gap, f"+.{digits}f") if abs(gap) >= 0.5 * 0.1**digits else "="
        for gap, digits in zip(gaps, DIGITS, strict=True)
    ]
    return values, [*gap_texts, "", "", ""]


def _numbers(one: ComparedDesign) -> tuple[float, float, float, float, float]:
    score = one.entry.candidate.score
    smallest_mm = one.width_mm * least_panel_share(one.entry.design.deployment)
    return 100.0 * score.iou_exact, 100.0 * score.evenness.area_cv, smallest_mm, 100.0 * score.siou_gain, score.tv
