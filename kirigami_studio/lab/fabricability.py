"""Whether sheets can be made, by their flat layouts: milliseconds, no planned cuts.

For judging many designs at once, as generators are trained and compared.  ``verdict`` has the whole answer for one.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from kirigami_studio.evaluate.evenness import evenness_of_many
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.settings.fabrication import FabricationSettings, material_for
from kirigami_studio.studio.as_cut import estimate
from kirigami_studio.studio.cutting import least_feature_mm

#: What generators are judged by: polypropylene on a sheet of 100 mm with connectors of 1 mm.  Film with connectors of
#: 0.2 mm lets every design of 10 x 10 voids close, acrylic lets none.
TRIAL = FabricationSettings(material="polypropylene-co2", width_mm=100.0)
#: A sheet that comes within this of being closed shows its target (radians).
CLOSES_WITHIN = math.radians(10.0)
#: Largest coefficient of variation of panel areas that still looks even.
EVEN = 0.6


@dataclass(frozen=True, slots=True)
class Fabricability:
    """Measures of a sheet that is to be cut.

    Attributes
    ----------
    area_cv : float
        Coefficient of variation of the panels' areas.
    least_mm, needed_mm : float
        The shortest edge or narrowest neck between centre lines of cuts, and the least that the material allows.
    jam_phi : float, radians
        Estimated angle at which it jams on the way to phi = 0; 0 where it closes, pi where connectors do not fit.
    """

    area_cv: float
    least_mm: float
    needed_mm: float
    jam_phi: float

    @property
    def cuttable(self) -> bool:
        """Whether every panel is as large as the material needs."""
        return self.least_mm >= self.needed_mm

    @property
    def closes(self) -> bool:
        """Whether it comes within 10 degrees of phi = 0."""
        return self.jam_phi <= CLOSES_WITHIN

    @property
    def even(self) -> bool:
        """Whether its panels are much of a size."""
        return self.area_cv <= EVEN


def fabricability(sheets: Sequence[Deployment], settings: FabricationSettings = TRIAL) -> list[Fabricability]:
    """Measures of sheets of one grid that are cut by the same settings.

    Raises
    ------
    FabricationError
        No such material.
    """
    material, needed = material_for(settings), least_feature_mm(settings)
    found = []
    for sheet, even in zip(sheets, evenness_of_many(sheets), strict=True):
        try:
            jam = estimate(sheet, settings, 0.0, material).jam_phi
        except KirigamiError:
            jam = math.pi  # panels too small for the connectors
        found.append(Fabricability(even.area_cv, even.least_feature_mm(settings.width_mm), needed, jam))
    return found
