"""Fixes are changes that were tried on the design itself: with them, the verdict is better."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Document
from kirigami_studio.project.history import History
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio import fixes
from kirigami_studio.studio.fixes import Advice, find_fixes
from kirigami_studio.studio.verdict import Level, Verdict, assess, refused

FILM = FabricationSettings(connector_mm=0.4)
STRAIGHT = replace(FILM, options=CutOptions(style=ConnectorStyle.STRAIGHT))


@pytest.fixture(scope="module")
def motion() -> Deployment:
    return deploy(RatioField.from_log10(np.random.default_rng(0).uniform(-0.5, 0.5, (4, 4))))


@pytest.fixture(scope="module")
def target(motion: Deployment) -> Outline:
    return Outline.from_points(motion.outline(0.0), "own")


@pytest.fixture(scope="module")
def design(motion: Deployment, target: Outline) -> Candidate:
    return Candidate(motion.sheet, evaluate(motion, target, 0.0), seed=0, index=0)


@cache
def verdict_on(design: Candidate, settings: FabricationSettings) -> Verdict:
    """Judged once: tests ask for the same verdict several times."""
    try:
        return assess(design, settings).verdict
    except KirigamiError as error:
        return refused(error)


def ended(search: Generator[None, None, Advice]) -> Advice:
    while True:
        try:
            next(search)
        except StopIteration as end:
            found: Advice = end.value
            return found


def advice(design: Candidate, settings: FabricationSettings, others: Sequence[Candidate] = ()) -> Advice:
    named = {f"A{number}": one for number, one in enumerate(others, start=1)}
    found = ended(find_fixes(design, settings, verdict_on(design, settings), named))
    for fix in found.fixes:
        again = verdict_on(fix.candidate, fix.settings)
        assert again == fix.verdict and again.better_than(verdict_on(design, settings)), fix.change.text
    return found


def test_that_a_sheet_which_jams_on_straight_connectors_is_told_to_centre_them(design: Candidate) -> None:
    found = advice(design, STRAIGHT)
    first = found.fixes[0]
    assert first.change.text == "Use centred connectors." and first.verdict.ok
    assert first.settings == FILM
    assert found.lines[0] == "Use centred connectors. Then: Ready to cut."
    assert first.to_json()["style"] == "centred" and first.to_json()["level"] == "ready_to_cut"


def test_that_a_connector_which_breaks_is_told_one_that_holds_with_its_strain(design: Candidate) -> None:
    thin = FabricationSettings(connector_mm=0.08)
    assert "as_cut.breaks" in [problem.code for problem in verdict_on(design, thin).problems]
    found = advice(design, thin)
    assert found.fixes[0].verdict.ok
    assert all(fix.change.code == "fix.strain" and fix.as_cut.strain <= 0.45 for fix in found.fixes)
    wider = [fix for fix in found.fixes if fix.settings.connector_mm != 0.08]
    assert wider and wider[0].change.text == f"Use connectors of 0.2 mm: strain {100 * wider[0].as_cut.strain:.1f} %."


def test_that_a_sheet_with_small_panels_is_told_the_width_that_serves(design: Candidate) -> None:
    thick = replace(find_material("tpu-co2"), key="thick-tpu", min_panel_mm=8.0)
    small = FabricationSettings(material=thick.key, own=thick, width_mm=80.0, connector_mm=0.5)
    found = advice(design, small)
    first = found.fixes[0]
    assert first.change.code == "fix.width" and first.verdict.ok and first.settings.own == thick
    assert 80.0 < first.settings.width_mm < 200.0
    assert first.change.text == f"Make it {first.settings.width_mm:.1f} mm wide."
    narrower = replace(small, width_mm=first.settings.width_mm - 0.2)
    assert not verdict_on(design, narrower).ok  # it is no wider than it has to be


def test_that_cuts_without_room_are_told_what_has_room(design: Candidate) -> None:
    crowded = replace(FILM, connector_mm=14.0)
    assert verdict_on(design, crowded).problems[0].code in ("slit.no_room", "edge_cut.no_room")
    assert advice(design, crowded).fixes[0].verdict.ok


def test_that_removed_connectors_are_put_back_first(design: Candidate) -> None:
    apart = replace(FILM, options=replace(FILM.options, removed=tuple(range(100))))
    assert verdict_on(design, apart).level is Level.FAILS
    found = advice(design, apart)
    assert found.fixes[0].change.text == "Put the removed connectors back." and found.fixes[0].settings == FILM


def test_that_a_material_that_cannot_is_told_one_that_can(design: Candidate) -> None:
    found = advice(design, FabricationSettings(material="acrylic-co2"))
    assert (
        found.fixes[0].verdict.ok and found.fixes[0].change.text == "Cut Polyimide film 50 \N{MICRO SIGN}m, UV laser."
    )
    assert sum(fix.settings.material != "acrylic-co2" for fix in found.fixes) <= 2


def test_that_it_is_said_plainly_where_nothing_works_and_what_was_tried(
    design: Candidate, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fixes, "_other_materials", lambda *_: iter(()))
    brittle = replace(find_material("acrylic-co2"), key="glass", bed_width_mm=0.0, bed_height_mm=0.0)
    found = advice(design, FabricationSettings(material="glass", own=brittle, width_mm=300.0))
    assert found.fixes == () and len(found.lines) == 1
    assert found.lines[0].startswith("Nothing that was tried works: ") and "300 to 900 mm wide" in found.lines[0]
    assert found.tried.fields["styles"] == 6 and int(str(found.tried.fields["count"])) > 20


def test_that_another_design_is_offered_and_chosen_in_one_step(design: Candidate, target: Outline) -> None:
    crossed = replace(design, score=replace(design.score, feasible=False), index=1)
    document = Document(target, DesignSettings((4, 4)), (crossed, design), 0, FILM)
    found = advice(crossed, FILM, document.candidates)
    assert [fix.change.text for fix in found.fixes] == ["Choose design A2."]
    edit = found.fixes[0].edit(document)
    assert edit.document.candidate == design and edit.label == "Choose design A2"


def test_that_a_fix_is_one_step_that_can_be_undone_and_leaves_the_files_alone(
    design: Candidate, target: Outline
) -> None:
    document = Document(
        target, DesignSettings((4, 4)), (design,), 0, replace(STRAIGHT, profile="k40", dxf_version="R12")
    )
    fix = advice(design, STRAIGHT).fixes[0]
    edit = fix.edit(document)
    assert edit.label == "Use centred connectors" and edit.merge_key is None
    assert edit.document.fabrication == replace(FILM, profile="k40", dxf_version="R12")
    history = History()
    history.restart(document)
    assert history.apply(edit) and history.undo_label == "Use centred connectors"
    assert history.undo() and history.document == document


def test_that_a_coarser_grid_is_offered_where_panels_leave_no_room_and_takes_the_place_of_all_designs(
    design: Candidate, target: Outline
) -> None:
    crowded = replace(FILM, connector_mm=5.0, options=replace(FILM.options, hinge_mm=((3, 5.0),)))
    assert verdict_on(design, crowded).problems[0].code == "plan.connectors_narrowed"
    motion = deploy(RatioField.from_log10(np.random.default_rng(2).uniform(-0.4, 0.4, (2, 2))))
    coarse = Candidate(motion.sheet, evaluate(motion, target, 0.0), seed=3, index=0)
    made = []

    def coarser() -> Iterator[tuple[Candidate, ...]]:
        made.append(coarse)
        yield (coarse, replace(coarse, index=1))

    found = ended(find_fixes(design, crowded, verdict_on(design, crowded), {}, coarser()))
    assert made == [coarse]
    (fix,) = [fix for fix in found.fixes if fix.instead]
    match = 100.0 * coarse.score.iou_exact
    assert fix.change.text == f"Use 2 x 2 voids: match {match:.1f} %." and fix.settings.options.hinge_mm == ()
    assert fix.verdict == verdict_on(coarse, fix.settings) and fix.to_json()["grid"] == [2, 2]
    document = Document(target, DesignSettings((4, 4)), (design,), 0, crowded)
    history = History()
    history.restart(document)
    assert history.apply(fix.edit(document)) and history.document.candidates == (coarse, replace(coarse, index=1))
    assert history.document.candidate == coarse and history.document.fabrication.options.hinge_mm == ()
    assert history.undo_label == f"Use 2 x 2 voids: match {match:.1f} %"
    assert history.undo() and history.document == document
    # A sheet that jams, but has room, asks for no other grid while anything else helps.
    ended(find_fixes(design, STRAIGHT, verdict_on(design, STRAIGHT), {}, coarser()))
    assert made == [coarse]
