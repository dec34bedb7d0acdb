"""Reads the folder of an assembly without the program: libraries and the words of the files, nothing of the package.

Pieces are recognised by the places of their holes and the middle of their outline, whatever turn they lie in, and put
together by ``pieces.json``.
"""

from __future__ import annotations

import itertools
import json
import re
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import ezdxf
import numpy as np
import shapely
import svgelements
from shapely.geometry import Polygon

Ring = tuple[np.ndarray, bool]  #: points, and whether they are those of a circle
#: Least area of a drilled hole, as a share of that of a circle with its circumference; the next are octagons.
ROUND = 0.98
#: Layers whose lines are engraved.
ENGRAVED = ("NAME", "ARTWORK")


@dataclass(frozen=True)
class Together:
    """Pieces of one kind of file, put together.

    Attributes
    ----------
    pieces : int
    outline_mm, holes_mm, pins_mm : float
        Farthest that finished outlines, holes, and the two holes of a pin are from where they should be.
    overlap_mm2 : float
        That pieces of one layer share at the worst angle.
    """

    pieces: int
    outline_mm: float
    holes_mm: float
    pins_mm: float
    overlap_mm2: float


def circle(centre: np.ndarray, radius: float) -> np.ndarray:
    turn = 2.0 * np.pi * np.arange(64) / 64
    return centre + radius * np.column_stack([np.cos(turn), np.sin(turn)])


def dxf_rings(path: Path) -> list[Ring]:
    rings: list[Ring] = []
    for entity in ezdxf.readfile(path).modelspace():
        if entity.dxf.layer in ENGRAVED:
            continue
        if entity.dxftype() == "CIRCLE":
            rings.append((circle(np.array([entity.dxf.center.x, entity.dxf.center.y]), entity.dxf.radius), True))
        elif entity.dxftype() == "POLYLINE":
            assert entity.is_closed
            rings.append((np.array([[v.dxf.location.x, v.dxf.location.y] for v in entity.vertices]), False))
        else:
            assert entity.dxftype() == "LWPOLYLINE" and entity.closed and not entity.has_arc
            rings.append((np.array(entity.get_points("xy")), False))
    return rings


def svg_rings(path: Path) -> list[Ring]:
    rings: list[Ring] = []
    drawing = svgelements.SVG.parse(path, reify=False)
    height = float(drawing.viewbox.height)
    for group in drawing.select(lambda element: isinstance(element, svgelements.Group) and element.id not in ENGRAVED):
        for shape in group:
            if not isinstance(shape, svgelements.Path):
                continue
            arcs = [part for part in shape if isinstance(part, svgelements.Arc)]
            if arcs:
                centre = np.array([float(arcs[0].center.x), height - float(arcs[0].center.y)])
                rings.append((circle(centre, float(arcs[0].rx)), True))
                continue
            ends = [part.end for part in shape if isinstance(part, (svgelements.Move, svgelements.Line))]
            assert isinstance(shape[-1], svgelements.Close)
            rings.append((np.array([[end.x, height - end.y] for end in ends], dtype=float), False))
    return rings


def project_rings(path: Path) -> list[Ring]:
    rings: list[Ring] = []
    root = ElementTree.parse(path).getroot()
    names = {s.find("index").get("Value"): s.find("name").get("Value") for s in root.findall("CutSetting")}
    for shape in root.findall("Shape"):
        place = np.array([float(word) for word in shape.findtext("XForm").split()])
        assert place[:4].tolist() == [1.0, 0.0, 0.0, 1.0]
        if names[shape.get("CutIndex")] in ENGRAVED:
            continue
        if shape.get("Type") == "Ellipse":
            rings.append((circle(place[4:], float(shape.get("Rx"))), True))
            continue
        corners = re.findall(r"V(\S+) ([-\d.]+)", shape.findtext("VertList"))
        ways = re.findall(r"L(\d+) (\d+)", shape.findtext("PrimList"))
        assert [int(end) for _, end in ways] == [*range(1, len(corners)), 0]
        rings.append((np.array(corners, dtype=float), False))
    return rings


READERS = {".dxf": dxf_rings, ".svg": svg_rings, ".lbrn2": project_rings}


@dataclass(frozen=True)
class Recognised:
    """Pieces of one kind of file, in their own frames.

    Attributes
    ----------
    found : dict
        Finished area of each piece without its round holes, and their middles.
    beams : dict
        File of each piece, its outline there, and the turn and shift from there to its frame.
    outline_mm, holes_mm : float
        As in :class:`Together`.
    """

    found: dict[str, tuple[Polygon, np.ndarray]]
    beams: dict[str, tuple[Path, Polygon, np.ndarray, np.ndarray]]
    outline_mm: float
    holes_mm: float


def put_together(folder: Path, kind: str, kerf_mm: float) -> Together:
    """Read the files of a kind, recognise every piece once, and move them as ``pieces.json`` says."""
    record = json.loads((folder / "pieces.json").read_text())
    layers = {piece["id"]: piece["layer"] for piece in record["pieces"]}
    read = recognise(folder, kind, kerf_mm)
    return Together(len(read.found), read.outline_mm, read.holes_mm, *moved(record, read.found, layers))


def recognise(folder: Path, kind: str, kerf_mm: float) -> Recognised:
    """Read the files of a kind, and recognise every piece once."""
    record = json.loads((folder / "pieces.json").read_text())
    wanted = {piece["id"]: piece for piece in record["pieces"]}
    meant = {name: with_openings(piece) for name, piece in wanted.items()}
    whole = {name: filleted(area, kerf_mm) for name, area in meant.items()}
    found: dict[str, tuple[Polygon, np.ndarray]] = {}
    beams: dict[str, tuple[Path, Polygon, np.ndarray, np.ndarray]] = {}
    outline_mm = holes_mm = 0.0
    for path in sorted(folder.glob(f"layer-*{kind}")):
        layer = int(re.match(r"layer-(\d+)", path.name)[1])
        rings = READERS[kind](path)
        solid = [Polygon(ring) for ring, is_circle in rings if not is_circle]
        outlines = [one for one in solid if not any(other.contains(one) for other in solid if other is not one)]
        pockets = [one for one in solid if not any(one is other for other in outlines)]
        holes = [ring.mean(axis=0) for ring, is_circle in rings if is_circle]
        radii = [np.linalg.norm(ring[0] - ring.mean(axis=0)) for ring, is_circle in rings if is_circle]
        for beam in outlines:
            mine = [at for at, hole in enumerate(holes) if beam.contains(shapely.Point(hole))]
            burned = [one.buffer(0.5 * kerf_mm, quad_segs=64) for one in pockets if beam.contains(one)]
            finished = beam.buffer(-0.5 * kerf_mm, quad_segs=64).difference(shapely.union_all(burned))
            here = np.array([holes[at] for at in mine]).reshape(-1, 2)
            name, turn, shift, miss = recognised(finished, here, layer, wanted, whole, found)
            area = shapely.transform(finished, lambda points, turn=turn, shift=shift: points @ turn.T + shift)
            asked, corners = (shapely.points(shapely.get_coordinates(one)) for one in (meant[name], area))
            outline_mm = max(
                outline_mm, shapely.distance(asked, area).max(), shapely.distance(corners, whole[name]).max()
            )
            radius = [np.sqrt(Polygon(ring).area / np.pi) for ring in round_holes(wanted[name])]
            sizes = [abs(radii[at] + 0.5 * kerf_mm - radius[0]) for at in mine]
            holes_mm = max(holes_mm, miss, *sizes, 0.0)
            found[name] = (area, here @ turn.T + shift)
            beams[name] = (path, beam, turn, shift)
    assert set(found) == set(wanted), "a piece is missing"
    return Recognised(found, beams, outline_mm, holes_mm)


def artwork_of(path: Path) -> list[np.ndarray]:
    """Lines (P, 2), mm, on the layer of artwork of a cut file; closed ones repeat their first point."""
    lines: list[np.ndarray] = []
    if path.suffix == ".dxf":
        for entity in ezdxf.readfile(path).modelspace().query('*[layer=="ARTWORK"]'):
            points = np.array(entity.get_points("xy"))
            lines.append(np.vstack([points, points[:1]]) if entity.closed else points)
    elif path.suffix == ".svg":
        drawing = svgelements.SVG.parse(path, reify=False)
        height = float(drawing.viewbox.height)
        for group in drawing.select(lambda one: isinstance(one, svgelements.Group) and one.id == "ARTWORK"):
            for shape in (one for one in group if isinstance(one, svgelements.Path)):
                ends = [part.end for part in shape]
                lines.append(np.array([[end.x, height - end.y] for end in ends], dtype=float))
    else:
        root = ElementTree.parse(path).getroot()
        names = {s.find("index").get("Value"): s.find("name").get("Value") for s in root.findall("CutSetting")}
        for shape in root.findall("Shape"):
            if names[shape.get("CutIndex")] == "ARTWORK":
                place = np.array([float(word) for word in shape.findtext("XForm").split()])[4:]
                corners = np.array(re.findall(r"V(\S+) ([-\d.]+)", shape.findtext("VertList")), dtype=float)
                ways = np.array(re.findall(r"L(\d+) (\d+)", shape.findtext("PrimList")), dtype=int)
                lines.append(corners[[*ways[:, 0], ways[-1, 1]]] + place)
    return lines


def posed_artwork(folder: Path, read: Recognised, step: int) -> list[np.ndarray]:
    """Lines of artwork of all pieces as they lie at a step of the motion, mm."""
    record = json.loads((folder / "pieces.json").read_text())
    lines = {path: artwork_of(path) for path in {beam[0] for beam in read.beams.values()}}
    posed = []
    for name, (path, beam, turn, shift) in read.beams.items():
        x, y, angle = record["motion"][step]["poses"][name]
        turned = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        for line in lines[path]:
            if beam.contains(shapely.Point(line[:2].mean(axis=0))):
                posed.append((line @ turn.T + shift) @ turned.T + (x, y))
    assert len(posed) == sum(map(len, lines.values())), "a line lies on no piece, or on two"
    return posed


def is_round(ring: list[list[float]]) -> bool:
    """Whether a ring is a drilled hole, and no opening of another form."""
    area = Polygon(ring)
    return 4.0 * np.pi * area.area > ROUND * area.length**2


def round_holes(piece: dict) -> list[list[list[float]]]:
    """The drilled holes among the rings of a piece."""
    return [ring for ring in piece["holes"] if is_round(ring)]


def with_openings(piece: dict) -> Polygon:
    """A piece without what is drilled."""
    return Polygon(piece["outline"], [ring for ring in piece["holes"] if not is_round(ring)])


def filleted(area: Polygon, kerf_mm: float) -> Polygon:
    """What a round beam leaves that goes round an area."""
    return area.buffer(0.5 * kerf_mm, quad_segs=64).buffer(-0.5 * kerf_mm, quad_segs=64) if kerf_mm else area


def recognised(
    area: Polygon,
    holes: np.ndarray,
    layer: int,
    wanted: dict[str, dict],
    whole: dict[str, Polygon],
    found: dict[str, object],
) -> tuple[str, np.ndarray, np.ndarray, float]:
    """The piece of a layer that is not found yet and fits best; its turn, its shift, and how far its holes are off."""
    best = ("", np.eye(2), np.zeros(2), np.inf)
    for name, piece in wanted.items():
        drilled = round_holes(piece)
        if piece["layer"] != layer or name in found or len(drilled) != len(holes):
            continue
        meant = whole[name]
        if abs(meant.area - area.area) > 0.5:
            continue
        middles = np.array([Polygon(ring).centroid.coords[0] for ring in drilled]).reshape(-1, 2)
        for order in itertools.permutations(range(len(holes))):
            turn, shift, miss = fitted(
                np.vstack([holes, area.centroid.coords[0]]), np.vstack([middles[list(order)], meant.centroid.coords[0]])
            )
            if miss < best[3]:
                best = (name, turn, shift, miss)
    assert best[3] < 0.05, "no piece looks like this"
    return best


def fitted(points: np.ndarray, onto: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """The rigid motion, without a mirror, that lays points on others best; how far the farthest hole is off."""
    middle, other = points.mean(axis=0), onto.mean(axis=0)
    u, _, vt = np.linalg.svd((points - middle).T @ (onto - other))
    turn = vt.T @ np.diag([1.0, np.linalg.det(vt.T @ u.T)]) @ u.T
    shift = other - turn @ middle
    return turn, shift, float(np.linalg.norm(points @ turn.T + shift - onto, axis=1)[:-1].max(initial=0.0))


def nearest(holes: np.ndarray, pin: list[float]) -> np.ndarray:
    """The hole of a piece that is nearest to a pin's place in it."""
    return holes[np.linalg.norm(holes - pin, axis=1).argmin()]


def moved(record: dict, found: dict[str, tuple[Polygon, np.ndarray]], layers: dict[str, int]) -> tuple[float, float]:
    """Farthest that the holes of a pin are apart, and largest overlap within a layer, over the whole motion."""
    pins = overlap = 0.0
    names = list(found)
    layer = np.array([layers[name] for name in names])
    areas = np.array([found[name][0] for name in names], dtype=object)
    points, owner = shapely.get_coordinates(areas, return_index=True)
    pinned = [[names.index(hinge["pieces"][side]) for hinge in record["hinges"]] for side in (0, 1)]
    drilled = [
        np.array([nearest(found[hinge["pieces"][side]][1], hinge["at"][side]) for hinge in record["hinges"]])
        for side in (0, 1)
    ]
    for step in record["motion"]:
        poses = np.array([step["poses"][name] for name in names])
        turn, shift = np.exp(1j * poses[:, 2]), poses[:, 0] + 1j * poses[:, 1]
        ends = [
            turn[here] * (holes.reshape(-1, 2) @ (1.0, 1j)) + shift[here]
            for here, holes in zip(pinned, drilled, strict=True)
        ]
        pins = max(pins, float(np.abs(ends[0] - ends[1]).max(initial=0.0)))
        moved_points = turn[owner] * (points @ (1.0, 1j)) + shift[owner]
        placed = shapely.set_coordinates(areas.copy(), np.column_stack([moved_points.real, moved_points.imag]))
        one, other = shapely.STRtree(placed).query(placed, predicate="intersects")
        pairs = (one < other) & (layer[one] == layer[other])
        shared = shapely.area(shapely.intersection(placed[one[pairs]], placed[other[pairs]]))
        for number in set(layers.values()):
            overlap = max(overlap, float(shared[layer[one[pairs]] == number].sum()))
    return pins, overlap
