"""Readers of printed solids that share no code with the product: numpy-stl, lib3mf, edges counted by NumPy."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import lib3mf
import numpy as np
from stl import mesh as stl_mesh


@dataclass(frozen=True)
class ReadBody:
    """A body of a file: triangles (F, 3, 3) in mm, its name, and the colour of its material as #RRGGBB."""

    triangles: np.ndarray
    name: str = ""
    colour: str = ""

    @property
    def volume(self) -> float:
        """By the divergence theorem, mm3."""
        one, two, three = np.moveaxis(self.triangles.astype(np.float64), 1, 0)
        return float(np.einsum("ij,ij->", one, np.cross(two, three)) / 6.0)

    @property
    def closed(self) -> bool:
        """Whether every edge belongs to two triangles that run along it in opposite directions, none is a point."""
        corners = self.triangles.reshape(-1, 3)
        faces = np.unique(corners, axis=0, return_inverse=True)[1].reshape(-1, 3)
        edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
        once = np.unique(edges, axis=0)
        return bool(
            len(once) == len(edges)
            and np.array_equal(once, np.unique(edges[:, ::-1], axis=0))
            and np.all(edges[:, 0] != edges[:, 1])
        )

    @property
    def bounds(self) -> np.ndarray:
        """Lowest and highest coordinates (2, 3), mm."""
        corners = self.triangles.reshape(-1, 3)
        return np.stack([corners.min(axis=0), corners.max(axis=0)])


def read_stl(path: Path) -> ReadBody:
    """All triangles of an STL file."""
    return ReadBody(np.array(stl_mesh.Mesh.from_file(str(path), calculate_normals=False).vectors))


def read_3mf(path: Path) -> dict[str, ReadBody]:
    """The bodies of a 3MF file in mm, which is read strictly."""
    library = lib3mf.get_wrapper()
    model = library.CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(path))
    assert reader.GetWarningCount() == 0
    assert model.GetUnit() == lib3mf.ModelUnit.MilliMeter
    found = {}
    items, objects = model.GetBuildItems(), model.GetMeshObjects()
    placed = set()
    while items.MoveNext():
        placed.add(items.GetCurrent().GetObjectResourceID())
    groups = model.GetComponentsObjects()
    while groups.MoveNext():  # several bodies are parts of one object, as they are
        group = groups.GetCurrentComponentsObject()
        assert group.GetResourceID() in placed and len(placed) == 1
        parts = [group.GetComponent(number) for number in range(group.GetComponentCount())]
        assert not any(part.HasTransform() for part in parts)
        placed |= {part.GetObjectResourceID() for part in parts}
    while objects.MoveNext():
        body = objects.GetCurrentMeshObject()
        assert body.GetResourceID() in placed and body.IsManifoldAndOriented() and body.IsValid()
        vertices = np.array([vertex.Coordinates[:] for vertex in body.GetVertices()])
        faces = np.array([triangle.Indices[:] for triangle in body.GetTriangleIndices()])
        group, number, chosen = body.GetObjectLevelProperty()
        assert chosen
        colour = model.GetBaseMaterialGroupByID(group).GetDisplayColor(number)
        shade = f"#{colour.Red:02X}{colour.Green:02X}{colour.Blue:02X}"
        found[body.GetName()] = ReadBody(vertices[faces], body.GetName(), shade)
    return found
