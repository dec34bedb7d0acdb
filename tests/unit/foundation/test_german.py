"""The German catalogue says everything that the program says."""

from __future__ import annotations

import gettext
import string

from kirigami_studio.export.profile import PROFILES
from kirigami_studio.fabricate.machine import cuttable, machines
from kirigami_studio.fabricate.material import library
from kirigami_studio.foundation.words import DOMAIN
from kirigami_studio.outlines import silhouettes
from tests.catalogues import LOCALE, catalogue, forms, template

GERMAN = catalogue("de")


def places(text: str) -> list[tuple[str, str | None, str | None]]:
    """Names, formats and conversions of the values in a text; none where its braces are no places for values."""
    try:
        return sorted((name, form, sign) for _, name, form, sign in string.Formatter().parse(text) if name is not None)
    except ValueError:
        return []


def pairs() -> list[tuple[str, str]]:
    found = []
    for message in template():
        said = GERMAN.get(message.id)
        if message.id and said is not None:
            found += list(zip(forms(message.id), forms(said.string), strict=True))
    return found


def test_that_every_sentence_is_said_in_german() -> None:
    wanted = {forms(message.id) for message in template() if message.id}
    said = {forms(message.id) for message in GERMAN if message.id and all(forms(message.string))}
    assert wanted - said == set(), "translate these in resources/locale/de"
    assert said - wanted == set(), "these are no longer said"


def test_that_no_german_sentence_is_a_guess() -> None:
    assert [message.id for message in GERMAN if message.id and message.fuzzy] == []


def test_that_german_sentences_name_the_same_values_in_the_same_formats() -> None:
    other = [(english, said) for english, said in pairs() if places(english) != places(said)]
    assert other == []
    assert places("{a:.1f} of {b!r:.40}") != places("{a:.2f} von {b!r:.40}")


def test_that_german_sentences_end_and_break_as_the_english_ones_do() -> None:
    for english, said in pairs():
        assert english.count("\n") == said.count("\n"), english
        assert english.endswith("…") == said.endswith("…"), english
        assert english[: len(english) - len(english.lstrip())] == said[: len(said) - len(said.lstrip())], english
        assert english[len(english.rstrip()) :] == said[len(said.rstrip()) :], english


def test_that_a_letter_is_marked_wherever_the_english_text_marks_one() -> None:
    assert [english for english, said in pairs() if english.count("&") != said.count("&")] == []


def test_that_fixed_numbers_have_the_comma() -> None:
    """Numbers with a point stand for what is typed on the command line or in files, between quotes."""
    with_point = [said for english, said in pairs() if has_point(said) and not has_point(english)]
    assert with_point == []
    kept = [said for _, said in pairs() if has_point(said)]
    assert [said for said in kept if not any(sign in said for sign in ("'", "=", "--"))] == []


def has_point(text: str) -> bool:
    """Whether a number outside the places for values has a decimal point."""
    plain = "".join(part for part, *_ in string.Formatter().parse(text)) if places(text) else text
    triples = zip(plain, plain[1:], plain[2:], strict=False)
    return any(before.isdigit() and sign == "." and after.isdigit() for before, sign, after in triples)


def test_that_the_compiled_catalogue_says_what_the_source_says() -> None:
    compiled = gettext.translation(DOMAIN, LOCALE, ["de"])
    singles = [message for message in GERMAN if message.id and not message.pluralizable]
    counting = [message for message in GERMAN if message.pluralizable]
    assert len(singles) > 2000 and len(counting) > 100
    assert [one.id for one in singles if compiled.gettext(str(one.id)) != one.string] == []
    for message in counting:
        one, many = message.id
        assert [compiled.ngettext(one, many, count) for count in (1, 0, 2)] == [message.string[at] for at in (0, 1, 1)]


def test_that_bundled_silhouettes_materials_and_profiles_have_german_names_and_notes() -> None:
    shown = [entry for name in silhouettes.names() for entry in (name, *titles(name))]
    shown += [words for one in library().items.values() for words in (one.name, one.machine, one.note)]
    shown += [profile.name for profile in PROFILES.values()]
    for machine in machines().items.values():
        shown += [machine.name, machine.note, machine.kind.words]
        shown += [words for one in cuttable(machine).values() for words in (one.name, one.machine, one.note)]
    assert [words for words in shown if GERMAN.get(words) is None] == []


def titles(name: str) -> tuple[str, str]:
    entry = silhouettes.entry(name)
    return entry.title, entry.about
