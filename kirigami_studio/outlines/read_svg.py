"""SVG drawings -> Outline: outer boundary of everything filled, or of the closed strokes."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
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
from kirigami_studio.outlines.contour import thinned
from kirigami_studio.outlines.joining import join
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.pieces import enclosed, largest_piece
from kirigami_studio.outlines.source_file import decoding, read_bytes
from kirigami_studio.outlines.svg_safety import checked_svg

#: The library's calls carry no types; its values are checked here instead.
svgelements: Any = untyped_svgelements

#: Resolution that CSS defines for lengths in millimetres or inches.
PIXELS_PER_INCH = 96.0

#: An open stroke whose ends are nearer than this share of its size is meant to be closed.
WIDEST_GAP = 0.02

#: Deviation of flattened curves from the true ones, share of the shape's size.
FLATNESS = 1.0 / 4000.0

#: Pieces of one curve segment at most: finer than any tolerance in use asks for, and a bound on memory.
MOST_PIECES = 1000


@dataclass(frozen=True, slots=True)
class Drawn:
    """One visible shape: its subpaths, y down, and how it is painted."""

    chains: tuple[FloatArray, ...]
    is_filled: bool
    is_white: bool
    is_even_odd: bool


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
        checked, width_mm, notes = checked_svg(content)
        svg = svgelements.SVG.parse(io.BytesIO(checked), reify=True, ppi=PIXELS_PER_INCH)
        scale, unit = (width_mm / svg.width, "mm") if width_mm and svg.width else (1.0, "px")
        ring, found = _ring(list(_drawn(svg.elements(), scale)), _left_out(svg), unit)
        # Turned upright last, so that places in sentences are those that a drawing program shows.
        down = Outline.from_points(thinned(ring), name=path.stem, notes=(*notes, *found), unit=unit)
        return Outline((down.points * (1.0, -1.0))[::-1], down.name, down.notes, down.size, unit)


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
        if left_out:
            raise TargetError("svg.no_shape_but_others", left_out=" ".join(left_out))
        raise TargetError("svg.no_shape")
    elif len(strokes) == 1 and np.array_equal(strokes[0][0], strokes[0][-1]):
        return strokes[0], notes
    else:
        region, joints = join(strokes, WIDEST_GAP, unit)
        notes = (*notes, *joints)
    ring, dropped = largest_piece(region)
    return ring, (*notes, *dropped)


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


def _drawn(elements: Iterable[Any], scale: float) -> Iterator[Drawn]:
    """Visible shapes, flattened, pixels times ``scale``."""
    shapes = [element for element in elements if isinstance(element, svgelements.Shape) and _is_visible(element)]
    # Reified here: a turned ellipse or rectangle keeps its transform until it is a path.
    paths = [svgelements.Path(shape).reify() for shape in shapes]
    for shape, path in zip(shapes, paths, strict=True):
        box = path.bbox()
        if box is None:
            continue
        left, top, right, bottom = (float(side) for side in box)
        if not np.isfinite([right - left, bottom - top]).all():
            raise TargetError("drawing.not_finite")
        tolerance = max(right - left, bottom - top) * FLATNESS
        chains = tuple(chain * scale for chain in flattened(path, tolerance) if len(chain) > 1)
        is_filled = _is_painted(shape, "fill") and not isinstance(shape, svgelements.SimpleLine)
        if chains and (is_filled or _is_painted(shape, "stroke")):
            is_even_odd = str(shape.values.get("fill-rule", "")).strip() == "evenodd"
            yield Drawn(chains, is_filled, _is_white(shape), is_even_odd)


def flattened(path: Any, tolerance: float) -> list[FloatArray]:
    """Return the subpaths of an ``svgelements.Path`` as chains of vertices.

    Parameters
    ----------
    path : svgelements.Path
        With its transform applied.
    tolerance : float
        Largest distance between a curve and its chords, path units.

    Returns
    -------
    chains : list of (P, 2) float
        A closed subpath ends on its first vertex; an open one does not.
    """
    chains: list[FloatArray] = []
    current: list[tuple[float, float]] = []
    for segment in path:
        if isinstance(segment, svgelements.Move):
            _finish(current, chains)
            current = [_pair(segment.end)] if segment.end is not None else []
        elif isinstance(segment, svgelements.Close):
            start = current[0] if current else None
            _finish([*current, *current[:1]], chains)
            current = [start] if start is not None else []  # After Z the next segment starts at the subpath's start.
        elif segment.end is not None and (current or segment.start is not None):
            current = current or [_pair(segment.start)]
            current.extend(_vertices(segment, tolerance))
    _finish(current, chains)
    return chains


def _finish(vertices: list[tuple[float, float]], chains: list[FloatArray]) -> None:
    if len(vertices) > 1:
        chains.append(np.array(vertices, dtype=np.float64))


def _pair(point: Any) -> tuple[float, float]:
    return float(point.x), float(point.y)


def _vertices(segment: Any, tolerance: float) -> list[tuple[float, float]]:
    """Vertices of one segment without its start."""
    if isinstance(segment, svgelements.QuadraticBezier):
        return _bezier([segment.start, segment.control, segment.end], tolerance)
    if isinstance(segment, svgelements.CubicBezier):
        return _bezier([segment.start, segment.control1, segment.control2, segment.end], tolerance)
    if isinstance(segment, svgelements.Arc) and segment.rx and segment.ry:
        cubics = segment.as_cubic_curves(max(1, int(np.ceil(abs(segment.sweep) / (np.pi / 8)))))
        return [vertex for cubic in cubics for vertex in _vertices(cubic, tolerance)]
    return [_pair(segment.end)]


def _bezier(controls: list[Any], tolerance: float) -> list[tuple[float, float]]:
    """Evenly spaced parameters; their number follows from the chord error ``h^2 / 8 * max|B''|``."""
    corners = np.array([_pair(point) for point in controls])
    degree = len(corners) - 1
    bend = degree * (degree - 1) * float(np.max(np.linalg.norm(np.diff(corners, n=2, axis=0), axis=1)))
    pieces = int(np.clip(np.ceil(np.sqrt(bend / (8.0 * max(tolerance, 1e-300)))), 1, MOST_PIECES))
    t = np.arange(1, pieces + 1)[:, None] / pieces
    for _ in range(degree):  # de Casteljau, all parameters at once
        corners = corners[..., :-1, :] * (1 - t)[..., None] + corners[..., 1:, :] * t[..., None]
    return [(float(x), float(y)) for x, y in corners[:, 0]]


def _is_visible(element: Any) -> bool:
    values = element.values
    hidden = str(values.get("visibility", "visible")).strip() in ("hidden", "collapse")
    return not hidden and not str(values.get("display", "")).strip().startswith("none") and _opacity(values) > 0


def _is_painted(element: Any, paint: str) -> bool:
    """Whether ``fill`` or ``stroke`` is visible; gradients and patterns count."""
    colour = str(element.values.get(paint, "none")).strip().lower()
    return colour not in ("none", "transparent", "") and _opacity(element.values, f"{paint}-") > 0


def _opacity(values: dict[str, Any], prefix: str = "") -> float:
    stated = str(values.get(f"{prefix}opacity", "1")).strip()
    try:
        return float(stated.removesuffix("%"))
    except ValueError:
        return 1.0


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
        sentences.append(tr("Text was left out. Convert it to paths if it belongs to the shape."))
    if any(isinstance(element, svgelements.Image) for element in elements):
        sentences.append(tr("An embedded picture was left out. Export it as PNG if it is the shape."))
    return tuple(sentences)
