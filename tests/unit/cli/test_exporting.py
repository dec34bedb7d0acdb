"""``export`` on the command line: the whole set, profiles, records and choices about the cuts."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from PIL import Image

from kirigami_studio.cli import main
from kirigami_studio.cli.fabrication import export
from kirigami_studio.cli.parser import build_parser
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.export.profile import PROFILES
from kirigami_studio.fabricate.options import STRAIGHT
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Document
from kirigami_studio.project.store import load, save
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings
from tests.refusals import refused


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A saved project of a 4 x 5 design whose target is its own outline, for the k40 profile."""
    field = RatioField.from_log10(np.random.default_rng(1).uniform(-0.3, 0.3, (4, 5)))
    target = Outline.from_points(deploy(field).outline(0.0), "own")
    document = Document(
        target=target,
        settings=DesignSettings((4, 5)),
        candidates=(Candidate(Sheet(field), evaluate(deploy(field), target), seed=0, index=0),),
        chosen=0,
        fabrication=FabricationSettings(width_mm=120.0, options=replace(STRAIGHT, hinge_mm=((1, 0.4),)), profile="k40"),
        provenance={"model": "balanced"},
    )
    path = tmp_path / "own.kiri"
    save(document, path)
    return path


def run(capsys: pytest.CaptureFixture[str], *argv: object) -> tuple[int, str, str]:
    code = main([str(word) for word in argv])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_that_all_writes_and_verifies_the_whole_set(
    capsys: pytest.CaptureFixture[str], project: Path, tmp_path: Path
) -> None:
    code, out, _ = run(capsys, "export", project, "--out", tmp_path / "set", "--all", "--paper", "a4", "--json")
    report = json.loads(out)
    assert code == 0
    assert {Path(path).name for path in report["files"]} == {path.name for path in (tmp_path / "set").iterdir()}
    assert [found["ok"] for found in report["verified"]] == [True] * 3
    record = json.loads((tmp_path / "set" / "cut.json").read_text())
    assert record["provenance"] == {
        "model": "balanced",
        "seed": "0",
        "sample": "0",
        "name": "A1",
        "origin": "sampled",
        "polished": "no",
        "trimmed": "no",
        "grid": "4 x 5",
        "phi_degrees": "0",
        "target": "own",
    }
    assert record["fabrication"]["profile"] == "k40"
    assert record["fabrication"]["options"]["hinge_mm"] == [[1, 0.4]]
    code, out, _ = run(capsys, "export", project, "--out", tmp_path / "bare", "--all", "--no-sidecar")
    assert code == 0
    assert out.count("verified by two readers") == 3
    assert not (tmp_path / "bare" / "cut.json").exists()


@pytest.mark.parametrize("profile", PROFILES)
def test_that_a_profile_reaches_the_file_and_its_verification(
    profile: str, capsys: pytest.CaptureFixture[str], project: Path, tmp_path: Path
) -> None:
    code, out, _ = run(capsys, "export", project, "--out", tmp_path / "x.dxf", "--profile", profile, "--json")
    report = json.loads(out)
    assert code == 0
    assert report["verified"][0]["ok"]
    note = PROFILES[profile].note
    assert note is None or note.text in report["warnings"]


def test_that_one_file_gets_a_record_when_asked_for(
    capsys: pytest.CaptureFixture[str], project: Path, tmp_path: Path
) -> None:
    code, out, _ = run(capsys, "export", project, "--out", tmp_path / "x.dxf", "--sidecar", "--json")
    assert code == 0
    assert [Path(path).name for path in json.loads(out)["files"]] == ["x.dxf", "x.json"]
    assert run(capsys, "export", project, "--out", tmp_path / "y.dxf")[0] == 0
    assert not (tmp_path / "y.json").exists()


def test_that_single_widths_change_the_plan(capsys: pytest.CaptureFixture[str], project: Path, tmp_path: Path) -> None:
    def finished(*more: object) -> float:
        code, out, err = run(capsys, "export", project, "--out", tmp_path / "x.dxf", "--sidecar", "--json", *more)
        assert code == 0, err
        return float(json.loads(out)["cut_length_mm"])

    plain = finished()
    assert finished("--hinge-mm", "5=1.5", "3=1.2") < plain
    record = json.loads((tmp_path / "x.json").read_text())
    assert record["fabrication"]["options"]["hinge_mm"] == [[1, 0.4], [3, 1.2], [5, 1.5]]
    finished("--hinge-mm", "3=0.9", "--remove", "1")
    record = json.loads((tmp_path / "x.json").read_text())
    assert record["fabrication"]["options"]["hinge_mm"] == [[3, 0.9]]
    assert record["fabrication"]["options"]["removed"] == [1]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--profile", "axe"], "no machine profile 'axe'"),
        (["--hinge-mm", "5"], "for example 3=0.8; got '5'"),
        (["--hinge-mm", "5=wide"], "got '5=wide'"),
        (["--hinge-mm", "5=-1"], "connector 5"),
        (["--hinge-mm", "5=nan"], "connector 5"),
        (["--hinge-mm", "999=1"], "no connector 999: this sheet has connectors 0 to"),
        (["--hinge-mm", "5=1", "5=2"], "once"),
        (["--remove", "999"], "no connector 999"),
        (["--hinge-mm", "1=1", "--remove", "1"], "given a width and also removed"),
        (["--tabs", "9999"], "0 to 200 tabs"),
    ],
)
def test_that_bad_choices_are_wrong_usage_in_one_sentence(
    options: list[str], words: str, capsys: pytest.CaptureFixture[str], project: Path, tmp_path: Path
) -> None:
    code, out, err = run(capsys, "export", project, "--out", tmp_path / "x.dxf", *options)
    assert (code, out, len(err.splitlines())) == (2, "", 1)
    assert words in err
    assert not (tmp_path / "x.dxf").exists()


@pytest.mark.parametrize(
    "options", [["--style", "curly"], ["--order", "random"], ["--tab-mm", "0"], ["--paper", "a9"], ["--remove", "-1"]]
)
def test_that_unknown_names_and_impossible_numbers_exit_with_two(options: list[str], project: Path) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["export", str(project), "--out", "x.dxf", *options])
    assert stopped.value.code == 2


def test_that_the_project_chooses_the_version_unless_told(
    capsys: pytest.CaptureFixture[str], project: Path, tmp_path: Path
) -> None:
    for more, release in (([], "R2010"), (["--dxf-version", "R12"], "R12")):
        assert run(capsys, "export", project, "--out", tmp_path / "x.dxf", *more)[0] == 0
        assert ezdxf.readfile(tmp_path / "x.dxf").acad_release == release


def test_that_a_name_is_engraved_on_request_and_the_file_carries_it(
    capsys: pytest.CaptureFixture[str], project: Path, tmp_path: Path
) -> None:
    def report(*options: object) -> dict[str, object]:
        code, out, _ = run(capsys, "export", project, "--out", tmp_path / "cut.dxf", *options, "--json")
        assert code == 0
        found: dict[str, object] = json.loads(out)
        return found

    def layers() -> list[str]:
        return [entity.dxf.layer for entity in ezdxf.readfile(tmp_path / "cut.dxf").modelspace()]

    bare = report()
    plain = (tmp_path / "cut.dxf").read_bytes()
    assert "engraved" not in bare and "NAME" not in layers()
    for options, text in ((["--engrave"], "A1"), (["--engrave", "--name", "For Ada"], "For Ada")):
        named = report(*options)
        assert named["engraved"]["text"] == text and layers()[0] == "NAME"  # type: ignore[index]
        told = ("cut_length_mm", "travel_mm", "seconds_estimate", "pieces", "min_connector_mm", "jam_deg", "ok")
        assert [named[key] for key in told] == [bare[key] for key in told]
        carried = load(tmp_path / "cut.dxf")
        assert carried.fabrication.engrave and carried.labels[0].text == text
        save(carried, tmp_path / "carried.kiri")
        judged = run(capsys, "check", tmp_path / "cut.dxf", "--design", tmp_path / "carried.kiri", "--json")[1]
        assert json.loads(judged)["problems"] == []
        assert json.loads(judged)["verdict"]["problems"] == bare["verdict"]["problems"]  # type: ignore[index]
    report("--no-engrave")
    assert (tmp_path / "cut.dxf").read_bytes() == plain
    code, out, _ = run(
        capsys, "export", tmp_path / "carried.kiri", "--out", tmp_path / "x.svg", "--no-engrave", "--json"
    )
    assert code == 0 and "engraved" not in json.loads(out) and 'id="NAME"' not in (tmp_path / "x.svg").read_text()


def test_that_a_name_without_room_is_told(capsys: pytest.CaptureFixture[str], project: Path, tmp_path: Path) -> None:
    long = "A name that is much too long for it"
    code, out, _ = run(capsys, "export", project, "--out", tmp_path / "cut.dxf", "--engrave", "--name", long, "--json")
    told = json.loads(out)
    assert code == 0 and "engraved" not in told and any("no whole panel has room" in text for text in told["warnings"])


def test_that_a_name_alone_renames_the_design_and_engraves_nothing(
    capsys: pytest.CaptureFixture[str], project: Path, tmp_path: Path
) -> None:
    for name, text in ((" For\tAda ", "For Ada"), ("", "A1"), ("a1", "a1")):
        assert run(capsys, "export", project, "--out", tmp_path / "cut.dxf", "--name", name)[0] == 0
        carried = load(tmp_path / "cut.dxf")
        assert carried.labels[0].text == text and not carried.fabrication.engrave


@pytest.mark.parametrize(("name", "said"), [("x" * 41, "41 letters; the limit is 40"), ("B2", "B2"), ("a12", "a12")])
def test_that_a_name_that_no_design_may_have_is_refused_before_anything_is_done(
    name: str, said: str, capsys: pytest.CaptureFixture[str], project: Path, tmp_path: Path
) -> None:
    # A target that is not there would be told otherwise: it has not been read yet.
    for command in (["design", "no-such-target"], ["export", str(project)]):
        try:
            code = main([*command, "--out", str(tmp_path / "no.dxf"), "--name", name])
        except SystemExit as stopped:
            code = int(str(stopped.code))
        (line,) = [line for line in capsys.readouterr().err.splitlines() if line.startswith("kirigami-studio")]
        assert code == 2 and said in line and line.count(".") == 1
        assert not (tmp_path / "no.dxf").exists()


@pytest.mark.parametrize("switch", [["--engrave"], ["--no-engrave"], ["--engrave", "--name", "Hex"]])
def test_that_the_switch_to_engrave_takes_no_target(switch: list[str]) -> None:
    read = build_parser().parse_args(["design", *switch, "a.svg", "b.svg"])
    assert read.targets == ["a.svg", "b.svg"] and read.engrave is (switch[0] == "--engrave")


def test_that_copies_fill_one_file_and_are_told(
    capsys: pytest.CaptureFixture[str], project: Path, tmp_path: Path
) -> None:
    def report(*options: object) -> dict[str, object]:
        words = ("export", project, "--out", tmp_path / "cut.dxf", "--width-mm", 60, *options, "--json")
        code, out, _ = run(capsys, *words)
        assert code == 0
        found: dict[str, object] = json.loads(out)
        return found

    alone, four = report(), report("--copies", 4, "--copy-gap-mm", 3)
    assert "copies" not in alone and alone["pieces"] == 1
    assert four["copies"] == four["pieces"] == 4
    assert four["cut_length_mm"] == pytest.approx(4 * float(str(alone["cut_length_mm"])), rel=1e-6)
    modelspace = ezdxf.readfile(tmp_path / "cut.dxf").modelspace()
    assert sum(entity.closed for entity in modelspace.query("LWPOLYLINE")) == 4
    many = report("--material", "film-uv", "--copies", "fit")
    assert int(str(many["copies"])) > 4 and many["pieces"] == many["copies"]
    few = report("--material", "film-uv", "--copies", 150)
    assert few["copies"] == many["copies"]
    assert any("Of 150 copies" in text for text in few["warnings"])  # type: ignore[attr-defined]


@pytest.mark.parametrize("number", ["0", "-3", "many", "201"])
def test_that_a_senseless_number_of_copies_is_wrong_usage(
    number: str, capsys: pytest.CaptureFixture[str], project: Path, tmp_path: Path
) -> None:
    try:
        code = run(capsys, "export", project, "--out", tmp_path / "cut.dxf", "--copies", number)[0]
    except SystemExit as left:
        code = int(str(left.code))
    assert code == 2 and not (tmp_path / "cut.dxf").exists()


def pixels(path: Path) -> np.ndarray:
    with Image.open(path) as read:
        return np.asarray(read.convert("RGB"))


def test_that_pictures_show_the_sheet_as_it_is_cut_and_half_open(
    capsys: pytest.CaptureFixture[str], project: Path, tmp_path: Path
) -> None:
    shown = {}
    for name, choices in {
        "ideal": [], "half": ["--at-deg", "90"], "flat": ["--at-deg", "180"],
        "cut": ["--as-cut"], "cut-half": ["--as-cut", "--at-deg", "90"], "cut-flat": ["--as-cut", "--at-deg", "180"],
    }.items():  # fmt: skip
        path = tmp_path / f"{name}.png"
        words = ("export", project, "--out", path, "--connector-mm", "1.5", *choices, "--json")
        code, out, err = run(capsys, *words)
        assert code == 0, err
        assert json.loads(out)["verdict"]["level"]
        shown[name] = pixels(path)
    # Flat, it is seen over the same target, so both pictures have one frame: they differ by bows and connectors alone.
    assert shown["flat"].shape == shown["cut-flat"].shape
    differ = np.abs(shown["flat"].astype(int) - shown["cut-flat"]).max(axis=2) > 60
    assert 5e-4 < differ.mean() < 0.2
    assert len({(image.shape, image.tobytes()) for image in shown.values()}) == 6


def test_that_the_pictures_of_the_whole_set_are_as_cut_and_the_cut_files_the_same(
    capsys: pytest.CaptureFixture[str], project: Path, tmp_path: Path
) -> None:
    for name, choices in {"plain": [], "cut": ["--as-cut", "--at-deg", "60"]}.items():
        code, _, err = run(capsys, "export", project, "--out", tmp_path / name, "--all", *choices, "--json")
        assert code == 0, err
    for name in ("cut.dxf", "cut.svg", "cut.pdf"):
        assert (tmp_path / "plain" / name).read_bytes() == (tmp_path / "cut" / name).read_bytes(), name
    plain, cut = ((tmp_path / name / "cut-picture.svg").read_text() for name in ("plain", "cut"))
    assert "Picture, not a cut file. As cut" in cut and "at 60 degrees" in cut
    assert "As cut" not in plain and "at 0 degrees" in plain


@pytest.mark.parametrize(
    ("out", "choices", "code"),
    [
        ("cut.dxf", ["--as-cut"], "picture.none"),
        ("cut.svg", ["--at-deg", "90"], "picture.none"),
        ("open.gif", ["--at-deg", "90"], "picture.none"),
        ("open.png", ["--at-deg", "181"], "picture.angle"),
    ],
)
def test_that_choices_of_pictures_are_refused_for_cut_files(
    project: Path, tmp_path: Path, out: str, choices: list[str], code: str
) -> None:
    arguments = build_parser().parse_args(["export", str(project), "--out", str(tmp_path / out), *choices])
    with refused(UsageError, code):
        export(arguments)
    assert not (tmp_path / out).exists()
