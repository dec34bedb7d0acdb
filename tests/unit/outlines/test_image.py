"""Pictures become outlines: threshold, polarity, colour modes, dirt, borders."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.read_image import automatic_threshold, outline_of_mask, read_image, trace_image
from tests.refusals import refused


@pytest.mark.parametrize("name", ["heart", "star", "gear", "puzzle", "circle", "letter-l"])
@pytest.mark.parametrize(("size", "least"), [(64, 0.985), (256, 0.997), (1000, 0.998)])
def test_that_a_drawn_silhouette_comes_back(name, size, least, coverage, picture, iou) -> None:
    wanted = silhouettes.load(name)
    longest = np.max(np.ptp(wanted.points, axis=0))
    outline = read_image(picture(1 - coverage(wanted, size)))
    assert iou(outline, wanted) > least
    assert len(outline.points) <= 400
    assert outline.size == pytest.approx(np.ptp(wanted.points, axis=0) * 0.9 * size / longest, abs=max(4, 0.004 * size))
    assert outline.unit == "px"
    assert outline.notes == ()


def test_that_a_very_large_picture_is_read_at_reduced_size(tmp_path, coverage, iou) -> None:
    wanted = silhouettes.load("heart")
    path = tmp_path / "large.png"
    small = Image.fromarray(coverage(wanted, 1000) < 0.5)
    small.resize((8000, 8000)).save(path, compress_level=1)
    outline = read_image(path)
    assert iou(outline, wanted) > 0.998
    assert max(outline.size) == pytest.approx(7200, abs=10)


@pytest.mark.parametrize(
    ("name", "mode"),
    [
        *(("shape.png", mode) for mode in ("L", "RGB", "1", "P", "RGBA", "LA")),
        *(("shape.bmp", mode) for mode in ("L", "RGB", "1", "P", "RGBA")),
        *(("shape.jpg", mode) for mode in ("L", "RGB", "CMYK")),
    ],
)
def test_that_every_colour_mode_is_read(name, mode, coverage, tmp_path, iou) -> None:
    wanted = silhouettes.load("heart")
    path = tmp_path / name
    Image.fromarray((255 * (1 - coverage(wanted, 256))).astype(np.uint8)).convert(mode).save(path)
    assert iou(read_image(path), wanted) > 0.99


def test_that_sixteen_bit_pictures_use_their_own_black_and_white(coverage, tmp_path, iou) -> None:
    wanted = silhouettes.load("star")
    path = tmp_path / "deep.png"
    Image.fromarray((500 + 3000 * coverage(wanted, 256)).astype(np.uint16)).save(path)
    assert iou(read_image(path), wanted) > 0.99


def test_that_a_white_mask_on_black_is_the_same_shape(coverage, picture, iou) -> None:
    wanted = silhouettes.load("gear")
    assert iou(read_image(picture(coverage(wanted, 256))), wanted) > 0.99


@pytest.mark.parametrize("colour", [0, 128, 255])
def test_that_the_alpha_channel_counts_whatever_the_colour(colour, coverage, tmp_path, iou) -> None:
    wanted = silhouettes.load("fish")
    alpha = Image.fromarray((255 * coverage(wanted, 256)).astype(np.uint8))
    path = tmp_path / "icon.png"
    Image.merge("LA", [Image.new("L", alpha.size, colour), alpha]).save(path)
    assert iou(read_image(path), wanted) > 0.99


def test_that_a_transparent_palette_colour_is_background(tmp_path, coverage, iou) -> None:
    wanted = silhouettes.load("heart")
    indices = Image.fromarray((coverage(wanted, 256) > 0.5).astype(np.uint8), mode=None)
    indices = indices.convert("P")
    indices.putpalette([0, 0, 0, 20, 20, 20])
    path = tmp_path / "palette.png"
    indices.save(path, transparency=0)
    assert iou(read_image(path), wanted) > 0.99


def test_that_an_opaque_picture_with_an_alpha_channel_is_read_by_its_grey(coverage, picture, iou) -> None:
    wanted = silhouettes.load("heart")
    assert iou(read_image(picture(1 - coverage(wanted, 256), mode="RGBA")), wanted) > 0.99


def test_that_a_shape_touching_the_border_is_closed_there() -> None:
    mask = np.zeros((64, 80), dtype=bool)
    mask[20:, :40] = True
    outline = outline_of_mask(mask, "corner")
    assert outline.size == pytest.approx((40, 44), abs=0.2)
    assert outline.points[:, 0].min() < 0 < outline.points[:, 0].max()


def test_that_row_zero_is_the_top() -> None:
    mask = np.zeros((90, 90), dtype=bool)
    mask[20:40, 20:70] = True
    mask[40:70, 40:50] = True
    outline = outline_of_mask(mask, "T")
    above = outline.points[outline.points[:, 1] > outline.points[:, 1].max() - 0.2]
    below = outline.points[outline.points[:, 1] < outline.points[:, 1].min() + 0.2]
    assert np.ptp(above[:, 0]) > 3 * np.ptp(below[:, 0])


def test_that_islands_are_dropped_and_said_and_holes_stay_open(coverage, picture, iou) -> None:
    wanted = silhouettes.load("square")
    ink = coverage(wanted, 256, share=0.6)
    ink[100:130, 100:130] = 0
    ink[5:15, 5:15] = 1
    ink[240:250, 100:110] = 1
    outline = read_image(picture(1 - ink))
    assert iou(outline.filled, wanted) > 0.99
    (note,) = outline.notes
    assert "2 islands" in note
    assert 1.0 - outline.polygon.area == pytest.approx(900 / (0.6 * 256) ** 2, rel=0.02)


def test_that_scanner_noise_does_not_change_the_shape(coverage, picture, iou) -> None:
    wanted = silhouettes.load("heart")
    generator = np.random.default_rng(0)
    grey = 0.85 - 0.7 * coverage(wanted, 300) + generator.normal(0, 0.06, (300, 300))
    assert iou(read_image(picture(grey, "scan.jpg")), wanted) > 0.99


def test_that_the_threshold_moves_the_contour(picture) -> None:
    x = np.linspace(-1, 1, 200)
    grey = np.minimum(1.0, np.hypot(x[:, None], x[None, :]))
    path = picture(grey)
    widths = [read_image(path, threshold).size[0] for threshold in (0.25, 0.5, 0.75)]
    assert widths == pytest.approx([0.25 * 199, 0.5 * 199, 0.75 * 199], abs=1.0)
    assert 0.3 < automatic_threshold(path) < 0.8


def test_that_the_automatic_threshold_is_midway_on_a_two_level_picture(picture) -> None:
    grey = np.full((100, 100), 200 / 255)
    grey[30:70, 30:70] = 100 / 255
    assert automatic_threshold(picture(grey)) == pytest.approx(150 / 255, abs=1e-6)


@pytest.mark.parametrize("threshold", [0.0, 1.0, -3, float("nan"), True, "dark"])
def test_that_an_impossible_threshold_is_refused(threshold, picture, coverage) -> None:
    with pytest.raises(TargetError, match="between 0"):
        read_image(picture(1 - coverage(silhouettes.load("heart"), 64)), threshold)


def test_that_a_threshold_outside_the_contrast_is_refused(picture, coverage) -> None:
    path = picture(0.8 - 0.3 * coverage(silhouettes.load("heart"), 64))
    with pytest.raises(TargetError, match="all one colour"):
        read_image(path, 0.1)


@pytest.mark.parametrize("level", [0.0, 0.5, 1.0])
def test_that_a_blank_picture_is_refused(level, picture) -> None:
    with pytest.raises(TargetError, match="blank"):
        read_image(picture(np.full((64, 64), level)))


def test_that_faint_paper_grain_is_blank(picture) -> None:
    grain = 0.9 + np.random.default_rng(0).uniform(-0.02, 0.02, (128, 128))
    with pytest.raises(TargetError, match="blank"):
        read_image(picture(grain))


@pytest.mark.parametrize("size", [64, 128, 400])
def test_that_noise_is_refused(size, picture) -> None:
    generator = np.random.default_rng(size)
    for grey in (generator.random((size, size)), generator.integers(0, 2, (size, size)).astype(float)):
        with pytest.raises(TargetError, match="specks"):
            read_image(picture(grey))


def test_that_too_small_a_shape_is_refused(picture) -> None:
    grey = np.ones((64, 64))
    grey[30:33, 30:33] = 0
    with pytest.raises(TargetError, match="9 pixels"):
        read_image(picture(grey))


def test_that_too_many_pixels_are_refused_before_decoding(tmp_path, monkeypatch) -> None:
    path = tmp_path / "wide.png"
    Image.new("1", (20_000, 5_001)).save(path)
    with pytest.raises(TargetError, match="20000 x 5001"):
        read_image(path)
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 1000)
    with pytest.raises(TargetError, match="too many pixels"):
        read_image(path)


def test_that_a_photo_is_turned_upright_as_its_camera_says(tmp_path) -> None:
    image = Image.new("L", (100, 60), 255)
    image.paste(0, (10, 20, 90, 40))
    exif = Image.Exif()
    exif[0x0112] = 6
    path = tmp_path / "turned.jpg"
    image.save(path, exif=exif)
    assert read_image(path).size == pytest.approx((20, 80), abs=1)


@pytest.mark.parametrize("mask", [np.zeros((20, 20), bool), np.zeros(5, bool), np.zeros((0, 4), bool)])
def test_that_a_mask_without_shape_is_refused(mask) -> None:
    with pytest.raises(TargetError, match="mask"):
        outline_of_mask(mask, "nothing")


def test_that_a_full_mask_is_its_rectangle(iou) -> None:
    rectangle = Outline.from_points([[0, 0], [60, 0], [60, 30], [0, 30]])
    assert iou(outline_of_mask(np.ones((30, 60), bool), "all"), rectangle) > 0.99


def test_that_a_text_file_named_png_is_refused_without_the_inner_workings(tmp_path: Path) -> None:
    (tmp_path / "a.png").write_text("hello")
    with refused(TargetError, "source.image_damaged") as caught:
        read_image(tmp_path / "a.png")
    assert "BytesIO" not in str(caught.value)


@pytest.mark.parametrize(("width", "height"), [(160, 120), (3001, 2503)])
def test_that_an_outline_knows_where_it_lies_in_its_picture(width, height, picture) -> None:
    grey = np.ones((height, width))
    left, right, top, bottom = width // 8, width // 2, height // 5, height // 3
    grey[top:bottom, left:right] = 0
    traced = trace_image(picture(grey))
    assert traced.picture == (width, height)
    ring = traced.outline.points * traced.scale + traced.centre
    wanted = [left, height - bottom, right, height - top]
    assert [*ring.min(axis=0), *ring.max(axis=0)] == pytest.approx(wanted, abs=max(1.0, width / 1500))


def test_that_a_picture_that_a_camera_turned_is_measured_upright(tmp_path: Path) -> None:
    page = Image.new("L", (160, 120), 255)
    page.paste(0, (10, 20, 90, 60))
    exif = Image.Exif()
    exif[0x0112] = 6  # turned a quarter: the first row is the right side
    path = tmp_path / "turned.jpg"
    page.save(path, exif=exif, quality=95)
    traced = trace_image(path)
    ring = traced.outline.points * traced.scale + traced.centre
    assert traced.picture == (120, 160)
    assert [*ring.min(axis=0), *ring.max(axis=0)] == pytest.approx([120 - 60, 160 - 90, 120 - 20, 160 - 10], abs=1)
