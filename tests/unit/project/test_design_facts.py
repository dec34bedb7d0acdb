"""What is said of a design is what made this one, not what made its neighbours."""

from __future__ import annotations

from dataclasses import replace

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.project.design_facts import design_facts
from kirigami_studio.project.document import Document


def test_that_a_candidate_tells_its_own_model_seed_and_origin(document: Document) -> None:
    known = {"application": "kirigami-studio 1", "model": "balanced; calm", "model_sha256": "aa; bb", "polish": "15"}
    first, second = document.candidates[:2]
    mixed = (
        replace(first, variant="calm", seed=9, index=3, origin=Origin.RESAMPLED),
        replace(second, variant="accuracy", origin=Origin.EDITED),
        *document.candidates[2:],
    )
    several = replace(document, candidates=mixed, provenance=known)
    facts = design_facts(several, mixed[0])
    rows, columns = first.field.ratio.shape
    assert facts["model"] == "calm" and facts["model_sha256"] == "bb" and facts["origin"] == "resampled"
    assert (facts["seed"], facts["sample"], facts["grid"]) == ("9", "3", f"{rows} x {columns}")
    assert facts["polish"] == "15" and facts["trimmed"] == "no"
    stranger = design_facts(several, mixed[1])
    assert stranger["model"] == "accuracy" and stranger["origin"] == "edited"
    assert "model_sha256" not in stranger, "a hash of another model would be a lie"


def test_that_the_only_model_of_a_project_is_that_of_a_candidate_which_does_not_know(
    document: Document, candidates: tuple[Candidate, ...]
) -> None:
    known = {"model": "balanced", "model_sha256": "aa"}
    silent = replace(candidates[0], variant="")
    facts = design_facts(replace(document, candidates=(silent,), chosen=0, marks=(), provenance=known), silent)
    assert (facts["model"], facts["model_sha256"]) == ("balanced", "aa")


def test_that_only_a_design_drawn_near_another_one_names_that_one(document: Document) -> None:
    first, second = document.candidates[:2]
    both = (replace(first, origin=Origin.RESAMPLED), replace(second, origin=Origin.SAMPLED), *document.candidates[2:])
    joined = replace(document, candidates=both, provenance={"near": "5e5e", "nearness": "0.6"})
    near, free = design_facts(joined, both[0]), design_facts(joined, both[1])
    assert (near["near"], near["nearness"]) == ("5e5e", "0.6")
    assert "near" not in free and "nearness" not in free
