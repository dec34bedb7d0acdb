"""Forms made of settings: fields say what their settings say, and bind both ways."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from PySide6.QtWidgets import QCheckBox, QComboBox, QDoubleSpinBox, QSpinBox
from pytestqt.qtbot import QtBot

from kirigami_studio.fabricate.material import Material, find_material
from kirigami_studio.fabricate.options import AS_MANY_AS_FIT, STRAIGHT, ConnectorStyle, CutOptions, CutOrder
from kirigami_studio.foundation.settings import settings_of
from kirigami_studio.gui.widgets.form import Form
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings

CUTS = replace(STRAIGHT, style=ConnectorStyle.ARC, order=CutOrder.SPREAD, tabs=4, tab_mm=0.7, copies=3)


@pytest.fixture
def form(qtbot: QtBot) -> Form:
    made = Form(CutOptions)
    made.remaining()
    for field in made.fields.values():
        qtbot.addWidget(field)
    return made


def test_that_a_form_has_a_field_for_every_setting_with_a_caption(form: Form) -> None:
    captioned = [name for name, one in settings_of(CutOptions).items() if one.setting.label]
    assert list(form.fields) == captioned == ["style", "order", "tabs", "tab_mm", "copies", "copy_gap_mm"]
    assert form.remaining() == [], "all of them are made"


def test_that_a_field_says_and_allows_what_its_setting_does(form: Form) -> None:
    gap, tabs = form.fields["copy_gap_mm"], form.fields["tabs"]
    assert isinstance(gap, QDoubleSpinBox) and isinstance(tabs, QSpinBox)
    assert (gap.objectName(), gap.minimum(), gap.maximum(), gap.decimals()) == ("copyGap", 0.1, 500.0, 1)
    assert gap.accessibleName() == "Gap between copies in millimetres" and "0.1 to 500" in gap.toolTip()
    assert (tabs.minimum(), tabs.maximum(), tabs.text()) == (0, 200, "Off")
    assert "(0 to 200)" in tabs.toolTip()


def test_that_showing_values_reports_no_edit_and_an_edit_is_reported_once(form: Form) -> None:
    reported: list[dict[str, object]] = []
    form.changed.connect(reported.append)
    form.show_settings(CUTS)
    assert reported == []
    style, tabs, gap = form.fields["style"], form.fields["tabs"], form.fields["copy_gap_mm"]
    assert isinstance(style, QComboBox) and isinstance(tabs, QSpinBox) and isinstance(gap, QDoubleSpinBox)
    assert style.currentData() == ConnectorStyle.ARC and tabs.value() == 4
    tabs.setValue(5)
    gap.setValue(6.5)
    style.setCurrentIndex(style.findData(ConnectorStyle.ROUND))
    style.activated.emit(style.currentIndex())
    assert reported == [{"tabs": 5}, {"copy_gap_mm": 6.5}, {"style": "round"}]
    changes = {name: value for change in reported for name, value in change.items()}
    assert replace(CUTS, **changes).style is ConnectorStyle.ROUND  # type: ignore[arg-type]


def test_that_an_angle_is_shown_in_degrees_and_reported_in_radians(qtbot: QtBot) -> None:
    form, reported = Form(DesignSettings), []
    box = form.decimal("phi")
    qtbot.addWidget(box)
    form.changed.connect(reported.append)
    form.show({"phi": math.pi / 3})
    assert box.text() == "60.0°" and reported == []
    box.setValue(90.0)
    assert reported[0]["phi"] == pytest.approx(math.pi / 2)


def test_that_a_switch_of_a_number_reports_a_number(qtbot: QtBot) -> None:
    form, reported = Form(DesignSettings), []
    box = form.switch("search")
    qtbot.addWidget(box)
    form.changed.connect(reported.append)
    form.show({"search": 3})
    assert isinstance(box, QCheckBox) and box.isChecked() and reported == []
    box.setChecked(False)
    box.setChecked(True)
    assert [type(change["search"]) for change in reported] == [int, int] and reported[-1] == {"search": 1}


def test_that_every_form_of_the_window_shows_what_any_settings_hold(qtbot: QtBot) -> None:
    many = replace(CUTS, copies=AS_MANY_AS_FIT)
    holders = (DesignSettings(k=7), FabricationSettings(width_mm=77.0), many, find_material("card-co2"))
    for holder in holders:
        form = Form(type(holder))
        form.remaining()
        for field in form.fields.values():
            qtbot.addWidget(field)
        form.show_settings(holder)
        for name, field in form.fields.items():
            value, scale = getattr(holder, name), form.settings[name].setting.scale
            if isinstance(field, QComboBox):
                assert field.currentData() == value, name
            elif isinstance(field, QCheckBox):
                assert field.isChecked() == bool(value), name
            elif value is not None:
                assert field.value() == pytest.approx(scale * value, abs=0.01), name
    assert isinstance(holders[-1], Material)
