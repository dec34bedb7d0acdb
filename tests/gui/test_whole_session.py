"""The whole way as a user goes it, and what the window owes the machine."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import ezdxf
import pytest
from PySide6.QtGui import QImage, QPainter
from PySide6.QtWidgets import QApplication, QWidget

from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.pipeline.variety import look_alikes
from kirigami_studio.project import store


@pytest.mark.torch
def test_that_the_session_without_a_display_makes_pictures_a_cut_file_and_a_project(
    tmp_path: Path, repository: Path
) -> None:
    command = [
        sys.executable,
        "-m",
        "kirigami_studio.lab.demonstrations.offscreen_session",
        "--out",
        str(tmp_path / "out"),
    ]
    done = subprocess.run(command, cwd=repository, capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == 0, done.stderr
    made = [Path(line.strip()) for line in done.stdout.splitlines()[1:]]
    assert all(path.stat().st_size > 1000 for path in made)
    assert sum(path.suffix == ".png" for path in made) >= 6
    assert ezdxf.readfile(tmp_path / "out" / "cut.dxf").header["$INSUNITS"] == 4
    project = store.load(tmp_path / "out" / "session.kiri")
    # The second card: designs that look like the first share its card.
    groups = look_alikes(project.candidates)
    assert project.chosen == next(place for place, group in enumerate(groups) if group != groups[0])


def test_that_the_session_reports_failure(tmp_path: Path, repository: Path) -> None:
    (tmp_path / "wall").write_text("a file", encoding="utf-8")
    command = [
        sys.executable,
        "-m",
        "kirigami_studio.lab.demonstrations.offscreen_session",
        "--out",
        str(tmp_path / "wall" / "out"),
    ]
    done = subprocess.run(command, cwd=repository, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 1 and done.stderr.startswith("The session failed: ") and "Traceback" not in done.stderr


def test_that_every_control_has_a_name_and_a_tooltip(designed: MainWindow) -> None:
    fields = ("QSpinBox", "QDoubleSpinBox", "DecimalField", "LengthField")
    kinds = ("QToolButton", "QPushButton", "QCheckBox", "QComboBox", "PhiSlider", *fields)
    panels = (designed.target, designed.settings, designed.stage, designed.fabrication)
    nameless = [
        widget.objectName() or widget.metaObject().className()
        for panel in panels
        for widget in panel.findChildren(QWidget)
        if widget.metaObject().className() in kinds
        and not (widget.toolTip() and (widget.accessibleName() or widget.property("text")))
    ]
    assert nameless == []
    assert {command.id for command in designed.commands.records} == set(designed.commands.actions)


def test_that_nothing_is_clipped_at_the_smallest_size(designed: MainWindow) -> None:
    designed.resize(designed.minimumSize())
    QApplication.processEvents()
    assert designed.width() <= 1000 and designed.height() <= 640
    for panel in (designed.target, designed.settings, designed.stage, designed.gallery, designed.fabrication):
        box = panel.rect().translated(panel.mapTo(designed, panel.rect().topLeft()))
        assert designed.rect().contains(box)
        for widget in panel.findChildren(QWidget):
            if widget.isVisible() and widget.parentWidget() is panel:
                assert panel.rect().contains(widget.geometry()), widget.objectName()


def test_that_painting_does_not_wear_out_none(qapp: QApplication) -> None:
    # PySide6 6.12.0 on Python below 3.12 loses a reference to None in every call that returns nothing:
    # a window that draws dies within minutes.
    picture = QImage(8, 8, QImage.Format.Format_ARGB32)
    painter = QPainter(picture)
    before = sys.getrefcount(None)
    for _ in range(1000):
        painter.drawLine(0, 0, 5, 5)
    after = sys.getrefcount(None)
    painter.end()
    assert after > before - 500
