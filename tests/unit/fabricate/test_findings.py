"""Notes and problems: codes and values, whose sentence is made when it is read and has all that it names."""

from __future__ import annotations

import ast
import pickle
import string
from pathlib import Path

import pytest

from kirigami_studio.fabricate.findings import Note, Problem, Severity
from kirigami_studio.foundation.sentences import SENTENCES

#: How notes, problems and findings are made: the code is the first text among the arguments.
MAKERS = ("of", "error", "warning", "judged", "weighed", "check_length")


def test_that_a_problem_is_a_code_with_values_and_a_place() -> None:
    problem = Problem.warning("plan.removed_not_cut_through", (1.0, 2.0), count=1)
    assert (problem.code, problem.severity, problem.where) == (
        "plan.removed_not_cut_through",
        Severity.WARNING,
        (1.0, 2.0),
    )
    assert problem.text.startswith("1 removed connector is not cut through, at x = 1.00, y = 2.00 mm.")
    many = Problem.warning("plan.removed_not_cut_through", (1.0, 2.0), count=2)
    assert many.text.startswith("2 removed connectors are not cut through, the first at")
    assert many != problem and pickle.loads(pickle.dumps(many)) == many
    assert len({problem, Note.of("plan.cut_twice"), Note.of("plan.cut_twice")}) == 2


def fields_of(code: str) -> set[str]:
    text = SENTENCES[code]
    forms = text if isinstance(text, tuple) else (text,)
    named = {name for form in forms for _, name, _, _ in string.Formatter().parse(form) if name}
    return named | ({"count"} if isinstance(text, tuple) else set())


@pytest.mark.parametrize("package", ["fabricate", "export"])
def test_that_every_finding_has_a_code_and_brings_the_values_that_its_sentence_names(
    package: str, repository: Path
) -> None:
    wrong, seen = [], 0
    for path in sorted((repository / "kirigami_studio" / package).glob("*.py")):
        for call in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(call, ast.Call):
                continue
            maker = call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
            texts = [word.value for word in call.args if isinstance(word, ast.Constant) and isinstance(word.value, str)]
            if maker not in MAKERS or not texts:
                continue
            seen += 1
            code, given = texts[0], {keyword.arg for keyword in call.keywords}
            place = {"x", "y"} if maker in ("error", "warning", "weighed") and len(call.args) > 1 else set()
            if maker == "check_length":
                given = (given - {"zero_allowed"}) | {"value"}
            if code not in SENTENCES:
                wrong.append(f"{path.name}:{call.lineno} {code}: no such code")
            elif None not in given and given | place != fields_of(code) | place:
                wrong.append(f"{path.name}:{call.lineno} {code}: {sorted(map(str, given))}")
    assert seen > 10 and wrong == []
