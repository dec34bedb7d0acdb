"""One sitting from the first stroke to the last undo, by mouse and keyboard, through the widgets of the real window.

Each step is a function that takes the window, does what a hand would and asserts what an eye would see.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from hand_gestures import middle_of, turn
from paint_counter import PaintCounter
from PySide6.QtCore import QPoint, QPointF, Qt
from pytestqt.qtbot import QtBot

from kirigami_studio.evaluate.candidate import Origin
from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.widgets.theme import LIGHT
from kirigami_studio.gui.window.application import create_window
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.project.document import Document

Until = Callable[[Callable[[], bool]], None]
LEFT, CONTROL = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.ControlModifier
VOIDS, DESIGNS, MOST_STEPS = 6, 3, 30


class Sitting:
    """A person at the window."""

    def __init__(self, window: MainWindow, qtbot: QtBot, until: Until) -> None:
        self.window, self.bot, self.until = window, qtbot, until

    @property
    def document(self) -> Document:
        return self.window.session.document

    def key(self, key: Qt.Key, modifier: Qt.KeyboardModifier = Qt.KeyboardModifier.NoModifier) -> None:
        self.bot.keyClick(self.window, key, modifier)

    def come_back(self) -> None:
        """Click on the window after another one was in front."""
        self.window.activateWindow()
        self.until(self.window.isActiveWindow)

    def draw_freehand(self) -> None:
        """D, one stroke around an egg, E to leave the drawing board."""
        view = self.window.target.view
        self.key(Qt.Key.Key_D)
        assert self.window.target.editing
        middle, radius = view.rect().center(), 0.35 * min(view.width(), view.height())
        stroke = [
            middle + QPoint(round(radius * math.cos(a)), round(0.7 * radius * math.sin(a)))
            for a in np.linspace(0, 1.97 * math.pi, 60)
        ]
        self.bot.mousePress(view, LEFT, pos=stroke[0])
        for place in stroke[1:]:
            self.bot.mouseMove(view, place)
        self.bot.mouseRelease(view, LEFT, pos=stroke[-1])
        target = self.document.target
        assert target is not None and target.name == "drawing"
        assert np.divide(*np.ptp(target.points, axis=0)) == pytest.approx(1 / 0.7, rel=0.08)
        self.key(Qt.Key.Key_E)
        assert not self.window.target.editing

    def set_up(self) -> None:
        """Type the grid and the number of designs."""
        settings = self.window.settings
        for box, value in ((settings.rows, VOIDS), (settings.columns, VOIDS), (settings.candidates, DESIGNS)):
            box.setFocus()
            box.selectAll()
            self.bot.keyClicks(box, str(value))
            self.bot.keyClick(box, Qt.Key.Key_Return)
        assert self.document.settings.grid == (VOIDS, VOIDS) and self.document.settings.k == DESIGNS

    def generate(self) -> None:
        """Ctrl+G with the bundled model."""
        self.key(Qt.Key.Key_G, CONTROL)
        assert self.window.services.run.running
        self.until(lambda: not self.window.services.run.running and self.window.fabrication.export.isEnabled())
        assert len(self.document.candidates) == DESIGNS and self.document.chosen == 0

    def choose(self) -> None:
        """Click on the second card, where every design has its own."""
        view = self.window.gallery.view
        self.window.gallery.bar.filters.grouped.setChecked(False)
        self.bot.mouseClick(view.viewport(), LEFT, pos=view.visualRect(view.model_.index(1, 0)).center())
        assert self.document.chosen == 1 and self.window.stage.title.text() == "Design A2"
        self.until(lambda: self.window.fabrication.export.isEnabled() and not self.window.session.queue.busy)

    def scrub(self) -> None:
        """Drag the slider from the target to the flat sheet and half the way back; the drawing follows exactly."""
        slider, view, stage = self.window.stage.deployment.slider, self.window.stage.view, self.window.session.stage
        assert stage is not None
        before, paints = self.document, PaintCounter(view)
        y, left, right = slider.height() // 2, 14, slider.width() - 15
        self.bot.mousePress(slider, LEFT, pos=QPoint(right, y))
        for x in [*np.linspace(right, left, 12).astype(int).tolist(), (left + right) // 2]:
            self.bot.mouseMove(slider, QPoint(x, y))
            view.repaint()
        self.bot.mouseRelease(slider, LEFT, pos=QPoint((left + right) // 2, y))
        assert view.phi == pytest.approx(math.pi / 2, abs=0.05) and paints.count >= 12
        exact = stage.design.pose_at(view.phi).apply(deploy(stage.candidate.sheet).nodes(view.phi))
        assert stage.design.nodes(view.phi) == pytest.approx(exact, abs=1e-9)
        assert self.document is before

    def edit_by_hand(self) -> None:
        """H, the wheel over a void, L; the exact layout follows at once, the score a moment later."""
        view, before = self.window.stage.view, self.document.candidate
        assert before is not None
        self.key(Qt.Key.Key_H)
        void, place = (2, 3), middle_of(view, (2, 3))
        self.bot.mouseMove(view, place)
        turn(view, place, 2)
        self.until(lambda: self.document.candidate is not None and self.document.candidate.origin is Origin.EDITED)
        after = self.document.candidate
        assert after is not None and self.document.chosen == 1
        changed = np.argwhere(after.sheet.field.ratio != before.sheet.field.ratio).tolist()
        assert changed == [list(void)] and after.sheet.field.ratio[void] > before.sheet.field.ratio[void]
        exact = after.score.transform.apply(deploy(after.sheet).nodes(after.score.phi))
        shown = view.design
        assert shown is not None and np.ptp(shown.nodes(after.score.phi) - exact, axis=0) == pytest.approx(
            0.0, abs=1e-9
        )
        self.key(Qt.Key.Key_L)
        assert self.document.locked == {void}
        self.key(Qt.Key.Key_H)
        self.until(lambda: self.window.fabrication.export.isEnabled() and not self.window.session.queue.busy)

    def set_connectors(self) -> None:
        """Show the cuts, click on a connector, type its width, Return; then put another one off with Delete."""
        page = self.window.cuts
        self.window.commands["cuts"].trigger()
        plan, transform = page._plan, page.view.transform()
        assert plan is not None and transform is not None
        at = plan.hinges.position
        apart = np.linalg.norm(at[:, None] - at[None], axis=2) + 1e9 * np.eye(len(at))
        first, second = np.argsort(-apart.min(axis=1))[:2].tolist()
        self.bot.mouseClick(page.view, LEFT, pos=QPointF(*transform.to_pixels(at[first]).tolist()).toPoint())
        assert page.view.selected == {first}
        width = page.hinges.width_mm
        width.setFocus()
        width.selectAll()
        self.bot.keyClicks(width, "0.3")
        self.bot.keyClick(width, Qt.Key.Key_Return)
        assert self.document.fabrication.options.hinge_mm == ((first, 0.3),)
        self.bot.mouseClick(page.view, LEFT, pos=QPointF(*transform.to_pixels(at[second]).tolist()).toPoint())
        self.bot.keyClick(page.view, Qt.Key.Key_Delete)
        assert self.document.fabrication.options.removed == (second,)
        self.until(lambda: page._plan is not None and page._plan.options == self.document.fabrication.options)
        assert page._plan is not None and page._plan.hinges.finished_mm[first] == pytest.approx(0.3, abs=2e-3)

    def export(self, path: Path) -> None:
        """Ctrl+E; another program's reader finds the sheet in mm, as wide as it was asked for."""
        self.key(Qt.Key.Key_E, CONTROL)
        self.until(lambda: any(one.tone in (Tone.DONE, Tone.WARNING) for one in self.window.messages.messages))
        report = self.window.dialogs.report
        assert report is not None and report.isVisible()
        self.bot.keyClick(report, Qt.Key.Key_Escape)
        assert not report.isVisible()
        self.come_back()
        drawing = ezdxf.readfile(path)
        assert drawing.header["$INSUNITS"] == 4 and len(drawing.audit().errors) == 0
        low, high = drawing.header["$EXTMIN"], drawing.header["$EXTMAX"]
        width_mm = self.document.fabrication.width_mm
        assert width_mm <= max(high[0] - low[0], high[1] - low[1]) < 1.25 * width_mm
        assert len(drawing.modelspace()) > VOIDS * VOIDS

    def save(self) -> None:
        """Ctrl+S."""
        self.key(Qt.Key.Key_S, CONTROL)
        self.until(lambda: not self.window.session.history.unsaved)

    def undo_everything(self) -> list[str]:
        """Ctrl+Z until there is nothing left; the steps' names, last first."""
        names = []
        while (name := self.window.session.history.undo_label) is not None and len(names) < MOST_STEPS:
            names.append(name)
            self.key(Qt.Key.Key_Z, CONTROL)
        return names

    def redo_everything(self) -> None:
        """Ctrl+Y as often."""
        for _ in range(MOST_STEPS):
            if self.window.session.history.redo_label is not None:
                self.key(Qt.Key.Key_Y, CONTROL)


@pytest.mark.torch
def test_that_a_whole_sitting_ends_where_it_began(
    window: MainWindow, qtbot: QtBot, until: Until, files: object, tmp_path: Path
) -> None:
    window.resize(1440, 900)
    at_work, start = Sitting(window, qtbot, until), window.session.document
    at_work.draw_freehand()
    at_work.set_up()
    at_work.generate()
    at_work.choose()
    at_work.scrub()
    at_work.edit_by_hand()
    at_work.set_connectors()
    files.answer = tmp_path / "egg.dxf"  # type: ignore[attr-defined]
    at_work.export(tmp_path / "egg.dxf")
    files.answer = tmp_path / "egg.kiri"  # type: ignore[attr-defined]
    at_work.save()
    kept = window.session.document
    assert reopened(tmp_path / "egg.kiri", until) == kept
    at_work.come_back()
    steps = at_work.undo_everything()
    assert window.session.document == start and window.gallery.view.model_.rowCount() == 0
    assert len(steps) >= 9 and len(set(steps)) >= 8
    at_work.redo_everything()
    assert window.session.document == kept and not window.session.history.unsaved
    until(lambda: not window.session.queue.busy and window.fabrication.export.isEnabled())


def reopened(path: Path, until: Until) -> Document:
    """What another window finds in the file."""
    other = create_window(LIGHT)
    other.show()
    other.files.open(str(path))
    until(lambda: other.session.stage is not None and other.fabrication.export.isEnabled())
    document = other.session.document
    assert len(other.gallery.view.model_.all_entries) == len(document.candidates)
    assert other.close()
    other.deleteLater()
    return document
