"""``design``: the whole way from targets to ranked candidates and a folder of files."""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from kirigami_studio.cli.console import ProgressLine, plain, print_json, say
from kirigami_studio.cli.fabrication import material_settings, parts_json, say_parts, say_verdict
from kirigami_studio.cli.inputs import Named, are_many_targets, for_each, part_choice, read_pieces, read_targets, warn
from kirigami_studio.cli.option_types import check_name, parse_grid_or_auto, setting_values
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.second_target import SecondTarget
from kirigami_studio.export.bed_files import KINDS as BED_KINDS
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.picture import write_parts_png, write_png
from kirigami_studio.export.svg import write_layout_svg, write_parts_svg
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.fabricate.machine import MachineKind
from kirigami_studio.fabricate.material import Construction
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import Cancelled, ExportError, FabricationError, KirigamiError, UsageError
from kirigami_studio.foundation.files import check_folder, write_atomically
from kirigami_studio.foundation.processes import Workers, ordered_results_of
from kirigami_studio.foundation.steps import never
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.laying import lost_to_chords, start_error, start_match
from kirigami_studio.lattice.sheet_files import sheet_json
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.read import read_target
from kirigami_studio.outlines.starts import start_shape
from kirigami_studio.pipeline.auto_grid import chosen_for
from kirigami_studio.pipeline.auto_start import chosen_start
from kirigami_studio.pipeline.events import Result
from kirigami_studio.pipeline.pool import Pool
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.variety import look_alikes
from kirigami_studio.project.candidate_edits import set_label
from kirigami_studio.project.document import Document
from kirigami_studio.project.labels import run_labels
from kirigami_studio.project.sheet_size import sized
from kirigami_studio.project.store import save
from kirigami_studio.project.target_parts import for_twin, parts_as_cut, scale_of, twins, with_part, with_parts
from kirigami_studio.settings.design import DesignChoices, chosen_settings
from kirigami_studio.settings.fabrication import (
    FabricationSettings,
    construction_for,
    is_printed,
    machine_for,
    named_machine,
)
from kirigami_studio.settings.layers import note_before_run
from kirigami_studio.studio.as_cut import AsCut, jam_json
from kirigami_studio.studio.designing import (
    KnownAsCut,
    completed,
    document_of,
    first_of_families,
    limit_of_run,
    request_for,
    run_design,
    why_covered,
    why_untrimmed,
)
from kirigami_studio.studio.making import (
    CutRequest,
    ExportedFiles,
    Output,
    Planned,
    closed,
    export_job,
    has_pieces,
    judged,
    judged_pieces,
    picture_job,
    planned,
    with_cuttable_chosen,
    written,
    written_pieces,
)
from kirigami_studio.studio.part_sheets import exporting_parts, folder_name, part_names, placed_layouts, worst_of
from kirigami_studio.studio.targets import PieceRead
from kirigami_studio.studio.two_states import shown_match
from kirigami_studio.studio.verdict import RANK, Level, Verdict, refused

#: Files of a design, by their roles.
FILES = {
    "project": "design.kiri",
    "cut": "cut.dxf",
    "layout": "layout.svg",
    "preview": "preview.png",
    "candidates": "candidates.json",
}
#: Pictures among them, and who draws them.
PICTURES: tuple[tuple[Callable[[ExportJob, Path], object], str], ...] = (
    (write_png, "preview"),
    (write_layout_svg, "layout"),
)


def design(arguments: argparse.Namespace) -> int:
    """Design every target; one JSON object a line for many, files only where --out is given."""
    fabrication = material_settings(arguments)
    limits = note_before_run(fabrication)
    check_name(arguments.name, run_labels(0, 1)[0].code)
    batch = are_many_targets(arguments.targets)
    if arguments.out is not None:
        check_folder(Path(arguments.out))
    line = ProgressLine()
    used: set[str] = set()

    wanted = chosen_settings(
        parse_grid_or_auto(arguments.grid),
        setting_values(arguments, DesignChoices),
        start=replace(start_shape(arguments.start), weight=arguments.start_weight),
        second=second_target(arguments),
    )

    def job_for(target: Outline, cut: FabricationSettings = fabrication) -> DesignJob:
        least, more = arguments.least_panel_mm, {"trim": arguments.trim, "budget_seconds": arguments.budget_seconds}
        request = request_for(target, wanted, cut, least_panel_mm=least, **more)
        return DesignJob(request, cut, least, arguments.out is not None, arguments.name or "")

    def job_of_part(part: Document) -> DesignJob:
        assert part.target is not None  # parts have one
        return job_for(part.target, part.fabrication)

    def folder_for(name: str) -> Path:
        return Path(arguments.out) / _folder_name(name, used) if batch else Path(arguments.out)

    def tell(name: str, design: DesignOutcome, files: dict[str, str]) -> None:
        warnings = [*warn(name, design.result.request.target), *(note.text for note in design.notes)]
        answer = summary(design.result, construction_for(fabrication)) | {"files": files, "warnings": warnings}
        if limits is not None:
            answer["material_note"] = limits.text
        answer |= {"ok": design.verdict.ok, "verdict": design.verdict.to_json(), **jam_json(design.verdict.as_cut)}
        if batch:
            print_json({"source": name} | answer)
        elif arguments.json:
            print_json(answer)
        else:
            _say_result(design.result.request.target, design.result, files, design.verdict)
            for note in design.notes:
                say("  " + tr("note: {text}", text=note.text))

    def one(name: str, target: Outline) -> None:
        design = designed(job_for(target), line)
        files: dict[str, str] = {}
        if arguments.out:
            design, files = write_files(design, folder_for(name))
        tell(name, design, files)

    def one_from_cluster(name: str, design: DesignOutcome) -> None:
        tell(name, design, design.save(folder_for(name)) if design.files else {})

    def every_part(name: str, pieces: tuple[PieceRead, ...]) -> None:
        """Design every piece of a target; one of a single piece as usual."""
        if len(pieces) == 1:
            one(name, pieces[0].outline)
            return
        whole = with_parts(Document(settings=wanted, fabrication=fabrication), [(p.outline, p.place) for p in pieces])
        parts, designs = parts_as_cut(whole), list[DesignOutcome]()
        for part, first in zip(parts, twins(parts), strict=True):
            made = designed(job_of_part(part), line) if first == len(designs) else designs[first].again_for(part)
            designs.append(made)
        found = parts_of(whole, designs, folder_for(name) if arguments.out else None)
        if batch or arguments.json:
            print_json(({"source": name} if batch else {}) | found.to_json([warn(name, p.outline) for p in pieces]))
        else:
            found.say()

    choice = part_choice(arguments)
    if choice is not None and choice.is_each:
        if arguments.scheduler:
            raise UsageError("parts.each_on_cluster")
        pieces = read_pieces(arguments.targets, arguments.threshold, choice, arguments.fill_holes)
        return for_each(pieces, batch, every_part, as_json=arguments.json)
    inputs = read_targets(arguments.targets, arguments.threshold, choice, arguments.fill_holes)
    if arguments.scheduler:
        return for_each(
            _from_cluster(inputs, job_for, Workers(scheduler=arguments.scheduler)),
            batch,
            one_from_cluster,
            as_json=arguments.json,
        )
    return for_each(inputs, batch, one, as_json=arguments.json)


@dataclass(frozen=True, slots=True)
class DesignJob:
    """One target to design."""

    request: Request  #: its grid may be open
    fabrication: FabricationSettings
    least_panel_mm: float
    files: bool  #: whether the design comes with its files
    name: str = ""  #: of the best design; "" for the name that it gets by itself


@dataclass(frozen=True, slots=True, eq=False)
class DesignOutcome:
    """The designs of a job."""

    result: Result
    request: CutRequest  #: The best design that can be cut in its project, and how it is cut
    verdict: Verdict
    #: Names by role, in the folder of the design, of a design from elsewhere that was asked for with its files
    files: Mapping[str, str] = field(default_factory=dict)
    #: Of these files, by name; a name that stands for a folder has several
    contents: Mapping[str, bytes] = field(default_factory=dict)
    #: What is not as it was asked for: no design is trimmed, or another one than the best is cut
    notes: tuple[Note, ...] = ()

    def again_for(self, part: Document) -> DesignOutcome:
        """The same designs for another part of this shape and size."""
        target, document = part.target, self.request.document
        assert target is not None and document is not None  # parts have one, and so has a design that was just made
        result = replace(self.result, request=replace(self.result.request, target=target))
        own = CutRequest.of(for_twin(document, part))
        return replace(self, result=result, request=replace(own, as_cut=self.request.as_cut))

    def save(self, folder: Path) -> dict[str, str]:
        """Write the files; returns their paths by role."""
        for name, content in self.contents.items():
            write_atomically(folder / name, content)
        return {role: str(folder / name) for role, name in self.files.items()}


def designed(job: DesignJob, line: ProgressLine, pool: Pool | None = None) -> DesignOutcome:
    """Do a job, its fits in ``pool``, by default the program's own."""
    run = run_design(job.request, job.fabrication, least_panel_mm=job.least_panel_mm, pool=pool)
    result = completed(run, lambda progress: line.show(progress.message))
    line.clear()
    document = sized(document_of(result, job.fabrication))
    untrimmed = why_untrimmed(result)
    notes: tuple[Note, ...] = () if untrimmed is None else (untrimmed,)
    if job.files:
        document, refusal = with_cuttable_chosen(document)
        if refusal is not None and document.chosen and document.label is not None:
            notes += (Note.of("design.other_is_cut", name=document.label.code, reason=str(refusal)),)
    if job.name:
        document = set_label(document, document.chosen or 0, job.name, "").document
    request = CutRequest.of(document)
    if request.is_pinned:
        return DesignOutcome(result, request, judged_pieces(request), notes=notes)
    try:
        made = planned(request)
    except FabricationError as error:
        return DesignOutcome(result, request, refused(error), notes=notes)
    known = KnownAsCut.of(result, job.fabrication).simulation(request.candidate, request.settings)
    request = replace(request, as_cut=closed(replace(request, as_cut=known), made))
    result = replace(result, as_cut={**result.as_cut, request.candidate: request.as_cut})
    return DesignOutcome(result, request, judged(request, made, request.as_cut), notes=notes)


@dataclass(frozen=True, slots=True, eq=False)
class PartsOutcome:
    """The designs of all parts of a target."""

    document: Document  #: their project
    designs: tuple[DesignOutcome, ...]
    files: Mapping[str, str]  #: by role
    written: ExportedFiles | None  #: what was found in the cut files

    @property
    def verdict(self) -> Verdict:
        """That on the part that does worst."""
        if self.written is not None and self.written.verdict is not None:
            return self.written.verdict
        return worst_of([design.verdict for design in self.designs])

    def to_json(self, warnings: Sequence[Sequence[str]]) -> dict[str, object]:
        """The JSON answer; ``warnings`` are those of reading each part."""
        parts = []
        for name, design, said in zip(part_names(self.document), self.designs, warnings, strict=True):
            construction = construction_for(design.request.settings)
            answer = {"name": name} | summary(design.result, construction)
            answer |= {"warnings": [*said, *(note.text for note in design.notes)], "verdict": design.verdict.to_json()}
            answer |= {"ok": design.verdict.ok, "width_mm": design.request.settings.width_mm}
            parts.append(answer | jam_json(design.verdict.as_cut))
        cut = {} if self.written is None else parts_json(self.written) | {"parts": parts}
        return cut | {
            "parts": parts,
            "mm_per_unit": scale_of(self.document),
            "files": dict(self.files),
            "ok": self.verdict.ok,
            "verdict": self.verdict.to_json(),
        }

    def say(self) -> None:
        """Say the same in sentences."""
        for design in self.designs:
            _say_result(design.result.request.target, design.result, {}, design.verdict)
            for note in design.notes:
                say("  " + tr("note: {text}", text=note.text))
        if self.written is not None:
            say_parts(self.written)
        for path in self.files.values():
            say(f"  {path}")


def parts_of(whole: Document, designs: Sequence[DesignOutcome], folder: Path | None) -> PartsOutcome:
    """One project of the designs of all parts, with its files in a folder if there is one.

    Raises
    ------
    FabricationError
        A part cannot be cut; the project is there.
    """
    for number, design in enumerate(designs):
        document = design.request.document
        assert document is not None  # a design that was just made has a project
        whole = with_part(whole, number, replace(document, place=whole.parts[number].place))
    found = PartsOutcome(whole, tuple(designs), {}, None)
    if folder is None:
        return found
    paths = {role: folder / name for role, name in FILES.items()}
    save(whole, paths["project"])
    listing = {
        "parts": [
            {"name": name, "candidates": candidates_json(design.result, construction_for(design.request.settings))}
            for name, design in zip(part_names(whole), designs, strict=True)
        ]
    }
    write_atomically(paths["candidates"], (json.dumps(plain(listing)) + "\n").encode())
    layouts = placed_layouts(whole)
    write_parts_svg(layouts, paths["layout"])
    write_parts_png(layouts, paths["preview"])
    known = {one.request.candidate: one.request.as_cut for one in designs if one.request.as_cut is not None}
    machine = named_machine(whole.fabrication)
    if has_pieces(whole.fabrication):
        paths["cut"] = folder / ("print" if is_printed(whole.fabrication) else "cut")
        output = Output(paths["cut"], "cut")
    else:
        output = Output(paths["cut"])
    if machine is not None and machine.file in BED_KINDS and machine.file != output.path.suffix and output.name is None:
        paths["machine_cut"] = paths["cut"].with_suffix(machine.file)
    try:
        outputs = [output, *(Output(paths[role]) for role in ("machine_cut",) if role in paths)]
        exported = [[*exporting_parts(whole, one, True, never, known)][-1] for one in outputs]
    except (ExportError, UsageError, FabricationError) as error:
        raise FabricationError("design.not_cut", project=paths["project"], reason=str(error)) from error
    written_now = [one for one in exported if isinstance(one, ExportedFiles)]
    paths["cut"] = written_now[0].path
    worst = max(written_now, key=lambda one: 0 if one.verdict is None else RANK[one.verdict.level])
    beds = {f"cut_{number}": path for number, path in enumerate(worst.files[1:], start=2) if output.name is None}
    return replace(found, files={role: str(path) for role, path in (paths | beds).items()}, written=worst)


@dataclass(frozen=True, slots=True)
class Answer:
    """A worker's answer: a design, or the error of this one target."""

    design: DesignOutcome | None
    error: KirigamiError | None

    def get(self) -> DesignOutcome:
        """The design; raises the error."""
        if self.design is None:
            raise self.error or Cancelled("run.no_result")
        return self.design


@dataclass(frozen=True, slots=True)
class Asked:
    """Assignment of a worker: a job, or the error with which its target could not be read."""

    name: str
    job: DesignJob | None
    error: KirigamiError | None


def designed_there(asked: Asked) -> Answer:
    """Do a job in this process alone, as a worker of a cluster, and read the files it writes."""
    job = asked.job
    if job is None:
        return Answer(None, asked.error)
    line = ProgressLine()
    line.active = False
    try:
        design = designed(job, line, Pool(1))
        if not job.files:
            return Answer(design, None)
        with TemporaryDirectory() as folder:
            design, paths = write_files(design, Path(folder))
            files = {role: Path(path).name for role, path in paths.items()}
            there = [path for path in sorted(Path(folder).rglob("*")) if path.is_file()]
            contents = {path.relative_to(folder).as_posix(): path.read_bytes() for path in there}
        return Answer(replace(design, files=files, contents=contents), None)
    except KirigamiError as error:
        return Answer(None, error)


def _from_cluster(
    inputs: Iterable[Named[Outline]], job_for: Callable[[Outline], DesignJob], workers: Workers
) -> Iterator[Named[DesignOutcome]]:
    """Designs of all inputs, in order, as if they were read from somewhere."""
    for asked, answer in ordered_results_of(designed_there, _asked(inputs, job_for), workers):
        yield Named(asked.name, answer.get)


def _asked(inputs: Iterable[Named[Outline]], job_for: Callable[[Outline], DesignJob]) -> Iterator[Asked]:
    """The jobs of all inputs.  Targets are read here: workers may not have their files."""
    for named in inputs:
        try:
            yield Asked(named.name, job_for(named.read()), None)
        except UsageError:
            raise
        except KirigamiError as error:
            yield Asked(named.name, None, error)


def second_target(arguments: argparse.Namespace) -> SecondTarget | None:
    """The second target that options ask for, None without one.

    Raises
    ------
    UsageError
        An angle or a weight without a target.
    TargetError
        The target cannot be read.
    """
    given = {name: value for name, value in setting_values(arguments, SecondTarget).items() if value is not None}
    if arguments.also is None:
        if given:
            raise UsageError("second_target.not_named")
        return None
    return SecondTarget(read_target(arguments.also), **given)


def summary(result: Result, construction: Construction) -> dict[str, object]:
    """The JSON answer of ``design`` without the files.

    Runs with a budget say whether it ended them, and those
    that chose their grid say why."""
    entries = candidates_json(result, construction)
    answer: dict[str, object] = {
        "candidates": entries,
        "best": entries[0],
        "construction": construction.value,
        "target_outline": [ring.tolist() for ring in result.request.target.rings],
        "target_holes": len(result.request.target.holes),
        "seconds": result.seconds,
        "forward_evaluations": result.forward_evaluations,
    }
    if result.request.grid_chosen:
        answer["grid"], answer["grid_reason"] = list(result.request.chosen_grid), chosen_for(result.request).reason
    if result.request.start_chosen:
        answer["start_choice"] = {"name": result.request.start.name, "reason": chosen_start(result.request).reason}
    if not result.request.start.is_plain:
        sheet = result.best.sheet
        answer["start"] = {
            "name": result.request.start.name,
            "lost_to_chords": lost_to_chords(sheet),
            "error": start_error(sheet),
            "iou": start_match(sheet),
            "weight": result.request.start.weight,
        }
    second = result.request.second
    if second is not None and result.best.second is not None:
        answer["second_target"] = {
            "name": second.outline.name,
            "phi": second.phi,
            "weight": second.weight,
            "iou_exact": result.best.second.match.iou_exact,
        }
    if result.best.trim is not None:
        answer["trimmed_iou"] = result.best.trim.iou
    answer["families"] = {
        family.value: {
            "place": place,
            "match": shown_match(one, _as_cut_in(result, one)),
            "given_up": one.given_up,
        }
        for family, (place, one) in first_of_families(result.candidates).items()
    }
    request = result.request
    # What panels of pinned sheets show says little of their pieces.
    why = None if request.pinned else why_covered(result.candidates, request.target, request.start)
    if why is not None:
        answer["why_covered"] = {"code": why.code, "text": why.text}
    limit = limit_of_run(result)
    if limit is not None and limit != why:
        answer["closed_limit"] = {"code": limit.code, "text": limit.text}
    if result.request.budget_seconds is not None:
        answer["budget_ended"] = result.budget_ended
    return answer


def candidates_json(result: Result, construction: Construction) -> list[dict[str, object]]:
    """The entries of ``candidates``, best first, each with its rank's reason and its group."""
    kind = {"construction": construction.value}
    ranking, candidates = result.ranking, result.candidates
    reasons, groups = ranking.reasons(candidates), look_alikes(candidates, ranking)
    return [
        candidate_json(candidate, ranking, _as_cut_in(result, candidate))
        | {"rank_reason": reason.text, "group": group, **kind}
        for candidate, reason, group in zip(candidates, reasons, groups, strict=True)
    ]


def _as_cut_in(result: Result, candidate: Candidate) -> AsCut | None:
    """How a design of a run does as cut, as far as that is known."""
    found = result.as_cut.get(candidate)
    return found if isinstance(found, AsCut) else None


def candidate_json(candidate: Candidate, ranking: Ranking, as_cut: AsCut | None = None) -> dict[str, object]:
    """One entry of ``candidates``: a sheet file with score and provenance.

    ``match`` is the one that everything shows: of pieces put together, of the trimmed or the whole sheet.  ``as_cut``
    is how it does as cut, null where its cuts cannot be planned.
    """
    even = candidate.score.evenness
    entry: dict[str, object] = {
        **sheet_json(candidate.sheet),
        "grid": list(candidate.sheet.grid),
        **candidate.score.to_json(),
        "match": shown_match(candidate, as_cut),
        "seed": candidate.seed,
        "index": candidate.index,
        "polished": candidate.polished,
        "symmetry": None if candidate.symmetry is None else candidate.symmetry.label,
        "panel_area_cv": even.area_cv,
        "least_feature_mm": even.least_feature_mm(ranking.width_mm),
        "at_limit": even.at_limit,
        "cuttable": ranking.cuttable(candidate),
        "as_cut": None if as_cut is None else as_cut.to_json(),
        "family": candidate.family.value,
        "outline": [ring.tolist() for ring in _silhouette(candidate)],
    }
    if candidate.second is not None:
        match = candidate.second.match
        entry["second"] = {"siou": match.siou, "iou_exact": match.iou_exact, "transform": match.transform.to_json()}
    if candidate.trim is not None:
        cut = sheet_json(candidate.trim.sheet)
        entry |= {"trimmed_iou": candidate.trim.iou, "trimmed_ratio": cut["ratio"], "trimmed_rim": cut["rim"]}
        entry["given_up"] = candidate.given_up
    return entry


def _silhouette(candidate: Candidate) -> list[FloatArray]:
    """Rings (P, 2) of what a design shows, in the frame of the target."""
    motion, pose, phi = deploy(candidate.final_sheet), candidate.final_pose, candidate.final_phi
    if candidate.trim is None:
        return [pose.apply(motion.outline(phi))]
    return PosedDesign(motion, pose, phi, candidate.trim).silhouette(phi)


def write_files(design: DesignOutcome, folder: Path) -> tuple[DesignOutcome, dict[str, str]]:
    """Write project, cut files, layout, preview and candidates.

    Beside ``cut.dxf`` there is a file of the kind that the machine takes, where that is another.
    Returns the design, judged with its cut files as read back, and the paths of all files by role.

    The bytes depend on what is given alone: wall time is not written.

    Raises
    ------
    FabricationError
        No design can be cut; everything but the cut file is there.
    """
    request, document = design.request, design.request.document
    paths = {role: folder / name for role, name in FILES.items()}
    assert document is not None  # a design that was just made has a project
    save(document, paths["project"])
    listing = {"candidates": candidates_json(design.result, construction_for(request.settings))}
    write_atomically(paths["candidates"], (json.dumps(plain(listing)) + "\n").encode())
    made, refusal = None, ""
    try:
        made = None if request.is_pinned else planned(request)
    except FabricationError as error:
        refusal = str(error)
    try:
        job = picture_job(request) if made is None else export_job(request, made)
    except (FabricationError, UsageError):  # panels are shown; writing the pieces says why there are none
        job = export_job(request, None)
    # Pillow draws without the interpreter's lock.
    with ThreadPoolExecutor(1) as beside:
        drawn = [beside.submit(write, job, paths[role]) for write, role in PICTURES]
        try:
            if refusal:
                raise FabricationError("design.not_cut", project=paths["project"], reason=refusal)
            return _write_cuts(design, made, folder, paths)
        finally:
            for one in drawn:
                one.result()


def _write_cuts(
    design: DesignOutcome, made: Planned | None, folder: Path, paths: dict[str, Path]
) -> tuple[DesignOutcome, dict[str, str]]:
    """Write the cut files, whose paths are added."""
    request = design.request
    if made is None or made.layers is not None:
        paths["cut"] = folder / ("print" if is_printed(request.settings) else "cut")
        output = Output(paths["cut"], "cut")
        try:
            found = written_pieces(request, output) if made is None else written(request, made, output, request.as_cut)
        except (ExportError, UsageError, FabricationError) as error:
            raise FabricationError("design.not_cut", project=paths["project"], reason=str(error)) from error
        assert found.verdict is not None  # layers are judged
        return replace(design, verdict=found.verdict), {role: str(path) for role, path in paths.items()}
    machine, verdicts = named_machine(request.settings), []
    if machine is None and machine_for(request.settings).kind is MachineKind.PRINTER:
        machine = machine_for(request.settings)
    if machine is not None and machine.file != paths["cut"].suffix:
        paths["machine_cut"] = paths["cut"].with_suffix(machine.file)
    for role in [name for name in ("cut", "machine_cut") if name in paths]:
        found = written(request, made, Output(paths[role]), request.as_cut)
        assert found.verdict is not None  # planned sheets are judged
        paths[role] = found.path  # a profile may ask for a folder
        verdicts.append(found.verdict)
    worst = max(verdicts, key=lambda verdict: RANK[verdict.level])
    return replace(design, verdict=worst), {role: str(path) for role, path in paths.items()}


def _folder_name(name: str, used: set[str]) -> str:
    """A file-system name for a batch input, made unique."""
    start = name.split("[")[0]
    return folder_name(Path(start).stem + name[len(start) :], used)


def _say_result(target: Outline, result: Result, files: dict[str, str], verdict: Verdict) -> None:
    score, trim = result.best.score, result.best.trim
    if result.request.start_chosen:
        say(f"{target.name}: {chosen_start(result.request).reason}")
    if result.request.grid_chosen:
        say(f"{target.name}: {chosen_for(result.request).reason}")
    best = tr_n(
        "{name}: the design has sIoU {siou:.4f} ({gain:+.4f} over the uniform layout) and TV {tv:.3f}; "
        "{seconds:.1f} s.",
        "{name}: the best of {count} designs has sIoU {siou:.4f} ({gain:+.4f} over the uniform layout) and "
        "TV {tv:.3f}; {seconds:.1f} s.",
        len(result.candidates),
        name=target.name,
        siou=score.siou,
        gain=score.siou_gain,
        tv=score.tv,
        seconds=result.seconds,
    )
    if not result.request.start.is_plain:
        say(
            tr(
                "{name}: the flat sheet starts as '{start}'; chords between its cuts take {lost:.2f} % off it, and it "
                "is within {error:.2f} % of that shape.",
                name=target.name,
                start=result.request.start.name,
                lost=100.0 * abs(lost_to_chords(result.best.sheet)),
                error=100.0 * start_error(result.best.sheet),
            )
        )
    shown = result.best.second
    if shown is not None:
        say(
            tr(
                "{name}: at {angle:.0f} degrees it matches '{second}' with IoU {iou:.4f}.",
                name=target.name,
                angle=math.degrees(shown.target.phi),
                second=shown.target.outline.name,
                iou=shown.match.iou_exact,
            )
        )
    ended = [tr("The budget ended the run.")] if result.budget_ended else []
    say(" ".join((best, *ended)))
    if result.request.trims and trim is None and result.ranking.cuttable(result.best):
        say(
            tr(
                "{name}: no trimmed design can be cut in this material; the best design that can is not trimmed.",
                name=target.name,
            )
        )
    uncuttable = not result.ranking.cuttable(result.best)
    # Pieces may do where their sheet would not.
    if not uncuttable or verdict.level is Level.FAILS:
        (reason, *_) = result.ranking.reasons(result.candidates)
        say(f"{target.name}: {reason.text}")
    limit = limit_of_run(result)
    if limit is not None:
        say(f"{target.name}: {limit.text}")
    if trim is not None and not result.request.pinned:  # pieces are trimmed by rules of their own
        say(
            tr(
                "{name}: trimmed, IoU {iou:.4f}; {percent:.1f} % of the sheet is cut off.",
                name=target.name,
                iou=trim.iou,
                percent=100 * trim.removed_share,
            )
        )
    if uncuttable and verdict.level is Level.FAILS:
        say(tr("{name}: no design can be cut in this material, width and style.", name=target.name))
    say_verdict(verdict)
    for path in files.values():
        say(f"  {path}")
