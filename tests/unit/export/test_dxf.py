"""Written DXF files, read back by ezdxf."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from shapely import union_all
from shapely.geometry import LineString

import kirigami_studio.export.dxf as dxf_module
from kirigami_studio import __version__
from kirigami_studio.export.dxf import dxf_bytes, write_dxf
from kirigami_studio.export.profile import find_profile
from kirigami_studio.fabricate.cut_plan import CutPlan, Layer, plan_cuts
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.lattice.deployment import Deployment
from tests.refusals import refused

MakeDesign = Callable[..., Deployment]
GRIDS = [(4, 5), (10, 10), (24, 24)]


@pytest.fixture(scope="module")
def plan(make_design: MakeDesign) -> CutPlan:
    """A 4 x 5 design at the default size."""
    return plan_cuts(make_design(4, 5, seed=1))


def read_points(path: Path) -> list[np.ndarray]:
    entities = ezdxf.readfile(path).modelspace()
    return [
        np.array(list(entity.vertices()) if entity.dxftype() == "LWPOLYLINE" else [(p.x, p.y) for p in entity.points()])
        for entity in entities
    ]


@pytest.mark.parametrize(("rows", "columns"), GRIDS)
@pytest.mark.parametrize(("version", "kind"), [("R2010", "LWPOLYLINE"), ("R12", "POLYLINE")])
def test_that_the_file_holds_one_polyline_for_each_cut_in_cutting_order(
    rows: int, columns: int, version: str, kind: str, make_design: MakeDesign, tmp_path: Path
) -> None:
    plan = plan_cuts(make_design(rows, columns, seed=2))
    write_dxf(plan, tmp_path / "cut.dxf", version)
    document = ezdxf.readfile(tmp_path / "cut.dxf")
    assert document.acad_release == version
    entities = list(document.modelspace())
    assert {entity.dxftype() for entity in entities} == {kind}
    assert [entity.dxf.layer for entity in entities] == [path.layer.value for path in plan.paths]
    assert [entity.is_closed for entity in entities] == [False] * (len(entities) - 1) + [True]
    for points, path in zip(read_points(tmp_path / "cut.dxf"), plan.paths, strict=True):
        np.testing.assert_array_equal(points, path.points)


@pytest.mark.parametrize(("rows", "columns"), GRIDS)
def test_that_nothing_in_the_file_is_cut_twice(
    rows: int, columns: int, make_design: MakeDesign, tmp_path: Path
) -> None:
    plan = plan_cuts(make_design(rows, columns, seed=3))
    write_dxf(plan, tmp_path / "cut.dxf")
    loops = [points if index < len(plan.paths) - 1 else np.vstack([points, points[:1]])
             for index, points in enumerate(read_points(tmp_path / "cut.dxf"))]  # fmt: skip
    lines = [LineString(points) for points in loops]
    total = sum(line.length for line in lines)
    assert total == pytest.approx(plan.cut_length_mm, abs=1e-9)
    assert total - union_all(lines).length == pytest.approx(0.0, abs=1e-9)


def test_that_the_header_says_millimetres_and_the_true_extents(plan: CutPlan, tmp_path: Path) -> None:
    write_dxf(plan, tmp_path / "cut.dxf")
    header = ezdxf.readfile(tmp_path / "cut.dxf").header
    assert (header["$INSUNITS"], header["$MEASUREMENT"], header["$ACADVER"]) == (4, 1, "AC1024")
    assert tuple(header["$EXTMIN"]) == (0.0, 0.0, 0.0)
    assert tuple(header["$EXTMAX"])[:2] == plan.bounds_mm
    assert plan.bounds_mm[0] == pytest.approx(100.0 + 0.02 + 2 * 0.2)


@pytest.mark.parametrize("version", ["R2010", "R12"])
def test_that_only_our_layers_exist_and_no_name_is_a_trap(plan: CutPlan, version: str, tmp_path: Path) -> None:
    write_dxf(plan, tmp_path / "cut.dxf", version)
    names = {layer.dxf.name for layer in ezdxf.readfile(tmp_path / "cut.dxf").layers}
    assert names - {"0", "Defpoints"} == {"SLITS", "EDGE_SLITS", "OUTLINE"}
    assert not [name for name in names if "CUT" in name or "ENGRAVE" in name]


@pytest.mark.parametrize(("profile", "expected"), [("any", {1}), ("lightburn", {1, 3, 5})])
def test_that_layer_and_entities_carry_the_colour_of_the_profile(
    plan: CutPlan, profile: str, expected: set[int], tmp_path: Path
) -> None:
    write_dxf(plan, tmp_path / "cut.dxf", profile=profile)
    document = ezdxf.readfile(tmp_path / "cut.dxf")
    for entity in document.modelspace():
        assert entity.dxf.color == document.layers.get(entity.dxf.layer).dxf.color
    assert {entity.dxf.color for entity in document.modelspace()} == expected


def test_that_the_file_says_how_it_was_made(plan: CutPlan, tmp_path: Path) -> None:
    write_dxf(plan, tmp_path / "cut.dxf")
    facts = dict(ezdxf.readfile(tmp_path / "cut.dxf").header.custom_vars)
    assert facts["KIRIGAMI_STUDIO"] == __version__
    assert (facts["KERF_MM"], facts["CONNECTOR_MM"], facts["DESIGN"]) == ("0.02", "0.2", plan.design_hash)
    write_dxf(plan, tmp_path / "old.dxf", "R12")
    assert ezdxf.readfile(tmp_path / "old.dxf").ezdxf_metadata()["KERF_MM"] == "0.02"


@pytest.mark.parametrize("version", ["R2010", "R12"])
def test_that_the_same_plan_gives_the_same_bytes(version: str, plan: CutPlan) -> None:
    assert dxf_bytes(plan, version, find_profile("any")) == dxf_bytes(plan, version, find_profile("any"))
    assert ezdxf.options.write_fixed_meta_data_for_testing is False


def test_that_writing_r12_logs_nothing(plan: CutPlan, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    write_dxf(plan, tmp_path / "cut.dxf", "R12")
    assert caplog.records == []


def test_that_an_unknown_version_or_profile_is_refused_and_nothing_is_written(plan: CutPlan, tmp_path: Path) -> None:
    with refused(ExportError, "dxf.unknown_version", version="R9"):
        write_dxf(plan, tmp_path / "cut.dxf", "R9")
    with refused(ExportError, "profile.unknown", name="axe"):
        write_dxf(plan, tmp_path / "cut.dxf", profile="axe")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("found", "meant", "expected"),
    [
        (b"SLITS", b"SLOTS", "its layers are"),
        (b"$INSUNITS\r\n 70\r\n4", b"$INSUNITS\r\n 70\r\n6", "its unit is 6"),
        (b"LWPOLYLINE", b"XLINE", "DXF"),
        (b"EOF", b"", "DXF"),
    ],
)
def test_that_a_file_that_differs_from_the_plan_is_refused_and_the_old_one_kept(
    found: bytes, meant: bytes, expected: str, plan: CutPlan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    goal = tmp_path / "cut.dxf"
    goal.write_bytes(b"the old file")
    good = dxf_bytes(plan, "R2010", find_profile("any")).replace(b"\r\n", b"\n")
    bad = good.replace(found.replace(b"\r\n", b"\n"), meant.replace(b"\r\n", b"\n"))
    assert bad != good
    monkeypatch.setattr(dxf_module, "dxf_bytes", lambda *_: bad)
    with pytest.raises(ExportError, match=expected):
        write_dxf(plan, goal)
    assert goal.read_bytes() == b"the old file"
    assert list(tmp_path.iterdir()) == [goal]


def test_that_a_coordinate_that_moved_by_a_micrometre_is_noticed(
    plan: CutPlan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    good = dxf_bytes(plan, "R2010", find_profile("any"))
    x = f"{plan.on_layer(Layer.SLITS)[3].points[0, 0]}".encode()
    moved = f"{plan.on_layer(Layer.SLITS)[3].points[0, 0] + 0.001:.4f}".encode()
    assert x in good
    monkeypatch.setattr(dxf_module, "dxf_bytes", lambda *_: good.replace(x, moved))
    with refused(ExportError, "dxf.entity_moved"):
        write_dxf(plan, tmp_path / "cut.dxf")
    assert list(tmp_path.iterdir()) == []
