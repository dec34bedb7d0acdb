"""The motion of a sheet as cut, laid over its ideal motion: panels on elastic connectors that stop where they jam."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely

from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.fabricate.cut_panels import CutPanels, PanelLines
from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.mechanics.closing import Closing, carried_on, covered_area, ideal_motion, moved_nodes


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
    mm_per_world: float  #: millimetres of one unit of the target's frame


@dataclass(frozen=True, slots=True, eq=False)
class CutMotion:
    """How a sheet moves as cut."""

    closing: Closing  #: of the design's planned cuts
    width_mm: float  #: width of the flat sheet
    jam_phi: float  #: radians; angle at which it jams; 0 for a sheet that closes
    reached: float  #: radians; the angle nearest to its target angle that it comes to
    panels: CutPanels  #: in the frame of the closing's network
    #: Lays the sheet where it comes to upon the target, from the closing's frame (mm): the pose in which its match as
    #: cut is measured; None where it has no target
    laid: Similarity | None = None
    made: Deployment | None = None  #: the sheet that is cut where that is not quite the design
    covered: shapely.Polygon | None = None  #: mm; its area at ``reached``, where that was found

    @property
    def jams(self) -> bool:
        """Whether the motion ends where the sheet jams."""
        return self.jam_phi > 0.0 and self.reached == self.jam_phi

    @property
    def caption(self) -> str:
        """What a picture of the motion says; plain English, as in all drawings that are written."""
        return f"As cut: jams at {math.degrees(self.jam_phi):.0f} degrees" if self.jams else "As cut"

    def pose(self, design: PosedDesign, phi: float) -> CutPose:
        """The sheet at an angle (radians), over its target.

        Flat its panels lie nearest to the ideal ones, where it comes to it lies as its match as cut is measured, and
        between the two it goes from one to the other.

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
        here = as_plane(network.centroids + motion[:, :2])
        place = self._placed(design, phi)
        placed = place.apply
        joined = network.ligaments.panels
        theta = motion[joined, 2]
        arms = as_plane(network.ligaments.points - network.centroids[joined]) * np.exp(1j * theta)
        ends = as_points(arms + here[joined])
        gap = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        number = np.arange(network.panel_count)
        if network.numbers is not None:
            number = np.full(int(network.numbers.max()) + 1, -1)
            number[network.numbers] = np.arange(network.panel_count)

        def lines(part: PanelLines) -> list[FloatArray]:
            owner = number[part.owner]
            arms = as_plane(part.points - network.centroids[owner]) * np.exp(1j * motion[owner, 2])
            return part.split(placed(as_points(arms + here[owner])))

        found, _, _ = moved_nodes(deployment, network, self.width_mm, motion)
        nodes = np.where(np.isnan(found), design.nodes(phi), placed(found))
        outlines, stretch = self.panels.outlines, gap / self.closing.sheet.connectors.width_mm
        drawn = lines(outlines), outlines.panel, lines(self.panels.cuts)
        return CutPose(phi, *drawn, nodes, placed(ends), stretch, 1.0 / place.scale)

    def area(self, design: PosedDesign, phi: float) -> shapely.Polygon:
        """Panels and voids of that pose, with openings inside: what the match as cut is measured of."""
        phi = max(phi, self.reached) if self.jams else phi
        covered = self.covered if phi == self.reached else None
        if covered is None:
            motion = carried_on(self.closing, design.deployment, self.width_mm, phi)
            covered = covered_area(design.deployment, self.closing.sheet.network, self.width_mm, motion, brief=True)
        laid: shapely.Polygon = shapely.transform(covered, self._placed(design, phi).apply)
        return laid

    def _placed(self, design: PosedDesign, phi: float) -> Similarity:
        """From the closing's frame (mm) into the target's, at an angle (radians)."""
        nearest = self.nearest(design, phi)
        if self.laid is None:
            return nearest
        share = min(1.0, (math.pi - phi) / (math.pi - self.reached)) if self.reached < math.pi else 0.0
        return self.laid.compose(self.nearest(design, self.reached).inverse()).part(share).compose(nearest)

    def nearest(self, design: PosedDesign, phi: float) -> Similarity:
        """The same with panels nearest to those of the ideal motion."""
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
        return Similarity.from_complex(factor * turned, complex(shift))
