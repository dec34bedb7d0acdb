"""A picture of a printed sheet for the README: flat, half open, and open over its target.

``python -m kirigami_studio.lab.demonstrations.printed_states PROJECT PICTURE --out docs/pictures/artwork.png``
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.export.artwork import Artwork, Laid
from kirigami_studio.export.artwork_patches import PrintedSheet, opened_patches
from kirigami_studio.export.artwork_picture import read_picture
from kirigami_studio.export.artwork_raster import BitmapFrame, paint
from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.foundation.units import MM_PER_INCH
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.project.store import load

WIDTH_MM = 100.0
#: Pixels of each state, and around it.
SIDE, MARGIN = 420, 16
#: Angle of the state in the middle, radians.
HALF_OPEN = math.radians(75.0)
#: Panels grow by so much (mm), a quarter of a pixel: no paper shines through where they touch.
OVERLAP_MM = 0.08
COLOURS = 256


def printed_states(project: Path, picture: Path) -> Image.Image:
    """Three states of a project's chosen design, printed with a picture that is whole on the opened sheet.

    Raises
    ------
    ProjectError
        The project has no chosen design.
    TargetError
        The picture cannot be read.
    """
    document = load(project)
    candidate = document.candidate
    if candidate is None or document.target is None:
        raise ProjectError("export.no_chosen_design")
    design = PosedDesign(deploy(candidate.final_sheet), candidate.final_pose, candidate.final_phi, candidate.trim)
    sheet = PrintedSheet.uncut(design, document.target.points, WIDTH_MM)
    artwork = Artwork(Laid(read_picture(picture)))
    shown = [opened_patches(artwork, sheet, phi, OVERLAP_MM) for phi in (math.pi, HALF_OPEN, candidate.final_phi)]
    boxes = [np.array([patch.region.bounds for patch in patches]) for patches in shown]
    ends = [(box[:, :2].min(axis=0), box[:, 2:].max(axis=0)) for box in boxes]
    longest = max(float((high - low).max()) for low, high in ends)
    dpi = SIDE / longest * MM_PER_INCH
    canvas = Image.new("RGB", (3 * (SIDE + MARGIN) + MARGIN, SIDE + 2 * MARGIN), "white")
    for column, (patches, (low, high)) in enumerate(zip(shown, ends, strict=True)):
        page = BitmapFrame((float(low[0]), float(low[1])), (float(high[0]), float(high[1])), dpi)
        image = paint(patches, page)
        left = MARGIN + column * (SIDE + MARGIN) + (SIDE - image.width) // 2
        canvas.paste(image, (left, MARGIN + (SIDE - image.height) // 2), image)
    return canvas


def main(argv: Sequence[str] | None = None) -> int:
    """Write the picture with few colours: a README is read over the network."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("project", type=Path)
    parser.add_argument("picture", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    words = parser.parse_args(argv)
    printed_states(words.project, words.picture).quantize(COLOURS).save(words.out, optimize=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
