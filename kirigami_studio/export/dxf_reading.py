"""Two readers of DXF that use ezdxf: a strict one for files written here, and a lenient one for files of any origin.

:func:`read_with_ezdxf` reads polylines as they were written and fails on anything ezdxf's audit objects to; it is the
first reader of a verification (the second one, ``group_codes``, shares no code with it).  :func:`read_content` takes
whatever a file holds, turns curves into chords in mm, and notes what a cutter would stumble over.
"""

from __future__ import annotations

import math
from collections import Counter, OrderedDict
from dataclasses import dataclass, field
from itertools import takewhile
from pathlib import Path
from typing import cast

import numpy as np
from ezdxf import units
from ezdxf.document import Drawing
from ezdxf.entities.arc import Arc
from ezdxf.entities.circle import Circle
from ezdxf.entities.dxfentity import DXFEntity
from ezdxf.entities.lwpolyline import LWPolyline, LWPolylinePoints
from ezdxf.entities.polyline import Polyline
from ezdxf.enums import InsertUnits
from ezdxf.filemanagement import readfile
from ezdxf.lldxf.const import DXFError
from ezdxf.path import make_path

from kirigami_studio.export.file_content import FileContent
from kirigami_studio.export.strokes import Stroke
from kirigami_studio.fabricate.cut_path import edge_lengths
from kirigami_studio.fabricate.findings import Problem
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ExportError, TargetError
from kirigami_studio.foundation.files import read_at_most
from kirigami_studio.outlines.read_dxf import opened_dxf
from kirigami_studio.outlines.source_file import MEGABYTE, TimeBudget

#: Largest file that is read (bytes); a 64 x 64 design is below 2 MB.
LARGEST_FILE = 100_000_000
#: Seconds of processor time that a file may take to be read; a 64 x 64 design has 1.5 MB and takes 1.2 s.
LEAST_SECONDS, SECONDS_PER_MEGABYTE = 3.0, 5.0
#: Numbers beyond this (mm) are none that a coordinate can have; sums of their squares would overflow.
FARTHEST_MM = 1e12
#: Curves that are larger than this (mm) are not followed.
LARGEST_CURVE_MM = 100_000.0
#: Chord tolerance (mm) for curves.
FLATTEN_MM = 0.001
#: Facts about a file's making that its check needs, the last two in numbered pieces; R12 files keep them among ezdxf's
#: own records.
RECORDED_FACTS = (
    "KIRIGAMI_STUDIO", "CONSTRUCTION", "DESIGN", "WIDTH_MM", "CONNECTOR_MM", "LEAST_CONNECTOR_MM", "KERF_MM",
    "SLOT_KERF_MM", "STYLE", "ORDER", "PROFILE", "MATERIAL", "MACHINE", "LINES", "TRIMMED", "TABS", "TABS_ASKED",
    "TAB_MM", "JOINS", "HOLES",
    "PART", "COPIES", "COPIES_ASKED", "COPY_GAP_MM", "NAME", "ENGRAVED_LINES", "ARTWORK_LINES", "VERDICT", "PURPOSE",
    "LAYER", "BED", "SHEETS", "BOX_MM", "PLACE", "PIECES", "PIN_MM", "EAR_MM", "CLEARANCE_MM", "FASTENER",
)  # fmt: skip
RECORDED_LISTS, MOST_PIECES = ("HINGE_MM", "REMOVED"), 400
#: Sheets of several designs in one file whose records are read.
MOST_SHEETS = 1000
#: What ezdxf raises on damaged files, depending on where the damage is.
PARSER_FAULTS = (
    DXFError,
    ArithmeticError,
    AssertionError,
    AttributeError,
    LookupError,
    RecursionError,
    StopIteration,
    TypeError,
    ValueError,
)
#: Curves that are shorter than this (mm) have no length.
SHORTEST_MM = 1e-6
#: Ends of a closed curve nearer than this (mm) are the same point.
ROUNDING_MM = 1e-9
CURVES = frozenset({"LINE", "LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE"})
#: Curves that many machines read wrongly or not at all.
RISKY_CURVES = frozenset({"ELLIPSE", "SPLINE"})


#: Files that were read last, by their bytes, and how many are kept: one that was read back is mostly verified next.
_READ: OrderedDict[bytes, FileContent] = OrderedDict()
KEPT_FILES = 4


def read_with_ezdxf(path: Path) -> FileContent:
    """Read a DXF's header, layers and polylines; the bytes of a file that was read just before are not parsed again.

    Raises
    ------
    ExportError
        The file does not read, or ezdxf's audit finds an error.
    """
    try:
        content = read_at_most(path, LARGEST_FILE)
    except OSError as error:
        raise ExportError("dxf.not_readable", path=path, reason=str(error)) from error
    found = _READ.get(content)
    if found is None:
        found = _READ[content] = _read(path)
        while len(_READ) > KEPT_FILES:
            _READ.popitem(last=False)
    return found


def _read(path: Path) -> FileContent:
    try:
        document = readfile(path)
        errors = document.audit().errors
        content = None if errors else _content(document)
    except (OSError, *PARSER_FAULTS) as error:
        raise ExportError("dxf.not_readable", path=path, reason=str(error)) from error
    if content is None:
        raise ExportError("dxf.audit", path=path, first=errors[0].message, count=len(errors))
    return content


def _content(document: Drawing) -> FileContent:
    strokes, others = [], []
    for entity in document.modelspace():
        if isinstance(entity, LWPolyline):
            table = np.array(entity.lwpoints.values).reshape(-1, LWPolylinePoints.VERTEX_SIZE)[:, [0, 1, 4]]
            closed = bool(entity.closed)
        elif isinstance(entity, Polyline):
            rows = [(v.dxf.location.x, v.dxf.location.y, v.dxf.bulge) for v in entity.vertices]
            table = np.array(rows, dtype=np.float64).reshape(-1, 3)
            closed = bool(entity.is_closed)
        elif entity.dxftype() == "CIRCLE":
            circle = cast(Circle, entity).dxf
            place = np.array([circle.center.x, circle.center.y])
            strokes.append(Stroke.round(place, 2.0 * circle.radius, circle.layer, circle.color))
            continue
        else:
            others.append(entity.dxftype())
            continue
        bulges = table[:, 2] if table[:, 2].any() else None
        strokes.append(Stroke(table[:, :2], closed, entity.dxf.layer, entity.dxf.color, bulges))
    corner = document.header.get("$EXTMAX")
    old = document.dxfversion == "AC1009"
    return FileContent(
        reader="ezdxf",
        strokes=tuple(strokes),
        unit=None if old else int(document.header.get("$INSUNITS", 0)),
        extent=None if corner is None else (float(corner[0]), float(corner[1])),
        layers={layer.dxf.name: layer.dxf.color for layer in document.layers},
        others=tuple(others),
    )


@dataclass(frozen=True, slots=True, eq=False)
class FilePath:
    """One curve of the file."""

    points: FloatArray  #: (P, 2), mm; the first point of a closed path is repeated at the end
    layer: str
    closed: bool  #: closed by its own flag or kind, not merely by ends that meet
    #: By how much the arcs of a polyline, an arc or a circle are longer than their chords in ``points``.
    arcs_mm: float = 0.0

    @property
    def length(self) -> float:
        """Length in mm, arcs as arcs; other curves along their chords."""
        return float(np.linalg.norm(np.diff(self.points, axis=0), axis=1).sum()) + self.arcs_mm


@dataclass(slots=True)
class DxfContent:
    """The contents of a DXF, with the problems seen while reading."""

    paths: list[FilePath] = field(default_factory=list)
    unit: str = "none"  #: name of the file's unit, "none" when it has none
    layers: tuple[str, ...] = ()  #: layers that hold entities
    facts: dict[str, str] = field(default_factory=dict)  #: the file's own custom records, such as ``KERF_MM``
    problems: list[Problem] = field(default_factory=list)


def read_content(path: Path) -> DxfContent:
    """Read the model space of a DXF.

    Raises
    ------
    ExportError
        The file is missing, too large, not a DXF, or takes too long to read.
    """
    content, file = DxfContent(), _bytes_of(path)
    budget = TimeBudget(LEAST_SECONDS + SECONDS_PER_MEGABYTE * len(file) / MEGABYTE)
    try:
        _collect(_open(path, file, content, budget), content, budget)
    except TargetError as error:
        if error.code == "source.too_slow":
            raise ExportError("cut_file.too_slow", path=path, **error.fields) from error
        raise ExportError(error.code, **error.fields) from error
    except PARSER_FAULTS as error:
        raise ExportError("cut_file.damaged", path=path) from error
    return content


def _open(path: Path, file: bytes, content: DxfContent, budget: TimeBudget) -> Drawing:
    try:
        document, repaired = opened_dxf(path, file, budget, strict_share=1.0)
    except OSError as error:
        # ezdxf raises a bare OSError for a file that is no DXF at all.
        raise ExportError("dxf.no_dxf", path=path) from error
    except PARSER_FAULTS as error:
        raise ExportError("cut_file.damaged", path=path) from error
    if repaired:
        content.problems.append(Problem.error("cut_file.only_partly_readable"))
    return document


def _bytes_of(path: Path) -> bytes:
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise ExportError("dxf.too_large", path=path, limit=LARGEST_FILE // 1_000_000)
        return read_at_most(path, LARGEST_FILE)
    except OSError as error:
        raise ExportError("dxf.cannot_open", path=path, reason=error.strerror or str(error)) from error


def _collect(document: Drawing, content: DxfContent, budget: TimeBudget) -> None:
    """Fill ``content`` from the document's header and model space."""
    factor = _unit_factor(document, content)
    content.facts = _facts(document)
    entities = list(document.modelspace())
    content.layers = tuple(sorted({_layer(entity) for entity in entities}))
    others: Counter[str] = Counter()
    risky: Counter[str] = Counter()
    for entity in entities:
        budget.check()
        kind = entity.dxftype()
        if kind not in CURVES:
            others[kind] += 1
            continue
        if kind in RISKY_CURVES:
            risky[kind] += 1
        _add_path(content, entity, factor)
    for kind, count in sorted(others.items()):
        content.problems.append(Problem.error("cut_file.other_entities", count=count, kind=kind))
    for kind, count in sorted(risky.items()):
        content.problems.append(Problem.warning("cut_file.risky_curves", count=count, kind=kind))


def _layer(entity: DXFEntity) -> str:
    return str(entity.dxf.get("layer", "0")) if entity.dxf.is_supported("layer") else "0"


def _unit_factor(document: Drawing, content: DxfContent) -> float:
    """Return mm for one drawing unit; note a unit that is missing or not mm."""
    code = int(document.header.get("$INSUNITS", 0))
    if code == units.MM:
        content.unit = "mm"
        return 1.0
    if code == 0:
        content.problems.append(Problem.warning("cut_file.no_unit"))
        return 1.0
    try:
        content.unit = units.decode(code) or str(code)
        factor = float(units.conversion_factor(InsertUnits(code), InsertUnits.Millimeters))
    except (ValueError, KeyError, IndexError, TypeError):
        content.problems.append(Problem.error("cut_file.unknown_unit", unit=code))
        return 1.0
    content.problems.append(Problem.warning("cut_file.other_unit", unit=content.unit))
    return factor


def _facts(document: Drawing) -> dict[str, str]:
    facts = {str(key): str(value) for key, value in document.header.custom_vars}
    record = document.ezdxf_metadata()
    sheets = (f"S{number}_" for number in range(1, MOST_SHEETS + 1))
    for start in ("", *takewhile(lambda one: f"{one}DESIGN" in record, sheets)):
        for key in (f"{start}{name}" for name in RECORDED_FACTS):
            if key not in facts and key in record:
                facts[key] = str(record[key])
        for name in (f"{start}{name}" for name in RECORDED_LISTS):
            for piece in takewhile(record.__contains__, (f"{name}_{number}" for number in range(MOST_PIECES))):
                facts.setdefault(piece, str(record[piece]))
    return facts


def _add_path(content: DxfContent, entity: DXFEntity, factor: float) -> None:
    layer = _layer(entity)
    name = {"kind": entity.dxftype(), "handle": str(entity.dxf.get("handle", "?")), "layer": layer}
    try:
        points = _flattened(entity, factor)
    except _TooLargeError:
        content.problems.append(Problem.error("cut_file.too_large_curve", limit=LARGEST_CURVE_MM / 1000.0, **name))
        return
    except PARSER_FAULTS:
        content.problems.append(Problem.error("cut_file.no_curve", **name))
        return
    if not np.all(np.abs(points) < FARTHEST_MM):
        content.problems.append(Problem.error("cut_file.not_a_number", **name))
        return
    length = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum()) if len(points) > 1 else 0.0
    if length < SHORTEST_MM:
        where = (float(points[0, 0]), float(points[0, 1])) if len(points) else None
        content.problems.append(Problem.error("cut_file.no_length", where, **name))
        return
    closed = _is_closed(entity)
    exact = _exact_length(entity)
    arcs = 0.0 if exact is None else exact * factor - length
    content.paths.append(FilePath(_met(points) if closed else points, layer, closed, arcs))


def _exact_length(entity: DXFEntity) -> float | None:
    """Length of a curve with arcs in the drawing's unit; None for kinds that are measured along chords."""
    if isinstance(entity, LWPolyline) and entity.has_arc:
        rows = np.array(entity.get_points("xyb"), dtype=np.float64)
        return float(edge_lengths(rows[:, :2], rows[:, 2], bool(entity.closed)).sum())
    if isinstance(entity, Polyline) and entity.is_2d_polyline and entity.has_arc:
        rows = np.array(
            [(vertex.dxf.location.x, vertex.dxf.location.y, vertex.dxf.bulge) for vertex in entity.vertices]
        )
        return float(edge_lengths(rows[:, :2], rows[:, 2], bool(entity.is_closed)).sum())
    if isinstance(entity, Circle) and not isinstance(entity, Arc):
        return float(2.0 * math.pi * entity.dxf.radius)
    if isinstance(entity, Arc):
        turn = math.radians((entity.dxf.end_angle - entity.dxf.start_angle) % 360.0)
        return float(entity.dxf.radius * (turn or 2.0 * math.pi))
    return None


class _TooLargeError(Exception):
    """A curve beyond what any machine cuts; its chords would have no end."""


def _flattened(entity: DXFEntity, factor: float) -> FloatArray:
    """Points of a curve in mm: (P, 2); raises what ezdxf raises for impossible curves."""
    if isinstance(entity, LWPolyline) and not entity.has_arc:
        corners = [(x, y) for x, y in entity.vertices()]
        points = corners + corners[:1] if entity.closed else corners
    elif isinstance(entity, Polyline) and not entity.is_2d_polyline and not entity.is_3d_polyline:
        raise ValueError("meshes are no curves")
    else:
        for value in entity.dxf.all_existing_dxf_attribs().values():
            if isinstance(value, float) and not math.isfinite(value):
                return np.array([[math.nan, math.nan]])
        path = make_path(entity)
        reached = np.array([v.xyz for v in path.control_vertices()], dtype=np.float64).reshape(-1, 3)
        if np.isnan(reached).any() or np.isinf(reached[:, 2]).any():
            return np.array([[math.nan, math.nan]])
        if len(reached) and not np.ptp(reached, axis=0).max() * factor <= LARGEST_CURVE_MM:  # infinite ones, too
            raise _TooLargeError
        points = [(v.x, v.y) for v in path.flattening(FLATTEN_MM / factor)]
    return np.array(points, dtype=np.float64).reshape(-1, 2) * factor


def _met(points: FloatArray) -> FloatArray:
    """Points of a closed curve, where flattening arcs may miss the first one by a rounding error at the end."""
    if np.abs(points[-1] - points[0]).max() > ROUNDING_MM:
        return points
    return np.concatenate([points[:-1], points[:1]])


def _is_closed(entity: DXFEntity) -> bool:
    if isinstance(entity, LWPolyline):
        return bool(entity.closed)
    if isinstance(entity, Polyline):
        return bool(entity.is_closed)
    return entity.dxftype() == "CIRCLE"
