"""A project brings the numbers of its own machine and material, and says where others are used in their place."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from kirigami_studio.export.dxf_check import check_file
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.machine import SHELF as MACHINES
from kirigami_studio.fabricate.machine import changed_machine, machines
from kirigami_studio.fabricate.material import SHELF as MATERIALS
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.project.document import Document
from kirigami_studio.project.store import ProjectError, load, packed_design, save
from kirigami_studio.settings.fabrication import FabricationSettings, machine_for, named_machine, stored_machine
from kirigami_studio.studio.checking import recorded_settings
from kirigami_studio.studio.cutting import plan_sheet
from kirigami_studio.studio.making import CutRequest, Output, planned, written

#: Slow, and too small for the sheet.
CHANGES = {"bed_width_mm": "90", "on_delay_s": "0.4", "largest_speed_mm_s": "3", "name": "Old laser"}


def plan_of(document: Document) -> CutPlan:
    return plan_sheet(deploy(Sheet.uniform(4, 5)), document.fabrication)


def said(document: Document) -> list[str]:
    """Codes of the notes on machine and material."""
    return [note.code for note in plan_of(document).notes if note.code.endswith(("_unknown", "_differs"))]


@pytest.fixture
def project(document: Document, own_machines: Path) -> Callable[[str], Path]:
    """Saves a project that is cut by an own machine of a key."""

    def write(key: str) -> Path:
        MACHINES.save(changed_machine("co2-laser", key, CHANGES))
        path = own_machines / "project.kiri"
        save(replace(document, fabrication=replace(document.fabrication, material="card-co2", machine=key)), path)
        return path

    return write


def test_that_a_project_is_cut_by_its_machine_where_nobody_has_it(project: Callable[[str], Path]) -> None:
    path = project("my-laser")
    before = plan_of(load(path))
    MACHINES.delete("my-laser")
    document = load(path)
    after = plan_of(document)
    assert after.machine == before.machine and after.machine.reach_mm == (90.0, 400.0)
    assert after.times == before.times and after.times.total > 2.0 * plan_of(_by(document, "co2-laser")).times.total
    assert said(document) == []
    save(document, path)
    assert stored_machine(load(path).fabrication) == before.machine, "and it goes on travelling"
    assert named_machine(_by(document, "glowforge").fabrication) == machines().items["glowforge"]
    assert said(_by(document, "sold")) == ["plan.machine_unknown"]


def test_that_a_cut_file_is_checked_by_the_machine_that_it_carries(
    project: Callable[[str], Path], tmp_path: Path
) -> None:
    document = load(project("my-laser"))
    request = CutRequest.of(document)
    found = written(request, planned(request), Output(tmp_path / "cut.dxf"), None)
    MACHINES.delete("my-laser")
    record = check_file(found.path).record
    assert record is not None and record.machine == "my-laser"
    # The project is cut by another machine by now, and does not carry that of the file any more.
    again = recorded_settings(record, found.path, FabricationSettings(machine="glowforge"))
    assert machine_for(again) == machine_for(document.fabrication) and machine_for(again).name == "Old laser"


def _by(document: Document, machine: str) -> Document:
    return replace(document, fabrication=replace(document.fabrication, machine=machine))


def test_that_the_design_in_a_cut_file_brings_its_machine(project: Callable[[str], Path], tmp_path: Path) -> None:
    document = load(project("my-laser"))
    (tmp_path / "one.kiri").write_bytes(packed_design(document, document.candidates[1]))
    MACHINES.delete("my-laser")
    assert plan_of(load(tmp_path / "one.kiri")).machine == plan_of(document).machine


@pytest.mark.parametrize("key", ["my-laser", "co2-laser"])
def test_that_another_machine_of_the_same_key_is_used_and_said(key: str, project: Callable[[str], Path]) -> None:
    path = project(key)
    if key == "my-laser":
        MACHINES.save(replace(changed_machine("k40", key, {}), key=key))
    else:
        MACHINES.delete(key)  # of the bundled one's key, which comes back
    document = load(path)
    assert plan_of(document).machine == machines().items[key]
    assert said(document) == ["plan.machine_differs"]
    save(document, path)
    assert said(load(path)) == [], "saved with what was used"


def test_that_other_words_are_no_difference(project: Callable[[str], Path]) -> None:
    path = project("my-laser")
    MACHINES.save(replace(machines().items["my-laser"], name="Renamed", note="In the cellar"))
    assert said(load(path)) == []


def test_that_another_material_of_the_same_key_is_said_too(document: Document, own_materials: Path) -> None:
    MATERIALS.save(replace(find_material("card-co2"), kerf_mm=0.31))
    path = own_materials / "project.kiri"
    save(replace(document, fabrication=replace(document.fabrication, material="card-co2")), path)
    assert said(load(path)) == []
    MATERIALS.delete("card-co2")
    assert said(load(path)) == ["plan.material_differs"]


def test_that_a_bundled_machine_is_not_carried(document: Document, tmp_path: Path) -> None:
    save(_by(document, "glowforge"), tmp_path / "bundled.kiri")
    assert "own_machine" not in _design(tmp_path / "bundled.kiri")["fabrication"]


def _design(path: Path) -> dict[str, dict[str, object]]:
    with zipfile.ZipFile(path) as archive:
        found: dict[str, dict[str, object]] = json.loads(archive.read("design.json"))
        return found


@pytest.mark.parametrize(
    ("entry", "value"),
    [
        ("bed_width_mm", -1.0), ("travel_mm_s", 0), ("travel_mm_s", 10**400), ("acceleration_mm_s2", "fast"),
        ("kind", "axe"), ("kind", None), ("name", None), ("name", 3), ("note", ["a"]), ("profile", 1), ("file", {}),
    ],
)  # fmt: skip
def test_that_an_impossible_machine_in_a_project_is_refused(
    entry: str, value: object, project: Callable[[str], Path]
) -> None:
    path = project("my-laser")
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    design = json.loads(members["design.json"])
    design["fabrication"]["own_machine"][entry] = value
    members["design.json"] = json.dumps(design).encode()
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    with pytest.raises(ProjectError) as found:
        load(path)
    assert found.value.code == "project.damaged" and "\n" not in str(found.value)


def test_that_words_of_a_carried_machine_are_plain_text(project: Callable[[str], Path], document: Document) -> None:
    machine = replace(changed_machine("co2-laser", "evil", {}), name="<b>a\x00\u202eb</b>\n" * 9)
    assert "\n" not in machine.name and "\x00" not in machine.name and "\u202e" not in machine.name
    fabrication = replace(document.fabrication, machine="evil", own_machine=machine)
    path = project("my-laser")
    save(replace(document, fabrication=fabrication), path)
    assert stored_machine(load(path).fabrication) == machine
