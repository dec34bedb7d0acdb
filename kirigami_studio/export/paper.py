"""A sheet laid over pages of paper: which page shows which part, and where neighbouring pages meet."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType

from kirigami_studio.fabricate.findings import Note
from kirigami_studio.foundation.errors import ExportError

Size = tuple[float, float]
Box = tuple[float, float, float, float]


class Paper(StrEnum):
    """Paper that PDFs are spread over; its values stand on the command line and in files."""

    NONE = "none"  #: one page as large as the sheet
    A4 = "a4"
    LETTER = "letter"

    @classmethod
    def _missing_(cls, value: object) -> Paper | None:
        """Capitals and blanks around a name do not matter."""
        wanted = str(value).strip().casefold()
        return next((one for one in cls if one.value == wanted), None)


#: Sizes (width, height) in mm, upright.
PAPERS: Mapping[Paper, Size | None] = MappingProxyType(
    {Paper.NONE: None, Paper.A4: (210.0, 297.0), Paper.LETTER: (215.9, 279.4)}
)
#: Rim (mm) that printers leave white.
MARGIN_MM = 10.0
#: Room below the drawing for the ruler and its words.
FOOTER_MM = 14.0
#: Neighbouring pages show this much (mm) of the same; they are joined in its middle.
OVERLAP_MM = 10.0
#: More pages than this are a mistake in the size.
MOST_PAGES = 400
#: From this many pages on, a note says how many.
MANY_PAGES = 20


@dataclass(frozen=True, slots=True)
class Tile:
    """One page of the drawing."""

    #: row, column: from the top left.
    row: int
    column: int
    window: Box  #: (x low, y low, x high, y high), mm; what the page shows, in the plan's frame
    #: (x low, y low, x high, y high), mm; what is left when the page is cut along its joining lines; cells fill the
    #: sheet without overlap.
    cell: Box


@dataclass(frozen=True, slots=True)
class Tiling:
    """All pages of a drawing."""

    page: Size  #: (width, height), mm; as printed, upright or on its side
    rows: int
    columns: int
    tiles: tuple[Tile, ...]  #: row by row from the top left


def tile(size: Size, paper: str) -> Tiling:
    """Lay a drawing over pages, upright or on their side, whichever takes fewer.

    Parameters
    ----------
    size : (width, height), mm
        The drawing; its lower left corner is the origin.
    paper : str
        A key of ``PAPERS`` other than "none".

    Raises
    ------
    ExportError
        Unknown paper, or too many pages.
    """
    upright = find_paper(paper)
    if upright is None:
        raise ExportError("paper.none")
    width, height = upright
    choices = [_tiling(size, page) for page in ((width, height), (height, width))]
    best = min(choices, key=lambda choice: choice.rows * choice.columns)
    if len(best.tiles) > MOST_PAGES:
        raise ExportError("paper.too_many_pages", pages=len(best.tiles), paper=paper)
    return best


def page_notes(size: Size, paper: str) -> tuple[Note, ...]:
    """What to know about a drawing (width, height; mm) on this paper before it is printed.

    Raises
    ------
    ExportError
        Unknown paper, or too many pages.
    """
    if find_paper(paper) is None:
        return ()
    pages = len(tile(size, paper).tiles)
    return (Note.of("paper.many_pages", pages=pages, paper=paper),) if pages >= MANY_PAGES else ()


def find_paper(name: str) -> Size | None:
    """Return a paper's size by its key, None for one page as large as the sheet.

    Raises
    ------
    ExportError
        No such paper; the sentence lists the known ones.
    """
    try:
        key = Paper(name)
    except ValueError:
        raise ExportError("paper.unknown", name=name, known=", ".join(PAPERS)) from None
    return PAPERS[key]


def _tiling(size: Size, page: Size) -> Tiling:
    room = (page[0] - 2.0 * MARGIN_MM, page[1] - 2.0 * MARGIN_MM - FOOTER_MM)
    columns, rows = (_count(side, available) for side, available in zip(size, room, strict=True))
    x_steps, y_steps = room[0] - OVERLAP_MM, room[1] - OVERLAP_MM
    tiles = []
    for row in range(rows):
        # The top row comes first; the drawing hangs from its upper edge.
        high = size[1] - row * y_steps if rows > 1 else room[1]
        for column in range(columns):
            low = column * x_steps
            window = (low, high - room[1], low + room[0], high)
            half = 0.5 * OVERLAP_MM
            cell = (
                window[0] + half if column else -math.inf,
                window[1] + half if row < rows - 1 else -math.inf,
                window[2] - half if column < columns - 1 else math.inf,
                window[3] - half if row else math.inf,
            )
            tiles.append(Tile(row, column, window, cell))
    return Tiling(page, rows, columns, tuple(tiles))


def _count(side: float, room: float) -> int:
    return 1 if side <= room else math.ceil((side - OVERLAP_MM) / (room - OVERLAP_MM))
