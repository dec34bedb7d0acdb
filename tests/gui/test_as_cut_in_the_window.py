"""The chosen design as cut: closed in the worker; the slider stops where it jams, connectors show their stretch."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QModelIndex, QPoint, Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from kirigami_studio.fabricate.cut_plan import Layer
from kirigami_studio.fabricate.options import ConnectorStyle
from kirigami_studio.gui.gallery.gallery_model import VERDICT_ROLE
from kirigami_studio.gui.session.overlays import Overlay
from kirigami_studio.gui.stage.gripping import grip_places
from kirigami_studio.gui.stage.phi_slider import MarkKind, PhiSlider, TrackPart, track_parts, value_at
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.studio.as_cut import Source
from kirigami_studio.studio.making import planned

LEFT = Qt.MouseButton.LeftButton
Until = Callable[[Callable[[], bool]], None]
JAM = math.radians(40.0)


@pytest.fixture
def closed(designed: MainWindow, until: Until) -> MainWindow:
    """A studio whose chosen design was closed on its connectors."""
    until(lambda: designed.services.as_cut.state.sheet is not None)
    return designed


@pytest.fixture
def jammed(closed: MainWindow, until: Until) -> MainWindow:
    """The same with straight connectors that are too wide."""
    options = replace(closed.session.document.fabrication.options, style=ConnectorStyle.STRAIGHT)
    closed.services.fabrication.change(connector_mm=2.0, options=options)
    until(lambda: closed.stage.deployment.slider.jam is not None)
    return closed


@pytest.fixture
def slider(qtbot: QtBot) -> PhiSlider:
    made = PhiSlider()
    qtbot.addWidget(made)
    made.resize(600, 50)
    made.set_jam(JAM)
    with qtbot.waitExposed(made):
        made.show()
    return made


def pixel(slider: PhiSlider, phi: float) -> QPoint:
    return QPoint(round(14 + (slider.width() - 28) * (1 - phi / math.pi)), 15)


def test_that_a_sheet_which_closes_says_so_and_has_no_mark(closed: MainWindow) -> None:
    stage = closed.stage
    assert stage.as_cut.text().startswith("Closes as cut: ")
    assert "Largest stretch" in stage.as_cut.toolTip() and "bends out of the plane" in stage.as_cut.toolTip()
    assert stage.deployment.slider.jam is None and not stage.deployment.ideal.isVisible()
    assert not closed.commands["ideal"].isEnabled()


def test_that_other_connectors_are_closed_anew_and_known_ones_at_once(jammed: MainWindow, until: Until) -> None:
    stage, reader = jammed.stage, jammed.services.as_cut
    assert stage.as_cut.text().startswith("Jams at ") and stage.deployment.ideal.isVisible()
    assert jammed.commands["ideal"].isEnabled()
    jammed.commands["undo"].trigger()
    assert stage.deployment.slider.jam is None and reader.state.busy
    assert stage.as_cut.text() == "Closing the sheet as cut …"
    until(lambda: not reader.state.busy)
    assert stage.as_cut.text().startswith("Closes as cut: ") and not reader.busy


@pytest.mark.parametrize("name", ["closed", "jammed"])
def test_that_missing_and_extra_area_agree_with_the_match_as_cut(name: str, request: pytest.FixtureRequest) -> None:
    window: MainWindow = request.getfixturevalue(name)
    view, sheet = window.stage.view, window.services.as_cut.state.sheet
    assert sheet is not None and sheet.as_cut.iou is not None
    window.stage.deployment.set_phi(sheet.as_cut.phi)  # a sheet that jams is drawn where it does
    view.grab()
    assert view.areas is not None
    found = (1.0 - view.areas.missing_share) / (1.0 + view.areas.extra_share)
    assert found == pytest.approx(sheet.as_cut.iou, abs=1e-6)


def test_that_other_files_are_no_reason_to_close_the_sheet_again(closed: MainWindow, until: Until) -> None:
    reader = closed.services.as_cut
    before = reader.state.sheet
    closed.services.fabrication.change(profile="lightburn")
    until(lambda: not reader.state.busy)
    assert reader.state.sheet is before


def test_that_another_choice_stops_the_work_on_the_one_before(closed: MainWindow, until: Until) -> None:
    services = closed.services
    first = services.session.document.candidates[0]
    other = next(one for one in services.session.document.candidates if one != services.session.document.candidate)
    services.chosen.choose(other)
    assert services.as_cut.state.sheet is None
    services.chosen.choose(first)
    until(lambda: services.as_cut.state.sheet is not None)
    assert services.session.stage is not None and services.session.stage.candidate == first


def test_that_a_drag_stops_at_the_jam_and_ideal_goes_on(slider: PhiSlider) -> None:
    QTest.mousePress(slider, LEFT, pos=pixel(slider, 2.0))
    QTest.mouseMove(slider, pixel(slider, 0.2))
    assert slider.phi == pytest.approx(JAM)
    QTest.mouseRelease(slider, LEFT, pos=pixel(slider, 0.2))
    slider.set_ideal(True)
    QTest.mousePress(slider, LEFT, pos=pixel(slider, 0.2))
    QTest.mouseRelease(slider, LEFT, pos=pixel(slider, 0.2))
    assert slider.phi == pytest.approx(0.2, abs=0.02)
    # Beyond the jam already: it moves there, and back.
    slider.set_ideal(False)
    QTest.mousePress(slider, LEFT, pos=pixel(slider, 0.1))
    QTest.mouseRelease(slider, LEFT, pos=pixel(slider, 0.1))
    assert slider.phi == pytest.approx(0.1, abs=0.02)


def test_that_keys_stop_at_the_jam_and_programs_do_not(slider: PhiSlider) -> None:
    slider.set_phi(JAM + math.radians(4.0))
    QTest.keyClick(slider, Qt.Key.Key_Right)
    assert slider.phi == pytest.approx(JAM + math.radians(3.0))
    for key in (Qt.Key.Key_PageUp, Qt.Key.Key_End, Qt.Key.Key_Right):
        QTest.keyClick(slider, key)
        assert slider.phi == pytest.approx(JAM), key
    slider.set_phi(0.0)
    assert slider.phi == 0.0


def test_that_the_track_says_where_it_jams(slider: PhiSlider) -> None:
    parts = track_parts(0.0, None, JAM)
    assert parts == ((TrackPart.FREE, math.pi, JAM), (TrackPart.JAMMED, JAM, 0.0))
    assert [kind for kind, _, _ in track_parts(0.2, 1.0, JAM)] == [
        TrackPart.FREE,
        TrackPart.CONTACT,
        TrackPart.JAMMED,
        TrackPart.PAST,
    ]
    assert [kind for kind, _, _ in track_parts(0.2, 0.5, JAM)] == [TrackPart.FREE, TrackPart.JAMMED, TrackPart.PAST]
    assert [mark.words for mark in slider.marks() if mark.kind is MarkKind.JAM] == ["40° jams"]
    assert slider.marks()[0].kind is MarkKind.TARGET  # where both have no room, the target's words stay
    assert "Jams at 40.0° as cut" in slider.toolTip()
    assert slider.stopped(1800) == value_at(JAM)


def test_that_the_flat_sheet_is_drawn_with_all_cuts_of_its_plan_and_the_switch_shows_the_ideal_one(
    closed: MainWindow,
) -> None:
    view, bar = closed.stage.view, closed.stage.deployment
    bar.set_phi(math.pi)
    pose, design = view.shown_as_cut, view.design
    assert pose is not None and design is not None and bar.as_cut_button.isVisibleTo(closed)
    request = closed.services.cutting.request
    assert request is not None
    plan = planned(request).plan
    mm = design.mm_per_world(plan.size_mm[0])
    cut = sum(float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum()) for line in pose.cuts) * mm
    # Every cut is an edge of two panels, the outline of one; edge cuts begin a little outside.
    outline = sum(path.length for path in plan.on_layer(Layer.OUTLINE))
    over = len(plan.on_layer(Layer.EDGE_SLITS)) * plan.overcut_mm
    assert cut == pytest.approx(2.0 * (plan.cut_length_mm - outline - over) + outline, rel=5e-4)
    as_cut = view.grab().toImage()
    closed.commands["as_cut"].trigger()
    assert view.shown_as_cut is None and not bar.as_cut.isChecked() and view.grab().toImage() != as_cut
    closed.commands["as_cut"].trigger()
    assert view.grab().toImage() == as_cut


def test_that_the_sheet_as_cut_is_drawn_at_every_angle_up_to_its_jam(jammed: MainWindow) -> None:
    view, bar, sheet = jammed.stage.view, jammed.stage.deployment, jammed.services.as_cut.state.sheet
    assert sheet is not None
    jam = sheet.as_cut.reached
    before = None
    for phi in np.linspace(math.pi, jam, 7).tolist():
        bar.set_phi(phi)
        pose = view.shown_as_cut
        assert pose is not None and pose.phi == pytest.approx(phi, abs=1e-3)
        assert before is None or not np.allclose(pose.nodes, before.nodes)
        before = pose
    bar.set_phi(0.5 * jam)
    view.grab()
    assert view.shown_as_cut is not None and view.shown_as_cut.phi == pytest.approx(jam)
    said = [chip.text for chip, _ in view.legend(view.fontMetrics())]
    assert f"as cut, stopped at {math.degrees(jam):.0f}°" in said
    jammed.commands["ideal"].trigger()
    assert view.shown_as_cut is None
    bar.set_phi(jam)
    assert view.shown_as_cut is not None


def test_that_the_sample_and_a_draft_are_drawn_in_their_ideal_motion(closed: MainWindow, until: Until) -> None:
    view = closed.stage.view
    assert view.shown_as_cut is not None
    closed.commands["hand"].trigger()
    closed.services.hand.nudge(frozenset({(1, 1)}), 0.2)
    assert view.shown_as_cut is None
    until(lambda: view.shown_as_cut is not None)


def test_that_connectors_show_their_stretch(jammed: MainWindow) -> None:
    view = jammed.stage.view
    plain = view.grab().toImage()
    jammed.commands["show_stretch"].trigger()
    assert Overlay.STRETCH in view.overlays
    jammed.stage.deployment.set_phi(math.pi)
    view.grab()
    assert view.overstretched == 0
    assert [scale.title for scale in view.scales] == ["connector stretch, widths"]
    jammed.stage.deployment.set_phi(0.0)
    shown = view.grab().toImage()
    sheet = jammed.services.as_cut.state.sheet
    assert sheet is not None and view.overstretched == int((sheet.stretch_at(0.0) > 0.45).sum())
    assert shown != plain


def test_that_nothing_is_said_of_a_sheet_that_is_edited(closed: MainWindow, until: Until) -> None:
    closed.commands["hand"].trigger()
    closed.services.hand.nudge(frozenset({(1, 1)}), 0.2)
    assert closed.services.as_cut.state.sheet is None and closed.stage.as_cut.text() == ""
    until(lambda: closed.services.as_cut.state.sheet is not None)


def test_that_force_and_energy_are_plotted(jammed: MainWindow, until: Until) -> None:
    plots = jammed.stage.plots
    jammed.resize(1440, 900)
    jammed.commands["plots"].trigger()
    until(lambda: plots.complete)
    sheet = jammed.services.as_cut.state.sheet
    assert sheet is not None
    force, energy = plots.cut_charts
    degrees, values = energy.curves[0].getData()
    assert values == pytest.approx(sheet.closing.path.energy) and degrees[0] == pytest.approx(180.0)
    assert force.curves[0].getData()[1][-1] > 0.0
    assert force.isVisible() and energy.isVisible()
    jammed.services.as_cut.forget()
    assert not force.isVisible() and not energy.isVisible() and plots.charts[0].isVisible()


def closing(row: QModelIndex) -> bool:
    found = row.data(VERDICT_ROLE).as_cut
    return found is None or bool(found.closes)


def test_that_every_card_tells_whether_the_design_closes(closed: MainWindow, until: Until) -> None:
    services, model = closed.services, closed.gallery.view.model_
    designs = services.session.document.candidates
    until(lambda: services.estimates.known.keys() == set(designs) and not services.estimates.busy)
    rows = [model.index(row, 0) for row in range(model.rowCount())]
    assert len(rows) == len(designs)
    for row in rows:
        assert row.data(VERDICT_ROLE).as_cut.closes
        # The design on the stage may have been simulated meanwhile; nobody has looked at the others.
        estimated = row.data(VERDICT_ROLE).as_cut.source is Source.ESTIMATE
        assert estimated or row.row() == 0
        assert ("closes (estimate)" if estimated else "closes, ") in row.data(Qt.ItemDataRole.ToolTipRole)
    pictured = closed.gallery.view.viewport().grab().toImage()
    services.fabrication.change(connector_mm=3.0)
    services.fabrication.change_options(style=ConnectorStyle.STRAIGHT)
    until(lambda: not services.estimates.busy and not any(closing(row) for row in rows))
    assert all("jams at " in row.data(Qt.ItemDataRole.AccessibleDescriptionRole) for row in rows)
    assert closed.gallery.view.viewport().grab().toImage() != pictured


def test_that_the_drawing_shows_where_to_hold_and_pull(closed: MainWindow, until: Until) -> None:
    view, grips = closed.stage.view, closed.services.grips
    assert view.grips is None and not grips.state.busy
    closed.stage.deployment.set_phi(1.0)
    plain = view.grab().toImage()
    closed.commands["show_grips"].trigger()
    assert grips.state.busy
    assert "Looking for where to hold and pull …" in [chip.text for chip, _ in view.legend(view.fontMetrics())]
    until(lambda: grips.state.found is not None)
    found = view.grips
    assert found is not None and found.held and found.moved
    said = [chip.text for chip, _ in view.legend(view.fontMetrics())]
    assert "hold 1 panel" in said
    assert f"pull {len(found.moved)} panel{'s' if len(found.moved) > 1 else ''}" in said
    shown = view.grab().toImage()
    assert shown != plain
    # At the end of the way there is nothing left to pull: pins without arrows.
    closed.stage.deployment.set_phi(math.pi)
    assert view.grab().toImage() != shown
    closed.commands["show_grips"].trigger()
    closed.stage.deployment.set_phi(1.0)
    assert view.grips is None and view.grab().toImage() == plain


def test_that_grips_belong_to_the_sheet_that_they_were_found_for(closed: MainWindow, until: Until) -> None:
    grips = closed.services.grips
    closed.commands["show_grips"].trigger()
    until(lambda: grips.state.found is not None)
    first = grips.state.found
    closed.services.fabrication.change(connector_mm=0.5)
    assert closed.stage.view.grips is None
    until(lambda: grips.state.found is not None)
    assert grips.state.found is not first
    closed.commands["undo"].trigger()
    until(lambda: grips.state.found is not None and not grips.state.busy)
    assert grips.state.found is first  # known already


def test_that_arrows_point_the_way_that_panels_go_seen_from_those_that_are_held(closed: MainWindow) -> None:
    stage = closed.session.stage
    assert stage is not None
    design = stage.design
    last = design.deployment.topology.panel_nodes.reshape(-1, 4).shape[0] - 1
    places = grip_places(design, (0,), (last,), 2.0, 0.0)

    def apart(phi: float) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        middles = design.panels(design.nodes(phi)).mean(axis=1)
        between: np.ndarray[tuple[int], np.dtype[np.float64]] = middles[last] - middles[0]
        return between

    way = apart(2.0 - 1e-3) - apart(2.0)
    cosine = float(way @ places.way[0]) / float(np.linalg.norm(way) * np.linalg.norm(places.way[0]))
    assert cosine > 0.99
    np.testing.assert_allclose(places.moved[0] - places.held[0], apart(2.0), atol=1e-12)
    assert not grip_places(design, (0,), (last,), 0.5, 0.5).way.any()
