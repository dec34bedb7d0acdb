"""Trimmed sheets as files: read back with ezdxf, the outline alone rebuilds the trimmed silhouette."""

from __future__ import annotations

import math
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import shapely
from shapely.geometry import LineString, Polygon

from kirigami_studio.evaluate.alignment import align
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.trimming import Trim, trim
from kirigami_studio.export.dxf import write_dxf
from kirigami_studio.export.dxf_check import check_file
from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.cut_plan import CutPlan, plan_cuts
from kirigami_studio.fabricate.finished_sheet import overlap_length
from kirigami_studio.fabricate.material import find_material, presets
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.fabricate.trimmed_sheet import needed_keep
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline

WIDTH_MM = 200.0
MATERIALS = list(presets())


def heart() -> Outline:
    t = 2.0 * np.pi * np.arange(80) / 80
    x = 16.0 * np.sin(t) ** 3
    y = 13.0 * np.cos(t) - 5.0 * np.cos(2.0 * t) - 2.0 * np.cos(3.0 * t) - np.cos(4.0 * t)
    return Outline.from_points(np.stack([x, y], axis=1), "heart")


def star() -> Outline:
    t = 2.0 * np.pi * np.arange(10) / 10
    radius = np.where(np.arange(10) % 2 == 0, 1.0, 0.5)
    return Outline.from_points(np.stack([radius * np.sin(t), radius * np.cos(t)], axis=1), "star")


def letter() -> Outline:
    return Outline.from_points([(0, 0), (3, 0), (3, 1), (1, 1), (1, 5), (0, 5)], "L")


SHAPES = {"heart": heart(), "star": star(), "L": letter()}


def rebuilt_iou(path: Path, plan: CutPlan, cut: Trim, deployment: Deployment, target: Outline) -> float:
    """IoU of the silhouette that the file's outline alone gives, panel by panel, with the target."""
    outlines = [e for e in ezdxf.readfile(path).modelspace() if e.dxf.layer == "OUTLINE"]
    assert len(outlines) == 1
    assert outlines[0].closed
    ring = Polygon([(x, y) for x, y in outlines[0].vertices()])
    assert ring.is_valid
    table = cut_table(deployment.field.rows, deployment.field.columns)
    low = deployment.compact.min(axis=0)
    scale = plan.size_mm[0] / float(np.ptp(deployment.compact[:, 0]))
    at = (plan.hinges.position - (deployment.compact[table.hinge_node] - low) * scale).mean(axis=0)
    finished = ring.buffer(-0.5 * plan.kerf_mm, join_style="mitre", mitre_limit=5.0)
    sheet = shapely.transform(finished, lambda points: (points - at) / scale + low)
    corners = deployment.compact[deployment.topology.panel_nodes.reshape(-1, 4)]
    deployed = deployment.panels(cut.phi).reshape(-1, 4, 2)
    removed = []
    for start, end in zip(corners, deployed, strict=True):
        along, turned = start[2] - start[0], end[2] - end[0]
        angle = math.atan2(turned[1], turned[0]) - math.atan2(along[1], along[0])
        rest = Polygon(start).difference(sheet)
        spun = shapely.affinity.rotate(rest, angle, origin=tuple(start[0]), use_radians=True)
        removed.append(shapely.affinity.translate(spun, *(end[0] - start[0])))
    silhouette = Polygon(deployment.outline(cut.phi)).difference(shapely.union_all(removed, grid_size=1e-9))
    laid = shapely.transform(silhouette, cut.pose.apply)
    common = laid.intersection(target.polygon).area
    return float(common / (laid.area + 1.0 - common))


def check(deployment: Deployment, target: Outline, phi: float, material: str, keep: float, folder: Path) -> None:
    pose = Similarity(1.04).compose(align(deployment.outline(phi), target.points))
    preset = find_material(material)
    keep = max(keep, needed_keep(deployment, WIDTH_MM, preset.connector_mm, preset.kerf_mm))
    cut = trim(deployment, target, phi, pose, keep)
    plan = plan_cuts(deployment, WIDTH_MM, material=preset, kept=cut.kept)
    report = check_plan(plan)
    assert report.ok, [problem.text for problem in report.problems]
    assert report.pieces == 1
    assert report.min_connector_mm >= plan.connector_mm - 1e-3
    path = folder / "trimmed.dxf"
    write_dxf(plan, path)
    found = check_file(path)
    assert found.ok, [problem.text for problem in found.problems]
    assert found.pieces == 1
    assert overlap_length([LineString(path.travelled) for path in plan.paths]) < 1e-9
    assert rebuilt_iou(path, plan, cut, deployment, target) == pytest.approx(cut.iou, abs=2e-3)


@pytest.mark.parametrize("keep", [0.08, 0.15, 0.25])
@pytest.mark.parametrize("name", sorted(SHAPES))
def test_that_trimmed_shapes_are_sound_as_files(name: str, keep: float, tmp_path: Path) -> None:
    z = np.random.default_rng(len(name)).uniform(-0.2, 0.2, (6, 6))
    check(deploy(RatioField.from_log10(z)), SHAPES[name], 0.0, "film-uv", keep, tmp_path)


@pytest.mark.parametrize("seed", range(30))
def test_that_random_trims_are_sound_as_files(seed: int, tmp_path: Path) -> None:
    random = np.random.default_rng(seed)
    rows, columns = random.integers(3, 9, 2)
    deployment = deploy(RatioField.from_log10(random.uniform(-0.35, 0.35, (rows, columns))))
    target = SHAPES[sorted(SHAPES)[seed % 3]]
    phi, keep = float(random.choice([0.0, 0.0, 0.7])), float(random.choice([0.08, 0.15, 0.25]))
    check(deployment, target, phi, MATERIALS[seed % len(MATERIALS)], keep, tmp_path)
