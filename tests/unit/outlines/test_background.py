"""Shapes are told from the colour of the border: colour, light, shadows, borders, pages; and objects from a click."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from PIL import Image, ImageChops, ImageDraw, ImageFilter

from kirigami_studio.foundation.errors import TargetError, UsageError
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.parts import Strokes
from kirigami_studio.outlines.picked import picked_part
from kirigami_studio.outlines.read import read_parts, read_target
from kirigami_studio.outlines.read_image import image_parts, is_plain_picture, read_image
from kirigami_studio.studio.targets import outline_of
from tests.refusals import refused

SIZE = 360
Colour = tuple[int, int, int]


def painted(mask: Image.Image, shape: Colour, ground: Colour | Image.Image) -> Image.Image:
    """A shape of one colour on another, or on a picture."""
    below = ground if isinstance(ground, Image.Image) else Image.new("RGB", mask.size, ground)
    return Image.composite(Image.new("RGB", mask.size, shape), below, mask)


def lit(image: Image.Image, light: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> Image.Image:
    """A picture in uneven light; x and y run from 0 to 1."""
    y, x = np.mgrid[: image.height, : image.width] / (SIZE - 1.0)
    return Image.fromarray((np.asarray(image) * light(x, y)[..., None]).clip(0, 255).astype(np.uint8))


def shaded(mask: Image.Image, ground: Colour) -> Image.Image:
    """A ground with the soft shadow of a shape."""
    shadow = ImageChops.offset(mask, 8, 9).filter(ImageFilter.GaussianBlur(7)).point(lambda level: int(0.55 * level))
    return Image.composite(Image.new("RGB", mask.size), Image.new("RGB", mask.size, ground), shadow)


@pytest.fixture(scope="module")
def mask(coverage) -> Callable[..., Image.Image]:
    """Coverage of a library silhouette, 0 to 255, maybe of another share of the picture, moved by pixels."""

    def made(name: str = "heart", share: float = 0.75, by: tuple[int, int] = (0, 0)) -> Image.Image:
        image = Image.fromarray((255 * coverage(silhouettes.load(name), SIZE, share)).astype(np.uint8))
        return image.transform(image.size, Image.Transform.AFFINE, (1, 0, -by[0], 0, 1, -by[1]))

    return made


@pytest.fixture
def agreement(tmp_path, iou) -> Callable[[Image.Image, Image.Image], float]:
    """IoU of a picture as it is read with a mask."""

    def measured(image: Image.Image, wanted: Image.Image, name: str = "seen.png") -> float:
        image.save(tmp_path / name, quality=80)
        wanted.save(tmp_path / "wanted.png")
        return iou(read_image(tmp_path / name), read_image(tmp_path / "wanted.png"))

    return measured


@pytest.mark.parametrize(
    ("shape", "ground"),
    [
        ((255, 0, 0), (0, 130, 0)),  # equally light
        ((70, 130, 230), (200, 120, 40)),
        ((238, 238, 238), (255, 255, 255)),
        ((255, 250, 205), (255, 255, 255)),
        ((38, 30, 30), (0, 0, 0)),
    ],
)
@pytest.mark.parametrize("name", ["seen.png", "seen.jpg"])
def test_that_a_shape_is_told_by_its_colour_and_not_by_grey(shape, ground, name, mask, agreement) -> None:
    assert agreement(painted(mask(), shape, ground), mask(), name) > 0.98


def test_that_a_pale_shape_is_not_its_darkest_detail(mask, agreement) -> None:
    image = painted(mask(), (255, 250, 200), (255, 255, 255))
    ImageDraw.Draw(image).ellipse((150, 140, 200, 190), fill=(20, 20, 20))
    assert agreement(image, mask(), "seen.jpg") > 0.98


def test_that_a_shape_of_pale_and_strong_colours_is_whole(mask, agreement) -> None:
    image = painted(mask(), (200, 30, 30), (255, 255, 255))
    left = mask().copy()
    left.paste(0, (SIZE // 2, 0, SIZE, SIZE))
    assert agreement(painted(left, (255, 240, 170), image), mask()) > 0.98


@pytest.mark.parametrize("by", [(0, 0), (0, 72), (-54, 0)])
@pytest.mark.parametrize(("shape", "ground"), [((0, 0, 0), (255, 255, 255)), ((255, 255, 255), (20, 80, 60))])
def test_that_a_shape_at_the_border_is_not_the_background(by, shape, ground, mask, agreement) -> None:
    drawn = Image.new("L", (SIZE, SIZE))
    size = SIZE if by == (0, 0) else int(0.8 * SIZE)
    corner = [(SIZE - size) // 2 + move for move in by]
    box = (*corner, corner[0] + size - 1, corner[1] + size - 1)
    ImageDraw.Draw(drawn).rounded_rectangle(box, 0.2 * size, fill=255)
    frame = Image.new("L", (SIZE + 40, SIZE + 40))
    frame.paste(drawn, (20, 20))
    assert agreement(painted(drawn, shape, ground), frame) > 0.98


@pytest.mark.parametrize(
    "light",
    [
        lambda x, y: 0.35 + 0.65 * x,
        lambda x, y: 1 - 0.6 * np.hypot(x, y) / 1.42,
        lambda x, y: 1 - ((x - 0.5) ** 2 + (y - 0.5) ** 2),
        lambda x, y: 0.5 + 0.5 * np.exp(-((x - 0.3) ** 2 + (y - 0.3) ** 2) / 0.3),
    ],
)
@pytest.mark.parametrize("shape", [(50, 50, 55), (60, 90, 180), (200, 200, 190)])
def test_that_uneven_light_leaves_the_shape_as_it_is(light, shape, mask, agreement) -> None:
    assert agreement(lit(painted(mask("fish"), shape, (250, 250, 245)), light), mask("fish")) > 0.98


@pytest.mark.parametrize("shape", [(200, 0, 0), (10, 10, 10), (250, 210, 20)])
@pytest.mark.parametrize("ground", [(255, 255, 255), (235, 220, 190)])
def test_that_a_drop_shadow_does_not_belong_to_the_shape(shape, ground, mask, agreement) -> None:
    assert agreement(painted(mask(), shape, shaded(mask(), ground)), mask()) > 0.98


def test_that_a_transparent_picture_has_its_opaque_shape_without_the_shadow(mask, agreement) -> None:
    shadow = ImageChops.offset(mask(), 6, 8).filter(ImageFilter.GaussianBlur(6)).point(lambda level: int(0.6 * level))
    image = Image.new("RGBA", (SIZE, SIZE))
    image.putalpha(shadow)
    image.paste((240, 240, 240, 255), (0, 0), mask())
    assert agreement(image, mask()) > 0.98
    faint = Image.new("RGBA", (SIZE, SIZE), (10, 10, 10))
    faint.putalpha(mask().point(lambda level: int(0.4 * level)))
    assert agreement(faint, mask()) > 0.99


def test_that_the_shape_on_a_page_is_taken_and_the_page_is_told(mask, agreement, tmp_path) -> None:
    table = Image.new("RGB", (SIZE, SIZE), (60, 50, 40))
    ImageDraw.Draw(table).polygon([(20, 15), (345, 25), (335, 350), (12, 340)], fill=(246, 246, 240))
    assert agreement(painted(mask(share=0.5), (180, 30, 40), table), mask(share=0.5)) > 0.98
    assert "The page around the shape was left out." in read_image(tmp_path / "seen.png").notes
    assert not is_plain_picture(tmp_path / "seen.png") and is_plain_picture(tmp_path / "wanted.png")


def test_that_the_lines_of_squared_paper_are_not_the_shape(mask, agreement) -> None:
    paper = Image.new("RGB", (SIZE, SIZE), (250, 250, 250))
    draw = ImageDraw.Draw(paper)
    for at in range(0, SIZE, 18):
        draw.line([(at, 0), (at, SIZE)], fill=(190, 210, 240))
        draw.line([(0, at), (SIZE, at)], fill=(190, 210, 240))
    assert agreement(painted(mask(), (20, 20, 20), paper), mask()) > 0.98


def test_that_the_threshold_of_a_coloured_picture_is_its_likeness_to_the_ground(mask, tmp_path) -> None:
    image = painted(mask(), (255, 0, 0), (0, 130, 0))
    image.save(tmp_path / "seen.png")
    for threshold in (0.2, 0.8):
        assert read_image(tmp_path / "seen.png", threshold).size == pytest.approx((270, 250), abs=12)


@pytest.mark.parametrize("name", ["seen.svg", "seen.txt", "seen"])
def test_that_the_content_of_a_file_says_its_kind(name, mask, tmp_path, iou) -> None:
    painted(mask(), (0, 0, 0), (255, 255, 255)).save(tmp_path / name, format="PNG")
    assert iou(read_target(tmp_path / name), silhouettes.load("heart")) > 0.99
    assert read_parts(tmp_path / name).unit == "px"


def test_that_the_first_picture_of_an_animation_is_read(mask, tmp_path, iou) -> None:
    frames = [painted(mask(name), (0, 0, 0), (255, 255, 255)) for name in ("star", "heart")]
    for ending in (".gif", ".webp"):
        frames[0].save(tmp_path / f"moves{ending}", save_all=True, append_images=frames[1:])
        assert iou(read_target(tmp_path / f"moves{ending}"), silhouettes.load("star")) > 0.99


# a click ------------------------------------------------------------------------------------------------------------


@pytest.fixture
def still_life(mask, tmp_path):
    """A grey shape with a shadow and a red one on wood, and the masks of both."""
    grain = 10 * np.sin(np.arange(SIZE) / 4.0)[None, :] + np.zeros((SIZE, 1))
    wood = Image.fromarray((np.array([160, 115, 75]) + grain[..., None]).clip(0, 255).astype(np.uint8))
    small, large = mask("star", 0.3, (-90, -90)), mask("gear", 0.45, (70, 60))
    image = painted(large, (225, 225, 220), painted(small, (190, 30, 40), wood))
    path = tmp_path / "still life.jpg"
    image.save(path, quality=90)
    return path, small, large


def overlap(part, wanted: Image.Image) -> float:
    # Drawn in eight times the size: Pillow's polygons hold their edges.
    drawn = Image.new("L", (8 * wanted.width, 8 * wanted.height))
    ring = [(8 * x - 0.5, 8 * (wanted.height - y) - 0.5) for x, y in part.region.exterior.coords]
    ImageDraw.Draw(drawn).polygon(ring, fill=255)
    ours, theirs = (np.asarray(one.resize(wanted.size, Image.Resampling.BOX)) / 255.0 for one in (drawn, wanted))
    return float(np.sum(np.minimum(ours, theirs)) / np.sum(np.maximum(ours, theirs)))


def test_that_a_click_takes_the_object_there(still_life) -> None:
    path, small, large = still_life
    assert overlap(picked_part(path, Strokes(((90.0, 90.0),))), small) > 0.97
    assert overlap(picked_part(path, Strokes(((250.0, 200.0),))), large) > 0.97


def test_that_a_second_click_adds_and_another_kind_removes(mask, tmp_path) -> None:
    whole, left = mask("square", 0.6), mask("square", 0.6)
    left.paste(0, (SIZE // 2, 0, SIZE, SIZE))
    path = tmp_path / "flag.png"
    image = painted(whole, (30, 60, 170), (240, 235, 225))
    painted(left, (240, 210, 60), image).save(path)
    one, other = (SIZE * 0.35, SIZE * 0.5), (SIZE * 0.65, SIZE * 0.5)
    assert overlap(picked_part(path, Strokes((one,))), left) > 0.97
    assert overlap(picked_part(path, Strokes((one, other))), whole) > 0.97
    assert overlap(picked_part(path, Strokes((one,), (other,))), left) > 0.97


def test_that_a_right_click_takes_a_shadow_away(mask, tmp_path) -> None:
    path = tmp_path / "shadow.png"
    painted(mask(), (50, 50, 50), shaded(mask(), (255, 255, 255))).save(path)
    place, beside = (SIZE * 0.5, SIZE * 0.5), (SIZE * 0.5 + 8, SIZE * 0.875 + 4)
    with_click = picked_part(path, Strokes((place,), (beside,)))
    assert overlap(with_click, mask()) > max(0.96, overlap(picked_part(path, Strokes((place,))), mask()))


@pytest.mark.parametrize(
    ("strokes", "code"),
    [
        (Strokes(), "object.no_place"),
        (Strokes(((999.0, 5.0),)), "object.outside"),
        (Strokes(((4.0, 4.0),), ((4.0, 4.0),)), "object.nothing_there"),
    ],
)
def test_that_places_that_say_nothing_are_refused(strokes, code, still_life) -> None:
    with refused(TargetError, "source.not_usable") as caught:
        picked_part(still_life[0], strokes)
    assert caught.value.__cause__.code == code


def test_that_an_object_is_a_target_from_python_and_only_of_a_picture(still_life, iou, mask) -> None:
    from kirigami_studio.studio.targets import PartChoice

    path, small, _ = still_life
    choice = PartChoice.of(None, None, None, None, [(90, 90)])
    small.save(path.with_name("small.png"))
    assert iou(outline_of(path, choice), read_image(path.with_name("small.png"))) > 0.97
    with refused(UsageError, "object.no_picture"):
        outline_of(path.with_name("drawing.svg"), choice)
    with refused(UsageError, "option.object_with_parts"):
        PartChoice.of("all", None, None, None, [(90, 90)])


def test_that_colours_are_offered_and_not_taken_without_asking(still_life) -> None:
    source = image_parts(still_life[0])
    assert any(part.is_aside for part in source.parts)
    assert not any(part.is_aside for part in source.of(source.usual))


def test_that_an_outline_on_paper_is_a_shape(mask, tmp_path, iou) -> None:
    page = Image.new("RGB", (SIZE, SIZE), (250, 250, 245))
    ring = np.asarray(mask().filter(ImageFilter.FIND_EDGES)) > 40
    pen = Image.fromarray(np.where(ring, 255, 0).astype(np.uint8)).filter(ImageFilter.MaxFilter(3))
    painted(pen, (20, 20, 40), page).save(tmp_path / "pen.png")
    outline = read_image(tmp_path / "pen.png")
    assert isinstance(outline, Outline) and iou(outline, silhouettes.load("heart")) > 0.97
