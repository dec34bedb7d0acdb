"""Drawings give all their parts, and chosen parts become one outline."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageDraw
from shapely.affinity import scale
from shapely.geometry import Point, Polygon, box

from kirigami_studio.foundation.errors import KirigamiError, TargetError
from kirigami_studio.outlines import svg_curves
from kirigami_studio.outlines.bezier import flattened_curve
from kirigami_studio.outlines.merging import Join, Merging, merged
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.parts import MOST_PARTS, DrawnPartKind, SourceParts, StrokeStyle
from kirigami_studio.outlines.read import read_parts
from tests.refusals import refused

DATA = Path(__file__).resolve().parents[2] / "data" / "targets"
LAYER = 'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" inkscape:groupmode="layer"'
LOGO = f"""
<g {LAYER} inkscape:label="Badge"><circle id="disc" cx="30" cy="40" r="20" fill="#c03030"/>
<path id="ring" fill-rule="evenodd" fill="#0000ff" d="M60 20h40v40h-40z M70 30h20v20h-20z"/></g>
<g {LAYER} inkscape:label="Line"><path id="swoosh" d="M10 80L110 80" fill="none" stroke="#108040" stroke-width="5"/>
<g style="display:none"><rect width="300" height="300"/></g></g>"""
MM = 'width="120mm" height="100mm" viewBox="0 0 120 100"'


@pytest.fixture
def logo(svg) -> SourceParts:
    return read_parts(svg(LOGO, MM))


def test_that_parts_have_names_layers_colours_kinds_and_sizes(logo) -> None:
    told = [(part.name, part.layer, part.colour, part.kind) for part in logo.parts]
    assert told == [
        ("disc", "Badge", "#c03030", DrawnPartKind.FILLED),
        ("ring", "Badge", "#0000ff", DrawnPartKind.FILLED),
        ("swoosh", "Line", "#108040", DrawnPartKind.STROKED),
    ]
    assert [part.size for part in logo.parts] == [pytest.approx(size) for size in ((40, 40), (40, 40), (100, 0))]
    assert logo.parts[2].pen.width == pytest.approx(5.0) and logo.unit == "mm"
    assert logo.parts[1].region.area == pytest.approx(1600 - 400)
    assert logo.layers == ("Badge", "Line")


def test_that_up_stays_up_in_parts(logo) -> None:
    assert logo.parts[0].bounds[1] > logo.parts[2].bounds[3]


@pytest.mark.parametrize(
    ("words", "names"),
    [
        ("all", ["disc", "ring", "swoosh"]),
        ("largest", ["ring"]),  # by its silhouette, as outlines are read
        ("ring", ["ring"]),
        ("RING, line", ["ring", "swoosh"]),
        ("1,3", ["disc", "swoosh"]),
        ("#c03030", ["disc"]),
        ("Badge", ["disc", "ring"]),
    ],
)
def test_that_parts_are_chosen_by_name_number_layer_and_colour(words, names, logo) -> None:
    assert [part.name for part in logo.chosen(words)] == names


def test_that_an_unknown_name_is_refused_with_those_there_are(logo) -> None:
    with refused(KirigamiError, "parts.unknown", name="disk", names="Badge, Line, disc, ring, swoosh"):
        logo.chosen("disk")


def outlined(source: SourceParts, words: str, **how: object) -> Outline:
    return merged(source, source.chosen(words), Merging(**how)).outline


def test_that_one_part_is_taken_with_its_size_and_the_rest_is_told(logo, iou) -> None:
    outline = outlined(logo, "ring")
    assert outline.size == pytest.approx((40, 40)) and outline.name == "ring"
    assert iou(outline.filled, Outline.from_points(np.asarray(box(0, 0, 1, 1).exterior.coords))) > 0.999
    assert outline.notes == ("2 parts were left out: disc, swoosh.",) and outline.polygon.area == pytest.approx(0.75)


def test_that_one_part_without_a_name_of_its_own_is_called_as_its_drawing(svg) -> None:
    """Before, the target and all its files were called "shape 1"."""
    source = read_parts(svg('<rect width="50" height="50"/><rect x="90" id="door" width="20" height="20"/>'))
    assert [part.name for part in source.parts] == ["shape 1", "door"]
    assert outlined(source, "shape 1").name == source.name and outlined(source, "door").name == "door"


def test_that_parts_that_do_not_touch_are_united_to_the_largest_and_that_is_said(logo) -> None:
    assert any("1 smaller piece was left out" in note for note in outlined(logo, "disc,ring").notes)


def test_that_a_bridge_of_the_width_asked_for_holds_parts_together(logo) -> None:
    found = merged(logo, logo.chosen("disc,ring"), Merging(Join.BRIDGE, bridge=3.0))
    (bridge,) = found.bridges
    disc, square = Point(30, -40).buffer(20, quad_segs=64), box(60, -60, 100, -20) - box(70, -50, 90, -30)
    assert bridge.intersection(box(51, -100, 59, 0)).bounds == pytest.approx((51, -41.5, 59, -38.5), abs=0.1)
    assert found.shape.symmetric_difference(disc.union(square).union(bridge)).area < 2.0
    assert found.outline.size == pytest.approx((90, 40), abs=0.1)


def test_that_touching_parts_get_no_bridge(svg) -> None:
    source = read_parts(svg('<rect width="50" height="50"/><rect x="50" width="50" height="50"/>'))
    assert not merged(source, source.parts, Merging(Join.BRIDGE)).bridges


def test_that_many_parts_are_bridged_by_a_tree(svg) -> None:
    dots = "".join(f'<circle cx="{20 * (k % 5)}" cy="{20 * (k // 5)}" r="5"/>' for k in range(20))
    source = read_parts(svg(dots))
    found = merged(source, source.parts, Merging(Join.BRIDGE, bridge=2.0))
    assert len(found.bridges) == 19
    assert all(found.shape.buffer(0.01).contains(part.region) for part in source.parts)


def test_that_a_hull_covers_all_parts_and_a_tight_one_is_smaller(logo) -> None:
    wide = merged(logo, logo.parts, Merging(Join.HULL)).shape
    tight = merged(logo, logo.parts, Merging(Join.TIGHT)).shape
    parts = [part.region for part in logo.parts if part.is_closed]
    assert all(shape.buffer(0.01).contains(part) for shape in (wide, tight) for part in parts)
    assert tight.area < 0.95 * wide.area and wide.equals(wide.convex_hull)


@pytest.mark.parametrize(
    ("style", "area"),
    [
        ("stroke-linecap:butt", 500.0),
        ("stroke-linecap:square", 525.0),
        ("stroke-linecap:round", 500.0 + np.pi * 2.5**2),
    ],
)
def test_that_strokes_are_taken_as_they_are_painted(style, area, svg) -> None:
    source = read_parts(svg(f'<path d="M10 80L110 80" fill="none" stroke="red" style="stroke-width:5;{style}"/>'))
    assert merged(source, source.parts, Merging(as_painted=True)).shape.area == pytest.approx(area, rel=2e-3)


def test_that_strokes_scale_with_their_group(svg) -> None:
    body = '<g transform="scale(2)"><path d="M5 40L55 40" fill="none" stroke="red" stroke-width="3"/></g>'
    source = read_parts(svg(body, 'width="200mm" height="200mm" viewBox="0 0 200 200"'))
    assert source.parts[0].pen.width == pytest.approx(6.0)


def test_that_an_open_drawing_has_an_outline_as_painted_that_is_refused_otherwise(svg) -> None:
    source = read_parts(svg('<path fill="none" stroke="red" stroke-width="6" d="M10 10h80v80h-80v-50"/>'))
    assert source.is_ambiguous
    with refused(TargetError, "parts.no_area"):
        merged(source, source.parts, Merging())
    assert merged(source, source.parts, Merging(as_painted=True)).outline.size == pytest.approx((86, 86))


def test_that_lines_without_a_width_take_the_one_given(dxf) -> None:
    source = read_parts(dxf(lambda space, _: space.add_line((0, 0), (100, 0))))
    found = merged(source, source.parts, Merging(as_painted=True, stroke=10.0))
    assert found.outline.size == pytest.approx((110, 10), abs=0.1)


@pytest.mark.parametrize(
    ("how", "word"),
    [
        ({"join": Join.BRIDGE, "bridge": 1000.0}, "bridge must be"),
        ({"join": Join.BRIDGE, "bridge": -1.0}, "bridge must be"),
        ({"join": Join.BRIDGE, "bridge": float("nan")}, "bridge must be"),
        ({"as_painted": True, "stroke": 0.0}, "stroke must be"),
        ({"join": Join.TIGHT, "tightness": 2.0}, "tightness"),
    ],
)
def test_that_numbers_that_make_no_sense_are_refused(how, word, dxf) -> None:
    def draw(space, _drawing) -> None:
        space.add_circle((0, 0), 5)
        space.add_circle((30, 0), 5)

    source = read_parts(dxf(draw))
    with pytest.raises(TargetError, match=word):
        merged(source, source.parts, Merging(**how))


def test_that_layers_of_a_dxf_give_parts_in_mm_and_hidden_ones_are_told(dxf) -> None:
    def draw(space, drawing) -> None:
        drawing.layers.add("Plate", color=1)
        drawing.layers.add("Guides").off()
        space.add_lwpolyline([(0, 0), (4, 0), (4, 2), (0, 2)], close=True, dxfattribs={"layer": "Plate"})
        space.add_circle((2, 1), 0.5, dxfattribs={"layer": "Plate"})
        space.add_line((9, 9), (12, 9), dxfattribs={"layer": "Marks", "color": 3})
        space.add_line((9, 8), (12, 8), dxfattribs={"layer": "Guides"})

    source = read_parts(dxf(draw, units=1))
    told = [(part.layer, part.kind.value, part.colour) for part in source.parts]
    assert told == [("Plate", "closed", "#ff0000"), ("Plate", "closed", "#ff0000"), ("Marks", "stroked", "#00ff00")]
    assert source.parts[0].size == pytest.approx((4 * 25.4, 2 * 25.4))
    assert source.left_out == ("Hidden layers were left out: Guides.",)


def test_that_texts_of_an_svg_are_letters_on_a_layer_of_their_own(svg) -> None:
    body = '<text x="50" y="40" font-size="20" text-anchor="middle" font-family="No Such Family">HI</text>'
    source = read_parts(svg(body, MM))
    assert [(part.name, part.layer, part.kind) for part in source.parts] == [
        ("H", "HI", DrawnPartKind.FILLED),
        ("I", "HI", DrawnPartKind.FILLED),
    ]
    left, right = source.parts[0].bounds, source.parts[1].bounds
    assert left[1] == pytest.approx(-40) and 12 < left[3] - left[1] < 17  # on the base line, as high as capitals are
    assert (left[0] + right[2]) / 2 == pytest.approx(50, abs=2.5) and right[0] > left[2]
    (note,) = source.left_out
    assert note.startswith("The font No Such Family is not at hand")
    assert merged(source, source.parts, Merging(Join.BRIDGE)).outline.size == pytest.approx(
        (right[2] - left[0], left[3] - left[1]), rel=0.05
    )


def test_that_turned_texts_of_a_dxf_lie_where_they_are_drawn(dxf) -> None:
    def draw(space, _drawing) -> None:
        space.add_text("H", height=10, rotation=90, dxfattribs={"insert": (50, 20)})
        space.add_mtext("H\\PH", dxfattribs={"insert": (0, 100), "char_height": 6, "attachment_point": 1})

    turned, upper, lower = read_parts(dxf(draw)).parts
    assert turned.bounds[2] == pytest.approx(50, abs=0.3) and turned.bounds[0] == pytest.approx(40, abs=0.3)
    assert turned.bounds[1] > 20
    assert upper.bounds[3] == pytest.approx(100, abs=0.3) and upper.size[1] == pytest.approx(6, abs=0.3)
    assert lower.bounds[3] == pytest.approx(90, abs=0.3)


def test_that_an_empty_or_endless_text_is_left_out(svg) -> None:
    body = f'<circle r="20"/><text x="5" y="5"> </text><text x="5" y="5">{"endless " * 5000}</text>'
    source = read_parts(svg(body))
    assert len(source.parts) == 1 and any("Text was left out" in note for note in source.left_out)


AMBIGUOUS = (
    ('<circle r="30"/><circle cx="90" r="20"/>', True),
    ('<circle r="30"/><circle cx="30" r="20"/>', False),
    ('<circle r="30"/>', False),
    ('<path d="M0 0h50v50h-50z M10 10v30h30v-30z"/>', False),
    ('<circle r="30"/><circle cx="90" r="1"/>', False),
    ('<path stroke="red" fill="none" d="M0 0h50v50"/>', True),
    ('<path stroke="red" fill="none" d="M0 0h50v50h-50z"/>', False),
    ('<rect width="200" height="100" fill="#cde"/><circle cx="60" cy="60" r="30"/>', True),
    ('<rect width="200" height="200" fill="#fff"/><circle cx="60" cy="60" r="50"/>', False),
    ('<circle r="3"/><path stroke="red" fill="none" d="M-50 -50h100v100h-100v-50"/>', True),
)


@pytest.mark.parametrize(("body", "asks"), AMBIGUOUS)
def test_that_only_drawings_with_a_choice_are_asked_about(body, asks, svg) -> None:
    assert read_parts(svg(body)).is_ambiguous is asks


def test_that_one_outline_filled_and_stroked_is_one_shape_although_rounding_tells_both_apart() -> None:
    read = read_parts(DATA / "fill_and_stroke.svg")
    filled, stroked = read.parts
    region = scale(filled.region, 1.0 + 1e-13, 1.0 + 1e-13)
    stroked = replace(stroked, region=region, pen=StrokeStyle(0.1))  # a broad one would count as painted
    assert 0.0 < stroked.region.area - filled.region.area < 1e-9, "so this test can fail"
    source = replace(read, parts=(filled, stroked))
    assert not source.is_ambiguous
    assert [part.name for part in source.chosen("largest")] == ["body"]
    assert merged(source, source.chosen("largest"), Merging()).outline.size == pytest.approx((60.0, 31.24), abs=0.01)


def test_that_the_largest_of_open_lines_is_taken_and_refused_for_want_of_an_area(svg) -> None:
    source = read_parts(svg('<path d="M10 10L60 10M10 30L70 30" stroke="black" fill="none"/>'))
    largest = source.chosen("largest")
    assert [part.size[0] for part in largest] == [60.0]
    with pytest.raises(TargetError) as caught:
        merged(source, largest, Merging())
    assert caught.value.code == "parts.no_area"


def test_that_pieces_of_one_path_are_parts_of_their_own(svg) -> None:
    source = read_parts(svg('<path id="word" d="M0 0h10v10h-10z M20 0h5v5h-5z"/>'))
    assert [part.name for part in source.parts] == ["word (1)", "word (2)"]


def test_that_the_smallest_of_too_many_parts_are_left_out_and_said(svg) -> None:
    many = "".join(f'<circle cx="{9 * k}" r="{1 + k / 1000}"/>' for k in range(MOST_PARTS + 20))
    source = read_parts(svg(many))
    assert len(source.parts) == MOST_PARTS and min(part.size[0] for part in source.parts) > 2.0
    assert source.left_out[-1] == "20 parts were left out: only the 500 largest are offered."


def bomb(tmp_path: Path) -> Path:
    """Blocks that insert the next one ten times, twelve deep."""
    path = tmp_path / "bomb.dxf"
    insert = "0 INSERT 8 0 2 B{} 10 0 20 0 30 0 "
    blocks = [f"0 BLOCK 8 0 2 B{k} 70 0 10 0 20 0 30 0 {insert.format(k + 1) * 10}0 ENDBLK " for k in range(12)]
    last = "0 BLOCK 8 0 2 B12 70 0 10 0 20 0 30 0 0 ENDBLK "
    words = f"0 SECTION 2 BLOCKS {''.join(blocks)}{last}0 ENDSEC 0 SECTION 2 ENTITIES {insert.format(0)}0 ENDSEC 0 EOF"
    path.write_text("\n".join(words.split()) + "\n")
    return path


def huge_spline(tmp_path: Path) -> Path:
    """A spline that reaches 1e300."""
    path = tmp_path / "spline.dxf"
    points = "10 0 20 0 30 0 10 20 20 1e300 30 0 10 10 20 50 30 0 10 0 20 0 30 0"
    words = f"0 SECTION 2 ENTITIES 0 SPLINE 8 0 70 8 71 3 72 8 73 4 40 0 40 0 40 0 40 0 40 1 40 1 40 1 40 1 {points}"
    path.write_text("\n".join(f"{words} 0 ENDSEC 0 EOF".split()) + "\n")
    return path


def written_svg(body: str):
    def write(tmp_path: Path) -> Path:
        path = tmp_path / "bomb.svg"
        path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg">{body}</svg>')
        return path

    return write


def scribble(count: int) -> str:
    ends = np.random.default_rng(0).random((count, 2)) * 100
    return f'<polyline fill="none" stroke="red" points="{" ".join(f"{x:.3f},{y:.3f}" for x, y in ends)}"/>'


@pytest.mark.parametrize(
    "write",
    [
        bomb,
        huge_spline,
        written_svg(f'<path fill="rgb({"1" * 30_000},0,0)" d="M0 0h9v9z"/>'),
        written_svg('<rect width="1" height="2"/>' * 90_000),
        written_svg(f'<path d="M0 0{"L1 2" * 500_000}"/>'),
        written_svg(f'<path d="M0 0 {" ".join(["C1 2 3 4 5 6"] * 40_000)}"/>'),
        written_svg(scribble(20_000)),
    ],
    ids=["blocks", "spline", "digits", "rectangles", "points", "curves", "scribble"],
)
def test_that_a_drawing_that_unfolds_without_end_is_given_up_in_time(write, tmp_path) -> None:
    path = write(tmp_path)
    read_parts_of_a_square(tmp_path)  # what is imported first is not the drawing's fault
    begun = time.thread_time()
    try:
        source = read_parts(path)
        merged(source, source.parts, Merging())
    except TargetError as error:
        assert len(str(error)) < 400
    assert time.thread_time() - begun < 5.0


def test_that_curves_are_counted_as_they_are_flattened_and_refused_before(tmp_path, monkeypatch) -> None:
    path = written_svg('<path d="M0 0 L9 0 Q20 5 9 9 C5 30 -5 30 0 9 A6 9 0 0 1 0 0 Z"/>')(tmp_path)
    drawn: list[int] = []

    def counting(controls, tolerance):
        vertices = flattened_curve(controls, tolerance)
        drawn.append(len(vertices))
        return vertices

    monkeypatch.setattr(svg_curves, "flattened_curve", counting)
    read_parts(path)
    curves, vertices = len(drawn), sum(drawn) + 3  # the start, the end of the line, and the start again
    assert curves > 3
    monkeypatch.setattr(svg_curves, "MOST_VERTICES", vertices)
    read_parts(path)
    assert len(drawn) == 2 * curves
    monkeypatch.setattr(svg_curves, "MOST_VERTICES", vertices - 1)
    with pytest.raises(TargetError, match=f"have {vertices} points"):
        read_parts(path)
    assert len(drawn) == 2 * curves


def test_that_a_control_that_is_no_number_is_an_error() -> None:
    with pytest.raises(ValueError, match="NaN"):
        flattened_curve(np.array([[0.0, 0.0], [np.nan, 1.0], [2.0, 0.0]]), 0.1)


def read_parts_of_a_square(tmp_path: Path) -> None:
    path = tmp_path / "square.svg"
    path.write_text('<svg xmlns="http://www.w3.org/2000/svg"><rect width="9" height="9"/></svg>')
    assert isinstance(read_parts(path).parts[0].region, Polygon)


def islands(tmp_path: Path, **colours: str) -> Path:
    """A disc, a square and a speck on white."""
    page = Image.new("RGB", (300, 200), "white")
    draw = ImageDraw.Draw(page)
    draw.ellipse((20, 20, 120, 120), fill=colours.get("disc", "black"))
    draw.rectangle((160, 60, 219, 119), fill=colours.get("square", "black"))
    draw.point((280, 180), fill="black")
    path = tmp_path / "islands.png"
    page.save(path)
    return path


def test_that_the_regions_of_a_picture_are_parts_in_pixels(tmp_path, iou) -> None:
    source = read_parts(islands(tmp_path))
    assert [part.size for part in source.parts] == [pytest.approx(size, abs=1.5) for size in ((101, 101), (60, 60))]
    assert source.unit == "px" and source.left_out == ("1 speck was left out.",)
    disc, square = source.parts
    assert disc.bounds[3] > square.bounds[3] and disc.bounds[2] < square.bounds[0]  # up stays up
    round_ = Outline.from_points(np.asarray(Point(0, 0).buffer(1).exterior.coords))
    assert iou(merged(source, (disc,), Merging()).outline, round_) > 0.98


def test_that_a_coloured_picture_has_a_layer_for_each_colour(tmp_path) -> None:
    source = read_parts(islands(tmp_path, disc="#c02020", square="#2040c0"))
    red, blue = (name for name in source.layers if name)
    assert {red, blue} == {"#c02020", "#2040c0"} or {red[1], blue[1]} == {"c", "2"}
    assert [part.layer for part in source.chosen(red)] == [red]


def test_that_a_picture_of_nothing_is_refused(tmp_path) -> None:
    path = tmp_path / "blank.png"
    Image.new("RGB", (50, 50), "white").save(path)
    with pytest.raises(TargetError, match="blank"):
        read_parts(path)


# every piece by itself -----------------------------------------------------------------------------------------------


def test_that_each_piece_is_an_outline_of_its_own_with_its_name_size_and_place(logo) -> None:
    found = merged(logo, logo.of([1, 2]), Merging(Join.EACH))
    assert [one.outline.name for one in found.all] == ["disc", "ring"]
    assert [one.outline.size for one in found.all] == [pytest.approx((40, 40), rel=1e-3)] * 2
    assert [len(one.outline.holes) for one in found.all] == [0, 1]
    (x, y), (other_x, other_y) = (one.place for one in found.all)
    assert (other_x - x, other_y - y) == pytest.approx((50, 0), abs=0.01)


def test_that_pieces_of_one_name_are_told_apart(svg) -> None:
    body = '<rect id="dot" x="10" width="8" height="8"/><g id="dot"><rect id="dot" x="30" width="8" height="8"/></g>'
    source = read_parts(svg(body, MM))
    found = merged(source, source.parts, Merging(Join.EACH))
    assert [one.outline.name for one in found.all] == ["dot", "dot 2"]


def test_that_a_piece_in_the_hole_of_another_one_is_a_sheet_too(svg) -> None:
    body = '<path id="eye" fill-rule="evenodd" d="M0 0h60v60h-60z M10 10h40v40h-40z M20 20h20v20h-20z"/>'
    source = read_parts(svg(body, MM))
    found = merged(source, source.parts, Merging(Join.EACH))
    assert sorted(one.outline.size[0] for one in found.all) == pytest.approx([20, 60])
    assert [len(one.outline.holes) for one in found.all] == [1, 0]


def test_that_painted_strokes_are_pieces(svg) -> None:
    body = '<g fill="none" stroke="#000" stroke-width="6"><path id="a" d="M10 10h80"/><path id="b" d="M10 40h70"/></g>'
    source = read_parts(svg(body, MM))
    found = merged(source, source.parts, Merging(Join.EACH, as_painted=True))
    assert [one.outline.name for one in found.all] == ["a", "b"]


def test_that_touching_parts_are_one_piece(svg) -> None:
    source = read_parts(svg('<rect id="a" width="20" height="20"/><rect id="b" x="20" width="9" height="20"/>', MM))
    found = merged(source, source.parts, Merging(Join.EACH))
    assert not found.others and found.outline.size == pytest.approx((29, 20))


def test_that_more_pieces_than_anybody_cuts_are_refused(svg) -> None:
    body = "".join(f'<rect x="{4 * k}" width="2" height="2"/>' for k in range(25))
    source = read_parts(svg(body, MM))
    with refused(TargetError, "parts.too_many_sheets"):
        merged(source, source.parts, Merging(Join.EACH))


STAR = "50,14 58,39 84,39 63,55 71,80 50,65 29,80 37,55 16,39 42,39"


def test_that_a_white_star_on_a_red_page_is_read_and_the_page_can_be_chosen(svg) -> None:
    """Before, the page was read, and nothing of the star was left."""
    page = f'<rect width="100" height="100" fill="#c81e1e"/><polygon points="{STAR}" fill="#fff"/>'
    source = read_parts(svg(page, 'width="100mm" height="100mm" viewBox="0 0 100 100"'))
    assert len(source.parts) == 2 and [source.parts[number - 1].colour for number in source.usual] == ["#ffffff"]
    assert source.parts[0].is_aside and source.parts[0].region.area == pytest.approx(1e4)
    # A badge beside which the page is seen is a shape, not a ground; so is a page with a speck on it.
    badge = page.replace('width="100" height="100"', 'x="10" y="10" width="80" height="80"')
    speck = '<rect width="100" height="100" fill="#c81e1e"/><circle cx="90" cy="90" r="2" fill="#fff"/>'
    for body in (badge, speck):
        taken = read_parts(svg(body, 'width="100mm" height="100mm" viewBox="0 0 100 100"'))
        assert taken.parts[0].number in taken.usual and not taken.parts[0].is_aside


def test_that_a_white_star_on_a_red_disc_in_a_picture_is_a_part(tmp_path: Path) -> None:
    """Before, it was a hole of the disc and nothing else."""
    page = Image.new("RGB", (240, 240), "white")
    draw = ImageDraw.Draw(page)
    draw.ellipse((15, 15, 225, 225), fill=(200, 20, 30))
    points = [tuple(2.4 * float(number) for number in pair.split(",")) for pair in STAR.split()]
    draw.polygon(points, fill="white")
    path = tmp_path / "badge.png"
    page.save(path)
    source = read_parts(path)
    disc, star = source.parts
    assert source.usual == (disc.number,) and star.is_aside
    assert star.region.area == pytest.approx(Polygon(points).area, rel=0.05)
    assert len(merged(source, (star,), Merging()).outline.holes) == 0
