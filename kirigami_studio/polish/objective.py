"""What a fit minimises: boundary distances both ways, robustly, and what it asks of ratios and panels.

Residuals, all in unit-area lengths and weighted by the boundary length that they stand for:

* from points on every layout edge to the target boundary (nothing may stick out),
* from even samples of the target boundary to the layout (nothing may be missed),

down-weighted beyond a trusted distance so that their sum grows like an area and not like its square.  Beside them:
terms on z, see ``preferences``; penalties on panels too small to cut, see ``panel_size``, and on long chords of a round
start, see ``chords``; and, where a stage of the fit asks for them, even panels, see ``even_panels``, a guide for the
inside, see ``guide``, and open junctions, see ``junctions``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kirigami_studio.evaluate.evenness import PanelSizes, panel_sizes
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.topology import topology
from kirigami_studio.polish.basis import Basis
from kirigami_studio.polish.boundary_target import BoundaryTarget
from kirigami_studio.polish.chords import WEIGHT as CHORDS
from kirigami_studio.polish.even_panels import EvenPanels
from kirigami_studio.polish.guide import Guide
from kirigami_studio.polish.junctions import OPEN, Junctions, junctions
from kirigami_studio.polish.matching import EDGE_SHARES, Matching, OneSided, check_excess, matched, outer_hinges
from kirigami_studio.polish.normal_equations import Quadratic
from kirigami_studio.polish.panel_size import PENALTY, shortage
from kirigami_studio.polish.preferences import PreferenceTerms
from kirigami_studio.polish.sensitivity import Decoded, NodeMotion, OutlineModel

#: Distance (unit-area lengths) beyond which a residual counts linearly when nothing else is asked for.
#: Found on 50 outlines, drawn ones and those of random fields: 0.003 to 0.03 differ by 0.002 in mean exact IoU.
TRUST = 0.005

#: A step that lowers the cost by no more than this share ends a fit: one for the match alone, and a stage of one with
#: even panels.  In whole runs for 4 shapes the larger share saves a quarter of the decodings; the mean IoU of the first
#: designs stays within 0.0002.  Where only the match counts it would take 0.0001 off an IoU of 0.9987.
CONVERGED, SETTLED = 1e-4, 2e-3

#: Number of pose parameters: log scale, angle, shift.
POSE = 4
NO_SIZES = panel_sizes(topology(2, 2).uniform_nodes, 2, 2).below(0.0)
NO_JUNCTIONS = junctions(topology(2, 2).uniform_nodes, 2, 2).shallower(0.0)


@dataclass(frozen=True, slots=True)
class Stage:
    """What counts for some steps of a fit.

    Attributes
    ----------
    steps : int
        Accepted steps at most.
    trust : float, unit-area lengths
        Distance beyond which a boundary residual counts linearly: large ones let far parts pull, small ones serve the
        area.
    even : float
        Weight of even panels, see ``even_panels``.
    guide : float
        Weight of the guide for the inside, see ``guide``.
    least_gain : float
        The stage ends with a step that lowers the cost by no more than this share.
    junctions : float
        Weight of cuts that meet at shallow angles, see ``junctions``.
    """

    steps: int
    trust: float = TRUST
    even: float = 0.0
    guide: float = 0.0
    least_gain: float = SETTLED
    junctions: float = 0.0


#: Nothing but the match and what the ratios prefer.
MATCH_ALONE = Stage(0)


class Objective:
    """Cost of states (shape, pose) for one target.

    A state is a vector: the shape (z of all voids row by row, then offsets of the mouths where the rim is free), then
    log scale, angle, shift x, shift y of the pose that carries the layout to the target's unit-area frame.

    Parameters
    ----------
    model : OutlineModel
    target : BoundaryTarget
    terms : PreferenceTerms
    stage : Stage
    least : float, unit cells
        Panel edges and necks should not be smaller; 0 for any size.
    excess : float, 0..1
        Weight of what sticks out of the target: 1 unless it will be trimmed.
    even : EvenPanels, optional
        Needed where the stage asks for even panels.
    guide : Guide, optional
        Needed where the stage asks for a guide.
    """

    def __init__(
        self,
        model: OutlineModel,
        target: BoundaryTarget,
        terms: PreferenceTerms,
        stage: Stage = MATCH_ALONE,
        least: float = 0.0,
        excess: float = 1.0,
        even: EvenPanels | None = None,
        guide: Guide | None = None,
    ) -> None:
        self.model, self.target, self.terms, self.stage, self.least = model, target, terms, stage, least
        self.even = even if stage.even else None
        self.guide = guide if stage.guide else None
        self._each_junction = stage.junctions / (2 * model.voids)
        self.one_sided = None
        if check_excess(excess) < 1.0:
            self.one_sided = OneSided(excess, outer_hinges(model.rows, model.columns, model.phi))

    def look(self, state: FloatArray) -> Look:
        """Decode a state, match it with the target and count the cost."""
        shape = state[:-POSE]
        decoded = self.model.decoded(shape)
        nodes = decoded.nodes
        outline = _posed(self.model.outline_of(nodes), state[-POSE:])
        matching = matched(outline, self.target)
        if self.one_sided is not None:
            matching = self.one_sided.weighed(matching, outline, self.target)
        cost = float((matching.weight * _robust(matching.distance, self.stage.trust)).sum())
        cost += self.terms.value(shape[: self.model.voids])
        if self.even is not None:
            cost += self.stage.even * self.even.value(nodes)
        if self.model.chords is not None:
            cost += CHORDS * self.model.chords.excess(self.model.positions(shape)) ** 2
        gaps = None
        if self.guide is not None:
            gaps = self.guide.gaps(nodes, _similarity(state[-POSE:]))
            cost += self.stage.guide * float(np.square(gaps).sum()) / len(gaps)
        small = NO_SIZES
        if self.least:
            small = panel_sizes(nodes, self.model.rows, self.model.columns).below(self.least)
            cost += shortage(small, self.least)
        shallow = NO_JUNCTIONS
        if self.stage.junctions:
            shallow = junctions(nodes, self.model.rows, self.model.columns).shallower(OPEN)
            cost += self._each_junction * float(np.square(shallow.sine - OPEN).sum())
        return Look(state, decoded, outline, matching, small, shallow, gaps, cost)

    def slopes(self, look: Look, basis: Basis | None = None, stiffness: FloatArray | None = None) -> Slopes:
        """Derivatives at a state, by the variables of ``basis``; by the shape's own numbers if missing.

        ``stiffness`` (V, V) is the even panels' of a state nearby, to be used again.
        """
        basis = basis or Basis.of(look.state.size - POSE, None)
        pose = look.state[-POSE:]
        motion = self.model.node_motion(look.decoded)
        if self.even is not None and stiffness is None:
            stiffness = motion.curvature(self.even.stiffness, basis)
        centroids = None
        if self.guide is not None:
            posed = _posed(self.guide.centroids(look.decoded.nodes), pose)
            moved = self.guide.slopes(motion.derivative(basis))
            centroids = _state_derivative(posed, moved, pose).reshape(-1, basis.size + POSE)
        outline = _state_derivative(look.outline, basis.reduced(motion.outline()), pose)
        return Slopes(basis, outline.reshape(-1, basis.size + POSE), motion, stiffness, centroids)

    def quadratic(self, look: Look, slopes: Slopes) -> Quadratic:
        """Gradient and Gauss-Newton approximation at a state, from the derivatives there or nearby."""
        inner = np.zeros((slopes.outline.shape[1],) * 2)
        shape, basis, own = look.state[:-POSE], slopes.basis, inner[:-POSE, :-POSE]
        own += basis.matrix(*self.terms.curvature(shape[: self.model.voids]))
        if self.even is not None and slopes.stiffness is not None:
            own += self.stage.even * slopes.stiffness
        if len(look.small.size):
            grown = basis.reduced(slopes.motion.slopes(*look.small.reach(self.model.node_count)))
            own += 2.0 * PENALTY * (grown.T @ grown)
        if len(look.shallow):
            opened = basis.reduced(slopes.motion.slopes(*look.shallow.reach(self.model.node_count)))
            own += 2.0 * self._each_junction * (opened.T @ opened)
        cut = self._cut_by_chords(shape)
        if cut is not None:
            slope = basis.reduced(cut[1])
            own += 2.0 * CHORDS * np.outer(slope, slope)
        if look.gaps is not None and slopes.centroids is not None:
            inner += 2.0 * self.stage.guide / len(look.gaps) * (slopes.centroids.T @ slopes.centroids)
        return Quadratic(self.gradient(look, slopes), inner, slopes.outline, self.spread(look))

    def gradient(self, look: Look, slopes: Slopes) -> FloatArray:
        """Derivative (V + 4,) of the cost, from the derivatives at the state or nearby."""
        matching, trust, shape = look.matching, self.stage.trust, look.state[:-POSE]
        force = 2.0 * matching.weight * matching.distance / np.sqrt(1.0 + np.square(matching.distance / trust))
        pull = matching.pull(force, len(look.outline)) + _stretching(look.outline, matching, trust)
        gradient: FloatArray = pull @ slopes.outline
        if look.gaps is not None and slopes.centroids is not None:
            gradient += 2.0 * self.stage.guide / len(look.gaps) * (look.gaps.ravel() @ slopes.centroids)
        by_shape = np.zeros(shape.size)
        by_shape[: self.model.voids] = self.terms.gradient(shape[: self.model.voids])
        by_nodes = self._force(look)
        if by_nodes is not None:
            by_shape += slopes.motion.gradient(by_nodes)
        cut = self._cut_by_chords(shape)
        if cut is not None:
            by_shape += 2.0 * CHORDS * cut[0] * cut[1]
        gradient[:-POSE] += slopes.basis.reduced(by_shape)
        return gradient

    def _cut_by_chords(self, shape: FloatArray) -> tuple[float, FloatArray] | None:
        """What chords cut off beyond what is allowed, and its derivative (S,) by the shape; None for nothing."""
        model = self.model
        excess = 0.0 if model.chords is None else model.chords.excess(model.positions(shape))
        if model.chords is None or not excess:
            return None
        return excess, np.append(np.zeros(model.voids), model.chords.slopes(model.positions(shape)))

    def spread(self, look: Look) -> FloatArray:
        """Gauss-Newton approximation of the second derivative of the match by the outline's vertices: (2 L, 2 L)."""
        matching = look.matching
        stiffness = 2.0 * matching.weight / np.sqrt(1.0 + np.square(matching.distance / self.stage.trust))
        return matching.spread(stiffness, len(look.outline))

    def _force(self, look: Look) -> FloatArray | None:
        """Derivative (N, 2) of the terms on panels by the compact nodes; None where there are none."""
        nodes = look.decoded.nodes
        force = self.stage.even * self.even.pull(nodes) if self.even is not None else None
        if len(look.small.size):
            lack = 2.0 * PENALTY * (look.small.size - self.least)
            grown = np.stack([lack @ along for along in look.small.reach(len(nodes))], axis=1)
            force = grown if force is None else force + grown
        if len(look.shallow):
            lack = 2.0 * self._each_junction * (look.shallow.sine - OPEN)
            opened = np.stack([lack @ along for along in look.shallow.reach(len(nodes))], axis=1)
            force = opened if force is None else force + opened
        return force


@dataclass(frozen=True, slots=True, eq=False)
class Slopes:
    """Derivatives at one state by the V variables that move, the pose's last where it takes part.

    Attributes
    ----------
    basis : Basis
        How the variables move the shape.
    outline : (2 L, V + 4) float
        Of the outline in the target's frame.
    motion : NodeMotion
        Of the compact nodes.
    stiffness : (V, V) float or None
        Second derivative of the term for even panels with weight 1, there or nearby.
    centroids : (2 P, V + 4) float or None
        Of the panel centroids in the target's frame, where there is a guide.
    """

    basis: Basis
    outline: FloatArray
    motion: NodeMotion
    stiffness: FloatArray | None
    centroids: FloatArray | None


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """The objective at one state.

    Attributes
    ----------
    state : (S + 4,) float
    decoded : Decoded
        The compact sheet.
    outline : (L, 2) float
        The layout's outline in the target's frame.
    matching : Matching
    small : PanelSizes
        Edges and necks below the least size.
    shallow : Junctions
        Where cuts meet at shallow angles, if the stage asks for open junctions.
    gaps : (P, 2) float or None
        From each panel centroid's image to the centroid, where there is a guide.
    cost : float
    """

    state: FloatArray
    decoded: Decoded
    outline: FloatArray
    matching: Matching
    small: PanelSizes
    shallow: Junctions
    gaps: FloatArray | None
    cost: float


def _robust(distance: FloatArray, trust: float) -> FloatArray:
    """Squared distance near the target, linear far from it (pseudo-Huber), with derivative 2 d / sqrt(1 + (d/c)^2)."""
    cost: FloatArray = 2.0 * trust**2 * (np.sqrt(1.0 + np.square(distance / trust)) - 1.0)
    return cost


def _posed(points: FloatArray, pose: FloatArray) -> FloatArray:
    """Scale by exp(pose[0]), turn by pose[1], shift by pose[2:]."""
    c, s = math.exp(pose[0]) * math.cos(pose[1]), math.exp(pose[0]) * math.sin(pose[1])
    posed: FloatArray = points @ np.array([[c, s], [-s, c]]) + pose[2:]
    return posed


def _similarity(pose: FloatArray) -> Similarity:
    return Similarity(math.exp(pose[0]), pose[1], (pose[2], pose[3]))


def _state_derivative(outline: FloatArray, derivative: FloatArray, pose: FloatArray) -> FloatArray:
    """Derivative (L, 2, V + 4) of posed points (L, 2) by variables and pose, from theirs in the layout's own frame."""
    c, s = math.exp(pose[0]) * math.cos(pose[1]), math.exp(pose[0]) * math.sin(pose[1])
    full = np.zeros((*outline.shape, derivative.shape[2] + POSE))
    full[:, 0, :-POSE] = c * derivative[:, 0] - s * derivative[:, 1]
    full[:, 1, :-POSE] = s * derivative[:, 0] + c * derivative[:, 1]
    about = outline - pose[2:]
    full[:, :, -4] = about
    full[:, 0, -3], full[:, 1, -3] = -about[:, 1], about[:, 0]
    full[:, 0, -2] = full[:, 1, -1] = 1.0
    return full


def _stretching(outline: FloatArray, matching: Matching, trust: float) -> FloatArray:
    """Derivative (2 L,) of the cost by vertices through the edge lengths that weight the outward distances."""
    edge = np.roll(outline, -1, axis=0) - outline
    length = np.maximum(np.hypot(*edge.T), 1e-12)
    outward = slice(0, len(outline) * EDGE_SHARES.size)
    cost = (matching.weight[outward] * _robust(matching.distance[outward], trust)).reshape(len(outline), -1)
    pull = (cost.sum(axis=1) / length)[:, None] * (edge / length[:, None])
    slope: FloatArray = (np.roll(pull, 1, axis=0) - pull).ravel()
    return slope
