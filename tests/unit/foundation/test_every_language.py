"""Every sentence is formatted in every language, with all its values, and in the plural form of the count."""

from __future__ import annotations

import gettext
import string
from collections.abc import Iterator

import pytest

import kirigami_studio.lab  # noqa: F401  (its sentences)
from kirigami_studio.foundation import words
from kirigami_studio.foundation.sentences import SENTENCES, sentence
from kirigami_studio.foundation.words import decimal_sign, tr, tr_n
from tests.catalogues import catalogue, forms, template

LANGUAGES = words.languages()
COUNTS = (0, 1, 2, 7)


@pytest.fixture(autouse=True, params=LANGUAGES)
def language(request: pytest.FixtureRequest) -> Iterator[str]:
    assert words.choose(request.param) == request.param
    yield request.param
    words.choose(*words.environment_languages())


def values_of(*texts: str) -> dict[str, object]:
    """A value for every field, each a different one, of the kind that its format asks for."""
    values: dict[str, object] = {}
    for text in texts:
        for _, name, form, conversion in string.Formatter().parse(text):
            if name is None or name == "count":
                continue
            if conversion is None and form and form[-1] in "feg%":
                values[name] = 12.25 + len(values)
            elif conversion is None and form and form[-1] == "d":
                values[name] = 40 + len(values)
            else:
                values[name] = f"value of {name}"
    return values


def filled(form: str, values: dict[str, object]) -> str:
    """A form with its values, each formatted by itself, numbers with the decimal sign of the language."""
    parts = []
    for text, name, spec, conversion in string.Formatter().parse(form):
        parts.append(text)
        if name is not None:
            value = repr(values[name]) if conversion == "r" else values[name]
            shown = format(value, spec or "")
            parts.append(shown.replace(".", decimal_sign()) if isinstance(value, float) else shown)
    return "".join(parts)


def expected_forms(ids: tuple[str, ...], language: str) -> tuple[str, ...]:
    """The forms of a message in a language, by the plural rule's number."""
    message = None if language == words.ENGLISH else catalogue(language).get(ids if len(ids) > 1 else ids[0])
    assert message is not None or language == words.ENGLISH, ids
    return ids if message is None else forms(message.string)


def rule(language: str) -> str:
    return "n != 1" if language == words.ENGLISH else catalogue(language).plural_expr


def test_that_every_sentence_is_said_with_all_its_values(language: str) -> None:
    said = 0
    for message in template():
        ids = forms(message.id)
        if not message.id or len(ids) > 1 or "{" not in ids[0]:
            continue
        try:
            values = values_of(ids[0]) | ({"count": 7} if "{count" in ids[0] else {})
        except ValueError:  # its braces are no places for values, and it is said without any
            continue
        if not values:
            continue
        (form,) = expected_forms(ids, language)
        assert tr(ids[0], **values) == filled(form, values)
        said += 1
    assert said > 500


@pytest.mark.parametrize("count", COUNTS)
def test_that_every_sentence_that_counts_is_said_in_the_form_of_the_count(language: str, count: int) -> None:
    form_of = gettext.c2py(rule(language))
    pairs = [forms(message.id) for message in template() if len(forms(message.id)) == 2]
    assert len(pairs) > 100
    for one, many in pairs:
        values = values_of(one, many)
        wanted = expected_forms((one, many), language)[form_of(count)]
        assert tr_n(one, many, count, **values) == filled(wanted, {"count": count, **values})


@pytest.mark.parametrize("count", COUNTS)
def test_that_every_problem_has_its_sentence(language: str, count: int) -> None:
    form_of = gettext.c2py(rule(language))
    for code, text in SENTENCES.items():
        ids = forms(text)
        values = values_of(*ids) | ({"count": count} if len(ids) > 1 or "{count" in ids[0] else {})
        form = expected_forms(ids, language)[form_of(count) if len(ids) > 1 else 0]
        if "material" in values and isinstance(values["material"], str):
            values["material"] = "Steel"  # one that no catalogue translates
        assert sentence(code, values) == filled(form, values), code
