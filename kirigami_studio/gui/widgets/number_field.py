"""Number fields that read comma, point and units, leave the wheel to the page that scrolls, and undo to the window."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TypeVar

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtGui import QKeyEvent, QValidator, QWheelEvent
from PySide6.QtWidgets import QAbstractSpinBox, QComboBox, QDoubleSpinBox, QLabel, QSlider, QWidget

from kirigami_studio.foundation.units import MM_PER_INCH
from kirigami_studio.foundation.words import ShownUnit

#: Keys that, with Ctrl, mean something to the window: undo, redo and export.  A field keeps undo while it is typed in.
WINDOW_KEYS = (Qt.Key.Key_Z, Qt.Key.Key_Y, Qt.Key.Key_E)
#: Millimetres in one of each unit that may be typed behind a length.
LENGTH_UNITS: Mapping[str, float] = {
    "mm": 1.0,
    "cm": 10.0,
    "um": 0.001,
    "\N{MICRO SIGN}m": 0.001,
    "\N{GREEK SMALL LETTER MU}m": 0.001,
    "in": MM_PER_INCH,
    "inch": MM_PER_INCH,
    '"': MM_PER_INCH,
    "thou": MM_PER_INCH / 1000,
}
#: Properties of a widget with its caption, and its spoken name, as they are for mm.
CAPTION, SPOKEN = "captionInMm", "spokenInMm"
#: Names of sliders that move a drawing.
DRAWING_SLIDERS = frozenset({"phiSlider", "cutStep"})
#: A number, a fraction of two, and what stands behind them.
TYPED = re.compile(r"\s*([+-]?\d*[.,]?\d*)\s*(?:(/)\s*(\d*[.,]?\d*))?\s*([^\d\s.,+/-]*)\s*")
#: What Qt wants back: whether the text is a number, the text, and where the cursor stands.
Answer = tuple[QValidator.State, str, int]


def number_field(box: QAbstractSpinBox) -> None:
    """Give a field its margin; the wheel changes it only while it has the focus, and the window keeps its keys."""
    box.lineEdit().setTextMargins(6, 0, 0, 0)
    box.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    box.installEventFilter(FieldHabits(box))


class WheelStays(QObject):
    """Leaves the wheel to the page that scrolls unless the control has the focus."""

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        # Hundreds of events pass while a window is made: to ask for their class is a quarter of the work of their type.
        if isinstance(event, QWheelEvent) and isinstance(watched, QWidget) and not watched.hasFocus():
            event.ignore()
            return True
        return False


class FieldHabits(WheelStays):
    """Also leaves keys of the window to it: undo unless something was typed, export, and Space, which plays."""

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        if not isinstance(event, QKeyEvent) or not isinstance(watched, QAbstractSpinBox):
            return super().eventFilter(watched, event)
        if event.type() == QEvent.Type.ShortcutOverride:
            typing = watched.lineEdit().isModified() and event.key() != Qt.Key.Key_E
            ctrl = bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier)
            if event.key() == Qt.Key.Key_Space or (ctrl and event.key() in WINDOW_KEYS and not typing):
                event.ignore()
                return True
        return super().eventFilter(watched, event)


def leave_wheel(root: QWidget) -> None:
    """Let the wheel change no value below a widget by accident: lists of choices, numbers, sliders in panels.

    Sliders that move a drawing are left as they are: there the wheel is meant for them.
    """
    kinds = (QComboBox, QAbstractSpinBox, QSlider)
    for control in (one for kind in kinds for one in root.findChildren(kind)):
        moves_a_drawing = control.objectName() in DRAWING_SLIDERS
        if not moves_a_drawing and control.findChild(WheelStays) is None:
            habits = FieldHabits if isinstance(control, QAbstractSpinBox) else WheelStays
            control.installEventFilter(habits(control))


class DecimalField(QDoubleSpinBox):
    """A spin box that takes comma and point as the decimal sign, whatever the system's language.

    Qt's own reads ``85,5`` as 855 where the system writes a point, and ``85.5`` as 855 where it writes a comma.
    """

    #: Factor to the field's own unit of each unit that may be typed.
    units: Mapping[str, float] = {}
    #: Unit of numbers that are typed without one; "" for the field's own.
    assumed = ""

    def validate(self, text: str, position: int) -> Answer:
        """Say whether a text can be, or can become, a number (Qt's own call)."""
        parts = self._parts(text)
        if parts is None:
            return QValidator.State.Invalid, text, position
        if parts == ("", "", "", ""):
            return super().validate(text, position)
        _, stroke, _, unit = parts
        if not stroke and not unit:
            return super().validate(self._plain(text), position)
        if not self.units or not any(known.startswith(unit) for known in self.units):
            return QValidator.State.Invalid, text, position
        value = self._value(parts)
        inside = value is not None and self.minimum() <= round(value, self.decimals()) <= self.maximum()
        return QValidator.State.Acceptable if inside else QValidator.State.Intermediate, text, position

    def valueFromText(self, text: str) -> float:  # noqa: N802 - Qt's name
        """Read a number in the field's own unit (Qt's own call)."""
        parts = self._parts(text)
        if parts is None or not (parts[1] or parts[3]):
            return super().valueFromText(self._plain(text))
        value = self._value(parts)
        return self.value() if value is None else round(value, self.decimals())

    def _parts(self, text: str) -> tuple[str, str, str, str] | None:
        """Split into number, stroke, divisor and unit; None if it cannot be a number."""
        if text == self.specialValueText():
            return "", "", "", ""
        body = text.removeprefix(self.prefix())
        found = TYPED.fullmatch(body.removesuffix(self.suffix()))
        if found is None:
            return None
        number, stroke, divisor, unit = (part or "" for part in found.groups())
        return number, stroke, divisor, unit.lower() or self.assumed

    def _value(self, parts: tuple[str, str, str, str]) -> float | None:
        number, stroke, divisor, unit = parts
        try:
            value = float(number.replace(",", "."))
            if stroke:
                value /= float(divisor.replace(",", "."))
        except (ValueError, ZeroDivisionError):
            return None
        if unit and unit not in self.units:
            return None
        return value * self.units.get(unit, 1.0)

    def _plain(self, text: str) -> str:
        """Write the decimal sign as the field's language does; what stands around the number stays."""
        front, back = self.prefix(), self.suffix()
        head = front if text.startswith(front) else ""
        tail = back if text.endswith(back) else ""
        body = text[len(head) : len(text) - len(tail)]
        return head + body.replace(",", ".").replace(".", self.locale().decimalPoint()) + tail


class LengthField(DecimalField):
    """A length in mm, shown in mm or inches, and typed as ``3 in``, ``3/8"`` or ``50 um``."""

    units = LENGTH_UNITS
    #: What the tooltip and the description say in mm.
    about = described = ""

    @property
    def assumed(self) -> str:  # type: ignore[override]
        """Unit of lengths that are typed without one: the shown one."""
        return "in" if ShownUnit.inches else ""

    def setSuffix(self, suffix: str) -> None:  # noqa: N802 - Qt's name
        """Set the unit that stands behind the number, if one does: that of all lengths."""
        super().setSuffix(suffix and f" {ShownUnit.name()}")

    def setToolTip(self, text: str) -> None:  # noqa: N802 - Qt's name
        """Set a tooltip about mm, which says the shown unit."""
        self.about = text
        super().setToolTip(ShownUnit.words(text))

    def setAccessibleDescription(self, text: str) -> None:  # noqa: N802 - Qt's name
        """Set a description about mm, which says the shown unit."""
        self.described = text
        super().setAccessibleDescription(ShownUnit.words(text))

    def textFromValue(self, value: float) -> str:  # noqa: N802 - Qt's name
        """Write a length in the unit of all lengths (Qt's own call)."""
        if not self.assumed:
            return super().textFromValue(value)
        inches = self.locale().toString(value / LENGTH_UNITS["in"], "f", self.decimals() + 2)
        return inches if self.suffix() else f'{inches}"'


def show_lengths(root: QWidget, inches: bool) -> None:
    """Show and read inches, or mm again, in all fields for lengths below a widget and in what names them."""
    ShownUnit.inches = inches
    for field in root.findChildren(LengthField):
        field.setSuffix(field.suffix())
        field.setDecimals(field.decimals())  # or the text would stay
        field.setToolTip(field.about)
        field.setAccessibleDescription(field.described)
    for part in root.findChildren(QWidget):
        if (caption := part.property(CAPTION)) is not None and isinstance(part, QLabel):
            part.setText(ShownUnit.words(caption))
        if (spoken := part.property(SPOKEN)) is not None:
            part.setAccessibleName(ShownUnit.words(spoken))


def names_length(part: QWidget) -> None:
    """Let a label, or the spoken name of a field, that tells of mm follow the shown unit from now on."""
    if isinstance(part, QLabel):
        part.setProperty(CAPTION, part.text())
        part.setText(ShownUnit.words(part.text()))
    elif part.accessibleName():
        part.setProperty(SPOKEN, part.accessibleName())
        part.setAccessibleName(ShownUnit.words(part.accessibleName()))


Field = TypeVar("Field", bound=DecimalField)


def decimal_field(
    kind: type[Field],
    name: str,
    low: float,
    high: float,
    *,
    decimals: int = 1,
    step: float = 1.0,
    suffix: str = "",
    accessible: str = "",
    tip: str = "",
    width: int | None = None,
) -> Field:
    """A number between ``low`` and ``high`` that reports what was typed once it is complete.

    ``width`` is the field's own, pixels; without it the style's.
    """
    field = kind()
    field.setObjectName(name)
    field.setDecimals(decimals)
    field.setRange(low, high)
    field.setSingleStep(step)
    field.setSuffix(suffix)
    field.setKeyboardTracking(False)
    field.setAccessibleName(accessible)
    field.setToolTip(tip)
    if width is not None:
        field.setFixedWidth(width)
    if isinstance(field, LengthField):
        names_length(field)
    number_field(field)
    return field
