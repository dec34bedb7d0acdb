"""Corners that are left to trimmed panels are the same for cut plan, pieces and linkages."""

import numpy as np
import pytest
import shapely
from shapely.geometry import Point, Polygon

from kirigami_studio.assembly.cut_away import _left_by
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.trimming import Trim
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.linkage import linkage_of
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.fabricate.trimmed_sheet import lost_hinges
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.left_corners import AT_CORNER, left_corners
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet

#: A panel inside of the sheet, and its number.
INSIDE, NUMBER = (1, 1), 5


@pytest.fixture(scope="module")
def deployment() -> Deployment:
    return deploy(Sheet(RatioField(np.ones((3, 3)))))


def trimmed(deployment: Deployment, off: float) -> Trim:
    """A trim that takes a disc of a radius, unit cells, off the first corner of a panel."""
    corners = deployment.compact[deployment.topology.panel_nodes.reshape(-1, 4)]
    part = Polygon(corners[NUMBER]).difference(Point(corners[NUMBER, 0]).buffer(off))
    kept: list[FloatArray | None] = [None] * len(corners)
    kept[NUMBER] = shapely.get_coordinates(part.exterior)[:-1]
    return Trim(deployment.sheet, 0.0, Similarity(), 0.1, True, tuple(kept), 1.0, 1.0, 0.0)


def test_that_whole_panels_have_all_corners_and_panels_that_are_gone_none(deployment: Deployment) -> None:
    corners = deployment.compact[deployment.topology.panel_nodes.reshape(-1, 4)]
    kept: list[FloatArray | None] = [None] * len(corners)
    kept[NUMBER] = np.zeros((0, 2))
    found = left_corners(kept, corners)
    assert not found[NUMBER].any()
    assert np.delete(found, NUMBER, axis=0).all()


@pytest.mark.parametrize(("off", "lost"), [(0.8 * AT_CORNER, 0), (1.2 * AT_CORNER, 1)])
def test_that_cut_plan_pieces_and_linkage_have_the_same_hinges(deployment: Deployment, off: float, lost: int) -> None:
    trim = trimmed(deployment, off)
    every = len(cut_table(3, 3).hinge_node)
    assert len(lost_hinges(deployment, trim.kept, cut_table(3, 3))) == lost
    job = ExportJob(deployment, trim=trim)
    assert len(linkage_of(job).hinges) == every - lost
    assert np.unique(_left_by(trim, deployment).corners[_left_by(trim, deployment).hinged]).size == every - lost
