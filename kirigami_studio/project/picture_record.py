"""The picture that a target was traced from, inside the project file: its bytes, its threshold, its place.

It is no part of the document: what cannot be kept or read again is left out with a sentence, and the project is whole
without it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from kirigami_studio.foundation.errors import KirigamiError, ProjectError
from kirigami_studio.project.json_record import Record, read_json

RECORD = "picture.json"
#: Kinds that a project keeps, by the extension of their member.
EXTENSIONS = (".png", ".jpg", ".jpeg", ".bmp")
#: Larger pictures stay outside of the project.
LARGEST_PICTURE = 16 * 2**20


@dataclass(frozen=True, slots=True)
class TracedPicture:
    """A picture and how the target was traced from it.

    Attributes
    ----------
    name : str
        Of its file, with the extension; the target is named after it.
    content : bytes
        Of its file.
    automatic, threshold : float
        Grey levels, 0 black .. 1 white: the one that would be chosen, and the one that was.
    scale : float, source pixels
        Length in the picture of one unit of the outline.
    centre : (x, y) float, source pixels
        The outline's centroid, from the lower left corner.
    size : (width, height) int, source pixels

    Raises
    ------
    ProjectError
        No such name, too large, or numbers that no picture has.
    """

    name: str
    content: bytes
    automatic: float
    threshold: float
    scale: float
    centre: tuple[float, float]
    size: tuple[int, int]

    def __post_init__(self) -> None:
        if "\0" in self.name or Path(self.name).name != self.name or Path(self.name).suffix.lower() not in EXTENSIONS:
            raise ProjectError(f"{self.name[:60]!r} is no name of a picture ({', '.join(EXTENSIONS)})")
        if len(self.content) > LARGEST_PICTURE:
            megabytes = len(self.content) / 2**20
            raise ProjectError(f"{self.name} has {megabytes:.0f} MB, more than {LARGEST_PICTURE // 2**20}")
        levels_fit = 0.0 <= self.automatic <= 1.0 and 0.0 < self.threshold < 1.0
        if not levels_fit or self.scale <= 0.0 or min(self.size) < 1:
            raise ProjectError(f"the record of {self.name} holds a number that no picture has")

    @property
    def member(self) -> str:
        """Its name in the project file."""
        return f"picture{Path(self.name).suffix.lower()}"


def picture_members(picture: TracedPicture | None) -> dict[str, bytes]:
    """The members of a project file that keep a picture; none for none."""
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
    """The picture that a project file keeps, None if it keeps none.

    Raises
    ------
    ProjectError
        It keeps one that is damaged or not there.
    """
    if RECORD not in members:
        return None
    try:
        record = Record(read_json(members[RECORD], RECORD), RECORD)
        name = record.text("name")
        member = f"picture{Path(name).suffix.lower()}"
        if member not in members:
            raise ProjectError(f"{member} is missing")
        width, height = record.pair("size")
        return TracedPicture(
            name=name,
            content=members[member],
            automatic=record.number("automatic"),
            threshold=record.number("threshold"),
            scale=record.number("scale"),
            centre=record.pair("centre"),
            size=(int(width), int(height)),
        )
    except (KirigamiError, ValueError) as error:
        raise ProjectError(f"The photo in this project cannot be read and was left out: {error}.") from error
