"""When each cut of a plan is done, for playing the job back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kirigami_studio.fabricate import timing
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.foundation.arrays import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class CutSteps:
    """The job as a row of steps: after step s the first s paths are cut.

    Attributes
    ----------
    seconds : (P + 1,) float
        From the start of the job until a step is done; 0 first, ascending.
    length_mm : (P + 1,) float
        Cut length so far.
    """

    seconds: FloatArray
    length_mm: FloatArray

    def __post_init__(self) -> None:
        self.seconds.setflags(write=False)
        self.length_mm.setflags(write=False)

    @property
    def last(self) -> int:
        """The step after which everything is cut."""
        return len(self.seconds) - 1

    def at(self, seconds: float) -> int:
        """The step under way after so many seconds: its path is being reached or cut."""
        return min(int(np.searchsorted(self.seconds, seconds, side="right")), self.last)


def cut_steps(plan: CutPlan) -> CutSteps:
    """Return the steps of a plan, with the time model of the plan.

    What the model adds per job is shared out among the paths by their time, so that the last step ends when the
    plan's estimate does.
    """
    material = plan.material
    acceleration = material.acceleration_mm_s2
    runs = [timing.run_lengths(path, timing.FLOWING_TURN) for path in plan.paths]
    cutting = [timing.run_seconds(lengths, material.speed_mm_s, acceleration).sum() for lengths in runs]
    moving = timing.run_seconds(timing.travel_lengths(plan.paths), material.travel_mm_s, acceleration)
    seconds = np.concatenate([[0.0], np.cumsum(np.array(cutting) + moving)])
    if seconds[-1] > 0.0:
        seconds = seconds * (plan.seconds_estimate / seconds[-1])
    return CutSteps(seconds, np.concatenate([[0.0], np.cumsum([path.length for path in plan.paths])]))
