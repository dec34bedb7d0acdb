"""Damaged weights and dead workers: one sentence, and the rest goes on."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import signal
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from worker_processes import workers_of

from kirigami_studio.evaluate.candidate import Origin
from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.window.main_window import MainWindow

Until = Callable[[Callable[[], bool]], None]
pytestmark = pytest.mark.torch

#: Damages, by what the sentence about them says.
DAMAGES = {
    "truncated": "damaged",
    "missing": "missing",
    "other hash": "damaged",
    "other shape": "do not fit",
    "not finite": "not finite",
    "not safetensors": "do not fit",
    "manifest": "Cannot read the list of models",
}


@pytest.fixture
def models(tmp_path: Path, repository: Path) -> Path:
    """A copy of two bundled variants' weights: the damaged one and a whole one."""
    folder = tmp_path / "models"
    folder.mkdir()
    source = repository / "resources" / "models"
    listed = json.loads((source / "manifest.json").read_bytes())
    listed["variants"] = {name: listed["variants"][name] for name in ("paper", "paper-accuracy")}
    for entry in listed["variants"].values():
        shutil.copy(source / entry["file"], folder)
    (folder / "manifest.json").write_text(json.dumps(listed), encoding="utf-8")
    return folder


def damage(folder: Path, kind: str) -> None:
    """Damage the variant ``paper``."""
    listed = json.loads((folder / "manifest.json").read_bytes())
    entry = listed["variants"]["paper"]
    path = folder / entry["file"]
    content = path.read_bytes()
    if kind == "truncated":
        content = content[: len(content) // 2]
    elif kind == "missing":
        path.unlink()
        return
    elif kind == "other hash":
        entry["sha256"] = "0" * 64
    elif kind == "other shape":
        entry["shape"]["channels"] = [2 * channels for channels in entry["shape"]["channels"]]
    elif kind == "not finite":
        (length,) = struct.unpack("<Q", content[:8])
        numbers = np.frombuffer(content[8 + length :], dtype="<f2").copy()
        numbers[len(numbers) // 2] = np.nan
        content = content[: 8 + length] + numbers.tobytes()
        entry["sha256"] = hashlib.sha256(content).hexdigest()
    elif kind == "not safetensors":
        content = b"PK\x03\x04 no weights"
        entry["sha256"] = hashlib.sha256(content).hexdigest()
    path.write_bytes(content)
    text = "{" if kind == "manifest" else json.dumps(listed)
    (folder / "manifest.json").write_text(text, encoding="utf-8")


@pytest.mark.parametrize("kind", DAMAGES)
def test_that_damaged_weights_are_refused_in_a_sentence_and_the_others_load(models: Path, kind: str) -> None:
    from kirigami_studio.foundation.errors import ModelError
    from kirigami_studio.generator.weights import load_model

    damage(models, kind)
    with pytest.raises(ModelError) as refusal:
        load_model("paper", models)
    assert DAMAGES[kind] in str(refusal.value) and str(refusal.value).endswith(".")
    if kind != "manifest":
        assert load_model("paper-accuracy", models).variant == "paper-accuracy"


def test_that_the_window_tells_of_damaged_weights_and_runs_with_another_variant(
    window: MainWindow, models: Path, until: Until, monkeypatch: pytest.MonkeyPatch
) -> None:
    damage(models, "truncated")
    monkeypatch.setattr("kirigami_studio.generator.weights.model_folder", lambda: models)
    services = window.services
    services.targeting.start_with("square")
    until(lambda: services.session.document.target is not None)
    services.settings.change(variant="paper", k=2, grid=(4, 4), steps=2, polish=1)
    services.generation.generate()
    until(lambda: not services.run.running and not services.session.queue.busy)
    messages = [message for message in window.messages.messages if message.tone is Tone.ERROR]
    assert len(messages) == 1 and "damaged" in messages[0].sentence
    assert services.session.document.candidates == ()
    services.settings.change(variant="paper-accuracy")
    services.generation.generate()
    until(lambda: not services.run.running and not services.session.queue.busy)
    assert services.session.document.candidates


def test_that_a_run_goes_on_when_a_worker_process_is_killed(window: MainWindow, until: Until) -> None:
    services = window.services
    services.targeting.start_with("heart")
    until(lambda: services.session.document.target is not None)
    services.settings.change(k=24, grid=(8, 8))
    services.generation.generate()
    until(lambda: workers_of(os.getpid()) != [] or not services.run.running)
    workers = workers_of(os.getpid())
    assert workers != []
    for pid in workers:
        os.kill(pid, signal.SIGKILL)
    until(lambda: not services.run.running and not services.session.queue.busy)
    found = [one for one in services.session.document.candidates if one.origin is not Origin.COVERED]
    assert len(found) == 24
    before = services.session.document.candidates
    services.generation.again()
    until(lambda: not services.run.running and not services.session.queue.busy)
    assert len(services.session.document.candidates) > len(before)
