"""FOLD 1.2, for origami programs: panels as faces, cuts as edges, frames for angles.

Two panels share the vertex of their hinge, and no edge; each edge along a cut stands twice, once for each side.
Pins of pieces in layers lie within their faces, so all hinges are listed by themselves, too.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from kirigami_studio import __version__
from kirigami_studio.assembly.pieces import Assembly
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.linkage import linkage_of
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically

#: Frames beside the flat sheet, as shares of the way to the target angle.
SHARES = (0.25, 0.5, 0.75, 1.0)
#: Nearer than this (mm) a vertex is that of the hinge.
SAME_MM = 1e-6
#: Gaps narrower than this (mm) between panels of the flat sheet are rounding.
HAIR_MM = 1e-3
#: Decimals of coordinates (mm).
DECIMALS = 9


def write_fold(job: ExportJob, path: Path) -> None:
    """Write the motion of a job, and read it back.

    Raises
    ------
    ExportError
        An unwritable place, or a file that did not read back.
    """
    data = fold_of(job)

    def verify(written: Path) -> None:
        if json.loads(written.read_text(encoding="utf-8")) != data:
            raise ExportError("linkage.not_as_written", name=path.name)

    write_atomically(path, json.dumps(data, separators=(",", ":"), allow_nan=False).encode("utf-8"), verify)


def fold_of(job: ExportJob) -> dict[str, Any]:
    """The file as a value; lengths in mm, angles in radians."""
    linkage = linkage_of(job)
    faces, owners = _faces(linkage)
    edges = [(one, other) for face in faces for one, other in zip(face, [*face[1:], face[0]], strict=True)]
    flat = _vertices(linkage, owners, math.pi)
    in_layers = len({piece.layer for piece in linkage.pieces}) > 1
    number = {piece.id: place for place, piece in enumerate(linkage.pieces)}
    pins = _vertices(linkage, [(number[hinge.pieces[0]], hinge.at[0]) for hinge in linkage.hinges], math.pi)
    angles = [math.pi + share * (linkage.phi_target - math.pi) for share in SHARES]
    return {
        "file_spec": 1.2,
        "file_creator": f"Kirigami Studio {__version__}",
        "file_classes": ["singleModel", "animation"],
        "frame_title": _title(math.pi),
        "frame_classes": ["creasePattern"],
        "frame_attributes": ["2D", "cuts", "noJoins", "selfTouching" if in_layers else "nonSelfTouching"],
        "frame_unit": "mm",
        "vertices_coords": flat.tolist(),
        "edges_vertices": [list(edge) for edge in edges],
        "edges_assignment": ["B"] * len(edges) if in_layers else _assignment(flat, edges, faces),
        "faces_vertices": [list(face) for face in faces],
        "faces_kirigami:name": [piece.id for piece in linkage.pieces],
        "faces_kirigami:layer": [piece.layer for piece in linkage.pieces],
        "kirigami:hinges": [
            {"faces": [number[name] for name in hinge.pieces], "at": at}
            for hinge, at in zip(linkage.hinges, pins.tolist(), strict=True)
        ],
        "kirigami:phi": math.pi,
        "kirigami:facts": dict(job.provenance),
        "file_frames": [
            {
                "frame_title": _title(phi),
                "frame_classes": ["foldedForm"],
                "frame_parent": 0,
                "frame_inherit": True,
                "vertices_coords": _vertices(linkage, owners, phi).tolist(),
                "kirigami:phi": phi,
            }
            for phi in angles
        ],
    }


def _title(phi: float) -> str:
    return f"phi = {math.degrees(phi):.1f} degrees"


def _faces(linkage: Assembly) -> tuple[list[list[int]], list[tuple[int, FloatArray]]]:
    """Vertex numbers of all parts; part and place of each vertex.  Parts share those at hinges."""
    faces: list[list[int]] = []
    owners: list[tuple[int, FloatArray]] = []
    shared: dict[int, int] = {}
    at_hinges: dict[str, list[tuple[int, FloatArray]]] = {piece.id: [] for piece in linkage.pieces}
    for hinge in linkage.hinges:
        for name, at in zip(hinge.pieces, hinge.at, strict=True):
            at_hinges[name].append((hinge.node, at))
    for part, piece in enumerate(linkage.pieces):
        face = []
        for corner in piece.outline:
            near = (node for node, at in at_hinges[piece.id] if np.abs(corner - at).max() < SAME_MM)
            node = next(near, None)
            if node is None or node not in shared:
                owners.append((part, corner))
            number = len(owners) - 1 if node is None else shared.setdefault(node, len(owners) - 1)
            face.append(number)
        faces.append(face)
    return faces, owners


def _vertices(linkage: Assembly, owners: list[tuple[int, FloatArray]], phi: float) -> FloatArray:
    """Places (V, 2) of all vertices at an angle, mm."""
    poses = linkage.poses(phi)[[part for part, _ in owners]]
    corners = np.array([corner for _, corner in owners]).reshape(-1, 2)
    plane = (corners[:, 0] + 1j * corners[:, 1]) * np.exp(1j * poses[:, 2]) + poses[:, 0] + 1j * poses[:, 1]
    return np.round(np.column_stack([plane.real, plane.imag]), DECIMALS) + 0.0


def _assignment(flat: FloatArray, edges: list[tuple[int, int]], faces: list[list[int]]) -> list[str]:
    """Edges of the flat sheet's rim, B, and those along cuts, C."""
    panels = np.array([shapely.make_valid(shapely.Polygon(flat[face])) for face in faces], dtype=object)
    # Wider by a hair: panels that touch along a cut have no gap then.
    sheet = shapely.union_all(shapely.buffer(panels, HAIR_MM, join_style="mitre"))
    lines = shapely.linestrings(flat[np.array(edges)])
    rest = shapely.difference(lines, shapely.buffer(sheet.boundary, 2.0 * HAIR_MM))
    return ["B" if left < 4.0 * HAIR_MM else "C" for left in shapely.length(rest).tolist()]
