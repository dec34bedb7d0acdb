"""Trimming: what stays of each panel, the trimmed score, and what is refused."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
import shapely
from shapely.geometry import Point, Polygon
from trimmed_panels import compact_parts, deployed_parts
from uneven_sheets import uneven_sheet

from kirigami_studio.evaluate.alignment import align
from kirigami_studio.evaluate.kept_panels import edge_panels
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.trimming import KEEP, Trim, trim
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import AngleError, UsageError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from tests.refusals import refused

GRID = 1e-9

#: Makes a design from rows, columns and a seed.
Made = Callable[[int, int, int], Deployment]


def design(rows: int, columns: int, seed: int) -> Deployment:
    """A random feasible sheet."""
    z = np.random.default_rng(seed).uniform(-0.4, 0.4, (rows, columns))
    return deploy(RatioField.from_log10(z))


def uneven(rows: int, columns: int, seed: int) -> Deployment:
    """A random feasible sheet with an uneven rim; for odd seeds it starts round, for every third with other cells."""
    sheet = uneven_sheet(rows, columns, seed, start=seed % 2 == 1)
    return deploy(Sheet(sheet.field, sheet.rim, sheet.start, (1.0, 1.2) if seed % 3 == 0 else (1.0, 1.0)))


def circle() -> Outline:
    angle = 2.0 * np.pi * np.arange(90) / 90
    return Outline.from_points(np.stack([np.cos(angle), np.sin(angle)], axis=1), "circle")


def laid(deployment: Deployment, target: Outline, phi: float, scale: float = 1.05) -> Similarity:
    """A pose that covers most of the target."""
    return Similarity(scale).compose(align(deployment.outline(phi), target.points))


def kept_silhouette(cut: Trim, deployment: Deployment) -> shapely.Geometry:
    """The slow way: every removed part moved to the target angle by a rigid fit of its panel, and taken away."""
    corners = deployment.compact[deployment.topology.panel_nodes.reshape(-1, 4)]
    deployed = deployment.panels(cut.phi).reshape(-1, 4, 2)
    removed = []
    for part, start, end in zip(cut.kept, corners, deployed, strict=True):
        if part is None:
            continue
        rest = Polygon(start).difference(Polygon(part), grid_size=GRID)
        before, after = start - start.mean(axis=0), end - end.mean(axis=0)
        u, _, v = np.linalg.svd(before.T @ after)
        removed.append(shapely.transform(rest, lambda p, r=u @ v, a=start, b=end: (p - a.mean(0)) @ r + b.mean(0)))
    return Polygon(deployment.outline(cut.phi)).difference(shapely.union_all(removed), grid_size=GRID)


@pytest.mark.parametrize("made", [design, uneven])
@pytest.mark.parametrize(("phi", "seed"), [(0.0, 1), (0.0, 2), (0.6, 3), (1.4, 4)])
def test_that_the_trimmed_iou_is_that_of_the_silhouette_less_what_was_cut_off(
    made: Made, phi: float, seed: int
) -> None:
    deployment, target = made(6, 7, seed), circle()
    pose = laid(deployment, target, phi)
    cut = trim(deployment, target, phi, pose)
    silhouette = shapely.transform(kept_silhouette(cut, deployment), pose.apply)
    common = silhouette.intersection(target.polygon).area
    assert cut.iou == pytest.approx(common / (silhouette.area + 1.0 - common), abs=1e-6)
    assert cut.iou > cut.untrimmed_iou
    kept = sum(Polygon(part).area for part in compact_parts(cut, deployment))
    flat = Polygon(deployment.outline(math.pi)).area
    assert cut.removed_share == pytest.approx(1.0 - kept / flat, abs=1e-6)


def test_that_parts_move_with_their_panels(letter_l: FloatArray) -> None:
    deployment, target = design(6, 6, 5), Outline.from_points(letter_l)
    cut = trim(deployment, target, 0.0, laid(deployment, target, 0.0))
    moved = PosedDesign(deployment, Similarity(), 0.8, cut).kept(deployment.nodes(0.8), 0.8)
    panels = deployment.panels(0.8).reshape(-1, 4, 2)
    assert sorted(moved) == [row for row, part in enumerate(cut.kept) if part is not None]
    for row, after in moved.items():
        before = cut.kept[row]
        assert before is not None
        lengths = [np.linalg.norm(np.diff(points, axis=0), axis=1) for points in (before, after)]
        np.testing.assert_allclose(*lengths, atol=1e-9)
        assert Polygon(after).difference(Polygon(panels[row]).buffer(1e-8)).area == 0.0
        np.testing.assert_allclose(after, deployed_parts(cut, deployment, 0.8)[row], atol=1e-12)


@pytest.mark.parametrize("made", [design, uneven])
@pytest.mark.parametrize("keep", [0.05, 0.15, 0.3])
@pytest.mark.parametrize("seed", range(6))
def test_that_every_hinge_keeps_its_material_and_every_panel_stays_one_piece(
    made: Made, seed: int, keep: float
) -> None:
    rows, columns = 4 + seed, 9 - seed
    deployment, target = made(rows, columns, seed), circle()
    cut = trim(deployment, target, 0.0, laid(deployment, target, 0.0, 1.35), keep)
    edge = edge_panels(rows, columns)
    assert sum(part is not None for part in cut.kept) > len(edge.index) // 2
    for index, corners, hinged in zip(edge.index, deployment.compact[edge.corners], edge.hinged, strict=True):
        part = cut.kept[index]
        if part is None:
            continue
        kept, panel = Polygon(part), Polygon(corners)
        assert kept.is_valid
        assert kept.difference(panel.buffer(1e-7)).area == 0.0
        for hinge in corners[hinged]:
            around = Point(hinge).buffer(0.99 * keep).intersection(panel)
            assert around.difference(kept.buffer(1e-7)).area == 0.0
        # No neck is narrower than 0.6 keep: shrunk by a little less than half of that it still is one piece.
        assert kept.buffer(-0.29 * keep, join_style="mitre").geom_type == "Polygon"


def test_that_panels_inside_the_sheet_are_never_cut() -> None:
    deployment, target = design(6, 6, 7), circle()
    cut = trim(deployment, target, 0.0, laid(deployment, target, 0.0, 2.0))
    inside = np.delete(np.arange(len(cut.kept)), edge_panels(6, 6).index)
    assert all(cut.kept[index] is None for index in inside)


@pytest.mark.parametrize("made", [design, uneven])
@pytest.mark.parametrize("seed", range(4))
def test_that_the_trimmed_compact_sheet_is_one_area_without_holes(made: Made, seed: int) -> None:
    deployment, target = made(7, 6, seed), circle()
    cut = trim(deployment, target, 0.0, laid(deployment, target, 0.0, 1.2))
    sheet = shapely.union_all([Polygon(part) for part in compact_parts(cut, deployment)], grid_size=1e-8)
    assert sheet.geom_type == "Polygon"
    assert not [ring for ring in sheet.interiors if Polygon(ring).area > 1e-6]


def test_that_nothing_is_cut_off_a_sheet_within_the_target() -> None:
    deployment, target = design(5, 5, 3), circle()
    cut = trim(deployment, target, 0.0, laid(deployment, target, 0.0, 0.5))
    assert all(part is None for part in cut.kept)
    assert cut.iou == cut.untrimmed_iou
    assert cut.removed_share == 0.0


def test_that_the_same_request_gives_the_same_trim() -> None:
    deployment, target = design(5, 6, 8), circle()
    pose = laid(deployment, target, 0.0)
    one, two = (trim(deployment, target, 0.0, pose) for _ in range(2))
    assert one.iou == two.iou
    for a, b in zip(one.kept, two.kept, strict=True):
        assert (a is None and b is None) or np.array_equal(a, b)  # type: ignore[arg-type]


@pytest.mark.parametrize("keep", [0.0, 0.01, 0.5, math.nan, "deep"])
def test_that_an_impossible_depth_is_refused(keep: float) -> None:
    with refused(UsageError, "trim.keep_out_of_range", least=0.02, most=0.4) as caught:
        trim(design(4, 4, 0), circle(), 0.0, Similarity(), keep)
    assert caught.value.code == "trim.keep_out_of_range"


def test_that_an_impossible_angle_is_refused() -> None:
    with pytest.raises(AngleError):
        trim(design(4, 4, 0), circle(), 4.0, Similarity(), KEEP)
