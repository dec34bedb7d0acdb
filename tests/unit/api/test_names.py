"""The names of the Python API: stable, listed, loaded when asked for, the same for type checkers and documents."""

from __future__ import annotations

import ast
import builtins
import importlib
import inspect
import json
import re
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import FrozenInstanceError
from enum import Enum
from pathlib import Path
from typing import Any, Literal, get_args, get_origin, get_type_hints

import pytest

import kirigami_studio as ks
from kirigami_studio.api.choices import CUTS, SEARCH, CutKeywords, SearchKeywords, keywords_of

pytestmark = pytest.mark.rule

#: What the API gives on which no promise rests: they come with their base classes.
INHERITED = {"add_note", "args", "with_traceback"}
LOADED = """
import json, sys
import kirigami_studio as ks
before = [name for name in sys.modules if name.startswith("kirigami_studio.")]
from kirigami_studio import *
heavy = [name for name in ("torch", "PySide6", "matplotlib") if name in sys.modules]
print(json.dumps([before, heavy, load_target("star").name, sorted(set(dir(ks)) & set(ks.__all__))]))
"""


@pytest.fixture(scope="module")
def listed(repository: Path) -> dict[str, set[str]]:
    """The table of stable names: each with the attributes that stand beside it."""
    text = (repository / "docs" / "python-api.md").read_text(encoding="utf-8")
    table = text.partition("## Stable names")[2].partition("\n## ")[0]
    rows = re.findall(r"^\| (`[^|]*) \| (.*) \|$", table, flags=re.MULTILINE)
    found: dict[str, set[str]] = {}
    for names, about in rows:
        for name in re.findall(r"`(\w+)`", names):
            found[name] = set(re.findall(r"`([\w.]+)`", about))
    return found


def public(kind: type) -> set[str]:
    """Public attributes of a class, those of its instances included."""
    fields = getattr(kind, "__dataclass_fields__", {})
    return {name for name in (*vars_of(kind), *fields) if not name.startswith("_")} - INHERITED


def vars_of(kind: type) -> Mapping[str, object]:
    return dict(inspect.getmembers(kind))


def test_that_the_table_of_stable_names_is_what_there_is(listed: dict[str, set[str]]) -> None:
    assert sorted(listed) == ks.__all__


@pytest.mark.parametrize(
    "name",
    [
        "Target",
        "Sheet",
        "Design",
        "Designs",
        "Cuts",
        "Simulation",
        "Exported",
        "CheckedFile",
        "Progress",
        "Score",
        "Verdict",
        "Feasibility",
    ],
)
def test_that_the_table_has_every_attribute(listed: dict[str, set[str]], name: str) -> None:
    assert listed[name] == public(getattr(ks, name))


def test_that_importing_loads_nothing_and_all_names_neither_torch_nor_qt() -> None:
    done = subprocess.run([sys.executable, "-c", LOADED], capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    before, heavy, name, names = json.loads(done.stdout)
    assert (before, heavy, name, names) == ([], [], "star", ks.__all__)


def test_that_no_name_hides_a_builtin_or_a_package(repository: Path) -> None:
    packages = {path.stem for path in (repository / "kirigami_studio").iterdir()}
    assert set(ks.__all__) & (set(dir(builtins)) | packages) == set()


def test_that_type_checkers_are_told_the_same_names(repository: Path) -> None:
    package = repository / "kirigami_studio"
    told = {}
    for node in ast.walk(ast.parse((package / "__init__.pyi").read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module is not None:
            told |= {alias.asname: getattr(importlib.import_module(node.module), alias.name) for alias in node.names}
    assert told == {name: getattr(ks, name) for name in ks.__all__}
    assert (package / "py.typed").exists()


def test_that_other_names_are_missing_as_usual() -> None:
    with pytest.raises(AttributeError, match=r"kirigami_studio.*no attribute 'desing'"):
        ks.desing  # noqa: B018
    assert ks.__version__


@pytest.mark.parametrize(
    ("wrong", "right"),
    [
        (lambda design: ks.desing, "design"),
        (lambda design: design.nmae, "name"),
        (lambda design: setattr(design, "nmae", "mine"), "name"),
        (lambda design: delattr(design.target, "nmae"), "name"),
    ],
)
def test_that_a_misspelt_attribute_is_refused_with_the_one_that_was_meant(
    design: ks.Design, wrong: Callable[[ks.Design], object], right: str
) -> None:
    with pytest.raises(AttributeError, match=rf"no attribute '\w+'\. Did you mean: '{right}'\?$"):
        wrong(design)


def test_that_an_attribute_like_no_other_is_missing_as_usual(design: ks.Design) -> None:
    with pytest.raises(AttributeError, match=r"'Design' object has no attribute 'zzz'$"):
        design.zzz  # type: ignore[attr-defined]  # noqa: B018
    assert not hasattr(design, "_repr_png_") and not hasattr(ks, "zzz")


def test_that_values_are_read_only(design: ks.Design) -> None:
    for name in ("document", "name"):
        with pytest.raises(FrozenInstanceError, match=name):
            setattr(design, name, "mine")


@pytest.mark.parametrize("kind", [SearchKeywords, CutKeywords])
def test_that_type_checkers_know_the_words_of_every_choice(kind: type) -> None:
    hints, seen = get_type_hints(kind), 0
    settings = {one.keyword: one for one in keywords_of(*SEARCH, *CUTS).values()}
    for name, hint in hints.items():
        if name in settings and issubclass(settings[name].kind, Enum):
            words = {word for part in get_args(hint) if get_origin(part) is Literal for word in get_args(part)}
            words |= set(get_args(hint)) & {str(one) for one in words} if get_origin(hint) is Literal else set()
            assert words == {choice.value for choice in settings[name].kind}, name
            assert str not in get_args(hint), f"{name} takes any text"
            seen += 1
    assert seen >= 3


def test_that_every_public_name_says_what_it_is() -> None:
    values = [getattr(ks, name) for name in ks.__all__]
    assert [value for value in values if not inspect.getdoc(value)] == []
    functions = [value for value in values if inspect.isfunction(value)]
    loose = {
        function.__name__: [
            name for name, one in inspect.signature(function).parameters.items() if one.annotation is one.empty
        ]
        for function in functions
    }
    assert {name for name, missing in loose.items() if missing} == set()


@pytest.mark.parametrize(("function", "kinds"), [(ks.design, SEARCH), (ks.Design.plan_cuts, CUTS)])
def test_that_help_tells_of_every_keyword_once_and_with_its_meaning(function: Any, kinds: tuple[type, ...]) -> None:
    told = inspect.getdoc(function) or ""
    assert "**choices" not in told
    for keyword in inspect.signature(function).parameters.keys() - {"self"}:
        assert len(re.findall(rf"(?m)^(?:\w+, )*{keyword}(?:, \w+)* : ", told)) == 1, keyword
    for keyword in keywords_of(*kinds):
        assert re.search(rf"(?m)^{keyword} : .+\n    \S", told), f"{keyword} has no meaning in its dataclass"
