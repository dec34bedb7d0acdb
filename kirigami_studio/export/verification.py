"""Verification of a written cut file: two independent readers against the plan, and the sheet that would be left."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.export.dxf_reading import read_with_ezdxf
from kirigami_studio.export.file_content import MILLIMETRES, FileContent, bent_otherwise, largest_shift, one_drawing
from kirigami_studio.export.group_codes import read_group_codes
from kirigami_studio.export.layer_files import by_layer, layer_folder, layer_paths
from kirigami_studio.export.profile import Profile, find_profile
from kirigami_studio.export.strokes import Stroke, extent, layer_colours, strokes_of
from kirigami_studio.export.svg_reading import read_with_svgelements, read_with_xml
from kirigami_studio.fabricate.checks import OVERLAP_TOLERANCE_MM, WIDTH_TOLERANCE_MM
from kirigami_studio.fabricate.cut_path import MEASURED_CHORD_MM
from kirigami_studio.fabricate.cut_plan import CutPlan, Layer
from kirigami_studio.fabricate.finished_sheet import overlap_length, remaining_pieces, smallest_ligament
from kirigami_studio.fabricate.joints import Pair, joined_pairs
from kirigami_studio.fabricate.tabs import joined_ring
from kirigami_studio.foundation.errors import ExportError

Reader = Callable[[Path], FileContent]
#: Stands in a sentence for the name of who read the file.
READER = "{reader}"


@dataclass(frozen=True, slots=True)
class Finding:
    """One line of the report.

    Attributes
    ----------
    text : str
        One sentence with its numbers.
    ok : bool
    warning : bool
        Fine, but a person should know.
    """

    text: str
    ok: bool
    warning: bool = False


@dataclass(frozen=True, slots=True)
class Verification:
    """What two readers found in a written cut file.

    Attributes
    ----------
    path : Path
    ok : bool
        No finding is bad.
    size_mm : (width, height)
        Everything that is drawn.
    pieces : int or None
        Pieces of the sheet after cutting; must be 1; None where the file does not tell.
    cut_length_mm : float
        As the file says.
    seconds_low, seconds_high : float
        Estimated time of the job.
    findings : tuple of Finding
    warnings : tuple of str
        What a person should read before cutting.
    """

    path: Path
    ok: bool
    size_mm: tuple[float, float]
    pieces: int | None
    cut_length_mm: float
    seconds_low: float
    seconds_high: float
    findings: tuple[Finding, ...]
    warnings: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Format:
    """How one kind of file is read twice.

    Attributes
    ----------
    readers : pair of functions
    shift_mm : float
        Points may differ by this from the plan.
    bulge : float
        Bulges may differ by this.
    """

    readers: tuple[Reader, Reader]
    shift_mm: float
    bulge: float


#: SVG has four decimals, and arcs by their radius.
FORMATS = {
    ".dxf": Format((read_with_ezdxf, read_group_codes), 1e-9, 1e-9),
    ".svg": Format((read_with_svgelements, read_with_xml), 1e-4, 5e-3),
}


def verify_export(plan: CutPlan, path: str | Path, profile_key: str, version: str = "R2010") -> Verification:
    """Read a written file with two readers and compare it with the plan that it was written from.

    Parameters
    ----------
    plan : CutPlan
    path : str or Path
        A cut file; of a profile with one file per layer, its folder or the name that the folder was made for.
    profile_key : str
    version : str
        DXF dialect that it was written in.

    Raises
    ------
    ExportError
        Unknown profile, a kind of file that cannot be verified, or a file that does not read.
    """
    goal, profile = Path(path), find_profile(profile_key)
    strokes = strokes_of(plan, profile)
    if profile.file_per_layer and goal.suffix.lower() != ".svg":
        goal, kind = layer_folder(goal), FORMATS[".dxf"]
        parts = layer_paths(goal)
        strokes = tuple(stroke for part in by_layer(strokes).values() for stroke in part)
        contents = [one_drawing([read(part) for part in parts]) for read in kind.readers]
        return _judged(plan, goal, profile, version, strokes, contents, kind)
    if goal.suffix.lower() not in FORMATS:
        raise ExportError(f"{goal} cannot be verified; cut files end in {', '.join(FORMATS)}.")
    kind = FORMATS[goal.suffix.lower()]
    contents = [read(goal) for read in kind.readers]
    return _judged(plan, goal, profile, version, strokes, contents, kind)


def _judged(
    plan: CutPlan,
    path: Path,
    profile: Profile,
    version: str,
    strokes: Sequence[Stroke],
    contents: Sequence[FileContent],
    kind: Format,
) -> Verification:
    physics = file_physics(contents[-1].strokes, plan, profile)
    findings = [
        *_agreed(contents, strokes, version, kind),
        *_physics_findings(physics, plan),
    ]
    warnings = [*plan.notes, *_cautions(plan, profile, version, strokes, path)]
    return Verification(
        path=path,
        ok=all(finding.ok for finding in findings),
        size_mm=extent(contents[-1].strokes),
        pieces=physics.pieces,
        cut_length_mm=contents[-1].length,
        seconds_low=plan.times.low,
        seconds_high=plan.times.high,
        findings=tuple(findings),
        warnings=tuple(warnings),
    )


def _agreed(contents: Sequence[FileContent], strokes: Sequence[Stroke], version: str, kind: Format) -> list[Finding]:
    """Each finding once where all readers agree to the letter, else once for each reader by its name."""
    told = zip(*(_reader_findings(content, strokes, version, kind) for content in contents), strict=True)
    found: list[Finding] = []
    for same in told:
        if len(set(same)) == 1:
            found.append(replace(same[0], text=same[0].text.replace(READER, "both readers")))
        else:
            found += [
                replace(finding, text=finding.text.replace(READER, content.reader))
                for finding, content in zip(same, contents, strict=True)
            ]
    return found


def _reader_findings(content: FileContent, strokes: Sequence[Stroke], version: str, kind: Format) -> list[Finding]:
    """Everything that one reader can compare; the sentences have a place for its name."""
    found = [_unit_finding(content, version), _count_finding(content, strokes), _layer_finding(content, strokes)]
    shift = largest_shift(content.strokes, strokes)
    total = sum(len(stroke.points) for stroke in strokes)
    same = shift <= kind.shift_mm and not bent_otherwise(content.strokes, strokes, kind.bulge)
    told = f"the farthest is {shift:.2g} mm off" if shift < float("inf") else "their numbers differ"
    found.append(
        Finding(f"All {total} points are where they were planned for {{reader}}, with the same arcs.", True)
        if same
        else Finding(f"Points or arcs are not where they were planned for {{reader}}: {told}.", False)
    )
    meant = sum(stroke.length for stroke in strokes)
    agree = abs(content.length - meant) <= kind.shift_mm * max(total, 1)
    found.append(
        Finding(f"The cut length is {content.length:.3f} mm for {{reader}}, planned are {meant:.3f} mm.", agree)
    )
    found.append(_size_finding(content, strokes, kind))
    return found


def _unit_finding(content: FileContent, version: str) -> Finding:
    if version == "R12" and content.unit is None:
        return Finding("There is no unit in the file for {reader}: import it as mm.", True, warning=True)
    text = f"The file's unit is {'mm' if content.unit == MILLIMETRES else content.unit} for {{reader}}."
    return Finding(text, content.unit == MILLIMETRES)


def _count_finding(content: FileContent, strokes: Sequence[Stroke]) -> Finding:
    closed = sum(stroke.closed for stroke in content.strokes)
    open_ = len(content.strokes) - closed
    right = [stroke.closed for stroke in content.strokes] == [stroke.closed for stroke in strokes]
    text = f"The file holds {open_} open and {closed} closed lines"
    if content.others:
        text += f" and {len(content.others)} other things ({content.others[0]})"
    planned = sum(stroke.closed for stroke in strokes)
    text += f" for {{reader}}, planned are {len(strokes) - planned} and {planned}."
    return Finding(text, right and not content.others)


def _layer_finding(content: FileContent, strokes: Sequence[Stroke]) -> Finding:
    meant = layer_colours(strokes)
    listed = {name: colour for name, colour in content.layers.items() if name in meant}
    right = listed == meant and [(stroke.layer, stroke.colour) for stroke in content.strokes] == [
        (stroke.layer, stroke.colour) for stroke in strokes
    ]
    used = dict.fromkeys((stroke.layer, stroke.colour) for stroke in content.strokes)
    shown = ", ".join(f"{name} in colour {colour}" for name, colour in used)
    text = f"The layers are {shown or 'none'} for {{reader}}"
    if right:
        return Finding(f"{text}, in that order.", True)
    wanted = ", ".join(f"{name} in colour {colour}" for name, colour in meant.items())
    return Finding(f"{text}; planned are {wanted}.", False)


def _size_finding(content: FileContent, strokes: Sequence[Stroke], kind: Format) -> Finding:
    width, height = extent(strokes)
    if content.extent is None:
        return Finding("The file's size is missing in its header for {reader}.", False)
    right = max(abs(content.extent[0] - width), abs(content.extent[1] - height)) <= kind.shift_mm
    text = f"The file's size is {content.extent[0]:.3f} x {content.extent[1]:.3f} mm for {{reader}}"
    return Finding(f"{text}, planned are {width:.3f} x {height:.3f} mm.", right)


@dataclass(frozen=True, slots=True)
class Physics:
    """The sheet after cutting.

    Attributes
    ----------
    pieces : int
    min_ligament_mm : float or None
        None when there is nothing to measure.
    overlap_mm : float
    """

    pieces: int
    min_ligament_mm: float | None
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
    outlines = 1 if profile.slots else len(plan.on_layer(Layer.OUTLINE))
    drawn = [stroke.drawn(MEASURED_CHORD_MM) for stroke in strokes]
    lines = [LineString(points) for points in drawn]
    inner, rim = lines[:-outlines], drawn[-outlines:]
    boundary = Polygon(rim[0] if outlines == 1 else joined_ring(rim))
    kerf = 0.0 if profile.slots else plan.kerf_mm
    loops = [Polygon(line) for line, stroke in zip(inner, strokes, strict=False) if stroke.closed]
    sheet: BaseGeometry = boundary.difference(shapely.union_all(loops))
    pieces = remaining_pieces(sheet, inner, kerf)
    ligament = smallest_ligament(inner, boundary.exterior, kerf, _meant(inner, plan)) if inner else None
    return Physics(len(pieces), None if ligament is None else ligament.width_mm, max(overlap_length(lines), 0.0))


def _meant(lines: Sequence[LineString], plan: CutPlan) -> set[Pair]:
    """Which of the file's cuts meet on purpose, by number; none where the file's cuts are not those of the plan."""
    paths = [path for path in plan.paths if path.layer is not Layer.OUTLINE]
    return joined_pairs(plan, paths, lines) if len(paths) == len(lines) else set()


def _physics_findings(physics: Physics, plan: CutPlan) -> list[Finding]:
    once = physics.overlap_mm <= OVERLAP_TOLERANCE_MM
    found = [Finding("Nothing is cut twice." if once else f"{physics.overlap_mm:.4f} mm would be cut twice.", once)]
    if physics.pieces is not None:
        word = "piece" if physics.pieces == 1 else "pieces"
        text = f"After cutting, the sheet is {physics.pieces} {word} with a kerf of {plan.kerf_mm:g} mm."
        found.append(Finding(text, physics.pieces == 1))
    ligament = physics.min_ligament_mm
    if ligament is not None:
        asked = plan.min_connector_mm
        narrow = ligament < asked - WIDTH_TOLERANCE_MM
        text = f"The smallest ligament is {ligament:.3f} mm; the smallest connector is planned with {asked:.3f} mm."
        found.append(Finding(text, ligament > 0.0, warning=narrow))
    return found


def _cautions(plan: CutPlan, profile: Profile, version: str, strokes: Sequence[Stroke], path: Path) -> list[str]:
    """What a person should know about this profile and version."""
    found = [profile.note] if profile.note else []
    if version == "R12" and path.suffix.lower() != ".svg":
        found.append("There is no unit in an R12 file: import it as mm.")
    if profile.slots:
        if plan.options.tabs:
            found.append(f"Contours for a service have no gaps: the {plan.options.tabs} tabs are left out.")
        length = sum(stroke.length for stroke in strokes)
        found.append(
            f"As slots the cut is {length:.1f} mm long instead of {plan.cut_length_mm:.1f} mm "
            f"({length / plan.cut_length_mm:.2f} times), and so is what a service charges."
        )
        found.append(
            f"The slots are {plan.kerf_mm:g} mm wide, the kerf of the plan; if the service asks for wider ones, plan "
            f"the cuts with that kerf."
        )
    return found
