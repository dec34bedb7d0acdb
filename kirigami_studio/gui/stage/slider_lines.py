"""The lines below the slider: its two ends, with a second target between them, and the design as cut."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from PySide6.QtCore import QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPaintEvent
from PySide6.QtWidgets import QAbstractButton, QSizePolicy, QWidget

from kirigami_studio.foundation.arrays import ShapeRings, as_rings
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.stage.as_cut import AsCutState
from kirigami_studio.gui.widgets.card import ElidedLabel
from kirigami_studio.gui.widgets.fitted_text import fitted
from kirigami_studio.gui.widgets.layouts import TOUCH, row
from kirigami_studio.gui.widgets.paths import ink, painter_on
from kirigami_studio.gui.widgets.target_items import paint_start_shape, paint_target_shape
from kirigami_studio.gui.widgets.theme import LIGHT, Palette
from kirigami_studio.gui.widgets.view_transform import Bounds, ViewTransform
from kirigami_studio.studio.two_states import TwoStates

if TYPE_CHECKING:
    from kirigami_studio.studio.as_cut import AsCut

#: Edge of a picture (pixels), and room between it and the words.
PICTURE, GAP = 20, 9


class EndsLine(QWidget):
    """Buttons below the slider; each names an end of the motion, or the second target between them, and goes there."""

    phi_wanted = Signal(float)  #: radians

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.start = EndButton("flatEnd", Qt.AlignmentFlag.AlignLeft)
        self.passed = EndButton("passedState", Qt.AlignmentFlag.AlignHCenter)
        self.target = EndButton("openEnd", Qt.AlignmentFlag.AlignRight)
        row((self.start, 1), (self.passed, 1), (self.target, 1), on=self, spacing=10)
        for button in (self.start, self.passed, self.target):
            button.clicked.connect(lambda _=False, button=button: self.phi_wanted.emit(button.phi))
        self.passed.hide()
        self._named = self._low = False
        self.set_low(False)
        self.show_states(None)

    def show_states(self, states: TwoStates | None) -> None:
        """Name both ends of a design, and what it passes; nothing without one."""
        self._named = states is not None
        self.setVisible(self._named and not self._low)
        if states is None:
            return
        start, target, passed = states.start, states.target, states.passed
        tip = tr("{state}. Click to close the sheet.", state=states.flat_line())
        self.start.show_state(math.pi, start.outline, start.texts(), tip)
        tip = tr("{state}. Click to open the sheet.", state=states.open_line())
        self.target.show_state(states.phi, target.outline, target.texts(), tip)
        self.passed.setVisible(passed is not None)
        if passed is not None:
            tip = tr("{state}. Click to go there.", state=passed.line())
            self.passed.show_state(passed.phi, passed.outline, passed.texts(), tip)

    def set_low(self, low: bool) -> None:
        """Leave room to the drawing in a low panel; the status line tells both matches, too."""
        self._low = low
        policy = self.sizePolicy()
        policy.setRetainSizeWhenHidden(not low)  # else the slider moves when the first design comes
        self.setSizePolicy(policy)
        self.setVisible(self._named and not self._low)


class EndButton(QAbstractButton):
    """A small outline and the longest text that fits, aligned to a side; the start at the left is that of a sheet."""

    def __init__(self, name: str, side: Qt.AlignmentFlag) -> None:
        super().__init__()
        self.setObjectName(name)
        self.phi = math.pi  #: radians; the angle that it goes to
        self._side = side
        self._outline: ShapeRings = None
        self._texts: tuple[str, ...] = ("",)
        self._palette: Palette = LIGHT
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setCursor(Qt.CursorShape.PointingHandCursor)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)

    def show_state(self, phi: float, outline: ShapeRings, texts: tuple[str, ...], tip: str) -> None:
        """Show what there is at an angle (radians): an outline (P, 2), and what is known of it, longest text first."""
        self.phi, self._outline, self._texts = phi, outline, texts
        self.setToolTip(tip)
        self.setAccessibleName(texts[0])
        self.setAccessibleDescription(tip)
        self.update()

    def set_palette(self, palette: Palette) -> None:
        self._palette = palette
        self.update()

    def sizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return QSize(160, max(PICTURE + 4, TOUCH))

    def drawn_text(self) -> str:
        """What is shown at the present width."""
        return fitted(self.fontMetrics(), self._texts, self.width() - PICTURE - GAP - 4)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        if self._outline is None:
            return
        painter = painter_on(self)
        if self.hasFocus() or self.underMouse():
            ink(painter, self._palette.accent if self.hasFocus() else self._palette.border)
            painter.drawRoundedRect(QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5), 5, 5)
        text, at_left, at_right = self.drawn_text(), Qt.AlignmentFlag.AlignLeft, Qt.AlignmentFlag.AlignRight
        left, words = 2.0, QRectF(self.rect()).adjusted(PICTURE + GAP, 0, 0, 0)
        if self._side is at_right:
            left, words = self.width() - PICTURE - 2.0, QRectF(self.rect()).adjusted(0, 0, -PICTURE - GAP, 0)
        elif self._side is not at_left:
            left = max(left, 0.5 * (self.width() - PICTURE - GAP - self.fontMetrics().horizontalAdvance(text)))
            words.setLeft(left + PICTURE + GAP - 2.0)
        is_sheet = self._side is at_left
        paint_end(painter, QRectF(left, 2.0, PICTURE, PICTURE), self._outline, is_sheet, self._palette)
        painter.setPen(QColor(self._palette.muted))
        aligned = at_right if self._side is at_right else at_left
        painter.drawText(words, int(aligned | Qt.AlignmentFlag.AlignVCenter), text)
        painter.end()


def paint_end(painter: QPainter, box: QRectF, outline: ShapeRings, sheet: bool, palette: Palette) -> None:
    """Draw an outline (P, 2), y up, as large as fits: a sheet is blue, a target orange."""
    transform = ViewTransform.fitting(Bounds.of(as_rings(outline)[0]), box, 1.0)
    paint = paint_start_shape if sheet else paint_target_shape
    paint(painter, transform.rings_to_pixels(outline), palette, 1.4)


#: A sheet that is meant for an angle (radians) below this is meant to close.
CLOSED = math.radians(0.5)


class AsCutLine(ElidedLabel):
    """Shows the line, with the figures behind it as a tooltip."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("asCut")
        self.setAccessibleDescription(tr("As cut"))
        self.setFixedHeight(self.fontMetrics().height() + 2)

    def show_state(self, state: AsCutState) -> None:
        """Say what is known."""
        if state.sheet is not None:
            found = state.sheet.as_cut
            self.setText(*texts(found))
            self.setToolTip(figures(found))
        elif state.busy:
            self.setText(tr("Closing the sheet as cut …"))
        else:
            self.setText(state.problem)


def texts(found: AsCut) -> tuple[str, ...]:
    """What was found, longest text first."""
    from kirigami_studio.studio.as_cut import Outcome

    phi, jam, match = math.degrees(found.phi), found.jam_deg, found.iou
    if found.closes:
        if match is None:
            return (tr("Closes as cut") if found.phi < CLOSED else tr("Opens to {phi:.0f}° as cut", phi=phi),)
        if found.phi < CLOSED:
            return (tr("Closes as cut: {match:.1f} %", match=100 * match),)
        return (tr("Opens to {phi:.0f}° as cut: {match:.1f} %", phi=phi, match=100 * match),)
    if found.nearly_closes:
        near = tr("Comes to {jam:.0f}° as cut", jam=jam)
        return (near if match is None else tr("Comes to {jam:.0f}° as cut: {match:.1f} %", jam=jam, match=100 * match),)
    short = tr("Jams at {jam:.0f}°", jam=jam)
    if found.outcome is Outcome.TOUCHING:
        return tr("Jams at {jam:.0f}°: panels touch", jam=jam), short
    long = tr(
        "Jams at {jam:.0f}°: a connector would stretch by {stretch:.1f} of its width", jam=jam, stretch=found.stretch
    )
    return long, short


def figures(found: AsCut) -> str:
    """The figures behind the verdict, one in each line."""
    from kirigami_studio.fabricate.strain import StrainFigure

    lines = [texts(found)[0]]
    if found.iou is not None and found.ideal_iou is not None:
        lines.append(
            tr(
                "Match as cut, at {reached:.0f}°: {match:.1f} %; ideal, with connectors of no width: {ideal:.1f} %",
                reached=math.degrees(found.reached),
                match=100 * found.iou,
                ideal=100 * found.ideal_iou,
            )
        )
    lines.append(tr("Largest stretch: {stretch:.2f} of a connector's width", stretch=found.stretch))
    if found.figure is StrainFigure.OUT_OF_PLANE:
        strain = tr("Largest strain: {strain:.0f} % (thin sheet: it bends out of the plane)", strain=100 * found.strain)
    else:
        strain = tr("Largest strain: {strain:.0f} % (thick sheet: it bends in the plane)", strain=100 * found.strain)
    lines.append(strain)
    lines.append(
        tr(
            "Simulated with this material, width and connectors. Friction, plastic set and motion out of the "
            "plane are not modelled."
        )
    )
    return "\n".join(lines)
