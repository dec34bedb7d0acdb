"""What every exporter gets and is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Protocol

import numpy as np

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.trimming import Trim
from kirigami_studio.export.paper import NO_PAPER
from kirigami_studio.export.profile import DEFAULT_PROFILE
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.lattice.deployment import Deployment, deploy, signed_area


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
        Key of the machine profile.
    paper : str
        Key of the paper that a PDF is spread over; "none" for one page as large as the sheet.
    provenance : mapping of str to str
        Where the design comes from: version of the program, name and hash of the model, seed, settings; every file
        repeats it.
    trim : Trim or None
        What was cut off the edge panels; pictures show what stays.
    """

    deployment: Deployment
    phi: float = 0.0
    plan: CutPlan | None = None
    target: FloatArray | None = None
    transform: Similarity = field(default_factory=Similarity)
    dxf_version: str = "R2010"
    profile: str = DEFAULT_PROFILE
    paper: str = NO_PAPER
    provenance: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    trim: Trim | None = None

    @classmethod
    def of(cls, candidate: Candidate, target: FloatArray | None, plan: CutPlan | None = None) -> ExportJob:
        """The job of a candidate as it is finished: trimmed if it is."""
        motion = deploy(candidate.final_field)
        return cls(motion, candidate.final_phi, plan, target, candidate.final_pose, trim=candidate.trim)

    @property
    def required_plan(self) -> CutPlan:
        """The plan, which says where its design comes from, or a refusal.

        Raises
        ------
        ExportError
            The job has none.
        """
        if self.plan is None:
            raise ExportError("A cut file needs a cut plan: choose a material and a sheet width first.")
        return replace(self.plan, origin=self.provenance) if self.provenance else self.plan

    def placed(self, nodes: FloatArray) -> FloatArray:
        """Move points (..., 2) from the layout's frame at ``phi`` to the target's frame."""
        matrix = self.transform.matrix
        moved: FloatArray = nodes @ matrix[:, :2].T + matrix[:, 2]
        return moved

    def placed_nodes(self, phi: float) -> FloatArray:
        """All nodes at any angle in the target's frame: turned as at the target angle, with the same centroid."""
        placed: FloatArray = self.placed(self.deployment.nodes(phi)) + self._drift(phi)
        return placed

    def placed_panels(self, phi: float) -> list[FloatArray]:
        """What there is of every panel at any angle in the same frame: list of (P, 2)."""
        if self.trim is None:
            return list(self.placed_nodes(phi)[self.deployment.topology.panel_nodes].reshape(-1, 4, 2))
        drift = self._drift(phi)
        return [self.placed(part) + drift for part in self.trim.deployed(self.deployment, phi)]

    def _drift(self, phi: float) -> FloatArray:
        """Shift (2,) that lays the centre of the sheet at ``phi`` upon that at the target angle."""
        loop = self.deployment.topology.outline_nodes
        goal, nodes = (self.placed(self.deployment.nodes(angle)[loop]) for angle in (self.phi, phi))
        drift: FloatArray = area_centroid(goal) - area_centroid(nodes)
        return drift


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
