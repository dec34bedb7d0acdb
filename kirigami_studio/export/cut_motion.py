"""The motion of a sheet as cut, laid over its ideal motion: panels on elastic connectors that stop where they jam."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.fabricate.cut_panels import CutPanels, PanelLines
from kirigami_studio.foundation.arrays import ComplexArray, FloatArray, IntArray
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.mechanics.closing import Closing, carried_on, ideal_motion, moved_nodes


@dataclass(frozen=True, slots=True, eq=False)
class CutPose:
    """A sheet as cut at one angle, in the target's frame."""

    phi: float  #: radians
    #: list of (Q, 2) float; as the cuts leave them, row by row; those that are not there are left out.
    panels: list[FloatArray]
    numbers: IntArray  #: (K,); their numbers in the sheet
    cuts: list[FloatArray]  #: list of (L, 2) float; their edges that were cut; across connectors there are none
    #: (N, 2); nodes of the lattice: halfway between the corners of the panels there, of the ideal motion where trimming
    #: left no panel.
    nodes: FloatArray
    #: (H, 2, 2); where either panel of a connector has it; both places are the same where it is not stretched.
    connectors: FloatArray
    stretch: FloatArray  #: (H,); distance of the two in widths of the connector


@dataclass(frozen=True, slots=True, eq=False)
class CutMotion:
    """How a sheet moves as cut."""

    closing: Closing  #: of the design's planned cuts
    width_mm: float  #: width of the flat sheet
    jam_phi: float  #: radians; angle at which it jams; 0 for a sheet that closes
    reached: float  #: radians; the angle nearest to its target angle that it comes to
    panels: CutPanels  #: in the frame of the closing's network
    made: Deployment | None = None  #: the sheet that is cut where that is not quite the design

    @property
    def jams(self) -> bool:
        """Whether the motion ends where the sheet jams."""
        return self.jam_phi > 0.0 and self.reached == self.jam_phi

    @property
    def caption(self) -> str:
        """What a picture of the motion says; plain English, as in all drawings that are written."""
        return f"As cut: jams at {math.degrees(self.jam_phi):.0f} degrees" if self.jams else "As cut"

    def pose(self, design: PosedDesign, phi: float) -> CutPose:
        """The sheet at an angle (radians), moved and turned so that its panels lie nearest to the ideal ones.

        Parameters
        ----------
        design : PosedDesign
            The sheet that is cut, over its target.
        phi : float, radians
            Where the sheet does not come to it, it is shown where it jams.
        """
        phi = max(phi, self.reached) if self.jams else phi
        deployment, network = design.deployment, self.closing.sheet.network
        motion = carried_on(self.closing, deployment, self.width_mm, phi)
        ideal = ideal_motion(deployment, network, self.width_mm, phi)
        here, meant = (as_plane(network.centroids + moved[:, :2]) for moved in (motion, ideal))
        turned = np.exp(1j * np.angle(np.sum((meant - meant.mean()) * np.conj(here - here.mean()))))
        flat = as_plane(deployment.compact - deployment.compact.min(axis=0))
        mm = self.width_mm / float(np.ptp(deployment.compact[:, 0]))
        # The ideal motion keeps the middle of all nodes where it is in the flat sheet.
        factor = design.pose_at(phi).factor / mm
        middle = complex(*design.nodes(phi).mean(axis=0))
        shift = middle + factor * (meant.mean() - mm * flat.mean()) - factor * turned * here.mean()

        def placed(points: FloatArray) -> FloatArray:
            spots: ComplexArray = as_plane(points) * (factor * turned) + shift
            return as_points(spots)

        joined = network.ligaments.panels
        theta = motion[joined, 2]
        arms = as_plane(network.ligaments.points - network.centroids[joined]) * np.exp(1j * theta)
        ends = as_points(arms + here[joined])
        gap = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        place = np.arange(network.panel_count)
        if network.numbers is not None:
            place = np.full(int(network.numbers.max()) + 1, -1)
            place[network.numbers] = np.arange(network.panel_count)

        def lines(part: PanelLines) -> list[FloatArray]:
            owner = place[part.owner]
            arms = as_plane(part.points - network.centroids[owner]) * np.exp(1j * motion[owner, 2])
            return part.split(placed(as_points(arms + here[owner])))

        found, _, _ = moved_nodes(deployment, network, self.width_mm, motion)
        nodes = np.where(np.isnan(found), design.nodes(phi), placed(found))
        outlines, stretch = self.panels.outlines, gap / self.closing.sheet.connectors.width_mm
        return CutPose(phi, lines(outlines), outlines.panel, lines(self.panels.cuts), nodes, placed(ends), stretch)
