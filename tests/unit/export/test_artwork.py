"""Pictures printed on sheets: the mapping against an independent image library, the bleed, and where pictures lie."""

from __future__ import annotations

import math
from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
import shapely
from PIL import Image
from skimage.transform import SimilarityTransform, estimate_transform, warp

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.evaluate.trimming import trim
from kirigami_studio.export.artwork import ArtPicture, Artwork, Laid, PictureFit, SheetState
from kirigami_studio.export.artwork_patches import PrintedSheet, opened_patches, printed_patches
from kirigami_studio.export.artwork_picture import picture_of
from kirigami_studio.export.artwork_raster import BitmapFrame, image_of, paint
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines import silhouettes

DPI = 200.0


def chequered(width: int, height: int, seed: int = 0) -> ArtPicture:
    """A picture of sharp squares in many colours, no two neighbours alike."""
    generator = np.random.default_rng(seed)
    squares = generator.integers(0, 256, (height // 20, width // 20, 3), dtype=np.uint8)
    stream = BytesIO()
    Image.fromarray(np.repeat(np.repeat(squares, 20, axis=0), 20, axis=1)).save(stream, format="PNG")
    return picture_of("squares.png", stream.getvalue())


def job_of(trimmed: bool = False, seed: int = 3) -> ExportJob:
    """A heart of 5 x 4 voids, not symmetric, turned and scaled over its target, with its plan."""
    field = RatioField.from_log10(np.random.default_rng(seed).uniform(-0.3, 0.3, (5, 4)))
    heart, deployment = silhouettes.load("heart"), deploy(field)
    score = evaluate(deployment, heart, 0.0)
    cut = trim(deployment, heart, 0.0, score.transform, 0.3) if trimmed else None
    candidate = Candidate(Sheet(field), score, 0, 0, trim=cut)
    plan = plan_cuts(deployment, width_mm=80.0, kept=None if cut is None else cut.kept)
    return ExportJob.of(candidate, heart.points, plan)


def warped_by_skimage(laid: Laid, sheet: PrintedSheet, page: BitmapFrame, panel: int) -> np.ndarray:
    """The printed page as scikit-image makes it from the panel's corners, as if it were all of that panel."""
    picture = np.asarray(image_of(laid.picture.content).convert("RGB"), dtype=np.float64) / 255.0
    design = sheet.design
    there = (
        design.panels(design.nodes(design.phi_target))[panel]
        if laid.state is SheetState.TARGET
        else sheet.corners[panel]
    )
    low, high = sheet.box(laid.state)
    height, width = picture.shape[:2]
    # Where the picture's corners lie, from what the options promise: it covers the box and 2 % more, centred.
    size = high - low + 0.04 * (high - low).max()
    scale = max(size[0] / width, size[1] / height)
    middle = 0.5 * (low + high)
    to_picture = (there - middle) * (1.0, -1.0) / scale + (0.5 * width, 0.5 * height)
    # scikit-image counts from pixels' middles.
    found = estimate_transform("similarity", page.to_pixels(sheet.corners[panel]) - 0.5, to_picture - 0.5)
    assert isinstance(found, SimilarityTransform)
    columns, rows = page.pixels
    return warp(picture, found, output_shape=(rows, columns), order=1)


def differences(printed: np.ndarray, meant: np.ndarray, inside: shapely.Polygon) -> dict[tuple[int, int], float]:
    """Mean difference of two pictures inside a polygon (pixels), the one moved by up to a pixel to all sides."""
    left, top, right, bottom = (int(value) for value in inside.bounds)
    rows, columns = np.mgrid[top:bottom, left:right]
    chosen = shapely.contains_xy(inside, columns.ravel() + 0.5, rows.ravel() + 0.5)
    rows, columns = rows.ravel()[chosen], columns.ravel()[chosen]
    return {
        (dx, dy): float(np.abs(printed[rows + dy, columns + dx] - meant[rows, columns]).mean())
        for dx in (-1, 0, 1)
        for dy in (-1, 0, 1)
    }


@pytest.mark.parametrize("state", list(SheetState))
def test_that_a_picture_warped_by_another_library_agrees_within_a_pixel(state: SheetState) -> None:
    job = job_of()
    sheet, laid = PrintedSheet.of(job), Laid(chequered(600, 560), state)
    patches = printed_patches(Artwork(laid), sheet, 1.0, 0.2)
    page = BitmapFrame((0.0, 0.0), (82.0, 100.0), DPI)
    printed = np.asarray(paint(patches, page).convert("RGB"), dtype=np.float64) / 255.0
    for panel in range(0, len(sheet.cells), 3):
        meant = warped_by_skimage(laid, sheet, page, panel)
        inner = shapely.Polygon(page.to_pixels(sheet.cells[panel])).buffer(-3.0)
        around = differences(printed, meant, inner)
        assert min(around, key=around.__getitem__) == (0, 0)
        assert around[0, 0] < 0.01
        assert around[1, 0] > 2.0 * around[0, 0]


@pytest.mark.parametrize("trimmed", [False, True])
def test_that_panels_and_their_pictures_come_together_on_the_target(trimmed: bool) -> None:
    job = job_of(trimmed)
    sheet, laid = PrintedSheet.of(job), Laid(chequered(600, 560))
    design = sheet.design
    scale = design.mm_per_world(80.0)
    maps = {(patch.factor, patch.shift) for patch in opened_patches(Artwork(laid), sheet, design.phi_target)}
    assert np.ptp([factor.real for factor, _ in maps]) < 1e-9
    assert np.ptp([shift.imag for _, shift in maps]) < 1e-9
    parts = design.parts(design.phi_target)
    regions = [patch.region for patch in opened_patches(Artwork(laid), sheet, design.phi_target)]
    assert len(regions) == len(parts)
    for region, part in zip(regions, parts, strict=True):
        assert region.symmetric_difference(shapely.Polygon(part * scale)).area < 1e-6


@pytest.mark.parametrize("trimmed", [False, True])
def test_that_the_sheet_and_its_bleed_are_printed_once_and_whole(trimmed: bool) -> None:
    job = job_of(trimmed)
    sheet = PrintedSheet.of(job)
    patches = printed_patches(Artwork(Laid(chequered(200, 200))), sheet, 1.5, 0.2)
    cells = [shapely.Polygon(cell) for cell in sheet.cells if len(cell)]
    printed = shapely.union_all([patch.region for patch in patches])
    assert shapely.union_all(cells).buffer(1.4).difference(printed).area < 1e-6
    assert printed.difference(shapely.union_all(cells).buffer(1.5 * 3.01)).area < 1e-6
    for earlier, patch in enumerate(patches):
        over = shapely.union_all([later.region for later in patches[earlier + 1 :]])
        seen = patch.region.difference(over)
        cell = shapely.Polygon(sheet.cells[patch.panel])
        assert cell.difference(seen).area < 1e-3  # nothing is painted over a panel's own cell
    assert printed_patches(Artwork(Laid(chequered(200, 200))), sheet, 0.0, 0.2)


def test_that_printed_panels_lie_where_the_cuts_are() -> None:
    job = job_of()
    sheet = PrintedSheet.of(job)
    cells = shapely.union_all([shapely.Polygon(cell) for cell in sheet.cells])
    kerf = job.required_plan.kerf_mm
    assert (
        cells.buffer(0.5 * kerf, join_style="mitre")
        .symmetric_difference(shapely.Polygon(job.required_plan.outline))
        .area
        < 1e-3 * cells.area
    )
    free = PrintedSheet.uncut(job.posed, job.target, 80.0)
    assert np.allclose(np.ptp(free.corners, axis=(0, 1)), np.ptp(sheet.corners, axis=(0, 1)))


def test_that_fit_shows_all_of_the_picture_and_fill_leaves_nothing_bare() -> None:
    low, high = np.array([1.0, 2.0]), np.array([5.0, 4.0])
    laid = Laid(chequered(400, 400), fitting=PictureFit.FIT)
    factor, shift = laid.map_into(low, high)
    corners = [factor * complex(u, -v) + shift for u, v in ((0, 0), (400, 400))]
    assert corners == pytest.approx([complex(2, 4), complex(4, 2)])
    factor, shift = replace(laid, fitting=PictureFit.FILL).map_into(low, high)
    left, right = factor * complex(0, 0) + shift, factor * complex(400, -400) + shift
    assert left.real < 1.0 and left.imag > 4.0 and right.real > 5.0 and right.imag < 2.0
    factor, shift = replace(laid, scale=2.0, turn=math.pi, shift=(0.5, 0.0)).map_into(low, high)
    assert factor * complex(200, -200) + shift == pytest.approx(complex(5, 3))
    assert factor * complex(0, 0) + shift == pytest.approx(complex(7, 1))


def test_that_two_pictures_share_every_panel_by_stripes_and_lie_in_both_states() -> None:
    sheet = PrintedSheet.of(job_of())
    first, second = chequered(600, 560), chequered(400, 400, seed=1)
    artwork = Artwork(Laid(first, SheetState.FLAT), second, stripes=40)
    patches = printed_patches(artwork, sheet, 1.0, 0.2)
    alone = printed_patches(Artwork(Laid(first, SheetState.FLAT)), sheet, 1.0, 0.2)
    over = [patch for patch in patches if patch.picture is second]
    below = [patch for patch in patches if patch.picture is first]
    assert [patch.region for patch in below] == [patch.region for patch in alone]
    assert len(over) == len(below)
    half = sum(patch.region.area for patch in over) / sum(patch.region.area for patch in below)
    assert half == pytest.approx(0.5, abs=0.02)
    low, high = sheet.corners.min(axis=(0, 1)), sheet.corners.max(axis=(0, 1))
    width = float(high[0] - low[0]) / 40
    for patch in over:
        for part in shapely.get_parts(patch.region):
            left, _, right, _ = part.bounds
            number = math.floor((0.5 * (left + right) - low[0]) / width)
            assert number % 2 == 1 and right - left < width + 1e-6
    assert len({(patch.factor, patch.shift) for patch in below}) == 1
    opened = opened_patches(artwork, sheet, sheet.design.phi_target)
    turns = [patch.factor for patch in opened if patch.picture is second]
    assert np.ptp([turn.real for turn in turns]) < 1e-9 and np.ptp([turn.imag for turn in turns]) < 1e-9


def test_that_what_is_transparent_in_the_second_picture_shows_the_first() -> None:
    sheet = PrintedSheet.of(job_of())
    stream = BytesIO()
    Image.new("RGBA", (50, 50), (0, 0, 0, 0)).save(stream, format="PNG")
    first = Laid(chequered(200, 200))
    page = BitmapFrame((0.0, 0.0), (80.0, 100.0), 60.0)
    alone, shared = (
        np.asarray(paint(printed_patches(artwork, sheet, 1.0, 0.2), page), dtype=int)
        for artwork in (Artwork(first), Artwork(first, picture_of("clear.png", stream.getvalue())))
    )
    assert np.abs(alone - shared).max() <= 2


def test_that_impossible_numbers_are_refused() -> None:
    picture = chequered(40, 40)
    for wrong in ({"scale": 0.0}, {"scale": math.inf}, {"turn": math.nan}, {"shift": (0.0, math.inf)}):
        with pytest.raises(ExportError) as caught:
            Laid(picture, **wrong)
        assert caught.value.code == "artwork.impossible_place"
    for stripes in (1, 1001):
        with pytest.raises(ExportError) as caught:
            Artwork(Laid(picture), picture, stripes)
        assert caught.value.code == "artwork.stripes"
    sheet = PrintedSheet.of(job_of())
    for bleed in (-1.0, 21.0, math.nan):
        with pytest.raises(ExportError) as caught:
            printed_patches(Artwork(Laid(picture)), sheet, bleed, 0.1)
        assert caught.value.code == "artwork.impossible_bleed"
    with pytest.raises(ExportError) as caught:
        BitmapFrame((0.0, 0.0), (1000.0, 1000.0), 600.0)
    assert caught.value.code == "artwork.too_many_pixels"
    assert BitmapFrame((0.0, 0.0), (1000.0, 1000.0), float(caught.value.fields["most_dpi"]))
