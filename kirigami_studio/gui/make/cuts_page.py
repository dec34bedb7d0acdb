"""The sheet as it is cut: plan, problems, connectors, and the job played cut by cut."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QElapsedTimer, QSignalBlocker, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import (
    QHBoxLayout,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QSlider,
    QWidget,
)

from kirigami_studio.assembly.posed_pieces import PieceLook
from kirigami_studio.fabricate.findings import Problem, Severity
from kirigami_studio.foundation.words import mark, tr, tr_n
from kirigami_studio.gui.make.beds_view import BedsView
from kirigami_studio.gui.make.cut_items import CutSteps, cut_steps
from kirigami_studio.gui.make.cut_view import CutOverlay, CutView
from kirigami_studio.gui.make.fabrication_panel import sheets_of
from kirigami_studio.gui.make.hinge_bar import HingeBar
from kirigami_studio.gui.widgets import icons
from kirigami_studio.gui.widgets.card import INSET, Card, FittingLabel, ToolButton
from kirigami_studio.gui.widgets.layouts import push_button
from kirigami_studio.gui.widgets.readable import readable_length, readable_mm, readable_size, readable_time
from kirigami_studio.gui.widgets.theme import LIGHT, Palette
from kirigami_studio.studio.making import laid_beds

if TYPE_CHECKING:
    from kirigami_studio.fabricate.cut_plan import CutPlan
    from kirigami_studio.studio.making import LaidBed, MadePieces, Planned

#: Seconds in which a whole job is played, however long it takes to cut.
PLAY_SECONDS = 12.0
FRAME_MS = 16
#: Pixels between the title and the numbers at least.
GAP = 12
#: A bar narrower than this (pixels) says only time and length of what is cut.
NARROW = 360
#: Lines that are shown without scrolling.
MOST_LINES = 3
ICONS = {Severity.ERROR: "fault", Severity.WARNING: "warning"}
OVERLAYS = (
    (CutOverlay.TRAVEL, "travel", mark("Show travel moves between cuts, dashed.")),
    (
        CutOverlay.CONNECTORS,
        "connector",
        mark("Show connectors. Dark is narrow, light is wide (reversed in the dark theme)."),
    ),
    (CutOverlay.PROBLEMS, "fault", mark("Mark problems found by the cut check.")),
    (CutOverlay.BED, "rectangle", mark("Show the sheet on the machine's bed.")),
)


class CutsPage(Card):
    """Shows one plan and reports what to do with its connectors."""

    width_wanted = Signal(frozenset, float)  #: numbers of connectors; mm
    remove_wanted = Signal(frozenset)  #: numbers of connectors
    reset_wanted = Signal(frozenset)  #: numbers of connectors
    edited = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(tr("Sheet"), parent)
        self._plan: CutPlan | None = None
        self._pieces: MadePieces | None = None
        self.view, self.beds = CutView(), BedsView()
        self.problems = ProblemList()
        self.hinges = HingeBar()
        self.bar = CutBar()
        self.numbers = FittingLabel()
        self.header.addWidget(self.numbers)
        self.header.addSpacing(8)
        self.toggles: dict[CutOverlay, ToolButton] = {}
        for overlay, icon, tip in OVERLAYS:
            button = ToolButton(f"cut{overlay.value.capitalize()}", icon, tr(tip), checkable=True)
            button.setChecked(overlay in self.view.overlays)
            button.toggled.connect(self._update_overlays)
            self.toggles[overlay] = button
            self.header.addWidget(button)
        self.body.addWidget(self.view, 1)
        self.body.addWidget(self.beds, 1)
        self.beds.hide()
        self.generate = push_button(tr("Generate"), tr("Design sheets for this target (Ctrl+G)"), name="")
        self.generate.hide()
        self.body.addWidget(self.generate)
        for part in (self.problems, self.hinges, self.bar):
            self.body.addWidget(part)
        self._connect()

    def _connect(self) -> None:
        view, hinges = self.view, self.hinges
        self.bar.step_changed.connect(view.show_step)
        self.problems.picked.connect(view.go_to)
        view.problem_picked.connect(self._take_picked)
        view.selection_changed.connect(lambda chosen: hinges.show_selection(self._plan, chosen))
        view.typed.connect(hinges.type_width)
        view.remove_wanted.connect(lambda: self.remove_wanted.emit(view.selected))
        view.gestures.width_wanted.connect(lambda width: self.width_wanted.emit(view.selected, width))
        view.gestures.drag_ended.connect(self.edited)
        view.gestures.removal_wanted.connect(self._remove_or_bring_back)
        hinges.selected.connect(self._take_rule)
        hinges.width_wanted.connect(lambda width: self.width_wanted.emit(view.selected, width))
        hinges.remove_wanted.connect(lambda: self.remove_wanted.emit(view.selected))
        hinges.reset_wanted.connect(lambda: self.reset_wanted.emit(view.selected))
        hinges.edited.connect(self.edited)

    def offer_run(self, ready: bool) -> None:
        """Offer a run where there is a target and no design that could be cut."""
        self.generate.setVisible(ready)

    @property
    def summary(self) -> tuple[str, ...]:
        """What the header says, longest first."""
        if self._pieces is not None:
            pieces, beds = len(self._pieces.made.assembly.pieces), len(self._pieces.beds)
            if self._pieces.printing is not None:
                one = tr_n(
                    "{pieces} pieces  ·  {count} plate", "{pieces} pieces  ·  {count} plates", beds, pieces=pieces
                )
                return (one,)
            return (tr_n("{pieces} pieces  ·  {count} bed", "{pieces} pieces  ·  {count} beds", beds, pieces=pieces),)
        if self._plan is None:
            return ()
        size, count, kerf_mm = readable_size(*self._plan.size_mm), len(self._plan.paths), self._plan.kerf_mm
        if len(self._plan.copies) > 1:
            size = sheets_of(self._plan)
        kerf = readable_mm(kerf_mm)
        long = tr_n(
            "{size}  ·  {count} cut  ·  kerf {kerf}",
            "{size}  ·  {count} cuts  ·  kerf {kerf}",
            count,
            size=size,
            kerf=kerf,
        )
        return long, tr("{size}  ·  kerf {kerf}", size=size, kerf=kerf), size

    def show_pieces(self, made: MadePieces | None) -> None:
        """Show the beds of a pinned design in the place of a plan; None shows the plan again."""
        self._pieces = made
        if made is None:
            self._show_beds((), (0.0, 0.0), PieceLook())
        else:
            self._show_beds(made.beds, made.job.machine.reach_mm, made.posed.look)
        for part in (self.view, self.hinges, self.bar, *self.toggles.values()):
            part.setVisible(made is None)
        if made is not None:
            self.problems.show_problems(made.report.problems)
        self._show_numbers()

    def _show_numbers(self) -> None:
        """Say in the header how large the sheet is, as far as there is room."""
        self.numbers.set_texts(*self.summary)
        shown = [button for button in self.toggles.values() if not button.isHidden()]
        used = sum(button.sizeHint().width() + self.header.spacing() for button in shown) + 8
        self.numbers.fit(self.width() - 2 * INSET - used - self.title.sizeHint().width() - GAP)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        self._show_numbers()
        super().resizeEvent(event)

    def _show_beds(self, beds: tuple[LaidBed, ...], room: tuple[float, float], look: PieceLook) -> None:
        self.beds.show_beds(beds, room, look)
        self.beds.setVisible(bool(beds))

    def show_plan(self, planned: Planned | None) -> None:
        """Show another plan, or the empty state; a new picture of one sheet keeps its place.

        The board of a backed design lies below its hinge layer.
        """
        self.show_pieces(None)
        if planned is not None and planned.layers is not None:
            job = planned.layers
            look = PieceLook.of(job.material, job.fastener, in_one_plane=False)
            self._show_beds(laid_beds(job), job.machine.reach_mm, look)
        plan = None if planned is None else planned.plan
        problems = () if planned is None else planned.report.problems
        new_sheet = self._plan is None or plan is None or self._plan.copies.spread_mm != plan.copies.spread_mm
        self._plan = plan
        self._show_numbers()
        self.view.set_caption("")
        self.view.show_plan(plan, problems)
        self.problems.show_problems(problems)
        self.hinges.show_selection(plan, self.view.selected)
        self.bar.set_steps(None if plan is None else cut_steps(plan))
        if new_sheet:
            self.view.fit()

    def show_refusal(self, sentence: str) -> None:
        """There is no plan for the present numbers; the last one stays in sight, and says so."""
        self.view.set_caption(
            tr("Preview out of date: {sentence}", sentence=sentence) if self._plan is not None else ""
        )

    def _take_picked(self, problem: int) -> None:
        self.problems.show_picked(problem)
        self.view.go_to(problem)

    def _remove_or_bring_back(self, remove: bool) -> None:
        (self.remove_wanted if remove else self.reset_wanted).emit(self.view.selected)

    def _take_rule(self, hinges: frozenset[int]) -> None:
        self.toggles[CutOverlay.CONNECTORS].setChecked(True)
        self.view.gestures.select(hinges)

    def _update_overlays(self) -> None:
        self.view.set_overlays(frozenset(overlay for overlay, one in self.toggles.items() if one.isChecked()))


class ProblemList(QListWidget):
    """One line for each problem: symbol, word and sentence; hidden while there is none."""

    picked = Signal(int)  #: number of the problem

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._problems: tuple[Problem, ...] = ()
        self._palette: Palette = LIGHT
        self.setObjectName("problemList")
        self.setAccessibleName(tr("Cut plan problems"))
        self.setIconSize(QSize(16, 16))
        self.setTextElideMode(Qt.TextElideMode.ElideRight)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.currentRowChanged.connect(self._emit_picked)
        self.itemClicked.connect(lambda item: self._emit_picked(self.row(item)))
        self.hide()

    def show_problems(self, problems: tuple[Problem, ...]) -> None:
        """Show another plan's problems."""
        self._problems = problems
        with QSignalBlocker(self):
            self.clear()
            for problem in problems:
                error = problem.severity is Severity.ERROR
                item = QListWidgetItem(
                    tr("Error: {problem}", problem=problem.text)
                    if error
                    else tr("Warning: {problem}", problem=problem.text)
                )
                item.setToolTip(
                    problem.text
                    if problem.where is None
                    else tr("{problem}\nClick to show the place.", problem=problem.text)
                )
                self.addItem(item)
            self.setCurrentRow(-1)
        self._update_icons()
        self.setVisible(bool(problems))
        lines = min(len(problems), MOST_LINES)
        self.setFixedHeight(lines * (self.fontMetrics().height() + 8) + 6)

    def show_picked(self, problem: int) -> None:
        """Mark the line of a problem that was picked in the drawing."""
        with QSignalBlocker(self):
            self.setCurrentRow(problem)

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self._palette = palette
        self._update_icons()

    def _update_icons(self) -> None:
        for row, problem in enumerate(self._problems):
            self.item(row).setIcon(icons.icon(ICONS[problem.severity], self._palette, self._palette.warning))

    def _emit_picked(self, row: int) -> None:
        if row >= 0:
            self.picked.emit(row)


class CutBar(QWidget):
    """Sets how much of the job the cut view shows."""

    step_changed = Signal(int)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._steps: CutSteps | None = None
        self._seconds = 0.0
        self._clock = QElapsedTimer()
        self.play = ToolButton("playCuts", "play", tr("Play or pause cutting (Space)."), checkable=True)
        self.slider = QSlider(Qt.Orientation.Horizontal)
        self.slider.setObjectName("cutStep")
        self.slider.setAccessibleName(tr("Cuts made so far"))
        self.slider.setToolTip(tr("Cuts made so far, in cutting order (arrow keys: one cut; Home: none; End: all)"))
        self.slider.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.count, self.so_far = QLabel(), QLabel()
        for label, name in ((self.count, tr("Cuts so far")), (self.so_far, tr("Time and cut length so far"))):
            label.setObjectName("muted")
            label.setAccessibleDescription(name)
            label.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(8)
        row.addWidget(self.play)
        row.addWidget(self.slider, 1)
        row.addWidget(self.count)
        row.addWidget(self.so_far)
        self._timer = QTimer(self)
        self._timer.setInterval(FRAME_MS)
        self._timer.timeout.connect(self._advance)
        self.play.toggled.connect(self._toggle)
        self.slider.valueChanged.connect(self._take_step)
        self.set_steps(None)

    @property
    def playing(self) -> bool:
        return self._timer.isActive()

    def set_steps(self, steps: CutSteps | None) -> None:
        """Another job, shown as cut to its end; None when there is nothing to play."""
        self.play.setChecked(False)
        self._steps = steps
        for part in (self.play, self.slider):
            part.setEnabled(steps is not None)
        last = 0 if steps is None else steps.last
        self.slider.setRange(0, last)
        self.slider.setPageStep(max(last // 10, 1))
        self.slider.setValue(last)
        self._show_numbers()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        """A narrow bar leaves out the count, which the slider shows."""
        super().resizeEvent(event)
        self.count.setVisible(self.width() >= NARROW)

    def _take_step(self, step: int) -> None:
        self._show_numbers()
        self.step_changed.emit(step)

    def _show_numbers(self) -> None:
        """The numbers keep their places while they grow."""
        steps = self._steps
        if steps is None:
            self.count.clear()
            self.so_far.clear()
            return
        step = self.slider.value()
        self.count.setText(f"{step} / {steps.last}")
        self.so_far.setText(f"{readable_time(steps.seconds[step])}  ·  {readable_length(steps.length_mm[step])}")
        metrics = self.fontMetrics()
        widest = f"{readable_time(99.0)}  ·  {readable_length(99_990.0)}"
        self.count.setMinimumWidth(metrics.horizontalAdvance(f"{steps.last} / {steps.last}"))
        self.so_far.setMinimumWidth(metrics.horizontalAdvance(widest))

    def _toggle(self, playing: bool) -> None:
        self.play.show_icon("pause" if self.play.isChecked() else "play")
        if playing and self._steps is not None:
            at_end = self.slider.value() == self._steps.last
            self._seconds = 0.0 if at_end else float(self._steps.seconds[self.slider.value()])
            self._clock.start()
            self._timer.start()
        else:
            self._timer.stop()

    def _advance(self) -> None:
        """Follow the job's own time, so that long cuts take longer than short ones."""
        steps = self._steps
        if steps is None:
            return
        self._seconds += self._clock.restart() / 1000.0 * float(steps.seconds[-1]) / PLAY_SECONDS
        self.slider.setValue(steps.at(self._seconds))
        if self._seconds >= steps.seconds[-1]:
            self.play.setChecked(False)
