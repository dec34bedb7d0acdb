"""Artwork: read in the worker, painted as a flat sheet, drawn on moving panels and pieces."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QBuffer, QByteArray, QIODevice, QSize, Qt
from PySide6.QtGui import QBrush, QGuiApplication, QImage, QImageWriter, QPainter, QPainterPath, QTransform
from PySide6.QtSvg import QSvgRenderer

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.export.artwork import ArtPicture, Artwork
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.steps import Cancel
from kirigami_studio.gui.widgets.paths import line_path
from kirigami_studio.gui.widgets.view_transform import ViewTransform
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.studio import importing

if TYPE_CHECKING:
    from kirigami_studio.export.artwork_patches import PrintedSheet
    from kirigami_studio.export.artwork_pieces import PrintedPieces


@dataclass(frozen=True, slots=True, eq=False)
class ShownArtwork:
    """The printed flat sheet of one design."""

    artwork: Artwork
    sheet: PrintedSheet
    image: QImage  #: nothing where nothing is printed
    corner: complex  #: mm; where its upper left corner lies on the flat sheet; y up
    dots_per_mm: float


@dataclass(frozen=True, slots=True, eq=False)
class PiecePatch:
    """A part of a piece that shows a picture."""

    path: QPainterPath  #: frame of the piece, mm
    image: QImage
    #: factor, shift: the image's map into the frame of the piece.
    factor: complex
    shift: complex


@dataclass(frozen=True, slots=True, eq=False)
class ShownPrint:
    """The printed pieces of one design."""

    artwork: Artwork
    deployment: Deployment  #: of the pieces
    patches: Mapping[str, tuple[PiecePatch, ...]]  #: by the ids of the pieces


def paint_patches(
    painter: QPainter,
    patches: Sequence[PiecePatch],
    place: tuple[complex, complex],
    to_pixels: QTransform,
    transform: ViewTransform,
) -> None:
    """Fill parts of a piece with artwork.

    Parameters
    ----------
    place : (factor, shift)
        From the frame of the piece into the world.
    to_pixels : QTransform
        From the frame of the piece.
    """
    brush = QBrush()
    for patch in patches:
        a = transform.scale * (place[0] * patch.factor).conjugate()
        b = transform.scale * (place[0] * patch.shift + place[1]).conjugate() + complex(*transform.origin)
        brush.setTextureImage(patch.image)
        brush.setTransform(QTransform(a.real, a.imag, -a.imag, a.real, b.real, b.imag))
        painter.fillPath(to_pixels.map(patch.path), brush)


def paint_artwork(
    painter: QPainter,
    shown: ShownArtwork,
    phi: float,
    panels: FloatArray,
    trimmed: Mapping[int, FloatArray],
    transform: ViewTransform,
) -> None:
    """Fill all panels with artwork.

    Parameters
    ----------
    shown : ShownArtwork
        The printed flat sheet of the design that is drawn.
    phi : float, radians
    panels : (K, 4, 2) float, pixels
    trimmed : mapping of row to (P, 2) float, pixels
        What trimming has left of panels, drawn instead of them.
    """
    motion = shown.sheet.motion(phi)
    # Pixels count downwards, in the view and in the artwork: between them lie the conjugates.
    turn = transform.scale * np.conj(motion.factor)
    factor = turn / shown.dots_per_mm
    shift = turn * np.conj(shown.corner) + transform.scale * np.conj(motion.shift) + complex(*transform.origin)
    painter.save()
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
    brush = QBrush(shown.image)
    for row, (a, b) in enumerate(zip(factor.tolist(), shift.tolist(), strict=True)):
        ring = trimmed.get(row, panels[row])
        if len(ring):
            brush.setTransform(QTransform(a.real, a.imag, -a.imag, a.real, b.real, b.imag))
            painter.fillPath(line_path(ring, closed=True), brush)
    painter.restore()


#: Pixels along the longer side of the flat sheet as it is shown: a view is seldom larger.
SHOWN_SIDE = 1200
#: Any width would do: what is shown is scaled.
WIDTH_MM = 100.0
#: Seconds of processor time that a document may take to be drawn, and how much smaller it is drawn before.
MOST_SECONDS, REDUCTIONS = 3.0, (128, 64, 32, 16, 8, 4, 2, 1)
#: Command lines have no display; text needs an application all the same, because it has the fonts.
_APPLICATION: list[QGuiApplication] = []


def reading_artwork(path: Path, cancel: Cancel) -> Iterator[ArtPicture]:
    """Read a picture file for printing."""
    importing.import_pictures()
    from kirigami_studio.export.artwork_picture import read_picture

    yield read_picture(path, svg_to_png)


def painting_artwork(
    artwork: Artwork, design: PosedDesign, target: Outline | None, cancel: Cancel
) -> Iterator[ShownArtwork]:
    """Paint the flat sheet of a design as it would be printed."""
    importing.import_exporters()
    from kirigami_studio.export.artwork_patches import PrintedSheet, printed_patches
    from kirigami_studio.export.artwork_raster import BitmapFrame, paint
    from kirigami_studio.foundation.units import MM_PER_INCH

    sheet = PrintedSheet.uncut(design, None if target is None else target.rings, WIDTH_MM)
    points = sheet.corners.reshape(-1, 2)
    low, high = points.min(axis=0), points.max(axis=0)
    dpi = SHOWN_SIDE / float((high - low).max()) * MM_PER_INCH
    page = BitmapFrame((float(low[0]), float(low[1])), (float(high[0]), float(high[1])), dpi)
    pixels = np.asarray(paint(printed_patches(artwork, sheet, 0.0, 0.0), page))
    height, width, _ = pixels.shape
    image = QImage(pixels.tobytes(), width, height, 4 * width, QImage.Format.Format_RGBA8888)
    shown = image.convertToFormat(QImage.Format.Format_ARGB32_Premultiplied)  # its own copy of the pixels
    yield ShownArtwork(artwork, sheet, shown, complex(page.low[0], page.high[1]), page.dots_per_mm)


def painting_on_pieces(artwork: Artwork, printed: PrintedPieces, cancel: Cancel) -> Iterator[ShownPrint]:
    """Lay pictures on pieces; those with lines are engraved, and drawn with the pieces."""
    importing.import_exporters()
    from shapely import affinity

    from kirigami_studio.evaluate.boundary import as_points
    from kirigami_studio.export.artwork_patches import patches_of, rings_of
    from kirigami_studio.export.artwork_raster import image_of

    assembly = printed.posed.assembly
    shifts = as_points(printed.origins)
    placed = zip(printed.areas, shifts, strict=True)
    regions = [affinity.translate(area, float(shift[0]), float(shift[1])) for area, shift in placed]
    images: dict[ArtPicture, tuple[QImage, float]] = {}
    found: dict[str, list[PiecePatch]] = {}
    for patch in patches_of(artwork, printed, regions):
        picture = patch.picture
        if picture.lines:
            continue
        if picture not in images:
            reduced = image_of(picture.content).copy()
            reduced.thumbnail((SHOWN_SIDE, SHOWN_SIDE))
            pixels = QImage(reduced.tobytes(), *reduced.size, 4 * reduced.width, QImage.Format.Format_RGBA8888)
            kept = pixels.convertToFormat(QImage.Format.Format_ARGB32_Premultiplied)  # its own copy of the pixels
            images[picture] = kept, picture.size[0] / reduced.width
        image, share = images[picture]
        own = patch.moved(1.0, -complex(printed.origins[patch.panel]))
        path = QPainterPath()
        for ring in rings_of(own.region):
            path.addPath(line_path(ring, closed=True))
        path.setFillRule(Qt.FillRule.OddEvenFill)
        made = PiecePatch(path, image, own.factor * share, own.shift)
        found.setdefault(assembly.pieces[patch.panel].id, []).append(made)
    yield ShownPrint(artwork, assembly.deployment, {name: tuple(made) for name, made in found.items()})


def _drawn(renderer: QSvgRenderer, size: QSize) -> QImage:
    image = QImage(QSize(1, 1).expandedTo(size), QImage.Format.Format_ARGB32_Premultiplied)
    image.fill(Qt.GlobalColor.transparent)
    painter = QPainter(image)
    renderer.render(painter)
    painter.end()
    return image


def svg_to_png(content: bytes, side: int) -> bytes:
    """Draw an SVG document on nothing, for the window and for the command line, which has no drawing of its own.

    Qt draws SVG Tiny 1.2 and a part of SVG 1.1: shapes, gradients, pictures and text, but not every filter.

    Parameters
    ----------
    side : int
        Pixels along the longer side of the document's page.

    Raises
    ------
    TargetError
        It cannot be drawn, or not in a few seconds.
    """
    if QGuiApplication.instance() is None:
        _APPLICATION.append(QGuiApplication(["kirigami-studio", "-platform", "offscreen"]))
    renderer = QSvgRenderer(QByteArray(content))
    page = renderer.viewBoxF().size() if not renderer.viewBoxF().isEmpty() else renderer.defaultSize().toSizeF()
    if not renderer.isValid() or page.isEmpty():
        raise TargetError("artwork.svg_not_drawn")
    # Nothing can stop a drawing that is under way: small ones tell how long the next, of twice the side, may take.
    for reduction in REDUCTIONS:
        begun = time.thread_time()
        image = _drawn(renderer, (page * (side / reduction / max(page.width(), page.height()))).toSize())
        if reduction > 1 and time.thread_time() - begun > MOST_SECONDS / 4:
            raise TargetError("artwork.svg_too_slow", seconds=MOST_SECONDS)
    stored = QByteArray()
    buffer = QBuffer(stored)
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    QImageWriter(buffer, QByteArray(b"PNG")).write(image)
    return bytes(stored.data())
