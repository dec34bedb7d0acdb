"""DXF drawings -> Outline: the largest closed contour in model space; or -> their parts."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from ezdxf import colors, recover, units
from ezdxf.document import Drawing
from ezdxf.entities.dxfentity import DXFEntity
from ezdxf.entities.dxfgfx import DXFGraphic
from ezdxf.entities.insert import Insert
from ezdxf.entities.layer import Layer
from ezdxf.entities.mtext import MText
from ezdxf.entities.text import Text as DXFText
from ezdxf.enums import InsertUnits
from ezdxf.filemanagement import dxf_stream_info, read, readfile
from ezdxf.lldxf.const import DXFError
from ezdxf.path import Command, make_path
from ezdxf.path import Path as Curve
from shapely.geometry import Polygon

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.outlines.bezier import flattened_curve
from kirigami_studio.outlines.joining import refuse_scribbles
from kirigami_studio.outlines.merging import usual_outline
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.parts import DrawnPartKind, Part, SourceParts, StrokeStyle, numbered, parts_of_groups
from kirigami_studio.outlines.source_file import TimeBudget, decoding, read_bytes
from kirigami_studio.outlines.text_curves import MOST_LETTERS, Text, scaled, text_parts

#: Entities that are lines of a contour; everything else in a drawing is text, measures and decoration.
CURVES = frozenset({"LINE", "ARC", "LWPOLYLINE", "POLYLINE", "SPLINE", "CIRCLE", "ELLIPSE", "HELIX"})

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
BY_LAYER, MICRONS = -1, 0.01


@dataclass(frozen=True, slots=True)
class Line:
    """One visible entity: (P, 2) vertices in drawing units, and where it belongs."""

    chain: FloatArray
    layer: str
    colour: str
    width: float  #: drawing units, 0 where it has none
    thickness_mm: float  #: of the line on paper, 0 where it has none


@dataclass(frozen=True, slots=True)
class DxfDrawing:
    """The lines of a file, what was changed, and millimetres to a unit (1 without a unit)."""

    lines: list[Line]
    notes: tuple[str, ...]
    to_mm: float
    unit: str
    facts: dict[str, str]
    texts: tuple[Text, ...] = ()


def read_dxf(path: str | Path) -> Outline:
    """Outline of the largest closed contour of a DXF file.

    LINE, ARC, LWPOLYLINE, POLYLINE, SPLINE, CIRCLE and ELLIPSE entities on visible layers of model
    space, blocks included, are joined where their ends meet; gaps up to 0.5 % of the size are closed.

    Returns
    -------
    Outline
        ``size`` in mm when the file states its unit ($INSUNITS), otherwise without unit.

    Raises
    ------
    TargetError
        Not a DXF file, damaged beyond repair, no lines, or an open contour (with the gap and its place).
    """
    path = Path(path)
    content = read_bytes(path, MOST_MEGABYTES)
    with decoding(path, "source.dxf_damaged"):
        return usual_outline(_parts(path, content))


def dxf_parts(path: str | Path) -> SourceParts:
    """All parts of a DXF file: what the lines of each layer enclose or draw.

    Raises
    ------
    TargetError
        As :func:`read_dxf`, but for open contours.
    """
    path = Path(path)
    content = read_bytes(path, MOST_MEGABYTES)
    with decoding(path, "source.dxf_damaged"):
        return _parts(path, content)


def _parts(path: Path, content: bytes) -> SourceParts:
    found = _read(path, content)
    lines_of: dict[str, list[Line]] = {}
    for line in found.lines:
        lines_of.setdefault(line.layer, []).append(line)
    groups = []
    for layer, lines in lines_of.items():
        thickness = max(line.thickness_mm for line in lines) if found.unit else 0.0
        pen = StrokeStyle(max(line.width * found.to_mm for line in lines) or thickness)
        colours = {line.colour for line in lines}
        colour = colours.pop() if len(colours) == 1 else ""
        like = Part(0, "", layer, colour, DrawnPartKind.STROKED, Polygon(), (), pen)
        groups.append(([line.chain * found.to_mm for line in lines], like))
    parts, gaps, bridged = parts_of_groups(groups, WIDEST_GAP, found.unit)
    written, fonts = text_parts([scaled(text, found.to_mm) for text in found.texts])
    parts += written
    if not parts:
        raise TargetError("dxf.no_lines_but_text")
    kept, too_many = numbered(parts, max(max(part.size) for part in parts))
    left_out = (*found.notes, *fonts, *gaps, *too_many)
    return SourceParts(path.stem, kept, left_out, found.unit, found.facts, bridged=bridged)


def _read(path: Path, content: bytes) -> DxfDrawing:
    """Everything visible in model space, flattened."""
    budget = TimeBudget()
    drawing, repaired = opened_dxf(path, content, budget)
    notes: tuple[str, ...] = ()
    if repaired:
        notes = (tr("The file was damaged and was repaired while reading. Check the shape."),)
    curves, texts, hidden = _visible(drawing, budget)
    written = [text for entity in texts[:MOST_LETTERS] for text in _texts(entity)]
    if not curves and not written:
        raise TargetError("dxf.no_lines_but_text" if texts else "dxf.no_lines")
    if texts and not written:
        notes += (tr("Text was left out. Convert it to lines if it belongs to the shape."),)
    if hidden:
        notes += (tr("Hidden layers were left out: {names}.", names=", ".join(sorted(hidden))),)
    # A file that does not state its unit is given metres by ezdxf; here it stays without unit.
    has_unit = b"$INSUNITS" in content and drawing.units != InsertUnits.Unitless
    to_mm = units.conversion_factor(InsertUnits(drawing.units), InsertUnits.Millimeters) if has_unit else 1.0
    lines, unread = _flattened(curves, drawing, budget) if curves else ([], 0)
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
    return DxfDrawing(lines, notes, to_mm, "mm" if has_unit else "", facts, tuple(written))


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


def _visible(drawing: Drawing, budget: TimeBudget) -> tuple[list[DXFGraphic], list[DXFGraphic], set[str]]:
    """Curves on visible layers of model space, blocks unfolded; texts; hidden layers with curves."""
    off = {layer.dxf.name.lower() for layer in drawing.layers if layer.is_off() or layer.is_frozen()}
    curves: list[DXFGraphic] = []
    hidden: set[str] = set()
    texts: list[DXFGraphic] = []
    _refuse_bombs(drawing)
    for count, entity in enumerate(_unfolded(drawing.modelspace(), 0, budget)):
        if count >= MOST_ENTITIES:
            raise TargetError("dxf.too_many_entities", limit=MOST_ENTITIES)
        if not isinstance(entity, DXFGraphic) or entity.dxf.invisible:
            continue
        if entity.dxf.layer.lower() in off:
            hidden |= {entity.dxf.layer} if entity.dxftype() in CURVES else set()
            continue
        if entity.dxftype() in TEXTS:
            texts.append(entity)
        if entity.dxftype() in CURVES:
            curves.append(entity)
    return curves, texts, hidden


def _texts(entity: DXFGraphic) -> Iterator[Text]:
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
        yield Text(text, matrix, anchor, layer=entity.dxf.layer, is_cap_height=True)


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


def _unfolded(entities: Iterable[DXFEntity], depth: int, budget: TimeBudget) -> Iterator[DXFEntity]:
    if depth > DEEPEST_BLOCK:
        raise TargetError("dxf.blocks_too_deep", limit=DEEPEST_BLOCK)
    for entity in entities:
        budget.check()
        if not isinstance(entity, Insert):
            yield entity
            continue
        for single in entity.multi_insert() if entity.mcount > 1 else (entity,):
            yield from _unfolded(single.virtual_entities(), depth + 1, budget)


def _flattened(curves: Iterable[DXFGraphic], drawing: Drawing, budget: TimeBudget) -> tuple[list[Line], int]:
    """Curves as lines, drawing units; z is dropped.  And the number of those that could not be read."""
    found: list[tuple[DXFGraphic, Curve]] = []
    damaged: list[Exception] = []
    for entity in curves:
        budget.check()
        try:
            curve = make_path(entity)
        except (DXFError, ValueError, TypeError, ArithmeticError, LookupError) as error:
            damaged.append(error)
        else:
            found += [(entity, curve)] if len(curve) > 0 else []
    if not found:
        if damaged:
            raise damaged[0]
        raise TargetError("dxf.no_length")
    corners = [np.array([(corner.x, corner.y) for corner in curve.control_vertices()]) for _, curve in found]
    everything = np.concatenate(corners)
    if not np.isfinite(everything).all():
        raise TargetError("drawing.not_finite")
    distance = float(np.max(np.ptp(everything, axis=0))) * FLATNESS
    if distance == 0.0:
        raise TargetError("dxf.one_point")
    layers = {layer.dxf.name.lower(): layer for layer in drawing.layers}
    lines = []
    for entity, curve in found:
        budget.check()
        lines.append(_line(entity, _vertices(curve, distance), layers.get(entity.dxf.layer.lower())))
    return lines, len(damaged)


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


def _line(entity: DXFGraphic, chain: FloatArray, layer: Layer | None) -> Line:
    """An entity with the colour and width that are its own, or its layer's."""
    number = entity.dxf.get("color", colors.BYLAYER)
    true = entity.dxf.get("true_color") if entity.dxf.hasattr("true_color") else None
    weight = entity.dxf.get("lineweight", BY_LAYER)
    if layer is not None and true is None and number == colors.BYLAYER:
        number = abs(layer.dxf.get("color", colors.BLACK))
        true = layer.dxf.get("true_color") if layer.dxf.hasattr("true_color") else None
    if layer is not None and weight == BY_LAYER:
        weight = layer.dxf.get("lineweight", BY_LAYER)
    red, green, blue = colors.int2rgb(true) if true is not None else colors.aci2rgb(number if 0 < number < 256 else 7)
    named = WIDTHS.get(entity.dxftype())
    width = max(float(entity.dxf.get(named, 0.0)), 0.0) if named else 0.0
    return Line(chain, entity.dxf.layer, f"#{red:02x}{green:02x}{blue:02x}", width, max(weight, 0) * MICRONS)
