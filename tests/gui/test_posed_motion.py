"""One motion: the panels on the screen, in a picture and in every frame of the animation are the same numbers."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QSize
from PySide6.QtGui import QPainter, QPixmap
from pytestqt.qtbot import QtBot

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.trimming import trim
from kirigami_studio.export import animation, picture
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.gui.session.session import DesignCache
from kirigami_studio.gui.stage import layout_view
from kirigami_studio.gui.stage.layout_view import LayoutView
from kirigami_studio.gui.widgets.view_transform import ViewTransform
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.project.document import Document

FRAMES = 6


def on_screen(
    view: LayoutView, phi: float, transform: ViewTransform, monkeypatch: pytest.MonkeyPatch
) -> list[FloatArray]:
    """Panels (P, 2) that the layout view paints at an angle, in the target's frame."""
    painted: list[FloatArray] = []

    def watch(_painter: object, panels: FloatArray, *_rest: object) -> None:
        painted.extend(panels)
        kept = _rest[-1]
        assert isinstance(kept, dict)
        for row, part in kept.items():
            painted[row] = part

    pixmap = QPixmap(QSize(400, 400))
    painter = QPainter(pixmap)
    with monkeypatch.context() as patch:
        patch.setattr(layout_view, "paint_panels", watch)
        view.set_phi(phi)
        view.paint_scene(painter, transform)
    painter.end()
    return [(part - transform.origin) / (transform.scale, -transform.scale) for part in painted]


def in_files(job: ExportJob, monkeypatch: pytest.MonkeyPatch) -> tuple[list[list[FloatArray]], list[FloatArray]]:
    """Panels of all frames of the animation, and those of the picture."""
    drawn: list[list[FloatArray]] = []
    draw = animation.draw_polygons

    def watch(polygons: list[FloatArray], *rest: object) -> object:
        drawn.append(polygons)
        return draw(polygons, *rest)  # type: ignore[arg-type]

    with monkeypatch.context() as patch:
        patch.setattr(animation, "draw_polygons", watch)
        patch.setattr(picture, "draw_polygons", watch)
        list(animation.animation_frames(job, FRAMES, 60))
        picture.preview(job, 60)
    return drawn[:-1], drawn[-1]


@pytest.fixture(params=["whole", "trimmed"])
def candidate(request: pytest.FixtureRequest, designs: Document) -> Candidate:
    first, target = designs.candidates[0], designs.target
    if request.param == "whole":
        return first
    assert target is not None
    score = first.score
    return replace(first, trim=trim(deploy(first.sheet.field), target, score.phi, score.transform))


def test_that_screen_picture_and_animation_show_the_same_panels_at_every_angle(
    candidate: Candidate, designs: Document, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert designs.target is not None
    view = LayoutView()
    qtbot.addWidget(view)
    view.resize(400, 400)
    view.show_design(DesignCache().entry(candidate).design, candidate.score, designs.target)
    transform = ViewTransform(256.0, (128.0, 64.0))
    job = ExportJob.of(candidate, designs.target.points)
    frames, still = in_files(job, monkeypatch)
    angles = [*animation.frame_angles(job.phi, FRAMES).tolist(), job.phi]
    assert angles[0] == math.pi and len(frames) == FRAMES
    for phi, panels in zip(angles, [*frames, still], strict=True):
        shown = on_screen(view, phi, transform, monkeypatch)
        assert len(shown) == len(panels)
        for part, expected in zip(shown, panels, strict=True):
            np.testing.assert_allclose(part, expected, rtol=0, atol=1e-12)
