"""Somebody who knows the paper finds its equations and measures by searching for their names."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest


@pytest.mark.parametrize(
    ("module", "definition", "said"),
    [
        ("lab/baselines/marching.py", "march", r"Eq\. 2"),
        ("lab/baselines/marching.py", "void_angle", r"parity rule \(Eq\. 1\)"),
        ("evaluate/siou.py", None, r"sIoU"),
        ("evaluate/total_variation.py", None, r"[Tt]otal variation"),
        ("lab/training/flow_path.py", "cfm_loss", r"Eq\. \d"),
        ("lab/training/grpo.py", "grpo_loss", r"Eq\. \d"),
    ],
)
def test_that_a_formula_is_found_by_its_name(repository: Path, module: str, definition: str | None, said: str) -> None:
    tree = ast.parse((repository / "kirigami_studio" / module).read_text(encoding="utf-8"))
    definitions = {node.name: node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    documented = tree if definition is None else definitions[definition]
    assert re.search(said, ast.get_docstring(documented) or "", re.DOTALL)
