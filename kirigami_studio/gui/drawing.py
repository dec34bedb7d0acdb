"""Strokes and corners of the mouse -> a target's outline."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QObject, Signal

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.target.outline import Outline

FloatArray = npt.NDArray[np.float64]


class Drawing(QObject):
    """Makes outlines of what was drawn, or says why there is none."""

    drawn = Signal(object)  #: Outline
    refused = Signal(object)  #: KirigamiError

    def take_freehand(self, points: FloatArray) -> None:
        """Smooth a stroke (L, 2), y up, into a target."""
        from kirigami_studio.target.editing import smooth_freehand

        self._make(lambda: smooth_freehand(points).renamed("drawing"))

    def take_polygon(self, points: FloatArray) -> None:
        """Make corners (L, 2), y up, a target."""
        self._make(lambda: Outline.from_points(points, name="polygon"))

    def _make(self, make: Callable[[], Outline]) -> None:
        try:
            outline = make()
        except KirigamiError as error:
            self.refused.emit(error)
        else:
            self.drawn.emit(outline)
