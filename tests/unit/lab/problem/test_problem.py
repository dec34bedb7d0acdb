"""The problem as others see it: targets, simulation, score, baselines, and what a generator is worth."""

from __future__ import annotations

import contextlib
import io
import json
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from command_line import answer, refusal

from kirigami_studio.foundation.errors import RatioError, UsageError
from kirigami_studio.lab import problem
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load

pytestmark = pytest.mark.torch

CARD = Path(__file__).parents[4] / "docs" / "data-card.md"


@pytest.fixture(scope="module")
def few() -> tuple[Outline, ...]:
    return problem.targets("structured", count=3)


def test_that_the_example_of_the_data_card_runs_as_it_stands() -> None:
    (example,) = re.findall(r"```python\n(.*?)```", CARD.read_text(encoding="utf-8"), flags=re.DOTALL)
    assert len([line for line in example.splitlines() if line]) <= 10
    shown = io.StringIO()
    with contextlib.redirect_stdout(shown):
        exec(compile(example.replace("count=50", "count=2"), str(CARD), "exec"), {})
    mine, prior = shown.getvalue().splitlines()
    assert float(re.findall(r"sIoU ([\d.]+)", mine)[0]) < 0.95 < float(re.findall(r"sIoU ([\d.]+)", prior)[0])


@pytest.mark.parametrize("family", ["structured", "sobol"])
def test_that_the_data_card_names_the_hash_of_the_test_split(family: str) -> None:
    digest = problem.designs(family, "test").about["sha256"]
    assert f"| {family} | test | 500 | `{digest}` |" in CARD.read_text(encoding="utf-8")


def test_that_splits_and_seeds_have_targets_of_their_own_and_repeat() -> None:
    for family in problem.FAMILIES:
        found = [problem.targets(family, split, 1, seed)[0] for split in ("test", "validation") for seed in (0, 1)]
        assert len({outline.points.tobytes() for outline in found}) == 4
        again = problem.targets(family, "test", 2)
        assert np.array_equal(again[0].points, found[0].points)
        assert again[0].polygon.area == pytest.approx(1.0)


def test_that_exact_targets_are_what_their_designs_show() -> None:
    data = problem.designs("sobol", "test", 1)
    (target,) = problem.targets("sobol", "test", 1, exact=True)
    assert problem.score(data.ratios[0], target).iou_exact > 1.0 - 1e-9
    assert problem.simulate(data.ratios[0]).outline.shape == target.points.shape
    assert np.array_equal(problem.simulate(data.ratios[0]).mask, data.masks[0])


def test_that_masks_are_pictures_of_the_targets(few: tuple[Outline, ...]) -> None:
    pictures = problem.masks(few)
    assert pictures.shape == (3, 128, 128)
    data = problem.designs("structured", "test", 3)
    common, either = (pictures & data.masks).sum(axis=(1, 2)), (pictures | data.masks).sum(axis=(1, 2))
    assert (common / either > 0.98).all()
    assert problem.masks([], 64).shape == (0, 64, 64)


def test_that_a_flat_sheet_is_the_rectangle_that_it_starts_as() -> None:
    flat = problem.simulate(np.ones((4, 6)), np.pi)
    assert flat.mask.any(axis=1).sum() == pytest.approx(128 * 5 / 7, abs=2)
    assert np.ptp(flat.outline, axis=0) == pytest.approx([7.0, 5.0])


def test_that_a_generator_is_judged_target_by_target(few: tuple[Outline, ...]) -> None:
    seen = []

    def generator(targets: Sequence[Outline]) -> list[object]:
        seen.append(targets)
        return [problem.designs("structured", "test", 3).ratios[0], None, np.full((10, 10), 11.0)]

    judged = problem.judge(generator, few)  # type: ignore[arg-type]
    assert seen == [few]
    assert judged.targets == 3
    first, *others = judged.scores
    assert first is not None
    assert first.siou > 0.97
    assert others == [None, None]
    assert judged.siou == pytest.approx(first.siou / 3)
    assert judged.success == judged.feasible == pytest.approx(1 / 3)
    assert judged.area_cv == first.evenness.area_cv
    assert list(judged.refused) == [2]
    assert "from 0.1 to 10" in judged.refused[2]
    told = json.loads(json.dumps(judged.to_json()))
    assert told["each"][1] is None
    assert told["siou"] == judged.siou


def test_that_wrong_answers_of_a_generator_are_refused(few: tuple[Outline, ...]) -> None:
    with pytest.raises(UsageError) as few_fields:
        problem.judge(lambda targets: [np.ones((10, 10))], few)
    assert few_fields.value.code == "problem.fields_missing"
    with pytest.raises(RatioError) as other_grid:
        problem.judge(lambda targets: [np.ones((8, 8)) for _ in targets], few)
    assert other_grid.value.code == "problem.other_grid"
    assert problem.judge(lambda targets: [np.ones((8, 8)) for _ in targets], few, None).feasible == 1.0
    with pytest.raises(UsageError) as nothing:
        problem.judge(problem.baseline("uniform"), [])
    assert nothing.value.code == "benchmark.no_targets"
    for wrong, code in (
        (lambda: problem.targets("fractal"), "training.unknown_family"),
        (lambda: problem.targets("sobol", "final"), "problem.unknown_split"),
        (lambda: problem.baseline("oracle"), "problem.unknown_baseline"),
    ):
        with pytest.raises(UsageError) as caught:
            wrong()
        assert caught.value.code == code


def test_that_baselines_are_those_of_the_tables(few: tuple[Outline, ...]) -> None:
    assert {"uniform", "cma-es", "fit", "prior", "balanced"} <= set(problem.baselines())
    uniform = problem.judge(problem.baseline("uniform"), few)
    assert uniform.siou == pytest.approx(uniform.uniform_siou)
    assert uniform.area_cv == pytest.approx(0.0, abs=1e-9)
    fitted = problem.judge(problem.baseline("fit"), few)
    sampled = problem.judge(problem.baseline("prior", seed=1), few)
    assert min(fitted.siou, sampled.siou) > 0.95 > uniform.siou
    assert problem.judge(problem.baseline("prior", seed=1), few).siou == sampled.siou
    small = problem.baseline("swarm", grid=(2, 2))([load("circle")])
    assert np.shape(small[0]) == (2, 2)


def test_that_the_command_judges_a_callable_of_a_module_here(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "somebodys.py").write_text(
        "import numpy as np\n"
        "def flat(targets):\n    return [np.ones((10, 10)) for target in targets]\n"
        "def broken(targets):\n    return targets[0].wrong\n"
    )
    monkeypatch.chdir(tmp_path)
    judging = ("benchmark", "judge")
    told = answer(capsys, *judging, "somebodys:flat", "uniform", "--targets", "heart", "--json")["families"]["targets"]
    assert told["somebodys:flat"]["siou"] == told["uniform"]["siou"] > 0.5
    drawn = answer(capsys, *judging, "uniform", "--families", "drawn", "--count", "1", "--json")["families"]
    assert list(drawn) == ["drawn"]
    code, said = refusal(capsys, *judging, "somebodys:broken", "--targets", "heart")
    assert (code, "AttributeError" in said) == (1, True)
    code, said = refusal(capsys, *judging, "somebodys:missing", "--targets", "heart")
    assert (code, "missing" in said) == (2, True)


def test_that_a_leaderboard_keeps_one_row_for_each_call(
    few: tuple[Outline, ...], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    uniform = problem.judge(problem.baseline("uniform"), few)
    # As the released code measures it, the floor is higher.
    assert uniform.siou_released > uniform.siou + 0.02
    half = problem.judge(lambda targets: [np.ones((10, 10)), None, None], few)
    assert half.siou_released < uniform.siou_released
    board = problem.entered({}, {("drawn", "uniform"): uniform}, (10, 10), 0)
    board = problem.entered(board, {("drawn", "uniform"): half, ("drawn", "mine"): uniform}, (10, 10), 0)
    board = json.loads(json.dumps(problem.entered(board, {("drawn", "mine"): uniform}, (10, 10), 1)))
    rows = board["rows"]
    assert [(row["generator"], row["seed"]) for row in rows] == [("uniform", 0), ("mine", 0), ("mine", 1)]
    assert rows[0]["siou_released"] == half.siou_released and rows[1]["siou"] == uniform.siou
    file = tmp_path / "board.json"
    file.write_text(json.dumps(board))
    call = ("benchmark", "judge", "uniform", "--targets", "circle", "--leaderboard", str(file))
    answer(capsys, *call, "--json")
    assert [row["family"] for row in json.loads(file.read_text())["rows"]] == ["drawn", "drawn", "drawn", "circle"]
    for wrong in ("[]", '{"rows": [{"siou": 1}]}', "nothing"):
        file.write_text(wrong)
        assert refusal(capsys, *call)[0] == 2 and file.read_text() == wrong
