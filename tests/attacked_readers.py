"""Reads files that are made to hurt, in a process with little memory; ``READER=FILE ...``, a line of JSON for each."""

from __future__ import annotations

import hashlib
import itertools
import json
import os
import resource
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

from kirigami_studio.cli.inputs import read_mask
from kirigami_studio.evaluate.mask_siou import mask_siou
from kirigami_studio.export.artwork_picture import read_picture
from kirigami_studio.export.dxf_check import check_file
from kirigami_studio.export.dxf_reading import read_with_ezdxf
from kirigami_studio.export.group_codes import read_group_codes
from kirigami_studio.export.svg_reading import read_with_svgelements, read_with_xml
from kirigami_studio.fabricate.material import read_preset
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.sheet_files import read_sheet
from kirigami_studio.mechanics.network_files import SpringConstants, read_network
from kirigami_studio.outlines.read import read_parts, read_target
from kirigami_studio.project import preferences, recent, recovery, store

#: Memory (bytes) that reading may take beside what the program takes.
MOST_MEMORY = 2**30


def checked(path: Path) -> None:
    check_file(path)


def verified_dxf(path: Path) -> None:
    attempted(path, read_with_ezdxf, read_group_codes)


def verified_svg(path: Path) -> None:
    attempted(path, read_with_svgelements, read_with_xml)


def attempted(path: Path, *readers: Callable[[Path], object]) -> None:
    """Have all read it, and refuse it as the last one that did."""
    refusal: KirigamiError | None = None
    for reader in readers:
        try:
            reader(path)
        except KirigamiError as error:
            refusal = error
    if refusal is not None:
        raise refusal


def target(path: Path) -> None:
    read_target(str(path))


def parts(path: Path) -> None:
    read_parts(str(path))


def mask(path: Path) -> None:
    read = read_mask(path)
    mask_siou(read, read)


def sheet(path: Path) -> None:
    deploy(read_sheet(path)).outline(0.0)


def archive(path: Path) -> None:
    """Its fields, and its masks, as the command line reads them."""
    from kirigami_studio.cli.inputs import read_sheets, read_targets

    attempted(
        path,
        lambda file: [named.read() for named in itertools.islice(read_sheets([str(file)]), 3)],
        lambda file: [named.read() for named in itertools.islice(read_targets([str(file)]), 3)],
    )


def network(path: Path) -> None:
    read_network(path, SpringConstants(1.0, 1.0, 1.0))


def artwork(path: Path) -> None:
    from kirigami_studio.gui.stage.artwork_painting import svg_to_png

    read_picture(path, svg_to_png)


def opened(path: Path) -> None:
    """A file that is dropped on the window or opened there."""
    from kirigami_studio.studio.parts import reading_source

    for _ in reading_source(str(path), lambda: False):
        pass


def pasted(path: Path) -> None:
    """Text from the clipboard."""
    from kirigami_studio.gui.target.pasting import recognised

    found = recognised(path.read_bytes().decode("utf-8", "replace"))
    if found is not None:
        ending, text = found
        place = Path(_FOLDER.name, f"pasted{ending}")
        place.write_text(text, encoding="utf-8", errors="replace")
        opened(place)


#: What readers are given beside a file; it ends with the process.
_FOLDER = tempfile.TemporaryDirectory(prefix="kirigami-studio-readers")


@cache
def model_folder() -> Path:
    """Small weights with their manifest, in a folder."""
    from small_networks import random_network

    from kirigami_studio.lab.trained_weights import store_model

    folder = Path(_FOLDER.name)
    store_model("a", random_network(), folder, {})
    return folder


def weights(path: Path) -> None:
    """A file of weights that its manifest knows."""
    from kirigami_studio.generator import weights as models

    folder = model_folder()
    entries = json.loads((folder / models.MANIFEST).read_bytes())
    content = path.read_bytes()
    (folder / "b.safetensors").write_bytes(content)
    entries["variants"]["b"] = entries["variants"]["a"] | {
        "sha256": hashlib.sha256(content).hexdigest(), "file": "b.safetensors"
    }  # fmt: skip
    (folder / models.MANIFEST).write_text(json.dumps(entries), encoding="utf-8")
    models.load_model.cache_clear()
    models.load_model("b", folder)


def manifest(path: Path) -> None:
    """The list of the weights in a folder."""
    from kirigami_studio.generator import weights as models
    from kirigami_studio.lab.trained_weights import variants_about

    folder = model_folder()
    shutil.copy(path, folder / models.MANIFEST)
    models.load_model.cache_clear()
    attempted(folder, models.variants, variants_about, lambda place: models.digest_of("a", place))
    for variant in models.variants(folder)[:3]:
        attempted(folder, partial(models.load_model, variant))


def baseline(path: Path) -> None:
    from kirigami_studio.lab.baselines.stored import load_generator

    load_generator(path)


def training(path: Path) -> None:
    """Archives that training reads."""
    from kirigami_studio.lab.training.dataset import Split
    from kirigami_studio.lab.training.first_designs import FirstDesigns
    from kirigami_studio.lab.training.fitted_fields import FittedFields

    attempted(path, Split.load, FittedFields.load, FirstDesigns.load)


def checkpoint(path: Path) -> None:
    from kirigami_studio.lab.training.learner import Checkpoint

    Checkpoint.load(path)


def runs(path: Path) -> None:
    """What a suite has finished."""
    from kirigami_studio.lab.benchmark.run_store import RunStore

    with RunStore.opened({"a": 1}, path):
        pass


@dataclass(frozen=True)
class Reader:
    """One way into the program.

    Attributes
    ----------
    read : callable
    endings : tuple of str
        Of the files that it is given; the first one where content does not tell.
    """

    read: Callable[[Path], object]
    endings: tuple[str, ...]


READERS = {
    "target": Reader(target, (".svg", ".dxf", ".json", ".png", ".pdf", ".webp", ".tif", ".gif")),
    "parts": Reader(parts, (".svg", ".dxf", ".png", ".pdf", ".tif")),
    "check": Reader(checked, (".dxf",)),
    "dxf": Reader(verified_dxf, (".dxf",)),
    "svg": Reader(verified_svg, (".svg",)),
    "mask": Reader(mask, (".png",)),
    "sheet": Reader(sheet, (".npy", ".json")),
    "material": Reader(read_preset, (".toml",)),
    "preferences": Reader(preferences.load, (".toml",)),
    "recent": Reader(recent.load, (".toml",)),
    "project": Reader(store.load_all, (".kiri",)),
    "recovery": Reader(recovery.read_note, (".kiri",)),
    "carried": Reader(store.load_all, (".dxf", ".svg")),
    "opened": Reader(opened, (".svg", ".dxf", ".json", ".png", ".pdf")),
    "pasted": Reader(pasted, (".svg", ".json")),
    "artwork": Reader(artwork, (".svg", ".png")),
    "archive": Reader(archive, (".npz",)),
    "network": Reader(network, (".npz",)),
    "weights": Reader(weights, (".safetensors",)),
    "manifest": Reader(manifest, (".json",)),
    "baseline": Reader(baseline, (".safetensors",)),
    "training": Reader(training, (".npz",)),
    "checkpoint": Reader(checkpoint, (".pt",)),
    "runs": Reader(runs, (".jsonl",)),
}


#: The reader of targets on files of one kind each.
KINDS = {
    "target-svg": Reader(target, (".svg",)),
    "target-dxf": Reader(target, (".dxf",)),
    "target-pdf": Reader(target, (".pdf",)),
    "target-picture": Reader(target, (".png", ".webp", ".tif", ".gif", ".jpg")),
}
#: Readers that load torch.
LEARNED = frozenset({"weights", "manifest", "baseline", "training", "checkpoint", "runs"})


def faulty(path: Path) -> None:
    """A reader with two faults, to see that the suite finds them: it knows the number of a file."""
    number = path.with_suffix(".now")
    if number.exists() and number.read_text() == "2":
        os.kill(os.getpid(), signal.SIGKILL)
    if number.exists() and number.read_text() == "4":
        raise ValueError("a fault")


#: Readers that are not the program's.
FAULTY = {"faulty": Reader(faulty, (".toml",))}
ALL = READERS | KINDS | FAULTY


def outcome(reader: Reader, path: Path) -> str:
    """The sentence that a person gets; empty where the file is fine."""
    try:
        reader.read(path)
    except KirigamiError as error:
        return f"refused: {error}"
    except BaseException as error:
        return f"UNCAUGHT {type(error).__name__}: {error}"
    return "read"


if __name__ == "__main__":
    if LEARNED & {word.partition("=")[0] for word in sys.argv[1:]}:
        model_folder()  # with torch, which takes a gigabyte of addresses
    for asked in sys.argv[1:]:
        reader, _, name = asked.partition("=")
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + MOST_MEMORY, resource.RLIM_INFINITY))
        begun = time.process_time()
        found = outcome(READERS[reader], Path(name))
        line = {
            "reader": reader, "name": Path(name).name, "seconds": time.process_time() - begun, "outcome": found
        }  # fmt: skip
        sys.stdout.write(f"{json.dumps(line)}\n")
        sys.stdout.flush()
