"""The deployed layout over its target as an antialiased bitmap: the PNG preview, and every frame of the animation.

The colours of all exported pictures and drawings are here, as red, green, blue from 0 to 255.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from io import SEEK_END, BytesIO
from itertools import combinations
from pathlib import Path
from types import MappingProxyType

import numpy as np
import shapely
from numpy.typing import NDArray
from PIL import Image, ImageChops, ImageDraw, ImageFilter
from PIL.PngImagePlugin import PngInfo, putchunk
from shapely.geometry.base import BaseGeometry

from kirigami_studio.assembly.posed_pieces import GLINT, HEAD_RIM, PosedPieces, shaded
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.provenance import origin_facts
from kirigami_studio.fabricate.cut_plan import Layer
from kirigami_studio.foundation.arrays import FloatArray, ShapeRings, as_rings
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically

Colour = tuple[int, int, int]
PAPER: Colour = (255, 255, 255)
PANEL: Colour = (176, 200, 226)
PANEL_EDGE: Colour = (44, 72, 105)
VOID: Colour = (250, 250, 247)
TARGET_FILL: Colour = (255, 232, 204)
TARGET_EDGE: Colour = (217, 95, 2)
INK: Colour = (40, 40, 40)
LAYER_COLOUR: Mapping[Layer, Colour] = MappingProxyType(
    {
        Layer.RELIEF: (220, 120, 0),
        Layer.HOLES: (0, 160, 190),
        Layer.SLITS: (255, 0, 0),
        Layer.EDGE_SLITS: (0, 160, 0),
        Layer.OUTLINE: (0, 0, 255),
    }
)
#: A name that is engraved.
NAME_COLOUR: Colour = (150, 0, 140)
#: Pictures are drawn this many times larger and then reduced.
SUPERSAMPLING = 3
LONGEST_SIDE = 900
#: Room around what a picture shows, share of its longer side.
MARGIN = 0.05
#: Shadows are so dark (of 255) and so soft, in their own lengths.
DARKNESS, SOFTNESS = 90, 0.6
#: A head's spot of light is so large and lies so far from the middle, in radii of the head.
SPOT, SPOT_AT = 0.5, 0.2
#: Flat sheets of parts lie up to so many times as far apart as their targets, looked for in so many steps; else in
#: a row with this gap, in widths of the widest.
MOST_SPREAD, SPREADS, ROW_GAP = 4.0, 24, 0.05
#: Bitmaps tell whole pixels a metre: 300 dpi become 299.9994.
SAME_DPI = 0.02


def write_png(job: ExportJob, path: str | Path, longest: int = LONGEST_SIDE) -> None:
    """Write the layout at the target angle over the target.

    Raises
    ------
    ExportError
        The place cannot be written, or the file did not read back.
    """
    write_image(preview(job, longest), Path(path), origin_facts(job.provenance))


def write_image(image: Image.Image, path: Path, facts: Mapping[str, str], dpi: float | None = None) -> None:
    """Write a bitmap as PNG and read it back.

    Parameters
    ----------
    facts : mapping of str to str
        Written as text chunks.
    dpi : float, optional
        Resolution that the file tells; none without one.

    Raises
    ------
    ExportError
        The place cannot be written, or the file did not read back.
    """
    stream = BytesIO()
    resolution = {} if dpi is None else {"dpi": (dpi, dpi)}
    image.save(stream, format="PNG", pnginfo=text_chunks(facts), **resolution)

    def verify(written: Path) -> None:
        with Image.open(written) as read:
            read.load()
            found = read.info.get("dpi", (0.0, 0.0))[0]
            if read.size != image.size or (dpi is not None and abs(found - dpi) > SAME_DPI):
                raise ExportError(
                    "png.other_size",
                    width=read.width,
                    height=read.height,
                    planned_width=image.width,
                    planned_height=image.height,
                )

    write_atomically(path, stream.getvalue(), verify)


def text_chunks(facts: Mapping[str, str]) -> PngInfo:
    """Facts as a PNG keeps them, each under its name."""
    texts = PngInfo()
    for name, text in facts.items():
        texts.add_itxt(name, text)
    return texts


def png_of_bands(size: tuple[int, int], bands: Iterable[NDArray[np.uint8]], facts: Mapping[str, str]) -> bytes:
    """A PNG of a bitmap that is never held as a whole.

    Parameters
    ----------
    size : tuple of int
        Width and height, pixels.
    bands : iterable of uint8 array (rows, width, 3)
        From the top, as many rows as the bitmap is high; red, green, blue.
    facts : mapping of str to str
        Written as text chunks.
    """
    stream = BytesIO(b"\x89PNG\r\n\x1a\n")
    stream.seek(0, SEEK_END)
    colours, depth = 2, 8  # red, green, blue of 8 bits; then compression, filter and interlacing as usual
    putchunk(stream, b"IHDR", struct.pack(">IIBBBBB", *size, depth, colours, 0, 0, 0))
    for kind, content, *_ in text_chunks(facts).chunks:
        putchunk(stream, kind, content)
    packer = zlib.compressobj()
    for band in bands:
        rows = np.zeros((len(band), 1 + 3 * size[0]), np.uint8)  # each row begins with its filter: none
        rows[:, 1:] = band.reshape(len(band), -1)
        putchunk(stream, b"IDAT", packer.compress(rows.data))
    putchunk(stream, b"IDAT", packer.flush())
    putchunk(stream, b"IEND")
    return stream.getvalue()


def preview(job: ExportJob, longest: int = LONGEST_SIDE) -> Image.Image:
    """Draw the layout at the job's angle over the target: pieces, or panels as cut or ideal."""
    if job.pieces is not None:
        frame = PictureFrame.around(shown_points(job.pieces, (job.shown_phi,), job.target), longest)
        return draw_pieces(job.pieces, job.shown_phi, frame, job.target)
    panels, edges = drawn_panels(job, job.shown_phi)
    frame = PictureFrame.around([*panels, *as_rings(job.target)], longest)
    return draw_polygons(panels, frame, job.target, edges)


@dataclass(frozen=True, slots=True, eq=False)
class PlacedLayout:
    """The layout of a part in its place among those of others.

    Flat sheets are larger than what they open to, so they lie farther apart: on the way each moves straight.
    """

    job: ExportJob
    mm: float  #: for one unit of the target's frame
    shift: FloatArray  #: (2,), mm; of the target's centroid
    flat: FloatArray  #: (2,), mm; the same while the sheet is flat

    @property
    def small(self) -> PlacedLayout:
        """The same as thumbnails show it."""
        pieces = self.job.pieces
        return self if pieces is None else replace(self, job=replace(self.job, pieces=pieces.small))

    def share_left(self, phi: float) -> float:
        """Share (0 to 1) of the way from the target angle to the flat sheet."""
        end = self.job.phi
        return float(np.clip((phi - end) / (math.pi - end), 0.0, 1.0)) if end < math.pi else 0.0

    def place(self, left: float) -> FloatArray:
        """Where the target's centroid is (2,), mm, at a share of the way."""
        at: FloatArray = self.shift + left * (self.flat - self.shift)
        return at

    def put(self, points: FloatArray, left: float = 0.0) -> FloatArray:
        """Points (P, 2) of the target's frame, mm."""
        return points * self.mm + self.place(left)

    def shown(self, left: float) -> list[FloatArray]:
        """Panels or pieces, each (P, 2), mm, at a share of the way."""
        phi, job = self.job.phi + left * (math.pi - self.job.phi), self.job
        outlines = job.posed.parts(phi) if job.pieces is None else job.pieces.outlines(phi)
        return [self.put(outline, left) for outline in outlines]


def spread(parts: Sequence[PlacedLayout]) -> list[PlacedLayout]:
    """Flat sheets so far apart that they do not overlap: as they are arranged, else in a row."""
    middle = np.mean([part.shift for part in parts], axis=0)
    for factor in np.geomspace(1.0, MOST_SPREAD, SPREADS).tolist():
        apart = [replace(part, flat=middle + factor * (part.shift - middle)) for part in parts]
        if not any(_overlap(apart, left) for left in (0.5, 1.0)):
            return apart
    boxes = [np.array(_hull(replace(part, flat=np.zeros(2)), 1.0).bounds) for part in parts]
    gap = ROW_GAP * max(float(box[2] - box[0]) for box in boxes)
    ends = np.cumsum([float(box[2] - box[0]) + gap for box in boxes])
    lefts = middle[0] - 0.5 * ends[-1] + np.append(0.0, ends[:-1])
    return [
        replace(part, flat=np.array([left - box[0], middle[1]]))
        for part, left, box in zip(parts, lefts, boxes, strict=True)
    ]


def _overlap(parts: Sequence[PlacedLayout], left: float) -> bool:
    hulls = [_hull(part, left) for part in parts]
    return any(one.intersects(other) for one, other in combinations(hulls, 2))


def _hull(part: PlacedLayout, left: float) -> BaseGeometry:
    return shapely.MultiPoint(np.concatenate(part.shown(left))).convex_hull


def write_parts_png(parts: Sequence[PlacedLayout], path: str | Path, longest: int = LONGEST_SIDE) -> None:
    """Write the layouts of all parts at their angles, each in its place.

    Raises
    ------
    ExportError
        The place cannot be written, or the file did not read back.
    """
    ways = [part.share_left(part.job.shown_phi) for part in parts]
    apart = spread(parts) if any(ways) else parts
    image = draw_parts(apart, ways, parts_frame(apart, [ways], longest))
    write_image(image, Path(path), origin_facts(parts[0].job.provenance))


def parts_frame(parts: Sequence[PlacedLayout], ways: Iterable[Sequence[float]], longest: int) -> PictureFrame:
    """The part of the plane, mm, with all parts at some shares of their ways, and with their targets."""
    clouds = [points for lefts in ways for part, left in zip(parts, lefts, strict=True) for points in part.shown(left)]
    targets = [part.put(ring) for part in parts for ring in as_rings(part.job.target)]
    return PictureFrame.around([*clouds, *targets], longest)


def draw_parts(parts: Sequence[PlacedLayout], ways: Sequence[float], frame: PictureFrame) -> Image.Image:
    """Draw all parts at shares of their ways, each over its target, which moves with it."""
    picture = Image.new("RGB", frame.pixels, PAPER)
    for part, left in zip(parts, ways, strict=True):
        job, low = part.job, (np.array(frame.low) - part.place(left)) / part.mm
        own = PictureFrame((float(low[0]), float(low[1])), frame.scale * part.mm, frame.pixels)
        phi = job.phi + left * (math.pi - job.phi)
        if job.pieces is not None:
            drawn = draw_pieces(job.pieces, phi, own, job.target)
        else:
            drawn = draw_polygons(job.posed.parts(phi), own, job.target)
        picture = ImageChops.darker(picture, drawn)
    return picture


def drawn_panels(job: ExportJob, phi: float) -> tuple[list[FloatArray], list[FloatArray] | None]:
    """The panels at an angle (radians), and the lines at their edges; None for all."""
    if job.motion is None:
        return job.posed.parts(phi), None
    pose = job.motion.pose(job.posed, phi)
    return pose.panels, pose.cuts


def draw_polygons(
    polygons: Sequence[FloatArray],
    frame: PictureFrame,
    target: ShapeRings = None,
    edges: Sequence[FloatArray] | None = None,
) -> Image.Image:
    """Draw panels, each (P, 2), over a target (L, 2) with its holes, its lines once more on top.

    ``edges`` are lines (L, 2) that are drawn over the panels instead of their outlines.
    """
    factor = SUPERSAMPLING
    size = (frame.pixels[0] * factor, frame.pixels[1] * factor)
    image = Image.new("RGB", size, PAPER)
    draw = ImageDraw.Draw(image)
    loops = [frame.pixel(ring, factor) for ring in as_rings(target)]
    for loop in loops:
        draw.polygon(loop, fill=TARGET_FILL if loop is loops[0] else PAPER)
    for polygon in polygons:
        corners = frame.pixel(polygon, factor)
        draw.polygon(corners, fill=PANEL)
        if edges is None:
            draw.line([*corners, corners[0]], fill=PANEL_EDGE, width=factor, joint="curve")
    for edge in () if edges is None else edges:
        draw.line(frame.pixel(edge, factor), fill=PANEL_EDGE, width=factor, joint="curve")
    for loop in loops:
        draw.line([*loop, loop[0]], fill=TARGET_EDGE, width=2 * factor, joint="curve")
    return image.resize(frame.pixels, Image.Resampling.BOX)


def shown_points(pieces: PosedPieces, angles: Iterable[float], target: ShapeRings) -> list[FloatArray]:
    """Points of pieces at some angles (radians), and of their target."""
    return [*(pieces.points(phi) for phi in angles), *as_rings(target)]


def draw_pieces(pieces: PosedPieces, phi: float, frame: PictureFrame, target: ShapeRings = None) -> Image.Image:
    """Draw pieces layer by layer, with shadows and heads, over a target outline (L, 2) with its holes.

    The target's lines are repeated on top.
    """
    factor, look = SUPERSAMPLING, pieces.look
    size = (frame.pixels[0] * factor, frame.pixels[1] * factor)
    image = Image.new("RGB", size, PAPER)
    loops = [frame.pixel(ring, factor) for ring in as_rings(target)]
    for loop in loops:
        ImageDraw.Draw(image).polygon(loop, fill=TARGET_FILL if loop is loops[0] else PAPER)
    fall = max(pieces.shadow * frame.scale, 1.0) * factor
    shown, drawn = (
        [[frame.pixel(line, factor) for line in lines] for lines in found]
        for found in (pieces.rings(phi), pieces.drawn(phi))
    )
    for place, layer in enumerate(pieces.layers):
        mask = Image.new("L", size, 0)
        draw = ImageDraw.Draw(mask)
        for number in layer:
            for depth, ring in enumerate(shown[number]):  # openings and holes follow the outline
                draw.polygon(ring, fill=0 if depth else 255)
        _paste(image, mask, look.layer(place, len(pieces.layers)), fall)
        draw = ImageDraw.Draw(image)
        for ring in (ring for number in layer for ring in shown[number]):
            draw.line([*ring, ring[0]], fill=look.line, width=factor)
        for line in (line for number in layer for line in drawn[number]):
            draw.line(line, fill=look.number, width=factor, joint="curve")
    heads = frame.pixel(pieces.heads(phi), factor)
    radius = max(0.5 * pieces.head_mm / pieces.mm_per_world * frame.scale, 0.7) * factor
    if heads:
        mask = Image.new("L", size, 0)
        _dots(mask, heads, radius, 255)
        _paste(image, mask, shaded(look.head, HEAD_RIM), 0.5 * fall)
        _dots(image, heads, 0.8 * radius, look.head)
        spots = [(x - SPOT_AT * radius, y - SPOT_AT * radius) for x, y in heads]
        _dots(image, spots, 0.5 * SPOT * radius, shaded(look.head, GLINT))
    for loop in loops:
        ImageDraw.Draw(image).line([*loop, loop[0]], fill=TARGET_EDGE, width=2 * factor, joint="curve")
    return image.resize(frame.pixels, Image.Resampling.BOX)


def _paste(image: Image.Image, mask: Image.Image, colour: Colour, fall: float) -> None:
    """Lay an area of a colour on a picture; its shadow falls so many pixels to the lower right."""
    small = mask.reduce(SUPERSAMPLING)  # soft edges need no fine pixels
    length = fall / SUPERSAMPLING
    shadow = ImageChops.offset(small, round(0.5 * length), round(length))
    shadow = shadow.filter(ImageFilter.GaussianBlur(SOFTNESS * length))
    shadow = shadow.point([value * DARKNESS // 255 for value in range(256)]).resize(mask.size)
    image.paste(INK, (0, 0), shadow)
    image.paste(colour, (0, 0), mask)


def _dots(image: Image.Image, places: Sequence[tuple[float, float]], radius: float, colour: Colour | int) -> None:
    draw = ImageDraw.Draw(image)
    for x, y in places:
        draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill=colour)


@dataclass(frozen=True, slots=True)
class PictureFrame:
    """Which part of the plane a picture shows."""

    low: tuple[float, float]  #: (x, y); lower left corner, in the frame of the drawing
    scale: float  #: pixels per unit
    pixels: tuple[int, int]  #: (width, height)

    @classmethod
    def around(cls, clouds: Sequence[FloatArray], longest: int) -> PictureFrame:
        """Fit all points (each (P, 2)) into a picture whose longer side has ``longest`` pixels."""
        points = np.concatenate([cloud.reshape(-1, 2) for cloud in clouds])
        extent = np.ptp(points, axis=0)
        room = MARGIN * float(extent.max())
        low = points.min(axis=0) - room
        size = extent + 2.0 * room
        scale = longest / float(size.max())
        width, height = (max(1, round(float(side) * scale)) for side in size)
        return cls((float(low[0]), float(low[1])), scale, (width, height))

    def pixel(self, points: FloatArray, factor: int) -> list[tuple[float, float]]:
        """Coordinates (P, 2) -> pixels of a picture ``factor`` times as large, y down."""
        scale = self.scale * factor
        x = (points[:, 0] - self.low[0]) * scale
        y = self.pixels[1] * factor - (points[:, 1] - self.low[1]) * scale
        return list(zip(x.tolist(), y.tolist(), strict=True))


def hexadecimal(colour: Colour) -> str:
    """Return ``#rrggbb``."""
    return "#{:02x}{:02x}{:02x}".format(*colour)
