"""Settings: fields of a dataclass with their range, words and names as metadata.

A field is a setting when its metadata has a :class:`Setting`::

    k: int = field(default=32, metadata=Setting(least=1, most=1024, label=mark("Desig&ns"), option="--k").metadata)

:func:`check` refuses values that do not fit, :func:`settings_of` lists the settings of a dataclass for the parser, the
Python API, the forms of the window and the project file.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields
from enum import Enum
from functools import cache
from types import MappingProxyType, NoneType, UnionType
from typing import Any, Final, NamedTuple, Union, get_args, get_origin, get_type_hints

from kirigami_studio.foundation.errors import KirigamiError, UsageError

#: Key of a field's metadata.
SETTING: Final = "setting"


class Choice(NamedTuple):
    """One value on offer: its label, and its meaning in a sentence."""

    value: object
    label: str
    about: str = ""


@dataclass(frozen=True, slots=True)
class SpecialValue:
    """A number with a meaning: its word on the command line, its text in the window."""

    value: int
    word: str
    shown: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """One setting; sentences are English, and marked for translation if the window shows them."""

    #: One or two sentences: the tooltip and, unless there is ``help``, the help on the command line.  ``{least}``,
    #: ``{most}`` (of the range), ``{low}`` and ``{high}`` (of the window's field) are filled in.
    about: str = ""
    #: least, most: range of a number; without one it has no end.
    least: float | None = None
    most: float | None = None
    #: above_least, below_most: whether that end is excluded.
    above_least: bool = False
    below_most: bool = False
    may_be_empty: bool = False  #: whether a text may have no letters
    #: Code of the problem with a value that does not fit; its sentence may name the setting's ``name``, ``value``,
    #: ``kind``, ``least``, ``most`` and ``choices``, and the value by the setting's own name.
    code: str = "settings.does_not_fit"
    error: type[KirigamiError] = UsageError
    #: Whether files hold it even where it is the default, and have to; others are left out then.
    always_written: bool = False
    undo: str = ""  #: what the Undo menu calls a change to it
    #: Caption in the window, with its mnemonic; a setting without one has no field that is made by itself.
    label: str = ""
    spoken: str = ""  #: name for screen readers; the label without one
    widget: str = ""  #: object name of its field; the name of the setting without one
    choices: tuple[Choice, ...] = ()  #: offered in the window, in this order
    #: low, high: range of that field, in what it shows; ``least`` and ``most`` without one.
    low: float | None = None
    high: float | None = None
    #: step, decimals, unit: of that field, in what it shows.
    step: float = 1.0
    decimals: int = 2
    unit: str = ""
    scale: float = 1.0  #: its field in the window shows this many times the value
    special: SpecialValue | None = None
    #: Name on the command line, such as ``--k``; without one it has none.  An angle whose option ends with ``-deg`` is
    #: read in degrees there, and in radians everywhere else.
    option: str = ""
    keyword: str = ""  #: name in Python and among the arguments, where the field's own one is another setting's, too
    #: metavar, help: of that option, where they are not its name and ``about``.
    metavar: str = ""
    help: str = ""
    alone: object = None  #: Value of the option without a value; None where it needs one.
    switched: bool = False  #: whether the option, of a number, only chooses between its default and 0
    #: Whether command line and Python API leave it open, as None, where it is not given: another setting decides it.
    open_unless_given: bool = False

    @property
    def metadata(self) -> Mapping[str, Setting]:
        """For a field of a dataclass."""
        return {SETTING: self}

    def holds(self, number: float) -> bool:
        """Whether a number lies in the range."""
        if not math.isfinite(number):
            return False
        least, most = self.least, self.most
        return (least is None or number > least or (number == least and not self.above_least)) and (
            most is None or number < most or (number == most and not self.below_most)
        )


@dataclass(frozen=True, slots=True)
class NamedSetting:
    """A setting with what its field says."""

    name: str
    kind: type  #: ``bool``, ``int``, ``float``, ``str`` or an enumeration; anything else checks itself
    optional: bool  #: whether None is a value of it
    default: Any  #: ``dataclasses.MISSING`` without one
    setting: Setting

    @property
    def keyword(self) -> str:
        """Its name in Python and among the arguments of a command."""
        return self.setting.keyword or self.name

    @property
    def is_plain(self) -> bool:
        """Whether it holds a flag, a number, a text or a choice."""
        return issubclass(self.kind, (bool, int, float, str, Enum))

    @property
    def numbers(self) -> dict[str, float | None]:
        """The ends of its ranges, as sentences name them."""
        one = self.setting
        shown = [end if end is None or one.scale == 1.0 else one.scale * end for end in (one.least, one.most)]
        low, high = (given if given is not None else end for given, end in zip((one.low, one.high), shown, strict=True))
        return {"least": one.least, "most": one.most, "low": low, "high": high}

    def fitting(self, value: object, **facts: object) -> object:
        """The value, a choice as the member of its enumeration that goes by this value.

        Raises
        ------
        KirigamiError
            Of the setting's own kind: the value does not fit.
        """
        if not self.is_plain or (value is None and self.optional):
            return value
        if issubclass(self.kind, Enum):
            try:
                return self.kind(value)
            except ValueError:
                raise self._refusal(value, facts) from None
        if self.kind is str:
            fits = isinstance(value, str) and (bool(value) or self.setting.may_be_empty)
        elif self.kind is bool:
            fits = isinstance(value, bool)
        else:
            number = isinstance(value, int if self.kind is int else (int, float)) and not isinstance(value, bool)
            fits = number and self.setting.holds(value)  # type: ignore[arg-type]
        if not fits:
            raise self._refusal(value, facts)
        return value

    @staticmethod
    def word(value: object) -> object:
        """A choice as it stands in files and on the command line; other values as they are."""
        return value.value if isinstance(value, Enum) else value

    def _refusal(self, value: object, facts: Mapping[str, object]) -> KirigamiError:
        setting, values = self.setting, {self.name: value, **facts, "name": self.name, "value": value}
        words = ", ".join(str(one.value) for one in self.kind) if issubclass(self.kind, Enum) else ""
        values |= {"choices": words, "kind": self.kind.__name__, "least": setting.least, "most": setting.most}
        return setting.error(setting.code, **values)


@cache
def settings_of(kind: type) -> Mapping[str, NamedSetting]:
    """All settings of a dataclass by name, in the order of its fields."""
    hints = get_type_hints(kind)
    found = {}
    for entry in fields(kind):
        if (setting := entry.metadata.get(SETTING)) is not None:
            plain, optional = _plain(hints[entry.name])
            default = entry.default if entry.default_factory is MISSING else entry.default_factory()
            found[entry.name] = NamedSetting(entry.name, plain, optional, default, setting)
    return MappingProxyType(found)


def _plain(hint: Any) -> tuple[type, bool]:
    """The type of a hint, and whether None may stand in its place."""
    if get_origin(hint) in (Union, UnionType):
        kinds = [one for one in get_args(hint) if one is not NoneType]
        return (kinds[0] if isinstance(kinds[0], type) else object), len(kinds) < len(get_args(hint))
    return (hint if isinstance(hint, type) else object), False


def check(instance: object, **facts: object) -> None:
    """Refuse values that do not fit, and turn words into members of their enumerations.

    The sentences of refusals may also name ``facts``.

    Raises
    ------
    KirigamiError
        Of the setting's own kind.
    """
    kind: type = type(instance)
    for name, one in settings_of(kind).items():
        value = getattr(instance, name)
        fitting = one.fitting(value, **facts)
        if fitting is not value:
            object.__setattr__(instance, name, fitting)
