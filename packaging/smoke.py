"""Try the installed program the way its first user would: list targets, design a heart, look at the cut file.

Run with the interpreter that the wheel was installed for, from any folder:

    python packaging/smoke.py [--k 2]

Exit code 0 means that every step did what it promises.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import subprocess
import sys
import tempfile
from pathlib import Path

CHECKOUT = Path(__file__).resolve().parents[1]
DESIGN_FILES = ("design.kiri", "cut.dxf", "layout.svg", "preview.png", "candidates.json")


class SmokeError(Exception):
    """A step did not do what it promises."""


def main() -> int:
    """Run every step in a folder of its own; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--k", type=int, default=2, help="candidates to draw (default: %(default)s)")
    arguments = parser.parse_args()
    try:
        with tempfile.TemporaryDirectory(prefix="kirigami-smoke-") as folder:
            refuse_the_checkout(Path(folder))
            try_targets(Path(folder))
            try_design(Path(folder), arguments.k)
    except SmokeError as error:
        print(f"smoke: {error}", file=sys.stderr)
        return 1
    print("smoke: the installed program works")
    return 0


def refuse_the_checkout(folder: Path) -> None:
    """Make sure that the package under test is the installed one, its bundled files included."""
    spec = importlib.util.find_spec("kirigami_studio")
    if spec is None or spec.origin is None:
        raise SmokeError("kirigami_studio is not installed for this interpreter; install the wheel first")
    package = Path(spec.origin).parent
    if package.parent == CHECKOUT:
        raise SmokeError(f"{package} is the checkout, not an installed wheel")
    if not (package / "resources" / "silhouettes").is_dir():
        raise SmokeError(f"the wheel carries no bundled files: {package / 'resources'} is missing")
    call(folder, "--help")


def try_targets(folder: Path) -> None:
    """The library lists the silhouettes that the guide speaks of."""
    listed = call(folder, "targets").split()
    for name in ("heart", "star", "hexagon", "circle"):
        if not any(name in word for word in listed):
            raise SmokeError(f"the target library does not list {name}")


def try_design(folder: Path, k: int) -> None:
    """The whole way from a silhouette to a checked cut file."""
    out = folder / "heart"
    report = json.loads(call(folder, "design", "heart", "--k", str(k), "--out", str(out), "--json"))
    if len(report["candidates"]) != k:
        raise SmokeError(f"asked for {k} candidates, got {len(report['candidates'])}")
    for name in DESIGN_FILES:
        if not (out / name).is_file() or (out / name).stat().st_size == 0:
            raise SmokeError(f"design wrote no {name}")
    verdict = json.loads(call(folder, "check", str(out / "cut.dxf"), "--json"))
    if not verdict["ok"]:
        raise SmokeError(f"the cut file has problems: {verdict['problems']}")


def call(folder: Path, *arguments: str) -> str:
    """Run the program in ``folder`` and return what it printed; any other exit code than 0 is a failure."""
    command = [sys.executable, "-m", "kirigami_studio", *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=600, check=False)
    if done.returncode != 0:
        raise SmokeError(f"{' '.join(command[2:])} ended with {done.returncode}: {done.stderr.strip()[-800:]}")
    return done.stdout


if __name__ == "__main__":
    sys.exit(main())
