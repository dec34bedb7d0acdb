"""Holes that are seen in a source are holes of its outline; they can be filled and opened again."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from PIL import Image, ImageDraw
from shapely.geometry import Point

from kirigami_studio.outlines.merging import Join, Merging, merged
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.parts import Strokes
from kirigami_studio.outlines.picked import picked_part
from kirigami_studio.outlines.read import read_parts, read_target
from kirigami_studio.outlines.read_image import outline_of_mask

RING = "M{a} 0A{a} {a} 0 1 0 -{a} 0A{a} {a} 0 1 0 {a} 0z"


def ring_path(outer: float, inner: float) -> str:
    return f'<path fill-rule="evenodd" d="{RING.format(a=outer)}{RING.format(a=inner)}"/>'


def missing(outline: Outline) -> float:
    return 1.0 - outline.polygon.area


@pytest.mark.parametrize("inner", [15.0, 27.5, 33.0])
def test_that_a_filled_ring_has_its_hole(inner, svg) -> None:
    outline = read_target(svg(ring_path(50, inner)))
    assert len(outline.holes) == 1 and not outline.notes
    assert missing(outline) == pytest.approx((inner / 50) ** 2, rel=2e-3)
    np.testing.assert_allclose(np.mean(outline.holes[0], axis=0), 0.0, atol=1e-3)


@pytest.mark.parametrize(
    "body",
    [
        ring_path(50, 45),
        # Icons are drawn with lines of two units in a box of 24, as paths or with a pen.
        '<circle r="9" fill="none" stroke="#000" stroke-width="2"/>',
        '<rect width="18" height="18" rx="3" fill="none" stroke="#000" stroke-width="2.5"/>',
        # A frame around a picture is no ring.
        ring_path(50, 40) + '<circle r="20"/>',
    ],
)
def test_that_a_frame_of_lines_is_a_filled_shape_whose_hole_can_be_opened(body, svg) -> None:
    outline = read_target(svg(body))
    assert not outline.holes and len(outline.filled_holes) == 1
    assert outline.notes[-1].startswith("Holes were filled")
    opened = outline.opened
    assert opened != outline and missing(opened) > 0.4 and not any("Holes" in note for note in opened.notes)
    assert opened.filled == outline and opened.filled.notes == outline.notes


def test_that_a_broad_stroke_is_a_ring(svg) -> None:
    outline = read_target(svg('<circle r="40" fill="none" stroke="#000" stroke-width="24"/>'))
    assert missing(outline) == pytest.approx((28 / 52) ** 2, rel=5e-3)
    filled = read_target(svg('<circle r="40" fill="none" stroke="#000" stroke-width="24"/><circle r="9"/>'))
    assert not filled.holes, "what lies within belongs to the shape"


def test_that_islands_in_a_hole_are_left_out_and_said(svg) -> None:
    body = (
        f'<path fill-rule="evenodd" d="{RING.format(a=50)}M-30 -5h20v20h-20zM10 -5h20v20h-20z"/><circle r="3" cx="20"/>'
    )
    outline = read_target(svg(body))
    assert len(outline.holes) == 2
    assert outline.notes == ("1 piece in a hole was left out.",)


def test_that_thin_contours_of_one_layer_are_holes_and_those_of_another_engraving(dxf) -> None:
    def plate(space, drawing) -> None:
        space.add_circle((0, 0), 50)
        space.add_circle((0, 0), 50)  # drawn twice
        space.add_circle((10, 0), 20)
        space.add_circle((10, 0), 5)  # in the hole
        space.add_circle((-30, 0), 5, dxfattribs={"layer": "ENGRAVE"})

    outline = read_target(dxf(plate))
    assert missing(outline) == pytest.approx(0.16, rel=1e-3)
    assert [note for note in outline.notes if "inside the outer" in note]
    left = outline.points[:, 0].min() * math.sqrt(math.pi) * 50
    assert np.mean(outline.holes[0], axis=0) * math.sqrt(math.pi) * 50 - (left, 0) == pytest.approx([60, 0], abs=0.1)


def test_that_the_usual_parts_make_the_usual_outline(dxf) -> None:
    path = dxf(lambda space, drawing: [space.add_circle((0, 0), r) for r in (50, 25)])
    source = read_parts(path)
    assert source.usual == (1, 2)
    found = merged(source, source.of(source.usual), Merging())
    assert found.outline == read_target(path) and found.outline.holes
    assert found.shape.area == pytest.approx(math.pi * (2500 - 625), rel=1e-3)


def test_that_a_hatch_with_a_hole_has_it(dxf) -> None:
    def draw(space, drawing) -> None:
        hatch = space.add_hatch()
        hatch.paths.add_polyline_path([(0, 0), (9, 0), (9, 9), (0, 9)], flags=1)
        hatch.paths.add_polyline_path([(3, 3), (6, 3), (6, 6), (3, 6)], flags=16)

    assert missing(read_target(dxf(draw))) == pytest.approx(1 / 9, rel=1e-3)


def test_that_a_hull_has_no_holes(svg) -> None:
    source = read_parts(svg(ring_path(50, 20)))
    assert not merged(source, source.parts, Merging(Join.HULL)).outline.holes


def drawn(*discs: tuple[float, int], size: int = 300, mode: str = "L", start: int = 255) -> Image.Image:
    image = Image.new(mode, (size, size), start)
    for radius, level in discs:
        low, high = 0.5 * size - radius, 0.5 * size + radius
        ImageDraw.Draw(image).ellipse((low, low, high, high), fill=level)
    return image


def test_that_a_picture_has_the_holes_that_are_seen(tmp_path) -> None:
    drawn((120, 0), (60, 255), (15, 0)).save(tmp_path / "ring.png")
    outline = read_target(tmp_path / "ring.png")
    assert missing(outline) == pytest.approx(0.25, rel=0.02)
    drawn((120, 0), (110, 255)).save(tmp_path / "line.png")
    line = read_target(tmp_path / "line.png")
    assert not line.holes and missing(line.opened) == pytest.approx((110 / 120) ** 2, rel=0.02)


def test_that_noise_makes_no_holes(tmp_path) -> None:
    noisy = np.asarray(drawn((120, 0), (60, 255)), dtype=float) * 0.7 + 40
    noisy += np.random.default_rng(0).normal(0, 25, noisy.shape)
    Image.fromarray(np.clip(noisy, 0, 255).astype(np.uint8)).save(tmp_path / "scan.jpg")
    outline = read_target(tmp_path / "scan.jpg")
    assert len(outline.holes) <= 1 and missing(outline.opened) == pytest.approx(0.25, rel=0.1)


def test_that_an_object_that_is_clicked_on_has_its_holes(tmp_path) -> None:
    drawn((120, 0), (60, 255)).save(tmp_path / "ring.png")
    region = picked_part(tmp_path / "ring.png", Strokes(((150.0, 60.0),))).region
    assert region.area == pytest.approx(Point(0, 0).buffer(120).area - Point(0, 0).buffer(60).area, rel=0.03)


def test_that_a_mask_has_its_holes() -> None:
    mask = np.asarray(drawn((120, 0), (60, 255))) == 0
    assert missing(outline_of_mask(mask, "ring")) == pytest.approx(0.25, rel=0.02)


def test_that_rings_of_a_table_are_holes_however_thin(tmp_path) -> None:
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    path = tmp_path / "frame.json"
    path.write_text(json.dumps({"rings": [square.tolist(), (0.9 * square + 0.05).tolist()], "name": "frame"}))
    outline = read_target(path)
    assert missing(outline) == pytest.approx(0.81) and outline.name == "frame"
