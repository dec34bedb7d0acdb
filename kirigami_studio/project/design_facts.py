"""Where one design comes from, as every export of it says: its own variant, seed and origin, and the run's settings."""

from __future__ import annotations

import math
import re

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.project.document import Document

#: What stands between the values of several runs in one project.
BETWEEN = re.compile(r"[,;]\s*")
#: What a run knows only of designs that were drawn near another one.
OF_RESAMPLED = ("near", "nearness")


def design_facts(document: Document, candidate: Candidate) -> dict[str, str]:
    """Name to text, all that is needed to make the design again.

    The settings are those of the run that drew the candidate.  Of designs out of projects before format 5 they are not
    known: then what the project knows of its run or runs is repeated, except that the model and its hash are those
    that this candidate was drawn with; a hash that the project does not know is left out rather than taken from
    another model, and a design that was not drawn near another one names none.
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
    rows, columns = candidate.field.rows, candidate.field.columns
    trim = candidate.trim
    return facts | {
        "seed": str(candidate.seed),
        "sample": str(candidate.index),
        "origin": candidate.origin.value,
        "polished": "yes" if candidate.polished else "no",
        "trimmed": "no" if trim is None else "yes",
        "grid": f"{rows} x {columns}",
        "phi_degrees": f"{math.degrees(candidate.score.phi):g}",
        **({} if document.target is None else {"target": document.target.name}),
    }


def _run_of(document: Document, candidate: Candidate) -> dict[str, str]:
    """The settings of a candidate's run; one that has not heard of them yet is asked for in the document."""
    known = candidate.made_with or next((one.made_with for one in document.candidates if one == candidate), ())
    return dict(known or document.provenance)


def _parts(text: str) -> list[str]:
    return [part for part in BETWEEN.split(text) if part]
