"""``artwork`` on the command line: files, what it tells, what it refuses."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from command_line import answer, refusal
from PIL import Image

from kirigami_studio.cli import main
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.export.artwork import Artwork, Laid, PictureFit, SheetState
from kirigami_studio.export.artwork_picture import read_picture
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.project.document import Document
from kirigami_studio.project.store import load as load_project
from kirigami_studio.project.store import save
from kirigami_studio.settings.fabrication import FabricationSettings


@pytest.fixture
def project(tmp_path: Path) -> Path:
    field = RatioField.from_log10(np.random.default_rng(1).uniform(-0.2, 0.2, (3, 4)))
    heart = load("heart")
    candidate = Candidate(Sheet(field), evaluate(deploy(field), heart), 0, 0)
    document = Document(heart, candidates=(candidate,), chosen=0, fabrication=FabricationSettings(width_mm=60.0))
    save(document, tmp_path / "design.kiri")
    return tmp_path / "design.kiri"


@pytest.fixture
def photo(tmp_path: Path) -> Path:
    Image.fromarray(np.random.default_rng(0).integers(0, 255, (300, 400, 3), dtype=np.uint8)).save(
        tmp_path / "photo.jpg"
    )
    return tmp_path / "photo.jpg"


def test_that_files_and_numbers_are_told(
    capsys: pytest.CaptureFixture[str], project: Path, photo: Path, tmp_path: Path
) -> None:
    told = answer(capsys, "artwork", project, "--picture", photo, "--out", tmp_path / "out", "--dpi", 100, "--json")
    assert {Path(path).name for path in told["files"]} == {path.name for path in (tmp_path / "out").iterdir()}
    assert [Path(path).name for path in told["files"]] == [
        "artwork.svg",
        "artwork.pdf",
        "artwork.png",
        "artwork_opened.png",
    ]
    assert told["page_mm"] == [side + 16.0 for side in told["frame_mm"]] and told["pages"] == 1
    with Image.open(tmp_path / "out" / "artwork.png") as image:
        assert list(image.size) == told["pixels"]
    assert told["covered"] == pytest.approx(1.0)
    assert told["on"] == "target"
    assert 50 < told["picture_dpi"] < 150
    (warning,) = told["warnings"]
    assert "dpi" in warning


def test_that_options_reach_the_files(
    capsys: pytest.CaptureFixture[str], project: Path, photo: Path, tmp_path: Path
) -> None:
    words = ["artwork", project, "--picture", photo, "--dpi", 50, "--json", "--out"]
    usual = answer(capsys, *words, tmp_path / "usual")
    flat = answer(capsys, *words, tmp_path / "flat", "--on", "flat", "--place", "fit", "--scale", 0.5, "--turn-deg", 90)
    assert flat["on"] == "flat"
    assert flat["covered"] < 0.5
    assert any("gets no picture" in warning for warning in flat["warnings"])
    cut = ["--width-mm", 90, "--copies", 2, "--bleed-mm", 2, "--margin-mm", 0]
    large = answer(capsys, *words, tmp_path / "large", *cut)
    assert large["copies"] == 2
    assert large["page_mm"] == large["frame_mm"]
    assert max(large["frame_mm"]) > 2.5 * max(usual["frame_mm"])
    assert main(["export", str(project), "--out", str(tmp_path / "cut.svg"), "--width-mm", "90", "--copies", "2"]) == 0
    roots = [ElementTree.parse(path).getroot() for path in (tmp_path / "cut.svg", tmp_path / "large" / "artwork.svg")]
    assert roots[0].get("viewBox") == roots[1].get("viewBox")


def test_that_the_artwork_of_the_project_is_printed_and_options_change_it(
    capsys: pytest.CaptureFixture[str], project: Path, photo: Path, tmp_path: Path
) -> None:
    words = ["artwork", project, "--dpi", 50, "--json", "--out", tmp_path / "out"]
    code, said = refusal(capsys, *words)
    assert code == 2 and "--picture" in said
    laid = Laid(read_picture(photo), SheetState.FLAT, PictureFit.FIT, 0.5)
    save(replace(load_project(project), artwork=Artwork(laid)), project)
    own = answer(capsys, *words)
    assert own["on"] == "flat" and own["covered"] < 0.5
    other = answer(capsys, *words, "--on", "target", "--scale", 1, "--place", "fill")
    assert other["on"] == "target" and other["covered"] == pytest.approx(1.0)
    told = answer(capsys, "export", project, "--all", "--out", tmp_path / "all", "--json")
    assert {"artwork.svg", "artwork.png"} < {Path(path).name for path in told["files"]}


def test_that_an_svg_is_printed_without_a_display(project: Path, tmp_path: Path) -> None:
    drawing = tmp_path / "drawing.svg"
    drawing.write_text('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 4 3"><text y="2">A</text></svg>')
    words = ["artwork", project, "--picture", drawing, "--out", tmp_path / "out", "--dpi", "50", "--json"]
    hidden = ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM")
    said = subprocess.run(
        [sys.executable, "-m", "kirigami_studio", *map(str, words)],
        capture_output=True,
        text=True,
        check=False,
        env={name: value for name, value in os.environ.items() if name not in hidden},
    )
    assert said.returncode == 0, said.stderr
    assert json.loads(said.stdout)["picture_dpi"] > 500


def test_that_a_large_print_is_spread_over_paper(
    capsys: pytest.CaptureFixture[str], project: Path, photo: Path, tmp_path: Path
) -> None:
    words = ["artwork", project, "--picture", photo, "--dpi", 10, "--json", "--width-mm", 400, "--out"]
    told = answer(capsys, *words, tmp_path / "many", "--paper", "a4", "--width-mm", 1200)
    assert told["pages"] >= 20 and any(f"{told['pages']} pages" in warning for warning in told["warnings"])
    document = load_project(project)
    save(replace(document, fabrication=replace(document.fabrication, paper="a4")), project)
    assert answer(capsys, *words, tmp_path / "own")["pages"] == 4


def test_that_a_second_picture_shares_the_sheet(
    capsys: pytest.CaptureFixture[str], project: Path, photo: Path, tmp_path: Path
) -> None:
    Image.new("RGB", (60, 60), "navy").save(tmp_path / "navy.png")
    words = ["--picture", photo, "--second", tmp_path / "navy.png", "--dpi", 50, "--out", tmp_path / "out"]
    told = answer(capsys, "artwork", project, *words, "--stripes", 30, "--json")
    assert told["stripes"] == 30
    with Image.open(tmp_path / "out" / "artwork.png") as image:
        pixels = np.asarray(image)
    opaque = pixels[pixels[..., 3] == 255]
    assert 0.3 < (opaque == (0, 0, 128, 255)).all(axis=1).mean() < 0.6
    code, said = refusal(capsys, "artwork", project, *words, "--stripes", 5000)
    assert code == 2 and "2 to 1000 stripes" in said


@pytest.mark.parametrize(
    ("options", "code", "words"),
    [
        (["--bleed-mm", "90"], 2, "bleed must be 0 to 20 mm"),
        (["--margin-mm", "900"], 2, "margin must be 0 to 100 mm"),
        (["--scale", "5000"], 2, "scale from 0.01 to 100"),
        (["--dpi", "99999"], 1, "dpi or less"),
        (["--material", "soap"], 1, "soap"),
    ],
)
def test_that_impossible_wishes_are_refused_in_one_sentence(
    options: list[str],
    code: int,
    words: str,
    capsys: pytest.CaptureFixture[str],
    project: Path,
    photo: Path,
    tmp_path: Path,
) -> None:
    said = refusal(capsys, "artwork", project, "--picture", photo, "--out", tmp_path / "out", *options)
    assert said[0] == code
    assert words in said[1]
    assert not (tmp_path / "out").exists()


def test_that_no_design_and_no_picture_are_refused(
    capsys: pytest.CaptureFixture[str], project: Path, photo: Path, tmp_path: Path
) -> None:
    save(Document(), tmp_path / "empty.kiri")
    assert refusal(capsys, "artwork", tmp_path / "empty.kiri", "--picture", photo, "--out", tmp_path)[0] == 1
    (tmp_path / "text.png").write_text("no picture")
    code, words = refusal(capsys, "artwork", project, "--picture", tmp_path / "text.png", "--out", tmp_path)
    assert code == 1
    assert "text.png is damaged or not a picture" in words
