"""A drawing to look at beside the cut file: connectors as numbered circles, and notes.  Never for the cutter.

Programs cut or engrave such marks, whatever their layer says; so they never stand in a cut file.
"""

from __future__ import annotations

from pathlib import Path

from ezdxf.document import Drawing

from kirigami_studio.export.dxf import check_marked, strokes_dxf
from kirigami_studio.export.facts import facts_of
from kirigami_studio.export.profile import BLUE, WHITE, find_profile
from kirigami_studio.export.strokes import extent, strokes_of
from kirigami_studio.export.verified import write_verified
from kirigami_studio.fabricate.cut_plan import CutPlan

CONNECTOR_LAYER, NOTE_LAYER = "CONNECTORS", "NOTES"
#: Radius (mm) of a connector's circle: large enough to be seen.
CIRCLE_MM = 0.6
NUMBER_MM, NOTE_MM = 0.8, 3.0
#: Distance (mm) of the notes from the sheet, and of their lines.
NOTE_GAP_MM, NOTE_LINE_MM = 10.0, 5.0
PROFILE = "lightburn"


def write_reference(plan: CutPlan, path: str | Path) -> Path:
    """Write the reference drawing, read it back, and return its path.

    Raises
    ------
    ExportError
        An unwritable place, or a file that did not read back.
    """
    goal = Path(path)
    strokes = strokes_of(plan, find_profile(PROFILE))
    size = extent(strokes)
    facts = {**facts_of(plan, find_profile(PROFILE)), "PURPOSE": "reference, not for cutting"}
    content = strokes_dxf(strokes, size, "R2010", facts, lambda document: _mark(document, plan, facts))
    circles = len(plan.hinges)
    write_verified(goal, content, lambda written: check_marked(written, strokes, {"CIRCLE": circles}))
    return goal


def _mark(document: Drawing, plan: CutPlan, facts: dict[str, str]) -> None:
    """Add the circles with their numbers, and the notes beside the sheet."""
    modelspace = document.modelspace()
    document.layers.add(CONNECTOR_LAYER, color=WHITE)
    document.layers.add(NOTE_LAYER, color=BLUE)
    for number, (x, y) in enumerate(plan.hinges.position.tolist()):
        modelspace.add_circle((x, y), CIRCLE_MM, dxfattribs={"layer": CONNECTOR_LAYER})
        _write(document, str(number), x + CIRCLE_MM, y + CIRCLE_MM, NUMBER_MM)
    width, height = plan.bounds_mm
    widths = "Numbers are those of single connector widths and removed connectors."
    for line, text in enumerate([*(f"{key}: {value}" for key, value in facts.items()), *plan.notes, widths]):
        _write(document, text, width + NOTE_GAP_MM, height - NOTE_MM - line * NOTE_LINE_MM, NOTE_MM)


def _write(document: Drawing, text: str, x: float, y: float, height: float) -> None:
    attributes = {"layer": NOTE_LAYER, "height": height, "insert": (x, y)}
    document.modelspace().add_text(text, dxfattribs=attributes)
