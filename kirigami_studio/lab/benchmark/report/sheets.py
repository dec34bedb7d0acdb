"""The parts of the report about sheets: whole runs shape by shape, and sheets as cut."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from kirigami_studio.lab.benchmark.report.cells import Figures


def shapes_section(sets: Mapping[str, Figures]) -> Iterator[str]:
    """First designs of whole runs, shape by shape."""
    yield "## Shape by shape"
    yield ""
    yield (
        "The first closed design of a run for each shape: exact IoU, sIoU as released, coefficient of variation (CV) "
        "of panel areas, and the symmetry that the sheet keeps. *Covered*: exact IoU of the first design that covers "
        "the target and is cut along its outline, with the share of the sheet that falls off, where the run makes one. "
        "`kirigami-studio benchmark designs --json`"
    )
    for name, figures in sets.items():
        low, high = figures["iou_exact_interval"]
        yield ""
        yield (
            f"{name}, {figures['targets']} shapes: mean exact IoU **{figures['iou_exact']:.4f}** "
            f"({low:.4f} - {high:.4f}), worst {figures['iou_exact_worst']:.4f} ({figures['iou_exact_worst_name']}); CV "
            f"{figures['panel_area_cv']:.2f}; uniform sheet {figures['uniform_iou']:.3f}. Closed or covered, whichever "
            f"matches better: mean **{figures['best_of_families']['match']:.4f}**, worst "
            f"{figures['best_of_families']['match_worst']:.4f} ({figures['best_of_families']['match_worst_name']})"
        )
        yield ""
        yield (
            "| shape | grid | uniform sheet | its as released | exact IoU | as released | CV | symmetry | covered | "
            "seconds |"
        )
        yield "|---" * 10 + "|"
        for shape, row in figures["shapes"].items():
            yield (
                f"| {shape} | {row['grid']} | {row['uniform_iou']:.3f} | {row['uniform_siou_released']:.3f} | "
                f"{row['iou_exact']:.4f} | {row['siou_released']:.4f} | {row['panel_area_cv']:.2f} | "
                f"{(row['symmetry'] or '').replace('_', ' ')} | {_cover(row)} | {row['seconds']:.1f} |"
            )
    yield ""


def _cover(row: Figures) -> str:
    """Match of the first design that covers its target, and what falls off."""
    cover = row.get("cover")
    return "" if cover is None else f"{cover['match']:.4f} ({100 * cover['given_up']:.0f} %)"


def as_cut_section(figures: Figures) -> Iterator[str]:
    """Sheets read back from their files and closed on their connectors."""
    yield "## As cut"
    yield ""
    yield (
        "Sheets in film, 100 mm wide: the cut file read back, and the sheet closed on its "
        "connectors to 2 degrees. The paper cut a heart, a star and a hexagon and gives no such numbers. "
        "`kirigami-studio benchmark as-cut`"
    )
    yield ""
    yield (
        "| silhouette | connectors (mm) | file passed | pieces | narrower | jams | stretch (widths) | uniform sheet "
        "| IoU designed | IoU as cut | as released |"
    )
    yield "|---" * 11 + "|"
    for sheet in figures["sheets"]:
        jam = "closes" if sheet["jam_deg"] == 0.0 else f"{sheet['jam_deg']:.0f} degrees"
        yield (
            f"| {sheet['name']} | {sheet['connector_mm']:g} | {'yes' if sheet['passed'] else 'NO'} | "
            f"{sheet['pieces']} | {sheet['narrowed']} of {sheet['connectors']} | {jam} | {sheet['stretch']:.3f} | "
            f"{sheet['uniform_iou']:.4f} | {sheet['iou']:.4f} | {sheet['iou_as_cut']:.4f} | "
            f"{sheet['siou_released']:.4f} |"
        )
    for sentence in figures["refused"]:
        yield ""
        yield sentence
    yield ""
