"""A picture of designs in plywood for README and guide: assembled, flat, and half open.

``python -m kirigami_studio.lab.demonstrations.assembled_pieces PROJECT ... --out docs/pictures/plywood.png`` shows the
chosen designs of projects as they are cut.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from pathlib import Path

from PIL import Image

from kirigami_studio.assembly.posed_pieces import PosedPieces
from kirigami_studio.export.picture import PAPER, PictureFrame, draw_pieces, shown_points
from kirigami_studio.project.store import load
from kirigami_studio.studio.making import CutRequest, posed_pieces

#: Pixels of an assembled design, of each of the other two states, and around them.
SIDE, SMALL_SIDE, MARGIN = 420, 200, 20
#: Angle of the state between, radians.
HALF_OPEN = math.radians(80.0)
#: Colours of the picture: it is read over the network.
COLOURS = 160


def assembled_pieces(projects: Sequence[Path]) -> Image.Image:
    """Draw three states of the chosen design of each project, side by side.

    Raises
    ------
    ProjectError
        A project has no chosen design.
    ValueError
        A design that is not made of pieces.
    """
    column, height = SIDE + MARGIN, SIDE + SMALL_SIDE + 3 * MARGIN
    canvas = Image.new("RGB", (column * len(projects) + MARGIN, height), PAPER)
    for place, project in enumerate(projects):
        pieces = posed_pieces(CutRequest.of(load(project)))
        if pieces is None:
            raise ValueError(f"{project} is not made of pieces")
        left = MARGIN + place * column
        _paste(canvas, _state(pieces, pieces.design.phi_target, SIDE), left + SIDE // 2, MARGIN + SIDE // 2)
        for share, shown, phi in ((0.25, pieces.upright(), math.pi), (0.75, pieces, HALF_OPEN)):
            middle = left + round(share * SIDE), 2 * MARGIN + SIDE + SMALL_SIDE // 2
            _paste(canvas, _state(shown, phi, SMALL_SIDE), *middle)
    return canvas


def _state(pieces: PosedPieces, phi: float, side: int) -> Image.Image:
    return draw_pieces(pieces, phi, PictureFrame.around(shown_points(pieces, (phi,), None), side))


def _paste(canvas: Image.Image, image: Image.Image, x: int, y: int) -> None:
    canvas.paste(image, (x - image.width // 2, y - image.height // 2))


def main(argv: Sequence[str] | None = None) -> int:
    """Write the picture with few colours."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("projects", type=Path, nargs="+")
    parser.add_argument("--out", type=Path, required=True)
    words = parser.parse_args(argv)
    assembled_pieces(words.projects).quantize(COLOURS).save(words.out, optimize=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
