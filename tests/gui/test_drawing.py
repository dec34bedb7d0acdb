"""The drawing code on its own: mapping, faults, differences, pictures, colours."""

from __future__ import annotations

import math

import numpy as np
import pytest
from contrast import contrast
from PySide6.QtCore import QPointF, QRectF, QSize
from PySide6.QtGui import QColor, QImage, QPainterPath, QPolygonF
from PySide6.QtWidgets import QApplication

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.gui.stage.fault_items import FaultKind, contact_place, faults, inverted_panels
from kirigami_studio.gui.stage.layout_items import candidate_pixmap, target_pixmap
from kirigami_studio.gui.widgets import icons, theme
from kirigami_studio.gui.widgets.mismatch_items import mismatch
from kirigami_studio.gui.widgets.paths import DOZEN, FEW, line_path, paths_of_quads
from kirigami_studio.gui.widgets.theme import DARK, LIGHT, PALETTES, Palette, style_sheet
from kirigami_studio.gui.widgets.view_transform import Bounds, ViewTransform
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.project.document import Document

SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])


@pytest.fixture
def posed(designs: Document) -> PosedDesign:
    candidate = designs.candidates[0]
    return PosedDesign(deploy(candidate.sheet.field), candidate.score.transform, 0.0)


@pytest.mark.parametrize("closed", [True, False])
@pytest.mark.parametrize("count", [0, 1, 3, FEW, FEW + 1, 200])
def test_that_a_line_has_its_points_whether_qt_reads_it_or_is_called_for_each(count: int, closed: bool) -> None:
    points = np.random.default_rng(count).normal(size=(count, 2))
    by_calls = QPainterPath()
    by_calls.addPolygon(QPolygonF([QPointF(*point) for point in points.tolist()]))
    if closed and count:
        by_calls.closeSubpath()
    assert line_path(points, closed) == by_calls


def test_that_dozens_of_quads_have_all_quads_and_fill_where_two_overlap() -> None:
    places = np.arange(DOZEN + 3)[:, None, None] * (2.0, 0.0)
    paths = paths_of_quads(SQUARE + places)
    assert [path.elementCount() for path in paths] == [5 * DOZEN, 15]
    assert all(any(path.contains(QPointF(x + 0.5, 0.5)) for path in paths) for x in range(0, 2 * DOZEN + 6, 2))
    (overlapping,) = paths_of_quads(np.stack([SQUARE, SQUARE[::-1] + 0.5]))  # one of them inverted
    assert overlapping.contains(QPointF(0.75, 0.75))


def test_that_a_frame_maps_there_and_back_with_y_up() -> None:
    transform = ViewTransform.fitting(Bounds(-1, -2, 3, 2), QRectF(0, 0, 400, 300), margin=10)
    x, y = transform.to_pixels(np.array([3.0, 2.0]))
    assert transform.to_world(QPointF(x, y)) == pytest.approx((3.0, 2.0))
    assert transform.to_pixels(np.array([0.0, 2.0]))[1] == pytest.approx(10)
    assert transform.to_pixels(np.array([0.0, -2.0]))[1] == pytest.approx(290)


def test_that_a_posed_design_lies_on_its_target_and_turns_about_its_middle(posed: PosedDesign) -> None:
    at_target = posed.nodes(0.0)
    assert at_target == pytest.approx(posed.pose.apply(posed.deployment.nodes(0.0)))
    for phi in (0.7, math.pi):
        assert posed.nodes(phi).mean(axis=0) == pytest.approx(at_target.mean(axis=0))
    box = Bounds.of(posed.extent())
    everywhere = np.concatenate([posed.nodes(phi) for phi in np.linspace(0, math.pi, 9)])
    assert everywhere[:, 0].min() >= box.left and everywhere[:, 1].max() <= box.top


def test_that_an_inverted_panel_is_found_and_marked_where_it_is(posed: PosedDesign) -> None:
    panels = posed.panels(posed.nodes(1.0)).copy()
    assert not inverted_panels(panels).any()
    panels[3] = panels[3, ::-1]
    wrong = inverted_panels(panels)
    assert np.flatnonzero(wrong).tolist() == [3]
    found = faults(panels, wrong, None)
    assert len(found) == 1 and found[0].kind is FaultKind.INVERTED
    assert found[0].where == pytest.approx(tuple(panels[3].mean(axis=0)))


def test_that_a_contact_is_marked_where_it_happens(posed: PosedDesign, designs: Document) -> None:
    from dataclasses import replace

    from kirigami_studio.evaluate.feasibility import Contact

    node = 17
    x, y = posed.deployment.nodes(0.9)[node]
    score = replace(designs.candidates[0].score, contact=Contact(0.9, (float(x), float(y))))
    assert contact_place(posed, score) == pytest.approx(posed.nodes(0.9)[node])
    assert contact_place(posed, designs.candidates[0].score) is None


def test_that_differences_are_shares_of_the_target() -> None:
    areas = mismatch(SQUARE, SQUARE * (1.0, 0.5) + (0.25, 0.0))
    assert areas.missing_share == pytest.approx(0.625)
    assert areas.extra_share == pytest.approx(0.125)
    bow = np.array([(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)])
    assert mismatch(SQUARE, bow).missing_share == pytest.approx(0.5)


def test_that_a_hole_is_missing_where_it_is_covered_and_open_where_panels_and_voids_went() -> None:
    hole = np.array([(0.25, 0.25), (0.75, 0.25), (0.75, 0.75), (0.25, 0.75)])
    assert mismatch((SQUARE, hole), SQUARE).extra_share == pytest.approx(0.25 / 0.75)
    left, right = hole * (0.4, 1.0) + (0.15, 0.0), hole * (0.4, 1.0) + (0.45, 0.0)
    void = np.array([[left[1], right[0], right[3], left[2]]])
    cut = [left, right]
    assert mismatch((SQUARE, hole), SQUARE, cut).extra_share == pytest.approx(0.05 / 0.75)
    areas = mismatch((SQUARE, hole), SQUARE, cut, void)
    assert areas.extra_share == pytest.approx(0.0, abs=1e-6) and areas.missing_share == pytest.approx(0.0, abs=1e-6)


def test_that_a_target_is_drawn_with_its_holes(qapp: QApplication) -> None:
    image = target_pixmap(load("ring"), QSize(80, 80), 1.0, LIGHT).toImage()
    assert image.pixelColor(40, 40).alpha() == 0 and image.pixelColor(12, 40).name() == LIGHT.target_fill


@pytest.mark.parametrize("ratio", [1.0, 2.0])
def test_that_a_thumbnail_is_sharp_and_shows_sheet_and_target(
    qapp: QApplication, posed: PosedDesign, designs: Document, ratio: float
) -> None:
    picture = candidate_pixmap(posed, designs.target, QSize(100, 80), ratio, LIGHT)
    assert (picture.width(), picture.height()) == (100 * ratio, 80 * ratio)
    image = picture.toImage().convertToFormat(QImage.Format.Format_ARGB32)
    seen = {image.pixelColor(x, y).name() for x in range(image.width()) for y in range(image.height())}
    assert {LIGHT.panel_even, LIGHT.panel_odd, LIGHT.target} <= seen


def test_that_a_thumbnail_shows_the_flat_sheet_upright_beside_the_sheet_over_its_target(
    qapp: QApplication, posed: PosedDesign, designs: Document
) -> None:
    image = candidate_pixmap(posed, designs.target, QSize(200, 112), 1.0, LIGHT).toImage()
    painted = np.array([[image.pixelColor(x, y).alpha() > 200 for x in range(115, 200)] for y in range(112)])
    rows, columns = np.flatnonzero(painted.any(axis=1)), np.flatnonzero(painted.any(axis=0))
    assert painted[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1].all()
    height, width = posed.deployment.sheet.rows + 1, posed.deployment.sheet.columns + 1
    assert rows.size / columns.size == pytest.approx(height / width, rel=0.05)


@pytest.mark.parametrize("palette", [LIGHT, DARK], ids=lambda palette: palette.name)
def test_that_text_is_readable_on_every_ground(palette: Palette) -> None:
    for ground in (palette.window, palette.surface, palette.raised, palette.canvas):
        assert contrast(palette.text, ground) > 7
        assert contrast(palette.muted, ground) > 4.5
    assert contrast(palette.on_accent, palette.accent) > 4.5
    assert contrast(palette.warning, palette.surface) > 4.5
    assert contrast(palette.accent, palette.surface) > 4.5
    for panel in (palette.panel_even, palette.panel_odd):
        assert contrast(palette.fault_line, palette.fault) > 7
        assert contrast(palette.extra, panel) > 1.5
    assert contrast(palette.target, palette.canvas) > 3


def test_that_every_command_has_its_icon_and_a_key_of_its_own(window: MainWindow) -> None:
    keys = [key for command in window.commands.records for key in command.shortcuts]
    assert len(keys) == len(set(keys))
    for command in window.commands.records:
        assert command.tip
        if command.icon:
            assert not icons.pixmap(command.icon, "#123456", 24).isNull()
    assert all("$" not in style_sheet(palette) for palette in PALETTES.values())


def test_that_another_palette_dresses_the_widgets_once(qapp: QApplication, monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[object] = []
    theme.apply(qapp, LIGHT)
    monkeypatch.setattr(QApplication, "setStyle", lambda *arguments: calls.append(arguments))
    for palette in (DARK, LIGHT):
        theme.apply(qapp, palette)
        assert qapp.palette().window().color() == QColor(palette.window)
        assert qapp.styleSheet() == style_sheet(palette)
    assert not calls
