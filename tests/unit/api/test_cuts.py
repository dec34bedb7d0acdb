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
