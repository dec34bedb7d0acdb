"""DXF drawings become outlines: every kind of entity, joined."""

from __future__ import annotations

import numpy as np
import pytest
from ezdxf.acis import api as acis_api
from ezdxf.acis import entities as acis
from ezdxf.math import Vec3
from ezdxf.render import MeshBuilder
from ezdxf.xclip import XClip
from shapely.geometry import LineString, Point

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.dxf_regions import EllipseCurve
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.read_dxf import dxf_parts, read_dxf
from tests.refusals import refused

DISC = Outline.from_points(np.asarray(Point(0, 0).buffer(1, quad_segs=256).exterior.coords))
SQUARE = [(0, 0), (10, 0), (10, 10), (0, 10)]


def box_outline(width: float, height: float) -> Outline:
    return Outline.from_points([[0, 0], [width, 0], [width, height], [0, height]])


def slot(space, _drawing) -> None:
    space.add_line((0, 0), (10, 0))
    space.add_line((0, 4), (10, 4))
    space.add_arc((10, 2), 2, -90, 90)
    space.add_arc((0, 2), 2, 90, 270)


def half_ellipse_and_line(space, _drawing) -> None:
    space.add_ellipse((0, 0), (10, 0), 0.5, 0, np.pi)
    space.add_line((-10, 0), (10, 0))


def splines(space, _drawing) -> None:
    # Two quarter-disc-like halves by splines through many points of a circle.
    for start in (0, np.pi):
        angle = np.linspace(start, start + np.pi, 40)
        space.add_spline([(10 * np.cos(a), 10 * np.sin(a), 0) for a in angle])


def nested_block(space, drawing) -> None:
    inner = drawing.blocks.new("INNER")
    inner.add_lwpolyline([(0, 0), (4, 0), (4, 1), (0, 1)], close=True)
    drawing.blocks.new("OUTER").add_blockref("INNER", (1, 1), {"xscale": 2, "yscale": 4})
    space.add_blockref("OUTER", (5, 5))


def square_with_gap(gap: float):
    def draw(space, _drawing) -> None:
        space.add_lwpolyline([(0, gap), (0, 10), (10, 10), (10, 0)])
        space.add_line((0, 0), (10, 0))

    return draw


SLOT = Outline.from_points(np.asarray(LineString([(0, 2), (10, 2)]).buffer(2, quad_segs=256).exterior.coords))
HALF = Outline.from_points([(10 * np.cos(a), 5 * np.sin(a)) for a in np.linspace(0, np.pi, 2000)])


@pytest.mark.parametrize(
    ("draw", "expected"),
    [
        (lambda space, _: space.add_circle((5, 5), 3), DISC),
        (lambda space, _: space.add_ellipse((5, 5), (3, 0), 1.0), DISC),
        (lambda space, _: space.add_lwpolyline(SQUARE, close=True), box_outline(1, 1)),
        (lambda space, _: space.add_lwpolyline([*SQUARE, SQUARE[0]]), box_outline(1, 1)),
        (lambda space, _: space.add_lwpolyline([(0, 0, 1), (9, 0, 1)], format="xyb", close=True), DISC),
        (lambda space, _: space.add_polyline2d(SQUARE, close=True), box_outline(1, 1)),
        (lambda space, _: space.add_polyline3d([(*p, 3) for p in SQUARE], close=True), box_outline(1, 1)),
        (slot, SLOT),
        (half_ellipse_and_line, HALF),
        (splines, DISC),
        (nested_block, box_outline(2, 1)),
        (square_with_gap(0.0), box_outline(1, 1)),
    ],
)
def test_that_every_kind_of_line_becomes_the_outline(draw, expected, dxf, iou) -> None:
    outline = read_dxf(dxf(draw))
    assert iou(outline, expected) > 0.999
    assert outline.notes == ()
    assert outline.unit == "mm"


def test_that_thousands_of_shuffled_lines_are_joined(dxf, iou) -> None:
    heart = silhouettes.load("heart")
    fine = np.asarray(heart.polygon.segmentize(0.002).exterior.coords) * 100

    def draw(space, _drawing) -> None:
        for index in np.random.default_rng(0).permutation(len(fine) - 1):
            ends = (fine[index], fine[index + 1]) if index % 2 else (fine[index + 1], fine[index])
            space.add_line(*(tuple(np.round(end, 6)) for end in ends))

    outline = read_dxf(dxf(draw))
    assert iou(outline, heart) > 0.999
    assert len(outline.points) <= 1000


@pytest.mark.parametrize(("units", "size", "unit"), [(4, 2.0, "mm"), (1, 50.8, "mm"), (6, 2000.0, "mm"), (0, 2.0, "")])
def test_that_the_size_follows_insunits(units, size, unit, dxf) -> None:
    outline = read_dxf(dxf(lambda space, _: space.add_circle((5, 5), 1), units=units))
    assert outline.size == pytest.approx((size, size), rel=1e-6)
    assert outline.unit == unit


def test_that_a_file_without_header_has_no_unit(tmp_path) -> None:
    path = tmp_path / "bare.dxf"
    tags = "0 SECTION 2 ENTITIES 0 CIRCLE 8 0 10 0.0 20 0.0 40 5.0 0 ENDSEC 0 EOF"
    path.write_text("\n".join(tags.split()) + "\n")
    outline = read_dxf(path)
    assert (outline.size, outline.unit) == (pytest.approx((10, 10)), "")


def test_that_binary_files_are_read(dxf, iou) -> None:
    assert iou(read_dxf(dxf(slot, fmt="bin")), SLOT) > 0.999


def test_that_a_file_without_its_end_is_repaired_and_said(dxf, iou) -> None:
    path = dxf(slot)
    path.write_bytes(path.read_bytes()[:-200])
    outline = read_dxf(path)
    assert iou(outline, SLOT) > 0.999
    assert "repaired while reading" in outline.notes[0]


def test_that_a_small_gap_is_closed_and_said(dxf, iou) -> None:
    outline = read_dxf(dxf(square_with_gap(0.04)))
    assert iou(outline, box_outline(1, 1)) > 0.999
    assert "0.04 mm near (0, 0.02)" in outline.notes[0]


@pytest.mark.parametrize("decoration", [lambda space: None, lambda space: space.add_circle((5, 5), 2)])
def test_that_a_wide_gap_is_named_even_around_a_closed_hole(decoration, dxf) -> None:
    def draw(space, drawing) -> None:
        square_with_gap(1.0)(space, drawing)
        decoration(space)

    with pytest.raises(TargetError, match=r"gap of 1 mm near \(0, 0\.5\)"):
        read_dxf(dxf(draw))


def test_that_engraving_and_stray_lines_are_left_out_and_said(dxf, iou) -> None:
    def draw(space, drawing) -> None:
        square_with_gap(0.0)(space, drawing)
        space.add_circle((5, 5), 2, dxfattribs={"layer": "ENGRAVE"})
        space.add_line((2, 2), (2.5, 2.5))
        space.add_circle((30, 5), 1)

    outline = read_dxf(dxf(draw))
    assert iou(outline, box_outline(1, 1)) > 0.999
    assert [
        word for word in ("inside the outer", "open line", "1 smaller piece") if word in " ".join(outline.notes)
    ] == [
        "inside the outer",
        "open line",
        "1 smaller piece",
    ]


@pytest.mark.parametrize("switch", ["off", "freeze"])
def test_that_hidden_layers_are_ignored(switch, dxf, iou) -> None:
    def draw(space, drawing) -> None:
        getattr(drawing.layers.add("Guides"), switch)()
        space.add_lwpolyline([(0, 0), (90, 0), (90, 90)], close=True, dxfattribs={"layer": "GUIDES"})
        space.add_circle((5, 5), 3)

    assert iou(read_dxf(dxf(draw)), DISC) > 0.999


def endless_block(space, drawing) -> None:
    block = drawing.blocks.new("A")
    block.add_blockref("A", (1, 0))
    space.add_blockref("A", (0, 0))


def wide_array(space, drawing) -> None:
    drawing.blocks.new("A").add_circle((0, 0), 1)
    count = {"row_count": 1000, "column_count": 1000, "row_spacing": 1, "column_spacing": 1}
    space.add_blockref("A", (0, 0), count)


@pytest.mark.parametrize(
    ("draw", "word"),
    [
        (lambda space, _: None, "no lines in model space"),
        (lambda space, _: space.add_text("hello"), "letters that do not touch"),
        (lambda space, _: space.add_line((0, 0), (5, 5)), "open"),
        (lambda space, _: space.add_line((3, 3), (3, 3)), "one point"),
        (lambda space, _: space.add_circle((0, 0), 0), "no length"),
        (lambda space, _: space.add_lwpolyline([(0, 0), (9, 9), (9, 0), (0, 9)], close=True), "near (4.5, 4.5)"),
        (endless_block, "16 deep"),
        (wide_array, "1000000 times"),
    ],
)
def test_that_what_has_no_outline_is_refused_with_advice(draw, word, dxf) -> None:
    with refused(TargetError, "source.not_usable", name="drawing.dxf") as caught:
        read_dxf(dxf(draw))
    assert word in str(caught.value)


STAR = Outline.from_points(
    [(30 * r * np.cos(a), 30 * r * np.sin(a)) for a, r in zip(np.arange(10) * np.pi / 5, [1, 0.4] * 5, strict=True)]
)
STAR_POINTS = [(float(x), float(y)) for x, y in 20 * STAR.points]
FRAME = [(-90, -90), (90, -90), (90, 90), (-90, 90)]
HIDING = {
    "off": lambda layer: layer.off(),
    "frozen": lambda layer: layer.freeze(),
    "not plotted": lambda layer: setattr(layer.dxf, "plot", 0),
}


def inside_a_block(space, drawing, layer: str) -> None:
    drawing.blocks.new("B").add_lwpolyline(FRAME, close=True, dxfattribs={"layer": layer})
    space.add_blockref("B", (0, 0))


def as_a_block(space, drawing, layer: str) -> None:
    """Lines on layer 0 show as the layer of the insertion, also through another block."""
    drawing.blocks.new("B").add_lwpolyline(FRAME, close=True)
    drawing.blocks.new("C").add_blockref("B", (0, 0))
    space.add_blockref("C", (0, 0), dxfattribs={"layer": layer})


@pytest.mark.parametrize("way", [inside_a_block, as_a_block])
@pytest.mark.parametrize("hidden", HIDING)
def test_that_what_is_hidden_in_a_block_is_not_seen(way, hidden, dxf, iou) -> None:
    def draw(space, drawing) -> None:
        HIDING[hidden](drawing.layers.add("Box"))
        way(space, drawing, "Box")
        space.add_lwpolyline(STAR_POINTS, close=True)

    outline = read_dxf(dxf(draw))
    assert iou(outline, STAR) > 0.999
    assert any("Box" in note for note in outline.notes)


def test_that_a_block_on_a_layer_that_is_off_shows_its_other_layers(dxf, iou) -> None:
    def draw(space, drawing) -> None:
        drawing.layers.add("Box").off()
        block = drawing.blocks.new("B")
        block.add_lwpolyline(FRAME, close=True)
        block.add_lwpolyline(STAR_POINTS, close=True, dxfattribs={"layer": "Shape"})
        space.add_blockref("B", (0, 0), dxfattribs={"layer": "Box"})

    assert iou(read_dxf(dxf(draw)), STAR) > 0.999


def hatch(space, _drawing) -> None:
    filled = space.add_hatch(color=2)
    filled.paths.add_polyline_path(STAR_POINTS, is_closed=True)


def pattern(space, _drawing) -> None:
    filled = space.add_hatch(color=2)
    filled.set_pattern_fill("ANSI31", scale=0.5)
    filled.paths.add_polyline_path(STAR_POINTS, is_closed=True)


def fan(space, _drawing) -> None:
    for one, other in zip(STAR_POINTS, STAR_POINTS[1:] + STAR_POINTS[:1], strict=True):
        space.add_3dface([(0, 0, 5), (*one, 0), (*other, 0), (*other, 0)])


def solids(space, _drawing) -> None:
    for one, other in zip(STAR_POINTS, STAR_POINTS[1:] + STAR_POINTS[:1], strict=True):
        space.add_solid([(0, 0), one, other, other])


def mesh(space, _drawing) -> None:
    builder = MeshBuilder()
    for one, other in zip(STAR_POINTS, STAR_POINTS[1:] + STAR_POINTS[:1], strict=True):
        builder.add_face([(0, 0, 0), (*one, 0), (*other, 0)])
    builder.render_polyface(space)


@pytest.mark.parametrize("draw", [hatch, pattern, fan, solids, mesh])
def test_that_fills_are_shapes(draw, dxf, iou) -> None:
    assert iou(read_dxf(dxf(draw)), STAR) > 0.999


def test_that_holes_of_a_hatch_stay_open_in_its_part(dxf) -> None:
    def draw(space, _drawing) -> None:
        filled = space.add_hatch(color=2)
        filled.paths.add_polyline_path(FRAME, is_closed=True, flags=1)
        filled.paths.add_polyline_path(STAR_POINTS, is_closed=True, flags=16)

    (part,) = dxf_parts(dxf(draw)).parts
    assert part.region.area == pytest.approx(180 * 180 - 400, rel=1e-6)


PLATE = [(0, 0), (100, 0), (100, 50), (0, 50)]


def measured(space, **attributes) -> None:
    for start, end in (((0, 50), (0, 68)), ((100, 50), (100, 68)), ((0, 65), (100, 65)), ((0, 65), (4, 66))):
        space.add_line(start, end, dxfattribs=attributes)
    space.add_text("100", height=4, dxfattribs=attributes).set_placement((45, 67))


@pytest.mark.parametrize(
    "attributes",
    [{"layer": "DIM"}, {"layer": "Bemaßung"}, {"layer": "COTES"}, {"layer": "标注"}, {"layer": "x7"}, {"color": 1}],
)
def test_that_a_measure_in_pieces_does_not_belong_to_the_plate(attributes, dxf, iou) -> None:
    def draw(space, _drawing) -> None:
        space.add_lwpolyline(PLATE, close=True)
        measured(space, **attributes)

    assert iou(read_dxf(dxf(draw)), box_outline(2, 1)) > 0.999


@pytest.mark.parametrize(
    "attributes",
    [{"layer": "Hilfslinien"}, {"layer": "construction"}, {"layer": "TITLEBLOCK"}, {"layer": "ENGRAVE"},
     {"layer": "Defpoints"}, {"linetype": "CENTER"}],
)  # fmt: skip
def test_that_a_larger_frame_of_construction_is_left_out_and_said(attributes, dxf, iou) -> None:
    def draw(space, drawing) -> None:
        drawing.linetypes.add("CENTER", [2.0, 1.25, -0.25, 0.25, -0.25])
        space.add_lwpolyline(FRAME, close=True, dxfattribs=attributes)
        space.add_lwpolyline(STAR_POINTS, close=True, dxfattribs={"layer": "Outline cut"})

    outline = read_dxf(dxf(draw))
    assert iou(outline, STAR) > 0.999
    assert any("left out" in note for note in outline.notes)


@pytest.mark.parametrize("attributes", [{"layer": "DIM"}, {"linetype": "CENTER"}])
def test_that_construction_alone_is_the_shape(attributes, dxf, iou) -> None:
    def draw(space, drawing) -> None:
        drawing.linetypes.add("CENTER", [2.0, 1.25, -0.25, 0.25, -0.25])
        space.add_lwpolyline(STAR_POINTS, close=True, dxfattribs=attributes)

    assert iou(read_dxf(dxf(draw)), STAR) > 0.999


@pytest.mark.parametrize("key", ["layer", "color"])
def test_that_an_outline_over_several_layers_or_colours_is_joined(key, dxf, iou) -> None:
    def draw(space, _drawing) -> None:
        for index in range(4):
            value = f"L{index % 3}" if key == "layer" else 1 + index % 3
            space.add_line(PLATE[index], PLATE[(index + 1) % 4], dxfattribs={key: value})

    assert iou(read_dxf(dxf(draw)), box_outline(2, 1)) > 0.999


def test_that_the_plotters_pen_does_not_make_lines_broad(dxf, iou) -> None:
    def draw(space, _drawing) -> None:
        pen = {"lineweight": 70}
        space.add_lwpolyline([(5, -2), (15, -2), (15, 2), (5, 2)], close=True, dxfattribs=pen)
        space.add_line((0, 0), (5, 0), dxfattribs=pen)
        space.add_line((15, 0), (20, 0), dxfattribs=pen)

    path = dxf(draw)
    assert iou(read_dxf(path), box_outline(10, 4)) > 0.999
    assert dxf_parts(path).parts[0].pen.width == pytest.approx(0.7)


def clipped(space, drawing) -> None:
    """A block with a plate that is seen and a larger one that is clipped away, half a hatch, and lines that are cut."""
    block = drawing.blocks.new("Plate")
    block.add_lwpolyline(SQUARE, close=True)
    block.add_lwpolyline([(x + 100, 10 * y) for x, y in SQUARE], close=True)
    XClip(space.add_blockref("Plate", (50, 20), {"rotation": 90})).set_block_clipping_path([(-1, -1), (20, 20)])


def clipped_inside_a_block(space, drawing) -> None:
    outer = drawing.blocks.new("Outer")
    clipped(outer, drawing)
    space.add_blockref("Outer", (3, 4), {"xscale": -2, "yscale": 2})


def clipped_fill(space, drawing) -> None:
    block = drawing.blocks.new("Filled")
    block.add_hatch().paths.add_polyline_path([(0, 0), (30, 0), (30, 10), (0, 10)])
    XClip(space.add_blockref("Filled", (0, 0))).set_block_clipping_path([(0, 0), (10, 0), (10, 30), (0, 30)])


@pytest.mark.parametrize("draw", [clipped, clipped_inside_a_block, clipped_fill])
def test_that_of_a_clipped_block_only_what_is_seen_counts(draw, dxf, iou) -> None:
    outline = read_dxf(dxf(draw))
    assert iou(outline, box_outline(1, 1)) > 0.999
    assert not outline.notes


def test_that_a_contour_that_a_clip_cuts_is_open(dxf) -> None:
    def draw(space, drawing) -> None:
        drawing.blocks.new("Plate").add_lwpolyline(SQUARE, close=True)
        XClip(space.add_blockref("Plate", (0, 0))).set_block_clipping_path([(-1, -1), (5, 20)])

    with refused(TargetError, "source.not_usable") as caught:
        read_dxf(dxf(draw))
    assert caught.value.__cause__.code == "lines.open_at"


def test_that_a_block_with_an_inverted_clip_is_named(dxf) -> None:
    def draw(space, drawing) -> None:
        drawing.blocks.new("Plate").add_lwpolyline(SQUARE, close=True)
        clip = XClip(space.add_blockref("Plate", (0, 0)))
        clip.set_block_clipping_path([(2, 2), (5, 5)])
        clip.invert_clipping_path(ignore_acad_compatibility=True)

    notes = " ".join(read_dxf(dxf(draw)).notes)
    assert "XCLIP" in notes and "Plate" in notes


class WrittenEllipse(EllipseCurve):
    def write_data(self, exporter) -> None:
        exporter.write_loc_vec3(self.centre)
        exporter.write_dir_vec3(self.normal)
        exporter.write_loc_vec3(self.major)
        exporter.write_double(self.ratio)
        super().write_data(exporter)


def loop_of(edges) -> acis.Loop:
    """A loop of edges (start, end, curve)."""
    coedges = []
    for start, end, curve in edges:
        edge, coedge = acis.Edge(), acis.Coedge()
        for name, place in (("start_vertex", start), ("end_vertex", end)):
            vertex = acis.Vertex()
            vertex.point, vertex.edge = acis.Point(), edge
            vertex.point.location = Vec3(place)
            setattr(edge, name, vertex)
        edge.curve, edge.coedge, coedge.edge, coedge.sense = curve, coedge, edge, False
        coedges.append(coedge)
    loop = acis.Loop()
    loop.set_coedges(coedges)
    return loop


def ellipse(centre, across: float, along: float) -> acis.Loop:
    curve = WrittenEllipse()
    curve.centre, curve.major, curve.ratio = Vec3(centre), Vec3(across, 0), along / across
    start = curve.centre + curve.major
    return loop_of([(start, start, curve)])


def half_disc(radius: float) -> acis.Loop:
    curve, straight = WrittenEllipse(), acis.StraightCurve()
    curve.major = Vec3(radius, 0)
    right, left = Vec3(radius, 0), Vec3(-radius, 0)
    return loop_of([(right, left, curve), (left, right, straight)])


def polygon(corners) -> acis.Loop:
    pairs = zip(corners, [*corners[1:], corners[0]], strict=True)
    return loop_of([(Vec3(start), Vec3(end), acis.StraightCurve()) for start, end in pairs])


def region(loops, surface=None):
    """A drawing with the region of some loops."""

    def draw(space, _drawing) -> None:
        body, lump, shell, face = acis.Body(), acis.Lump(), acis.Shell(), acis.Face()
        face.surface, face.shell = surface or acis.Plane(), shell
        for loop in reversed(loops):
            loop.face, loop.next_loop, face.loop = face, face.loop, loop
        shell.append_face(face)
        lump.append_shell(shell)
        body.append_lump(lump)
        acis_api.export_dxf(space.add_region(), [body])

    return draw


@pytest.mark.parametrize(
    ("loops", "expected"),
    [
        ([polygon([(0, 0), (30, 0), (30, 10), (0, 10)])], box_outline(3, 1)),
        ([ellipse((5, 5), 20, 20)], DISC),
        ([ellipse((5, 5), 20, 10)], Outline.from_points(DISC.points * (2, 1))),
        ([half_disc(3)], Outline.from_points(DISC.points[DISC.points[:, 1] >= -1e-9])),
    ],
)
def test_that_a_region_is_a_shape(loops, expected, dxf, iou) -> None:
    outline = read_dxf(dxf(region(loops)))
    assert iou(outline, expected) > 0.999


def test_that_a_region_in_a_block_is_moved_with_it_and_keeps_its_hole(dxf) -> None:
    def draw(space, drawing) -> None:
        region([polygon(SQUARE), ellipse((5, 5), 2, 2)])(drawing.blocks.new("A"), drawing)
        space.add_blockref("A", (100, 0), {"xscale": 2, "yscale": 2})

    path = dxf(draw)
    (part,) = dxf_parts(path).parts
    assert part.bounds == pytest.approx((100, 0, 120, 20)) and len(read_dxf(path).holes) == 1
    assert part.region.area == pytest.approx(400 - 16 * np.pi, rel=1e-3)


def test_that_a_region_with_other_curves_is_named(dxf) -> None:
    class Spline(acis.Curve):
        type = "intcurve-curve"

    def draw(space, drawing) -> None:
        region([loop_of([(Vec3(), Vec3(), Spline())])])(space, drawing)
        space.add_lwpolyline(SQUARE, close=True)

    assert any("Regions" in note for note in read_dxf(dxf(draw)).notes)


def test_that_an_outline_open_at_several_places_is_not_what_it_holds(dxf) -> None:
    def draw(space, _drawing) -> None:
        for start in np.arange(4) * np.pi / 2:
            angle = np.linspace(start + 0.1, start + np.pi / 2, 40)
            space.add_lwpolyline(np.column_stack([50 * np.cos(angle), 80 * np.sin(angle)]).tolist())
        space.add_circle((0, -50), 12)

    with pytest.raises(TargetError, match="The contour is open"):
        read_dxf(dxf(draw))
