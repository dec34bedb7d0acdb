"""A deployment placed in the target's frame, at every angle."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.trimming import Trim
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.gui.scene.trimmed_parts import TrimmedParts
from kirigami_studio.gui.scene.view_transform import Bounds
from kirigami_studio.lattice.deployment import Deployment

#: Angles at which the motion's extent is sampled; the extent is smooth in the angle.
EXTENT_SAMPLES = 9


@dataclass(frozen=True, slots=True, eq=False)
class PosedDesign:
    """One design where the eye expects it: over its target at ``phi_target``, turning about its own middle elsewhere.

    Attributes
    ----------
    deployment : Deployment
    pose : Similarity
        Layout frame at ``phi_target`` -> world.
    phi_target : float, radians
    trim : Trim or None
        What was cut off the edge panels.
    """

    deployment: Deployment
    pose: Similarity
    phi_target: float
    trim: Trim | None = None

    def nodes(self, phi: float) -> FloatArray:
        """All nodes at angle ``phi``: (N, 2) float, world."""
        placed = self.pose.apply(self.deployment.nodes(phi))
        centred: FloatArray = placed + (self._middle() - placed.mean(axis=0))
        return centred

    def _middle(self) -> FloatArray:
        return _placed_middle(self)

    def panels(self, nodes: FloatArray) -> FloatArray:
        """Panel corners (K, 4, 2) out of :meth:`nodes`."""
        return nodes[self.deployment.topology.panel_nodes].reshape(-1, 4, 2)

    def voids(self, nodes: FloatArray) -> FloatArray:
        """Void corners p0 to p3 (m, n, 4, 2) out of :meth:`nodes`."""
        return nodes[self.deployment.topology.void_nodes]

    def mm_per_world(self, width_mm: float) -> float:
        """Millimetres of one world unit, where the flat sheet is ``width_mm`` wide."""
        return width_mm / (float(np.ptp(self.deployment.compact[:, 0])) * self.pose.scale)

    def kept(self, nodes: FloatArray, phi: float) -> dict[int, FloatArray]:
        """What stays of the trimmed panels, (P, 2) each by its row in :meth:`panels`, out of :meth:`nodes`."""
        if self.trim is None:
            return {}
        rings = _trimmed_parts(self).kept
        return dict(zip(rings.panel.tolist(), rings.at(nodes, self.pose, phi), strict=True))

    def removed(self, nodes: FloatArray, phi: float) -> list[FloatArray]:
        """What trimming cut off: list of (P, 2), out of :meth:`nodes`."""
        return [] if self.trim is None else _trimmed_parts(self).removed.at(nodes, self.pose, phi)

    def outline(self, nodes: FloatArray, phi: float) -> FloatArray:
        """Boundary polygon (L, 2) out of :meth:`nodes`, before anything was cut off."""
        tables = self.deployment.topology
        zipped = phi < 1e-9
        boundary: FloatArray = nodes[tables.outline_at_zero if zipped else tables.outline_nodes]
        return boundary

    def to_world(self, place: tuple[float, float], phi: float) -> FloatArray:
        """Map one place of the layout frame at ``phi`` to the world: (2,)."""
        placed = self.pose.apply(self.deployment.nodes(phi)).mean(axis=0)
        moved: FloatArray = self.pose.apply(np.asarray(place)) + (self._middle() - placed)
        return moved

    def to_layout(self, place: tuple[float, float], phi: float) -> FloatArray:
        """Map one place of the world to the layout frame at ``phi``: (2,), the way back of :meth:`to_world`."""
        placed = self.pose.apply(self.deployment.nodes(phi)).mean(axis=0)
        back: FloatArray = self.pose.inverse().apply(np.asarray(place) - (self._middle() - placed))
        return back

    def bounds(self) -> Bounds:
        """Box around the whole motion from pi to 0."""
        angles = np.linspace(math.pi, 0.0, EXTENT_SAMPLES)
        return Bounds.of(np.concatenate([self.nodes(float(phi)) for phi in angles]))


@lru_cache(maxsize=512)
def _placed_middle(design: PosedDesign) -> FloatArray:
    middle: FloatArray = design.pose.apply(design.deployment.nodes(design.phi_target)).mean(axis=0)
    return middle


@lru_cache(maxsize=256)
def _trimmed_parts(design: PosedDesign) -> TrimmedParts:
    if design.trim is None:
        raise ValueError("A design that is not trimmed has no trimmed parts.")
    return TrimmedParts.of(design.deployment, design.trim)
