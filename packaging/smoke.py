"""Try the installed program the way its first user would: targets, a design, its cut file, a session of the window.

Run with the interpreter that the wheel was installed for, from any folder, or name a frozen program:

    python packaging/smoke.py [--k 2]
    python packaging/smoke.py --program build/bundle/dist/kirigami-studio/kirigami-studio
    python packaging/smoke.py --program "chroot ROOT kirigami-studio" --root ROOT

Exit code 0 means that every step did what it promises.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

CHECKOUT = Path(__file__).resolve().parents[1]
DESIGN_FILES = ("design.kiri", "cut.dxf", "layout.svg", "preview.png", "candidates.json")
SESSION = "kirigami_studio.lab.demonstrations.offscreen_session"
#: What the program says when its polishing workers do not start; it then does their work itself.
NO_WORKERS = ("polishing goes on in one process", "a polishing worker died")


class SmokeError(Exception):
    """A step did not do what it promises."""


class Program:
    """The program under test, and the folder that it works in.

    Parameters
    ----------
    words : list of str
        What starts it; empty for the interpreter that runs this file.
    root : Path
        The folder that the program takes for ``/``.
    folder : Path
        Where it works, as this process sees it.
    """

    def __init__(self, words: list[str], root: Path, folder: Path) -> None:
        self.words = words or [sys.executable, "-m", "kirigami_studio"]
        self.frozen = bool(words)
        self.root = root
        self.folder = folder

    def seen(self, path: Path) -> str:
        """A path as the program sees it."""
        return str(Path("/") / path.relative_to(self.root))

    def call(self, *arguments: str) -> str:
        """Run a command and return what it printed; any other exit code than 0 is a failure."""
        return self._run([*self.words, *arguments])

    def play(self, module: str, *arguments: str) -> str:
        """Run a module of the lab without a display; a frozen program has no lab and runs the checkout's script."""
        if self.frozen:
            copy = Path(shutil.copy(CHECKOUT / (module.replace(".", "/") + ".py"), self.folder))
            command = [*self.words, "-m", self.seen(copy)]
        else:
            command = [sys.executable, "-m", module]
        return self._run([*command, *arguments], QT_QPA_PLATFORM="offscreen")

    def _run(self, command: list[str], **environment: str) -> str:
        inside = {} if self.root == Path("/") else {"HOME": self.seen(self.folder)}
        done = subprocess.run(
            command,
            cwd=self.folder,
            env=os.environ | inside | environment,
            capture_output=True,
            text=True,
            timeout=600,
            check=False,
        )
        if done.returncode != 0:
            raise SmokeError(f"{shlex.join(command)} ended with {done.returncode}: {done.stderr.strip()[-800:]}")
        for words in NO_WORKERS:
            if words in done.stderr:
                raise SmokeError(f"{shlex.join(command)}: {words}")
        return done.stdout


def main() -> int:
    """Run every step in a folder of its own; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--k", type=int, default=2, help="candidates to draw (default: %(default)s)")
    parser.add_argument("--program", type=shlex.split, default=[], help="words that start a frozen program")
    parser.add_argument("--root", type=Path, default=Path("/"), help="folder that it takes for / (default: /)")
    parser.add_argument("--no-window", action="store_true", help="leave the session of the window out")
    arguments = parser.parse_args()
    root = arguments.root.resolve()
    words = [str(Path(word).resolve()) if Path(word).is_file() else word for word in arguments.program]
    place = None if root == Path("/") else root / "tmp"
    try:
        with tempfile.TemporaryDirectory(prefix="kirigami-smoke-", dir=place) as folder:
            program = Program(words, root, Path(folder))
            if not words:
                refuse_the_checkout()
            program.call("--help")
            try_targets(program)
            try_licences(program)
            try_design(program, arguments.k)
            if not arguments.no_window:
                try_window(program)
    except SmokeError as error:
        print(f"smoke: {error}", file=sys.stderr)
        return 1
    print("smoke: the installed program works")
    return 0


def refuse_the_checkout() -> None:
    """Make sure that the package under test is the installed one, its bundled files included."""
    spec = importlib.util.find_spec("kirigami_studio")
    if spec is None or spec.origin is None:
        raise SmokeError("kirigami_studio is not installed for this interpreter; install the wheel first")
    package = Path(spec.origin).parent
    if package.parent == CHECKOUT:
        raise SmokeError(f"{package} is the checkout, not an installed wheel")
    if not (package / "resources" / "silhouettes").is_dir():
        raise SmokeError(f"the wheel carries no bundled files: {package / 'resources'} is missing")


def try_targets(program: Program) -> None:
    """The library lists the silhouettes that the guide speaks of."""
    listed = program.call("targets").split()
    for name in ("heart", "star", "hexagon", "circle"):
        if not any(name in word for word in listed):
            raise SmokeError(f"the target library does not list {name}")


def try_licences(program: Program) -> None:
    """Everything that is shipped has a licence and its text."""
    parts = json.loads(program.call("licences", "--json"))["parts"]
    bare = [part["name"] for part in parts if not part["licence"] or not part["text"]]
    if bare or not any(part["licence"] == "LGPL-3.0-only" for part in parts):
        raise SmokeError(f"licences are missing: {', '.join(bare) or 'that of Qt'}")


def try_design(program: Program, k: int) -> None:
    """The whole way from a silhouette to a checked cut file."""
    out = program.folder / "heart"
    report = json.loads(program.call("design", "heart", "--k", str(k), "--out", program.seen(out), "--json"))
    if len(report["candidates"]) != k:
        raise SmokeError(f"asked for {k} candidates, got {len(report['candidates'])}")
    for name in DESIGN_FILES:
        if not (out / name).is_file() or (out / name).stat().st_size == 0:
            raise SmokeError(f"design wrote no {name}")
    check(program, out / "cut.dxf")


def try_window(program: Program) -> None:
    """A session in the window, without a display: choose, generate, export, save; the files are read back."""
    out = program.folder / "session"
    program.play(SESSION, "--out", program.seen(out))
    check(program, out / "cut.dxf")
    score = json.loads(program.call("score", program.seen(out / "session.kiri"), "heart", "--json"))
    if not score:
        raise SmokeError("the saved project cannot be scored")


def check(program: Program, file: Path) -> None:
    """Have the program read a cut file back."""
    verdict = json.loads(program.call("check", program.seen(file), "--json"))
    if not verdict["ok"]:
        raise SmokeError(f"the cut file has problems: {verdict['problems']}")


if __name__ == "__main__":
    sys.exit(main())
