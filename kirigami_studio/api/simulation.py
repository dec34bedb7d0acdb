"""A sheet closed on its elastic connectors: force, energy, stretch, and where it jams."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kirigami_studio.api.pictures import AngleCurve, curves_picture
from kirigami_studio.api.values import read_only
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.mechanics.closing import TOLERATED_STRETCH, Closing
from kirigami_studio.mechanics.loads import Loads, loads
from kirigami_studio.studio.as_cut import AsCut, SimulatedSheet


@read_only
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Simulation:
    """A sheet as cut on its way from flat (phi = pi) to phi = 0; arrays have one entry a step.

    In a notebook it shows force and stretch against the angle.

    Attributes
    ----------
    simulated : SimulatedSheet
        The value of the program that it wraps.
    posed : PosedDesign
        The sheet over its target.
    width_mm : float
        Of the flat sheet.
    """

    simulated: SimulatedSheet
    posed: PosedDesign
    width_mm: float

    @property
    def closing(self) -> Closing:
        """All that was computed, connector by connector."""
        return self.simulated.closing

    @property
    def as_cut(self) -> AsCut:
        """Estimates about the cut sheet."""
        return self.simulated.as_cut

    @property
    def phi(self) -> FloatArray:
        """Mean angle of the sheet (S,), radians."""
        return self.closing.phi

    @property
    def loads(self) -> Loads:
        """Energy, torque and force by three figures: elastic, yielding, bent out of the plane."""
        return loads(self.closing, self.as_cut.yields_at)

    @property
    def torque_nmm(self) -> FloatArray:
        """Elastic moment (S,), N mm, against the mean angle: the upper figure; NaN with grips."""
        torque = self.loads.in_plane.torque_nmm
        return np.full(len(self.phi), np.nan) if torque is None else torque

    @property
    def displacement_mm(self) -> FloatArray | None:
        """Way (S,), mm, of the panels that are led; None where the mean angle is driven."""
        drive = self.closing.path.drive
        return None if drive.weights.size else drive.displacement

    @property
    def force_n(self) -> FloatArray:
        """Force (S,), N, elastic: the upper figure.

        At the end of a lever as long as a panel; along their way where panels are led.
        """
        return self.loads.in_plane.force_n

    @property
    def energy_mj(self) -> FloatArray:
        """Energy (S,), mJ, elastic: the upper figure."""
        return self.closing.path.energy

    @property
    def stretch(self) -> FloatArray:
        """Largest stretch of a connector (S,), in its widths."""
        stretch: FloatArray = self.closing.stretch.max(axis=1)
        return stretch

    @property
    def closes(self) -> bool:
        """Whether the sheet comes to the angle that it is meant for."""
        return self.as_cut.closes

    @property
    def breaks(self) -> bool:
        """Whether a connector is expected to break on the way, by the figure that is believed."""
        return self.as_cut.survival.breaks

    @property
    def jam_phi(self) -> float | None:
        """Angle (radians) at which it jams; None for a sheet that closes."""
        return None if self.closes else self.as_cut.jam_phi

    @property
    def jam_deg(self) -> float:
        """The same in degrees, in [0, 180]: 0 where it closes fully, 180 where it stays flat."""
        return self.as_cut.jam_deg

    @property
    def strain(self) -> float:
        """Strain of the connector that is nearest to breaking on the way."""
        return self.as_cut.strain

    @property
    def iou(self) -> float:
        """Exact IoU with the target where the sheet comes to."""
        assert self.as_cut.iou is not None  # designs have a target
        return self.as_cut.iou

    def panels(self, phi: float | None = None) -> list[FloatArray]:
        """The panels as cut, over the target: (Q, 2) each, row by row.

        Parameters
        ----------
        phi : float, radians, optional
            Where the sheet comes to unless given; not below that.
        """
        motion = self.simulated.motion
        return motion.pose(self.posed, motion.reached if phi is None else max(phi, motion.reached)).panels

    def __repr__(self) -> str:
        return f"<Simulation: {self._ends}, stretch {self.as_cut.stretch:.2f} widths, IoU as cut {self.iou:.4f}>"

    def _repr_svg_(self) -> str:
        curves = (
            AngleCurve(self.phi, self.force_n, "force (N)"),
            AngleCurve(self.phi, self.stretch, "largest stretch (connector widths)", TOLERATED_STRETCH),
        )
        return curves_picture(curves, f"As cut: {self._ends}  ·  IoU {self.iou:.3f}", self.jam_phi)

    @property
    def _ends(self) -> str:
        ends = "closes" if self.jam_phi is None else f"jams at {math.degrees(self.jam_phi):.0f}°"
        if not self.breaks:
            return ends
        strains = f"{100 * self.strain:.0f} % of {100 * self.as_cut.strain_limit:g} %"
        return f"connectors break (strain {strains}), otherwise {ends}"
