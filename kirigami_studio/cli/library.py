"""Commands that list: targets, licences, parts, variants, materials, machines; the coupon."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from datetime import date
from importlib import import_module
from pathlib import Path

from kirigami_studio.cli.console import print_json, say
from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.coupon import kerf_from_gaps, plan_coupon
from kirigami_studio.fabricate.machine import SHELF as MACHINES
from kirigami_studio.fabricate.machine import Machine, changed_machine, cuttable, find_machine
from kirigami_studio.fabricate.machine import machines as all_machines
from kirigami_studio.fabricate.material import SHELF as MATERIALS
from kirigami_studio.fabricate.material import Material, default_material, find_material, library
from kirigami_studio.fabricate.material_copies import changed_copy, mark_calibrated
from kirigami_studio.fabricate.shelf import Contents, Item, Shelf
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.licences import components, normalised
from kirigami_studio.foundation.words import tr


def targets(arguments: argparse.Namespace) -> int:
    """List the library silhouettes."""
    from kirigami_studio.outlines.silhouettes import names

    return _listing(arguments, "targets", names())


def licences(arguments: argparse.Namespace) -> int:
    """List what comes with the program, or print the licence of one part of it."""
    found = components()
    if arguments.part is not None:
        found = tuple(one for one in found if normalised(one.name) == normalised(arguments.part))
        if not found:
            raise UsageError("licences.no_such_part", part=arguments.part)
    if arguments.json:
        print_json({"parts": [asdict(one) for one in found]})
    elif arguments.part is not None:
        for one in found:
            say(one.text)
    else:
        for one in found:
            say(f"{one.name:32} {one.version:14} {one.licence}")
    return 0


def serve(arguments: argparse.Namespace) -> int:
    """Serve assistants over the Model Context Protocol until they hang up."""
    code: int = import_module("kirigami_studio.api.mcp_server").serve(Path(arguments.folder))
    return code


def completion(arguments: argparse.Namespace) -> int:
    """Print what makes a shell complete commands, options and files."""
    import shtab

    from kirigami_studio.cli.parser import build_parser

    parser = build_parser()
    _complete_files(parser, shtab.FILE)
    sys.stdout.write(shtab.complete(parser, arguments.shell) + "\n")
    return 0


def _complete_files(parser: argparse.ArgumentParser, files: object) -> None:
    """Have texts of every command that are no choices completed as names of files."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for child in action.choices.values():
                _complete_files(child, files)
        elif action.nargs != 0 and action.choices is None and action.type is None:
            action.complete = files  # type: ignore[attr-defined]


def parts(arguments: argparse.Namespace) -> int:
    """List the parts of a drawing."""
    from kirigami_studio.outlines.read import read_parts

    source = read_parts(arguments.file)
    if arguments.json:
        listed = [part.to_json(source.unit) for part in source.parts]
        print_json(
            {
                "parts": listed,
                "layers": [name for name in source.layers if name],
                "unit": source.unit,
                "largest": list(source.usual),
                "as_painted": source.choice.as_painted,
                "ambiguous": source.is_ambiguous,
                "warnings": list(source.left_out),
            }
        )
        return 0
    for note in source.left_out:
        say(note)
    for part in source.parts:
        width, height = part.size
        row = (
            f"{part.number:4d}  {part.name:24.24}",
            f"{part.kind.value:8}",
            f"{part.layer:20.20}",
            f"{part.colour:8}",
        )
        say(f"{'  '.join(row)}{width:10.4g} x {height:.4g} {source.unit}".rstrip())
    return 0


def variants(arguments: argparse.Namespace) -> int:
    """List the generator variants without loading any weights."""
    from kirigami_studio.generator.weights import variants as bundled

    return _listing(arguments, "variants", bundled())


def _listing(arguments: argparse.Namespace, key: str, names: Sequence[str]) -> int:
    if arguments.json:
        print_json({key: list(names)})
    else:
        for name in names:
            say(name)
    return 0


def materials(arguments: argparse.Namespace) -> int:
    """List all materials, or save or delete one of one's own."""
    _refuse_loose_options(arguments, "materials.copy_and_delete", "materials.options_without_copy")
    found = library()
    if arguments.machine is not None and arguments.copy is None:
        found = replace(found, items=cuttable(find_machine(arguments.machine)))
    listed = {
        "materials": list(found.items),
        "own": sorted(found.own),
        "calibrated": [key for key, material in found.items.items() if material.calibrated],
    }
    return _kept(arguments, MATERIALS, found, listed, _row, _copied_material)


def machines(arguments: argparse.Namespace) -> int:
    """List all machines, or save or delete one of one's own."""
    _refuse_loose_options(arguments, "machines.copy_and_delete", "machines.options_without_copy")
    found = all_machines()
    listed = {"machines": {key: _machine_json(machine, key in found.own) for key, machine in found.items.items()}}
    return _kept(arguments, MACHINES, found, listed, _machine_row, _copied_machine)


def _refuse_loose_options(arguments: argparse.Namespace, both: str, loose: str) -> None:
    """Refuse ``--copy`` beside ``--delete``, and options that mean nothing without ``--copy``."""
    if arguments.copy is not None and arguments.delete is not None:
        raise UsageError(both)
    if arguments.copy is None and (arguments.key is not None or arguments.set or vars(arguments).get("calibrated")):
        raise UsageError(loose)


def _kept(
    arguments: argparse.Namespace,
    shelf: Shelf[Item],
    found: Contents[Item],
    listed: Mapping[str, object],
    row: Callable[[Item, bool], str],
    copied: Callable[[argparse.Namespace, str], tuple[Item, Mapping[str, object]]],
) -> int:
    """List the values of a shelf, or delete or save one of the user's own."""
    if arguments.delete is not None:
        shelf.delete(arguments.delete)
        return _answer(arguments, {"deleted": arguments.delete}, tr("{key}: deleted", key=arguments.delete))
    if arguments.copy is not None:
        made, told = copied(arguments, arguments.copy if arguments.key is None else arguments.key)
        return _answer(arguments, {"saved": made.key, **told}, tr("{material}: saved", material=row(made, True)))
    rows = [row(item, key in found.own) for key, item in found.items.items()]
    faults = [fault.text for fault in found.faults]
    left_out = [tr("Left out: {fault}", fault=fault) for fault in faults]
    return _answer(arguments, {**listed, "faults": faults}, "\n".join([*rows, *left_out]))


def _machine_json(machine: Machine, own: bool) -> dict[str, object]:
    """All numbers of a machine, and the keys of the materials that it cuts."""
    return {**asdict(machine), "own": own, "reach_mm": machine.reach_mm, "materials": list(cuttable(machine))}


def _machine_row(machine: Machine, own: bool) -> str:
    """Key, whose it is, what it reaches, and its name."""
    width, height = machine.reach_mm
    reach = tr("{width:g} x {height:g} mm", width=width, height=height) if min(width, height) > 0.0 else tr("any size")
    return f"{machine.key:<20} {tr('own') if own else tr('bundled'):<8} {reach:<14} {tr(machine.name)}"


def _row(material: Material, own: bool) -> str:
    """Key, whose it is, whether and when it was calibrated, and its name."""
    state = tr("uncalibrated")
    if material.calibrated:
        state = " ".join(part for part in (tr("calibrated"), material.measured_on, material.measured_by) if part)
    return f"{material.key:<12} {tr('own') if own else tr('bundled'):<8} {state:<14} {material.name}"


def _changes(arguments: argparse.Namespace) -> dict[str, object]:
    """Changes of ``--set`` by name.

    Raises
    ------
    UsageError
        Something that is no name with a value.
    """
    changes: dict[str, object] = {}
    for entry in arguments.set:
        name, equals, value = entry.partition("=")
        if not equals or not value.strip():
            raise UsageError("materials.not_name_and_value", entry=entry)
        changes[name.strip()] = value.strip()
    return changes


def _copied_machine(arguments: argparse.Namespace, key: str) -> tuple[Machine, Mapping[str, object]]:
    """Save a changed copy of a machine."""
    made = changed_machine(arguments.copy, key, _changes(arguments))
    MACHINES.save(made)
    return made, {}


def _copied_material(arguments: argparse.Namespace, key: str) -> tuple[Material, Mapping[str, object]]:
    """Save a changed copy of a material, calibrated today if somebody measured it."""
    if arguments.calibrated and arguments.by is None:
        raise UsageError("materials.calibrated_by_nobody")
    machine = None if arguments.machine is None else find_machine(arguments.machine)
    made = changed_copy(arguments.copy, key, _changes(arguments), machine)
    if arguments.calibrated:
        made = mark_calibrated(made, date.today(), arguments.by)
    else:
        MATERIALS.save(made)
    return made, {"calibrated": made.calibrated}


def coupon(arguments: argparse.Namespace) -> int:
    """Write the calibration coupon of a material, or turn what was measured on it into a kerf."""
    from kirigami_studio.export.dxf import write_dxf
    from kirigami_studio.export.pdf import write_pdf
    from kirigami_studio.export.profile import DEFAULT_PROFILE, find_profile
    from kirigami_studio.export.svg import write_cut_svg

    if arguments.gap_mm:
        return _measured(arguments)
    if arguments.out is None:
        raise UsageError("coupon.nothing_to_do")
    profile = find_profile(arguments.profile or DEFAULT_PROFILE)
    path = Path(arguments.out)
    material = default_material() if arguments.material is None else find_material(arguments.material)
    plan = plan_coupon(material, arguments.kerf_mm)
    match path.suffix.lower():
        case ".dxf":
            write_dxf(plan, path, arguments.dxf_version, profile)
        case ".svg":
            write_cut_svg(plan, path, profile)
        case ".pdf":
            write_pdf(plan, path)
        case _:
            raise UsageError("coupon.unknown_extension", name=path.name)
    report, notes = check_plan(plan), [note.text for note in plan.notes]
    content: dict[str, object] = {
        "files": [str(path)],
        "size_mm": plan.size_mm,
        "seconds_estimate": plan.seconds_estimate,
        "pieces": report.pieces,
        "notes": notes,
    }
    width, height = plan.size_mm
    title = tr(
        "{path}: coupon of {width:g} x {height:g} mm for {material}, about {seconds:.0f} s",
        path=path,
        width=width,
        height=height,
        material=material.key,
        seconds=plan.seconds_estimate,
    )
    return _answer(arguments, content, "\n".join([title, *notes]))


def _measured(arguments: argparse.Namespace) -> int:
    found = kerf_from_gaps(arguments.gap_mm)
    kerf, doubt = round(found.kerf_mm, 4), round(found.doubt_mm, 4)
    sentence = tr(
        "Kerf {kerf:g} mm (readings within {doubt:g} mm of it). Save it, for example, with: "
        "kirigami-studio materials --copy KEY --as NEW --set kerf_mm={kerf:g} --calibrated --by NAME",
        kerf=kerf,
        doubt=doubt,
    )
    return _answer(arguments, {"kerf_mm": found.kerf_mm, "doubt_mm": found.doubt_mm}, sentence)


def _answer(arguments: argparse.Namespace, content: dict[str, object], sentence: str) -> int:
    if arguments.json:
        print_json(content)
    else:
        say(sentence)
    return 0
