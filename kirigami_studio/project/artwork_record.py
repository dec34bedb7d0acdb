"""The artwork of a document inside the project file: the bytes of its pictures, once, and how they lie.

An artwork that cannot be read is left out with a note: the design is complete without it.
"""

from __future__ import annotations

import io
import json
from collections.abc import Mapping

import numpy as np
from PIL import Image

from kirigami_studio.export.artwork import ArtPicture, Artwork, Laid, PictureFit, SheetState
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import KirigamiError, ProjectError
from kirigami_studio.project.json_record import Record, one_of, read_json

RECORD = "artwork.json"
#: Decimals of lines, pixels.
DECIMALS = 3
#: Members that pictures may be stored as.
PICTURES = ("artwork.png", "artwork.jpg", "artwork2.png", "artwork2.jpg")


def artwork_members(artwork: Artwork | None) -> dict[str, bytes]:
    """The members of a project file that store the artwork, if there is one."""
    if artwork is None:
        return {}
    laid = artwork.first
    record: dict[str, object] = {
        "name": laid.picture.name,
        "picture": f"artwork{laid.picture.extension}",
        "state": laid.state.value,
        "fitting": laid.fitting.value,
        "scale": laid.scale,
        "turn": laid.turn,
        "shift": list(laid.shift),
        **_lines_record(laid.picture),
    }
    pictures = {f"artwork{laid.picture.extension}": laid.picture.content}
    if artwork.second is not None:
        member = f"artwork2{artwork.second.extension}"
        second = {"name": artwork.second.name, "picture": member, **_lines_record(artwork.second)}
        record |= {"second": second, "stripes": artwork.stripes}
        pictures[member] = artwork.second.content
    return {RECORD: json.dumps(record, indent=1).encode(), **pictures}


def artwork_of(members: Mapping[str, bytes]) -> Artwork | None:
    """The artwork that is stored in a project file, None without one.

    Raises
    ------
    ProjectError
        It is damaged or missing.
    """
    if RECORD not in members:
        return None
    try:
        record = Record(read_json(members[RECORD], RECORD), RECORD)
        laid = Laid(
            _picture(record, members),
            one_of(SheetState, record.text("state")),
            one_of(PictureFit, record.text("fitting")),
            record.number("scale"),
            record.number("turn"),
            record.pair("shift"),
        )
        if not record.holds("second"):
            return Artwork(laid)
        return Artwork(laid, _picture(record.record("second"), members), record.whole("stripes"))
    except (KirigamiError, OSError, ValueError, TypeError, SyntaxError, Image.DecompressionBombError) as error:
        raise ProjectError("artwork.left_out", reason=error) from error


def _lines_record(picture: ArtPicture) -> dict[str, object]:
    """The lines of a picture, x and y of one point after the other."""
    if not picture.lines:
        return {}
    return {"lines": [(line.round(DECIMALS) + 0.0).ravel().tolist() for line in picture.lines]}


def _lines(record: Record) -> tuple[FloatArray, ...]:
    """The lines that a record has."""
    if not record.holds("lines"):
        return ()
    found = tuple(np.array(line, dtype=np.float64) for line in record.list("lines"))
    if any(line.ndim != 1 or len(line) < 4 or len(line) % 2 or not np.isfinite(line).all() for line in found):
        raise ProjectError("json.not_a_number", place=f"{RECORD}.lines", value=record.list("lines"))
    return tuple(line.reshape(-1, 2) for line in found)


def _picture(record: Record, members: Mapping[str, bytes]) -> ArtPicture:
    """The picture that a record names."""
    member = record.text("picture")
    if member not in PICTURES or member not in members:
        raise ProjectError("project.member_missing", name=member)
    with Image.open(io.BytesIO(members[member]), formats=("PNG", "JPEG")) as image:
        return ArtPicture(record.text("name"), members[member], image.size, _lines(record))
