"""The German catalogue says everything that the program says."""

from __future__ import annotations

import string
from pathlib import Path

import pytest
from babel.messages.catalog import Catalog
from babel.messages.pofile import read_po

from kirigami_studio.export.profile import PROFILES
from kirigami_studio.fabricate.material import library
from kirigami_studio.foundation.words import DOMAIN, read_catalogue
from kirigami_studio.outlines import silhouettes


@pytest.fixture(scope="module")
def template(repository: Path) -> Catalog:
    with (repository / "resources" / "locale" / f"{DOMAIN}.pot").open("rb") as stream:
        return read_po(stream)


@pytest.fixture(scope="module")
def german_file(repository: Path) -> Path:
    return repository / "resources" / "locale" / "de" / "LC_MESSAGES" / f"{DOMAIN}.po"


@pytest.fixture(scope="module")
def german(german_file: Path) -> Catalog:
    with german_file.open("rb") as stream:
        return read_po(stream)


def forms(text: object) -> tuple[str, ...]:
    """The singular and the plural, or the one form there is."""
    return tuple(text) if isinstance(text, tuple | list) else (str(text),)


def places(text: str) -> list[tuple[str, str | None, str | None]]:
    """Names, formats and conversions of the values in a text; none where its braces are no places for values."""
    try:
        return sorted((name, form, sign) for _, name, form, sign in string.Formatter().parse(text) if name is not None)
    except ValueError:
        return []


def pairs(template: Catalog, german: Catalog) -> list[tuple[str, str]]:
    found = []
    for message in template:
        said = german.get(message.id)
        if message.id and said is not None:
            found += list(zip(forms(message.id), forms(said.string), strict=True))
    return found


def test_that_every_sentence_is_said_in_german(template: Catalog, german: Catalog) -> None:
    wanted = {forms(message.id) for message in template if message.id}
    said = {forms(message.id) for message in german if message.id and all(forms(message.string))}
    assert wanted - said == set(), "translate these in resources/locale/de"
    assert said - wanted == set(), "these are no longer said"


def test_that_no_german_sentence_is_a_guess(german: Catalog) -> None:
    assert [message.id for message in german if message.id and message.fuzzy] == []


def test_that_german_sentences_name_the_same_values_in_the_same_formats(template: Catalog, german: Catalog) -> None:
    other = [(english, said) for english, said in pairs(template, german) if places(english) != places(said)]
    assert other == []
    assert places("{a:.1f} of {b!r:.40}") != places("{a:.2f} von {b!r:.40}")


def test_that_german_sentences_end_and_break_as_the_english_ones_do(template: Catalog, german: Catalog) -> None:
    for english, said in pairs(template, german):
        assert english.count("\n") == said.count("\n"), english
        assert english.endswith("…") == said.endswith("…"), english
        assert english[: len(english) - len(english.lstrip())] == said[: len(said) - len(said.lstrip())], english
        assert english[len(english.rstrip()) :] == said[len(said.rstrip()) :], english


def test_that_a_letter_is_marked_wherever_the_english_text_marks_one(template: Catalog, german: Catalog) -> None:
    assert [english for english, said in pairs(template, german) if english.count("&") != said.count("&")] == []


def test_that_fixed_numbers_have_the_comma(template: Catalog, german: Catalog) -> None:
    """Numbers with a point stand for what is typed on the command line or in files, between quotes."""
    with_point = [said for english, said in pairs(template, german) if has_point(said) and not has_point(english)]
    assert with_point == []
    kept = [said for _, said in pairs(template, german) if has_point(said)]
    assert [said for said in kept if not any(sign in said for sign in ("'", "=", "--"))] == []


def has_point(text: str) -> bool:
    """Whether a number outside the places for values has a decimal point."""
    plain = "".join(part for part, *_ in string.Formatter().parse(text)) if places(text) else text
    triples = zip(plain, plain[1:], plain[2:], strict=False)
    return any(before.isdigit() and sign == "." and after.isdigit() for before, sign, after in triples)


def test_that_the_catalogue_is_read_as_babel_reads_it(german_file: Path, german: Catalog) -> None:
    read = read_catalogue(german_file, "de")
    assert read.texts == {forms(message.id)[0]: forms(message.string) for message in german if message.id}
    assert [read.form(count) for count in (0, 1, 2)] == [1, 0, 1]


def test_that_bundled_silhouettes_materials_and_profiles_have_german_names_and_notes(german: Catalog) -> None:
    shown = [entry for name in silhouettes.names() for entry in (name, *titles(name))]
    shown += [words for one in library().materials.values() for words in (one.name, one.machine, one.note)]
    shown += [profile.name for profile in PROFILES.values()]
    assert [words for words in shown if german.get(words) is None] == []


def titles(name: str) -> tuple[str, str]:
    entry = silhouettes.entry(name)
    return entry.title, entry.about
