"""The design that a cut file came from, inside the file: a packed project of that one design, as text.

A DXF has it in custom variables (R12: in ezdxf's own records), an SVG in its metadata; other programs pass over both.
"""

from __future__ import annotations

import base64
import binascii
import re
from collections.abc import Mapping

#: Name of the pieces, with their number behind it; also that of the element in an SVG.
NAME = "KIRIGAMI_DESIGN"
#: Characters of one piece: some programs cut off strings of a DXF after 255.
PIECE = 240
LETTERS = rb"([A-Za-z0-9+/=]{1,%d})" % PIECE
#: A piece in a DXF: its name, the group codes of its value, and the value.
IN_DXF = re.compile(rb"%s_(\d{1,6})\s+(?:9\s+\$CUSTOMPROPERTY\s+1|1000)\s+%s\s" % (NAME.encode(), LETTERS))
IN_R12 = re.compile(rb"%s_(\d{1,6}):%s\s" % (NAME.encode(), LETTERS))
IN_SVG = re.compile(rb'<metadata id="%s">([A-Za-z0-9+/=]{1,16000000})</metadata>' % NAME.encode())


def record_text(record: bytes) -> str:
    """The record as one line of letters."""
    return base64.b64encode(record).decode("ascii")


def record_pieces(record: bytes) -> Mapping[str, str]:
    """The record as short strings with names, in order."""
    text = record_text(record)
    starts = range(0, len(text), PIECE)
    return {f"{NAME}_{number}": text[start : start + PIECE] for number, start in enumerate(starts)}


def record_in(content: bytes) -> bytes | None:
    """The record in the bytes of a DXF or SVG; None where there is none, or a piece of it is missing."""
    if NAME.encode() not in content:
        return None
    whole = IN_SVG.search(content)
    if whole is not None:
        return _decoded(whole[1])
    pieces = {int(number): text for number, text in IN_DXF.findall(content) or IN_R12.findall(content)}
    if not pieces or sorted(pieces) != list(range(len(pieces))):
        return None
    return _decoded(b"".join(text for _, text in sorted(pieces.items())))


def _decoded(text: bytes) -> bytes | None:
    try:
        return base64.b64decode(text, validate=True)
    except (binascii.Error, ValueError):
        return None
