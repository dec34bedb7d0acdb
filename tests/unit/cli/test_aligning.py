"""``train grpo`` and ``train align`` from a file of weights to a file of weights, and what they refuse."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
import torch
from safetensors.torch import load_file

from kirigami_studio.cli import main
from kirigami_studio.generator.network import NetworkShape, VelocityNetwork
from kirigami_studio.generator.weights import load_model, variants
from kirigami_studio.lab.trained_weights import store_model
from kirigami_studio.lab.training.learner import grown_state
from kirigami_studio.lab.training.train_aligned import VARIANTS, AlignSettings

pytestmark = pytest.mark.torch
SMALL = NetworkShape(4, 4, 32, 64, 1, 16, 24, 32, 48)


@pytest.fixture(scope="module")
def weights(tmp_path_factory: pytest.TempPathFactory) -> Path:
    torch.manual_seed(0)
    network = VelocityNetwork(SMALL)
    return store_model("prior", network, tmp_path_factory.mktemp("prior"), {})


@pytest.fixture(autouse=True)
def few_targets(monkeypatch: pytest.MonkeyPatch) -> None:
    """Watching 200 targets of each family takes most of a minute."""
    monkeypatch.setattr("kirigami_studio.lab.cli.learning.VALIDATION_COUNT", 3)
    monkeypatch.setattr("kirigami_studio.lab.cli.learning.GROUP_COUNT", 3)


def test_that_the_bundled_prior_can_be_aligned() -> None:
    shape = AlignSettings(prior="").shape
    assert grown_state(load_model("prior").network, shape).keys() == VelocityNetwork(shape).state_dict().keys()


def test_that_weights_are_aligned_and_written_with_their_manifest(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, weights: Path
) -> None:
    words = ["train", "grpo", "--reward", "regularity", "--start", str(weights), "--calls", "12", "--group", "3",
             "--batch", "2", "--rollout-steps", "2", "--device", "cpu", "--out", str(tmp_path / "run")]  # fmt: skip
    assert main([*words, "--json"]) == 0
    answered = json.loads(capsys.readouterr().out)
    assert answered["record"]["calls"] == 12
    assert {"structured_iou", "drawn_iou", "structured_spread", "structured_tv"} <= answered["record"].keys()
    assert answered["record"]["reward"] == pytest.approx(-answered["record"]["tv"])
    assert [Path(name).name for name in answered["files"]] == ["grpo-regularity.safetensors"]
    model = load_model("grpo-regularity", tmp_path / "run")
    assert not all(
        torch.equal(value, load_model("prior", weights.parent).network.state_dict()[name])
        for name, value in model.network.state_dict().items()
    )
    about = json.loads((tmp_path / "run" / "manifest.json").read_text())["variants"]["grpo-regularity"]["about"]
    assert about["settings"]["start"] == load_model("prior", weights.parent).digest
    assert main(words) == 0
    assert "grpo-regularity.safetensors" in capsys.readouterr().out
    assert main([*words, "--seed", "1"]) == 1
    assert "other settings (seed)" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("code", "words", "said"),
    [
        (1, ["--start", "nowhere/prior.safetensors"], "nowhere"),
        (2, ["--group", "1"], "at least 2 designs"),
        (2, ["--calls", "3"], "at least 4 environment calls"),
        (2, ["--reward", "balanced", "--calls", "100"], "at least 132 environment calls"),
        (2, ["--average-decay", "1"], "below 1"),
        (2, ["--keep-at", "20000"], "Choose fewer"),
        (2, ["--minutes", "0"], "--minutes"),
        (2, ["--device", "abacus"], "abacus"),
    ],
)
def test_that_what_is_missing_or_makes_no_sense_is_refused_in_a_sentence(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, code: int, words: list[str], said: str
) -> None:
    assert main(["train", "grpo", *words, "--out", str(tmp_path / "out")]) == code
    sentence = capsys.readouterr().err
    assert said in sentence and len(sentence.splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_that_a_prior_is_aligned_to_three_variants_of_one_file_and_resumed(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, weights: Path
) -> None:
    shape = replace(SMALL, direction=True, preference=True, sheets=True)
    monkeypatch.setattr("kirigami_studio.lab.training.train_aligned.AlignSettings", partial(AlignSettings, shape=shape))
    run = tmp_path / "run"
    words = ["train", "align", "--start", str(weights), "--steps", "2", "--batch", "4", "--drawn", "3",
             "--learning-rate", "0.01", "--evenness-weight", "0.3", "--free-rims", "0.5", "--symmetric", "0.5",
             "--device", "cpu", "--out", str(run)]  # fmt: skip
    # Stopped at once, which means after one step.
    assert main([*words, "--minutes", "0.00001", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["record"]["step"] == 1
    first = load_file(run / "aligned.safetensors")
    assert main([*words, "--json"]) == 0
    answered = json.loads(capsys.readouterr().out)
    assert answered["record"]["step"] == 2
    wanted = {f"{family}_{figure}_{preference}" for family in ("structured", "sobol", "drawn")
              for figure in ("iou", "tv", "cv", "spread") for preference in ("0", "0.35", "0.9")}  # fmt: skip
    assert wanted | {"loss", "match", "variation", "unevenness", "anchor"} <= answered["record"].keys()
    assert answered["record"]["structured_tv_0.9"] < answered["record"]["structured_tv_0"]
    assert [Path(name).name for name in answered["files"]] == ["aligned.safetensors"]
    assert variants(run) == tuple(VARIANTS) == ("accuracy", "balanced", "regularity")
    models = [load_model(name, run) for name in VARIANTS]
    assert [model.preference for model in models] == list(VARIANTS.values()) == [0.0, 0.35, 0.9]
    assert len({model.digest for model in models}) == 1
    assert all(model.moves_mouths for model in models)
    about = json.loads((run / "manifest.json").read_text())["variants"]["balanced"]["about"]
    assert about["settings"]["prior"] == load_model("prior", weights.parent).digest
    assert about["validation"]["step"] == 2
    steps = [json.loads(line)["step"] for line in (run / "log.jsonl").read_text().splitlines()]
    assert steps == [1, 2]
    before = load_file(run / "aligned.safetensors")
    assert main(words) == 0
    assert "aligned.safetensors" in capsys.readouterr().out
    assert json.loads((run / "manifest.json").read_text())["variants"]["balanced"]["about"]["validation"]["sobol_iou_0"]
    after = load_file(run / "aligned.safetensors")
    assert before.keys() == after.keys() and all(torch.equal(value, after[name]) for name, value in before.items())
    # One step alone gave other weights.
    assert not torch.equal(first["leave.weight"], after["leave.weight"])
    assert main([*words, "--anchor-weight", "0"]) == 1
    assert "other settings (anchor_weight)" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("code", "words", "said"),
    [
        (1, ["--start", "nowhere/prior.safetensors"], "nowhere"),
        (2, ["--other-sheets", "2"], "--other-sheets is a share from 0 to 1, got 2"),
        (2, ["--free-rims", "1.5"], "--free-rims is a share from 0 to 1, got 1.5"),
        (2, ["--symmetric", "2"], "--symmetric is a share from 0 to 1, got 2"),
        (2, ["--minutes", "0"], "--minutes must be above 0, got 0"),
        (2, ["--minutes", "-3"], "--minutes must be above 0, got -3"),
        (2, ["--device", "abacus"], "abacus"),
    ],
)
def test_that_alignment_refuses_what_makes_no_sense_in_a_sentence(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, code: int, words: list[str], said: str
) -> None:
    assert main(["train", "align", *words, "--steps", "1", "--out", str(tmp_path / "out")]) == code
    sentence = capsys.readouterr().err
    assert said in sentence and len(sentence.splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_that_alignment_refuses_a_prior_of_another_shape_in_a_sentence(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, weights: Path
) -> None:
    words = ["--start", str(weights), "--steps", "1", "--drawn", "2", "--batch", "2", "--device", "cpu"]
    assert main(["train", "align", *words, "--out", str(tmp_path / "out")]) == 1
    sentence = capsys.readouterr().err
    assert "another shape" in sentence and len(sentence.splitlines()) == 1
    assert not list(tmp_path.glob("out/*.safetensors"))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["align", "--reward", "accuracy"], "--reward accuracy"), (["align", "--steps", "0"], "1 or more"),
        (["align", "--other-sheets", "-1"], "0 or more"), (["align", "--learning-rate", "0"], "above 0"),
        (["align", "--variation-weight", "nan"], "finite"), (["align", "--anchor-weight", "-1"], "0 or more"),
        (["grpo", "--reward", "beauty"], "--reward"), (["grpo", "--temperature", "0"], "above 0"),
        (["grpo", "--calls", "0"], "1 or more"), (["grpo", "--reference", "-1"], "0 or more"),
        (["grpo", "--learning-rate", "nan"], "finite"), (["grpo", "--steps", "5"], "--steps 5"),
        (["prior", "--reward", "accuracy"], "--reward accuracy"), (["posterior"], "posterior"), ([], "COMMAND"),
    ],
)  # fmt: skip
def test_that_each_stage_takes_its_own_options_only(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, words: list[str], said: str
) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["train", *words, "--out", str(tmp_path / "out")])
    assert stopped.value.code == 2
    assert said in capsys.readouterr().err.splitlines()[-1]
    assert not (tmp_path / "out").exists()


def test_that_all_stages_show_their_own_examples(capsys: pytest.CaptureFixture[str]) -> None:
    shown = {}
    for words in ([], ["prior"], ["align"], ["grpo"]):
        with pytest.raises(SystemExit):
            main(["train", *words, "--help"])
        shown[" ".join(words)] = capsys.readouterr().out.split("examples:")[1]
    assert "train prior" in shown["prior"] and "train grpo" not in shown["prior"]
    assert "train grpo" in shown["grpo"] and "train prior" not in shown["grpo"]
    assert all(f"train {stage}" in shown[""] for stage in ("prior", "align", "grpo"))
    assert "train align" in shown["align"] and "train grpo" not in shown["align"]
