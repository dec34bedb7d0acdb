"""Jobs on targets: read a file or a library silhouette, trace a picture at a threshold, measure a shape."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.steps import Cancel
from kirigami_studio.foundation.words import tr
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.starts import StartShape, outline_start
from kirigami_studio.pipeline.request import Request
from kirigami_studio.project.settings import DesignSettings

if TYPE_CHECKING:
    from kirigami_studio.outlines.read_image import Traced
    from kirigami_studio.outlines.symmetry import TargetSymmetry

#: Extensions of targets that are traced at a threshold.
PICTURES = (".png", ".jpg", ".jpeg", ".bmp")
#: Longer side of the picture as it is kept for drawing, pixels.
LARGEST_SIDE = 1600


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture that a target is traced from; grey levels run from 0 (black) to 1 (white).

    Attributes
    ----------
    path : Path
    automatic, threshold : float, 0..1
        The grey level that suits the picture best, and the one it is traced at.
    traced : Traced or None
        Where the target lies in it.
    seen : (H, W, 4) uint8 or None
        The picture reduced for drawing: red, green, blue, opacity.
    """

    path: Path
    automatic: float
    threshold: float
    traced: Traced | None = None
    seen: NDArray[np.uint8] | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class TargetRead:
    """A target that was read, with the picture that it was traced from, if it was."""

    outline: Outline
    picture: Picture | None = None


def reading_target(source: str, cancel: Cancel) -> Iterator[TargetRead]:
    """Read a file or a library silhouette."""
    from kirigami_studio.outlines.read import read_target

    path = Path(source)
    if path.suffix.lower() in PICTURES:
        from kirigami_studio.outlines.read_image import automatic_threshold, trace_image

        level = automatic_threshold(path)
        traced = trace_image(path)
        yield TargetRead(traced.outline, Picture(path, level, level, traced, reduced_picture(path)))
    else:
        yield TargetRead(read_target(source))


def making_start(outline: Outline, cancel: Cancel) -> Iterator[StartShape]:
    """Make a drawn shape a start outline; one that is too hollow is refused."""
    yield outline_start(outline)


def checking_start(
    outline: Outline, settings: DesignSettings, request: Request | None, cancel: Cancel
) -> Iterator[str]:
    """Find out why the next run would refuse a drawn start, one sentence, or "" where it would not.

    The run is the ``request`` with another start; without one, as there is no target yet, its grid is the settings'.
    """
    from kirigami_studio.pipeline.auto_grid import predicted_for

    start, grid = outline_start(outline), settings.grid
    try:
        if request is not None:
            asked = replace(request, start=start)
            grid = predicted_for(asked).grid if asked.grid is None else asked.grid
    except KirigamiError as error:  # such as a symmetry that the start cannot have
        yield str(error)
    else:
        yield start_refusal(start, grid, settings.rim)


def start_refusal(start: StartShape, grid: tuple[int, int], rim: str) -> str:
    """Why a run on a grid would refuse a start, one sentence; "" where it would not."""
    from kirigami_studio.polish.flat_sheet import first_sheet

    try:
        first_sheet(grid, start, free_rim=rim == "free")
    except KirigamiError as error:
        return str(error)
    return ""


def tracing(picture: Picture, cancel: Cancel) -> Iterator[Traced]:
    """Trace a picture at its threshold."""
    from kirigami_studio.outlines.read_image import trace_image

    yield trace_image(picture.path, picture.threshold)


def reduced_picture(path: Path) -> NDArray[np.uint8] | None:
    """Return a picture turned upright and reduced; None when it cannot be read.

    A large photo takes a third of a second to read, hence this is done in a worker.

    Returns
    -------
    (H, W, 4) uint8 or None
        Red, green, blue, opacity, row 0 on top; the longer side is at most ``LARGEST_SIDE`` pixels.
    """
    from PIL import Image, ImageOps

    from kirigami_studio.outlines.read_image import opened_image
    from kirigami_studio.outlines.source_file import decoding, read_bytes

    try:
        with decoding(path, "source.image_damaged"):
            image = ImageOps.exif_transpose(opened_image(read_bytes(path)))
            if image.mode.startswith(("I", "F")):  # 16 and 32 bit: black and white are the extremes
                deep = np.asarray(image, dtype=np.float64)
                lowest, highest = float(np.min(deep)), float(np.max(deep))
                image = Image.fromarray((255.0 * (deep - lowest) / max(highest - lowest, 1e-12)).astype(np.uint8))
            image = image.convert("RGBA")
            image.thumbnail((LARGEST_SIDE, LARGEST_SIDE))
    except KirigamiError:
        return None
    return np.asarray(image)


@dataclass(frozen=True, slots=True)
class TargetReading:
    """What a target's shape says.

    Attributes
    ----------
    symmetry : str
        How symmetric it is, in one or two sentences.
    grid : (rows, columns) or None
        What a run would choose, as far as that is known without trying; None where the settings ask for a symmetry
        that the target is far from.
    reason : str
        Why, in one sentence.
    start_refusal : str
        Why the run would refuse the start on that grid, in one sentence; "" where it would not.
    """

    symmetry: str
    grid: tuple[int, int] | None
    reason: str
    start_refusal: str = ""


def reading_shape(request: Request, cancel: Cancel) -> Iterator[TargetReading]:
    """Measure how symmetric a request's target is, and choose a grid for it."""
    from kirigami_studio.outlines.symmetry import symmetry_of
    from kirigami_studio.pipeline.auto_grid import known_for

    found = _symmetry_sentence(symmetry_of(request.target))
    try:
        choice = known_for(request)
    except KirigamiError as error:
        yield TargetReading(found, None, str(error))
    else:
        grid = choice.grid if request.grid is None else request.grid
        yield TargetReading(found, choice.grid, choice.reason, start_refusal(request.start, grid, request.rim))


def _symmetry_sentence(found: TargetSymmetry) -> str:
    """The best axis and turn of a target, with what counts as symmetric."""
    from kirigami_studio.outlines.symmetry import TOLERANCE

    mirror, turn = found.axes[0].overlap, max(found.half_turn, found.quarter_turn)
    numbers = {"mirror": 100.0 * mirror, "turn": 100.0 * turn, "least": 100.0 * TOLERANCE}
    if mirror >= TOLERANCE and turn >= TOLERANCE:
        return tr(
            "The target is symmetric: it shares {mirror:.1f} % of its area with its mirror image and {turn:.1f} % with "
            "its turned self.",
            **numbers,
        )
    if mirror >= TOLERANCE:
        return tr(
            "The target has a mirror axis: it shares {mirror:.1f} % of its area with its mirror image.", **numbers
        )
    if turn >= TOLERANCE:
        return tr(
            "The target looks the same turned: it shares {turn:.1f} % of its area with its turned self.", **numbers
        )
    return tr(
        "The target is not symmetric: it shares {mirror:.1f} % of its area with its best mirror image and {turn:.1f} % "
        "with its turned self; {least:.1f} % would count.",
        **numbers,
    )
