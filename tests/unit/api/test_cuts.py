"""Cuts, simulations and files of the Python API are those of the command line."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import answer
from PIL import Image

import kirigami_studio as ks


def test_that_a_cut_file_is_the_one_of_the_command_line(
    design: ks.Design, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    design.save(tmp_path / "one.kiri")
    told = answer(capsys, "export", tmp_path / "one.kiri", "--out", tmp_path / "theirs.dxf", "--width-mm", 60,
                  "--material", "card-co2", "--style", "round", "--tabs", 4, "--hinge-mm", "3=0.8", "--remove", 7,
                  "--json")  # fmt: skip
    cuts = design.plan_cuts(width_mm=np.float64(60), material="card-co2", style="round", tabs=4, hinge_mm={3: 0.8},
                            removed=[7])  # fmt: skip
    mine = cuts.export(tmp_path / "mine.dxf")
    assert mine.path.read_bytes() == (tmp_path / "theirs.dxf").read_bytes()
    assert mine.ok and mine.verdict is not None and mine.verdict.to_json() == told["verdict"]
    assert list(cuts.size_mm) == told["size_mm"] and cuts.min_connector_mm == told["min_connector_mm"]


def test_that_every_kind_of_file_is_written(cuts: ks.Cuts, design: ks.Design, tmp_path: Path) -> None:
    for suffix in ("dxf", "svg", "pdf", "lbrn2", "png"):
        written = cuts.export(tmp_path / f"cut.{suffix}")
        assert written.ok and written.path.stat().st_size > 500
        assert len(written.verifications) == (suffix in ("dxf", "svg"))
    assert json.loads(cuts.export(tmp_path / "told.svg", record=True).files[1].read_text())["verdict"]["level"]
    picture = design.export(tmp_path / "closed.png")
    assert picture.verdict is None and picture.cuts is None and picture.ok
    with Image.open(picture.path) as image:
        assert max(image.size) == 900


def test_that_the_whole_set_is_written_and_verified(cuts: ks.Cuts, tmp_path: Path) -> None:
    written = cuts.export_all(tmp_path / "set")
    assert written.ok and len(written.verifications) == 3
    assert {"cut.dxf", "cut.pdf", "preview.png"} <= {path.name for path in written.files}
    assert repr(written).startswith("<Exported cut.dxf, ") and repr(written).endswith(", verified by two readers>")


def test_that_a_simulation_is_that_of_the_command_line(
    design: ks.Design, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    design.save(tmp_path / "one.kiri")
    told = answer(capsys, "mechanics", tmp_path / "one.kiri", "--width-mm", 80, "--material", "film-uv", "--json")
    found = design.simulate(width_mm=80, material="film-uv")
    assert np.degrees(found.phi) == pytest.approx(told["phi_deg"])
    assert found.force_n == pytest.approx(told["force_n"]) and found.energy_mj == pytest.approx(told["energy_mj"])
    assert found.stretch == pytest.approx(told["max_stretch_widths"])
    assert math.degrees(found.jam_phi or 0.0) == pytest.approx(told["jam_deg"] or 0.0)
    assert found.iou == pytest.approx(told["iou_as_cut"]) and found.closes is (found.jam_phi is None)


def test_that_a_led_simulation_is_that_of_the_command_line(
    design: ks.Design, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    design.save(tmp_path / "one.kiri")
    told = answer(capsys, "mechanics", tmp_path / "one.kiri", "--width-mm", 80, "--material", "film-uv", "--hold", 0,
                  "--move", 24, 29, "--end-deg", 120, "--steps", 5, "--young-gpa", 3, "--json")  # fmt: skip
    found = design.simulate(width_mm=80, material="film-uv", hold=[0], move=np.array([24, 29]),
                            end=math.radians(120), steps=5, young_gpa=3)  # fmt: skip
    assert np.degrees(found.phi) == pytest.approx(told["phi_deg"]) and len(found.phi) == 5
    assert found.displacement_mm == pytest.approx(told["displacement"]) and told["displacement_unit"] == "mm"
    assert found.force_n == pytest.approx(told["force_n"]) and found.energy_mj == pytest.approx(told["energy_mj"])
    assert np.isnan(found.torque_nmm).all()
    assert (
        found.jam_deg == pytest.approx(told["jam_deg"]) and found.as_cut.source.value == told["jam_from"] == "estimate"
    )


def test_that_grips_that_make_no_sense_are_refused(cuts: ks.Cuts) -> None:
    for options, code in (
        ({"hold": [0]}, "mechanics.hold_and_move"),
        ({"hold": "0", "move": [1]}, "api.not_panels"),
        ({"hold": [0], "move": [999]}, "drive.unknown_panel"),
        ({"end": math.pi}, "mechanics.end_angle"),
        ({"end": 5.0}, "angle.out_of_range"),
        ({"steps": 2}, "drive.too_few_steps"),
        ({"steps": 2.5}, "api.not_whole"),
        ({"young_gpa": float("nan")}, "api.not_a_number"),
    ):
        with pytest.raises(ks.KirigamiError) as refused:
            cuts.simulate(**options)  # type: ignore[arg-type]
        assert refused.value.code == code


def test_that_cut_paths_are_those_of_the_file_in_millimetres(cuts: ks.Cuts, tmp_path: Path) -> None:
    paths = cuts.paths_mm()
    assert {"SLITS", "OUTLINE"} <= set(paths)
    (outline,) = paths["OUTLINE"]
    assert np.array_equal(outline[0], outline[-1]) and np.ptp(outline, axis=0) == pytest.approx(cuts.size_mm, abs=0.5)
    lengths = sum(np.linalg.norm(np.diff(path, axis=0), axis=1).sum() for layer in paths.values() for path in layer)
    assert lengths == pytest.approx(cuts.cut_length_mm, rel=1e-3)
    read = ks.check(cuts.export(tmp_path / "cut.dxf").path).report
    assert set(paths) <= set(read.layers) and sum(map(len, paths.values())) == read.path_count


def test_that_a_shared_page_is_that_of_an_export(design: ks.Design, cuts: ks.Cuts, tmp_path: Path) -> None:
    page = tmp_path / "mine.html"
    shared = ks.share(design, page, material="film-uv", width_mm=80).path.read_bytes()
    assert shared == cuts.export(page).path.read_bytes()
    with pytest.raises(ks.KirigamiError) as refused:
        ks.share(design, tmp_path / "mine.svg")
    assert refused.value.code == "api.not_a_page_name" and not (tmp_path / "mine.svg").exists()


def test_that_a_simulated_sheet_has_panels_on_its_way(cuts: ks.Cuts) -> None:
    motion = cuts.simulate()
    assert motion is cuts.simulate()
    closed, open_ = motion.panels(), motion.panels(math.pi / 2)
    assert len(closed) == len(open_) == 30
    assert np.ptp(np.concatenate(open_), axis=0).prod() > 1.3 * np.ptp(np.concatenate(closed), axis=0).prod()


def test_that_a_picture_shows_the_angle_that_is_asked_for_as_cut_or_ideal(cuts: ks.Cuts, tmp_path: Path) -> None:
    ways: list[dict[str, Any]] = [{}, {"phi": math.pi / 2}, {"as_cut": True}, {"phi": math.pi / 2, "as_cut": True}]
    written = set()
    for number, way in enumerate(ways):
        cuts.export(tmp_path / f"{number}.png", **way)
        written.add((tmp_path / f"{number}.png").read_bytes())
    assert len(written) == 4


def test_that_a_file_is_checked_alone_and_beside_its_design(cuts: ks.Cuts, design: ks.Design, tmp_path: Path) -> None:
    alone = design.plan_cuts()
    path = alone.export(tmp_path / "cut.dxf").path
    assert ks.check(path).ok and ks.check(path).verification is None
    beside = ks.check(path, design)
    assert beside.verification is not None and beside.verification.ok
    assert beside.verdict is not None and beside.ok is beside.verdict.ok
    assert ks.check(path).sound and repr(ks.check(path)) == "<CheckedFile cut.dxf: sound>"
    other = ks.check(cuts.export(tmp_path / "other.dxf").path, design)
    assert other.verification is not None and other.verification.ok and other.verdict is not None
    assert other.said is other.verdict.level
    assert repr(other).startswith(f"<CheckedFile other.dxf: sound, {other.verdict.level.words}")


def test_that_a_sheet_that_would_fall_apart_is_written_with_the_verdict_that_it_will_not_work(
    design: ks.Design, tmp_path: Path
) -> None:
    apart = design.plan_cuts(removed=range(20))
    assert not apart.report.ok and "cannot be cut" in repr(apart)
    assert not apart.verdict.ok and "Will not work" in apart._repr_html_()
    exported = apart.export(tmp_path / "cut.dxf", record=True)
    assert exported.path.is_file() and not exported.ok and exported.verdict is not None
    assert exported.verdict.level.value == "will_not_work"
    assert json.loads((tmp_path / "cut.json").read_text())["verdict"]["level"] == "will_not_work"
