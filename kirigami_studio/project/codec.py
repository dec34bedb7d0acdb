"""Document <-> members of a project file: JSON for what the user may read, one array for the ratios."""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from dataclasses import MISSING, asdict, fields, replace
from typing import Any

import numpy as np

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.evaluate.evenness import Evenness, evenness
from kirigami_studio.evaluate.feasibility import Contact
from kirigami_studio.evaluate.score import Score, confirmed
from kirigami_studio.evaluate.second_target import SecondMatch, SecondTarget, confirmed_match
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.siou import ShapeMatch
from kirigami_studio.evaluate.trimming import Trim, trim
from kirigami_studio.fabricate.machine import OLDER_ENTRIES, Machine, MachineKind
from kirigami_studio.fabricate.material import OLD_LIMIT, Material, with_entries_of_now
from kirigami_studio.fabricate.options import CutOptions
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.lattice.deployment import check_phi, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.sheet_files import rim_json, sheet_json, sheet_of_json
from kirigami_studio.outlines.drawing import NO_GUIDES, Guides
from kirigami_studio.outlines.nodes import Kind, Nodes
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.starts import RECTANGLE, USUAL_WEIGHT, StartShape
from kirigami_studio.project.document import MOST_PARTS, Document, Mark, Void
from kirigami_studio.project.json_record import Record, one_of, read_json, settings_json, settings_values
from kirigami_studio.project.labels import Label
from kirigami_studio.project.migrations import Members
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings

DESIGN = "design.json"
RATIOS = "ratios.npy"
#: Members of the other parts of a target, numbered from 1 on.
PART = "part-{number}-{name}"
#: Ratios as they were sampled, of those candidates that a fit has improved, in the candidates' order.
SAMPLED = "sampled.npy"


def encode(document: Document) -> dict[str, bytes]:
    """Return the members of the current format; equal documents give equal bytes."""
    found = _members(document)
    for number, part in enumerate(document.other_parts, start=1):
        found |= {PART.format(number=number, name=name): content for name, content in _members(part).items()}
    return found


def _members(document: Document) -> dict[str, bytes]:
    """The members of a document without the other parts of its target."""
    runs = list(dict.fromkeys(entry.made_with for entry in document.candidates if entry.made_with))
    seconds = list(dict.fromkeys(_second_targets(document)))
    design = {
        "target": None if document.target is None else _outline_json(document.target),
        "settings": _settings_json(document.settings, seconds),
        # Not there for a target that is one object, so that such projects stay as they were.
        **({"drawing": [_outline_json(entry) for entry in document.drawing]} if document.drawing else {}),
        **({} if document.guides == NO_GUIDES else {"guides": dict(zip("xy", document.guides, strict=True))}),
        "fabrication": _fabrication_json(document.fabrication),
        "candidates": [_candidate_json(entry, runs, seconds) for entry in document.candidates],
        "runs": [dict(run) for run in runs],
        # Not there without any, so that such projects stay as they were.
        **({"second_targets": [_second_target_json(entry) for entry in seconds]} if seconds else {}),
        "chosen": document.chosen,
        "provenance": dict(sorted(document.provenance.items())),
        "marks": [mark.value for mark in document.marks],
        "labels": [asdict(label) for label in document.labels],
        "naming_runs": document.runs,
        "locked": [list(void) for void in sorted(document.locked)],
        # Not there for a target of one part, so that such projects stay as they were.
        **({"parts": {"others": len(document.other_parts), "at": document.part}} if document.other_parts else {}),
        **({} if document.place is None else {"place": list(document.place)}),
    }
    members = {DESIGN: json.dumps(design, indent=1, allow_nan=False).encode()}
    sampled = [entry.sampled_sheet for entry in document.candidates if entry.sampled_sheet is not None]
    for name, sheets in ((RATIOS, [entry.sheet for entry in document.candidates]), (SAMPLED, sampled)):
        if sheets:
            stream = io.BytesIO()
            stacked = np.stack([sheet.field.ratio for sheet in sheets]).astype("<f8")
            np.lib.format.write_array(stream, stacked, version=(1, 0), allow_pickle=False)
            members[name] = stream.getvalue()
    return members


def decode(members: Members) -> Document:
    """Rebuild the document.

    Raises
    ------
    KirigamiError
        A member is missing or holds what no document can hold.
    """
    document, others, at = _document(members)
    parts = []
    for number in range(1, others + 1):
        start = PART.format(number=number, name="")
        own = {name.removeprefix(start): content for name, content in members.items() if name.startswith(start)}
        part, more, _ = _document(own)
        if more:
            raise ProjectError("project.part_without_target")
        parts.append(part)
    return replace(document, other_parts=tuple(parts), part=at) if parts else document


def _document(members: Members) -> tuple[Document, int, int]:
    """A document without the other parts of its target, their number, and its place among all."""
    if DESIGN not in members:
        raise ProjectError("project.member_missing", name=DESIGN)
    design = Record(read_json(members[DESIGN], DESIGN), DESIGN)
    others, at = 0, 0
    if design.holds("parts"):
        among = design.record("parts")
        others, at = among.whole("others"), among.whole("at")
        if not 0 <= others < MOST_PARTS:
            raise ProjectError("project.no_such_part", number=at, parts=others + 1, limit=MOST_PARTS)
    settings = design.record("settings")
    entries = design.list("candidates")
    records = [Record(entry, f"{DESIGN}.candidates[{k}]") for k, entry in enumerate(entries)]
    fields = _read_ratios(members, RATIOS, len(records))
    sampled = iter(_read_ratios(members, SAMPLED, sum(record.flag("sampled") for record in records)))
    runs = _runs(design.list("runs"))
    seconds = _second_targets_of(design)
    rows, columns = _whole_pair(settings, "grid")
    target = _outline(design.record("target")) if design.holds("target") else None
    candidates = [
        replace(
            _candidate(record, field, next(sampled) if record.flag("sampled") else None, target),
            made_with=_run(record, runs),
            second=_second(record, seconds),
        )
        for record, field in zip(records, fields, strict=True)
    ]
    found = Document(
        target=target,
        drawing=_drawing(design),
        guides=_guides(design),
        settings=DesignSettings(
            **settings_values(settings, DesignSettings),
            grid=(rows, columns),
            start=_start(settings),
            second=_second_target(settings, seconds),
        ),
        candidates=_confirmed(candidates, target),
        chosen=design.whole("chosen") if design.holds("chosen") else None,
        fabrication=_fabrication(design.record("fabrication")),
        provenance=design.texts("provenance"),
        marks=tuple(one_of(Mark, name) for name in design.list("marks")),
        labels=tuple(_label(entry, k) for k, entry in enumerate(design.list("labels"))),
        runs=design.whole("naming_runs"),
        locked=frozenset(_void(entry) for entry in design.list("locked")),
        place=design.pair("place") if design.holds("place") else None,
    )
    return found, others, at


def _settings_json(settings: DesignSettings, seconds: list[SecondTarget]) -> dict[str, object]:
    """The settings; no start where it is the paper's rectangle and no second target where there is none, so that such
    projects stay as they were.
    """
    start = settings.start
    entries = {"grid": list(settings.grid), **settings_json(settings)}
    if settings.second is not None:
        entries["second"] = {"number": seconds.index(settings.second)}
    if not start.is_plain or start.is_auto:
        outline = None if start.outline is None else _outline_json(start.outline)
        softer = {} if start.weight == USUAL_WEIGHT else {"weight": start.weight}
        entries["start"] = {"name": start.name, "aspect": start.aspect, "outline": outline, **softer}
    return entries


def _start(settings: Record) -> StartShape:
    if not settings.holds("start"):
        return RECTANGLE
    record = settings.record("start")
    return StartShape(
        record.text("name"),
        _outline(record.record("outline")) if record.holds("outline") else None,
        record.number("aspect") if record.holds("aspect") else None,
        record.number("weight") if record.holds("weight") else USUAL_WEIGHT,
    )


def _second_targets(document: Document) -> Iterator[SecondTarget]:
    """All second targets that a document knows of, some more than once."""
    if document.settings.second is not None:
        yield document.settings.second
    for candidate in document.candidates:
        if candidate.second is not None:
            yield candidate.second.target


def _second_target_json(second: SecondTarget) -> dict[str, object]:
    return {"outline": _outline_json(second.outline), "phi": second.phi, "weight": second.weight}


def _second_targets_of(design: Record) -> list[SecondTarget]:
    if not design.holds("second_targets"):
        return []
    place = f"{DESIGN}.second_targets"
    records = [Record(entry, f"{place}[{k}]") for k, entry in enumerate(design.list("second_targets"))]
    return [
        SecondTarget(_outline(record.record("outline")), record.number("phi"), record.number("weight"))
        for record in records
    ]


def _second_target(record: Record, seconds: list[SecondTarget]) -> SecondTarget | None:
    if not record.holds("second"):
        return None
    number = record.record("second").whole("number")
    if not 0 <= number < len(seconds):
        raise ProjectError("project.no_such_second_target", number=number, targets=len(seconds))
    return seconds[number]


def _second(record: Record, seconds: list[SecondTarget]) -> SecondMatch | None:
    target = _second_target(record, seconds)
    if target is None:
        return None
    match = record.record("second")
    pose = _pose(match.record("transform"))
    return SecondMatch(target, ShapeMatch(match.number("siou"), match.number("iou_exact"), pose))


def _outline_json(outline: Outline) -> dict[str, object]:
    return {
        "name": outline.name,
        "notes": list(outline.notes),
        "size": None if outline.size is None else list(outline.size),
        "unit": outline.unit,
        "points": outline.points.tolist(),
        "place": None if outline.place is None else list(outline.place),
        "nodes": None if outline.nodes is None else _nodes_json(outline.nodes),
        # Left out where there are none: files stay as they were before holes.
        **{
            key: [hole.tolist() for hole in getattr(outline, key)]
            for key in ("holes", "filled_holes")
            if getattr(outline, key)
        },
    }


def _outline(record: Record) -> Outline:
    notes = record.list("notes")
    return Outline(
        points=_table(record.list("points"), "target.points"),
        name=record.text("name"),
        notes=tuple(str(note) for note in notes),
        size=record.pair("size") if record.holds("size") else None,
        unit=record.text("unit"),
        place=record.pair("place") if record.holds("place") else None,
        nodes=_nodes(record.record("nodes")) if record.holds("nodes") else None,
        **{
            key: tuple(_table(hole, f"target.{key}") for hole in record.list(key))
            for key in ("holes", "filled_holes")
            if record.holds(key)
        },
    )


def _drawing(design: Record) -> tuple[Outline, ...]:
    if not design.holds("drawing"):
        return ()
    place = f"{DESIGN}.drawing"
    return tuple(_outline(Record(entry, f"{place}[{k}]")) for k, entry in enumerate(design.list("drawing")))


def _guides(design: Record) -> Guides:
    if not design.holds("guides"):
        return NO_GUIDES
    guides = design.record("guides")
    return guides.numbers("x"), guides.numbers("y")


def _nodes_json(nodes: Nodes) -> dict[str, object]:
    return {
        "at": nodes.at.tolist(),
        "kinds": [kind.value for kind in nodes.kinds],
        "handles": nodes.handles.tolist(),
        "kept": nodes.kept.tolist(),
    }


def _nodes(record: Record) -> Nodes:
    at, kept = record.list("at"), record.list("kept")
    if not all(isinstance(index, int) and not isinstance(index, bool) and abs(index) < 2**31 for index in at):
        raise ProjectError("json.not_whole_numbers", place=f"{DESIGN}.target.nodes.at")
    if not all(isinstance(flag, bool) for flag in kept):
        raise ProjectError("json.not_all_true_or_false", place=f"{DESIGN}.target.nodes.kept")
    try:
        handles = np.array(record.list("handles"), dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise ProjectError("json.not_a_table_of_numbers", place=f"{DESIGN}.target.nodes.handles") from None
    kinds = tuple(one_of(Kind, name) for name in record.list("kinds"))
    return Nodes(np.array(at, dtype=np.int64), kinds, handles, np.array(kept, dtype=np.bool_))


def _fabrication_json(settings: FabricationSettings) -> dict[str, object]:
    options = settings.options
    lists = {"hinge_mm": [list(pair) for pair in options.hinge_mm], "removed": list(options.removed)}
    own, machine = settings.own, settings.own_machine
    return {
        **settings_json(settings),
        "options": {**settings_json(options), **lists},
        "own": None if own is None else _own_json(own) | {"sources": dict(own.sources)},
        # Not there without one, so that such projects stay as they were.
        **({} if machine is None else {"own_machine": _own_json(machine)}),
    }


def _own_json(own: Material | Machine) -> dict[str, object]:
    return {name: one for name, one in asdict(own).items() if one is not None}


def _fabrication(record: Record) -> FabricationSettings:
    options = record.record("options")
    return FabricationSettings(
        **settings_values(record, FabricationSettings),
        options=CutOptions(
            **settings_values(options, CutOptions),
            hinge_mm=tuple(_hinge_width(entry) for entry in options.list("hinge_mm")),
            removed=tuple(_hinge(entry) for entry in options.list("removed")),
        ),
        own=_own_material(record.record("own")) if record.holds("own") else None,
        own_machine=_own_machine(record.record("own_machine")) if record.holds("own_machine") else None,
    )


def _own_material(record: Record) -> Material:
    """The numbers of a material; those of its machine stand in older files."""
    older = {name: record.number(name) for name in OLDER_ENTRIES if record.holds(name)}
    limits = {OLD_LIMIT: record.number(OLD_LIMIT)} if record.holds(OLD_LIMIT) else {}
    newer: dict[str, Any] = {name: record.text(name) for name in ("construction", "style") if record.holds(name)}
    if record.holds("sources"):
        newer["sources"] = record.texts("sources")
    # The note is longer than a name; a material makes plain text of it itself.
    note = {"note": record.verbatim("note")}
    return Material(**with_entries_of_now(limits) | _plain_fields(record, Material) | older | newer | note)


def _own_machine(record: Record) -> Machine:
    """The numbers of a machine; its note is longer than a name, as a material's."""
    words = {"kind": one_of(MachineKind, record.text("kind")), "note": record.verbatim("note")}
    return Machine(**_plain_fields(record, Machine) | words)


def _hinge(entry: object) -> int:
    if isinstance(entry, bool) or not isinstance(entry, int):
        raise ProjectError("project.not_a_connector_number", value=entry)
    return entry


def _hinge_width(entry: object) -> tuple[int, float]:
    if not isinstance(entry, list) or len(entry) != 2:
        raise ProjectError("project.not_a_connector_with_width", value=entry)
    hinge, width = entry
    if isinstance(width, bool) or not isinstance(width, (int, float)):
        raise ProjectError("project.not_a_connector_width", value=width)
    return _hinge(hinge), float(width)


def _plain_fields(record: Record, kind: type[Material | Machine | Score | Evenness]) -> dict[str, Any]:
    """What a record has for those fields of a dataclass that hold one text, number or flag."""
    read = {"str": record.text, "float": record.number, "int": record.whole, "bool": record.flag}
    entries = [entry for entry in fields(kind) if entry.type in read]
    wanted = [entry for entry in entries if entry.default is MISSING or record.holds(entry.name)]
    return {entry.name: read[str(entry.type)](entry.name) for entry in wanted}


def _candidate_json(
    entry: Candidate, runs: list[tuple[tuple[str, str], ...]], seconds: list[SecondTarget]
) -> dict[str, object]:
    cut, second = entry.trim, entry.second
    return {
        "seed": entry.seed,
        "index": entry.index,
        "polished": entry.polished,
        "variant": entry.variant,
        "origin": entry.origin.value,
        "run": runs.index(entry.made_with) if entry.made_with else None,
        "sheet": _unless_default(entry.sheet),
        "sampled": entry.sampled_sheet is not None,
        "sampled_sheet": None if entry.sampled_sheet is None else _unless_default(entry.sampled_sheet),
        "score": entry.score.to_json(),
        **(
            {}
            if second is None
            else {
                "second": {
                    "number": seconds.index(second.target),
                    "siou": second.match.siou,
                    "iou_exact": second.match.iou_exact,
                    "transform": second.match.transform.to_json(),
                }
            }
        ),
        # What was cut off follows from these; it is cut again on reading.
        "trim": None
        if cut is None
        else {
            **sheet_json(cut.sheet),
            "pose": cut.pose.to_json(),
            "phi": cut.phi,
            "keep": cut.keep,
            **({"deep": True} if cut.deep else {}),
        },
    }


def _unless_default(sheet: Sheet) -> dict[str, object] | None:
    """Rim, start outline and cell; None where they are the paper's."""
    return None if sheet.is_default else rim_json(sheet)


def _sheet(record: Record, name: str, field: RatioField) -> Sheet:
    """Ratios with the rim, start outline and cell that a record has for them."""
    return sheet_of_json(record.record(name).entries, field) if record.holds(name) else Sheet(field)


def _candidate(record: Record, field: RatioField, sampled: RatioField | None, target: Outline | None) -> Candidate:
    sheet = _sheet(record, "sheet", field)
    return Candidate(
        sheet=sheet,
        score=_score(record.record("score"), sheet),
        seed=record.whole("seed"),
        index=record.whole("index"),
        polished=record.flag("polished"),
        sampled_sheet=None if sampled is None else _sheet(record, "sampled_sheet", sampled),
        trim=_trim(record.record("trim"), target) if record.holds("trim") and target is not None else None,
        variant=record.text("variant"),
        origin=one_of(Origin, record.text("origin")),
    )


def _confirmed(candidates: list[Candidate], target: Outline | None) -> tuple[Candidate, ...]:
    """The designs with scores that they have, whatever the file says."""
    if target is None:
        return tuple(candidates)
    deployments = [deploy(candidate.sheet) for candidate in candidates]
    scores = confirmed(deployments, [candidate.score for candidate in candidates], target)
    seconds = [
        None if candidate.second is None else confirmed_match(deployment, candidate.second)
        for candidate, deployment in zip(candidates, deployments, strict=True)
    ]
    return tuple(
        replace(candidate, score=score, second=second)
        for candidate, score, second in zip(candidates, scores, seconds, strict=True)
    )


def _trim(record: Record, target: Outline) -> Trim:
    sheet = sheet_of_json(record.entries, RatioField(_table(record.list("ratio"), "trim.ratio")))
    deep = record.holds("deep") and record.flag("deep")
    pose = _pose(record.record("pose"))
    return trim(deploy(sheet), target, record.number("phi"), pose, record.number("keep"), deep)


def _pose(record: Record) -> Similarity:
    return Similarity(record.number("scale"), record.number("angle"), record.pair("shift"))


def _score(record: Record, sheet: Sheet) -> Score:
    """Read back what :meth:`Score.to_json` wrote; the evenness of older files is measured."""
    contact = record.record("contact") if record.holds("contact") else None
    plain = _plain_fields(record, Score)
    check_phi(plain["phi"])
    return Score(
        **plain,
        contact=None if contact is None else Contact(contact.number("phi"), contact.pair("where")),
        transform=_pose(record.record("transform")),
        evenness=Evenness(**_plain_fields(record.record("evenness"), Evenness))
        if record.holds("evenness")
        else evenness(deploy(sheet)),
    )


def _runs(entries: list[object]) -> list[tuple[tuple[str, str], ...]]:
    """What designs were made with, one table for each run."""
    by_number = Record({str(number): entry for number, entry in enumerate(entries)}, f"{DESIGN}.runs")
    return [tuple(sorted(by_number.texts(str(number)).items())) for number in range(len(entries))]


def _run(record: Record, runs: list[tuple[tuple[str, str], ...]]) -> tuple[tuple[str, str], ...]:
    if not record.holds("run"):
        return ()
    number = record.whole("run")
    if not 0 <= number < len(runs):
        raise ProjectError("project.no_such_run", number=number, runs=len(runs))
    return runs[number]


def _label(entry: object, number: int) -> Label:
    record = Record(entry, f"{DESIGN}.labels[{number}]")
    return Label(record.verbatim("code"), record.verbatim("name"), record.verbatim("note"))


def _void(entry: object) -> Void:
    if not isinstance(entry, list) or len(entry) != 2:
        raise ProjectError("project.not_a_void", value=entry)
    void = Record(dict(zip(("row", "column"), entry, strict=True)), f"{DESIGN}.locked")
    return void.whole("row"), void.whole("column")


def _whole_pair(record: Record, name: str) -> tuple[int, int]:
    values = record.list(name)
    if len(values) != 2:
        raise ProjectError("json.not_two_whole_numbers", place=f"{DESIGN}.settings.{name}", value=values)
    both = Record(dict(zip(("rows", "columns"), values, strict=True)), f"{DESIGN}.settings.{name}")
    return both.whole("rows"), both.whole("columns")


def _table(rows: object, place: str) -> FloatArray:
    """A table of numbers from a list of lists."""
    try:
        return np.array(rows, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise ProjectError("json.not_a_table_of_numbers", place=f"{DESIGN}.{place}") from None


def _read_ratios(members: Members, name: str, count: int) -> list[RatioField]:
    """Read the (N, m, n) array; its header is checked against the bytes before any memory is asked for."""
    if count == 0:
        return []
    if name not in members:
        raise ProjectError("project.member_missing", name=name)
    content = members[name]
    stream = io.BytesIO(content)
    try:
        if np.lib.format.read_magic(stream) != (1, 0):
            raise ValueError("version of the NPY format")
        shape, fortran, dtype = np.lib.format.read_array_header_1_0(stream)
    except Exception as error:  # NumPy evaluates the header as Python text: it may raise a dozen kinds
        raise ProjectError("project.array_not_readable", name=name, reason=str(error)) from error
    if len(shape) != 3 or shape[0] != count or fortran or dtype != np.dtype("<f8"):
        raise ProjectError("project.array_of_wrong_shape", name=name, designs=count, shape=shape, dtype=str(dtype))
    size = 8 * int(shape[0]) * int(shape[1]) * int(shape[2])
    if len(content) - stream.tell() != size:
        raise ProjectError("project.array_of_wrong_size", name=name, bytes=size, found=len(content) - stream.tell())
    table = np.frombuffer(content, dtype="<f8", offset=stream.tell()).reshape(shape)
    return [RatioField(ratio) for ratio in table]
