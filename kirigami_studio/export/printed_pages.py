"""Pages of a plan for a printer: the lines and words of its PDF, recorded to be drawn again.

:class:`PageRecorder` has the methods of reportlab's canvas that :mod:`~kirigami_studio.export.pdf_pages` calls, so a
printed page and a page of the PDF are drawn by the same code.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kirigami_studio.export.paper import Size, Tiling
from kirigami_studio.export.pdf import draw_plan, pages_of
from kirigami_studio.export.pdf_pages import MM_PER_POINT
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.foundation.arrays import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class PageStroke:
    """A line on a page."""

    points: FloatArray  #: (P, 2), mm from the page's lower left corner
    closed: bool
    colour: tuple[float, float, float]  #: red, green, blue, 0 to 1
    width_mm: float
    dash_mm: tuple[float, ...] = ()  #: on and off; empty for a whole line


@dataclass(frozen=True, slots=True)
class PageText:
    """Words on a page."""

    text: str
    place: tuple[float, float]  #: start of the base line, mm; its middle where the words are ``centred``
    height_mm: float  #: of the font
    centred: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class PrintedPage:
    """All that is on a page."""

    strokes: tuple[PageStroke, ...]
    texts: tuple[PageText, ...]


@dataclass(frozen=True, slots=True, eq=False)
class PrintedPages:
    """A plan on paper."""

    paper: str  #: the paper's key
    tiling: Tiling
    pages: tuple[PrintedPage, ...]  #: a map first where there are several parts

    @property
    def size_mm(self) -> Size:
        """Width and height of each page."""
        return self.tiling.page


def printed_pages(plan: CutPlan, paper: str) -> PrintedPages:
    """Lay a plan over paper and record its pages.

    Raises
    ------
    ExportError
        Unknown paper, or too many pages.
    """
    tiling = pages_of(plan.copies.spread_mm, paper)
    recorder = PageRecorder()
    draw_plan(recorder, plan, tiling)
    return PrintedPages(paper, tiling, tuple(recorder.pages))


class PageRecorder:
    """Records drawing in points, as reportlab takes it, in mm."""

    def __init__(self) -> None:
        self.pages: list[PrintedPage] = []
        self._strokes: list[PageStroke] = []
        self._texts: list[PageText] = []
        self._colour = (0.0, 0.0, 0.0)
        self._width, self._font = 1.0, 10.0  # points
        self._dash: tuple[float, ...] = ()

    def setLineCap(self, _: int) -> None:  # noqa: N802 - reportlab's name
        """All caps are round."""

    def setLineWidth(self, points: float) -> None:  # noqa: N802 - reportlab's name
        self._width = points

    def setStrokeColorRGB(self, red: float, green: float, blue: float) -> None:  # noqa: N802 - reportlab's name
        self._colour = red, green, blue

    def setDash(self, *points: float) -> None:  # noqa: N802 - reportlab's name
        self._dash = tuple(length * MM_PER_POINT for length in points)

    def setFont(self, _: str, points: float) -> None:  # noqa: N802 - reportlab's name
        self._font = points

    def draw_line(self, points: FloatArray, closed: bool) -> None:
        """Draw a line (P, 2), mm on the page."""
        width = self._width * MM_PER_POINT
        self._strokes.append(PageStroke(np.array(points), closed, self._colour, width, self._dash))

    def line(self, *ends: float) -> None:
        self.draw_line(MM_PER_POINT * np.array(ends).reshape(2, 2), closed=False)

    def drawString(self, x: float, y: float, text: str) -> None:  # noqa: N802 - reportlab's name
        self._write(x, y, text, centred=False)

    def drawCentredString(self, x: float, y: float, text: str) -> None:  # noqa: N802 - reportlab's name
        self._write(x, y, text, centred=True)

    def _write(self, x: float, y: float, text: str, centred: bool) -> None:
        place = x * MM_PER_POINT, y * MM_PER_POINT
        self._texts.append(PageText(text, place, self._font * MM_PER_POINT, centred))

    def showPage(self) -> None:  # noqa: N802 - reportlab's name
        """End a page; the next one begins with what a new page has."""
        self.pages.append(PrintedPage(tuple(self._strokes), tuple(self._texts)))
        self._strokes, self._texts = [], []
        self._colour, self._width, self._dash = (0.0, 0.0, 0.0), 1.0, ()
