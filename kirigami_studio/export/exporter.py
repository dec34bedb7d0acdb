"""What every exporter gets and is."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

import numpy as np

from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.export.profile import DEFAULT_PROFILE
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.lattice.deployment import Deployment, signed_area
from kirigami_studio.lattice.ratio_field import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class ExportJob:
    """All that any kind of file may need.

    Attributes
    ----------
    deployment : Deployment
    phi : float, radians
        Target angle.
    plan : CutPlan or None
        Needed by cut files (DXF, SVG, PDF).
    target : (L, 2) float or None
        Target outline, drawn behind pictures.
    transform : Similarity
        Takes the layout's frame at ``phi`` to the target's.
    dxf_version : str
    profile : str
        Key of the colour profile.
    """

    deployment: Deployment
    phi: float = 0.0
    plan: CutPlan | None = None
    target: FloatArray | None = None
    transform: Similarity = field(default_factory=Similarity)
    dxf_version: str = "R2010"
    profile: str = DEFAULT_PROFILE

    @property
    def required_plan(self) -> CutPlan:
        """The plan, or a refusal.

        Raises
        ------
        ExportError
            The job has none.
        """
        if self.plan is None:
            raise ExportError("A cut file needs a cut plan: choose a material and a sheet width first.")
        return self.plan

    def placed(self, nodes: FloatArray) -> FloatArray:
        """Move points (..., 2) from the layout's frame at ``phi`` to the target's frame."""
        matrix = self.transform.matrix
        moved: FloatArray = nodes @ matrix[:, :2].T + matrix[:, 2]
        return moved

    def placed_nodes(self, phi: float) -> FloatArray:
        """All nodes at any angle in the target's frame: turned as at the target angle, with the same centroid."""
        loop = self.deployment.topology.outline_nodes
        goal = self.placed(self.deployment.nodes(self.phi))
        nodes = self.placed(self.deployment.nodes(phi))
        placed: FloatArray = nodes + (area_centroid(goal[loop]) - area_centroid(nodes[loop]))
        return placed


def area_centroid(polygon: FloatArray) -> FloatArray:
    """Centre of area of a closed polygon (L, 2)."""
    following = np.roll(polygon, -1, axis=0)
    cross = polygon[:, 0] * following[:, 1] - polygon[:, 1] * following[:, 0]
    centre: FloatArray = ((polygon + following) * cross[:, None]).sum(axis=0) / (6.0 * signed_area(polygon))
    return centre


class Exporter(Protocol):
    """Writes one kind of file."""

    @property
    def extension(self) -> str:
        """Lower case, with the dot."""

    @property
    def name(self) -> str:
        """What a person reads in a file dialog."""

    def write(self, job: ExportJob, path: Path) -> None:
        """Write and verify; raises ExportError and leaves an older file alone when that fails."""
