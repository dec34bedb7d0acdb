"""Judge any cut file: units, layers, duplicates, gaps, pieces, narrowest ligament.

:func:`check_file` reads a DXF of any origin, a cut SVG of this program, or a folder of layer files.  A file written
here says how it was made, how many tabs its outline has and how many cuts end on other cuts, and is held to that; in a
foreign file the outline is the largest closed contour.  A name that such a file says it engraves is no cut.  A sound
file is no verdict on its sheet: whether that closes and its material holds is known by the design alone.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import shapely
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.assembly.nesting import LaidShape
from kirigami_studio.export.dxf_reading import (
    FARTHEST_MM,
    FLATTEN_MM,
    MOST_SHEETS,
    SHORTEST_MM,
    DxfContent,
    FilePath,
    read_content,
)
from kirigami_studio.export.file_content import MILLIMETRES
from kirigami_studio.export.file_record import LONGEST_SAID, FileRecord, PieceRecord, piece_record_of, record_of
from kirigami_studio.export.layer_files import MARK_GAP_MM, REGISTRATION_LAYER, layer_paths
from kirigami_studio.export.lightburn import read_lightburn
from kirigami_studio.export.profile import ARTWORK_LAYER, NAME_LAYER
from kirigami_studio.export.provenance import AROUND, BOX, PLACE, PROGRAM, SHEETS, SLOT_KERF, THROUGH
from kirigami_studio.export.sheet_bed import place_of_text
from kirigami_studio.export.svg_reading import LARGEST_FILE, facts_of_svg, is_svg, read_with_xml
from kirigami_studio.fabricate.checks import OVERLAP_TOLERANCE_MM, WIDTH_TOLERANCE_MM, place_of
from kirigami_studio.fabricate.copies import are_apart, copy_numbers
from kirigami_studio.fabricate.cut_plan import LARGEST_SHEET_MM, SMALLEST_SHEET_MM, Layer
from kirigami_studio.fabricate.engraving import nearest_cut
from kirigami_studio.fabricate.findings import Problem, Severity
from kirigami_studio.fabricate.finished_sheet import RepeatedCut, overlap, remaining_pieces, smallest_ligament
from kirigami_studio.fabricate.joints import ending_on_others
from kirigami_studio.fabricate.tabs import joined_ring
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import read_at_most
from kirigami_studio.foundation.plain_text import plain_line

#: A length of the box round a sheet, mm.
BOX_NUMBER = re.compile(r"\d{1,4}\.\d{4}", re.ASCII)
#: Kinds of file that an export has beside cut files.
NO_CUT_FILES = frozenset({".pdf", ".png", ".gif", ".html", ".json", ".kiri", ".csv", ".txt"}) | frozenset(
    {".3mf", ".stl", ".obj", ".fold", ".xml", ".inp", ".geo"}
)
#: A tab may differ from the width that the file promises by this much (mm).
TAB_TOLERANCE_MM = 1e-3
#: Cuts may end this far (mm) beyond the outline: edge cuts run over it on purpose.
REACH_MM = 1.0
#: Contact with the outline below this (mm) is rounding.
TOUCH_MM = 1e-3
#: Machine programs choose the operation by these words in a layer's name (MeerK40t, K40 Whisperer).
TRAP_WORDS = ("CUT", "ENGRAVE")
#: What a file says of the numbers of its engraved lines, and their layers.
ENGRAVED_FACTS = {"ENGRAVED_LINES": NAME_LAYER, "ARTWORK_LINES": ARTWORK_LAYER}
#: Ends nearer than this (mm) count as the same point.
SAME_POINT_MM = 1e-4
#: Closed cuts that are wider than this (mm) are no slots.
WIDEST_SLOT_MM = 1.5
#: An outline whose ends miss each other by less than this (mm) was meant to be closed.
NEARLY_CLOSED_MM = 0.5


@dataclass(frozen=True, slots=True)
class FileReport:
    """The contents of a cut file."""

    path: Path
    problems: tuple[Problem, ...]
    unit: str  #: "mm", another unit's name, or "none"
    layers: tuple[str, ...]  #: layers that hold entities
    path_count: int  #: curves that can be cut
    #: cut_length_mm, overlap_mm: length of all curves, and how much of it lies on another curve.
    cut_length_mm: float
    overlap_mm: float
    bounds_mm: tuple[float, float]  #: (width, height); extent of all curves
    kerf_mm: float  #: the kerf that pieces and ligaments were computed with
    pieces: int | None  #: Pieces of the sheet after cutting; None without a closed outline.
    min_ligament_mm: float | None  #: finished width of the narrowest place between two cuts
    #: How the file says it was made; None for files of others, of earlier versions, and for damaged records.
    record: FileRecord | None = None
    of_pieces: PieceRecord | None = None  #: the same of a bed with the pieces of an assembly
    sheets: tuple[FileReport, ...] = ()  #: of each sheet of a bed with those of several designs
    place: LaidShape | None = None  #: where such a sheet lies, as the file has it

    @property
    def ok(self) -> bool:
        """No errors; there may be warnings."""
        return not any(problem.severity is Severity.ERROR for problem in self.problems)


def check_file(path: str | Path, kerf_mm: float | None = None) -> FileReport:
    """Read a DXF of any origin, or an own cut SVG, and list its faults for the cutter.

    Parameters
    ----------
    path : str or Path
        A file, whose content says of which kind it is; or a folder of layer files, which is checked as the one drawing
        that it is.  One file of such a folder is checked by itself without the sheet that only all of them show.
    kerf_mm : float, optional
        Full cut width; else what the file says of itself, else 0.

    Raises
    ------
    ExportError
        The file is missing or of another kind, or the kerf makes no sense.
    """
    content = _read(Path(path))
    return (
        _of_sheets(Path(path), content, kerf_mm) if SHEETS in content.facts else _judged(Path(path), content, kerf_mm)
    )


def _of_sheets(path: Path, content: DxfContent, kerf_mm: float | None) -> FileReport:
    """Judge a file with sheets of several designs: each by itself, by its own record."""
    problems = [*content.problems]
    said = content.facts[SHEETS]
    count = int(said) if said.isdecimal() and len(said) <= 4 else 0
    boxes = [_box_of(content, number) for number in range(1, min(count, MOST_SHEETS) + 1)]
    if not boxes or any(box is None for box in boxes):
        problems.append(Problem.error("cut_file.sheets_differ", promised=plain_line(said, LONGEST_SAID)))
        return _judged(path, replace(content, problems=problems), kerf_mm)
    part = {"PART": content.facts["PART"]} if "PART" in content.facts else {}
    shift = MARK_GAP_MM if part or path.is_dir() else 0.0
    inside = [shapely.box(*box).buffer(SAME_POINT_MM, join_style="mitre") for box in boxes if box is not None]
    inside = [shapely.transform(area, lambda points: points + shift) for area in inside]
    paths: list[list[FilePath]] = [[] for _ in boxes]
    for found in content.paths:
        line = LineString(found.points)
        at = next((number for number, area in enumerate(inside) if area.contains(line)), None)
        if at is None:
            x, y = found.points[0].tolist()
            problems.append(Problem.error("cut_file.outside_sheet", (x, y)))
            at = int(np.argmin([area.distance(line) for area in inside]))
        paths[at].append(found)
    reports = []
    for number, own in enumerate(paths, start=1):
        start = f"S{number}_"
        facts = {key.removeprefix(start): text for key, text in content.facts.items() if key.startswith(start)}
        layers = tuple(name for name in content.layers if any(one.layer == name for one in own))
        sheet = replace(content, paths=own, facts=facts | part, layers=layers, problems=[])
        place = place_of_text(facts.get(PLACE, ""), number - 1)
        reports.append(replace(_judged(path, sheet, kerf_mm), place=place))
    for report in reports:
        problems += [problem for problem in report.problems if problem not in problems]
    points = np.concatenate([found.points for found in content.paths] or [np.zeros((1, 2))])
    width, height = np.ptp(points, axis=0).tolist()
    pieces = [one.pieces for one in reports if one.pieces is not None]
    ligaments = [one.min_ligament_mm for one in reports if one.min_ligament_mm is not None]
    return FileReport(path, tuple(problems), content.unit, content.layers, sum(one.path_count for one in reports),
                      sum(one.cut_length_mm for one in reports), sum(one.overlap_mm for one in reports),
                      (width, height), reports[0].kerf_mm, sum(pieces) if len(pieces) == len(reports) else None,
                      min(ligaments, default=None), sheets=tuple(reports))  # fmt: skip


def _box_of(content: DxfContent, number: int) -> tuple[float, float, float, float] | None:
    """Left, bottom, right and top, mm, of a sheet of a file by its own record."""
    words = content.facts.get(f"S{number}_{BOX}", "").split()
    if len(words) != 4 or not all(BOX_NUMBER.fullmatch(word) for word in words):
        return None
    left, bottom, right, top = map(float, words)
    return left, bottom, right, top


def _judged(path: Path, content: DxfContent, kerf_mm: float | None) -> FileReport:
    """Judge a file with one sheet, its copies, or pieces."""
    kerf, damaged = _kerf(content, kerf_mm)
    if purpose := content.facts.get("PURPOSE"):
        # Whatever else it has is meant for eyes.
        problems = [Problem.error("cut_file.not_for_cutting", purpose=plain_line(purpose))]
        return FileReport(Path(path), tuple(problems), content.unit, content.layers, len(content.paths), 0.0, 0.0,
                          (0.0, 0.0), kerf, None, None)  # fmt: skip
    problems = [*content.problems, *_layer_problems(content.layers), *damaged]
    drawn = content.paths
    content = _without_name(content, kerf, problems)
    try:
        of_pieces = piece_record_of(content.facts)
    except ExportError as error:
        problems.append(Problem.error(error.code, **error.fields))
        of_pieces = None
    if of_pieces is not None:
        return _piece_report(Path(path), content, kerf, of_pieces, problems)
    record = _record(content, problems)
    content = _without_registration(content, problems)
    if not content.paths:
        of_the_name = drawn and "PART" in content.facts
        problems.append(Problem.warning("cut_file.name_alone") if of_the_name else Problem.error("cut_file.empty"))
        return FileReport(Path(path), tuple(problems), content.unit, content.layers, 0, 0.0, 0.0, (0.0, 0.0), kerf,
                          None, None)  # fmt: skip
    lines = [LineString(path.points) for path in content.paths]
    size = np.ptp(np.concatenate([path.points for path in content.paths]), axis=0)
    bounds = (float(size[0]), float(size[1]))
    twice = overlap(lines)
    problems += [*_size_problems(bounds), *_double_problems(content.paths, twice)]
    whole, length = content, sum(path.length for path in content.paths)
    content, copies = _one_of_copies(whole, kerf, problems)
    part = "PART" in content.facts and all(found.layer != Layer.OUTLINE.value for found in content.paths)
    if part:
        outline = None
    elif content.facts.get("TABS", "0") == "0":
        outline = _find_outline(content.paths, problems)
    else:
        outline = tabbed_outline(content, problems)
    if outline is not None:
        outline = _with_holes(outline, content, problems)
    problems += placement_problems(content.paths, outline)
    pieces, ligament = _physics(content, outline, kerf, problems)
    if record is not None and ligament is not None and ligament < record.least_connector_mm - WIDTH_TOLERANCE_MM:
        widths = {"width_mm": ligament, "recorded_mm": record.least_connector_mm}
        problems.append(Problem.warning("cut_file.narrower_than_recorded", **widths))
    return FileReport(Path(path), tuple(problems), content.unit, content.layers, len(lines), length, twice.length_mm,
                      bounds, kerf, None if pieces is None else copies * pieces, ligament, record)  # fmt: skip


def _piece_report(
    path: Path, content: DxfContent, kerf: float, record: PieceRecord, problems: list[Problem]
) -> FileReport:
    """Judge a bed with pieces: cuts closed and apart, as many pieces as its record says."""
    whole = "PART" not in content.facts
    if whole and len(content.paths) != record.lines:
        problems.append(Problem.error("cut_file.lines_differ", count=len(content.paths), promised=record.lines))
    points = np.concatenate([found.points for found in content.paths] or [np.zeros((1, 2))])
    width, height = np.ptp(points, axis=0).tolist()
    problems += _size_problems((width, height)) if content.paths else []
    for found in content.paths:
        if not found.closed:
            x, y = found.points[0].tolist()
            problems.append(Problem.error("cut_file.piece_open", (x, y)))
    rings = np.array([LineString(found.points) for found in content.paths], dtype=object)
    one, other = shapely.STRtree(rings).query(rings, predicate="intersects")
    for at in one[one < other].tolist():
        x, y = content.paths[at].points[0].tolist()
        problems.append(Problem.error("cut_file.pieces_cross", (x, y)))
    closed = [found.points for found in content.paths if found.closed and len(found.points) > 3]
    areas = np.array([Polygon(ring) for ring in closed], dtype=object)
    starts = [Point(ring[0]) for ring in closed]
    inside = shapely.STRtree(starts).query(areas, predicate="contains_properly")[1]
    # What lies in a hole is a further piece, as the tiles in a frame are.
    pieces = int(np.sum(np.bincount(inside, minlength=len(areas)) % 2 == 0))
    if whole and pieces != record.pieces:
        problems.append(Problem.error("cut_file.pieces_differ", count=pieces, promised=record.pieces))
    near = (
        [shapely.distance(rings[at], np.delete(rings, at)).min() for at in range(len(rings))] if len(rings) > 1 else []
    )
    length = sum(found.length for found in content.paths)
    ligament = float(min(near)) - kerf if near else None
    return FileReport(path, tuple(problems), content.unit, content.layers, len(content.paths), length, 0.0,
                      (width, height), kerf, pieces if whole else None, ligament, None, record)  # fmt: skip


def _record(content: DxfContent, problems: list[Problem]) -> FileRecord | None:
    """How a file says it was made, and whether it has as many cuts as it says."""
    try:
        record = record_of(content.facts)
    except ExportError as error:
        if all(problem.code != error.code for problem in problems):
            problems.append(Problem.error(error.code, **error.fields))
        return None
    if record is not None and "PART" not in content.facts and len(content.paths) != record.lines:
        problems.append(Problem.error("cut_file.lines_differ", count=len(content.paths), promised=record.lines))
    return record


def _one_of_copies(content: DxfContent, kerf: float, problems: list[Problem]) -> tuple[DxfContent, int]:
    """The first of the copies that a file names, and their number; they are alike and apart."""
    said, gap = content.facts.get("COPIES", "1"), _number(content, "COPY_GAP_MM")
    copies = int(said) if said.isdecimal() and len(said) <= 3 else 0
    if copies == 1:
        return content, 1
    if not 1 < copies <= len(content.paths):
        problems.append(Problem.error("cut_file.copies_differ", promised=said))
        return content, 1
    numbers = copy_numbers([path.layer for path in content.paths], copies)
    sheets = [[content.paths[at] for at in np.flatnonzero(numbers == copy).tolist()] for copy in range(copies)]
    clouds = [np.concatenate([path.points for path in sheet] or [np.zeros((1, 2))]) for sheet in sheets]
    # Not the other way round, so that a gap that is no number counts as a fault.
    apart = gap > kerf and are_apart(clouds, gap - kerf, 2.0 * SAME_POINT_MM)
    if not (apart and _are_alike(sheets)):
        problems.append(Problem.error("cut_file.copies_differ", promised=said))
    return replace(content, paths=sheets[0]), copies


def _are_alike(sheets: Sequence[Sequence[FilePath]]) -> bool:
    """Whether copies have the same lines but for their place."""
    first = sheets[0]
    return all(
        len(sheet) == len(first)
        and all(
            _is_same(one, replace(other, points=other.points + (first[0].points[0] - sheet[0].points[0])))
            for one, other in zip(first, sheet, strict=True)
        )
        for sheet in sheets[1:]
    )


def _is_same(one: FilePath, other: FilePath) -> bool:
    """Whether two curves are one.

    Chords of an arc may begin at other points of it, those of nothing else.
    """
    least = 2.0 * SAME_POINT_MM
    if not one.arcs_mm and not other.arcs_mm:
        return one.points.shape == other.points.shape and float(np.abs(one.points - other.points).max()) <= least
    ends = float(np.abs(one.points[[0, -1]] - other.points[[0, -1]]).max())
    apart = float(shapely.hausdorff_distance(LineString(one.points), LineString(other.points)))
    return ends <= least and abs(one.length - other.length) <= least and apart <= FLATTEN_MM + least


def _read(path: Path) -> DxfContent:
    """A file, or the files of a folder as one drawing; registration marks are no cuts."""
    if not path.is_dir() or not any(path.iterdir()):
        if path.suffix.lower() in NO_CUT_FILES:
            raise ExportError("cut_file.other_kind", path=path)
        if path.suffix.lower() == ".lbrn2":
            return _lightburn_content(path)
        return _without_marks(_svg_content(path) if is_svg(path) else read_content(path))
    contents = [read_content(part) for part in layer_paths(path)]
    marks = [[p.points.tolist() for p in content.paths if p.layer == REGISTRATION_LAYER] for content in contents]
    if any(found != marks[0] or not found for found in marks):
        raise ExportError("layers.not_registered", folder=path)
    problems = [problem for content in contents for problem in content.problems]
    whole = DxfContent(
        paths=[found for content in contents for found in content.paths],
        unit=contents[0].unit,
        layers=tuple(sorted({name for content in contents for name in content.layers})),
        facts={key: value for key, value in contents[0].facts.items() if key != "PART"},
        problems=[problem for nth, problem in enumerate(problems) if problem not in problems[:nth]],
    )
    return _without_marks(whole)


def _svg_content(path: Path) -> DxfContent:
    """A cut SVG of this program, as if it were a DXF."""
    facts = facts_of_svg(path)
    if PROGRAM not in facts:
        raise ExportError("cut_file.foreign_svg", path=path)
    found = read_with_xml(path)
    problems = [
        Problem.error("cut_file.other_entities", count=n, kind=kind) for kind, n in Counter(found.others).items()
    ]
    if found.unit != MILLIMETRES:
        problems.append(Problem.warning("cut_file.no_unit"))
    paths = []
    for number, stroke in enumerate(found.strokes, start=1):
        points = stroke.travelled(FLATTEN_MM)
        chords = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
        name = {"kind": "path", "handle": f"{number}", "layer": stroke.layer}
        if not np.all(np.abs(points) < FARTHEST_MM):
            problems.append(Problem.error("cut_file.not_a_number", **name))
        elif chords < SHORTEST_MM:
            problems.append(Problem.error("cut_file.no_length", **name))
        else:
            paths.append(FilePath(points, stroke.layer, stroke.closed, stroke.length - chords))
    unit = "mm" if found.unit == MILLIMETRES else "none"
    return DxfContent(paths, unit, tuple(sorted(found.layers)), facts, problems)


def _lightburn_content(path: Path) -> DxfContent:
    """A LightBurn project, as if it were a DXF."""
    try:
        found = read_lightburn(read_at_most(path, LARGEST_FILE), path)
    except OSError as error:
        raise ExportError("dxf.cannot_open", path=path, reason=error.strerror or str(error)) from error
    paths = [FilePath(one.points, one.layer, one.closed) for one in found.paths]
    return DxfContent(paths, "mm", tuple(sorted(found.layers)), dict(found.facts), [])


def _without_marks(content: DxfContent) -> DxfContent:
    return replace(
        content,
        paths=[path for path in content.paths if path.layer != REGISTRATION_LAYER],
        layers=tuple(name for name in content.layers if name != REGISTRATION_LAYER),
    )


def _without_name(content: DxfContent, kerf: float, problems: list[Problem]) -> DxfContent:
    """The cuts alone of a file that engraves a name, or artwork, in so many lines.

    Of files for single layers one holds all of the name, and the others nothing of it.
    """
    promised = {layer: content.facts.get(fact) for fact, layer in ENGRAVED_FACTS.items()}
    if not any(promised.values()):
        return content
    engraved = frozenset(layer for layer, count in promised.items() if count)
    cuts = [path for path in content.paths if path.layer not in engraved]
    for layer in sorted(engraved):
        count = sum(path.layer == layer for path in content.paths)
        if f"{count}" != promised[layer] and (count or "PART" not in content.facts):
            problems.append(Problem.error("cut_file.name_differs", promised=promised[layer], layer=layer, count=count))
    # Lines of artwork may end at the edge of a piece.
    names = [path for path in content.paths if path.layer == NAME_LAYER and NAME_LAYER in engraved]
    if names and cuts:
        clear = nearest_cut([path.points for path in names], [path.points for path in cuts])
        if clear.distance_mm < kerf:
            problems.append(Problem.error("cut_file.name_cuts", clear.where, clear_mm=clear.distance_mm))
    return replace(content, paths=cuts)


def _without_registration(content: DxfContent, problems: list[Problem]) -> DxfContent:
    """The sheet of a file without holes round it and through it."""
    promised = content.facts.get(AROUND)
    if promised is None or "PART" in content.facts:
        return content
    around, through = (
        int(one) if one.isdecimal() and len(one) <= 2 else 0 for one in (promised, content.facts.get(THROUGH, "0"))
    )
    outside, inside = content.paths[:around], content.paths[around : around + through]
    cuts = content.paths[around + through :]
    sheet = shapely.box(*shapely.total_bounds([LineString(path.points) for path in cuts])) if cuts else Polygon()
    lines = [LineString(path.points) for path in (*outside, *inside)]
    right = [sheet.intersects(line) == (number >= around) for number, line in enumerate(lines)]
    if not around or not all(right) or not all(path.closed for path in (*outside, *inside)):
        problems.append(Problem.error("cut_file.registration_differs", promised=promised))
        return content
    return replace(content, paths=cuts)


def _kerf(content: DxfContent, kerf_mm: float | None) -> tuple[float, list[Problem]]:
    """The kerf of the call or of the file; 0 and a problem where the file names no width."""
    kerf = _number(content, "KERF_MM", "0") if kerf_mm is None else kerf_mm
    if 0.0 <= kerf <= LARGEST_SHEET_MM:
        return kerf, []
    if kerf_mm is not None:
        raise ExportError("cut_file.kerf_not_a_width", value=kerf)
    said = plain_line(content.facts["KERF_MM"], LONGEST_SAID)
    return 0.0, [Problem.error("cut_file.record_not_readable", name="KERF_MM", value=said)]


def _layer_problems(layers: Sequence[str]) -> list[Problem]:
    trapped = [name for name in layers if any(word in name.upper() for word in TRAP_WORDS)]
    if not trapped:
        return []
    return [Problem.error("cut_file.trap_layers", layers=", ".join(trapped))]


def _size_problems(bounds: tuple[float, float]) -> list[Problem]:
    if max(bounds) <= LARGEST_SHEET_MM and max(bounds) >= SMALLEST_SHEET_MM:
        return []
    return [
        Problem.error(
            "cut_file.size_unlikely",
            width_mm=bounds[0],
            height_mm=bounds[1],
            smallest_mm=SMALLEST_SHEET_MM,
            largest_mm=LARGEST_SHEET_MM,
        )
    ]


def _double_problems(paths: Sequence[FilePath], twice: RepeatedCut) -> list[Problem]:
    seen: Counter[tuple[tuple[float, float], ...]] = Counter()
    for path in paths:
        points = np.round(path.points / SAME_POINT_MM).astype(np.int64)
        for start, stop in zip(points[:-1].tolist(), points[1:].tolist(), strict=True):
            seen[tuple(sorted((tuple(start), tuple(stop))))] += 1
    doubles = [(ends, count) for ends, count in seen.items() if count > 1 and ends[0] != ends[1]]
    problems = []
    if doubles:
        (x, y), _ = doubles[0][0]
        where = (x * SAME_POINT_MM, y * SAME_POINT_MM)
        again = sum(count - 1 for _, count in doubles)
        problems.append(Problem.error("cut_file.duplicates", where, count=again))
    if twice.length_mm > OVERLAP_TOLERANCE_MM:
        problems.append(Problem.error("cut_file.overlap", twice.where, length_mm=twice.length_mm))
    return problems


def _find_outline(paths: Sequence[FilePath], problems: list[Problem]) -> Polygon | None:
    """Return the area inside the outline; note when it is open, crosses itself or is missing.

    The outline is what the OUTLINE layer holds; in a foreign file, the largest closed contour, be it one path or a
    chain of lines that meet.
    """
    own = [path for path in paths if path.layer == Layer.OUTLINE.value]
    rings = [Polygon(path.points) for path in own or paths if path.closed and len(path.points) > 3]
    if not rings:
        chains = _chains(own or paths)
        rings = [Polygon(chain.coords) for chain in chains if chain.is_closed and len(chain.coords) > 3]
        if not rings:
            problems.append(_open_outline(chains))
            return None
        problems.append(Problem.warning("cut_file.outline_of_lines"))
    outline = max(rings, key=lambda ring: float(ring.area))
    if not outline.is_valid:
        where = shapely.get_coordinates(outline)[0]
        problems.append(Problem.error("cut_file.outline_crosses_itself", (float(where[0]), float(where[1]))))
        return None
    return outline


def _holes_said(facts: Mapping[str, str]) -> int:
    """How many holes a file of ours says that its silhouette has."""
    said = facts.get("HOLES", "0")
    return int(said) if said.isdecimal() and len(said) <= 3 else 0


def _with_holes(outline: Polygon, content: DxfContent, problems: list[Problem]) -> Polygon:
    """The area inside the outline less as many holes as the file says: the last closed cuts.

    Slots run into holes: in a file of slots they are slots like the others.
    """
    count = 0 if SLOT_KERF in content.facts else _holes_said(content.facts)
    if not count:
        return outline
    near = outline.exterior.buffer(SAME_POINT_MM)
    layered = [path for path in content.paths if path.layer == Layer.HOLES.value]
    closed = [path.points for path in layered or content.paths if path.closed and len(path.points) > 3]
    holes = [points for points in closed if not LineString(points).within(near)][-count:]
    cut = Polygon(outline.exterior, holes)
    if len(holes) < count or not cut.is_valid:
        problems.append(Problem.error("cut_file.holes_differ", count=len(holes), promised=count))
        return outline
    return cut


def _chains(paths: Sequence[FilePath]) -> list[LineString]:
    """Join lines whose ends meet, each piece of line used once."""
    snapped = shapely.set_precision(shapely.multilinestrings([LineString(path.points) for path in paths]), 1e-6)
    merged = shapely.line_merge(shapely.union_all(snapped))
    return [part for part in shapely.get_parts(merged) if isinstance(part, LineString)]


def _open_outline(chains: Sequence[LineString]) -> Problem:
    gaps = [(chain.length, shapely.Point(chain.coords[0]).distance(shapely.Point(chain.coords[-1])), chain)
            for chain in chains]  # fmt: skip
    nearly = [entry for entry in gaps if entry[1] < NEARLY_CLOSED_MM and entry[0] > SMALLEST_SHEET_MM]
    if not nearly:
        return Problem.error("cut_file.no_outline")
    _, gap, chain = max(nearly, key=lambda entry: entry[0])
    x, y = chain.coords[0]
    return Problem.error("cut_file.outline_open", (float(x), float(y)), gap_mm=float(gap))


def tabbed_outline(content: DxfContent, problems: list[Problem]) -> Polygon | None:
    """Return the area inside the outline with its tabs closed; note gaps that are no tabs.

    Parameters
    ----------
    content : DxfContent
        Its facts hold ``TABS``, ``TAB_MM`` and ``KERF_MM``.
    """
    parts = [path for path in content.paths if path.layer == Layer.OUTLINE.value]
    if not parts and content.facts["TABS"].isdecimal():
        # A file with everything on one layer: its outline comes last.
        parts = content.paths[-int(content.facts["TABS"]) :]
    closed = sum(path.closed for path in parts)
    if closed or f"{len(parts)}" != content.facts["TABS"]:
        x, y = parts[0].points[-1] if parts else (0.0, 0.0)
        tabs, where = content.facts["TABS"], (float(x), float(y))
        problems.append(Problem.error("cut_file.tab_count", where, tabs=tabs, paths=len(parts), closed=closed))
        return None
    wanted = _number(content, "TAB_MM") + _number(content, "KERF_MM")
    ends = np.array([path.points[[0, -1]] for path in parts]).reshape(-1, 2)
    away = np.linalg.norm(ends[:, None] - ends, axis=2)
    np.fill_diagonal(away, np.inf)
    gaps = away.min(axis=1)
    # Not above, so that a fact that is no number counts as a fault.
    if not np.all(np.abs(gaps - wanted) <= TAB_TOLERANCE_MM):
        worst = int(np.argmax(np.abs(gaps - wanted)))
        x, y = ends[worst]
        gap, where = float(gaps[worst]), (float(x), float(y))
        problems.append(Problem.error("cut_file.tab_gap", where, gap_mm=gap, promised_mm=wanted))
        return None
    return Polygon(joined_ring([path.points for path in parts]))


def _number(content: DxfContent, key: str, default: str = "nan") -> float:
    try:
        return float(content.facts.get(key, default))
    except ValueError:
        return math.nan


def placement_problems(paths: Sequence[FilePath], outline: Polygon | None) -> list[Problem]:
    """List cuts outside the outline, across it, below the origin, and after it."""
    problems: list[Problem] = []
    low = np.concatenate([path.points for path in paths]).min(axis=0)
    if low.min() < -TOUCH_MM:
        problems.append(Problem.warning("cut_file.below_origin", low_x=float(low[0]), low_y=float(low[1])))
    if outline is None:
        return problems
    inside, reach = outline.buffer(-TOUCH_MM), outline.buffer(REACH_MM)
    lines = [LineString(path.points) for path in paths]
    for path, line in zip(paths, lines, strict=True):
        x, y = path.points[0]
        if not line.within(reach):
            problems.append(Problem.error("cut_file.outside_sheet", (float(x), float(y))))
        elif path.layer == Layer.SLITS.value and not line.within(inside):
            problems.append(Problem.error("cut_file.slit_reaches_outline", (float(x), float(y))))
    ring = outline.exterior.buffer(TOUCH_MM)
    on_ring = np.array([bool(shapely.within(line, ring)) for line in lines])
    if on_ring.any() and not on_ring[-1]:
        problems.append(Problem.warning("cut_file.cuts_after_outline"))
    return problems


def _physics(
    content: DxfContent, outline: Polygon | None, kerf: float, problems: list[Problem]
) -> tuple[int | None, float | None]:
    """Cut the sheet: number of pieces and narrowest ligament."""
    if outline is None or "PART" in content.facts:
        return None, None
    ring = outline.boundary
    near_ring = ring.buffer(SAME_POINT_MM)
    inner = [path for path in content.paths if not LineString(path.points).within(near_ring)]
    holes = [Polygon(path.points) for path in inner if path.closed and len(path.points) > 3]
    problems += _loose_discs(inner, _holes_said(content.facts))
    sheet: BaseGeometry = outline.difference(shapely.union_all([hole for hole in holes if hole.is_valid]))
    cuts, joined = _inner_cuts(inner, content.facts, problems)
    left = remaining_pieces(sheet, cuts, kerf)
    pieces = len(left)
    if pieces != 1:
        if left:
            where = place_of(left[1].representative_point())
            problems.append(Problem.error("cut_file.falls_apart", where, kerf_mm=kerf, pieces=pieces))
        else:
            problems.append(Problem.error("cut_file.nothing_left", place_of(outline.centroid), kerf_mm=kerf))
    ligament = smallest_ligament(cuts, ring, kerf, joined)
    if ligament is None:
        return pieces, None
    if ligament.width_mm <= 0 and pieces == 1:
        # In a foreign drawing cuts may cross on purpose; in ours a connector is lost.
        ours = any(path.layer in (Layer.SLITS.value, Layer.EDGE_SLITS.value) for path in content.paths)
        weighed = Problem.error if ours else Problem.warning
        problems.append(weighed("cut_file.connector_lost", ligament.where))
    return pieces, ligament.width_mm


def _loose_discs(inner: Sequence[FilePath], meant: int = 0) -> list[Problem]:
    """Closed cuts whose inside falls out, beside relief holes, slots and holes that are meant."""
    closed = [Polygon(path.points) for path in inner if path.closed and path.layer != Layer.RELIEF.value
              and len(path.points) > 3]  # fmt: skip
    # Twice the area over half the length: about the width of a slot, the radius of a disc.
    wide = [ring for ring in closed if 4.0 * ring.area > WIDEST_SLOT_MM * 2.0 * ring.length]
    if len(wide) <= meant:
        return []
    largest = max(wide, key=lambda ring: float(ring.area))
    size = math.sqrt(4.0 * largest.area / math.pi)
    return [Problem.warning("cut_file.loose_parts", place_of(largest.centroid), count=len(wide), size_mm=size)]


def _inner_cuts(
    inner: Sequence[FilePath], facts: Mapping[str, str], problems: list[Problem]
) -> tuple[list[LineString], set[tuple[int, int]]]:
    """All cuts but the outline, and which of them meet on purpose.

    Lines of a foreign file are joined to chains.  A file of ours says how many cuts end on another one (slits on their
    relief holes, arcs and bars, and on each other where a connector was removed).
    """
    if "JOINS" not in facts:
        return (_chains(inner) if inner else []), set()
    lines = [LineString(path.points) for path in inner]
    ends = ending_on_others(lines)
    if f"{len(ends)}" == facts["JOINS"]:
        return lines, set(ends)
    x, y = shapely.get_coordinates(lines[ends[0][0]])[0] if ends else inner[0].points[0]
    where = (float(x), float(y))
    problems.append(Problem.error("cut_file.joins_differ", where, count=len(ends), promised=facts["JOINS"]))
    return lines, set()
