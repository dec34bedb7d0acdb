"""All designs of a suite in one picture: the layout over its target, the figures below."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from io import BytesIO
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from kirigami_studio.benchmark.design_suite import Made
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.palette import PAPER
from kirigami_studio.export.picture import PictureFrame, draw_polygons
from kirigami_studio.foundation.files import write_atomically

#: Size of one picture and of its lines of text, pixels.
TILE, LINE, GAP = 260, 22, 14
COLUMNS = 6
INK = (40, 44, 52)


def write_contact_sheet(made: Sequence[Made], path: Path) -> None:
    """Write a PNG with a tile for every design, two where it was trimmed.

    Raises
    ------
    ExportError
        The place cannot be written.
    """
    tiles = [tile for one in made for tile in _tiles(one)]
    rows = math.ceil(len(tiles) / COLUMNS)
    width, height = TILE + GAP, TILE + 2 * LINE + GAP
    sheet = Image.new("RGB", (COLUMNS * width + GAP, rows * height + GAP), PAPER)
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(16)
    for number, (picture, lines) in enumerate(tiles):
        x, y = GAP + number % COLUMNS * width, GAP + number // COLUMNS * height
        sheet.paste(picture, (x + (TILE - picture.width) // 2, y + (TILE - picture.height) // 2))
        for place, text in enumerate(lines):
            draw.text((x + TILE // 2, y + TILE + place * LINE), text, fill=INK, font=font, anchor="ma")
    stream = BytesIO()
    sheet.save(stream, format="PNG", optimize=True)
    write_atomically(path, stream.getvalue())


def _tiles(one: Made) -> list[tuple[Image.Image, tuple[str, str]]]:
    grid = f"{one.request.grid[0]} x {one.request.grid[1]}"
    plain = replace(one.best, trim=None)
    agreement = f"IoU {plain.score.iou_exact:.3f} (uniform {plain.score.uniform_iou:.3f})"
    tiles = [(_drawn(plain, one), (f"{one.target.name}, {grid}", agreement))]
    if one.best.trim is not None:
        tiles.append((_drawn(one.best, one), ("trimmed", f"IoU {one.best.trim.iou:.3f}")))
    return tiles


def _drawn(candidate: Candidate, one: Made) -> Image.Image:
    job = ExportJob.of(candidate, one.target.points)
    panels = job.posed.parts(job.phi)
    return draw_polygons(panels, PictureFrame.around([*panels, one.target.points], TILE), one.target.points)
