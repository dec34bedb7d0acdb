"""Training by several processes, as torchrun starts them: gloo on this machine's processor."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import torch
from command_line import refusal
from torchrun_program import CPU, SETTINGS, train

from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lab.training.learner import CHECKPOINT, Checkpoint
from kirigami_studio.lab.training.ranks import SEED_STEP, Ranks
from kirigami_studio.lab.training.train_flow import trained_network

pytestmark = pytest.mark.torch
TWO = (sys.executable, "-m", "torch.distributed.run", "--standalone", "--nproc-per-node", "2")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, repository: Path) -> Path:
    """What two processes left behind; one of their runs was begun by one process."""
    made = tmp_path_factory.mktemp("torchrun")
    train(made / "begun by one", 0.0)
    program = repository / "tests" / "torchrun_program.py"
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "start_new_session": True}
    for words in (("library", str(made)), ("command", str(made / "command"))):  # at once they might take one port
        with subprocess.Popen([*TWO, str(program), *words], **pipes) as process:
            try:
                printed, errors = process.communicate(timeout=300)
            finally:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGKILL)  # the launcher's end does not end what it started
        assert process.returncode == 0, errors
    (made / "printed.txt").write_text(printed)
    return made


def said(folder: Path, rank: int) -> dict:
    return json.loads((folder / f"rank-{rank}.json").read_text())


def test_that_the_gradient_of_two_halves_is_that_of_the_batch(folder: Path) -> None:
    assert max(said(folder, rank)["difference"] for rank in (0, 1)) < 1e-5


def test_that_two_processes_learn_what_one_learns_and_the_first_alone_writes(folder: Path, tmp_path: Path) -> None:
    by_two, by_one = said(folder, 0)["records"], train(tmp_path)
    assert said(folder, 1)["records"] == []
    assert len((folder / "whole" / "log.jsonl").read_text().splitlines()) == len(by_two) == len(by_one) == 3
    for records in (by_two, by_one):
        assert records[-1]["loss"] < 0.97 * records[0]["loss"]
    # Other data and noise: over seeds, these figures of one process differ by as much.
    for name in ("structured_iou", "sobol_iou"):
        assert by_two[-1][name] == pytest.approx(by_one[-1][name], abs=0.05)
    assert by_two[-1]["loss"] == pytest.approx(by_one[-1]["loss"], rel=0.2)


def test_that_a_run_of_two_is_gone_on_with_by_two_as_if_it_had_not_stopped(folder: Path) -> None:
    assert said(folder, 0)["stopped"][-1]["step"] == 1.0
    whole, parts = (trained_network(SETTINGS, folder / name, CPU).state_dict() for name in ("whole", "parts"))
    assert all(torch.equal(whole[name], parts[name]) for name in whole)
    assert len(Checkpoint.load(folder / "whole" / CHECKPOINT).others) == 1


def test_that_a_run_is_gone_on_with_by_another_number_of_processes(folder: Path) -> None:
    assert Checkpoint.load(folder / "begun by one" / CHECKPOINT).step == SETTINGS.steps
    assert Checkpoint.load(folder / "begun by two" / CHECKPOINT).step == 1
    train(folder / "begun by two")
    ends = []
    for name in ("whole", "begun by one", "begun by two"):
        lines = (folder / name / "log.jsonl").read_text().splitlines()
        assert [json.loads(line)["step"] for line in lines][-1] == SETTINGS.steps
        ends.append(json.loads(lines[-1])["structured_iou"])
    assert np.ptp(ends) < 0.05


def test_that_the_command_trains_under_torchrun_and_speaks_once(folder: Path) -> None:
    (line,) = (folder / "printed.txt").read_text().splitlines()
    assert json.loads(line)["record"]["step"] == 2.0
    assert json.loads(line)["files"] == [str(folder / "command" / "cgan.safetensors")]
    assert (folder / "command" / "cgan.safetensors").exists()


def test_that_one_process_is_the_first_with_the_seed_and_batch_of_the_run() -> None:
    alone, second = Ranks.present(), Ranks(1, 2)
    assert (alone.first, alone.seed(5), alone.share(7)) == (True, 5, 7)
    assert (second.first, second.seed(5), second.share(8)) == (False, 5 + SEED_STEP, 4)
    assert alone.means({"loss": 2.0}) == {"loss": 2.0}
    with pytest.raises(UsageError) as caught:
        second.share(7)
    assert caught.value.code == "training.batch_not_shared"


def test_that_grpo_is_refused_with_several_processes(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setenv("TORCHELASTIC_RUN_ID", "test")
    monkeypatch.setenv("WORLD_SIZE", "2")
    code, sentence = refusal(capsys, "train", "grpo", "--out", tmp_path)
    assert (code, "torchrun" in sentence) == (2, True)
