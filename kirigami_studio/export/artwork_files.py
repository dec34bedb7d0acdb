"""A printed sheet -> SVG, PDF and PNG in true millimetres, in register with the cut file, and a picture of it opened.

All three files have the frame of the cut file of the same plan and profile, or of the same bed of pieces: the same
origin and unit, a margin around it, and marks in the margin on the lines of the frame's edges.  In SVG and PDF the
picture keeps its own pixels; in PNG it has the resolution asked for.  The PDF is one page, or spread over pages of the
job's paper as that of the cuts is.
"""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from io import BytesIO
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import shapely
from PIL import Image, ImageDraw

from kirigami_studio import __version__
from kirigami_studio.assembly.nesting import LaidShape
from kirigami_studio.export.artwork import ArtPicture, Artwork
from kirigami_studio.export.artwork_patches import Patch, PrintedSheet, opened_patches, printed_patches, rings_of
from kirigami_studio.export.artwork_pieces import PrintedPieces, bed_patches, posed_patches
from kirigami_studio.export.artwork_raster import BitmapFrame, most_dpi, paint
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.paper import Tile, Tiling, find_paper, tile
from kirigami_studio.export.pdf_library import Canvas, ImageReader, mm
from kirigami_studio.export.pdf_pages import LINE_MM, check_pages, draw_pages, page_boxes, to_page
from kirigami_studio.export.picture import INK, PAPER, TARGET_EDGE, write_image
from kirigami_studio.export.profile import find_profile
from kirigami_studio.export.provenance import facts_of
from kirigami_studio.export.strokes import extent, frame_origin, strokes_of
from kirigami_studio.export.svg import NAMESPACE, decimals, path_data, root_element, svg_content
from kirigami_studio.foundation.arrays import FloatArray, as_rings
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.foundation.units import MM_PER_INCH

XLINK = "http://www.w3.org/1999/xlink"
USUAL_DPI = 300.0
USUAL_BLEED_MM = 1.0
USUAL_MARGIN_MM = 8.0
MOST_MARGIN_MM = 100.0
#: Marks begin this far (mm) beyond the bleed and are this thick; shorter ones are left out.
MARK_GAP_MM = 1.0
MARK_LINE_MM = 0.1
SHORTEST_MARK_MM = 1.0
#: Pixels along the longer side of the picture of the opened sheet, and its margin (mm).
OPENED_SIDE = 1200
OPENED_MARGIN_MM = 3.0
#: There panels grow by this share of the sheet's width, about half a pixel: no white shines through where they touch.
OPENED_OVERLAP = 4e-4


@dataclass(frozen=True, slots=True, eq=False)
class PrintedBed:
    """Pieces on a bed that are printed."""

    name: str  #: stem of its cut file
    pieces: PrintedPieces
    placed: Mapping[str, LaidShape]  #: where they lie, by their ids
    size_mm: tuple[float, float]  #: width and height of the cut file
    facts: Mapping[str, str]  #: how the cut file was made
    digest: str  #: of the design


@dataclass(frozen=True, eq=False)
class ArtworkJob:
    """The contents of the files of a printed sheet, or of the pieces on one bed.

    Raises
    ------
    ExportError
        A margin that no page has.
    """

    artwork: Artwork
    job: ExportJob  #: with its plan, or with pieces
    dpi: float = USUAL_DPI  #: of the PNG
    bleed_mm: float = USUAL_BLEED_MM  #: how far panels at the sheet's edge are printed beyond it
    margin_mm: float = USUAL_MARGIN_MM  #: around the frame of the cut file; 0 for pages that are exactly that frame
    bed: PrintedBed | None = None  #: of pieces; None for a sheet

    def __post_init__(self) -> None:
        if not 0.0 <= self.margin_mm <= MOST_MARGIN_MM:
            raise ExportError("artwork.impossible_margin", margin_mm=self.margin_mm, most=MOST_MARGIN_MM)

    @classmethod
    def usual(cls, artwork: Artwork, job: ExportJob, bed: PrintedBed | None = None) -> ArtworkJob:
        """That of somebody who asks for no numbers: 300 dpi, or as many as a bitmap of its size may have."""
        made = cls(artwork, job, bed=bed)
        return replace(made, dpi=min(made.dpi, most_dpi(*made.page_mm)))

    @property
    def stem(self) -> str:
        """Of its files' names."""
        return "artwork" if self.bed is None else f"artwork-{self.bed.name}"

    @property
    def digest(self) -> str:
        """Of the design."""
        return self.job.required_plan.design_hash if self.bed is None else self.bed.digest

    @cached_property
    def sheet(self) -> PrintedSheet:
        return PrintedSheet.of(self.job)

    @cached_property
    def patches(self) -> tuple[Patch, ...]:
        """Those of the first copy, in the frame of the cut file."""
        if self.bed is not None:
            return bed_patches(self.bed.pieces, self.artwork, self.bed.placed, self.bleed_mm)
        plan = self.job.required_plan
        origin = frame_origin(plan, find_profile(self.job.profile))
        found = printed_patches(self.artwork, self.sheet, self.bleed_mm, plan.kerf_mm)
        return tuple(patch.moved(1.0, -complex(*origin)) for patch in found)

    @property
    def places(self) -> FloatArray:
        """Where the copies lie: (C, 2) mm."""
        if self.bed is not None:
            return np.zeros((1, 2))
        return self.job.required_plan.copies.places

    @cached_property
    def frame_mm(self) -> tuple[float, float]:
        """Width and height of the cut file; its lower left corner is (0, 0)."""
        if self.bed is not None:
            return self.bed.size_mm
        return extent(strokes_of(self.job.required_plan, find_profile(self.job.profile)))

    @property
    def page_mm(self) -> tuple[float, float]:
        """Width and height of the printed page."""
        return self.frame_mm[0] + 2.0 * self.margin_mm, self.frame_mm[1] + 2.0 * self.margin_mm

    @cached_property
    def tiling(self) -> Tiling | None:
        """The pages of paper that the PDF is spread over; None for the printed page itself.

        Raises
        ------
        ExportError
            Unknown paper, or too many pages.
        """
        return None if find_paper(self.job.paper) is None else tile(self.page_mm, self.job.paper)

    @property
    def page(self) -> BitmapFrame:
        """The page as a bitmap.

        Raises
        ------
        ExportError
            It would have too many pixels.
        """
        low, high = (-self.margin_mm, -self.margin_mm), (np.array(self.frame_mm) + self.margin_mm).tolist()
        return BitmapFrame(low, (high[0], high[1]), self.dpi)

    @property
    def marks(self) -> FloatArray:
        """Lines (M, 2, 2) in the margin, mm: their extensions are the edges of the frame."""
        near, far = self.bleed_mm + MARK_GAP_MM, self.margin_mm
        if far - near < SHORTEST_MARK_MM:
            return np.zeros((0, 2, 2))
        width, height = self.frame_mm
        reach = np.array([[near, near], [far, far]])
        lines = [
            np.array([x, y]) + reach * along
            for x, side in ((0.0, -1.0), (width, 1.0))
            for y, up in ((0.0, -1.0), (height, 1.0))
            for along in ((side, 0.0), (0.0, up))
        ]
        return np.array(lines)

    @property
    def picture_dpi(self) -> float:
        """Pixels of the picture on an inch of the sheet; the fewest where there are two."""
        return min(patch.dots_per_mm for patch in self.patches) * MM_PER_INCH

    @cached_property
    def covered(self) -> float:
        """Share of the sheet that gets a picture: the rest lies beside it."""
        shown = total = 0.0
        for patch in self.patches:
            width, height = patch.picture.size
            corners = patch.shift + patch.factor * np.conj(np.array([0.0, width, width + 1j * height, 1j * height]))
            picture = shapely.Polygon(np.column_stack([corners.real, corners.imag]))
            shown += patch.region.intersection(picture).area
            total += patch.region.area
        return shown / total

    @property
    def facts(self) -> Mapping[str, str]:
        """How the files were made."""
        if self.bed is not None:
            return self.bed.facts
        return facts_of(self.job.required_plan, find_profile(self.job.profile))


def write_artwork(work: ArtworkJob, folder: str | Path) -> tuple[Path, ...]:
    """Write SVG, PDF and PNG of the printed sheet, and a PNG of the sheet opened to its target.

    Returns
    -------
    files : tuple of Path
        ``artwork.svg``, ``artwork.pdf``, ``artwork.png`` and ``artwork_opened.png``; of a bed, ``artwork-layer-1.svg``
        and so on.

    Raises
    ------
    ExportError
        No plan, too many pixels, an unwritable place, or a file that did not read back as it was meant.
    """
    home = Path(folder)
    page, _ = work.page, work.tiling  # too many pixels or pages are refused before anything is written
    svg, pdf, png = (home / f"{work.stem}{end}" for end in (".svg", ".pdf", ".png"))
    opened = home / "artwork_opened.png"
    write_atomically(svg, _svg_bytes(work), lambda written: _verify_svg(written, work))
    write_atomically(pdf, _pdf_bytes(work), lambda written: _verify_pdf(written, work))
    write_image(printed_image(work, page), png, work.facts, work.dpi)
    write_image(opened_image(work), opened, work.facts, None)
    return svg, pdf, png, opened


def printed_image(work: ArtworkJob, page: BitmapFrame) -> Image.Image:
    """The printed page: RGBA, nothing where nothing is printed."""
    copies = [patch.moved(1.0, complex(*place)) for place in work.places.tolist() for patch in work.patches]
    image = paint(copies, page)
    draw = ImageDraw.Draw(image)
    for line in work.marks:
        ends = [tuple(end) for end in (page.to_pixels(line) - 0.5).tolist()]
        draw.line(ends, fill=(*INK, 255), width=max(1, round(MARK_LINE_MM * page.dots_per_mm)))
    return image


def opened_image(work: ArtworkJob) -> Image.Image:
    """The printed sheet, or all pieces, opened over the target's outline, on white."""
    if work.bed is None:
        sheet = work.sheet
        width = float(np.ptp(sheet.corners[..., 0]))
        scale, outline = sheet.design.mm_per_world(width), sheet.target
        patches = opened_patches(work.artwork, sheet, sheet.phi_target, OPENED_OVERLAP * width)
    else:
        pieces = work.bed.pieces
        scale, outline = pieces.mm_per_world, pieces.target
        patches = posed_patches(pieces, work.artwork, pieces.phi_target)
    clouds = [np.array(patch.region.bounds).reshape(2, 2) for patch in patches]
    target = [ring * scale for ring in as_rings(outline)]
    points = np.concatenate([*clouds, *target])
    low, high = points.min(axis=0) - OPENED_MARGIN_MM, points.max(axis=0) + OPENED_MARGIN_MM
    dpi = OPENED_SIDE / float((high - low).max()) * MM_PER_INCH
    page = BitmapFrame((float(low[0]), float(low[1])), (float(high[0]), float(high[1])), dpi)
    image = paint(patches, page, (*PAPER, 255))
    for line in target:
        ring = page.to_pixels(np.concatenate([line, line[:1]])) - 0.5
        ImageDraw.Draw(image).line([tuple(point) for point in ring.tolist()], fill=(*TARGET_EDGE, 255), width=2)
    return image.convert("RGB")


def _pictures(work: ArtworkJob) -> dict[ArtPicture, str]:
    """A name for every picture that is used."""
    used = dict.fromkeys(patch.picture for patch in work.patches)
    return {picture: f"picture{place}" for place, picture in enumerate(used, start=1)}


def _svg_bytes(work: ArtworkJob) -> bytes:
    (width, height), margin = work.frame_mm, work.margin_mm
    root = root_element(width, height, "Kirigami artwork", margin)
    root.set("xmlns:xlink", XLINK)
    ElementTree.SubElement(root, "desc").text = "; ".join(f"{key} {value}" for key, value in work.facts.items())
    definitions = ElementTree.SubElement(root, "defs")
    names = _pictures(work)
    for picture, name in names.items():
        kind = "jpeg" if picture.is_jpeg else "png"
        content = f"data:image/{kind};base64,{base64.b64encode(picture.content).decode('ascii')}"
        size = {"width": f"{picture.size[0]}", "height": f"{picture.size[1]}", "preserveAspectRatio": "none"}
        ElementTree.SubElement(definitions, "image", {"id": name, **size, "xlink:href": content})
    sheet = ElementTree.SubElement(root, "g", {"id": "ARTWORK"})
    first = ElementTree.SubElement(sheet, "g", {"id": "SHEET"})
    for place, patch in enumerate(work.patches):
        clip = ElementTree.SubElement(definitions, "clipPath", {"id": f"panel{place}"})
        rings = " ".join(path_data(ring, height, closed=True) for ring in rings_of(patch.region))
        ElementTree.SubElement(clip, "path", {"d": rings, "clip-rule": "evenodd"})
        a, b = patch.factor, patch.shift
        matrix = (a.real, -a.imag, a.imag, a.real, b.real, height - b.imag)
        words = " ".join(f"{value:.9f}" for value in matrix)
        group = ElementTree.SubElement(first, "g", {"clip-path": f"url(#panel{place})"})
        link = f"#{names[patch.picture]}"
        ElementTree.SubElement(group, "use", {"xlink:href": link, "transform": f"matrix({words})"})
    for x, y in work.places[1:].tolist():
        move = {"transform": f"translate({decimals(x)} {decimals(-y)})"}
        ElementTree.SubElement(sheet, "use", {"xlink:href": "#SHEET", **move})
    look = {"id": "MARKS", "fill": "none", "stroke": "#000000", "stroke-width": f"{MARK_LINE_MM:g}"}
    marks = ElementTree.SubElement(root, "g", look)
    for line in work.marks:
        ElementTree.SubElement(marks, "path", {"d": path_data(line, height, closed=False)})
    return svg_content(root)


def _verify_svg(path: Path, work: ArtworkJob) -> None:
    read = ElementTree.parse(path).getroot()
    found = len(read.findall(f".//{{{NAMESPACE}}}clipPath"))
    if found != len(work.patches) or read.get("width") != f"{decimals(work.page_mm[0])}mm":
        raise ExportError("svg.not_as_written", found=found, planned=len(work.patches))


def _pdf_bytes(work: ArtworkJob) -> bytes:
    stream = BytesIO()
    # reportlab carries no types; invariant: the same plan gives the same bytes.
    make_canvas: Any = Canvas
    make_reader: Any = ImageReader
    tiling = work.tiling
    size = work.page_mm if tiling is None else tiling.page
    canvas = make_canvas(stream, pagesize=tuple(side * mm for side in size), invariant=1)
    canvas.setTitle(f"Kirigami artwork {work.digest}")
    canvas.setCreator(f"Kirigami Studio {__version__}")
    canvas.setSubject("; ".join(f"{key} {value}" for key, value in work.facts.items()))
    names = _pictures(work)
    for picture, name in names.items():
        width, height = picture.size
        canvas.beginForm(name, 0, 0, width, height)
        canvas.drawImage(make_reader(io.BytesIO(picture.content)), 0, 0, width, height, mask="auto")
        canvas.endForm()
    page_width, page_height = work.page_mm
    canvas.beginForm("sheet", -work.margin_mm, -work.margin_mm, page_width, page_height)
    for patch in work.patches:
        canvas.saveState()
        _clip(canvas, rings_of(patch.region))
        a, b, height = patch.factor, patch.shift, patch.picture.size[1]
        canvas.transform(a.real, a.imag, -a.imag, a.real, b.real + a.imag * height, b.imag - a.real * height)
        canvas.doForm(names[patch.picture])
        canvas.restoreState()
    canvas.endForm()
    if tiling is None:
        _draw_print(canvas, work)
        canvas.showPage()
    else:
        across, up = work.page_mm
        about = f"Print {across:.1f} x {up:.1f} mm" + (f", {len(work.places)} copies" if len(work.places) > 1 else "")
        draw_pages(canvas, tiling, work.page_mm, about, lambda part: _draw_part(canvas, work, part))
    canvas.save()
    return stream.getvalue()


def _draw_part(canvas: Any, work: ArtworkJob, part: Tile) -> None:
    """Draw what of the print a page of paper shows."""
    canvas.saveState()
    x, y = to_page(part).tolist()
    canvas.translate(x * mm, y * mm)
    low_x, low_y, high_x, high_y = part.window
    _clip(canvas, [mm * np.array([[low_x, low_y], [high_x, low_y], [high_x, high_y], [low_x, high_y]])])
    _draw_print(canvas, work)
    canvas.restoreState()
    canvas.setLineWidth(LINE_MM * mm)


def _draw_print(canvas: Any, work: ArtworkJob) -> None:
    """Draw all copies and the marks, the lower left corner of the printed page being the origin."""
    canvas.scale(mm, mm)
    canvas.translate(work.margin_mm, work.margin_mm)
    for x, y in work.places.tolist():
        canvas.saveState()
        canvas.translate(x, y)
        canvas.doForm("sheet")
        canvas.restoreState()
    canvas.setLineWidth(MARK_LINE_MM)
    for (x, y), (end_x, end_y) in work.marks.tolist():
        canvas.line(x, y, end_x, end_y)


def _clip(canvas: Any, rings: Sequence[FloatArray]) -> None:
    path = canvas.beginPath()
    for ring in rings:
        path.moveTo(*ring[0].tolist())
        for point in ring[1:].tolist():
            path.lineTo(*point)
        path.close()
    canvas.clipPath(path, stroke=0, fill=0, fillMode=0)


def _verify_pdf(path: Path, work: ArtworkJob) -> None:
    tiling = work.tiling
    page, parts = (work.page_mm, 1) if tiling is None else (tiling.page, len(tiling.tiles))
    check_pages(page_boxes(path.read_bytes()), page, parts)
