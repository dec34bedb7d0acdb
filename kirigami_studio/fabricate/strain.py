"""Which strain a connector is judged by, and whether the material survives it.

A connector turns by up to half a turn.  Kept flat it bends in the plane, across its width w, and its outer fibre is
pulled: strain turn w / (2 l), and the sheet tears at its elongation at break.  A thin sheet need not stay flat.  Of a
strip of thickness h the energy of bending in the plane grows as h w^3, across the thickness as w h^3 (the scaling laws
of Isobe and Okumura, Scientific Reports 6, 24758, 2016, measured on cut paper; ligaments that buckle out of the plane
and stay bent: Rafsanjani and Bertoldi, Physical Review Letters 118, 084301, 2017).  So it escapes: strain
turn h / (2 l), and it breaks where a bend of that outer fibre breaks.

Where in between a sheet changes over nobody has measured for these connectors.  At h = w / 2 the bend costs a quarter
of the energy; above that the larger figure is believed.

Under rigid panels, such as tiles on a hinge layer, only what lies free between them bends: the flexure length is the
free length where that is shorter.  A strip that cannot stretch turns by t in the plane only over two folds, since each
mirrors it: inclined by t / 4 to its cross section, one this way and one that.  Side by side they take a length of
2 w tan(t / 4), twice the width for half a turn.  Where less is free it stays flat, however thin.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np

from kirigami_studio.fabricate.findings import Note
from kirigami_studio.fabricate.material import Material
from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray

#: A connector escapes out of the plane where the sheet's thickness is below this share of its width.
ESCAPES_BELOW = 0.5
#: Lengths that differ by less than this (mm) are the same.
ROUNDING_MM = 1e-9


class StrainFigure(Enum):
    """Which of the two figures of a connector's strain is believed."""

    IN_PLANE = "in_plane"  #: bent across the width, as board is
    OUT_OF_PLANE = "out_of_plane"  #: buckled and bent across the thickness, as film is


@dataclass(frozen=True, slots=True, eq=False)
class RigidPanels:
    """Panels that do not bend: what they leave free of every connector."""

    free_mm: FloatArray  #: (H,) length between the rigid parts of both panels
    flexure_mm: FloatArray  #: (H,) length over which it bends between panels of the sheet alone, behind its strain
    turn: float  #: by which connectors turn altogether, radians

    def of(self, connectors: IntArray) -> RigidPanels:
        """The same of some connectors, by number."""
        return RigidPanels(self.free_mm[connectors], self.flexure_mm[connectors], self.turn)

    @property
    def sharper(self) -> FloatArray:
        """How many times (H,) as strained connectors are as between panels of the sheet alone."""
        factor: FloatArray = self.flexure_mm / np.minimum(self.flexure_mm, self.free_mm)
        return factor

    def has_room(self, width_mm: FloatArray) -> BoolArray:
        """Whether connectors of these widths (H,) have the length for two folds out of the plane."""
        room: BoolArray = self.free_mm >= 2.0 * width_mm * math.tan(0.25 * self.turn) - ROUNDING_MM
        return room


@dataclass(frozen=True, slots=True)
class Survival:
    """Strain and limit of the connector that is nearest to breaking, by the figure believed."""

    strain: float  #: of the figure that is believed
    figure: StrainFigure
    thinness: float  #: thickness of the sheet over the connector's width
    limit: float  #: strain at which it breaks: elongation at break in the plane, in bending out of it
    yields_at: float  #: strain above which it stays bent; 0 where the material has no such strain
    held: bool = False  #: thin enough to escape, but between rigid panels that leave no length for it

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
        if self.held:
            return Note.of("strain.held_by_tiles", ratio=self.thinness, threshold=ESCAPES_BELOW)
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


def used_up(
    material: Material,
    width_mm: FloatArray,
    in_plane: FloatArray,
    out_of_plane: FloatArray,
    rigid: RigidPanels | None = None,
) -> FloatArray:
    """Share (..., H) of the strain that connectors bear; above 1 they break.

    Parameters
    ----------
    material : Material
        Of the sheet that bends: of the hinge layer alone under tiles.
    width_mm : (H,) float
    in_plane, out_of_plane : (..., H) float
        Both figures of their strain, between panels of the sheet alone.
    rigid : RigidPanels, optional
        What stiffens the panels.
    """
    return _judged(material, width_mm, in_plane, out_of_plane, rigid).shares


def survival(
    material: Material,
    width_mm: FloatArray,
    in_plane: FloatArray,
    out_of_plane: FloatArray,
    rigid: RigidPanels | None = None,
) -> Survival:
    """Judge the connector nearest to breaking; parameters are those of :func:`used_up`."""
    judged = _judged(material, width_mm, in_plane, out_of_plane, rigid)
    worst = np.unravel_index(int(np.argmax(judged.shares)), judged.shares.shape)
    hinge = worst[-1]
    bent = bool(judged.bent[hinge])
    return Survival(
        float(judged.strains[worst]),
        StrainFigure.OUT_OF_PLANE if bent else StrainFigure.IN_PLANE,
        material.thickness_mm / float(width_mm[hinge]),
        material.bend_strain if bent else material.break_strain,
        material.yield_strain,
        held=not bent and bool(escapes(material.thickness_mm, width_mm)[hinge]),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Judged:
    """The figures believed, and their shares of the limit."""

    bent: BoolArray  #: (H,) out of the plane
    strains: FloatArray  #: (..., H)
    shares: FloatArray  #: (..., H)


def _judged(
    material: Material,
    width_mm: FloatArray,
    in_plane: FloatArray,
    out_of_plane: FloatArray,
    rigid: RigidPanels | None,
) -> _Judged:
    bent = escapes(material.thickness_mm, width_mm)
    if rigid is not None:
        bent = bent & rigid.has_room(width_mm)
    strains = np.where(bent, out_of_plane, in_plane) * (1.0 if rigid is None else rigid.sharper)
    return _Judged(bent, strains, strains / np.where(bent, material.bend_strain, material.break_strain))
