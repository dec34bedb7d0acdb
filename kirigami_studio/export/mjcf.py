"""MJCF, the models of MuJoCo: bodies of parts, joints at hinges, contacts within layers.

Lengths are in metres.  Parts form a tree of hinge joints from the one in the middle, which stays where it is; hinges
that close loops are equality constraints.  A joint's angle is 0 in the flat sheet and pi - phi at phi: its range ends
there because two parts lie on each other's edges then.  The model stands half open: in the flat sheet all four hinges
of a void lie in one line, and it could leave that state by bending the wrong way.
"""

from __future__ import annotations

import math
from collections import deque
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio import __version__
from kirigami_studio.assembly.pieces import Assembly, Hinge, Piece
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.linkage import linkage_of
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically

#: Metres of a millimetre.
METRES = 1e-3
#: Shapes for contacts are smaller than their parts by this (mm), and off that by up to half of it.
INSET_MM = 0.1
#: kg / m^3; of wood and paper: forces scale with it, ways do not.
DENSITY = 700.0
#: Name of the actuator that closes and opens the sheet.
DRIVE = "drive"


def write_mjcf(job: ExportJob, path: Path) -> None:
    """Write the model of a job, and read it back.

    Raises
    ------
    ExportError
        Parts that do not hang together, an unwritable place, or a file that did not read back.
    """
    model = model_of(linkage_of(job), job.thickness_mm)
    ElementTree.indent(model)
    content = ElementTree.tostring(model, encoding="unicode")

    def verify(written: Path) -> None:
        if ElementTree.canonicalize(written.read_text(encoding="utf-8")) != ElementTree.canonicalize(content):
            raise ExportError("linkage.not_as_written", name=path.name)

    write_atomically(path, content.encode("utf-8"), verify)


def model_of(linkage: Assembly, thickness_mm: float) -> Element:
    """The model of parts and hinges.

    Raises
    ------
    ExportError
        Parts that do not hang together.
    """
    start = 0.5 * (math.pi + linkage.phi_target)
    model = Element("mujoco", model="kirigami")
    model.append(ElementTree.Comment(f" Kirigami Studio {__version__}; metres, kilograms, seconds, radians "))
    SubElement(model, "compiler", angle="radian", autolimits="true", boundmass="1e-6", boundinertia="1e-10")
    SubElement(model, "option", timestep="0.0005", integrator="implicitfast", cone="elliptic")
    assets, world = SubElement(model, "asset"), SubElement(model, "worldbody")
    poses = linkage.poses(start)
    place = {piece.id: number for number, piece in enumerate(linkage.pieces)}
    first = int(np.argmin(np.hypot(*(poses[:, :2] - poses[:, :2].mean(axis=0)).T)))
    bodies = {first: _body(linkage.pieces[first], world, assets, thickness_mm, poses[first], np.zeros(3))}
    loops, joints = list(linkage.hinges), []
    beside: dict[int, list[tuple[int, Hinge]]] = {number: [] for number in place.values()}
    for hinge in linkage.hinges:
        for name, neighbour in (hinge.pieces, hinge.pieces[::-1]):
            beside[place[name]].append((place[neighbour], hinge))
    waiting = deque([first])
    while waiting:
        number = waiting.popleft()
        for other, hinge in beside[number]:
            if other in bodies:
                continue
            piece = linkage.pieces[other]
            body = _body(piece, bodies[number], assets, thickness_mm, poses[other], poses[number])
            bodies[other] = body
            joints.append(_joint(body, piece, hinge, math.pi - start))
            loops.remove(hinge)
            waiting.append(other)
    if len(bodies) < len(linkage.pieces):
        raise ExportError("linkage.apart", parts=len(linkage.pieces), together=len(bodies))
    equality, contact = SubElement(model, "equality"), SubElement(model, "contact")
    for hinge in loops:
        ends = {"name": f"loop{hinge.node}", "body1": hinge.pieces[0], "body2": hinge.pieces[1]}
        SubElement(equality, "connect", ends, anchor=_metres(hinge.at[0]), solref="0.001 1")
    for pair in sorted({hinge.pieces for hinge in linkage.hinges}):
        SubElement(contact, "exclude", body1=pair[0], body2=pair[1])
    if joints:
        actuator, states = SubElement(model, "actuator"), SubElement(model, "keyframe")
        limits = {"ctrlrange": f"0 {math.pi - linkage.phi_target:.9g}", "kp": "0.5", "kv": "0.01"}
        SubElement(actuator, "position", limits, name=DRIVE, joint=joints[0])
        for name, phi in (("flat", math.pi), ("half", start), ("target", linkage.phi_target)):
            turn = f"{math.pi - phi:.12g}"
            SubElement(states, "key", name=name, qpos=" ".join([turn] * len(joints)), ctrl=turn)
    return model


def _body(
    piece: Piece, parent: Element, assets: Element, thickness_mm: float, pose: FloatArray, frame: FloatArray
) -> Element:
    """A part and its convex shapes as a body of its parent, whose pose is ``frame``."""
    x, y = pose[:2] - frame[:2]
    cosine, sine = math.cos(frame[2]), math.sin(frame[2])
    at = _metres(np.array([cosine * x + sine * y, cosine * y - sine * x]))
    body = SubElement(parent, "body", name=piece.id, pos=at, euler=f"0 0 {pose[2] - frame[2]:.12g}")
    low = -thickness_mm * (piece.layer - 1)
    layer = {"contype": str(piece.layer), "conaffinity": str(piece.layer)}
    for number, shape in enumerate(convex_shapes(piece), start=1):
        name = f"{piece.id}.{number}"
        corners = shapely.get_coordinates(shape)[:-1]
        ends = [np.column_stack([corners, np.full(len(corners), z)]) for z in (low, low + thickness_mm)]
        SubElement(assets, "mesh", name=name, vertex=_metres(np.concatenate(ends).ravel()))
        kind = {"type": "mesh", "mesh": name, "density": f"{DENSITY:g}"}
        SubElement(body, "geom", kind | layer, name=name, friction="0.1", solref="0.004 1")
    return body


def _joint(body: Element, piece: Piece, hinge: Hinge, turn: float) -> str:
    """The joint of a body with its parent at an angle of ``turn``; its name."""
    at = hinge.at[hinge.pieces.index(piece.id)]
    name, way = f"hinge{hinge.node}", 1 if sum(piece.panel) % 2 else -1
    limits = {"ref": f"{turn:.12g}", "range": f"0 {math.pi:.9g}", "damping": "1e-5", "armature": "1e-7"}
    # Before the shapes, as programs that read line by line expect it.
    body.insert(0, Element("joint", limits, name=name, type="hinge", axis=f"0 0 {way}", pos=_metres(at)))
    return name


def _metres(lengths_mm: FloatArray) -> str:
    """Lengths, mm, as MJCF has them; two of them are a place in the plane."""
    numbers = [f"{METRES * length:.12g}" for length in lengths_mm.tolist()]
    return " ".join([*numbers, "0"] if len(numbers) == 2 else numbers)


def convex_shapes(piece: Piece) -> list[BaseGeometry]:
    """Convex polygons (mm) that fill a part but for its rim: MuJoCo takes hulls of shapes."""
    part = Polygon(piece.outline, piece.openings)
    region = part.simplify(0.25 * INSET_MM).buffer(-INSET_MM, join_style="mitre").simplify(0.25 * INSET_MM)
    shapes: list[BaseGeometry] = []
    for triangle in shapely.get_parts(shapely.constrained_delaunay_triangles(region)):
        shape: BaseGeometry = triangle
        grown = True
        while grown:
            grown = False
            for number, other in enumerate(shapes):
                both = shape.union(other)
                hull = both.convex_hull
                if isinstance(both, Polygon) and _depth(both, hull) <= 0.5 * INSET_MM:
                    shape, grown = hull, True
                    del shapes[number]
                    break
        shapes.append(shape)
    return shapes


def _depth(shape: Polygon, hull: BaseGeometry) -> float:
    """How far the hollows of a shape lie within its hull."""
    return float(shape.exterior.hausdorff_distance(hull.boundary))
