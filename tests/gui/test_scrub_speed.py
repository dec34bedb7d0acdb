"""How fast the layout is drawn while the slider moves: 24 x 24 voids, the usual overlays or all of them."""

from __future__ import annotations

import math
import time
from io import BytesIO

import numpy as np
import pytest
from machine_pace import window_slowness
from paint_counter import PaintCounter
from PIL import Image
from pytestqt.qtbot import QtBot

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.export.artwork import Artwork, Laid
from kirigami_studio.export.artwork_picture import picture_of
from kirigami_studio.gui.session.overlays import USUAL, Overlay
from kirigami_studio.gui.stage.artwork_painting import ShownArtwork, painting_artwork
from kirigami_studio.gui.stage.layout_view import LayoutView
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.outline import Outline

#: Milliseconds of processor time that a hand on the slider waits for a picture with everything shown.
LONGEST_MS = 100.0


def printed_sheet(design: PosedDesign, target: Outline) -> ShownArtwork:
    """A sheet printed with a picture of noise."""
    stream = BytesIO()
    Image.fromarray(np.random.default_rng(0).integers(0, 255, (300, 300, 3), dtype=np.uint8)).save(stream, "PNG")
    (shown,) = painting_artwork(
        Artwork(Laid(picture_of("noise.png", stream.getvalue()))), design, target, lambda: False
    )
    return shown


@pytest.mark.parametrize("printed", [False, True], ids=["plain panels", "artwork"])
@pytest.mark.parametrize("overlays", [USUAL, frozenset(Overlay)], ids=["usual overlays", "all overlays"])
@pytest.mark.parametrize(("first", "last"), [(math.pi, 0.3), (0.2, 0.0)], ids=["on the way", "near the target"])
def test_that_every_slider_step_is_drawn(
    qtbot: QtBot, first: float, last: float, overlays: frozenset[Overlay], printed: bool
) -> None:
    field = RatioField.from_log10(np.random.default_rng(1).normal(size=(24, 24)) * 0.05)
    deployment, target = deploy(field), silhouettes.load("heart")
    score = evaluate(deployment, target, 0.0)
    view = LayoutView()
    qtbot.addWidget(view)
    view.resize(800, 700)
    design = PosedDesign(deployment, score.transform, 0.0)
    view.show_design(design, score, target)
    if printed:
        overlays = overlays - {Overlay.RATIOS}  # colours of its own
        view.show_artwork(printed_sheet(design, target))
    view.set_overlays(overlays)
    with qtbot.waitExposed(view):
        view.show()
    painted: list[int] = []
    paints = PaintCounter(view)
    spent: list[float] = []
    slowness = window_slowness()
    for phi in np.linspace(first, last, 30).tolist():
        before, start = paints.count, time.thread_time()
        view.set_phi(phi)
        view.repaint()
        spent.append(1000.0 * (time.thread_time() - start))
        painted.append(paints.count - before)
    assert set(painted) == {1}
    assert np.median(spent) < LONGEST_MS * 0.5 * (slowness + window_slowness())
