"""Sentences of ``assembly``, by the code of the problem: sizes of pins, findings on pieces."""

from __future__ import annotations

from kirigami_studio.foundation.words import mark, mark_n

SENTENCES: dict[str, str | tuple[str, str]] = {
    "pins.out_of_range": mark("{name} of pinned pieces must be from {least:g} to {most:g}, got {value!r:.40}."),
    "pins.ear_within_hole": mark(
        "An ear of {ear_mm:g} mm does not hold a hole of {pin_mm:g} mm and necks of {neck_mm:g} mm. Make the ear "
        "wider, or holes and necks smaller."
    ),
    "pins.sheet_too_narrow": mark(
        "A sheet of {width_mm:g} mm has no room for a margin of {margin_mm:g} mm. Make the sheet wider or the pins "
        "smaller."
    ),
    "pinned.falls_apart": mark_n(
        "Piece {piece} falls apart: the ears of its neighbours cut it through. Make the ears smaller or the sheet "
        "larger.",
        "{count} pieces, {piece} first, fall apart: the ears of their neighbours cut them through. Make the ears "
        "smaller or the sheet larger.",
    ),
    "pinned.ears_meet": mark_n(
        "{count} pair of pins of one layer comes as near as {gap_mm:.1f} mm; ears and clearance need {needed_mm:.1f}"
        " mm. Make the ears smaller or the sheet larger, or fit the design for these pins.",
        "{count} pairs of pins of one layer come as near as {gap_mm:.1f} mm; ears and clearance need {needed_mm:.1f}"
        " mm. Make the ears smaller or the sheet larger, or fit the design for these pins.",
    ),
    "pinned.pieces_collide": mark(
        "Pieces of one layer overlap by {overlap_mm2:.2f} mm2 at {angle_deg:.0f} degrees. Choose another design."
    ),
    "pinned.wall_too_thin": mark_n(
        "A hole of piece {piece} has a wall of {wall_mm:.1f} mm, {needed_mm:.1f} mm are asked for. Make the holes "
        "smaller or the sheet larger.",
        "Holes of {count} pieces have less wall than {needed_mm:.1f} mm; one of piece {piece} has {wall_mm:.1f} mm. "
        "Make the holes smaller or the sheet larger.",
    ),
    "pinned.neck_too_narrow": mark_n(
        "Piece {piece} has a neck of {neck_mm:.1f} mm, {needed_mm:.1f} mm are asked for. Make the ears smaller or "
        "the sheet larger.",
        "{count} pieces have necks narrower than {needed_mm:.1f} mm; that of piece {piece} is {neck_mm:.1f} mm wide. "
        "Make the ears smaller or the sheet larger.",
    ),
    "pinned.heads_meet": mark(
        "Two pins come as near as {apart_mm:.1f} mm, and their heads are {head_mm:.1f} mm wide. Use smaller heads or"
        " a larger sheet."
    ),
    "pinned.flat_outline_spoilt": mark(
        "The flat outline lacks {lost:.1f} % of its area, and {beyond:.1f} % stick out of it."
    ),
    "pinned.target_missed": mark(
        "The target lacks {lost:.1f} % of its area, and {beyond:.1f} % stick out of it. Choose another design or a "
        "finer grid."
    ),
}
