"""Picture files for printing: every colour mode, turned upright, kept small enough, or refused in one sentence."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kirigami_studio.export import artwork, artwork_picture
from kirigami_studio.export.artwork_picture import read_picture
from kirigami_studio.export.artwork_raster import image_of
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines import read_image


def saved(image: Image.Image, path: Path, **options: object) -> Path:
    image.save(path, **options)
    return path


def test_that_plain_files_are_kept_byte_by_byte(tmp_path: Path) -> None:
    photo = saved(Image.new("RGB", (40, 30), "teal"), tmp_path / "photo.jpg")
    clear = saved(Image.new("RGBA", (40, 30), (1, 2, 3, 4)), tmp_path / "clear.png")
    for path in (photo, clear):
        assert read_picture(path).content == path.read_bytes()
    assert read_picture(photo).extension == ".jpg"
    assert image_of(read_picture(clear).content).getpixel((0, 0)) == (1, 2, 3, 4)


@pytest.mark.parametrize(
    ("mode", "colour", "kind"),
    [("CMYK", (0, 255, 255, 0), "jpg"), ("CMYK", (0, 255, 255, 0), "tif"), ("P", 1, "png"), ("LA", (76, 128), "png"),
     ("L", 76, "bmp"), ("1", 1, "png"), ("I;16", 19532, "png"), ("RGB", (255, 0, 0), "webp")],
)  # fmt: skip
def test_that_every_colour_mode_becomes_8_bit_rgb(mode: str, colour: object, kind: str, tmp_path: Path) -> None:
    image = Image.new(mode, (8, 6), colour)
    if mode == "P":
        image.putpalette([0, 0, 0, 255, 0, 0])
    picture = read_picture(saved(image, tmp_path / f"picture.{kind}"))
    with Image.open(io.BytesIO(picture.content)) as read:
        assert read.mode in ("RGB", "RGBA")
        assert read.format in ("PNG", "JPEG")
    red, green, _, alpha = image_of(picture.content).getpixel((4, 3))
    if mode in ("CMYK", "P", "RGB"):
        assert red > 200 and green < 60
    elif mode != "1":
        assert abs(red - 76) <= 1
    assert alpha == (128 if mode == "LA" else 255)


def test_that_a_photo_is_turned_upright(tmp_path: Path) -> None:
    pixels = np.zeros((20, 40, 3), dtype=np.uint8)
    pixels[:, :20] = 255
    exif = Image.Exif()
    exif[0x0112] = 6  # turn it clockwise to see it
    picture = read_picture(saved(Image.fromarray(pixels), tmp_path / "photo.jpg", exif=exif))
    assert picture.size == (20, 40)
    assert image_of(picture.content).getpixel((10, 5))[0] > 250
    assert image_of(picture.content).getpixel((10, 35))[0] < 5
    with Image.open(io.BytesIO(picture.content)) as read:
        assert read.getexif().get(0x0112, 1) == 1


def test_that_large_pictures_are_averaged_down(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(artwork_picture, "KEPT_PIXELS", 1000)
    picture = read_picture(saved(Image.new("RGB", (100, 60), "red"), tmp_path / "large.png"))
    assert picture.size == (34, 20)
    assert image_of(picture.content).getpixel((5, 5)) == (255, 0, 0, 255)


@pytest.mark.parametrize(
    ("name", "content", "code"),
    [
        ("broken.png", b"\x89PNG\r\n\x1a\n nothing", "artwork.picture_damaged"),
        ("text.jpg", b"hello", "artwork.picture_damaged"),
        ("empty.png", b"", "source.empty"),
    ],
)
def test_that_damaged_files_get_one_sentence(
    name: str, content: bytes, code: str, tmp_path: Path, qapp: object
) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(TargetError) as caught:
        read_picture(tmp_path / name)
    assert caught.value.code == code
    assert name in str(caught.value)


def test_that_missing_files_folders_and_svgs_without_a_drawer_are_refused(tmp_path: Path) -> None:
    (tmp_path / "x.svg").write_text("<svg/>")
    for path, code in (
        (tmp_path / "no.png", "source.missing"),
        (tmp_path, "source.folder"),
        (tmp_path / "x.svg", "artwork.no_svg_here"),
    ):
        with pytest.raises(TargetError) as caught:
            read_picture(path)
        assert caught.value.code == code


def test_that_pictures_of_too_many_pixels_or_bytes_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = saved(Image.new("RGB", (100, 60), "red"), tmp_path / "large.png")
    monkeypatch.setattr(artwork, "LARGEST_PICTURE", 10)
    with pytest.raises(TargetError, match="Save it with fewer pixels"):
        read_picture(path)
    monkeypatch.setattr(read_image, "MOST_PIXELS", 1000)
    with pytest.raises(TargetError, match="100 x 60 pixels"):
        read_picture(path)
