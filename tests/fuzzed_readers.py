"""Damages files and reads them: ``python tests/fuzzed_readers.py --inputs 20000 --jobs 2 --out FOLDER [READER ...]``.

Readers work in processes of their own, which read one file after another.  A file that takes too much time or memory
ends its process, and another one goes on behind it.  Files that end in anything but an answer or one sentence are kept
in the folder; those belong into ``tests/data/attacks``, as small as they can be made.  Same seed, same files: what a
stopped run has finished is in the folder's journal, and is not read again.  How files are damaged, and why no fuzzing
library does it: ``damaged_files``.
"""

from __future__ import annotations

import argparse
import contextlib
import gc
import io
import json
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
import zipfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path
from types import FrameType

from damaged_files import LONGEST, mutated

TESTS = Path(__file__).parent
RESOURCES = TESTS.parent / "resources"
ATTACKS = TESTS / "data" / "attacks"
#: Seconds of processor time, and bytes of memory beside what the program takes, that one file may cost.
MOST_SECONDS, MOST_MEMORY = 5.0, 2 * 2**30
#: Seconds by the clock after which a file that is still being read is given up: the machine may be busy.
MOST_WAITING = 600.0
#: Files that one process reads.
SHARE = 1000
#: A seed of so many bytes is chosen half as often as an empty one, and one that hurt once this much more seldom.
USUAL_SIZE, SELDOM = 2000, 0.2


def sources(reader: str) -> list[tuple[bytes, float]]:
    """What the files of a reader are made from, with how often each is chosen: small ones more often."""
    from attacked_readers import ALL

    places = (TESTS / "data", RESOURCES / "examples", RESOURCES / "silhouettes", RESOURCES / "materials")
    endings = ALL[reader].endings
    found = sorted(path for place in places for path in place.rglob("*") if path.suffix.lower() in endings)
    contents = [
        (path.read_bytes(), SELDOM if ATTACKS in path.parents else 1.0)
        for path in found
        if path.stat().st_size <= LONGEST
    ]
    contents += [(content, 5.0) for content in whole(reader)]
    return [(content, often / (1.0 + len(content) / USUAL_SIZE)) for content, often in contents]


def whole(reader: str) -> list[bytes]:
    """Files that the program itself writes, and small ones of every kind that it reads."""

    if reader in ("check", "dxf", "svg", "target", "parts", "carried", "opened", "pasted") or reader.startswith(
        "target-"
    ):
        return _drawings(reader)
    if reader in ("mask", "artwork"):
        return [_picture("PNG"), *([SVG] if reader == "artwork" else [])]
    if reader in ("sheet", "archive", "network", "training"):
        return _arrays(reader)
    if reader in ("weights", "manifest", "baseline", "checkpoint"):
        return _learned(reader)
    if reader == "project":
        return _projects()
    stream = io.BytesIO()
    if reader == "recovery":
        with zipfile.ZipFile(stream, "w") as archive:
            archive.writestr("recovery.json", '{"name": "a", "path": "", "changed": "2026-01-01T00:00:00+00:00"}')
    texts = {
        "preferences": b'tour_seen = true\nlanguage = "de"\ntheme = "dark"\nwidth_mm = 100.0\nsize = "flat"\n',
        "recent": b'projects = ["/a.kiri"]\ntargets = ["/a.svg", "heart"]\n',
        "runs": b'{"settings": {"a": 1}}\n{"key": ["a", 1], "iou": 0.5}\n{"key": ["b", 2], "iou": 0.25}\n',
    }
    content = stream.getvalue() or texts.get(reader, b"")
    return [content] if content else []


#: Something of all that drawings are made of.
SVG = b"""<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="30mm" viewBox="0 0 40 30">
<defs><g id="a"><circle r="2"/></g>
<linearGradient id="p"><stop offset="0" stop-color="red"/></linearGradient></defs>
<g transform="translate(2 3) rotate(10)">
<path d="M0 0h9v9l-3-3C1 2 3 4 5 6S7 8 9 1Q1 1 2 2T3 3A4 5 6 0 1 7 8Z" fill="url(#p)" stroke="#f00"/>
<use href="#a" x="9"/>
<rect x="20" y="3" width="9" height="9" rx="1"/><polygon points="1,20 9,20 5,28"/>
<ellipse cx="30" cy="20" rx="5" ry="3"/></g></svg>"""


def _picture(kind: str) -> bytes:
    from PIL import Image, ImageDraw

    stream = io.BytesIO()
    picture = Image.new("L", (60, 40))
    ImageDraw.Draw(picture).ellipse((5, 5, 50, 35), fill=255)
    picture.save(stream, kind)
    return stream.getvalue()


def _page() -> bytes:
    from reportlab.pdfgen.canvas import Canvas

    stream = io.BytesIO()
    page = Canvas(stream, pagesize=(60, 40), pageCompression=0)
    page.beginForm("a")
    page.circle(5, 5, 4, fill=1)
    page.endForm()
    page.rect(5, 5, 30, 20, fill=1)
    page.translate(40, 10)
    page.doForm("a")
    page.drawString(3, 3, "i")
    page.save()
    return stream.getvalue()


def _drawings(reader: str) -> list[bytes]:
    import ezdxf
    from attacked_readers import ALL

    from kirigami_studio.export.dxf import dxf_bytes
    from kirigami_studio.export.exporter import ExportJob
    from kirigami_studio.export.profile import find_profile
    from kirigami_studio.export.svg import cut_svg_bytes
    from kirigami_studio.lattice.deployment import deploy
    from kirigami_studio.lattice.ratio_field import RatioField
    from kirigami_studio.project import store
    from kirigami_studio.settings.fabrication import FabricationSettings
    from kirigami_studio.studio.cutting import plan_sheet

    design = deploy(RatioField.uniform(3, 3))
    plan = plan_sheet(design, FabricationSettings(60.0, connector_mm=0.8))
    record = b""
    if reader in ("carried", "opened"):
        document = store.load(RESOURCES / "examples" / "heart.kiri")
        record = store.packed_design(document, document.candidates[0])
    job = ExportJob(design, plan=plan, record=record)
    any_machine = find_profile("any")
    drawing = ezdxf.new("R2000", setup=False)
    space = drawing.modelspace()
    space.add_lwpolyline([(0, 0), (9, 0, 0, 0, 0.5), (9, 9), (0, 9)], close=True)
    space.add_spline([(20, 0), (25, 5), (30, 0), (20, 0)])
    space.add_ellipse((40, 0), (5, 0), 0.5)
    drawing.blocks.new("A").add_circle((0, 0), 2)
    space.add_blockref("A", (60, 0))
    text = io.StringIO()
    drawing.write(text)
    of = {
        ".dxf": [dxf_bytes(plan, "R2010", any_machine, record=record), dxf_bytes(plan, "R12", any_machine)],
        ".svg": [cut_svg_bytes(job), SVG],
        ".json": [b"[[0, 0], [1, 0], [1, 1], [0.5, 0.2], [0, 1]]"],
        ".png": [_picture("PNG")],
        ".webp": [_picture("WEBP")],
        ".tif": [_picture("TIFF")],
        ".gif": [_picture("GIF")],
        ".jpg": [_picture("JPEG")],
        ".pdf": [_page()],
    }
    of[".dxf"].append(text.getvalue().encode())
    return [content for ending in ALL[reader].endings for content in of[ending]]


def _arrays(reader: str) -> list[bytes]:
    import numpy as np

    def packed(**arrays: object) -> bytes:
        stream = io.BytesIO()
        np.savez_compressed(stream, **arrays)
        return stream.getvalue()

    if reader == "sheet":
        stream = io.BytesIO()
        np.save(stream, np.full((3, 4), 1.25))
        return [stream.getvalue()]
    if reader == "archive":
        masks = np.zeros((2, 32, 32), dtype=np.bool_)
        masks[:, 5:25, 8:20] = True
        return [packed(ratios=np.full((2, 3, 4), 1.25)), packed(masks=masks)]
    if reader == "network":
        quads = 0.01 * np.array([[[0, 0], [1, 0], [1, 1], [0, 1]], [[1, 1], [2, 1], [2, 2], [1, 2]]], dtype=np.float64)
        return [
            packed(quads_m=quads, bonds=np.array([[0, 2, 1, 0]])),
            packed(quads_m=quads, bonds=np.zeros((0, 4), int)),
        ]
    about = np.array('{"sha256": ""}')
    fits = {name: np.ones((2, 3)) for name in ("z", "requested", "iou", "shape", "candidate", "block")}
    return [packed(ratios=np.ones((2, 3, 3)), masks=np.ones((2, 8, 8), bool), about=about), packed(about=about, **fits)]


def _learned(reader: str) -> list[bytes]:
    """Files of small networks."""
    import torch
    from attacked_readers import model_folder

    if reader in ("weights", "manifest"):
        return [(model_folder() / ("a.safetensors" if reader == "weights" else "manifest.json")).read_bytes()]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "a")
        if reader == "baseline":
            from kirigami_studio.lab.baselines.conditional import FieldPixels
            from kirigami_studio.lab.baselines.cvae import Cvae
            from kirigami_studio.lab.baselines.stored import store_generator

            store_generator("cvae", Cvae(FieldPixels(3, 3)), path, {})
        else:
            from kirigami_studio.lab.training.learner import Checkpoint

            tensors = {"a": torch.ones(2, 2)}
            Checkpoint(1, tensors, tensors, {"state": {}}, {"rate": 0.1}, torch.get_rng_state()).save(path)
        return [path.read_bytes()]


def _projects() -> list[bytes]:
    """A project with one design, and one with a picture behind the target and artwork on the sheet."""
    from dataclasses import replace

    from kirigami_studio.export.artwork import ArtPicture, Artwork, Laid
    from kirigami_studio.project import store
    from kirigami_studio.project.picture_record import TracedPicture

    document = store.load(RESOURCES / "examples" / "heart.kiri")
    small = store.packed_design(document, document.candidates[0])
    picture = _picture("PNG")
    traced = TracedPicture("a.png", picture, 0.5, 0.5, 30.0, (30.0, 20.0), (60, 40))
    alone = replace(document, candidates=(), chosen=None, marks=(), labels=())
    pictured = replace(alone, artwork=Artwork(Laid(ArtPicture("a.png", picture, (60, 40)))))
    return [small, store.pack(alone), store.pack(pictured, traced)]


class _TooLongError(BaseException):
    """A file took all of its time."""


def _stop(_signal: int, _frame: FrameType | None) -> None:
    raise _TooLongError


def read_many(reader: str, first: int, last: int, seed: int, folder: Path) -> None:
    """Read damaged files one by one, in this process; JSON for each that did not end well, and at the end."""
    from attacked_readers import ALL, outcome

    signal.signal(signal.SIGPROF, _stop)
    seeds = sources(reader)
    originals, weights = [content for content, _ in seeds], list(accumulate(often for _, often in seeds))
    place = folder / f"{reader}.{first}.now"
    _warm(reader, originals, place)
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + MOST_MEMORY, resource.RLIM_INFINITY))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    slowest, slowest_number, begun_all = 0.0, first, time.process_time()
    for number in range(first, last):
        draw = random.Random(f"{seed} {reader} {number}")
        original = draw.choices(originals, cum_weights=weights)[0]
        content = mutated(original, originals, draw)
        ending = draw.choice(ALL[reader].endings) if draw.random() < 0.05 else ending_of(original, reader)
        path = folder / f"{reader}.{first}{ending}"
        path.write_bytes(content)
        place.write_text(str(number))
        begun = time.process_time()
        # What a reader in C does not give back, the process pays for.
        resource.setrlimit(resource.RLIMIT_CPU, (int(begun + 3 * MOST_SECONDS) + 1, resource.RLIM_INFINITY))
        signal.setitimer(signal.ITIMER_PROF, MOST_SECONDS)
        try:
            found = outcome(ALL[reader], path)
        except _TooLongError:
            found = "UNCAUGHT too long"
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        seconds = time.process_time() - begun
        if seconds > slowest:
            slowest, slowest_number = seconds, number
        said = found.removeprefix("refused: ")
        if said != found and ("\n" in said or not said.endswith(".") or len(said) > 600):
            found = f"UNCAUGHT no sentence: {said[:200]!r}"
        if found.startswith("UNCAUGHT"):
            kept = folder / f"{reader}_{seed}_{number}{ending}"
            path.replace(kept)
            tell(json.dumps({"file": kept.name, "outcome": found}))
        path.unlink(missing_ok=True)
    place.unlink(missing_ok=True)
    resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    peak = max(0, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) * 1024
    took = time.process_time() - begun_all
    tell(json.dumps({"done": last, "seconds": took, "slowest": slowest, "number": slowest_number, "peak": peak}))


def _warm(reader: str, originals: Sequence[bytes], place: Path) -> None:
    """Have the program import what it reads with, so that this does not count as a file's time and memory."""
    from attacked_readers import ALL, outcome

    for ending in ALL[reader].endings:
        matching = [content for content in originals if ending_of(content, reader) == ending]
        path = place.with_suffix(ending)
        path.write_bytes(min(matching or originals, key=len))
        with contextlib.suppress(_TooLongError):
            outcome(ALL[reader], path)
        path.unlink(missing_ok=True)
    gc.collect()


def tell(line: str) -> None:
    """Print a line at once."""
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def ending_of(content: bytes, reader: str) -> str:
    """The ending that a file of such content has."""
    from attacked_readers import ALL

    endings = ALL[reader].endings
    beginnings = {b"PK": ".kiri", b"\x89PNG": ".png", b"\x93NUMPY": ".npy", b"{": ".json", b"[": ".json"}
    for beginning, ending in beginnings.items():
        if content.startswith(beginning) and ending in endings:
            return ending
    if b"<svg" in content[:2000] and ".svg" in endings:
        return ".svg"
    text = [ending for ending in endings if ending in (".dxf", ".toml")]
    return text[0] if text else endings[0]


@dataclass(frozen=True)
class Found:
    """A file that did not end in an answer or a sentence."""

    file: str
    outcome: str


@dataclass(frozen=True)
class Share:
    """What became of a stretch of numbers.

    Attributes
    ----------
    first, last : int
    found : tuple of Found
    seconds : float
        Of processor time.
    slowest : float, seconds
    number : int
        Of the file that was slowest.
    peak : int, bytes
        Of memory, beside what the program had.
    """

    first: int
    last: int
    found: tuple[Found, ...]
    seconds: float = 0.0
    slowest: float = 0.0
    number: int = 0
    peak: int = 0


def read_share(reader: str, first: int, last: int, seed: int, folder: Path) -> Share:
    """Have a stretch of numbers read, in as many processes as it ends."""
    found, at = list[Found](), first
    sums = {"seconds": 0.0, "slowest": 0.0, "number": first, "peak": 0}
    while at < last:
        place = folder / f"{reader}.{at}.now"
        place.write_text(str(at))
        child = started(reader, "--from", at, "--inputs", last, "--seed", seed, "--out", folder)
        output, errors = _ended(child, place)
        for line in output.splitlines():
            if line.startswith('{"file"'):
                found.append(Found(**json.loads(line)))
            elif line.startswith('{"done"'):
                told = json.loads(line)
                if told["slowest"] > sums["slowest"]:
                    sums |= {"slowest": told["slowest"], "number": told["number"]}
                sums["seconds"] += told["seconds"]
                sums["peak"] = max(sums["peak"], told["peak"])
        if child.returncode == 0:
            break
        if child.returncode > 0:  # not killed: the fault is here
            raise RuntimeError(errors[-2000:])
        reached = int(place.read_text())
        place.unlink()
        for path in folder.glob(f"{reader}.{at}.*"):
            path.replace(folder / f"{reader}_{seed}_{reached}{path.suffix}")
        found.append(Found(f"{reader}_{seed}_{reached}", f"ended by signal {-child.returncode}: {errors[-300:]}"))
        at = reached + 1
    return Share(first, last, tuple(found), **sums)


def started(*words: object) -> subprocess.Popen[str]:
    """This program with some arguments."""
    return subprocess.Popen(
        [sys.executable, __file__, *map(str, words)],
        env=os.environ | {"PYTHONWARNINGS": "ignore", "PYTHONPATH": os.pathsep.join([str(TESTS), *sys.path])},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def _ended(child: subprocess.Popen[str], place: Path) -> tuple[str, str]:
    """What a process said until it ended, or was ended because a file took too long by the clock."""
    reached, since = "", time.monotonic()
    while True:
        with contextlib.suppress(subprocess.TimeoutExpired):
            return child.communicate(timeout=2.0)
        now = place.read_text() if place.exists() else ""
        if now != reached:
            reached, since = now, time.monotonic()
        elif time.monotonic() - since > MOST_WAITING:
            child.kill()


def fuzzed(reader: str, inputs: int, seed: int, folder: Path, jobs: int = 1) -> Iterator[Share]:
    """Have a reader read damaged files, ``jobs`` processes at a time; what the journal has is not read again."""
    folder.mkdir(parents=True, exist_ok=True)
    journal, known = folder / f"{reader}-{seed}.jsonl", dict[tuple[int, int], Share]()
    for line in journal.read_text().splitlines() if journal.exists() else ():
        entry = json.loads(line)
        share = Share(**entry | {"found": tuple(Found(**one) for one in entry["found"])})
        known[share.first, share.last] = share
    stretches = [(first, min(first + SHARE, inputs)) for first in range(0, inputs, SHARE)]
    yield from (known[stretch] for stretch in stretches if stretch in known)
    with ThreadPoolExecutor(jobs) as pool:
        missing = [stretch for stretch in stretches if stretch not in known]
        for share in pool.map(lambda stretch: read_share(reader, *stretch, seed, folder), missing):
            with journal.open("a") as stream:
                entry = vars(share) | {"found": [vars(one) for one in share.found]}
                stream.write(f"{json.dumps(entry)}\n")
            yield share


def main() -> int:
    from attacked_readers import ALL, READERS

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("readers", nargs="*", choices=[*ALL, []])
    parser.add_argument("--inputs", type=int, default=1000, help="files for each reader")
    parser.add_argument("--jobs", type=int, default=1, help="processes beside each other")
    parser.add_argument("--minutes", type=float, default=float("inf"), help="begin with no reader after these")
    parser.add_argument("--from", type=int, dest="first", help="read in this process, from this number on")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, required=True)
    asked = parser.parse_args()
    if asked.first is not None:
        for name in asked.readers or READERS:
            read_many(name, asked.first, asked.inputs, asked.seed, asked.out)
        return 0
    bad, begun_all = 0, time.monotonic()
    for name in asked.readers or READERS:
        if time.monotonic() - begun_all > 60.0 * asked.minutes:
            tell(f"{name}: not begun")
            continue
        begun, shares = time.monotonic(), []
        for share in fuzzed(name, asked.inputs, asked.seed, asked.out, asked.jobs):
            shares.append(share)
            for found in share.found:
                tell(f"  {found.file}: {found.outcome}")
        faults, worst = sum(len(share.found) for share in shares), max(shares, key=lambda share: share.slowest)
        seconds, peak = sum(share.seconds for share in shares), max(share.peak for share in shares)
        bad += faults
        tell(
            f"{name}: {asked.inputs} files, {faults} bad, {time.monotonic() - begun:.0f} s "
            f"({asked.inputs / max(seconds, 1e-9):.0f} a second of processor time), "
            f"slowest {worst.slowest:.2f} s (number {worst.number}), {peak / 2**20:.0f} MiB at most"
        )
    return min(bad, 1)


if __name__ == "__main__":
    sys.exit(main())
