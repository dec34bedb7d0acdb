"""What a fit minimises: boundary distances both ways, robustly, and what it asks of ratios and panels.

Residuals, all in unit-area lengths and weighted by the boundary length that they stand for:

* from points on every layout edge to the target boundary (nothing may stick out),
* from even samples of the target boundary to the layout (nothing may be missed),

down-weighted beyond a trusted distance so that their sum grows like an area and not like its square.  Where the start
is not the paper's rectangle, vertices that stick out count beside that: horns.  Beside them:
terms on z, see ``preferences``; penalties on panels too small to cut, see ``panel_size``, on pins too near to each
other, see ``pinwheel``, and on long chords of a round start, see ``chords``; and, where a phase of the fit asks for
them, even panels, see ``even_panels``, none large, see ``large_panels``, a transport map of the inside, see
``transport_map``, and open junctions, see ``junctions``.  A second target has residuals of the same kind at its own
angle, in a pose of its own, times its weight.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_diag, csr_matrix

from kirigami_studio.evaluate.evenness import PanelSizes, panel_sizes
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.topology import topology
from kirigami_studio.polish.basis import Basis
from kirigami_studio.polish.boundary_target import BoundaryTarget
from kirigami_studio.polish.chords import Chords
from kirigami_studio.polish.even_panels import EvenPanels, EvenPanelsAt
from kirigami_studio.polish.junctions import OPEN, JunctionAngles, junctions
from kirigami_studio.polish.large_panels import LARGE, PanelAreas, panel_areas
from kirigami_studio.polish.matching import Matching, OneSided, check_excess, matched
from kirigami_studio.polish.normal_equations import Matrix, Quadratic
from kirigami_studio.polish.panel_size import PENALTY, shortage
from kirigami_studio.polish.pin_room import PinRoom, pin_room
from kirigami_studio.polish.preferences import FieldPreferenceTerms
from kirigami_studio.polish.sensitivity import CompactLayout, NodeMotion, OutlineModel
from kirigami_studio.polish.transport_map import TransportTerm

#: Distance (unit-area lengths) beyond which a residual counts linearly when nothing else is asked for.
#: Found on 50 outlines, drawn ones and those of random fields: 0.003 to 0.03 differ by 0.002 in mean exact IoU.
TRUST = 0.005

#: A step that lowers the cost by no more than this share ends a fit: one for the match alone, and a phase of one with
#: even panels.  In whole runs for 4 shapes the larger share saves a quarter of the decodings; the mean IoU of the first
#: designs stays within 0.0002.  Where only the match counts it would take 0.0001 off an IoU of 0.9987.
CONVERGED, SETTLED = 1e-4, 2e-3

#: Corrections follow a step that lowered the cost by this share, and in runs, which take many short fits, by the
#: second.  In 10 steps from the uniform sheet of 16 x 16 voids to 8 shapes corrections after every step reach a mean
#: exact IoU of 0.9738, after steps that gained 0.02 0.9730, after those that gained 0.25 0.9633, by 5 and 27 % less
#: processor time; in runs for a heart, a butterfly and a star first designs are as good with the second share.
CORRECTED, SPARINGLY = 0.02, 0.25

#: Number of pose parameters: log scale, angle, shift.
POSE = 4
NO_SIZES = panel_sizes(topology(2, 2).uniform_nodes, 2, 2).below(0.0)
ALL_APART = pin_room(topology(2, 2).uniform_nodes, 2, 2, 0.0, 0.0, pins_alone=True)
NO_JUNCTIONS = junctions(topology(2, 2).uniform_nodes, 2, 2).shallower(0.0)
NO_AREAS = panel_areas(topology(2, 2).uniform_nodes, 2, 2).larger(LARGE)


@dataclass(frozen=True, slots=True, eq=False)
class SecondTerm:
    """What a second target adds to the cost."""

    model: OutlineModel  #: Of the same sheets at its angle
    target: BoundaryTarget
    weight: float


@dataclass(frozen=True, slots=True)
class FitPhase:
    """What counts for some steps of a fit."""

    steps: int  #: Accepted steps at most
    #: unit-area lengths; distance beyond which a boundary residual counts linearly: large ones let far parts pull,
    #: small ones serve the area
    trust: float = TRUST
    even: float = 0.0  #: Weight of even panels, see ``even_panels``
    transport: float = 0.0  #: Weight of the transport map of the inside, see ``transport_map``
    least_gain: float = SETTLED  #: The phase ends with a step that lowers the cost by no more than this share
    junctions: float = 0.0  #: Weight of cuts that meet at shallow angles, see ``junctions``
    corrected: float = CORRECTED  #: Corrections follow a step that lowers the cost by this share


#: Nothing but the match and what the ratios prefer.
MATCH_ALONE = FitPhase(0)


class Objective:
    """Cost of states (shape, pose) for one target.

    A state is a vector: the shape (z of all voids row by row, then offsets of the mouths and, half open, of the edge
    hinges where the rim is free), then
    log scale, angle, shift x, shift y of the pose that carries the layout to the target's unit-area frame; and the same
    of the layout at the second target's angle, where there is one.

    Parameters
    ----------
    model : OutlineModel
    target : BoundaryTarget
    terms : FieldPreferenceTerms
    phase : FitPhase
    least : float, unit cells
        Panel edges and necks should not be smaller; 0 for any size.
    excess : float, 0..1
        Weight of what sticks out of the target: 1 unless it will be trimmed.
    even : EvenPanels, optional
        Needed where the phase asks for even panels.
    transport : TransportTerm, optional
        Needed where the phase asks for a transport map.
    second : SecondTerm, optional
    gap : float, unit cells
        Pins should not be nearer to each other; 0 for sheets without pins.
    gap_penalty : float
        Weight of what is missing, see ``pinwheel``.

    Attributes
    ----------
    poses : int
        How many numbers of a state are its poses.
    """

    def __init__(
        self,
        model: OutlineModel,
        target: BoundaryTarget,
        terms: FieldPreferenceTerms,
        phase: FitPhase = MATCH_ALONE,
        least: float = 0.0,
        excess: float = 1.0,
        even: EvenPanels | None = None,
        transport: TransportTerm | None = None,
        second: SecondTerm | None = None,
        gap: float = 0.0,
        gap_penalty: float = PENALTY,
    ) -> None:
        self.model, self.target, self.terms, self.phase, self.least = model, target, terms, phase, least
        self.gap, self._gap_penalty = gap, gap_penalty
        self.even = even if phase.even else None
        self.transport = transport if phase.transport else None
        self.second, self.poses = second, POSE if second is None else 2 * POSE
        self._each_junction = phase.junctions / (2 * model.voids)
        self._each_large = 0.0
        if self.even is not None:
            self._each_large = phase.even * self.even.large / ((model.rows + 1) * (model.columns + 1))
        self.one_sided, layout = None, (model.rows, model.columns, model.phi)
        if check_excess(excess) < 1.0:
            self.one_sided = OneSided.trimmed(excess, *layout)
        elif model.has_start:
            self.one_sided = OneSided.without_horns(*layout)

    def look(self, state: FloatArray) -> Look:
        """Decode a state, match it with the target and count the cost."""
        shape, pose, second_pose = self._parts(state)
        decoded = self.model.decoded(shape)
        nodes = decoded.nodes
        outline = _posed(self.model.outline_of(nodes), pose)
        matching = matched(outline, self.target)
        if self.one_sided is not None:
            matching = self.one_sided.weighed(matching, outline, self.target)
        cost = matching.cost(self.phase.trust)
        second = None
        if self.second is not None:
            placed = _posed(self.second.model.outline_of(nodes), second_pose)
            second = SecondLook(placed, matched(placed, self.second.target))
            cost += self.second.weight * second.matching.cost(self.phase.trust)
        cost += self.terms.value(shape[: self.model.voids])
        even = None
        if self.even is not None:
            even = self.even.at(nodes)
            cost += self.phase.even * even.value
        excess = 0.0
        if self.model.chords is not None:
            excess = self.model.chords.excess(self.model.positions(shape))
            cost += self.model.chords.weight * excess**2
        gaps = None
        if self.transport is not None:
            gaps = self.transport.gaps(nodes, _similarity(pose))
            cost += self.phase.transport * float(np.square(gaps).sum()) / len(gaps)
        small = NO_SIZES
        if self.least:
            small = panel_sizes(nodes, self.model.rows, self.model.columns).below(self.least)
            cost += shortage(small, self.least)
        close = ALL_APART
        if self.gap:
            close = pin_room(nodes, self.model.rows, self.model.columns, self.gap, 0.0)
            cost += self._gap_penalty * float(np.square(close.spare).sum())
        shallow = NO_JUNCTIONS
        if self.phase.junctions:
            shallow = junctions(nodes, self.model.rows, self.model.columns).shallower(OPEN)
            cost += self._each_junction * float(np.square(shallow.sine - OPEN).sum())
        large = NO_AREAS
        if self.even is not None and self._each_large:
            large = panel_areas(nodes, self.model.rows, self.model.columns, self.even.mean_area).larger(LARGE)
            cost += self._each_large * float(np.square(large.area - LARGE).sum())
        return Look(state, decoded, outline, matching, second, even, small, close, shallow, large, excess, gaps, cost)

    def _parts(self, state: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Shape, pose, and the second target's pose, empty where there is none."""
        shape, poses = state[: -self.poses], state[-self.poses :]
        return shape, poses[:POSE], poses[POSE:]

    def slopes(self, look: Look, basis: Basis | None = None, stiffness: Matrix | None = None) -> Slopes:
        """Derivatives at a state, by the variables of ``basis``; by the shape's own numbers if missing.

        ``stiffness`` (V, V) is the even panels' of a state nearby, to be used again.
        """
        basis = basis or Basis.of(look.state.size - self.poses, None)
        _, pose, second_pose = self._parts(look.state)
        motion = self.model.node_motion(look.decoded)
        if look.even is not None and stiffness is None:
            stiffness = motion.curvature(look.even.curvature(), basis)
        centroids = None
        if self.transport is not None:
            posed = _posed(self.transport.centroids(look.decoded.nodes), pose)
            moved = _turned(self.transport.slopes(motion.derivative(basis)), _factor(pose), self.poses)
            centroids = _with_pose(moved, posed, pose, 0, self.poses)
        outline = motion.outline(basis, _factor(pose), self.poses)
        outline = _with_pose(outline, look.outline, pose, 0, self.poses)
        if self.second is not None and look.second is not None:
            other = motion.outline_in(self.second.model, basis, _factor(second_pose), self.poses)
            other = _with_pose(other, look.second.outline, second_pose, POSE, self.poses)
            outline = np.concatenate([outline, other])
        return Slopes(basis, outline, motion, stiffness, centroids)

    def quadratic(
        self, look: Look, slopes: Slopes, opening: FloatArray | None = None, *, single: bool = False
    ) -> Quadratic:
        """Gradient and Gauss-Newton approximation at a state, from the derivatives there or nearby.

        ``opening`` (V, V) is that of open junctions at a state nearby, to be used again, see :meth:`opening`; a large
        matrix may be of ``single`` precision.
        """
        size, kind = slopes.outline.shape[1], np.float32 if single else np.float64
        inner = np.zeros((size, size), dtype=kind)
        shape, basis, own = self._parts(look.state)[0], slopes.basis, inner[: -self.poses, : -self.poses]
        row, column, value = basis.entries(*self.terms.curvature(shape[: self.model.voids]))
        np.add.at(inner.ravel(), row * size + column, value.astype(kind))
        if self.even is not None and slopes.stiffness is not None:
            own += np.multiply(self.phase.even, slopes.stiffness, dtype=kind, casting="same_kind")
        opening = self.opening(look, slopes) if opening is None else opening
        if opening is not None:
            own += opening
        priced = self._priced(look)
        if priced is not None:
            grown = slopes.motion.slopes(*priced[1], basis)
            own += 2.0 * (grown.T @ grown)
        if look.excess and self.model.chords is not None:
            slope = basis.reduced(self._cut_by_chords(self.model.chords, shape))
            own += 2.0 * self.model.chords.weight * np.outer(slope, slope)
        if look.gaps is not None and slopes.centroids is not None:
            inner += 2.0 * self.phase.transport / len(look.gaps) * (slopes.centroids.T @ slopes.centroids)
        return Quadratic(self.gradient(look, slopes), inner, slopes.outline, self.spread(look))

    def opening(self, look: Look, slopes: Slopes) -> FloatArray | None:
        """Gauss-Newton approximation (V, V) of the second derivative of open junctions, where the phase has them."""
        if not len(look.shallow):
            return None
        grown = slopes.motion.slopes(*look.shallow.reach(self.model.node_count), slopes.basis)
        return np.asarray(2.0 * self._each_junction * (grown.T @ grown))

    def gradient(self, look: Look, slopes: Slopes) -> FloatArray:
        """Derivative (V + P,) of the cost, P numbers of poses, from the derivatives at the state or nearby."""
        trust, shape = self.phase.trust, self._parts(look.state)[0]
        pull = look.matching.slope(look.outline, trust)
        if self.second is not None and look.second is not None:
            second = look.second.matching.slope(look.second.outline, trust)
            pull = np.concatenate([pull, self.second.weight * second])
        gradient: FloatArray = pull @ slopes.outline
        if look.gaps is not None and slopes.centroids is not None:
            gradient += 2.0 * self.phase.transport / len(look.gaps) * (look.gaps.ravel() @ slopes.centroids)
        by_shape = np.zeros(shape.size)
        by_shape[: self.model.voids] = self.terms.gradient(shape[: self.model.voids])
        by_nodes = self._force(look)
        if by_nodes is not None:
            by_shape += slopes.motion.gradient(by_nodes)
        if look.excess and self.model.chords is not None:
            by_shape += 2.0 * self.model.chords.weight * look.excess * self._cut_by_chords(self.model.chords, shape)
        gradient[: -self.poses] += slopes.basis.reduced(by_shape)
        return gradient

    def _cut_by_chords(self, chords: Chords, shape: FloatArray) -> FloatArray:
        """Derivative (S,) by the shape of what chords cut off."""
        cut = np.zeros(self.model.size)
        slopes = chords.slopes(self.model.positions(shape))
        cut[self.model.voids : self.model.voids + slopes.size] = slopes
        return cut

    def spread(self, look: Look) -> csr_matrix:
        """Gauss-Newton approximation of the second derivative of the match by the outline's vertices: (2 L, 2 L); those
        at the second target's angle follow the first.
        """
        trust = self.phase.trust
        spread = look.matching.curvature(len(look.outline), trust)
        if self.second is None or look.second is None:
            return spread
        second = self.second.weight * look.second.matching.curvature(len(look.second.outline), trust)
        return csr_matrix(block_diag((spread, second)))

    def _force(self, look: Look) -> FloatArray | None:
        """Derivative (N, 2) of the terms on panels by the compact nodes; None where there are none."""
        force = None if look.even is None else self.phase.even * look.even.pull()
        if len(look.shallow):
            weight = 2.0 * self._each_junction * (look.shallow.sine - OPEN)
            opened = look.shallow.pulled(weight, self.model.node_count)
            force = opened if force is None else force + opened
        priced = self._priced(look)
        if priced is not None:
            grown = np.stack([2.0 * (priced[0] @ along) for along in priced[1]], axis=1)
            force = grown if force is None else force + grown
        return force

    def _priced(self, look: Look) -> tuple[FloatArray, tuple[FloatArray, FloatArray]] | None:
        """By how much sizes and areas are beyond what is asked of them, times the root of their weight (F,), and
        matrices (F, N) that read changes of these off motions of the nodes in x and in y; None where none are.
        """
        count = self.model.node_count
        terms = [
            (weight**0.5, beyond, reach(count))
            for weight, beyond, reach in (
                (PENALTY, look.small.size - self.least, look.small.reach),
                (self._gap_penalty, look.close.spare, look.close.reach),
                (self._each_large, look.large.area - LARGE, look.large.reach),
            )
            if len(beyond)
        ]
        if not terms:
            return None
        along_x, along_y = (np.concatenate([root * reach[axis] for root, _, reach in terms]) for axis in (0, 1))
        return np.concatenate([root * beyond for root, beyond, _ in terms]), (along_x, along_y)


@dataclass(frozen=True, slots=True, eq=False)
class Slopes:
    """Derivatives at one state by the V variables that move, the pose's last where it takes part."""

    basis: Basis  #: How the variables move the shape
    #: (2 L, V + 4); of the outline in the target's frame; of that at the second target's angle below it, in 4 columns
    #: more
    outline: FloatArray
    motion: NodeMotion  #: Of the compact nodes
    #: (V, V); second derivative of the term for even panels with weight 1, there or nearby
    stiffness: Matrix | None
    #: (2 P, V + 4); of the panel centroids in the target's frame, where there is a transport map
    centroids: FloatArray | None


@dataclass(frozen=True, slots=True, eq=False)
class SecondLook:
    """The layout at the second target's angle, in that target's frame: its outline (L, 2), and what matches."""

    outline: FloatArray
    matching: Matching


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """The objective at one state."""

    state: FloatArray  #: (S + P,); p is 4, or 8 where there is a second target
    decoded: CompactLayout  #: The compact sheet
    outline: FloatArray  #: (L, 2); the layout's outline in the target's frame
    matching: Matching
    second: SecondLook | None
    even: EvenPanelsAt | None  #: Where the phase asks for even panels
    small: PanelSizes  #: Edges and necks below the least size
    close: PinRoom  #: Where pins have less room than they need
    shallow: JunctionAngles  #: Where cuts meet at shallow angles, if the phase asks for open junctions
    large: PanelAreas  #: Panels that are large, if the phase asks for even ones
    excess: float  #: Share of a round start's area that chords cut off beyond what is allowed
    gaps: FloatArray | None  #: (P, 2); from each panel centroid's image to the centroid, where there is a transport map
    cost: float


def _posed(points: FloatArray, pose: FloatArray) -> FloatArray:
    """Scale by exp(pose[0]), turn by pose[1], shift by pose[2:]."""
    c, s = math.exp(pose[0]) * math.cos(pose[1]), math.exp(pose[0]) * math.sin(pose[1])
    posed: FloatArray = points @ np.array([[c, s], [-s, c]]) + pose[2:]
    return posed


def _similarity(pose: FloatArray) -> Similarity:
    return Similarity(math.exp(pose[0]), pose[1], (pose[2], pose[3]))


def _factor(pose: FloatArray) -> complex:
    """Scale and turn of a pose."""
    return cmath.rect(math.exp(pose[0]), pose[1])


def _turned(derivative: FloatArray, factor: complex, more: int) -> FloatArray:
    """A derivative (L, 2, V) turned and scaled by a factor, with ``more`` columns left open."""
    count, _, size = derivative.shape
    turned = np.empty((count, 2, size + more))
    turned[:, 0, :size] = factor.real * derivative[:, 0] - factor.imag * derivative[:, 1]
    turned[:, 1, :size] = factor.imag * derivative[:, 0] + factor.real * derivative[:, 1]
    return turned


def _with_pose(derivative: FloatArray, points: FloatArray, pose: FloatArray, first: int, poses: int) -> FloatArray:
    """A derivative (2 L, V + P) of posed ``points`` (L, 2) by variables and poses.

    It is made of (L, 2, V + P) with open columns for the P numbers of ``poses``; the points' own pose begins at
    number ``first`` of these.
    """
    count, _, size = derivative.shape
    derivative[:, :, size - poses :] = 0.0
    first += size - poses
    own, about = derivative[:, :, first : first + POSE], points - pose[2:]
    own[:, :, 0] = about
    own[:, 0, 1], own[:, 1, 1] = -about[:, 1], about[:, 0]
    own[:, 0, 2] = own[:, 1, 3] = 1.0
    return derivative.reshape(2 * count, size)
