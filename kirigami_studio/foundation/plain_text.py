"""Text from outside as it can be shown: bounded, and without control characters.

Names and notes in files may hold anything: ten million letters, line ends, escape sequences of terminals, marks that
turn the direction of what follows.  Every reader passes them through here.
"""

from __future__ import annotations

#: Letters that a name and a note from outside have at most, the first as names of files do; a longer one ends in an
#: ellipsis.
LONGEST_NAME, LONGEST_NOTE = 255, 2000
ELLIPSIS = "…"
#: Of a text that is too long, so many times as much is looked at.
LOOKED_AT = 4


def printable(text: str, instead: str = " ") -> str:
    """A text with ``instead`` for every character that cannot be shown, line ends among them."""
    return text if text.isprintable() else "".join(letter if letter.isprintable() else instead for letter in text)


def plain_line(text: str, longest: int = LONGEST_NAME) -> str:
    """Return a name from outside as one line of at most ``longest`` printable characters."""
    if len(text) <= longest and text.isprintable():
        return text
    looked_at = text[: LOOKED_AT * longest]
    line = " ".join(printable(looked_at).split())
    if len(line) <= longest and len(looked_at) == len(text):
        return line
    return line[: longest - len(ELLIPSIS)].rstrip() + ELLIPSIS


def plain_lines(text: str) -> str:
    """A note from outside in lines, of at most ``LONGEST_NOTE`` printable characters in all."""
    if len(text) > LONGEST_NOTE:
        text = text[: LONGEST_NOTE - len(ELLIPSIS)].rstrip() + ELLIPSIS
    return "\n".join(printable(line) for line in text.splitlines())
