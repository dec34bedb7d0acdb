"""``materials`` and ``coupon`` through the real entry point."""

from __future__ import annotations

from datetime import date
from pathlib import Path

import ezdxf
import pytest
from command_line import answer, refusal

from kirigami_studio.cli import main
from kirigami_studio.fabricate.material import find_material, presets


def test_that_every_material_is_listed_with_its_owner_and_state(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["materials"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[:3] for line in lines] == [[key, "bundled", "uncalibrated"] for key in presets()]
    assert answer(capsys, "materials", "--json") == {
        "materials": list(presets()), "own": [], "calibrated": [], "faults": []
    }  # fmt: skip


def test_that_a_copy_is_made_listed_used_and_deleted(capsys: pytest.CaptureFixture[str], own_materials: Path) -> None:
    made = answer(
        capsys,
        "materials",
        "--copy",
        "film-uv",
        "--as",
        "mine",
        "--set",
        "kerf_mm=0.031",
        "--set",
        "passes = 2",
        "--json",
    )
    assert made == {"saved": "mine", "calibrated": False}
    assert (find_material("mine").kerf_mm, find_material("mine").passes) == (0.031, 2)
    assert main(["materials"]) == 0
    assert "mine         own      uncalibrated" in capsys.readouterr().out
    assert answer(capsys, "materials", "--delete", "mine", "--json") == {"deleted": "mine"}
    assert list(own_materials.iterdir()) == []


def test_that_a_calibrated_copy_says_when_and_by_whom(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["materials", "--copy", "film-uv", "--set", "kerf_mm=0.03", "--calibrated", "--by", "Ada"]) == 0
    assert "film-uv      own      calibrated" in capsys.readouterr().out
    found = find_material("film-uv")
    assert (found.calibrated, found.measured_on, found.measured_by) == (True, date.today().isoformat(), "Ada")
    assert answer(capsys, "materials", "--json")["calibrated"] == ["film-uv"]


def test_that_broken_own_files_are_said_in_the_list(capsys: pytest.CaptureFixture[str], own_materials: Path) -> None:
    (own_materials / "bad.toml").write_text("no toml")
    assert main(["materials"]) == 0
    assert "Left out: Cannot read the material file" in capsys.readouterr().out.splitlines()[-1]
    assert len(answer(capsys, "materials", "--json")["faults"]) == 1


@pytest.mark.parametrize(
    ("code", "argv", "expected"),
    [
        (2, ["--copy", "film-uv", "--delete", "x"], "not both"),
        (2, ["--as", "x"], "need --copy KEY"),
        (2, ["--set", "kerf_mm=1"], "need --copy KEY"),
        (2, ["--copy", "film-uv", "--set", "kerf_mm"], "NAME=VALUE"),
        (2, ["--copy", "film-uv", "--calibrated"], "--by NAME"),
        (1, ["--copy", "oak"], "no material 'oak'"),
        (1, ["--copy", "film-uv", "--as", "../x"], "key has 1 to 40"),
        (1, ["--copy", "film-uv", "--set", "kerf_mm=-1"], "kerf_mm must be a number of 0 or more"),
        (1, ["--copy", "film-uv", "--set", "kerf=1"], "no entry 'kerf'"),
        (1, ["--delete", "film-uv"], "is a bundled material"),
    ],
)
def test_that_wrong_requests_are_one_sentence_and_change_nothing(
    capsys: pytest.CaptureFixture[str], own_materials: Path, code: int, argv: list[str], expected: str
) -> None:
    found, sentence = refusal(capsys, "materials", *argv)
    assert found == code
    assert expected in sentence
    assert list(own_materials.iterdir()) == []


@pytest.mark.parametrize("suffix", [".dxf", ".svg", ".pdf"])
def test_that_a_coupon_is_written(capsys: pytest.CaptureFixture[str], tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"coupon{suffix}"
    answered = answer(capsys, "coupon", "--material", "pet-co2", "--out", path, "--json")
    assert answered["files"] == [str(path)]
    assert answered["pieces"] == 1
    assert path.stat().st_size > 1000
    if suffix == ".dxf":
        assert len(ezdxf.readfile(path).modelspace()) > 60
        assert main(["check", str(path)]) == 0


def test_that_measured_gaps_become_a_kerf(capsys: pytest.CaptureFixture[str]) -> None:
    answered = answer(capsys, "coupon", "--gap-mm", 1.4, 1.6, "--json")
    assert answered == {"kerf_mm": pytest.approx(0.15), "doubt_mm": pytest.approx(0.01)}
    assert main(["coupon", "--gap-mm", "0.3"]) == 0
    assert "--set kerf_mm=0.03" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("code", "argv", "expected"),
    [
        (2, [], "Give --out"),
        (2, ["--out", "coupon.gif"], ".dxf, .svg or .pdf"),
        (1, ["--out", "coupon.dxf", "--material", "oak"], "no material 'oak'"),
        (1, ["--out", "coupon.dxf", "--kerf-mm", "2"], "kerfs up to 0.5 mm"),
    ],
)
def test_that_impossible_coupons_are_refused(
    capsys: pytest.CaptureFixture[str], code: int, argv: list[str], expected: str
) -> None:
    found, sentence = refusal(capsys, "coupon", *argv)
    assert found == code
    assert expected in sentence
