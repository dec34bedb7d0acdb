"""Verification of a written cut file: two independent readers against the plan, and the sheet that would be left.

An engraved name is compared by itself: it has to come back, before anything is cut, and to be clear of every cut.  All
else is told of the cuts alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import shapely
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.export.dxf_reading import read_with_ezdxf
from kirigami_studio.export.file_content import MILLIMETRES, FileContent, bent_otherwise, largest_shift
from kirigami_studio.export.group_codes import read_group_codes
from kirigami_studio.export.jam_angle import jam_angle_of_file, matched_connectors
from kirigami_studio.export.layer_files import by_layer, laid_together, layer_folder, layer_paths
from kirigami_studio.export.lightburn import lightburn_bytes, read_lightburn
from kirigami_studio.export.profile import DEFAULT_PROFILE, NAME_LAYER, DxfVersion, Profile, find_profile
from kirigami_studio.export.sheet_bed import SheetBed
from kirigami_studio.export.strokes import (
    Stroke,
    extent,
    frame_origin,
    layer_colours,
    name_strokes,
    sheet_strokes,
    strokes_of,
    total_length,
    work_of,
)
from kirigami_studio.export.svg_reading import LARGEST_FILE, read_with_svgelements, read_with_xml
from kirigami_studio.export.voids_read import LEAST_RING, FoundVoids, read_voids
from kirigami_studio.fabricate.checks import OVERLAP_TOLERANCE_MM, WIDTH_TOLERANCE_MM
from kirigami_studio.fabricate.copies import SAME_MM, alike, are_apart, copy_numbers
from kirigami_studio.fabricate.cut_path import MEASURED_CHORD_MM
from kirigami_studio.fabricate.cut_plan import CutPlan, Layer
from kirigami_studio.fabricate.engraving import MARGIN_MM, clearance_mm, nearest_cut
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.fabricate.finished_sheet import overlap_length, remaining_pieces, smallest_ligament
from kirigami_studio.fabricate.joints import Pair, joined_pairs
from kirigami_studio.fabricate.tabs import joined_ring
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import read_at_most
from kirigami_studio.foundation.sentences import sentence
from kirigami_studio.lattice.deployment import Deployment

Reader = Callable[[Path], FileContent]

#: Voids may miss being parallelograms by this much (micrometres) in a file whose connectors are all centred.
VOID_MISS_UM = 5.0
#: Share of its margin that a name may be nearer to a cut: the chords of arcs.
NAME_NEARER = 0.05


@dataclass(frozen=True, slots=True)
class Finding(Note):
    """One line of the report."""

    ok: bool = True
    warning: bool = False  #: Fine, but the user should know
    reader: str = ""  #: The only reader that found it; empty where all agree

    @classmethod
    def judged(cls, ok: bool, code: str, /, **fields: object) -> Finding:
        """A finding that is good or bad."""
        return Finding(code, fields, ok)

    @property
    def text(self) -> str:
        """The sentence, after the name of the reader if only one found it."""
        text = sentence(self.code, self.fields)
        return sentence("verify.by_one_reader", {"reader": self.reader, "finding": text}) if self.reader else text


@dataclass(frozen=True, slots=True)
class Verification:
    """What two readers found in a written cut file."""

    path: Path
    ok: bool  #: No finding is bad
    size_mm: tuple[float, float]  #: (width, height); everything that is drawn
    pieces: int | None  #: Pieces of the sheet after cutting; must be 1; None where the file does not say
    cut_length_mm: float  #: As the file says
    #: seconds_low and seconds_high: Estimated time of the job
    seconds_low: float
    seconds_high: float
    findings: tuple[Finding, ...]
    warnings: tuple[Note, ...]  #: Notes to read before cutting
    #: By how much voids miss being parallelograms about the connectors' centres as read from the file; None where none
    #: were found
    void_miss_um: float | None = None
    #: radians; where the sheet jams, 0 if it closes: by its simulation where that is known and the file is as planned,
    #: else by the estimate for these centres; None where nothing is known
    jam_phi: float | None = None
    sheet: str = ""  #: Name of the sheet that it is about, of a file that holds several


@dataclass(frozen=True, slots=True)
class Format:
    """How one kind of file is read twice."""

    readers: tuple[Reader, Reader]
    shift_mm: float  #: Points may differ by this from the plan
    bulge: float  #: Bulges may differ by this


#: SVG has four decimals, and arcs by their radius.
FORMATS = {
    ".dxf": Format((read_with_ezdxf, read_group_codes), 1e-9, 1e-9),
    ".svg": Format((read_with_svgelements, read_with_xml), 1e-4, 5e-3),
}


def verify_export(
    plan: CutPlan,
    path: str | Path,
    profile_key: str,
    version: str | None = "R2010",
    deployment: Deployment | None = None,
    simulated_jam: float | None = None,
) -> Verification:
    """Read a written file with two readers and compare it with the plan that it was written from.

    Parameters
    ----------
    plan : CutPlan
    path : str or Path
        A cut file, or a LightBurn project; of a profile with one file per layer, its folder or the name that the folder
        was made for.
    profile_key : str
    version : str or None
        DXF dialect that it was written in; None for the one that it says it is in.
    deployment : Deployment, optional
        The design of the plan; without it nothing is said about where the sheet jams.
    simulated_jam : float, optional, radians
        Where the planned sheet jams by its simulation, 0 if it closes; a file that is as planned has no other angle.

    Raises
    ------
    ExportError
        Unknown profile, a kind of file that cannot be verified, or a file that does not read.
    """
    goal, profile = Path(path), find_profile(profile_key)
    if goal.suffix.lower() == ".lbrn2":
        return _project_verified(plan, goal, simulated_jam, lightburn_bytes(plan), len(plan.copies))
    goal, kind, contents = _read_twice(goal, profile)
    strokes = _as_filed(strokes_of(plan, profile), goal)
    return _judged(plan, goal, profile, version, strokes, contents, kind, deployment, simulated_jam)


def verify_bed(
    bed: SheetBed, path: str | Path, profile_key: str, version: str | None = "R2010", project: bytes = b""
) -> tuple[Verification, ...]:
    """Read the file of a bed with two readers, and compare every sheet with its plan.

    Parameters
    ----------
    bed : SheetBed
    path, profile_key, version
        As for :func:`verify_export`.
    project : bytes
        The LightBurn project that the bed makes, which one that was written is compared with.

    Returns
    -------
    verifications : tuple of Verification
        One for each sheet; what is wrong with the whole file stands in all of them.

    Raises
    ------
    ExportError
        As :func:`verify_export`.
    """
    goal, profile = Path(path), find_profile(profile_key)
    if goal.suffix.lower() == ".lbrn2":
        return tuple(_project_verified(sheet.plan, goal, sheet.simulated_jam, project) for sheet in bed.sheets)
    goal, kind, contents = _read_twice(goal, profile)
    dialect = version or _dialect(goal, contents)
    planned = _as_filed(bed.strokes(profile), goal)
    of_file = agreed(contents, [reader_findings(content, planned, dialect, kind) for content in contents])
    sheets = [bed.by_sheet(content.strokes, profile) for content in contents]
    together = [*(finding for finding in of_file if not finding.ok), _apart(sheets[-1], bed)]
    found = []
    for number, sheet in enumerate(bed.sheets):
        own = [_alone(content, strokes[number]) for content, strokes in zip(contents, sheets, strict=True)]
        meant = _as_filed(sheet_strokes(sheet.plan, profile), goal)
        judged = _judged(sheet.plan, goal, profile, dialect, meant, own, kind, sheet.deployment, sheet.simulated_jam)
        findings = (*judged.findings, *together)
        found.append(replace(judged, findings=findings, ok=all(finding.ok for finding in findings)))
    return tuple(found)


def _alone(content: FileContent, strokes: Sequence[Stroke]) -> FileContent:
    """Content of the file of one sheet; the frame of a file is that of its cuts."""
    cuts = [stroke for stroke in strokes if stroke.layer != NAME_LAYER]
    return replace(content, strokes=tuple(strokes), extent=extent(cuts) if cuts else None)


def _apart(sheets: Sequence[Sequence[Stroke]], bed: SheetBed) -> Finding:
    """Whether the sheets of a bed, each in its own frame, lie apart where they are placed."""
    clouds = [
        place.put(np.concatenate([stroke.travelled() for stroke in sheet] or [np.zeros((1, 2))]))
        for sheet, place in zip(sheets, bed.places, strict=True)
    ]
    # Slots and overcuts reach beyond cut lines by less than a kerf.
    least = bed.gap_mm - max(sheet.plan.kerf_mm for sheet in bed.sheets)
    right = are_apart(clouds, least, SAME_MM)
    found = {"count": len(sheets), "gap_mm": bed.gap_mm}
    return Finding.judged(right, "verify.sheets" if right else "verify.sheets_meet", **found)


def _read_twice(goal: Path, profile: Profile) -> tuple[Path, Format, list[FileContent]]:
    """Place of a file or of the folder of its layers, its kind, and what both readers find."""
    if profile.file_per_layer and goal.suffix.lower() != ".svg":
        goal, kind = layer_folder(goal), FORMATS[".dxf"]
        parts = layer_paths(goal)
        return goal, kind, [laid_together([read(part) for part in parts], goal) for read in kind.readers]
    if goal.suffix.lower() not in FORMATS:
        raise ExportError("verify.unknown_kind", path=goal, known=", ".join(FORMATS))
    kind = FORMATS[goal.suffix.lower()]
    return goal, kind, [read(goal) for read in kind.readers]


def _as_filed(strokes: Sequence[Stroke], goal: Path) -> tuple[Stroke, ...]:
    """Strokes in the order in which a file, or the folder of its layers, has them."""
    if goal.suffix.lower() in FORMATS:
        return tuple(strokes)
    return tuple(stroke for part in by_layer(strokes).values() for stroke in part)


def _dialect(path: Path, contents: Sequence[FileContent]) -> str:
    """The DXF version that a file says it is in."""
    old = path.suffix.lower() != ".svg" and all(content.unit is None for content in contents)
    return DxfVersion.R12 if old else DxfVersion.R2010


def _judged(
    plan: CutPlan,
    path: Path,
    profile: Profile,
    dialect: str | None,
    strokes: Sequence[Stroke],
    contents: Sequence[FileContent],
    kind: Format,
    deployment: Deployment | None,
    simulated_jam: float | None,
) -> Verification:
    version = dialect or _dialect(path, contents)
    written, contents = contents, [_cuts_of(content) for content in contents]
    sheets = _copies_read(contents[-1].strokes, plan)
    physics = file_physics(sheets[0], plan, profile)
    voids = file_voids(sheets[0], plan, profile)
    by_reader = [reader_findings(content, strokes, version, kind) for content in contents]
    as_simulated = simulated_jam is not None and all(finding.ok for found in by_reader for finding in found)
    jam = simulated_jam if as_simulated else None
    if not as_simulated and deployment is not None:
        jam = jam_angle_of_file(voids, plan, deployment)
    times = work_of(strokes, plan).times
    findings = [
        *agreed(contents, by_reader),
        *agreed(contents, _name_findings(written, plan, profile, kind)),
        *_physics_findings(physics, plan),
        *_copies_findings(sheets, physics, plan, kind),
        *void_findings(voids, plan),
    ]
    warnings = [*plan.notes, *_cautions(plan, profile, version, strokes, path)]
    return Verification(
        path=path,
        ok=all(finding.ok for finding in findings),
        size_mm=extent(contents[-1].strokes),
        pieces=physics.pieces * len(sheets),
        cut_length_mm=contents[-1].length,
        seconds_low=times.low,
        seconds_high=times.high,
        findings=tuple(findings),
        warnings=tuple(warnings),
        void_miss_um=voids.miss_um if voids.voids else None,
        jam_phi=jam,
    )


def _project_verified(
    plan: CutPlan, path: Path, simulated_jam: float | None, project: bytes, copies: int = 1
) -> Verification:
    """Compare a LightBurn project with the one that its plan makes: every path, on its layer, in its order."""
    found = read_lightburn(_bytes_of(path), path)
    meant = read_lightburn(project, path)
    same = len(found.paths) == len(meant.paths) and all(
        one.layer == other.layer and np.array_equal(one.curves, other.curves)
        for one, other in zip(found.paths, meant.paths, strict=True)
    )
    profile = find_profile(DEFAULT_PROFILE)
    strokes = sheet_strokes(plan, profile)
    work = work_of(strokes_of(plan, profile) if copies > 1 else strokes, plan)
    findings = [Finding.judged(same, "verify.project_as_planned" if same else "verify.project_differs")]
    physics = file_physics(strokes, plan, profile) if same else None
    if physics is not None:
        findings += _physics_findings(physics, plan)
    return Verification(
        path=path,
        ok=all(finding.ok for finding in findings),
        size_mm=plan.bounds_mm,
        pieces=None if physics is None else physics.pieces * copies,
        cut_length_mm=work.cut_length_mm,
        seconds_low=work.times.low,
        seconds_high=work.times.high,
        findings=tuple(findings),
        warnings=plan.notes,
        jam_phi=simulated_jam if same else None,
    )


def _bytes_of(path: Path) -> bytes:
    try:
        return read_at_most(path, LARGEST_FILE)
    except OSError as error:
        raise ExportError("dxf.cannot_open", path=path, reason=error.strerror or str(error)) from error


def agreed(contents: Sequence[FileContent], by_reader: Sequence[Sequence[Finding]]) -> list[Finding]:
    """Each finding once where all readers agree to the last digit, else once for each reader by its name."""
    found: list[Finding] = []
    for first, *others in zip(*by_reader, strict=True):
        if all(other == first for other in others):
            found.append(first)
        else:
            readers = [content.reader for content in contents]
            found += [replace(one, reader=reader) for one, reader in zip((first, *others), readers, strict=True)]
    return found


def _cuts_of(content: FileContent) -> FileContent:
    """What one reader found but for an engraved name."""
    return replace(content, strokes=tuple(stroke for stroke in content.strokes if stroke.layer != NAME_LAYER))


def _name_findings(
    contents: Sequence[FileContent], plan: CutPlan, profile: Profile, kind: Format
) -> list[list[Finding]]:
    """What each reader says of an engraved name; nothing where none was meant and none was found."""
    meant = name_strokes(plan, profile)
    if not meant and all(_cuts_of(content).strokes == content.strokes for content in contents):
        return [[] for _ in contents]
    return [[_name_finding(content, meant, plan, kind)] for content in contents]


def _name_finding(content: FileContent, meant: Sequence[Stroke], plan: CutPlan, kind: Format) -> Finding:
    names = [stroke for stroke in content.strokes if stroke.layer == NAME_LAYER]
    cuts = _cuts_of(content).strokes
    told = {"name": "" if plan.engraving is None else plan.engraving.text, "layer": NAME_LAYER}
    looks = [(stroke.layer, stroke.colour, stroke.closed) for stroke in names]
    same = looks == [(stroke.layer, stroke.colour, stroke.closed) for stroke in meant]
    first = [stroke.layer for stroke in content.strokes[: len(names)]] == [NAME_LAYER] * len(names)
    if not (names and same and first and largest_shift(names, meant) <= kind.shift_mm):
        return Finding.judged(False, "verify.name_differs", **told)
    traced = [stroke.travelled(MEASURED_CHORD_MM) for stroke in cuts]
    clear = nearest_cut([stroke.points for stroke in names], traced).distance_mm if traced else math.inf
    shared = {stroke.colour for stroke in names} & {stroke.colour for stroke in cuts}
    if shared or clear < clearance_mm(plan.kerf_mm) - NAME_NEARER * MARGIN_MM:
        return Finding.judged(False, "verify.name_cuts", clear_mm=clear)
    # Rounded as it is shown, so that readers that agree in print agree.
    return Finding.judged(True, "verify.name", **told, clear_mm=round(clear, 2))


def reader_findings(content: FileContent, strokes: Sequence[Stroke], version: str, kind: Format) -> list[Finding]:
    """Everything that one reader can compare."""
    return [
        _unit_finding(content, version),
        _count_finding(content, strokes),
        _layer_finding(content, strokes),
        _point_finding(content, strokes, kind),
        _length_finding(content, strokes, kind),
        _size_finding(content, strokes, kind),
    ]


def _unit_finding(content: FileContent, version: str) -> Finding:
    if version == "R12" and content.unit is None:
        return Finding("verify.no_unit_in_r12", {}, ok=True, warning=True)
    if content.unit is None:
        return Finding.judged(False, "verify.no_unit")
    if content.unit != MILLIMETRES:
        return Finding.judged(False, "verify.other_unit", unit=content.unit)
    return Finding.judged(True, "verify.unit_is_mm")


def _count_finding(content: FileContent, strokes: Sequence[Stroke]) -> Finding:
    closed, planned = (sum(stroke.closed for stroke in lines) for lines in (content.strokes, strokes))
    counts = {
        "open_lines": len(content.strokes) - closed,
        "closed_lines": closed,
        "planned_open": len(strokes) - planned,
        "planned_closed": planned,
    }
    if content.others:
        return Finding.judged(
            False, "verify.other_things", others=len(content.others), kind=content.others[0], **counts
        )
    right = [stroke.closed for stroke in content.strokes] == [stroke.closed for stroke in strokes]
    return Finding.judged(right, "verify.line_counts", **counts)


def _layer_finding(content: FileContent, strokes: Sequence[Stroke]) -> Finding:
    meant = layer_colours(strokes)
    listed = {name: colour for name, colour in content.layers.items() if name in meant}
    used = [(stroke.layer, stroke.colour) for stroke in content.strokes]
    found, planned = _layer_list(used), _layer_list(meant.items())
    if listed == meant and used == [(stroke.layer, stroke.colour) for stroke in strokes]:
        return Finding.judged(True, "verify.layers_as_planned", layers=found)
    if not used:
        return Finding.judged(False, "verify.no_layers", planned=planned)
    return Finding.judged(False, "verify.layers_differ", layers=found, planned=planned)


def _layer_list(layers: Iterable[tuple[str, int]]) -> str:
    """Names with their colours, each once."""
    return ", ".join(f"{name} ({colour})" for name, colour in dict.fromkeys(layers))


def _point_finding(content: FileContent, strokes: Sequence[Stroke], kind: Format) -> Finding:
    shift = largest_shift(content.strokes, strokes)
    if shift == float("inf"):
        return Finding.judged(False, "verify.point_count")
    if shift > kind.shift_mm or bent_otherwise(content.strokes, strokes, kind.bulge):
        return Finding.judged(False, "verify.points_moved", shift_mm=shift)
    return Finding.judged(True, "verify.points_as_planned", points=sum(len(stroke.points) for stroke in strokes))


def _length_finding(content: FileContent, strokes: Sequence[Stroke], kind: Format) -> Finding:
    points, planned = sum(len(stroke.points) for stroke in strokes), total_length(strokes)
    right = abs(content.length - planned) <= kind.shift_mm * max(points, 1)
    # Rounded as they are shown, so that readers that agree in print agree.
    return Finding.judged(right, "verify.length", length_mm=round(content.length, 3), planned_mm=round(planned, 3))


def _size_finding(content: FileContent, strokes: Sequence[Stroke], kind: Format) -> Finding:
    width, height = extent(strokes)
    if content.extent is None:
        return Finding.judged(False, "verify.no_size")
    right = max(abs(content.extent[0] - width), abs(content.extent[1] - height)) <= kind.shift_mm
    return Finding.judged(
        right,
        "verify.size",
        width_mm=round(content.extent[0], 3),
        height_mm=round(content.extent[1], 3),
        planned_width_mm=round(width, 3),
        planned_height_mm=round(height, 3),
    )


@dataclass(frozen=True, slots=True)
class Physics:
    """The sheet after cutting."""

    pieces: int
    min_ligament_mm: float | None  #: None when there is nothing to measure
    overlap_mm: float


def file_physics(strokes: Sequence[Stroke], plan: CutPlan, profile: Profile) -> Physics:
    """Cut the sheet along the strokes of a file.

    Parameters
    ----------
    strokes : sequence of Stroke
        As read, in file order.
    plan : CutPlan
        Its kerf, and which of the strokes are the outline (by number, for the names are the profile's).
    profile : Profile
    """
    outlines, holes = _rims(plan, profile)
    traced = [stroke.travelled(MEASURED_CHORD_MM) for stroke in strokes]
    lines = [LineString(points) for points in traced]
    inner, rim = lines[: -outlines - holes], traced[-outlines:]
    openings = [points for points in traced[-outlines - holes : -outlines] if len(points) > 3]
    ring = rim[0] if outlines == 1 else joined_ring(rim)
    if len(ring) < LEAST_RING:  # another line is where the outline should be
        return Physics(0, None, max(overlap_length(lines), 0.0))
    outline = Polygon(ring)
    drawn = Polygon(outline.exterior, openings)
    boundary = drawn if drawn.is_valid else outline  # a file that lost a hole has other cuts in its place
    kerf = 0.0 if profile.slots else plan.kerf_mm
    loops = [Polygon(line) for line, stroke in zip(inner, strokes, strict=False) if stroke.closed]
    sheet: BaseGeometry = boundary.difference(shapely.union_all(loops))
    pieces = remaining_pieces(sheet, inner, kerf)
    ligament = smallest_ligament(inner, boundary.boundary, kerf, _meant(inner, plan)) if inner else None
    return Physics(len(pieces), None if ligament is None else ligament.width_mm, max(overlap_length(lines), 0.0))


def _rims(plan: CutPlan, profile: Profile) -> tuple[int, int]:
    """Numbers of strokes at the end of a file: of the outline, and of the holes before it.

    Slots run into the holes: of a file with slots they are slots like the others.
    """
    return (1, 0) if profile.slots else (len(plan.on_layer(Layer.OUTLINE)), len(plan.on_layer(Layer.HOLES)))


def _copies_read(strokes: Sequence[Stroke], plan: CutPlan) -> list[list[Stroke]]:
    """The strokes of a file by the copy of the sheet that they belong to; of one that holds a single sheet, all."""
    numbers = copy_numbers([stroke.layer for stroke in strokes], len(plan.copies))
    return [[strokes[at] for at in np.flatnonzero(numbers == copy).tolist()] for copy in range(len(plan.copies))]


def _copies_findings(
    sheets: Sequence[Sequence[Stroke]], physics: Physics, plan: CutPlan, kind: Format
) -> list[Finding]:
    """Whether all copies are the sheet that was judged, and lie apart: then each of them stays in as many pieces."""
    if len(sheets) == 1:
        return []
    clouds = [np.concatenate([stroke.points for stroke in sheet] or [np.zeros((1, 2))]) for sheet in sheets]
    # Slots and overcuts reach beyond cut lines by less than a kerf.
    least = plan.copies.gap_mm - plan.kerf_mm
    right = alike(clouds, least, 2.0 * max(kind.shift_mm, SAME_MM))
    found = {"count": len(sheets), "gap_mm": plan.copies.gap_mm, "pieces": physics.pieces * len(sheets)}
    return [Finding.judged(right, "verify.copies" if right else "verify.copies_differ", **found)]


def _meant(lines: Sequence[LineString], plan: CutPlan) -> set[Pair]:
    """Which of the file's cuts meet on purpose, by number; none where the file's cuts are not those of the plan."""
    paths = plan.inner
    return joined_pairs(plan, paths, lines) if len(paths) == len(lines) else set()


def _physics_findings(physics: Physics, plan: CutPlan) -> list[Finding]:
    once = physics.overlap_mm <= OVERLAP_TOLERANCE_MM
    found = [
        Finding.judged(True, "verify.cut_once")
        if once
        else Finding.judged(False, "verify.cut_twice", length_mm=physics.overlap_mm),
        Finding.judged(physics.pieces == 1, "verify.pieces", count=physics.pieces, kerf_mm=plan.kerf_mm),
    ]
    ligament = physics.min_ligament_mm
    if ligament is not None:
        planned = plan.min_connector_mm
        widths = {"ligament_mm": ligament, "planned_mm": planned}
        narrow = ligament < planned - WIDTH_TOLERANCE_MM
        found.append(Finding("verify.smallest_ligament", widths, ok=ligament > 0.0, warning=narrow))
    return found


def file_voids(strokes: Sequence[Stroke], plan: CutPlan, profile: Profile) -> FoundVoids:
    """Find connectors and voids in the strokes of a file; see :func:`file_physics`."""
    outlines, holes = _rims(plan, profile)
    return read_voids(strokes, outlines, plan.kerf_mm, profile.slots, holes).moved(frame_origin(plan, profile))


def sheet_findings(strokes: Sequence[Stroke], plan: CutPlan, profile: Profile) -> list[Finding]:
    """Pieces, widths and voids that the strokes of one sheet, as read, leave."""
    physics, voids = file_physics(strokes, plan, profile), file_voids(strokes, plan, profile)
    return [*_physics_findings(physics, plan), *void_findings(voids, plan)]


def void_findings(voids: FoundVoids, plan: CutPlan) -> list[Finding]:
    """Whether the sheet can close, by the connectors that were read from its file.

    Of a plan whose connectors are all centred, every one has to be found, as wide as planned, and every void has to
    be a parallelogram within ``VOID_MISS_UM``.  As wide as planned is as wide as asked for, but for the connectors that
    the plan lists as narrowed.  Of other plans, the user should know by how much voids miss that.
    """
    voids = _without_corners(voids, plan)
    found = {"connectors": len(voids.connectors), "voids": voids.voids, "miss_um": voids.miss_um}
    centred = plan.void_miss_mm is not None and 1e3 * plan.void_miss_mm < VOID_MISS_UM
    if centred:
        narrowest, planned = voids.narrowest_mm, int(np.sum(~plan.hinges.removed))
        if len(voids.connectors) != planned or narrowest < plan.min_connector_mm - 2.0 * WIDTH_TOLERANCE_MM:
            widths = {"narrowest_mm": narrowest, "planned": planned, "planned_mm": plan.min_connector_mm}
            return [Finding.judged(False, "verify.connectors_lost", connectors=len(voids.connectors), **widths)]
        if narrow := _too_narrow(voids, plan):
            return narrow
        if voids.miss_um <= VOID_MISS_UM:
            return [Finding.judged(True, "verify.voids_close", narrowest_mm=narrowest, **found)]
    if voids.where is None:
        return []
    x, y = voids.where
    return [Finding("verify.voids_miss", {**found, "x": x, "y": y}, ok=not centred, warning=not centred)]


def _places(plan: CutPlan) -> FloatArray:
    """Where the connectors of a plan turn: (T, 2), mm."""
    places = plan.hinges.position if plan.centres is None else plan.centres
    return np.asarray(places[~plan.hinges.removed])


def _without_corners(voids: FoundVoids, plan: CutPlan) -> FoundVoids:
    """The connectors less corners of holes: cut as slots, these are as round as ends of slits.

    Only as many are left out as there are more than planned, and only on the rims of holes.
    """
    places = _places(plan)
    rims = shapely.MultiLineString(list(plan.boundary.interiors))
    if rims.is_empty or not 0 < len(places) < len(voids.connectors):
        return voids
    centres = np.array([connector.centre for connector in voids.connectors])
    planned = linear_sum_assignment(cdist(places, centres))[1]
    others = np.setdiff1d(np.arange(len(centres)), planned)
    on_rim = shapely.dwithin(shapely.points(centres[others]), rims, plan.kerf_mm + plan.connector_mm)
    corners = set(others[on_rim].tolist())
    return replace(voids, connectors=tuple(one for at, one in enumerate(voids.connectors) if at not in corners))


def _too_narrow(voids: FoundVoids, plan: CutPlan) -> list[Finding]:
    """Connectors of the file that are narrower than asked for, or, of those listed as narrowed, than listed."""
    hinges = plan.hinges
    there = np.flatnonzero(~hinges.removed)
    matched = matched_connectors(voids, _places(plan))
    if matched is None:
        return []
    least = hinges.asked_mm.copy()
    least[hinges.narrowed] = hinges.requested_mm[hinges.narrowed]
    width = np.array([connector.width_mm for connector in voids.connectors])[matched]
    missing = least[there] - width
    short = missing > 2.0 * WIDTH_TOLERANCE_MM
    if not np.any(short):
        return []
    worst = int(np.argmax(missing))
    x, y = hinges.position[there[worst]]
    widths = {"width_mm": float(width[worst]), "planned_mm": float(least[there[worst]])}
    return [Finding.judged(False, "verify.connectors_narrower", count=int(short.sum()), x=x, y=y, **widths)]


def _cautions(plan: CutPlan, profile: Profile, version: str, strokes: Sequence[Stroke], path: Path) -> list[Note]:
    """Notes on this profile and version."""
    found = [profile.note] if profile.note is not None else []
    if plan.engraving is not None and profile.name_colour is None:
        name = plan.engraving.text
        found.append(Note.of("profile.name_left_out", name=name) if name else Note.of("profile.marks_left_out"))
    if version == "R12" and path.suffix.lower() != ".svg":
        found.append(Note.of("verify.no_unit_in_r12"))
    if profile.slots:
        if plan.options.tabs:
            found.append(Note.of("verify.tabs_left_out", count=plan.options.tabs))
        length, open_mm = sum(stroke.length for stroke in strokes), len(plan.copies) * plan.cut_length_mm
        found.append(Note.of("verify.slots_longer", length_mm=length, open_mm=open_mm, times=length / open_mm))
        found.append(Note.of("verify.slots_width", kerf_mm=plan.kerf_mm))
    return found
