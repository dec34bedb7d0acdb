"""SVG drawings -> their parts, and the outline of the silhouette that is seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import shapely
from shapely.geometry import Polygon

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import tr
from kirigami_studio.outlines.joining import refuse_scribbles
from kirigami_studio.outlines.merging import usual_outline
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.parts import (
    RECTANGLE,
    DrawnPartKind,
    Part,
    SourceParts,
    StrokeStyle,
    numbered,
    parts_of_groups,
    parts_of_region,
    stroked,
)
from kirigami_studio.outlines.pieces import lines_within
from kirigami_studio.outlines.source_file import TimeBudget, decoded
from kirigami_studio.outlines.svg_drawing import PIXELS_PER_MM, WHITE, Drawn, Paint, SvgDrawing, svg_drawing
from kirigami_studio.outlines.svg_safety import checked_svg
from kirigami_studio.outlines.text_curves import text_parts

DAMAGED = "source.svg_damaged"
#: An open stroke whose ends are nearer than this share of its size is meant to be closed.
WIDEST_GAP = 0.02
#: Opacity below which a shape is hardly seen, such as a shadow.
FAINT = 0.3
#: A white rectangle is paper if it covers this share of the page.
PAPER = 0.9
#: Share of a coloured page from which on what is painted on it is meant, and not the page.
ON_GROUND = 0.02
#: How many times nearer to its curves than those of an outline the lines of a picture stay: 3 um of 200 mm.
FINER = 16.0


def read_svg(path: str | Path) -> Outline:
    """Outline of the silhouette that an SVG file shows, by the rule of ``outlines.parts``.

    Returns
    -------
    Outline
        ``size`` in mm when the file states its width in a real unit, otherwise in pixels.

    Raises
    ------
    TargetError
        Not SVG, larger than 20 MB, with entities that are no plain texts, nothing drawn, several letters only, or an
        open contour.
    """
    return decoded(path, DAMAGED, lambda *file: usual_outline(_parts(*file)))


def svg_parts(path: str | Path) -> SourceParts:
    """All parts of an SVG file: connected filled regions, contours and lines.

    Raises
    ------
    TargetError
        As :func:`read_svg`, but for open contours and letters.
    """
    return decoded(path, DAMAGED, _parts)


def _parts(path: Path, content: bytes) -> SourceParts:
    budget = TimeBudget()
    root, width_mm = checked_svg(content)
    unit = "px" if width_mm is None else "mm"
    read = svg_drawing(root, 1.0 if width_mm is None else 1.0 / PIXELS_PER_MM, budget)
    return parts_of_drawing(path.stem, read, unit, budget)


def painted_lines(content: bytes, size: tuple[float, float]) -> tuple[FloatArray, ...]:
    """The lines that an SVG is drawn with: middles of strokes, and edges of areas without one.

    Texts, pictures and a white background have none.

    Parameters
    ----------
    content : bytes
    size : (width, height)
        That the drawing's page, or its view, is scaled to.

    Returns
    -------
    lines : tuple of (P, 2) float
        Units of ``size``, y down; a closed one repeats its first point.

    Raises
    ------
    TargetError
        As :func:`read_svg`, but for open contours and letters.
    """
    budget = TimeBudget()
    root, _ = checked_svg(content)
    view = (root.get("viewBox") or "").replace(",", " ").split()
    if len(view) == 4:  # the page is as large as its view, so that nothing is beside it
        root.set("width", view[2])
        root.set("height", view[3])
    read = svg_drawing(root, 1.0, budget, FINER)
    refuse_scribbles([chain for shape in read.drawn for chain in shape.chains])
    if read.page is None or min(read.page) <= 0.0:
        return ()
    page = shapely.box(0.0, 0.0, *read.page)
    drawn, _paper = _without_paper(read.drawn, read.page)
    scale, found = np.array(size) / read.page, []
    for shape in drawn:
        budget.check()
        closes = shape.stroke is None
        chains = [
            np.concatenate([one, one[:1]]) if closes and np.any(one[0] != one[-1]) else one for one in shape.chains
        ]
        seen = page if shape.clip is None else page.intersection(shape.clip)
        lines = lines_within([chain for chain in chains if len(chain) > 1], seen)
        found += [line * scale for line in lines]
    return tuple(found)


def parts_of_drawing(name: str, read: SvgDrawing, unit: str, budget: TimeBudget) -> SourceParts:
    """The parts of a drawing as it is painted, of an SVG or of a page."""
    refuse_scribbles([chain for shape in read.drawn for chain in shape.chains])
    drawn, paper = _without_paper(read.drawn, read.page)
    notes = [*read.left_out]
    if paper is not None:
        notes.append(tr("The white background was left out."))
    ground = _ground(drawn, read.page)
    if ground is not None:
        notes.append(tr("The coloured background was left out."))
    if any(shape.fill is not None and _is_open(shape) for shape in drawn):
        notes.append(tr("An open filled path was closed by a straight line, as it is painted."))
    written, fonts = text_parts(read.texts)
    notes += fonts
    if not drawn and not written:
        if notes:
            raise TargetError("svg.no_shape_but_others", left_out=" ".join(notes))
        raise TargetError("svg.no_shape")
    parts: list[Part] = []
    lines: dict[tuple[str, str, float], list[Drawn]] = {}
    for shape in drawn:
        budget.check()
        if shape.fill is not None:
            parts += [replace(one, is_aside=shape is ground) for one in _filled_parts(shape)]
        elif shape.clip is not None:
            like = _part(shape, shape.stroke)
            parts += parts_of_region(shape.seen(), replace(like, lines=(), ring=None))
        else:
            lines.setdefault((shape.layer, _colour(shape.stroke), round(shape.pen.width, 9)), []).append(shape)
    groups = [([chain for shape in some for chain in shape.chains], _line_part(some)) for some in lines.values()]
    found, gaps, bridged = parts_of_groups(groups, WIDEST_GAP, unit)
    found = _named(found, [shape for some in lines.values() for shape in some])
    parts = [_upright(part) for part in (*parts, *found, *written)]
    if not parts:
        raise TargetError("drawing.no_area")
    kept, too_many = numbered(parts, max(max(part.size) for part in parts))
    if not kept:
        raise TargetError("drawing.no_area")
    box = None if paper is None else (paper[0], -paper[3], paper[2], -paper[1])
    return SourceParts(name, kept, (*notes, *gaps, *too_many), unit, paper=box, bridged=bridged, is_turned=True)


def _part(shape: Drawn, paint: Paint | None) -> Part:
    """A filled part without its region."""
    lines = shape.chains if shape.stroke is not None and shape.clip is None else ()
    pen = shape.pen if shape.stroke is not None else StrokeStyle()
    rings = [chain for chain in shape.chains if len(chain) > 2]
    ring = rings[0] if len(rings) == 1 and shape.clip is None else None
    faint = max(one[3] for one in (shape.fill, shape.stroke) if one is not None) < FAINT
    kind = DrawnPartKind.FILLED
    return Part(0, shape.name, shape.layer, _colour(paint), kind, Polygon(), lines, pen, is_faint=faint, ring=ring)


def _filled_parts(shape: Drawn) -> list[Part]:
    """The connected pieces of a filled shape."""
    region = shape.region()
    if shape.stroke is not None and shape.clip is not None:
        region = region.union(stroked(shape.chains, shape.pen, shape.pen.width).intersection(shape.clip))
    return parts_of_region(region, _part(shape, shape.fill))


def _line_part(shapes: list[Drawn]) -> Part:
    """A part of the lines of one layer, colour and width, without them."""
    first = shapes[0]
    name = first.name if len(shapes) == 1 else ""
    return Part(0, name, first.layer, _colour(first.stroke), DrawnPartKind.STROKED, Polygon(), (), first.pen)


def _named(parts: Sequence[Part], shapes: Sequence[Drawn]) -> list[Part]:
    """Parts of lines with the name of the shape that all their lines come from, where it has one."""
    chains = [(shape.name, chain) for shape in shapes for chain in shape.chains if len(chain) > 1]
    lines = [(number, line) for number, part in enumerate(parts) for line in part.lines]
    if not chains or not lines:
        return list(parts)
    tree = shapely.STRtree([shapely.LineString(line) for _, line in lines])
    nearest = tree.nearest(shapely.points([chain[:2].mean(axis=0) for _, chain in chains]))
    names: dict[int, set[str]] = {}
    for (name, _), place in zip(chains, nearest.tolist(), strict=True):
        names.setdefault(lines[place][0], set()).add(name)
    own = {number: some.pop() for number, some in names.items() if len(some) == 1}
    return [replace(part, name=part.name or own.get(number, "")) for number, part in enumerate(parts)]


def _upright(part: Part) -> Part:
    """The part with y up."""
    region = shapely.transform(part.region, lambda points: points * (1.0, -1.0))
    ring: FloatArray | None = None if part.ring is None else part.ring * (1.0, -1.0)
    return replace(part, region=region, lines=tuple(line * (1.0, -1.0) for line in part.lines), ring=ring)


def _is_open(shape: Drawn) -> bool:
    return any(len(chain) > 2 and not np.array_equal(chain[0], chain[-1]) for chain in shape.chains)


def _colour(paint: Paint | None) -> str:
    """Digits of a colour; none of patterns."""
    return "" if paint is None else "#" + "".join(f"{round(255.0 * level):02x}" for level in paint[:3])


def _without_paper(
    drawn: tuple[Drawn, ...], size: tuple[float, float] | None
) -> tuple[list[Drawn], tuple[float, float, float, float] | None]:
    """Leave out a white rectangle that covers the page behind all others; and its box."""
    page = _page_of(drawn, size)
    others = [shape for shape in drawn if shape is not page]
    if page is None or page.fill is None or min(page.fill[:3]) < WHITE:
        return list(drawn), None
    if not any(shape.fill is None or min(shape.fill[:3]) < WHITE for shape in others):
        return list(drawn), None
    points = np.concatenate(page.chains)
    (left, top), (right, bottom) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    return others, (left, top, right, bottom)


def _ground(drawn: Sequence[Drawn], size: tuple[float, float] | None) -> Drawn | None:
    """A coloured page with shapes of other colours on it, which are meant then, as in a picture."""
    page = None if size is None else _page_of(drawn, size)
    if page is None or page.fill is None:
        return None
    others = [shape for shape in drawn if shape is not page and shape.fill is not None and shape.fill != page.fill]
    shown = sum(float(shape.region().area) for shape in others)
    return page if shown >= ON_GROUND * float(page.region().area) else None


def _page_of(drawn: Sequence[Drawn], size: tuple[float, float] | None) -> Drawn | None:
    """The first filled shape where it is a plain rectangle that covers the page."""
    first = next((shape for shape in drawn if shape.fill is not None), None)
    if first is None or first.stroke is not None:
        return None
    others = [shape for shape in drawn if shape is not first]
    page = np.concatenate(first.chains)
    low, high = page.min(axis=0), page.max(axis=0)
    inner = np.concatenate([chain for shape in others if shape.fill is not None for chain in shape.chains] or [page])
    slack = 1e-6 * (high - low)
    covered = np.maximum(np.minimum(high, size or high) - np.maximum(low, 0.0), 0.0)
    if size is not None and np.prod(covered) < PAPER * np.prod(size):
        return None
    is_page = first.region().area >= RECTANGLE * float(np.prod(high - low))
    within = np.all(inner.min(axis=0) >= low - slack) and np.all(inner.max(axis=0) <= high + slack)
    return first if is_page and within else None
