"""Sentences of ``pipeline``, by the code of the problem."""

from __future__ import annotations

from kirigami_studio.foundation.words import mark

SENTENCES: dict[str, str | tuple[str, str]] = {
    "fit.stopped": mark("Fitting stopped; nothing changed."),
    "trim.stopped": mark("Trimming stopped; nothing changed."),
    "trim.connectors_too_wide": mark(
        "Connectors of {connector_mm:g} mm leave nothing to trim on a sheet {width_mm:g} mm wide. Make the sheet at "
        "least {least_mm} mm wide or the connectors narrower."
    ),
}
