"""Files of own machines and materials from anywhere: each is used or left out with one short sentence."""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path
from typing import Any

import pytest

from kirigami_studio.export.profile import PROFILES as WRITTEN
from kirigami_studio.export.registry import WRITERS
from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.machine import FILES, PROFILES
from kirigami_studio.fabricate.machine import SHELF as MACHINES
from kirigami_studio.fabricate.material import SHELF as MATERIALS
from kirigami_studio.fabricate.shelf import LARGEST_NUMBER, LEAST_NUMBER, Contents, Shelf
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.resources import resource
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.settings.fabrication import new_settings
from kirigami_studio.studio.cutting import plan_sheet

KINDS: dict[str, tuple[Shelf[Any], str]] = {"machine": (MACHINES, "co2-laser"), "material": (MATERIALS, "card-co2")}
NO_NUMBERS = ("nan", "inf", "-inf", "-1", "1e308", "1" + 400 * "0", "true", '"x"', "[]", "{}", "9999999999999999999")
NO_TEXTS = ("1", "true", "[]", "{}", "1979-05-27")
TEXTS = ('"<img src=file:///etc/passwd><b>"', '"a\\u0000b"', '"\\u202e"', f'"{1000 * "long "}"', '"../../x"', '"con"')
#: Texts of a machine that are keys of a table, and of which no others fit.
WORDS = ("kind", "profile", "file", "construction", "style")


def bundled(kind: str) -> str:
    shelf, key = KINDS[kind]
    return resource(shelf.folder, f"{key}.toml").read_text(encoding="utf-8")


def entries(kind: str, number: bool) -> list[str]:
    """Names of the entries that are numbers, or texts."""
    found = re.findall(r"(?m)^(\w+) = (.)", bundled(kind))
    return [name for name, first in found if (first.isdigit() if number else first == '"')]


def with_entry(kind: str, name: str, value: str) -> str:
    return re.sub(rf"(?m)^{name} = .*$", lambda _: f"{name} = {value}", bundled(kind))


@pytest.fixture(params=KINDS)
def kind(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def folder(kind: str, own_machines: Path, own_materials: Path) -> Path:
    return own_machines if kind == "machine" else own_materials


def contents(kind: str) -> Contents[Any]:
    return KINDS[kind][0].contents()


def test_that_numbers_and_texts_of_no_sense_are_left_out_with_a_sentence(kind: str, folder: Path) -> None:
    cases = [(name, value) for name in entries(kind, number=True) for value in NO_NUMBERS]
    cases += [(name, value) for name in entries(kind, number=False) for value in NO_TEXTS]
    cases += [(name, value) for name in WORDS if name in entries(kind, number=False) for value in TEXTS]
    for number, (name, value) in enumerate(cases):
        (folder / f"bad-{number:03d}.toml").write_text(with_entry(kind, name, value), encoding="utf-8")
    found = contents(kind)
    assert len(cases) > 50 and found.own == frozenset()
    assert len(found.faults) == len(cases)
    assert all(fault.text.isprintable() and len(fault.text) < 400 for fault in found.faults)


def test_that_what_is_no_file_is_left_out_with_a_sentence(kind: str, folder: Path) -> None:
    good = bundled(kind)
    files = {
        "large": f"{good}\n# {10_000_000 * 'x'}".encode(),
        "deep": f"{good}\nextra = {1000 * '['}".encode(),
        "latin": good.encode() + b"# \xff",
        "binary": bytes(range(256)),
        "empty": b"",
    }
    for name, content in files.items():
        (folder / f"{name}.toml").write_bytes(content)
    (folder / "folder.toml").mkdir()
    others = ["folder"]
    if sys.platform != "win32":
        for name, where in (("zero", "/dev/zero"), ("loop", "loop.toml"), ("gone", "gone"), ("link", "folder.toml")):
            (folder / f"{name}.toml").symlink_to(where)
        os.mkfifo(folder / "pipe.toml")
        others += ["zero", "loop", "gone", "link", "pipe"]
    found = contents(kind)
    assert found.own == frozenset() and len(found.faults) == len(files) + len(others)
    for fault in found.faults:
        assert fault.text.isprintable() and "Errno" not in fault.text and fault.text.count(str(folder)) == 1


@pytest.mark.skipif(sys.platform == "win32", reason="names that Windows lacks")
def test_that_names_of_files_and_values_are_plain(kind: str, folder: Path) -> None:
    (folder / "two\nlines<b>.toml").write_text(bundled(kind), encoding="utf-8")
    for number, text in enumerate(TEXTS):
        for name in ("name", "note"):
            (folder / f"{name}-{number}.toml").write_text(with_entry(kind, name, text), encoding="utf-8")
    found = contents(kind)
    assert not found.faults and len(found.own) == 1 + 2 * len(TEXTS)
    for key in found.own:
        item = found.items[key]
        assert item.key == key and item.key.isprintable() and item.name.isprintable() and len(item.name) <= 255
        assert KINDS[kind][0].find(key) == item
        assert all(line.isprintable() for line in item.note.split("\n"))


def test_that_a_file_of_an_editor_of_windows_is_read(kind: str, folder: Path) -> None:
    (folder / "mine.toml").write_bytes(b"\xef\xbb\xbf" + bundled(kind).replace("\n", "\r\n").encode())
    assert contents(kind).own == {"mine"}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("value", [LARGEST_NUMBER, LEAST_NUMBER, 1e-3])
def test_that_the_largest_and_smallest_numbers_are_planned_or_refused(kind: str, value: float, folder: Path) -> None:
    sheet, planned = deploy(Sheet.uniform(3, 3)), 0
    for name in entries(kind, number=True):
        if name == "passes":
            continue
        (folder / "mine.toml").write_text(with_entry(kind, name, f"{value:.9f}"), encoding="utf-8")
        try:
            plan = plan_sheet(sheet, new_settings({kind: "mine"}))
        except KirigamiError as error:
            assert str(error).isprintable()
            continue
        planned += 1
        assert 0.0 < plan.times.total < float("inf")
        assert all(problem.text for problem in check_plan(plan).problems)
    assert planned


def test_that_machines_name_the_profiles_and_files_that_are_written() -> None:
    assert set(PROFILES) == set(WRITTEN) and set(FILES) < set(WRITERS)
