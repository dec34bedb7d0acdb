"""Forms made of settings: a field for each, and one binder that reports edits and shows values."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Any

from PySide6.QtCore import QObject, QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QCheckBox, QLayout, QSpinBox, QVBoxLayout, QWidget

from kirigami_studio.foundation.settings import NamedSetting, settings_of
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.widgets.card import compact
from kirigami_studio.gui.widgets.choice_box import ChoiceBox, Choices
from kirigami_studio.gui.widgets.layouts import column, label
from kirigami_studio.gui.widgets.number_field import DecimalField, LengthField, names_length, number_field

#: A field of a form.
Field = QSpinBox | DecimalField | ChoiceBox | QCheckBox


def spoken(one: NamedSetting) -> str:
    """Return the name of a setting for screen readers."""
    return tr(one.setting.spoken) if one.setting.spoken else tr(one.setting.label).replace("&", "")


class Form(QObject):
    """The fields of the settings of a dataclass.

    Parameters
    ----------
    kind : type
        The dataclass.
    width : int or None, pixels
        Least width of a number that is as narrow as its column; None for as wide as its largest value.
    prefix : str
        Of the object names of fields that their settings do not name.
    """

    changed = Signal(dict)  #: name of a setting -> its new value
    edited = Signal()  #: a number was left

    def __init__(self, kind: type, width: int | None = 62, prefix: str = "", parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.settings: Mapping[str, NamedSetting] = settings_of(kind)
        self.fields: dict[str, Field] = {}
        self._show: dict[str, Callable[[Any], None]] = {}
        self._captions: dict[str, QWidget] = {}
        self._width, self._prefix = width, prefix

    def whole(self, name: str) -> QSpinBox:
        """Make the field of a whole number."""
        one, box = self.settings[name], QSpinBox()
        low, high = one.numbers["low"], one.numbers["high"]
        box.setRange(int(low or 0), int(high if high is not None else 2**31 - 1))
        box.setSingleStep(int(one.setting.step))
        if one.setting.special is not None:
            box.setSpecialValueText(tr(one.setting.special.shown))
        if one.setting.unit:
            box.setSuffix(f" {one.setting.unit}")
        self._bind_number(one, box, box.setValue)
        box.valueChanged.connect(lambda value: self.changed.emit({name: value}))
        return box

    def decimal(self, name: str, suffix: str = "") -> DecimalField:
        """Make the field of a number, its unit in the caption but for an angle or a ``suffix``."""
        one = self.settings[name]
        setting, scale = one.setting, one.setting.scale
        box = LengthField() if setting.unit == "mm" else DecimalField()
        low, high = one.numbers["low"], one.numbers["high"]
        box.setDecimals(setting.decimals)
        box.setRange(low if low is not None else -1e9, high if high is not None else 1e9)
        box.setSingleStep(setting.step)
        box.setSuffix(suffix or ("°" if setting.unit == "°" else ""))
        self._bind_number(one, box, lambda value: box.setValue(scale * value))
        box.valueChanged.connect(lambda value: self.changed.emit({name: value / scale}))
        return box

    def choice(self, name: str, choices: Choices | None = None, show: Callable[[Any], None] | None = None) -> ChoiceBox:
        """Make the field of a choice, of those that its setting offers unless others are given.

        ``show`` shows a value in the place of :meth:`ChoiceBox.choose`.
        """
        one = self.settings[name]
        box = ChoiceBox("", spoken(one), one.setting.choices if choices is None else choices)
        self._bind(one, box, show or box.choose)
        box.activated.connect(lambda _: self.changed.emit({name: box.currentData()}))
        return box

    def switch(self, name: str) -> QCheckBox:
        """Make the field of a flag, or of a number that is 0 or 1."""
        one = self.settings[name]
        box = QCheckBox(tr(one.setting.label))
        box.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._bind(one, box, lambda value: box.setChecked(bool(value)))
        box.toggled.connect(lambda on: self.changed.emit({name: one.kind(on)}))
        return box

    def captioned(self, name: str, content: QWidget | QLayout | None = None) -> QVBoxLayout:
        """A field that was made below the caption of its setting, alone or within ``content``."""
        caption = "" if isinstance(self.fields[name], QCheckBox) else tr(self.settings[name].setting.label)
        words, field = label(caption, self.fields[name]), self.fields[name]
        if isinstance(field, LengthField):
            names_length(words)
        self._captions[name] = words
        return column(words, field if content is None else content, spacing=3)

    def offer(self, names: Iterable[str], on: bool) -> None:
        """Show fields with their captions, or take them away."""
        for name in names:
            self.fields[name].setEnabled(on)
            for part in (self.fields[name], self._captions[name]):
                part.setVisible(on)

    def remaining(self, elsewhere: Collection[str] = ()) -> list[QVBoxLayout]:
        """Make the fields of settings with a caption that have none yet, here or ``elsewhere``."""
        found = []
        for name, one in self.settings.items():
            if one.setting.label and name not in (*self.fields, *elsewhere) and one.is_plain:
                if one.kind is bool:
                    self.switch(name)
                elif one.setting.choices:
                    self.choice(name)
                elif one.kind is int:
                    self.whole(name)
                elif one.kind is float:
                    self.decimal(name)
                else:
                    continue
                found.append(self.captioned(name))
        return found

    def show(self, values: Mapping[str, Any]) -> None:
        """Show values by the names of their settings, without an edit; None leaves a field as is."""
        for name, value in values.items():
            if name in self.fields and value is not None:
                with QSignalBlocker(self.fields[name]):
                    self._show[name](value)

    def show_settings(self, settings: object) -> None:
        """Show the values that an instance of the dataclass has."""
        self.show({name: getattr(settings, name) for name in self.fields})

    def _bind_number(self, one: NamedSetting, box: QSpinBox | DecimalField, show: Callable[[Any], None]) -> None:
        box.setKeyboardTracking(False)
        if self._width is None:
            number_field(box)
        else:
            compact(box, self._width)
        box.editingFinished.connect(self.edited)
        self._bind(one, box, show)

    def _bind(self, one: NamedSetting, field: Field, show: Callable[[Any], None]) -> None:
        setting = one.setting
        field.setObjectName(setting.widget or self._prefix + one.name)
        field.setAccessibleName(spoken(one))
        if setting.about:
            field.setToolTip(tr(setting.about, **one.numbers))
        if isinstance(field, LengthField):
            names_length(field)
        self.fields[one.name], self._show[one.name] = field, show
