"""JSON read field by field; a missing or wrong entry is refused by its place in the file."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from enum import Enum
from types import MappingProxyType
from typing import Any, NoReturn, TypeVar

from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.foundation.plain_text import LONGEST_NOTE, plain_line
from kirigami_studio.foundation.settings import NamedSetting, settings_of

LARGEST_NUMBER = 1e300
_NOT_GIVEN = object()

Choice = TypeVar("Choice", bound=Enum)
Value = TypeVar("Value")


def read_json(content: bytes, place: str) -> object:
    """Parse strict JSON: no NaN, no infinity.

    Raises
    ------
    ProjectError
        Not UTF-8, not JSON, or nested beyond reason.
    """
    try:
        return json.loads(content.decode("utf-8"), parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as error:
        raise ProjectError("json.not_readable", place=place, reason=str(error)) from error


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not a number")


class Record:
    """One JSON object.

    Parameters
    ----------
    place : str
        Its name in messages, e.g. ``design.json.settings``.

    Raises
    ------
    ProjectError
        From every method: the field is missing or of another kind.
    """

    def __init__(self, value: object, place: str) -> None:
        if not isinstance(value, dict):
            raise ProjectError("json.not_an_object", place=place)
        self._value: dict[str, Any] = value
        self._place = place

    @property
    def entries(self) -> Mapping[str, Any]:
        """All fields, for a reader of its own."""
        return MappingProxyType(self._value)

    def number(self, name: str) -> float:
        value = self._get(name)
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not _fits(value):
            self._refuse("json.not_a_number", name, value)
        return float(value)

    def whole(self, name: str) -> int:
        value = self._get(name)
        if isinstance(value, bool) or not isinstance(value, int):
            self._refuse("json.not_a_whole_number", name, value)
        return int(value)

    def flag(self, name: str) -> bool:
        return self._of_kind(bool, name, "json.not_true_or_false")

    def text(self, name: str) -> str:
        """A text as one plain line."""
        return plain_line(self.verbatim(name))

    def verbatim(self, name: str) -> str:
        """A text as it is written, for what checks it itself."""
        return self._of_kind(str, name, "json.not_a_text")

    def list(self, name: str) -> list[Any]:
        return self._of_kind(list, name, "json.not_a_list").copy()

    def texts(self, name: str) -> dict[str, str]:
        """A table of texts, each one plain line."""
        value = self._get(name)
        if not isinstance(value, dict) or not all(isinstance(text, str) for text in value.values()):
            self._refuse("json.not_a_table_of_texts", name, value)
        return {plain_line(key): plain_line(text, LONGEST_NOTE) for key, text in value.items()}

    def numbers(self, name: str) -> tuple[float, ...]:
        """A list of numbers."""
        values = self.list(name)
        each = Record({str(k): value for k, value in enumerate(values)}, f"{self._place}.{name}")
        return tuple(each.number(str(k)) for k in range(len(values)))

    def pair(self, name: str) -> tuple[float, float]:
        """Two numbers."""
        values = self.list(name)
        if len(values) != 2:
            self._refuse("json.not_two_numbers", name, values)
        both = Record(dict(zip("01", values, strict=True)), f"{self._place}.{name}")
        return both.number("0"), both.number("1")

    def record(self, name: str) -> Record:
        return Record(self._get(name), f"{self._place}.{name}")

    def holds(self, name: str) -> bool:
        """Whether the field is there and not null."""
        return self._value.get(name) is not None

    def _of_kind(self, kind: type[Value], name: str, code: str) -> Value:
        value = self._get(name)
        if not isinstance(value, kind):
            self._refuse(code, name, value)
        return value

    def _get(self, name: str) -> Any:
        value = self._value.get(name, _NOT_GIVEN)
        if value is _NOT_GIVEN:
            raise ProjectError("json.entry_missing", place=self._place, name=name)
        return value

    def _refuse(self, code: str, name: str, value: object) -> NoReturn:
        raise ProjectError(code, place=f"{self._place}.{name}", value=value)


def _fits(value: float) -> bool:
    return abs(value) <= LARGEST_NUMBER and not math.isnan(value)


def one_of(kind: type[Choice], name: object) -> Choice:
    """The member of an enumeration that goes by this value.

    Raises
    ------
    ProjectError
        There is none.
    """
    try:
        return kind(name)
    except ValueError:
        choices = ", ".join(str(choice.value) for choice in kind)
        raise ProjectError("json.not_a_choice", value=name, choices=choices) from None


def settings_json(instance: object) -> dict[str, object]:
    """Return the plain settings of a dataclass, without defaults that need not be written."""
    kind: type = type(instance)
    return {
        name: one.word(getattr(instance, name))
        for name, one in settings_of(kind).items()
        if one.is_plain and (one.setting.always_written or getattr(instance, name) != one.default)
    }


def settings_values(record: Record, kind: type) -> dict[str, Any]:
    """Return the values of the plain settings of a dataclass; optional ones may be missing.

    Raises
    ------
    ProjectError
        A setting is missing or of another kind.
    """
    return {
        name: _setting_value(record, one)
        for name, one in settings_of(kind).items()
        if one.is_plain and (record.holds(name) or (one.setting.always_written and not one.optional))
    }


def _setting_value(record: Record, one: NamedSetting) -> object:
    if issubclass(one.kind, Enum):
        return one_of(one.kind, record.text(one.name))
    read = {bool: record.flag, int: record.whole, float: record.number, str: record.text}
    return read[one.kind](one.name)
