"""What the program says of a sheet as cut: the estimate and the simulator agree, and both know what centring does."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from stopwatch import paced

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.foundation.errors import AngleError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.events import Result
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.request import Request
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.as_cut import (
    Outcome,
    SimulatedSheet,
    Source,
    StrainFigure,
    estimate,
    estimates,
    jam_json,
    simulate,
)
from kirigami_studio.studio.cutting import plan_sheet

STRAIGHT = FabricationSettings(connector_mm=0.4, options=CutOptions(style=ConnectorStyle.STRAIGHT))
CENTRED = replace(STRAIGHT, options=CutOptions(style=ConnectorStyle.CENTRED))


def simulated(
    design: Deployment, settings: FabricationSettings, phi: float = 0.0, target: Outline | None = None
) -> SimulatedSheet:
    plan: CutPlan = plan_sheet(design, settings)
    steps = simulate(design, plan, settings.width_mm, phi, target)
    while True:
        try:
            next(steps)
        except StopIteration as end:
            found: SimulatedSheet = end.value
            return found


@pytest.fixture(scope="module")
def design() -> Deployment:
    return deploy(RatioField.from_log10(np.random.default_rng(0).uniform(-0.5, 0.5, (6, 6))))


@pytest.fixture(scope="module")
def target(design: Deployment) -> Outline:
    return Outline.from_points(design.outline(0.0), "closed sheet")


@pytest.fixture(scope="module")
def straight(design: Deployment, target: Outline) -> SimulatedSheet:
    return simulated(design, STRAIGHT, 0.0, target)


@pytest.fixture(scope="module")
def centred(design: Deployment, target: Outline) -> SimulatedSheet:
    return simulated(design, CENTRED, 0.0, target)


def test_that_a_centred_sheet_closes_and_keeps_its_match(centred: SimulatedSheet) -> None:
    found = centred.as_cut
    assert found.outcome is Outcome.CLOSES and found.jam_phi == 0.0 and found.reached == 0.0
    assert found.iou is not None and found.ideal_iou is not None
    assert found.ideal_iou == pytest.approx(1.0, abs=1e-6)
    assert found.iou == pytest.approx(found.ideal_iou, abs=0.005)


def test_that_a_straight_sheet_jams_and_says_where(straight: SimulatedSheet) -> None:
    found = straight.as_cut
    assert found.outcome is Outcome.STRETCHED and not found.closes
    assert found.reached == found.jam_phi > math.radians(10.0)
    assert found.stretch > 0.45
    assert found.iou is not None and found.ideal_iou is not None and found.iou < found.ideal_iou - 0.02


def test_that_panels_in_contact_are_told_apart_from_connectors_that_stretch() -> None:
    even = deploy(RatioField.from_log10(np.random.default_rng(3).uniform(-0.3, 0.3, (4, 4))))
    found = simulated(even, replace(STRAIGHT, connector_mm=0.8)).as_cut
    assert found.outcome is Outcome.TOUCHING and found.stretch < 0.45
    assert math.radians(2.0) < found.reached < math.radians(15.0)


def test_that_a_sheet_which_jams_later_than_it_is_meant_to_open_does_its_work(
    design: Deployment, straight: SimulatedSheet
) -> None:
    beyond = straight.as_cut.jam_phi + math.radians(15.0)
    found = simulated(design, STRAIGHT, beyond).as_cut
    assert found.outcome is Outcome.CLOSES and found.reached == beyond
    assert found.jam_phi == pytest.approx(straight.as_cut.jam_phi)
    assert found.stretch < straight.as_cut.stretch
    assert found.iou is None and found.ideal_iou is None


def test_that_the_estimate_agrees_with_the_simulator(
    design: Deployment, straight: SimulatedSheet, centred: SimulatedSheet
) -> None:
    jams, closes = estimate(design, STRAIGHT, 0.0), estimate(design, CENTRED, 0.0)
    assert closes.outcome is centred.as_cut.outcome and closes.jam_phi == 0.0
    assert jams.outcome is straight.as_cut.outcome
    assert jams.jam_phi == pytest.approx(straight.as_cut.jam_phi, abs=math.radians(15.0))
    assert closes.strain == pytest.approx(centred.as_cut.strain, rel=0.2)
    assert jams.iou is None and jams.strain > 0.0


def test_that_the_estimate_does_not_take_crowded_connectors_as_centred(design: Deployment) -> None:
    wide = replace(CENTRED, width_mm=20.0, connector_mm=1.5)
    assert not estimate(design, wide, 0.0).closes


def test_that_film_buckles_and_card_does_not(design: Deployment) -> None:
    film = estimate(design, STRAIGHT, 0.0)
    card = estimate(design, replace(STRAIGHT, material="card-co2", connector_mm=0.2), 0.0)
    assert film.figure is StrainFigure.OUT_OF_PLANE and card.figure is StrainFigure.IN_PLANE


def test_that_every_connector_has_its_node_and_its_stretch(straight: SimulatedSheet) -> None:
    assert straight.node.shape == straight.stretch_at(1.0).shape
    assert straight.stretch_at(math.pi).max() < 1e-6
    assert straight.stretch_at(0.0) == pytest.approx(straight.closing.stretch[-1])
    step = 10
    assert straight.stretch_at(float(straight.closing.phi[step])) == pytest.approx(straight.closing.stretch[step])


def test_that_an_estimate_at_ten_by_ten_takes_milliseconds() -> None:
    design = deploy(RatioField.from_log10(np.random.default_rng(1).uniform(-0.3, 0.3, (10, 10))))
    assert paced(lambda: estimate(design, CENTRED, 0.0)) < 0.02


def test_that_designs_are_ranked_by_the_way_that_they_come_as_cut(design: Deployment, target: Outline) -> None:
    even = deploy(RatioField.uniform(6, 6))
    irregular = Candidate(design.sheet, evaluate(design, target, 0.0), seed=0, index=0)
    score = replace(evaluate(even, target, 0.0), iou_exact=irregular.score.iou_exact - 0.001)
    uniform = Candidate(even.sheet, score, seed=0, index=1)
    request = Request(target, (6, 6), regular=0.0, polish=0)
    result = Result(request, (irregular, uniform), 2, 0.0)
    assert Ranking.of(request).ranked([uniform, irregular]) == result.candidates
    jams = jam_angles(result, STRAIGHT)
    assert jams[irregular] > math.radians(10.0) > jams[uniform]
    again = result.ranked_as_cut(jams)
    assert again.candidates == (uniform, irregular) and again.best == uniform
    assert [reason.code for reason in again.ranking.reasons(again.candidates)][1] == "rank.jams"
    assert result.ranked_as_cut(jam_angles(result, CENTRED)).candidates == result.candidates
    apart = replace(STRAIGHT.options, removed=tuple(range(cut_table(6, 6).hinge_count)))
    assert jam_angles(result, replace(STRAIGHT, options=apart)) == {}


def jam_angles(result: Result, settings: FabricationSettings) -> dict[Candidate, float]:
    return {candidate: found.jam_phi for candidate, found in estimates(result.candidates, settings).items()}


@pytest.mark.parametrize("connector_mm", [1.0, 8.0, 16.0, 30.0, 60.0])
@pytest.mark.parametrize("seed", range(4))
def test_that_an_estimate_of_wide_connectors_jams_no_earlier_than_at_once(seed: int, connector_mm: float) -> None:
    design = deploy(RatioField.from_log10(np.random.default_rng(seed).uniform(-0.9, 0.9, (6, 6))))
    found = estimate(design, replace(STRAIGHT, connector_mm=connector_mm), 0.0)
    assert 0.0 <= found.jam_deg <= 180.0 and found.source is Source.ESTIMATE
    assert jam_json(found) == {"jam_deg": found.jam_deg, "jam_from": "estimate"}


def test_that_a_jam_beyond_the_flat_sheet_is_refused(straight: SimulatedSheet) -> None:
    with pytest.raises(AngleError):
        replace(straight.as_cut, jam_phi=math.radians(230.0))
    assert straight.as_cut.source is Source.SIMULATION
    assert jam_json(None) == {"jam_deg": None, "jam_from": None}


def test_that_share_of_way_and_word_say_how_far_a_sheet_comes(straight: SimulatedSheet) -> None:
    half = replace(straight.as_cut, jam_phi=math.radians(90.0), outcome=Outcome.STRETCHED)
    assert half.opened == pytest.approx(0.5) and half.word == "jams at 90°"
    assert replace(half, phi=math.radians(90.0), outcome=Outcome.CLOSES).word == "opens to 90°"
    closed = replace(half, jam_phi=0.0, outcome=Outcome.CLOSES, iou=0.97, ideal_iou=0.98)
    assert closed.word == "closes" and closed.opened == 1.0 and closed.lost == pytest.approx(0.01)
    assert closed.to_json() == {"jam_deg": 0.0, "jam_from": "simulation", "iou": 0.97, "max_strain": closed.strain}
