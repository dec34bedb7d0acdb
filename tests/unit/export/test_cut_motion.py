"""The animation of a sheet as cut: it lies on the ideal one while flat, stops where it jams, and says so."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from PIL import Image
from shapely.geometry import LineString, Polygon

from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.siou import siou_of_many
from kirigami_studio.export import cut_motion
from kirigami_studio.export.animation import LETTERS, OVERSTRETCHED, animation_frames, write_animation
from kirigami_studio.export.cut_motion import CutMotion
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.picture import INK
from kirigami_studio.fabricate.cut_plan import Layer
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.foundation.steps import result_of
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.mechanics.closing import carried_on, covered_area
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.as_cut import simulate
from kirigami_studio.studio.cutting import plan_sheet

WIDTH = 100.0


@pytest.fixture(scope="module")
def design() -> Deployment:
    return deploy(RatioField.from_log10(np.random.default_rng(0).uniform(-0.5, 0.5, (6, 6))))


def made(design: Deployment, style: ConnectorStyle) -> ExportJob:
    settings = FabricationSettings(WIDTH, connector_mm=0.8, options=CutOptions(style=style))
    plan = plan_sheet(design, settings)
    motion = result_of(simulate(design, plan, WIDTH, 0.0)).motion
    jam = motion.closing.jam_phi()
    motion = replace(motion, jam_phi=jam, reached=jam)
    pose = Similarity(0.1, 0.3, (2.0, 1.0))
    return ExportJob(design, 0.0, None, pose.apply(design.outline(0.0)), pose, motion=motion)


@pytest.fixture(scope="module")
def straight(design: Deployment) -> ExportJob:
    return made(design, ConnectorStyle.STRAIGHT)


@pytest.fixture(scope="module")
def centred(design: Deployment) -> ExportJob:
    return made(design, ConnectorStyle.CENTRED)


def motion_of(job: ExportJob) -> CutMotion:
    assert job.motion is not None
    return job.motion


@pytest.mark.parametrize("style", [ConnectorStyle.CENTRED, ConnectorStyle.ARC, ConnectorStyle.ROUND])
def test_that_the_flat_sheet_as_cut_has_the_very_lines_of_the_cut_file(style: ConnectorStyle) -> None:
    design = deploy(RatioField.from_log10(np.random.default_rng(3).uniform(-0.4, 0.4, (4, 5))))
    plan = plan_sheet(design, FabricationSettings(WIDTH, connector_mm=0.8, options=CutOptions(style=style)))
    motion = result_of(simulate(design, plan, WIDTH, 0.0)).motion
    job = ExportJob(design, 0.0, None, None, Similarity(0.1, 0.3, (2.0, 1.0)), motion=motion)
    pose, posed = motion.pose(job.posed, math.pi), job.posed
    assert len(pose.panels) == 30 and pose.numbers.tolist() == list(range(30))
    np.testing.assert_allclose(pose.stretch, 0.0, atol=1e-12)
    # Back from the target's frame to the plan's.
    back = posed.pose_at(math.pi).inverse()
    made = plan.cut_from(design)
    mm = WIDTH / float(np.ptp(made.compact[:, 0]))
    origin = plan.panels[0][0] - mm * made.compact[made.topology.panel_nodes.reshape(-1, 4)[0, 0]]
    # Most lines are drawn twice, as an edge of either panel.
    drawn = shapely.union_all([LineString(mm * back.apply(line) + origin) for line in pose.cuts], grid_size=1e-6)
    (outline,) = plan.on_layer(Layer.OUTLINE)
    sheet = Polygon(outline.flattened)
    planned = shapely.union_all([LineString(path.travelled) for path in plan.paths]).intersection(sheet.buffer(1e-6))
    assert drawn.difference(planned.buffer(2e-4)).length < 1e-6
    assert planned.difference(drawn.buffer(2e-4)).length < 5e-3
    assert drawn.length == pytest.approx(planned.length, rel=1e-4)
    # All of the sheet belongs to some panel, except what falls out of relief holes.
    area = sum(Polygon(mm * back.apply(panel) + origin).area for panel in pose.panels)
    holes = sum(Polygon(path.flattened).area for path in plan.on_layer(Layer.RELIEF))
    assert area == pytest.approx(sheet.area - holes, rel=1e-5)


def test_that_a_sheet_as_cut_is_moved_by_its_connectors_at_every_angle(centred: ExportJob) -> None:
    motion, posed = motion_of(centred), centred.posed
    mm, flat = posed.mm_per_world(WIDTH), motion_of(centred).pose(posed, math.pi)
    for degrees in (170.0, 120.0, 90.0, 61.3, 30.0, 10.0):
        pose = motion.pose(posed, math.radians(degrees))
        # Panels are rigid, and their edges meet where they did: at both ends of every neck.
        for panel, other in zip(pose.panels, flat.panels, strict=True):
            assert np.ptp(np.abs(np.subtract.outer(panel @ (1, 1j), panel @ (1, 1j)))
                          - np.abs(np.subtract.outer(other @ (1, 1j), other @ (1, 1j)))) < 1e-9  # fmt: skip
        apart = np.linalg.norm(pose.connectors[:, 1] - pose.connectors[:, 0], axis=1)
        assert apart.max() * mm < 0.1


def test_that_the_area_of_the_match_is_kept_and_others_are_found_briefly(
    straight: ExportJob, monkeypatch: pytest.MonkeyPatch
) -> None:
    motion, posed = motion_of(straight), straight.posed
    network = motion.closing.sheet.network
    asked: list[bool] = []

    def counted(*given: object, brief: bool = False) -> Polygon:
        asked.append(brief)
        return covered_area(*given, brief=brief)  # type: ignore[arg-type]

    monkeypatch.setattr(cut_motion, "covered_area", counted)
    here = carried_on(motion.closing, posed.deployment, WIDTH, motion.reached)
    kept = replace(motion, covered=covered_area(posed.deployment, network, WIDTH, here))
    assert kept.area(posed, 0.0).area == pytest.approx(motion.area(posed, 0.0).area, rel=1e-3)
    assert asked == [True]
    kept.area(posed, motion.reached + 0.1)
    assert asked == [True, True]


def test_that_a_sheet_that_jams_is_shown_no_further(straight: ExportJob) -> None:
    motion = motion_of(straight)
    at_jam, beyond = (motion.pose(straight.posed, phi) for phi in (motion.reached, 0.0))
    for panel, other in zip(at_jam.panels, beyond.panels, strict=True):
        np.testing.assert_array_equal(panel, other)


def test_that_a_centred_sheet_ends_near_its_ideal_state_and_a_straight_one_does_not(
    straight: ExportJob, centred: ExportJob
) -> None:
    ideal = centred.posed.parts(0.0)
    # Bows and necks are nearer to the ideal panels than these are off.
    off = [
        max(shapely.hausdorff_distance(Polygon(a), Polygon(b)) for a, b in zip(shown, ideal, strict=True))
        for shown in (motion_of(job).pose(job.posed, 0.0).panels for job in (centred, straight))
    ]
    mm = centred.posed.mm_per_world(WIDTH)
    assert off[0] * mm < 1.2 < 2.0 < off[1] * mm


def test_that_stretch_is_that_of_the_simulation(straight: ExportJob) -> None:
    motion = motion_of(straight)
    step = int(np.sum(motion.closing.phi >= motion.reached)) // 2  # before it jams
    assert step > 3
    pose = motion.pose(straight.posed, float(motion.closing.phi[step]))
    np.testing.assert_allclose(pose.stretch, motion.closing.stretch[step], rtol=1e-6, atol=1e-9)
    apart = np.linalg.norm(pose.connectors[:, 1] - pose.connectors[:, 0], axis=1) * straight.posed.mm_per_world(WIDTH)
    np.testing.assert_allclose(apart, motion.closing.stretch_mm[step], rtol=1e-6, atol=1e-9)


def test_that_the_last_frame_shows_where_the_sheet_jams_and_says_so(straight: ExportJob, tmp_path: Path) -> None:
    motion = motion_of(straight)
    jam = math.degrees(motion.jam_phi)
    assert jam > 10.0 and motion.caption == f"As cut: jams at {jam:.0f} degrees"
    write_animation(straight, tmp_path / "jams.gif", frames=4, longest=240)
    with Image.open(tmp_path / "jams.gif") as image:
        assert image.info["comment"].decode() == f"MOTION {motion.caption}"
        image.seek(3)
        last = np.asarray(image.convert("RGB")).astype(int)
    corner = last[-LETTERS:, :90].reshape(-1, 3)
    assert np.any(np.abs(corner - INK).max(axis=1) < 60)
    # The same angle in the ideal motion: no caption, other panels.
    reached = straight.posed.pose_at(motion.reached)
    job = replace(straight, phi=motion.reached, transform=reached, motion=None)
    ideal = animation_frames(job, 4, 240)[-1].convert("RGB")
    other = np.asarray(ideal).astype(int)
    assert not np.any(np.abs(other[-LETTERS:, :90].reshape(-1, 3) - INK).max(axis=1) < 60)
    assert np.mean(np.abs(last[: -2 * LETTERS] - other[: -2 * LETTERS]).max(axis=2) > 60) > 0.02


def test_that_connectors_which_stop_the_sheet_are_red(straight: ExportJob) -> None:
    def red(job: ExportJob) -> int:
        pixels = np.asarray(animation_frames(job, 2, 900)[-1].convert("RGB")).reshape(-1, 3).astype(int)
        return int(np.sum(np.abs(pixels - OVERSTRETCHED).max(axis=1) < 60))

    motion = motion_of(straight)
    early = replace(straight, motion=replace(motion, reached=0.5 * (math.pi + motion.jam_phi)))
    assert red(early) == 0 < red(straight)


def test_that_a_sheet_which_closes_has_a_caption_without_a_jam(centred: ExportJob) -> None:
    closes = replace(motion_of(centred), jam_phi=0.0, reached=0.0)
    assert closes.caption == "As cut" and not closes.jams


def test_that_the_motion_is_that_of_the_sheet_that_is_cut_to_its_end(design: Deployment, centred: ExportJob) -> None:
    motion, posed = motion_of(centred), centred.posed
    assert motion.made is posed.deployment is not design and centred.target is not None
    last = float(motion.closing.phi.min())
    assert 0.0 < last < 0.05
    # Beyond the last step the panels go on as those that are cut do: by what these move, none by more.
    free = replace(motion, jam_phi=0.0, reached=0.0)
    before, after = (free.pose(posed, phi).connectors.mean(axis=1) for phi in (last, 0.0))
    node = cut_table(*posed.deployment.sheet.grid).hinge_node
    ideal = posed.nodes(0.0)[node] - posed.nodes(last)[node]
    np.testing.assert_allclose(after - before, ideal, atol=0.02 / posed.mm_per_world(WIDTH))
    (score,) = siou_of_many([posed.outline(posed.nodes(0.0), 0.0)], Outline.from_points(centred.target))
    assert score.iou_exact > 0.99
