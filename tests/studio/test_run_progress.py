"""Progress of a whole run: one bar that never goes back, and an estimate that is a bound."""

from __future__ import annotations

import pytest

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.foundation.steps import never
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline.events import Phase, Progress, Result
from kirigami_studio.pipeline.request import Request
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.designing import Judged, ranked_as_cut
from kirigami_studio.studio.run_progress import RunProgress, phases_of

#: As runs report them: fits begin before the first samples, and what was trimmed meanwhile is checked again.
REPORTED = (
    (Phase.LOADING, 0, 8),
    (Phase.FITTING, 0, 2),
    (Phase.SAMPLING, 6, 6),
    (Phase.FITTING, 1, 2),
    (Phase.POLISHING, 0, 6),
    (Phase.POLISHING, 6, 6),
    (Phase.POLISHING, 6, 10),
    (Phase.POLISHING, 10, 10),
    (Phase.JUDGING, 0, 8),
    (Phase.JUDGING, 4, 8),
    (Phase.TRIMMING, 0, 3),
    (Phase.JUDGING, 0, 8),
    (Phase.JUDGING, 7, 8),
)


@pytest.fixture
def request_() -> Request:
    return Request(load("heart"), (8, 8), k=8)


def test_that_the_share_of_a_run_never_falls_when_a_phase_begins_or_comes_again(request_: Request) -> None:
    whole = RunProgress(request_)
    shares = [whole.placed(Progress(done, total, "", phase)).share for phase, done, total in REPORTED]
    assert shares == sorted(shares) and shares[0] == 0.0 and shares[-1] < 1.0
    assert shares[4] < shares[5] == shares[6] < shares[7], "more to polish is no step back, and moves the bar"
    assert shares[8] < shares[9] == shares[10] == shares[11] < shares[12], "what comes again takes a part of the rest"
    assert 0.4 < shares[8] < 0.8, "checking takes as long as designing"


def test_that_checking_says_the_most_that_it_may_still_take(request_: Request) -> None:
    times = (100.0, 109.0, 120.0, 150.0, 200.0)
    ticks = iter((100.0, *times))  # one look at the clock when the phase begins
    whole = RunProgress(request_, lambda: next(ticks))
    said = [whole.placed(Progress(done, 8, "x", Phase.JUDGING)).message for done in (0, 0, 1, 2, 8)]
    assert said[0] == said[1] == said[4] == "x", "nothing is known before the first design is checked"
    assert "2 min" in said[2], "7 designs of 20 s"
    assert "2 min" in said[3], "6 designs of 25 s"


def test_that_phases_are_those_that_a_request_may_have(request_: Request) -> None:
    assert Phase.SEARCHING not in phases_of(request_) and Phase.TRIMMING not in phases_of(request_)
    plain = Request(load("heart"), (8, 8), k=1, polish=0, search=1, trim=True)
    assert {Phase.SEARCHING, Phase.TRIMMING} < set(phases_of(plain)) and Phase.POLISHING not in phases_of(plain)


def test_that_designs_are_reported_as_they_are_checked() -> None:
    target, sheet = load("square"), deploy(RatioField.uniform(3, 3))
    design = Candidate(sheet.sheet, evaluate(sheet, target), seed=0, index=0)
    result = Result(Request(target, (3, 3), k=1, polish=0), (design,), 1, 0.0)
    steps = ranked_as_cut(result, FabricationSettings(), (), never)
    reports: list[Progress | Judged] = []
    while True:
        try:
            reports.append(next(steps))
        except StopIteration as end:
            ranked: Result = end.value
            break
    looked = [one for one in reports if isinstance(one, Judged)]
    assert [one.candidate for one in looked] == [design]
    assert looked[0].as_cut == ranked.as_cut[design] and looked[0].refusal == ranked.refusals.get(design)
    progress = [one for one in reports if isinstance(one, Progress)]
    assert {one.phase for one in progress} == {Phase.JUDGING} and {one.total for one in progress} == {1}
