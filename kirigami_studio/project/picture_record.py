"""The picture that a target was traced from, inside the project file: its bytes, its threshold, its place.

It is no part of the document: a picture that cannot be stored or read is left out with a note, and the project is
complete without it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from kirigami_studio.foundation.errors import KirigamiError, ProjectError
from kirigami_studio.foundation.plain_text import plain_line
from kirigami_studio.outlines.read import PICTURES
from kirigami_studio.project.json_record import Record, read_json

RECORD = "picture.json"
#: Larger pictures are not stored.
LARGEST_PICTURE = 16 * 2**20


@dataclass(frozen=True, slots=True)
class TracedPicture:
    """A picture and how the target was traced from it.

    Raises
    ------
    ProjectError
        No such name, too large, or numbers that no picture has.
    """

    name: str  #: of its file, with the extension; the target is named after it
    content: bytes  #: of its file
    #: automatic, threshold: grey levels, 0 black .. 1 white: the one that would be chosen, and the one that was.
    automatic: float
    threshold: float
    scale: float  #: source pixels; length in the picture of one unit of the outline
    centre: tuple[float, float]  #: (x, y), source pixels; the outline's centroid, from the lower left corner
    size: tuple[int, int]  #: (width, height), source pixels

    def __post_init__(self) -> None:
        if "\0" in self.name or Path(self.name).name != self.name or Path(self.name).suffix.lower() not in PICTURES:
            raise ProjectError("picture.not_a_picture_name", name=self.name, extensions=", ".join(PICTURES))
        if len(self.content) > LARGEST_PICTURE:
            megabytes, limit = len(self.content) / 2**20, LARGEST_PICTURE // 2**20
            raise ProjectError("picture.too_large", name=self.name, megabytes=megabytes, limit=limit)
        levels_fit = 0.0 <= self.automatic <= 1.0 and 0.0 < self.threshold < 1.0
        if not levels_fit or self.scale <= 0.0 or min(self.size) < 1:
            raise ProjectError("picture.impossible_number", name=self.name)

    @property
    def member(self) -> str:
        """Its name in the project file."""
        return f"picture{Path(self.name).suffix.lower()}"


def picture_members(picture: TracedPicture | None) -> dict[str, bytes]:
    """The members of a project file that store the picture, if there is one."""
    if picture is None:
        return {}
    record = {
        "name": picture.name,
        "automatic": picture.automatic,
        "threshold": picture.threshold,
        "scale": picture.scale,
        "centre": list(picture.centre),
        "size": list(picture.size),
    }
    return {RECORD: json.dumps(record, indent=1).encode(), picture.member: picture.content}


def picture_of(members: Mapping[str, bytes]) -> TracedPicture | None:
    """The picture that is stored in a project file, None without one.

    Raises
    ------
    ProjectError
        It is damaged or missing.
    """
    if RECORD not in members:
        return None
    try:
        record = Record(read_json(members[RECORD], RECORD), RECORD)
        name = record.verbatim("name")
        member = f"picture{Path(name).suffix.lower()}"
        if member not in members:
            raise ProjectError("project.member_missing", name=member)
        width, height = record.pair("size")
        return TracedPicture(
            name=name if "\0" in name else plain_line(name),  # no file has such a name: it is refused
            content=members[member],
            automatic=record.number("automatic"),
            threshold=record.number("threshold"),
            scale=record.number("scale"),
            centre=record.pair("centre"),
            size=(int(width), int(height)),
        )
    except (KirigamiError, ValueError) as error:
        raise ProjectError("picture.left_out", reason=error) from error
