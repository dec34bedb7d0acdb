"""A logo of two parts on the command line and in Python: two sheets to one scale, one project, one cut file."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from PIL import Image
from shapely.geometry import Polygon

import kirigami_studio as ks
from kirigami_studio.cli import main
from kirigami_studio.export.share_page import read_page
from kirigami_studio.foundation.errors import ProjectError, UsageError
from kirigami_studio.project.sheet_size import size_of
from kirigami_studio.project.store import load, save
from kirigami_studio.project.target_parts import parts_as_cut, scale_of
from tests.refusals import refused

pytestmark = pytest.mark.torch
#: A stroke with a dot above it, as an "i": 14 mm and 28 mm wide.
LETTER = '<circle id="dot" cx="20" cy="16" r="7"/><rect id="stem" x="6" y="30" width="28" height="30"/>'
QUICK = ["--grid", "3x3", "--k", "1", "--no-polish", "--material", "film-uv", "--json"]


@pytest.fixture(scope="module")
def letter(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("letter") / "letter.svg"
    size = 'width="40mm" height="70mm" viewBox="0 0 40 70"'
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{LETTER}</svg>', encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def made(letter: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, object]]:
    """The folder that ``design`` writes, and its answer."""
    folder = tmp_path_factory.mktemp("out")
    answers: list[dict[str, object]] = []
    patch = pytest.MonkeyPatch()
    patch.setattr("kirigami_studio.cli.design.print_json", answers.append)
    wish = ["design", str(letter), "--parts", "all", "--join", "each", "--width-mm", "60", "--out", str(folder)]
    try:
        assert main([*wish, *QUICK]) == 0
    finally:
        patch.undo()
    (answer,) = answers
    return folder, json.loads(json.dumps(answer, default=list))


def outlines_of(path: Path) -> list[Polygon]:
    """Outlines in a cut file, by ezdxf and shapely alone."""
    lines = ezdxf.readfile(path).modelspace().query('LWPOLYLINE[layer=="OUTLINE"]')
    return [Polygon([(x, y) for x, y, *_ in ezdxf.path.make_path(line).flattening(1e-3)]) for line in lines]


def test_that_each_part_has_its_designs_and_the_file_both_sheets_apart(made) -> None:
    folder, answer = made
    assert sorted(path.name for path in folder.iterdir()) == [
        "candidates.json",
        "cut.dxf",
        "design.kiri",
        "layout.svg",
        "preview.png",
    ]
    parts = answer["parts"]
    assert [part["name"] for part in parts] == ["dot", "stem"]
    assert all(part["candidates"] and part["verdict"]["level"] for part in parts)
    assert answer["pieces"] == 2 and all(one["ok"] for one in answer["verified"])
    assert [one["part"] for one in answer["verified"]] == ["dot", "stem"]
    one, other = outlines_of(folder / "cut.dxf")
    assert one.distance(other) > 4.0


def test_that_both_sheets_open_to_the_scale_of_the_drawing(made) -> None:
    folder, answer = made
    project = load(folder / "design.kiri")
    parts = parts_as_cut(project)
    sizes = [max(size_of(part).opened) for part in parts]
    assert sizes[0] / sizes[1] == pytest.approx(14.0 / 30.0, rel=1e-6)
    assert sizes[1] == pytest.approx(30.0 * answer["mm_per_unit"], rel=1e-6)
    # The largest part's sheet is as wide as asked for, as far as that is known before the run.
    assert parts[1].fabrication.width_mm == pytest.approx(60.0, rel=0.1)
    # By area: a closed sheet covers what it covers flat.
    areas = sorted(outline.area for outline in outlines_of(folder / "cut.dxf"))
    wanted = [part.target.polygon.area * (max(size_of(part).opened) / np.ptp(part.target.points, axis=0).max()) ** 2
              for part in parts]  # fmt: skip
    assert areas == pytest.approx(sorted(wanted), rel=0.1)


def test_that_the_cut_file_carries_the_project_and_passes_its_check_beside_it(made, tmp_path, capsys) -> None:
    folder, answer = made
    assert main(["check", str(folder / "cut.dxf"), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["sound"] and report["pieces"] == 2 and len(report["sheets"]) == 2
    assert report["verdict_at_export"] == answer["verdict"]["level"]
    code = main(["check", str(folder / "cut.dxf"), "--design", str(folder / "design.kiri"), "--json"])
    report = json.loads(capsys.readouterr().out)
    assert report["verdict"]["level"] == answer["verdict"]["level"] and code == (0 if report["ok"] else 1)
    carried = load(folder / "cut.dxf")
    assert [part.target.name for part in carried.parts] == ["dot", "stem"]
    assert [len(part.candidates) for part in carried.parts] == [1, 1]


def test_that_the_file_of_another_project_is_told(made, tmp_path: Path, capsys) -> None:
    folder, _ = made
    other = tmp_path / "other.kiri"
    save(ks.decode(np.full((3, 3), 1.1)).for_target("square").document, other)
    assert main(["check", str(folder / "cut.dxf"), "--design", str(other), "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["verdict"]["level"] == "will_not_work"


def test_that_one_part_is_exported_by_its_name_or_number(made, tmp_path: Path, capsys) -> None:
    folder, _ = made
    project = str(folder / "design.kiri")
    for words in ("dot", "1"):
        path = tmp_path / f"{words}.dxf"
        main(["export", project, "--part", words, "--out", str(path), "--json"])
        assert json.loads(capsys.readouterr().out)["pieces"] == 1 and len(outlines_of(path)) == 1
    assert (tmp_path / "dot.dxf").read_bytes() == (tmp_path / "1.dxf").read_bytes()
    assert main(["export", project, "--part", "tail", "--out", str(tmp_path / "tail.dxf")]) == 2
    assert "dot, stem" in capsys.readouterr().err


def test_that_everything_goes_to_a_folder_with_one_for_each_part(made, tmp_path: Path, capsys) -> None:
    folder, _ = made
    assert main(["export", str(folder / "design.kiri"), "--all", "--out", str(tmp_path / "all"), "--json"]) == 0
    json.loads(capsys.readouterr().out)
    assert {path.name for path in (tmp_path / "all").iterdir()} == {"cut.dxf", "cut.svg", "dot", "stem"}
    assert len(outlines_of(tmp_path / "all" / "cut.dxf")) == 2
    assert len(outlines_of(tmp_path / "all" / "stem" / "cut.dxf")) == 1


def test_that_pieces_cannot_be_several_where_one_shape_is_wanted(letter: Path, capsys) -> None:
    assert main(["design", str(letter), "--parts", "all", "--join", "each", "--scheduler", "tcp://x:1"]) == 2
    with refused(UsageError, "parts.several_targets", count=2):
        ks.load_target(letter, join="each")


def test_that_a_drawing_of_one_piece_is_designed_as_usual(letter: Path, tmp_path: Path, capsys) -> None:
    wish = ["design", str(letter), "--parts", "dot", "--join", "each", "--out", str(tmp_path), *QUICK]
    assert main(wish) == 0
    assert "best" in json.loads(capsys.readouterr().out)
    assert not load(tmp_path / "design.kiri").other_parts


def test_that_python_gives_the_same_parts(made, letter: Path, tmp_path: Path) -> None:
    folder, _ = made
    assert [target.name for target in ks.load_parts(letter)] == ["dot", "stem"]
    project = ks.load_project(folder / "design.kiri")
    parts = ks.Parts(project.document)
    assert parts.names == ("dot", "stem") and len(parts) == 2
    assert parts["dot"].target.name == "dot" and [len(designs) for designs in parts] == [1, 1]
    found = parts.export(tmp_path / "letter.svg")
    assert found.ok and set(found.verdicts) == {"dot", "stem"} and len(found.verifications) == 2
    empty = ks.Parts(load(folder / "design.kiri"))
    with refused(ProjectError, "api.no_such_name"):
        _ = empty["tail"]


@pytest.fixture(scope="module")
def colon(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two equal dots, one above the other."""
    path = tmp_path_factory.mktemp("colon") / "colon.svg"
    size = 'width="40mm" height="70mm" viewBox="0 0 40 70"'
    dots = '<circle id="upper" cx="20" cy="16" r="7"/><circle id="lower" cx="20" cy="50" r="7"/>'
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{dots}</svg>', encoding="utf-8")
    return path


@pytest.fixture
def runs(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the targets that are designed."""
    from kirigami_studio.studio.designing import run_design

    names: list[str] = []

    def counted(request, *arguments, **more):
        names.append(request.target.name)
        return run_design(request, *arguments, **more)

    monkeypatch.setattr("kirigami_studio.cli.design.run_design", counted)
    monkeypatch.setattr("kirigami_studio.api.designs.run_design", counted)
    return names


def test_that_equal_parts_are_designed_once_and_both_cut(runs, colon: Path, tmp_path: Path, capsys) -> None:
    wish = ["design", str(colon), "--parts", "all", "--join", "each", "--out", str(tmp_path), *QUICK]
    assert main(wish) == 0
    one, other = json.loads(capsys.readouterr().out)["parts"]
    assert runs == ["upper"] and [one["name"], other["name"]] == ["upper", "lower"]
    assert one["candidates"] == other["candidates"] and one["verdict"] == other["verdict"]
    upper, lower = load(tmp_path / "design.kiri").parts
    assert upper.candidate == lower.candidate and upper.place != lower.place and lower.target.name == "lower"
    assert len(outlines_of(tmp_path / "cut.dxf")) == 2


def test_that_python_designs_equal_parts_once(runs, colon: Path) -> None:
    parts = ks.design_parts(colon, grid=(3, 3), k=1, polish=0, material="film-uv")
    assert len(runs) == 1 and parts.names == ("upper", "lower")
    assert parts["upper"].document.candidate == parts["lower"].document.candidate
    assert parts["lower"].target.name == "lower"


def test_that_fixes_are_told_for_each_part_that_fails(made, tmp_path: Path, capsys, monkeypatch) -> None:
    from kirigami_studio.cli import fabrication

    folder, _ = made
    asked: list[str] = []

    def advice(request, verdict):
        asked.append(request.target.name)

    monkeypatch.setattr(fabrication, "_advice", advice)
    wish = ["export", str(folder / "design.kiri"), "--out", str(tmp_path / "cut.dxf"), "--json"]
    main([*wish, "--fixes"])
    found = json.loads(capsys.readouterr().out)["parts"]
    failing = [part["name"] for part in found if not part["ok"]]
    assert asked == failing
    asked.clear()
    main(wish)
    assert asked == []


def test_that_a_file_of_one_sheet_alone_says_which_part_it_shows(made, tmp_path: Path, capsys) -> None:
    folder, _ = made
    wish = ["export", str(folder / "design.kiri"), "--out", str(tmp_path / "view.csv"), "--json"]
    main(wish)
    said = json.loads(capsys.readouterr().out)["warnings"]
    assert sum("'stem'" in text or "'dot'" in text for text in said) == 1
    main([*wish, "--part", "dot"])
    assert not any("'dot'" in text for text in json.loads(capsys.readouterr().out)["warnings"])


def ink(path: Path) -> list[float]:
    """Shares of a picture's rows, from the top, that show a panel somewhere."""
    with Image.open(path) as picture:
        frame = np.asarray(picture.convert("RGB"), dtype=float)
    rows = (frame[..., 2] - frame[..., 0] > 20.0).any(axis=1)
    return rows.tolist()


def test_that_pictures_show_all_parts_in_the_places_of_the_drawing(made, tmp_path: Path, capsys) -> None:
    folder, _ = made
    for kind in ("png", "gif", "html"):
        path = tmp_path / f"view.{kind}"
        assert main(["export", str(folder / "design.kiri"), "--out", str(path), "--json"]) in (0, 1)
        answer = json.loads(capsys.readouterr().out)
        assert answer["files"] == [str(path)] and [part["name"] for part in answer["parts"]] == ["dot", "stem"]
        assert not any("'dot'" in text or "'stem'" in text for text in answer["warnings"])
    # The dot and the stem lie one above the other, with a gap between them: two bands of rows.
    rows = ink(tmp_path / "view.png")
    assert sum(one and not before for before, one in pairwise([False, *rows])) == 2
    with Image.open(tmp_path / "view.gif") as film:
        assert film.n_frames > 10
    moving = read_page(tmp_path / "view.html")
    assert {part[3] for part in moving["parts"]} == {0, 1} and len(moving["sheets"]) == 2
    # Over the target they are where the drawing has them: the dot 29 mm above the stem's middle.
    (_, _, _, dot, *_), (_, _, _, stem, *_) = moving["sheets"]
    assert dot - stem == pytest.approx(answer_scale(folder) * 29.0, rel=0.1)


def answer_scale(folder: Path) -> float:
    return scale_of(load(folder / "design.kiri"))


def test_that_one_part_can_still_be_pictured_alone(made, tmp_path: Path, capsys) -> None:
    folder, _ = made
    path = tmp_path / "dot.html"
    main(["export", str(folder / "design.kiri"), "--out", str(path), "--part", "dot", "--json"])
    capsys.readouterr()
    assert "sheets" not in read_page(path)
