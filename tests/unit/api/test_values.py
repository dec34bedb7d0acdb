"""Targets, sheets and designs of the Python API say what the packages below say."""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest
import shapely
from command_line import answer

import kirigami_studio as ks
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.outlines.starts import start_shape
from kirigami_studio.polish.flat_sheet import first_sheet
from kirigami_studio.project.document import Document

L_SHAPE = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]


def test_that_one_shape_is_one_target_wherever_it_comes_from(tmp_path: Path) -> None:
    (tmp_path / "ell.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 2 H2 V1 H1 V0 H0 Z"/></svg>', encoding="utf-8"
    )
    mask = np.zeros((40, 40), dtype=bool)
    mask[20:], mask[:, :20] = True, True
    sources = (L_SHAPE, np.array(L_SHAPE)[::-1], shapely.Polygon(L_SHAPE), Outline.from_points(L_SHAPE),
               tmp_path / "ell.svg", str(tmp_path / "ell.svg"), ks.load_target(L_SHAPE))  # fmt: skip
    first, *others = (ks.load_target(source) for source in sources)
    assert [other.polygon.symmetric_difference(first.polygon).area < 1e-6 for other in others] == [True] * 6
    for traced in (mask, mask.astype(np.uint8) * 255, mask.astype(float)):
        assert ks.load_target(traced).polygon.symmetric_difference(first.polygon).area < 0.05
    assert ks.load_target(L_SHAPE) == first and hash(ks.load_target(L_SHAPE)) == hash(first)


def test_that_a_target_with_a_hole_has_it_in_region_mask_and_words_and_can_be_filled(tmp_path: Path) -> None:
    ring = shapely.Point(0, 0).buffer(10) - shapely.Point(0, 0).buffer(4)
    (tmp_path / "ring.json").write_text(
        json.dumps({"rings": [list(ring.exterior.coords), list(ring.interiors[0].coords)]}), encoding="utf-8"
    )
    for source in (ring, tmp_path / "ring.json", ks.load_target(ring)):
        target = ks.load_target(source)
        assert target.polygon.area == pytest.approx(1.0) and target.region.area == pytest.approx(0.84)
        assert len(target.holes) == 1 and repr(target).endswith("1 hole>")
        mask = target.mask(200)
        assert mask.sum() / 200**2 == pytest.approx(0.84 * math.pi / 4, rel=0.01) and not mask[100, 100]
        filled = ks.load_target(source, fill_holes=True)
        assert not filled.holes and filled.region.area == pytest.approx(1.0) and "filled" in filled.notes[-1]
        assert ks.load_target(filled, fill_holes=False) == target != filled


def test_that_targets_keep_names_and_tell_what_was_left_out() -> None:
    two = shapely.MultiPolygon([shapely.box(0, 0, 2, 2), shapely.box(5, 0, 6, 1)])
    target = ks.load_target(two, name="box")
    assert target.name == "box" and target.polygon.area == pytest.approx(1.0)
    assert len(target.notes) == 1 and "smaller piece" in target.notes[0]
    with pytest.raises(ValueError, match="read-only"):
        target.points[0] = 0.0
    assert {"heart", "star"} <= set(ks.target_names())


def test_that_parts_of_a_drawing_are_chosen_as_on_the_command_line(tmp_path: Path) -> None:
    path = tmp_path / "two.svg"
    path.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg"><rect id="big" width="30" height="30"/>'
        '<circle id="small" cx="60" cy="15" r="10"/></svg>',
        encoding="utf-8",
    )
    assert len(ks.load_target(path).points) == 4
    assert len(ks.load_target(path, parts="small").points) > 20
    joined = ks.load_target(path, parts="all", join="hull")
    assert joined.polygon.convex_hull.area == pytest.approx(1.0)
    with pytest.raises(ks.KirigamiError) as refused:
        ks.load_target("heart", parts="all")
    assert refused.value.code == "parts.not_a_drawing"


def test_that_a_sheet_is_the_exact_deployment(uneven: ks.Sheet) -> None:
    motion = deploy(RatioField(uneven.ratios))
    for phi in (math.pi, 1.0, 0.0):
        assert np.array_equal(uneven.voids(phi), motion.voids(phi))
        assert np.array_equal(uneven.panels(phi), motion.panels(phi))
        assert np.array_equal(uneven.outline(phi), motion.outline(phi))
        assert uneven.polygon(phi).area == pytest.approx(uneven.area(phi))
    panels, voids = uneven.panel_polygons(1.0), uneven.void_polygons(1.0)
    assert panels.shape == (5, 6) and voids.shape == (4, 5)
    assert shapely.area(voids).sum() / uneven.area(1.0) == pytest.approx(uneven.porosity(1.0))
    assert shapely.area(panels).sum() + shapely.area(voids).sum() == pytest.approx(uneven.area(1.0))


def test_that_sheets_are_read_from_files_and_from_what_they_say_of_themselves(
    uneven: ks.Sheet, design: ks.Design, tmp_path: Path
) -> None:
    np.save(tmp_path / "ratios.npy", uneven.ratios)
    design.save(tmp_path / "one.kiri")
    for source in (tmp_path / "ratios.npy", str(tmp_path / "one.kiri"), design, uneven, uneven.ratios.tolist()):
        assert ks.decode(source) == uneven
    round_one = ks.Sheet(deploy(first_sheet((4, 4), start_shape("circle"), free_rim=True)))
    told = round_one.to_json()
    again = ks.decode(told["ratio"], rim=told["rim"], start=told["start"], cell=told["cell"])
    assert again == round_one and hash(again) == hash(round_one)


def test_that_a_sheet_is_scored_as_on_the_command_line(
    uneven: ks.Sheet, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    np.save(tmp_path / "ratios.npy", uneven.ratios)
    told = answer(capsys, "score", tmp_path / "ratios.npy", "heart", "--json")
    mine = ks.score(uneven, "heart")
    assert (mine.siou, mine.iou_exact, mine.tv) == (told["siou"], told["iou_exact"], told["tv"])
    assert mine == evaluate(uneven.deployment, load("heart"))


def test_that_a_sheet_with_a_target_is_a_design(uneven: ks.Sheet, tmp_path: Path) -> None:
    design = uneven.for_target("heart", phi=0.3, name="first try")
    assert (design.name, design.target.name, design.phi) == ("first try", "heart", 0.3)
    assert design.sheet == uneven and design.siou == ks.score(uneven, "heart", phi=0.3).siou
    flat = design.panel_polygons(math.pi)
    assert len(flat) == 30 and shapely.area(flat).sum() == pytest.approx(shapely.area(design.panel_polygons()).sum())
    assert design.polygon().intersection(design.target.polygon).area > 0.7
    again = ks.load_project(design.save(tmp_path / "try.kiri"))
    assert len(again) == 1 and again.chosen.name == "first try" and again.best.sheet == uneven
    own = uneven.for_target()
    assert own.iou > 0.999 and own.feasible and not own.trimmed


def test_that_designs_are_a_sequence(hearts: ks.Designs, tmp_path: Path) -> None:
    assert len(hearts) == len(list(hearts)) == len(hearts.table()) == len(hearts.ratios) > 3
    assert hearts[0].name == hearts["A1"].name == hearts.best.name == "A1"
    assert hearts[-1].sheet == list(hearts)[-1].sheet
    assert [one.name for one in hearts[1:3]] == ["A2", "A3"]
    assert hearts.target.name == "heart" and hearts.ratios.shape[1:] == hearts.best.grid
    row = hearts.table()[2]
    assert row["name"] == "A3" and row["iou"] == hearts[2].iou == hearts[2].score.iou_exact
    assert ks.load_project(hearts.save(tmp_path / "again.kiri")).document == hearts.document
    only = ks.load_project(hearts["A3"].save(tmp_path / "third.kiri"))
    assert [one.name for one in only] == ["A3"]
    nothing = ks.Designs(Document())
    assert len(nothing) == 0 and repr(nothing) == "<Designs: none>"


@pytest.mark.torch
def test_that_a_slice_of_designs_is_designs_with_their_names_and_choice(hearts: ks.Designs, tmp_path: Path) -> None:
    some = hearts[1:4]
    assert isinstance(some, ks.Designs) and [one.name for one in some] == [one.name for one in hearts][1:4]
    assert some.best.sheet == hearts[1].sheet and some.chosen.name == some.best.name
    assert hearts[:3].chosen.name == hearts.chosen.name
    assert ks.load_project(some.save(tmp_path / "some.kiri"))[2].sheet == hearts[3].sheet
    assert len(hearts[5:5]) == 0 and [one.name for one in hearts[::-1]] == [one.name for one in hearts][::-1]


def test_that_sheets_take_arrays_of_angles(uneven: ks.Sheet) -> None:
    angles = np.linspace(0.0, math.pi, 6).reshape(2, 3)
    for function in (uneven.nodes, uneven.panels, uneven.voids, uneven.area, uneven.porosity):
        found = function(angles)
        assert np.array_equal(found[1, 0], function(float(angles[1, 0])))
        assert found.shape == (2, 3, *np.shape(function(0.0))) and found.dtype == np.float64
    assert isinstance(uneven.area(np.float64(0.5)), float)
    with pytest.raises(ks.KirigamiError, match="got 4"):
        uneven.area([0.0, 4.0])
    with pytest.raises(ks.KirigamiError, match="number in radians"):
        uneven.panels(["flat"])
    with pytest.raises(ks.KirigamiError, match=r"got array\(\[0. , 0.5\]\)"):
        uneven.outline(np.array([0.0, 0.5]))


def test_that_designs_become_a_frame_of_pandas_with_a_row_for_each(hearts: ks.Designs) -> None:
    pytest.importorskip("pandas")
    frame = hearts.to_frame()
    assert list(frame.index) == [design.name for design in hearts]
    assert frame["iou"].tolist() == [design.iou for design in hearts] and frame["feasible"].dtype == bool
    assert list(hearts[:0].to_frame().columns) == list(frame.columns)


def test_that_packages_that_are_not_there_are_named_with_their_extra(
    hearts: ks.Designs, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, extra, wanted in (
        ("pandas", "pandas", hearts.to_frame),
        ("matplotlib.collections", "plot", hearts.best.plot),
    ):
        monkeypatch.setitem(sys.modules, name, None)
        with pytest.raises(ks.KirigamiError, match=rf"pip install 'kirigami-studio\[{extra}\]'") as refused:
            wanted()
        assert refused.value.code == "api.package_missing"


def test_that_the_same_arguments_give_the_same_designs_as_the_command_line(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    seen: list[ks.Progress] = []
    options = {"k": 2, "grid": (4, 5), "seed": 3, "symmetry": "none", "regular": 0.2, "rim": "even", "polish": False}
    mine = ks.design("heart", **options, progress=seen.append)  # type: ignore[arg-type]
    told = answer(capsys, "design", "heart", "--k", 2, "--grid", "4x5", "--seed", 3, "--symmetry", "none", "--rim",
                  "even", "--regular", 0.2, "--no-polish", "--out", tmp_path, "--json")  # fmt: skip
    assert [one.ratios.tolist() for one in mine] == [one["ratio"] for one in told["candidates"]]
    assert ks.load_project(tmp_path / "design.kiri").document == mine.document
    assert [one for one in seen if one.done == one.total == 2] and 0 <= seen[-1].done <= 2
    shares = [one.share for one in seen]
    assert shares == sorted(shares) and shares[0] >= 0 and shares[-1] <= 1
    small = ks.design("star", k=np.int64(1), grid=np.array([3, 3]), polish=False, start="circle", also="hexagon",
                      also_phi=1.2, phi=np.float32(0.1), material="film-uv")  # fmt: skip
    assert small.best.candidate.second is not None and small.best.sheet.deployment.sheet.start is not None


@pytest.mark.torch
def test_that_progress_in_a_file_has_whole_lines(capsys: pytest.CaptureFixture[str]) -> None:
    ks.design("circle", k=2, grid=(3, 3), polish=2, regular=0.0, progress=True)
    said = capsys.readouterr().out
    assert "\r" not in said and 1 <= len(said.splitlines()) <= 11
