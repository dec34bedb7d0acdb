"""Cut plan or deployed layout -> SVG in true millimetres."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import shapely

from kirigami_studio import __version__
from kirigami_studio.assembly.posed_pieces import FINE, HEAD_RIM, PosedPieces, shaded
from kirigami_studio.export import picture
from kirigami_studio.export.design_record import NAME, record_text
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.picture import PlacedLayout, drawn_panels, hexadecimal
from kirigami_studio.export.profile import BLUE, CYAN, GREEN, MAGENTA, MM_DPI, ORANGE, RED, WHITE, Profile, find_profile
from kirigami_studio.export.provenance import PROGRAM, facts_of, origin_facts
from kirigami_studio.export.strokes import Stroke, extent, file_strokes
from kirigami_studio.fabricate.cut_plan import DECIMALS, CutPlan
from kirigami_studio.foundation.arrays import FloatArray, as_rings
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically

NAMESPACE = "http://www.w3.org/2000/svg"
#: Between the facts of a description.
SEPARATOR = "; "
#: Line width (mm) of cut lines; laser drivers take anything thinner than 0.1 mm as a line to cut.
CUT_LINE_MM = 0.05
LAYOUT_MARGIN_MM = 5.0
#: Widths (mm) of the lines of a picture, and size and place of its note.
EDGE_MM, TARGET_MM, NOTE_MM, NOTE_UP_MM = 0.15, 0.5, 3.5, 1.2
#: The note is no larger than that so many letters as high would be as wide as the picture.
NOTE_LETTERS = 30.0
#: What a picture says of itself, so that nobody cuts it.
NO_CUT_FILE = "not a cut file"
#: What the AutoCAD colours of the profiles look like on white.
ACI_COLOUR = {
    RED: (255, 0, 0),
    GREEN: (0, 255, 0),
    CYAN: (0, 255, 255),
    BLUE: (0, 0, 255),
    MAGENTA: (255, 0, 255),
    WHITE: (0, 0, 0),
    ORANGE: (255, 128, 0),
}


def write_cut_svg(plan: CutPlan, path: str | Path, profile: Profile, record: bytes = b"") -> None:
    """Write a plan as true-size SVG: one group for each layer, lines and true arcs in cutting order.

    Raises
    ------
    ExportError
        The place cannot be written, or the file did not read back.
    """
    strokes = file_strokes(plan, profile)
    write_svg(_cut_drawing(plan, profile, record), Path(path), len(strokes), extent(strokes))


def cut_svg_bytes(job: ExportJob) -> bytes:
    """Return the cut file's bytes as they are written for a job.

    Raises
    ------
    ExportError
        The job has no plan, or names an unknown profile.
    """
    return svg_content(_cut_drawing(job.required_plan, find_profile(job.profile), job.record))


def _cut_drawing(plan: CutPlan, profile: Profile, record: bytes) -> ElementTree.Element:
    title = f"Kirigami cut plan, sheet {plan.size_mm[0]:g} x {plan.size_mm[1]:g} mm"
    return strokes_svg(file_strokes(plan, profile), title, facts_of(plan, profile), profile.svg_dpi, record)


def strokes_svg(
    strokes: Sequence[Stroke], title: str, facts: Mapping[str, str], dpi: float = MM_DPI, record: bytes = b""
) -> ElementTree.Element:
    """Return the drawing of any strokes.

    Parameters
    ----------
    strokes : sequence of Stroke
    title : str
    facts : mapping of str to str
        About the making of the file.
    dpi : float
        Units to the inch, see :class:`~kirigami_studio.export.profile.Profile`.
    record : bytes
        The design, see ``design_record``.
    """
    width, height = extent(strokes)
    root = root_element(width, height, title)
    turned = _counted_at(root, width, height, dpi)
    _describe(root, facts)
    if record:
        ElementTree.SubElement(root, "metadata", {"id": NAME}).text = record_text(record)
    for number, ((name, colour), run) in enumerate(groupby(strokes, lambda stroke: (stroke.layer, stroke.colour))):
        # A layer that comes back later in the cutting order needs a name of its own.
        again = any(element.get("id") == name for element in root)
        group = ElementTree.SubElement(root, "g", {"id": f"{name}.{number}" if again else name, **turned})
        # On every path: MeerK40t takes a path that inherits its stroke for a second operation too, and burns it twice.
        look = {"fill": "none", "stroke": hexadecimal(ACI_COLOUR[colour]), "stroke-width": f"{CUT_LINE_MM:g}"}
        for stroke in run:
            ElementTree.SubElement(group, "path", {"d": _stroke_data(stroke, height), **look})
    return root


def _counted_at(root: ElementTree.Element, width: float, height: float, dpi: float) -> dict[str, str]:
    """Let a frame (mm) count so many units to the inch; return the scale of groups in mm."""
    if dpi == MM_DPI:
        return {}
    scale = dpi / MM_DPI
    root.set("viewBox", f"0 0 {decimals(scale * width)} {decimals(scale * height)}")
    return {"transform": f"scale({scale:.10f})"}


def _stroke_data(stroke: Stroke, height: float) -> str:
    """SVG path data of lines and arcs; y is turned over, and a turn to the left stays one."""
    if stroke.bulges is None:
        return path_data(stroke.points, height, stroke.closed)
    points = np.stack([stroke.points[:, 0], height - stroke.points[:, 1]], axis=1).round(DECIMALS)
    stops = np.roll(points, -1, axis=0)
    edges = len(points) if stroke.closed else len(points) - 1
    words = [f"M {decimals(points[0, 0])},{decimals(points[0, 1])}"]
    for start, (x, y), bulge in zip(points[:edges], stops, stroke.bulges, strict=False):
        goal = f"{decimals(x)},{decimals(y)}"
        if bulge == 0.0:
            words.append(f"L {goal}")
            continue
        radius = float(np.hypot(x - start[0], y - start[1])) * (1.0 + bulge**2) / (4.0 * abs(bulge))
        words.append(f"A {radius:.8f} {radius:.8f} 0 {int(abs(bulge) > 1.0)} {int(bulge < 0.0)} {goal}")
    if stroke.closed and stroke.bulges[-1] == 0.0:
        words.pop()
    return " ".join(words) + (" Z" if stroke.closed else "")


def write_layout_svg(job: ExportJob, path: str | Path, width_mm: float = 100.0) -> None:
    """Draw the layout over the target, at the size of a flat sheet of ``width_mm``.

    It is a picture and says so: all is filled, lines too, because laser programs cut and engrave strokes.

    Raises
    ------
    ExportError
        The place cannot be written, or the file did not read back.
    """
    if job.pieces is not None:
        _write_pieces_svg(job, job.pieces, Path(path))
        return
    part = PlacedLayout(job, job.posed.mm_per_world(width_mm), np.zeros(2), np.zeros(2))
    _write_layouts([part], Path(path), "" if job.motion is None else job.motion.caption)


def write_parts_svg(parts: Sequence[PlacedLayout], path: str | Path) -> None:
    """Draw the layouts of all parts, each in its place; as :func:`write_layout_svg`."""
    _write_layouts(parts, Path(path), "")


def _write_layouts(parts: Sequence[PlacedLayout], path: Path, caption: str) -> None:
    """Draw layouts, the same of each in one group."""
    found = [_layout_shapes(part) for part in parts]
    groups = [
        (name, colour, [shape for shapes in found for shape in shapes[name]])
        for name, colour in (
            ("TARGET_AREA", picture.TARGET_FILL),
            ("VOIDS", picture.VOID),
            ("PANELS", picture.PANEL),
            ("EDGES", picture.PANEL_EDGE),
            ("TARGET", picture.TARGET_EDGE),
        )
    ]
    shown = ("TARGET_AREA", "VOIDS", "PANELS")
    everything = np.concatenate(
        [ring for name, _, shapes in groups if name in shown for rings in shapes for ring in rings]
    )
    low = everything.min(axis=0) - LAYOUT_MARGIN_MM
    width, height = (float(side) for side in everything.max(axis=0) + LAYOUT_MARGIN_MM - low)
    _write_shapes(parts[0].job, path, groups, low, (width, height), caption)


def _layout_shapes(part: PlacedLayout) -> dict[str, list[list[FloatArray]]]:
    """Shapes of a layout, group by group, each as its rings (L, 2), mm."""
    job = part.job
    design, phi = job.posed, job.shown_phi
    tables = design.deployment.topology
    drawn, edges = drawn_panels(job, phi)
    panels = [part.put(panel) for panel in drawn]
    lines = [part.put(edge) for edge in edges] if edges is not None else [np.concatenate([p, p[:1]]) for p in panels]
    # As cut the voids are other ones; the page shows through.
    voids = [] if job.motion is not None else list(part.put(design.nodes(phi)[tables.void_nodes].reshape(-1, 4, 2)))
    target = [part.put(np.asarray(ring, dtype=np.float64)) for ring in as_rings(job.target)]
    rims = [np.concatenate([loop, loop[:1]]) for loop in target]
    return {
        "TARGET_AREA": [target] if target else [],
        "VOIDS": [[void] for void in voids],
        "PANELS": [[panel] for panel in panels],
        "EDGES": [_band(line, EDGE_MM) for line in lines],
        "TARGET": [_band(rim, TARGET_MM) for rim in rims],
    }


def _write_pieces_svg(job: ExportJob, pieces: PosedPieces, path: Path) -> None:
    """Draw pieces layer by layer over the target, at their own size."""
    phi, scale, look = job.shown_phi, pieces.mm_per_world, pieces.look
    coarse = pieces.simplified(FINE)
    rings = [[ring * scale for ring in shape] for shape in coarse.rings(phi)]
    drawn = [[line * scale for line in lines] for lines in coarse.drawn(phi)]
    target = [np.asarray(ring, dtype=np.float64) * scale for ring in as_rings(job.target)]
    everything = np.concatenate([*(shape[0] for shape in rings), *target])
    low = everything.min(axis=0) - LAYOUT_MARGIN_MM
    width, height = (float(side) for side in everything.max(axis=0) + LAYOUT_MARGIN_MM - low)
    groups: list[tuple[str, picture.Colour, list[list[FloatArray]]]] = [
        ("TARGET_AREA", picture.TARGET_FILL, [target] if target else [])
    ]
    for place, layer in enumerate(pieces.layers, start=1):
        shapes = [rings[number] for number in layer]
        edges = [_band(np.concatenate([ring, ring[:1]]), EDGE_MM) for shape in shapes for ring in shape]
        groups.append((f"LAYER_{place}", look.layer(place - 1, len(pieces.layers)), shapes))
        groups.append((f"EDGES_{place}", look.line, edges))
        lines = [_band(line, EDGE_MM) for number in layer for line in drawn[number]]
        groups += [(f"ARTWORK_{place}", look.number, lines)] if lines else []
    heads = pieces.heads(phi) * scale
    for name, colour, share in (("HEAD_RIMS", shaded(look.head, HEAD_RIM), 1.0), ("HEADS", look.head, 0.8)):
        discs = [shapely.Point(head).buffer(0.5 * share * pieces.head_mm, quad_segs=6) for head in heads]
        groups.append((name, colour, [[shapely.get_coordinates(disc)[:-1]] for disc in discs]))
    rims = [_band(np.concatenate([loop, loop[:1]]), TARGET_MM) for loop in target]
    groups.append(("TARGET", picture.TARGET_EDGE, rims))
    _write_shapes(job, path, groups, low, (width, height))


def _write_shapes(
    job: ExportJob,
    path: Path,
    groups: Sequence[tuple[str, picture.Colour, list[list[FloatArray]]]],
    low: FloatArray,
    size: tuple[float, float],
    caption: str = "",
) -> None:
    """Write filled shapes, group by group, as a picture that says so of itself.

    Parameters
    ----------
    groups : sequence of (name, colour, shapes)
        Each shape as its rings (L, 2), mm.
    low : (2,) float, mm
        Lower left corner of the picture.
    size : (width, height), mm
    caption : str
        Follows the note below the picture.
    """
    width, height = size
    root = root_element(
        width, height, f"Picture of a kirigami layout at {np.degrees(job.shown_phi):g} degrees, {NO_CUT_FILE}"
    )
    root.set("id", "PICTURE")
    _describe(root, {PROGRAM: __version__, "PURPOSE": f"picture, {NO_CUT_FILE}", **origin_facts(job.provenance)})
    count = 0
    for name, colour, shapes in groups:
        look = {"fill": hexadecimal(colour), "fill-rule": "evenodd", "stroke": "none"}
        group = ElementTree.SubElement(root, "g", {"id": name})
        for rings in shapes:
            data = " ".join(path_data(ring - low, height, closed=True) for ring in rings)
            ElementTree.SubElement(group, "path", {"d": data, **look})
            count += 1
    place = {"x": decimals(0.5 * width), "y": decimals(height - NOTE_UP_MM), "text-anchor": "middle"}
    said = f"Picture, {NO_CUT_FILE}" + (f". {caption}" if caption else "")
    look = {
        "font-family": "sans-serif",
        "font-size": decimals(min(NOTE_MM, width / NOTE_LETTERS)),
        "fill": hexadecimal(picture.INK),
    }
    ElementTree.SubElement(root, "text", {**place, **look}).text = said
    write_svg(root, path, count, size)


def _band(line: FloatArray, width_mm: float) -> list[FloatArray]:
    """A line (L, 2) of some width as the rings around it."""
    area = shapely.buffer(shapely.LineString(line), 0.5 * width_mm, quad_segs=2, join_style="mitre")
    return [shapely.get_coordinates(ring)[:-1] for ring in shapely.get_rings(area)]


def root_element(width: float, height: float, title: str, margin: float = 0.0) -> ElementTree.Element:
    """An empty drawing of a frame (mm), whose upper left corner is (0, 0), with a margin around it."""
    page_width, page_height = width + 2.0 * margin, height + 2.0 * margin
    size = {"width": f"{decimals(page_width)}mm", "height": f"{decimals(page_height)}mm"}
    view = f"{decimals(-margin)} {decimals(-margin)} {decimals(page_width)} {decimals(page_height)}"
    root = ElementTree.Element("svg", {"xmlns": NAMESPACE, "version": "1.1", **size, "viewBox": view})
    ElementTree.SubElement(root, "title").text = title
    return root


def _describe(root: ElementTree.Element, facts: Mapping[str, str]) -> None:
    """Say how the drawing was made, where viewers and drawing programs show it."""
    if facts:
        ElementTree.SubElement(root, "desc").text = SEPARATOR.join(f"{key} {value}" for key, value in facts.items())


def decimals(value: float) -> str:
    """Shortest text with four decimals at most."""
    return f"{value + 0.0:.4f}".rstrip("0").rstrip(".")


def path_data(points: FloatArray, height: float, closed: bool) -> str:
    """SVG path data; y is turned over because SVG counts it downwards."""
    pairs = [f"{decimals(x)},{decimals(height - y)}" for x, y in points.tolist()]
    return "M " + " L ".join(pairs) + (" Z" if closed else "")


def write_svg(root: ElementTree.Element, path: Path, paths: int, size: tuple[float, float]) -> None:
    """Write a drawing of so many paths and this size (mm), and read it back.

    Raises
    ------
    ExportError
        The place cannot be written, or the file did not read back.
    """
    content = svg_content(root)

    def verify(written: Path) -> None:
        read = ElementTree.parse(written).getroot()
        found = len(read.findall(f".//{{{NAMESPACE}}}path"))
        if found != paths or read.get("width") != f"{decimals(size[0])}mm":
            raise ExportError("svg.not_as_written", found=found, planned=paths)

    write_atomically(path, content, verify)


def svg_content(root: ElementTree.Element) -> bytes:
    """The bytes of a file with this drawing, indented."""
    ElementTree.indent(root)
    content: bytes = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    return content
