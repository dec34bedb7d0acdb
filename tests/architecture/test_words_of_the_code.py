"""Names mean one thing, and docstrings begin as they should: the list of exceptions only ever gets shorter."""

from __future__ import annotations

import ast
import re
from collections import Counter, defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

pytestmark = pytest.mark.rule

#: A docstring's first line is a noun phrase or an imperative of at most so many characters.
LONGEST = 90
#: Begins with a relative clause, or with a participle of what is said.
BEGINNING = re.compile(r"(what|that which|told)\b", re.IGNORECASE)
#: The user is the user; what is written is not "told".
DIALECT = re.compile(r"\b(a person|told)\b", re.IGNORECASE)
#: Docstrings that broke the rule when it was made, by package: mend some, and lower the number.
OFFENDERS = {
    "": 1,
    "evaluate": 93,
    "export": 70,
    "fabricate": 120,
    "generator": 43,
    "gui": 364,
    "lab": 206,
    "mechanics": 43,
    "outlines": 106,
    "pipeline": 69,
    "polish": 105,
    "project": 56,
    "studio": 101,
}
#: One thing under one name: the public class of the API wraps the one of the lattice.
WRAPPED = {"Sheet": ["api/design.py", "lattice/sheet.py"]}


def offences(source: str) -> list[tuple[int, str]]:
    """Lines with docstrings against the rule, and their first lines."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if not isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            continue
        text = ast.get_docstring(node) or ""
        first = text.partition("\n")[0]
        if len(first) > LONGEST or BEGINNING.match(first) or DIALECT.search(text):
            found.append((getattr(node, "lineno", 1), first))
    return found


def modules(repository: Path) -> Iterator[tuple[str, Path]]:
    """All modules with the package that each is in, "" for those beside the packages."""
    root = repository / "kirigami_studio"
    for path in sorted(root.rglob("*.py")):
        parts = path.relative_to(root).parts
        yield parts[0] if len(parts) > 1 else "", path


@pytest.fixture(scope="module")
def classes(repository: Path) -> dict[str, list[str]]:
    """Packages and modules of all classes by name."""
    found = defaultdict(list)
    for package, path in modules(repository):
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef):
                found[node.name].append(f"{package}/{path.name}")
    return found


def test_that_docstrings_against_the_rule_do_not_become_more(repository: Path) -> None:
    counts: Counter[str] = Counter()
    for package, path in modules(repository):
        counts[package] += len(offences(path.read_text(encoding="utf-8")))
    more = {package: (count, OFFENDERS.get(package, 0)) for package, count in counts.items()
            if count > OFFENDERS.get(package, 0)}  # fmt: skip
    assert more == {}, "first lines are imperatives or noun phrases of at most 90 characters: mend those you have added"


def test_that_the_rule_is_seen_to_fail() -> None:
    right = '"""Docstrings of a module."""\ndef one():\n    """Return the user\'s sheet."""\n'
    assert offences(right) == []
    for wrong in ("What a sheet is.", "Told at the end.", "A sheet that a person cut.", "A" + 90 * "b" + "."):
        assert [line for line, _ in offences(f'{right}class Sheet:\n    """{wrong}"""\n')] == [4]


def test_that_a_class_name_means_one_thing(classes: dict[str, list[str]]) -> None:
    shared = {name: places for name, places in classes.items() if len(places) > 1}
    assert shared == WRAPPED, "find another name"
