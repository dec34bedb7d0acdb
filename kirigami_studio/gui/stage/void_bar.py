"""The row under the layout while it is edited by hand: a void, its ratio, its lock, and what holds for all."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QKeyEvent, QResizeEvent
from PySide6.QtWidgets import QMenu, QToolButton, QWidget

from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.gui.stage.hand_editor import LARGEST, SMALLEST
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
        short = tr("Void ({row}, {column})", row=down, column=right)
        if voids <= locked:
            long = tr("Void ({row}, {column}): locked (L unlocks)", row=down, column=right)
        else:
            long = tr("Void ({row}, {column}): drag, scroll, or press + and -", row=down, column=right)
        return long, short, f"({down}, {right})"
    if voids:
        return (tr_n("{count} void", "{count} voids", len(voids)),)
    hint = tr("Drag a void, an outline corner or an edge cut; scroll to change a ratio")
    if locked:
        count = tr_n("{count} void locked", "{count} voids locked", len(locked))
        return tr("{hint}  ·  {count}", hint=hint, count=count), count
    return hint, tr("Drag a void or the outline")
