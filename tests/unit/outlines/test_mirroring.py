"""Drawing with a mirror: what comes is symmetric, whatever was drawn."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines.anchors import Anchors
from kirigami_studio.outlines.combining import Combine
from kirigami_studio.outlines.figures import BoundingBox, Figure, figure
from kirigami_studio.outlines.mirroring import IMAGES, Axis, Mirror, mirrored
from kirigami_studio.outlines.placed import Placed
from kirigami_studio.outlines.refining import stroked
from tests.refusals import refused

AXES = [Axis.UPRIGHT, Axis.LEVEL, Axis.BOTH]


def asymmetry(placed: Placed, mirror: Mirror) -> float:
    """Largest share of the area that lies apart from an image."""
    shapes = [Placed.from_ring(image, "").polygon for image in mirror.all_images(placed.ring)]
    return max(placed.polygon.symmetric_difference(shape).area for shape in shapes) / placed.polygon.area


@given(st.sampled_from(AXES), st.floats(-9, 9), st.floats(-9, 9), st.floats(5, 40), st.floats(5, 40))
@settings(max_examples=40, deadline=None)
def test_that_a_shape_across_the_axis_and_its_images_are_one_symmetric_target(axis, x, y, width, height) -> None:
    mirror = Mirror(axis, (3.0, -2.0))
    box = BoundingBox(3.0 + x - width, -2.0 + y - height, 3.0 + x + width, -2.0 + y + height)
    if abs(x) > 0.8 * width or abs(y) > 0.8 * height:
        return
    drawn = Placed.from_ring(figure(Figure.STAR, box, 6, 0.7), "star")
    made = mirrored(None, drawn, Combine.NEW, "star", mirror)
    assert asymmetry(made, mirror) < 1e-5
    assert made.polygon.area >= drawn.polygon.area * (1 - 1e-6)


def test_that_a_shape_beside_the_axis_is_refused_and_ears_are_added_both() -> None:
    mirror = Mirror(Axis.UPRIGHT)
    ear = Placed.from_ring(figure(Figure.ELLIPSE, BoundingBox(10, 10, 20, 30)), "ear")
    with refused(TargetError, "mirror.images_apart"):
        mirrored(None, ear, Combine.NEW, "ear", mirror)
    head = Placed.from_ring(figure(Figure.ELLIPSE, BoundingBox(-20, -20, 20, 20)), "head")
    hare = mirrored(head, ear, Combine.ADD, "ear", mirror)
    assert asymmetry(hare, mirror) < 1e-5 and hare.polygon.bounds[3] == pytest.approx(30)
    bitten = mirrored(head, ear, Combine.SUBTRACT, "ear", mirror)
    assert asymmetry(bitten, mirror) < 1e-5 and bitten.polygon.area < head.polygon.area
    # Control: without the mirror there is one ear.
    assert asymmetry(mirrored(head, ear, Combine.ADD, "ear", Mirror()), mirror) > 0.05


@pytest.mark.parametrize("axis", AXES)
def test_that_a_stroke_from_axis_to_axis_is_the_half_or_quarter_of_a_whole(axis) -> None:
    mirror = Mirror(axis, (5.0, 1.0))
    until = math.pi / 2 if axis is Axis.BOTH else math.pi
    angle = np.linspace(0.02, until - 0.02, 60) + (math.pi / 2 if axis is Axis.UPRIGHT else 0.0)
    stroke = np.column_stack([30 * np.cos(angle), 20 * np.sin(angle)]) + mirror.at
    whole = mirror.completed(stroke)
    assert whole is not None
    made = mirror.evened(stroked(whole))
    assert asymmetry(made, mirror) < 1e-5
    assert made.polygon.area == pytest.approx(math.pi * 30 * 20, rel=0.02)


def test_that_a_stroke_that_ends_elsewhere_is_a_shape_of_its_own() -> None:
    stroke = np.array([(10.0, 0.0), (30.0, 0.0), (30.0, 20.0), (12.0, 20.0)])
    for axis in Axis:
        assert Mirror(axis).completed(stroke) is None


def test_that_images_are_reflections_and_both_axes_give_three() -> None:
    assert [len(images) for images in IMAGES.values()] == [0, 1, 1, 3]
    mirror = Mirror(Axis.BOTH, (1.0, 2.0))
    for factors in mirror.images:
        point = np.array([4.0, 7.0])
        np.testing.assert_allclose(mirror.image(mirror.image(point, factors), factors), point)


def test_that_every_point_gets_its_image_on_the_line() -> None:
    target = Placed.from_ring(figure(Figure.RECTANGLE, BoundingBox(-20, -10, 20, 10)), "plate")
    anchors, _ = Anchors.of(target).inserted((13.0, 10.0))
    mirror = Mirror(Axis.UPRIGHT)
    images = [mirror.image(anchors.places, factors) for factors in mirror.images]
    more = anchors.evened(images, 0.1)
    for place in more.places:
        image = mirror.image(place, (-1, 1))
        assert np.min(np.linalg.norm(more.places - image, axis=1)) < 0.1
    assert len(more.places) == len(anchors.places) + 1
    assert more.evened([np.array([(0.0, 3.0)])], 0.1) is more  # not on the line
