"""Sentences of ``lattice``: grids, ratios, angles and cells that make no sheet."""

from __future__ import annotations

from kirigami_studio.foundation.words import mark

SENTENCES: dict[str, str | tuple[str, str]] = {
    "grid.not_whole_numbers": mark("The grid must be two whole numbers of voids, got {rows!r:.40} x {columns!r:.40}."),
    "grid.out_of_range": mark("The grid must have {least} to {most} voids each way, got {rows} x {columns}."),
    "ratios.not_numbers": mark("Ratios must be an (m, n) table of numbers."),
    "ratios.wrong_shape": mark("Ratios must have shape (m, n), got {shape}."),
    "ratios.wrong_batch_shape": mark("Ratios must have shape (B, {rows}, {columns}), got {shape}."),
    "ratio.not_finite": mark("The ratio at void ({row}, {column}) is {ratio}; it must be finite."),
    "ratio.not_positive": mark("The ratio at void ({row}, {column}) is {ratio:g}; it must be above 0."),
    "ratio.out_of_range": mark(
        "The ratio at void ({row}, {column}) is {ratio:g}; it must be {least:g} to {most:g}, where the layout is exact."
    ),
    "angle.not_a_number": mark("The deployment angle must be a number in radians, got {phi!r:.80}."),
    "angle.out_of_range": mark("The deployment angle must be 0 to pi radians (pi is the compact sheet), got {phi:g}."),
    "cell.not_positive": mark("A cell needs a width and a height above 0, got {cell!r:.80}."),
}
