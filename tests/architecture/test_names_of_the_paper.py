"""The paper's equations and measures are found by their names in the code, and in one table of the docs."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

pytestmark = pytest.mark.rule

ROW = re.compile(r"^\| (?P<name>[^|]+) \| [^|]+ \| (?P<code>[^|]*`[^|]+) \|$", re.MULTILINE)
PLACE = re.compile(r"`(?P<module>[\w/]+\.py): (?P<definition>\w+)`")
#: Words by which a row's place says what it is, where its name is none.
WORDS = {"Sec. 2.1": r"the paper's (N_inv|r_ov)"}


def test_that_the_table_of_equations_leads_to_code_that_names_them(repository: Path) -> None:
    text = (repository / "docs" / "mathematics.md").read_text(encoding="utf-8")
    rows = ROW.findall(text.partition("## Where the paper's equations are")[2].partition("\n## ")[0])
    assert {f"Eq. {number}" for number in range(1, 7)} <= {name for name, _ in rows}
    for name, code in rows:
        places = PLACE.findall(code)
        assert places, name
        for module, definition in places:
            tree = ast.parse((repository / "kirigami_studio" / module).read_text(encoding="utf-8"))
            named = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef | ast.ClassDef)}
            said = f"{ast.get_docstring(tree)} {ast.get_docstring(named[definition])}"
            assert re.search(WORDS.get(name, re.escape(name)), said, re.IGNORECASE), (name, module, definition)


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
