"""Is the design physical?  Invalid quads, overlap, and contact on the way from the compact sheet.

Panels are rigid, voids are parallelograms and angles around a node always sum to 2 pi, so the sheet maps one to one as
long as its outline does not cross itself: overlap and contact are read off one polygon per angle.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.evaluate.crossing import deepest_crossing, stays_clear
from kirigami_studio.foundation.arrays import BoolArray, ComplexArray, FloatArray
from kirigami_studio.lattice.deployment import ZIPPED_BELOW, Deployment, check_phi

#: Largest overlap ratio that still counts as feasible (paper, tau_ov).
TAU_OVERLAP = 0.02

#: Quads with less area (unit cells squared) have collapsed; rounding leaves 1e-13.
COLLAPSED = 1e-10

#: Vertices are snapped to this grid (unit cells) before a union.
UNION_GRID = 1e-9

#: Angles at which the way from the compact sheet to the target is looked at.
PATH_ANGLES = 32

#: Accuracy of the first contact angle, radians.
CONTACT_ACCURACY = 1e-4


@dataclass(frozen=True, slots=True)
class Contact:
    """First self-contact of the outline on the way from the compact sheet to the target angle."""

    phi: float  #: radians; largest angle found at which the outline crosses itself, exact to 1e-4
    where: tuple[float, float]  #: (x, y), unit cells; place of the crossing in the layout's own frame at that angle

    def to_json(self) -> dict[str, object]:
        """Plain numbers: ``phi`` (radians) and ``where`` [x, y]."""
        return {"phi": self.phi, "where": list(self.where)}


@dataclass(frozen=True, slots=True)
class Feasibility:
    """What :func:`invalid_quads`, :func:`overlap_ratio` and :func:`path_contact` say about one design at one angle."""

    n_invalid: int
    overlap_ratio: float
    contact: Contact | None

    @property
    def feasible(self) -> bool:
        return self.n_invalid == 0 and self.overlap_ratio <= TAU_OVERLAP and self.contact is None


def feasibility_of_many(deployments: Sequence[Deployment], phi: float) -> list[Feasibility]:
    """Check designs of one grid at an angle in [0, pi]: the three checks, shared between all designs."""
    tables = deployments[0].topology
    even, odd = (as_plane(np.stack([getattr(one, part) for one in deployments])) for part in ("even_part", "odd_part"))
    nodes = tables.panel_nodes.reshape(-1, 4)
    if ZIPPED_BELOW < phi < math.pi - ZIPPED_BELOW:
        nodes = np.concatenate([nodes, tables.void_nodes.reshape(-1, 4)])
    turn = cmath.exp(0.5j * (math.pi - phi))
    n_invalid = np.count_nonzero(bad_quads((turn.conjugate() * even + turn * odd)[:, nodes]), axis=1)
    loop = tables.outline_nodes
    clear = stays_clear(even[:, loop], odd[:, loop], phi, PATH_ANGLES)
    return [
        # What is not certainly clear is looked at again one by one.
        Feasibility(int(count), 0.0, None)
        if free
        else Feasibility(int(count), overlap_ratio(deployment, phi), path_contact(deployment, phi))
        for deployment, count, free in zip(deployments, n_invalid, clear, strict=True)
    ]


def invalid_quads(deployment: Deployment, phi: float) -> int:
    """Number of collapsed, inverted or self-crossing quads (the paper's N_inv).

    Panels count at every angle; voids count for 0 < phi < pi only, since they are closed at both ends of the motion.
    """
    return int(np.count_nonzero(bad_quads(as_plane(quads_that_count(deployment, phi)))))


def bad_quads(corners: ComplexArray) -> BoolArray:
    """Which of the quads (..., 4), x + iy in unit cells, are collapsed, inverted or cross themselves: (...) bool."""
    a, b, c, d = np.moveaxis(corners, -1, 0)
    area = 0.5 * (np.conj(c - a) * (d - b)).imag
    return np.asarray((area < COLLAPSED) | _edges_cross(a, b, c, d) | _edges_cross(b, c, d, a))


def overlap_ratio(deployment: Deployment, phi: float) -> float:
    """Share of material lost to overlap, ``1 - A_union / sum A`` (the paper's r_ov), by exact polygon union.

    An outline that does not cross itself means no overlap at all, which spares the union.
    """
    outline = deployment.outline(phi)
    if shapely.is_valid(shapely.Polygon(outline)) or deepest_crossing(as_plane(outline)) is None:
        return 0.0
    return shared_area(quads_that_count(deployment, phi))


def shared_area(corners: FloatArray) -> float:
    """Share of the area of quads (K, 4, 2), unit cells, that lies in more than one; 1 where none has any."""
    quads = np.asarray(shapely.polygons(corners), dtype=object)
    quads = quads[shapely.is_valid(quads)]
    total = float(shapely.area(quads).sum())
    if total <= 0.0:
        return 1.0
    # Without a grid, neighbours whose shared edge differs by rounding make the union lose whole panels.
    union = float(shapely.area(shapely.union_all(quads, grid_size=UNION_GRID)))
    return min(1.0, max(0.0, 1.0 - union / total))


def path_contact(deployment: Deployment, phi_target: float) -> Contact | None:
    """First angle between the compact sheet and the target at which the outline crosses itself.

    Looks at 32 angles including the target and bisects between the last free and the first crossing one.  Edges that
    only touch (edge hinges zipping shut at phi = 0, edge cuts closed at pi) are no contact.
    """
    target = check_phi(phi_target)
    angles = np.linspace(math.pi, target, PATH_ANGLES + 1)[1:]
    outlines = outline_path(deployment, angles)
    at_target = as_plane(deployment.outline(target))
    clear = np.append(
        shapely.is_valid(shapely.polygons(as_points(outlines[:-1]))),
        shapely.is_valid(shapely.Polygon(as_points(at_target))),
    )
    for index in np.flatnonzero(~clear):
        place = deepest_crossing(at_target if index == PATH_ANGLES - 1 else outlines[index])
        if place is not None:
            free = math.pi if index == 0 else float(angles[index - 1])
            return _first_contact(deployment, free, float(angles[index]), place)
    return None


def is_clear(deployment: Deployment, phi: float) -> bool:
    """Whether :func:`path_contact` finds none; known at once for most designs."""
    nodes = deployment.topology.outline_nodes
    even, odd = (as_plane(part[nodes])[np.newaxis] for part in (deployment.even_part, deployment.odd_part))
    return bool(stays_clear(even, odd, phi, PATH_ANGLES)[0]) or path_contact(deployment, phi) is None


def outline_path(deployment: Deployment, angles: FloatArray) -> ComplexArray:
    """Outlines at several angles at once: (A, L) complex, unit cells, edge hinges included.

    ``P(phi) = R(-a) U + R(+a) V`` with 2a = pi - phi, for the outline's nodes only.
    """
    nodes = deployment.topology.outline_nodes
    turn = np.exp(0.5j * (math.pi - angles))[:, np.newaxis]
    path: ComplexArray = np.conj(turn) * as_plane(deployment.even_part[nodes]) + turn * as_plane(
        deployment.odd_part[nodes]
    )
    return path


def _first_contact(deployment: Deployment, free: float, crossed: float, place: complex) -> Contact:
    """Bisect between a free and a crossing angle."""
    while free - crossed > CONTACT_ACCURACY:
        middle = 0.5 * (free + crossed)
        found = deepest_crossing(outline_path(deployment, np.array([middle]))[0])
        if found is None:
            free = middle
        else:
            crossed, place = middle, found
    return Contact(crossed, (place.real, place.imag))


def quads_that_count(deployment: Deployment, phi: float) -> FloatArray:
    """The quads that the paper's checks look at: panels, and voids while they are open: (Q, 4, 2)."""
    panels = deployment.panels(phi).reshape(-1, 4, 2)
    if not ZIPPED_BELOW < check_phi(phi) < math.pi - ZIPPED_BELOW:
        return panels
    return np.concatenate([panels, deployment.voids(phi).reshape(-1, 4, 2)])


def _edges_cross(a: ComplexArray, b: ComplexArray, c: ComplexArray, d: ComplexArray) -> BoolArray:
    """Whether segments ab and cd cross properly, one by one."""
    return np.asarray((_side(a, b, c) * _side(a, b, d) < 0.0) & (_side(c, d, a) * _side(c, d, b) < 0.0))


def _side(a: ComplexArray, b: ComplexArray, p: ComplexArray) -> FloatArray:
    side: FloatArray = (np.conj(b - a) * (p - a)).imag
    return side
