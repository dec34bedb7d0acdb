"""What stays of every panel of a trimmed sheet, panel by panel: the slow reference of the posed motion."""

from __future__ import annotations

import math

import numpy as np

from kirigami_studio.evaluate.trimming import Trim
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import Deployment, rotate


def compact_parts(trim: Trim, deployment: Deployment) -> list[FloatArray]:
    """Every panel in the compact sheet, whole ones included: (P, 2) float each, unit cells."""
    corners = deployment.compact[deployment.topology.panel_nodes.reshape(-1, 4)]
    return [whole if part is None else part for part, whole in zip(trim.kept, corners, strict=True)]


def deployed_parts(trim: Trim, deployment: Deployment, phi: float) -> list[FloatArray]:
    """The same at any angle, in the layout's frame: each part turns with its panel about the panel's top node."""
    half, nodes, parts = 0.5 * (math.pi - phi), deployment.nodes(phi), []
    corners = deployment.topology.panel_nodes
    for (line, place), part in zip(np.ndindex(corners.shape[:2]), compact_parts(trim, deployment), strict=True):
        anchor = corners[line, place, 0]
        turn = -half if (line + place) % 2 == 0 else half
        parts.append(rotate(part - deployment.compact[anchor], turn) + nodes[anchor])
    return parts
