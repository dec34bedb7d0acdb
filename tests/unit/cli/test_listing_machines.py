"""``machines``, and ``--machine`` of other commands."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from kirigami_studio.cli import main
from kirigami_studio.fabricate.machine import find_machine, machines
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.foundation.resources import resource

HEART = str(resource("examples", "heart.kiri"))


def answer(capsys: pytest.CaptureFixture[str], *words: str) -> Any:
    assert main([*words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_that_machines_are_listed_with_what_they_reach_and_cut(capsys: pytest.CaptureFixture[str]) -> None:
    found = answer(capsys, "machines")["machines"]
    assert list(found) == list(machines().items)
    maker = found["cricut-maker"]
    assert (maker["reach_mm"], maker["profile"], maker["file"], maker["own"]) == (
        [292.0, 596.0],
        "cricut",
        ".svg",
        False,
    )
    assert "card-co2" in maker["materials"] and "acrylic-co2" not in maker["materials"]
    assert main(["machines"]) == 0
    assert "292 x 596 mm" in capsys.readouterr().out


def test_that_a_machine_is_copied_changed_and_deleted(capsys: pytest.CaptureFixture[str], own_machines: Path) -> None:
    changes = ("--set", "bed_width_mm=900", "--set", "name=Mine")
    assert answer(capsys, "machines", "--copy", "co2-laser", "--as", "mine", *changes) == {"saved": "mine"}
    assert find_machine("mine").reach_mm == (900.0, 400.0) and (own_machines / "mine.toml").exists()
    assert answer(capsys, "machines", "--delete", "mine") == {"deleted": "mine"}
    assert machines().own == frozenset()


@pytest.mark.parametrize(
    ("words", "status"),
    [
        (("--copy", "co2-laser", "--delete", "k40"), 2),
        (("--as", "mine"), 2),
        (("--set", "bed_width_mm=1"), 2),
        (("--copy", "co2-laser", "--set", "bed_width_mm"), 2),
        (("--copy", "lathe"), 1),
        (("--copy", "co2-laser", "--as", "mine", "--set", "kerf_mm=1"), 1),
        (("--delete", "k40"), 1),
    ],
)
def test_that_impossible_wishes_are_refused_in_a_sentence(
    words: tuple[str, ...], status: int, capsys: pytest.CaptureFixture[str], own_machines: Path
) -> None:
    assert main(["machines", *words]) == status
    said = capsys.readouterr()
    assert said.out == "" and said.err.strip() and "Traceback" not in said.err
    assert list(own_machines.iterdir()) == []


def test_that_materials_of_a_machine_are_those_that_it_cuts(capsys: pytest.CaptureFixture[str]) -> None:
    assert answer(capsys, "materials", "--machine", "diode-10w")["materials"] == [
        "plywood-co2", "card-co2", "card-05-co2", "leather-co2", "felt-co2",
    ]  # fmt: skip
    assert "film-uv" in answer(capsys, "materials")["materials"]


def test_that_a_material_is_copied_with_its_figures_on_a_machine(capsys: pytest.CaptureFixture[str]) -> None:
    answer(capsys, "materials", "--copy", "plywood-co2", "--as", "my-ply", "--machine", "diode-10w")
    made = find_material("my-ply")
    assert (made.machine, made.passes, made.speed_mm_s) == ("diode laser", 5, 4.2)
    assert made.young_gpa == find_material("plywood-co2").young_gpa


def test_that_export_takes_the_machines_profile_bed_and_speeds(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    words = ("export", HEART, "--material", "card-co2", "--connector-mm", "0.5")
    plain = answer(capsys, *words, "--out", str(tmp_path / "plain.svg"))
    slow = answer(capsys, *words, "--machine", "cricut-maker", "--out", str(tmp_path / "cricut.svg"))
    assert slow["seconds_estimate"] > plain["seconds_estimate"]
    text = (tmp_path / "cricut.svg").read_text(encoding="utf-8")
    assert 'transform="scale(2.8346' in text and 'transform="scale' not in (tmp_path / "plain.svg").read_text()
    assert (tmp_path / "cricut.svg").exists() and slow["size_mm"] == plain["size_mm"]


@pytest.mark.torch
@pytest.mark.parametrize(("machine", "more"), [("cricut-maker", "cut.svg"), ("hand", "cut.pdf"), ("uv-laser", "")])
def test_that_a_design_comes_with_the_file_that_its_machine_takes(
    machine: str, more: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    words = ("design", "square", "--grid", "4x4", "--k", "1", "--no-polish", "--machine", machine)
    found = answer(capsys, *words, "--out", str(tmp_path / "here"))
    roles = ["project", "cut", "layout", "preview", "candidates", *(["machine_cut"] if more else [])]
    assert sorted(found["files"]) == sorted(roles)
    assert all(Path(path).exists() for path in found["files"].values()), "a folder for a file for each layer"
    if more:
        path = Path(found["files"]["machine_cut"])
        assert path.name == more and f"profile {find_machine(machine).profile}" in _made_with(path, capsys)


def _made_with(path: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """Line of ``check`` on how a file was made; PDFs are not read."""
    if path.suffix == ".pdf":
        return f"profile {find_machine('hand').profile}" if path.read_bytes().startswith(b"%PDF-") else ""
    assert main(["check", str(path)]) == 0
    return next(line for line in capsys.readouterr().out.splitlines() if "made with:" in line)


@pytest.mark.torch
def test_that_a_worker_sends_all_files_of_a_design() -> None:
    from kirigami_studio.cli.design import Asked, DesignJob, designed_there
    from kirigami_studio.outlines.silhouettes import load
    from kirigami_studio.settings.design import chosen_settings
    from kirigami_studio.settings.fabrication import new_settings
    from kirigami_studio.studio.designing import request_for

    cut = new_settings({"machine": "uv-laser"})
    settings = chosen_settings((4, 4), {"k": 1, "polish": 0})
    job = DesignJob(request_for(load("square"), settings, cut, least_panel_mm=0.0), cut, 0.0, True)
    found = designed_there(Asked("square", job, None)).get()
    assert found.files["cut"] == "cut" and "cut/3_OUTLINE.dxf" in found.contents


def test_that_an_unknown_machine_is_refused_before_any_work(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["design", "heart", "--machine", "lathe", "--out", str(tmp_path / "out")]) == 1
    assert "glowforge" in capsys.readouterr().err and not (tmp_path / "out").exists()
