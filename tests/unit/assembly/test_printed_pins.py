"""Panels that are printed on their pins: free over the whole motion, held by their pins, without support."""

from __future__ import annotations

import math
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from manifold3d import Manifold, Mesh64
from refusals import refused
from solid_reader import read_3mf, read_stl

from kirigami_studio.assembly.printed import PinJoint, pinned_solids
from kirigami_studio.assembly.solids import Plate, PrintedPins, PrintForm, Printing
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.registry import export
from kirigami_studio.fabricate.cut_plan import plan_cuts
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
def plate(design: Deployment) -> Plate:
    return pinned_solids(design, None, WIDTH, 0.0, THICKNESS, PINS)


def placed(design: Deployment, plate: Plate, phi: float, raised: float = 0.0) -> list[Manifold]:
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
def test_that_no_two_bodies_meet_at_any_angle(design: Deployment, plate: Plate, phi_deg: int) -> None:
    bodies = placed(design, plate, math.radians(phi_deg))
    for one, other in combinations(bodies, 2):
        assert one.min_gap(other, 1.0) >= PINS.clearance_mm - 0.03


@pytest.mark.parametrize("raised", [0.8, -0.8])
def test_that_no_pin_comes_out_of_its_ear(design: Deployment, plate: Plate, raised: float) -> None:
    bodies = placed(design, plate, 1.0, raised)
    layers = [solid.layer for solid in plate]
    hinges = sum((bodies[one] ^ bodies[other]).volume() > 0.01 for one, other in combinations(range(len(bodies)), 2)
                 if layers[one] != layers[other])  # fmt: skip
    assert hinges == 3 * 3 + 2 * 4  # every pair of neighbouring panels


def test_that_nothing_hangs_over_flatter_than_its_cones(plate: Plate) -> None:
    for solid in plate:
        one, two, three = np.moveaxis(solid.vertices[solid.faces], 1, 0)
        normal = np.cross(two - one, three - one)
        area = np.linalg.norm(normal, axis=1)
        above = np.maximum(np.maximum(one[:, 2], two[:, 2]), three[:, 2]) > 1e-6
        hanging = above & (area > 1e-6) & (normal[:, 2] < -(math.cos(math.radians(44.9))) * area)
        assert not hanging.any(), solid.name


def test_that_every_body_stands_on_the_plate_and_has_the_thickness(plate: Plate) -> None:
    for solid in plate:
        assert solid.low[2] == pytest.approx(0.0, abs=1e-9) and solid.high[2] == pytest.approx(THICKNESS)
    assert [solid.name for solid in plate][:4] == ["A1", "B1", "A2", "B2"]


def test_that_other_readers_find_the_same_closed_bodies(design: Deployment, tmp_path: Path) -> None:
    printing = Printing(PrintForm.PINNED, THICKNESS)
    job = ExportJob(design, plan=plan_cuts(design, WIDTH, 1.0, 0.2), printing=printing)
    bodies, alone = read_3mf(export(job, tmp_path / "pins.3mf")), read_stl(export(job, tmp_path / "pins.stl"))
    assert len(bodies) == 12 and all(body.closed for body in bodies.values()) and alone.closed
    assert len({body.colour for body in bodies.values()}) == 2
    assert alone.volume == pytest.approx(sum(body.volume for body in bodies.values()), rel=1e-4)
    assert alone.bounds[0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-4)


def test_that_sizes_that_do_not_fit_are_refused_with_the_least_that_do(design: Deployment) -> None:
    with refused(FabricationError, "printed.too_thin_for_pins") as caught:
        pinned_solids(design, None, WIDTH, 0.0, 2.0, PINS)
    pinned_solids(design, None, WIDTH, 0.0, float(str(caught.value.fields["least_mm"])), PINS)
    with refused(FabricationError, "printed.ear_too_small") as caught:
        pinned_solids(design, None, WIDTH, 0.0, THICKNESS, PrintedPins(ear_mm=4.0, pin_mm=2.4))
    least = float(str(caught.value.fields["least_mm"]))
    pinned_solids(design, None, WIDTH, 0.0, THICKNESS, PrintedPins(ear_mm=least, pin_mm=2.4))
    with refused(FabricationError, "printed.cone_too_flat"):
        PrintedPins(cone_deg=30.0)
    with refused(FabricationError, "printed.pins_not_positive"):
        PrintedPins(ear_mm=2.0, pin_mm=2.4)


def test_that_the_usual_thickness_is_the_least_in_whole_layers(design: Deployment, tmp_path: Path) -> None:
    job = ExportJob(design, plan=plan_cuts(design, WIDTH, 1.0, 0.2), printing=Printing(PrintForm.PINNED))
    least = PinJoint.least_mm(PINS)
    height = read_stl(export(job, tmp_path / "pins.stl")).bounds[1, 2]
    assert least <= height < least + 0.2 and height / 0.2 == pytest.approx(round(height / 0.2), abs=1e-4)
    with refused(FabricationError, "printed.too_thin_for_pins"):
        pinned_solids(design, None, WIDTH, 0.0, least - 0.01, PINS)


def test_that_pins_without_room_for_their_ears_are_refused() -> None:
    even = deploy(RatioField.from_log10(np.full((2, 2), 0.01)))
    with refused(FabricationError, "printed.pins_too_near", needed_mm=PINS.apart_mm) as caught:
        pinned_solids(even, None, WIDTH, 0.0, THICKNESS, PINS)
    assert float(str(caught.value.fields["apart_mm"])) < 2.0


def test_that_an_assembly_larger_than_the_bed_is_refused(design: Deployment, tmp_path: Path) -> None:
    printing = Printing(PrintForm.PINNED, THICKNESS, bed_mm=(90.0, 200.0))
    job = ExportJob(design, plan=plan_cuts(design, WIDTH, 1.0, 0.2), printing=printing)
    with refused(FabricationError, "printed.assembly_larger_than_bed", bed_width_mm=90.0):
        export(job, tmp_path / "pins.stl")
    assert list(tmp_path.iterdir()) == []


def test_that_trimmed_panels_keep_their_ears_and_panels_that_are_gone_have_none(design: Deployment) -> None:
    whole = design.compact[design.topology.panel_nodes.reshape(-1, 4)]
    kept: list[np.ndarray | None] = [None] * len(whole)
    kept[0] = np.zeros((0, 2))
    solids = pinned_solids(design, kept, WIDTH, 0.0, THICKNESS, PINS)
    assert len(solids) == 11
    for gone in (1, 5, 9):  # the second column
        kept[gone] = np.zeros((0, 2))
    with refused(FabricationError, "printed.loose_parts", parts=2):
        pinned_solids(design, kept, WIDTH, 0.0, THICKNESS, PINS)
