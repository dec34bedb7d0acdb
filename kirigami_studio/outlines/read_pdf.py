"""PDF pages, and AI files with a PDF inside -> their parts, and the outline of the silhouette that is seen.

PDFium unfolds the first page into painted objects; what they are made of is chosen as in SVG.
"""

from __future__ import annotations

import ctypes
import re
import threading
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pypdfium2 as untyped_pypdfium2
import pypdfium2.raw as untyped_pdfium
from shapely.geometry import Polygon, box
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import tr
from kirigami_studio.outlines.bezier import flattened_curve
from kirigami_studio.outlines.merging import usual_outline
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.parts import Cap, Corner, SourceParts, StrokeStyle, text_left_out
from kirigami_studio.outlines.pieces import painted
from kirigami_studio.outlines.read_svg import parts_of_drawing
from kirigami_studio.outlines.source_file import TimeBudget, decoded
from kirigami_studio.outlines.svg_drawing import LEAST_SEEN, Drawn, Paint, SvgDrawing

#: The library's calls carry no types.
pypdfium2: Any = untyped_pypdfium2
pdfium: Any = untyped_pdfium

DAMAGED = "source.pdf_damaged"
MM_PER_POINT = 25.4 / 72.0
#: Deviation of flattened curves from the true ones, share of the page's size.
FLATNESS = 1.0 / 8000.0
#: Objects of a page after every form, forms in each other, and numbers of all paths.
MOST_OBJECTS, DEEPEST_FORM, MOST_POINTS = 20_000, 12, 200_000
#: Megabytes of all streams, unpacked: PDFium unpacks them whole.
MOST_UNPACKED = 256
#: How a file states layers, which may be off; pixels at which they are looked at, and sets of objects at most.
LAYERS, LOOKED_SIDE, MOST_SETS = b"/OCProperties", 256, 64
STREAM = re.compile(rb"stream\r?\n")
CAPS: tuple[Cap, ...] = ("flat", "round", "square")
JOINS: tuple[Corner, ...] = ("mitre", "round", "bevel")
#: PDFium keeps state of its own: one thread at a time.
LOCK = threading.Lock()


def read_pdf(path: str | Path) -> Outline:
    """Outline of the silhouette that the first page of a PDF or AI file shows; ``size`` in mm.

    Raises
    ------
    TargetError
        Not a PDF, locked by a password, too large, nothing drawn but texts and pictures, or an open contour.
    """
    return decoded(path, DAMAGED, lambda *file: usual_outline(_parts(*file)))


def pdf_parts(path: str | Path) -> SourceParts:
    """All parts of the first page of a PDF or AI file.

    Raises
    ------
    TargetError
        As :func:`read_pdf`, but for open contours.
    """
    return decoded(path, DAMAGED, _parts)


def _parts(path: Path, content: bytes) -> SourceParts:
    budget = TimeBudget()
    if content.lstrip()[:4] == b"%!PS":
        raise TargetError("pdf.postscript")
    has_layers = _unpacked(content, budget)
    with LOCK:
        try:
            document = pypdfium2.PdfDocument(content)
        except pypdfium2.PdfiumError as error:
            if "password" in str(error).lower():
                raise TargetError("pdf.locked") from error
            raise
        try:
            read = _drawing(document, has_layers, budget)
        finally:
            document.close()
    return parts_of_drawing(path.stem, read, "mm", budget)


def _unpacked(content: bytes, budget: TimeBudget) -> bool:
    """Refuse a file that unpacks to more than PDFium should hold; whether it states layers."""
    left = MOST_UNPACKED * 1_000_000
    has_layers = LAYERS in content
    for start in STREAM.finditer(content):
        if not content.startswith(b"\x78", start.end()):
            continue
        budget.check()
        unpacking = zlib.decompressobj()
        end = content.find(b"endstream", start.end())
        packed = content[start.end() : end if end > 0 else None]
        while packed and left > 0:
            try:
                piece = unpacking.decompress(packed, 1_000_000)
            except zlib.error:
                break
            packed, left = unpacking.unconsumed_tail, left - len(piece)
            has_layers = has_layers or LAYERS in piece
        if left <= 0:
            raise TargetError("pdf.unpacks", limit=MOST_UNPACKED)
    return has_layers


#: Objects of a page that are seen or hidden together: which form on the page holds them (-1 for none), and their layer.
_Set = tuple[int, str]


@dataclass(slots=True)
class _Page:
    """A page that is being unfolded."""

    tolerance: float  #: mm; of flattened curves
    budget: TimeBudget
    objects: int = 0
    points: int = 0
    has_text: bool = False
    has_picture: bool = False
    hidden: frozenset[_Set] = frozenset()  #: what lies on layers that are off

    def count(self) -> None:
        self.budget.check()
        self.objects += 1
        if self.objects > MOST_OBJECTS:
            raise TargetError("svg.too_many_elements", elements=self.objects, limit=MOST_OBJECTS)


def _drawing(document: Any, has_layers: bool, budget: TimeBudget) -> SvgDrawing:
    """What the first page shows, y down, mm."""
    page = document[0]
    left, bottom, right, top = page.get_cropbox(fallback_ok=True)
    turned = {0: (1, 0, 0, 1, -left, -bottom), 90: (0, -1, 1, 0, -bottom, right), 180: (-1, 0, 0, -1, right, top)}
    a, b, c, d, e, f = turned.get(page.get_rotation(), (0, 1, -1, 0, top, -left))
    width, height = page.get_size()
    if not (0.0 < width < np.inf and 0.0 < height < np.inf):
        raise TargetError("drawing.not_finite")
    upright = np.array([[a, c, e], [b, d, f], [0.0, 0.0, 1.0]])
    down = MM_PER_POINT * np.array([[1.0, 0.0, 0.0], [0.0, -1.0, height], [0.0, 0.0, 1.0 / MM_PER_POINT]])
    seen = _Page(FLATNESS * MM_PER_POINT * max(width, height), budget)
    get: Callable[[int], Any] = lambda index: pdfium.FPDFPage_GetObject(page.raw, index)  # noqa: E731
    if has_layers:
        seen.hidden = _hidden(page, (width, height), budget)
    shown = box(0.0, 0.0, MM_PER_POINT * width, MM_PER_POINT * height)
    drawn = tuple(_unfolded(get, pdfium.FPDFPage_CountObjects(page.raw), down @ upright, shown, seen, 0))
    notes = []
    if names := sorted({layer for _, layer in seen.hidden if layer}):
        notes.append(tr("Hidden layers were left out: {names}.", names=", ".join(names)))
    if len(document) > 1:
        notes.append(tr("Only the first of {pages} pages is read.", pages=len(document)))
    if seen.has_text:
        notes.append(text_left_out())
    if seen.has_picture:
        notes.append(tr("An embedded picture was left out. Export it as PNG if it is the shape."))
    return SvgDrawing(drawn, (), tuple(notes), (MM_PER_POINT * width, MM_PER_POINT * height))


def _unfolded(
    get: Callable[[int], Any],
    count: int,
    frame: FloatArray,
    clip: BaseGeometry,
    page: _Page,
    depth: int,
    outer: _Set = (-1, ""),
) -> Iterator[Drawn]:
    """The visible shapes of a page or of a form in it, in the order of painting."""
    if depth > DEEPEST_FORM:
        raise TargetError("pdf.too_deep", limit=DEEPEST_FORM)
    for index in range(count):
        page.count()
        one = get(index)
        kind = pdfium.FPDFPageObj_GetType(one)
        own = _set_of(one, index, kind, outer)
        if own in page.hidden:
            continue
        within = _clipped(one, frame, clip, page)
        if within.is_empty:
            continue
        if kind == pdfium.FPDF_PAGEOBJ_FORM:
            inner = partial(pdfium.FPDFFormObj_GetObject, one)
            inside = frame @ _matrix(one)
            yield from _unfolded(inner, pdfium.FPDFFormObj_CountObjects(one), inside, within, page, depth + 1, own)
        elif kind == pdfium.FPDF_PAGEOBJ_PATH:
            yield from _shape(one, frame @ _matrix(one), within, page)
        elif kind == pdfium.FPDF_PAGEOBJ_SHADING and isinstance(within, Polygon):
            ring = np.asarray(within.exterior.coords)
            yield Drawn((ring,), GREY, None, False, StrokeStyle(), "", _layer(one), None)
        page.has_text |= kind == pdfium.FPDF_PAGEOBJ_TEXT
        page.has_picture |= kind == pdfium.FPDF_PAGEOBJ_IMAGE


def _set_of(one: Any, index: int, kind: int, outer: _Set) -> _Set:
    form, layer = outer
    return (index if kind == pdfium.FPDF_PAGEOBJ_FORM and form < 0 else form), _layer(one) or layer


def _hidden(page: Any, size: tuple[float, float], budget: TimeBudget) -> frozenset[_Set]:
    """The sets of objects that layers hide: PDFium paints each of them alone."""
    sets: dict[_Set, list[Any]] = {}

    def collect(get: Callable[[int], Any], count: int, outer: _Set, depth: int) -> None:
        for index in range(min(count, MOST_OBJECTS)):
            budget.check()
            one = get(index)
            kind = pdfium.FPDFPageObj_GetType(one)
            own = _set_of(one, index, kind, outer)
            if kind != pdfium.FPDF_PAGEOBJ_FORM:
                sets.setdefault(own, []).append(one)
            elif depth < DEEPEST_FORM:
                inner = partial(pdfium.FPDFFormObj_GetObject, one)
                collect(inner, pdfium.FPDFFormObj_CountObjects(one), own, depth + 1)

    collect(partial(pdfium.FPDFPage_GetObject, page.raw), pdfium.FPDFPage_CountObjects(page.raw), (-1, ""), 0)
    if len(sets) > MOST_SETS:
        return frozenset()
    scale = LOOKED_SIDE / max(size)
    across, down = (max(round(scale * side), 1) for side in size)
    objects = [one for some in sets.values() for one in some]
    hidden = set()
    for own, some in sets.items():
        budget.check()
        for one in objects:
            pdfium.FPDFPageObj_SetIsActive(one, False)
        for one in some:
            pdfium.FPDFPageObj_SetIsActive(one, True)
        bitmap = pypdfium2.PdfBitmap.new_native(across, down, pdfium.FPDFBitmap_BGRA)
        bitmap.fill_rect((0, 0, 0, 0), 0, 0, across, down)
        pdfium.FPDF_RenderPageBitmap(bitmap.raw, page.raw, 0, 0, across, down, 0, 0)
        if not bitmap.to_numpy()[..., 3].any():
            hidden.add(own)
        bitmap.close()
    for one in objects:
        pdfium.FPDFPageObj_SetIsActive(one, True)
    return frozenset(hidden)


#: Paint of gradients and patterns, whose colours are not looked at.
GREY: Paint = (0.5, 0.5, 0.5, 1.0)


def _shape(one: Any, frame: FloatArray, clip: BaseGeometry, page: _Page) -> Iterator[Drawn]:
    """One path, if it is painted."""
    mode, strokes = ctypes.c_int(), ctypes.c_int()
    pdfium.FPDFPath_GetDrawMode(one, mode, strokes)
    fill = _paint(pdfium.FPDFPageObj_GetFillColor, one) if mode.value != pdfium.FPDF_FILLMODE_NONE else None
    stroke = _paint(pdfium.FPDFPageObj_GetStrokeColor, one) if strokes.value else None
    if fill is None and stroke is None:
        return
    count = pdfium.FPDFPath_CountSegments(one)
    chains = _chains(lambda index: pdfium.FPDFPath_GetPathSegment(one, index), count, frame, page, fill is not None)
    if not chains:
        return
    corners = np.concatenate(chains)
    cuts = not clip.contains(box(*corners.min(axis=0), *corners.max(axis=0)))
    is_even_odd = mode.value == pdfium.FPDF_FILLMODE_ALTERNATE
    pen = _pen(one, frame)
    yield Drawn(tuple(chains), fill, stroke, is_even_odd, pen, "", _layer(one), clip if cuts else None)


def _chains(get: Callable[[int], Any], count: int, frame: FloatArray, page: _Page, closes: bool) -> list[FloatArray]:
    """Flattened subpaths (P, 2), mm; filled ones are closed."""
    page.points += count
    if page.points > MOST_POINTS:
        raise TargetError("svg.too_many_numbers", limit=MOST_POINTS)
    chains: list[list[FloatArray]] = []
    controls: list[FloatArray] = []
    x, y = ctypes.c_float(), ctypes.c_float()
    for index in range(count):
        segment = get(index)
        pdfium.FPDFPathSegment_GetPoint(segment, x, y)
        kind = pdfium.FPDFPathSegment_GetType(segment)
        point = (frame @ (x.value, y.value, 1.0))[None, :2]
        if not np.isfinite(point).all():
            raise TargetError("drawing.not_finite")
        if kind == pdfium.FPDF_SEGMENT_MOVETO or not chains:
            chains.append([point])
            controls = []
        elif kind == pdfium.FPDF_SEGMENT_BEZIERTO:
            controls.append(point)
            if len(controls) == 3:
                chains[-1].append(flattened_curve(np.concatenate([chains[-1][-1][-1:], *controls]), page.tolerance))
                controls = []
        else:
            chains[-1].append(point)
        if pdfium.FPDFPathSegment_GetClose(segment) and len(chains[-1]) > 1:
            chains[-1].append(chains[-1][0])
    whole = [np.concatenate(chain) for chain in chains if len(chain) > 1]
    if closes:
        whole = [
            chain if np.array_equal(chain[0], chain[-1]) else np.concatenate([chain, chain[:1]]) for chain in whole
        ]
    return [chain for chain in whole if np.ptp(chain, axis=0).any()]


def _clipped(one: Any, frame: FloatArray, outer: BaseGeometry, page: _Page) -> BaseGeometry:
    """What is seen of an object lies inside this."""
    path = pdfium.FPDFPageObj_GetClipPath(one)
    region = outer
    for index in range(max(pdfium.FPDFClipPath_CountPaths(path), 0) if path else 0):
        count = max(pdfium.FPDFClipPath_CountPathSegments(path, index), 0)
        rings = _chains(
            partial(pdfium.FPDFClipPath_GetPathSegment, path, index),
            count,
            frame,
            page,
            True,
        )
        region = region.intersection(painted(rings, False))
    return region


def _matrix(one: Any) -> FloatArray:
    """From an object's own space to that of its page or form, (3, 3)."""
    stored = pdfium.FS_MATRIX()
    pdfium.FPDFPageObj_GetMatrix(one, stored)
    return np.array([[stored.a, stored.c, stored.e], [stored.b, stored.d, stored.f], [0.0, 0.0, 1.0]])


def _paint(get: Callable[..., int], one: Any) -> Paint | None:
    """A colour, 0..1; None where it cannot be seen."""
    red, green, blue, opacity = (ctypes.c_uint() for _ in range(4))
    if not get(one, red, green, blue, opacity):
        return GREY
    paint = (red.value / 255.0, green.value / 255.0, blue.value / 255.0, opacity.value / 255.0)
    return paint if paint[3] >= LEAST_SEEN else None


def _pen(one: Any, frame: FloatArray) -> StrokeStyle:
    width = ctypes.c_float()
    pdfium.FPDFPageObj_GetStrokeWidth(one, width)
    scale = float(np.sqrt(abs(np.linalg.det(frame[:2, :2]))))
    cap, join = pdfium.FPDFPageObj_GetLineCap(one), pdfium.FPDFPageObj_GetLineJoin(one)
    return StrokeStyle(width.value * scale, CAPS[cap if 0 <= cap < 3 else 0], JOINS[join if 0 <= join < 3 else 0])


def _layer(one: Any) -> str:
    """The name of the layer that an object is marked with."""
    for index in range(max(pdfium.FPDFPageObj_CountMarks(one), 0)):
        mark = pdfium.FPDFPageObj_GetMark(one, index)
        length, text = ctypes.c_ulong(), ctypes.create_string_buffer(256)
        if pdfium.FPDFPageObjMark_GetParamStringValue(
            mark, b"Name", ctypes.cast(text, ctypes.POINTER(ctypes.c_ushort)), 256, length
        ):
            return text.raw[: max(min(length.value, 256) - 2, 0)].decode("utf-16-le", errors="replace")
    return ""
