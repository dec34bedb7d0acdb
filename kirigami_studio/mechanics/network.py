"""Rigid panels joined by elastic ligaments: one network as a value, checked when it is made.

Every panel has three degrees of freedom, a displacement u and a turn theta about its centroid c, so that a point that
lies at r from the centroid at rest is at ``x = c + u + R(theta) r``.  A ligament joins a point of panel A to a point of
panel B.  A contact is a void angle that a ligament's turn changes; it resists below a few degrees.  A *stop* is a
place where a point of one panel runs into an edge of another.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.foundation.errors import MechanicsError

#: Void angle (radians) below which panels resist: 5 degrees (Deng et al. 2020; DifFlexMM).
CONTACT_BELOW = math.radians(5.0)
#: Stiffness of a contact in turning stiffnesses of its ligament.
CONTACT_STIFFNESS = 100.0
#: Coordinates (mm) are no larger than this, and panels no smaller than that.
LARGEST_MM, SMALLEST_MM = 1e7, 1e-6
#: A void angle at rest (radians) is no larger than a full turn and what a rotation centre off the edges adds.
LARGEST_ANGLE = 3.0 * math.pi
#: A slender ligament must be longer than this share of the mean distance of joined panels.
SHORTEST_SLENDER = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Ligaments:
    """The elastic joints."""

    panels: IntArray  #: (L, 2); panels A and B
    points: FloatArray  #: (L, 2, 2), mm; where a ligament begins on A and ends on B, at rest
    #: (L,); True for a strip from A to B, False for a T-junction, whose two points are one rotation centre.
    slender: BoolArray
    #: (L,), radians; direction from A to B in which a T-junction is stretched, at rest; the ligament's own where it is
    #: slender.
    axis: FloatArray
    #: stretching, shearing: (L,), N/mm; stiffness along and across the axis.
    stretching: FloatArray
    shearing: FloatArray
    turning: FloatArray  #: (L,), N mm; stiffness against the turn of B relative to A

    def __len__(self) -> int:
        return len(self.panels)


@dataclass(frozen=True, slots=True, eq=False)
class Contacts:
    """Void angles that may not close."""

    ligament: IntArray  #: (C,); the ligament at the void's corner
    sign: FloatArray  #: (C,), +1 or -1; by how much the angle changes with theta_B - theta_A
    rest: FloatArray  #: (C,), radians; the angle at rest, counted from where the panels would touch
    stiffness: FloatArray  #: (C,), N mm

    def __len__(self) -> int:
        return len(self.ligament)


@dataclass(frozen=True, slots=True, eq=False)
class Stops:
    """Points of panels that edges of other panels stop."""

    panels: IntArray  #: (T, 2); the panel with the edge, and the one with the point
    point: FloatArray  #: (T, 2), mm; the point at rest
    #: foot, normal: (T, 2), mm and unit vectors; a place on the edge at rest, and the direction out of its panel there.
    foot: FloatArray
    normal: FloatArray
    ligament: IntArray  #: (T,); the ligament whose turn tells whether the panels are near each other
    #: (T,), radians; they are where theta_B - theta_A of the ligament has this sign and is larger than this.
    turned: FloatArray
    stiffness: FloatArray  #: (T,), N/mm; slope of the force against the depth of the point behind the edge
    soft: FloatArray  #: (T,), mm; depth to which that slope grows from nothing

    def __len__(self) -> int:
        return len(self.panels)

    def and_also(self, more: Stops) -> Stops:
        """Both kinds of stops."""
        names = [one.name for one in fields(self)]
        return Stops(*(np.concatenate([getattr(self, name), getattr(more, name)]) for name in names))

    @classmethod
    def none(cls) -> Stops:
        """No stops at all."""
        numbers, places, values = np.zeros(0, dtype=np.intp), np.zeros((0, 2)), np.zeros(0)
        pairs = np.zeros((0, 2), dtype=np.intp)
        return cls(pairs, places, places.copy(), places.copy(), numbers, values, values.copy(), values.copy())


@dataclass(frozen=True, slots=True, eq=False)
class PanelNetwork:
    """Panels, ligaments and contacts, all in mm and N.

    Raises
    ------
    MechanicsError
        An array of another shape, a value that is not finite, a stiffness that is not positive, a panel that does not
        exist, or panels that do not hang together.
    """

    centroids: FloatArray  #: (P, 2), mm
    ligaments: Ligaments
    contacts: Contacts
    #: (P, Q, 2), mm; corners of the panels at rest, for pictures and silhouettes; may be empty, (P, 0, 2).
    outlines: FloatArray
    #: (P,); which panels of a sheet they are, row by row, where trimming took others; None for all.
    numbers: IntArray | None = None
    stops: Stops = field(default_factory=Stops.none)

    def __post_init__(self) -> None:
        count, joints, stops = len(self.centroids), self.ligaments, self.stops
        if count < 2 or not len(joints):
            raise MechanicsError("network.too_small", panels=count, ligaments=len(joints))
        length = len(joints.panels)
        shapes = {
            "centroids": (self.centroids, (count, 2)),
            "panels": (joints.panels, (length, 2)),
            "points": (joints.points, (length, 2, 2)),
            "axis": (joints.axis, (length,)),
            "stretching": (joints.stretching, (length,)),
            "shearing": (joints.shearing, (length,)),
            "turning": (joints.turning, (length,)),
            "slender": (joints.slender, (length,)),
            "outlines": (self.outlines, (count, self.outlines.shape[1] if self.outlines.ndim == 3 else 0, 2)),
            "contact ligaments": (self.contacts.ligament, (len(self.contacts),)),
            "contact signs": (self.contacts.sign, (len(self.contacts),)),
            "contact angles": (self.contacts.rest, (len(self.contacts),)),
            "contact stiffness": (self.contacts.stiffness, (len(self.contacts),)),
            "panels of stops": (stops.panels, (len(stops), 2)),
            "points of stops": (stops.point, (len(stops), 2)),
            "edges of stops": (stops.foot, (len(stops), 2)),
            "normals of stops": (stops.normal, (len(stops), 2)),
            "ligaments of stops": (stops.ligament, (len(stops),)),
            "turns of stops": (stops.turned, (len(stops),)),
            "stiffness of stops": (stops.stiffness, (len(stops),)),
            "softness of stops": (stops.soft, (len(stops),)),
        }
        for name, (values, shape) in shapes.items():
            check_values(name, values, shape)
            values.setflags(write=False)
        for name, values in (("stretching", joints.stretching), ("shearing", joints.shearing),
                             ("turning", joints.turning)):  # fmt: skip
            if np.any(values <= 0.0):
                worst = int(np.argmin(values))
                raise MechanicsError("network.stiffness_not_positive", name=name, value=float(values[worst]), at=worst)
        self._check_joints()
        wrong = (self.contacts.rest <= 0.0) | (self.contacts.rest > LARGEST_ANGLE)
        if np.any(wrong):
            worst = int(np.argmax(wrong))
            raise MechanicsError(
                "network.panels_touch", angle_deg=math.degrees(float(self.contacts.rest[worst])), contact=worst
            )

    def _check_joints(self) -> None:
        """Refuse ligaments that join nothing, or too little."""
        count, joints = len(self.centroids), self.ligaments
        for table, last in (
            (joints.panels, count - 1), (self.contacts.ligament, len(joints) - 1),
            (self.stops.panels, count - 1), (self.stops.ligament, len(joints) - 1),
        ):  # fmt: skip
            if table.size and not 0 <= table.min() <= table.max() <= last:
                worst = int(table.max() if table.max() > last else table.min())
                raise MechanicsError("network.number_out_of_range", number=worst, last=last)
        largest = max(float(np.abs(part).max()) for part in (self.centroids, joints.points))
        if largest > LARGEST_MM or self.panel_size < SMALLEST_MM:
            raise MechanicsError("network.size_out_of_range", largest_mm=LARGEST_MM, smallest_mm=SMALLEST_MM)
        own = np.flatnonzero(joints.panels[:, 0] == joints.panels[:, 1])
        if own.size:
            raise MechanicsError("network.joins_itself", ligament=int(own[0]), panel=int(joints.panels[own[0], 0]))
        short = np.flatnonzero(joints.slender & (self.lengths <= SHORTEST_SLENDER * self.panel_size))
        if short.size:
            raise MechanicsError("network.slender_without_length", ligament=int(short[0]))
        links = coo_array((np.ones(len(joints)), tuple(joints.panels.T)), shape=(count, count))
        parts, part = connected_components(links, directed=False)
        if parts > 1:
            apart = int(np.argmax(part != part[0]))
            raise MechanicsError("network.not_connected", count=int(parts), panel=apart)

    @property
    def panel_count(self) -> int:
        return len(self.centroids)

    @property
    def lengths(self) -> FloatArray:
        """Distance (L,) from A's point to B's at rest, mm."""
        span: FloatArray = np.linalg.norm(self.ligaments.points[:, 1] - self.ligaments.points[:, 0], axis=1)
        return span

    @property
    def panel_size(self) -> float:
        """Mean distance between the centroids of joined panels, mm: the length by which turns are compared to moves."""
        ends = self.centroids[self.ligaments.panels]
        return float(np.mean(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)))

    def number_of(self, place: int) -> int:
        """The number in its sheet, row by row, of the panel at a place in the network."""
        return place if self.numbers is None else int(self.numbers[place])

    def place_of(self, number: int) -> int:
        """The place in the network of a panel of the sheet.

        Raises
        ------
        MechanicsError
            The sheet has no such panel, or trimming took it.
        """
        known = np.arange(self.panel_count) if self.numbers is None else self.numbers
        found = np.flatnonzero(known == number)
        if not found.size:
            raise MechanicsError("drive.unknown_panel", panel=number, last=int(known[-1]))
        return int(found[0])

    def turns(self, motion: FloatArray) -> FloatArray:
        """Turn of B relative to A at every ligament, (..., L) radians, out of motions (..., P, 3)."""
        theta = motion[..., 2]
        turned: FloatArray = theta[..., self.ligaments.panels[:, 1]] - theta[..., self.ligaments.panels[:, 0]]
        return turned

    def void_angles(self, motion: FloatArray) -> FloatArray:
        """Angles (..., C) of the contacts, radians, out of motions (..., P, 3)."""
        found: FloatArray = self.contacts.rest + self.contacts.sign * self.turns(motion)[..., self.contacts.ligament]
        return found

    def moved_outlines(self, motion: FloatArray) -> FloatArray:
        """Corners (P, Q, 2) of the panels, mm, after the motion (P, 3)."""
        arms = self.outlines - self.centroids[:, None]
        cos, sin = np.cos(motion[:, 2, None]), np.sin(motion[:, 2, None])
        turned = np.stack([cos * arms[..., 0] - sin * arms[..., 1], sin * arms[..., 0] + cos * arms[..., 1]], axis=-1)
        moved: FloatArray = turned + (self.centroids + motion[:, :2])[:, None]
        return moved

    def with_stiffness(self, stretching: float, shearing: float, turning: float, contact: float) -> PanelNetwork:
        """The same network with one set of constants: N/mm, N/mm, N mm, and turning stiffnesses of a contact."""
        count = len(self.ligaments)
        joints = replace(
            self.ligaments,
            stretching=np.full(count, stretching),
            shearing=np.full(count, shearing),
            turning=np.full(count, turning),
        )
        return replace(
            self,
            ligaments=joints,
            contacts=replace(self.contacts, stiffness=np.full(len(self.contacts), contact * turning)),
        )


def check_values(name: str, values: npt.NDArray[np.generic], shape: tuple[int, ...]) -> None:
    """Refuse an array that has another shape or holds what is not finite.

    Raises
    ------
    MechanicsError
        With the array's name.
    """
    if values.shape != shape:
        raise MechanicsError("network.wrong_shape", name=name, found=values.shape, wanted=shape)
    if values.dtype.kind not in "biuf":
        raise MechanicsError("network.not_numbers", name=name)
    bad = np.argwhere(~np.isfinite(values))
    if bad.size:
        raise MechanicsError("network.not_finite", name=name, at=tuple(int(place) for place in bad[0]))
