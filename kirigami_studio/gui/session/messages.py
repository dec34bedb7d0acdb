"""A sentence for the user, with its weight and what lies behind it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum


class Tone(Enum):
    """How a message looks; the value is the icon's name."""

    HINT = "info"
    DONE = "check"
    WARNING = "warning"
    ERROR = "fault"


@dataclass(frozen=True, slots=True)
class Message:
    """One message."""

    sentence: str  #: what happened and what to try
    tone: Tone = Tone.HINT
    details: str = ""  #: trace or list, shown when asked for
    actions: tuple[tuple[str, Callable[[], None]], ...] = ()  #: what may be done about it, one button each
    passing: bool = False  #: whether it goes by itself although it has actions, as Undo does the same
