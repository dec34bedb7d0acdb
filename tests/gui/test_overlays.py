"""What is drawn over the layout: in which colours, in which unit, and where it leads to."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import shapely
from PySide6.QtCore import QPoint, QSize, Qt
from PySide6.QtGui import QColor, QFontMetrics, QImage, QPainter
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from kirigami_studio.evaluate.feasibility import Contact
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.fabricate.panel_sizes import edges_of, necks_of, panels_in_mm, smallest_edge, smallest_neck
from kirigami_studio.gui.session.overlays import USUAL, Overlay
from kirigami_studio.gui.stage.fault_items import FaultKind, crossing_place
from kirigami_studio.gui.stage.layout_labels import heat_tiles, quad_areas, smallest_parts
from kirigami_studio.gui.stage.layout_view import FAULT_SENTENCES, LayoutView, numbered_fault
from kirigami_studio.gui.widgets.colour_scale import bar_boxes, opening_scale, paint_colour_bars, ratio_scale
from kirigami_studio.gui.widgets.legends import Chip, legend_boxes, paint_legend
from kirigami_studio.gui.widgets.mismatch_items import boundary_gap
from kirigami_studio.gui.widgets.theme import DARK, LIGHT, Palette
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.view_commands import OVERLAY_COMMANDS
from kirigami_studio.lattice.deployment import Deployment, deploy, rotate
from kirigami_studio.project.document import Document

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def posed(designs: Document) -> PosedDesign:
    candidate = designs.candidates[0]
    return PosedDesign(deploy(candidate.sheet.field), candidate.score.transform, 0.0)


def test_that_each_overlay_has_a_key_and_changes_the_picture(designed: MainWindow, qtbot: QtBot) -> None:
    designed.resize(1440, 900)
    stage, actions = designed.stage, designed.commands.actions
    stage.deployment.set_phi(0.05)  # near the target, and voids are open
    assert stage.view.overlays == USUAL
    for name, overlay in OVERLAY_COMMANDS.items():
        before = stage.view.grab().toImage()
        keys = actions[name].shortcut()[0]
        qtbot.keyClick(designed, keys.key(), keys.keyboardModifiers())
        assert (overlay in stage.view.overlays) == (overlay not in USUAL) == actions[name].isChecked()
        if overlay is not Overlay.FAULTS:  # there is none
            assert stage.view.grab().toImage() != before, name
        assert actions[name] in stage.overlay_menu.actions()
        qtbot.keyClick(designed, keys.key(), keys.keyboardModifiers())
        assert stage.view.grab().toImage() == before


def test_that_a_narrow_header_shows_whole_buttons_only(designed: MainWindow) -> None:
    for size in (QSize(1000, 640), QSize(1440, 900)):
        designed.resize(size)
        QApplication.processEvents()
        stage = designed.stage
        shown = [button for button in (*stage.toggles.values(), stage.overlays_button, stage.plots_switch, stage.whole)
                 if button.isVisible()]  # fmt: skip
        assert {stage.overlays_button, stage.plots_switch} <= set(shown)
        edges = sorted((button.geometry().left(), button.geometry().right()) for button in shown)
        assert all(right < left for (_, right), (left, _) in pairwise(edges))
        assert edges[-1][1] < stage.width()
        assert stage.title.geometry().right() < edges[0][0]


def test_that_lengths_follow_the_width_of_the_flat_sheet(designed: MainWindow) -> None:
    view, stage = designed.stage.view, designed.session.stage
    assert stage is not None
    corners = stage.design.deployment.compact
    across = np.ptp(stage.design.pose.apply(corners) @ _back(stage.design.pose.angle), axis=0)[0]
    assert view.mm_per_unit * across == pytest.approx(100.0)
    designed.services.fabrication.change(width_mm=250.0)
    assert view.mm_per_unit * across == pytest.approx(250.0)


def _back(angle: float) -> np.ndarray:
    """Turns row vectors by minus the angle."""
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def test_that_void_areas_make_up_the_sheet_in_mm2(posed: PosedDesign) -> None:
    mm2 = posed.mm_per_world(80.0) ** 2
    for phi in (0.4, 2.0):
        nodes = posed.nodes(phi)
        panels, voids = quad_areas(posed.panels(nodes)).sum() * mm2, quad_areas(posed.voids(nodes)).sum() * mm2
        cell = 80.0 / (posed.deployment.field.columns + 1)
        assert panels + voids == pytest.approx(posed.deployment.area(phi) * cell * cell)
        assert panels == pytest.approx(80.0 * 80.0 * 5 / 6)


def test_that_heat_tiles_cover_their_voids_and_each_other_nowhere(posed: PosedDesign) -> None:
    for phi in (0.0, 1.0, math.pi):
        nodes, field = posed.nodes(phi), posed.deployment.field
        tiles = heat_tiles(posed.panels(nodes), field.rows, field.columns)
        polygons = shapely.polygons(tiles.reshape(-1, 4, 2))
        assert shapely.is_valid(polygons).all()
        united = shapely.union_all(polygons, grid_size=1e-12)
        assert united.area == pytest.approx(shapely.area(polygons).sum(), rel=1e-6)
        middles = shapely.points(posed.voids(nodes).mean(axis=2).reshape(-1, 2))
        assert shapely.dwithin(polygons, middles, 1e-9).all()


@pytest.mark.parametrize("palette", [LIGHT, DARK], ids=lambda palette: palette.name)
def test_that_the_ratio_scale_is_even_on_both_sides_and_gets_stronger_outwards(palette: Palette) -> None:
    scale = ratio_scale(np.array([[0.5, 1.0], [1.3, 1.9]]), palette)
    assert scale.low == -scale.high == pytest.approx(-math.log10(2.0))
    assert [label for _, label in scale.ticks] == ["1/2", "1", "2"]
    shades = scale.shades(np.linspace(scale.low, scale.high, 9))
    ground = QColor(palette.canvas).lightnessF()
    away = [abs(shade.lightnessF() - ground) for shade in shades]
    assert away[4] == min(away) and away[0] > away[2] > away[4] < away[6] < away[8]
    assert shades[0].blueF() > shades[0].redF() and shades[8].redF() > shades[8].blueF()


def test_that_the_greatest_distance_of_two_squares_is_where_they_differ_most() -> None:
    square = shapely.box(0, 0, 1, 1)
    moved = boundary_gap(square, shapely.box(0.1, 0, 1.1, 1))
    assert moved.greatest == pytest.approx(0.1)
    assert np.linalg.norm(moved.ends[1] - moved.ends[0]) == pytest.approx(0.1)
    spike = shapely.Polygon([(0, 0), (1, 0), (1, 1), (0.5, 1.8), (0.49, 1), (0, 1)])
    assert boundary_gap(square, spike).greatest == pytest.approx(0.8)
    assert boundary_gap(square, spike).ends[0] == pytest.approx([0.5, 1.8])
    assert boundary_gap(square, square).mean == 0.0


def test_that_the_mean_distance_agrees_with_a_dense_search(designed: MainWindow) -> None:
    view, stage = designed.stage.view, designed.session.stage
    view.grab()
    assert view.areas is not None and stage is not None and designed.session.document.target is not None
    sheet = shapely.Polygon(stage.design.outline(stage.design.nodes(0.0), 0.0)).exterior
    target = shapely.Polygon(designed.session.document.target.points).exterior
    dense = [
        shapely.distance(shapely.line_interpolate_point(one, np.linspace(0, 1, 20_000), normalized=True), other)
        for one, other in ((sheet, target), (target, sheet))
    ]
    assert view.areas.gap.mean == pytest.approx(0.5 * (dense[0].mean() + dense[1].mean()), rel=0.02)
    assert view.areas.gap.greatest == pytest.approx(max(dense[0].max(), dense[1].max()), rel=1e-3)


def test_that_the_smallest_parts_are_those_of_the_cut_plan(designed: MainWindow) -> None:
    view, stage = designed.stage.view, designed.session.stage
    assert stage is not None
    sheet = stage.design.deployment
    kept: list[None] = [None] * sheet.topology.panel_nodes[..., 0].size
    panels = panels_in_mm(sheet, kept, 100.0, np.zeros(2))
    edge, neck = smallest_edge(panels, 0.0), smallest_neck(panels, 0.0)
    assert edge is not None and neck is not None
    parts = smallest_parts(stage.design.panels(stage.design.nodes(stage.design.phi_target)))
    sizes = [part.size * view.mm_per_unit for part in parts]
    assert sizes[0] == pytest.approx(min(edge.size_mm, neck.size_mm))
    assert sizes == sorted(sizes) and len({part.panel for part in parts}) == len(sizes)
    for phi in (0.0, 1.1, math.pi):
        quads = stage.design.panels(stage.design.nodes(phi))
        for part in parts:
            ends = part.ends(quads)
            assert np.linalg.norm(ends[1] - ends[0]) == pytest.approx(part.size)
    quads = np.array(panels)
    assert edges_of(quads).sizes.min() >= neck.size_mm - 1e-9 and necks_of(quads).sizes.min() == neck.size_mm


def test_that_a_fault_is_brought_to_the_middle_by_key_and_by_click(designed: MainWindow, qtbot: QtBot) -> None:
    stage, entry = designed.stage, designed.session.stage
    assert entry is not None
    score = entry.candidate.score
    place = tuple(entry.design.deployment.nodes(0.9)[7].tolist())
    score = replace(score, contact=Contact(0.9, place))
    stage.view.show_design(entry.design, score, designed.session.document.target)
    qtbot.keyClick(designed, Qt.Key.Key_F3)
    assert stage.view.phi == pytest.approx(0.9, abs=math.radians(0.051))
    transform = stage.view.transform()
    assert transform is not None
    there = transform.to_pixels(np.array(stage.view.find_faults()[0].where))
    middle = stage.view.scene_box().center()  # beside the legends
    assert there == pytest.approx([middle.x(), middle.y()], abs=1.0)
    assert "1 of 1" in designed.status_text.text() and "contact" in designed.status_text.text()
    stage.fit()
    stage.view.grab()
    transform = stage.view.transform()
    assert transform is not None
    spot = transform.to_pixels(np.array(stage.view.faults[0].where)).round().astype(int).tolist()
    qtbot.mouseClick(stage.view, LEFT, pos=QPoint(*spot))
    zoomed = stage.view.transform()
    assert zoomed is not None and zoomed.scale > 3 * transform.scale


def test_that_a_design_without_faults_says_so(designed: MainWindow, qtbot: QtBot) -> None:
    designed.commands["next_fault"].trigger()
    assert designed.status_text.text().startswith("No faults")


def test_that_an_overlap_is_marked_where_it_is_at_the_angle_that_is_shown(posed: PosedDesign) -> None:
    sheet = posed.deployment
    assert crossing_place(posed, 1.0) is None
    corner, nodes = sheet.topology.outline_nodes[2], sheet.nodes(1.0)
    folded = sheet.even_part.copy()
    through = 2.5 * (nodes.mean(axis=0) - nodes[corner])  # this corner reaches through the sheet
    folded[corner] += rotate(through, 0.5 * (math.pi - 1.0))
    broken = replace(posed, deployment=Deployment(sheet.sheet, sheet.compact, folded, sheet.odd_part))
    where = crossing_place(broken, 1.0)
    assert where is not None
    outline = shapely.LinearRing(broken.outline(broken.nodes(1.0), 1.0))
    assert not outline.is_simple and outline.distance(shapely.Point(where)) < 1e-9


def test_that_numbers_are_written_only_where_they_fit(qtbot: QtBot, posed: PosedDesign) -> None:
    pictures = {}
    for edge in (60, 900):
        view = LayoutView()
        qtbot.addWidget(view)
        view.resize(edge, edge)
        view.show_design(posed, None, None)
        view.set_phi(1.5)
        for overlays in (frozenset[Overlay](), frozenset({Overlay.PANEL_NUMBERS, Overlay.VOID_NUMBERS})):
            view.set_overlays(overlays)
            pictures[edge, bool(overlays)] = view.grab().toImage()
    assert pictures[60, True] == pictures[60, False]
    assert pictures[900, True] != pictures[900, False]


def test_that_no_fault_kind_is_without_words() -> None:
    assert len({numbered_fault(kind, 1, 2) for kind in FaultKind}) == len(FAULT_SENTENCES) == len(FaultKind)


def test_that_labels_and_colour_bars_stay_inside_a_narrow_view(qtbot: QtBot) -> None:
    width = 150
    picture = QImage(width, 200, QImage.Format.Format_RGB32)
    picture.fill(0xFFFF00FF)
    painter = QPainter(picture)
    chips = [Chip((LIGHT.text,), "off by 0.18 mm (max 2.06 mm)"), Chip((LIGHT.extra,), "extra")]
    boxes = legend_boxes(chips, QFontMetrics(painter.font()), width, 200.0)
    assert all(box.left() > 0 and box.right() < width for box in boxes)
    paint_legend(painter, chips, boxes, LIGHT)
    scale = opening_scale(218.0, LIGHT)
    paint_colour_bars(painter, [scale], bar_boxes([scale.title], painter.fontMetrics(), width - 10.0, 10.0), LIGHT)
    painter.end()
    for edge in (0, 1, width - 2, width - 1):
        assert {picture.pixel(edge, y) for y in range(200)} == {0xFFFF00FF}, "something reaches over the edge"
