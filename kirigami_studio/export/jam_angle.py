"""Where a sheet jams, by the centres of its connectors as read from its file.

The centres are given back to the hinges of the design, and the fast estimate of the closing simulator
(``mechanics.estimate``) tells at which angle a connector is stretched by more than it bears, or panels touch.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist

from kirigami_studio.export.voids_read import FoundVoids
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.options import ConnectorStyle
from kirigami_studio.fabricate.panel_sizes import panels_in_mm
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.foundation.errors import MechanicsError
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.mechanics.connectors import ElasticSheet, Junctions, cut_connectors, junctions
from kirigami_studio.mechanics.estimate import estimate_stretch
from kirigami_studio.mechanics.sheet_network import polygons_as_rows, sheet_network

MPA_PER_GPA = 1e3


def jam_angle_of_file(found: FoundVoids, plan: CutPlan, deployment: Deployment) -> float | None:
    """Estimate where a sheet jams.

    Parameters
    ----------
    found : FoundVoids
        What was read from the file, in the plan's frame.
    plan : CutPlan
        Its material, kerf, and which connector is which hinge.
    deployment : Deployment
        The design that the plan was made from.

    Returns
    -------
    phi : float or None, radians
        0 where it closes; None where the connectors of the file are not those of the plan, end in shapes, or hold no
        sheet together.
    """
    if plan.centres is None and plan.options.style not in (ConnectorStyle.CENTRED, ConnectorStyle.STRAIGHT):
        return None  # necks before holes, arcs and bars do not tell where the connector turns
    there = np.flatnonzero(~plan.hinges.removed)
    width, deployment = plan.size_mm[0], plan.cut_from(deployment)
    places = junctions(deployment, width, cut_table(*deployment.sheet.grid).hinge_node)
    whole = panels_in_mm(deployment, (), width, np.zeros(2))
    # The corner panel may be trimmed: origins are compared by a panel that is not.
    shift = next(
        (one[0] - other[0] for one, other in zip(whole, plan.panels, strict=True) if len(other) == len(one)), None
    )
    if shift is None:
        return None
    necks = neck_middles(places, plan) if plan.centres is None else plan.centres + shift
    matched = matched_connectors(found, (necks - shift)[there])
    if matched is None:
        return None
    widths = np.zeros(len(plan.hinges))
    widths[there] = np.maximum([found.connectors[number].width_mm for number in matched.tolist()], 0.0)
    centres = necks.copy()
    centres[there] = np.array([found.connectors[number].centre for number in matched.tolist()]) + shift
    if plan.centres is None:
        # Beside straight slits connectors turn off the middle of their necks; the file tells how far necks are moved.
        gone = widths <= 0.0
        straight = np.zeros_like(necks)
        straight[~gone] = cut_connectors(places, widths, plan.kerf_mm).centres.mean(axis=1)
        centres += np.where(gone[:, None], 0.0, straight - necks)
    connectors = cut_connectors(places, widths, plan.kerf_mm, centres)
    elastic = ElasticSheet(MPA_PER_GPA * plan.material.young_gpa, plan.material.thickness_mm)
    rows = polygons_as_rows([part + shift for part in plan.panels])
    try:
        network = sheet_network(rows, connectors, elastic)
    except MechanicsError:  # parts neither close nor jam; that they are parts is another finding
        return None
    return estimate_stretch(deployment, network, width).jam_phi()


def neck_middles(places: Junctions, plan: CutPlan) -> FloatArray:
    """Middles (H, 2), mm, of the necks before the tips of straight slits."""
    gap = np.maximum(plan.hinges.finished_mm, 0.0) + plan.kerf_mm
    height = gap - np.where(places.on_edge, 0.5 * plan.kerf_mm, 0.0)
    tips = places.place + (height / places.sine)[:, None] * places.along
    middles: FloatArray = tips - 0.5 * gap[:, None] * places.normal
    return middles


def matched_connectors(found: FoundVoids, position: FloatArray) -> IntArray | None:
    """Which connector of a file is at each of the places (T, 2), mm, by least distances: (T,).

    The places are those of the connectors themselves: two slits that end opposite each other have one junction.  None
    where there are not as many, or none.
    """
    if len(found.connectors) != len(position) or not len(position):
        return None
    centres = np.array([connector.centre for connector in found.connectors])
    return np.asarray(linear_sum_assignment(cdist(position, centres))[1], dtype=np.intp)
