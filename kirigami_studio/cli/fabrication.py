"""``export``, ``check`` and ``animate``: from saved projects to files, and back from files."""

from __future__ import annotations

import argparse
import math
import sys
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from kirigami_studio.cli.console import STREAM, is_quiet, print_json, remark, say, sentences_to, standing_in
from kirigami_studio.cli.option_types import check_name
from kirigami_studio.export.animation import FRAMES, write_animation
from kirigami_studio.export.cut_motion import CutMotion
from kirigami_studio.export.paper import page_notes
from kirigami_studio.export.profile import find_profile
from kirigami_studio.export.provenance import engraved_json, narrowed_json
from kirigami_studio.export.registry import find_writer
from kirigami_studio.export.strokes import Work, strokes_of, work_of
from kirigami_studio.export.verification import FORMATS, Verification
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.findings import Severity
from kirigami_studio.foundation.errors import FabricationError, UsageError
from kirigami_studio.foundation.steps import never
from kirigami_studio.foundation.words import mark, tr, tr_n
from kirigami_studio.project.candidate_edits import set_label
from kirigami_studio.project.document import Document
from kirigami_studio.project.store import load
from kirigami_studio.settings.fabrication import (
    FabricationSettings,
    is_pinned,
    new_settings,
    with_choices,
)
from kirigami_studio.settings.layers import is_backed, note_before_run
from kirigami_studio.studio.as_cut import Source, jam_json, simulated
from kirigami_studio.studio.checking import Checked, checked_together
from kirigami_studio.studio.cutting import check_connectors
from kirigami_studio.studio.designing import request_for
from kirigami_studio.studio.fixes import Advice
from kirigami_studio.studio.making import (
    CutRequest,
    ExportedFiles,
    Output,
    chosen_candidate,
    closed,
    fixing,
    picture_job,
    planned,
    writes_layers,
    written,
    written_pieces,
)
from kirigami_studio.studio.part_sheets import (
    exporting_parts,
    part_of,
    part_requests,
    shows_parts,
    with_settings,
    writes_parts,
)
from kirigami_studio.studio.verdict import Verdict, refused

if TYPE_CHECKING:
    from kirigami_studio.export.assembly_files import AssemblyJob

#: Angle of the flat sheet.
FLAT_DEG = 180.0


def material_settings(arguments: argparse.Namespace) -> FabricationSettings:
    """Fabrication settings of the width options, else the material's; warn of its limits.

    Unknown materials are refused here, before any work.
    """
    settings = new_settings(_given(arguments))
    note = note_before_run(settings)
    if note is not None:
        in_layers = is_pinned(settings) or is_backed(settings)
        said = tr("note: {text}", text=note.text) if in_layers else f"{tr('warning')}: {note.text}"
        remark(said)
    return settings


def export(arguments: argparse.Namespace) -> int:
    """Write cut or picture files of a project, verify the cut files, and report on them.

    With ``--out -`` the file is standard output, and the report goes to standard error.
    """
    if arguments.out != STREAM:
        return _export(arguments)
    if arguments.json or arguments.all:
        raise UsageError("export.output_is_the_file")
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"cut.{arguments.format}"
        arguments.out = str(path)
        with standing_in(path), sentences_to(None if is_quiet() else "stderr"):
            code = _export(arguments, alone=True)
        content = path.read_bytes()
    sys.stdout.flush()
    sys.stdout.buffer.write(content)
    return code


def _export(arguments: argparse.Namespace, alone: bool = False) -> int:
    """The same to files; ``alone`` refuses all but one."""
    _check_picture(arguments)
    document = load(arguments.project)
    if arguments.part is not None:
        document = part_of(document, arguments.part)
    chosen_candidate(document)
    if arguments.name is not None and document.chosen is not None and document.label is not None:
        check_name(arguments.name, document.label.code)
        document = set_label(document, document.chosen, arguments.name, document.label.note).document
    settings = overridden(document.fabrication, arguments)
    request = CutRequest.of(document, settings)
    output = Output(Path(arguments.out), "cut" if arguments.all else None, _wants_record(arguments))
    if alone and (writes_parts(document, output) or request.is_pinned or writes_layers(request, output)):
        raise UsageError("export.several_files")
    angle = None if arguments.at_deg is None else math.radians(arguments.at_deg)
    if writes_parts(document, output) or shows_parts(document, output):
        whole = with_settings(document, settings)
        return _export_parts(whole, output, angle, fixes=arguments.fixes, as_json=arguments.json)
    if not arguments.all and not writes_layers(request, output):
        find_writer(arguments.out)
    if request.is_pinned:
        found = written_pieces(request, output, angle)
        assert found.verdict is not None  # pieces are judged
        wanted = arguments.fixes and not found.verdict.ok
        return _export_pieces(found, _advice(request, found.verdict) if wanted else None, as_json=arguments.json)
    check_connectors(request.candidate, settings.options)
    try:
        made = planned(request)
    except FabricationError as error:
        if not arguments.fixes:
            raise
        fixes = " ".join(_advice(request, refused(error)).lines)
        raise FabricationError("export.with_fixes", reason=str(error), fixes=fixes) from error
    plan, report = made.plan, made.report
    motion = None
    if arguments.as_cut:
        sheet = simulated(request.candidate, plan, settings.width_mm, request.target, request.deployment)
        request, motion = replace(request, as_cut=sheet.as_cut), sheet.motion
    found = written(request, made, output, closed(request, made), motion, picture_phi=angle)
    verdict = found.verdict
    assert verdict is not None  # planned sheets are judged
    advice = _advice(request, verdict) if arguments.fixes and not verdict.ok else None
    work = _work(plan, settings.profile, output) if made.layers is None or made.work is None else made.work
    notes = [*plan.notes, *report.problems, *(note for one in found.verifications for note in one.warnings)]
    if output.has_pdf:
        notes += page_notes(plan.copies.spread_mm, settings.paper)
    warnings = [note.text for note in notes]
    if document.other_parts and not shows_parts(document, output):
        shown = "" if document.target is None else document.target.name
        warnings.append(tr("This file shows the part '{name}' alone; --part takes another.", name=shown))
    if names := ", ".join(name for name in found.older if name not in found.removed):
        warnings.append(
            tr("The folder has files of an earlier export: {names}. Delete what you do not want to cut.", names=names)
        )
    if found.removed:
        names = ", ".join(found.removed)
        warnings.append(tr("Removed files of an earlier export that this one does not have: {names}.", names=names))
    warnings = list(dict.fromkeys(warnings))
    verified = [_summary(one) for one in found.verifications]
    bad = [finding.text for one in found.verifications for finding in one.findings if not finding.ok]
    if arguments.json:
        print_json(
            {
                "files": [str(path) for path in found.files],
                "size_mm": plan.size_mm,
                "cut_length_mm": work.cut_length_mm,
                "travel_mm": work.travel_mm,
                "seconds_estimate": work.times.total,
                "pieces": report.pieces * len(plan.copies),
                **({} if made.layers is None else tiles_json(made.layers)),
                **({} if len(plan.copies) == 1 else {"copies": len(plan.copies)}),
                "min_connector_mm": plan.min_connector_mm,
                **({} if plan.engraving is None else {"engraved": engraved_json(plan.engraving)}),
                **({} if not plan.hinges.narrowed.size else {"narrowed_connectors": narrowed_json(plan)}),
                "void_miss_um": None if not verified else verified[0]["void_miss_um"],
                **jam_json(verdict.as_cut),
                "warnings": warnings,
                "verified": verified,
                "ok": verdict.ok,
                "verdict": verdict.to_json(),
                **_advice_json(advice),
            }
        )
        return 0 if found.ok else 1
    say(
        tr_n(
            "{files}: {width:.2f} x {height:.2f} mm, cut {cut:.1f} mm, travel {travel:.1f} mm, about {seconds:.0f} s, "
            "{count} piece, smallest connector {connector:.3f} mm",
            "{files}: {width:.2f} x {height:.2f} mm, cut {cut:.1f} mm, travel {travel:.1f} mm, about {seconds:.0f} s, "
            "{count} pieces, smallest connector {connector:.3f} mm",
            report.pieces * len(plan.copies),
            files=", ".join(str(path) for path in found.files),
            width=plan.size_mm[0],
            height=plan.size_mm[1],
            cut=work.cut_length_mm,
            travel=work.travel_mm,
            seconds=work.times.total,
            connector=plan.min_connector_mm,
        )
    )
    if made.layers is not None:
        say(
            "  "
            + tr(
                "{tiles} tiles of {board}, glued on {hinge}",
                tiles=len(made.layers.assembly.pieces),
                board=made.layers.material.name,
                hinge=plan.material.name,
            )
        )
    for one in found.verifications:
        if one.ok:
            say("  " + tr("{path}: verified by two readers", path=one.path))
        else:
            say("  " + tr("{path}: NOT as planned", path=one.path))
    for text in bad:
        say("  " + tr("fault: {text}", text=text))
    say_verdict(verdict)
    _say_advice(advice)
    said = {note.text for note in (*verdict.problems, *verdict.notes)} | {problem.text for problem in report.problems}
    for warning in warnings:
        if warning not in said:
            say("  " + tr("note: {text}", text=warning))
    return 0 if found.ok else 1


def _export_parts(document: Document, output: Output, angle: float | None, *, fixes: bool, as_json: bool) -> int:
    """Write the sheets of all parts of a project, and report on each."""
    requests = part_requests(document)
    for request in requests:
        check_connectors(request.candidate, request.settings.options)
    *_, found = exporting_parts(document, output, True, never, picture_phi=angle)
    assert isinstance(found, ExportedFiles)  # all pages of a PDF are wanted
    verdicts = [(request, one.verdict) for request, one in zip(requests, found.parts, strict=True)]
    advice = [_advice(one, said) if fixes and said is not None and not said.ok else None for one, said in verdicts]
    if as_json:
        answer = parts_json(found) | {"files": [str(path) for path in found.files]}
        each = zip((_part_json(part) for part in found.parts), advice, strict=True)
        print_json(answer | {"parts": [one | _advice_json(some) for one, some in each]})
    else:
        say_parts(found)
        for part, some in zip(found.parts, advice, strict=True):
            if some is not None:
                say(f"{part.part}:")
                _say_advice(some)
        for path in found.files:
            say(f"  {path}")
    return 0 if found.ok else 1


def parts_json(found: ExportedFiles) -> dict[str, object]:
    """The JSON answer on the files of all parts, and on each."""
    verdict, work, parts = found.verdict, found.work, [_part_json(part) for part in found.parts]
    assert verdict is not None  # sheets are judged
    plans = [(part.planned.plan, part.planned.report) for part in found.parts if part.planned is not None]
    warnings = [note.text for plan, report in plans for note in (*plan.notes, *report.problems)]
    return {
        "parts": parts,
        **(
            {}
            if work is None
            else {
                "cut_length_mm": work.cut_length_mm,
                "travel_mm": work.travel_mm,
                "seconds_estimate": work.times.total,
            }
        ),
        "pieces": sum(report.pieces for _, report in plans)
        + sum(len(part.pieces.made.assembly.pieces) for part in found.parts if part.pieces is not None),
        **({"min_connector_mm": min(plan.min_connector_mm for plan, _ in plans)} if plans else {}),
        "warnings": list(dict.fromkeys(warnings)),
        "verified": [_summary(one) | {"part": one.sheet} for one in found.verifications],
        "ok": verdict.ok,
        "verdict": verdict.to_json(),
    }


def _part_json(found: ExportedFiles) -> dict[str, object]:
    verdict, made = found.verdict, found.planned
    assert verdict is not None  # sheets are judged
    sheet = {} if made is None else {"size_mm": made.plan.size_mm, "min_connector_mm": made.plan.min_connector_mm}
    return {"name": found.part, **sheet, **jam_json(verdict.as_cut), "ok": verdict.ok, "verdict": verdict.to_json()}


def say_parts(found: ExportedFiles) -> None:
    """Say of every part what was found in its files, and what is to be expected of it."""
    for part in found.parts:
        if part.planned is not None:
            width, height = part.planned.plan.size_mm
            say(tr("{part}: sheet of {width:.2f} x {height:.2f} mm", part=part.part, width=width, height=height))
        else:
            say(f"{part.part}:")
        for one in part.verifications:
            path = one.path
            right = tr("{path}: verified by two readers", path=path)
            say("  " + (right if one.ok else tr("{path}: NOT as planned", path=path)))
            for finding in one.findings:
                if not finding.ok:
                    say("  " + tr("fault: {text}", text=finding.text))
        if part.verdict is not None:
            say_verdict(part.verdict)
    if (work := found.work) is not None:
        say(
            tr(
                "all parts: cut {cut:.1f} mm, travel {travel:.1f} mm, about {seconds:.0f} s",
                cut=work.cut_length_mm,
                travel=work.travel_mm,
                seconds=work.times.total,
            )
        )


def _wants_record(arguments: argparse.Namespace) -> bool:
    """Whether all settings are written beside the files: beside a whole set unless refused."""
    return arguments.sidecar is not False if arguments.all else bool(arguments.sidecar)


def _export_pieces(found: ExportedFiles, advice: Advice | None, *, as_json: bool) -> int:
    """Report on the files of a pinned design."""
    pieces, verdict = found.pieces, found.verdict
    assert pieces is not None and verdict is not None
    assembly, beds, report, printing = pieces.made.assembly, pieces.beds, pieces.report, pieces.printing
    warnings = list(dict.fromkeys(note.text for note in (*report.problems, *pieces.job.notes)))
    if as_json:
        print_json(
            {
                "files": [str(path) for path in found.files],
                "construction": pieces.job.construction.value,
                **(
                    {"cut_length_mm": pieces.cut_length_mm, "seconds_estimate": pieces.seconds}
                    if printing is None
                    else {"thickness_mm": printing.thickness_mm, "volume_mm3": printing.volume_mm3}
                ),
                "pieces": len(assembly.pieces),
                "pins": len(assembly.hinges),
                "beds": len(beds),
                "iou": report.figures.match,
                "flat_iou": report.figures.flat_match,
                **jam_json(verdict.as_cut),
                "warnings": warnings,
                "verified": [_summary(one) for one in found.verifications],
                "ok": verdict.ok,
                "verdict": verdict.to_json(),
                **_advice_json(advice),
            }
        )
        return 0 if found.ok else 1
    counts = {"folder": found.path, "pieces": len(assembly.pieces), "beds": len(beds), "pins": len(assembly.hinges)}
    if printing is not None:
        words = mark("{folder}: {pieces} pieces, {pins} joints, {beds} plates, {volume:.1f} cm3, {height:g} mm high")
        say(tr(words, **counts, volume=printing.volume_mm3 / 1000.0, height=printing.thickness_mm))
    else:
        words = mark("{folder}: {pieces} pieces on {beds} beds, {pins} pins, cut {cut:.1f} mm, about {seconds:.0f} s")
        say(tr(words, **counts, cut=pieces.cut_length_mm, seconds=pieces.seconds))
    for one in found.verifications:
        if printing is None:
            say("  " + tr("{path}: verified by two readers", path=one.path))
        else:
            say("  " + tr("{path}: {finding}", path=one.path, finding=one.findings[0].text))
    say_verdict(verdict)
    _say_advice(advice)
    return 0 if found.ok else 1


def _advice_json(advice: Advice | None) -> dict[str, object]:
    if advice is None:
        return {}
    return {"fixes": [fix.to_json() for fix in advice.fixes], "tried": advice.tried.text}


def _say_advice(advice: Advice | None) -> None:
    for text in () if advice is None else advice.lines:
        say("  " + tr("fix: {text}", text=text))


def _check_picture(arguments: argparse.Namespace) -> None:
    """Refuse choices for pictures where none is written, and angles that no sheet has."""
    suffix, angle = Path(arguments.out).suffix.lower(), arguments.at_deg
    if angle is not None and angle > FLAT_DEG:
        raise UsageError("picture.angle", angle=angle)
    wanted = (".png",) if angle is not None else (".png", ".gif")
    if (arguments.as_cut or angle is not None) and not arguments.all and suffix not in wanted:
        raise UsageError("picture.none", kinds=" ".join(wanted), path=arguments.out)


def _advice(request: CutRequest, verdict: Verdict) -> Advice:
    """Try changes on the chosen design, all in one go."""
    document = request.document
    assert document is not None and document.target is not None  # a request of a project has them
    run = request_for(document.target, document.settings, request.settings)
    *_, found = fixing(request, verdict, document.named_candidates, run, never)
    assert found is not None  # the last report
    return found


def say_verdict(verdict: Verdict) -> None:
    """Say what is to be expected of a sheet, and why, one line each."""
    say("  " + tr("verdict: {level}", level=verdict.words))
    say("  " + tr("answers: {answers}", answers=verdict.summary))
    for problem in verdict.problems:
        error = problem.severity is Severity.ERROR
        text = problem.text
        say("  " + (tr("problem: {text}", text=text) if error else tr("care: {text}", text=text)))
    for note in verdict.notes:
        say("  " + tr("note: {text}", text=note.text))


def _work(plan: CutPlan, profile: str, output: Output) -> Work:
    """Time of cutting the files; of the plan for kinds of file that have no profile."""
    suffix = output.path.suffix.lower()
    if len(plan.copies) > 1 and suffix in (".pdf", ".lbrn2"):
        return work_of(strokes_of(plan, find_profile("any")), plan)
    if output.name is not None or suffix in FORMATS:
        return work_of(strokes_of(plan, find_profile(profile)), plan)
    return Work(plan.cut_length_mm, plan.travel_mm, plan.times)


def tiles_json(layers: AssemblyJob) -> dict[str, object]:
    """Materials of a backed design."""
    assert layers.glued is not None  # backed designs are
    return {
        "construction": layers.construction.value,
        "hinge_layer": layers.glued.plan.material.key,
        "board": layers.material.key,
        "tiles": len(layers.assembly.pieces),
        "glue_mm2": layers.glued.glue_mm2,
    }


def _summary(found: Verification) -> dict[str, object]:
    return {
        "file": str(found.path),
        "ok": found.ok,
        "pieces": found.pieces,
        "cut_length_mm": found.cut_length_mm,
        "seconds": [found.seconds_low, found.seconds_high],
        "void_miss_um": found.void_miss_um,
        "findings": [finding.text for finding in found.findings],
    }


def check(arguments: argparse.Namespace) -> int:
    """Re-read a cut file; exit code 1 where something is wrong with it or with the sheet."""
    document = None if arguments.design is None else load(arguments.design)
    every = checked_together([Path(name) for name in arguments.file], document)
    ok = all(found.ok for found in every)
    if arguments.json:
        answers = [_checked_json(found) for found in every]
        # One file answers as it always did; of several, those of each stand in a list.
        print_json(
            answers[0] if len(every) == 1 else {"ok": ok, "sound": all(one.sound for one in every), "files": answers}
        )
        return 0 if ok else 1
    for name, found in zip(arguments.file, every, strict=True):
        sound = tr("{file}: the file is sound", file=name)
        say(sound if found.sound else tr("{file}: the file is not sound", file=name))
        for line in (*(problem.text for problem in found.report.problems), *found.lines):
            say(f"  {line}")
    verdicts = {id(found.verdict): found.verdict for found in every if found.verdict is not None}
    for verdict in verdicts.values():
        say_verdict(verdict)
    return 0 if ok else 1


def _checked_json(found: Checked) -> dict[str, object]:
    report, record = found.report, found.report.record or found.report.of_pieces
    answer: dict[str, object] = {
        "file": str(report.path),
        "ok": found.ok,
        "sound": found.sound,
        "problems": [problem.text for problem in report.problems],
        "unit": report.unit,
        "layers": report.layers,
        "paths": report.path_count,
        "size_mm": report.bounds_mm,
        "cut_length_mm": report.cut_length_mm,
        "overlap_mm": report.overlap_mm,
        "pieces": report.pieces,
        "min_ligament_mm": report.min_ligament_mm,
        "record": None if record is None else record.to_json(),
        "verdict_at_export": None if found.said is None else found.said.value,
    }
    if report.sheets:
        records = [None if sheet.record is None else sheet.record.to_json() for sheet in report.sheets]
        answer["sheets"] = [
            {"record": record, "pieces": sheet.pieces} for record, sheet in zip(records, report.sheets, strict=True)
        ]
    if found.verification is not None:
        answer["void_miss_um"] = found.verification.void_miss_um
    if found.verdict is not None:
        answer |= {**jam_json(found.verdict.as_cut), "verdict": found.verdict.to_json()}
    return answer


def animate(arguments: argparse.Namespace) -> int:
    """Write the deployment as an animated GIF."""
    path = Path(arguments.out)
    if path.suffix.lower() != ".gif":
        raise UsageError("animate.not_a_gif", name=path.name)
    document = load(arguments.project)
    request = CutRequest.of(document, overridden(document.fabrication, arguments))
    job = picture_job(request)
    if arguments.as_cut and not request.is_pinned:  # pieces move as the ideal sheet does
        job = replace(job, motion=_cut_motion(document, request.settings))
    frames, motion = write_animation(job, path, FRAMES), job.motion
    if arguments.json:
        answer: dict[str, object] = {"frames": frames, "files": [str(path)]}
        if motion is not None:
            jam = {"jam_deg": math.degrees(motion.jam_phi), "jam_from": Source.SIMULATION.value}
            answer |= {**jam, "reached_deg": math.degrees(motion.reached)}
        print_json(answer)
    elif motion is None:
        say(tr("{path}: {frames} frames", path=path, frames=frames))
    else:
        reached = math.degrees(motion.reached)
        say(tr("{path}: {frames} frames, as cut to {reached:.0f} degrees", path=path, frames=frames, reached=reached))
    return 0


def _cut_motion(document: Document, settings: FabricationSettings) -> CutMotion:
    """How the chosen design moves as cut, simulated on its planned cuts."""
    request = CutRequest.of(document, settings)
    check_connectors(request.candidate, settings.options)
    made, width = planned(request), settings.width_mm
    return simulated(request.candidate, made.plan, width, request.target, request.deployment).motion


def overridden(saved: FabricationSettings, arguments: argparse.Namespace) -> FabricationSettings:
    """The project's settings with the command line's on top.

    Raises
    ------
    UsageError
        An option that no settings can hold.
    """
    return with_choices(saved, _given(arguments))


def _given(arguments: argparse.Namespace) -> dict[str, Any]:
    """Values of the command line by the names of settings."""
    given = {name: value for name, value in vars(arguments).items() if value is not None}
    given["hinge_mm"] = [_hinge_width(text) for text in given.get("hinge_mm", ())]
    given["removed"] = given.pop("remove", ())
    return given


def _hinge_width(text: str) -> tuple[int, float]:
    """``"3=0.8"`` -> (3, 0.8)."""
    number, _, width = text.partition("=")
    try:
        return int(number), float(width)
    except ValueError:
        raise UsageError("export.connector_and_width", text=text) from None
