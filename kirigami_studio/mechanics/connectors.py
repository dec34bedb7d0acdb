"""The connectors of a cut sheet: where they turn, how stiff they are, how much they are strained.

A connector is what is left between the end of a slit and the cut or the edge that it ends on.  Its constants are those
of a plane strip beside two notches, found with finite elements (plane stress, Poisson's ratio 0.35, a slit of kerf k
that ends w before a flank, thickness h, panels of size S):

    k_t = E h w^3 / (12 l_eff),   l_eff = k + 1.275 w      (within 3 % for k/w from 0 to 4)
    E h / k_n = 4.08 ln(S / w) - 1.7
    E h / k_s = 4.29 ln(S / w) + 1.6

An arc or a bar lengthens the connector: by a strip of that length, with E h / k_n = L / w and E h / k_s = (L / w)^3.
At k = 0 the first is 3 % above E h w^2 / 15.8, the value of handbooks for a ligament beside a deep edge crack (Tada,
Paris and Irwin).  A connector turns about a point 0.73 w from the flank, 0.56 w at k = 4 w, where it is
narrowest: below the tip of a slit that arrives at a slant.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.foundation.errors import MechanicsError
from kirigami_studio.lattice.deployment import Deployment

#: l_eff = kerf + this many widths.
FLEXURE_WIDTHS = 1.275
#: Distance of the rotation centre from the flank in widths: beside a sharp slit, and beside one of kerf 4 w.
CENTRE_SHARP, CENTRE_WIDE, WIDE_KERF = 0.73, 0.56, 4.0
#: (a, b) of E h / k = a ln(S / w) + b.
STRETCHING, SHEARING = (4.08, -1.7), (4.29, 1.6)
#: The formulas hold for panels at least so many times as large as their connectors are wide.
LEAST_RATIO = 2.0
#: Panels have met where one is this share of the mean connector's width in the other.
MEETING_SHARE = 0.1


@dataclass(frozen=True, slots=True)
class ElasticSheet:
    """What the sheet is made of.

    Raises
    ------
    MechanicsError
        A number that is not finite and positive.
    """

    young_mpa: float  #: N/mm^2
    thickness_mm: float

    def __post_init__(self) -> None:
        for name, value in (("Young's modulus", self.young_mpa), ("thickness", self.thickness_mm)):
            if not (math.isfinite(value) and value > 0.0):
                raise MechanicsError("sheet.constant_not_positive", name=name, value=value)


def flexure_length(width_mm: FloatArray, kerf_mm: float) -> FloatArray:
    """l_eff (H,), mm: the length over which a straight connector bends."""
    return kerf_mm + FLEXURE_WIDTHS * width_mm


def centre_height(width_mm: FloatArray, kerf_mm: float) -> FloatArray:
    """Distance (H,), mm, of the rotation centre of a straight connector from the flank of the cut that it ends on."""
    share = np.clip(kerf_mm / (WIDE_KERF * width_mm), 0.0, 1.0)
    height: FloatArray = (CENTRE_SHARP + share * (CENTRE_WIDE - CENTRE_SHARP)) * width_mm
    return height


def turning_stiffness(sheet: ElasticSheet, width_mm: FloatArray, flexure_mm: FloatArray) -> FloatArray:
    """k_t (H,), N mm."""
    stiffness: FloatArray = sheet.young_mpa * sheet.thickness_mm * width_mm**3 / (12.0 * flexure_mm)
    return stiffness


def plane_stiffness(
    sheet: ElasticSheet, width_mm: FloatArray, panel_mm: FloatArray, longer_mm: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """k_n and k_s (H,), N/mm; what makes a connector longer is a strip in series with it."""
    ratio = np.log(np.maximum(panel_mm / width_mm, LEAST_RATIO))
    slender = longer_mm / width_mm
    (n_slope, n_offset), (s_slope, s_offset) = STRETCHING, SHEARING
    film = sheet.young_mpa * sheet.thickness_mm
    return film / (n_slope * ratio + n_offset + slender), film / (s_slope * ratio + s_offset + slender**3)


@dataclass(frozen=True, slots=True, eq=False)
class SheetConnectors:
    """The connectors of one flat sheet, as plain arrays."""

    panels: IntArray  #: (H, 2); panels A and B
    #: (H, 2, 2), mm; the rotation centre as a point of A and as a point of B, in the flat sheet; both are the same
    #: place, unless a reader of the cut file found otherwise.
    centres: FloatArray
    along: FloatArray  #: (H, 2); unit vector of the slit that ends there
    width_mm: FloatArray  #: (H,); finished width
    flexure_mm: FloatArray  #: (H,); length over which the connector bends
    #: (H,); by how much that is longer than at the end of a straight slit, because of an arc or a bar.
    longer_mm: FloatArray
    sign: FloatArray  #: (H,); +1 where theta_B - theta_A grows as the sheet opens, -1 where it falls
    #: (H,), radians; void angle at which the panels meet along the edges that fold onto each other; negative where a
    #: gap stays.
    touch: FloatArray

    def __len__(self) -> int:
        return len(self.panels)

    @property
    def meeting_mm(self) -> float:
        """How far one panel is in another one where they have met, mm; 0 without connectors."""
        return MEETING_SHARE * float(self.width_mm.mean()) if len(self) else 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Junctions:
    """The T-junctions of a design in the flat sheet, and the panels that hang together there."""

    node: IntArray  #: (H,); node numbers of the lattice
    panels: IntArray  #: (H, 2); panels A < B, row by row
    place: FloatArray  #: (H, 2), mm
    #: along, through: (H, 2); unit vectors of the slit, away from the junction, and of the cut or edge that it ends on,
    #: towards A.
    along: FloatArray
    through: FloatArray
    reach_mm: FloatArray  #: (H,); length of the shorter of both panels' edges beside the through cut
    on_edge: BoolArray  #: (H,); whether the slit ends on the sheet's edge
    sign: FloatArray  #: (H,); as in :class:`SheetConnectors`
    corners: FloatArray  #: (P, 4, 2), mm; all panels

    @property
    def sine(self) -> FloatArray:
        """Sine (H,) of the angle between slit and through cut."""
        crossed: FloatArray = np.abs(self.along[:, 0] * self.through[:, 1] - self.along[:, 1] * self.through[:, 0])
        return crossed

    @property
    def normal(self) -> FloatArray:
        """Unit vector (H, 2) square to the through cut, on the slit's side."""
        normal = np.stack([-self.through[:, 1], self.through[:, 0]], axis=1)
        turned: FloatArray = normal * np.sign(np.sum(normal * self.along, axis=1))[:, None]
        return turned


def junctions(deployment: Deployment, width_mm: float, nodes: IntArray | None = None) -> Junctions:
    """Find the junctions of a design.

    Parameters
    ----------
    width_mm : float
        Width of the flat sheet; its smallest coordinates are 0, y up.
    nodes : (H,) int, optional
        The junctions that are wanted, in this order, by node number; all unless given.

    Raises
    ------
    MechanicsError
        A node at which no two panels hang together, or a width that is not positive.
    """
    if not (math.isfinite(width_mm) and width_mm > 0.0):
        raise MechanicsError("sheet.constant_not_positive", name="width", value=width_mm)
    tables = deployment.topology
    table = tables.panel_nodes.reshape(-1, 4)
    scale = width_mm / float(np.ptp(deployment.compact[:, 0]))
    flat = (deployment.compact - deployment.compact.min(axis=0)) * scale
    order = np.argsort(table.ravel(), kind="stable")
    ranked = table.ravel()[order]
    first = np.flatnonzero(ranked[:-1] == ranked[1:])
    shared = ranked[first]
    # A node has one panel or two; the stable order puts the lower panel first.
    panel_a, corner_a = np.divmod(order[first], 4)
    panel_b, corner_b = np.divmod(order[first + 1], 4)
    if nodes is not None:
        place = np.searchsorted(shared, nodes)
        known = place < shared.size
        known[known] = shared[place[known]] == np.asarray(nodes)[known]
        if not np.all(known):
            raise MechanicsError("sheet.no_junction", node=int(np.asarray(nodes)[~known][0]))
        shared, panel_a, corner_a, panel_b, corner_b = (
            part[place] for part in (shared, panel_a, corner_a, panel_b, corner_b)
        )
    corners = flat[table]
    back_a, ahead_a = _edges(corners, panel_a, corner_a)
    back_b, ahead_b = _edges(corners, panel_b, corner_b)
    # Along the slit the edges of both panels run together: ahead on one of them and back on the other.
    a_first = np.sum(_unit(ahead_a) * _unit(back_b), axis=1) > np.sum(_unit(back_a) * _unit(ahead_b), axis=1)
    along = _unit(np.where(a_first[:, None], ahead_a, back_a))
    edge_a, edge_b = (np.where(a_first[:, None], *pair) for pair in ((back_a, ahead_a), (ahead_b, back_b)))
    line, column = np.divmod(panel_a, tables.columns + 1)
    return Junctions(
        node=shared,
        panels=np.stack([panel_a, panel_b], axis=1),
        place=flat[shared],
        along=along,
        through=_unit(_unit(edge_a) - _unit(edge_b)),
        reach_mm=np.minimum(np.linalg.norm(edge_a, axis=1), np.linalg.norm(edge_b, axis=1)),
        on_edge=tables.fixed[shared],
        sign=np.where((line + column) % 2 == 0, 1.0, -1.0),
        corners=corners,
    )


def tip_asides(found: Junctions, width_mm: FloatArray, kerf_mm: float, hole_mm: float = 0.0) -> FloatArray:
    """From junctions along the through cuts to below the ends of slits (H, 2), mm.

    Parameters
    ----------
    found : Junctions
    width_mm : (H,) float
        Finished widths.
    kerf_mm : float
    hole_mm : float
        Radius of the holes that slits end in: a connector is narrowest below the middle of its hole.
    """
    gap = width_mm + np.where(found.on_edge, 0.5, 1.0) * kerf_mm + hole_mm
    leaning = np.sum(found.along * found.through, axis=1) / found.sine
    aside: FloatArray = (gap * leaning)[:, None] * found.through
    return aside


def cut_connectors(
    found: Junctions,
    width_mm: FloatArray,
    kerf_mm: float,
    centres: FloatArray | None = None,
    longer_mm: FloatArray | None = None,
    aside: FloatArray | None = None,
) -> SheetConnectors:
    """Connectors where slits end a finished width before the junction; those of width 0 are left out.

    Parameters
    ----------
    width_mm : (H,) float
        Finished widths; 0 for a removed connector.
    centres : (H, 2) or (H, 2, 2) float, mm, optional
        Rotation centres in the flat sheet, one place or a place on A and one on B; where connectors at straight slits
        have theirs unless given: off the through cut on the slit's side, where the connector is narrowest.
    longer_mm : (H,) float, mm, optional
        By how much connectors are longer than at the ends of straight slits; then they turn about their middle.
    aside : (H, 2) float, mm, optional
        From the junctions along the through cuts to the middles of the connectors; to below the tips of straight slits
        unless given.

    Raises
    ------
    MechanicsError
        Arrays of other shapes or values that are not finite.
    """
    count = len(found.node)
    more = np.zeros(count) if longer_mm is None else longer_mm
    for values in (width_mm, more):
        if values.shape != (count,) or not np.all(np.isfinite(values)) or np.any(values < 0.0):
            raise MechanicsError("sheet.widths_wrong", found=values.shape, count=count)
    if not (math.isfinite(kerf_mm) and kerf_mm >= 0.0):
        raise MechanicsError("sheet.constant_not_positive", name="kerf", value=kerf_mm)
    there = np.flatnonzero(width_mm > 0.0)
    width, longer = width_mm[there], more[there]
    flank = np.where(found.on_edge[there], 0.0, 0.5 * kerf_mm)
    if centres is None:
        height = np.where(longer > 0.0, 0.5 * width, centre_height(width, kerf_mm)) + flank
        along = tip_asides(found, width_mm, kerf_mm) if aside is None else aside
        middle = found.place[there] + along[there] + height[:, None] * found.normal[there]
        both = np.stack([middle, middle], axis=1)
    else:
        if centres.shape not in ((count, 2), (count, 2, 2)) or not np.all(np.isfinite(centres)):
            raise MechanicsError("sheet.centres_wrong", found=centres.shape, count=count)
        both = centres[there] if centres.ndim == 3 else np.stack([centres[there], centres[there]], axis=1)
        height = _heights(found, there, both.mean(axis=1))
    return SheetConnectors(
        panels=found.panels[there],
        centres=both,
        along=found.along[there],
        width_mm=width,
        flexure_mm=flexure_length(width, kerf_mm) + longer,
        longer_mm=longer,
        sign=found.sign[there],
        touch=2.0 * np.arctan2(height - flank, found.reach_mm[there]),
    )


def _heights(found: Junctions, there: IntArray, middle: FloatArray) -> FloatArray:
    """How far (H,), mm, centres are from the middle of the through cut, positive on the slit's side."""
    height: FloatArray = np.sum((middle - found.place[there]) * found.normal[there], axis=1)
    return height


def _edges(corners: FloatArray, panel: IntArray, corner: IntArray) -> tuple[FloatArray, FloatArray]:
    """Both edges (H, 2) of panels at a corner, away from it: to the corner before and to the one after."""
    here = corners[panel, corner]
    return corners[panel, (corner - 1) % 4] - here, corners[panel, (corner + 1) % 4] - here


def _unit(vectors: FloatArray) -> FloatArray:
    unit: FloatArray = vectors / np.linalg.norm(vectors, axis=1)[:, None]
    return unit
