"""The banner below the stage: what is to be expected of the sheet as it is cut now, and fixes that were tried."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QFrame, QGridLayout, QHBoxLayout, QLabel, QMenu, QPushButton, QSizePolicy, QWidget

from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.gui.make.verdict import VerdictState
from kirigami_studio.gui.widgets import icons
from kirigami_studio.gui.widgets.announcing import announce
from kirigami_studio.gui.widgets.card import ElidedLabel
from kirigami_studio.gui.widgets.fitted_text import elided
from kirigami_studio.gui.widgets.layouts import TOUCH
from kirigami_studio.gui.widgets.theme import LIGHT, Palette
from kirigami_studio.gui.widgets.verdict_marks import ICONS, colour_of, level_of

if TYPE_CHECKING:
    from kirigami_studio.studio.fixes import Fix

#: Most of the banner's width that fixes may take.
SHARE = 0.62
#: Pixels beside headline and fixes: margins, icon, gaps.
BESIDE = 64
#: Lines of the worst problem, and the share of them that is used: what is left of one when words wrap is lost.
LINES, LINE_USED = 2, 0.9
ICON_EDGE = 20


class VerdictBar(QFrame):
    """Keeps its height: a line for the level with its fixes, then the worst problem; the tooltip has all of it."""

    fix_wanted = Signal(object)  #: Fix

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("verdictBar")
        self._palette: Palette = LIGHT
        self._state = VerdictState()
        self.setAccessibleName(tr("Verdict on the sheet as cut"))
        self.icon = QLabel()
        self.icon.setFixedSize(ICON_EDGE, ICON_EDGE)
        self.headline = ElidedLabel(Qt.TextElideMode.ElideRight)
        self.headline.setObjectName("verdictLevel")
        self.sentence = QLabel()
        self.sentence.setObjectName("muted")
        self.sentence.setWordWrap(True)
        self.sentence.setAlignment(Qt.AlignmentFlag.AlignTop | Qt.AlignmentFlag.AlignLeft)
        self.sentence.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.sentence.setFixedHeight(LINES * self.sentence.fontMetrics().lineSpacing() + 2)
        self.more = QPushButton(tr("More fixes"))
        self.more.setObjectName("small")
        self.more.setToolTip(tr("More changes that were tried on this design and help."))
        self.more.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.menu = QMenu(self.more)
        self.menu.setToolTipsVisible(True)
        self.more.setMenu(self.menu)
        self.buttons: list[QPushButton] = []
        self._row = QHBoxLayout()
        self._row.setSpacing(6)
        self._row.addWidget(self.more)
        self._grid = grid = QGridLayout(self)
        grid.setContentsMargins(10, 4, 6, 4)
        grid.setHorizontalSpacing(8)
        grid.setVerticalSpacing(2)
        grid.addWidget(self.icon, 0, 0)
        grid.addWidget(self.headline, 0, 1)
        grid.addLayout(self._row, 0, 2)
        grid.addWidget(self.sentence, 1, 0, 1, 3)
        grid.setColumnStretch(1, 1)
        # A button is higher than a line of text: room for one is kept, so that nothing moves when fixes are found.
        grid.setRowMinimumHeight(0, TOUCH)
        policy = self.sizePolicy()
        policy.setRetainSizeWhenHidden(True)  # what is above it does not move when the first verdict comes
        self.setSizePolicy(policy)
        self.hide()

    def show_state(self, state: VerdictState) -> None:
        """Show what is known; nothing without a design."""
        self._state = state
        self.setVisible(state.known)
        self._show_words()
        self._show_fixes()

    def _show_words(self) -> None:
        state, verdict = self._state, self._state.verdict
        said = headline(state)
        if said != self.headline.text() and not state.pending:
            announce(self, said)
        self.headline.setText(said, *([] if verdict is None or state.pending else [verdict.words]))
        self.icon.setAccessibleName(said)
        self.setToolTip("\n".join(state.lines))
        self._fit_sentence()
        self.setAccessibleDescription("\n".join(state.lines))
        level = "" if state.pending else level_of(verdict)
        colour = colour_of(level, self._palette)
        self.icon.setPixmap(icons.pixmap(ICONS[level], colour, ICON_EDGE, self.devicePixelRatioF()))
        self.headline.setStyleSheet(f"color: {colour}; font-weight: 600;")
        self.setProperty("level", level)
        self.style().unpolish(self)
        self.style().polish(self)

    def _fit_sentence(self) -> None:
        """Show the worst problem, or the first note, in two lines."""
        margins = self._grid.contentsMargins()
        width = max(self.width() - margins.left() - margins.right() - 2 * self.frameWidth() - 2, 1)
        said, metrics = self._state.lines[1:2], self.sentence.fontMetrics()
        self.sentence.setText(said[0] if said else "")
        if self.sentence.heightForWidth(width) > self.sentence.height():
            self.sentence.setText(elided(metrics, said[0], round(LINE_USED * LINES * width)))

    def _show_fixes(self) -> None:
        for button in self.buttons:
            self._row.removeWidget(button)
            button.hide()
            button.deleteLater()
        fixes = () if self._state.advice is None else self._state.advice.fixes
        self.buttons = [self._button(fix) for fix in fixes]
        for place, button in enumerate(self.buttons):
            self._row.insertWidget(place, button)
        self._fit()

    def _button(self, fix: Fix) -> QPushButton:
        button = QPushButton(_label(fix))
        button.setObjectName("small")
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        button.setToolTip(tip(fix))
        button.clicked.connect(lambda _=False, fix=fix: self.fix_wanted.emit(fix))
        return button

    def _fit(self) -> None:
        """Show as many fixes as there is room for; the others are in a menu."""
        words = self.headline.fontMetrics().horizontalAdvance(self.headline.text())
        room = max(SHARE * self.width(), self.width() - words - BESIDE)
        needed = [button.sizeHint().width() + self._row.spacing() for button in self.buttons]
        if sum(needed) > room:
            room -= self.more.sizeHint().width()
        hidden: list[Fix] = []
        fixes = () if self._state.advice is None else self._state.advice.fixes
        for button, fix, width in zip(self.buttons, fixes, needed, strict=True):
            room -= width
            fits = room >= 0 and not hidden
            button.setVisible(fits)
            if not fits:
                hidden.append(fix)
        self.menu.clear()
        for fix in hidden:
            action = self.menu.addAction(_label(fix))
            action.setToolTip(tip(fix))
            action.triggered.connect(lambda _=False, fix=fix: self.fix_wanted.emit(fix))
        self.more.setText(tr("Fixes") if len(hidden) == len(fixes) else tr("More fixes"))
        self.more.setVisible(bool(hidden))

    def minimumSizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return QSize(0, super().minimumSizeHint().height())

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        super().resizeEvent(event)
        self._fit()
        self._fit_sentence()

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self._palette = palette
        self._show_words()


def headline(state: VerdictState) -> str:
    """The level in words, and what is still being found out."""
    verdict = state.verdict
    if state.pending or verdict is None:
        return tr("Checking the sheet as cut …")
    words = verdict.words
    if state.searching:
        return tr("{level}  ·  trying fixes …", level=words)
    if state.advice is not None and not state.advice.fixes:
        return tr("{level}  ·  nothing that was tried helps", level=words)
    if len(verdict.problems) > 1:
        return tr_n("{level}  ·  {count} problem", "{level}  ·  {count} problems", len(verdict.problems), level=words)
    return words


def tip(fix: Fix) -> str:
    """What was found when a fix was tried."""
    lines = [tr("Tried on this design: {level}.", level=fix.verdict.level_words)]
    lines += [problem.text for problem in fix.verdict.problems]
    if fix.instead:
        lines.append(tr("The designs on this grid go."))
    return "\n".join([*lines, tr("Ctrl+Z takes it back.")])


def _label(fix: Fix) -> str:
    return fix.change.text.rstrip(".")
