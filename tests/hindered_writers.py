"""Everything that the program writes, hindered: killed, out of room, without permission.  A line of JSON for each.

``kills --count 200`` kills a process that writes again and again, at random moments and in the midst of files;
``full`` lets no file grow beyond a few bytes, as on a full disk; ``readonly`` takes away the right to write, as another
user.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import resource
import signal
import sys
import time
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.registry import WRITERS, export
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.project import preferences, recent, recovery, store
from kirigami_studio.project.preferences import Preferences
from kirigami_studio.project.recent import Recent
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.cutting import plan_sheet

RESOURCES = Path(__file__).parents[1] / "resources"
#: Different contents that a file goes through.
VERSIONS = 3
#: Longest time (seconds) that a writer lives before it is killed.
LONGEST_LIFE = 0.03
#: Bytes that a file may have where there is no room.
ROOM = 40
#: User and group without rights: nobody.
NOBODY = 65534

Writer = Callable[[Path, int], object]


def documents() -> list[Writer]:
    """Projects, and what is kept of them for a crash."""
    example = store.load(RESOURCES / "examples" / "heart.kiri")
    versions = [
        replace(example, fabrication=replace(example.fabrication, width_mm=100.0 + number))
        for number in range(VERSIONS)
    ]
    note = recovery.RecoveryNote("a", "", recovery.now())
    return [
        lambda folder, number: store.save(versions[number], folder / "a.kiri"),
        lambda folder, number: recovery.keep(versions[number], note, folder / "b.kiri"),
    ]


def settings() -> list[Writer]:
    return [
        lambda folder, number: preferences.save(Preferences(width_mm=100.0 + number), folder / "preferences.toml"),
        lambda folder, number: recent.save(Recent((f"/{number}.kiri",), ()), folder / "recent.toml"),
    ]


def exports(endings: tuple[str, ...]) -> list[Writer]:
    """Cut files, pictures and animations of a small sheet."""
    sheets = [deploy(RatioField.uniform(2, 2 + number)) for number in range(VERSIONS)]
    jobs = [ExportJob(sheet, plan=plan_sheet(sheet, FabricationSettings(60.0))) for sheet in sheets]

    def writer(ending: str) -> Writer:
        return lambda folder, number: export(jobs[number], folder / f"c{ending}")

    return [writer(ending) for ending in endings]


def learned() -> list[Writer]:
    """What training and benchmarks write."""
    import numpy as np
    import torch
    from small_networks import random_network

    from kirigami_studio.lab.benchmark.run_store import RunStore
    from kirigami_studio.lab.trained_weights import store_model
    from kirigami_studio.lab.training.dataset import Split
    from kirigami_studio.lab.training.learner import Checkpoint

    network = random_network()

    def checkpoint(folder: Path, number: int) -> None:
        tensors = {"a": torch.full((9,), float(number))}
        Checkpoint(number, tensors, tensors, {}, {}, torch.get_rng_state()).save(folder / "checkpoint.pt")

    def runs(folder: Path, number: int) -> None:
        with RunStore.opened({"a": 1}, folder / "runs" / "runs.jsonl") as store_of_runs:
            store_of_runs.add(("a", number, time.time_ns()), {"iou": 0.5, "long": "x" * 50})

    def split(folder: Path, number: int) -> None:
        Split(np.full((1, 2, 2), 1.0 + number), np.ones((1, 8, 8), np.bool_), {}).save(folder / "split.npz")

    return [checkpoint, runs, split, lambda folder, number: store_model("a", network, folder, {"number": number})]


def killed(count: int, seed: int, folder: Path) -> None:
    """Kill writers; say what was left of their files each time."""
    draw = random.Random(seed)
    writers = [*documents(), *settings(), *exports((".dxf",))]
    whole = list[dict[str, object]]()
    for number in range(VERSIONS):
        for writer in writers:
            writer(folder, number)
        whole.append({path.name: content_of(path) for path in folder.iterdir()})
    for number in range(count):
        before = set(folder.iterdir())  # with what killed writers have left
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            os.close(reading)
            _write_for_ever(writers, folder, writing)
        os.close(writing)
        os.read(reading, 1)  # it has begun
        if number % 2:  # in the midst of a file, however seldom the writer is in one
            while set(folder.iterdir()) <= before:
                pass
        else:
            time.sleep(draw.uniform(0.0, LONGEST_LIFE))
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        os.close(reading)
        present = {path.name: content_of(path) for path in folder.iterdir() if not path.name.startswith(".")}
        broken = [
            name for name in whole[0] if present.get(name) not in [contents[name] for contents in whole]
        ]  # fmt: skip
        litter = [path.name for path in folder.iterdir() if path.name not in whole[0]]
        tell({"broken": broken, "litter": litter})


def content_of(path: Path) -> object:
    """The bytes of a file; of an archive its members, since it also says when it was written."""
    if path.suffix != ".kiri":
        return path.read_bytes()
    try:
        with zipfile.ZipFile(path) as archive:
            return {name: archive.read(name) for name in archive.namelist()}
    except zipfile.BadZipFile:
        return "damaged"


def _write_for_ever(writers: list[Writer], folder: Path, begun: int) -> None:
    """Never returns: the process is killed."""
    number = 0
    os.write(begun, b"x")
    while True:
        number = (number + 1) % VERSIONS
        for writer in random.sample(writers, len(writers)):
            writer(folder, number)


def refused(folder: Path, hinder: Callable[[Path], None]) -> None:
    """Write everything, hinder that, and say how every writer takes it."""
    writers = {
        **{f"document {k}": writer for k, writer in enumerate(documents())},
        **{f"settings {k}": writer for k, writer in enumerate(settings())},
        **dict(zip(WRITERS, exports(tuple(WRITERS)), strict=True)),
        **{f"learned {k}": writer for k, writer in enumerate(learned())},
    }
    for writer in writers.values():
        writer(folder, 0)
    before = contents(folder)
    hinder(folder)
    for name, writer in writers.items():
        try:
            writer(folder, 1)
            said = "written"
        except KirigamiError as error:
            said = f"refused: {error}"
        except BaseException as error:
            said = f"UNCAUGHT {type(error).__name__}: {error}"
        after = contents(folder)
        changed = sorted(path for path in before.keys() | after.keys() if before.get(path) != after.get(path))
        tell({"writer": name, "said": said, "changed": changed})


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def no_room(_folder: Path) -> None:
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (ROOM, resource.RLIM_INFINITY))


def no_permission(folder: Path) -> None:
    """Nobody may read all and change nothing."""
    for path in (folder, *folder.rglob("*")):
        path.chmod(0o555 if path.is_dir() else 0o444)
    os.setgroups([])
    os.setgid(NOBODY)
    os.setuid(NOBODY)


def tell(line: dict[str, object]) -> None:
    sys.stdout.write(f"{json.dumps(line)}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("how", choices=["kills", "full", "readonly"])
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--folder", type=Path, required=True)
    asked = parser.parse_args()
    asked.folder.mkdir(parents=True, exist_ok=True)
    if asked.how == "kills":
        killed(asked.count, asked.seed, asked.folder)
    else:
        refused(asked.folder, no_room if asked.how == "full" else no_permission)
