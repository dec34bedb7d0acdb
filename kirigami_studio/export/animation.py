"""Deployment from the compact sheet to the target angle -> looping GIF.

The motion is the ideal one, with connectors of no width, or that of the sheet as cut, which stops where it jams and
says so in a caption.  The file's comment names the motion.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.export.cut_motion import CutMotion
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.picture import (
    INK,
    SUPERSAMPLING,
    PictureFrame,
    PlacedLayout,
    draw_parts,
    draw_pieces,
    draw_polygons,
    parts_frame,
    shown_points,
    spread,
)
from kirigami_studio.export.provenance import origin_facts
from kirigami_studio.foundation.arrays import FloatArray, ShapeRings, as_rings
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.mechanics.closing import TOLERATED_STRETCH

FRAMES = 40
FRAME_MS = 50
#: The first and the last frame stay this long (ms).
HOLD_MS = 900
LONGEST_SIDE = 480
#: Colours of the shared palette; the picture has few and their blends.
PALETTE_COLOURS = 64
#: Smallest radius (pixels) and colour of the dots at connectors that are stretched to this share of what they tolerate:
#: at the angle where the sheet jams, those that stop it.
DOT, OVERSTRETCHED, NEARLY = 1.2, (213, 0, 50), 0.95
#: Height (pixels) of the caption's letters and its distance from the picture's corner, for a longest side of 480.
LETTERS, INSET = 15, 7


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
    motion = {} if job.motion is None else {"MOTION": job.motion.caption}
    _write_frames(animation_frames(job, frames, longest), path, origin_facts(job.provenance) | motion)
    return frames


def write_parts_animation(parts: Sequence[PlacedLayout], path: str | Path) -> None:
    """Write the ideal motion of all parts: their flat sheets come together as they open.

    Raises
    ------
    ExportError
        An unwritable place, or a file that did not read back.
    """
    apart = spread([part.small for part in parts])
    ways = [[left] * len(apart) for left in ((frame_angles(0.0, FRAMES) / math.pi).tolist())]
    frame = parts_frame(apart, ways[:: FRAMES // 4], LONGEST_SIDE)
    pictures = [draw_parts(apart, lefts, frame) for lefts in ways]
    _write_frames(_with_one_palette(pictures, captioned=False), path, origin_facts(parts[0].job.provenance))


def _write_frames(pictures: Sequence[Image.Image], path: str | Path, said: Mapping[str, str]) -> None:
    """Write a looping GIF and read it back."""
    frames = len(pictures)
    durations = [HOLD_MS] + [FRAME_MS] * (frames - 2) + [HOLD_MS]
    stream = BytesIO()
    facts = "; ".join(f"{name} {text}" for name, text in said.items())
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


def animation_frames(job: ExportJob, frames: int, longest: int) -> list[Image.Image]:
    """Pictures of the motion that show one part of the plane and share one palette."""
    design, motion = job.posed, job.motion
    end = job.phi if motion is None else motion.reached
    angles = [float(angle) for angle in frame_angles(end, frames)]
    if job.pieces is not None:
        box = PictureFrame.around(shown_points(job.pieces, angles, job.target), longest)
        pieces = job.pieces.small
        pictures = [draw_pieces(pieces, angle, box, job.target) for angle in angles]
        return _with_one_palette(pictures, captioned=False)
    # The ideal motion decides what part of the plane is shown.
    poses = [design.parts(angle) for angle in angles]
    clouds = [np.concatenate(panels) for panels in poses]
    box = PictureFrame.around([*clouds, *as_rings(job.target)], longest)
    if motion is None:
        pictures = [draw_polygons(panels, box, job.target) for panels in poses]
    else:
        pictures = [_as_cut(design, job.target, motion, angle, box) for angle in angles]
    return _with_one_palette(pictures, captioned=motion is not None)


def _with_one_palette(pictures: list[Image.Image], captioned: bool) -> list[Image.Image]:
    """Pictures in the colours of all; open and closed states together show every one."""
    width, height = pictures[0].size
    sample = Image.new("RGB", (width, 2 * height + (2 * LETTERS if captioned else 0)), OVERSTRETCHED)
    sample.paste(INK, (0, 2 * height + LETTERS, *sample.size))
    sample.paste(pictures[len(pictures) // 2], (0, 0))
    sample.paste(pictures[-1], (0, height))
    shared = sample.quantize(colors=PALETTE_COLOURS)
    return [picture.quantize(palette=shared, dither=Image.Dither.NONE) for picture in pictures]


def _as_cut(design: PosedDesign, target: ShapeRings, motion: CutMotion, phi: float, box: PictureFrame) -> Image.Image:
    """One frame of the sheet as cut: panels, connectors that stop it, and the caption."""
    pose = motion.pose(design, phi)
    image = draw_polygons(pose.panels, box, target, pose.cuts)
    large = image.resize((SUPERSAMPLING * box.pixels[0], SUPERSAMPLING * box.pixels[1]))
    draw = ImageDraw.Draw(large)
    widths = motion.closing.sheet.connectors.width_mm / design.mm_per_world(motion.width_mm)
    radii = SUPERSAMPLING * np.maximum(0.5 * widths * box.scale, DOT)
    far = np.flatnonzero(pose.stretch > NEARLY * TOLERATED_STRETCH)
    spots = box.pixel(pose.connectors[far].mean(axis=1), SUPERSAMPLING)
    for (x, y), radius in zip(spots, radii[far].tolist(), strict=True):
        draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill=OVERSTRETCHED)
    image = large.resize(box.pixels, Image.Resampling.BOX)
    share = max(box.pixels) / LONGEST_SIDE
    font = ImageFont.load_default(size=max(LETTERS * share, 8.0))
    ImageDraw.Draw(image).text((INSET * share, box.pixels[1] - INSET * share), motion.caption, INK, font, anchor="ls")
    return image
