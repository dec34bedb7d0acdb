"""A document cannot hold what makes no sense."""

from __future__ import annotations

import math
from dataclasses import FrozenInstanceError, replace

import pytest

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.errors import KirigamiError, ProjectError
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.project.document import Document
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings
from tests.refusals import refused


def test_that_a_new_document_is_empty_and_ready_for_a_first_run() -> None:
    document = Document()
    assert document.target is None
    assert document.candidate is None
    assert document.settings.grid == (10, 10)


def test_that_a_document_cannot_be_changed_in_place(document: Document) -> None:
    with pytest.raises(FrozenInstanceError):
        document.chosen = 0  # type: ignore[misc]
    with pytest.raises(TypeError):
        document.provenance["model"] = "other"  # type: ignore[index]


def test_that_the_chosen_candidate_is_the_one_at_its_index(document: Document) -> None:
    assert document.candidate == document.candidates[1]


@pytest.mark.parametrize("chosen", [3, -1, "1"])
def test_that_a_choice_beyond_the_candidates_is_refused(document: Document, chosen: object) -> None:
    with refused(ProjectError, "project.no_such_design", designs=3):
        replace(document, chosen=chosen)


def test_that_candidates_of_two_grids_are_refused(document: Document) -> None:
    stranger: Candidate = replace(document.candidates[0], sheet=Sheet.uniform(6, 7))
    with refused(ProjectError, "project.grids_differ", columns=5, other_columns=7, other_rows=6, rows=4):
        replace(document, candidates=(*document.candidates, stranger))


def test_that_candidates_need_their_target(document: Document) -> None:
    with refused(ProjectError, "project.designs_without_target"):
        replace(document, target=None)


@pytest.mark.parametrize(
    "changes",
    [
        {"grid": (1, 10)},
        {"grid": (10, 65)},
        {"grid": (10,)},
        {"grid": (10.0, 10)},
        {"phi": math.pi},
        {"phi": -0.1},
        {"phi": math.nan},
        {"phi": "0"},
        {"k": 0},
        {"k": 2.5},
        {"k": True},
        {"seed": -1},
        {"steps": 0},
        {"polish": -1},
        {"variant": ""},
    ],
)
def test_that_impossible_search_settings_are_refused_in_a_sentence(changes: dict[str, object]) -> None:
    with pytest.raises(KirigamiError) as caught:
        DesignSettings(**changes)  # type: ignore[arg-type]
    assert str(caught.value).endswith((".", "choice."))


@pytest.mark.parametrize(
    "changes",
    [
        {"width_mm": 0.0},
        {"width_mm": math.inf},
        {"width_mm": None},
        {"material": ""},
        {"connector_mm": 0.0},
        {"connector_mm": math.nan},
        {"kerf_mm": -0.01},
        {"kerf_mm": "thin"},
    ],
)
def test_that_impossible_fabrication_settings_are_refused_in_a_sentence(changes: dict[str, object]) -> None:
    with pytest.raises(KirigamiError, match=r"got .*\.$"):
        FabricationSettings(**changes)  # type: ignore[arg-type]


def test_that_a_kerf_of_zero_is_a_blade() -> None:
    assert FabricationSettings(kerf_mm=0.0).kerf_mm == 0.0
