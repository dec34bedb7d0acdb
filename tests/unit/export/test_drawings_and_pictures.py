"""SVG, PDF, PNG and GIF: true size, right content, same bytes."""

from __future__ import annotations

import io
import math
import re
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image
from svgelements import SVG
from svgelements import Path as SvgPath

from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.export import picture
from kirigami_studio.export.animation import frame_angles, write_animation
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.pdf import write_pdf
from kirigami_studio.export.picture import png_of_bands, preview, write_png
from kirigami_studio.export.profile import find_profile
from kirigami_studio.export.svg import write_cut_svg, write_layout_svg
from kirigami_studio.fabricate.cut_plan import Layer, plan_cuts
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.lattice.deployment import Deployment, signed_area
from tests.refusals import refused

MakeDesign = Callable[..., Deployment]
SVG_NS = "{http://www.w3.org/2000/svg}"
PX_PER_MM = 96.0 / 25.4


@pytest.fixture(scope="module")
def job(make_design: MakeDesign) -> ExportJob:
    """A 4 x 5 design whose target is its own outline, turned, scaled and shifted."""
    design = make_design(4, 5, seed=1, spread=0.3)
    transform = Similarity(0.2, 0.5, (1.0, -2.0))
    matrix = transform.matrix
    target = design.outline(0.0) @ matrix[:, :2].T + matrix[:, 2]
    return ExportJob(design, 0.0, plan_cuts(design), target, transform)


def test_that_the_cut_svg_is_true_to_size_for_another_reader(job: ExportJob, tmp_path: Path) -> None:
    plan = job.required_plan
    write_cut_svg(plan, tmp_path / "cut.svg", find_profile("lightburn"))
    read = [element for element in SVG.parse(tmp_path / "cut.svg").elements() if isinstance(element, SvgPath)]
    assert len(read) == len(plan.paths)
    width, height = plan.bounds_mm
    for element, path in zip(read, plan.paths, strict=True):
        points = np.array([(point.x, point.y) for point in element.as_points()])
        points = np.array(
            [point for index, point in enumerate(points) if index == 0 or any(point != points[index - 1])]
        )
        expected = np.stack([path.travelled[:, 0], height - path.travelled[:, 1]], axis=1) * PX_PER_MM
        np.testing.assert_allclose(points, expected, atol=2e-3)
    root = ElementTree.parse(tmp_path / "cut.svg").getroot()
    assert root.get("width") == f"{width:g}mm"
    assert [group.get("id") for group in root.iter(f"{SVG_NS}g")] == [layer.value for layer in plan.layers]
    colours = [{path.get("stroke") for path in group} for group in root.iter(f"{SVG_NS}g")]
    assert colours == [{"#ff0000"}, {"#00ff00"}, {"#0000ff"}]
    # MeerK40t burns a path twice that inherits its stroke.
    assert all(group.get("stroke") is None for group in root.iter(f"{SVG_NS}g"))
    assert {path.get("fill") for path in root.iter(f"{SVG_NS}path")} == {"none"}


def test_that_the_layout_svg_shows_all_panels_voids_and_the_target_in_mm(job: ExportJob, tmp_path: Path) -> None:
    write_layout_svg(job, tmp_path / "layout.svg", width_mm=60.0)
    root = ElementTree.parse(tmp_path / "layout.svg").getroot()
    counts = {group.get("id"): len(group) for group in root.iter(f"{SVG_NS}g")}
    assert counts == {"TARGET_AREA": 1, "VOIDS": 20, "PANELS": 30, "EDGES": 30, "TARGET": 1}
    data = root.find(f".//{SVG_NS}g[@id='TARGET_AREA']/{SVG_NS}path")
    assert data is not None
    loop = np.array([float(number) for number in re.findall(r"-?[\d.]+", str(data.get("d")))]).reshape(-1, 2)
    # The sheet of 6 x 5 cells is 60 mm wide: 100 mm^2 for each unit of area; y is turned over.
    assert -signed_area(loop) == pytest.approx(100.0 * job.deployment.area(0.0), rel=1e-4)


def test_that_the_layout_svg_has_nothing_to_cut_and_says_that_it_is_a_picture(job: ExportJob, tmp_path: Path) -> None:
    write_layout_svg(job, tmp_path / "layout.svg")
    root = ElementTree.parse(tmp_path / "layout.svg").getroot()
    elements = list(root.iter())
    # Laser programs cut or engrave strokes, inherited ones too.
    assert {element.get("stroke", "none") for element in elements} == {"none"}
    assert all("style" not in element.attrib and "stroke-width" not in element.attrib for element in elements)
    assert all(path.get("fill", "none") != "none" for path in root.iter(f"{SVG_NS}path"))
    assert root.get("id") == "PICTURE"
    notes = [root.findtext(f"{SVG_NS}{name}") or "" for name in ("title", "desc", "text")]
    assert all("picture" in note.lower() for note in notes) and all("not a cut file" in n for n in notes)


def test_that_the_pdf_page_is_the_sheet_at_one_to_one(job: ExportJob, tmp_path: Path) -> None:
    plan = job.required_plan
    write_pdf(plan, tmp_path / "cut.pdf")
    content = (tmp_path / "cut.pdf").read_bytes()
    found = re.search(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", content)
    assert found is not None
    assert float(found[1]) * 25.4 / 72 == pytest.approx(plan.bounds_mm[0] + 20.0, abs=1e-3)
    lines = re.findall(rb"n ([\d.]+) ([\d.]+) m ([\d.]+) ([\d.]+) l\sS", content)
    slits = plan.on_layer(Layer.SLITS)
    lengths = [math.dist((float(a), float(b)), (float(c), float(d))) * 25.4 / 72 for a, b, c, d in lines[: len(slits)]]
    np.testing.assert_allclose(lengths, [slit.length for slit in slits], atol=2e-3)


@pytest.mark.parametrize("extension", ["svg", "layout.svg", "pdf", "png", "gif"])
def test_that_the_same_job_gives_the_same_bytes(extension: str, job: ExportJob, tmp_path: Path) -> None:
    contents = []
    for name in ("one", "two"):
        path = tmp_path / f"{name}.{extension}"
        match extension:
            case "svg":
                write_cut_svg(job.required_plan, path, find_profile("any"))
            case "layout.svg":
                write_layout_svg(job, path)
            case "pdf":
                write_pdf(job.required_plan, path)
            case "png":
                write_png(job, path, longest=120)
            case _:
                write_animation(job, path, frames=4, longest=80)
        contents.append(path.read_bytes())
    assert contents[0] == contents[1]


def test_that_the_preview_covers_the_target_with_panels(job: ExportJob) -> None:
    pixels = np.asarray(preview(job, longest=300)).reshape(-1, 3).astype(int)

    def share(colour: picture.Colour) -> float:
        return float(np.mean(np.abs(pixels - colour).max(axis=1) <= 2))

    assert share(picture.PANEL) > 0.3
    assert share(picture.TARGET_FILL) < 0.02
    elsewhere = ExportJob(job.deployment, 1.5, None, job.target, job.transform)
    pixels = np.asarray(preview(elsewhere, longest=300)).reshape(-1, 3).astype(int)
    assert share(picture.TARGET_FILL) > 0.05


def test_that_the_png_reads_back_at_the_size_asked_for(job: ExportJob, tmp_path: Path) -> None:
    write_png(job, tmp_path / "preview.png", longest=200)
    with Image.open(tmp_path / "preview.png") as image:
        assert max(image.size) == 200


def test_that_the_animation_runs_from_compact_to_the_target_in_one_constant_frame(
    job: ExportJob, tmp_path: Path
) -> None:
    assert write_animation(job, tmp_path / "unfold.gif", frames=12, longest=120) == 12
    with Image.open(tmp_path / "unfold.gif") as image:
        assert getattr(image, "n_frames", 1) == 12
        assert image.info["loop"] == 0
        filled = []
        for index in range(12):
            image.seek(index)
            assert max(image.size) == 120
            pixels = np.asarray(image.convert("RGB")).reshape(-1, 3).astype(int)
            filled.append(float(np.mean(np.abs(pixels - picture.PANEL).max(axis=1) <= 12)))
    assert min(filled) > 0.1


def test_that_angles_run_from_pi_to_the_goal_and_slow_down_at_both_ends() -> None:
    angles = frame_angles(0.5, 21)
    steps = -np.diff(angles)
    assert (angles[0], angles[-1]) == (math.pi, 0.5)
    assert np.all(steps > 0)
    assert steps[10] > 5 * steps[0]


def test_that_an_animation_of_one_frame_is_refused(job: ExportJob, tmp_path: Path) -> None:
    with refused(ExportError, "gif.too_few_frames", frames=1):
        write_animation(job, tmp_path / "unfold.gif", frames=1)


def test_that_the_motion_ends_in_the_pose_of_the_target_and_keeps_its_centre(job: ExportJob) -> None:
    design = job.posed
    end = design.nodes(0.0)
    assert job.target is not None
    np.testing.assert_allclose(end[job.deployment.topology.outline_at_zero], job.target, atol=1e-9)
    start = design.nodes(math.pi)
    np.testing.assert_allclose(start.mean(axis=0), end.mean(axis=0), atol=1e-12)
    area = signed_area(start[job.deployment.topology.outline_nodes])
    assert area == pytest.approx(30.0 * 0.2**2)


def test_that_a_bitmap_written_in_bands_reads_back_pixel_by_pixel_with_its_facts() -> None:
    pixels = np.random.default_rng(3).integers(0, 256, (50, 31, 3), dtype=np.uint8)
    content = png_of_bands((31, 50), (pixels[top : top + 16] for top in range(0, 50, 16)), {"FROM": "größer, 4 x 5"})
    with Image.open(io.BytesIO(content)) as read:
        assert read.text == {"FROM": "größer, 4 x 5"}  # type: ignore[attr-defined]
        np.testing.assert_array_equal(np.asarray(read), pixels)
