"""The wheel carries everything: it is built, unpacked elsewhere and tried as its first user would try it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

pytestmark = pytest.mark.torch

SOURCES = ("kirigami_studio", "resources", "pyproject.toml", "setup.py", "MANIFEST.in", "README.md", "LICENSE")


@pytest.fixture(scope="module")
def wheel(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wheel built from a copy, so that no ``build`` folder of the checkout leaks into it."""
    pytest.importorskip("setuptools")
    copy = tmp_path_factory.mktemp("source")
    for name in SOURCES:
        source = repository / name
        if source.is_dir():
            shutil.copytree(source, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, copy)
    out = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "-w", str(out), str(copy)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    (built,) = out.glob("kirigami_studio-*.whl")
    return built


def files_below(folder: Path) -> set[str]:
    """Relative names of all files, caches and hidden ones left out."""
    found = (path.relative_to(folder) for path in folder.rglob("*") if path.is_file())
    return {
        path.as_posix() for path in found if "__pycache__" not in path.parts and not path.name.startswith(".")
    }  # fmt: skip


def test_that_the_wheel_carries_every_module_and_every_bundled_file(wheel: Path, repository: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    assert len(names) == len(set(names))
    expected = {f"kirigami_studio/{name}" for name in files_below(repository / "kirigami_studio")}
    bundled = {name.removesuffix(".po") + ".mo" if name.endswith(".po") else name
               for name in files_below(repository / "resources")}  # fmt: skip
    assert "locale/de/LC_MESSAGES/kirigami_studio.mo" in bundled
    expected |= {f"kirigami_studio/resources/{name}" for name in bundled}
    assert any(name.startswith("kirigami_studio/resources/silhouettes/") for name in expected)
    carried = {name for name in names if ".dist-info/" not in name}
    assert carried == expected


def test_that_the_wheel_states_its_licence_and_its_command(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        text = {name.split(".dist-info/")[-1]: archive.read(name).decode() for name in archive.namelist()
                if ".dist-info/" in name}  # fmt: skip
    assert "MIT License" in text["licenses/LICENSE"]
    assert "kirigami-studio = kirigami_studio.cli:main" in text["entry_points.txt"]


def test_that_the_installed_program_takes_a_silhouette_to_a_checked_cut_file(
    wheel: Path, repository: Path, tmp_path: Path
) -> None:
    site = tmp_path / "site"
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    smoke = shutil.copy(repository / "packaging" / "smoke.py", tmp_path)
    done = subprocess.run(
        [sys.executable, str(smoke), "--k", "2"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(site)},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "works" in done.stdout


def test_that_the_smoke_test_refuses_the_checkout(repository: Path, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, str(repository / "packaging" / "smoke.py")],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(repository)},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 1
    assert "not an installed wheel" in done.stderr
