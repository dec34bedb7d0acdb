"""Two designs or more beside each other, moved together, with the same figures under each."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from PySide6.QtCore import QEvent, QPointF, QRectF, Qt, QTimer, Signal
from PySide6.QtGui import QFontMetrics, QKeyEvent, QResizeEvent
from PySide6.QtWidgets import QFrame, QGridLayout, QLabel, QScrollArea, QWidget

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.fabricate.panel_sizes import least_panel_share
from kirigami_studio.foundation.words import mark, number, tr
from kirigami_studio.gui.gallery.gallery_selection import differences
from kirigami_studio.gui.session.overlays import Overlay
from kirigami_studio.gui.session.session import Entry
from kirigami_studio.gui.stage.deployment_bar import DeploymentBar
from kirigami_studio.gui.stage.layout_view import LayoutView
from kirigami_studio.gui.widgets.card import ElidedLabel, ToolButton
from kirigami_studio.gui.widgets.layouts import column, plain_pane, row
from kirigami_studio.gui.widgets.legends import Chip
from kirigami_studio.gui.widgets.readable import UNKNOWN, readable_feature, readable_time
from kirigami_studio.gui.widgets.theme import LIGHT, Palette, themed
from kirigami_studio.gui.widgets.view_transform import Bounds
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.studio.two_states import shown_match

if TYPE_CHECKING:
    from kirigami_studio.assembly.posed_pieces import PosedPieces
    from kirigami_studio.studio.as_cut import AsCut

#: Designs that are compared at most: one for each of the keys 1 to 9.
MOST = 9
#: Width of a pane (pixels) below which panes go into one more row.
LEAST_WIDTH = 150
#: A narrower drawing (pixels) has no legends, which would cover it.
LEGENDS_FROM = 240
#: Pixels between panes, and between two columns of figures.
GAP, BETWEEN = 10, 24


@dataclass(frozen=True, slots=True)
class ComparedDesign:
    """A design beside others, and all that is known of it."""

    entry: Entry
    name: str  #: what it is called
    width_mm: float  #: of its flat sheet
    chosen: bool = False  #: whether it is the one on the stage
    as_cut: AsCut | None = None  #: how it does as cut, as far as that is known
    simulated: bool = False  #: whether that was simulated, not estimated
    seconds: float | None = None  #: that cutting it takes, as far as that is known
    pieces: PosedPieces | None = None  #: that it is made of, as far as they are known


#: What each row under a design is, in their order; "\N{ALMOST EQUAL TO}" stands before estimates.
TIPS = {
    "match": mark("Exact IoU with the target, of a trimmed design as trimmed."),
    "as_cut": mark("Whether the sheet comes to its angle as cut, or where it jams. \N{ALMOST EQUAL TO}: an estimate."),
    "strain": mark("Largest strain of a connector on the way there. \N{ALMOST EQUAL TO}: an estimate."),
    "time": mark("How long cutting takes; differences in seconds."),
    "smallest": mark("Smallest panel edge or neck."),
    "panels": mark("How much panel sizes vary (coefficient of variation)."),
    "gain": mark("Points of sIoU gained over a sheet of equal cuts."),
    "roughness": mark("Total variation (TV) of the ratios, lower is smoother."),
    "symmetric": mark("Whether the sheet is its own mirror image, or the same after a turn."),
    "rim": mark("Where cuts meet the sheet's sides: free, or at even distances."),
}


APART = mark("Difference from design 1: {gap}.")


class ComparedFigure(NamedTuple):
    """One row under a design; its value is None where two of them are not subtracted."""

    caption: str
    text: str
    value: float | None = None
    form: str = "+.0f"
    kind: str = ""

    def apart(self, first: ComparedFigure) -> str:
        """How far the number is above or below that of another design."""
        if self.value is None or first.value is None or self.kind != first.kind:
            return ""
        gap = number(self.value - first.value, self.form)
        return "=" if gap in (number(0.0, self.form), number(-0.0, self.form)) else gap


def figures_of(one: ComparedDesign) -> dict[str, ComparedFigure]:
    """Return the rows under a design by their names, in their order."""
    candidate, found = one.entry.candidate, one.as_cut
    score, even = candidate.score, candidate.final_sheet.has_even_rim
    match, variation, gain = (
        100.0 * shown_match(candidate, found),
        100.0 * score.evenness.area_cv,
        100.0 * score.siou_gain,
    )
    smallest = one.width_mm * least_panel_share(one.entry.design.deployment)
    time = UNKNOWN if one.seconds is None else readable_time(one.seconds)
    rows = {
        "match": ComparedFigure(tr("Match"), tr("{match:.1f} %", match=match), match, "+.1f"),
        "as_cut": ComparedFigure(tr("As cut"), UNKNOWN),
        "strain": ComparedFigure(tr("Strain"), UNKNOWN),
        "time": ComparedFigure(tr("Cut time"), time, one.seconds),
        "smallest": ComparedFigure(tr("Smallest"), readable_feature(smallest), smallest, "+.2f"),
        "panels": ComparedFigure(tr("Panels"), tr("±{variation:.0f} %", variation=variation), variation),
        "gain": ComparedFigure(tr("Gain"), tr("{gain:+.1f}", gain=gain), gain, "+.1f"),
        "roughness": ComparedFigure(tr("Roughness"), tr("{tv:.2f}", tv=score.tv), score.tv, "+.2f"),
        "symmetric": ComparedFigure(tr("Symmetric"), tr("no") if candidate.symmetry is None else tr("yes")),
        "rim": ComparedFigure(tr("Rim"), tr("even") if even else tr("free")),
    }
    if not score.feasible and candidate.trim is None:
        rows["as_cut"] = rows["as_cut"]._replace(text=tr("overlaps itself"))
    elif found is not None:
        about, strain = "" if one.simulated else "\N{ALMOST EQUAL TO} ", 100.0 * found.strain
        text, kind = about + tr("{strain:.0f} %", strain=strain), str(one.simulated)
        rows["as_cut"] = rows["as_cut"]._replace(text=about + found.word)
        rows["strain"] = rows["strain"]._replace(text=text, value=strain, kind=kind)
    return rows


class ComparedView(LayoutView):
    """A layout that is fitted together with others, so that all have one scale."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._shared: Bounds | None = None
        self.setMinimumSize(120, 140)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # keys belong to the page

    def share(self, bounds: Bounds | None) -> None:
        """Fit this part of the world instead of the design's own."""
        self._shared = bounds
        self.update()

    def own_bounds(self) -> Bounds | None:
        """Box of this design alone."""
        return super().scene_bounds()

    def legend(self, metrics: QFontMetrics) -> list[tuple[Chip, QRectF]]:
        return super().legend(metrics) if self.width() >= LEGENDS_FROM else []

    def scene_box(self) -> QRectF:
        return super().scene_box() if self.width() >= LEGENDS_FROM else QRectF(self.rect())

    def scene_bounds(self) -> Bounds | None:
        own = super().scene_bounds()
        return own if own is None else self._shared or own


class FigureRows(QWidget):
    """Captions with their figures right beside them, in two columns where there is room."""

    def __init__(self) -> None:
        super().__init__()
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(0, 0, 0, 0)
        self._grid.setVerticalSpacing(0)
        self._grid.setHorizontalSpacing(3)
        self.captions: dict[str, ElidedLabel] = {}
        self.values: dict[str, QLabel] = {}
        self.gaps: dict[str, QLabel] = {}
        self._arranged = 0, True
        self._width = 0  #: pixels of one column, 0 while it is not measured

    def show_figures(self, figures: Mapping[str, ComparedFigure], first: Mapping[str, ComparedFigure] | None) -> None:
        """Show the rows of a design, and how far its numbers are from those of the first one."""
        for name, figure in figures.items():
            if name not in self.values:
                self._add(name, figure.caption)
            gap = "" if first is None else figure.apart(first[name])
            if (self.values[name].text(), self.gaps[name].text()) != (figure.text, gap):
                self._width = 0
                self.values[name].setText(figure.text)
                self.gaps[name].setText(gap)
            tip = f"{tr(TIPS[name])} {tr(APART, gap=gap)}" if gap else tr(TIPS[name])
            for label in (self.captions[name], self.values[name], self.gaps[name]):
                label.setToolTip(tip)

    def _add(self, name: str, caption: str) -> None:
        elided = ElidedLabel(Qt.TextElideMode.ElideRight)
        self.captions[name], self.values[name], self.gaps[name] = elided, QLabel(), QLabel()
        elided.setText(caption)
        self.gaps[name].setObjectName("muted")
        for label in (self.values[name], self.gaps[name]):
            label.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)

    def column_width(self) -> int:
        """Pixels that one column of rows takes."""
        if not self._width:
            parts = (self.captions, self.values, self.gaps)
            widths = [max(label.sizeHint().width() for label in labels.values()) for labels in parts]
            self._width = sum(widths) + 2 * self._grid.horizontalSpacing()
        return self._width

    def arrange(self, columns: int, gaps: bool) -> None:
        """Put the rows into so many columns, with differences or without; tooltips have them."""
        if (columns, gaps) == self._arranged:
            return
        self._arranged = columns, gaps
        rows = math.ceil(len(self.values) / columns)
        widest = max(label.sizeHint().width() for label in self.captions.values())
        for place, name in enumerate(self.values):
            side, below = divmod(place, rows)
            self.captions[name].setMaximumWidth(widest)
            for part, label in enumerate((self.captions[name], self.values[name], self.gaps[name])):
                self._grid.addWidget(label, below, 4 * side + part)
            self.gaps[name].setVisible(gaps)
        self._grid.setColumnMinimumWidth(3, BETWEEN if columns == 2 else 0)
        for place, stretch in ((0, 100), (3, 1), (4, 100 if columns == 2 else 0), (7, 1)):
            self._grid.setColumnStretch(place, stretch)


class Pane(QWidget):
    """One of the designs: its name, its layout and its figures."""

    def __init__(self, place: int) -> None:
        super().__init__()
        self.title = ElidedLabel(Qt.TextElideMode.ElideRight)
        self.title.setObjectName("number")
        self.use = ToolButton(f"take{place + 1}", "check", tr("Use this design ({key}).", key=place + 1))
        self.view = ComparedView()
        self.view.setObjectName(f"compared{place + 1}")
        self.view.setAccessibleName(tr("Layout of design {number}", number=place + 1))
        self.figures = FigureRows()
        self._shown: tuple[Entry, Outline | None] | None = None
        head = row((self.title, 1), self.use)
        column(head, (self.view, 1), self.figures, on=self, spacing=4)

    def show_design(self, one: ComparedDesign, target: Outline | None) -> None:
        """Show the layout of a design over the target, unless it is there already."""
        if self._shown is not None and self._shown[0] is one.entry and self._shown[1] == target:
            self.view.show_pieces(one.pieces)
            return
        self._shown = one.entry, target
        candidate = one.entry.candidate
        # Contacts and the second target's pose are known of the sheet that was scored.
        scored = candidate.final_sheet == candidate.sheet
        known = (candidate.score, candidate.second) if scored else (None, None)
        self.view.set_sheet_width(one.width_mm)
        self.view.show_design(one.entry.design, known[0], target, known[1])
        self.view.show_pieces(one.pieces)

    def empty(self) -> None:
        """Show no design."""
        self._shown = None
        self.view.show_design(None, None, None)


class ComparePage(QWidget):
    """Designs at one angle, zoom and place, their figures compared with those of the first.

    Panes are made when designs are marked to be compared, or first shown: each takes as long as all the rest.
    """

    taken = Signal(Candidate)
    left = Signal()
    shown_changed = Signal()
    phi_changed = Signal(float)  #: radians

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.designs: tuple[ComparedDesign, ...] = ()  #: shown, the first one first
        self._overlays: frozenset[Overlay] | None = None
        self._palette: Palette = LIGHT
        self._view = 1.0, QPointF()
        self._columns = 0
        self.panes: list[Pane] = []
        self.bar = DeploymentBar()
        self.swap = ToolButton("swap", "swap", tr("Swap: choose the other design (Shift+K)."))
        self.leave = ToolButton("leaveCompare", "close", tr("Close the comparison (K or Esc)."))
        self.leave.clicked.connect(self.left)
        sheet = plain_pane()
        self._grid = QGridLayout(sheet)
        self._grid.setContentsMargins(0, 0, 0, 0)
        self._grid.setSpacing(GAP)
        self.panes_area = QScrollArea()
        self.panes_area.setWidgetResizable(True)
        self.panes_area.setFrameShape(QFrame.Shape.NoFrame)
        self.panes_area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.panes_area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.panes_area.setWidget(sheet)
        foot = row((self.bar, 1), self.swap, self.leave, spacing=4)
        column((self.panes_area, 1), foot, on=self, spacing=8)
        self.bar.phi_changed.connect(self.phi_changed)

    @property
    def shown(self) -> tuple[Pane, ...]:
        """The panes that hold them."""
        return tuple(self.panes[: len(self.designs)])

    @property
    def summary(self) -> tuple[str, ...]:
        """The header of the stage, longest text first."""
        sheets = [one.entry.candidate for one in self.designs]
        if len(sheets) < 2:
            return ()
        apart = max(differences(sheets[1:], sheets[0].sheet))
        if len(sheets) == 2:
            return tr("the designs differ by {apart:.2f}", apart=apart), tr("differ by {apart:.2f}", apart=apart)
        long = tr("up to {apart:.2f} from the first of {count}", apart=apart, count=len(sheets))
        return long, tr("up to {apart:.2f} from the first", apart=apart)

    def set_palette(self, palette: Palette) -> None:
        """Give later panes other colours; those that are there have their own call."""
        self._palette = palette

    def expect(self, designs: Sequence[ComparedDesign], target: Outline | None) -> None:
        """Make the panes of designs that may be compared soon, one in each turn of the event loop."""
        place = len(self.panes)
        if place < min(len(designs), MOST):
            self._add_pane()
            pane = self.panes[place]
            pane.figures.show_figures(figures_of(designs[place]), None)
            pane.show_design(designs[place], target)
            pane.view.compare_ideal()
            for part in pane.findChildren(QWidget):
                part.ensurePolished()
            QTimer.singleShot(0, self, lambda: self.expect(designs, target))

    def show_designs(self, designs: Sequence[ComparedDesign], target: Outline | None) -> None:
        """Show these designs, at most :data:`MOST`; angle, zoom and place stay."""
        self.designs = tuple(designs[:MOST])
        while len(self.panes) < len(self.designs):
            self._add_pane()
        first = figures_of(self.designs[0]) if self.designs else {}
        for place, pane in enumerate(self.panes):
            one = self.designs[place] if place < len(self.designs) else None
            if one is None:
                pane.hide()
                pane.empty()
                continue
            pane.title.setText(*_titles(place + 1, one))
            pane.show_design(one, target)
            pane.view.set_sheet_width(one.width_mm)
            pane.figures.show_figures(figures_of(one), first if place else None)
            pane.show()
        self._share_bounds()
        self._mark_angles()
        self.swap.setVisible(len(self.designs) == 2)
        self._arrange()
        self.shown_changed.emit()

    def _add_pane(self) -> None:
        place = len(self.panes)
        pane = Pane(place)
        pane.hide()
        self._grid.addWidget(pane, 0, place)
        pane.use.clicked.connect(lambda: self._take(place))
        pane.view.set_view(*self._view)
        pane.view.view_changed.connect(self.set_view)
        self.bar.phi_changed.connect(pane.view.set_phi)
        pane.view.set_phi(self.bar.slider.phi)
        if self._overlays is not None:
            pane.view.set_overlays(self._overlays)
        for part in themed((pane, *pane.findChildren(QWidget))):
            part.set_palette(self._palette)
        self.panes.append(pane)
        self._columns = 0

    def _share_bounds(self) -> None:
        shared = None
        for pane in self.shown:
            box = pane.view.own_bounds()
            shared = box if shared is None or box is None else shared.united(box)
        for pane in self.panes:
            pane.view.share(shared)

    def _mark_angles(self) -> None:
        self.bar.set_ready(bool(self.designs))
        if self.designs:
            first = self.designs[0].entry
            contacts = [one.entry.candidate.score.contact for one in self.designs]
            touches = max((contact.phi for contact in contacts if contact is not None), default=None)
            second = first.candidate.second
            self.bar.set_marks(first.design.phi_target, touches, None if second is None else second.target.phi)

    def _arrange(self) -> None:
        """Lay out panes in rows of equal length, and figures alike in all of them."""
        count = len(self.designs)
        if not count:
            return
        most = max(2, (self.width() + GAP) // (LEAST_WIDTH + GAP))
        rows = math.ceil(count / most)
        columns = math.ceil(count / rows)
        if columns != self._columns:
            for place in range(MOST):
                self._grid.setColumnStretch(place, 1 if place < columns else 0)
            for place, pane in enumerate(self.panes):
                self._grid.addWidget(pane, *divmod(place, columns))
            self._columns = columns
        room = (self.width() + GAP) // columns - GAP
        widest = max(pane.figures.column_width() for pane in self.shown)
        for pane in self.shown:
            pane.figures.arrange(2 if 2 * widest + BETWEEN <= room else 1, gaps=widest <= room)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        super().resizeEvent(event)
        self._arrange()

    def set_phi(self, phi: float) -> None:
        """Show all at another angle, radians."""
        self.bar.set_phi(phi)

    def set_overlays(self, overlays: frozenset[Overlay]) -> None:
        """Choose the overlays of all."""
        self._overlays = overlays
        for pane in self.panes:
            pane.view.set_overlays(overlays)

    def fit(self) -> None:
        """Show everything of all."""
        if self.panes:
            self.panes[0].view.fit()

    def zoom(self, factor: float) -> None:
        """Enlarge all."""
        if self.panes:
            self.panes[0].view.zoom(factor)

    def set_view(self, zoom: float, shift: QPointF) -> None:
        """Show one part of all."""
        self._view = zoom, QPointF(shift)
        for pane in self.panes:
            pane.view.set_view(zoom, shift)

    def _take(self, place: int) -> None:
        if place < len(self.designs):
            self.taken.emit(self.designs[place].entry.candidate)

    def _place_of(self, event: QKeyEvent) -> int | None:
        """The design that a key without others stands for."""
        plain = not event.modifiers() & ~Qt.KeyboardModifier.KeypadModifier
        place = event.key() - Qt.Key.Key_1
        return place if plain and 0 <= place < len(self.designs) else None

    def event(self, event: QEvent) -> bool:
        """Take the keys of designs before the window does."""
        asks = event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent)
        if asks and isinstance(event, QKeyEvent) and self._place_of(event) is not None:
            event.accept()
            return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        place = self._place_of(event)
        if place is not None:
            self._take(place)
        elif event.key() == Qt.Key.Key_Escape:
            self.left.emit()
        else:
            super().keyPressEvent(event)


def _titles(place: int, one: ComparedDesign) -> tuple[str, ...]:
    """How a pane is called, longest first."""
    plain = (tr("{place}   Design {name}", place=place, name=one.name), f"{place}   {one.name}")
    if not one.chosen:
        return plain
    return (
        tr("{place}   Design {name}, chosen", place=place, name=one.name),
        tr("{place}   {name}, chosen", place=place, name=one.name),
        *plain[1:],
    )
