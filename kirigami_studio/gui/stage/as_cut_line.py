"""One line about the design on the stage as cut: whether it closes, or where it jams and why."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.stage.as_cut import AsCutState
from kirigami_studio.gui.widgets.card import ElidedLabel

if TYPE_CHECKING:
    from kirigami_studio.studio.as_cut import AsCut

#: A sheet that is meant for an angle (radians) below this is meant to close.
CLOSED = math.radians(0.5)


class AsCutLine(ElidedLabel):
    """Shows the line, with the figures behind it as a tooltip."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("asCut")
        self.setAccessibleName(tr("As cut"))
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
        self.setAccessibleDescription(self.text())


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
