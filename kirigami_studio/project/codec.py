"""Document <-> members of a project file: JSON for what a person may read, one array for the ratios."""

from __future__ import annotations

import io
import json

import numpy as np

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.feasibility import Contact
from kirigami_studio.evaluate.score import Score
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.lattice.deployment import check_phi
from kirigami_studio.lattice.ratio_field import FloatArray, RatioField
from kirigami_studio.project.document import Document
from kirigami_studio.project.json_record import Record, read_json
from kirigami_studio.project.migrations import Members
from kirigami_studio.project.settings import DesignSettings, FabricationSettings
from kirigami_studio.target.outline import Outline

DESIGN = "design.json"
RATIOS = "ratios.npy"


def encode(document: Document) -> dict[str, bytes]:
    """Return the members of the current format; equal documents give equal bytes."""
    design = {
        "target": None if document.target is None else _outline_json(document.target),
        "settings": {
            "grid": list(document.settings.grid),
            "phi": document.settings.phi,
            "k": document.settings.k,
            "seed": document.settings.seed,
            "variant": document.settings.variant,
            "steps": document.settings.steps,
            "polish": document.settings.polish,
        },
        "fabrication": {
            "width_mm": document.fabrication.width_mm,
            "material": document.fabrication.material,
            "connector_mm": document.fabrication.connector_mm,
            "kerf_mm": document.fabrication.kerf_mm,
        },
        "candidates": [
            {"seed": entry.seed, "index": entry.index, "polished": entry.polished, "score": entry.score.to_json()}
            for entry in document.candidates
        ],
        "chosen": document.chosen,
        "provenance": dict(sorted(document.provenance.items())),
    }
    members = {DESIGN: json.dumps(design, indent=1, allow_nan=False).encode()}
    if document.candidates:
        stream = io.BytesIO()
        stacked = np.stack([entry.field.ratio for entry in document.candidates]).astype("<f8")
        np.lib.format.write_array(stream, stacked, version=(1, 0), allow_pickle=False)
        members[RATIOS] = stream.getvalue()
    return members


def decode(members: Members) -> Document:
    """Rebuild the document.

    Raises
    ------
    KirigamiError
        A member is missing or holds what no document can hold; the sentence fits after "the project is damaged:".
    """
    if DESIGN not in members:
        raise ProjectError(f"it lacks {DESIGN}")
    design = Record(read_json(members[DESIGN], DESIGN), DESIGN)
    settings, fabrication = design.record("settings"), design.record("fabrication")
    entries = design.list("candidates")
    fields = _read_ratios(members, len(entries))
    rows, columns = _whole_pair(settings, "grid")
    return Document(
        target=_outline(design.record("target")) if design.holds("target") else None,
        settings=DesignSettings(
            grid=(rows, columns),
            phi=settings.number("phi"),
            k=settings.whole("k"),
            seed=settings.whole("seed"),
            variant=settings.text("variant"),
            steps=settings.whole("steps"),
            polish=settings.whole("polish"),
        ),
        candidates=tuple(
            _candidate(Record(entry, f"{DESIGN}.candidates[{k}]"), field)
            for k, (entry, field) in enumerate(zip(entries, fields, strict=True))
        ),
        chosen=design.whole("chosen") if design.holds("chosen") else None,
        fabrication=FabricationSettings(
            width_mm=fabrication.number("width_mm"),
            material=fabrication.text("material"),
            connector_mm=fabrication.number("connector_mm") if fabrication.holds("connector_mm") else None,
            kerf_mm=fabrication.number("kerf_mm") if fabrication.holds("kerf_mm") else None,
        ),
        provenance=design.texts("provenance"),
    )


def _outline_json(outline: Outline) -> dict[str, object]:
    return {
        "name": outline.name,
        "notes": list(outline.notes),
        "size": None if outline.size is None else list(outline.size),
        "unit": outline.unit,
        "points": outline.points.tolist(),
    }


def _outline(record: Record) -> Outline:
    notes = record.list("notes")
    return Outline(
        points=_table(record.list("points")),
        name=record.text("name"),
        notes=tuple(str(note) for note in notes),
        size=record.pair("size") if record.holds("size") else None,
        unit=record.text("unit"),
    )


def _table(rows: list[object]) -> FloatArray:
    """(L, 2) float from a list of pairs."""
    try:
        return np.array(rows, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise ProjectError(f"{DESIGN}.target.points is not a list of [x, y] pairs") from None


def _candidate(record: Record, field: RatioField) -> Candidate:
    return Candidate(
        field=field,
        score=_score(record.record("score")),
        seed=record.whole("seed"),
        index=record.whole("index"),
        polished=record.flag("polished"),
    )


def _score(record: Record) -> Score:
    """Read back what :meth:`Score.to_json` wrote."""
    contact = record.record("contact") if record.holds("contact") else None
    transform = record.record("transform")
    return Score(
        siou=record.number("siou"),
        siou_gain=record.number("siou_gain"),
        uniform_siou=record.number("uniform_siou"),
        iou_exact=record.number("iou_exact"),
        uniform_iou=record.number("uniform_iou"),
        tv=record.number("tv"),
        tv_log10=record.number("tv_log10"),
        feasible=record.flag("feasible"),
        n_invalid=record.whole("n_invalid"),
        overlap_ratio=record.number("overlap_ratio"),
        contact=None if contact is None else Contact(contact.number("phi"), contact.pair("where")),
        transform=Similarity(transform.number("scale"), transform.number("angle"), transform.pair("shift")),
        phi=check_phi(record.number("phi")),
    )


def _whole_pair(record: Record, name: str) -> tuple[int, int]:
    values = record.list(name)
    if len(values) != 2:
        raise ProjectError(f"{DESIGN}: {name} must be two whole numbers, got {len(values)}")
    both = Record(dict(zip(("rows", "columns"), values, strict=True)), f"{DESIGN}.{name}")
    return both.whole("rows"), both.whole("columns")


def _read_ratios(members: Members, count: int) -> list[RatioField]:
    """Read the (N, m, n) array; its header is checked against the bytes before any memory is asked for."""
    if count == 0:
        return []
    if RATIOS not in members:
        raise ProjectError(f"it lacks {RATIOS}")
    content = members[RATIOS]
    stream = io.BytesIO(content)
    try:
        if np.lib.format.read_magic(stream) != (1, 0):
            raise ValueError("another npy version")
        shape, fortran, dtype = np.lib.format.read_array_header_1_0(stream)
    except (ValueError, SyntaxError, TypeError, KeyError, RecursionError, MemoryError) as error:
        raise ProjectError(f"{RATIOS} is not an array file ({str(error)[:80]})") from error
    if len(shape) != 3 or shape[0] != count or fortran or dtype != np.dtype("<f8"):
        raise ProjectError(f"{RATIOS} must hold {count} tables of numbers, got an array {shape} of {dtype}")
    size = 8 * int(shape[0]) * int(shape[1]) * int(shape[2])
    if len(content) - stream.tell() != size:
        raise ProjectError(f"{RATIOS} should hold {size} bytes of ratios, got {len(content) - stream.tell()}")
    table = np.frombuffer(content, dtype="<f8", offset=stream.tell()).reshape(shape)
    return [RatioField(ratio) for ratio in table]
