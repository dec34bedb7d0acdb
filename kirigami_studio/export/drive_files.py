"""Board and arms of a pinned sheet in its lists: spacers, screws, steps."""

from __future__ import annotations

from collections.abc import Mapping

from kirigami_studio.assembly.driving import DriveParts
from kirigami_studio.export.hold_files import PartsEntry
from kirigami_studio.fabricate.drive import BAR_MM, BEHIND_MM, HORN_MM, DriveKind
from kirigami_studio.fabricate.fastener import FastenerSize

#: Steps of assembly, for either drive.
DRIVE_STEPS: Mapping[DriveKind, tuple[str, ...]] = {
    DriveKind.CRANK: (
        "Glue the square bar into ARM1, put it through the round hole of the board, and glue it into HANDLE behind.",
    ),
    DriveKind.SERVO: (
        "Screw the servo to the board from behind, its shaft through the cut-out. With the servo at one end of its "
        "way, screw ARM1 to its horn as the picture of the flat sheet shows it.",
    ),
}
COMMON_STEPS = (
    "Screw ARM2, where there is one, to the board with its spacer, so that it turns.",
    "Put the long screws from the front through the pins of the list, their spacers behind the sheet: into the board "
    "at the fixed piece, into the arms at the others. Heads and nuts of all other pins turn clear of the spacers.",
)


def drive_steps(drive: DriveParts) -> tuple[str, ...]:
    """Steps of assembly of a drive."""
    return (*DRIVE_STEPS[drive.kind], *COMMON_STEPS)


def gap_mm(kind: DriveKind, thickness_mm: float, beyond_mm: float) -> float:
    """Room between arms and board, mm: for nuts, or for the horn of a servo."""
    return beyond_mm if kind is DriveKind.CRANK else max(beyond_mm, HORN_MM - thickness_mm)


def drive_lines(drive: DriveParts | None, thickness_mm: float, hole_mm: float, size: FastenerSize) -> list[PartsEntry]:
    """Lines of the parts list.

    Parameters
    ----------
    drive : DriveParts or None
    thickness_mm : float
        Of the sheet, the arms and the board.
    hole_mm : float
        Diameter of the holes.
    size : FastenerSize
        Of the pins.
    """
    if drive is None:
        return []
    nut, gap = size.beyond_mm, gap_mm(drive.kind, thickness_mm, size.beyond_mm)
    column, whole = nut + thickness_mm + gap, 2.0 * thickness_mm
    columns = ", ".join("+".join(hinge.pieces) for hinge in drive.columns)
    led = ", ".join(f"{'+'.join(arm.hinge.pieces)} to ARM{number}" for number, arm in enumerate(drive.arms, start=1))
    wide = f"at most {size.head_mm:g} mm wide"
    arms, followers = len(drive.arms), len(drive.arms) - 1
    found = [
        PartsEntry("spacers", len(drive.columns), hole_mm, column, f"from the sheet to the board, {wide}; {columns}"),
        PartsEntry(
            "screws", len(drive.columns), hole_mm, whole + column + thickness_mm + nut, f"instead of pins; {columns}"
        ),
        PartsEntry("spacers", arms, hole_mm, nut, f"from the sheet to the arms, {wide}; {led}"),
        PartsEntry("screws", arms, hole_mm, whole + nut + thickness_mm + nut, f"instead of pins; {led}"),
    ]
    if followers:
        found += [
            PartsEntry("spacers", followers, hole_mm, gap, "from ARM2 to the board"),
            PartsEntry("screws", followers, hole_mm, 2.0 * thickness_mm + gap + nut, "for ARM2, in the board"),
        ]
    behind = BEHIND_MM
    if drive.kind is DriveKind.CRANK:
        behind = nut + thickness_mm + nut
        bar = 3.0 * thickness_mm + gap + nut
        found.append(PartsEntry("square bar", 1, BAR_MM, bar, f"{BAR_MM:g} x {BAR_MM:g} mm, from ARM1 to HANDLE"))
    else:
        found.append(PartsEntry("servo", 1, None, None, "SG90, with its horn and screws; measure yours: sizes vary"))
    found.append(PartsEntry("spacers", 4, None, behind, "from the board to the wall, at its corners"))
    return found
