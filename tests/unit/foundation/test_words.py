"""Sentences in the user's language."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from babel.messages.catalog import Catalog

from kirigami_studio.foundation.words import FOLDER_VARIABLE, LANGUAGE_VARIABLE, environment_languages, tr, tr_n
from tests.catalogues import write_compiled


def test_that_english_is_said_as_it_is_written() -> None:
    assert tr("Reading {name} …", name="a{b}") == "Reading a{b} …"
    assert tr("{not a place}") == "{not a place}"
    assert tr("") == ""
    assert tr("{share:.1f} % missing", share=2.345) == "2.3 % missing"


@pytest.mark.parametrize(("count", "said"), [(0, "0 designs"), (1, "One design"), (3, "3 designs")])
def test_that_one_thing_is_spoken_of_as_one(count: int, said: str) -> None:
    assert tr_n("One design", "{count} designs", count) == said


def test_that_a_catalogue_of_the_users_language_is_read(tmp_path: Path) -> None:
    catalogue = Catalog("de")
    catalogue.add("Reading {name} …", "{name} wird gelesen …")
    catalogue.add(("One design", "{count} designs"), ("Ein Entwurf", "{count} Entwürfe"))
    write_compiled(catalogue, tmp_path, "de")
    program = (
        "from kirigami_studio.foundation.words import tr, tr_n\n"
        "print(tr('Reading {name} …', name='x'), tr_n('One design', '{count} designs', 4), tr('Undo'))"
    )
    env = {"LANGUAGE": "de", "PYTHONIOENCODING": "utf-8", FOLDER_VARIABLE: str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", program], env=env, capture_output=True, text=True, encoding="utf-8", check=True
    )
    assert done.stdout.strip() == "x wird gelesen … 4 Entwürfe Undo"


def test_that_a_damaged_value_is_written_plainly() -> None:
    assert tr("{name:.40} is {size:.1f} mm wide.", name=["a"], size="wide") == "['a'] is wide mm wide."


def test_that_the_language_of_this_program_comes_before_that_of_the_desktop(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LANGUAGE", "fr:en")
    assert environment_languages() == ("fr", "en")
    monkeypatch.setenv(LANGUAGE_VARIABLE, "de_AT.UTF-8")
    assert environment_languages() == ("de_AT",)
