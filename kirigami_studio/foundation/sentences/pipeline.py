"""Sentences of ``pipeline``: requests that make no sense, and runs that ended early."""

from __future__ import annotations

from kirigami_studio.foundation.words import mark

SENTENCES: dict[str, str | tuple[str, str]] = {
    "fit.stopped": mark("Fitting stopped; nothing changed."),
    "request.angle_out_of_range": mark(
        "The target angle must be at least 0 and below pi radians, got {phi:g}. The usual choice is 0."
    ),
    "request.budget_not_positive": mark(
        "The time budget must be a finite number of seconds above 0, got {budget!r:.80}."
    ),
    "request.k_out_of_range": mark(
        "The number of candidates (k) must be a whole number from {least} to {most}, got {value!r:.80}."
    ),
    "request.near_other_grid": mark(
        "Samples near a design have its grid of {near_rows} x {near_columns} voids, not {rows} x {columns}."
    ),
    "request.nearness_out_of_range": mark("The nearness must be a number from 0 to less than 1, got {nearness!r:.80}."),
    "request.nearness_without_design": mark("A nearness needs the design that the samples should be near."),
    "request.polish_out_of_range": mark(
        "The number of polishing steps must be a whole number from {least} to {most}, got {value!r:.80}."
    ),
    "request.search_out_of_range": mark(
        "The search effort must be a whole number from {least} to {most}, got {value!r:.80}."
    ),
    "request.seed_out_of_range": mark("The seed must be a whole number from {least} to {most}, got {value!r:.80}."),
    "request.steps_out_of_range": mark(
        "The number of sampling steps must be a whole number from {least} to {most}, got {value!r:.80}."
    ),
    "request.unknown_preference": mark("A fit can prefer {choices}, not {prefer!r:.80}."),
    "run.no_result": mark("The run ended without a result."),
    "run.stopped_polishing": mark("Stopped while polishing, with {done} of {total} done; nothing changed."),
    "run.stopped_scoring": mark("Stopped after {done} of {total} candidates; nothing changed."),
    "run.stopped_searching": mark("Stopped while searching, with {done} of {total} done; nothing changed."),
    "run.stopped_trimming": mark("Stopped while trimming, with {done} of {total} done; nothing changed."),
    "trim.connectors_too_wide": mark(
        "Connectors of {connector_mm:g} mm leave nothing to trim on a sheet {width_mm:g} mm wide. Make the "
        "sheet at least {least_mm} mm wide or the connectors narrower."
    ),
    "trim.stopped": mark("Trimming stopped; nothing changed."),
}
