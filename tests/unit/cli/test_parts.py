"""Options on the parts of drawings, and what is told of what was left out."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from command_line import refusal
from PIL import Image, ImageDraw
from shapely.geometry import Polygon

from kirigami_studio.cli import main

BODY = '<circle id="disc" cx="30" cy="40" r="20"/><rect id="plate" x="60" y="20" width="30" height="30"/>'


@pytest.fixture
def logo(tmp_path: Path) -> Path:
    path = tmp_path / "logo.svg"
    text = f'<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="80mm" viewBox="0 0 100 80">{BODY}</svg>'
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture
def sheet(tmp_path: Path) -> Path:
    path = tmp_path / "sheet.json"
    path.write_text(json.dumps({"ratio": [[1.0, 1.0, 1.0]] * 3}), encoding="utf-8")
    return path


def scored(capsys: pytest.CaptureFixture[str], *words: object) -> tuple[dict, str]:
    assert main(["score", *map(str, words), "--json"]) == 0
    captured = capsys.readouterr()
    return json.loads(captured.out), captured.err


def test_that_parts_lists_what_a_drawing_holds(capsys, logo) -> None:
    assert main(["parts", str(logo), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert [part["name"] for part in told["parts"]] == ["disc", "plate"]
    assert told["parts"][1]["size"] == pytest.approx([30, 30]) and told["unit"] == "mm"
    assert told["largest"] == [1] and told["ambiguous"] is True and told["as_painted"] is False


def test_that_what_was_left_out_is_told_on_standard_error_and_in_json(capsys, logo, sheet) -> None:
    told, said = scored(capsys, sheet, logo)
    asked, note = told["warnings"]
    assert "Taken: disc." in asked and "--parts" in asked
    assert "1 smaller piece was left out" in note
    assert said == "".join(f"kirigami-studio: warning: {logo}: {one}\n" for one in (asked, note))


def test_that_a_chosen_part_is_the_target(capsys, logo, sheet) -> None:
    told, said = scored(capsys, sheet, logo, "--parts", "plate")
    assert told["warnings"] == ["1 part was left out: disc."] and "disc" in said
    assert told["siou"] == pytest.approx(scored(capsys, sheet, "square")[0]["siou"], abs=1e-3)


def test_that_joined_parts_leave_nothing_out(capsys, logo, sheet) -> None:
    told, _ = scored(capsys, sheet, logo, "--join", "bridge", "--bridge", "5")
    assert told["warnings"] == ["1 bridge holds the parts together."]
    assert scored(capsys, sheet, logo, "--join", "hull") == (
        told | scored(capsys, sheet, logo, "--join", "hull")[0],
        "",
    )


def test_that_open_lines_are_refused_with_the_option_that_takes_them(capsys, tmp_path, sheet) -> None:
    path = tmp_path / "open.svg"
    path.write_text('<svg xmlns="http://www.w3.org/2000/svg"><path fill="none" stroke="red" d="M0 0h50v50"/></svg>')
    code, said = refusal(capsys, "score", sheet, path, "--json")
    assert code == 1 and "--stroke-outline" in said
    told, _ = scored(capsys, sheet, path, "--stroke-outline", "4")
    assert told["feasible"]


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (("logo.svg", "--parts", "nothing"), 2, "disc, plate"),
        (("logo.svg", "--join", "hull", "--bridge", "2"), 2, "--join bridge"),
        (("logo.svg", "--bridge", "500"), 1, "logo.svg: A bridge must be"),
        (("heart", "--parts", "all"), 2, "has no parts"),
    ],
)
def test_that_options_that_make_no_sense_are_refused(words, code, says, capsys, logo, sheet, monkeypatch) -> None:
    monkeypatch.chdir(logo.parent)
    found, said = refusal(capsys, "score", sheet, *words, "--json")
    assert found == code and says in said


def test_that_holes_are_kept_filled_or_opened_as_asked(capsys, tmp_path, sheet) -> None:
    thick = '<path fill-rule="evenodd" d="M0 0h50v50h-50zM15 15h20v20h-20z"/>'
    thin = '<path fill-rule="evenodd" d="M0 0h50v50h-50zM2 2h46v46h-46z"/>'
    found = {}
    for name, body in (("thick", thick), ("thin", thin)):
        path = tmp_path / f"{name}.svg"
        path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg">{body}</svg>', encoding="utf-8")
        for option in ((), ("--fill-holes",), ("--no-fill-holes",)):
            told, said = scored(capsys, sheet, path, *option)
            found[name, *option] = told["target_holes"], "filled" in said
    assert found == {
        ("thick",): (1, False),
        ("thick", "--fill-holes"): (0, True),
        ("thick", "--no-fill-holes"): (1, False),
        ("thin",): (0, True),
        ("thin", "--fill-holes"): (0, True),
        ("thin", "--no-fill-holes"): (1, False),
    }


@pytest.fixture
def photo(tmp_path: Path) -> Path:
    """A dark disc, and a red bar of which half is yellow, on a table."""
    image = Image.new("RGB", (480, 240), (225, 220, 210))
    draw = ImageDraw.Draw(image)
    draw.ellipse((30, 30, 210, 210), fill=(40, 45, 60))
    draw.rectangle((280, 80, 359, 159), fill=(200, 40, 40))
    draw.rectangle((360, 80, 439, 159), fill=(250, 210, 60))
    image.save(tmp_path / "photo.jpg", quality=95)
    return tmp_path / "photo.jpg"


def designed(capsys: pytest.CaptureFixture[str], photo: Path, *words: str) -> tuple[Polygon, list[str]]:
    """The target of a design of a picture, and the warnings."""
    assert main(["design", str(photo), *words, "--k", "1", "--grid", "4x4", "--no-polish", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    return Polygon(told["target_outline"][0]), told["warnings"]


def test_that_a_design_is_of_the_object_at_a_place(capsys, photo) -> None:
    def is_box(shape: Polygon, across: float, down: float) -> bool:
        left, bottom, right, top = shape.bounds
        return (right - left) / (top - bottom) == pytest.approx(across / down, rel=0.05) and shape.area > 0.96 * (
            (right - left) * (top - bottom)
        )

    disc, said = designed(capsys, photo)
    assert not is_box(disc, 1, 1) and any("--object X,Y" in note for note in said)
    square, said = designed(capsys, photo, "--object", "320,120")
    assert is_box(square, 1, 1) and not any("--object X,Y" in note for note in said)
    assert is_box(designed(capsys, photo, "--object", "320,120", "--object", "400,120")[0], 2, 1)
    both = ("--object", "320,120", "--object", "400,120", "--not-object", "420,100")
    assert is_box(designed(capsys, photo, *both)[0], 1, 1)
    code, sentence = refusal(capsys, "design", photo, "--object", "999,5", "--k", "1", "--json")
    assert code == 1 and "999" in sentence
