"""Backed designs in the window: both layers on the page of cuts, tiles on the stage, the second material."""

from __future__ import annotations

import math
from collections.abc import Callable

from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.settings.fabrication import BoardCut

Until = Callable[[Callable[[], bool]], None]


def test_that_a_backed_design_shows_both_layers_and_its_tiles_at_every_angle(
    designed: MainWindow, until: Until
) -> None:
    panel, cuts, view = designed.fabrication, designed.cuts, designed.stage.view
    assert not cuts.beds.isVisibleTo(cuts) and not panel.options.files.fields["second_material"].isEnabled()
    designed.services.fabrication.change(material="plywood-co2", construction="backed", width_mm=300.0)
    until(lambda: cuts.beds.isVisibleTo(cuts) and not designed.services.verdict.busy)
    assert cuts.view.isVisibleTo(cuts)
    verdict = designed.services.verdict.state.verdict
    assert verdict is not None and verdict.as_cut is not None
    assert "tiles" in panel.numbers["pieces"].text()
    assert panel.lengths["connector_mm"].value() == 2.0  # that of cotton
    for name in ("gap_mm", "second_material", "board_cut"):
        assert panel.options.files.fields[name].isEnabled()
    pictures = []
    for degrees in (180.0, 90.0):
        designed.stage.deployment.set_phi(math.radians(degrees))
        pictures.append(view.grab().toImage())
    view.show_tiles(None)
    assert pictures[1] != view.grab().toImage() and pictures[0] != pictures[1]
    designed.services.fabrication.change(board_cut=BoardCut.KISS, second_material="felt-co2")
    until(lambda: not designed.services.verdict.busy)
    assert designed.session.document.fabrication.second_material == "felt-co2"
    designed.services.fabrication.change(construction="one-sheet")
    until(lambda: not cuts.beds.isVisibleTo(cuts))
