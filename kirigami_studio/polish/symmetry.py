"""Symmetric set-ups of a fit: which symmetries target and lattice share, and how the target then has to lie."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

from kirigami_studio.foundation.errors import TargetError, UsageError
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.starts import RECTANGLE, StartShape
from kirigami_studio.outlines.symmetry import (
    AS_GOOD_AS_EXACT,
    LEAST_MEANT,
    TOLERANCE,
    MirrorAxis,
    different_axes,
    mirrored_mean,
    symmetry_of,
    turned_mean,
)
from kirigami_studio.polish.flat_sheet import can_have

#: A sketch has a second axis when both overlap this much.
BOTH_MEANT = 0.95


class KeptSymmetry(StrEnum):
    """Symmetry that designs have to keep; its values stand on the command line and in files."""

    AUTO = "auto"  #: the symmetries that the target shows within a tolerance
    NONE = "none"
    MIRROR = "mirror"  #: the axis that a rough sketch may have meant
    TURN = "turn"  #: the turn that it may have meant


@dataclass(frozen=True, slots=True)
class SymmetricPose:
    """A symmetry that a target and suitable lattices share, and how the target has to lie for it."""

    symmetry: Symmetry
    #: radians; direction in the target's frame that the sheet's upward direction must have, or the opposite one; None
    #: when any will do
    angle: float | None
    overlap: float = 1.0  #: IoU of the target and its worst image under the symmetry
    axes: tuple[MirrorAxis, ...] = ()  #: The target's axes that it uses: none for a turn, two for two mirrors

    def fits(self, grid: tuple[int, int], start: StartShape = RECTANGLE) -> bool:
        """Whether sheets of a grid and start can have it; one that has, has it at every angle of deployment."""
        return can_have(grid, start, self.symmetry)

    def is_part_of(self, other: SymmetricPose) -> bool:
        """Whether every sheet that keeps the other keeps this one too, and lies as freely."""
        part = set(self.symmetry.moves) < set(other.symmetry.moves)
        return part and (other.angle is None or self.angle is not None)


def shared_symmetries(
    target: Outline,
    grid: tuple[int, int],
    setting: KeptSymmetry = KeptSymmetry.AUTO,
    start: StartShape = RECTANGLE,
    *,
    pinned: bool = False,
) -> list[SymmetricPose]:
    """Symmetries of ``target`` that sheets of ``grid`` and ``start`` have too, at every angle, the most specific first.

    What is only a part of another one in the list is left out, unless it lets the sheet lie at other angles: beside two
    mirrors the half turn stays, with which a diamond may lie on its corner.  ``pinned`` sheets have turns alone.

    Raises
    ------
    TargetError
        A symmetry is asked for and the target is far from any.
    UsageError
        A symmetry is asked for that the grid or the start does not have.
    """
    found: list[SymmetricPose] = []
    for pose in symmetric_poses(target, setting, pinned=pinned):
        if pose.fits(grid, start) and not any(pose.is_part_of(other) for other in found):
            found.append(pose)
    if not found and setting in (KeptSymmetry.MIRROR, KeptSymmetry.TURN):
        rows, columns = grid
        if not start.is_plain:
            raise UsageError("symmetry.not_of_start", name=start.name, rows=rows, columns=columns, symmetry=setting)
        code = "symmetry.no_mirror_on_grid" if setting == KeptSymmetry.MIRROR else "symmetry.no_turn_on_grid"
        raise UsageError(code, rows=rows, columns=columns, more=columns + 1)
    return found


def symmetric_poses(
    target: Outline, setting: KeptSymmetry = KeptSymmetry.AUTO, *, pinned: bool = False
) -> tuple[SymmetricPose, ...]:
    """All symmetric set-ups that are worth trying for a target, the most specific first, whatever the grid.

    Axes that a turn of the target onto itself carries to each other count once: a star has one axis, a hexagon two
    (with a corner or a side up).

    Parameters
    ----------
    target : Outline
    setting : KeptSymmetry
        ``auto``: symmetries with an overlap of at least ``TOLERANCE``; ``mirror`` and ``turn``: the best axis or turn,
        if there is any that overlaps by ``LEAST_MEANT``; ``none``: nothing.
    pinned : bool
        Whether for sheets with pins, which a flip would turn into others: they have no mirrors.

    Raises
    ------
    TargetError
        A symmetry is asked for and the target is far from any.
    UsageError
        A mirror is asked for with pins.
    """
    poses: list[SymmetricPose] = []
    if pinned and setting == KeptSymmetry.MIRROR:
        raise UsageError("symmetry.no_mirror_with_pins")
    if setting in (KeptSymmetry.AUTO, KeptSymmetry.MIRROR) and not pinned:
        poses += _mirror_poses(target, forced=setting == KeptSymmetry.MIRROR)
    if setting in (KeptSymmetry.AUTO, KeptSymmetry.TURN):
        poses += _turn_poses(target, forced=setting == KeptSymmetry.TURN)
    return tuple(sorted(poses, key=lambda pose: -len(pose.symmetry.moves)))


def _mirror_poses(target: Outline, forced: bool) -> list[SymmetricPose]:
    found = symmetry_of(target)
    axes = found.mirrors(TOLERANCE)
    if forced and not axes:
        best = found.axes[0]
        if best.overlap < LEAST_MEANT:
            raise TargetError("symmetry.no_mirror_axis", percent=100.0 * best.overlap, least=100.0 * LEAST_MEANT)
        axes = (best, *(other for other in found.mirrors(BOTH_MEANT) if best.crosses(other)))
    different = different_axes(target, axes)
    poses = []
    for axis in different:
        crossing = next((other for other in axes if axis.crosses(other)), None)
        if crossing is not None:
            overlap = min(axis.overlap, crossing.overlap)
            poses.append(SymmetricPose(Symmetry.TWO_MIRRORS, axis.angle, overlap, (axis, crossing)))
    for axis in different:
        poses.append(SymmetricPose(Symmetry.LEFT_RIGHT, axis.angle, axis.overlap, (axis,)))
    for axis in different:
        upward = (axis.angle + 0.5 * math.pi) % math.pi
        poses.append(SymmetricPose(Symmetry.TOP_BOTTOM, upward, axis.overlap, (axis,)))
    return poses


def _turn_poses(target: Outline, forced: bool) -> list[SymmetricPose]:
    found = symmetry_of(target)
    quarter, half = min(found.quarter_turn, found.half_turn), found.half_turn
    if forced and half < LEAST_MEANT:
        raise TargetError("symmetry.no_turn", percent=100.0 * half, least=100.0 * LEAST_MEANT)
    least = LEAST_MEANT if forced and half < TOLERANCE else TOLERANCE
    poses = []
    if quarter >= (BOTH_MEANT if least < TOLERANCE else TOLERANCE):
        poses.append(SymmetricPose(Symmetry.QUARTER_TURN, None, quarter))
    if half >= least:
        poses.append(SymmetricPose(Symmetry.HALF_TURN, None, half))
    return poses


def symmetric_target(target: Outline, pose: SymmetricPose) -> Outline:
    """What a symmetric sheet should be fitted to: the target, or the mean of its images where it is only a sketch.

    Scores stay against the target itself.

    Raises
    ------
    TargetError
        The target and its images have nothing in common.
    """
    if pose.overlap >= AS_GOOD_AS_EXACT:
        return target
    match pose.symmetry:
        case Symmetry.HALF_TURN:
            return turned_mean(target)
        case Symmetry.QUARTER_TURN:
            return turned_mean(target, quarter=True)
        case _:
            return mirrored_mean(target, *pose.axes)
