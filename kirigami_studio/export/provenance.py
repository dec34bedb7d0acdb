"""Origin of a file: facts that every exported file repeats, and the full record as JSON.

The record (sidecar) holds enough to make the same bytes again.
"""

from __future__ import annotations

import hashlib
import json
import re
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import fields
from enum import Enum
from pathlib import Path
from typing import Any

from kirigami_studio import __version__
from kirigami_studio.export.design_record import PIECE
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.profile import Profile, find_profile
from kirigami_studio.export.strokes import name_strokes, strokes_of, work_of
from kirigami_studio.fabricate.cut_plan import CutPlan, Layer
from kirigami_studio.fabricate.joints import joint_count
from kirigami_studio.fabricate.lettering import Engraving
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.foundation.plain_text import printable
from kirigami_studio.lattice.sheet_files import rim_json

#: What some kind of file cannot have in a name.
NOT_IN_NAMES = re.compile(r"[^A-Z0-9_]")
#: Stands for a character that some kind of file cannot hold.
REPLACEMENT = "\N{REPLACEMENT CHARACTER}"
#: The fact by which a cut file is known as one of this program.
PROGRAM = "KIRIGAMI_STUDIO"
#: How a sheet is made: the panels hang together by bridges of the sheet itself.
ONE_SHEET = "one-sheet"
#: The fact with the kerf that slots are as wide as, and that with the level of the verdict of the export.
SLOT_KERF, VERDICT = "SLOT_KERF_MM", "VERDICT"
#: The fact with the number of holes round the sheet that are made first.
AROUND = "HOLES_AROUND"
#: The same of holes in the sheet that hold it, which are made next.
THROUGH = "HOLES_THROUGH"
#: The fact with the number of sheets of several designs, each of which has a record of its own.
SHEETS = "SHEETS"
#: Facts in such a record: the corners of the box round the sheet, and its shift with the number of quarter turns.
BOX, PLACE = "BOX_MM", "PLACE"
#: Raised when entries change their meaning.
VERSION = 1


def facts_of(plan: CutPlan, profile: Profile) -> dict[str, str]:
    """The record in a file of its making: all that its plan is made of again."""
    kerf = 0.0 if profile.slots else plan.kerf_mm
    paths = "beam centre lines, kerf already allowed for: apply no kerf offset"
    return {
        PROGRAM: __version__,
        "CONSTRUCTION": ONE_SHEET,
        "DESIGN": plan.design_hash,
        "SIZE_MM": f"{plan.size_mm[0]:.4f} x {plan.size_mm[1]:.4f}",
        "WIDTH_MM": exactly(plan.size_mm[0]),
        "CONNECTOR_MM": exactly(plan.connector_mm),
        "LEAST_CONNECTOR_MM": f"{plan.min_connector_mm:.4f}",
        "KERF_MM": exactly(kerf),
        **({SLOT_KERF: exactly(plan.kerf_mm)} if profile.slots else {}),
        "STYLE": plan.options.style.value,
        "ORDER": plan.options.order.value,
        "PROFILE": profile.key,
        "MATERIAL": plan.material.key,
        **({} if plan.chosen_machine is None else {"MACHINE": plan.chosen_machine.key}),
        "PATHS": "edges of the finished part: apply the kerf offset of the machine" if profile.slots else paths,
        "LINES": f"{len(strokes_of(plan, profile))}",
        **({"TRIMMED": f"{plan.trimmed}"} if plan.trimmed else {}),
        **_single_connectors(plan),
        **_tabs(plan, profile),
        **_copies(plan),
        **_name(plan, profile),
        **({VERDICT: plan.verdict} if plan.verdict else {}),
        **origin_facts(plan.origin),
    }


def exactly(value: float) -> str:
    """The shortest text of a number that reads as that very number."""
    short = f"{value:g}"
    return short if float(short) == value else repr(float(value))


def _single_connectors(plan: CutPlan) -> dict[str, str]:
    """Connectors with a width of their own and removed ones, in pieces that every program keeps."""
    widths = " ".join(f"{hinge}={exactly(width)}" for hinge, width in plan.options.hinge_mm)
    removed = " ".join(f"{hinge}" for hinge in plan.options.removed)
    facts: dict[str, str] = {}
    for key, text in (("HINGE_MM", widths), ("REMOVED", removed)):
        facts |= {f"{key}_{number}": line for number, line in enumerate(textwrap.wrap(text, PIECE))}
    return facts


def _copies(plan: CutPlan) -> dict[str, str]:
    """Number of sheets in the file, where not one, their distance, and the number asked for."""
    copies, asked = plan.copies, plan.options.copies
    facts = {} if len(copies) == 1 else {"COPIES": f"{len(copies)}", "COPY_GAP_MM": exactly(copies.gap_mm)}
    return facts if asked == 1 else {**facts, "COPIES_ASKED": f"{asked}", "COPY_GAP_MM": exactly(copies.gap_mm)}


def _name(plan: CutPlan, profile: Profile) -> dict[str, str]:
    """The name that was to be engraved; what is, where the file has it, and in how many lines, so that a check can
    tell it from cuts.
    """
    asked = {"NAME": _one_line(plan.name)} if plan.name else {}
    lines = name_strokes(plan, profile)
    if plan.engraving is None or not lines:
        return asked
    return {**asked, "ENGRAVED": plan.engraving.text, "ENGRAVED_LINES": f"{len(lines)}"}


def _tabs(plan: CutPlan, profile: Profile) -> dict[str, str]:
    """Tabs, cuts that end on others on purpose, and holes, which a check would take for faults.

    Files of closed contours have no tabs and no such ends, and say only what was asked for.
    """
    facts: dict[str, str] = {}
    if plan.options.tabs:
        name = "TABS_ASKED" if profile.slots else "TABS"
        facts |= {name: f"{plan.options.tabs}", "TAB_MM": exactly(plan.options.tab_mm)}
    if not profile.slots and (joints := joint_count(plan)):
        facts["JOINS"] = f"{joints}"
    if holes := len(plan.on_layer(Layer.HOLES)):
        facts["HOLES"] = f"{holes}"
    return facts


def origin_facts(origin: Mapping[str, str]) -> dict[str, str]:
    """Where a design comes from, under names that no fact about the cutting has."""
    return {f"FROM_{NOT_IN_NAMES.sub('_', name.upper())}": _one_line(text) for name, text in sorted(origin.items())}


def _one_line(text: str) -> str:
    """The text as every kind of file holds it, without characters that XML or UTF-8 lack."""
    return printable(" ".join(text.split()), REPLACEMENT)


def sidecar_path(cut_file: Path) -> Path:
    """``sheet.dxf`` -> ``sheet.json``; the same beside a folder of files."""
    return cut_file.with_suffix(".json")


def write_sidecar(
    job: ExportJob,
    path: str | Path,
    cut_files: Sequence[Path] = (),
    verdict: Mapping[str, object] | None = None,
) -> Path:
    """Write the record of a job, and return its path.

    Parameters
    ----------
    cut_files : sequence of Path
        Written files that the record names with their SHA-256.
    verdict : mapping, optional
        What is to be expected of the sheet, as JSON; the record has it as it is.

    Raises
    ------
    ExportError
        No plan, or an unwritable place.
    """
    goal = Path(path)
    record = sidecar_record(job, cut_files) | ({} if verdict is None else {"verdict": verdict})
    content = json.dumps(record, indent=1, sort_keys=True, allow_nan=False).encode() + b"\n"

    def verify(written: Path) -> None:
        if json.loads(written.read_bytes()) != record:
            raise ExportError("sidecar.not_as_written", path=goal)

    write_atomically(goal, content, verify)
    return goal


def sidecar_record(job: ExportJob, cut_files: Sequence[Path] = ()) -> dict[str, Any]:
    """Return the record: names, numbers, lists and nothing that depends on time or place.

    Rim, start outline and cell are there, as in a sheet file, where they are not the paper's.
    """
    plan = job.required_plan
    sheet = job.deployment.sheet
    kept = None
    if job.trim is not None:
        kept = [None if part is None else part.tolist() for part in job.trim.kept]
    return {
        "version": VERSION,
        "application": f"kirigami-studio {__version__}",
        "design": {
            "hash": plan.design_hash,
            "rows": sheet.rows,
            "columns": sheet.columns,
            "ratio": sheet.field.ratio.tolist(),
            **({} if sheet.is_default else rim_json(sheet)),
            "phi": float(job.phi),
            "kept": kept,
        },
        "fabrication": {
            "width_mm": float(plan.size_mm[0]),
            "connector_mm": plan.connector_mm,
            "kerf_mm": plan.kerf_mm,
            "overcut_mm": plan.overcut_mm,
            "material": _plain(plan.material),
            "machine": _plain(plan.machine),
            "options": _plain(plan.options),
            "profile": job.profile,
            "dxf_version": job.dxf_version,
            "paper": job.paper,
            **({} if plan.engraving is None else {"engraved": engraved_json(plan.engraving)}),
        },
        "expected": _expected(plan, find_profile(job.profile)),
        "provenance": dict(sorted(job.provenance.items())),
        "files": {name: digest for path in cut_files for name, digest in _digests(path)},
    }


def _expected(plan: CutPlan, profile: Profile) -> dict[str, Any]:
    work = work_of(strokes_of(plan, profile), plan)
    return {
        "size_mm": [float(side) for side in plan.size_mm],
        "cut_length_mm": work.cut_length_mm,
        "travel_mm": work.travel_mm,
        "seconds": {"low": work.times.low, "estimate": work.times.total, "high": work.times.high},
        "paths": {layer.value: len(plan.copies) * len(plan.on_layer(layer)) for layer in plan.layers},
        "min_connector_mm": plan.min_connector_mm,
        **({} if plan.made is None else {"ratio_as_cut": plan.made.field.ratio.tolist()}),
        **({} if not plan.hinges.narrowed.size else {"narrowed_connectors": narrowed_json(plan)}),
        "notes": [note.text for note in plan.notes],
    }


def narrowed_json(plan: CutPlan) -> list[dict[str, float]]:
    """Number, place, planned and asked width, mm, of connectors narrower than asked for."""
    hinges = plan.hinges
    return [
        {
            "connector": int(hinge),
            "x_mm": float(hinges.position[hinge, 0]),
            "y_mm": float(hinges.position[hinge, 1]),
            "width_mm": float(hinges.requested_mm[hinge]),
            "asked_mm": float(hinges.asked_mm[hinge]),
        }
        for hinge in hinges.narrowed.tolist()
    ]


def engraved_json(engraving: Engraving) -> dict[str, Any]:
    """Text and height, mm, of a name that is engraved."""
    return {"text": engraving.text, "height_mm": engraving.height_mm}


def _plain(value: Any) -> Any:
    """Turn a flat dataclass into what JSON knows, without what is not there."""
    entries = {entry.name: getattr(value, entry.name) for entry in fields(value)}
    return {name: _entry(entry) for name, entry in entries.items() if entry is not None}


def _entry(value: Any) -> Any:
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, Mapping):
        return {str(name): _entry(item) for name, item in value.items()}
    return [_entry(item) for item in value] if isinstance(value, tuple) else value


def _digests(path: Path) -> list[tuple[str, str]]:
    """Name and SHA-256 of a file, or of the files of a folder with the folder's name in front."""
    try:
        parts = sorted(path.iterdir()) if path.is_dir() else [path]
        return [
            (part.relative_to(path.parent).as_posix(), hashlib.sha256(part.read_bytes()).hexdigest()) for part in parts
        ]
    except OSError as error:
        raise ExportError("sidecar.file_not_readable", path=path, reason=error.strerror or str(error)) from error
