"""Deployment from the compact sheet to the target angle -> looping GIF."""

from __future__ import annotations

import math
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image

from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.picture import PictureFrame, draw_polygons
from kirigami_studio.export.provenance import origin_facts
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically

FRAMES = 40
FRAME_MS = 50
#: The first and the last frame stay this long (ms).
HOLD_MS = 900
LONGEST_SIDE = 480
#: Colours of the shared palette; the picture has few and their blends.
PALETTE_COLOURS = 64


@dataclass(frozen=True, slots=True)
class GifExporter:
    """Deployment as GIF."""

    extension: str = ".gif"
    name: str = "GIF animation of the deployment"

    def write(self, job: ExportJob, path: Path) -> None:
        """Write the motion from phi = pi to the job's angle."""
        write_animation(job, path)


def frame_angles(phi: float, frames: int) -> FloatArray:
    """Angles from pi to ``phi``, slow at both ends: (frames,) float, radians."""
    time = np.linspace(0.0, 1.0, frames)
    eased = 0.5 - 0.5 * np.cos(math.pi * time)
    angles = math.pi + (phi - math.pi) * eased
    angles[-1] = phi
    return angles


def write_animation(job: ExportJob, path: str | Path, frames: int = FRAMES, longest: int = LONGEST_SIDE) -> int:
    """Write the motion and return the number of frames.

    Raises
    ------
    ExportError
        Fewer than 2 frames, an unwritable place, or a file that did not read back.
    """
    if frames < 2:
        raise ExportError("gif.too_few_frames", frames=frames)
    pictures = animation_frames(job, frames, longest)
    durations = [HOLD_MS] + [FRAME_MS] * (frames - 2) + [HOLD_MS]
    stream = BytesIO()
    facts = "; ".join(f"{name} {text}" for name, text in origin_facts(job.provenance).items())
    pictures[0].save(
        stream,
        format="GIF",
        save_all=True,
        append_images=pictures[1:],
        duration=durations,
        loop=0,
        optimize=False,
        **({"comment": facts.encode("utf-8")} if facts else {}),
    )

    def verify(written: Path) -> None:
        with Image.open(written) as read:
            found = int(getattr(read, "n_frames", 1))
            if found != frames or read.size != pictures[0].size:
                raise ExportError("gif.other_frames", found=found, planned=frames)

    write_atomically(Path(path), stream.getvalue(), verify)
    return frames


def animation_frames(job: ExportJob, frames: int, longest: int) -> list[Image.Image]:
    """Pictures of the motion that show one part of the plane and share one palette."""
    design = job.posed
    poses = [design.parts(float(angle)) for angle in frame_angles(job.phi, frames)]
    clouds = [np.concatenate(panels) for panels in poses]
    box = PictureFrame.around(clouds if job.target is None else [*clouds, job.target], longest)
    pictures = [draw_polygons(panels, box, job.target) for panels in poses]
    # Open and closed states together show every colour.
    sample = Image.new("RGB", (box.pixels[0], 2 * box.pixels[1]))
    sample.paste(pictures[frames // 2], (0, 0))
    sample.paste(pictures[-1], (0, box.pixels[1]))
    shared = sample.quantize(colors=PALETTE_COLOURS)
    return [picture.quantize(palette=shared, dither=Image.Dither.NONE) for picture in pictures]
