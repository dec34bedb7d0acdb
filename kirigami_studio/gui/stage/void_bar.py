"""Voids changed by hand: the row under the layout, and the presenter of gestures and row."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject, QPoint, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QAction, QKeyEvent, QResizeEvent
from PySide6.QtWidgets import QAbstractButton, QLabel, QMenu, QToolButton, QWidget

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.stage.edge_cuts import MouthFacts
from kirigami_studio.gui.stage.hand_editor import LARGEST, SMALLEST, HandEditor
from kirigami_studio.gui.stage.layout_view import LayoutView
from kirigami_studio.gui.stage.void_items import VoidFacts
from kirigami_studio.gui.widgets.card import FittingLabel, ToolButton
from kirigami_studio.gui.widgets.layouts import row
from kirigami_studio.gui.widgets.number_field import DecimalField, decimal_field
from kirigami_studio.project.document import Void


class VoidBar(QWidget):
    """Shows the selected voids and reports what to do with them."""

    ratio_wanted = Signal(frozenset, float)  #: of Void; ratio
    lock_wanted = Signal(frozenset, bool)  #: of Void; whether they are to be locked
    all_wanted = Signal(bool)  #: whether every void is to be locked

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._voids: frozenset[Void] = frozenset()
        self.selection_text = FittingLabel()
        self.ratio = decimal_field(
            DecimalField,
            "voidRatio",
            SMALLEST,
            LARGEST,
            decimals=4,
            step=0.02,
            accessible=tr("Ratio of the selected void"),
            tip=tr("Ratio x of the selected void, 0.1 to 10: lower left edge divided by upper left edge."),
            width=104,
        )
        self.ratio.setPrefix("x ")
        self.lock = ToolButton(
            "lockVoid",
            "lock",
            tr("Lock (L). Keeps the ratio in manual edits and Fit again; Generate makes new designs."),
            checkable=True,
        )
        self.all = QToolButton()
        self.all.setObjectName("lockMany")
        self.all.setText(tr("All \N{BLACK DOWN-POINTING SMALL TRIANGLE}"))
        self.all.setToolTip(tr("Lock or unlock every void."))
        self.all.setAccessibleName(tr("Lock or unlock every void"))
        self.all.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.all.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        menu = QMenu(self.all)
        self.lock_all = menu.addAction(tr("Lock all voids"))
        self.unlock_all = menu.addAction(tr("Unlock all voids"))
        self.all.setMenu(menu)
        self.refit = ToolButton(
            "refit",
            "refit",
            tr("Fit again (Ctrl+F). Improves the match from here; locked voids stay, a trim is redone."),
            checkable=True,
        )
        row(self.selection_text, ..., self.ratio, self.lock, self.all, self.refit, on=self, spacing=6)
        self.ratio.valueChanged.connect(lambda ratio: self.ratio_wanted.emit(self._voids, ratio))
        self.lock.clicked.connect(lambda on: self.lock_wanted.emit(self._voids, on))
        self.lock_all.triggered.connect(lambda: self.all_wanted.emit(True))
        self.unlock_all.triggered.connect(lambda: self.all_wanted.emit(False))
        self.show_voids(frozenset(), None, frozenset())

    def show_voids(self, voids: frozenset[Void], ratio: float | None, locked: frozenset[Void]) -> None:
        """Show what is selected; ``ratio`` is that of the first one, None where there is no design."""
        self._voids = voids
        ready = bool(voids) and ratio is not None
        fixed = bool(voids) and voids <= locked
        self.ratio.setEnabled(ready and not fixed)
        self.lock.setEnabled(ready)
        self.lock.setChecked(fixed)
        self.all.setEnabled(ratio is not None)
        self.refit.setEnabled(ratio is not None)
        with QSignalBlocker(self.ratio):
            # It is shown in the place of the smallest value, at which the field rests while nothing is selected.
            self.ratio.setSpecialValueText("" if ready else "x \N{EN DASH}")
            self.ratio.setValue(ratio if ready and ratio is not None else self.ratio.minimum())
        self.selection_text.set_texts(*_selection_texts(voids, locked))
        self._fit()

    def show_mouth(self, name: str, short: str) -> None:
        """An edge cut is selected instead of voids."""
        self.selection_text.set_texts(tr("{name}: drag it, or press the arrow keys", name=name), name, short)
        self._fit()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        super().resizeEvent(event)
        self._fit()

    def _fit(self) -> None:
        others = (self.ratio, self.lock, self.all, self.refit)
        self.selection_text.fit(self.width() - sum(part.width() + 6 for part in others) - 8)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        """Enter in the number field is for the number, not for the window."""
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            event.accept()
        else:
            super().keyPressEvent(event)


def _selection_texts(voids: frozenset[Void], locked: frozenset[Void]) -> tuple[str, ...]:
    """What the row says, longest first."""
    if len(voids) == 1:
        ((down, right),) = voids
        short = tr("Row {row}, column {column}", row=down, column=right)
        if voids <= locked:
            long = tr("Void in row {row}, column {column}: locked (L unlocks)", row=down, column=right)
        else:
            long = tr("Void in row {row}, column {column}: drag, scroll, or press + and -", row=down, column=right)
        return long, short, f"({down}, {right})"
    if voids:
        return (tr_n("{count} void", "{count} voids", len(voids)),)
    hint = tr("Drag a void, an outline corner or an edge cut; scroll to change a ratio")
    if locked:
        count = tr_n("{count} void locked", "{count} voids locked", len(locked))
        return tr("{hint}  ·  {count}", hint=hint, count=count), count
    return hint, tr("Drag a void or the outline")


class VoidPresenter(QObject):
    """Lets the hand editor do what gestures and the bar ask for, and shows what came of it.

    Parameters
    ----------
    play : QAbstractButton
        Is let go when a drag begins.
    status : QLabel
        Tells of the void that is pointed at.
    running, showing_before : callable
        Whether a run goes on, and whether the design is shown as it was sampled: then nothing is changed by hand.
    command : callable
        The action of a command, by its id.
    """

    editable = Signal(bool)  #: whether there is a design that may be changed by hand now

    def __init__(
        self,
        view: LayoutView,
        bar: VoidBar,
        play: QAbstractButton,
        status: QLabel,
        session: Session,
        *,
        hand: HandEditor,
        running: Callable[[], bool],
        showing_before: Callable[[], bool],
        command: Callable[[str], QAction],
    ) -> None:
        super().__init__(view)
        self._view, self._gestures, self._bar, self._play, self._status = view, view.voids, bar, play, status
        self._session, self._hand, self._running = session, hand, running
        self._showing_before, self._command = showing_before, command
        self._void_facts, self._status_before = "", ""
        self.menu: QMenu | None = None
        self._connect()
        self.refresh()

    def _connect(self) -> None:
        gestures, hand, bar = self._gestures, self._hand, self._bar
        gestures.hovered.connect(self._describe)
        gestures.selection_changed.connect(self.refresh)
        gestures.nudged.connect(hand.nudge)
        for begun, begin in (
            (gestures.pull_begun, hand.begin_drag),
            (gestures.vertex_begun, hand.begin_vertex),
            (gestures.rim.grasped, hand.begin_mouth),
        ):
            begun.connect(self._pause)
            begun.connect(begin)
        gestures.dragged.connect(hand.drag)
        gestures.rim.hovered.connect(self._describe_mouth)
        gestures.rim.selection_changed.connect(self.refresh)
        gestures.rim.nudged.connect(hand.nudge_mouth)
        gestures.drag_ended.connect(hand.release)
        gestures.drag_cancelled.connect(hand.cancel)
        gestures.lock_wanted.connect(hand.lock)
        gestures.menu_wanted.connect(self._show_menu)
        hand.drafted.connect(self._show_draft)
        bar.ratio_wanted.connect(hand.set_ratio)
        bar.lock_wanted.connect(hand.lock)
        bar.all_wanted.connect(hand.lock_all)

    @property
    def _width_mm(self) -> float:
        """Width of the flat sheet of the design on the stage."""
        stage = self._session.stage
        return self._session.width_of(None if stage is None else stage.candidate)

    def _pause(self) -> None:
        """Stop playing, so that the angle stays the same during a drag."""
        self._play.setChecked(False)

    def refresh(self) -> None:
        """The document, the stage or the mode has changed."""
        document = self._session.document
        ready = document.candidate is not None and not self._running()
        self._gestures.set_locked(document.locked)
        self._gestures.enable(ready and not self._showing_before())
        self.editable.emit(ready)
        sheet = self._hand.sheet if ready else None
        chosen = min(self._gestures.selected, default=(0, 0))
        fits = sheet is not None and chosen[0] < sheet.rows and chosen[1] < sheet.columns
        ratio = float(sheet.field.ratio[chosen]) if sheet is not None and fits else None
        self._bar.show_voids(self._gestures.selected, ratio, document.locked)
        mouth, meant = self._gestures.rim.selected, self._gestures.rim.meant
        if sheet is not None and mouth is not None:
            facts = MouthFacts.of(sheet, mouth, self._width_mm)
            self._bar.show_mouth(facts.name, facts.short_name)
        if self._gestures.void is not None:
            self._describe(self._gestures.void)
        elif meant is not None:
            self._describe_mouth(meant)

    def _show_draft(self, design: PosedDesign) -> None:
        self._view.show_draft(design)
        self.refresh()

    # the label at the pointer --------------------------------------------------------------------------------------

    def _describe(self, void: Void | None) -> None:
        design = self._view.design
        if void is None or design is None:
            self._gestures.lines = ()
            if self._status.text() == self._void_facts and self._void_facts:
                self._status.setText(self._status_before)
            self._void_facts = ""
            return
        document = self._session.document
        width, locked = self._width_mm, void in document.locked
        facts = VoidFacts.of(design.deployment, void, self._view.phi, width, locked)
        self._gestures.lines = facts.lines()
        self._tell(facts.sentence())

    def _tell(self, sentence: str) -> None:
        """Show what is pointed at in the status line; the text before comes back when nothing is."""
        if self._running():  # the line tells how far the run is
            return
        if self._status.text() != self._void_facts or not self._void_facts:
            self._status_before = self._status.text()
        self._void_facts = sentence
        self._status.setText(sentence)

    def _describe_mouth(self, mouth: int | None) -> None:
        """Tell where an edge cut is that is pointed at."""
        design = self._view.design
        if mouth is None or design is None:
            self._describe(None)
            return
        width = self._width_mm
        facts = MouthFacts.of(design.deployment.sheet, mouth, width)
        self._gestures.lines = facts.lines()
        self._tell(facts.sentence())

    # locks and fit -------------------------------------------------------------------------------------------------

    def toggle_lock(self) -> None:
        """Lock the selected voids, or the one under the pointer; unlock them when all are locked."""
        here = self._gestures.void
        voids = self._gestures.selected or (frozenset() if here is None else frozenset({here}))
        if voids:
            self._hand.lock(voids, not voids <= self._session.document.locked)
        else:
            self._session.set_status(tr("Point at a void or select some, then press L to lock them."))

    def _show_menu(self, void: Void, place: QPoint) -> None:
        voids, locked = self._gestures.selected, self._session.document.locked
        self.menu = QMenu(self._view)
        lock = self.menu.addAction(tr("Unlock") if voids <= locked else tr("Lock"))
        lock.triggered.connect(self.toggle_lock)
        even = self.menu.addAction(tr("Set ratio to 1"))
        even.setEnabled(not voids <= locked)
        even.triggered.connect(lambda: self._hand.set_ratio(voids, 1.0))
        self.menu.addSeparator()
        for name in ("lock_all", "unlock_all", "even_rim", "refit"):
            self.menu.addAction(self._command(name))
        self.menu.aboutToHide.connect(self.menu.deleteLater)
        self.menu.popup(place)
