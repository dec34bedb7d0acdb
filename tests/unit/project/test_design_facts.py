"""What is said of a design is what made this one, not what made its neighbours."""

from __future__ import annotations

from dataclasses import replace

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.project.candidate_edits import NewDesigns, add_candidates, renew_candidates
from kirigami_studio.project.design_facts import design_facts
from kirigami_studio.project.document import Document, Mark
from kirigami_studio.project.edits import replace_candidate, take_changed


def larger(candidate: Candidate, factor: float) -> Sheet:
    """The candidate's sheet with all ratios times a factor."""
    return candidate.sheet.with_field(RatioField(candidate.sheet.field.ratio * factor))


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
    rows, columns = first.sheet.grid
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
    facts = design_facts(
        replace(document, candidates=(silent,), chosen=0, marks=(), labels=(), provenance=known), silent
    )
    assert (facts["model"], facts["model_sha256"]) == ("balanced", "aa")


def test_that_only_a_design_drawn_near_another_one_names_that_one(document: Document) -> None:
    first, second = document.candidates[:2]
    both = (replace(first, origin=Origin.RESAMPLED), replace(second, origin=Origin.SAMPLED), *document.candidates[2:])
    joined = replace(document, candidates=both, provenance={"near": "5e5e", "nearness": "0.6"})
    near, free = design_facts(joined, both[0]), design_facts(joined, both[1])
    assert (near["near"], near["nearness"]) == ("5e5e", "0.6")
    assert "near" not in free and "nearness" not in free


def test_that_designs_of_several_runs_tell_the_settings_of_their_own(document: Document) -> None:
    first = {"model": "prior", "model_sha256": "aa", "k": "3", "polish": "0", "steps": "8"}
    second = {"model": "balanced", "model_sha256": "bb", "k": "8", "polish": "3", "steps": "4", "prefer": "calm"}
    start = replace(document, provenance=first, marks=())
    best = start.candidates[0]
    new = replace(best, sheet=larger(best, 1.01), seed=77, variant="balanced")
    both = add_candidates(start, NewDesigns((new,), second), lambda one: -one.score.siou).document
    assert both.provenance["polish"] == "0; 3"
    for one in both.candidates:
        facts, run = design_facts(both, one), second if one == new else first
        assert {name: facts.get(name) for name in second} == {name: run.get(name) for name in second}
    assert design_facts(both, new)["k"] == "8", "a design that has not been told is looked up"
    third = add_candidates(
        both,
        NewDesigns((replace(new, seed=78, sheet=larger(best, 1.02)),), first),
        lambda one: 0,
    )
    assert design_facts(third.document, new)["polish"] == "3"


def test_that_changed_and_pinned_designs_keep_the_settings_of_their_run(document: Document) -> None:
    first, second = {"model": "prior", "polish": "0"}, {"model": "balanced", "polish": "3", "prefer": "calm"}
    best = document.candidates[0]
    start = replace(document, provenance=first, marks=(Mark.PINNED, Mark.NONE, Mark.NONE))
    new = replace(best, sheet=larger(best, 1.01), seed=77)
    renewed = renew_candidates(start, NewDesigns((new,), second), lambda one: -one.score.siou).document
    assert {design_facts(renewed, one)["polish"] for one in renewed.candidates} == {"0", "3"}
    edited = replace(best, sheet=larger(best, 1.02), origin=Origin.EDITED)
    changed = take_changed(renewed, best, edited, "Change by hand")
    assert changed is not None and design_facts(changed.document, edited)["polish"] == "0"
    place = changed.document.candidates.index(new)
    trimmed = replace_candidate(changed.document, place, replace(new, polished=True), "Fit again").document
    assert design_facts(trimmed, trimmed.candidates[place])["prefer"] == "calm"
