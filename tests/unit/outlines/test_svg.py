"""SVG drawings become outlines."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest
from shapely.geometry import Point, Polygon, box

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.read_svg import read_svg
from tests.refusals import refused

DATA = Path(__file__).resolve().parents[2] / "data" / "targets"
DISC = Outline.from_points(np.asarray(Point(0, 0).buffer(1, quad_segs=256).exterior.coords))


def rectangle(width: float, height: float) -> Outline:
    return Outline.from_points([[0, 0], [width, 0], [width, height], [0, height]])


FRAME = Outline.from_points([[0, 0], [100, 0], [100, 100], [0, 100]], holes=[[[20, 20], [80, 20], [80, 80], [20, 80]]])


def polygon_of(region: Polygon) -> Outline:
    """Expected outline of a shapely polygon given in SVG coordinates (y down)."""
    return Outline.from_points(np.asarray(region.exterior.coords) * (1, -1))


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ('<rect x="10" y="20" width="100" height="50"/>', rectangle(2, 1)),
        ('<circle cx="50" cy="50" r="40"/>', DISC),
        ('<circle cx="50" cy="50" r="40" fill="url(#gradient)"/>', DISC),
        ('<ellipse cx="50" cy="50" rx="40" ry="20" transform="scale(1 2)"/>', DISC),
        ('<path d="M10 50 A40 40 0 1 1 90 50 A40 40 0 1 1 10 50z"/>', DISC),
        ('<path d="M10 10h100v100h-100z M30 30v60h60v-60z"/>', FRAME),
        ('<path fill-rule="evenodd" d="M10 10h100v100h-100z M30 30h60v60h-60z"/>', FRAME),
        ('<polygon points="0,0 60,0 60,30 0,30"/>', rectangle(2, 1)),
        ('<polyline points="0,0 60,0 60,30 0,30" style="fill:#333"/>', rectangle(2, 1)),
        ('<path fill="none" stroke="red" d="M0 0H60V30H0Z"/>', rectangle(2, 1)),
        ('<g fill="none" stroke="red"><path d="M0 0H60V30"/><path d="M0 0V30H60"/></g>', rectangle(2, 1)),
        ('<rect width="50" height="50"/><rect x="50" width="50" height="50"/>', rectangle(2, 1)),
        ('<svg width="60" height="60" viewBox="0 0 10 10"><rect width="10" height="5"/></svg>', rectangle(2, 1)),
        ('<defs><rect id="r" width="40" height="20"/></defs><use xlink:href="#r"/>', rectangle(2, 1)),
        ('<symbol id="r"><rect width="40" height="20"/></symbol><use href="#r" x="9"/>', rectangle(2, 1)),
        ('<symbol id="r"><rect width="90" height="90"/></symbol><circle r="5"/>', DISC),
        ('<mask id="m"><rect width="90" height="90"/></mask><circle r="5"/>', DISC),
        ('<clipPath id="c"><rect width="90" height="90"/></clipPath><circle r="5"/>', DISC),
        ('<g style="display:none"><rect width="90" height="90"/></g><circle r="5"/>', DISC),
        ('<rect visibility="hidden" width="90" height="90"/><circle r="5"/>', DISC),
        ('<rect opacity="0" width="90" height="90"/><circle r="5"/>', DISC),
        ('<rect fill-opacity="0" width="90" height="90"/><circle r="5"/>', DISC),
        ('<style>.a{fill:none}</style><rect class="a" width="90" height="90"/><circle r="5"/>', DISC),
        ('<rect width="200" height="200" fill="#fff"/><circle cx="60" cy="60" r="50"/>', DISC),
        ('<circle r="50" fill="white"/>', DISC),
    ],
)  # fmt: skip
def test_that_a_drawing_has_the_outline_one_sees(body, expected, svg, iou) -> None:
    assert iou(read_svg(svg(body)), expected) > 0.999


def test_that_a_turned_and_stretched_group_is_followed(svg, iou) -> None:
    outline = read_svg(
        svg('<g transform="translate(9 9) rotate(30) scale(2 1)"><ellipse cx="5" cy="5" rx="40" ry="20"/></g>')
    )
    angle = np.linspace(0, 2 * np.pi, 2000, endpoint=False)
    ellipse = np.column_stack([80 * np.cos(angle), 20 * np.sin(angle)])
    cos, sin = np.cos(np.pi / 6), np.sin(np.pi / 6)
    turned = ellipse @ np.array([[cos, sin], [-sin, cos]]) * (1, -1)
    assert iou(outline, Outline.from_points(turned)) > 0.999


def test_that_up_stays_up(svg, iou) -> None:
    heart = silhouettes.load("heart")
    points = " ".join(f"{100 + 50 * x:.4f},{100 - 50 * y:.4f}" for x, y in heart.points)
    assert iou(read_svg(svg(f'<polygon points="{points}"/>')), heart) > 0.9999


def test_that_curves_are_flattened_within_the_tolerance(svg) -> None:
    outline = read_svg(svg('<circle cx="50" cy="50" r="40"/>'))
    radius = np.linalg.norm(outline.points, axis=1)
    middle = np.linalg.norm((outline.points + np.roll(outline.points, 1, axis=0)) / 2, axis=1)
    assert radius.max() - middle.min() < 2 * radius.max() / 2000


def test_that_a_badge_with_styles_uses_and_a_page_is_read_in_mm(iou) -> None:
    outline = read_svg(DATA / "badge.svg")
    shape = Point(120, 80).buffer(50, quad_segs=256).union(box(50, 50, 190, 110))
    assert iou(outline, polygon_of(shape)) > 0.999
    assert outline.size == pytest.approx((70, 50), abs=1e-9)
    assert outline.unit == "mm"
    assert outline.notes == ("The white background was left out.",)


@pytest.mark.parametrize(
    ("attributes", "size", "unit"),
    [
        ('width="100mm" height="100mm" viewBox="0 0 200 200"', (50, 25), "mm"),
        ('width="20cm" height="20cm" viewBox="0 0 200 200"', (100, 50), "mm"),
        ('width="1in" height="1in"', (100 * 25.4 / 96, 50 * 25.4 / 96), "mm"),
        ('width="400" height="400" viewBox="0 0 200 200"', (200, 100), "px"),
        ('width="100%" viewBox="0 0 200 200"', (100, 50), "px"),
        ("", (100, 50), "px"),
    ],
)
def test_that_the_size_follows_the_stated_units(attributes, size, unit, svg) -> None:
    outline = read_svg(svg('<rect x="1" y="2" width="100" height="50"/>', attributes))
    assert outline.size == pytest.approx(size, rel=1e-9)
    assert outline.unit == unit


@pytest.mark.parametrize(
    ("body", "word"),
    [
        ('<path d="M0 0h50v50h-50z M3 3v44h44v-44z"/>', "Holes were filled (77 % of the area)"),
        ('<circle r="30"/><circle cx="90" r="10"/>', "1 smaller piece was left out (10 % of the area)"),
        ('<path fill="none" stroke="red" d="M0 0h50v50h-50v-49.5"/>', "A gap was closed: 0.5 px near (0, 0.25)"),
        ('<path d="M0 0h50v50h-50v-40"/>', "closed by a straight line"),
        ('<text x="50" y="5">Hi</text><circle r="30"/>', "Text was left out. Convert it to paths"),
        ('<image href="a.png" width="5" height="5"/><circle r="30"/>', "embedded picture"),
        ('<path d="M0 0L100 0L100 100L50 100L51 101L50 102L51 99L0 100z"/>', "at 2 places, the first near (50.6"),
        ('<circle r="30"/><rect width="90" height="5" fill="none" stroke="red"/>', "without filling"),
        ('<circle r="30" clip-path="path(\'M0 0H9V9z\')"/>', "Clip paths"),
        ('<circle r="30" clip-path="circle(calc(9px))"/>', "Clip paths"),
        ('<filter id="f"><feGaussianBlur stdDeviation="3"/></filter><circle r="30" filter="url(#f)"/>', "Filters"),
        ('<circle r="30" style="filter:drop-shadow(3px 3px 2px red)"/>', "Filters"),
    ],
)  # fmt: skip
def test_that_what_was_changed_is_said(body, word, svg) -> None:
    assert any(word in note for note in read_svg(svg(body)).notes)


@pytest.mark.parametrize(
    ("body", "word"),
    [
        ("", "has no visible shape"),
        ('<text x="5" y="5">Hi</text>', "a text of 3 letters that do not touch"),
        ('<path fill="none" stroke="red" d="M0 0h50v50h-50v-40"/>', "gap of 10 px near (0, 5)"),
        ('<line x2="50" y2="50" stroke="red"/>', "open"),
        ('<path d="M0 0L50 50L50 0L0 50z"/>', "near (25, 25)"),
        (
            '<rect width="50" height="50"/><rect x="50" y="50" width="50" height="40"/>',
            "in the point near (50, 50)",
        ),
        ('<path d="M0 0L50 50"/>', "no area"),
        ('<path d="M0 0L50 50L100 100z"/>', "no area"),
        ('<path d="M0 0L1e308 0L1e308 1e308z"/>', "ordinary size"),
        ('<path d="M0 0 L foo z"/>', "has no visible shape"),
        ('<rect width="0" height="5"/>', "has no visible shape"),
        ('<g id="a"><use href="#a"/></g>', "inside itself"),
    ],
)
def test_that_what_has_no_outline_is_refused_with_advice(body, word, svg) -> None:
    with refused(TargetError, "source.not_usable", name="drawing.svg") as caught:
        read_svg(svg(body))
    assert word in str(caught.value)


def test_that_a_bomb_of_uses_is_refused_without_unfolding(svg) -> None:
    tens = "".join(f'<g id="a{k}">{f"<use href={chr(34)}#a{k - 1}{chr(34)}/>" * 10}</g>' for k in range(1, 12))
    with pytest.raises(TargetError, match="unfolds to"):
        read_svg(svg(f'<rect id="a0" width="1" height="1"/>{tens}'))


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_that_entity_declarations_are_refused_in_any_encoding(encoding, tmp_path) -> None:
    path = tmp_path / "bomb.svg"
    text = '<?xml version="1.0"?><!DOCTYPE svg [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><svg>&b;</svg>'
    path.write_bytes(text.encode(encoding))
    with pytest.raises(TargetError, match="entities"):
        read_svg(path)


@pytest.mark.parametrize(
    ("content", "word"),
    [
        (b"<svg", "not well-formed"),
        (b"<svg><g></svg>", "not well-formed"),
        (b"<html/>", "<html>"),
        (b"not xml at all", "not well-formed"),
        (gzip.compress(b"<svg/>", mtime=0), "compressed"),
        (b"<svg>" + b"<g>" * 30_000 + b"</g>" * 30_000 + b"</svg>", "damaged"),
        (b" " * 20_000_001, "20.0 MB, more than 20 MB"),
        (b"", "empty"),
    ],
)
def test_that_a_file_that_is_not_svg_is_refused(content, word, tmp_path) -> None:
    path = tmp_path / "broken.svg"
    path.write_bytes(content)
    with pytest.raises(TargetError) as caught:
        read_svg(path)
    assert word in str(caught.value)
