"""Panels with bows run into each other where an independent, rigid check of the true panels finds it."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
import shapely
from shapely.affinity import affine_transform
from shapely.geometry import Point, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.fabricate.cut_plan import CutPlan, Layer
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.sheet_files import sheet_of_json
from kirigami_studio.mechanics.closing import TOLERATED_STRETCH, Closing, closing, ideal_motion
from kirigami_studio.mechanics.network import Stops
from kirigami_studio.mechanics.sheet_network import SheetNetwork
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.as_cut import planned_sheet
from kirigami_studio.studio.cutting import plan_sheet
from tests.cut_sheets import burned

DATA = Path(__file__).parents[2] / "data"
EASY = json.loads((DATA / "easy_sheets.json").read_text(encoding="utf-8"))
#: Sheets of 10 x 10 voids as ``design --k 4`` made them, with panels small enough for bows to meet.
BOWED = json.loads((DATA / "bowed_sheets.json").read_text(encoding="utf-8"))
WIDTH = 100.0
#: Around a connector so many spans of its width and kerf bend: they belong to no rigid panel.
BENDING = 1.25
#: Angles (degrees) at which the rigid check looks.
LOOKED_DEG = (90.0, 60.0, 45.0, 30.0, 25.0, 20.0, *np.arange(16.0, 1.5, -1.0).tolist())


def bowed(name: str) -> Deployment:
    return deploy(sheet_of_json(BOWED[name]))


def made(design: Deployment, style: ConnectorStyle, connector_mm: float) -> tuple[CutPlan, Deployment, SheetNetwork]:
    settings = FabricationSettings(WIDTH, connector_mm=connector_mm, options=CutOptions(style=style))
    plan = plan_sheet(design, settings)
    return plan, plan.cut_from(design), planned_sheet(plan.cut_from(design), plan, WIDTH)


def true_panels(plan: CutPlan, sheet: SheetNetwork) -> npt.NDArray[np.object_]:
    """What the kerf leaves of every panel, without what bends at connectors, in the network's frame: no own geometry.

    The material that is left when all cuts are burned away hangs together at connectors alone; without these it falls
    into the panels.
    """
    left = Polygon(plan.outline).buffer(-0.5 * plan.kerf_mm, join_style="mitre")
    cuts = [path for path in plan.paths if path.layer is not Layer.OUTLINE]
    left = left.difference(shapely.union_all([burned(path, max(plan.kerf_mm, 1e-3)) for path in cuts]))
    shift = sheet.network.outlines[0, 0] - plan.panels[0][0]
    spans = BENDING * (sheet.connectors.width_mm + plan.kerf_mm)
    for centre, span in zip(sheet.connectors.centres.mean(axis=1) - shift, spans.tolist(), strict=True):
        left = left.difference(Point(centre).buffer(span))
    found: list[BaseGeometry] = [Polygon()] * len(plan.panels)
    parts = [part for part in shapely.get_parts(left) if part.area > 1e-6]
    for number, panel in enumerate(plan.panels):
        own = [part for part in parts if part.intersection(Polygon(panel)).area > 0.5 * part.area]
        found[number] = shapely.union_all(own)
    return np.array([affine_transform(part, [1, 0, 0, 1, *shift]) for part in found], dtype=object)


def moved(panels: npt.NDArray[np.object_], sheet: SheetNetwork, motion: FloatArray) -> npt.NDArray[np.object_]:
    places = []
    for panel, (x, y), (dx, dy, turn) in zip(panels, sheet.network.centroids, motion, strict=True):
        cos, sin = math.cos(turn), math.sin(turn)
        at = (x + dx - cos * x + sin * y, y + dy - sin * x - cos * y)
        places.append(affine_transform(panel, [cos, -sin, sin, cos, *at]))
    return np.array(places, dtype=object)


def deepest(panels: npt.NDArray[np.object_]) -> float:
    """How wide (mm) two panels overlap at most: the diameter of the largest circle in what they share."""
    one, other = shapely.STRtree(panels).query(panels, "intersects")
    apart = one < other
    shared = shapely.intersection(panels[one[apart]], panels[other[apart]], grid_size=1e-7)
    parts = shapely.get_parts(shared)
    areas = parts[(shapely.get_type_id(parts) == shapely.GeometryType.POLYGON) & (shapely.area(parts) > 1e-7)]
    return max((2.0 * float(shapely.maximum_inscribed_circle(area).length) for area in areas), default=0.0)


def rigid_jam(
    panels: npt.NDArray[np.object_], sheet: SheetNetwork, deployment: Deployment, connector_mm: float
) -> float:
    """Angle (degrees) of the ideal motion from which on panels overlap by more than their connectors may give.

    Across a void two connectors in a row give way, each by what it tolerates; 0 where panels never overlap so much.
    """
    for degrees in LOOKED_DEG:
        motion = ideal_motion(deployment, sheet.network, WIDTH, math.radians(degrees))
        if deepest(moved(panels, sheet, motion)) > 2.0 * TOLERATED_STRETCH * connector_mm:
            return degrees
    return 0.0


@pytest.mark.parametrize(
    ("name", "connector_mm"),
    [("heart", 0.5), ("heart", 1.0), ("star", 0.2), ("gear", 1.0)],
)
def test_that_the_jam_angle_is_that_of_the_rigid_check(name: str, connector_mm: float) -> None:
    plan, deployment, sheet = made(bowed(name), ConnectorStyle.CENTRED, connector_mm)
    panels, found = true_panels(plan, sheet), closing(sheet)
    jam = math.degrees(found.jam_phi())
    assert abs(jam - rigid_jam(panels, sheet, deployment, connector_mm)) <= 5.0
    # On their way there no two panels are in each other.
    reached = max(jam, 2.0)
    for degrees in (20.0, 10.0, 6.0, reached):
        if degrees >= reached:
            motion = found.motion_at(math.radians(degrees))
            assert deepest(moved(panels, sheet, motion)) < TOLERATED_STRETCH * connector_mm, degrees


def test_that_contacts_of_bows_are_what_a_sheet_jams_by() -> None:
    plan, _, sheet = made(bowed("heart"), ConnectorStyle.CENTRED, 0.5)
    bare, panels = closing(without_stops(sheet)), true_panels(plan, sheet)
    # Without them it closes, with its panels in each other from between 10 and 5 degrees on.
    assert bare.jam_phi() == 0.0
    at = [deepest(moved(panels, sheet, bare.motion_at(math.radians(degrees)))) for degrees in (10.0, 5.0, 2.0)]
    assert at[0] < 0.01 and min(at[1:]) > 0.25
    found = closing(sheet)
    assert math.radians(2.0) < found.jam_phi() < math.radians(6.0)
    assert deepest(moved(panels, sheet, found.motion_at(found.jam_phi()))) < 0.5 * at[1]


@pytest.mark.parametrize("name", ["hexagon", "circle", "house"])
def test_that_sheets_whose_bows_stay_apart_have_none(name: str) -> None:
    design = deploy(sheet_of_json(EASY[name]))
    plan, deployment, sheet = made(design, ConnectorStyle.CENTRED, 0.5)
    assert len(sheet.network.stops) == 0 and closing(sheet).jam_phi() == 0.0
    assert rigid_jam(true_panels(plan, sheet), sheet, deployment, 0.5) == 0.0


@pytest.mark.parametrize("style", [ConnectorStyle.STRAIGHT, ConnectorStyle.ARC, ConnectorStyle.DOUBLE])
def test_that_styles_without_bows_are_closed_as_before(style: ConnectorStyle) -> None:
    assert len(made(bowed("heart"), style, 0.5)[2].network.stops) == 0


def test_that_contacts_cost_less_than_the_closing_itself() -> None:
    plan, _, sheet = made(bowed("star"), ConnectorStyle.CENTRED, 0.5)
    assert len(sheet.network.stops) > 50
    bare = without_stops(sheet)

    def seconds(run: Callable[[], object]) -> float:
        spent = []
        for _ in range(2):
            begun = time.process_time()
            run()
            spent.append(time.process_time() - begun)
        return min(spent)

    def with_contacts() -> Closing:
        return closing(planned_sheet(plan.cut_from(bowed("star")), replace(plan), WIDTH))

    # The panels are found anew each time; measured on one core: 1.7 times.
    assert seconds(with_contacts) < 3.0 * seconds(lambda: closing(bare))


def without_stops(sheet: SheetNetwork) -> SheetNetwork:
    return replace(sheet, network=replace(sheet.network, stops=Stops.none()))
