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
from kirigami_studio.fabricate.panel_sizes import panels_in_mm
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.foundation.errors import MechanicsError
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.mechanics.connectors import ElasticSheet, cut_connectors, junctions
from kirigami_studio.mechanics.estimate import estimate_stretch
from kirigami_studio.mechanics.sheet_network import polygons_as_rows, sheet_network

MPA_PER_GPA = 1e3


def jam_angle_of_file(found: FoundVoids, plan: CutPlan, deployment: Deployment) -> float | None:
    """Estimate where a sheet jams.

    Parameters
    ----------
    found : FoundVoids
        What was read from the file.
    plan : CutPlan
        Its material, kerf, and which connector is which hinge.
    deployment : Deployment
        The design that the plan was made from.

    Returns
    -------
    phi : float or None, radians
        0 where it closes; None where the connectors of the file are not those of the plan, or hold no sheet together.
    """
    there = np.flatnonzero(~plan.hinges.removed)
    matched = matched_connectors(found, plan.hinges.position[there])
    if matched is None:
        return None
    width, deployment = plan.size_mm[0], plan.cut_from(deployment)
    places = junctions(deployment, width, cut_table(*deployment.sheet.grid).hinge_node)
    whole = panels_in_mm(deployment, (), width, np.zeros(2))
    # The corner panel may be trimmed: origins are compared by a panel that is not.
    shift = next(
        (one[0] - other[0] for one, other in zip(whole, plan.panels, strict=True) if len(other) == len(one)), None
    )
    if shift is None:
        return None
    centres, widths = places.place.copy(), np.zeros(len(plan.hinges))
    centres[there] = np.array([connector.centre for connector in found.connectors])[matched] + shift
    widths[there] = np.array([connector.width_mm for connector in found.connectors])[matched]
    connectors = cut_connectors(places, np.maximum(widths, 0.0), plan.kerf_mm, centres)
    elastic = ElasticSheet(MPA_PER_GPA * plan.material.young_gpa, plan.material.thickness_mm)
    rows = polygons_as_rows([part + shift for part in plan.panels])
    try:
        network = sheet_network(rows, connectors, elastic)
    except MechanicsError:  # parts neither close nor jam; that they are parts is another finding
        return None
    return estimate_stretch(deployment, network, width).jam_phi()


def matched_connectors(found: FoundVoids, position: FloatArray) -> IntArray | None:
    """Which connector of a file is at each of the hinges at (T, 2), mm, by least distances: (T,).

    None where there are not as many, or none.
    """
    if len(found.connectors) != len(position) or not len(position):
        return None
    centres = np.array([connector.centre for connector in found.connectors])
    return np.asarray(linear_sum_assignment(cdist(position, centres))[1], dtype=np.intp)
