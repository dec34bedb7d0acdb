"""A design of several pieces -> a folder.

It has a cut file for each bed, pieces and their motion, the parts list and the assembly sheet.  The folder appears
whole or not at all.  Every cut file is read back by two readers, and the pieces that were found in the files of a kind
are put together again by the motion that the folder tells (``pieces_read``).
"""

from __future__ import annotations

import csv
import io
import json
import math
import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from shapely.geometry import Polygon

from kirigami_studio import __version__
from kirigami_studio.assembly.driving import DriveParts
from kirigami_studio.assembly.holding import HoldPlace
from kirigami_studio.assembly.pieces import Assembly, Piece, RoundHole
from kirigami_studio.export.assembly_pdf import AssemblySheet, write_assembly_pdf
from kirigami_studio.export.backed_files import HINGE_LAYER, Glued
from kirigami_studio.export.cut_bed import BOARD, LAYERS, CutBed, board_bed, laid_on_beds
from kirigami_studio.export.drive_files import drive_lines
from kirigami_studio.export.dxf import check_written, strokes_dxf
from kirigami_studio.export.file_content import FileContent
from kirigami_studio.export.hold_files import SIDE_BY_SIDE_STEPS, hold_findings, hold_lines, holds_json
from kirigami_studio.export.layer_files import by_layer, fill_layer_folder, laid_together, layer_paths, whole_folder
from kirigami_studio.export.lightburn import strokes_lightburn, write_project
from kirigami_studio.export.lightburn_reading import read_project, scan_project
from kirigami_studio.export.paper import Paper
from kirigami_studio.export.pieces_read import FoundPiece, KnownOutlines, found_pieces, motion_findings
from kirigami_studio.export.profile import (
    ARTWORK_LAYER,
    DEFAULT_PROFILE,
    ENGRAVED_LAYERS,
    NAME_LAYER,
    DxfVersion,
    Profile,
    find_profile,
)
from kirigami_studio.export.provenance import PROGRAM, VERDICT, exactly, origin_facts
from kirigami_studio.export.strokes import Stroke, Work, cutting_work, extent
from kirigami_studio.export.svg import strokes_svg, write_svg
from kirigami_studio.export.verification import (
    FORMATS,
    Finding,
    Format,
    Verification,
    agreed,
    reader_findings,
    sheet_findings,
)
from kirigami_studio.fabricate.cut_plan import Layer, design_hash
from kirigami_studio.fabricate.fastener import SIZES, Fastener
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.fabricate.hold import HoldOptions
from kirigami_studio.fabricate.machine import Machine
from kirigami_studio.fabricate.material import Construction, Material
from kirigami_studio.fabricate.options import BoardCut, CutOrder
from kirigami_studio.foundation.arrays import FloatArray, ShapeRings
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.foundation.frozen_mapping import FrozenMapping
from kirigami_studio.foundation.processes import Beside, by_itself
from kirigami_studio.foundation.words import mark, tr, tr_n

#: Angles of the motion from flat to the target.
ANGLES = 181
#: Decimals of lengths (mm) and turns (radians) in ``pieces.json``.
LENGTH_DECIMALS, TURN_DECIMALS = 6, 9
#: Chords of a round hole there miss it by this (mm).
RING_CHORD_MM = 5e-4
#: Kinds of cut files that are written.
KINDS = (".dxf", ".svg", ".lbrn2")
#: Kinds of files with the solids of a drive, and distance of its beds in them (mm).
SOLIDS, APART_MM = (".3mf", ".stl"), 10.0
PIECES, PARTS, SHEET = "pieces.json", "parts.csv", "assembly.pdf"
OWN_NAME = re.compile(
    r"(layer-[1-9]\d*|board)(-b[1-9]\d*)?(\.dxf|\.svg|\.lbrn2|\.stl|\.3mf)?|pieces\.json|parts\.csv|assembly\.pdf"
)
#: LightBurn projects have its own colours, and four decimals.
PROJECT_PROFILE, PROJECT = "lightburn", Format((read_project, scan_project), 1e-4, 1e-6)


@dataclass(frozen=True, eq=False)
class AssemblyJob:
    """All that the files of an assembly need.

    Attributes
    ----------
    assembly : Assembly
    material : Material
    machine : Machine
    fastener : Fastener
    kerf_mm : float
    hole_mm, ear_mm, clearance_mm : float
        Diameters of holes and ears; room between pieces that pass each other.
    construction : Construction
    name : str
        Of the design.
    profile : str
        Key of the machine profile.
    dxf_version : DxfVersion
    paper : Paper
        Of the assembly sheet.
    order : CutOrder
    margin_mm : float
        Of each bed that stays free all round.
    target : (L, 2) float or None, mm
        Target outline, in the frame of the assembly at its target angle.
    provenance : mapping of str to str
        Where the design comes from.
    record : bytes
        The design as a packed project, which the first DXF and SVG carry; empty for none.
    verdict : str
        Level of the verdict on the design; "" where nobody has judged it.
    hold : HoldOptions
        Parts that hold it in its end states.
    holds : tuple of HoldPlace
        Where they are.
    drive : DriveParts or None
        Board and arms that move it.
    width_mm : float
        Of the flat sheet; 0 where that is not known.
    glued : Glued or None
        The hinge layer that the pieces are glued on, in the place of pins.
    grips : (str, str) or None
        Ids of the pieces to hold and to pull, so that the flat sheet opens.
    """

    assembly: Assembly
    material: Material
    machine: Machine
    fastener: Fastener
    kerf_mm: float
    hole_mm: float
    ear_mm: float
    clearance_mm: float
    construction: Construction = Construction.PINNED
    name: str = ""
    profile: str = DEFAULT_PROFILE
    dxf_version: DxfVersion = DxfVersion.R2010
    paper: Paper = Paper.NONE
    order: CutOrder = CutOrder.SHORTEST
    margin_mm: float = 0.0
    target: ShapeRings = None
    provenance: Mapping[str, str] = field(default_factory=FrozenMapping)
    record: bytes = b""
    verdict: str = ""
    hold: HoldOptions = field(default_factory=HoldOptions)
    holds: tuple[HoldPlace, ...] = ()
    drive: DriveParts | None = None
    width_mm: float = 0.0
    glued: Glued | None = None
    grips: tuple[str, str] | None = None

    @property
    def whole(self) -> Assembly:
        """The assembly with the parts of its drive."""
        return self.assembly if self.drive is None else self.drive.assembly

    @cached_property
    def beds(self) -> tuple[CutBed, ...]:
        """Pieces on the beds of the machine.

        Raises
        ------
        FabricationError
            A hole or an opening that is narrower than the kerf.
        """
        if (glued := self.glued) is not None:
            return (board_bed(glued.board, self.allowed_mm, glued.cut is BoardCut.KISS, self.order),)
        return laid_on_beds(self.whole.pieces, self.allowed_mm, self.machine.reach_mm, self.margin_mm, self.order)

    @property
    def allowed_mm(self) -> float:
        """The kerf that the files allow for; cutting services allow for it themselves."""
        return 0.0 if find_profile(self.profile).slots else self.kerf_mm

    @property
    def notes(self) -> tuple[Note, ...]:
        """Notes on its beds, to read before cutting."""
        room = self.machine.reach_mm
        layers = Counter(bed.layer for bed in self.beds)
        several = [
            Note.of("pieces.several_beds", layer=layer, count=count, width_mm=room[0], height_mm=room[1])
            for layer, count in layers.items()
            if count > 1
        ]
        kiss = self.glued is not None and self.glued.cut is BoardCut.KISS
        kissed = [Note.of("backed.kiss_cut", layer=find_profile(self.profile).layer_name(Layer.KISS))] if kiss else []
        return (*several, *kissed)

    @cached_property
    def works(self) -> tuple[Work, ...]:
        """Length and time of the cuts of each bed."""
        cuts = [
            [stroke for stroke in bed.strokes(find_profile(self.profile)) if stroke.layer not in ENGRAVED_LAYERS]
            for bed in self.beds
        ]
        return tuple(cutting_work(strokes, self.material, self.machine) for strokes in cuts)

    @cached_property
    def hinge_work(self) -> Work | None:
        """The same of the hinge layer under tiles."""
        return None if self.glued is None else self.glued.work(find_profile(self.profile))

    @property
    def all_works(self) -> tuple[Work, ...]:
        """Of all files."""
        return self.works if self.hinge_work is None else (self.hinge_work, *self.works)

    @property
    def fastener_length_mm(self) -> float:
        """Least length of a pin: both layers, and what it needs beyond them."""
        return 2.0 * self.material.thickness_mm + SIZES[self.fastener].beyond_mm


@dataclass(frozen=True, slots=True)
class AssemblyFiles:
    """The written files.

    Attributes
    ----------
    files : tuple of Path
        Cut files, pieces, parts list and assembly sheet; a folder stands for the files of a bed's layers.
    verifications : tuple of Verification
        One for each cut file, and one for the pieces put together.
    """

    files: tuple[Path, ...]
    verifications: tuple[Verification, ...]


def write_assembly(
    job: AssemblyJob,
    folder: str | Path,
    kinds: Sequence[str] = KINDS,
    judged: Callable[[Sequence[Verification]], str] | None = None,
    beside: Beside = by_itself,
) -> AssemblyFiles:
    """Write the whole folder.

    Parameters
    ----------
    job : AssemblyJob
    folder : str or Path
        Files of an earlier assembly in it are replaced; all else stays.
    kinds : sequence of str
        Extensions of the cut files; projects are left out where the profile wants closed contours for a service.
    judged : function, optional
        Gets what was read back and returns the level of the verdict, which the files repeat.
    beside : Beside
        Those who write some of the files meanwhile.

    Raises
    ------
    ExportError
        A place that cannot be written, or a file that is not what was meant; nothing is written then.
    FabricationError
        As :attr:`AssemblyJob.beds`.
    """
    home = Path(folder)
    _ = job.beds  # refused before a folder is made
    wanted = [kind for kind in kinds if kind != ".lbrn2" or not find_profile(job.profile).slots]
    with whole_folder(home, OWN_NAME) as fresh:
        while True:
            verified = _filled(job, fresh, home, wanted, beside)
            level = job.verdict if judged is None else judged(verified)
            if level == job.verdict:
                break
            # What is judged does not depend on what the files say of it.
            job, judged = replace(job, verdict=level), None
        names = sorted(entry.name for entry in fresh.iterdir())
    return AssemblyFiles(tuple(home / name for name in names), tuple(verified))


def _filled(job: AssemblyJob, fresh: Path, home: Path, kinds: Sequence[str], beside: Beside) -> list[Verification]:
    """Write all files into a new folder and read them back; those after the first kind ``beside`` this process."""
    place = fresh.absolute()  # others may have another working folder
    files = [_cut_files(job, kind) for kind in kinds]
    works: list[list[Callable[[], Any]]] = [[partial(one.written, place) for one in of_kind] for of_kind in files]
    first, later = works[:1], works[1:] or [[]]
    later[-1].append(partial(write_assembly_pdf, _assembly_sheet(job), place / SHEET, job.paper))
    verified: list[Verification] = []
    by_kind: dict[str, dict[str, FoundPiece]] = {kind: {} for kind in kinds}
    moving, known = job.whole.by_id, KnownOutlines()

    def verify(of_kind: Sequence[_CutFile], written: Sequence[_Written]) -> None:
        for one, found in zip(of_kind, written, strict=False):  # after cut files there may be the assembly sheet
            verification, pieces = one.verified(job, home, found, known)
            verified.append(verification)
            by_kind[one.kind].update({piece.id: piece for piece in pieces if piece.id in moving})

    with beside([partial(_all_done, share) for share in later]) as answers:
        record = pieces_json(job.whole, holds=job.holds)
        write_atomically(fresh / PIECES, (json.dumps(record, separators=(",", ":")) + "\n").encode())
        write_atomically(fresh / PARTS, parts_csv(job).encode())
        if job.drive is not None and set(kinds) >= set(KINDS[:2]):
            _write_solids(job, fresh)
        for of_kind, own in zip(files, first, strict=False):
            verify(of_kind, _all_done(own))
        for of_kind, written in zip(files[1:], answers(), strict=False):  # the sheet alone, with one kind
            verify(of_kind, written)
    verified.append(_motion_verified(job, record, fresh / PIECES, home / PIECES, by_kind, known))
    for one in verified:
        for finding in one.findings:
            if not finding.ok:
                raise ExportError("assembly.not_as_meant", name=one.path.name, finding=finding.text)
    return verified


def _all_done(works: Sequence[Callable[[], Any]]) -> list[Any]:
    """The results of some work, one after the other."""
    return [work() for work in works]


def _assembly_sheet(job: AssemblyJob) -> AssemblySheet:
    sheet = AssemblySheet(job.assembly, job.beds, _about(job), _part_lines(job), job.target, job.holds, job.drive)
    sheet = replace(sheet, grips=job.grips)
    if (glued := job.glued) is None:
        return sheet
    return replace(
        sheet,
        steps=glued.steps,
        legend={2: mark("tiles")},
        hold_steps=SIDE_BY_SIDE_STEPS,
        template=board_bed(glued.board, 0.0),
        under=glued.under,
    )


# cut files ------------------------------------------------------------------------------------------------------------


def bed_facts(job: AssemblyJob, bed: CutBed, strokes: Sequence[Stroke]) -> dict[str, str]:
    """The record in a bed's file of its making."""
    profile, size = find_profile(job.profile), bed.size_mm
    numbers, artwork = (sum(stroke.layer == name for stroke in strokes) for name in (NAME_LAYER, ARTWORK_LAYER))
    return {
        PROGRAM: __version__,
        "CONSTRUCTION": job.construction.value,
        "DESIGN": design_hash(job.assembly.deployment, ()),
        "SIZE_MM": f"{size[0]:.4f} x {size[1]:.4f}",
        "LAYER": f"{bed.layer}",
        "BED": f"{bed.number} of {sum(other.layer == bed.layer for other in job.beds)}",
        "PIECES": f"{len(bed.pieces)}",
        **({"WIDTH_MM": exactly(job.width_mm)} if job.width_mm else {}),
        "PIN_MM": exactly(job.hole_mm),
        "EAR_MM": exactly(job.ear_mm),
        "CLEARANCE_MM": exactly(job.clearance_mm),
        **({"FASTENER": job.fastener.value} if job.glued is None else {"HINGE_LAYER": job.glued.plan.material.key}),
        "KERF_MM": exactly(job.allowed_mm),
        "ORDER": job.order.value,
        "PROFILE": profile.key,
        "MATERIAL": job.material.key,
        **({"MACHINE": job.machine.key} if job.machine.key else {}),
        "PATHS": "edges of the finished parts: apply the kerf offset of the machine"
        if profile.slots
        else "beam centre lines, kerf already allowed for: apply no kerf offset",
        "LINES": f"{len(strokes) - numbers - artwork}",
        **({"ENGRAVED_LINES": f"{numbers}"} if numbers else {}),
        **({"ARTWORK_LINES": f"{artwork}"} if artwork else {}),
        **({VERDICT: job.verdict} if job.verdict else {}),
        **origin_facts(job.provenance),
    }


@dataclass(frozen=True, slots=True)
class _Written:
    """A file, or a folder of layers, as it was written.

    Attributes
    ----------
    name : str
    contents : list of FileContent
        As both readers have them.
    findings : list of Finding
    """

    name: str
    contents: list[FileContent]
    findings: list[Finding]


@dataclass(frozen=True, slots=True, eq=False)
class _CutFile:
    """A cut file to be written."""

    name: str  #: without extension
    kind: str
    strokes: Sequence[Stroke]
    facts: dict[str, str]
    record: bytes  #: the packed design; empty for none
    material: Material
    machine: Machine
    profile: Profile
    dxf_version: DxfVersion
    bed: CutBed | None  #: that it cuts; None for the hinge layer

    def written(self, folder: Path) -> _Written:
        """Write it, or a folder of layers, and read it twice."""
        kind, strokes, facts, profile = self.kind, self.strokes, self.facts, self.profile
        path, how = folder / f"{self.name}{kind}", PROJECT if kind == ".lbrn2" else FORMATS[kind]
        if kind == ".lbrn2":
            write_project(strokes_lightburn(strokes, self.material, self.machine, facts), strokes, path)
        elif kind == ".svg":
            title = f"Kirigami pieces, layer {facts['LAYER']}, bed {facts['BED'].partition(' ')[0]}"
            content = strokes_svg(strokes, title, facts, profile.svg_dpi, self.record)
            write_svg(content, path, len(strokes), extent(strokes))
        elif profile.file_per_layer:
            path = folder / self.name
            path.mkdir()
            fill_layer_folder(path, strokes, self.dxf_version, facts, self.record)
            strokes = tuple(stroke for part in by_layer(strokes).values() for stroke in part)
        else:
            drawing = strokes_dxf(strokes, extent(strokes), self.dxf_version, facts, record=self.record)
            write_atomically(path, drawing, lambda one: check_written(one, strokes, extent(strokes), self.dxf_version))
        contents = [_content(read, path) for read in how.readers]
        version = "R2010" if kind != ".dxf" else self.dxf_version
        findings = agreed(contents, [reader_findings(one, strokes, version, how) for one in contents])
        return _Written(path.name, contents, findings)

    def verified(
        self, job: AssemblyJob, home: Path, written: _Written, known: KnownOutlines
    ) -> tuple[Verification, list[FoundPiece]]:
        """Find its pieces, or the hinge layer, in what was written."""
        path, contents, findings = home / written.name, written.contents, written.findings
        if self.bed is not None:
            return _bed_verified(job, self.bed, path, contents, known, findings)
        assert job.glued is not None  # others have no hinge layer
        return _hinge_layer_verified(job.glued, path, contents, findings, self.profile), []


def _cut_files(job: AssemblyJob, kind: str) -> list[_CutFile]:
    """The cut files of a kind: the hinge layer, if there is one, and every bed."""
    profile, cut, glued = _profile_of(job, kind), (job.material, job.machine), job.glued
    files: list[_CutFile] = []
    if glued is not None:
        plan, own = glued.plan, _hinge_profile(job, kind)
        strokes = glued.strokes(own)
        facts = glued.facts(own, strokes) | origin_facts(job.provenance)
        facts |= {VERDICT: job.verdict} if job.verdict else {}
        sheet = plan.material, plan.machine
        files.append(_CutFile(HINGE_LAYER, kind, strokes, facts, job.record, *sheet, own, job.dxf_version, None))
    for bed in job.beds:
        strokes = bed.strokes(profile)
        facts = bed_facts(job, bed, strokes)
        record = job.record if bed is job.beds[0] and glued is None else b""
        files.append(_CutFile(bed.name, kind, strokes, facts, record, *cut, profile, job.dxf_version, bed))
    return files


def _profile_of(job: AssemblyJob, kind: str) -> Profile:
    """The profile of the files of a kind; projects have their own."""
    return find_profile(PROJECT_PROFILE if kind == ".lbrn2" else job.profile)


def _hinge_profile(job: AssemblyJob, kind: str) -> Profile:
    """That of the hinge layer: projects have arcs by other curves, which their readers do not take for arcs."""
    profile = _profile_of(job, kind)
    return replace(profile, flatten=True) if kind == ".lbrn2" else profile


def read_bed(job: AssemblyJob, bed: CutBed, path: Path, known: KnownOutlines) -> tuple[Verification, list[FoundPiece]]:
    """Find the pieces of a bed in a file of any origin, by both readers.

    Parameters
    ----------
    job : AssemblyJob
        With the kerf and the profile of the file.
    bed : CutBed
        Of that job.
    path : Path
        A file, or a folder of layer files.
    known : KnownOutlines
        Of the other files of the job.

    Raises
    ------
    ExportError
        Missing, damaged, or of another kind.
    """
    return _bed_verified(job, bed, path, [_content(read, path) for read in _format_of(path).readers], known, [])


def _format_of(path: Path) -> Format:
    """The format of a cut file, or of a folder of layer files."""
    kind = path.suffix.lower()
    how = FORMATS[".dxf"] if path.is_dir() else PROJECT if kind == ".lbrn2" else FORMATS.get(kind)
    if how is None:
        raise ExportError("verify.unknown_kind", path=path, known=", ".join(KINDS))
    return how


def _bed_verified(
    job: AssemblyJob,
    bed: CutBed,
    path: Path,
    contents: Sequence[FileContent],
    known: KnownOutlines,
    found: Sequence[Finding],
) -> tuple[Verification, list[FoundPiece]]:
    """The pieces of a bed, with what else was found in its file."""
    of_pieces = [found_pieces(content.strokes, bed, job.allowed_mm, known) for content in contents]
    findings = (*found, *agreed(contents, [one for one, _ in of_pieces]))
    work = job.works[job.beds.index(bed)]
    # A project is for LightBurn alone, whose layers have names: a profile's note is on DXF and SVG.
    note = None if path.suffix.lower() == ".lbrn2" else find_profile(job.profile).note
    verification = Verification(
        path=path,
        ok=all(finding.ok for finding in findings),
        size_mm=extent(contents[-1].strokes),
        pieces=len(of_pieces[-1][1]) or None,
        cut_length_mm=work.cut_length_mm,
        seconds_low=work.times.low,
        seconds_high=work.times.high,
        findings=findings,
        warnings=job.notes if note is None else (*job.notes, note),
    )
    return verification, of_pieces[-1][1]


def read_hinge_layer(job: AssemblyJob, glued: Glued, path: Path) -> Verification:
    """Judge the hinge layer in a file of any origin, by both readers.

    Parameters
    ----------
    job : AssemblyJob
        With the profile of the file.
    glued : Glued
    path : Path
        A file, or a folder of layer files.

    Raises
    ------
    ExportError
        Missing, damaged, or of another kind.
    """
    how, profile = _format_of(path), _hinge_profile(job, path.suffix.lower())
    contents = [_content(read, path) for read in how.readers]
    return _hinge_layer_verified(glued, path, contents, [], profile)


def _hinge_layer_verified(
    glued: Glued, path: Path, contents: Sequence[FileContent], found: Sequence[Finding], profile: Profile
) -> Verification:
    """The hinge layer in a file, with what else was found there."""
    sheets = [glued.sheet_in(content.strokes, profile) for content in contents]
    found = [*found, *agreed(contents, [sheet_findings(sheet, glued.plan, profile) for sheet in sheets])]
    work = glued.work(profile)
    return Verification(
        path=path,
        ok=all(finding.ok for finding in found),
        size_mm=extent(contents[-1].strokes),
        pieces=1,
        cut_length_mm=work.cut_length_mm,
        seconds_low=work.times.low,
        seconds_high=work.times.high,
        findings=tuple(found),
        warnings=glued.plan.notes,
    )


def _content(read: Callable[[Path], FileContent], path: Path) -> FileContent:
    return laid_together([read(part) for part in layer_paths(path)], path) if path.is_dir() else read(path)


def _write_solids(job: AssemblyJob, fresh: Path) -> None:
    """Write board, arms and handle as solids, as they lie on their beds."""
    from kirigami_studio.assembly.printed import extruded
    from kirigami_studio.assembly.solids import at_origin
    from kirigami_studio.export.meshes import write_plate  # with libraries that few need

    thick, solids, left = job.material.thickness_mm, [], 0.0
    for bed in (one for one in job.beds if one.layer > LAYERS):
        for cuts, place in bed.placed:
            piece = cuts.piece
            holes = [_ring(hole) for hole in piece.holes]
            rings = [place.put(ring) + np.array([left, 0.0]) for ring in (piece.outline, *piece.openings, *holes)]
            solids.append(extruded(piece.id, 1 + piece.layer % 2, Polygon(rings[0], rings[1:]), thick))
        left += bed.size_mm[0] + APART_MM
    for kind in SOLIDS:
        write_plate(at_origin(solids), fresh / f"{BOARD}{kind}", _about(job)["subject"])


# pieces and motion ----------------------------------------------------------------------------------------------------


def pieces_json(assembly: Assembly, angles: int = ANGLES, holds: Sequence[HoldPlace] = ()) -> dict[str, Any]:
    """Pieces, hinges, motion and places that hold the pieces, as plain lists.

    Outlines, holes (as rings) and hinge points are in the frame of their piece, in mm; a pose turns a piece about its
    origin, then moves it.
    """
    phis = np.linspace(math.pi, assembly.phi_target, angles)
    return {
        "unit": "mm",
        "pieces": [
            {
                "id": piece.id,
                "layer": piece.layer,
                "outline": _plain(piece.outline),
                "holes": [_plain(ring) for ring in (*map(_ring, piece.holes), *piece.openings)],
            }
            for piece in assembly.pieces
        ],
        "hinges": [
            {"pieces": list(hinge.pieces), "at": [_plain(np.asarray(at)) for at in hinge.at]}
            for hinge in assembly.hinges
        ],
        "motion": [
            {"phi_deg": round(math.degrees(phi), TURN_DECIMALS), "poses": _poses(assembly, phi)}
            for phi in phis.tolist()
        ],
        **({"holds": holds_json(holds, LENGTH_DECIMALS)} if holds else {}),
    }


def _plain(points: FloatArray) -> Any:
    return (points.round(LENGTH_DECIMALS) + 0.0).tolist()


def _poses(assembly: Assembly, phi: float) -> dict[str, list[float]]:
    poses = assembly.poses(phi)
    rounded = np.column_stack([poses[:, :2].round(LENGTH_DECIMALS), poses[:, 2].round(TURN_DECIMALS)]) + 0.0
    return dict(zip((piece.id for piece in assembly.pieces), rounded.tolist(), strict=True))


def _ring(hole: RoundHole) -> FloatArray:
    """A round hole as a clockwise ring (K, 2), mm, of the same area."""
    radius = 0.5 * hole.diameter_mm
    count = 4 * math.ceil(math.pi / (4.0 * math.acos(1.0 - min(1.0, RING_CHORD_MM / radius))))
    step = 2.0 * math.pi / count
    turn = -step * np.arange(count)
    reach = radius * math.sqrt(step / math.sin(step))
    return np.asarray(hole.centre) + reach * np.column_stack([np.cos(turn), np.sin(turn)])


def _motion_verified(
    job: AssemblyJob,
    meant: Mapping[str, Any],
    path: Path,
    goal: Path,
    by_kind: Mapping[str, Mapping[str, FoundPiece]],
    known: KnownOutlines,
) -> Verification:
    """Read pieces and motion back, and put the pieces of each kind of file together."""
    record = json.loads(path.read_bytes())
    right = record == meant
    findings = [Finding.judged(right, "verify.motion_as_planned" if right else "verify.motion_differs", angles=ANGLES)]
    for kind, pieces in by_kind.items():
        if not right or set(pieces) != set(job.whole.by_id):
            continue
        moved = [*motion_findings(pieces, record, known), *hold_findings(pieces, record)]
        findings += [replace(finding, reader=kind.removeprefix(".").upper()) for finding in moved]
    place = job.assembly.placing(math.pi)
    far = np.concatenate([place(piece, piece.outline) for piece in job.assembly.pieces])
    width, height = np.ptp(far, axis=0).tolist()
    return Verification(
        path=goal,
        ok=all(finding.ok for finding in findings),
        size_mm=(width, height),
        pieces=len(job.whole.pieces),
        cut_length_mm=sum(work.cut_length_mm for work in job.all_works),
        seconds_low=sum(work.times.low for work in job.all_works),
        seconds_high=sum(work.times.high for work in job.all_works),
        findings=tuple(findings),
        warnings=(),
    )


# parts list -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class PartLine:
    """A line of the parts list, whose entries are its columns; None where one does not apply.

    Attributes
    ----------
    item : str
        One of ``ITEMS``.
    layer, bed : int or None
    file : str
        Stem of the cut file.
    count : int or None
    diameter_mm, length_mm, area_mm2, cut_mm, seconds : float or None
    note : str
    material : str
        Name of a material, which the note has, too.
    """

    item: str
    layer: int | None = None
    bed: int | None = None
    file: str = ""
    count: int | None = None
    diameter_mm: float | None = None
    length_mm: float | None = None
    area_mm2: float | None = None
    cut_mm: float | None = None
    seconds: float | None = None
    note: str = ""
    material: str = ""


#: Headings of the columns, by the names of the entries.
HEADINGS = {
    "item": mark("item"),
    "layer": mark("layer"),
    "bed": mark("bed"),
    "file": mark("file"),
    "count": mark("count"),
    "diameter_mm": mark("diameter_mm"),
    "length_mm": mark("length_mm"),
    "area_mm2": mark("area_mm2"),
    "cut_mm": mark("cut_mm"),
    "seconds": mark("seconds"),
    "note": mark("note"),
}
ITEMS = {
    "pieces": mark("pieces"),
    "pins": mark("pins"),
    "material": mark("material"),
    "all cuts": mark("all cuts"),
    "magnets": mark("magnets"),
    "eyelets": mark("eyelets"),
    "stitches": mark("stitches"),
    "tabs": mark("tabs"),
    "spacers": mark("spacers"),
    "screws": mark("screws"),
    "square bar": mark("square bar"),
    "servo": mark("servo"),
    "hinge layer": mark("hinge layer"),
    "glue": mark("glue"),
}


def parts(job: AssemblyJob) -> tuple[PartLine, ...]:
    """The parts list: pieces of each bed, pins or glue, holding parts, materials, totals."""
    found = _hinge_layer_parts(job)
    for bed, work in zip(job.beds, job.works, strict=True):
        area = sum(_area(cuts.piece) for cuts in bed.pieces)
        ids = " ".join(cuts.piece.id for cuts in bed.pieces)
        found.append(
            PartLine(
                "pieces",
                bed.layer,
                bed.number,
                bed.name,
                len(bed.pieces),
                area_mm2=area,
                cut_mm=work.cut_length_mm,
                seconds=work.times.total,
                note=ids,
            )
        )
    if job.assembly.hinges:
        pins = PartLine(
            "pins",
            count=len(job.assembly.hinges),
            diameter_mm=job.hole_mm,
            length_mm=job.fastener_length_mm,
            note=tr("{pins}; holes of this diameter, pins at least this long", pins=tr(SIZES[job.fastener].name)),
        )
        found.append(pins)
    found += [
        PartLine(line.item, count=line.count, diameter_mm=line.diameter_mm, length_mm=line.length_mm, note=line.note)
        for line in (
            *hold_lines(job.holds, job.hold),
            *drive_lines(job.drive, job.material.thickness_mm, job.hole_mm, SIZES[job.fastener]),
        )
    ]
    if job.glued is not None:
        found.append(PartLine("glue", area_mm2=job.glued.glue_mm2, note=tr("area of the tiles, one side")))
    found.append(_material_part(job.material, [bed.size_mm for bed in job.beds]))
    found.append(
        PartLine(
            "all cuts",
            count=len(job.whole.pieces),
            area_mm2=sum(map(_area, job.whole.pieces)),
            cut_mm=sum(work.cut_length_mm for work in job.all_works),
            seconds=sum(work.times.total for work in job.all_works),
            note=tr("on {machine}", machine=tr(job.machine.name)),
        )
    )
    return tuple(found)


def _hinge_layer_parts(job: AssemblyJob) -> list[PartLine]:
    """The sheet that tiles are glued on, and its material."""
    if job.glued is None or job.hinge_work is None:
        return []
    plan, work = job.glued.plan, job.hinge_work
    area = float(shapely.area(Polygon(plan.outline)))
    line = PartLine("hinge layer", 1, 1, HINGE_LAYER, 1, area_mm2=area, cut_mm=work.cut_length_mm)
    return [
        replace(line, seconds=work.times.total, note=tr("on {machine}", machine=tr(plan.machine.name))),
        _material_part(plan.material, [job.glued.board.size_mm]),
    ]


def _material_part(material: Material, sizes: Sequence[tuple[float, float]]) -> PartLine:
    note = tr("{material}; area of the rectangles round what is cut", material=tr(material.name))
    area = sum(width * height for width, height in sizes)
    return PartLine("material", count=len(sizes), note=note, area_mm2=area, material=material.name)


def _area(piece: Piece) -> float:
    """Finished area of a piece, mm^2."""
    rounds = sum(0.25 * math.pi * hole.diameter_mm**2 for hole in piece.holes)
    return float(shapely.area(Polygon(piece.outline, piece.openings))) - rounds


def parts_csv(job: AssemblyJob) -> str:
    """The parts list as a table in the user's language; numbers have points."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\r\n")
    table.writerow([tr(heading) for heading in HEADINGS.values()])
    for part in parts(job):
        named = replace(part, item=tr(ITEMS.get(part.item, part.item)))
        table.writerow([_cell(getattr(named, column)) for column in HEADINGS])
    return text.getvalue()


def _cell(value: object) -> str:
    if value is None:
        return ""
    return f"{value:.1f}" if isinstance(value, float) else str(value)


def _part_lines(job: AssemblyJob) -> tuple[str, ...]:
    """The parts list in sentences for the assembly sheet."""
    lines = []
    for part in parts(job):
        cut: dict[str, object] = {"cut": part.cut_mm or 0.0, "time": _minutes(part.seconds)}
        count = part.count or 0
        if part.item == "pieces":
            one = tr_n(
                "{file}: {count} piece, cut {cut:.1f} mm, {time}",
                "{file}: {count} pieces, cut {cut:.1f} mm, {time}",
                count,
                file=part.file,
                **cut,
            )
        elif part.item == "pins":
            one = tr_n(
                "{count} pin: {name}, at least {length:.1f} mm long, holes {hole:g} mm",
                "{count} pins: {name}, at least {length:.1f} mm long, holes {hole:g} mm",
                count,
                name=tr(SIZES[job.fastener].name),
                length=part.length_mm,
                hole=part.diameter_mm,
            )
        elif part.item == "material":
            one = tr_n(
                "{material}: {area:.0f} cm2 on {count} bed",
                "{material}: {area:.0f} cm2 on {count} beds",
                count,
                material=tr(part.material),
                area=(part.area_mm2 or 0.0) / 100.0,
            )
        elif part.item == "hinge layer":
            one = f"{part.file}: {tr(part.item)}, {_cell(part.cut_mm)} mm, {_minutes(part.seconds)}"
        elif part.item == "glue":
            one = f"{tr(part.item)}: {(part.area_mm2 or 0.0) / 100.0:.0f} cm2"
        elif part.item != "all cuts":
            size = " x ".join(_cell(one) for one in (part.diameter_mm, part.length_mm) if one is not None)
            one = f"{part.count} {tr(ITEMS[part.item])}{f', {size} mm' if size else ''}, {part.note}"
        else:
            one = tr_n(
                "Together {count} piece, cut {cut:.1f} mm, {time}, {machine}",
                "Together {count} pieces, cut {cut:.1f} mm, {time}, {machine}",
                count,
                machine=part.note,
                **cut,
            )
        lines.append(one)
    return tuple(lines)


def _minutes(seconds: float | None) -> str:
    total = round(seconds or 0.0)
    return f"{total // 60} min {total % 60:02d} s"


def _about(job: AssemblyJob) -> dict[str, str]:
    """Title and facts for the assembly sheet."""
    facts = {"design": design_hash(job.assembly.deployment, ()), **job.provenance}
    return {
        "title": job.name or tr("Kirigami assembly"),
        "subject": "; ".join(f"{key} {text}" for key, text in facts.items()),
    }
