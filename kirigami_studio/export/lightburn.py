"""Cut plan -> LightBurn project (.lbrn2): named layers, speed, power, passes, order.

A name is engraved first, by lines with a setting of their own: in one pass at a share of the material's power, since
materials know only what cuts them.  Connectors are marked on the tool layer T1 where that is asked for: LightBurn
leaves it out, but MeerK40t engraves it.

The file is XML; a path is a list of vertices (``V x y``, with handles where a curve leaves or arrives) and a list of
primitives between them (``L`` line, ``B`` Bezier curve).  Arcs become Bezier curves of a quarter turn at most.  The
written file is read back, and the length on each layer compared with the plan.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from kirigami_studio.export.profile import ARTWORK_LAYER, ENGRAVED_LAYERS, NAME_LAYER, find_profile
from kirigami_studio.export.provenance import facts_of
from kirigami_studio.export.strokes import Stroke, file_strokes, layer_colours, name_strokes, total_length
from kirigami_studio.fabricate.cut_path import arc_of
from kirigami_studio.fabricate.cut_plan import CutPath, CutPlan, Layer
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.fabricate.machine import Machine
from kirigami_studio.fabricate.material import Material
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically

#: Numbers of the palette: magenta, red, green, blue, as in the DXF profile.
PALETTE_NUMBER = {
    Layer.RELIEF: 7,
    Layer.HOLES: 2,
    Layer.SLITS: 2,
    Layer.EDGE_SLITS: 3,
    Layer.KISS: 3,
    Layer.OUTLINE: 1,
}
#: The number of holes in a sheet with slits, whose number they have otherwise: cyan.
HOLES_BESIDE_SLITS = 6
#: Numbers of the name and of artwork in the palette: black and orange.
NAME_NUMBER, ARTWORK_NUMBER = 0, 5
ENGRAVED_NUMBER = {NAME_LAYER: NAME_NUMBER, ARTWORK_LAYER: ARTWORK_NUMBER}
#: Share of the material's power that both are engraved with.
NAME_POWER = 0.2
#: The first tool layer, which LightBurn shows and never cuts.
TOOL_LAYER = 30
MARKER_RADIUS_MM = 0.5
#: A Bezier curve stands for at most this much of an arc (radians): the error is below 0.03 % of the radius.
LARGEST_TURN = math.pi / 2.0
#: Share by which a length may differ after reading back: arcs as Bezier curves, measured along chords.
SAME_LENGTH = 5e-4
#: Chords that a Bezier curve of a quarter turn is measured with; they miss 3e-5 of it.
CHORDS = 64
#: Chords of a curve where the cuts of a project are checked.
CURVE_CHORDS = 24
#: Files that were read last are kept, by their bytes.
KEPT_FILES = 4
#: x and y of the four control points of a cubic Bezier curve, mm.
Curve = tuple[float, ...]
_NUMBER = r"(-?\d+(?:\.\d+)?)"
_VERTEX = re.compile(rf"V{_NUMBER} {_NUMBER}(?:c0x{_NUMBER}(?:c0y{_NUMBER})?)?(?:c1x{_NUMBER}(?:c1y{_NUMBER})?)?")
_PLACE = re.compile(rf"1 0 0 1 {_NUMBER} {_NUMBER}")
_FACT = re.compile(r"([A-Z][A-Z0-9_]{1,60}) (.{1,255})")
_PRIMITIVE = re.compile(r"([LB])(\d+) (\d+)")


def write_lightburn(plan: CutPlan, path: str | Path, markers: bool = False) -> None:
    """Write a plan as LightBurn project and read it back.

    Parameters
    ----------
    markers : bool
        Also draw a circle around every connector, on the tool layer.

    Raises
    ------
    ExportError
        The place cannot be written, or the file did not read back.
    """
    write_project(lightburn_bytes(plan, markers), file_strokes(plan, find_profile("any")), Path(path))


def write_project(content: bytes, strokes: Sequence[Stroke], path: Path) -> None:
    """Write a project of these strokes, and compare the length on each layer as it is read back.

    Raises
    ------
    ExportError
        As :func:`write_lightburn`.
    """
    meant = {
        name: total_length([stroke for stroke in strokes if stroke.layer == name]) for name in layer_colours(strokes)
    }

    def verify(written: Path) -> None:
        found = layer_lengths(written)
        for name, length in meant.items():
            if not abs(found.get(name, 0.0) - length) <= SAME_LENGTH * length:
                raise ExportError(
                    "lightburn.other_length", found_mm=found.get(name, 0.0), planned_mm=length, layer=name
                )

    write_atomically(path, content, verify)


def lightburn_bytes(plan: CutPlan, markers: bool = False) -> bytes:
    """Return the project's XML; ``markers`` as for :func:`write_lightburn`."""
    names = name_strokes(plan, find_profile("any"))
    root = _project(plan.material, plan.machine, plan.layers, [NAME_LAYER] if names else [])
    if markers:
        _add_setting(root, "Tool", TOOL_LAYER, "CONNECTORS", len(plan.layers) + (1 if names else 0), {})
    for stroke in names:
        _add_path(root, stroke, NAME_NUMBER)
    palette = palette_for(plan.layers)
    for path in plan.copies.of(plan.paths):
        _add_path(root, path, palette[path.layer])
    marked = (plan.copies.places[:, None] + plan.hinges.position).reshape(-1, 2)
    for x, y in marked.tolist() if markers else []:
        _add_circle(root, (x, y), MARKER_RADIUS_MM, TOOL_LAYER)
    return _with_notes(root, plan.material, facts_of(plan, find_profile("lightburn")), plan.notes, bool(names))


def strokes_lightburn(
    strokes: Sequence[Stroke], material: Material, machine: Machine, facts: Mapping[str, str]
) -> bytes:
    """Return the project of any strokes; their layers have the names of :class:`Layer`."""
    engraved = [stroke for stroke in strokes if stroke.layer in ENGRAVED_LAYERS]
    cuts = [(stroke, Layer(stroke.layer)) for stroke in strokes if stroke.layer not in ENGRAVED_LAYERS]
    layers = tuple(dict.fromkeys(layer for _, layer in cuts))
    named = list(dict.fromkeys(stroke.layer for stroke in engraved))
    palette, root = palette_for(layers), _project(material, machine, layers, named)
    numbers = [
        *((stroke, ENGRAVED_NUMBER[stroke.layer]) for stroke in engraved),
        *((stroke, palette[layer]) for stroke, layer in cuts),
    ]
    for stroke, number in numbers:
        _add_path(root, stroke, number)
    return _with_notes(root, material, facts, (), bool(engraved))


def palette_for(layers: Sequence[Layer]) -> dict[Layer, int]:
    """Numbers of the palette for the layers of one project, each its own."""
    return PALETTE_NUMBER | ({Layer.HOLES: HOLES_BESIDE_SLITS} if Layer.SLITS in layers else {})


def _project(
    material: Material, machine: Machine, layers: Sequence[Layer], engraved: Sequence[str]
) -> ElementTree.Element:
    """A project with its settings and nothing drawn."""
    # Mirrored in y means that y counts upwards.
    root = ElementTree.Element(
        "LightBurnProject",
        {"AppVersion": "1.0.00", "FormatVersion": "1", "MaterialHeight": "0", "MirrorX": "False", "MirrorY": "True"},
    )
    power = f"{material.power_percent:g}"
    work = {
        "speed": f"{machine.speed_mm_s(material):g}",
        "minPower": power,
        "maxPower": power,
        "numPasses": f"{material.passes}",
        "kerf": "0",
    }
    faint = f"{NAME_POWER * material.power_percent:g}"
    light = work | {"minPower": faint, "maxPower": faint, "numPasses": "1"}
    for priority, name in enumerate(engraved):
        _add_setting(root, "Cut", ENGRAVED_NUMBER[name], name, priority, light)
    palette = palette_for(layers)
    for priority, layer in enumerate(layers, start=len(engraved)):
        _add_setting(root, "Cut", palette[layer], layer.value, priority, work)
    return root


def _with_notes(
    root: ElementTree.Element, material: Material, facts: Mapping[str, str], about: Sequence[Note], named: bool
) -> bytes:
    """The bytes of a project that says how it was made, and what to know of it."""
    about_name = (Note.of("lightburn.name_power", percent=100.0 * NAME_POWER),)
    told = (*about, *power_notes(material), *(about_name if named and material.power_percent else ()))
    notes = [*(f"{key} {value}" for key, value in facts.items()), *(note.text for note in told)]
    ElementTree.SubElement(root, "Notes", {"ShowOnLoad": "0", "Notes": "\n".join(notes)})
    ElementTree.indent(root)
    content: bytes = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    return content


def power_notes(material: Material) -> tuple[Note, ...]:
    """Advice about the power in LightBurn where the material does not know it."""
    return () if material.power_percent else (Note.of("lightburn.no_power", material=material.name),)


def _add_setting(
    root: ElementTree.Element, kind: str, index: int, name: str, priority: int, work: Mapping[str, str]
) -> None:
    setting = ElementTree.SubElement(root, "CutSetting", {"type": kind})
    for key, value in {"index": f"{index}", "name": name, "priority": f"{priority}", **work}.items():
        ElementTree.SubElement(setting, key, {"Value": value})


def _add_path(root: ElementTree.Element, path: CutPath | Stroke, number: int) -> None:
    if isinstance(path, Stroke) and path.circle:
        right, left = path.points.tolist()
        _add_circle(root, (0.5 * (right[0] + left[0]), right[1]), 0.5 * (right[0] - left[0]), number)
        return
    shape = ElementTree.SubElement(root, "Shape", {"Type": "Path", "CutIndex": str(number)})
    ElementTree.SubElement(shape, "XForm").text = "1 0 0 1 0 0"
    vertices, primitives = _vertices(path)
    ElementTree.SubElement(shape, "VertList").text = "".join(vertices)
    ElementTree.SubElement(shape, "PrimList").text = "".join(primitives)


def _add_circle(root: ElementTree.Element, centre: tuple[float, float], radius: float, number: int) -> None:
    size = f"{radius:.4f}".rstrip("0").rstrip(".")
    look = {"Type": "Ellipse", "CutIndex": str(number), "Rx": size, "Ry": size}
    shape = ElementTree.SubElement(root, "Shape", look)
    ElementTree.SubElement(shape, "XForm").text = f"1 0 0 1 {centre[0]:.4f} {centre[1]:.4f}"


def _vertices(path: CutPath | Stroke) -> tuple[list[str], list[str]]:
    """Vertices with their handles, and the primitives between them."""
    points: list[FloatArray] = [path.points[0]]
    leaving: dict[int, FloatArray] = {}
    arriving: dict[int, FloatArray] = {}
    edges = len(path.points) if path.closed else len(path.points) - 1
    for edge in range(edges):
        stop = path.points[(edge + 1) % len(path.points)]
        bulge = 0.0 if path.bulges is None else float(path.bulges[edge])
        for first, second, goal in _curves(points[-1], stop, bulge):
            leaving[len(points) - 1] = first
            points.append(goal)
            arriving[len(points) - 1] = second
        if bulge == 0.0:
            points.append(stop)
    count = len(points) - 1 if path.closed else len(points)
    if path.closed and count in arriving:
        arriving[0] = arriving[count]
    vertices = [
        f"V{points[i][0]:.4f} {points[i][1]:.4f}" + _handle("c0", leaving.get(i)) + _handle("c1", arriving.get(i))
        for i in range(count)
    ]
    primitives = [f"{'B' if i in leaving else 'L'}{i} {(i + 1) % count}" for i in range(len(points) - 1)]
    return vertices, primitives


def _handle(name: str, point: FloatArray | None) -> str:
    return f"{name}x1" if point is None else f"{name}x{point[0]:.6f}{name}y{point[1]:.6f}"


def _curves(start: FloatArray, stop: FloatArray, bulge: float) -> list[tuple[FloatArray, FloatArray, FloatArray]]:
    """Bezier curves of an arc: both handles and the end of each; none for a straight edge."""
    if bulge == 0.0:
        return []
    centre, _ = arc_of(start, stop, bulge)
    whole = 4.0 * math.atan(bulge)
    count = math.ceil(abs(whole) / LARGEST_TURN)
    turn = whole / count
    reach = 4.0 / 3.0 * math.tan(turn / 4.0)
    arm = start - centre
    found = []
    for number in range(1, count + 1):
        following = _turned(start - centre, turn * number)
        handles = (centre + arm + reach * _turned(arm, math.pi / 2.0),
                   centre + following - reach * _turned(following, math.pi / 2.0))  # fmt: skip
        found.append((*handles, stop if number == count else centre + following))
        arm = following
    return found


def _turned(arm: FloatArray, angle: float) -> FloatArray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]])


def layer_lengths(path: Path) -> dict[str, float]:
    """Return the length (mm) that is cut on each layer, by the layer's name.

    Raises
    ------
    ExportError
        No readable project, or a shape on a layer without settings.
    """
    try:
        found = read_lightburn(path.read_bytes(), path)
    except OSError as error:
        raise ExportError("lightburn.not_readable", path=path, reason=str(error)) from error
    lengths = dict.fromkeys(found.layers, 0.0)
    for one in found.paths:
        lengths[one.layer] += _length(one.curves)
    return lengths


@dataclass(frozen=True, slots=True, eq=False)
class ProjectPath:
    """One path of a LightBurn project."""

    layer: str  #: name of its cut setting
    curves: FloatArray  #: (C, 4, 2), mm; cubic Bezier curves, one after the other

    @property
    def closed(self) -> bool:
        """Whether it ends where it begins."""
        return len(self.curves) > 1 and bool(np.array_equal(self.curves[-1, -1], self.curves[0, 0]))

    @property
    def points(self) -> FloatArray:
        """Points (P, 2), mm, along it, with chords for the curves."""
        straight = np.all(self.curves[:, 1] == self.curves[:, 0], axis=1)
        parts = [
            curve[-1:] if line else _weights(CURVE_CHORDS)[1:] @ curve
            for curve, line in zip(self.curves, straight, strict=True)
        ]
        return np.concatenate([self.curves[0, :1], *parts])


@dataclass(frozen=True, slots=True, eq=False)
class ProjectContent:
    """A LightBurn project as it is read: what it cuts, and what it says of itself."""

    paths: tuple[ProjectPath, ...]
    facts: Mapping[str, str]
    layers: tuple[str, ...]


def read_lightburn(content: bytes, path: Path) -> ProjectContent:
    """Read the bytes of a project; ``path`` is named in refusals.

    Raises
    ------
    ExportError
        No readable project, a shape on a layer without settings, or one that is no path.
    """
    try:
        return _content(content)
    except (ElementTree.ParseError, KeyError, ValueError, IndexError, LookupError) as error:
        raise ExportError("lightburn.not_readable", path=path, reason=str(error)) from error


@lru_cache(maxsize=KEPT_FILES)
def _content(content: bytes) -> ProjectContent:
    """Read a project; one that was read back is mostly verified next."""
    root = ElementTree.fromstring(content)
    names = {_value(one, "index"): _value(one, "name") for one in root.findall("CutSetting[@type='Cut']")}
    tools = {_value(one, "index") for one in root.findall("CutSetting[@type='Tool']")}
    if root.tag != "LightBurnProject" or root.find(".//Shape//Shape") is not None:
        raise ValueError("it is no project of plain paths")
    shapes = [shape for shape in root.findall("Shape") if shape.get("CutIndex") not in tools]
    paths = tuple(
        ProjectPath(names[str(shape.get("CutIndex"))], np.array(_control_points(shape)).reshape(-1, 4, 2))
        for shape in shapes
    )
    if not all(len(one.curves) and np.all(np.isfinite(one.curves)) for one in paths):
        raise ValueError("a path has no length")
    for one in paths:
        one.curves.setflags(write=False)
    notes = root.find("Notes")
    lines = "" if notes is None else str(notes.get("Notes"))
    facts: dict[str, str] = {}
    for line in lines.splitlines():
        if found := _FACT.fullmatch(line):
            facts.setdefault(found[1], found[2])
    return ProjectContent(paths, facts, tuple(names.values()))


def _value(setting: ElementTree.Element, name: str) -> str:
    found = setting.find(name)
    return "" if found is None else str(found.get("Value"))


def _control_points(shape: ElementTree.Element) -> list[Curve]:
    """Curves that a shape consists of; the inner control points of a straight edge are its ends."""
    if shape.get("Type") == "Ellipse":
        return _circle_curves(shape)
    if shape.get("Type") != "Path" or shape.findtext("XForm") != "1 0 0 1 0 0":
        raise ValueError(f"a {shape.get('Type')} lies on a layer that is cut")
    vertices = [
        tuple(float(number or "nan") for number in match) for match in _VERTEX.findall(shape.findtext("VertList", ""))
    ]
    found: list[Curve] = []
    for kind, one, other in _PRIMITIVE.findall(shape.findtext("PrimList", "")):
        start, stop = vertices[int(one)], vertices[int(other)]
        inner = start[:2] + stop[:2] if kind == "L" else start[2:4] + stop[4:6]
        found.append((*start[:2], *inner, *stop[:2]))
    return found


def _circle_curves(shape: ElementTree.Element) -> list[Curve]:
    """Curves of a circle, counter-clockwise from its rightmost point."""
    place = _PLACE.fullmatch(shape.findtext("XForm", ""))
    radius = float(str(shape.get("Rx")))
    if place is None or shape.get("Rx") != shape.get("Ry") or not radius > 0.0:
        raise ValueError("an ellipse that is no circle lies on a layer that is cut")
    centre = np.array([float(place[1]), float(place[2])])
    arm = np.array([radius, 0.0])
    right, left = centre + arm, centre - arm
    found: list[Curve] = []
    for start, stop in ((right, left), (left, right)):
        here = start
        for first, second, goal in _curves(start, stop, 1.0):
            found.append((*here.tolist(), *first.tolist(), *second.tolist(), *goal.tolist()))
            here = goal
    return found


def _length(curves: FloatArray) -> float:
    """Length (mm) of cubic Bezier curves (C, 4, 2), along chords; straight ones have one."""
    bent = np.any(curves[:, 1] != curves[:, 0], axis=1) | np.any(curves[:, 2] != curves[:, 3], axis=1)
    straight = np.linalg.norm(curves[~bent, 3] - curves[~bent, 0], axis=1).sum()
    return float(straight + np.linalg.norm(np.diff(_weights(CHORDS), axis=0) @ curves[bent], axis=2).sum())


def _weights(chords: int) -> FloatArray:
    """Weights (chords + 1, 4) of control points of a cubic Bezier curve at equal steps."""
    t = np.linspace(0.0, 1.0, chords + 1)
    weights: FloatArray = np.stack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3], axis=1)
    return weights
