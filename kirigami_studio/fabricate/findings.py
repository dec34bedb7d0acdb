"""What a check of a plan or file finds: sentences with a weight and a place."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Severity(Enum):
    """An error spoils the sheet; a warning may."""

    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True, slots=True)
class Problem:
    """One finding.

    Attributes
    ----------
    text : str
        What is wrong and what to try.
    severity : Severity
    where : (x, y) or None, mm
        A place to look at, in the frame of the plan or file.
    """

    text: str
    severity: Severity = Severity.ERROR
    where: tuple[float, float] | None = None
