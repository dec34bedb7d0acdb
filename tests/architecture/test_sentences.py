"""Every problem has a code, every code one whole sentence, and a problem brings the values that its sentence names."""

from __future__ import annotations

import ast
import re
import string
from dataclasses import dataclass
from pathlib import Path

import pytest

import kirigami_studio.lab
from kirigami_studio.foundation import errors
from kirigami_studio.foundation.errors import ExportError, KirigamiError
from kirigami_studio.foundation.sentences import SENTENCES, sentence

pytestmark = pytest.mark.rule

CODE = re.compile(r"[a-z][a-z0-9_]*(\.[a-z0-9_]+)+")
#: Told in one clause, which a longer sentence takes in.
CLAUSES = re.compile(r"[.!?:)…}]$|\{\w+[^}]*\}$")


def tables_of(repository: Path) -> list[Path]:
    """The modules with sentences: those of the product, and that of the lab."""
    package = repository / "kirigami_studio"
    return [*(package / "foundation" / "sentences").glob("*.py"), package / "lab" / "sentences.py"]


@dataclass(frozen=True)
class Call:
    """A call whose first argument is a text: where it is, what it makes, the text, the names of its values."""

    place: str
    callee: str
    text: str
    fields: frozenset[str]
    complete: bool


def calls_in(path: Path) -> list[Call]:
    """All calls of a module that begin with a literal text or an f-string, which counts as none."""
    found = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.Call) or not node.args:
            continue
        callee = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        first = node.args[0]
        if isinstance(first, ast.Constant) and isinstance(first.value, str):
            text = first.value
        elif isinstance(first, ast.JoinedStr):
            text = "an f-string"
        else:
            continue
        names = frozenset(keyword.arg for keyword in node.keywords if keyword.arg is not None)
        complete = len(names) == len(node.keywords)
        found.append(Call(f"{path.name}:{node.lineno}", callee, text, names, complete))
    return found


@pytest.fixture(scope="module")
def calls(repository: Path) -> list[Call]:
    tables = tables_of(repository)
    paths = sorted((repository / "kirigami_studio").rglob("*.py"))
    return [call for path in paths if path not in tables for call in calls_in(path)]


def kinds_of_errors() -> set[str]:
    """Names of the classes of problems."""
    return {name for name, kind in vars(errors).items() if isinstance(kind, type) and issubclass(kind, KirigamiError)}


def fields_of(text: str | tuple[str, str]) -> set[str]:
    """Names of the values in a sentence, or in both forms of one that counts."""
    forms = text if isinstance(text, tuple) else (text,)
    return {name.split(".")[0] for form in forms for _, name, _, _ in string.Formatter().parse(form) if name}


def test_that_every_error_is_raised_with_a_code(calls: list[Call]) -> None:
    kinds = kinds_of_errors()
    assert [f"{call.place}: {call.text}" for call in calls if call.callee in kinds and call.text not in SENTENCES] == []


def test_that_a_problem_brings_the_values_that_its_sentence_names(calls: list[Call]) -> None:
    kinds = kinds_of_errors()
    wrong = []
    for call in calls:
        if call.callee not in kinds or call.text not in SENTENCES or not call.complete:
            continue
        text = SENTENCES[call.text]
        needed = fields_of(text) | ({"count"} if isinstance(text, tuple) else set())
        if call.fields != needed:
            wrong.append(f"{call.place} {call.text}: brings {sorted(call.fields)}, its sentence names {sorted(needed)}")
    assert wrong == []


def test_that_no_code_is_left_over(repository: Path) -> None:
    tables = tables_of(repository)
    paths = (repository / "kirigami_studio").rglob("*.py")
    code = "\n".join(path.read_text(encoding="utf-8") for path in paths if path not in tables)
    assert [name for name in SENTENCES if f'"{name}"' not in code] == []


def test_that_codes_are_names_and_sentences_are_whole() -> None:
    assert [code for code in SENTENCES if not CODE.fullmatch(code)] == []
    forms = [form for text in SENTENCES.values() for form in (text if isinstance(text, tuple) else (text,))]
    assert [form for form in forms if not CLAUSES.search(form)] == []
    assert [form for form in forms if "  " in form or form != form.strip()] == []


def test_that_the_lab_brings_its_own_sentences() -> None:
    assert set(kirigami_studio.lab.sentences.SENTENCES) <= set(SENTENCES)


def test_that_no_code_stands_in_two_tables(repository: Path) -> None:
    keys = [
        key.value
        for table in tables_of(repository)
        for node in ast.walk(ast.parse(table.read_text(encoding="utf-8")))
        if isinstance(node, ast.Dict)
        for key in node.keys
        if isinstance(key, ast.Constant)
    ]
    assert len(keys) > 200
    assert sorted({key for key in keys if keys.count(key) > 1}) == []


def test_that_a_sentence_is_made_when_it_is_read() -> None:
    error = ExportError("file.not_written", path="cut.dxf", reason="No space left on device")
    assert error.code == "file.not_written" and error.fields["path"] == "cut.dxf"
    assert str(error) == sentence(error.code, error.fields)
    assert str(error).startswith("Cannot write cut.dxf: No space left on device.")
