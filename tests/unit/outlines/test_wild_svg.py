"""SVG by its standard: every rule that decides which silhouette is seen."""

from __future__ import annotations

from pathlib import Path

import pytest

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines.merging import usual_outline
from kirigami_studio.outlines.read import read_parts, read_target
from kirigami_studio.outlines.svg_style import colour_of

WILD = Path(__file__).resolve().parents[2] / "data" / "wild" / "svg"


def shown(svg, body: str, attributes: str = 'viewBox="0 0 100 100"') -> tuple[float, ...]:
    """Left, top, right and bottom of everything filled, as the drawing counts."""
    boxes = [part.bounds for part in read_parts(svg(body, attributes)).parts]
    left, top = min(box[0] for box in boxes), -max(box[3] for box in boxes)
    right, bottom = max(box[2] for box in boxes), -min(box[1] for box in boxes)
    return tuple(round(float(value), 6) for value in (left, top, right, bottom))


@pytest.mark.parametrize(
    ("body", "box"),
    [
        # use, symbol, nested drawings
        ('<symbol id="s" viewBox="0 0 2 1"><rect width="2" height="1"/></symbol>'
         '<use href="#s" x="10" y="20" width="40" height="40"/>', (10, 30, 50, 50)),
        ('<symbol id="s" viewBox="0 0 2 1" preserveAspectRatio="none"><rect width="2" height="1"/></symbol>'
         '<use href="#s" width="40" height="40"/>', (0, 0, 40, 40)),
        ('<svg x="10" y="10" width="20" height="20" viewBox="0 0 10 10"><rect width="90" height="5"/></svg>',
         (10, 10, 30, 20)),
        ('<svg x="10" y="10" width="20" height="20" overflow="visible"><rect width="90" height="5"/></svg>',
         (10, 10, 100, 15)),
        ('<svg x="25%" y="50%" width="50%" height="20"><rect width="100%" height="100%"/></svg>', (25, 50, 75, 70)),
        # switch
        ('<switch><rect systemLanguage="xx" width="90" height="90"/><rect width="9" height="9"/></switch>',
         (0, 0, 9, 9)),
        ('<switch><g requiredExtensions="http://x.org"><rect width="90" height="90"/></g>'
         '<rect systemLanguage="de, en" width="9" height="9"/><rect width="50" height="9"/></switch>', (0, 0, 9, 9)),
        # transforms
        ('<rect width="20" height="10" style="transform:rotate(90deg);transform-origin:20px 10px"/>',
         (20, -10, 30, 10)),
        ('<rect width="20" height="10" transform="scale(2)" transform-origin="right bottom"/>',
         (-100, -100, -60, -80)),
        ('<rect x="10" y="10" width="20" height="10" style="transform:scaleX(2);transform-box:fill-box;'
         'transform-origin:center"/>', (0, 10, 40, 20)),
        ('<rect width="20" height="10" transform="translate(10-5)rotate(0 5 5)"/>', (10, -5, 30, 5)),
        # what is not seen
        ('<g opacity="0%"><rect width="90" height="90"/></g><rect width="9" height="9"/>', (0, 0, 9, 9)),
        ('<g opacity=".1"><rect opacity=".05" width="90" height="90"/></g><rect width="9" height="9"/>', (0, 0, 9, 9)),
        ('<rect fill="#12345600" width="90" height="90"/><rect width="9" height="9"/>', (0, 0, 9, 9)),
        ('<rect fill="hsla(9,9%,9%,0)" width="90" height="90"/><rect width="9" height="9"/>', (0, 0, 9, 9)),
        ('<g color="transparent"><rect fill="currentColor" width="90" height="90"/></g><rect width="9" height="9"/>',
         (0, 0, 9, 9)),
        ('<linearGradient id="g"><stop stop-opacity="0"/></linearGradient><linearGradient id="h" href="#g"/>'
         '<rect fill="url(#h)" width="90" height="90"/><rect width="9" height="9"/>', (0, 0, 9, 9)),
        ('<g visibility="hidden"><rect width="90" height="90"/><rect visibility="visible" width="9" height="9"/></g>',
         (0, 0, 9, 9)),
        # the cascade
        ('<style>g > rect:not(.k){display:none}</style><g><rect width="90" height="90"/>'
         '<rect class="k" width="9" height="9"/></g>', (0, 0, 9, 9)),
        ('<style>#a{fill:none} rect{fill:red} .b{fill:none!important}</style><rect id="a" width="90" height="90"/>'
         '<rect class="b" style="fill:red" width="90" height="90"/><rect width="9" height="9"/>', (0, 0, 9, 9)),
        ('<style>:root{--ink:none} .a{fill:var(--ink)} .b{fill:var(--no, none)}</style>'
         '<rect class="a" width="90" height="90"/><rect class="b" width="90" height="90"/>'
         '<rect width="9" height="9"/>', (0, 0, 9, 9)),
        ('<style>@media print{rect{fill:red}} @media screen{.a{fill:none}}</style><rect class="a" width="90" '
         'height="90"/><rect width="9" height="9"/>', (0, 0, 9, 9)),
        ('<style>[data-x^="gu"]{fill:none}</style><rect data-x="guide" width="90" height="90"/>'
         '<rect width="9" height="9"/>', (0, 0, 9, 9)),
        ('<g fill="none"><rect style="fill:inherit" width="90" height="90"/></g><rect width="9" height="9"/>',
         (0, 0, 9, 9)),
        # clip paths and masks
        ('<clipPath id="c"><rect x="5" y="5" width="20" height="10"/></clipPath>'
         '<g clip-path="url(#c)" transform="translate(1 2)"><rect width="90" height="90"/></g>', (6, 7, 26, 17)),
        ('<clipPath id="c" clipPathUnits="objectBoundingBox"><rect width=".5" height=".5"/></clipPath>'
         '<rect x="10" y="10" width="20" height="40" clip-path="url(#c)"/>', (10, 10, 20, 30)),
        # markers
        ('<marker id="m" markerWidth="4" markerHeight="2" refX="4" refY="1" orient="auto"><rect width="9" height="9"/>'
         '</marker><path d="M10 50H30V10" fill="none" marker-end="url(#m)" stroke-width="5"/>', (25, 10, 35, 30)),
        ('<marker id="m" markerWidth="8" markerHeight="8" viewBox="0 0 2 2" refX="1" refY="center" '
         'markerUnits="userSpaceOnUse"><rect width="2" height="2"/></marker>'
         '<polyline points="10,10 20,10 20,30" fill="none" marker-mid="url(#m)"/>', (16, 6, 24, 14)),
        ('<marker id="m" markerWidth="2" markerHeight="2" orient="auto-start-reverse" overflow="visible">'
         '<rect width="5" height="1" fill="context-stroke"/></marker>'
         '<line x1="50" y1="50" x2="60" y2="50" style="marker:url(#m)" />', (45, 49, 65, 51)),
        ('<marker id="m" markerWidth="20" markerHeight="20"><path d="M0 0h5v5z" marker-start="url(#m)"/></marker>'
         '<g transform="scale(2)"><path d="M1 1C1 9 2 9 9 9" fill="none" marker-start="url(#m)"/></g>', (2, 2, 12, 12)),
        ('<rect x="10" y="20" width="40" height="20" clip-path="circle(5px)"/>', (25, 25, 35, 35)),
        ('<rect x="10" y="20" width="40" height="20" clip-path="circle(closest-side at 25% 50%)"/>', (10, 20, 30, 40)),
        ('<rect x="10" y="20" width="40" height="20" style="clip-path:ellipse(25% 50% at right)"/>', (40, 20, 50, 40)),
        ('<rect x="10" y="20" width="40" height="20" clip-path="inset(5px 10% 0 10px)"/>', (20, 25, 46, 40)),
        ('<rect x="10" y="20" width="40" height="20" clip-path="inset(1px 2px round 4px)"/>', (12, 21, 48, 39)),
        ('<rect width="40" height="20" clip-path="polygon(evenodd, 0 0, 50% 0, 10px 100%)"/>', (0, 0, 20, 20)),
        ('<rect width="9" height="9" clip-path="view-box polygon(0 0, 5% 0, 5% 4%, 0 4%)"/>', (0, 0, 5, 4)),
        ('<rect x="10" y="10" width="20" height="20" stroke="red" stroke-width="2" clip-path="inset(0) fill-box"/>',
         (10, 10, 30, 30)),
        ('<g clip-path="inset(50% 0 0 0)" transform="scale(2)"><rect width="9" height="9"/></g>', (0, 9, 18, 18)),
        ('<clipPath id="c"><rect width="20" height="90"/></clipPath><clipPath id="d" clip-path="url(#c)">'
         '<rect width="90" height="20"/></clipPath><rect width="90" height="90" style="clip-path:url(#d)"/>',
         (0, 0, 20, 20)),
        ('<mask id="m"><rect width="90" height="90" fill="#fff"/><rect x="30" width="60" height="90"/></mask>'
         '<rect width="90" height="90" mask="url(#m)"/>', (0, 0, 30, 90)),
        ('<mask id="m" style="mask-type:alpha"><rect width="30" height="90"/></mask>'
         '<rect width="90" height="90" mask="url(#m)"/>', (0, 0, 30, 90)),
    ],
)  # fmt: skip
def test_that_rules_of_svg_are_followed(body, box, svg) -> None:
    assert shown(svg, body) == pytest.approx(box, abs=1e-6)


@pytest.mark.parametrize(
    ("body", "size"),
    [
        # broad lines alone: an anchor, a circle, and a cross that encloses nothing
        ('<g fill="none" stroke="#000" stroke-width="2"><circle cx="12" cy="5" r="3"/><path d="M12 8v14M5 12h14"/></g>',
         (14, 21)),
        ('<circle cx="12" cy="12" r="10" fill="none" stroke="#000" stroke-width="2"/>', (22, 22)),
        ('<path d="M4 12h16M12 4v16" fill="none" stroke="#000" stroke-width="2"/>', (16, 16)),
        # the stroke of a filled shape, and lines of a middling width round one or with much beside what they enclose
        ('<rect width="20" height="10" stroke="#000" stroke-width="2"/>', (22, 12)),
        ('<rect width="60" height="30"/><rect width="60" height="30" fill="none" stroke="#000" stroke-width="2"/>',
         (62, 32)),
        ('<g fill="none" stroke="#000" stroke-width="2"><rect width="30" height="30"/><path d="M30 15h40"/></g>',
         (71, 32)),
        # thin lines count by what they enclose
        ('<rect width="60" height="30" fill="none" stroke="#000" stroke-width="2"/>', (60, 30)),
        ('<rect width="60" height="30" fill="none" stroke="#000" stroke-width=".1"/><rect x="5" y="5" width="50" '
         'height="20"/>', (60, 30)),
        # lines of two colours that make one contour
        ('<path d="M0 0h60v30" fill="none" stroke="red" stroke-width=".2"/>'
         '<path d="M60 30h-60v-30" fill="none" stroke="blue" stroke-width=".2"/>', (60, 30)),
    ],
)  # fmt: skip
def test_that_strokes_count_as_painted_where_they_carry_the_shape(body, size, svg) -> None:
    assert read_target(svg(body)).size == pytest.approx(size, rel=2e-3)


def test_that_corners_of_strokes_are_cut_off_beyond_the_limit_of_their_mitre(svg) -> None:
    """A corner of 11 degrees: its tip would be ten widths long."""
    body = '<path fill="none" stroke="#000" stroke-width="2" d="M0 0L10 1L0 2" stroke-miterlimit="{}"/>'
    short, long = (read_target(svg(body.format(limit))).size[0] for limit in (4, 20))
    assert short == pytest.approx(10.2, abs=0.05) and long == pytest.approx(20.15, abs=0.05)


def test_that_what_is_read_and_what_the_parts_say_is_one(svg) -> None:
    """The window asks by the parts and takes their outline; before, it read the file again by another rule."""
    for name in ("s01_cut_frame_and_engraving.svg", "s31_stroke_only_shape_with_one_dot.svg"):
        taken = usual_outline(read_parts(WILD / name))
        assert (taken.points == read_target(WILD / name).points).all()


@pytest.mark.parametrize(
    "body",
    [
        # open at two corners, around a window; and one open line
        '<path d="M20 91V40L50 16L77 38M80 41V88M77 91H23" fill="none" stroke="#000" stroke-width=".5"/>'
        '<rect x="40" y="60" width="10" height="10" fill="none" stroke="#000" stroke-width=".5"/>',
        '<path d="M0 0h90v90h-90v-80" fill="none" stroke="#000" stroke-width=".5"/><circle cx="45" cy="45" r="9"/>',
    ],
)
def test_that_what_an_open_contour_holds_is_not_taken_in_its_place(body, svg) -> None:
    path = svg(body)
    with pytest.raises(TargetError, match="gap of"):
        read_target(path)
    assert read_parts(path).is_ambiguous


def test_that_another_reading_is_told_with_the_way_to_choose_it(svg) -> None:
    (said, _) = read_target(svg('<circle id="sun" r="30"/><circle cx="90" r="20"/>')).notes
    assert "sun" in said and "--parts" in said


def test_that_shapes_that_share_an_edge_but_for_rounding_are_one_and_a_gap_stays_a_gap(svg) -> None:
    near, apart = (f'<rect width="40" height="40"/><rect x="{x}" width="40" height="40"/>' for x in (40.01, 40.2))
    assert read_target(svg(near)).size == pytest.approx((80.01, 40.0))
    assert read_target(svg(apart)).size == pytest.approx((40.0, 40.0))


def test_that_a_subpath_that_paints_two_pieces_is_no_contour_that_crosses_itself(svg) -> None:
    """A calendar: its head and its body hang together by a line of no width."""
    outline = read_target(svg('<path d="M0 0h16v14h-16v-9h16v-1h-16z"/>'))
    assert outline.size == pytest.approx((16, 9)) and "smaller piece" in " ".join(outline.notes)


def test_that_a_white_flag_on_a_larger_page_is_no_paper(svg) -> None:
    body = '<path fill="#fff" d="M5 17h62v38h-62z"/><circle cx="36" cy="36" r="9"/>'
    assert read_target(svg(body, 'viewBox="0 0 72 72"')).size == pytest.approx((62, 38))


def test_that_a_path_is_read_up_to_its_damage_and_that_is_said(svg) -> None:
    outline = read_target(svg('<path d="M0 0h60v30h-60z M5 5 L 9"/>'))
    assert outline.size == pytest.approx((60, 30)) and any("damaged" in note for note in outline.notes)


def test_that_one_letter_is_a_target_and_a_word_is_refused_with_the_way_to_join_it(svg) -> None:
    assert read_target(svg('<text x="5" y="50" font-size="40">T</text>')).size[1] == pytest.approx(29, abs=3)
    with pytest.raises(TargetError, match="--join bridge"):
        read_target(svg('<text x="5" y="50" font-size="40">TO</text>'))


@pytest.mark.parametrize(
    "declared",
    [
        '<!ENTITY a SYSTEM "file:///etc/hostname">',
        '<!ENTITY % a "b">',
        '<!ENTITY a "&#60;rect/>">',
        '<!ENTITY a "x"><!ENTITY b "&a;&a;">',
        f'<!ENTITY a "{"x" * 2000}">',
    ],
    ids=["external", "parameter", "markup", "nested", "long"],
)
def test_that_entities_but_short_plain_texts_are_refused(declared, tmp_path) -> None:
    path = tmp_path / "drawing.svg"
    path.write_text(
        f'<!DOCTYPE svg [{declared}]><svg xmlns="http://www.w3.org/2000/svg"><rect width="9" height="9"/></svg>'
    )
    with pytest.raises(TargetError, match="entities"):
        read_target(path)


WHITES = (
    "white", "hsl(0 0% 100%)", "hwb(0 100% 0%)", "lab(100 0 0)", "lch(100 0 0)", "oklab(1 0 0)", "oklch(1 0 0)",
    "color(srgb 1 1 1)", "color(srgb-linear 1 1 1)", "color(display-p3 1 1 1)", "color(a98-rgb 1 1 1)",
    "color(prophoto-rgb 1 1 1)", "color(rec2020 1 1 1)", "color(xyz 0.9505 1 1.089)", "color(xyz-d50 0.9643 1 0.8251)",
)  # fmt: skip


@pytest.mark.parametrize("white", WHITES)
def test_that_white_paper_is_white_in_every_space_of_colours(white: str, svg) -> None:
    red, green, blue, opacity = colour_of(white)
    assert min(red, green, blue) > 0.995 and opacity == 1.0
    paper = f'<rect width="100" height="100" fill="{white}"/><rect x="20" y="30" width="40" height="50"/>'
    assert usual_outline(read_parts(svg(paper, 'viewBox="0 0 100 100"'))).size == pytest.approx((40.0, 50.0))


def test_that_colours_of_light_are_those_of_the_screen() -> None:
    for same in ("lab(54.29 80.82 69.9)", "oklch(0.62796 0.25768 29.234)", "color(xyz 0.4124 0.2126 0.0193)"):
        assert colour_of(same)[:3] == pytest.approx((1.0, 0.0, 0.0), abs=0.06)
    assert colour_of("color(srgb-linear 0.2140 0 0 / 50%)") == pytest.approx((0.5, 0.0, 0.0, 0.5), abs=1e-3)
    assert colour_of("color(--own 1 1 1)") is None


def test_that_a_shadow_that_is_hardly_seen_does_not_belong_to_the_shape(svg) -> None:
    shadow = '<rect x="{}" y="4" width="40" height="40" opacity=".15"/>'
    shape = '<rect width="40" height="40" fill="red"/>'
    path = svg(shadow.format(4) + shape)
    assert read_target(path).size == (40.0, 40.0)
    assert read_parts(path).is_ambiguous
    assert not read_parts(svg(shape + '<rect x="4" y="4" width="9" height="9" opacity=".15"/>')).is_ambiguous
    assert read_target(svg(shadow.format(4))).size == (40.0, 40.0)
