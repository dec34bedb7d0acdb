"""``train grpo`` from a file of weights to a file of weights, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import torch

from kirigami_studio.cli import main
from kirigami_studio.generator.network import NetworkShape, VelocityNetwork
from kirigami_studio.generator.weights import load_model, store_model

pytestmark = pytest.mark.torch


@pytest.fixture(scope="module")
def weights(tmp_path_factory: pytest.TempPathFactory) -> Path:
    torch.manual_seed(0)
    network = VelocityNetwork(NetworkShape(4, 4, 32, 64, 1, 16, 24, 32, 48))
    return store_model("prior", network, tmp_path_factory.mktemp("prior"), {})


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


@pytest.mark.parametrize(
    ("words", "said"),
    [
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


def test_that_both_stages_show_their_own_examples(capsys: pytest.CaptureFixture[str]) -> None:
    shown = {}
    for words in ([], ["prior"], ["grpo"]):
        with pytest.raises(SystemExit):
            main(["train", *words, "--help"])
        shown[" ".join(words)] = capsys.readouterr().out.split("examples:")[1]
    assert "train prior" in shown["prior"] and "train grpo" not in shown["prior"]
    assert "train grpo" in shown["grpo"] and "train prior" not in shown["grpo"]
    assert "train prior" in shown[""] and "train grpo" in shown[""]
