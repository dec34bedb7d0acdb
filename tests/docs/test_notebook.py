"""The notebook of the documentation plays from top to bottom, and what its cells show is kept in it."""

from __future__ import annotations

import ast
import json
from pathlib import Path

import pytest


def shown(source: str, names: dict[str, object]) -> object:
    """Play a cell; the value of its last expression, None without one."""
    tree = ast.parse(source)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, "cell", "exec"), names)
    return eval(compile(ast.Expression(last.value), "cell", "eval"), names) if isinstance(last, ast.Expr) else None


def kinds(value: object) -> set[str]:
    """What a notebook keeps of a value."""
    pictures = {"_repr_svg_": "image/svg+xml", "_repr_html_": "text/html"}
    return (
        {"text/plain"} | {kind for name, kind in pictures.items() if hasattr(value, name)}
        if value is not None
        else set()
    )


@pytest.mark.torch
def test_that_the_notebook_plays(repository: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    notebook = json.loads((repository / "docs" / "first-design.ipynb").read_text(encoding="utf-8"))
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert len(cells) > 8
    for cell in cells:
        value = shown("".join(cell["source"]), names)
        kept = [set(output["data"]) for output in cell["outputs"] if output["output_type"] == "execute_result"]
        assert kept == ([kinds(value)] if value is not None else [])
    assert (tmp_path / "heart.dxf").exists() and (tmp_path / "heart.kiri").exists()
