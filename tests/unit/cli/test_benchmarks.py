"""``benchmark`` on the command line: suites that compare variants."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from kirigami_studio.cli import main
from kirigami_studio.export.profile import PROFILES
from kirigami_studio.lab.benchmark import cut_files_suite
from kirigami_studio.lab.benchmark.cut_files_suite import CutFileFigures

pytestmark = pytest.mark.torch


def figures(capsys: pytest.CaptureFixture[str], *words: str) -> Any:
    assert main(["benchmark", *words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_that_a_suite_is_measured_on_the_families_that_it_is_asked_for(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    words = ("--families", "released", "--count", "1", "--seeds", "0", "--k", "2", "--processes", "1")
    found = figures(capsys, "generators", "--generators", "paper", *words, "--out", str(tmp_path))
    assert list(found["families"]) == ["released"]
    assert found["families"]["released"]["rows"]["paper"]["runs"] == 1


def test_that_variants_are_measured_on_both_families_of_either_split(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    out = tmp_path / "figures.json"
    words = ("variants", "--count", "1", "--seeds", "0")
    test = figures(capsys, *words, "--out", str(out))
    assert json.loads(out.read_text()) == test
    assert list(test) == ["structured", "sobol"]
    assert "prior" in test["sobol"]["variants"]
    validation = figures(capsys, *words, "--split", "validation", "--variants", "prior")
    for family in test:
        found = [split[family]["variants"]["prior"]["uniform_siou"] for split in (test, validation)]
        assert found[0] != found[1]


def test_that_spread_and_robustness_take_named_targets(capsys: pytest.CaptureFixture[str]) -> None:
    spread = figures(capsys, "spread", "--targets", "heart", "--k", "2", "--variants", "prior")
    assert spread["targets"]["variants"]["prior"]["own_poses"]["std_rms"]["mean"] > 0.0
    robust = figures(capsys, "robustness", "--targets", "heart", "--seeds", "0", "--variants", "prior")
    assert robust["targets"]["prior"]["clean"]["siou"] > 0.9
    assert robust["targets"]["prior"]["together_64"]["siou_difference"] != 0.0


def test_that_solvers_go_on_in_their_folder(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    words = ["solvers", "--targets", "circle", "--grid", "4x4", "--evaluations", "26"]
    words += ["--processes", "1", "--out", str(tmp_path / "runs")]
    first = figures(capsys, *words, "--methods", "swarm", "--seeds", "0")
    assert first["families"]["targets"]["rows"]["swarm"]["evaluations"] == 24.0
    both = figures(capsys, *words, "--methods", "fit,swarm", "--seeds", "0")
    assert both["families"]["targets"]["rows"]["swarm"] == first["families"]["targets"]["rows"]["swarm"]
    assert json.loads((tmp_path / "runs" / "solvers.json").read_text()) == both
    assert len((tmp_path / "runs" / "solvers.jsonl").read_text().splitlines()) == 3
    assert main(["benchmark", *words, "--methods", "swarm", "--seeds", "0"]) == 0
    assert "(92.6)" in capsys.readouterr().out
    more = figures(capsys, "best-of-k", *words[1:], "--methods", "swarm", "--k", "2")
    curve = more["families"]["targets"]["swarm"]
    assert (curve[0]["k"], curve[0]["siou"]) == (1, first["families"]["targets"]["rows"]["swarm"]["siou"])
    assert len((tmp_path / "runs" / "solvers.jsonl").read_text().splitlines()) == 4
    sweep = figures(capsys, "grid-sweep", "--sizes", "3", "--methods", "fit", *words[1:3], *words[-4:])
    assert sweep["sizes"][0]["points"][0]["evaluations"] > 5
    assert (tmp_path / "runs" / "grid-sweep.jsonl").exists()
    for wrong, code in ((["--methods", "annealing"], 2), (["--evaluations", "27"], 1)):
        assert main(["benchmark", *words, *wrong]) == code


def test_that_a_picture_can_show_the_worst_only(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    sizes = []
    for worst in ((), ("--worst", "1")):
        path = tmp_path / f"picture{len(sizes)}.png"
        names = ["letter-l", "heart", "star", "egg", "circle", "square", "drop"]
        figures(capsys, "designs", "--targets", *names, "--steps", "1", "--picture", str(path), *worst)
        with Image.open(path) as picture:
            sizes.append(picture.height)
    assert sizes[0] > 1.5 * sizes[1]  # two rows of tiles, and one


def test_that_an_unknown_variant_is_wrong_usage_before_anything_is_measured(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for words in (["variants", "--count", "1"], ["spread"], ["robustness"], ["generation-speed"]):
        assert main(["benchmark", *words, "--variants", "prior,none"]) == 2
        captured = capsys.readouterr()
        assert captured.out == "" and "no generator variant 'none'" in captured.err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["generator", "--variants", "prior"], "--variants"), (["variants", "--variant", "prior"], "--variant"),
        (["spread", "--polish", "3"], "--polish"), (["robustness", "--exact"], "--exact"),
        (["nearness", "--seeds", "0", "1"], "--seeds"), (["polish", "--trim"], "--trim"),
        (["regularity", "--k", "2"], "--k"), (["designs", "--variants", "prior"], "--variants"),
        (["generation-speed", "--count", "1"], "--count"), (["speed", "--grid", "4x4"], "--grid"),
        (["solvers", "--k", "2"], "--k"),
        (["lattice", "--seed", "1"], "--seed"), (["fabrication", "--targets", "heart"], "--targets"),
        (["cut-files", "--grid", "4x4"], "--grid"), (["as-cut", "--count", "1"], "--count"),
        (["everything"], "everything"), ([], "COMMAND"),
    ],
)  # fmt: skip
def test_that_each_suite_takes_its_own_options_only(
    capsys: pytest.CaptureFixture[str], words: list[str], said: str
) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["benchmark", *words])
    assert stopped.value.code == 2
    assert said in capsys.readouterr().err.splitlines()[-1]


def test_that_cut_files_are_counted_for_a_person_and_as_json(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cut_files_suite, "PROFILES", {"slots": PROFILES["slots"]})
    found = figures(capsys, "cut-files", "--count", "1", "--seed", "1")
    assert (found["designs"], found["files"], found["passed"], found["failures"]) == (1, 3, 3, [])
    assert main(["benchmark", "cut-files", "--count", "1", "--seed", "1"]) == 0
    assert "3 of 3 files of 1 designs passed" in capsys.readouterr().out


def test_that_a_cut_file_that_does_not_pass_fails_the_command(monkeypatch: pytest.MonkeyPatch) -> None:
    bad = CutFileFigures(1, 3, 2, 0, ("Design 0, slots, R12 .dxf: a line is missing",), 0.1, 0.1, (1.5, 1.6, 1.7))
    monkeypatch.setattr(cut_files_suite, "measure_cut_files", lambda *given: bad)
    assert main(["benchmark", "cut-files"]) == 1
