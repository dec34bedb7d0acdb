"""The match of a design on pins is that of its pieces, in every face; that of its lattice stays in its score."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from kirigami_studio.api.design import Design
from kirigami_studio.cli.design import candidate_json
from kirigami_studio.evaluate.trimming import Trim
from kirigami_studio.export.share_page import write_page
from kirigami_studio.project.document import Document
from kirigami_studio.studio.assembling import Assembled, assembled
from kirigami_studio.studio.designing import ranking_of
from kirigami_studio.studio.making import CutRequest, picture_job
from kirigami_studio.studio.two_states import TwoStates, shown_flat_match, shown_match
from kirigami_studio.studio.verdict import judge_assembled, look_at
from tests.pinned_assemblies import plain_pinwheel


@pytest.fixture(scope="module")
def pinwheel() -> Document:
    return plain_pinwheel()


@pytest.fixture(scope="module")
def made(pinwheel: Document) -> Assembled:
    assert pinwheel.candidate is not None and pinwheel.target is not None
    return assembled(pinwheel.candidate, pinwheel.fabrication, pinwheel.target)


def test_that_command_line_api_and_verdict_tell_the_match_of_the_pieces(pinwheel: Document, made: Assembled) -> None:
    candidate, match = pinwheel.candidates[0], made.report.figures.match
    assert match > candidate.match + 0.01
    told = candidate_json(candidate, ranking_of(pinwheel), made.as_cut)
    assert (told["match"], told["iou_exact"]) == (match, candidate.score.iou_exact)
    assert candidate_json(candidate, ranking_of(pinwheel))["match"] == candidate.match
    design = Design(pinwheel)
    assert (design.match, design.iou) == (match, candidate.match) and f"IoU {match:.3f}" in design._repr_svg_()
    assert "lattice IoU" in repr(design)
    assert judge_assembled(candidate, made, pinwheel.fabrication).match == match


def test_that_both_ends_of_the_slider_and_the_page_to_share_tell_it(
    pinwheel: Document, made: Assembled, tmp_path: Path
) -> None:
    candidate, target, figures = pinwheel.candidates[0], pinwheel.target, made.report.figures
    job = picture_job(CutRequest.of(pinwheel))
    assert target is not None
    states = TwoStates.of(candidate, job.posed, target, 160.0, made.as_cut)
    assert (states.start.match, states.target.match) == (figures.flat_match, figures.match)
    assert shown_flat_match(candidate, None) == TwoStates.of(candidate, job.posed, target, 160.0).start.match
    write_page(job, tmp_path / "design.html")
    assert f"Match {100 * figures.match:.1f} %" in (tmp_path / "design.html").read_text(encoding="utf-8")


def test_that_the_ranking_counts_the_pieces_of_a_trimmed_design_once(pinwheel: Document, made: Assembled) -> None:
    candidate = pinwheel.candidates[0]
    trim = Trim(candidate.sheet, 0.0, candidate.final_pose, 0.1, True, (None,) * 16, 0.97, candidate.match, 0.1)
    trimmed = replace(candidate, trim=trim)
    for one in (candidate, trimmed):
        found = look_at(one, pinwheel.fabrication, pinwheel.target)
        ranking = replace(ranking_of(pinwheel), losses={one: found.loss})
        assert ranking.made_match(one) == pytest.approx(shown_match(one, found.as_cut), abs=1e-12)
