"""A project brings what it was made with: its own material and the photo behind its target."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from kirigami_studio.fabricate.machine import SHELF as MACHINES
from kirigami_studio.fabricate.machine import changed_machine, machines
from kirigami_studio.fabricate.material import SHELF, library
from kirigami_studio.fabricate.material_copies import changed_copy
from kirigami_studio.gui.session.messages import Message
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.services import Services
from kirigami_studio.outlines.read_image import automatic_threshold, read_image
from kirigami_studio.project import edits, picture_record, recovery, store
from kirigami_studio.project.document import Document

Until = Callable[[Callable[[], bool]], None]


def rewritten(path: Path, change: Callable[[dict[str, bytes]], None]) -> Path:
    """A project file with other members."""
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    change(members)
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return path


def told(window: MainWindow, words: str) -> list[Message]:
    return [one for one in window.messages.messages if words in one.sentence]


# own materials ---------------------------------------------------------------------------------------------------


@pytest.fixture
def own_project(designs: Document, own_materials: Path, tmp_path: Path) -> Path:
    """A project cut from an own material that nobody has in stock any more."""
    SHELF.save(changed_copy("film-uv", "my-film", {"connector_mm": 0.41, "kerf_mm": 0.07, "name": "My film"}))
    document = edits.set_fabrication(designs, material="my-film").document
    path = tmp_path / "own.kiri"
    store.save(document, path)
    assert store.load(path) == document
    SHELF.delete("my-film")
    assert "my-film" not in library().items
    return path


def test_that_a_deleted_own_material_is_still_cut_and_can_be_taken_over(
    window: MainWindow, own_project: Path, tmp_path: Path, until: Until
) -> None:
    window.services.project.open(own_project)
    until(lambda: window.fabrication.export.isEnabled())
    fabrication = window.fabrication
    assert fabrication.material.currentText() == "My film"
    assert fabrication.lengths["connector_mm"].value() == 0.41 and fabrication.lengths["kerf_mm"].value() == 0.07
    assert fabrication.numbers["ligament"].text() == "0.41 mm"
    (message,) = told(window, "You don't have the material")
    assert "My film" in message.sentence
    # Saving keeps the numbers although they are not in stock.
    window.services.project.save(tmp_path / "again.kiri")
    until(lambda: (tmp_path / "again.kiri").exists())
    carried = store.load(tmp_path / "again.kiri").fabrication.own
    assert carried is not None and (carried.key, carried.kerf_mm) == ("my-film", 0.07)
    dict(message.actions)["Add to my materials"]()
    assert library().items["my-film"] == carried
    assert fabrication.material.findData("my-film") >= 0 and fabrication.material.currentText() == "My film"


def test_that_the_own_stock_wins_over_what_a_project_knew(window: MainWindow, own_project: Path, until: Until) -> None:
    SHELF.save(changed_copy("film-uv", "my-film", {"connector_mm": 0.55, "kerf_mm": 0.07, "name": "My film"}))
    window.services.project.open(own_project)
    until(lambda: window.fabrication.export.isEnabled())
    assert window.fabrication.numbers["ligament"].text() == "0.55 mm"
    (message,) = told(window, "differs from the project's")
    assert message.details == "connector_mm: 0.41 in the project, 0.55 in yours"


def test_that_a_preset_is_not_carried(designs: Document, tmp_path: Path) -> None:
    store.save(designs, tmp_path / "preset.kiri")
    with zipfile.ZipFile(tmp_path / "preset.kiri") as archive:
        assert json.loads(archive.read("design.json"))["fabrication"]["own"] is None


@pytest.mark.parametrize(("entry", "value"), [("kerf_mm", -1.0), ("kerf_mm", "wide"), ("passes", 0), ("name", None)])
def test_that_an_impossible_material_in_a_project_is_refused(entry: str, value: object, own_project: Path) -> None:
    def spoil(members: dict[str, bytes]) -> None:
        design = json.loads(members["design.json"])
        design["fabrication"]["own"][entry] = value
        members["design.json"] = json.dumps(design).encode()

    with pytest.raises(store.ProjectError, match="Cannot open"):
        store.load(rewritten(own_project, spoil))


# own machines ----------------------------------------------------------------------------------------------------


def test_that_a_machine_that_nobody_has_is_shown_used_and_can_be_taken_over(
    window: MainWindow, designs: Document, tmp_path: Path, until: Until
) -> None:
    MACHINES.save(changed_machine("cricut-maker", "my-cutter", {"bed_width_mm": "77", "name": "My cutter"}))
    changes = {"machine": "my-cutter", "material": "drag-knife", "profile": "cricut"}
    document = edits.set_fabrication(designs, **changes).document  # type: ignore[arg-type]
    store.save(document, tmp_path / "own.kiri")
    mine = machines().items["my-cutter"]
    MACHINES.delete("my-cutter")
    window.services.project.open(tmp_path / "own.kiri")
    until(lambda: window.fabrication.export.isEnabled())
    chooser = window.fabrication.chooser
    assert (chooser.machine.currentText(), chooser.material.currentData()) == ("My cutter", "drag-knife")
    assert "77" in chooser.machine.toolTip() and chooser.wanted_file == ".svg"
    (message,) = told(window, "You don't have the machine")
    dict(message.actions)["Add to my machines"]()
    assert machines().items["my-cutter"] == mine
    assert chooser.machine.currentText() == "My cutter"
    MACHINES.save(replace(mine, bed_width_mm=78.0))
    window.services.project.open(tmp_path / "own.kiri")
    until(lambda: bool(told(window, "differs from the project's")))
    assert told(window, "differs from the project's")[0].details == "bed_width_mm: 77 in the project, 78 in yours"


# the photo -------------------------------------------------------------------------------------------------------


@pytest.fixture
def traced_project(photo: Path, tmp_path: Path, until: Until) -> Path:
    """A project that another session saved: traced at another threshold than the automatic one."""
    services, path = Services(), tmp_path / "traced.kiri"
    services.targeting.open(str(photo))
    until(lambda: services.session.document.target is not None)
    services.targeting.change_threshold(0.8)
    until(lambda: services.session.document.target == read_image(photo, 0.8))
    until(lambda: not services.session.queue.busy)
    services.project.save(path)
    until(lambda: not services.session.history.unsaved)
    services.close()
    return path


def test_that_photo_and_threshold_come_back_although_the_file_is_gone(
    window: MainWindow, traced_project: Path, photo: Path, until: Until
) -> None:
    at_half, automatic = read_image(photo, 0.5), automatic_threshold(photo)
    photo.unlink()
    services = window.services
    services.project.open(traced_project)
    until(lambda: window.target.threshold.isVisible())
    assert window.target.threshold.slider.value() == 160 and window.target.view.underlay is not None
    assert not services.session.history.unsaved
    services.targeting.change_threshold(0.5)
    until(lambda: services.session.document.target == at_half)
    assert at_half.name == "two greys" and services.session.history.undo_label == "Change threshold"
    until(lambda: not services.session.queue.busy)
    services.targeting.change_threshold(None)
    until(lambda: not services.session.queue.busy)
    assert window.target.threshold.slider.value() == round(200 * automatic)
    services.session.history.end_drag()
    services.project.undo()
    assert window.target.threshold.slider.value() == 160


def test_that_a_recovered_project_brings_its_photo(
    window: MainWindow, traced_project: Path, tmp_path: Path, until: Until
) -> None:
    opened = store.load_all(traced_project)
    note = recovery.RecoveryNote("traced.kiri", str(traced_project), recovery.now())
    recovery.keep(opened.document, note, tmp_path / "state" / "left.kiri", opened.picture)
    window.services.project.recovery.use(tmp_path / "state")
    until(lambda: bool(told(window, "Recover traced.kiri")))
    dict(told(window, "Recover traced.kiri")[0].actions)["Recover"]()
    until(lambda: window.target.threshold.isVisible())
    assert window.target.threshold.slider.value() == 160
    until(lambda: not (tmp_path / "state" / "left.kiri").exists())
    own = window.services.project.recovery.file
    assert own is not None and store.load_all(own).picture == opened.picture


@pytest.mark.parametrize("fault", ["missing", "Nothing to paste", "no name", "too large", "no number"])
def test_that_a_photo_that_cannot_be_read_is_left_out_with_a_sentence(
    fault: str, window: MainWindow, traced_project: Path, until: Until
) -> None:
    def spoil(members: dict[str, bytes]) -> None:
        if fault == "missing":
            del members["picture.png"]
        elif fault == "Nothing to paste":
            members["picture.json"] = members["picture.json"].replace(b"two greys.png", b"../../evil.png")
        elif fault == "no name":
            members["picture.json"] = members["picture.json"].replace(b"two greys.png", rb"two\u0000greys.png")
        elif fault == "too large":
            members["picture.png"] += bytes(picture_record.LARGEST_PICTURE)
        else:
            members["picture.json"] = members["picture.json"].replace(b"0.8", b"7.5")

    window.services.project.open(rewritten(traced_project, spoil))
    until(lambda: bool(told(window, "left out")) and window.session.document.target is not None)
    assert not window.target.threshold.isVisible()
    assert len(told(window, "The picture in this project cannot be read and was left out")) == 1


def test_that_a_photo_that_is_gone_at_saving_is_told_and_the_project_is_saved(
    window: MainWindow, photo: Path, tmp_path: Path, until: Until
) -> None:
    window.services.targeting.open(str(photo))
    until(lambda: window.session.document.target is not None)
    photo.unlink()
    window.services.project.save(tmp_path / "without.kiri")
    until(lambda: not window.session.history.unsaved)
    assert "two greys.png" in told(window, "was not saved with the project")[0].sentence
    opened = store.load_all(tmp_path / "without.kiri")
    assert opened.document == window.session.document and opened.picture is None and opened.notes == ()


def test_that_a_photo_larger_than_a_project_keeps_is_told(
    window: MainWindow, photo: Path, tmp_path: Path, until: Until
) -> None:
    with photo.open("ab") as stream:  # readers ignore what follows the end of a PNG
        stream.write(bytes(picture_record.LARGEST_PICTURE))
    window.services.targeting.open(str(photo))
    until(lambda: window.session.document.target is not None)
    window.services.project.save(tmp_path / "small.kiri")
    until(lambda: not window.session.history.unsaved)
    assert "the limit is 16" in told(window, "was not saved with the project")[0].sentence
    assert (tmp_path / "small.kiri").stat().st_size < 100_000


def test_that_equal_projects_give_equal_bytes_with_their_photo(traced_project: Path) -> None:
    opened = store.load_all(traced_project)
    assert opened.picture is not None
    assert store.pack(opened.document, opened.picture) == traced_project.read_bytes()
    with pytest.raises(store.ProjectError):
        replace(opened.picture, name="page.txt")
