"""The artwork of a document inside the project file: the bytes of its picture, once, and where it lies.

An artwork that cannot be read is left out with a note: the design is complete without it.
"""

from __future__ import annotations

import io
import json
from collections.abc import Mapping

from PIL import Image

from kirigami_studio.export.artwork import ArtPicture, Artwork, Fitting, Laid, State
from kirigami_studio.foundation.errors import KirigamiError, ProjectError
from kirigami_studio.project.json_record import Record, one_of, read_json

RECORD = "artwork.json"
#: Members that the picture may be stored as.
PICTURES = ("artwork.png", "artwork.jpg")


def artwork_members(artwork: Artwork | None) -> dict[str, bytes]:
    """The members of a project file that store the artwork, if there is one."""
    if artwork is None:
        return {}
    laid = artwork.first
    record = {
        "name": laid.picture.name,
        "picture": f"artwork{laid.picture.extension}",
        "state": laid.state.value,
        "fitting": laid.fitting.value,
        "scale": laid.scale,
        "turn": laid.turn,
        "shift": list(laid.shift),
    }
    return {RECORD: json.dumps(record, indent=1).encode(), f"artwork{laid.picture.extension}": laid.picture.content}


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
        member = record.text("picture")
        if member not in PICTURES or member not in members:
            raise ProjectError("project.member_missing", name=member)
        content = members[member]
        with Image.open(io.BytesIO(content), formats=("PNG", "JPEG")) as image:
            size = image.size
        picture = ArtPicture(record.text("name"), content, size)
        laid = Laid(
            picture,
            one_of(State, record.text("state")),
            one_of(Fitting, record.text("fitting")),
            record.number("scale"),
            record.number("turn"),
            record.pair("shift"),
        )
        return Artwork(laid)
    except (KirigamiError, OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        raise ProjectError("artwork.left_out", reason=error) from error
