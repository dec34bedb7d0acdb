"""``design``: the whole way from targets to ranked candidates and a folder of files."""

from __future__ import annotations

import argparse
import json
import math
from dataclasses import replace
from pathlib import Path

from kirigami_studio.cli.console import ProgressLine, plain, print_json, say
from kirigami_studio.cli.fabrication import checked_plan, material_settings, say_verdict
from kirigami_studio.cli.inputs import are_many_targets, for_each, read_targets
from kirigami_studio.cli.option_types import parse_grid_or_auto
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.second_target import USUAL_PHI, USUAL_WEIGHT, SecondTarget
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.picture import write_png
from kirigami_studio.export.registry import export
from kirigami_studio.export.svg import write_layout_svg
from kirigami_studio.foundation.errors import Cancelled, FabricationError, UsageError
from kirigami_studio.foundation.files import check_folder, write_atomically
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.lattice.laying import lost_to_chords, start_error, start_match
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.sheet_files import sheet_json
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.read import read_target
from kirigami_studio.outlines.starts import start_shape
from kirigami_studio.pipeline.auto_grid import chosen_for
from kirigami_studio.pipeline.best_as_cut import best_as_cut
from kirigami_studio.pipeline.events import Finished, Progress, Result
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.redesign import keep_for_connectors
from kirigami_studio.pipeline.request import POLISH_STEPS, REGULAR, Request, provenance
from kirigami_studio.pipeline.run import run, with_grid
from kirigami_studio.pipeline.variety import look_alikes
from kirigami_studio.polish.flat_sheet import width_in_cells
from kirigami_studio.project.as_cut import jam_angles
from kirigami_studio.project.cutting import least_feature_mm, material_for, room_mm
from kirigami_studio.project.design_facts import design_facts, with_run
from kirigami_studio.project.document import Document
from kirigami_studio.project.settings import DesignSettings, FabricationSettings
from kirigami_studio.project.store import save
from kirigami_studio.project.verdict import Verdict, assess, look_at, refused


def design(arguments: argparse.Namespace) -> int:
    """Design every target; one JSON object a line for many, files only where --out is given."""
    grid = parse_grid_or_auto(arguments.grid)
    start = replace(start_shape(arguments.start), weight=arguments.start_weight)
    second = second_target(arguments)
    fabrication = material_settings(arguments)
    regular = REGULAR[arguments.prefer] if arguments.regular is None else arguments.regular
    batch = are_many_targets(arguments.targets)
    if arguments.out is not None:
        check_folder(Path(arguments.out))
    line = ProgressLine()
    used: set[str] = set()

    def one(name: str, target: Outline) -> None:
        request = _on_its_grid(
            Request(
                target=target,
                grid=grid,
                phi=arguments.phi,
                k=arguments.k,
                seed=arguments.seed,
                variant=arguments.variant,
                steps=arguments.steps,
                polish=POLISH_STEPS if arguments.polish else 0,
                prefer=arguments.prefer,
                trim=arguments.trim,
                search=arguments.search,
                budget_seconds=arguments.budget,
                symmetry=arguments.symmetry,
                rim=arguments.rim,
                regular=regular,
                width_mm=fabrication.width_mm,
                least_feature_mm=max(least_feature_mm(fabrication), arguments.least_panel_mm),
                room_mm=room_mm(fabrication),
                start=start,
                second=second,
            ),
            fabrication,
            arguments.least_panel_mm,
        )
        result = _run(request, line)
        if arguments.material is not None:
            result = cuttable_first(result, fabrication, line)
        if request.trim and all(one.trim is None for one in result.candidates):
            budget_ended = result.budget_ended
            raise FabricationError("design.trimming_cut_short" if budget_ended else "design.none_trimmed")
        folder = None if arguments.out is None else Path(arguments.out)
        if folder is not None and batch:
            folder = folder / _folder_name(name, used)
        files = {} if folder is None else write_files(result, fabrication, folder)
        answer = summary(result) | {"files": files}
        verdict = None if arguments.material is None else _verdict_on(result, fabrication)
        if verdict is not None:
            answer |= {"ok": verdict.ok, "verdict": verdict.to_json()}
        if batch:
            print_json({"source": name} | answer)
        elif arguments.json:
            print_json(answer)
        else:
            _say_result(target, result, files, verdict)

    return for_each(read_targets(arguments.targets, arguments.threshold), batch, one)


def second_target(arguments: argparse.Namespace) -> SecondTarget | None:
    """The second target that options ask for, None without one.

    Raises
    ------
    UsageError
        An angle or a weight without a target.
    TargetError
        The target cannot be read.
    """
    if arguments.also is None:
        if arguments.at_deg is not None or arguments.weight is not None:
            raise UsageError("second_target.not_named")
        return None
    phi = USUAL_PHI if arguments.at_deg is None else math.radians(arguments.at_deg)
    weight = USUAL_WEIGHT if arguments.weight is None else arguments.weight
    return SecondTarget(read_target(arguments.also), phi, weight)


def cuttable_first(result: Result, fabrication: FabricationSettings, line: ProgressLine) -> Result:
    """Rank designs by how they do as cut, the best that can be cut in this material first."""
    target = result.request.target
    jams = jam_angles(result.candidates, fabrication)
    steps = best_as_cut(result, jams, lambda one: look_at(one, fabrication, target))
    while True:
        try:
            one = next(steps)
        except StopIteration as end:
            line.clear()
            found: Result = end.value
            return found
        line.show(tr("Looking for a design that can be cut: {number} of {total}", number=one.number, total=one.total))


def _verdict_on(result: Result, fabrication: FabricationSettings) -> Verdict:
    """The verdict on the best design."""
    try:
        return assess(result.best, fabrication, result.request.target).verdict
    except FabricationError as error:
        return refused(error)


def summary(result: Result) -> dict[str, object]:
    """The JSON answer of ``design`` without the files; runs with a budget say whether it ended them, and those
    that chose their grid say why."""
    entries = candidates_json(result)
    answer: dict[str, object] = {
        "candidates": entries,
        "best": entries[0],
        "seconds": result.seconds,
        "forward_evaluations": result.forward_evaluations,
    }
    if result.request.grid_chosen:
        answer["grid"], answer["grid_reason"] = list(result.request.chosen_grid), chosen_for(result.request).reason
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
    if result.request.budget_seconds is not None:
        answer["budget_ended"] = result.budget_ended
    return answer


def candidates_json(result: Result) -> list[dict[str, object]]:
    """The entries of ``candidates``, best first, each with its rank's reason and the group that it looks like."""
    ranking, candidates = result.ranking, result.candidates
    reasons, groups = ranking.reasons(candidates), look_alikes(candidates, ranking)
    return [
        candidate_json(candidate, ranking) | {"rank_reason": reason.text, "group": group}
        for candidate, reason, group in zip(candidates, reasons, groups, strict=True)
    ]


def candidate_json(candidate: Candidate, ranking: Ranking) -> dict[str, object]:
    """One entry of ``candidates``: a sheet file with score and provenance; a trimmed one's other sheet and IoU."""
    even = candidate.score.evenness
    entry: dict[str, object] = {
        **sheet_json(candidate.sheet),
        "grid": list(candidate.sheet.grid),
        **candidate.score.to_json(),
        "seed": candidate.seed,
        "index": candidate.index,
        "polished": candidate.polished,
        "symmetry": None if candidate.symmetry is None else candidate.symmetry.label,
        "panel_area_cv": even.area_cv,
        "least_feature_mm": even.least_feature_mm(ranking.width_mm),
        "at_limit": even.at_limit,
        "cuttable": ranking.cuttable(candidate),
    }
    if candidate.second is not None:
        match = candidate.second.match
        entry["second"] = {"siou": match.siou, "iou_exact": match.iou_exact, "transform": match.transform.to_json()}
    if candidate.trim is not None:
        cut = sheet_json(candidate.trim.sheet)
        entry |= {"trimmed_iou": candidate.trim.iou, "trimmed_ratio": cut["ratio"], "trimmed_rim": cut["rim"]}
    return entry


def write_files(result: Result, fabrication: FabricationSettings, folder: Path) -> dict[str, str]:
    """Write the project, the cut file, the layout, a preview and the candidates; returns their paths by role.

    The bytes depend on the request alone: wall time is not written.
    """
    request, best = result.request, result.best
    plan, _ = checked_plan(best, fabrication)
    document = document_of(result, fabrication)
    job = replace(ExportJob.of(best, request.target.points, plan), provenance=design_facts(document, best))
    paths = {
        "project": folder / "design.kiri",
        "cut": folder / "cut.dxf",
        "layout": folder / "layout.svg",
        "preview": folder / "preview.png",
        "candidates": folder / "candidates.json",
    }
    save(document, paths["project"])
    export(job, paths["cut"])
    write_layout_svg(job, paths["layout"])
    write_png(job, paths["preview"])
    listing = {"candidates": candidates_json(result)}
    write_atomically(paths["candidates"], (json.dumps(plain(listing)) + "\n").encode())
    return {role: str(path) for role, path in paths.items()}


def document_of(result: Result, fabrication: FabricationSettings) -> Document:
    """The project that the window would have after the same run."""
    from kirigami_studio.generator.weights import digest_of

    request = result.request
    settings = DesignSettings(
        request.chosen_grid,
        request.phi,
        request.k,
        request.seed,
        request.variant,
        request.steps,
        request.polish,
        request.prefer,
        request.search,
        request.grid_chosen,
        request.symmetry,
        request.rim,
        request.regular,
        request.start,
        request.second,
    )
    source = provenance(request, digest_of(request.variant))
    candidates = tuple(with_run(result.candidates, source))
    return Document(request.target, settings, candidates, 0, fabrication, source)


def _run(request: Request, line: ProgressLine) -> Result:
    for event in run(request):
        if isinstance(event, Progress):
            line.show(event.message)
        elif isinstance(event, Finished):
            line.clear()
            return event.result
    raise Cancelled("run.no_result")


def _on_its_grid(request: Request, fabrication: FabricationSettings, least_panel_mm: float) -> Request:
    """The request with its grid chosen, and with what depends on the size of its cells."""
    request = with_grid(request)
    grid = request.chosen_grid
    least = least_panel_mm * width_in_cells(grid, request.start) / fabrication.width_mm
    return replace(
        request, least_panel=least, keep=_keep(fabrication, request.uniform) if request.trim else request.keep
    )


def _keep(fabrication: FabricationSettings, sheet: Sheet) -> float:
    """How deep (unit cells) material has to stay at the hinges of a trimmed sheet so that its connectors hold."""
    material, numbers = material_for(fabrication), (fabrication.connector_mm, fabrication.kerf_mm)
    return keep_for_connectors(sheet, material, fabrication.width_mm, *numbers)


def _folder_name(name: str, used: set[str]) -> str:
    """A file-system name for a batch input, made unique."""
    stem = Path(name.split("[")[0]).stem + name[len(name.split("[")[0]) :]
    clean = "".join(letter if letter.isalnum() or letter in "-_" else "_" for letter in stem).strip("_") or "target"
    unique, number = clean, 2
    while unique in used:
        unique, number = f"{clean}_{number}", number + 1
    used.add(unique)
    return unique


def _say_result(target: Outline, result: Result, files: dict[str, str], verdict: Verdict | None) -> None:
    score, trim, angle = result.best.score, result.best.trim, math.degrees(result.request.phi)
    for note in target.notes:
        say(f"{target.name}: {note}")
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
    feasible = tr("It is feasible at {angle:.0f} degrees.", angle=angle)
    if not score.feasible:
        feasible = tr("It is not feasible at {angle:.0f} degrees.", angle=angle)
    ended = [tr("The budget ended the run.")] if result.budget_ended else []
    say(" ".join((best, feasible, *ended)))
    if result.request.trim and trim is None and result.ranking.cuttable(result.best):
        say(
            tr(
                "{name}: no trimmed design can be cut in this material; the best design that can is not trimmed.",
                name=target.name,
            )
        )
    (reason, *_) = result.ranking.reasons(result.candidates)
    say(f"{target.name}: {reason.text}")
    if trim is not None:
        say(
            tr(
                "{name}: trimmed, IoU {iou:.4f}; {percent:.1f} % of the sheet is cut off.",
                name=target.name,
                iou=trim.iou,
                percent=100 * trim.removed_share,
            )
        )
    if verdict is not None:
        if not result.ranking.cuttable(result.best):
            say(tr("{name}: no design can be cut in this material, width and style.", name=target.name))
        say_verdict(verdict)
    for path in files.values():
        say(f"  {path}")
