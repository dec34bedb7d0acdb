"""Every example of the Python API runs: in its docstrings, in its document, and the ten lines of the README."""

from __future__ import annotations

import contextlib
import doctest
import importlib
import io
import pkgutil
import re
from pathlib import Path

import pytest

import kirigami_studio
from kirigami_studio import api

MODULES = ("", *(f".api.{module.name}" for module in pkgutil.iter_modules(api.__path__)))


@pytest.mark.parametrize("name", MODULES)
def test_that_examples_in_docstrings_run(name: str) -> None:
    found = doctest.testmod(importlib.import_module(f"kirigami_studio{name}"))
    assert found.failed == 0


def test_that_there_are_examples() -> None:
    finder = doctest.DocTestFinder(exclude_empty=True)
    modules = [importlib.import_module(f"kirigami_studio{name}") for name in MODULES]
    assert sum(len(test.examples) for module in modules for test in finder.find(module)) > 15
    assert kirigami_studio.__doc__ is not None


@pytest.mark.torch
def test_that_examples_of_the_document_run_in_order(
    repository: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = (repository / "docs" / "python-api.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```pycon\n(.*?)```", text, flags=re.DOTALL)
    assert len(blocks) > 5
    monkeypatch.chdir(tmp_path)
    examples = doctest.DocTestParser().get_doctest("\n".join(blocks), {}, "docs/python-api.md", None, 0)
    said = io.StringIO()
    doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(examples, out=said.write)
    assert said.getvalue() == ""


@pytest.mark.torch
def test_that_the_ten_lines_lead_to_a_cut_file(
    repository: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (lines,) = ten_lines(repository / "docs" / "python-api.md")
    assert ten_lines(repository / "README.md") == [lines]
    assert len([line for line in lines.splitlines() if line]) == 10
    monkeypatch.chdir(tmp_path)
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(compile(lines.replace("k=8", "k=1, grid=(5, 5)"), "the ten lines", "exec"), {})
    assert "<Design A1 for 'heart': 5 x 5 voids" in said.getvalue()
    assert "Candidate 1 of 1" in said.getvalue()
    assert "<Simulation: " in said.getvalue()
    assert Path("heart.dxf").stat().st_size > 1000
    assert Path("heart.kiri").exists()


def ten_lines(path: Path) -> list[str]:
    """Blocks of Python that begin with the import."""
    text = path.read_text(encoding="utf-8")
    return re.findall(r"```python\n(import kirigami_studio as ks\n.*?)```", text, flags=re.DOTALL)
