"""SVG drawings -> Outline: outer boundary of everything filled, or of the closed strokes; or -> their parts."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import shapely
import svgelements as untyped_svgelements
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import tr
from kirigami_studio.outlines.bezier import curve_pieces, flattened_curve
from kirigami_studio.outlines.contour import thinned
from kirigami_studio.outlines.joining import MOST_VERTICES, closed_gaps, join, joined, refuse_scribbles
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.parts import (
    Cap,
    Corner,
    DrawnPartKind,
    Part,
    SourceParts,
    StrokeStyle,
    numbered,
    parts_of_lines,
    parts_of_region,
)
from kirigami_studio.outlines.pieces import enclosed, largest_piece
from kirigami_studio.outlines.source_file import TimeBudget, decoding, read_bytes
from kirigami_studio.outlines.svg_safety import checked_svg
from kirigami_studio.outlines.text_curves import Text, text_left_out, text_parts

#: The library's calls carry no types; its values are checked here instead.
svgelements: Any = untyped_svgelements

#: Resolution that CSS defines for lengths in millimetres or inches.
PIXELS_PER_INCH = 96.0

#: An open stroke whose ends are nearer than this share of its size is meant to be closed.
WIDEST_GAP = 0.02

#: Deviation of flattened curves from the true ones, share of the shape's size.
FLATNESS = 1.0 / 4000.0

ANCHORS = {"start": 0.0, "middle": 0.5, "end": 1.0}
#: Names of SVG for the ends and corners of strokes, and ours.
CAPS: Mapping[str, Cap] = {"butt": "flat", "round": "round", "square": "square"}
JOINS: Mapping[str, Corner] = {"miter": "mitre", "round": "round", "bevel": "bevel"}


@dataclass(frozen=True, slots=True)
class Drawn:
    """One visible shape: its subpaths, y down, and how it is painted."""

    chains: tuple[FloatArray, ...]
    is_filled: bool
    is_white: bool
    is_even_odd: bool
    name: str
    layer: str
    colour: str
    pen: StrokeStyle | None  #: None without a stroke


@dataclass(frozen=True, slots=True)
class SvgDrawing:
    """A drawing with lengths in ``unit``, what was left out, and hidden layers among that."""

    drawn: list[Drawn]
    left_out: tuple[str, ...]
    unit: str
    texts: tuple[Text, ...] = ()


def read_svg(path: str | Path) -> Outline:
    """Outline of an SVG file: paths, basic shapes, groups, transforms, viewBox, styles, definitions.

    Filled shapes are united and the largest piece is followed along its outer edge.  Without a filled
    shape, strokes that are closed or close with a gap below 2 % of the size are used instead.

    Returns
    -------
    Outline
        ``size`` in mm when the file states its width in a real unit, otherwise in pixels.

    Raises
    ------
    TargetError
        Not SVG, larger than 20 MB, with entity declarations, nothing drawn, text only, or open strokes.
    """
    path = Path(path)
    content = read_bytes(path)
    with decoding(path, "source.svg_damaged"):
        read = _read(content)
        ring, found = _ring(read.drawn, read.left_out, read.unit)
        # Turned upright last, so that places in sentences are those that a drawing program shows.
        down = Outline.from_points(thinned(ring), name=path.stem, notes=found, unit=read.unit)
        return Outline((down.points * (1.0, -1.0))[::-1], down.name, down.notes, down.size, read.unit)


def svg_parts(path: str | Path) -> SourceParts:
    """All parts of an SVG file: every connected filled region, and what strokes enclose or draw, by layer and colour.

    Raises
    ------
    TargetError
        As :func:`read_svg`, but for open strokes.
    """
    path = Path(path)
    content = read_bytes(path)
    with decoding(path, "source.svg_damaged"):
        read = _read(content)
        filled, notes = _without_paper([shape for shape in read.drawn if shape.is_filled])
        strokes = [shape for shape in read.drawn if not shape.is_filled]
        written, left_out = _written(read)
        if not filled and not strokes and not written:
            raise _nothing_drawn(read.left_out)
        parts: list[Part] = []
        for shape in filled:
            lines = shape.chains if shape.pen is not None else ()
            like = Part(
                0,
                shape.name,
                shape.layer,
                shape.colour,
                DrawnPartKind.FILLED,
                Polygon(),
                lines,
                shape.pen or StrokeStyle(),
            )
            parts += parts_of_region(_region(shape), like)
        lines_of: dict[tuple[str, str], list[Drawn]] = {}
        for shape in strokes:
            lines_of.setdefault((shape.layer, shape.colour), []).append(shape)
        gaps: list[str] = []
        for (layer, colour), shapes in lines_of.items():
            net = joined([chain for shape in shapes for chain in shape.chains], WIDEST_GAP)
            gaps += closed_gaps(net, read.unit)
            # Lines that meet are one part: it is painted with the broadest of their pens.
            pen = max((shape.pen or StrokeStyle() for shape in shapes), key=lambda pen: pen.width)
            name = shapes[0].name if len(shapes) == 1 else ""
            parts += parts_of_lines(net, Part(0, name, layer, colour, DrawnPartKind.STROKED, Polygon(), (), pen))
        parts = [_upright(part) for part in parts] + written
        if not parts:
            raise TargetError("drawing.no_area")
        kept, too_many = numbered(parts, max(max(part.size) for part in parts))
        return SourceParts(path.stem, kept, (*left_out, *notes, *gaps, *too_many), read.unit)


def _written(read: SvgDrawing) -> tuple[list[Part], tuple[str, ...]]:
    """The letters of all texts as parts, y up; and what is left out of the drawing then."""
    parts, fonts = text_parts(read.texts)
    return parts, (*(note for note in read.left_out if note != text_left_out()), *fonts)


def _upright(part: Part) -> Part:
    """The part with y up."""
    region = shapely.transform(part.region, lambda points: points * (1.0, -1.0))
    return replace(part, region=region, lines=tuple(line * (1.0, -1.0) for line in part.lines))


def _read(content: bytes) -> SvgDrawing:
    """Everything visible in a file, y down."""
    budget = TimeBudget()
    checked, width_mm, notes = checked_svg(content)
    svg = svgelements.SVG.parse(io.BytesIO(checked), reify=True, ppi=PIXELS_PER_INCH)
    budget.check()
    scale, unit = (width_mm / svg.width, "mm") if width_mm and svg.width else (1.0, "px")
    drawn = list(_drawn(_walk(svg, ""), scale, budget))
    refuse_scribbles([chain for shape in drawn for chain in shape.chains])
    return SvgDrawing(drawn, (*notes, *_left_out(svg)), unit, tuple(_texts(_walk(svg, ""), scale)))


def _texts(elements: Iterable[tuple[Any, str]], scale: float) -> Iterator[Text]:
    """Visible texts, y up, pixels times ``scale``.  Parts of a text come before it and follow it on its line."""
    waiting: list[Text] = []
    for element, layer in elements:
        if not isinstance(element, svgelements.Text) or not _is_visible(element) or not _is_painted(element, "fill"):
            continue
        own = element.values.get("attributes") or {}
        line = _text(element, layer, scale)
        if own.get("tag") == "tspan" and "x" not in own and "y" not in own:
            waiting.append(line)
            continue
        yield replace(line, text=line.text + "".join(part.text for part in waiting))
        waiting = []


def _text(element: Any, layer: str, scale: float) -> Text:
    to, size = element.transform, float(element.font_size or 16.0)
    values = element.values
    x, y = float(element.x or 0.0) + float(element.dx or 0.0), float(element.y or 0.0) + float(element.dy or 0.0)
    across, down = to.point_in_matrix_space((x, y)), (to.c, to.d)
    matrix = (
        (to.a * size * scale, -down[0] * size * scale, float(across.x) * scale),
        (-to.b * size * scale, down[1] * size * scale, -float(across.y) * scale),
    )
    weight = str(values.get("font-weight", "")).strip()
    return Text(
        " ".join(str(element.text or "").split(" ")).strip("\n\r\t"),
        matrix,
        ANCHORS.get(str(values.get("text-anchor", "start")).strip(), 0.0),
        str(values.get("font-family", "")),
        weight in ("bold", "bolder") or _number(weight, 400.0) >= 600.0,
        str(values.get("font-style", "")).strip() in ("italic", "oblique"),
        layer,
    )


def _walk(group: Any, layer: str) -> Iterator[tuple[Any, str]]:
    """Shapes in the order in which they are painted, each with its layer."""
    for element in group:
        if not isinstance(element, list) or isinstance(
            element, svgelements.Shape
        ):  # groups, uses and the drawing itself are lists of their children
            yield element, layer
        else:
            yield from _walk(element, _layer_of(element, layer))


def _layer_of(group: Any, outer: str) -> str:
    """The layer of what is in a group: a layer of a drawing program, or the outermost group with a name."""
    own = group.values.get("attributes") or {}
    label = next((str(text) for key, text in own.items() if key.endswith("}label")), "")
    name = label or str(own.get("id") or "")
    is_layer = any(key.endswith("}groupmode") and text == "layer" for key, text in own.items())
    return name if name and (is_layer or not outer) else outer


def _ring(drawn: list[Drawn], left_out: tuple[str, ...], unit: str) -> tuple[FloatArray, tuple[str, ...]]:
    """The outer edge of what is painted, and what was changed."""
    filled, notes = _without_paper([shape for shape in drawn if shape.is_filled])
    notes = (*left_out, *notes)
    strokes = [chain for shape in drawn if not shape.is_filled for chain in shape.chains]
    if filled:
        notes = (*notes, tr("Shapes without filling were left out.")) if strokes else notes
        rings = [chain for shape in filled for chain in shape.chains if len(chain) > 2]
        if any(not np.array_equal(ring[0], ring[-1]) for ring in rings):
            notes = (*notes, tr("An open filled path was closed by a straight line, as it is painted."))
        if len(rings) == 1:  # Left as it is, so that crossings are judged and named.
            return rings[0], notes
        region = shapely.unary_union([_region(shape) for shape in filled])
    elif not strokes:
        raise _nothing_drawn(left_out)
    elif len(strokes) == 1 and np.array_equal(strokes[0][0], strokes[0][-1]):
        return strokes[0], notes
    else:
        region, joints = join(strokes, WIDEST_GAP, unit)
        notes = (*notes, *joints)
    ring, dropped = largest_piece(region)
    return ring, (*notes, *dropped)


def _nothing_drawn(left_out: tuple[str, ...]) -> TargetError:
    if left_out:
        return TargetError("svg.no_shape_but_others", left_out=" ".join(left_out))
    return TargetError("svg.no_shape")


def _region(shape: Drawn) -> BaseGeometry:
    """Painted region of one shape by its fill rule; holes stay open.

    For the nonzero rule, subpaths of one direction are united and the two directions cancel, which
    is exact as long as no three subpaths of one shape lie over each other.
    """
    turned: dict[bool, list[BaseGeometry]] = {True: [], False: []}
    for chain in shape.chains:
        if len(chain) > 2:
            faces = shapely.unary_union(enclosed(LineString([*chain, chain[0]])))
            turned[Polygon(chain).exterior.is_ccw].append(faces)
    if not shape.is_even_odd:
        return shapely.unary_union(turned[True]).symmetric_difference(shapely.unary_union(turned[False]))
    region: BaseGeometry = Polygon()
    for faces in (*turned[True], *turned[False]):
        region = region.symmetric_difference(faces)
    return region


def _without_paper(filled: list[Drawn]) -> tuple[list[Drawn], tuple[str, ...]]:
    """Leave out a white shape that lies behind all others: the page, not the target."""
    if len(filled) < 2 or not filled[0].is_white or all(shape.is_white for shape in filled):
        return filled, ()
    others = np.concatenate([chain for shape in filled[1:] for chain in shape.chains])
    page = np.concatenate(filled[0].chains)
    slack = 1e-6 * np.ptp(page, axis=0)
    if np.all(others.min(axis=0) >= page.min(axis=0) - slack) and np.all(
        others.max(axis=0) <= page.max(axis=0) + slack
    ):
        return filled[1:], (tr("The white background was left out."),)
    return filled, ()


def _drawn(elements: Iterable[tuple[Any, str]], scale: float, budget: TimeBudget) -> Iterator[Drawn]:
    """Visible shapes, flattened, pixels times ``scale``."""
    for shape, layer in elements:
        budget.check()
        if not isinstance(shape, svgelements.Shape) or not _is_visible(shape):
            continue
        # Reified here: a turned ellipse or rectangle keeps its transform until it is a path.
        path = svgelements.Path(shape).reify()
        chains = tuple(chain * scale for chain in flattened(path) if len(chain) > 1)
        is_filled = _is_painted(shape, "fill") and not isinstance(shape, svgelements.SimpleLine)
        is_stroked = _is_painted(shape, "stroke")
        if chains and (is_filled or is_stroked):
            is_even_odd = str(shape.values.get("fill-rule", "")).strip() == "evenodd"
            pen = _pen(shape, scale) if is_stroked else None
            colour = _colour(shape.fill if is_filled else shape.stroke)
            yield Drawn(chains, is_filled, _is_white(shape), is_even_odd, _name(shape), layer, colour, pen)


def _name(shape: Any) -> str:
    own = shape.values.get("attributes") or {}
    label = next((str(text) for key, text in own.items() if key.endswith("}label")), "")
    return (label or str(own.get("id") or ""))[:60]


def _colour(colour: Any) -> str:
    if colour is None or colour.value is None:
        return ""
    return f"#{colour.red:02x}{colour.green:02x}{colour.blue:02x}"


def _pen(shape: Any, scale: float) -> StrokeStyle:
    """How a shape is stroked."""
    width, values = shape.stroke_width, shape.values
    width = float(width) * scale if isinstance(width, int | float) and np.isfinite(width) and width > 0 else scale
    cap = CAPS.get(str(values.get("stroke-linecap", "butt")).strip(), "flat")
    join = JOINS.get(str(values.get("stroke-linejoin", "miter")).strip(), "mitre")
    return StrokeStyle(width, cap, join, _number(values.get("stroke-miterlimit"), 4.0))


def flattened(path: Any, tolerance: float | None = None) -> list[FloatArray]:
    """Return the subpaths of an ``svgelements.Path`` as chains of vertices.

    Parameters
    ----------
    path : svgelements.Path
        With its transform applied.
    tolerance : float, optional
        Largest distance between a curve and its chords, path units; by default ``FLATNESS`` of the path's size.

    Returns
    -------
    chains : list of (P, 2) float
        A closed subpath ends on its first vertex; an open one does not.

    Raises
    ------
    TargetError
        A coordinate is not finite, or the chains would have more than ``MOST_VERTICES`` vertices.
    """
    chains: list[list[FloatArray]] = []  # each a start, and the controls of every segment behind it
    current: list[FloatArray] = []
    for segment in path:
        if isinstance(segment, svgelements.Move):
            chains.append(current)
            current = [_points(segment.end)] if segment.end is not None else []
        elif isinstance(segment, svgelements.Close):
            start = current[:1]
            chains.append([*current, *start])
            current = start  # After Z the next segment starts at the subpath's start.
        elif segment.end is not None and (current or segment.start is not None):
            current = current or [_points(segment.start)]
            current.extend(_controls(segment))
    chains = [chain for chain in (*chains, current) if len(chain) > 1]
    if not chains:
        return []
    corners = np.concatenate([controls for chain in chains for controls in chain])
    with np.errstate(over="ignore", invalid="ignore"):
        size = float(np.max(np.ptp(corners, axis=0)))
    if not np.isfinite(size):
        raise TargetError("drawing.not_finite")
    error = FLATNESS * size if tolerance is None else tolerance
    segments = [[chain[0], *map(_behind, chain, chain[1:])] for chain in chains]
    if (vertices := sum(_vertices_of(chain, error) for chain in segments)) > MOST_VERTICES:
        raise TargetError("drawing.too_many_vertices", vertices=vertices, limit=MOST_VERTICES)
    return [
        np.concatenate([one if len(one) == 1 else flattened_curve(one, error) for one in chain]) for chain in segments
    ]


def _behind(before: FloatArray, controls: FloatArray) -> FloatArray:
    """The end of a line, or the controls of a curve with its start, which is the end of what is ``before`` it."""
    return controls if len(controls) == 1 else np.concatenate([before[-1:], controls])


def _vertices_of(chain: list[FloatArray], tolerance: float) -> int:
    """How many vertices it has when it is flattened; curves are counted together, which takes no time."""
    by_length = [[one for one in chain if len(one) == length] for length in (1, 3, 4)]
    return len(by_length[0]) + sum(int(curve_pieces(np.stack(same), tolerance).sum()) for same in by_length[1:] if same)


def _points(*points: Any) -> FloatArray:
    return np.array([(float(point.x), float(point.y)) for point in points])


def _controls(segment: Any) -> list[FloatArray]:
    """Controls of one segment without its start; several where it is an arc."""
    if isinstance(segment, svgelements.QuadraticBezier):
        return [_points(segment.control, segment.end)]
    if isinstance(segment, svgelements.CubicBezier):
        return [_points(segment.control1, segment.control2, segment.end)]
    if isinstance(segment, svgelements.Arc) and segment.rx and segment.ry:
        pieces = int(np.clip(np.ceil(abs(segment.sweep) / (np.pi / 8)), 1, 64))
        return [controls for cubic in segment.as_cubic_curves(pieces) for controls in _controls(cubic)]
    return [_points(segment.end)]


def _is_visible(element: Any) -> bool:
    values = element.values
    hidden = str(values.get("visibility", "visible")).strip() in ("hidden", "collapse")
    return not hidden and not str(values.get("display", "")).strip().startswith("none") and _opacity(values) > 0


def _is_painted(element: Any, paint: str) -> bool:
    """Whether ``fill`` or ``stroke`` is visible; gradients and patterns count."""
    colour = str(element.values.get(paint, "none")).strip().lower()
    return colour not in ("none", "transparent", "") and _opacity(element.values, f"{paint}-") > 0


def _opacity(values: dict[str, Any], prefix: str = "") -> float:
    return _number(values.get(f"{prefix}opacity"), 1.0)


def _number(stated: Any, otherwise: float) -> float:
    try:
        return float(str(stated).strip().removesuffix("%"))
    except ValueError:
        return otherwise


def _is_white(element: Any) -> bool:
    fill = element.fill
    if fill is None or fill.value is None:
        return False
    return bool(min(fill.red, fill.green, fill.blue) >= 250)


def _left_out(svg: Any) -> tuple[str, ...]:
    """Notes on visible parts that have no outline of their own."""
    elements = list(svg.elements())
    sentences = []
    if any(isinstance(element, svgelements.Text) and str(element.text or "").strip() for element in elements):
        sentences.append(text_left_out())
    if any(isinstance(element, svgelements.Image) for element in elements):
        sentences.append(tr("An embedded picture was left out. Export it as PNG if it is the shape."))
    return tuple(sentences)
