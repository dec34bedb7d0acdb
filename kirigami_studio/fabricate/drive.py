"""Drives that turn pinned sheets from behind: sizes of boards, arms, and of a small servo."""

from __future__ import annotations

from enum import StrEnum

#: Width of arms, mm, and how long they may be.
ARM_MM, SHORTEST_MM, LONGEST_MM = 16.0, 20.0, 90.0
#: Least room between parts that pass each other, and least wall between cuts of the board, mm.
ROOM_MM, WALL_MM = 1.0, 4.0
#: Margin of the board round all that moves over it, mm; screws to the wall stand in it, with holes as wide as these.
MARGIN_MM, WALL_SCREW_MM = 14.0, 4.2
#: Side of the square bar that a crank turns by, and its round hole in the board, mm.
BAR_MM, BAR_HOLE_MM = 6.0, 8.8
#: Length of the handle of a crank, mm.
HANDLE_MM = 60.0
#: A servo of size SG90, mm: cut-out of its case, distance and holes of its screws, distance of the shaft from the
#: middle of the case, height of the horn's face over the flange, and depth that it takes behind the board.
CASE_MM, SCREWS_MM, SCREW_HOLE_MM, SHAFT_MM, HORN_MM, BEHIND_MM = (23.2, 12.6), 27.8, 2.0, 5.3, 12.0, 25.0
#: The same: hole over the screw of the horn, and the slot over the horn's own holes: from, to, width, mm.
HORN_SCREW_MM, HORN_SLOT_MM = 5.0, (6.5, 14.0, 1.8)
#: Narrowest hole of pins that screws pass, mm: brads have no thread for spacers.
LEAST_SCREW_MM = 2.0


class DriveKind(StrEnum):
    """Ways to move a pinned sheet; the values stand on the command line and in files."""

    NONE = "none"
    CRANK = "crank"
    SERVO = "servo"
