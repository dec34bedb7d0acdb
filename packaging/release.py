"""Make all files of a release for this system, tried as they are installed: ``python packaging/release.py``.

The version, the changelog and the names of the files must agree, and the tree must be as it is committed.  Then, into
``dist``: wheel and source archive, the frozen program, its packages, and SHA256SUMS.  The wheel is installed into an
empty environment and tried there; the program is frozen from that environment and tried, too.
``--any-tree`` makes the same of a tree that is no release.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from version import ROOT, ReleaseError, changes, file_names, unreleased, version

PACKAGING = ROOT / "packaging"
ENVIRONMENT = ROOT / "build" / "release-env"
PINS = PACKAGING / "constraints-bundle.txt"
TORCH_INDEX = "https://download.pytorch.org/whl/cpu"


def check_tree() -> None:
    """Refuse a tree that is not as committed, and a version that the changelog does not have.

    Raises
    ------
    ReleaseError
        With what is to be done.
    """
    changes(version())
    said = subprocess.run(["git", "status", "--porcelain"], cwd=ROOT, capture_output=True, text=True, check=False)
    if said.returncode != 0:
        raise ReleaseError("this is no checkout of git: a release is made of a commit")
    if said.stdout.strip():
        raise ReleaseError(f"commit or remove these first:\n{said.stdout.rstrip()}")


def environment() -> Path:
    """Make an empty environment; return its interpreter."""
    shutil.rmtree(ENVIRONMENT, ignore_errors=True)
    subprocess.run([sys.executable, "-m", "venv", str(ENVIRONMENT)], check=True)
    return ENVIRONMENT / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")


def install(python: Path, *what: str) -> None:
    """Install into the environment, in the versions that releases are made with."""
    command = [str(python), "-m", "pip", "install", "-q", "-c", str(PINS)]
    subprocess.run([*command, *what], check=True)


def build_python_files(python: Path, out: Path) -> None:
    """Build the source archive, and the wheel from it, of a copy, so that nothing is left in the tree."""
    copy = ROOT / "build" / "source"
    shutil.rmtree(copy, ignore_errors=True)
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT, capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    for name in filter(None, listed.split("\0")):
        if (ROOT / name).is_file():
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, copy / name)
    install(python, "build")
    subprocess.run([str(python), "-m", "build", "--outdir", str(out), str(copy)], check=True)


def try_out(python: Path, *arguments: str) -> None:
    """Run the smoke test from another folder, so that the checkout is not what it finds."""
    clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    subprocess.run([str(python), str(PACKAGING / "smoke.py"), *arguments], cwd=python.parent, env=clean, check=True)


def write_sums(out: Path, names: Sequence[str]) -> None:
    """Write SHA256SUMS of the files of this release, and refuse it when one is missing or has another name.

    Raises
    ------
    ReleaseError
        A file was not made.
    """
    missing = [name for name in names if not (out / name).is_file()]
    if missing:
        raise ReleaseError(f"not made: {', '.join(missing)}")
    sums = [f"{hashlib.sha256((out / name).read_bytes()).hexdigest()}  {name}\n" for name in sorted(names)]
    (out / "SHA256SUMS").write_text("".join(sums), encoding="ascii")


def write_notes(out: Path) -> Path:
    """Write what the changelog says of the version, or of what is not released yet, as the notes of the release."""
    try:
        said = changes(version())[1]
    except ReleaseError:
        said = unreleased()
    notes = out / f"kirigami-studio-{version()}-notes.md"
    notes.write_text(f"# Kirigami Studio {version()}\n\n{said}\n", encoding="utf-8")
    return notes


def make(out: Path) -> None:
    """All steps, in order."""
    names = file_names(version())
    python = environment()
    build_python_files(python, out)
    python = environment()  # empty again: what building needed must not hide what the wheel lacks
    # By itself: only torch needs the other index, and a machine without a way there may have its wheel.
    install(python, "--retries", "1", "--extra-index-url", TORCH_INDEX, "torch")
    install(python, str(out / names["wheel"]))
    try_out(python)
    install(python, "pyinstaller", "argparse-manpage")
    bundle = [str(python), str(PACKAGING / "bundle.py"), "--out", str(out)]
    subprocess.run([*bundle, "--no-archive"], check=True)
    folder = ROOT / "build" / "bundle" / "dist"
    if sys.platform == "darwin":
        try_out(python, "--program", f"'{folder / 'Kirigami Studio.app/Contents/MacOS/kirigami-studio'}'")
        subprocess.run(["sh", str(PACKAGING / "macos" / "dmg.sh")], check=True)
    elif sys.platform == "win32":
        try_out(python, "--program", f"'{folder / 'kirigami-studio' / 'kirigami-studio.exe'}'")
        subprocess.run([*bundle, "--archive-only"], check=True)
        script = str(PACKAGING / "windows" / "kirigami-studio.iss")
        signed = (
            ["/DSigned", f"/Ssigntool={os.environ['KIRIGAMI_SIGNTOOL']}"] if "KIRIGAMI_SIGNTOOL" in os.environ else []
        )
        subprocess.run(["iscc", f"/DVersion={version()}", *signed, script], check=True)
    else:
        try_out(python, "--program", f"'{folder / 'kirigami-studio' / 'kirigami-studio'}'")
        subprocess.run([*bundle, "--archive-only"], check=True)
        subprocess.run([str(python), str(PACKAGING / "linux" / "deb.py"), "--out", str(out)], check=True)
    write_sums(out, [*names.values(), write_notes(out).name])


def main() -> int:
    """Check, then make everything."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--any-tree", action="store_true", help="make packages of a tree that is no release")
    parser.add_argument("--check", action="store_true", help="only see whether this tree can be released")
    parser.add_argument("--out", type=Path, default=ROOT / "dist", help="folder of the files (default: dist)")
    arguments = parser.parse_args()
    try:
        if not arguments.any_tree:
            check_tree()
        if not arguments.check:
            make(arguments.out.resolve())
            print(f"{version()} is in {arguments.out}:", *file_names(version()).values(), "SHA256SUMS", sep="\n  ")
    except (ReleaseError, subprocess.CalledProcessError) as error:
        print(f"release: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
