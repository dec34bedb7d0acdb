"""SVG, PDF and PNG of a printed sheet: in register with the cut file, at true size, and what they say."""

from __future__ import annotations

import base64
import io
import re
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pypdf
import pytest
from PIL import Image

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.export.artwork import ArtPicture, Artwork, Laid, SheetState
from kirigami_studio.export.artwork_files import ArtworkJob, write_artwork
from kirigami_studio.export.artwork_patches import rings_of
from kirigami_studio.export.artwork_picture import picture_of
from kirigami_studio.export.artwork_raster import MOST_PIXELS, image_of
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.paper import tile
from kirigami_studio.export.profile import find_profile
from kirigami_studio.export.svg import write_cut_svg
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.fabricate.options import STRAIGHT
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.lab.demonstrations import printed_states
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines import silhouettes
from kirigami_studio.project.document import Document
from kirigami_studio.project.store import save

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def picture() -> ArtPicture:
    """Four coloured quarters: red, green over blue, white."""
    quarters = np.array([[(255, 0, 0), (0, 255, 0)], [(0, 0, 255), (255, 255, 255)]], dtype=np.uint8)
    stream = io.BytesIO()
    Image.fromarray(np.repeat(np.repeat(quarters, 60, axis=0), 60, axis=1)).save(stream, format="PNG")
    return picture_of("quarters.png", stream.getvalue())


@pytest.fixture(scope="module")
def job() -> ExportJob:
    field = RatioField.from_log10(np.random.default_rng(2).uniform(-0.2, 0.2, (3, 4)))
    heart, deployment = silhouettes.load("heart"), deploy(field)
    candidate = Candidate(Sheet(field), evaluate(deployment, heart, 0.0), 0, 0)
    return ExportJob.of(candidate, heart.points, plan_cuts(deployment, width_mm=50.0))


def view_box(path: Path) -> list[float]:
    return [float(number) for number in ElementTree.parse(path).getroot().get("viewBox", "").split()]


@pytest.mark.parametrize("profile", ["any", "slots"])
@pytest.mark.parametrize("copies", [1, 3])
def test_that_the_print_has_the_frame_of_the_cut_file(
    profile: str, copies: int, picture: ArtPicture, job: ExportJob, tmp_path: Path
) -> None:
    plan = plan_cuts(job.deployment, width_mm=50.0, options=replace(STRAIGHT, copies=copies))
    job = replace(job, plan=plan, profile=profile)
    write_cut_svg(plan, tmp_path / "cut.svg", find_profile(profile))
    artwork = Artwork(Laid(picture))
    svg, pdf, png, _ = write_artwork(ArtworkJob(artwork, job, 100.0, margin_mm=0.0), tmp_path / "bare")
    frame = view_box(tmp_path / "cut.svg")
    assert view_box(svg) == frame
    assert ElementTree.parse(svg).getroot().get("width") == ElementTree.parse(tmp_path / "cut.svg").getroot().get(
        "width"
    )
    page = pypdf.PdfReader(pdf).pages[0].mediabox
    assert [float(page.width) * 25.4 / 72.0, float(page.height) * 25.4 / 72.0] == pytest.approx(frame[2:], abs=1e-3)
    with Image.open(png) as image:
        assert np.array(image.size) == pytest.approx(np.array(frame[2:]) / 25.4 * 100.0, abs=1.0)
        assert image.info["dpi"][0] == pytest.approx(100.0, abs=0.02)
    svg = write_artwork(ArtworkJob(artwork, job, 100.0, margin_mm=8.0), tmp_path / "margin")[0]
    assert view_box(svg) == pytest.approx([-8.0, -8.0, frame[2] + 16.0, frame[3] + 16.0])


def test_that_the_svg_shows_what_the_bitmap_shows(picture: ArtPicture, job: ExportJob, tmp_path: Path) -> None:
    work = ArtworkJob(Artwork(Laid(picture, SheetState.TARGET)), job, 254.0, margin_mm=5.0)
    svg, _, png, _ = write_artwork(work, tmp_path)
    root = ElementTree.parse(svg).getroot()
    (image,) = root.iter(f"{SVG}image")
    content = image.get("{http://www.w3.org/1999/xlink}href", "").split(",")[1]
    assert base64.b64decode(content) == picture.content
    with Image.open(png) as opened:
        pixels = np.asarray(opened.convert("RGB"), dtype=int)
    left, top, _, _ = view_box(svg)
    source = np.asarray(image_of(picture.content).convert("RGB"), dtype=int)
    uses = [use.get("transform", "") for use in root.iter(f"{SVG}use")]
    paths = [path.get("d", "") for path in root.iter(f"{SVG}path") if path.get("clip-rule")]
    assert len(uses) == len(paths) == 4 * 5
    agreeing = 0
    for words, data in zip(uses, paths, strict=True):
        a, b, c, d, e, f = (float(number) for number in re.findall(r"-?\d+\.\d+", words))
        ring = np.array(
            [[float(number) for number in pair.split(",")] for pair in re.findall(r"[-\d.]+,[-\d.]+", data)]
        )
        place = ring.mean(axis=0)
        u, v = np.linalg.solve([[a, c], [b, d]], place - (e, f))
        meant = source[int(v), int(u)]
        x, y = ((place - (left, top)) * 10.0).astype(int)
        agreeing += bool(np.abs(pixels[y, x] - meant).max() < 30)
    assert agreeing >= 17  # the middle of a panel may lie on an edge of the picture's squares


def test_that_the_pdf_lays_every_panel_and_its_picture_where_they_belong(
    picture: ArtPicture, job: ExportJob, tmp_path: Path
) -> None:
    work = ArtworkJob(Artwork(Laid(picture)), job, margin_mm=5.0)
    reader = pypdf.PdfReader(write_artwork(work, tmp_path)[1])
    page = reader.pages[0]
    forms = {name: form.get_object() for name, form in page["/Resources"]["/XObject"].items()}
    (sheet,) = [form for name, form in forms.items() if "sheet" in name]
    found: list[tuple[np.ndarray, np.ndarray]] = []
    ring: list[tuple[float, float]] = []
    for operands, operator in pypdf.generic.ContentStream(sheet, reader).operations:
        if operator in (b"m", b"l"):
            ring = (
                [*ring, (float(operands[0]), float(operands[1]))]
                if operator == b"l"
                else [(float(operands[0]), float(operands[1]))]
            )
        elif operator == b"cm" and ring:
            found.append((np.array(ring), np.array([float(number) for number in operands])))
    assert len(found) == len(work.patches) == 20
    height = picture.size[1]
    for (points, (a, b, c, d, e, f)), patch in zip(found, work.patches, strict=True):
        assert np.allclose(points, rings_of(patch.region)[0], atol=1e-4)
        for place in (complex(*points[0]), complex(*points[1])):
            right, up = np.linalg.solve([[a, c], [b, d]], [place.real - e, place.imag - f])
            pixel = ((place - patch.shift) / patch.factor).conjugate()
            assert complex(right, height - up) == pytest.approx(pixel, abs=0.02)
    drawn = pypdf.generic.ContentStream(page.get_contents(), reader).operations
    steps = [[float(number) for number in operands] for operands, operator in drawn if operator == b"cm"]
    frame = np.eye(3)
    for a, b, c, d, e, f in steps[:4]:
        frame = frame @ np.array([[a, c, e], [b, d, f], [0.0, 0.0, 1.0]])
    assert frame[:2, 2] == pytest.approx([5.0 * 72.0 / 25.4] * 2, abs=1e-3)
    assert frame[0, 0] == pytest.approx(72.0 / 25.4, abs=1e-4)


def place_of_print(page: pypdf.PageObject, reader: pypdf.PdfReader) -> tuple[np.ndarray, np.ndarray]:
    """Where the frame of the cut file lies on a page, and the box that the print is cut off at: (2,), (2, 2) mm."""
    frame, steps, corners = np.eye(3), 0, []
    for operands, operator in pypdf.generic.ContentStream(page.get_contents(), reader).operations:
        values = [float(number) for number in operands] if operator in (b"cm", b"m", b"l") else []
        if operator == b"cm" and steps < 4:
            a, b, c, d, e, f = values
            frame, steps = frame @ np.array([[a, c, e], [b, d, f], [0.0, 0.0, 1.0]]), steps + 1
        elif operator in (b"m", b"l") and 0 < steps < 4:
            corners.append((frame @ [*values, 1.0])[:2])
    mm = 25.4 / 72.0
    assert frame[0, 0] == pytest.approx(1.0 / mm, abs=1e-4)
    return frame[:2, 2] * mm, np.array([np.min(corners, axis=0), np.max(corners, axis=0)]) * mm


@pytest.mark.parametrize(("width_mm", "copies"), [(230.0, 1), (120.0, 4)])
def test_that_a_print_larger_than_the_paper_is_spread_over_pages(
    width_mm: float, copies: int, picture: ArtPicture, job: ExportJob, tmp_path: Path
) -> None:
    plan = plan_cuts(job.deployment, width_mm=width_mm, options=replace(STRAIGHT, copies=copies))
    work = ArtworkJob(Artwork(Laid(picture)), replace(job, plan=plan, paper="a4"), 20.0)
    assert len(work.places) == copies
    pdf = write_artwork(work, tmp_path)[1]
    reader, meant = pypdf.PdfReader(pdf), tile(work.page_mm, "a4")
    assert len(meant.tiles) >= 2 and len(reader.pages) == len(meant.tiles) + 1
    assert f"Map of {len(meant.tiles)} pages" in reader.pages[0].extract_text()
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    for page, part in zip(reader.pages[1:], meant.tiles, strict=True):
        sides = [float(page.mediabox.width), float(page.mediabox.height)]
        assert np.array(sides) * 25.4 / 72.0 == pytest.approx(meant.page, abs=1e-3)
        origin, box = place_of_print(page, reader)
        corner = np.array(part.window[:2])
        assert origin == pytest.approx(np.array([10.0, 24.0]) - corner + work.margin_mm, abs=1e-3)
        assert box == pytest.approx(np.array(part.window).reshape(2, 2) - corner + [10.0, 24.0], abs=1e-3)
        low, high = np.minimum(low, part.window[:2]), np.maximum(high, part.window[2:])
        drawn = [operator for _, operator in pypdf.generic.ContentStream(page.get_contents(), reader).operations]
        assert drawn.count(b"Do") == copies and b"W*" in drawn
        assert "This ruler is 50 mm long" in page.extract_text()
    assert np.all(low <= 1e-9) and np.all(high >= np.array(work.page_mm) - 1e-9)
    assert pdf.read_bytes().count(b"/Subtype /Image") == 1  # however many pages show it


def test_that_a_print_that_fits_takes_one_page_of_the_paper(
    picture: ArtPicture, job: ExportJob, tmp_path: Path
) -> None:
    pdf = write_artwork(ArtworkJob(Artwork(Laid(picture)), replace(job, paper="letter"), 20.0), tmp_path)[1]
    (page,) = pypdf.PdfReader(pdf).pages
    assert sorted([float(page.mediabox.width), float(page.mediabox.height)]) == pytest.approx([612.0, 792.0], abs=1e-2)


def test_that_the_opened_sheet_shows_the_picture_as_it_was(picture: ArtPicture, job: ExportJob, tmp_path: Path) -> None:
    opened = write_artwork(ArtworkJob(Artwork(Laid(picture)), job), tmp_path)[3]
    with Image.open(opened) as image:
        colours = np.asarray(image, dtype=int)
    height, width, _ = colours.shape
    for x, y, meant in ((0.35, 0.35, (255, 0, 0)), (0.65, 0.35, (0, 255, 0)), (0.35, 0.6, (0, 0, 255))):
        area = colours[
            int((y - 0.02) * height) : int((y + 0.02) * height), int((x - 0.02) * width) : int((x + 0.02) * width)
        ]
        assert np.median(area.reshape(-1, 3), axis=0).tolist() == list(meant)


def test_that_the_picture_for_the_readme_shows_three_states(
    picture: ArtPicture, job: ExportJob, tmp_path: Path
) -> None:
    (tmp_path / picture.name).write_bytes(picture.content)
    candidate = Candidate(job.deployment.sheet, evaluate(job.deployment, silhouettes.load("heart"), 0.0), 0, 0)
    save(Document(silhouettes.load("heart"), candidates=(candidate,), chosen=0), tmp_path / "own.kiri")
    words = [str(tmp_path / name) for name in ("own.kiri", picture.name)]
    assert printed_states.main([*words, "--out", str(tmp_path / "three.png")]) == 0
    with Image.open(tmp_path / "three.png") as image:
        pixels = np.asarray(image.convert("RGB"), dtype=int)
    printed = (pixels < 250).any(axis=2)
    thirds = [third.mean() for third in np.array_split(printed, 3, axis=1)]
    assert min(thirds) > 0.15


def test_that_marks_point_at_the_corners_of_the_frame(picture: ArtPicture, job: ExportJob) -> None:
    work = ArtworkJob(Artwork(Laid(picture)), job, bleed_mm=1.0, margin_mm=6.0)
    width, height = work.frame_mm
    assert len(work.marks) == 8
    for start, end in work.marks.tolist():
        along = np.array(end) - start
        corner = np.array([round(start[0] / width) * width, round(start[1] / height) * height])
        reach = np.array(start) - corner
        assert abs(along[0] * reach[1] - along[1] * reach[0]) < 1e-9
        assert np.linalg.norm(reach) == pytest.approx(2.0)
        assert np.linalg.norm(np.array(end) - corner) == pytest.approx(6.0)
    assert len(ArtworkJob(Artwork(Laid(picture)), job, bleed_mm=1.0, margin_mm=2.0).marks) == 0


def test_that_the_same_picture_gives_the_same_bytes_and_names_its_design(
    picture: ArtPicture, job: ExportJob, tmp_path: Path
) -> None:
    work = ArtworkJob(Artwork(Laid(picture)), job, 100.0)
    first, second = (write_artwork(work, tmp_path / name) for name in ("one", "two"))
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]
    assert job.required_plan.design_hash.encode() in first[0].read_bytes()
    with Image.open(first[2]) as image:
        assert image.info["DESIGN"] == job.required_plan.design_hash


def test_that_too_many_pixels_unknown_paper_and_odd_margins_are_refused_before_anything_is_written(
    picture: ArtPicture, job: ExportJob, tmp_path: Path
) -> None:
    with pytest.raises(ExportError) as caught:
        write_artwork(ArtworkJob(Artwork(Laid(picture)), job, 20000.0), tmp_path / "none")
    assert caught.value.code == "artwork.too_many_pixels"
    assert not (tmp_path / "none").exists()
    with pytest.raises(ExportError) as caught:
        write_artwork(ArtworkJob(Artwork(Laid(picture)), replace(job, paper="a9")), tmp_path / "none")
    assert caught.value.code == "paper.unknown"
    assert not (tmp_path / "none").exists()
    with pytest.raises(ExportError) as caught:
        ArtworkJob(Artwork(Laid(picture)), job, margin_mm=-1.0)
    assert caught.value.code == "artwork.impossible_margin"


@pytest.mark.parametrize(("width_mm", "dpi"), [(50.0, 300.0), (1200.0, 232.0), (2999.0, 93.0)])
def test_that_a_print_of_no_asked_resolution_gets_what_a_bitmap_may_have(
    width_mm: float, dpi: float, picture: ArtPicture, job: ExportJob
) -> None:
    large = replace(job, plan=plan_cuts(job.deployment, width_mm=width_mm))
    work = ArtworkJob.usual(Artwork(Laid(picture)), large)
    assert work.dpi == pytest.approx(dpi, abs=8.0)
    width, height = work.page.pixels  # refused where these are too many
    assert dpi == 300.0 or width * height > 0.97 * MOST_PIXELS
