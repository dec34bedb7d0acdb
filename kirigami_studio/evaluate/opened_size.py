"""Size of the target on an opened sheet, beside the size that it was drawn in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.outlines.outline import Outline

#: Sizes this near (relative) are one size: a hundredth of a millimetre in 100.
SAME_SIZE = 1e-4


@dataclass(frozen=True, slots=True)
class OpenedSize:
    """The target as an opened sheet shows it, and as it was drawn."""

    #: (width, height), mm; of the target in its own orientation, at the scale at which the opened sheet fits it best.
    opened: tuple[float, float]
    drawn: tuple[float, float] | None  #: (width, height), mm; its real size; None when its source has none in mm.

    @classmethod
    def of(cls, target: Outline, flat: float, width_mm: float) -> OpenedSize:
        """That of a sheet ``width_mm`` wide, ``flat`` wide where the target has area 1.

        Raises
        ------
        UsageError
            A width that is not above 0.
        """
        if not width_mm > 0:
            raise UsageError("opened_size.width_not_positive", width_mm=width_mm)
        width, height = np.ptp(target.points, axis=0).tolist()
        unit = width_mm / flat
        return cls((unit * width, unit * height), target.size if target.unit == "mm" else None)

    @property
    def agrees(self) -> bool:
        """Whether the opened sheet has the drawn size."""
        return self.drawn is not None and abs(self.opened[0] / self.drawn[0] - 1.0) <= SAME_SIZE


def opened_size(deployment: Deployment, pose: Similarity, target: Outline, width_mm: float) -> OpenedSize:
    """Compare the opened sheet with the target as drawn.

    Parameters
    ----------
    pose : Similarity
        Layout frame at the target angle (unit cells) -> target frame (area 1), as a score or a trim has it.

    Raises
    ------
    UsageError
        A width that is not above 0.
    """
    # Panels are rigid: a cell of the flat sheet has the same length in the opened one.
    return OpenedSize.of(target, float(np.ptp(deployment.compact[:, 0])) * pose.scale, width_mm)
