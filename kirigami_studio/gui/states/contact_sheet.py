"""Many screenshots on one page, small and with captions: all states of a size and theme at a glance."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

#: ``STATE-WIDTHxHEIGHT-THEME.png``, as the state sheet names its pictures.
NAME = re.compile(r"(?P<state>.+)-(?P<group>\d+x\d+-(?:light|dark))")
#: Pixels: width of one small picture, and the band for its caption.
WIDTH, CAPTION = 480, 22
GAP = 10
COLUMNS = 4
PAPER, INK = "#8a94a0", "#0b0f14"


def contact_sheets(pictures: Sequence[Path], out: Path) -> list[Path]:
    """Write one page for every size and theme among the pictures.

    Parameters
    ----------
    pictures : sequence of Path
        Those that are named otherwise share a page of their own, ``others``.
    out : Path
        Folder of the pages.

    Returns
    -------
    pages : list of Path
        ``contact-GROUP.png``, in the order in which the groups first appear.
    """
    groups: dict[str, list[tuple[str, Path]]] = defaultdict(list)
    for picture in pictures:
        found = NAME.fullmatch(picture.stem)
        group, state = (found["group"], found["state"]) if found else ("others", picture.stem)
        groups[group].append((state, picture))
    pages = []
    for group, entries in groups.items():
        page = out / f"contact-{group}.png"
        contact_sheet(entries).save(page)
        pages.append(page)
    return pages


def contact_sheet(entries: Sequence[tuple[str, Path]]) -> Image.Image:
    """One page of captioned pictures, row by row."""
    small = [(caption, _small(path)) for caption, path in entries]
    height = max(picture.height for _, picture in small) + CAPTION
    columns = min(COLUMNS, len(small))
    rows = -(-len(small) // columns)
    page = Image.new("RGB", (columns * (WIDTH + GAP) + GAP, rows * (height + GAP) + GAP), PAPER)
    draw, font = ImageDraw.Draw(page), ImageFont.load_default(size=13)
    for number, (caption, picture) in enumerate(small):
        row, column = divmod(number, columns)
        left, top = GAP + column * (WIDTH + GAP), GAP + row * (height + GAP)
        draw.text((left, top + 2), caption, fill=INK, font=font)
        page.paste(picture, (left, top + CAPTION))
    return page


def _small(path: Path) -> Image.Image:
    """A picture no wider than its column, and no higher than three quarters of that."""
    with Image.open(path) as picture:
        shown = picture.convert("RGB")
    shown.thumbnail((WIDTH, WIDTH * 3 // 4), Image.Resampling.LANCZOS)
    return shown
