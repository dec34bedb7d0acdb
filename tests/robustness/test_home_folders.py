"""Homes that are no folder, and files in a home that a library would run."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
#: All modules that name reportlab in an import, or what imports it for them.
IMPORTERS = [
    ".".join(path.relative_to(ROOT).with_suffix("").parts)
    for path in sorted((ROOT / "kirigami_studio").rglob("*.py"))
    if re.search(r"^ *(from|import) (reportlab|kirigami_studio\.export\.pdf_library)", path.read_text("utf-8"), re.M)
]


def run(home: Path, out: Path, *words: str) -> subprocess.CompletedProcess[str]:
    environment = {name: value for name, value in os.environ.items() if not name.startswith("XDG_")}
    environment |= {"HOME": str(home), "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path])}
    return subprocess.run(
        [sys.executable, *words, str(out)],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )


@pytest.mark.skipif(os.name == "nt", reason="the home folder is found otherwise")
def test_that_a_home_that_is_no_folder_stops_no_work_and_is_not_spoken_of(tmp_path: Path) -> None:
    home = tmp_path / "home"
    home.write_text("a file", encoding="utf-8")
    words = ["-m", "kirigami_studio", "export", "resources/examples/heart.kiri", "--out"]
    done = run(home, tmp_path / "heart.pdf", *words)
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "heart.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.parametrize("importer", IMPORTERS)
@pytest.mark.skipif(os.name == "nt", reason="the home folder is found otherwise")
def test_that_no_file_of_the_home_folder_is_run(importer: str, tmp_path: Path) -> None:
    for name in (".reportlab_mods", ".reportlab_settings"):
        (tmp_path / name).write_text(f"open({str(tmp_path / 'was_run')!r}, 'w').close()\n", encoding="utf-8")
    done = run(tmp_path, tmp_path, "-c", f"import {importer}")
    assert (done.returncode, done.stderr) == (0, "")
    assert not (tmp_path / "was_run").exists()


def test_that_modules_that_import_reportlab_are_found() -> None:
    assert {"kirigami_studio.export.pdf", "kirigami_studio.export.pdf_library"} < set(IMPORTERS)
