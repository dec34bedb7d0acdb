"""Contact sheets: pictures in rows with two lines of text below each, as PNG, drawn by Pillow."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from io import BytesIO
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate_many
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.picture import PAPER, PictureFrame, draw_polygons
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.lab.benchmark.generator_table import Generator
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline

#: A picture and its two lines of text.
Tile = tuple[Image.Image, tuple[str, str]]
#: Pixels of a line of text and between tiles.
LINE, GAP = 22, 14
INK = (40, 44, 52)
#: Colours of the palette: few are needed, and the file is a third as large.
COLOURS = 64
#: Samples of a target in the picture of generators, and pixels of one.
SHOWN, TILE = 3, 150


def write_tiles(tiles: Sequence[Tile], side: int, columns: int, path: Path) -> None:
    """Write a PNG of tiles of ``side`` pixels, ``columns`` in a row.

    Raises
    ------
    ExportError
        The place cannot be written.
    """
    rows = math.ceil(len(tiles) / columns)
    width, height = side + GAP, side + 2 * LINE + GAP
    sheet = Image.new("RGB", (columns * width + GAP, rows * height + GAP), PAPER)
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(16)
    for number, (picture, lines) in enumerate(tiles):
        x, y = GAP + number % columns * width, GAP + number // columns * height
        sheet.paste(picture, (x + (side - picture.width) // 2, y + (side - picture.height) // 2))
        for place, text in enumerate(lines):
            draw.text((x + side // 2, y + side + place * LINE), text, fill=INK, font=font, anchor="ma")
    stream = BytesIO()
    sheet.quantize(COLOURS).save(stream, format="PNG", optimize=True)
    write_atomically(path, stream.getvalue())


def write_samples(
    targets: Mapping[str, Sequence[Outline]], generators: Sequence[Generator], seed: int, path: Path
) -> None:
    """Write a PNG of samples over their targets: a row for each generator, the families side by side.

    Parameters
    ----------
    targets : mapping of str to sequence of Outline
        The first of each family is shown.
    generators : sequence of Generator
    seed : int
    path : Path

    Raises
    ------
    ExportError
        The place cannot be written.
    """
    tiles: list[Tile] = []
    for generator in generators:
        for target, *_ in targets.values():
            for field in generator.draw(target, SHOWN, seed, generator.steps):
                (score,) = evaluate_many([deploy(field)], target)
                candidate = Candidate(Sheet(field), score, seed, 0)
                job = ExportJob.of(candidate, target.points)
                panels = job.posed.parts(job.phi)
                frame = PictureFrame.around([*panels, target.points], TILE)
                agreement = f"sIoU {100.0 * score.siou:.1f} %" if score.feasible else "not feasible"
                tiles.append((draw_polygons(panels, frame, target.points), (generator.name, agreement)))
    write_tiles(tiles, TILE, SHOWN * len(targets), path)
