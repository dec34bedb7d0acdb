"""Changes by hand of a pinned design stop where its pins would come too near to each other, and say so."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from kirigami_studio.evaluate.pins import GAP_ROUNDING, least_pin_distance
from kirigami_studio.fabricate.material import Construction
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.stage.hand_editor import PINS_STOP_IT
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.project import store
from kirigami_studio.settings.fabrication import pin_sizes
from kirigami_studio.studio.designing import least_gap_of
from tests.pinned_assemblies import plain_pinwheel

Until = Callable[[Callable[[], bool]], None]


@pytest.fixture
def pinned(window: MainWindow, until: Until, tmp_path: Path) -> MainWindow:
    store.save(plain_pinwheel(), tmp_path / "square.kiri")
    window.services.project.open(tmp_path / "square.kiri")
    until(lambda: window.session.stage is not None)
    return window


def least(window: MainWindow) -> float:
    document = window.session.document
    assert document.candidate is not None
    return least_gap_of(document.fabrication, document.candidate.final_sheet)


def test_that_a_typed_ratio_goes_as_far_as_pins_allow_and_says_why(pinned: MainWindow, until: Until) -> None:
    hand, before = pinned.services.hand, pinned.session.document.candidate
    hand.set_ratio(frozenset({(1, 1)}), 1.0)
    assert tr(PINS_STOP_IT) in pinned.status_text.text()
    hand.commit()
    until(lambda: not hand.busy)
    after = pinned.session.document.candidate
    assert before is not None and after is not None and after is not before
    assert 1.0 < after.sheet.field.ratio[1, 1] < before.sheet.field.ratio[1, 1]
    distance, bound = least_pin_distance(deploy(after.sheet)), least(pinned)
    assert bound - 2 * GAP_ROUNDING <= distance < 1.02 * bound


def test_that_one_sheet_takes_the_same_ratio_as_it_is_typed(pinned: MainWindow, until: Until) -> None:
    pinned.services.fabrication.change(construction=Construction.ONE_SHEET)
    hand = pinned.services.hand
    hand.set_ratio(frozenset({(1, 1)}), 1.0)
    hand.commit()
    until(lambda: not hand.busy)
    candidate = pinned.session.document.candidate
    assert candidate is not None and candidate.sheet.field.ratio[1, 1] == 1.0


def test_that_an_edge_cut_stops_as_well(pinned: MainWindow, until: Until) -> None:
    hand, sheet = pinned.services.hand, pinned.session.document.candidates[0].sheet
    motion, sizes = deploy(sheet), pin_sizes(pinned.session.document.fabrication)
    own, wide = least_pin_distance(motion), float(np.ptp(motion.compact[:, 0]))
    # So narrow that pins have hardly more room than they need.
    pinned.services.fabrication.change(width_mm=2.0 * sizes.margin_mm + sizes.apart_mm * wide / (0.995 * own))
    bound = least(pinned)
    assert bound == pytest.approx(0.995 * own)
    stopped = []
    for mouth in range(4):
        for step in (-0.6, 0.6):
            hand.nudge_mouth(mouth, step)
            stopped.append(tr(PINS_STOP_IT) in pinned.status_text.text())
            kept = hand.sheet
            assert kept is not None and least_pin_distance(deploy(kept)) >= bound - 2 * GAP_ROUNDING
            hand.cancel()
    assert np.any(stopped)
