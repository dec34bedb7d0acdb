"""Names and notes of designs: A1, A2, ... for the first run of a project, B1, ... for the second, unless renamed.

A design keeps its name whatever becomes of its rank, and while it is trimmed, fitted again or changed by hand.  The
letters go on through the whole project, so that a name on a cut file or on a sheet means one design.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.foundation.plain_text import printable

#: The name that a design gets by itself.
CODE = re.compile(r"[A-Z]{1,8}[1-9][0-9]{0,5}")
#: What reads as such a name, however it is written: after two letters there were 702 runs.
READS_AS_CODE = re.compile(r"[A-Za-z]{1,2}[1-9][0-9]{0,5}")
#: Letters that a name and a note have at most.
LONGEST_NAME, LONGEST_NOTE = 40, 2000
ALPHABET = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"


@dataclass(frozen=True, slots=True)
class Label:
    """What a design is called, and what the user has noted of it.

    Raises
    ------
    ProjectError
        No such code, or a name or a note that is too long or cannot be shown.
    """

    code: str  #: the name that it got by itself, such as "A1"; it never changes
    name: str = ""  #: the name that the user gave it, "" for none
    note: str = ""

    def __post_init__(self) -> None:
        if not isinstance(self.code, str) or CODE.fullmatch(self.code) is None:
            raise ProjectError("labels.not_a_code", value=self.code)
        if len(self.name) > LONGEST_NAME:
            raise ProjectError("labels.name_too_long", letters=len(self.name), most=LONGEST_NAME)
        if len(self.note) > LONGEST_NOTE:
            raise ProjectError("labels.note_too_long", letters=len(self.note), most=LONGEST_NOTE)
        if not self.name.isprintable() or not all(line.isprintable() for line in self.note.split("\n")):
            raise ProjectError("labels.not_printable", code=self.code)

    @property
    def text(self) -> str:
        """What the design is called."""
        return self.name or self.code


def letters_of(run: int) -> str:
    """``0`` -> ``A``, ``25`` -> ``Z``, ``26`` -> ``AA``."""
    letters = ""
    run += 1
    while run > 0:
        run, rest = divmod(run - 1, len(ALPHABET))
        letters = ALPHABET[rest] + letters
    return letters


def run_labels(run: int, count: int, taken: Iterable[Label] = ()) -> tuple[Label, ...]:
    """Labels for ``count`` designs of a run, best first; runs count from 0.  No two designs share a name."""
    known = {label.text for label in taken} | {label.code for label in taken}
    labels: list[Label] = []
    number = 0
    while len(labels) < count:
        number += 1
        code = f"{letters_of(run)}{number}"
        if code not in known:
            labels.append(Label(code))
    return tuple(labels)


def reads_as_code(name: str) -> bool:
    """Whether the user would take it for the name that a design gets by itself: ``B2`` and ``b2``, not ``Heart2``."""
    return READS_AS_CODE.fullmatch(name) is not None


def cleaned_name(text: str) -> str:
    """A typed or pasted name as one line without characters that cannot be shown."""
    return " ".join(printable(text).split())


def cleaned_note(text: str) -> str:
    """A typed or pasted note without characters that cannot be shown; its lines stay."""
    return "\n".join(printable(line).rstrip() for line in text.splitlines()).strip()


def file_ending(label: Label) -> str:
    """What a design's name adds to the name of its files: letters, digits, dots and dashes that every system takes."""
    return re.sub(r"[^\w.-]+", "-", label.text).strip("-.") or label.code
