"""Random designs through every profile: what any reader of the file must find, and both DXF versions alike."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import shapely
from shapely.geometry import LineString

from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.profile import PROFILES, find_profile
from kirigami_studio.export.registry import export
from kirigami_studio.export.verification import verify_export
from kirigami_studio.fabricate.cut_plan import CutPlan, plan_cuts
from kirigami_studio.fabricate.material import presets
from kirigami_studio.lattice.deployment import Deployment

MakeDesign = Callable[..., Deployment]
DESIGNS = 40
#: What R12 allows in names.
R12_LETTERS = set("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-$")
MATERIALS = [material for material in presets().values() if material.kerf_mm > 0.0]


def random_job(seed: int, make_design: MakeDesign) -> ExportJob:
    """A design of 2 x 2 to 4 x 4 voids in some material and size."""
    random = np.random.default_rng(seed)
    rows, columns = int(random.integers(2, 5)), int(random.integers(2, 5))
    design = make_design(rows, columns, seed=seed, spread=float(random.uniform(0.1, 0.5)))
    material = MATERIALS[seed % len(MATERIALS)]
    return ExportJob(design, plan=plan_cuts(design, float(random.uniform(150.0, 300.0)), material=material))


def entities(path: Path) -> list[ezdxf.entities.DXFEntity]:
    parts = sorted(path.iterdir()) if path.is_dir() else [path]
    return [entity for part in parts for entity in ezdxf.readfile(part).modelspace()]


def points_of(entity: ezdxf.entities.DXFEntity) -> np.ndarray:
    if entity.dxftype() == "LWPOLYLINE":
        return np.array(entity.get_points("xyb"))
    return np.array([(v.dxf.location.x, v.dxf.location.y, v.dxf.bulge) for v in entity.vertices])


def check_centre_lines(path: Path, plan: CutPlan, profile: str) -> None:
    """What fabrication.md asks of every file of beam centre lines; layer files have marks 2 mm around the sheet."""
    drawn = entities(path)
    found = [entity for entity in drawn if entity.dxf.layer != "REGISTRATION"]
    assert len(drawn) - len(found) == (3 * len(plan.layers) if path.is_dir() else 0)
    assert len(found) == len(plan.paths)
    chosen = find_profile(profile)
    assert [entity.dxf.layer for entity in found] == [chosen.layer_name(cut.layer) for cut in plan.paths]
    assert [entity.dxf.color for entity in found] == [chosen.colour[cut.layer] for cut in plan.paths]
    assert [entity.is_closed for entity in found] == [cut.closed for cut in plan.paths]
    tables = [points_of(entity) - ([2.0, 2.0, 0.0] if path.is_dir() else 0.0) for entity in found]
    everything = np.concatenate(tables).round(9)
    assert np.all(np.isfinite(everything)) and everything[:, :2].min() >= 0.0
    np.testing.assert_allclose(everything[:, :2].max(axis=0), plan.bounds_mm, atol=1e-4)
    lines = [
        LineString(np.vstack([table[:, :2], table[:1, :2]]) if entity.is_closed else table[:, :2])
        for table, entity in zip(tables, found, strict=True)
    ]
    assert sum(line.length for line in lines) == pytest.approx(plan.cut_length_mm, rel=1e-9)
    one, other = shapely.STRtree(lines).query(lines, predicate="intersects")
    meeting = {(a, b) for a, b in zip(one.tolist(), other.tolist(), strict=True) if a < b}
    assert {plan.paths[a].layer.value for a, _ in meeting} <= {"EDGE_SLITS"}
    assert {plan.paths[b].layer.value for _, b in meeting} <= {"OUTLINE"}


def check_closed_contours(path: Path) -> None:
    """What a cutting service asks: closed, disjoint contours, the outline last and around all others."""
    found = entities(path)
    assert all(entity.is_closed for entity in found)
    rings = [shapely.Polygon(points_of(entity)[:, :2]) for entity in found]
    assert all(ring.is_valid for ring in rings)
    *holes, outline = rings
    assert all(hole.within(outline) for hole in holes)
    one, other = shapely.STRtree(holes).query(holes, predicate="intersects")
    assert np.array_equal(np.sort(one), np.arange(len(holes))) and np.array_equal(one, other)
    assert found[-1].dxf.layer == "OUTLINE" and {entity.dxf.layer for entity in found[:-1]} == {"SLOTS"}


@pytest.mark.parametrize("seed", range(DESIGNS))
def test_that_every_profile_passes_for_random_designs(seed: int, make_design: MakeDesign, tmp_path: Path) -> None:
    made = random_job(seed, make_design)
    plan = made.required_plan
    for profile in PROFILES:
        path = export(replace(made, profile=profile), tmp_path / f"{profile}.dxf")
        report = verify_export(plan, path, profile)
        assert report.ok, (profile, [finding.text for finding in report.findings if not finding.ok])
        assert report.pieces == 1
        if profile == "slots":
            check_closed_contours(path)
        else:
            check_centre_lines(path, plan, profile)


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("seed", range(3))
def test_that_r12_has_the_geometry_of_r2010_and_no_unit(
    seed: int, profile: str, make_design: MakeDesign, tmp_path: Path
) -> None:
    made = replace(random_job(seed, make_design), profile=profile)
    new = entities(export(made, tmp_path / "new.dxf"))
    path = export(replace(made, dxf_version="R12"), tmp_path / "old.dxf")
    old = entities(path)
    assert {entity.dxftype() for entity in old} == {"POLYLINE"}
    for one, other in zip(new, old, strict=True):
        np.testing.assert_allclose(points_of(one), points_of(other), rtol=0.0, atol=1e-9)
        assert (one.dxf.layer, one.dxf.color, one.is_closed) == (other.dxf.layer, other.dxf.color, other.is_closed)
    for part in sorted(path.iterdir()) if path.is_dir() else [path]:
        assert b"$INSUNITS" not in part.read_bytes()
        for layer in ezdxf.readfile(part).layers:
            name = layer.dxf.name
            assert name == "Defpoints" or (len(name) <= 31 and set(name) <= R12_LETTERS)
            assert not any(word in name for word in ("CUT", "ENGRAVE"))
    report = verify_export(made.required_plan, path, profile, "R12")
    assert any(warning.code == "verify.no_unit_in_r12" for warning in report.warnings)
    assert any(finding.warning and "import it as mm" in finding.text for finding in report.findings)
