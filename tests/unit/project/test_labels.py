"""Designs keep their names, whatever becomes of them, their ranks and their project."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.foundation.resources import resource
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.project import edits, store
from kirigami_studio.project.candidate_edits import (
    NewDesigns,
    add_candidates,
    rank_again,
    renew_candidates,
    replace_candidates,
    set_label,
)
from kirigami_studio.project.design_facts import design_facts
from kirigami_studio.project.document import Document, Mark
from kirigami_studio.project.labels import LONGEST_NAME, LONGEST_NOTE, Label, file_ending, letters_of, run_labels
from tests.refusals import refused


def codes(document: Document) -> list[str]:
    return [label.code for label in document.labels]


def by_sheet(document: Document) -> dict[object, str]:
    return {one.sheet: label.text for one, label in zip(document.candidates, document.labels, strict=True)}


@pytest.fixture
def others(candidates: tuple[Candidate, ...]) -> tuple[Candidate, ...]:
    """Two other designs of the same grid."""
    return tuple(replace(one, seed=99, sheet=Sheet(RatioField(1.1 * one.sheet.field.ratio))) for one in candidates[:2])


@pytest.fixture
def rank() -> Callable[[Candidate], float]:
    return lambda one: -one.score.siou


def test_that_runs_are_lettered_like_columns_of_a_table() -> None:
    assert [letters_of(run) for run in (0, 1, 25, 26, 27, 51, 52, 701, 702)] == [
        "A", "B", "Z", "AA", "AB", "AZ", "BA", "ZZ", "AAA",
    ]  # fmt: skip


def test_that_designs_of_the_first_run_are_called_a1_a2_a3(document: Document) -> None:
    assert codes(document) == ["A1", "A2", "A3"] and document.runs == 1


def test_that_a_further_run_begins_with_another_letter_and_leaves_names_alone(
    document: Document, others: tuple[Candidate, ...], rank: Callable[[Candidate], float]
) -> None:
    before = by_sheet(document)
    joined = add_candidates(document, NewDesigns(others, {}), rank).document
    assert joined.runs == 2 and {sheet: name for sheet, name in by_sheet(joined).items() if sheet in before} == before
    fresh = [label.code for one, label in zip(joined.candidates, joined.labels, strict=True) if one.seed == 99]
    assert fresh == ["B1", "B2"], "the better one comes first"
    assert add_candidates(joined, NewDesigns(others, {}), rank).document.runs == 2, "nothing was new"


def test_that_generating_again_goes_on_with_the_letters_and_pinned_designs_keep_their_names(
    document: Document, others: tuple[Candidate, ...], rank: Callable[[Candidate], float]
) -> None:
    pinned = replace(document, marks=(Mark.NONE, Mark.PINNED, Mark.NONE))
    renewed = renew_candidates(pinned, NewDesigns(others, {}), rank).document
    assert by_sheet(renewed)[document.candidates[1].sheet] == "A2"
    assert sorted(codes(renewed)) == ["A2", "B1", "B2"] and renewed.runs == 2
    elsewhere = edits.set_target(renewed, replace(renewed.target, name="other")).document  # type: ignore[type-var]
    assert elsewhere.labels == () and elsewhere.runs == 2, "a name on a cut file means one design of the project"
    assert codes(edits.set_candidates(elsewhere, others, {}).document) == ["C1", "C2"]


def test_that_names_stay_when_ranks_change_and_designs_are_fitted_trimmed_or_edited(document: Document) -> None:
    before = by_sheet(document)
    turned = rank_again(document, 0.9, lambda one: -one.score.siou, "test").document
    assert turned.candidates == document.candidates[::-1] and by_sheet(turned) == before
    better = replace(document.candidates[2], polished=True, seed=5)
    fitted = edits.take_changed(document, document.candidates[2], better, "Fit")
    assert fitted is not None and fitted.document.labels == document.labels
    again = replace_candidates(document, {document.candidates[2]: better}, lambda one: -one.seed, "test").document
    assert again.label_of(better) == document.labels[2]
    assert edits.choose(turned, 0).label == "Choose design A3"


def test_that_a_name_and_a_note_are_one_named_edit_that_a_file_keeps(document: Document, tmp_path: Path) -> None:
    renamed = set_label(document, 1, "  Wide\theart ", "For the fair.\r\nCut on Monday.  ")
    assert renamed.label == "Rename design A2"
    assert renamed.document.labels[1] == Label("A2", "Wide heart", "For the fair.\nCut on Monday.")
    noted = set_label(renamed.document, 1, "Wide heart", "Sold")
    assert noted.label == "Note on design Wide heart"
    store.save(noted.document, tmp_path / "named.kiri")
    opened = store.load(tmp_path / "named.kiri")
    assert opened == noted.document and opened.labels[1].note == "Sold"
    assert design_facts(opened, opened.candidates[1])["name"] == "Wide heart"
    assert edits.choose(opened, 1).label == "Choose design Wide heart"
    plain = set_label(opened, 1, "", "").document
    assert plain.labels[1] == Label("A2") and set_label(opened, 1, "A2", "").document == plain


@pytest.mark.parametrize("name", ["A1", "a3", "Wide Heart"])
def test_that_no_two_designs_have_one_name(document: Document, name: str) -> None:
    named = set_label(document, 0, "wide heart", "").document
    with refused(ProjectError, "labels.taken") as caught:
        set_label(named, 1, name, "")
    assert caught.value.code == "labels.taken"


def test_that_a_run_leaves_out_a_name_that_a_person_has_given_before_it(
    document: Document, others: tuple[Candidate, ...], rank: Callable[[Candidate], float]
) -> None:
    named = set_label(document, 0, "B1", "").document
    joined = add_candidates(named, NewDesigns(others, {}), rank).document
    assert sorted(label.text for label in joined.labels) == ["A2", "A3", "B1", "B2", "B3"]


@pytest.mark.parametrize(
    ("name", "note", "code"),
    [
        ("n" * (LONGEST_NAME + 1), "", "labels.name_too_long"),
        ("", "n" * (LONGEST_NOTE + 1), "labels.note_too_long"),
        ("\x00", "", "labels.not_printable"),
    ],
)
def test_that_a_label_that_cannot_be_shown_is_refused_in_a_sentence(name: str, note: str, code: str) -> None:
    with pytest.raises(ProjectError) as caught:
        Label("A1", name, note)
    assert caught.value.code == code and len(str(caught.value)) < 200


@pytest.mark.parametrize("code", ["", "a1", "A0", "1A", "A", None, "A1; DROP"])
def test_that_only_letters_and_a_number_are_a_code(code: str) -> None:
    with refused(ProjectError, "labels.not_a_code"):
        Label(code)


def test_that_fewer_names_than_designs_are_refused(document: Document) -> None:
    with refused(ProjectError, "project.labels_do_not_match", designs=3, labels=2):
        replace(document, labels=run_labels(0, 2))


def test_that_a_project_of_format_2_opens_with_names() -> None:
    opened = store.load(resource("examples", "heart.kiri"))
    count = len(opened.candidates)
    assert count > 1 and codes(opened) == [f"A{number}" for number in range(1, count + 1)] and opened.runs == 1


@pytest.mark.parametrize(
    ("name", "ending"),
    [("", "A1"), ("Wide heart", "Wide-heart"), ("a/b\\c:d", "a-b-c-d"), ("...", "A1"), ("Größe 3", "Größe-3")],
)
def test_that_the_name_of_a_file_takes_what_every_system_can_hold(name: str, ending: str) -> None:
    assert file_ending(Label("A1", name)) == ending
