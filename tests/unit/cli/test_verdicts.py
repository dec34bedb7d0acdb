"""The verdict on the command line: the same list in the answer, in the record beside the file, and in words."""

from __future__ import annotations

import json
import math
import time
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from command_line import answer, refusal

from kirigami_studio.cli import main
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.foundation.errors import Cancelled
from kirigami_studio.foundation.steps import never, result_of
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.events import Progress, Result
from kirigami_studio.pipeline.pool import Pool
from kirigami_studio.pipeline.request import Request
from kirigami_studio.project.document import Document
from kirigami_studio.project.store import save
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio import verdict
from kirigami_studio.studio.designing import ranked_as_cut
from kirigami_studio.studio.verdict import looking


@pytest.fixture(scope="module")
def document() -> Document:
    field = RatioField.from_log10(np.random.default_rng(0).uniform(-0.7, 0.7, (4, 5)))
    target = Outline.from_points(deploy(field).outline(0.0), "own")
    design = Candidate(Sheet(field), evaluate(deploy(field), target), seed=0, index=0)
    settings = FabricationSettings(connector_mm=0.2)
    return Document(target, DesignSettings((4, 5)), (design,), 0, settings, {"model": "balanced"})


@pytest.fixture
def project(document: Document, tmp_path: Path) -> Path:
    path = tmp_path / "own.kiri"
    save(document, path)
    return path


def test_that_an_export_answers_with_the_verdict_that_its_record_has(
    capsys: pytest.CaptureFixture[str], project: Path, tmp_path: Path
) -> None:
    good = answer(capsys, "export", project, "--out", tmp_path / "set", "--all", "--json")
    assert good["ok"] and good["verdict"]["level"] == "ready_to_cut" and good["verdict"]["problems"] == []
    assert json.loads((tmp_path / "set" / "cut.json").read_text())["verdict"] == good["verdict"]
    straight = ("--style", "straight", "--material", "felt-co2", "--width-mm", "200", "--connector-mm", "0.6")
    straight += ("--construction", "one-sheet")
    bad = answer(capsys, "export", project, "--out", tmp_path / "one.dxf", *straight, "--sidecar", "--json")
    assert not bad["ok"] and bad["verdict"]["level"] == "will_not_work"
    assert {"as_cut.breaks", "as_cut.jams_stretched"} <= {problem["code"] for problem in bad["verdict"]["problems"]}
    assert json.loads((tmp_path / "one.json").read_text())["verdict"] == bad["verdict"]
    assert bad["verified"][0]["ok"]  # the file is as planned; it is the sheet that will not work


def test_that_the_same_list_is_said_in_words(capsys: pytest.CaptureFixture[str], project: Path, tmp_path: Path) -> None:
    wish = ["export", str(project), "--out", str(tmp_path / "cut.dxf"), "--connector-mm", "2.6"]
    told = answer(capsys, *wish, "--json")["verdict"]
    assert main(wish) == 0
    said = capsys.readouterr().out.splitlines()
    assert "  verdict: Cut with care" in said
    care = [line for line in said if line.startswith("  care: ")]
    assert care == [f"  care: {problem['text']}" for problem in told["problems"]]
    (answers,) = [line for line in said if line.startswith("  answers: ")]
    assert all(answer["word"] in answers for answer in told["answers"].values())
    assert [line for line in said if line.startswith("  note: ")] == [f"  note: {text}" for text in told["notes"]]


def test_that_fixes_are_told_where_they_are_asked_for(
    capsys: pytest.CaptureFixture[str], project: Path, tmp_path: Path
) -> None:
    wish = ["export", str(project), "--out", str(tmp_path / "cut.dxf"), "--style", "straight", "--connector-mm", "0.4"]
    assert "fixes" not in answer(capsys, *wish, "--json")
    told = answer(capsys, *wish, "--fixes", "--json")
    assert told["fixes"][0]["text"] == "Use centred connectors." and told["fixes"][0]["level"] == "ready_to_cut"
    assert "tried" in told
    assert main([*wish, "--fixes"]) == 0
    assert "  fix: Use centred connectors. Then: Ready to cut." in capsys.readouterr().out.splitlines()
    code, said = refusal(capsys, *wish[:4], "--connector-mm", "15", "--fixes")
    assert code == 1 and "Then: Ready to cut." in said


def test_that_a_file_is_checked_against_its_design(
    capsys: pytest.CaptureFixture[str], document: Document, project: Path, tmp_path: Path
) -> None:
    cut = tmp_path / "cut.dxf"
    answer(capsys, "export", project, "--out", cut, "--json")
    good = answer(capsys, "check", cut, "--design", project, "--json")
    assert good["ok"] and good["verdict"]["level"] == "ready_to_cut" and good["void_miss_um"] < 5.0
    assert good["jam_deg"] == pytest.approx(0.0) and "verdict" not in answer(capsys, "check", cut, "--json")
    # How the file was made is taken from the file, not from what the project says by now.
    straight = replace(document.fabrication, connector_mm=0.4, options=CutOptions(style=ConnectorStyle.STRAIGHT))
    other = tmp_path / "other.kiri"
    save(replace(document, fabrication=straight), other)
    assert answer(capsys, "check", cut, "--design", other, "--json")["verdict"] == good["verdict"]
    # The sheet with those connectors does not close, as its own file says.
    told = answer(capsys, "export", other, "--out", cut, "--json")["verdict"]
    assert main(["check", str(cut), "--design", str(project), "--json"]) == 1
    jams = json.loads(capsys.readouterr().out)
    assert jams["sound"] and not jams["ok"] and jams["verdict"] == told
    assert jams["verdict_at_export"] == told["level"] != "ready_to_cut"


def test_that_the_best_design_that_can_be_cut_comes_first(document: Document) -> None:
    target = document.target
    assert target is not None
    irregular = document.candidates[0]
    even = deploy(RatioField.uniform(4, 5))
    score = replace(evaluate(even, target), iou_exact=0.5)
    uniform = Candidate(even.sheet, score, seed=0, index=1)
    crossed = replace(irregular, score=replace(irregular.score, feasible=False), index=2)
    result = Result(Request(target, (4, 5), regular=0.0, polish=0), (irregular, uniform, crossed), 3, 0.0)
    straight = replace(document.fabrication, options=CutOptions(style=ConnectorStyle.STRAIGHT))
    found = result_of(ranked_as_cut(result, straight, (), never))
    assert found.candidates == (uniform, irregular, crossed)
    assert [found.ranking.cuttable(one) for one in found.candidates] == [True, False, False]
    reasons = [reason.code for reason in found.ranking.reasons(found.candidates)]
    assert reasons[1:] == ["rank.jams", "rank.not_feasible"]
    assert found.jam_phi[irregular] > math.radians(10.0)
    centred = result_of(ranked_as_cut(result, document.fabrication, (), never))
    assert centred.candidates == (irregular, uniform, crossed) and centred.refusals == {}
    brittle = result_of(ranked_as_cut(result, replace(document.fabrication, material="card-co2"), (), never))
    assert not any(brittle.ranking.cuttable(one) for one in brittle.candidates)
    assert {note.code for note in brittle.refusals.values()} == {"as_cut.breaks"}


def test_that_workers_look_at_the_designs_after_the_first_and_find_the_same(
    document: Document, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = document.target
    assert target is not None
    rng = np.random.default_rng(2)
    candidates = []
    for number in range(4):
        sheet = deploy(RatioField.from_log10(0.1 * number * rng.uniform(-1.0, 1.0, (4, 5))))
        candidates.append(Candidate(sheet.sheet, evaluate(sheet, target), seed=0, index=number))
    result = Result(Request(target, (4, 5), regular=0.0, polish=0), tuple(candidates), 4, 0.0)
    brittle = replace(document.fabrication, material="card-co2")
    alone = result_of(ranked_as_cut(result, brittle, (), never, Pool(0)))
    with closing(Pool(2)) as pool:
        pool.start()
        while not pool.ready:
            time.sleep(0.05)
        here: list[Candidate] = []
        with monkeypatch.context() as patch:
            patch.setattr(verdict, "looking", lambda one, *more: here.append(one) or looking(one, *more))
            together = result_of(ranked_as_cut(result, brittle, (), never, pool))
        assert len(here) == 1 and len(alone.refusals) >= 3
        assert together == alone and together.refusals == alone.refusals and together.losses == alone.losses
        assert together.as_cut == alone.as_cut
        # One that is stopped on its way leaves the workers to the next.
        at: list[int] = []
        steps = ranked_as_cut(result, brittle, (), lambda: bool(at) and at[-1] == 1, pool)
        with pytest.raises(Cancelled):
            at.extend(step.done for step in steps if isinstance(step, Progress))
        assert pool.ready


@pytest.mark.torch
def test_that_design_says_whether_the_material_can_be_cut(capsys: pytest.CaptureFixture[str]) -> None:
    wish = ["design", "heart", "--grid", "4x4", "--k", "2", "--no-polish", "--steps", "1"]
    # Without a material it is the one that new projects have, as in the window.
    plain, named = (answer(capsys, *wish, *more, "--json") for more in ((), ("--material", "film-uv")))
    assert plain["verdict"] == named["verdict"] and "from" in plain["verdict"]
    assert [one["index"] for one in plain["candidates"]] == [one["index"] for one in named["candidates"]]
    assert plain["jam_deg"] == plain["verdict"]["jam_deg"] and plain["jam_from"] == plain["verdict"]["jam_from"]
    for one in plain["candidates"]:
        assert 0.0 <= one["as_cut"]["jam_deg"] <= 180.0 and one["as_cut"]["jam_from"] in ("estimate", "simulation")
    assert plain["candidates"][0]["as_cut"]["jam_deg"] == plain["jam_deg"]
    thin = ("--material", "card-co2", "--width-mm", "250", "--connector-mm", "1")
    card = answer(capsys, *wish, *thin, "--json")
    assert not card["ok"] and card["verdict"]["level"] == "will_not_work"
    assert not any(entry["cuttable"] for entry in card["candidates"])
    assert main([*wish, *thin]) == 0
    out = capsys.readouterr().out
    assert "no design can be cut in this material, width and style." in out and "verdict: Will not work" in out


def test_that_a_design_whose_pieces_can_be_cut_is_not_said_to_fail(capsys: pytest.CaptureFixture[str]) -> None:
    """Its sheet has no room for the ears of its pins; two of them are left out of the pieces."""
    words = ["design", "heart", "--grid", "4x4", "--k", "1", "--no-polish", "--symmetry", "none"]
    assert main([*words, "--material", "plywood-co2"]) == 0
    out = capsys.readouterr().out
    assert "verdict: Ready to cut" in out and "no design can be cut" not in out and "Pins come as near" not in out
