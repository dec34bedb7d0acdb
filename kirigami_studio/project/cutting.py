"""From a finished design and its fabrication settings to the cut plan: the one way for window and command line."""

from __future__ import annotations

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.fabricate.cut_plan import CutPlan, plan_cuts
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.project.material_record import material_for
from kirigami_studio.project.settings import FabricationSettings


def plan_of(candidate: Candidate, settings: FabricationSettings, deployment: Deployment | None = None) -> CutPlan:
    """Plan the cuts of a design; a trimmed one gets its trimmed outline.

    Parameters
    ----------
    candidate : Candidate
    settings : FabricationSettings
    deployment : Deployment, optional
        Of the finished field, if it is known already: that of the trim, if the candidate is trimmed.

    Raises
    ------
    FabricationError
        No such material, or a plan that cannot be made.
    """
    trim = candidate.trim
    return plan_cuts(
        deployment or deploy(candidate.final_field),
        width_mm=settings.width_mm,
        connector_mm=settings.connector_mm,
        kerf_mm=settings.kerf_mm,
        material=material_for(settings),
        options=settings.options,
        kept=None if trim is None else trim.kept,
    )
