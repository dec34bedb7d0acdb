"""DXF drawings -> Outline: the silhouette that is seen in model space; or -> their parts.

Lines of a layer and colour are joined with each other, fills of a layer are united.  Layers of measures, texts, centre
and construction lines are read, but count only where nothing else is closed (``Part.is_aside``).
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import shapely
from ezdxf import colors, recover, units
from ezdxf.document import Drawing
from ezdxf.entities.dxfentity import DXFEntity
from ezdxf.entities.dxfgfx import DXFGraphic
from ezdxf.entities.insert import Insert
from ezdxf.entities.layer import Layer
from ezdxf.entities.mtext import MText
from ezdxf.entities.polygon import DXFPolygon
from ezdxf.entities.polyline import Polyline
from ezdxf.entities.solid import Face3d, Solid
from ezdxf.entities.text import Text as DXFText
from ezdxf.enums import InsertUnits
from ezdxf.filemanagement import dxf_stream_info, read, readfile
from ezdxf.lldxf.const import DXFError
from ezdxf.math import Vec3
from ezdxf.path import Command, from_hatch_boundary_path, from_vertices, make_path
from ezdxf.path import Path as Curve
from ezdxf.xclip import XClip
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.outlines.bezier import flattened_curve
from kirigami_studio.outlines.dxf_regions import region_rings
from kirigami_studio.outlines.joining import refuse_scribbles
from kirigami_studio.outlines.merging import usual_outline
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.parts import (
    DrawnPartKind,
    Part,
    SourceParts,
    StrokeStyle,
    numbered,
    parts_of_groups,
    parts_of_region,
)
from kirigami_studio.outlines.pieces import united
from kirigami_studio.outlines.source_file import TimeBudget, decoded
from kirigami_studio.outlines.text_curves import MOST_LETTERS, Text, scaled, text_parts

DAMAGED = "source.dxf_damaged"
#: Entities that are lines of a contour, and those that are filled; all else is text, measures and decoration.
CURVES = frozenset({"LINE", "ARC", "LWPOLYLINE", "POLYLINE", "SPLINE", "CIRCLE", "ELLIPSE", "HELIX"})
HATCHES, FACES = frozenset({"HATCH", "MPOLYGON"}), frozenset({"SOLID", "TRACE", "3DFACE"})
FILLS = HATCHES | FACES
#: A flat face with its edges, and solids of a modelling kernel, which are not read.
REGION = "REGION"
KERNEL = frozenset({"BODY", "3DSOLID", "SURFACE"})
#: Words of layers that hold the shape, whatever else their names say, and of those that hold what is beside it or
#: engraved on it, in several languages.
CUT_WORDS = re.compile(
    r"cut|outline|contou?r|kontur|umriss|schnitt|schneid|d[eé]coupe|coupe|corte|taglio|profile?|laser|mill|fr[aä]s"
)
ASIDE_WORDS = re.compile(
    r"dims?|te?xte?s?|text[oi]s?|test[oi]|tekst|notes?|anno|aux|ax[ei]s?|ass[ei]|ejes?|achsen?|cot[ae]s?|"
    r"quot[ae]s?|"
    r"ma(?:ss|ß)e?|maate?n?|cent(?:re|er|ro)|cl|guides?|hidden|hilf|sketch|skizze|titles?|labels?|leaders?|vports?|"
    r"dimension\w*|(?:be|ver)ma(?:ss|ß)\w*|cotation\w*|quotatur\w*|acota\w*|maatvoer\w*|wymiar\w*|размер\w*|"
    r"annot\w*|beschrift\w*|schrift[fk]\w*|cente?re?l\w*|mittel[lp]\w*|hartlijn\w*|symmetr\w*|constr\w*|konstruk\w*|"
    r"hilfs\w*|costruzion\w*|auxilia\w*|defpoint\w*|viewport\w*|ansichtsf\w*|titleb\w*|cartouche\w*|cajet\w*|"
    r"cartigl\w*|zeichnungsr\w*|blattrahm\w*|verdeckt\w*|phantom\w*|helper\w*|guidel\w*|referen[cz]\w*|вспомог\w*|"
    r"e?n?gra[vb]\w*|incisi\w*|etch\w*|标注\w*|尺寸\w*|寸法\w*|文字\w*|中心线\w*|辅助\w*"
)
#: Layers of AutoCAD Mechanical with hidden lines, measures, texts, centre lines, and hatches.
MECHANICAL = re.compile(r"am_(3|5|6|7|8|10|11)n?")
#: Line types of centre lines, hidden edges and construction.
ASIDE_LINES = re.compile(r"center|centre|phantom|hidden|dash|dot|divide|border|mitte|strich|trait|iso0[2-9]|iso1")
#: Layer whose lines have that of their block's insertion, and that which is never plotted.
LAYER_0, NEVER_PLOTTED = "0", "defpoints"

TEXTS = frozenset({"TEXT", "MTEXT", "ATTRIB", "ATTDEF"})

#: Gaps up to this share of the drawing's size are closed: sloppy snapping, not a missing line.
WIDEST_GAP = 0.005

#: Deviation of flattened curves from the true ones, share of the drawing's size.
FLATNESS = 1.0 / 4000.0

#: Blocks nest and repeat; a drawing that unfolds to more entities than this is no outline.
MOST_ENTITIES = 100_000
#: Steps of unfolding, one for each entity; a copy of a block takes as long as so many entities.
MOST_STEPS, COPY = 2_000_000, 40
DEEPEST_BLOCK = 16
#: Share of the time that unfolding entities may take: joining and judging their lines takes twice as long again.
UNFOLDING = 0.35
MOST_MEGABYTES = 50
#: Share of the time for the text of a file; its entities take as long again.
STRICT_SHARE = 0.5
#: Distance of two lines of a text, heights of its capitals.
LINE = 5.0 / 3.0
BINARY = b"AutoCAD Binary DXF"
#: Such files are decoded at one go, which cannot be timed.
MOST_BINARY_MEGABYTES = 4
#: Attributes with the width of a line in drawing units.
WIDTHS = {"LWPOLYLINE": "const_width", "POLYLINE": "default_start_width"}
#: Line widths on paper are in hundredths of a millimetre; these mean the layer's, and ordinary.
BY_LAYER, BY_LAYER_NAME, MICRONS = -1, "BYLAYER", 0.01


@dataclass(frozen=True, slots=True)
class Line:
    """One visible entity: (P, 2) vertices in drawing units, and where it belongs."""

    chain: FloatArray
    layer: str
    colour: str
    width: float  #: drawing units, 0 where it has none
    thickness_mm: float  #: of the line on paper, 0 where it has none
    is_aside: bool = False  #: whether it is a measure, a text, a centre or construction line


@dataclass(frozen=True, slots=True)
class Fill:
    """One visible filled entity: its region in drawing units, and where it belongs."""

    region: BaseGeometry
    layer: str
    colour: str
    is_aside: bool


class Shown(NamedTuple):
    """A visible entity, the layer that it shows as, and the region in which it is seen."""

    entity: DXFGraphic
    layer: str
    clip: BaseGeometry | None  #: drawing units; None where nothing is cut off


@dataclass(slots=True)
class Seen:
    """Entities that are visible in a drawing, and names of those that are not."""

    curves: list[Shown] = field(default_factory=list)
    fills: list[Shown] = field(default_factory=list)
    texts: list[Shown] = field(default_factory=list)
    hidden: set[str] = field(default_factory=set)  #: layers with lines or fills that are off, frozen or not plotted
    clipped: set[str] = field(default_factory=set)  #: blocks whose clips are not followed
    kernel: int = 0  #: regions and solids that cannot be read


@dataclass(frozen=True, slots=True)
class DxfDrawing:
    """The lines of a file, what was changed, and millimetres to a unit (1 without a unit)."""

    lines: list[Line]
    notes: tuple[str, ...]
    to_mm: float
    unit: str
    facts: dict[str, str]
    texts: tuple[Text, ...] = ()
    fills: tuple[Fill, ...] = ()


def read_dxf(path: str | Path) -> Outline:
    """Outline of the silhouette that is seen in a DXF file.

    LINE, ARC, LWPOLYLINE, POLYLINE, SPLINE, CIRCLE and ELLIPSE entities on visible, plotted layers of model space,
    blocks included and clipped, are joined where their ends meet; gaps up to 0.5 % of the size are closed.  HATCH,
    SOLID, TRACE, 3DFACE and flat REGION entities are filled.

    Returns
    -------
    Outline
        ``size`` in mm when the file states its unit ($INSUNITS), otherwise without unit.

    Raises
    ------
    TargetError
        Not a DXF file, damaged beyond repair, no lines, or an open contour (with the gap and its place).
    """
    return decoded(path, DAMAGED, lambda *file: usual_outline(_parts(*file)), MOST_MEGABYTES)


def dxf_parts(path: str | Path) -> SourceParts:
    """All parts of a DXF file: what the lines of each layer enclose or draw.

    Raises
    ------
    TargetError
        As :func:`read_dxf`, but for open contours.
    """
    return decoded(path, DAMAGED, _parts, MOST_MEGABYTES)


def _parts(path: Path, content: bytes) -> SourceParts:
    found = _read(path, content)
    groups: dict[tuple[bool, str, str], list[Line]] = {}
    for line in found.lines:
        groups.setdefault((line.is_aside, line.layer, line.colour), []).append(line)
    parts, gaps, bridged = _filled(found), [], 0.0
    for is_aside in (False, True):
        some = [(key, lines) for key, lines in groups.items() if key[0] is is_aside]
        more, closed, width = parts_of_groups(
            [_group(found, key, lines) for key, lines in some], WIDEST_GAP, found.unit
        )
        parts += more
        gaps += closed
        bridged = max(bridged, width)
    written, fonts = text_parts([scaled(text, found.to_mm) for text in found.texts])
    parts += [replace(part, is_aside=is_aside_layer(part.layer)) for part in written]
    if not parts:
        raise TargetError("dxf.no_lines_but_text")
    beside = dict.fromkeys(part.layer for part in parts if part.is_aside and not part.is_letter)
    notes: tuple[str, ...] = found.notes
    if beside and any(part.is_closed and not part.is_aside for part in parts):
        notes += (
            tr("Measures, texts, engraving and construction lines were left out: {names}.", names=", ".join(beside)),
        )
    kept, too_many = numbered(parts, max(max(part.size) for part in parts))
    return SourceParts(path.stem, kept, (*notes, *fonts, *gaps, *too_many), found.unit, found.facts, bridged=bridged)


def _group(found: DxfDrawing, key: tuple[bool, str, str], lines: Sequence[Line]) -> tuple[list[FloatArray], Part]:
    """Lines of a layer and colour, source units, and the part that all of them are like."""
    is_aside, layer, colour = key
    thickness = max(line.thickness_mm for line in lines) if found.unit else 0.0
    width = max(line.width * found.to_mm for line in lines)
    pen = StrokeStyle(width or thickness, is_on_paper=not width)
    like = Part(0, "", layer, colour, DrawnPartKind.STROKED, Polygon(), (), pen, is_aside=is_aside)
    return [line.chain * found.to_mm for line in lines], like


def _filled(found: DxfDrawing) -> list[Part]:
    """What is filled on each layer, united, because faces of a mesh abut."""
    fills_of: dict[tuple[bool, str, str], list[BaseGeometry]] = {}
    for fill in found.fills:
        fills_of.setdefault((fill.is_aside, fill.layer, fill.colour), []).append(fill.region)
    parts = []
    for (is_aside, layer, colour), regions in fills_of.items():
        size = float(np.max(np.ptp(shapely.total_bounds(np.array(regions, dtype=object)).reshape(2, 2), axis=0)))
        region = shapely.transform(united(regions, size), lambda points: points * found.to_mm)
        like = Part(0, "", layer, colour, DrawnPartKind.FILLED, Polygon(), is_aside=is_aside)
        parts += parts_of_region(region, like)
    return parts


def is_aside_layer(name: str) -> bool:
    """Whether a layer by its name holds measures, texts, centre or construction lines, not the shape."""
    name = name.casefold()
    if CUT_WORDS.search(name):
        return False
    words = re.findall(r"[^\W\d_]+", name)
    return any(map(ASIDE_WORDS.fullmatch, words)) or MECHANICAL.fullmatch(name) is not None


def _read(path: Path, content: bytes) -> DxfDrawing:
    """Everything visible in model space, flattened."""
    budget = TimeBudget()
    drawing, repaired = opened_dxf(path, content, budget)
    notes: tuple[str, ...] = ()
    if repaired:
        notes = (tr("The file was damaged and was repaired while reading. Check the shape."),)
    seen = _visible(drawing, budget)
    written = [text for entity, layer, _ in seen.texts[:MOST_LETTERS] for text in _texts(entity, layer)]
    if not seen.curves and not seen.fills and not written:
        if seen.kernel:
            raise TargetError("dxf.only_regions")
        raise TargetError("dxf.no_lines_but_text" if seen.texts else "dxf.no_lines")
    if seen.texts and not written:
        notes += (tr("Text was left out. Convert it to lines if it belongs to the shape."),)
    if seen.hidden:
        notes += (tr("Hidden layers were left out: {names}.", names=", ".join(sorted(seen.hidden))),)
    if seen.clipped:
        names = ", ".join(sorted(seen.clipped))
        notes += (tr("Blocks that are clipped in the drawing (XCLIP) were taken whole: {names}.", names=names),)
    if seen.kernel:
        notes += (tr("Regions and solids were left out. Explode them into lines if they belong to the shape."),)
    # A file that does not state its unit is given metres by ezdxf; here it stays without unit.
    has_unit = b"$INSUNITS" in content and drawing.units != InsertUnits.Unitless
    to_mm = units.conversion_factor(InsertUnits(drawing.units), InsertUnits.Millimeters) if has_unit else 1.0
    lines, fills, unread = _flattened(seen, drawing, budget) if seen.curves or seen.fills else ([], [], 0)
    refuse_scribbles([line.chain for line in lines])
    if unread:
        notes += (
            tr_n(
                "{count} damaged line was left out. Check the shape.",
                "{count} damaged lines were left out. Check the shape.",
                unread,
            ),
        )
    facts = {str(name): str(text) for name, text in drawing.header.custom_vars.properties}
    return DxfDrawing(lines, notes, to_mm, "mm" if has_unit else "", facts, tuple(written), tuple(fills))


class _TimedBytes(io.BytesIO):
    """The bytes of a file, for as long as there is time."""

    def __init__(self, content: bytes, budget: TimeBudget, share: float = 1.0) -> None:
        super().__init__(content)
        self._budget, self._share = budget, share

    def readline(self, size: int | None = -1, /) -> bytes:
        self._budget.check(self._share)
        return super().readline(size)

    def read1(self, size: int | None = -1, /) -> bytes:
        self._budget.check(self._share)
        return super().read1(size)


def opened_dxf(
    path: Path, content: bytes, budget: TimeBudget, strict_share: float = STRICT_SHARE
) -> tuple[Drawing, bool]:
    """Read strictly, for a share of the time at most, then with ezdxf's recover mode; whether that was needed.

    Raises
    ------
    TargetError
        Too large for its kind, or it takes too long.
    Exception
        Whatever ezdxf raises on damaged files.
    """
    try:
        if content.startswith(BINARY):
            if len(content) > MOST_BINARY_MEGABYTES * 1_000_000:
                megabytes = len(content) / 1_000_000
                raise TargetError("source.too_large", path=path, megabytes=megabytes, limit=MOST_BINARY_MEGABYTES)
            return readfile(path), False
        encoding = dxf_stream_info(io.StringIO(content[:100_000].decode("utf-8", errors="ignore"))).encoding
        raw = _TimedBytes(content, budget, strict_share)
        return read(io.TextIOWrapper(raw, encoding=encoding, errors="surrogateescape")), False
    except (DXFError, OSError, ValueError, LookupError, TypeError, AttributeError):
        drawing, _ = recover.read(_TimedBytes(content, budget))
        return drawing, True


def _visible(drawing: Drawing, budget: TimeBudget) -> Seen:
    """All that is on visible, plotted layers of model space, blocks unfolded."""
    layers = {layer.dxf.name.lower(): layer for layer in drawing.layers}
    frozen = {name for name, layer in layers.items() if layer.is_frozen()}
    hidden = frozen | {name for name, layer in layers.items() if layer.is_off() or not layer.dxf.get("plot", 1)}
    seen = Seen()
    _refuse_bombs(drawing)
    for count, shown in enumerate(_unfolded(drawing.modelspace(), Around(), budget, frozen, seen)):
        if count >= MOST_ENTITIES:
            raise TargetError("dxf.too_many_entities", limit=MOST_ENTITIES)
        kind, layer = shown.entity.dxftype(), shown.layer
        if layer.lower() in hidden or layer.lower() == NEVER_PLOTTED:
            seen.hidden |= {layer} if kind in CURVES or kind in FILLS or kind == REGION else set()
        elif kind in TEXTS:
            seen.texts.append(shown)
        elif kind in FILLS or (kind == REGION and region_rings(shown.entity) is not None):
            seen.fills.append(shown)
        elif kind in CURVES:
            seen.curves.append(shown)
        elif kind in KERNEL or kind == REGION:
            seen.kernel += 1
    return seen


def _texts(entity: DXFGraphic, layer: str) -> Iterator[Text]:
    """The lines of a text, in drawing units."""
    if isinstance(entity, MText):
        height, at, angle = float(entity.dxf.char_height), entity.dxf.insert, float(entity.get_rotation())
        rows = entity.plain_text(split=True)
        row, column = divmod(max(int(entity.dxf.attachment_point), 1) - 1, 3)
        # Attached at the top, in the middle or at the bottom; lines are five thirds of a letter apart.
        first = (-1.0, 0.5 * (len(rows) - 1) * LINE - 0.5, (len(rows) - 1) * LINE)[min(row, 2)]
        anchor = 0.5 * column
    elif isinstance(entity, DXFText):
        kind, at, other = entity.get_placement()
        height, angle, rows = float(entity.dxf.height), float(entity.dxf.rotation), [entity.plain_text()]
        name = kind.name
        anchor = 1.0 if name.endswith("RIGHT") else 0.5 if name.endswith("CENTER") or name == "MIDDLE" else 0.0
        first = -1.0 if name.startswith("TOP") else -0.5 if name.startswith("MIDDLE") else 0.0
        if other is not None:  # between two places
            at, anchor = at.lerp(other), 0.5
    else:
        return
    if not (np.isfinite([height, angle, at.x, at.y]).all() and height > 0):
        return
    cos, sin = height * np.cos(np.radians(angle)), height * np.sin(np.radians(angle))
    for number, text in enumerate(rows):
        up = first - number * LINE
        matrix = ((cos, -sin, at.x - sin * up), (sin, cos, at.y + cos * up))
        yield Text(text, matrix, anchor, layer=layer, is_cap_height=True)


def _refuse_bombs(drawing: Drawing) -> None:
    """Refuse a drawing whose blocks hold each other so often that unfolding them would take minutes: count first."""
    known: dict[str, int] = {}

    def steps(entities: Iterable[DXFEntity], depth: int) -> int:
        return sum(one.mcount * (COPY + inside(one, depth + 1)) if isinstance(one, Insert) else 1 for one in entities)

    def inside(insert: Insert, depth: int) -> int:
        if insert.mcount > MOST_ENTITIES:
            raise TargetError("dxf.block_repeated", times=insert.mcount)
        block = insert.block()
        if block is None or depth > DEEPEST_BLOCK:  # which is told when it is unfolded
            return 0
        name = block.name.lower()
        if name not in known:
            known[name] = 0  # of a block that holds itself
            known[name] = steps(block, depth)
        return known[name]

    if steps(drawing.modelspace(), 0) > MOST_STEPS:
        raise TargetError("dxf.too_many_entities", limit=MOST_ENTITIES)


class Around(NamedTuple):
    """Blocks around entities: number, layer of the innermost, region in which it is seen."""

    depth: int = 0
    layer: str = LAYER_0
    clip: BaseGeometry | None = None


def _unfolded(
    entities: Iterable[DXFEntity], around: Around, budget: TimeBudget, frozen: set[str], seen: Seen
) -> Iterator[Shown]:
    """Entities with the layers that they show as: in blocks, those on layer 0 show as their insertion's.

    What is inserted on a frozen layer is hidden with all of its layers; on one that is off, only what shows as it.
    """
    if around.depth > DEEPEST_BLOCK:
        raise TargetError("dxf.blocks_too_deep", limit=DEEPEST_BLOCK)
    for entity in entities:
        budget.check(UNFOLDING)
        if not isinstance(entity, DXFGraphic) or entity.dxf.invisible:
            continue
        layer = around.layer if entity.dxf.layer == LAYER_0 else entity.dxf.layer
        inner = Around(around.depth + 1, layer, around.clip)
        if isinstance(entity, Polyline) and (entity.is_poly_face_mesh or entity.is_polygon_mesh):
            yield from _unfolded(entity.virtual_entities(), inner, budget, frozen, seen)
        elif not isinstance(entity, Insert):
            yield Shown(entity, layer, around.clip)
        elif layer.lower() in frozen:
            seen.hidden.add(layer)
        else:
            clip = _clip_of(entity, seen)
            if clip is not None:
                inner = inner._replace(clip=clip if around.clip is None else clip.intersection(around.clip))
            for single in entity.multi_insert() if entity.mcount > 1 else (entity,):
                yield from _unfolded(single.virtual_entities(), inner, budget, frozen, seen)


def _clip_of(insert: Insert, seen: Seen) -> BaseGeometry | None:
    """The region in which a block is seen, drawing units; None where nothing is cut off.

    A clip that is not followed is kept by the block's name.
    """
    stated = insert.origin_of_copy or insert  # copies have no clip of their own
    if not (isinstance(stated, Insert) and stated.has_extension_dict):
        return None
    clip = XClip(stated)
    if not (clip.has_clipping_path and clip.is_clipping_enabled):
        return None
    path = clip.get_block_clipping_path()
    corners = [(place.x, place.y) for place in insert.matrix44().transform_vertices(path.vertices)]
    if not path.is_inverted_clip and insert.mcount == 1 and len(corners) > 2 and np.isfinite(corners).all():
        region = Polygon(corners)
        if region.is_valid and region.area > 0.0:
            return region
    seen.clipped.add(insert.dxf.name)
    return None


def _flattened(seen: Seen, drawing: Drawing, budget: TimeBudget) -> tuple[list[Line], list[Fill], int]:
    """Lines and fills, drawing units; z is dropped.  And the number of those that could not be read."""
    found: list[tuple[Shown, list[Curve]]] = []
    damaged: list[Exception] = []
    for shown in (*seen.curves, *seen.fills):
        budget.check(UNFOLDING)
        try:
            curves = [make_path(shown.entity)] if shown.entity.dxftype() in CURVES else _edges(shown.entity)
        except (DXFError, ValueError, TypeError, ArithmeticError, LookupError, AttributeError) as error:
            damaged.append(error)
        else:
            curves = [curve for curve in curves if len(curve) > 0]
            found += [(shown, curves)] if curves else []
    if not found:
        if damaged:
            raise damaged[0]
        raise TargetError("dxf.no_length")
    corners = [[(corner.x, corner.y) for corner in curve.control_vertices()] for _, all_ in found for curve in all_]
    everything = np.array([corner for some in corners for corner in some])
    if not np.isfinite(everything).all():
        raise TargetError("drawing.not_finite")
    distance = float(np.max(np.ptp(everything, axis=0))) * FLATNESS
    if distance == 0.0:
        raise TargetError("dxf.one_point")
    layers = {layer.dxf.name.lower(): layer for layer in drawing.layers}
    lines: list[Line] = []
    fills: list[Fill] = []
    for (entity, name, clip), curves in found:
        budget.check(UNFOLDING)
        chains = [_vertices(curve, distance) for curve in curves]
        line = _line(entity, chains[0], name, layers.get(name.lower()))
        if entity.dxftype() in CURVES:
            lines += [replace(line, chain=chain) for chain in _seen_of(line.chain, clip)]
        else:
            region = _inside(chains) if clip is None else _inside(chains).intersection(clip)
            fills += [] if region.is_empty else [Fill(region, name, line.colour, line.is_aside)]
    if not lines and not fills:
        raise TargetError("dxf.no_lines")
    return lines, fills, len(damaged)


def _seen_of(chain: FloatArray, clip: BaseGeometry | None) -> list[FloatArray]:
    """The pieces of a chain (P, 2) that lie in a region."""
    if clip is None or clip.covers(line := LineString(chain)):
        return [chain]
    pieces = shapely.get_parts(shapely.line_merge(line.intersection(clip)))
    return [shapely.get_coordinates(piece) for piece in pieces if isinstance(piece, LineString) and piece.length > 0]


def _edges(entity: DXFGraphic) -> list[Curve]:
    """The closed edges of a filled entity."""
    if isinstance(entity, DXFPolygon):
        ocs, raised = entity.ocs(), Vec3(entity.dxf.elevation).z
        paths = entity.paths.rendering_paths(entity.dxf.hatch_style)
        return [from_hatch_boundary_path(path, ocs, raised) for path in paths]
    if entity.dxftype() == REGION:
        return [from_vertices(ring, close=True) for ring in region_rings(entity) or ()]
    assert isinstance(entity, Solid | Face3d)
    return [from_vertices(entity.wcs_vertices(close=True))]


def _inside(rings: Sequence[FloatArray]) -> BaseGeometry:
    """What lies inside an odd number of rings (L, 2)."""
    region: BaseGeometry = Polygon()
    for ring in rings:
        if len(ring) > 2:
            region = region.symmetric_difference(shapely.make_valid(Polygon(ring)))
    pieces = [piece for piece in shapely.get_parts(region) if isinstance(piece, Polygon)]
    return shapely.union_all(pieces)


def _vertices(curve: Curve, distance: float) -> FloatArray:
    """Vertices (P, 2) of a curve whose chords are at most ``distance`` away from it."""
    start = np.array([[curve.start.x, curve.start.y]])
    vertices = [start]
    for command in curve.commands():
        points = [
            *(getattr(command, name) for name in ("ctrl", "ctrl1", "ctrl2") if hasattr(command, name)),
            command.end,
        ]
        controls = np.vstack([start, [(point.x, point.y) for point in points]])
        start = controls[-1:]
        is_straight = command.type in (Command.LINE_TO, Command.MOVE_TO)
        vertices.append(start if is_straight else flattened_curve(controls, distance))
    return np.concatenate(vertices)


def _line(entity: DXFGraphic, chain: FloatArray, name: str, layer: Layer | None) -> Line:
    """An entity with the colour, width and line type that are its own, or its layer's."""
    number = entity.dxf.get("color", colors.BYLAYER)
    true = entity.dxf.get("true_color") if entity.dxf.hasattr("true_color") else None
    weight = entity.dxf.get("lineweight", BY_LAYER)
    pattern = str(entity.dxf.get("linetype", BY_LAYER_NAME))
    if layer is not None and true is None and number == colors.BYLAYER:
        number = abs(layer.dxf.get("color", colors.BLACK))
        true = layer.dxf.get("true_color") if layer.dxf.hasattr("true_color") else None
    if layer is not None and weight == BY_LAYER:
        weight = layer.dxf.get("lineweight", BY_LAYER)
    if layer is not None and pattern.upper() == BY_LAYER_NAME:
        pattern = str(layer.dxf.get("linetype", ""))
    red, green, blue = colors.int2rgb(true) if true is not None else colors.aci2rgb(number if 0 < number < 256 else 7)
    named = WIDTHS.get(entity.dxftype())
    width = max(float(entity.dxf.get(named, 0.0)), 0.0) if named else 0.0
    colour = f"#{red:02x}{green:02x}{blue:02x}"
    is_aside = is_aside_layer(name) or (
        ASIDE_LINES.search(pattern.casefold()) is not None and not CUT_WORDS.search(name.casefold())
    )
    return Line(chain, name, colour, width, max(weight, 0) * MICRONS, is_aside)
