"""Sentences of ``polish``: fits and drags that make no sense."""

from __future__ import annotations

from kirigami_studio.foundation.words import mark

SENTENCES: dict[str, str | tuple[str, str]] = {
    "drag.no_such_vertex": mark("The outline has vertices 0 to {last}, got {vertex}."),
    "fit.angle_compact": mark(
        "A fit needs an angle below pi radians: at pi the sheet is compact and shows a rectangle whatever its ratios."
    ),
    "fit.excess_out_of_range": mark("The weight of what sticks out must be a number from 0 to 1, got {excess!r:.80}."),
    "fit.least_panel_out_of_range": mark("The least panel size must be 0 to {most:g} cells, got {least!r:.80}."),
    "fit.locks_and_symmetry": mark(
        "A fit cannot keep locked voids and a symmetry at the same time. Choose one of them."
    ),
    "fit.locks_wrong_table": mark(
        "Locked voids must be a table of truth values of shape {shape}, got {got} of type {kind}."
    ),
    "fit.steps_not_whole": mark("The number of steps must be a whole number of at least 0, got {steps!r:.80}."),
    "fit.trust_not_positive": mark("The trusted distance must be a finite number above 0, got {trust:g}."),
    "fit.weights_out_of_range": mark(
        "The weights of a fit must be finite numbers of at least 0, got {start:g} for the start, {smooth:g} "
        "for smoothness and {total_variation:g} for total variation."
    ),
    "search.effort_out_of_range": mark(
        "The search effort must be a whole number from 1 to {most}, got {effort!r:.80}."
    ),
}
