"""Mirror while drawing: which axes reflect what is drawn, as a button with a menu."""

from __future__ import annotations

from PySide6.QtGui import QAction, QActionGroup
from PySide6.QtWidgets import QMenu, QToolButton, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.look import icons
from kirigami_studio.gui.look.theme import LIGHT, Palette
from kirigami_studio.gui.panels.card import TOOL_ICON
from kirigami_studio.gui.sketching.sketch_context import SketchContext
from kirigami_studio.outlines.mirroring import Axis


class AxisButton(QToolButton):
    """Shows the axes in use; its menu and Shift+M change them."""

    def __init__(self, context: SketchContext, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._context = context
        self._palette: Palette = LIGHT
        self.setObjectName("axis")
        self.setIconSize(TOOL_ICON)
        self.setAccessibleName(tr("Mirror while drawing"))
        self.setToolTip(
            tr(
                "Mirror while drawing (Shift+M). Shapes, strokes and points are reflected about the dashed axis "
                "through the middle of the target."
            )
        )
        self.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.setCheckable(True)
        menu = QMenu(self)
        group = QActionGroup(self)
        self.choices: dict[Axis, QAction] = {}
        for axis, text in (
            (Axis.NONE, tr("&No mirror")),
            (Axis.UPRIGHT, tr("&Left and right")),
            (Axis.LEVEL, tr("&Top and bottom")),
            (Axis.BOTH, tr("&Both")),
        ):
            choice = menu.addAction(text)
            choice.setCheckable(True)
            choice.triggered.connect(lambda _=False, axis=axis: self.set_axis(axis))
            group.addAction(choice)
            self.choices[axis] = choice
        self.setMenu(menu)
        self.choices[context.mirror.axis].setChecked(True)

    def set_axis(self, axis: Axis) -> None:
        """Mirror about these axes from now on."""
        self._context.set_axis(axis)
        self.choices[axis].setChecked(True)
        self.setChecked(axis is not Axis.NONE)
        self._dress()

    def cycle(self) -> None:
        """Go on to the next choice."""
        axes = list(Axis)
        self.set_axis(axes[(axes.index(self._context.mirror.axis) + 1) % len(axes)])

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self._palette = palette
        self._dress()

    def _dress(self) -> None:
        axis = self._context.mirror.axis
        self.setIcon(icons.icon(f"axis-{axis.value}", self._palette))
        for choice, action in self.choices.items():
            action.setIcon(icons.icon(f"axis-{choice.value}", self._palette))
