"""An SVG as it is painted: visible shapes and texts, with paint, pen and clip.

Everything lies in one frame, the page's, y down, in the unit that it is scaled to.  Groups, ``use``, symbols, nested
drawings, ``switch``, transforms, clip paths and masks are resolved here; the cascade is
:mod:`~kirigami_studio.outlines.svg_style`'s.
"""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np
import shapely
import svgelements as untyped_svgelements
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.words import tr
from kirigami_studio.outlines.css_shapes import ELLIPSE_VERTICES, PLACES, basic_shape
from kirigami_studio.outlines.parts import Cap, Corner, StrokeStyle, stroked
from kirigami_studio.outlines.pieces import painted
from kirigami_studio.outlines.source_file import TimeBudget
from kirigami_studio.outlines.svg_curves import Vertex, checked, flattened, turned, vertices_of
from kirigami_studio.outlines.svg_safety import MM_PER_UNIT, reference_of, tag_of
from kirigami_studio.outlines.svg_style import REFERENCE, Cascade, Properties, colour_of, computed, share_of
from kirigami_studio.outlines.text_curves import Text

#: The library's calls carry no types; its values are checked here instead.
svgelements: Any = untyped_svgelements

#: Pixels in a millimetre, as CSS defines them.
PIXELS_PER_MM = 96.0 / 25.4
#: Paint of less opacity is not seen.
LEAST_SEEN = 0.01
#: Levels of red, green and blue from which on paint is white.
WHITE = 250.0 / 255.0
#: Steps from one gradient to another that its stops may be taken from.
MOST_LINKS = 8

ANCHORS = {"start": 0.0, "middle": 0.5, "end": 1.0}
#: Names of SVG for the ends and corners of strokes, and ours.
CAPS: Mapping[str, Cap] = {"butt": "flat", "round": "round", "square": "square"}
JOINS: Mapping[str, Corner] = {"miter": "mitre", "round": "round", "bevel": "bevel"}
GROUPS = frozenset({"g", "a", "svg", "switch", "use", "symbol"})
SHAPES = frozenset({"path", "rect", "circle", "ellipse", "line", "polyline", "polygon"})
NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
LENGTH = re.compile(rf"\s*({NUMBER.pattern})\s*([a-zA-Z]*|%)\s*")
#: Functions of CSS that change what is seen of a shape, and elements of filters that change colours alone.
FILTERS = re.compile(r"blur|shadow", re.IGNORECASE)
RECOLOURING = frozenset({"feColorMatrix", "feComponentTransfer", ""})
#: Lines that have markers, how many are painted at most, and their lengths.
MARKED, MOST_MARKERS = frozenset({"path", "line", "polyline", "polygon"}), 2_000
MARKER_SIZE = ("markerWidth", "markerHeight")
#: Letters of a shape of CSS that is looked at.
LONGEST_SHAPE = 10_000
# Names begin at their first letter alone and are short: a long word without a parenthesis took half a minute.
TRANSFORM = re.compile(r"(?<![a-zA-Z])([a-zA-Z]{1,16})\s*\(([^()]*)\)")
Paint = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Drawn:
    """One visible shape: its subpaths, y down, and how it is painted."""

    chains: tuple[FloatArray, ...]  #: tuple of (P, 2) float, drawing units; a closed one repeats its first vertex
    fill: Paint | None  #: red, green, blue and opacity, 0..1; None where it is not filled
    stroke: Paint | None  #: None where it has no visible stroke
    is_even_odd: bool
    pen: StrokeStyle
    name: str
    layer: str
    clip: BaseGeometry | None  #: drawing units; what is seen lies inside; None where nothing is cut off

    def region(self) -> BaseGeometry:
        """The filled region, holes left open."""
        filled = painted([chain for chain in self.chains if len(chain) > 2], self.is_even_odd)
        return filled if self.clip is None else filled.intersection(self.clip)

    def seen(self) -> BaseGeometry:
        """The region that fill and stroke cover together."""
        parts = [self.region()] if self.fill is not None else []
        if self.stroke is not None:
            line = stroked(self.chains, self.pen, self.pen.width)
            parts.append(line if self.clip is None else line.intersection(self.clip))
        return shapely.union_all(parts)


@dataclass(frozen=True, slots=True, eq=False)
class SvgDrawing:
    """Everything visible in a file, and a sentence on each kind of thing that was left out."""

    drawn: tuple[Drawn, ...]
    texts: tuple[Text, ...]
    left_out: tuple[str, ...]
    page: tuple[float, float] | None  #: drawing units; width and height of the page; None where they are not stated


@dataclass(frozen=True, slots=True, eq=False)
class _Frame:
    """Where an element is painted."""

    matrix: FloatArray  #: (3, 3) float; from the element's user space to the page
    view: tuple[float, float]  #: user units; width and height that percentages are of
    style: Properties = field(default_factory=dict)
    opacity: float = 1.0
    clip: BaseGeometry | None = None
    layer: str = ""
    name: str = ""  #: of the ``use`` that shows it
    makes_clip: bool = False  #: whether shapes count by their fill, whatever their paint is
    is_measured: bool = False  #: whether only the extent counts: nothing is clipped
    inside: tuple[Element, ...] = ()  #: clip paths and masks that are being made


def svg_drawing(root: Element, scale: float, budget: TimeBudget, finer: float = 1.0) -> SvgDrawing:
    """Everything painted in a checked document.

    Parameters
    ----------
    scale : float
        Drawing units to a pixel.
    finer : float
        How many times nearer to curves than usual chords stay.

    Raises
    ------
    TargetError
        It takes too long, has coordinates that are no numbers, or far too many curves or rules.
    """
    return _Painter(root, scale, budget, finer).drawing()


class _Painter:
    def __init__(self, root: Element, scale: float, budget: TimeBudget, finer: float) -> None:
        self._root, self._scale, self._budget, self._finer = root, scale, budget, finer
        self._cascade = Cascade(root)
        self._named: dict[str, Element] = {}
        for element in root.iter():
            if name := element.get("id"):
                self._named.setdefault(name, element)
        self._texts: list[Text] = []
        self._said: dict[str, str] = {}
        self._clips: dict[tuple[Element, bytes], BaseGeometry] = {}
        self._marked = 0

    def drawing(self) -> SvgDrawing:
        size = self._page()
        is_stated = _view_box(self._root) is not None or None not in map(
            _stated_length, (self._root.get("width"), self._root.get("height"))
        )
        to_page = np.diag([self._scale, self._scale, 1.0]) @ _viewport(self._root, (0.0, 0.0, *size))
        page = (size[0] * self._scale, size[1] * self._scale)
        frame = _Frame(to_page, self._view(self._root, size))
        drawn = tuple(self._children(self._root, replace(frame, style=self._style(self._root, frame))))
        return SvgDrawing(drawn, tuple(self._texts), tuple(self._said.values()), page if is_stated else None)

    def _page(self) -> tuple[float, float]:
        """Width and height of the page, pixels; those of its view where they are not stated."""
        box = _view_box(self._root)
        stated = [_stated_length(self._root.get(name)) for name in ("width", "height")]
        if box is None:
            width, height = (100.0 if one is None else one for one in stated)
        else:
            *_, across, down = box
            width = stated[0] if stated[0] is not None else across * (stated[1] / down if stated[1] else 1.0)
            height = stated[1] if stated[1] is not None else down * (width / across)
        return width, height

    def _view(self, element: Element, size: tuple[float, float]) -> tuple[float, float]:
        box = _view_box(element)
        return size if box is None else (box[2], box[3])

    def _style(self, element: Element, frame: _Frame) -> dict[str, str]:
        return computed(self._cascade.declared(element), frame.style)

    def _children(self, element: Element, frame: _Frame) -> Iterator[Drawn]:
        for child in element:
            yield from self._walk(child, frame)

    def _walk(self, element: Element, frame: _Frame) -> Iterator[Drawn]:
        """Shapes in the order in which they are painted."""
        self._budget.check()
        tag = tag_of(element)
        if tag == "image":
            self._say("image", tr("An embedded picture was left out. Export it as PNG if it is the shape."))
        if tag not in GROUPS and tag not in SHAPES and tag != "text":
            return
        if tag == "symbol" or not _applies(element):
            return
        style = self._style(element, frame)
        opacity = frame.opacity * share_of(style.get("opacity"))
        if style.get("display", "").strip() == "none" or (opacity < LEAST_SEEN and not frame.makes_clip):
            return
        if not frame.makes_clip and self._changes_shape(style.get("filter", "none").strip()):
            self._say("filter", tr("Filters such as blur and shadows were left out."))
        inner = replace(frame, style=style, opacity=opacity)
        inner = replace(inner, matrix=frame.matrix @ self._transform(element, inner))
        inner = self._clipped(element, inner)
        if inner.clip is not None and inner.clip.is_empty:
            return
        if tag == "text":
            if not frame.makes_clip and not frame.is_measured:
                self._texts += self._lines(element, inner)
        elif tag in SHAPES:
            yield from self._shape(element, tag, inner)
            if tag in MARKED and not frame.makes_clip and not frame.is_measured:
                yield from self._markers(element, tag, inner)
        else:
            yield from self._group(element, tag, inner)

    def _group(self, element: Element, tag: str, frame: _Frame) -> Iterator[Drawn]:
        layer = _layer_of(element, frame.layer)
        if tag == "switch":
            chosen = next((child for child in element if _applies(child) and tag_of(child)), None)
            if chosen is not None:
                yield from self._walk(chosen, replace(frame, layer=layer))
        elif tag == "svg":
            yield from self._nested(element, element, replace(frame, layer=layer))
        elif tag == "use":
            target = self._named.get(reference_of(element))
            if target is None:
                return
            across, down = (self._length(element, name, frame, axis) for axis, name in enumerate(("x", "y")))
            frame = replace(frame, matrix=frame.matrix @ _moved(across, down), name=_name(element))
            if tag_of(target) in ("symbol", "svg"):
                if _applies(target):
                    yield from self._nested(target, element, replace(frame, style=self._style(target, frame)))
            else:
                yield from self._walk(target, replace(frame, layer=layer))
        else:
            yield from self._children(element, replace(frame, layer=layer))

    def _nested(self, element: Element, stating: Element, frame: _Frame) -> Iterator[Drawn]:
        """Shapes of a nested drawing or a symbol; ``stating`` has its width and height."""
        corner = [self._length(element, name, frame, axis) for axis, name in enumerate(("x", "y"))]
        size = []
        for axis, name in enumerate(("width", "height")):
            stated = stating.get(name) or element.get(name) or "100%"
            size.append(self._length_of(stated, frame, axis, frame.view[axis]))
        if tag_of(element) == "symbol":
            corner = [0.0, 0.0]
        if min(size) <= 0.0:
            return
        matrix = frame.matrix
        if not frame.is_measured and frame.style.get("overflow", "hidden").strip() not in ("visible", "auto"):
            states_size = any(one.get(name) for one in (stating, element) for name in ("width", "height"))
            if _view_box(element) is not None or states_size:
                edges = np.array([corner, [corner[0] + size[0], corner[1] + size[1]]])
                window = Polygon(_placed(np.array([(edges[i, 0], edges[j, 1]) for i, j in CORNERS]), matrix))
                frame = replace(frame, clip=window if frame.clip is None else window.intersection(frame.clip))
        inner = _viewport(element, (corner[0], corner[1], size[0], size[1]))
        view = self._view(element, (size[0], size[1]))
        yield from self._children(element, replace(frame, matrix=matrix @ inner, view=view))

    def _shape(self, element: Element, tag: str, frame: _Frame) -> Iterator[Drawn]:
        style = frame.style
        if style.get("visibility", "visible").strip() in ("hidden", "collapse"):
            return
        fill = self._paint(style, "fill", frame.opacity) if tag != "line" else None
        stroke = self._paint(style, "stroke", frame.opacity)
        width = self._length_of(style.get("stroke-width", "1"), frame, None, 1.0)
        stroke = stroke if width > 0.0 else None
        if frame.makes_clip:
            fill, stroke = (1.0, 1.0, 1.0, 1.0), None
        if fill is None and stroke is None:
            return
        chains = tuple(chain for chain in self._chains(element, tag, frame) if len(chain) > 1)
        if not chains:
            return
        keeps_width = style.get("vector-effect", "").strip() == "non-scaling-stroke"
        width *= self._scale if keeps_width else float(np.sqrt(abs(np.linalg.det(frame.matrix[:2, :2]))))
        cap = CAPS.get(style.get("stroke-linecap", "butt").strip(), "flat")
        join = JOINS.get(style.get("stroke-linejoin", "miter").strip(), "mitre")
        pen = StrokeStyle(width, cap, join, _number(style.get("stroke-miterlimit"), 4.0))
        rule = style.get("clip-rule" if frame.makes_clip else "fill-rule", "").strip()
        clip = frame.clip
        if clip is not None:
            corners = np.concatenate(chains)
            slack = 0.5 * width if stroke is not None else 0.0
            extent = shapely.box(*(corners.min(axis=0) - slack), *(corners.max(axis=0) + slack))
            clip = None if clip.covers(extent) else clip
        yield Drawn(chains, fill, stroke, rule == "evenodd", pen, _name(element) or frame.name, frame.layer, clip)

    def _markers(self, element: Element, tag: str, frame: _Frame) -> Iterator[Drawn]:
        """Shapes of the markers on the vertices of a line."""
        found: list[Element | None] = []
        for end in ("start", "mid", "end"):
            link = REFERENCE.match(frame.style.get(f"marker-{end}", "none"))
            marker = None if link is None else self._named.get(link["name"])
            found.append(None if marker is None or tag_of(marker) != "marker" or marker in frame.inside else marker)
        if not any(one is not None for one in found) or frame.style.get("visibility", "visible").strip() != "visible":
            return
        width = self._length_of(frame.style.get("stroke-width", "1"), frame, None, 1.0)
        vertices = self._vertices(element, tag, frame)
        for index, vertex in enumerate(vertices):
            marker = found[0 if index == 0 else 2 if index == len(vertices) - 1 else 1]
            if marker is None:
                continue
            self._budget.check()
            self._marked += 1
            if self._marked > MOST_MARKERS:
                self._say("marker", tr("Arrow heads and other markers on lines were left out."))
                return
            yield from self._marker(marker, vertex, width, index == 0, frame)

    def _marker(self, marker: Element, vertex: Vertex, width: float, begins: bool, frame: _Frame) -> Iterator[Drawn]:
        stated = marker.get("orient", "0").strip()
        turn = vertex.way if stated.startswith("auto") else _angle(stated)
        turn += np.pi if stated == "auto-start-reverse" and begins else 0.0
        size = [self._length_of(marker.get(name, "3"), frame, axis, 3.0) for axis, name in enumerate(MARKER_SIZE)]
        scale = 1.0 if marker.get("markerUnits", "").strip() == "userSpaceOnUse" else width
        if not (np.isfinite(turn) and scale > 0.0 and min(size) > 0.0):
            return
        view = _viewport(marker, (0.0, 0.0, size[0], size[1]))
        inner = self._view(marker, (size[0], size[1]))
        origin = [
            PLACES[word] * inner[axis] if (word := marker.get(name, "0").strip()) in PLACES else _number(word, 0.0)
            for axis, name in enumerate(("refX", "refY"))
        ]
        across, down, _ = view @ (*origin, 1.0)
        place = frame.matrix @ _moved(*vertex.place) @ np.diag([scale, scale, 1.0])
        cos, sin = np.cos(turn), np.sin(turn)
        place = place @ np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]) @ _moved(-across, -down)
        blank = _Frame(place @ view, inner, opacity=frame.opacity, clip=frame.clip, layer=frame.layer)
        style = self._style(marker, blank)
        if style.get("overflow", "hidden").strip() not in ("visible", "auto"):
            window = Polygon(_placed(np.array([(x * size[0], y * size[1]) for x, y in CORNERS]), place))
            blank = replace(blank, clip=window if frame.clip is None else window.intersection(frame.clip))
        yield from self._children(marker, replace(blank, style=style, inside=(*frame.inside, marker)))

    def _vertices(self, element: Element, tag: str, frame: _Frame) -> list[Vertex]:
        """The vertices of a line in its user space."""
        if tag == "path":
            path = svgelements.Path()
            with contextlib.suppress(ValueError, IndexError, TypeError, AttributeError, ArithmeticError):
                path.parse(element.get("d", ""))
            return vertices_of(path)
        chains = self._chains(element, tag, replace(frame, matrix=np.eye(3)))
        points = chains[0] if chains else np.zeros((0, 2))
        ways = np.diff(points, axis=0)
        return turned([*points], [np.zeros(2), *ways], [*ways, np.zeros(2)])

    def _chains(self, element: Element, tag: str, frame: _Frame) -> list[FloatArray]:
        """The subpaths of a shape on the page."""
        if tag in ("polyline", "polygon"):
            numbers = [float(text) for text in NUMBER.findall(element.get("points", ""))]
            corners = np.array(numbers[: len(numbers) // 2 * 2], dtype=np.float64).reshape(-1, 2)
            if len(corners) == 0:
                return []
            corners = np.concatenate([corners, corners[:1]]) if tag == "polygon" else corners
            return [checked(_placed(corners, frame.matrix))]
        size = {
            name: self._length(element, name, frame, AXES[name])
            for name in LENGTHS.get(tag, ())
            if element.get(name, "auto").strip() != "auto"
        }
        if tag == "path":
            path = svgelements.Path()
            try:
                path.parse(element.get("d", ""))
            except (ValueError, IndexError, TypeError, AttributeError, ArithmeticError):
                self._say("path", tr("A path is damaged: it was read up to the damage. Check the shape."))
            if len(path) and not isinstance(path[0], svgelements.Move):
                return []
        elif tag == "line":
            ends = [(size.get(f"x{end}", 0.0), size.get(f"y{end}", 0.0)) for end in (1, 2)]
            return [checked(_placed(np.array(ends), frame.matrix))]
        elif tag == "rect":
            if min(size.get("width", 0.0), size.get("height", 0.0)) <= 0.0:
                return []
            path = svgelements.Path(svgelements.Rect(**size))
        else:
            radii = (size.get("r"),) * 2 if tag == "circle" else (size.get("rx"), size.get("ry"))
            rx, ry = (one if one is not None else other for one, other in (radii, radii[::-1]))
            if rx is None or ry is None or min(rx, ry) <= 0.0:
                return []
            angle = np.linspace(0.0, 2.0 * np.pi, round(ELLIPSE_VERTICES * np.sqrt(self._finer)) + 1)
            ring = np.column_stack([size.get("cx", 0.0) + rx * np.cos(angle), size.get("cy", 0.0) + ry * np.sin(angle)])
            ring[-1] = ring[0]
            return [checked(_placed(ring, frame.matrix))]
        return flattened(path, frame.matrix, self._finer)

    # paint -----------------------------------------------------------------------------------------------------------

    def _paint(self, style: Properties, kind: str, opacity: float) -> Paint | None:
        """The paint of ``fill`` or ``stroke``; None where nothing is seen of it."""
        text = style.get(kind, "black" if kind == "fill" else "none").strip()
        opacity *= share_of(style.get(f"{kind}-opacity"))
        paint: Paint | None = (0.5, 0.5, 0.5, 1.0)  # patterns, and what leads nowhere
        if (link := REFERENCE.match(text)) is not None:
            server = self._named.get(link["name"])
            if server is not None and tag_of(server).endswith("Gradient"):
                paint = self._gradient(server)
            elif server is None and link["otherwise"].strip():
                text, link = link["otherwise"].strip(), None
        if link is None:
            if text.lower() == "none":
                return None
            paint = colour_of(text, style.get("color", "black"))
            if text.lower().startswith("context-"):
                paint = (0.5, 0.5, 0.5, 1.0)  # of the line that a marker is on
            elif paint is None:
                paint = (0.0, 0.0, 0.0, 1.0) if kind == "fill" else None
        if paint is None or paint[3] * opacity < LEAST_SEEN:
            return None
        return (*paint[:3], paint[3] * opacity)

    def _gradient(self, server: Element) -> Paint | None:
        """The most opaque stop of a gradient; None without stops."""
        for _ in range(MOST_LINKS):
            stops = [child for child in server if tag_of(child) == "stop"]
            if stops:
                found = []
                for stop in stops:
                    style = computed(self._cascade.declared(stop), {})
                    colour = colour_of(style.get("stop-color", "black"), style.get("color", "black"))
                    red, green, blue, opacity = colour or (0.0, 0.0, 0.0, 1.0)
                    found.append((red, green, blue, opacity * share_of(style.get("stop-opacity"))))
                return max(found, key=lambda paint: paint[3])
            other = self._named.get(reference_of(server))
            if other is None:
                return None
            server = other
        return None

    def _changes_shape(self, stated: str) -> bool:
        """Whether a filter does more than to change colours."""
        if (link := REFERENCE.match(stated)) is None:
            return FILTERS.search(stated) is not None
        source = self._named.get(link["name"])
        return source is not None and any(tag_of(one) not in RECOLOURING for one in source)

    # clip paths and masks --------------------------------------------------------------------------------------------

    def _clipped(self, element: Element, frame: _Frame) -> _Frame:
        if frame.is_measured:
            return frame
        for kind in ("clip-path", "mask"):
            stated = frame.style.get(kind, "none").strip()
            if stated == "none":
                continue
            link = REFERENCE.match(stated)
            source = self._named.get(link["name"]) if link is not None else None
            if link is None:
                region = self._basic_shape(stated, element, frame) if kind == "clip-path" else None
                if region is None:
                    self._say("clip", tr("Clip paths of other kinds are not followed. Cut the shape itself."))
                    continue
            else:
                is_such = source is not None and tag_of(source) == {"clip-path": "clipPath", "mask": "mask"}[kind]
                if source is None or not is_such or source in frame.inside:
                    continue
                region = self._region_of(source, element, frame)
            frame = replace(frame, clip=region if frame.clip is None else region.intersection(frame.clip))
        return frame

    def _basic_shape(self, stated: str, element: Element, frame: _Frame) -> BaseGeometry | None:
        """The region of a shape that CSS states, on the page; None where it is not understood."""
        shape = basic_shape(stated[:LONGEST_SHAPE])
        if shape is None:
            return None
        if shape.reference == "view-box":
            box = (0.0, 0.0, *frame.view)
        else:
            box = self._extent(element, frame)
            if shape.reference != "fill-box" and self._paint(frame.style, "stroke", 1.0) is not None:
                half = 0.5 * self._length_of(frame.style.get("stroke-width", "1"), frame, None, 1.0)
                box = (box[0] - half, box[1] - half, box[2] + half, box[3] + half)
        found = shape.ring(box, lambda word, whole: self._length_of(word, frame, None, np.nan, whole))
        if found is None:
            return None
        ring, is_even_odd = found
        return painted([checked(_placed(ring, frame.matrix))], is_even_odd) if len(ring) else Polygon()

    def _region_of(self, source: Element, element: Element, frame: _Frame) -> BaseGeometry:
        """The region of a clip path or a mask for an element, on the page."""
        is_clip = tag_of(source) == "clipPath"
        units = source.get("clipPathUnits" if is_clip else "maskContentUnits", "userSpaceOnUse").strip()
        matrix, view = frame.matrix, frame.view
        if units == "objectBoundingBox":
            left, top, right, bottom = self._extent(element, frame)
            matrix = matrix @ np.array([[right - left, 0.0, left], [0.0, bottom - top, top], [0.0, 0.0, 1.0]])
            view = (1.0, 1.0)
        key = source, matrix.tobytes()
        if key not in self._clips:
            blank = _Frame(matrix, view, makes_clip=is_clip, inside=(*frame.inside, source))
            inner = replace(blank, style=self._style(source, blank))
            inner = replace(inner, matrix=matrix @ self._transform(source, inner))
            inner = self._clipped(source, inner)
            region: BaseGeometry = Polygon()
            if is_clip:
                region = shapely.union_all([shape.region() for shape in self._children(source, inner)])
            else:
                keeps_colour = source.get("mask-type") == "alpha" or "mask-type:alpha" in source.get(
                    "style", ""
                ).replace(" ", "")
                for shape in self._children(source, inner):
                    red, green, blue, opacity = shape.fill or shape.stroke or (0.0, 0.0, 0.0, 0.0)
                    light = opacity if keeps_colour else opacity * (0.2125 * red + 0.7154 * green + 0.0721 * blue)
                    if light >= 0.5:
                        region = region.union(shape.seen())
                    elif opacity >= 0.5 and not keeps_colour:
                        region = region.difference(shape.seen())
            self._clips[key] = region
        return self._clips[key]

    def _extent(self, element: Element, frame: _Frame) -> tuple[float, float, float, float]:
        """Left, top, right and bottom of an element in its user space."""
        measured = replace(frame, matrix=np.eye(3), clip=None, is_measured=True, opacity=1.0, makes_clip=False)
        tag = tag_of(element)
        if tag in SHAPES:
            chains = self._chains(element, tag, measured)
        else:
            shapes = self._group(element, tag, measured) if tag in GROUPS else self._children(element, measured)
            chains = [chain for shape in shapes for chain in shape.chains]
        if not chains:
            return 0.0, 0.0, 0.0, 0.0
        corners = np.concatenate(chains)
        (left, top), (right, bottom) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
        return left, top, right, bottom

    # places ----------------------------------------------------------------------------------------------------------

    def _transform(self, element: Element, frame: _Frame) -> FloatArray:
        """The matrix of an element's transform, about its origin."""
        stated = frame.style.get("transform", "none") if tag_of(element) != "clipPath" else element.get("transform", "")
        stated = stated or element.get("gradientTransform", "")
        if not stated.strip() or stated.strip() == "none":
            return np.eye(3)
        origin = frame.style.get("transform-origin", "").split()
        box = (0.0, 0.0, *frame.view)
        if frame.style.get("transform-box", "").strip() in ("fill-box", "content-box", "border-box", "stroke-box"):
            left, top, right, bottom = self._extent(element, frame)
            box, origin = (left, top, right - left, bottom - top), origin or ["50%", "50%"]
        if len(origin) > 1 and (origin[0] in ("top", "bottom") or origin[1] in ("left", "right")):
            origin = [origin[1], origin[0]]
        place = [box[0], box[1]] if origin else [0.0, 0.0]
        for axis, word in enumerate((*origin, "center")[:2] if origin else ()):
            if word in PLACES:
                place[axis] += PLACES[word] * box[2 + axis]
            else:
                place[axis] += self._length_of(word, frame, axis, 0.0, box[2 + axis])
        matrix = self._matrix(stated, frame, box)
        return _moved(*place) @ matrix @ _moved(-place[0], -place[1])

    def _matrix(self, stated: str, frame: _Frame, box: tuple[float, ...]) -> FloatArray:
        """The product of a list of transforms; the identity where one is not understood."""
        product = np.eye(3)
        for name, arguments in TRANSFORM.findall(stated[:100_000]):
            words = [
                word for word in re.split(r"[\s,]+", re.sub(r"(?<=[\d.])(?=[+-])(?<![eE])", " ", arguments)) if word
            ]
            kind = name.lower()
            if kind.startswith("translate"):
                axes = (1,) if kind.endswith("y") else (0, 1)
                values = [
                    self._length_of(word, frame, axis, 0.0, box[2 + axis])
                    for axis, word in zip(axes, words, strict=False)
                ]
            else:
                values = [
                    _angle(word) if kind in ANGLES and at < ANGLES[kind] else _number(word, np.nan)
                    for at, word in enumerate(words)
                ]
            one = _one_transform(kind, values)
            if one is None or not np.isfinite(one).all():
                return np.eye(3)
            product = product @ one
        return product

    def _length(self, element: Element, name: str, frame: _Frame, axis: int | None) -> float:
        return self._length_of(element.get(name, "0"), frame, axis, 0.0)

    def _length_of(
        self, text: str, frame: _Frame, axis: int | None, otherwise: float, whole: float | None = None
    ) -> float:
        """A length in user units; percentages are of the view's side, or of its diagonal."""
        found = LENGTH.fullmatch(text)
        if found is None:
            return otherwise
        value, unit = float(found[1]), found[2].lower()
        if unit == "%":
            if whole is None:
                whole = frame.view[axis] if axis is not None else float(np.hypot(*frame.view)) / np.sqrt(2.0)
            return 0.01 * value * whole
        if unit in ("em", "rem", "ex", "ch"):
            return value * self._font_size(frame.style) * (1.0 if unit.endswith("em") else 0.5)
        scale = PIXELS.get(unit)
        return otherwise if scale is None else value * scale

    def _font_size(self, style: Properties) -> float:
        found = LENGTH.fullmatch(style.get("font-size", ""))
        if found is None:
            return 16.0
        unit = found[2].lower()
        relative = {"em": 16.0, "rem": 16.0, "%": 0.16, "ex": 8.0}
        return float(found[1]) * (relative[unit] if unit in relative else PIXELS.get(unit, 1.0))

    # texts -----------------------------------------------------------------------------------------------------------

    def _lines(self, element: Element, frame: _Frame) -> list[Text]:
        """The lines of a text: a part that has a place of its own begins one."""
        lines: list[Text] = []
        # The pen's place; x of a line that only says how far below the last one it is.
        place = [0.0, 0.0]

        def add(words: str | None, style: Properties, begins: bool) -> None:
            words = " ".join((words or "").replace("\n", " ").replace("\t", " ").split(" "))
            if lines and not begins:
                lines[-1] = replace(lines[-1], text=lines[-1].text + words)
            elif words.strip() or begins:
                lines.append(self._text(words, place, replace(frame, style=style)))

        def visit(part: Element, style: Properties) -> None:
            if style.get("display", "").strip() == "none" or not _applies(part):
                return
            begins = part is element
            for axis, (at, by) in enumerate((("x", "dx"), ("y", "dy"))):
                inner = replace(frame, style=style)
                if stated := part.get(at, "").replace(",", " ").split():
                    place[axis], begins = self._length_of(stated[0], inner, axis, 0.0), True
                if moved := part.get(by, "").replace(",", " ").split():
                    place[axis] += self._length_of(moved[0], inner, axis, 0.0)
                    begins = begins or axis == 1
            is_seen = style.get("visibility", "visible").strip() == "visible"
            seen = is_seen and self._paint(style, "fill", frame.opacity) is not None
            add(part.text if seen else "", style, begins)
            for child in part:
                if tag_of(child) in ("tspan", "a"):
                    visit(child, self._style(child, replace(frame, style=style)))
                elif tag_of(child) == "textPath":
                    self._say(
                        "text", tr("Text along a path was left out. Convert it to paths if it belongs to the shape.")
                    )
                add(child.tail if seen else "", style, False)

        visit(element, frame.style)
        return [replace(line, text=line.text.strip()) for line in lines if line.text.strip()]

    def _text(self, words: str, place: list[float], frame: _Frame) -> Text:
        style, size = frame.style, self._font_size(frame.style)
        (a, c, _), (b, d, _) = frame.matrix[:2].tolist()
        x, y = _placed(np.array([place]), frame.matrix)[0].tolist()
        weight = style.get("font-weight", "").strip()
        return Text(
            words,
            ((a * size, -c * size, x), (b * size, -d * size, y)),
            ANCHORS.get(style.get("text-anchor", "start").strip(), 0.0),
            style.get("font-family", ""),
            weight in ("bold", "bolder") or _number(weight, 400.0) >= 600.0,
            style.get("font-style", "").strip() in ("italic", "oblique"),
            frame.layer,
        )

    def _say(self, kind: str, sentence: str) -> None:
        self._said.setdefault(kind, sentence)


#: Corners of a rectangle, by which of two edges they lie on.
CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))
#: Lengths that a shape is stated by, and the side of the view that percentages of each are of.
LENGTHS = {
    "rect": ("x", "y", "width", "height", "rx", "ry"),
    "circle": ("cx", "cy", "r"),
    "ellipse": ("cx", "cy", "rx", "ry"),
    "line": ("x1", "y1", "x2", "y2"),
}
AXES = {
    "r": None,
    **{
        name: axis
        for axis, names in enumerate(("x width cx rx x1 x2", "y height cy ry y1 y2"))
        for name in names.split()
    },
}
PIXELS = {
    "": 1.0,
    "px": 1.0,
    **{unit: mm * PIXELS_PER_MM for unit, mm in MM_PER_UNIT.items()},
    "q": 0.25 * PIXELS_PER_MM,
}
#: Transforms by angles, and how many of their numbers are angles.
ANGLES = {"rotate": 1, "skewx": 1, "skewy": 1, "skew": 2}


def _one_transform(kind: str, values: list[float]) -> FloatArray | None:
    x, y = (*values, np.nan, np.nan)[:2]
    match kind, len(values):
        case "matrix", 6:
            return np.array([values[0::2], values[1::2], [0.0, 0.0, 1.0]])
        case "translate", 1 | 2:
            return _moved(x, y if len(values) > 1 else 0.0)
        case "translatex", 1:
            return _moved(x, 0.0)
        case "translatey", 1:
            return _moved(0.0, x)
        case "scale", 1 | 2:
            return np.diag([x, y if len(values) > 1 else x, 1.0])
        case "scalex", 1:
            return np.diag([x, 1.0, 1.0])
        case "scaley", 1:
            return np.diag([1.0, x, 1.0])
        case "rotate", 1 | 3:
            cos, sin = np.cos(x), np.sin(x)
            turned = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
            return turned if len(values) == 1 else _moved(*values[1:]) @ turned @ _moved(-values[1], -values[2])
        case "skewx", 1:
            return np.array([[1.0, np.tan(x), 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        case "skewy", 1:
            return np.array([[1.0, 0.0, 0.0], [np.tan(x), 1.0, 0.0], [0.0, 0.0, 1.0]])
    return None


def _moved(x: float, y: float) -> FloatArray:
    return np.array([[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]])


def _placed(points: FloatArray, matrix: FloatArray) -> FloatArray:
    with np.errstate(over="ignore", invalid="ignore"):
        found: FloatArray = points @ matrix[:2, :2].T + matrix[:2, 2]
    return found


def _viewport(element: Element, at: tuple[float, float, float, float]) -> FloatArray:
    """The matrix from a drawing to the space around it: a rectangle (left, top, width, height)."""
    left, top, width, height = at
    box = _view_box(element)
    if box is None:
        return _moved(left, top)
    scale = np.array([width / box[2], height / box[3]])
    words = element.get("preserveAspectRatio", "").split()
    words = [word for word in words if word != "defer"]
    align = words[0] if words else "xMidYMid"
    if align != "none":
        scale[:] = max(scale) if "slice" in words[1:] else min(scale)
    spare = np.array([width, height]) - scale * box[2:]
    shares = [PLACEMENT.get(align[1:4], 0.5), PLACEMENT.get(align[5:8], 0.5)] if align != "none" else [0.0, 0.0]
    corner = np.array([left, top]) + spare * shares - scale * box[:2]
    return np.array([[scale[0], 0.0, corner[0]], [0.0, scale[1], corner[1]], [0.0, 0.0, 1.0]])


PLACEMENT = {"Min": 0.0, "Mid": 0.5, "Max": 1.0}


def _view_box(element: Element) -> tuple[float, float, float, float] | None:
    numbers = [float(text) for text in NUMBER.findall(element.get("viewBox", "")[:200])]
    if len(numbers) != 4 or not np.isfinite(numbers).all() or min(numbers[2:]) <= 0.0:
        return None
    return numbers[0], numbers[1], numbers[2], numbers[3]


def _stated_length(text: str | None) -> float | None:
    """Pixels of a length that depends on nothing else; None where it does or there is none."""
    found = LENGTH.fullmatch(text or "")
    if found is None or found[2].lower() not in PIXELS or not 0.0 < float(found[1]) < 1e9:
        return None
    return float(found[1]) * PIXELS[found[2].lower()]


def _applies(element: Element) -> bool:
    """Whether its conditions hold: no extensions, and English or any language."""
    if element.get("requiredExtensions", "").strip():
        return False
    languages = element.get("systemLanguage")
    return languages is None or any(word.strip().lower().split("-")[0] == "en" for word in languages.split(","))


def _angle(word: str) -> float:
    """Radians of an angle, degrees where it has no unit."""
    for unit, factor in (("deg", np.pi / 180.0), ("grad", np.pi / 200.0), ("rad", 1.0), ("turn", 2.0 * np.pi)):
        if word.lower().endswith(unit):
            return _number(word[: -len(unit)], np.nan) * factor
    return _number(word, np.nan) * np.pi / 180.0


def _number(stated: str | None, otherwise: float) -> float:
    try:
        return float((stated or "").strip())
    except ValueError:
        return otherwise


def _name(element: Element) -> str:
    return (_label(element) or element.get("id", ""))[:60]


def _label(element: Element) -> str:
    return next((text for key, text in element.items() if key.endswith("}label")), "")


def _layer_of(group: Element, outer: str) -> str:
    """The layer of a group: one of a drawing program, or the outermost group with a name."""
    name = _label(group) or group.get("id", "")
    is_layer = any(key.endswith("}groupmode") and text == "layer" for key, text in group.items())
    return name if name and (is_layer or not outer) else outer
