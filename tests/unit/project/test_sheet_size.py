"""The size of the opened shape and the flat width that follows it, against sheets that are really opened."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines import silhouettes
from kirigami_studio.pipeline.events import Result
from kirigami_studio.pipeline.request import Request
from kirigami_studio.project import edits
from kirigami_studio.project.document import Document
from kirigami_studio.project.sheet_size import cut_for, flat_width, set_opened_size, size_of, sized
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.studio.designing import KnownAsCut, ranking_of
from tests.refusals import refused


def designed(phi: float = 0.0, count: int = 2) -> Document:
    target, draw = silhouettes.load("heart"), np.random.default_rng(5)
    sheets = [Sheet(RatioField.from_log10(0.1 * draw.normal(size=(4, 5)))) for _ in range(count)]
    found = [
        Candidate(sheet, evaluate(deploy(sheet), target, phi), seed=1, index=index)
        for index, sheet in enumerate(sheets)
    ]
    return edits.set_candidates(edits.set_target(Document(), target).document, found, {}).document


@pytest.mark.parametrize("phi", [0.0, 0.7])
def test_that_the_flat_width_opens_to_the_size_that_was_asked_for(phi: float) -> None:
    document = set_opened_size(designed(phi), 80.0).document
    size = size_of(document)
    assert size is not None and max(size.opened) == pytest.approx(80.0) and size.agrees
    candidate = document.candidate
    assert candidate is not None and document.target is not None
    deployment = deploy(candidate.sheet)
    per_cell = document.fabrication.width_mm / np.ptp(deployment.compact[:, 0])
    opened = candidate.score.transform.apply(deployment.nodes(phi))  # in the target's frame
    per_unit = 80.0 / np.ptp(document.target.points, axis=0).max()
    flat_edge = np.linalg.norm(deployment.nodes(phi)[1] - deployment.nodes(phi)[0]) * per_cell
    assert np.linalg.norm(opened[1] - opened[0]) * per_unit == pytest.approx(flat_edge)


def test_that_another_design_has_a_width_of_its_own_and_a_typed_width_stays() -> None:
    document = set_opened_size(designed(), 80.0).document
    other = sized(edits.choose(document, 1).document)
    assert other.fabrication.width_mm != document.fabrication.width_mm
    assert cut_for(document, document.candidates[1]).width_mm == other.fabrication.width_mm
    typed = edits.set_fabrication(other, width_mm=60.0).document
    assert sized(typed) is typed and sized(edits.choose(typed, 0).document).fabrication.width_mm == 60.0


def test_that_findings_of_a_run_hold_for_designs_of_other_widths_that_open_to_one_size() -> None:
    document = set_opened_size(designed(), 80.0).document
    jams = {document.candidates[1]: Note.of("as_cut.nearly", jam_deg=10.0, phi_deg=0.0)}
    assert document.target is not None
    result = Result(Request(document.target), document.candidates, 2, 1.0, refusals=jams)
    known = KnownAsCut.of(result, document.fabrication)
    other = sized(edits.choose(document, 1).document)
    assert other.fabrication.width_mm != document.fabrication.width_mm
    assert ranking_of(other, known).refusals == jams
    typed = edits.set_fabrication(other, width_mm=60.0).document
    assert not ranking_of(typed, known).refusals, "another size, of which nothing was found"


@pytest.mark.parametrize("phi", [0.0, 0.5, 1.2, 2.4])
def test_that_the_width_expected_before_a_run_is_that_of_the_uniform_sheet(phi: float) -> None:
    target = silhouettes.load("square")
    deployment = deploy(RatioField.uniform(6, 9))
    # Nodes at the angle, all of them: between panels the voids are open, and count as far as they lie inside.
    hull = shapely.convex_hull(shapely.MultiPoint(deployment.nodes(phi)))
    unit = 1.0 / math.sqrt(hull.area)
    settings = DesignSettings(grid=(6, 9), phi=phi)
    expected = flat_width(target, settings, None)
    assert expected == pytest.approx(np.ptp(deployment.compact[:, 0]) * unit, rel=0.08)


def test_that_a_target_drawn_in_mm_brings_its_size_and_a_picture_does_not() -> None:
    heart = silhouettes.load("heart")
    drawn = replace(heart, size=(60.0, 54.0), unit="mm")
    assert edits.set_target(Document(), drawn).document.fabrication.opened_mm == 60.0
    assert edits.set_target(Document(), replace(drawn, unit="px")).document.fabrication.opened_mm is None
    moved = edits.set_fabrication(edits.set_target(Document(), drawn).document, width_mm=90.0).document
    again = edits.edit_target(moved, replace(drawn, place=(3.0, 4.0)), "Move target").document
    assert again.fabrication.opened_mm is None  # of the same size: what was typed stays
    larger = edits.edit_target(moved, replace(drawn, size=(70.0, 63.0)), "Resize target").document
    assert larger.fabrication.opened_mm == 70.0


@pytest.mark.parametrize("size", [0.0, -1.0, math.nan, math.inf, 1e9])
def test_that_an_impossible_size_is_refused_with_its_number(size: float) -> None:
    with refused(UsageError, "settings.opened_size"):
        set_opened_size(designed(count=1), size)
