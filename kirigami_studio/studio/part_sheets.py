"""A target of several parts: one sheet for each, to one scale, on beds of one machine.

Parts that lie apart cannot be one mechanism: a sheet is rigid panels that hang together.  So each part has a sheet of
its own.  Together they make one export: a cut file for each bed, with the chosen design of every part.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.fabricate.options import AS_MANY_AS_FIT
from kirigami_studio.foundation.errors import Cancelled, ProjectError, UsageError
from kirigami_studio.foundation.frozen_mapping import FrozenMapping
from kirigami_studio.foundation.steps import Cancel, never
from kirigami_studio.project.document import Document
from kirigami_studio.project.target_parts import parts_as_cut, scale_of
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio import importing
from kirigami_studio.studio.making import (
    CutRequest,
    ExportedFiles,
    ManyPages,
    Output,
    Planned,
    closed,
    exporting,
    jam_of,
    judged,
    many_pages_of,
    picture_job,
    pieces_of,
    planned,
    writes_layers,
    written,
    written_pieces,
)

if TYPE_CHECKING:
    from kirigami_studio.export.bed_files import BedFile
    from kirigami_studio.export.picture import PlacedLayout
    from kirigami_studio.export.sheet_bed import SheetBed
    from kirigami_studio.export.verification import Verification
    from kirigami_studio.studio.as_cut import AsCut
    from kirigami_studio.studio.verdict import Verdict

#: Kinds of pictures that show all parts of a project.
PICTURED = frozenset({".png", ".gif", ".html"})
#: Kinds of cut files that are written of a whole set, beside a folder for each part.
TOGETHER = (".dxf", ".svg")


@dataclass(frozen=True, slots=True, eq=False)
class PartSheet:
    """The sheet of a part: its design, its plan, and how it does as cut."""

    name: str  #: of the part
    request: CutRequest  #: for one copy
    made: Planned
    as_cut: AsCut | str

    def judged(self, verifications: Sequence[Verification] = ()) -> Verdict:
        """Its verdict, with what was found in its files."""
        return judged(self.request, self.made, self.as_cut, verifications)


def part_names(document: Document) -> tuple[str, ...]:
    """Names of the parts of a target, in order."""
    return tuple("" if part.target is None else part.target.name for part in document.parts)


def folder_name(name: str, used: set[str]) -> str:
    """A name that a folder can have, and that none of those ``used`` has; it is added to them."""
    clean = "".join(letter if letter.isalnum() or letter in "-_" else "_" for letter in name).strip("_") or "target"
    unique, number = clean, 2
    while unique in used:
        unique, number = f"{clean}_{number}", number + 1
    used.add(unique)
    return unique


def part_of(document: Document, words: str) -> Document:
    """A part as a project of its own, by its name or its number from 1.

    Raises
    ------
    UsageError
        There is no such part.
    """
    names = part_names(document)
    found = [
        number for number, name in enumerate(names) if words.strip().casefold() in (name.casefold(), f"{number + 1}")
    ]
    if not found:
        raise UsageError("parts.no_such_part", name=words, names=", ".join(names))
    return replace(parts_as_cut(document)[found[0]], place=None)


def with_settings(document: Document, settings: FabricationSettings) -> Document:
    """The project cut by other settings; another width of the sheet is another scale."""
    changed = settings.width_mm != document.fabrication.width_mm
    return replace(document, fabrication=replace(settings, opened_mm=None) if changed else settings)


def part_requests(document: Document) -> tuple[CutRequest, ...]:
    """The chosen design of every part, all cut to one scale.

    Raises
    ------
    ProjectError
        A part has none.
    """
    parts = parts_as_cut(document)
    missing = [name for name, part in zip(part_names(document), parts, strict=True) if part.candidate is None]
    if missing:
        raise ProjectError("parts.not_designed", names=", ".join(missing))
    return tuple(CutRequest.of(part) for part in parts)


def part_sheets(
    document: Document, known: Mapping[Candidate, AsCut | str] = FrozenMapping(), cancel: Cancel = never
) -> tuple[PartSheet, ...]:
    """Plan the sheet of every part, and close those of which nothing is ``known``.

    Raises
    ------
    FabricationError
        A plan that cannot be made.
    ProjectError
        A part has no design.
    """
    found = []
    for name, request in zip(part_names(document), part_requests(document), strict=True):
        if cancel():
            raise Cancelled("plan.stopped")
        cut = request.settings
        one = replace(
            request,
            settings=replace(cut, options=replace(cut.options, copies=1)),
            as_cut=known.get(request.candidate),
        )
        made = planned(one, cancel)
        found.append(PartSheet(name, one, made, closed(one, made)))
    return tuple(found)


def worst_of(verdicts: Sequence[Verdict]) -> Verdict:
    """The verdict on the sheet that does worst: the whole is no better."""
    from kirigami_studio.studio.verdict import RANK

    return max(verdicts, key=lambda verdict: RANK[verdict.level])


def writes_parts(document: Document | None, output: Output) -> bool:
    """Whether an output is cut files of all parts of a project."""
    if document is None or not document.other_parts:
        return False
    from kirigami_studio.export.bed_files import KINDS

    layered = document.candidate is not None and writes_layers(CutRequest.of(document), output)
    return layered or output.name is not None or output.path.suffix.lower() in KINDS


def shows_parts(document: Document | None, output: Output) -> bool:
    """Whether an output is a picture of all parts of a project."""
    shown = output.name is None and output.path.suffix.lower() in PICTURED
    return shown and document is not None and bool(document.other_parts)


def placed_layouts(document: Document) -> list[PlacedLayout]:
    """The opened sheets, or pieces, of all parts, each in its place, for pictures of the whole.

    Raises
    ------
    ProjectError
        A part has no design.
    FabricationError, UsageError
        Pieces that cannot be made.
    """
    from kirigami_studio.export.picture import PlacedLayout
    from kirigami_studio.project.store import packed_designs

    scale, record, found = scale_of(document), packed_designs(document), []
    for request in part_requests(document):
        assert request.document is not None  # a request of a project has it
        job = replace(picture_job(request), record=record)
        place = scale * np.array(request.document.place or (0.0, 0.0))
        pieces = job.pieces
        mm = job.posed.mm_per_world(request.settings.width_mm) if pieces is None else pieces.mm_per_world
        found.append(PlacedLayout(job, mm, place, place))
    return found


def picturing_parts(
    document: Document, path: Path, cancel: Cancel = never, picture_phi: float | None = None
) -> Iterator[ExportedFiles]:
    """Write a picture, animation or page of all parts, in their ideal motion.

    Parameters
    ----------
    picture_phi : float, radians, optional
        Angle that pictures show; the target angle unless given.
    """
    importing.import_exporters()
    from kirigami_studio.export.animation import write_parts_animation
    from kirigami_studio.export.picture import write_parts_png
    from kirigami_studio.export.share_page import write_parts_page

    writers = {".png": write_parts_png, ".gif": write_parts_animation, ".html": write_parts_page}
    layouts = [replace(one, job=replace(one.job, picture_phi=picture_phi)) for one in placed_layouts(document)]
    if cancel():
        raise Cancelled("export.stopped", folder=path)
    writers[path.suffix.lower()](layouts, path)
    yield ExportedFiles(path, None, files=(path,))


def exporting_parts(
    document: Document,
    output: Output,
    many_pages: bool,
    cancel: Cancel,
    known: Mapping[Candidate, AsCut | str] = FrozenMapping(),
    picture_phi: float | None = None,
) -> Iterator[ExportedFiles | ManyPages]:
    """Write the chosen designs of all parts: a cut file for each bed; pieces in folders; one picture of all.

    A PDF of many pages is written only where ``many_pages`` are wanted.  What is ``known`` of designs as cut is not
    found out again.  Pictures show ``picture_phi`` (radians), or the target angle.
    """
    importing.import_exporters()
    importing.import_as_cut()
    requests = part_requests(document)
    if shows_parts(document, output):
        for picture in picturing_parts(document, output.path, cancel, picture_phi):
            yield _with_verdicts(document, requests, picture, known, cancel)
        return
    if any(writes_layers(request, output) for request in requests):
        yield _layers_written(document, requests, output)
        return
    sheets = part_sheets(document, known, cancel)
    beds = laid(sheets, _copies(document))
    if output.has_pdf and not many_pages:
        for bed in beds:
            if many := many_pages_of(bed.size_mm, document.fabrication.paper):
                yield many
                return
    if cancel():
        raise Cancelled("export.stopped", folder=output.path)
    yield written_parts(document, sheets, beds, output, cancel)


def exporting_all(
    request: CutRequest, output: Output, many_pages: bool, cancel: Cancel
) -> Iterator[ExportedFiles | ManyPages]:
    """Write files of a design, or of all parts of its project where the files hold them."""
    document = request.document
    if document is not None and shows_parts(document, output):
        yield from picturing_parts(document, output.path, cancel)
    elif document is not None and writes_parts(document, output):
        known = {} if request.as_cut is None else {request.candidate: request.as_cut}
        yield from exporting_parts(document, output, many_pages, cancel, known)
    else:
        yield from exporting(request, output, many_pages, cancel)


def laid(sheets: Sequence[PartSheet], copies: int = 1) -> tuple[SheetBed, ...]:
    """Lay so many copies of every part on beds.

    Raises
    ------
    FabricationError
        A gap between sheets that the kerf would use up.
    """
    from kirigami_studio.export.sheet_bed import BedSheet, sheets_on_beds

    one = [
        BedSheet(
            replace(sheet.made.plan, origin=sheet.request.facts, name=sheet.made.plan.name),
            sheet.request.deployment,
            jam_of(sheet.as_cut),
        )
        for sheet in sheets
    ]
    return sheets_on_beds(one * copies)


def _copies(document: Document) -> int:
    asked = document.fabrication.options.copies
    return 1 if asked == AS_MANY_AS_FIT else asked


def written_parts(
    document: Document, sheets: Sequence[PartSheet], beds: Sequence[SheetBed], output: Output, cancel: Cancel = never
) -> ExportedFiles:
    """Write the sheets of all parts, read them back, and judge each.

    Raises
    ------
    ExportError
        An unwritable place, or a file that did not pass its own re-reading.
    """
    from kirigami_studio.export.bed_files import BedFile
    from kirigami_studio.export.profile import find_profile
    from kirigami_studio.export.strokes import total_work, work_of
    from kirigami_studio.project.store import packed_designs

    cut = document.fabrication
    how = BedFile(cut.profile, cut.dxf_version, cut.paper, packed_designs(document))
    goals = [output.path] if output.name is None else [output.path / f"{output.name}{kind}" for kind in TOGETHER]
    files: list[Path] = []
    read: list[tuple[Verification, ...]] = [() for _ in sheets]
    for goal in goals:
        more, found = _beds_written(sheets, beds, goal, how)
        files += more
        read = [(*before, *after) for before, after in zip(read, found, strict=True)]
    parts = [_part_of(sheet, verified, output) for sheet, verified in zip(sheets, read, strict=True)]
    if output.name is not None:
        used: set[str] = set()
        for number, sheet in enumerate(sheets):
            if cancel():
                raise Cancelled("export.stopped", folder=output.path)
            own = replace(output, path=output.path / folder_name(sheet.name, used))
            one = written(sheet.request, sheet.made, own, sheet.as_cut)
            files += one.files
            parts[number] = replace(one, part=sheet.name, verifications=(*read[number], *one.verifications))
    verdict = worst_of([one.verdict for one in parts if one.verdict is not None])
    first = files[0] if output.name is None else output.path
    return ExportedFiles(
        first,
        sheets[0].made,
        tuple(one for part in parts for one in part.verifications),
        verdict=verdict,
        files=tuple(files),
        parts=tuple(parts),
        work=total_work([work_of(bed.cuts(find_profile(cut.profile)), bed.sheets[0].plan) for bed in beds]),
    )


def _beds_written(
    sheets: Sequence[PartSheet], beds: Sequence[SheetBed], goal: Path, how: BedFile
) -> tuple[tuple[Path, ...], list[tuple[Verification, ...]]]:
    """Write the files of one kind; returns them, and what was found of every part."""
    from kirigami_studio.export.bed_files import write_beds

    def of_parts(verifications: Sequence[Verification]) -> list[tuple[Verification, ...]]:
        named = [replace(one, sheet=sheets[at % len(sheets)].name) for at, one in enumerate(verifications)]
        return [tuple(named[at :: len(sheets)]) for at in range(len(sheets))]

    def level(verifications: Sequence[Verification]) -> str:
        found = zip(sheets, of_parts(verifications), strict=True)
        return worst_of([sheet.judged(verified) for sheet, verified in found]).level.value

    written_now = write_beds(beds, goal, how, level)
    return written_now.files, of_parts(written_now.verifications)


def _part_of(sheet: PartSheet, verified: tuple[Verification, ...], output: Output) -> ExportedFiles:
    return ExportedFiles(output.path, sheet.made, verified, verdict=sheet.judged(verified), part=sheet.name)


def _with_verdicts(
    document: Document,
    requests: Sequence[CutRequest],
    picture: ExportedFiles,
    known: Mapping[Candidate, AsCut | str],
    cancel: Cancel,
) -> ExportedFiles:
    """A picture of all parts with the verdict on each."""
    if any(request.is_pinned for request in requests):
        judged_parts = [
            ExportedFiles(picture.path, None, verdict=made.verdict, pieces=made, part=name)
            for name, made in zip(part_names(document), map(pieces_of, requests), strict=True)
        ]
    else:
        sheets = part_sheets(document, known, cancel)
        judged_parts = [
            ExportedFiles(picture.path, sheet.made, verdict=sheet.judged(), part=sheet.name) for sheet in sheets
        ]
    verdict = worst_of([one.verdict for one in judged_parts if one.verdict is not None])
    return replace(picture, planned=judged_parts[0].planned, verdict=verdict, parts=tuple(judged_parts))


def _layers_written(document: Document, requests: Sequence[CutRequest], output: Output) -> ExportedFiles:
    """Write a folder for each part of designs that are made of pieces or tiles."""
    home = output.path if output.name is not None else output.path.with_suffix("")
    used: set[str] = set()
    parts = []
    for name, request in zip(part_names(document), requests, strict=True):
        place = home / folder_name(name, used)
        own = replace(output, path=place if output.name is not None else place.with_suffix(output.path.suffix))
        if request.is_pinned:
            found = written_pieces(request, own)
        else:
            made = planned(request)
            found = written(request, made, own, closed(request, made))
        verified = tuple(replace(one, sheet=name) for one in found.verifications)
        parts.append(replace(found, part=name, verifications=verified))
    return ExportedFiles(
        home,
        parts[0].planned,
        tuple(one for part in parts for one in part.verifications),
        verdict=worst_of([one.verdict for one in parts if one.verdict is not None]),
        files=tuple(one for part in parts for one in part.files),
        pieces=parts[0].pieces,
        parts=tuple(parts),
    )
