"""The hint before generating: what it marks, what it leaves alone, and that fits lose what it marks."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import Polygon

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.figures import BoundingBox, Figure, figure
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.reach import NEEDED_PANELS, Reach, reach_of, reach_texts
from kirigami_studio.outlines.read import read_target
from tests.refusals import refused

DATA = Path(__file__).resolve().parents[2] / "data"
#: Best of 6 polished samples (seed 0, balanced): sheets in the target's frame, and their sIoU.
FITS = json.loads((DATA / "reach_fits.json").read_text(encoding="utf-8"))


def shape(name: str) -> Outline:
    return read_target(DATA / "dev_shapes" / f"{name}-fill.json")


def plate_with(width: float, inwards: bool) -> Outline:
    """A square of 10 with an arm or a notch of some width and length 5."""
    square = Polygon(figure(Figure.RECTANGLE, BoundingBox(0, 0, 10, 10)))
    bottom, top = 5 - width / 2, 5 + width / 2
    bar = shapely.box(5, bottom, 10, top) if inwards else shapely.box(9, bottom, 15, top)
    made = square.difference(bar) if inwards else square.union(bar)
    return Outline.from_points(np.asarray(made.exterior.coords[:-1]))


@pytest.mark.parametrize("kind", [Figure.RECTANGLE, Figure.ELLIPSE, Figure.REGULAR])
@pytest.mark.parametrize("grid", [(4, 4), (10, 10), (24, 24)])
def test_that_plain_shapes_are_not_marked(kind, grid) -> None:
    assert reach_of(Outline.from_points(figure(kind, BoundingBox(0, 0, 10, 10), 6)), grid).clear


@given(width=st.floats(0.3, 6.0), rows=st.integers(4, 30), inwards=st.booleans())
@settings(max_examples=60, deadline=None)
def test_that_an_arm_or_notch_is_marked_just_when_it_is_narrower_than_the_grid_can_show(width, rows, inwards) -> None:
    outline = plate_with(width, inwards)
    scale = math.sqrt(100 + (-5 if inwards else 5) * width)
    needed = NEEDED_PANELS / (rows + 1) * scale
    reach = reach_of(outline, (rows, rows))
    if width < 0.95 * needed and 5 * width > 0.6 * (scale / (rows + 1)) ** 2:
        assert len(reach.notches if inwards else reach.arms) >= 1
    elif width > 1.05 * needed and needed < 2:
        assert reach.clear


def test_that_the_mark_lies_on_the_arm() -> None:
    outline = plate_with(1.0, inwards=False)
    reach = reach_of(outline, (10, 10))
    assert len(reach.arms) == 1 and reach.notches == ()
    tip = outline.points[np.argmax(outline.points[:, 0])]
    assert Polygon(reach.arms[0]).distance(shapely.Point(tip)) < 1e-6
    assert reach.share == pytest.approx(5.0 / 105, rel=0.05)


def test_that_a_finer_grid_is_named_that_shows_everything() -> None:
    outline = plate_with(1.6, inwards=True)
    reach = reach_of(outline, (10, 10))
    said, brief = reach_texts(reach, outline, 9.6)
    assert "narrower than 1.7 mm" in said and "10 \N{MULTIPLICATION SIGN} 10" in said, "which one, and for which grid"
    finer = brief.removesuffix(".").split("Try ")[1]
    rows, columns = (int(word) for word in finer.split(" \N{MULTIPLICATION SIGN} "))
    assert f"or try {finer} voids" in said
    assert reach_of(outline, (rows, columns)).clear


def test_that_hopeless_parts_should_be_made_wider_and_nothing_is_said_of_good_ones() -> None:
    hair = plate_with(0.1, inwards=False)
    assert reach_texts(reach_of(hair, (10, 10)), hair)[0].endswith("makes it blunt. Draw them wider.")
    heart = silhouettes.load("heart")
    assert reach_texts(reach_of(heart, (16, 16)), heart) == ("", "")


def test_that_a_grid_without_voids_is_refused() -> None:
    with refused(TargetError, "reach.no_voids", columns=4, rows=0):
        reach_of(silhouettes.load("heart"), (0, 4))


# what fits lose -----------------------------------------------------------------------------------


def loss(fit: dict[str, object]) -> tuple[Reach, Polygon, float]:
    """The mark, the places where sheet and target differ, and what the match misses."""
    outline, grid = shape(str(fit["name"])), tuple(fit["grid"])  # type: ignore[arg-type]
    sheet = shapely.make_valid(Polygon(fit["sheet"]))
    return reach_of(outline, grid), outline.polygon.symmetric_difference(sheet), 1 - float(fit["siou"])  # type: ignore[arg-type]


def test_that_fits_miss_more_of_shapes_that_are_marked() -> None:
    found = [loss(fit) for fit in FITS]
    marked = [missed for reach, _, missed in found if not reach.clear]
    others = [missed for reach, _, missed in found if reach.clear]
    assert len(marked) >= 12 and len(others) >= 20
    assert np.mean(marked) > 3 * np.mean(others) and min(marked) > 0.02
    shares, missed = [reach.share for reach, _, _ in found], [missed for _, _, missed in found]
    assert np.corrcoef(shares, missed)[0, 1] > 0.7
    # Control: the order of the fits matters, so the figure is no matter of course.
    assert abs(np.corrcoef(shares, np.roll(missed, 7))[0, 1]) < 0.4


def test_that_fits_miss_more_at_the_marked_places_than_along_the_rest() -> None:
    inside = length = total = around = 0.0
    for fit in FITS:
        reach, differs, _ = loss(fit)
        if reach.clear:
            continue
        outline = shape(fit["name"])
        panel = reach.narrowest / NEEDED_PANELS
        zone = shapely.union_all([Polygon(ring) for ring in (*reach.arms, *reach.notches)]).buffer(0.35 * panel)
        inside, total = inside + differs.intersection(zone).area, total + differs.area
        edge = outline.polygon.exterior
        length, around = length + edge.intersection(zone).length, around + edge.length
    assert inside / total > 1.4 * length / around


def test_that_an_undercut_is_marked_on_every_grid_and_the_advice_is_not_a_finer_one() -> None:
    mouth, inside = 1.0, 5.0
    notch = [(5 - mouth / 2, 10), (5 - inside / 2, 6), (5 + inside / 2, 6), (5 + mouth / 2, 10)]
    outline = Outline.from_points(np.array([(0, 0), (10, 0), (10, 10), *notch[::-1], (0, 10)], dtype=float))
    leaning = [(8, 10), (6, 6), (4, 6), (2, 10)]
    wide = Outline.from_points(np.array([(0, 0), (10, 0), (10, 10), *leaning, (0, 10)], dtype=float))
    for grid in ((8, 8), (30, 30)):
        reach = reach_of(outline, grid)
        assert math.degrees(reach.turns_back) == pytest.approx(180 + 2 * math.degrees(math.atan2(2, 4)), abs=1)
        assert Polygon(reach.undercut).area * 84 == pytest.approx(0.5 * (mouth + inside) * 4, rel=0.1)
        assert "wider at its mouth" in reach_texts(reach, outline)[0]
        assert not reach_of(wide, grid).turns_back
