"""Which connectors are selected, by which rule, and their width: own, cut through, or the usual one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QKeyEvent, QResizeEvent
from PySide6.QtWidgets import QHBoxLayout, QMenu, QToolButton, QWidget

from kirigami_studio.fabricate.cut_plan import CutPlan, Layer
from kirigami_studio.fabricate.slits import SHEET_EDGE
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.words import mark, tr, tr_n
from kirigami_studio.gui.widgets.card import FittingLabel, ToolButton
from kirigami_studio.gui.widgets.number_field import LengthField, names_length, number_field

#: Which connectors of a plan are meant.
Rule = Callable[[CutPlan], frozenset[int]]
WIDTH_TIP = mark("Finished width of the selected connectors, mm (0.02 to 20).")
#: The part of all connectors that counts as being at short or at long cuts.
QUARTER = 0.25


def every_hinge(plan: CutPlan) -> frozenset[int]:
    """All connectors."""
    return frozenset(range(len(plan.hinges)))


def edge_hinges(plan: CutPlan) -> frozenset[int]:
    """Connectors beside the sheet's edge: of slits that end there, and of cuts that open there."""
    opening = [path.cut for path in plan.on_layer(Layer.EDGE_SLITS)]
    hinges = plan.hinges
    return _numbers((hinges.through == SHEET_EDGE) | np.isin(hinges.cut, opening))


def hinges_of_short_cuts(plan: CutPlan) -> frozenset[int]:
    """The quarter of all connectors whose cuts are shortest: those of the small panels."""
    length = _cut_lengths(plan)
    return _numbers(length <= np.quantile(length, QUARTER))


def hinges_of_long_cuts(plan: CutPlan) -> frozenset[int]:
    """The quarter of all connectors whose cuts are longest: those of the large panels."""
    length = _cut_lengths(plan)
    return _numbers(length >= np.quantile(length, 1.0 - QUARTER))


def _cut_lengths(plan: CutPlan) -> FloatArray:
    """Length (mm) of the cut that each hinge shortens: (H,); of a cut in several parts, of all together."""
    lengths = np.zeros(int(plan.hinges.cut.max()) + 1)
    for path in plan.paths:
        if path.cut >= 0 and path.layer is not Layer.RELIEF:
            lengths[path.cut] += path.length
    chosen: FloatArray = lengths[plan.hinges.cut]
    return chosen


def _numbers(chosen: BoolArray) -> frozenset[int]:
    return frozenset(np.flatnonzero(chosen).tolist())


#: Menu text, tooltip, rule.
RULES: tuple[tuple[str, str, Rule], ...] = (
    (mark("&All connectors"), mark("Select every connector of the sheet"), every_hinge),
    (mark("&Edge connectors"), mark("Select the connectors along the sheet's edge"), edge_hinges),
    (mark("On &short cuts"), mark("Select the quarter of connectors on the shortest cuts"), hinges_of_short_cuts),
    (mark("On &long cuts"), mark("Select the quarter of connectors on the longest cuts"), hinges_of_long_cuts),
)


class HingeBar(QWidget):
    """Shows how many connectors are selected and reports what to do with them."""

    selected = Signal(frozenset)  #: numbers of connectors, by a rule
    width_wanted = Signal(float)  #: mm
    remove_wanted = Signal()
    reset_wanted = Signal()
    edited = Signal()  #: the number was left

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._plan: CutPlan | None = None
        self.rules = QToolButton()
        self.rules.setObjectName("hingeRules")
        self.rules.setText(tr("Select ▾"))
        self.rules.setToolTip(tr("Select connectors by rule, or click them in the drawing."))
        self.rules.setAccessibleName(tr("Select connectors by rule"))
        self.rules.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.rules.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        menu = QMenu(self.rules)
        menu.setToolTipsVisible(True)
        self.choices = []
        for text, tip, rule in RULES:
            action = menu.addAction(tr(text))
            action.setToolTip(tr(tip))
            action.triggered.connect(lambda _=False, rule=rule: self._apply(rule))
            self.choices.append(action)
        self.rules.setMenu(menu)
        self.selection_text = FittingLabel()
        self.width_mm = LengthField()
        self.width_mm.setObjectName("hingeWidth")
        self.width_mm.setRange(0.02, 20.0)
        self.width_mm.setSingleStep(0.05)
        self.width_mm.setDecimals(3)
        self.width_mm.setSuffix(tr(" mm"))
        self.width_mm.setKeyboardTracking(False)
        self.width_mm.setToolTip(tr(WIDTH_TIP))
        self.width_mm.setAccessibleName(tr("Width of the selected connectors in millimetres"))
        self.width_mm.setFixedWidth(108)
        number_field(self.width_mm)
        names_length(self.width_mm)
        self.remove = ToolButton("removeHinges", "sever", tr("Cut through: leave no connector here (Delete)."))
        self.reset = ToolButton("resetHinges", "reset", tr("Reset to the sheet's connector width."))
        self._lay_out()
        self.width_mm.valueChanged.connect(self.width_wanted)
        self.width_mm.editingFinished.connect(self.edited)
        self.remove.clicked.connect(self.remove_wanted)
        self.reset.clicked.connect(self.reset_wanted)
        self.show_selection(None, frozenset())

    def _lay_out(self) -> None:
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(6)
        row.addWidget(self.rules)
        row.addWidget(self.selection_text)
        row.addStretch(1)
        for part in (self.width_mm, self.remove, self.reset):
            row.addWidget(part)

    def show_selection(self, plan: CutPlan | None, hinges: frozenset[int]) -> None:
        """Show what is selected; the number is what these connectors were asked to be."""
        self._plan = plan
        self.rules.setEnabled(plan is not None)
        for part in (self.width_mm, self.remove, self.reset):
            part.setEnabled(bool(hinges) and plan is not None)
        cut = hinges & set(plan.options.removed) if plan is not None else frozenset()
        self.selection_text.set_texts(*_selection_texts(hinges, len(cut)))
        self._fit()
        if plan is not None:
            there = [hinge for hinge in sorted(hinges) if hinge not in plan.options.removed]
            asked = plan.hinges.asked_mm[there[0]] if there else plan.connector_mm
            with QSignalBlocker(self.width_mm):
                self.width_mm.setValue(float(asked))
        if plan is not None and hinges:
            own = {hinge for hinge, _ in plan.options.hinge_mm} | set(plan.options.removed)
            self.reset.setEnabled(bool(own & hinges))
            self.remove.setEnabled(cut != hinges)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        super().resizeEvent(event)
        self._fit()

    def _fit(self) -> None:
        """Show the longest text on the selection that fits."""
        others = (self.rules, self.width_mm, self.remove, self.reset)
        self.selection_text.fit(self.width() - sum(part.sizeHint().width() + 6 for part in others) - 8)

    def type_width(self, letter: str) -> None:
        """Start typing a width with this letter."""
        self.width_mm.setFocus(Qt.FocusReason.ShortcutFocusReason)
        self.width_mm.lineEdit().setText(letter)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        """Enter in the number field is for the number, not for the window."""
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            event.accept()
        else:
            super().keyPressEvent(event)

    def _apply(self, rule: Rule) -> None:
        if self._plan is not None:
            self.selected.emit(rule(self._plan))


def _selection_texts(hinges: frozenset[int], cut: int) -> tuple[str, ...]:
    """What the row says of the selected connectors, ``cut`` of them cut through; longest first."""
    if not hinges:
        return (tr("No connector selected"), tr("No connector"))
    count, number = len(hinges), min(hinges)
    if count == 1:
        named = tr("Connector {number}", number=number)
        return (
            (tr("Connector {number}: cut through", number=number), named, f"{number}") if cut else (named, f"{number}")
        )
    named = tr_n("{count} connector", "{count} connectors", count)
    if not cut:
        return named, f"{count}"
    return tr("{cut} of {count} cut through", cut=cut, count=count), named, f"{count}"
