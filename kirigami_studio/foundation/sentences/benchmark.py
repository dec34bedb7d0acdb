"""Sentences of the benchmark suites, by the code of the problem."""

from __future__ import annotations

from kirigami_studio.foundation.words import mark

SENTENCES: dict[str, str | tuple[str, str]] = {
    "benchmark.no_targets_found": mark(
        "No targets found to measure on. Name a file, a folder with shapes, or 'library'."
    ),
    "benchmark.no_targets": mark("This suite needs at least one target, got none."),
    "benchmark.starts_differ": mark("Fits need one start for each outline, got {starts} for {outlines}."),
    "benchmark.too_few_to_time": mark(
        "Timings need at least one variant and two targets, got {variants} and {targets}."
    ),
    "benchmark.spread_of_one": mark("A spread needs at least 2 samples of each target, got {k}."),
}
