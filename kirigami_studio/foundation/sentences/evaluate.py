"""Sentences of ``evaluate``: silhouettes, masks and poses that cannot be measured, and trims that cannot be made."""

from __future__ import annotations

from kirigami_studio.foundation.words import mark

SENTENCES: dict[str, str | tuple[str, str]] = {
    "silhouette.not_a_table": mark("A silhouette must be a table of numbers, one x, y pair per row."),
    "silhouette.too_few_points": mark(
        "A silhouette needs at least three points, one x, y pair per row; got an array of shape {shape}."
    ),
    "silhouette.not_finite": mark("Point {point} of the silhouette is ({x}, {y}); its coordinates must be finite."),
    "silhouette.no_area": mark("The silhouette has no area: its points lie on one line, or its parts cancel out."),
    "siou.mask_too_thin": mark("Mask {number} shows only lines thinner than 1/{size} of its length. Draw them bolder."),
    "siou.mask_ragged": mark("Mask {number} must be a 2-D array of numbers; its rows have different lengths."),
    "siou.mask_not_a_table": mark("Mask {number} must be a 2-D array of numbers, got shape {shape} of type {kind}."),
    "siou.mask_not_finite": mark("Mask {number} holds {value} at row {row}, column {column}; use 0 and 1."),
    "siou.mask_empty": mark("Mask {number} is empty: none of its {rows} x {columns} pixels is foreground."),
    "raster.size_out_of_range": mark("The mask size must be a whole number from 2 to {most} pixels, got {size!r:.80}."),
    "opened_size.width_not_positive": mark("The width of the sheet must be above 0 mm, got {width_mm:g}."),
    "similarity.not_finite": mark(
        "A similarity needs a positive scale and finite numbers, got scale {scale:g}, angle {angle:g}, shift "
        "({x:g}, {y:g})."
    ),
    "trim.crosses_itself": mark(
        "This design crosses itself at the target angle, so it cannot be trimmed. Choose another design."
    ),
    "trim.keep_out_of_range": mark(
        "The material kept at hinges must be {least:g} to {most:g} cells deep, got {keep!r:.80}."
    ),
}
