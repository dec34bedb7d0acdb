"""Where designs come from: the provenance of one or several runs, and the facts that every export states."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import replace

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.project.document import Document

#: What joins the values of several runs in one provenance.
BETWEEN_RUNS = "; "
#: What may separate them: several models of one run are joined by commas.
SEPARATOR = re.compile(r"[,;]\s*")
#: Entries of a provenance that apply only to designs that were sampled near another one.
OF_RESAMPLED = ("near", "nearness")


def joined_provenance(before: Mapping[str, str], after: Mapping[str, str]) -> dict[str, str]:
    """The provenance of several runs together: where they differ, each value once, in the order of the runs."""
    known = dict(before)
    for name, value in after.items():
        values = [part for part in known.get(name, "").split(BETWEEN_RUNS) if part]
        known[name] = BETWEEN_RUNS.join(dict.fromkeys([*values, *value.split(BETWEEN_RUNS)]))
    return known


def with_run(candidates: Iterable[Candidate], provenance: Mapping[str, str]) -> list[Candidate]:
    """The designs with the settings of their run; designs that have settings already keep them."""
    run = tuple(sorted(provenance.items()))
    return [one if one.made_with or not run else replace(one, made_with=run) for one in candidates]


def design_facts(document: Document, candidate: Candidate) -> dict[str, str]:
    """All that is needed to make the design again, name to text.

    The settings are those of the candidate's own run.  Where that is not known, the provenance of the whole document
    stands in, except that the model and its hash are the candidate's own: a hash that is not known is left out rather
    than taken from another model, and a design that was not sampled near another one names none.
    """
    facts = _run_of(document, candidate)
    models, digests = (_parts(facts.pop(name, "")) for name in ("model", "model_sha256"))
    if candidate.origin in (Origin.SAMPLED, Origin.SEARCHED):
        facts = {name: text for name, text in facts.items() if name not in OF_RESAMPLED}
    variant = candidate.variant or (models[0] if len(models) == 1 else "")
    by_model = dict(zip(models, digests, strict=True)) if len(models) == len(digests) else {}
    if variant:
        facts["model"] = variant
    if variant in by_model:
        facts["model_sha256"] = by_model[variant]
    (rows, columns), cut = candidate.sheet.grid, candidate.final_sheet
    trim, label = candidate.trim, document.label_of(candidate)
    return facts | {
        "seed": str(candidate.seed),
        "sample": str(candidate.index),
        "origin": candidate.origin.value,
        "polished": "yes" if candidate.polished else "no",
        "trimmed": "no" if trim is None else "yes",
        "grid": f"{rows} x {columns}",
        **({} if cut.is_default else {"sheet": _differences(cut)}),
        "phi_degrees": f"{math.degrees(candidate.score.phi):g}",
        **({} if document.target is None else {"target": document.target.name}),
        **({} if label is None else {"name": label.text}),
    }


def _differences(sheet: Sheet) -> str:
    """What a sheet has that the paper's has not; the numbers are in the project and in the record beside a cut file."""
    found = [] if sheet.has_even_rim else ["uneven rim"]
    if sheet.start is not None:
        found.append(f"start outline of {len(sheet.start)} points")
    width, height = sheet.cell
    if (width, height) != (1.0, 1.0):
        found.append(f"cell {width:g} x {height:g}")
    return ", ".join(found)


def _run_of(document: Document, candidate: Candidate) -> dict[str, str]:
    """The settings of a candidate's run; a candidate without them is looked up in the document."""
    known = candidate.made_with or next((one.made_with for one in document.candidates if one == candidate), ())
    return dict(known or document.provenance)


def _parts(text: str) -> list[str]:
    return [part for part in SEPARATOR.split(text) if part]
