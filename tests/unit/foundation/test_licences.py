"""Everything that is shipped has a licence with its text, wherever it comes from."""

from __future__ import annotations

import json
from importlib.metadata import Distribution, requires
from pathlib import Path

import pytest

from kirigami_studio.cli import main
from kirigami_studio.foundation.licences import OURS, Package, components, normalised, packages


def test_that_every_part_has_a_licence_and_its_text() -> None:
    found = components()
    assert len(found) > 20
    assert [part.name for part in found if not part.licence or len(part.text) < 200] == []


def test_that_the_program_comes_first_and_the_others_by_name() -> None:
    names = [part.name.lower() for part in components()]
    assert names[0] == OURS and names[1:] == sorted(names[1:])


def test_that_every_package_that_the_program_needs_is_listed_and_no_extra() -> None:
    wanted = {normalised(line) for line in requires(OURS) or () if "extra ==" not in line}
    extras = {normalised(line) for line in requires(OURS) or () if "extra ==" in line} - wanted
    assert len(wanted) > 10
    assert wanted <= set(packages())
    assert "pytest" in extras and "pytest" not in packages()


def test_that_qt_comes_with_the_lgpl_and_with_the_way_to_replace_it() -> None:
    qt = next(part for part in components() if normalised(part.name) == "pyside6-essentials")
    assert qt.licence == "LGPL-3.0-only"
    for words in ("you may replace them", "GNU LESSER GENERAL PUBLIC LICENSE", "GNU GENERAL PUBLIC LICENSE"):
        assert words in " ".join(qt.text.split())


def test_that_what_is_no_python_package_is_listed_from_the_bundled_tables(repository: Path) -> None:
    table = json.loads((repository / "resources" / "licences" / "components.json").read_text(encoding="utf-8"))
    names = {part.name for part in components()}
    assert len(table) == 2 and {entry["name"] for entry in table} <= names


def test_that_an_old_licence_is_read_where_no_list_of_files_is(tmp_path: Path) -> None:
    """As in a frozen program."""
    folder = tmp_path / "Some_Name-1.0.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: some-name\nVersion: 1.0\nLicense-File: OLD\n")
    (folder / "OLD").write_bytes("© Müller".encode("latin-1"))
    (found,) = Distribution.discover(name="some-name", path=[str(tmp_path)])
    assert Package(found, found.metadata).texts == ["© Müller"]


@pytest.mark.parametrize(
    ("requirement", "name"),
    [("PySide6_Essentials>=6.8", "pyside6-essentials"), ("tomli-w", "tomli-w"), ("a.b_c ; x == 'y'", "a-b-c")],
)
def test_that_names_are_compared_as_registries_do(requirement: str, name: str) -> None:
    assert normalised(requirement) == name


def test_that_the_command_line_lists_and_prints_licences(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["licences"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == len(components())
    assert main(["licences", "tomli.w"]) == 0
    assert capsys.readouterr().out.startswith("MIT License")
    assert main(["licences", "gpl-by-mistake"]) == 2
    assert "gpl-by-mistake" in capsys.readouterr().err
