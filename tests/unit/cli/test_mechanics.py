"""The command that closes sheets and drives networks: its figures, and one sentence for what it cannot do."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from command_line import answer, refusal

from kirigami_studio.cli import main
from kirigami_studio.evaluate.trimming import trim
from kirigami_studio.foundation.resources import resource
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.project.document import Document
from kirigami_studio.project.store import load, save

NETWORK = ("mechanics", "--network", resource("mechanics", "panel_network.npz"))
L2 = ("--ka", 882, "--ks", 220.5, "--kt", 3.78e-4)


@pytest.fixture
def sheet_file(tmp_path: Path) -> Path:
    ratio = 10.0 ** np.random.default_rng(1).uniform(-0.4, 0.4, (3, 3))
    path = tmp_path / "sheet.json"
    path.write_text(json.dumps({"ratio": ratio.tolist()}))
    return path


def test_that_a_sheet_is_closed_as_the_contract_says(sheet_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = (
        "mechanics",
        sheet_file,
        "--connector-mm",
        2,
        "--style",
        "straight",
        "--steps",
        9,
        "--end-deg",
        30,
        "--json",
    )
    cut = answer(capsys, *words)
    ideal = answer(capsys, *words, "--centres", "node")
    for found in (cut, ideal):
        assert (
            len(found["phi_deg"]) == len(found["energy_mj"]) == len(found["force_n"]) == len(found["max_strain"]) == 9
        )
        assert found["phi_deg"][0] == pytest.approx(180.0) and found["phi_deg"][-1] == pytest.approx(30.0)
        assert found["stable_deg"] == pytest.approx([180.0])
        assert found["strain_believed"] == "out_of_plane"
        assert found["max_strain_out_of_plane"][-1] < found["max_strain"][-1]
    # Finished widths differ by less than a micrometre, so connectors do not turn quite alike.
    assert max(ideal["max_stretch_widths"]) < 1e-3
    # Nothing jams as far as it was driven: beyond that there is only an estimate.
    assert (ideal["jam_deg"], ideal["jam_from"]) == (0.0, "estimate")
    assert cut["max_stretch_widths"][-1] > 0.01
    stiff = answer(capsys, *words, "--young-gpa", 5.0)
    assert stiff["energy_mj"][-1] == pytest.approx(2.0 * cut["energy_mj"][-1], rel=1e-6)


def test_that_bars_bend_more_easily(sheet_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--steps", 5, "--end-deg", 90, "--json", "--style")
    straight, bars = (answer(capsys, "mechanics", sheet_file, *words, style) for style in ("straight", "double"))
    assert bars["energy_mj"][-1] < 0.5 * straight["energy_mj"][-1]
    assert bars["max_strain"][-1] < straight["max_strain"][-1]


def test_that_a_trimmed_design_keeps_its_trim(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    project = resource("examples", "heart.kiri")
    document = load(project)
    chosen = document.candidate
    assert chosen is not None and document.target is not None
    cut = trim(deploy(chosen.final_sheet), document.target, chosen.final_phi, chosen.final_pose)
    saved = tmp_path / "trimmed.kiri"
    save(Document(document.target, candidates=(replace(chosen, trim=cut),), chosen=0), saved)
    ideal = ("--centres", "node", "--steps", 5, "--json")
    found, whole = (answer(capsys, "mechanics", path, *ideal) for path in (saved, project))
    assert found["iou_ideal"] == pytest.approx(cut.iou, abs=0.01)
    assert found["iou_ideal"] > whole["iou_ideal"]


def test_that_grips_are_held_and_moved(sheet_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--centres", "node", "--hold", 0, 3, "--move", 12, 15, "--steps", 9, "--end-deg", 120)
    found = answer(capsys, "mechanics", sheet_file, *words, "--json")
    assert found["displacement_unit"] == "mm"
    assert np.all(np.diff(found["displacement"]) > 0.0)
    slope = np.gradient(found["energy_mj"], found["displacement"], edge_order=2)
    assert found["force_n"][2:-2] == pytest.approx(slope[2:-2], rel=0.1)


def test_that_a_project_tells_its_overlap_as_cut(capsys: pytest.CaptureFixture[str]) -> None:
    project = resource("examples", "heart.kiri")
    found = answer(capsys, "mechanics", project, "--centres", "node", "--steps", 11, "--json")
    assert (found["jam_deg"], found["jam_from"]) == (0.0, "simulation") and "estimated_jam_deg" not in found
    assert found["iou_as_cut"] == pytest.approx(found["iou_ideal"], abs=0.003)
    centred, straight = (
        answer(capsys, "mechanics", project, "--style", style, "--steps", 16, "--json")
        for style in ("centred", "straight")
    )
    assert centred["jam_deg"] == 0.0 < straight["jam_deg"]
    assert centred["max_stretch_widths"][-2] < 0.05 < straight["max_stretch_widths"][-2]
    assert centred["iou_as_cut"] == pytest.approx(centred["iou_ideal"], abs=0.003)
    assert straight["iou_as_cut"] < straight["iou_ideal"] - 0.01
    assert main(["mechanics", str(project), "--steps", "11", "--width-mm", "60"]) == 0
    told = capsys.readouterr().out
    assert "Jams at" in told or "Closes" in told
    assert "not modelled" in told


def test_that_a_network_is_driven_along_the_published_path(capsys: pytest.CaptureFixture[str]) -> None:
    found = answer(capsys, *NETWORK, *L2, "--steps", 30, "--json")
    assert found["displacement_mm"][-1] == pytest.approx(9.256, abs=1e-3)
    force = np.interp([4.5, 8.5], found["displacement_mm"], found["force_n"])
    assert force == pytest.approx([2.18, 4.26], rel=0.02)
    assert found["stable_mm"] == pytest.approx([0.0])
    pulled = answer(capsys, *NETWORK, *L2, "--drive", "clamped:y:1.5", "--steps", 5, "--json")
    assert pulled["displacement_mm"] == pytest.approx(np.linspace(0.0, 1.5, 5))
    assert pulled["force_n"][-1] > 0.1
    assert main([str(word) for word in (*NETWORK, *L2, "--steps", 5)]) == 0
    assert "Rests by itself at (mm): 0.00." in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "code", "told"),
    [
        (("mechanics",), 2, "Name either a project or sheet, or a network"),
        (NETWORK, 2, "A network needs --ka"),
        ((*NETWORK, *L2, "--drive", "sideways"), 2, "no drive 'sideways'"),
        ((*NETWORK, *L2, "--drive", "clamped:z:1"), 2, "no drive 'clamped:z:1'"),
        ((*NETWORK, *L2, "--drive", "clamped:x:nan"), 2, "no drive 'clamped:x:nan'"),
        ((*NETWORK, *L2, "--steps", 1), 2, "at least 3 steps"),
        (("mechanics", "--network", "none.npz", *L2), 1, "There is no file none.npz"),
        (("mechanics", "none.json"), 1, "none.json"),
    ],
)
def test_that_wrong_use_is_told_in_one_sentence(
    words: tuple[object, ...], code: int, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    found, sentence = refusal(capsys, *words)
    assert found == code
    assert told in sentence


def test_that_options_of_sheets_are_checked(sheet_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for words, code, told in (
        (("--hold", 0), 2, "--hold and --move together"),
        (("--hold", 0, "--move", 400), 1, "There is no panel 400"),
        (("--material", "oak"), 1, "oak"),
        (("--end-deg", 180), 2, "below 180 degrees"),
    ):
        found, sentence = refusal(capsys, "mechanics", sheet_file, *words)
        assert found == code
        assert told in sentence


def test_that_card_which_would_close_is_said_to_break(sheet_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ("mechanics", sheet_file, "--material", "card-co2", "--connector-mm", 0.5, "--steps", 9)
    found = answer(capsys, *words, "--json")
    assert found["breaks"] and 90.0 < found["breaks_deg"] < 180.0
    assert (found["strain_limit"], found["strain_believed"]) == (0.03, "in_plane")
    assert max(found["max_strain"]) > 0.5
    assert main([str(word) for word in words]) == 0
    told = capsys.readouterr().out
    assert "breaks at 3 %" in told and "Closes" not in told
    film = answer(capsys, "mechanics", sheet_file, "--steps", 5, "--json")
    assert (film["breaks"], film["breaks_deg"]) == (False, None)


def test_that_energy_torque_and_force_are_named_by_their_units_in_all_figures(
    sheet_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = answer(capsys, "mechanics", sheet_file, "--steps", 5, "--json")
    for figure in (found, found["in_plane_yielding"], found["out_of_plane"]):
        for torque, force in zip(figure["torque_nmm"], figure["force_n"], strict=True):
            assert torque == pytest.approx(force * found["lever_mm"], rel=1e-9, abs=1e-9)
    assert found["out_of_plane"]["energy_mj"][-1] < found["in_plane_yielding"]["energy_mj"][-1] < found["energy_mj"][-1]
    gripped = answer(
        capsys, "mechanics", sheet_file, "--hold", 0, "--move", 15, "--steps", 5, "--end-deg", 120, "--json"
    )
    assert "torque_nmm" not in gripped and gripped["lever_mm"] is None
    assert set(gripped["out_of_plane"]) == {"energy_mj", "force_n"}
