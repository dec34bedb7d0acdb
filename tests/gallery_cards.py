"""Cards for tests of the gallery."""

from __future__ import annotations

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.gui.session.session import Entry
from kirigami_studio.lattice.deployment import deploy


def decoded(candidate: Candidate) -> Entry:
    """The card of a candidate at its own angle."""
    return Entry(candidate, PosedDesign(deploy(candidate.sheet.field), candidate.score.transform, candidate.score.phi))
