"""The command-line contract, through the real entry point."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from command_line import answer, refusal
from PIL import Image
from uneven_sheets import uneven_sheet

from kirigami_studio.cli import library, main
from kirigami_studio.cli.parser import SubCommand, all_commands, command_function
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.sheet_files import sheet_json
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.project.document import Document
from kirigami_studio.project.store import save

FIELD = np.array([[1.0, 2.0, 0.5], [0.8, 1.5, 1.0]])


@pytest.fixture
def ratios(tmp_path: Path) -> Path:
    path = tmp_path / "ratios.json"
    path.write_text(json.dumps({"ratio": FIELD.tolist()}))
    return path


@pytest.mark.parametrize("command", all_commands(), ids=lambda command: command.name)
def test_that_every_sub_command_finds_its_function(command: SubCommand) -> None:
    assert callable(command_function(command.run))


def test_that_decode_answers_with_the_exact_layout(capsys: pytest.CaptureFixture[str], ratios: Path) -> None:
    layout = answer(capsys, "decode", ratios, "--phi", "pi/2", "--json")
    deployment = deploy(RatioField(FIELD))
    assert np.allclose(layout["void_corners"], deployment.voids(math.pi / 2))
    assert np.array(layout["panels"]).shape == (12, 4, 2)
    assert layout["area"] == pytest.approx(deployment.area(math.pi / 2))
    assert layout["n_invalid"] == 0
    assert layout["contact"] is None


def test_that_porosity_tells_areas_at_every_angle_and_finds_one(
    capsys: pytest.CaptureFixture[str], ratios: Path, tmp_path: Path
) -> None:
    table = answer(
        capsys, "porosity", ratios, "--angles", "5", "--find", "0.2", "--out", tmp_path / "areas.csv", "--json"
    )
    deployment = deploy(RatioField(FIELD))
    assert table["phi_deg"] == [180.0, 135.0, 90.0, 45.0, 0.0]
    assert table["area"] == pytest.approx([deployment.area(math.radians(phi)) for phi in table["phi_deg"]])
    assert table["porosity"][2] == table["largest_porosity"]
    for phi in table["found"]["phi_deg"]:
        area = deployment.area(math.radians(phi))
        assert (area - table["panel_area"]) / area == pytest.approx(0.2)
    heads, *rows = (tmp_path / "areas.csv").read_text().splitlines()
    assert heads == "phi (deg),area (unit cells^2),void area (unit cells^2),porosity"
    assert [float(row.split(",")[1]) for row in rows] == pytest.approx(table["area"])
    in_mm = answer(capsys, "porosity", ratios, "--angles", "5", "--width-mm", "40", "--json")
    assert in_mm["panel_area"] == pytest.approx(table["panel_area"] * 100.0)  # four cells across: 10 mm each
    code, sentence = refusal(capsys, "porosity", ratios, "--find", "0.9", "--json")
    assert code == 1 and "90 degrees" in sentence


def test_that_the_compact_sheet_starts_at_the_origin(capsys: pytest.CaptureFixture[str], ratios: Path) -> None:
    corners = np.array(answer(capsys, "decode", ratios, "--phi", "pi", "--json")["outline"])
    assert np.allclose(corners.min(axis=0), (0, -3))
    assert np.allclose(corners.max(axis=0), (4, 0))


def test_that_decode_tells_the_flat_panels_in_the_order_of_the_open_ones(
    capsys: pytest.CaptureFixture[str], ratios: Path
) -> None:
    layout = answer(capsys, "decode", ratios, "--phi", "1", "--json")
    deployment = deploy(RatioField(FIELD))
    assert np.allclose(layout["panels_flat"], deployment.panels(math.pi).reshape(-1, 4, 2))
    assert np.allclose(layout["panels"], deployment.panels(1.0).reshape(-1, 4, 2))


def test_that_decode_and_score_take_sheets_and_the_chosen_design_of_a_project(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    sheet, heart = uneven_sheet(3, 4, seed=5), load("heart")
    (tmp_path / "sheet.json").write_text(json.dumps(sheet_json(sheet)))
    score = evaluate(deploy(sheet), heart)
    candidates = (Candidate(Sheet(sheet.field), score, 0, 0), Candidate(sheet, score, 0, 1))
    save(Document(heart, candidates=candidates, chosen=1), tmp_path / "design.kiri")
    save(Document(heart, candidates=candidates), tmp_path / "none.kiri")
    for name in ("sheet.json", "design.kiri"):
        layout = answer(capsys, "decode", tmp_path / name, "--phi", "0.5", "--json")
        assert np.allclose(layout["outline"], deploy(sheet).outline(0.5))
        assert answer(capsys, "score", tmp_path / name, "heart", "--json")["siou"] == score.siou
    assert main(["decode", str(tmp_path / "none.kiri")]) == 1
    assert "No design is chosen in" in capsys.readouterr().err


def test_that_score_answers_with_all_promised_keys(capsys: pytest.CaptureFixture[str], ratios: Path) -> None:
    score = answer(capsys, "score", ratios, "heart", "--json")
    promised = {"siou", "siou_gain", "iou_exact", "tv", "feasible", "n_invalid", "overlap_ratio", "transform"}
    assert promised <= score.keys()
    assert 0 < score["siou"] <= 1


def test_that_batches_answer_one_object_a_line(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    np.savez(tmp_path / "fields.npz", ratios=np.stack([FIELD, 1 / FIELD]))
    assert main(["score", str(tmp_path / "fields.npz"), "circle"]) == 0
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [line["source"] for line in lines] == ["fields.npz[0]", "fields.npz[1]"]


def test_that_siou_of_a_turned_mask_is_nearly_one(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    mask = np.zeros((128, 128), dtype=np.uint8)
    mask[20:100, 30:60] = 255
    mask[80:100, 30:90] = 255
    Image.fromarray(mask).save(tmp_path / "a.png")
    Image.fromarray(np.rot90(mask)).save(tmp_path / "b.png")
    assert answer(capsys, "siou", tmp_path / "a.png", tmp_path / "b.png", "--json")["siou"] > 0.98
    Image.fromarray(np.tile(np.uint8(255), (16, 64))).save(tmp_path / "c.png")
    whole, cropped = (
        answer(capsys, "siou", tmp_path / "a.png", tmp_path / "c.png", "--json", *extra)["siou"]
        for extra in ((), ("--crop",))
    )
    assert cropped > whole


@pytest.mark.torch
def test_that_a_design_becomes_checked_files_with_the_same_bytes(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    folders = [tmp_path / name for name in ("first", "second")]
    answers = [
        answer(capsys, "design", "star", "--grid", "5x5", "--k", 3, "--out", folder, "--json") for folder in folders
    ]
    assert len(answers[0]["candidates"]) == 3
    assert answers[0]["best"] == answers[0]["candidates"][0]
    assert all(candidate["polished"] for candidate in answers[0]["candidates"])
    # Four steps of the generator and the score for each, and then the fits.
    assert answers[0]["forward_evaluations"] > 3 * (4 + 1)
    for name in ("design.kiri", "cut.dxf", "layout.svg", "preview.png", "candidates.json"):
        first, second = ((folder / name).read_bytes() for folder in folders)
        assert first == second, name
    assert answer(capsys, "check", folders[0] / "cut.dxf", "--json")["ok"]
    assert ezdxf.readfile(folders[0] / "cut.dxf").header["$INSUNITS"] == 4


@pytest.mark.torch
def test_that_a_saved_project_is_exported_to_every_kind_of_file(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    answer(capsys, "design", "heart", "--k", 1, "--grid", "4x5", "--out", tmp_path, "--json")
    project = tmp_path / "design.kiri"
    for suffix in ("dxf", "svg", "pdf", "png", "gif"):
        report = answer(
            capsys,
            "export",
            project,
            "--out",
            tmp_path / f"x.{suffix}",
            "--width-mm",
            80,
            "--connector-mm",
            0.8,
            "--json",
        )
        assert Path(report["files"][0]).stat().st_size > 500
        assert report["pieces"] == 1
        assert report["min_connector_mm"] == pytest.approx(0.8, abs=1e-3)
    document = ezdxf.readfile(tmp_path / "x.dxf")
    assert document.header["$EXTMAX"][0] == pytest.approx(80, abs=1.0)
    assert answer(capsys, "animate", project, "--out", tmp_path / "y.gif", "--json")["frames"] > 10
    as_cut = answer(
        capsys, "animate", project, "--out", tmp_path / "z.gif", "--as-cut", "--style", "straight",
        "--connector-mm", 1.5, "--json",
    )  # fmt: skip
    assert as_cut["frames"] > 10 and as_cut["reached_deg"] == as_cut["jam_deg"] > 5.0
    assert (tmp_path / "z.gif").read_bytes() != (tmp_path / "y.gif").read_bytes()


@pytest.mark.torch
def test_that_the_file_of_a_sheet_that_would_fall_apart_is_told_not_to_work(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    answer(capsys, "design", "heart", "--k", 1, "--grid", "4x4", "--out", tmp_path, "--json")
    words = ["export", tmp_path / "design.kiri", "--out", tmp_path / "x.dxf", "--connector-mm", 1e-9, "--json"]
    assert main([str(word) for word in words]) == 1
    found = json.loads(capsys.readouterr().out)
    assert not found["ok"] and found["pieces"] == 17 and found["verdict"]["level"] == "will_not_work"
    assert found["verdict"]["answers"]["files"]["state"] == "bad" and (tmp_path / "x.dxf").exists()


@pytest.mark.torch
def test_that_unpolished_candidates_cost_a_layout_for_every_step_and_one_for_the_score(
    capsys: pytest.CaptureFixture[str],
) -> None:
    answered = answer(capsys, "design", "heart", "--k", 2, "--no-polish", "--steps", 3, "--json")
    assert answered["forward_evaluations"] == 2 * (3 + 1)
    assert not any(candidate["polished"] for candidate in answered["candidates"])
    promised = {"ratio", "siou", "siou_gain", "tv", "feasible", "n_invalid", "overlap_ratio", "seed", "polished"}
    assert promised <= answered["best"].keys()


@pytest.mark.torch
def test_that_a_budget_is_kept_and_told(capsys: pytest.CaptureFixture[str]) -> None:
    answered = answer(capsys, "design", "heart", "--k", 4, "--grid", "4x4", "--budget", 0.001, "--json")
    assert answered["budget_ended"] is True
    assert len(answered["candidates"]) == 4
    assert "budget_ended" not in answer(capsys, "design", "heart", "--k", 1, "--grid", "4x4", "--json")


@pytest.mark.torch
def test_that_a_search_adds_a_candidate_to_the_samples(capsys: pytest.CaptureFixture[str]) -> None:
    answered = answer(capsys, "design", "heart", "--k", 1, "--grid", "4x4", "--search", "--json")
    assert sorted(candidate["index"] for candidate in answered["candidates"]) == [0, 1]


@pytest.mark.torch
def test_that_many_targets_are_designed_in_order(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["design", "circle", "drop", "--k", "1", "--grid", "4x4"]) == 0
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [line["source"] for line in lines] == ["circle", "drop"]
    assert all(line["files"] == {} for line in lines)


@pytest.mark.parametrize(
    ("code", "argv"),
    [
        (1, ["design", "unicorn", "--k", "1"]),
        (1, ["design", "missing.png", "--k", "1"]),
        (2, ["design", "heart", "--k", "0"]),
        (2, ["design", "heart", "--k", "1", "--search", "9"]),
        (2, ["design", "heart", "--grid", "1x1"]),
        (2, ["design", "heart", "--grid", "ten"]),
        (2, ["design", "heart", "--phi", "pi"]),
        (2, ["design", "heart", "--variant", "psychic", "--k", "1"]),
        (1, ["design", "heart", "--material", "adamantium"]),
        (1, ["decode", "missing.json"]),
        (1, ["score", "missing.json", "heart"]),
        (2, ["score", "heart"]),
        (1, ["export", "missing.kiri", "--out", "x.dxf"]),
        (1, ["export", "missing.kiri", "--out", "x.doc"]),
        (1, ["check", "missing.dxf"]),
        (2, ["animate", "missing.kiri", "--out", "x.mp4"]),
        (2, ["train", "prior", "--out", "nowhere", "--minutes", "0"]),
    ],
)
def test_that_bad_requests_end_in_one_sentence(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, code: int, argv: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert refusal(capsys, *argv)[0] == code
    assert list(tmp_path.iterdir()) == []


def test_that_an_unwritable_folder_is_refused_in_one_sentence(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, ratios: Path
) -> None:
    (tmp_path / "file").write_text("in the way")
    code = main(["decode", str(ratios), "--json", "--out", str(tmp_path / "file" / "layout.json")])
    assert code == 1
    assert "Cannot write" in capsys.readouterr().err


@pytest.mark.parametrize("argv", [["--nonsense"], ["design"], ["design", "heart", "--k", "many"], ["decode"]])
def test_that_wrong_usage_exits_with_two(argv: list[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(argv)
    assert stopped.value.code == 2


@pytest.mark.parametrize("listing", ["targets", "variants"])
def test_that_listings_are_json_and_lines(capsys: pytest.CaptureFixture[str], listing: str) -> None:
    names = answer(capsys, listing, "--json")[listing]
    assert main([listing]) == 0
    assert capsys.readouterr().out.split() == names
    assert names


@pytest.mark.parametrize("command", sorted({command.name.split()[0] for command in all_commands()}))
def test_that_every_command_shows_examples(capsys: pytest.CaptureFixture[str], command: str) -> None:
    with pytest.raises(SystemExit) as stopped:
        main([command, "--help"])
    assert stopped.value.code == 0
    assert f"kirigami-studio {command}" in capsys.readouterr().out.split("examples:")[1]


def test_that_the_program_runs_as_a_module() -> None:
    words = [sys.executable, "-m", "kirigami_studio", "design", "--help"]
    shown = subprocess.run(words, capture_output=True, text=True, check=True).stdout
    assert "kirigami-studio design" in shown.split("examples:")[1]


def test_that_datasets_are_written_and_verified(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    answered = answer(capsys, "dataset", "structured", "--out", tmp_path, "--split", "test", "--count", 4, "--json")
    with np.load(answered["files"]["test"]) as archive:
        assert archive["masks"].shape == (4, 128, 128)
        stored = json.loads(str(archive["about"]))
    about = answered["splits"]["test"]
    assert about["designs"] == 4
    assert about["rendered_again_iou"] >= 0.999
    assert len(about["sha256"]) == 64
    assert about["sha256"] == stored["sha256"]


def test_that_one_field_is_scored_on_each_of_many_targets(
    capsys: pytest.CaptureFixture[str], ratios: Path, tmp_path: Path
) -> None:
    masks = np.zeros((2, 64, 64), dtype=bool)
    masks[:, 10:50, 10:50] = True
    np.savez(tmp_path / "masks.npz", masks=masks)
    assert main(["score", str(ratios), str(tmp_path / "masks.npz")]) == 0
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [line["target"] for line in lines] == ["masks.npz[0]", "masks.npz[1]"]
    assert lines[0]["siou"] == lines[1]["siou"]


@pytest.mark.parametrize(
    "words",
    [
        ("dataset", "sobol", "--count", "0"), ("dataset", "sobol", "--count", "-1"),
        ("dataset", "sobol", "--seed", "-1"), ("train", "prior", "--batch", "0"), ("train", "prior", "--steps", "0"),
        ("train", "prior", "--validate-every", "0"), ("train", "prior", "--threads", "0"),
        ("train", "prior", "--seed", "-1"), ("train", "prior", "--minutes", "nan"),
        ("train", "prior", "--outline-weight", "nan"), ("benchmark", "generator", "--count", "0"),
        ("benchmark", "generator", "--k", "0"), ("benchmark", "generator", "--seeds", "-1"),
        ("benchmark", "generator", "--data-seed", "-1"),
    ],
)  # fmt: skip
def test_that_impossible_numbers_of_the_learning_commands_are_wrong_usage(
    words: tuple[str, ...], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    with pytest.raises(SystemExit) as exit_:
        main([*words, "--out", str(tmp_path / "new")])
    assert exit_.value.code == 2
    assert words[-2] in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
@pytest.mark.parametrize("words", [("targets",), ("targets", "--json")])
def test_that_a_full_disk_behind_standard_output_is_one_sentence(words: tuple[str, ...]) -> None:
    assert Path("/dev/full").is_char_device(), "something has put a file in the place of this machine's device"
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "kirigami_studio", *words],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert done.returncode == 1
    assert len(done.stderr.splitlines()) == 1 and "No space left" in done.stderr


def test_that_a_run_folder_that_cannot_be_made_is_one_sentence(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("in the way")
    code, sentence = refusal(
        capsys, "train", "prior", "--steps", 1, "--device", "cpu", "--out", tmp_path / "file" / "x"
    )
    assert code == 1 and "file" in sentence


@pytest.mark.torch
def test_that_one_bad_entry_of_a_batch_is_reported_in_its_place(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    masks = np.zeros((3, 32, 32), dtype=bool)
    masks[0, 4:28, 4:28] = masks[2, 4:28, 10:20] = True
    np.savez(tmp_path / "masks.npz", masks=masks)
    assert main(["design", str(tmp_path / "masks.npz"), "--k", "1", "--no-polish"]) == 1
    printed = capsys.readouterr()
    lines = [json.loads(line) for line in printed.out.splitlines()]
    assert [line["source"] for line in lines] == ["masks.npz[0]", "masks.npz[1]", "masks.npz[2]"]
    assert ["error" in line for line in lines] == [False, True, False]
    assert "1 of 3 inputs failed" in printed.err


def test_that_bad_fields_of_a_batch_leave_the_others_their_answer(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    np.savez(tmp_path / "fields.npz", ratios=np.stack([FIELD, -FIELD, 1 / FIELD]))
    for command in (["decode", str(tmp_path / "fields.npz")], ["score", str(tmp_path / "fields.npz"), "circle"]):
        assert main(command) == 1
        lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
        assert ["error" in line for line in lines] == [False, True, False]


def test_that_a_wrong_request_stops_a_batch_at_once(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["design", "heart", "star", "--k", "0"]) == 2
    assert capsys.readouterr().out == ""


def test_that_a_folder_that_cannot_be_written_is_refused_before_any_work(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "taken").write_text("a file")
    monkeypatch.setattr("kirigami_studio.pipeline.run.run", lambda *_: pytest.fail("the run was started"))
    for out in (tmp_path / "taken", tmp_path / "taken" / "deeper"):
        code, sentence = refusal(capsys, "design", "heart", "--k", "1", "--out", out)
        assert code == 1
        assert "taken" in sentence


def test_that_a_file_without_a_command_is_one_to_open_in_the_window(tmp_path: Path) -> None:
    target = tmp_path / "leaf.svg"
    target.write_text("<svg/>", encoding="utf-8")
    hidden = {"DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"}
    env = {name: value for name, value in os.environ.items() if name not in hidden}
    for words, said in (([str(target)], "No display available"), ([f"{target}x"], "invalid choice")):
        command = [sys.executable, "-m", "kirigami_studio", *words]
        done = subprocess.run(command, env=env, capture_output=True, text=True, timeout=60, check=False)
        assert said in done.stderr and done.returncode == (1 if "display" in said else 2)


@pytest.mark.parametrize("names", [["no-such.svg"], ["no-such.svg", "nor-this.svg"]])
@pytest.mark.parametrize("command", ["design", "decode"])
def test_that_every_input_that_fails_has_a_line_of_json_where_json_is_asked_for(
    names: list[str], command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([command, *names, "--json"]) == 1
    said = capsys.readouterr()
    told = [json.loads(line) for line in said.out.splitlines()]
    assert [one["source"] for one in told] == names and all(one["error"].endswith(".") for one in told)
    assert len(said.err.splitlines()) == 1


def test_that_a_single_input_that_fails_says_so_on_standard_error_alone_without_json(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["decode", "no-such.json"]) == 1
    said = capsys.readouterr()
    assert said.out == "" and len(said.err.splitlines()) == 1


def test_that_ctrl_c_is_the_exit_code_that_shells_expect(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopped(_: object) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr(library, "targets", stopped)
    assert main(["targets"]) == 130
    assert len(capsys.readouterr().err.splitlines()) == 1
