"""Panels that are printed on their pins: free over the whole motion, held by their pins, without support."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
import pytest
from manifold3d import Manifold, Mesh64
from refusals import refused

from kirigami_studio.assembly.options import PinOptions
from kirigami_studio.assembly.pieces import Assembly
from kirigami_studio.assembly.pinned import assembled
from kirigami_studio.assembly.printed import PinJoint, cap_solids, pinned_solids
from kirigami_studio.assembly.shaping import Shaping
from kirigami_studio.assembly.solids import LAYER_MM, Solid
from kirigami_studio.fabricate.fastener import PrintedPins
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField

WIDTH, THICKNESS = 100.0, 4.2
PINS = PrintedPins()


def pinwheel(rows: int, columns: int, seed: int = 0) -> Deployment:
    """A design whose ratios are above and below 1 like a checkerboard."""
    signs = (-1.0) ** np.add.outer(np.arange(rows), np.arange(columns))
    size = 0.2 + np.random.default_rng(seed).uniform(-0.05, 0.05, (rows, columns))
    return deploy(RatioField.from_log10(signs * size))


@pytest.fixture(scope="module")
def design() -> Deployment:
    return pinwheel(2, 3)


@pytest.fixture(scope="module")
def assembly(design: Deployment) -> Assembly:
    sizes = {"pin_mm": PINS.pin_mm, "ear_mm": PINS.ear_mm, "clearance_mm": PINS.clearance_mm, "neck_mm": 1.2}
    options = PinOptions(**sizes, wall_mm=2.0, margin_mm=0.0, in_one_plane=True)
    cell = WIDTH / float(np.ptp(design.compact[:, 0]))
    return assembled(Shaping.of(design, cell, 0.0, options), design, cell, 0.0)


@pytest.fixture(scope="module")
def plate(assembly: Assembly) -> tuple[Solid, ...]:
    return pinned_solids(assembly, THICKNESS, PINS)


def placed(design: Deployment, plate: tuple[Solid, ...], phi: float, raised: float = 0.0) -> list[Manifold]:
    """Bodies at an angle, by the corners of their panels, those of layer 1 raised."""
    cell = WIDTH / np.ptp(design.compact[:, 0])
    flat, now = (cell * design.panels(angle).reshape(-1, 4, 2) for angle in (math.pi, phi))
    found = []
    for solid, before, after in zip(plate, flat, now, strict=True):
        turn = np.subtract(np.arctan2(*(after[1] - after[0])[::-1]), np.arctan2(*(before[1] - before[0])[::-1]))
        body = Manifold(Mesh64(solid.vertices.copy(), solid.faces.astype(np.uint64)))
        lifted = raised if solid.layer == 1 else 0.0
        body = body.translate([*(-before[0]), lifted]).rotate([0.0, 0.0, math.degrees(turn)])
        found.append(body.translate([*after[0], 0.0]))
    return found


@pytest.mark.parametrize("phi_deg", [180, 150, 110, 70, 30, 0])
def test_that_no_two_bodies_meet_at_any_angle(design: Deployment, plate: tuple[Solid, ...], phi_deg: int) -> None:
    bodies = placed(design, plate, math.radians(phi_deg))
    for one, other in combinations(bodies, 2):
        assert one.min_gap(other, 1.0) >= PINS.clearance_mm - 0.01


@pytest.mark.parametrize("raised", [0.8, -0.8])
def test_that_no_pin_comes_out_of_its_ear(design: Deployment, plate: tuple[Solid, ...], raised: float) -> None:
    bodies = placed(design, plate, 1.0, raised)
    layers = [solid.layer for solid in plate]
    hinges = sum((bodies[one] ^ bodies[other]).volume() > 0.01 for one, other in combinations(range(len(bodies)), 2)
                 if layers[one] != layers[other])  # fmt: skip
    assert hinges == 3 * 3 + 2 * 4  # every pair of neighbouring panels


def test_that_nothing_hangs_over_flatter_than_its_cones(plate: tuple[Solid, ...]) -> None:
    for solid in plate:
        one, two, three = np.moveaxis(solid.vertices[solid.faces], 1, 0)
        normal = np.cross(two - one, three - one)
        area = np.linalg.norm(normal, axis=1)
        above = np.maximum(np.maximum(one[:, 2], two[:, 2]), three[:, 2]) > 1e-6
        hanging = above & (area > 1e-6) & (normal[:, 2] < -(math.cos(math.radians(44.9))) * area)
        assert not hanging.any(), solid.name


def test_that_every_body_stands_on_the_plate_and_has_the_thickness(plate: tuple[Solid, ...]) -> None:
    for solid in plate:
        assert solid.low[2] == pytest.approx(0.0, abs=1e-9) and solid.high[2] == pytest.approx(THICKNESS)
    assert [solid.name for solid in plate][:4] == ["A1", "B1", "A2", "B2"]


def test_that_sizes_that_do_not_fit_are_refused_with_the_least_that_do() -> None:
    with refused(FabricationError, "printed.too_thin_for_pins") as caught:
        PinJoint.of(PINS, 2.0)
    PinJoint.of(PINS, float(str(caught.value.fields["least_mm"])))
    with refused(FabricationError, "printed.ear_too_small") as caught:
        PinJoint.of(PrintedPins(ear_mm=4.0, pin_mm=2.4), THICKNESS)
    least = float(str(caught.value.fields["least_mm"]))
    PinJoint.of(PrintedPins(ear_mm=least, pin_mm=2.4), THICKNESS)
    with refused(FabricationError, "printed.cone_too_flat"):
        PrintedPins(cone_deg=30.0)
    with refused(FabricationError, "printed.pins_not_positive"):
        PrintedPins(ear_mm=2.0, pin_mm=2.4)


def test_that_a_pin_at_a_seam_and_its_cap_take_the_room_of_a_whole_pin() -> None:
    joint = PinJoint.of(PINS, THICKNESS)
    both = joint.seam_pin.union(joint.cap)
    assert joint.seam_pin.intersection(joint.cap).area == 0.0 and joint.pin.buffer(1e-9).covers(both)
    assert joint.pin.difference(both).area < 0.15  # the room for glue, and the tip of the cap
    assert joint.cap.bounds[0] < PINS.pin_mm / 2 + PINS.clearance_mm < joint.cap.bounds[2]  # the ring does not come off
    caps = cap_solids(5, THICKNESS, PINS)
    assert len(caps) == 5 and min(solid.low[2] for solid in caps) == 0.0
    assert len({tuple(np.round(solid.low, 3)) for solid in caps}) == 5


@pytest.mark.parametrize("clearance", [0.2, 0.3, 0.4, 0.6])
def test_that_an_ear_that_is_left_open_holds_its_pin_at_every_clearance(clearance: float) -> None:
    pins = PrintedPins.of(None, None, clearance)
    assert (pins.pin_mm, pins.clearance_mm) == (PINS.pin_mm, clearance)
    assert 0.5 <= pins.ear_mm - pins.least_ear_mm <= 0.6 + 1e-9
    PinJoint.of(pins, PinJoint.usual_mm(pins, 0.0))
    assert PrintedPins.of(None, None, None) == PINS


def test_that_the_usual_thickness_is_that_of_the_material_in_whole_layers_and_the_least_of_the_pins() -> None:
    least = PinJoint.least_mm(PINS)
    for material in (0.5, 3.0, least, 5.1, 6.0):
        height = PinJoint.usual_mm(PINS, material)
        assert max(least, material) - 1e-9 <= height < max(least, material) + LAYER_MM
        assert height / LAYER_MM == pytest.approx(round(height / LAYER_MM), abs=1e-6)
    with refused(FabricationError, "printed.too_thin_for_pins"):
        PinJoint.of(PINS, least - 0.01)


def test_that_coordinates_differ_in_single_precision_so_that_stl_closes(plate: tuple[Solid, ...]) -> None:
    for solid in plate:
        assert len(np.unique(solid.vertices.astype(np.float32), axis=0)) == len(solid.vertices), solid.name
