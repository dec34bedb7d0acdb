"""Cuts that were planned lately are not planned again, whoever asks for them."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kirigami_studio.foundation.errors import Cancelled
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.project.document import Document
from kirigami_studio.studio.making import MOST_PLANS, CutRequest, planned


def request_of(document: Document, index: int, width_mm: float) -> CutRequest:
    """As the window makes it anew each time: nothing in it is the object of an earlier one but the design."""
    candidate = document.candidates[index]
    settings = replace(document.fabrication, width_mm=width_mm)
    return CutRequest(candidate, deploy(candidate.final_sheet), document.target, settings)


def test_that_a_design_that_is_chosen_again_has_its_cuts_at_once(designs: Document) -> None:
    first = planned(request_of(designs, 0, 91.0), lambda: False)
    other = planned(request_of(designs, 1, 91.0), lambda: False)
    # A plan that is not kept asks whether to go on.
    assert planned(request_of(designs, 0, 91.0), lambda: True) is first is not other


def test_that_other_settings_are_planned_anew_and_old_plans_are_dropped(designs: Document) -> None:
    widths = [60.0 + number for number in range(MOST_PLANS + 1)]
    first = planned(request_of(designs, 0, widths[0]), lambda: False)
    for width in widths[1:]:
        made = planned(request_of(designs, 0, width), lambda: False)
        assert made.plan.size_mm[0] == pytest.approx(width)
    with pytest.raises(Cancelled):
        planned(request_of(designs, 0, widths[0]), lambda: True)
    assert planned(request_of(designs, 0, widths[0]), lambda: False) is not first
