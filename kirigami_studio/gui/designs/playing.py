"""How the deployment is played: where the sheet is at each phase of a swing."""

from __future__ import annotations

import math
from enum import Enum

#: Part of a whole swing during which playing rests at each end, to let the eye arrive.
REST = 0.08
#: How many times faster than usual the deployment may be played.
SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0)


class PlayMode(Enum):
    """What happens when the sheet has opened."""

    SWING = "swing"  #: it closes again
    LOOP = "loop"  #: it starts anew from the flat sheet
    ONCE = "once"  #: it stays


def phi_at(phase: float, mode: PlayMode = PlayMode.SWING, last: float = 0.0) -> float:
    """Angle (radians) at a phase (0..1): from pi to ``last``, and back when swinging, with a rest at both ends.

    A swing is open at phase 1/2, the others at 1.
    """
    there = 1.0 - abs(2.0 * (phase % 1.0) - 1.0) if mode is PlayMode.SWING else min(max(phase, 0.0), 1.0)
    eased = min(max((there - REST) / (1.0 - 2.0 * REST), 0.0), 1.0)
    return math.pi - eased * (math.pi - last)


def phase_of(phi: float, mode: PlayMode = PlayMode.SWING, last: float = 0.0) -> float:
    """Phase on the opening way that shows ``phi``; what lies past ``last`` counts as open."""
    opened = min((math.pi - phi) / (math.pi - last), 1.0)
    there = REST + (1.0 - 2.0 * REST) * opened
    return 0.5 * there if mode is PlayMode.SWING else there
