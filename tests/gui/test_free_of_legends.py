"""What explains a drawing does not lie on it: the fitted picture keeps clear of legends and colour bars."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtWidgets import QApplication

from kirigami_studio.gui.session.overlays import USUAL, Overlay
from kirigami_studio.gui.stage.layout_view import LayoutView
from kirigami_studio.gui.widgets.canvas import Canvas
from kirigami_studio.gui.widgets.legends import AWAY, clear_box
from kirigami_studio.gui.widgets.view_transform import Bounds, ViewTransform
from kirigami_studio.gui.window.main_window import MainWindow

SIZES = ((1000, 640), (1280, 720), (1440, 900), (1920, 1080))
COLOURED = (frozenset(), frozenset({Overlay.RATIOS}), frozenset({Overlay.RATIOS, Overlay.OPENINGS}))


def drawn(view: LayoutView, phi: float) -> QRectF:
    """Pixels around sheet and target at an angle."""
    design, transform, target = view.design, view.transform(), view._target
    assert design is not None and transform is not None and target is not None
    points = transform.to_pixels(np.concatenate([design.nodes(phi), target.points]))
    (left, top), (right, bottom) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    return QRectF(QPointF(left, top), QPointF(right, bottom))


def legends(view: LayoutView) -> list[QRectF]:
    """Where the labels and bars of the last painted picture are."""
    metrics = view.fontMetrics()
    titles = [scale.title for scale in view.scales]
    return [box for _, box in view.legend(metrics)] + view.bar_boxes(titles)


def fill(window: MainWindow, size: tuple[int, int]) -> LayoutView:
    """A window in which the view is hardly higher than the design, with all its legends."""
    window.resize(*size)
    QApplication.processEvents()
    view = window.stage.view
    view.set_caption("")
    view.grab()
    return view


@pytest.mark.parametrize(("size", "more"), list(product(SIZES, COLOURED)))
def test_that_no_legend_lies_on_the_fitted_design(
    designed: MainWindow, size: tuple[int, int], more: frozenset[Overlay]
) -> None:
    view = fill(designed, size)
    view.set_overlays(USUAL | more)
    for phi in (0.0, 0.1, 1.5, math.pi):
        designed.stage.deployment.set_phi(phi)
        view.grab()
        boxes = legends(view)
        assert len(boxes) == (3 if phi < 0.2 else 0) + len(more)
        assert not any(box.intersects(drawn(view, phi)) for box in boxes)


def test_that_without_its_room_a_legend_would_lie_on_the_design(
    designed: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    view = fill(designed, (1440, 700))
    view.set_overlays(USUAL | {Overlay.RATIOS, Overlay.OPENINGS})
    monkeypatch.setattr(LayoutView, "scene_box", Canvas.scene_box)
    covered = []
    for phi in (0.0, math.pi):
        designed.stage.deployment.set_phi(phi)
        view.grab()
        covered += [box.intersects(drawn(view, phi)) for box in legends(view)]
    assert any(covered)


def test_that_the_picture_rests_while_legends_come_and_go_with_the_angle(designed: MainWindow) -> None:
    view = fill(designed, (1280, 720))
    frames = []
    for phi in (0.0, 0.1, 1.5, math.pi):
        designed.stage.deployment.set_phi(phi)
        view.grab()
        frames.append(view.transform())
    assert len(set(frames)) == 1


def test_that_a_plain_picture_shows_what_the_screen_shows(designed: MainWindow) -> None:
    view = fill(designed, (1440, 700))
    before = view.transform()
    with view.without_overlays():
        assert view.transform() == before


def test_that_both_sides_of_a_comparison_are_fitted_alike(designed: MainWindow) -> None:
    designed.resize(1440, 900)
    designed.commands["compare"].trigger()
    QApplication.processEvents()
    for overlays in (USUAL, USUAL | {Overlay.RATIOS}):
        designed.stage.compare.set_overlays(overlays)
        left, right = (pane.view for pane in designed.stage.compare.shown)
        assert left.scene_box() == right.scene_box()


def test_that_a_legend_takes_the_side_that_costs_the_picture_least() -> None:
    wide, tall = Bounds(0.0, 0.0, 4.0, 1.0), Bounds(0.0, 0.0, 1.0, 4.0)
    view = QRectF(0.0, 0.0, 600.0, 600.0)
    corner = QRectF(430.0, 10.0, 160.0, 60.0)
    assert clear_box(wide, view, 20.0, [corner]) == view  # nothing would be covered
    square = Bounds(0.0, 0.0, 1.0, 1.0)
    below = clear_box(square, view, 20.0, [corner])
    assert below.top() + 20.0 == pytest.approx(corner.bottom() + AWAY) and below.right() == view.right()
    narrow = QRectF(560.0, 10.0, 30.0, 500.0)
    beside = clear_box(square, view, 20.0, [narrow])
    assert beside.right() - 20.0 == pytest.approx(narrow.left() - AWAY) and beside.top() == view.top()
    assert clear_box(tall, QRectF(0, 0, 90, 90), 5.0, [QRectF(0, 30, 90, 60)]) == QRectF(0, 0, 90, 90)
    for bounds in (wide, tall, square):
        assert ViewTransform.fitting(bounds, clear_box(bounds, view, 20.0, [corner]), 20.0).scale > 0.0
