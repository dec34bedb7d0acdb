"""Cut plan -> DXF in millimetres: one polyline for each cut, in cutting order, the same bytes every time.

Every file is read back with ezdxf and compared with the plan before it takes its name.  :func:`write_reference` draws
the same sheet with numbered connectors and notes beside it, to look at and not to cut.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from io import StringIO
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
from ezdxf import units, zoom
from ezdxf._options import options
from ezdxf.document import Drawing
from ezdxf.entities.lwpolyline import LWPolylinePoints
from ezdxf.filemanagement import new

from kirigami_studio.export.design_record import record_pieces
from kirigami_studio.export.dxf_reading import read_with_ezdxf
from kirigami_studio.export.file_content import FileContent, bent_otherwise
from kirigami_studio.export.profile import BLUE, DEFAULT_PROFILE, WHITE, DxfVersion, Profile, find_profile
from kirigami_studio.export.provenance import facts_of
from kirigami_studio.export.strokes import Stroke, extent, file_strokes, layer_colours
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically

#: Layers that every DXF document has whether wanted or not.
UNAVOIDABLE_LAYERS = frozenset({"0", "Defpoints"})
#: Coordinates survive the text form exactly; anything above this (mm) is a fault.
SAME_MM = 1e-9
CONNECTOR_LAYER, NOTE_LAYER = "CONNECTORS", "NOTES"
#: Radius (mm) of a connector's circle: large enough to be seen.
CIRCLE_MM = 0.6
NUMBER_MM, NOTE_MM = 0.8, 3.0
#: Distance (mm) of the notes from the sheet, and of their lines.
NOTE_GAP_MM, NOTE_LINE_MM = 10.0, 5.0
PROFILE = "lightburn"


def write_dxf(
    plan: CutPlan,
    path: str | Path,
    version: str = "R2010",
    profile: str | Profile = DEFAULT_PROFILE,
    record: bytes = b"",
) -> None:
    """Write a plan as one file, read it back and compare.

    Parameters
    ----------
    version : str
        "R2010", or "R12" for old programs; an R12 file cannot say its unit: import it as mm.
    profile : str or Profile
        What the machine's program wants; see ``layer_files`` for one file per layer.
    record : bytes
        The design that the plan cuts, see ``design_record``.

    Raises
    ------
    ExportError
        Unknown version or profile, unwritable place, or a file that did not come back as it was meant.
    """
    chosen = find_profile(profile) if isinstance(profile, str) else profile
    content = dxf_bytes(plan, version, chosen, record)
    strokes = file_strokes(plan, chosen)
    size = extent(strokes)
    write_atomically(Path(path), content, lambda written: check_written(written, strokes, size, version))


def dxf_bytes(plan: CutPlan, version: str, profile: Profile, record: bytes = b"") -> bytes:
    """Return the DXF file's bytes.

    Raises
    ------
    ExportError
        Unknown version, or a plan that the profile cannot show.
    """
    strokes = file_strokes(plan, profile)
    return strokes_dxf(strokes, extent(strokes), version, facts_of(plan, profile), record=record)


def strokes_dxf(
    strokes: Sequence[Stroke],
    size: tuple[float, float],
    version: str,
    facts: dict[str, str],
    mark: Callable[[Drawing], None] | None = None,
    record: bytes = b"",
) -> bytes:
    """Return a DXF of any strokes.

    Parameters
    ----------
    size : (width, height), mm
        What the header says; the lower left corner is the origin.
    mark : function, optional
        Draws more; never for a cut file.
    record : bytes
        The design, see ``design_record``.

    Raises
    ------
    ExportError
        Unknown version.
    """
    if version not in tuple(DxfVersion):
        raise ExportError("dxf.unknown_version", version=version)
    with _fixed_metadata():
        # R12 knows no units, and ezdxf.new would log that at every export.
        document = Drawing.new("R12") if version == "R12" else new(version, units=units.MM)
        document.header["$MEASUREMENT"] = 1
        for name, colour in layer_colours(strokes).items():
            document.layers.add(name, color=colour)
        _draw(document, strokes, version)
        if mark is not None:
            mark(document)
        _frame(document, size)
        _describe(document, facts, version)
        _enclose(document, record, version)
        if version != "R12":
            _sort_classes(document)
        text = StringIO()
        document.write(text)
    return document.encode(text.getvalue())


_FIXED_METADATA = threading.Lock()


@contextmanager
def _fixed_metadata() -> Iterator[None]:
    """Let ezdxf write a fixed date and identity, so that the same plan gives the same bytes."""
    with _FIXED_METADATA:
        before = options.write_fixed_meta_data_for_testing
        options.write_fixed_meta_data_for_testing = True
        try:
            yield
        finally:
            options.write_fixed_meta_data_for_testing = before


def _sort_classes(document: Drawing) -> None:
    """Put the CLASSES section in a fixed order; ezdxf fills it from a set, whose order differs between runs."""
    section = document.classes
    section.add_required_classes(document.dxfversion)
    section.classes = dict(sorted(section.classes.items()))


class _Text(str):
    """Tags that are written as they stand."""

    def dxfstr(self) -> str:
        return self


class _Corners(LWPolylinePoints):
    """Corners of a line without width, written in one go: ezdxf makes objects of each."""

    def dxftags(self) -> Iterator[Any]:
        rows = (
            f" 10\n{x}\n 20\n{y}\n 42\n{bulge}\n" if bulge else f" 10\n{x}\n 20\n{y}\n" for x, y, _, _, bulge in self
        )
        yield _Text("".join(rows))


def _draw(document: Drawing, strokes: Sequence[Stroke], version: str) -> None:
    modelspace = document.modelspace()
    for stroke in strokes:
        attributes = {"layer": stroke.layer, "color": stroke.colour}
        if stroke.circle:
            right, left = stroke.points.tolist()
            modelspace.add_circle((0.5 * (right[0] + left[0]), right[1]), 0.5 * (right[0] - left[0]), attributes)
            continue
        # x, y, widths at both ends, bulge
        table = np.zeros((len(stroke.points), LWPolylinePoints.VERTEX_SIZE))
        table[:, :2] = stroke.points
        table[:, 4] = 0.0 if stroke.bulges is None else stroke.bulges
        if version == "R12":
            form = "xy" if stroke.bulges is None else "xyseb"
            rows = table[:, : len(form)].tolist()
            modelspace.add_polyline2d(rows, format=form, close=stroke.closed, dxfattribs=attributes)
        else:
            line = modelspace.add_lwpolyline((), close=stroke.closed, dxfattribs=attributes)
            line.lwpoints = _Corners(table.tolist())  # one by one takes ten times as long


def _frame(document: Drawing, size: tuple[float, float]) -> None:
    """Say how large the drawing is, and let viewers open on it."""
    modelspace = document.modelspace()
    width, height = size
    modelspace.reset_extents((0.0, 0.0, 0.0), (width, height, 0.0))
    # ezdxf takes a corner at the origin for a missing one and would leave the header's extents empty.
    document.header["$EXTMIN"] = (0.0, 0.0, 0.0)
    document.header["$EXTMAX"] = (width, height, 0.0)
    modelspace.reset_limits((0.0, 0.0), (width, height))
    zoom.window(modelspace, (0.0, 0.0), (width, height))


def _describe(document: Drawing, facts: dict[str, str], version: str) -> None:
    """Say in the file how it was made; R12 has no custom variables, only ezdxf's own records."""
    record = document.ezdxf_metadata()
    for key, value in facts.items():
        record[key] = value
        if version != "R12":
            document.header.custom_vars.append(key, value)


def _enclose(document: Drawing, record: bytes, version: str) -> None:
    """Put the design into the file, where its facts are."""
    notes = document.ezdxf_metadata()
    for name, piece in record_pieces(record).items() if record else ():
        if version == "R12":
            notes[name] = piece
        else:
            document.header.custom_vars.append(name, piece)


def check_written(path: Path, strokes: Sequence[Stroke], size: tuple[float, float], version: str) -> None:
    """Read a written file back and compare everything that a cutter sees with what was meant.

    Raises
    ------
    ExportError
        With the first difference.
    """
    try:
        content = read_with_ezdxf(path)
    except ExportError as error:
        raise ExportError("dxf.not_read_back", reason=str(error)) from error
    if difference := _first_difference(content, strokes, size, version):
        raise difference


def _first_difference(
    content: FileContent, strokes: Sequence[Stroke], size: tuple[float, float], version: str
) -> ExportError | None:
    """The first difference from the plan; None where there is none."""
    if version != "R12" and content.unit != units.MM:
        return ExportError("dxf.other_unit", unit=content.unit)
    if content.extent != size:
        return ExportError("dxf.other_extent", extent=content.extent)
    if set(content.layers) - UNAVOIDABLE_LAYERS != set(layer_colours(strokes)):
        return ExportError("dxf.other_layers", layers=", ".join(sorted(content.layers)))
    if content.others:
        return ExportError("dxf.other_kind", kind=content.others[0])
    if len(content.strokes) != len(strokes):
        return ExportError("dxf.other_count", found=len(content.strokes), planned=len(strokes))
    differences = map(_stroke_difference, content.strokes, strokes, count())
    return next((difference for difference in differences if difference is not None), None)


def _stroke_difference(found: Stroke, meant: Stroke, number: int) -> ExportError | None:
    """How one entity, by its number in the file, differs from what was meant."""
    if (found.layer, found.colour) != (meant.layer, meant.colour):
        return ExportError("dxf.entity_on_other_layer", number=number, layer=found.layer, colour=found.colour)
    if found.closed != meant.closed:
        return ExportError("dxf.entity_closed" if found.closed else "dxf.entity_open", number=number)
    if found.points.shape != meant.points.shape or not np.all(np.abs(found.points - meant.points) <= SAME_MM):
        return ExportError("dxf.entity_moved", number=number)
    if found.circle != meant.circle or bent_otherwise([found], [meant], SAME_MM):
        return ExportError("dxf.entity_bent", number=number)
    return None


def write_reference(plan: CutPlan, path: str | Path) -> Path:
    """Write the reference drawing, read it back, and return its path.

    Raises
    ------
    ExportError
        An unwritable place, or a file that did not read back.
    """
    goal = Path(path)
    strokes = file_strokes(plan, find_profile(PROFILE))
    size = extent(strokes)
    facts = {**facts_of(plan, find_profile(PROFILE)), "PURPOSE": "reference, not for cutting"}
    content = strokes_dxf(strokes, size, "R2010", facts, lambda document: _mark(document, plan, facts))
    circles = len(plan.hinges)
    write_atomically(goal, content, lambda written: check_marked(written, strokes, {"CIRCLE": circles}))
    return goal


def _mark(document: Drawing, plan: CutPlan, facts: dict[str, str]) -> None:
    """Add the circles with their numbers, and the notes beside the sheet."""
    modelspace = document.modelspace()
    document.layers.add(CONNECTOR_LAYER, color=WHITE)
    document.layers.add(NOTE_LAYER, color=BLUE)
    for number, (x, y) in enumerate(plan.hinges.position.tolist()):
        modelspace.add_circle((x, y), CIRCLE_MM, dxfattribs={"layer": CONNECTOR_LAYER})
        _write(document, str(number), x + CIRCLE_MM, y + CIRCLE_MM, NUMBER_MM)
    width, height = plan.copies.spread_mm
    widths = "Numbers are those of single connector widths and removed connectors."
    facts_lines = [f"{key}: {value}" for key, value in facts.items()]
    for line, text in enumerate([*facts_lines, *(note.text for note in plan.notes), widths]):
        _write(document, text, width + NOTE_GAP_MM, height - NOTE_MM - line * NOTE_LINE_MM, NOTE_MM)


def _write(document: Drawing, text: str, x: float, y: float, height: float) -> None:
    attributes = {"layer": NOTE_LAYER, "height": height, "insert": (x, y)}
    document.modelspace().add_text(text, dxfattribs=attributes)


def check_marked(path: Path, strokes: Sequence[Stroke], marks: Mapping[str, int]) -> None:
    """Read a drawing with marks back: the strokes as they were meant, and as many marks of each kind.

    Raises
    ------
    ExportError
        With the first difference.
    """
    content = read_with_ezdxf(path)
    kinds = [*content.others, *("CIRCLE" for stroke in content.strokes if stroke.circle)]
    wrong = [kind for kind, number in marks.items() if kinds.count(kind) != number]
    drawn = [stroke for stroke in content.strokes if not stroke.circle]
    if wrong or len(drawn) != len(strokes) or any(map(_stroke_difference, drawn, strokes, count())):
        raise ExportError("dxf.drawing_differs")
