"""Notes and problems of a plan or a file: values with a code, and a sentence made on reading."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum

from kirigami_studio.foundation.sentences import sentence


class Severity(Enum):
    """An error spoils the sheet; a warning may."""

    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True, slots=True)
class Note:
    """Something worth knowing."""

    code: str  #: names the kind of note, ``topic.what``; stable, so that programs and tests can tell notes apart
    fields: Mapping[str, object] = field(default_factory=dict, hash=False)  #: the values that its sentence names

    @classmethod
    def of(cls, code: str, /, **fields: object) -> Note:
        """A note with the values that its sentence names."""
        return Note(code, fields)

    @property
    def text(self) -> str:
        """The sentence in the user's language: what it is, and what to try."""
        return sentence(self.code, self.fields)


@dataclass(frozen=True, slots=True)
class Problem(Note):
    """A note with a weight and a place."""

    severity: Severity = Severity.ERROR
    #: (x, y), mm; a place to look at, in the frame of the plan or file; its sentence may name it as ``x`` and ``y``.
    where: tuple[float, float] | None = None

    @classmethod
    def error(cls, code: str, where: tuple[float, float] | None = None, /, **fields: object) -> Problem:
        """Findings that spoil the sheet."""
        return Problem(code, _with_place(fields, where), Severity.ERROR, where)

    @classmethod
    def warning(cls, code: str, where: tuple[float, float] | None = None, /, **fields: object) -> Problem:
        """Findings that may spoil the sheet."""
        return Problem(code, _with_place(fields, where), Severity.WARNING, where)


def _with_place(fields: dict[str, object], where: tuple[float, float] | None) -> dict[str, object]:
    return fields if where is None else {**fields, "x": where[0], "y": where[1]}
