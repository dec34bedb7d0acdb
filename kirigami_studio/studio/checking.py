"""Checking a cut file: by itself, by its own record of how it was made, and by the design that it was made of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.export.bed_files import bed_project
from kirigami_studio.export.dxf_check import FileReport, check_file
from kirigami_studio.export.file_record import FileRecord, PieceRecord
from kirigami_studio.export.layer_files import layer_paths
from kirigami_studio.export.provenance import ONE_SHEET
from kirigami_studio.export.sheet_bed import BedSheet, SheetBed
from kirigami_studio.export.verification import Verification, verify_bed, verify_export
from kirigami_studio.fabricate.cut_plan import design_hash
from kirigami_studio.fabricate.fastener import Fastener
from kirigami_studio.fabricate.findings import Note, Problem
from kirigami_studio.fabricate.material import Construction, library
from kirigami_studio.fabricate.options import CutOrder
from kirigami_studio.foundation.errors import ExportError, FabricationError, KirigamiError, ProjectError, UsageError
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.project.document import Document
from kirigami_studio.project.store import load
from kirigami_studio.project.target_parts import parts_as_cut
from kirigami_studio.settings.fabrication import (
    FabricationSettings,
    named_machine,
    stored_machine,
    stored_material,
)
from kirigami_studio.studio.making import CutRequest, closed, jam_of, judged, pieces_of, planned
from kirigami_studio.studio.verdict import RANK, Level, Verdict, judge_assembled, refused

#: Settings that cut files say by the design alone that they carry.
HELD_AND_MOVED = ("held_by", "held_when", "magnet_mm", "magnet_height_mm", "moved_by")


@dataclass(frozen=True, slots=True, eq=False)
class Checked:
    """Findings on a cut file."""

    report: FileReport  #: What the file alone shows: whether it is sound
    verification: Verification | None = None  #: Beside the cuts of its design, where one was named
    verdict: Verdict | None = None  #: On the sheet of that design

    @property
    def sound(self) -> bool:
        """Whether nothing is wrong with the file itself; says nothing about the sheet."""
        return self.report.ok

    @property
    def ok(self) -> bool:
        """Whether the file is sound, and the sheet of its design, where that is known, ready to cut."""
        return self.sound and (self.verdict is None or self.verdict.ok)

    @property
    def said(self) -> Level | None:
        """The verdict of the export, as the file has it."""
        if self.report.sheets:  # all sheets of a bed have the same
            return replace(self, report=self.report.sheets[0]).said
        record = self.report.record or self.report.of_pieces
        return None if record is None or not record.verdict else Level(record.verdict)

    @property
    def lines(self) -> tuple[str, ...]:
        """Lines on the file itself, on its making, and on the verdict of its export."""
        report, record = self.report, self.report.record
        found = []
        if report.sheets:
            record = report.sheets[0].record
            found.append(tr_n("{count} sheet on this bed", "{count} sheets on this bed", len(report.sheets)))
        if report.pieces is not None and report.min_ligament_mm is not None:
            found.append(
                tr_n(
                    "checked: {cuts} lines, {pieces} piece, {width:.3f} mm of material or more between cuts of "
                    "{kerf:g} mm",
                    "checked: {cuts} lines, {pieces} pieces, {width:.3f} mm of material or more between cuts of "
                    "{kerf:g} mm",
                    report.pieces,
                    cuts=report.path_count,
                    pieces=report.pieces,
                    width=report.min_ligament_mm,
                    kerf=report.kerf_mm,
                )
            )
        if record is not None:
            found.append(
                tr(
                    "made with: {material}, connectors {connector:g} mm {style}, kerf {kerf:g} mm, profile {profile}, "
                    "version {version}",
                    material=record.material,
                    connector=record.connector_mm,
                    style=record.options.style.value,
                    kerf=record.kerf_mm,
                    profile=record.profile.key,
                    version=record.version,
                )
            )
        if (pieces := report.of_pieces) is not None and pieces.construction == Construction.BACKED:
            found.append(
                tr(
                    "made with: {material}, tiles for a hinge layer, registration holes {pin:g} mm, kerf {kerf:g} mm, "
                    "profile {profile}, version {version}",
                    material=pieces.material,
                    pin=pieces.pin_mm,
                    kerf=pieces.kerf_mm,
                    profile=pieces.profile.key,
                    version=pieces.version,
                )
            )
        elif pieces is not None:
            found.append(
                tr(
                    "made with: {material}, {construction}, layer {layer}, bed {bed}, pins {pin:g} mm, ears {ear:g} "
                    "mm, clearance {clearance:g} mm, kerf {kerf:g} mm, profile {profile}, version {version}",
                    material=pieces.material,
                    construction=pieces.construction,
                    layer=pieces.layer,
                    bed=pieces.bed,
                    pin=pieces.pin_mm,
                    ear=pieces.ear_mm,
                    clearance=pieces.clearance_mm,
                    kerf=pieces.kerf_mm,
                    profile=pieces.profile.key,
                    version=pieces.version,
                )
            )
        if self.said is not None:
            found.append(tr("verdict when it was exported: {level}", level=self.said.words))
        one_sheet = record is not None and record.construction == ONE_SHEET
        if self.verdict is None and (one_sheet or record is not None or pieces is not None):
            found.append(
                tr("not checked: whether the sheet closes and its material holds; name its project by --design")
            )
        return tuple(found)


def checked(path: Path, document: Document | None = None) -> Checked:
    """Read a cut file, compare it with its design, and judge the sheet.

    Parameters
    ----------
    path : Path
        A file, or a folder of layer files.
    document : Document, optional
        The project that it was exported from.  How the design was cut is taken from the file, and so is which of the
        designs it is.

    Raises
    ------
    ExportError
        Missing, damaged, or of another kind.
    ProjectError
        The project has no chosen design.
    """
    report = check_file(path)
    if document is None or not _is_cut_file(report):
        return Checked(report)
    if _is_backed(report):
        return _checked_backed([report], document)[0]
    if report.sheets:
        return _checked_sheets(report, document)
    if report.of_pieces is not None:
        return _checked_beds([report], document)[0]
    request, unlike = _request(report.record, path, _as_carried(document, [report]))
    try:
        made = planned(request)
    except FabricationError as error:
        return Checked(report, None, refused(error))
    as_cut = closed(request, made)
    settings = request.settings
    try:
        found = verify_export(made.plan, path, settings.profile, None, request.deployment, jam_of(as_cut))
    except FabricationError as error:
        return Checked(report, None, refused(error))
    verdict = judged(request, made, as_cut, [found])
    return Checked(report, found, replace(verdict, problems=(*unlike, *verdict.problems)))


def _checked_sheets(report: FileReport, document: Document) -> Checked:
    """Compare every sheet of a bed with its design; the verdict is that on the worst."""
    parts, unlike = parts_as_cut(document), tuple[Problem, ...]()
    requests: list[CutRequest] = []
    for sheet in report.sheets:
        design = "" if sheet.record is None else sheet.record.design
        own = next((part for part in parts if _design_of(part, design) is not None), parts[document.part])
        request, others = _request(sheet.record, report.path, _as_carried(own, [report]))
        requests.append(request)
        unlike = (*unlike, *(problem for problem in others if problem not in unlike))
    try:
        made = [planned(request) for request in requests]
    except FabricationError as error:
        return Checked(report, None, refused(error))
    as_cut = [closed(request, one) for request, one in zip(requests, made, strict=True)]
    sheets = [
        BedSheet(one.plan, request.deployment, jam_of(jam))
        for request, one, jam in zip(requests, made, as_cut, strict=True)
    ]
    places = [sheet.place for sheet in report.sheets if sheet.place is not None]
    if len(places) < len(sheets):
        problem = Problem.error("cut_file.sheets_differ", promised=len(sheets))
        return Checked(replace(report, problems=(*report.problems, problem)))
    bed = SheetBed(tuple(sheets), tuple(places), 1, 1, tuple(range(len(sheets))))
    profile = requests[0].settings.profile
    project = bed_project(bed, "") if report.path.suffix.lower() == ".lbrn2" else b""
    found = verify_bed(bed, report.path, profile, None, project)
    verdicts = [
        judged(request, one, jam, [verification])
        for request, one, jam, verification in zip(requests, made, as_cut, found, strict=True)
    ]
    worst = max(range(len(found)), key=lambda number: RANK[verdicts[number].level])
    verdict = verdicts[worst]
    return Checked(report, found[worst], replace(verdict, problems=(*unlike, *verdict.problems)))


def checked_together(paths: Sequence[Path], document: Document | None = None) -> tuple[Checked, ...]:
    """The same of several files; those of the beds of one design are judged together.

    Raises
    ------
    ExportError, ProjectError
        As :func:`checked`.
    """
    reports = [check_file(path) for path in paths]
    if document is not None and len(reports) > 1 and all(report.of_pieces is not None for report in reports):
        return _checked_beds(reports, document)
    if document is not None and len(reports) > 1 and all(map(_is_backed, reports)):
        return _checked_backed(reports, document)
    return tuple(checked(path, document) for path in paths)


def _is_backed(report: FileReport) -> bool:
    """Whether a file is that of a layer of a backed design."""
    records = (one for one in (report.record, report.of_pieces) if one is not None)
    return Construction.BACKED.value in {one.construction for one in records}


def _checked_backed(reports: Sequence[FileReport], document: Document) -> tuple[Checked, ...]:
    """Compare files of tiles and hinge layer with their design, and judge it."""
    from kirigami_studio.export.assembly_files import read_bed, read_hinge_layer
    from kirigami_studio.export.pieces_read import KnownOutlines

    request, unlike = _request_of_layers(reports, _as_carried(document, reports))
    try:
        made = planned(request)
        job = made.layers
        if job is None or job.glued is None:
            raise FabricationError("export.no_chosen_design")
        board, known = job.beds[0], KnownOutlines()
        found = [
            read_hinge_layer(job, job.glued, report.path)
            if report.of_pieces is None
            else read_bed(job, board, report.path, known)[0]
            for report in reports
        ]
    except (FabricationError, UsageError) as error:
        return tuple(Checked(report, None, refused(error)) for report in reports)
    layers = {"layer-1" if report.of_pieces is None else board.name for report in reports}
    missing = sorted({"layer-1", board.name} - layers)
    notes = (Note.of("check.beds_missing", beds=", ".join(missing)),) if missing else ()
    verdict = judged(request, made, closed(request, made), found)
    verdict = replace(verdict, problems=(*unlike, *verdict.problems), notes=(*verdict.notes, *notes))
    return tuple(Checked(report, one, verdict) for report, one in zip(reports, found, strict=True))


def _request_of_layers(reports: Sequence[FileReport], document: Document) -> tuple[CutRequest, tuple[Problem, ...]]:
    """Design of the layers of a backed sheet; a problem where the project lacks it."""
    saved = document.fabrication
    hinge = next((report.record for report in reports if report.record is not None), None)
    board = next((report.of_pieces for report in reports if report.of_pieces is not None), None)
    wanted = replace(saved, construction=Construction.BACKED, opened_mm=None)
    keys = [one.material for one in (hinge, board) if one is not None]
    own = next((key for key in keys if key == saved.material), keys[0])
    others = [key for key in keys if key != own]
    wanted = replace(wanted, material=own, second_material=others[0] if others else saved.second_material)
    if hinge is not None:
        wanted = replace(
            wanted,
            width_mm=hinge.width_mm,
            connector_mm=hinge.connector_mm,
            options=hinge.options,
            profile=hinge.profile.key,
            kerf_mm=hinge.kerf_mm if own == hinge.material else saved.kerf_mm,
        )
    elif board is not None:
        wanted = replace(wanted, width_mm=board.width_mm or saved.width_mm, profile=board.profile.key)
    if board is not None and own == board.material and not board.profile.slots:
        wanted = replace(wanted, kerf_mm=board.kerf_mm)
    design = hinge.design if hinge is not None else board.design if board is not None else ""
    found = _design_of(document, design)
    if found is None:
        found = next(
            (
                number
                for number, candidate in enumerate(document.candidates)
                if design_hash(deploy(candidate.final_sheet), ()) == design
            ),
            None,
        )
    unlike = () if found is not None else (Problem.error("check.other_design", design=design),)
    chosen = document if found is None else replace(document, chosen=found)
    return CutRequest.of(chosen, wanted), unlike


def _checked_beds(reports: Sequence[FileReport], document: Document) -> tuple[Checked, ...]:
    """Compare the files of beds with the pieces of their design, together where all are there."""
    from kirigami_studio.export.assembly_files import pieces_json, read_bed
    from kirigami_studio.export.pieces_read import KnownOutlines, motion_findings

    records = [report.of_pieces for report in reports if report.of_pieces is not None]
    if any(record.construction != Construction.PINNED.value for record in records):
        return tuple(Checked(report) for report in reports)
    request, unlike = _request_of_pieces(records[0], _as_carried(document, reports))
    if any(_made_otherwise(record, records[0]) for record in records):
        unlike = (*unlike, Problem.error("check.beds_of_several"))
    try:
        made = pieces_of(request)
        job = made.cutting
        assert job is not None  # pinned pieces are cut
        beds = {bed.name: bed for bed in job.beds}
        names = [_bed_name(record) for record in records]
        unlike = (*unlike, *(Problem.error("check.bed_unknown", bed=name) for name in names if name not in beds))
        unlike = (*unlike, *(Problem.error("check.bed_twice", bed=name) for name in beds if names.count(name) > 1))
        known = KnownOutlines()
        read = {
            report.path: read_bed(job, beds[name], report.path, known)
            for report, name in zip(reports, names, strict=True)
            if name in beds
        }
    except (FabricationError, UsageError) as error:
        return tuple(Checked(report, None, refused(error)) for report in reports)
    pieces = {piece.id: piece for _, found in read.values() for piece in found}
    verifications = {path: found for path, (found, _) in read.items()}
    missing = sorted(set(beds) - set(names))
    notes: tuple[Note, ...] = (Note.of("check.beds_missing", beds=", ".join(missing)),) if missing else ()
    if set(pieces) == set(job.assembly.by_id):
        moved = motion_findings(pieces, pieces_json(job.assembly), known)
        last, found = next(reversed(verifications.items()))
        verifications[last] = replace(
            found, findings=(*found.findings, *moved), ok=found.ok and all(one.ok for one in moved)
        )
    verdict = judge_assembled(request.candidate, made.made, request.settings, tuple(verifications.values()))
    verdict = replace(verdict, problems=(*unlike, *verdict.problems), notes=(*verdict.notes, *notes))
    return tuple(Checked(report, verifications.get(report.path), verdict) for report in reports)


def _bed_name(record: PieceRecord) -> str:
    from kirigami_studio.export.cut_bed import bed_name

    number = record.bed.partition(" ")[0]
    return bed_name(record.layer, int(number)) if number.isascii() and number.isdecimal() else record.bed


def _made_otherwise(one: PieceRecord, other: PieceRecord) -> bool:
    """Whether two beds cannot belong to one export."""
    of_bed = replace(one, layer=other.layer, bed=other.bed, pieces=other.pieces, lines=other.lines)
    return replace(of_bed, profile=other.profile) != other


def _request_of_pieces(record: PieceRecord, document: Document) -> tuple[CutRequest, tuple[Problem, ...]]:
    """Design of a bed, made as its record says, and a problem where the project lacks it."""
    saved = document.fabrication
    wanted = replace(
        saved,
        material=record.material,
        machine=record.machine,
        construction=Construction.PINNED,
        width_mm=record.width_mm or saved.width_mm,
        pin_mm=record.pin_mm,
        ear_mm=record.ear_mm,
        clearance_mm=record.clearance_mm,
        fastener=Fastener(record.fastener) if record.fastener else saved.fastener,
        profile=record.profile.key,
        kerf_mm=saved.kerf_mm if record.profile.slots else record.kerf_mm,
        options=replace(saved.options, order=CutOrder(record.order)) if record.order else saved.options,
    )
    numbers = range(len(document.candidates))
    own = (number for number in numbers if _identity_of_pieces(document.candidates[number]) == record.design)
    first = document.chosen if document.chosen is not None else 0
    found = sorted(own, key=lambda number: number != first)
    if not found:
        return CutRequest.of(document, wanted), (Problem.error("check.other_design", design=record.design),)
    return CutRequest.of(replace(document, chosen=found[0]), wanted), ()


def _identity_of_pieces(candidate: Candidate) -> str:
    return design_hash(deploy(candidate.sheet), ())


def _is_cut_file(report: FileReport) -> bool:
    return all(problem.code != "cut_file.not_for_cutting" for problem in report.problems)


def _request(record: FileRecord | None, path: Path, document: Document) -> tuple[CutRequest, tuple[Problem, ...]]:
    """Design of a file, cut as its record says, and a problem where the project lacks it."""
    if record is None:
        return CutRequest.of(document, _enclosed(path) or document.fabrication), ()
    found = _design_of(document, record.design)
    unlike = () if found is not None else (Problem.error("check.other_design", design=record.design),)
    chosen = document if found is None else replace(document, chosen=found)
    request = CutRequest.of(chosen, recorded_settings(record, path, document.fabrication))
    return replace(request, engraved=record.name), unlike


def recorded_settings(record: FileRecord, path: Path, saved: FabricationSettings) -> FabricationSettings:
    """The settings that a file was exported with.

    Parameters
    ----------
    record : FileRecord
    path : Path
        The file, which has the numbers of a material and of a machine that are not bundled.
    saved : FabricationSettings
        Of the project; what the record does not tell is taken from there.

    Raises
    ------
    ExportError
        A record of settings that there are none of.
    """
    try:
        named = replace(saved, material=record.material, machine=record.machine)
        material, machine = stored_material(named), stored_machine(named)
        unknown = record.material not in library().items and material is None
        if unknown or (record.machine and named_machine(named) is None):
            enclosed = _enclosed(path) or saved
            material, machine = material or enclosed.own, machine or enclosed.own_machine
        return replace(
            named,
            width_mm=record.width_mm,
            own=material,
            own_machine=machine,
            connector_mm=record.connector_mm,
            kerf_mm=record.kerf_mm,
            options=record.options,
            profile=record.profile.key,
            engrave=bool(record.name),
            opened_mm=None,
        )
    except KirigamiError as error:
        raise ExportError("cut_file.record_not_readable", name=error.code, value="") from error


def _as_carried(document: Document, reports: Sequence[FileReport]) -> Document:
    """The project held and moved as the design that files carry; as it is where they carry none."""
    found = next((one for report in reports if (one := _enclosed(report.path)) is not None), None)
    if found is None:
        return document
    chosen = {name: getattr(found, name) for name in HELD_AND_MOVED}
    return replace(document, fabrication=replace(document.fabrication, **chosen))


def _enclosed(path: Path) -> FabricationSettings | None:
    """The settings of the design that a file carries; None where it carries none."""
    try:
        return load(layer_paths(path)[0] if path.is_dir() else path).fabrication
    except (ProjectError, IndexError):
        return None


def _design_of(document: Document, identity: str) -> int | None:
    """Number of the design with an identity, the chosen one first; None where the project does not have it."""
    first = range(0) if document.chosen is None else range(document.chosen, document.chosen + 1)
    for number in chain(first, range(len(document.candidates))):
        if _identity(document.candidates[number]) == identity:
            return number
    return None


def _identity(candidate: Candidate) -> str:
    kept = () if candidate.trim is None or all(part is None for part in candidate.trim.kept) else candidate.trim.kept
    return design_hash(deploy(candidate.final_sheet), kept)
