"""The chosen design, large: layout or comparison, overlays, plots, deployment; its presenter."""

from __future__ import annotations

import math
from collections.abc import Callable

from PySide6.QtCore import QByteArray, QObject, QSettings, QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QAction, QResizeEvent
from PySide6.QtWidgets import QMenu, QSplitter, QStackedWidget, QToolButton, QWidget

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.gallery.compare_page import ComparePage
from kirigami_studio.gui.gallery.gallery_model import described
from kirigami_studio.gui.make.verdict_bar import VerdictBar
from kirigami_studio.gui.session.overlays import USUAL, Overlay
from kirigami_studio.gui.session.session import Entry, Session
from kirigami_studio.gui.stage.as_cut import UNKNOWN, AsCutEstimates, AsCutState
from kirigami_studio.gui.stage.curves import CurveReader
from kirigami_studio.gui.stage.deployment_bar import DeploymentBar
from kirigami_studio.gui.stage.gripping import GripFinder
from kirigami_studio.gui.stage.layout_view import USUAL_WIDTH_MM, FaultTour, LayoutView
from kirigami_studio.gui.stage.plots_panel import PlotsPanel
from kirigami_studio.gui.stage.slider_lines import AsCutLine, EndsLine
from kirigami_studio.gui.stage.void_bar import VoidBar
from kirigami_studio.gui.widgets.card import INSET, TITLE_SHARE, Card, FittingLabel, SwitchButton, ToolButton
from kirigami_studio.gui.widgets.layouts import column, plain_pane
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.studio.as_cut import AsCut
from kirigami_studio.studio.designing import limit_of
from kirigami_studio.studio.making import MadePieces, Planned
from kirigami_studio.studio.two_states import TwoStates, shown_flat_match, shown_match, start_of

#: A stage at least this wide (pixels) has its plots at the side, a narrower one below.
WIDE = 640
#: A stage lower than this (pixels) leaves room to the drawing: no line for the slider's ends.
LOW = 630
#: Pixels between the title and the numbers at least.
GAP = 12
OVERLAYS = (
    (Overlay.TARGET, "target", mark("Show the target's outline (T).")),
    (
        Overlay.MISMATCH,
        "mismatch",
        mark("Show missing and extra area near the target angle (M). Orange stripes: missing; dark stripes: extra."),
    ),
    (Overlay.FAULTS, "fault", mark("Mark inverted panels and contacts (F).")),
)
BEFORE = mark("Before polish: show the design as generated (B).")
NEVER_POLISHED = mark("Before polish (B). Nothing to compare: polishing has not changed this design.")
NEVER_SAMPLED = mark("Before polish (B). Nothing to compare: the model did not generate this design.")
TRIM = mark("Trim to target (Ctrl+T). Cuts the edge panels along the target; every hinge keeps its material.")
UNTRIM = mark("Trim to target (Ctrl+T). Press again to untrim.")
TRIMMING = mark("Trimming … Press again, or Esc, to stop.")
PLOTS = mark("Plots: match, area, size and gaps at every angle (J).")


class StagePanel(Card):
    """Shows one entry of the gallery at any angle, as it is or as the generator sampled it."""

    overlays_changed = Signal(frozenset)  #: of Overlay
    before_wanted = Signal(bool)  #: whether the design is to be shown as sampled
    status = Signal(str)
    switches_changed = Signal()  #: the state of :attr:`before`, :attr:`trim` or the plots
    comparing_changed = Signal(bool)  #: whether several designs are shown side by side
    whole_width_wanted = Signal(bool)  #: more of them than have room beside the other columns

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(tr("Layout"), parent)
        self._entry: Entry | None = None
        self._sample: Entry | None = None
        self._target: Outline | None = None
        self._name = ""
        self._limit = ""
        self._known: AsCut | None = None  # of the design, beside its score
        self._width_mm = USUAL_WIDTH_MM
        self._trimmable, self._trimming = True, False
        self._as_cut = UNKNOWN
        self._posed_for: Outline | None = None  #: the target at whose angle the first design was shown
        self.view = LayoutView()
        self.tour = FaultTour(self.view)
        self.deployment = DeploymentBar()
        self.ends = EndsLine()
        self.as_cut = AsCutLine()
        self.plots = PlotsPanel()
        self.compare = ComparePage()
        self.compare.shown_changed.connect(self._show_comparison)
        self.numbers = FittingLabel()
        self.header.addWidget(self.numbers)
        self.header.addSpacing(8)
        self.before = SwitchButton("before", "before", tr(BEFORE))
        self.before.switch.toggled.connect(self._toggle_before)
        self.trim = SwitchButton("trim", "trim", tr(TRIM))
        tip = tr(
            "Edit by hand (H). Scroll over a void, or drag it, a corner of the outline or an edge cut. "
            "L locks; arrows go to the next void."
        )
        self.hand = SwitchButton("hand", "hand", tip)
        self.hand.switch.toggled.connect(self._toggle_hand)
        for switch in (self.before, self.trim, self.hand):
            self.header.addWidget(switch)
        self.header.addSpacing(6)
        self._add_overlays()
        self._add_pages()
        self.deployment.phi_changed.connect(self.view.set_phi)
        self.deployment.as_cut_button.show()
        self.deployment.as_cut.toggled.connect(self.view.set_as_cut)
        self.deployment.ideal.toggled.connect(self.view.set_ideal)
        self.ends.phi_wanted.connect(self.deployment.set_phi)
        self.deployment.ideal.toggled.connect(lambda _: self.switches_changed.emit())
        self.deployment.phi_changed.connect(self.plots.set_phi)
        self.plots.phi_wanted.connect(self.deployment.set_phi)
        self.tour.phi_wanted.connect(self.deployment.set_phi)
        self.tour.status.connect(self.status)
        self.deployment.phi_changed.connect(self.compare.set_phi)
        self.compare.phi_changed.connect(self.deployment.set_phi)
        self.overlays_changed.connect(self.compare.set_overlays)

    def _add_overlays(self) -> None:
        """The switches at the right of the header: what is drawn over the layout."""
        self.toggles: dict[Overlay, ToolButton] = {}
        self.overlays: dict[Overlay, QAction] = {}
        for overlay, icon, tip in OVERLAYS:
            toggle = SwitchButton(f"show{overlay.value.capitalize()}", icon, tr(tip))
            self.toggles[overlay], self.overlays[overlay] = toggle, toggle.switch
            self.header.addWidget(toggle)
        for overlay in Overlay:
            switch = self.overlays.setdefault(overlay, QAction(self))
            switch.setCheckable(True)
            switch.setChecked(overlay in USUAL)
            switch.toggled.connect(self._update_overlays)
        self.overlays_button = ToolButton("overlays", "overlays", tr("Overlays on the layout."))
        self.overlays_button.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.overlay_menu = QMenu(self.overlays_button)
        self.overlay_menu.setToolTipsVisible(True)
        self.overlays_button.setMenu(self.overlay_menu)
        self.header.addWidget(self.overlays_button)
        self.plots_switch = SwitchButton("plots", "plots", tr(PLOTS))
        self.plots_switch.switch.toggled.connect(self._toggle_plots)
        self.header.addWidget(self.plots_switch)
        self.whole = ToolButton("fit", "fit", tr("Fit view (0)."))
        self.whole.clicked.connect(self.fit)
        self.header.addWidget(self.whole)
        for button in (self.whole, *self.toggles.values()):
            button.hide()  # until it is known that there is room

    def _add_pages(self) -> None:
        self._layout_page = plain_pane()
        self.split = QSplitter(Qt.Orientation.Vertical)
        self.split.setChildrenCollapsible(False)
        self.split.addWidget(self.view)
        self.split.addWidget(self.plots)
        self.split.setStretchFactor(0, 1)
        self.plots.hide()
        self.voids = VoidBar()
        below = (self.voids, self.deployment, self.ends, self.as_cut)
        column((self.split, 1), *below, on=self._layout_page, spacing=8)
        self.voids.hide()
        self.pages = QStackedWidget()
        for page in (self._layout_page, self.compare):
            self.pages.addWidget(page)
        self.body.addWidget(self.pages, 1)
        self.verdict = VerdictBar()
        self.body.addWidget(self.verdict)

    def show_target(self, target: Outline | None) -> None:
        """Show the target while there is no design for it yet."""
        self._target = target
        if self._entry is None:
            self._show()

    @property
    def comparing(self) -> bool:
        """Whether several designs are shown side by side."""
        return self.pages.currentWidget() is self.compare

    @property
    def player(self) -> DeploymentBar:
        """What Space plays now."""
        return self.compare.bar if self.comparing else self.deployment

    @property
    def _in_sight(self) -> LayoutView | ComparePage:
        return self.compare if self.comparing else self.view

    def take_focus(self) -> None:
        """Give the keyboard to what is in sight."""
        self._in_sight.setFocus()

    def fit(self) -> None:
        """Show everything of what is in sight."""
        self._in_sight.fit()

    def zoom(self, factor: float) -> None:
        """Enlarge what is in sight."""
        self._in_sight.zoom(factor)

    def set_comparing(self, on: bool) -> None:
        """Show several designs side by side, or one alone."""
        if on != self.comparing:
            self._turn_to(self.compare if on else self._layout_page)

    @property
    def wants_whole_width(self) -> bool:
        """Whether more designs are compared than have room beside the other columns."""
        return self.comparing and len(self.compare.designs) > 2

    def _show_comparison(self) -> None:
        self.show_title()
        self.whole_width_wanted.emit(self.wants_whole_width)

    def _turn_to(self, page: QWidget) -> None:
        for bar in (self.deployment, self.compare.bar):
            bar.play.setChecked(False)
        self.pages.setCurrentWidget(page)
        for switch in (self.before, self.hand, self.plots_switch):
            switch.setVisible(page is self._layout_page)
        self.take_focus()
        self.show_title()
        self.switches_changed.emit()
        self.comparing_changed.emit(self.comparing)
        self.whole_width_wanted.emit(self.wants_whole_width)

    def _toggle_hand(self, on: bool) -> None:
        self.voids.setVisible(on)
        self.view.voids.switch(on)
        self.view.setFocus()
        self.switches_changed.emit()

    def set_editable(self, editable: bool) -> None:
        """Whether there is a design that may be changed by hand now."""
        self.hand.switch.setEnabled(editable)

    @property
    def showing_before(self) -> bool:
        """Whether the design is shown as the generator sampled it."""
        return self._sample is not None and self.before.isChecked()

    def show_entry(self, entry: Entry | None, target: Outline | None, name: str) -> None:
        """Show another design; the angle stays, or starts at the target angle for the first one."""
        first = entry is not None and self.view.design is None and target != self._posed_for
        self._entry, self._target, self._name, self._sample = entry, target, name, None
        self.tour.forget()
        self.deployment.set_ready(entry is not None)
        self._set_switches()
        self._show()
        if entry is not None and first:
            self.view.fit()
            self.deployment.set_phi(entry.design.phi_target)
            self._posed_for = target
        if self.before.isChecked():
            self.before_wanted.emit(True)

    def show_sample(self, candidate: Candidate, sample: Entry) -> None:
        """Show how the design on the stage was sampled, if that is still wanted."""
        if self.before.isChecked() and self._entry is not None and self._entry.candidate == candidate:
            self._sample = sample
            self._show()

    def show_as_cut(self, state: AsCutState) -> None:
        """Show what is known of the design as cut."""
        self._as_cut = state
        self._tell_as_cut()

    def _tell_as_cut(self) -> None:
        """The sample of a design is not cut: nothing is said of it."""
        state = UNKNOWN if self._sample is not None else self._as_cut
        jam = 0.0 if state.sheet is None else state.sheet.as_cut.jam_phi
        self.as_cut.show_state(state)
        self.view.show_as_cut(state.sheet)
        self.plots.show_as_cut(state.sheet)
        if (jam or None) != self.deployment.slider.jam:
            self.deployment.set_jam(jam or None)
            self.switches_changed.emit()

    def show_trimming(self, busy: bool) -> None:
        """The design is being trimmed, or no longer."""
        self._trimming = busy
        self._set_switches()

    def set_trimmable(self, trimmable: bool) -> None:
        """Whether a design may be trimmed now."""
        self._trimmable = trimmable
        self._set_switches()

    def set_name(self, name: str) -> None:
        """The same design is called otherwise now."""
        if name != self._name:
            self._name = name
            self.show_title()

    def _toggle_before(self, on: bool) -> None:
        self._sample = None
        self._show()
        self.before_wanted.emit(on)
        self.switches_changed.emit()

    def _set_switches(self) -> None:
        candidate = None if self._entry is None else self._entry.candidate
        comparable = candidate is not None and candidate.sampled_sheet is not None
        trimmed = candidate is not None and candidate.trim is not None
        before, trim = self.before.switch, self.trim.switch
        before.setEnabled(comparable)
        never = NEVER_SAMPLED if candidate is not None and candidate.polished else NEVER_POLISHED
        before.setToolTip(tr(BEFORE if comparable or candidate is None else never))
        with QSignalBlocker(before):
            before.setChecked(comparable and before.isChecked())
        trim.setEnabled(candidate is not None and self._target is not None and self._trimmable)
        trim.setToolTip(tr(TRIMMING if self._trimming else UNTRIM if trimmed else TRIM))
        trim.setChecked(trimmed or self._trimming)
        self.switches_changed.emit()

    def _show_ends(self) -> None:
        """Say what the design starts as and what it opens into, on a sheet as wide as it is cut."""
        entry, target = self._sample or self._entry, self._target
        if entry is None or target is None:
            self.ends.show_states(None)
        else:
            known = None if self._sample is not None else self._known
            self.ends.show_states(TwoStates.of(entry.candidate, entry.design, target, self._width_mm, known))

    def _show(self) -> None:
        """Show the present design, or its sample."""
        entry = self._entry
        self.show_title()
        self._show_ends()
        if entry is None:  # the target that designs are made for
            self.view.show_design(None, None, self._target)
            return
        shown = self._sample or entry
        # Contacts and the second target's pose are known of the sheet that was scored; the one that was fitted for
        # trimming is free of contacts.
        whole, second = shown.candidate.final_sheet == shown.candidate.sheet, shown.candidate.second
        score = shown.candidate.score if whole else None
        contact = None if score is None else score.contact
        self.view.show_design(shown.design, score, self._target, second if whole else None)
        self.deployment.set_marks(
            shown.design.phi_target,
            None if contact is None else contact.phi,
            None if second is None else second.target.phi,
        )
        self.plots.set_target(shown.design.phi_target)
        self._tell_as_cut()

    def show_made(self, made: Planned | MadePieces | None) -> None:
        """Draw pieces and tiles of a design whose cuts are planned, and name them in the header."""
        self.view.show_pieces(made.on_board if isinstance(made, MadePieces) else None)
        self.view.show_tiles(made.layers if isinstance(made, Planned) else None)
        self.show_title()

    def show_known(self, known: AsCut | None) -> None:
        """Show the match of a design as it is known now: of its pieces once they were put together."""
        if known is not self._known:
            self._known = known
            self.show_title()
            self._show_ends()

    def show_limit(self, text: str) -> None:
        """Say beside the match what no closed sheet shows of the target; "" for nothing."""
        if text != self._limit:
            self._limit = text
            self.show_title()

    def show_title(self) -> None:
        """Show what the header says of the design."""
        entry, name = self._entry, self._name
        alone = tr("Layout") if entry is None or not name else tr("Design {name}", name=name)
        self.title.setText(tr("Comparison") if self.comparing else alone)
        self.numbers.set_texts(*self._texts())
        limit = [self._limit] if self._limit else []
        about = "" if entry is None else described(entry.candidate, name, self._known)
        self.numbers.setToolTip("\n".join([about, *limit]) if about else "")
        self._fit_numbers()

    def _texts(self) -> tuple[str, ...]:
        """What the header says, longest first."""
        if self.comparing:
            return self.compare.summary
        sample = None if self._sample is None else self._sample.candidate
        return () if self._entry is None else score_texts(self._entry.candidate, sample, self._width_mm, self._known)

    def _fit_numbers(self) -> None:
        """Put the longest text that fits into the header; none fits beside many buttons in a narrow stage."""
        optional = [self.toggles[overlay] for overlay, _, _ in reversed(OVERLAYS)]
        switches = (self.before, self.hand, self.overlays_button, self.plots_switch)
        buttons = [self.trim, *switches, *optional, self.whole]
        used = sum(button.sizeHint().width() + self.header.spacing() for button in buttons) + 14
        title = min(self.title.sizeHint().width(), round(TITLE_SHARE * self.width()))
        room = self.width() - 2 * INSET - used - title - GAP
        for button in (self.whole, *optional):  # keys, menus and the double-click stay
            fits = room + GAP >= 2 * self.header.spacing()
            button.setVisible(fits)
            room += 0 if fits else button.sizeHint().width() + self.header.spacing()
        fitted = self.numbers.fit(room)
        texts = self._texts()
        special = self._sample is not None or (self._entry is not None and self._entry.candidate.trim is not None)
        self.view.set_caption(texts[0] if special and texts and not fitted else "")

    def set_sheet_width(self, width_mm: float) -> None:
        """Set the width of the flat sheet, mm."""
        self._width_mm = width_mm
        self.view.set_sheet_width(width_mm)
        self.plots.set_sheet_width(width_mm)
        self.show_title()
        self._show_ends()

    def _toggle_plots(self, on: bool) -> None:
        self.plots.setVisible(on)
        self._place_plots()
        self.switches_changed.emit()

    def _place_plots(self) -> None:
        """At the side of the layout in a wide stage, below it in a narrow one."""
        side = Qt.Orientation.Horizontal if self.width() >= WIDE else Qt.Orientation.Vertical
        if self.split.orientation() is not side:
            self.split.setOrientation(side)
            size = self.split.size()
            length, share = (size.width(), 0.38) if side is Qt.Orientation.Horizontal else (size.height(), 0.4)
            self.split.setSizes([round((1.0 - share) * length), round(share * length)])

    def restore(self, settings: QSettings) -> None:
        """Play, and show plots, as the last time."""
        self.deployment.restore(settings)
        sizes = settings.value("plotsSplit")
        if isinstance(sizes, QByteArray):
            self.split.restoreState(sizes)
        self.plots_switch.switch.setChecked(settings.value("plots") == "yes")

    def remember(self, settings: QSettings) -> None:
        """Keep how it is played and whether plots are shown for the next time."""
        self.deployment.remember(settings)
        settings.setValue("plots", "yes" if self.plots_switch.isChecked() else "no")
        settings.setValue("plotsSplit", self.split.saveState())

    def minimumSizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        """Leave out the buttons that go where there is no room."""
        whole, spacing = super().minimumSizeHint(), self.header.spacing()
        shown = [button for button in (self.whole, *self.toggles.values()) if not button.isHidden()]
        header = whole.width() - sum(button.minimumSizeHint().width() + spacing for button in shown)
        return QSize(max(header, self.pages.minimumSizeHint().width() + 2 * INSET), whole.height())

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        self._fit_numbers()
        super().resizeEvent(event)
        self._place_plots()
        self.ends.set_low(self.height() < LOW)
        self.body.activate()

    def _update_overlays(self) -> None:
        chosen = frozenset(overlay for overlay, switch in self.overlays.items() if switch.isChecked())
        self.view.set_overlays(chosen)
        self.overlays_changed.emit(chosen)


def score_texts(
    candidate: Candidate, sample: Candidate | None, width_mm: float, known: AsCut | None = None
) -> tuple[str, ...]:
    """Figures of a design on a sheet of a width, beside those of its sample if that is shown, longest text first.

    ``known`` is what is known of it as cut.
    """
    score, of_pieces = candidate.score, known is not None and known.of_pieces
    trim = None if of_pieces else candidate.trim  # pieces are cut by rules of their own
    whole = tr("{percent:.1f} %", percent=100 * score.iou_exact)
    if sample is not None:
        before = tr("{percent:.1f} %", percent=100 * sample.score.iou_exact)
        long = tr("before polish: match {before}  ·  after: {match}", before=before, match=whole)
        return long, tr("before {before}  ·  after {match}", before=before, match=whole)
    if trim is not None:
        trimmed = tr("{percent:.1f} %", percent=100 * trim.iou)
        long = tr("match {trimmed}  ·  {match} untrimmed", match=whole, trimmed=trimmed)
        return long, tr("{trimmed}  ·  {match} untrimmed", match=whole, trimmed=trimmed)
    match, variation = 100 * shown_match(candidate, known), 100 * score.evenness.area_cv
    smallest_mm = score.evenness.least_feature_mm(width_mm)
    return (
        tr(
            "match {match:.1f} %   panels ±{variation:.0f} %   smallest {smallest_mm:.1f} mm",
            match=match,
            variation=variation,
            smallest_mm=smallest_mm,
        ),
        tr("match {match:.1f} %   panels ±{variation:.0f} %", match=match, variation=variation),
        tr("match {match:.1f} %", match=match),
    )


class StagePresenter(QObject):
    """Shows the design on the stage, as wide as it would be cut, and what a run leaves of it.

    Parameters
    ----------
    name_of : callable
        What a design is called.
    estimates : AsCutEstimates
        What is known of designs as cut.
    """

    facts_changed = Signal(str)  #: what the status line says of the design

    def __init__(
        self,
        panel: StagePanel,
        session: Session,
        *,
        curves: CurveReader,
        grips: GripFinder,
        name_of: Callable[[Candidate | None], str],
        estimates: AsCutEstimates,
    ) -> None:
        super().__init__(panel)
        self._panel, self._session, self._curves, self._name_of = panel, session, curves, name_of
        self._estimates, self._facts = estimates, ""
        self._running = False
        panel.plots_switch.switch.toggled.connect(curves.want)
        panel.status.connect(session.set_status)
        panel.overlays_changed.connect(lambda shown: grips.want(Overlay.GRIPS in shown))
        curves.grown.connect(panel.plots.show_curves)
        grips.changed.connect(panel.view.show_grips)
        estimates.changed.connect(self._show_known)
        estimates.judged.connect(self._show_known)
        self.show_document()
        self.show_design(None)

    def show_run(self) -> None:
        """A run has begun: its target is shown, then the best design so far."""
        self._running = True
        self._panel.set_trimmable(False)
        self._show_hint()

    def show_idle(self) -> None:
        """No run is in progress."""
        self._running = False
        self._panel.set_trimmable(True)
        self._show_hint()

    def _show_hint(self) -> None:
        """Say what to do next while there is no design."""
        set_hint, target = self._panel.view.set_hint, self._session.document.target
        if self._running:
            set_hint("generate", tr("Generating …"), tr("The best design so far appears here."))
        elif target is not None:
            set_hint("generate", tr("Ready to design"), tr("Press Generate (Ctrl+G)."))
        else:
            set_hint("target", tr("Start with a target"), tr("Draw a shape, open a file, or take a silhouette."))
        self._panel.show_target(target)

    def show_document(self) -> None:
        """The document has changed."""
        self._show_width()
        self._show_hint()
        limit = limit_of(self._session.document)
        self._panel.show_limit("" if limit is None else limit.text)

    def show_design(self, entry: Entry | None) -> None:
        """Another design is chosen, or none."""
        target, candidate = self._session.document.target, None if entry is None else entry.candidate
        self._show_width()
        self._panel.show_entry(entry, target, self._name_of(candidate))
        self._curves.show(None if entry is None else entry.design, target)
        self._show_known()

    def _show_known(self) -> None:
        """Say of the design on the stage what is known of it by now."""
        entry = self._session.stage
        known = None if entry is None else self._estimates.as_cut_of(entry.candidate)
        self._panel.show_known(known)
        facts = "" if entry is None else "   ·   ".join(_facts(entry, known))
        if facts != self._facts:
            self._facts = facts
            self.facts_changed.emit(facts)

    def _show_width(self) -> None:
        """The flat sheet is as wide as opens the design on the stage to the size asked for."""
        stage = self._session.stage
        self._panel.set_sheet_width(self._session.width_of(None if stage is None else stage.candidate))


def _facts(entry: Entry, known: AsCut | None) -> list[str]:
    """Facts about a design, with what is known of it as cut, for the status line."""
    (rows, columns), score, trim = entry.candidate.sheet.grid, entry.candidate.score, entry.candidate.trim
    of_pieces = known is not None and known.of_pieces
    facts = [
        tr("{rows} \N{MULTIPLICATION SIGN} {columns} voids", rows=rows, columns=columns),
        tr("even rim") if entry.candidate.final_sheet.has_even_rim else tr("free rim"),
        tr("match {match:.1f} %", match=100 * (shown_match(entry.candidate, known) if of_pieces else score.iou_exact)),
    ]
    flat = shown_flat_match(entry.candidate, known)
    if flat is not None and (of_pieces or entry.candidate.sheet.start is not None):
        share = 100 * flat
        facts.append(tr("{start} {share:.1f} % when flat", start=start_of(entry.candidate), share=share))
    second = entry.candidate.second
    if second is not None:
        shown, angle = second.target.outline.name, math.degrees(second.target.phi)
        share = 100 * second.match.iou_exact
        if trim is None:
            facts.append(tr("{name} {share:.1f} % at {angle:.0f}°", name=shown, share=share, angle=angle))
        else:
            facts.append(tr("{name} {share:.1f} % at {angle:.0f}° untrimmed", name=shown, share=share, angle=angle))
    if entry.candidate.symmetry is not None:
        facts.insert(1, tr("symmetric"))
    if trim is not None and not of_pieces:
        facts.append(tr("trimmed match {match:.1f} %", match=100 * trim.iou))
    return facts if score.feasible else [*facts, tr("overlaps itself")]
