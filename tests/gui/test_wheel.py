"""Scrolling over a page changes no choice and no number that the pointer happens to pass."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtWidgets import QAbstractSpinBox, QApplication, QComboBox, QSlider, QWidget

from kirigami_studio.gui.widgets.number_field import DRAWING_SLIDERS
from kirigami_studio.gui.window.main_window import MainWindow


def scroll(widget: QWidget) -> None:
    """One notch down, then one up, in the middle of a widget."""
    place = QPointF(widget.rect().center())
    for notch in (-120, 120):
        buttons, keys = Qt.MouseButton.NoButton, Qt.KeyboardModifier.NoModifier
        where = QPointF(widget.mapToGlobal(place))
        phase = Qt.ScrollPhase.NoScrollPhase
        QApplication.sendEvent(
            widget, QWheelEvent(place, where, QPoint(), QPoint(0, notch), buttons, keys, phase, False)
        )


def value(control: QWidget) -> object:
    if isinstance(control, QComboBox):
        return control.currentIndex()
    return control.value() if isinstance(control, QSlider) else control.text()  # type: ignore[attr-defined]


def controls_of(root: QWidget) -> list[QWidget]:
    kinds = (QComboBox, QAbstractSpinBox, QSlider)
    found = [one for kind in kinds for one in root.findChildren(kind) if one.objectName() not in DRAWING_SLIDERS]
    return [one for one in found if one.isEnabled()]


def test_that_the_wheel_changes_nothing_in_the_whole_window(designed: MainWindow) -> None:
    before, controls = designed.session.document, controls_of(designed)
    assert len(controls) > 40
    designed.stage.view.setFocus()
    for control in controls:
        shown = value(control)
        seen: list[object] = []
        signal = getattr(control, "currentIndexChanged", None) or getattr(control, "valueChanged", None)
        if signal is not None:
            signal.connect(seen.append)
        scroll(control)
        assert value(control) == shown and seen == [], control.objectName() or control.accessibleName()
    assert designed.session.document is before


@pytest.mark.parametrize("command", ["materials", "artwork"])
def test_that_the_wheel_changes_nothing_in_dialogs(command: str, designed: MainWindow) -> None:
    designed.commands[command].trigger()
    QApplication.processEvents()
    dialog = getattr(designed.dialogs, command)
    for part in dialog.findChildren(QWidget):
        part.setEnabled(True)  # as for a material of one's own, and a picture that is there
    controls = [one for one in controls_of(dialog) if not one.hasFocus()]
    assert controls
    for control in controls:
        shown = value(control)
        scroll(control)
        assert value(control) == shown, control.objectName() or control.accessibleName()


def test_that_the_wheel_turns_a_choice_that_has_the_focus(designed: MainWindow) -> None:
    box = designed.fabrication.material
    box.setCurrentIndex(2)
    box.setFocus()
    event_place = QPointF(box.rect().center())
    where = QPointF(box.mapToGlobal(event_place))
    QApplication.sendEvent(
        box,
        QWheelEvent(
            event_place,
            where,
            QPoint(),
            QPoint(0, -120),
            Qt.MouseButton.NoButton,
            Qt.KeyboardModifier.NoModifier,
            Qt.ScrollPhase.NoScrollPhase,
            False,
        ),
    )
    assert box.currentIndex() == 3
