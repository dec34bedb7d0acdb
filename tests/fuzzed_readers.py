"""Mutates inputs and reads them: ``python tests/fuzzed_readers.py --inputs 20000 --out FOLDER [READER ...]``.

Every reader works in a process of its own, which is killed when a file takes too much time or memory and begun again
behind that file.  Files that end in anything but an answer or one sentence are kept in the folder; those belong into
``tests/data/attacks``.  Same seed, same files.
"""

from __future__ import annotations

import argparse
import io
import json
import os
import random
import re
import resource
import signal
import subprocess
import sys
import time
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

TESTS = Path(__file__).parent
RESOURCES = TESTS.parent / "resources"
#: Endings of the seeds of each reader.
ENDINGS = {
    "target": (".svg", ".dxf", ".json", ".png"),
    "parts": (".svg", ".dxf", ".png"),
    "check": (".dxf",),
    "dxf": (".dxf",),
    "svg": (".svg",),
    "mask": (".png",),
    "sheet": (".npy", ".json"),
    "material": (".toml",),
    "preferences": (".toml",),
    "recent": (".toml",),
    "project": (".kiri",),
    "recovery": (".kiri",),
}
#: Seconds of processor time, and bytes of memory beside what the program takes, that one file may cost.
MOST_SECONDS, MOST_MEMORY = 5.0, 2 * 2**30
NUMBER = re.compile(rb"-?\d+(?:\.\d+)?")
#: What numbers become.
NUMBERS = (b"0", b"-1", b"1e400", b"-1e308", b"1e-320", b"nan", b"inf", b"9" * 400, b"2147483648", b"0x10", b"1e9", b"")
#: Longest mutated file; longer ones only take longer.
LONGEST = 300_000


def sources(reader: str) -> list[bytes]:
    """What the files of a reader are made from: those that hurt once, and whole ones."""
    places = (TESTS / "data", RESOURCES / "examples", RESOURCES / "silhouettes", RESOURCES / "materials")
    found = sorted(path for place in places for path in place.rglob("*") if path.suffix.lower() in ENDINGS[reader])
    contents = [path.read_bytes() for path in found if path.stat().st_size <= LONGEST]
    return [*contents, *whole(reader)]


def whole(reader: str) -> list[bytes]:
    """Files that the program itself writes."""
    import numpy as np
    from PIL import Image, ImageDraw

    if reader in ("check", "dxf", "svg", "target", "parts"):
        from kirigami_studio.export.dxf import dxf_bytes
        from kirigami_studio.export.exporter import ExportJob
        from kirigami_studio.export.profile import find_profile
        from kirigami_studio.export.svg import cut_svg_bytes
        from kirigami_studio.lattice.deployment import deploy
        from kirigami_studio.lattice.ratio_field import RatioField
        from kirigami_studio.project.cutting import plan_sheet
        from kirigami_studio.project.settings import FabricationSettings

        design = deploy(RatioField.uniform(3, 3))
        plan = plan_sheet(design, FabricationSettings(60.0, connector_mm=0.8))
        drawings = {
            ".dxf": dxf_bytes(plan, "R2010", find_profile("any")),
            ".svg": cut_svg_bytes(ExportJob(design, plan=plan)),
        }
        return [content for ending, content in drawings.items() if ending in ENDINGS[reader]]
    stream = io.BytesIO()
    if reader == "mask":
        picture = Image.new("L", (60, 40))
        ImageDraw.Draw(picture).ellipse((5, 5, 50, 35), fill=255)
        picture.save(stream, "PNG")
    elif reader == "sheet":
        np.save(stream, np.full((3, 4), 1.25))
    elif reader in ("preferences", "recent"):
        stream.write(b'tour_seen = true\nlanguage = "de"\n' if reader == "preferences" else b'projects = ["/a.kiri"]\n')
    elif reader == "recovery":
        with zipfile.ZipFile(stream, "w") as archive:
            archive.writestr("recovery.json", '{"name": "a", "path": "", "changed": "2026-01-01T00:00:00+00:00"}')
    return [stream.getvalue()] if stream.getvalue() else []


def mutated(content: bytes, others: Sequence[bytes], draw: random.Random) -> bytes:
    """A damaged copy."""
    if content.startswith(b"PK") and draw.random() < 0.85:
        return _repacked(content, others, draw)
    for _ in range(draw.choice((1, 1, 2, 4))):
        content = draw.choice(MUTATIONS)(content, draw.choice(others), draw)
    return content[:LONGEST]


def _repacked(content: bytes, others: Sequence[bytes], draw: random.Random) -> bytes:
    """A zip with one damaged member."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            members = {name: archive.read(name) for name in archive.namelist()}
    except Exception:
        return _flipped(content, b"", draw)
    if members:
        name = draw.choice(sorted(members))
        for _ in range(draw.choice((1, 1, 2))):
            members[name] = draw.choice(MUTATIONS)(members[name], members[draw.choice(sorted(members))], draw)
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, member in members.items():
            archive.writestr(name, member)
    return stream.getvalue()


def _flipped(content: bytes, _: bytes, draw: random.Random) -> bytes:
    found = bytearray(content)
    for _number in range(draw.choice((1, 3, 10)) if found else 0):
        found[draw.randrange(len(found))] = draw.randrange(256)
    return bytes(found)


def _span(content: bytes, draw: random.Random) -> tuple[int, int]:
    first = draw.randrange(len(content) + 1)
    return first, min(len(content), first + draw.choice((1, 4, 20, 100, 1000)))


def _without(content: bytes, _: bytes, draw: random.Random) -> bytes:
    first, last = _span(content, draw)
    return content[:first] + content[last:]


def _repeated(content: bytes, _: bytes, draw: random.Random) -> bytes:
    first, last = _span(content, draw)
    return content[:last] + content[first:last] * draw.choice((1, 5, 200)) + content[last:]


def _crossed(content: bytes, other: bytes, draw: random.Random) -> bytes:
    first, last = _span(other, draw)
    place = draw.randrange(len(content) + 1)
    return content[:place] + other[first:last] + content[place:]


def _renumbered(content: bytes, _: bytes, draw: random.Random) -> bytes:
    found = list(NUMBER.finditer(content))
    if not found:
        return content
    chosen = draw.choice(found)
    return content[: chosen.start()] + draw.choice(NUMBERS) + content[chosen.end() :]


def _cut(content: bytes, _: bytes, draw: random.Random) -> bytes:
    return content[: draw.randrange(len(content) + 1)]


MUTATIONS: tuple[Callable[[bytes, bytes, random.Random], bytes], ...] = (
    _flipped, _without, _repeated, _crossed, _renumbered, _renumbered, _cut
)  # fmt: skip


class _TooLongError(BaseException):
    """A file took all of its time."""


def _stop(_signal: int, _frame: FrameType | None) -> None:
    raise _TooLongError


def read_many(reader: str, first: int, last: int, seed: int, folder: Path) -> None:
    """Read mutated files one by one, in this process; a line of JSON for each that did not end well."""
    from attacked_readers import READERS, outcome

    signal.signal(signal.SIGPROF, _stop)
    originals, place = sources(reader), folder / f"{reader}.now"
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + MOST_MEMORY, used + MOST_MEMORY))
    for number in range(first, last):
        draw = random.Random(f"{seed} {reader} {number}")
        original = draw.choice(originals)
        content = mutated(original, originals, draw)
        ending = draw.choice(ENDINGS[reader]) if draw.random() < 0.05 else ending_of(original, reader)
        path = place.with_suffix(ending)
        path.write_bytes(content)
        place.write_text(str(number))
        begun = time.process_time()
        # What a reader in C does not give back, the process pays for.
        resource.setrlimit(resource.RLIMIT_CPU, (int(begun + 3 * MOST_SECONDS) + 1, resource.RLIM_INFINITY))
        signal.setitimer(signal.ITIMER_PROF, MOST_SECONDS)
        try:
            found = outcome(READERS[reader], path)
        except _TooLongError:
            found = "UNCAUGHT too long"
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        if found.startswith("UNCAUGHT"):
            kept = folder / f"{reader}_{seed}_{number}{ending}"
            path.replace(kept)
            tell(json.dumps({"file": kept.name, "outcome": found}))
    place.write_text(str(last))


def tell(line: str) -> None:
    """Print a line at once."""
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def ending_of(content: bytes, reader: str) -> str:
    """The ending that a file of such content has."""
    beginnings = {b"PK": ".kiri", b"\x89PNG": ".png", b"\x93NUMPY": ".npy", b"{": ".json", b"[": ".json"}
    for beginning, ending in beginnings.items():
        if content.startswith(beginning) and ending in ENDINGS[reader]:
            return ending
    if b"<svg" in content[:2000] and ".svg" in ENDINGS[reader]:
        return ".svg"
    text = [ending for ending in ENDINGS[reader] if ending in (".dxf", ".toml")]
    return text[0] if text else ENDINGS[reader][0]


@dataclass(frozen=True)
class Found:
    """A file that did not end in an answer or a sentence."""

    file: str
    outcome: str


def fuzzed(reader: str, inputs: int, seed: int, folder: Path) -> list[Found]:
    """Have a reader read mutated files, in as many processes as it kills."""
    folder.mkdir(parents=True, exist_ok=True)
    found, first, place = list[Found](), 0, folder / f"{reader}.now"
    while first < inputs:
        words = [sys.executable, __file__, reader, "--out", str(folder), "--seed", str(seed)]
        place.write_text(str(first))
        done = subprocess.run(
            [*words, "--from", str(first), "--inputs", str(inputs)],
            env=os.environ | {"PYTHONWARNINGS": "ignore", "PYTHONPATH": os.pathsep.join([str(TESTS), *sys.path])},
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        found += [Found(**json.loads(line)) for line in done.stdout.splitlines() if line.startswith('{"file"')]
        reached = int(place.read_text())
        if done.returncode == 0:
            break
        if done.returncode > 0:  # not killed: the fault is here
            raise RuntimeError(done.stderr[-2000:])
        found.append(Found(f"{reader} number {reached}", f"exit status {done.returncode}: {done.stderr[-300:]}"))
        first = reached + 1
    return found


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("readers", nargs="*", choices=[*ENDINGS, []])
    parser.add_argument("--inputs", type=int, default=1000, help="files for each reader")
    parser.add_argument("--from", type=int, dest="first", help="read in this process, from this number on")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, required=True)
    asked = parser.parse_args()
    if asked.first is not None:
        read_many(asked.readers[0], asked.first, asked.inputs, asked.seed, asked.out)
        sys.exit(0)
    bad = 0
    for name in asked.readers or ENDINGS:
        begun = time.monotonic()
        lines = fuzzed(name, asked.inputs, asked.seed, asked.out)
        bad += len(lines)
        tell(f"{name}: {asked.inputs} files, {len(lines)} bad, {time.monotonic() - begun:.0f} s")
        for line in lines:
            tell(f"  {line.file}: {line.outcome}")
    sys.exit(min(bad, 1))
