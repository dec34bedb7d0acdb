"""Which strain a connector is judged by, and whether the material survives it.

A connector turns by up to half a turn.  Kept flat it bends in the plane, across its width w, and its outer fibre is
pulled: strain turn w / (2 l), and the sheet tears at its elongation at break.  A thin sheet need not stay flat.  Of a
strip of thickness h the energy of bending in the plane grows as h w^3, across the thickness as w h^3 (the scaling laws
of Isobe and Okumura, Scientific Reports 6, 24758, 2016, measured on cut paper; ligaments that buckle out of the plane
and stay bent: Rafsanjani and Bertoldi, Physical Review Letters 118, 084301, 2017).  So it escapes: strain
turn h / (2 l), and it breaks where a bend of that outer fibre breaks.

Where in between a sheet changes over nobody has measured for these connectors.  At h = w / 2 the bend costs a quarter
of the energy; above that the larger figure is believed.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from kirigami_studio.fabricate.findings import Note
from kirigami_studio.fabricate.material import Material
from kirigami_studio.foundation.arrays import BoolArray, FloatArray

#: A connector escapes out of the plane where the sheet's thickness is below this share of its width.
ESCAPES_BELOW = 0.5


class StrainFigure(Enum):
    """Which of the two figures of a connector's strain is believed."""

    IN_PLANE = "in_plane"  #: bent across the width, as board is
    OUT_OF_PLANE = "out_of_plane"  #: buckled and bent across the thickness, as film is


@dataclass(frozen=True, slots=True)
class Survival:
    """Strain and limit of the connector that is nearest to breaking, by the figure believed."""

    strain: float  #: of the figure that is believed
    figure: StrainFigure
    thinness: float  #: thickness of the sheet over the connector's width
    limit: float  #: strain at which it breaks: elongation at break in the plane, in bending out of it
    yields_at: float  #: strain above which it stays bent; 0 where the material has no such strain

    @property
    def breaks(self) -> bool:
        """Whether the connector is expected to break."""
        return self.strain > self.limit

    @property
    def stays_bent(self) -> bool:
        """Whether it is bent for good, without breaking."""
        return not self.breaks and 0.0 < self.yields_at < self.strain

    @property
    def why(self) -> Note:
        """Which figure is believed, with the ratio that decides and its threshold."""
        code = "strain.escapes" if self.figure is StrainFigure.OUT_OF_PLANE else "strain.stays_flat"
        return Note.of(code, ratio=self.thinness, threshold=ESCAPES_BELOW)


def strain_note(material: Material, found: Survival) -> Note:
    """Say whether connectors break, stay bent or survive, by which figure and why."""
    fields = {
        "strain_percent": 100.0 * found.strain,
        "limit_percent": 100.0 * found.limit,
        "yield_percent": 100.0 * found.yields_at,
        "material": material.name,
        "why": found.why.text,
    }
    code = "as_cut.breaks" if found.breaks else "as_cut.stays_bent" if found.stays_bent else "as_cut.survives"
    return Note(code, fields)


def escapes(thickness_mm: float, width_mm: FloatArray) -> BoolArray:
    """Which connectors of these widths (H,) bend out of the plane."""
    found: BoolArray = thickness_mm < ESCAPES_BELOW * width_mm
    return found


def used_up(material: Material, width_mm: FloatArray, in_plane: FloatArray, out_of_plane: FloatArray) -> FloatArray:
    """Share (..., H) of the strain that connectors bear; above 1 they break.

    Parameters
    ----------
    width_mm : (H,) float
    in_plane, out_of_plane : (..., H) float
        Both figures of their strain.
    """
    bent = escapes(material.thickness_mm, width_mm)
    shares: FloatArray = np.where(bent, out_of_plane / material.bend_strain, in_plane / material.break_strain)
    return shares


def survival(material: Material, width_mm: FloatArray, in_plane: FloatArray, out_of_plane: FloatArray) -> Survival:
    """Judge the connector nearest to breaking; parameters are those of :func:`used_up`."""
    shares = used_up(material, width_mm, in_plane, out_of_plane)
    worst = np.unravel_index(int(np.argmax(shares)), shares.shape)
    width = float(width_mm[worst[-1]])
    bent = material.thickness_mm < ESCAPES_BELOW * width
    return Survival(
        float((out_of_plane if bent else in_plane)[worst]),
        StrainFigure.OUT_OF_PLANE if bent else StrainFigure.IN_PLANE,
        material.thickness_mm / width,
        material.bend_strain if bent else material.break_strain,
        material.yield_strain,
    )
