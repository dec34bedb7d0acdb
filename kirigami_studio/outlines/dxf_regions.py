"""REGION entities of DXF -> the rings of their faces.

The body of a region is ACIS data, which ezdxf reads as far as faces, edges and straight lines; circles and ellipses are
read here.  A region with other curves (splines) or with curved faces cannot be read.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from ezdxf.acis import entities as acis
from ezdxf.acis.const import AcisException
from ezdxf.acis.dxf import load_dxf
from ezdxf.entities.dxfgfx import DXFGraphic
from ezdxf.math import Matrix44, Vec3

#: Vertices of a whole ellipse, and entities in one chain at most.
ELLIPSE_VERTICES, MOST_LINKS = 128, 20_000
#: Share of an ellipse's axis from which on the ends of an edge are two places.
SAME_PLACE = 1e-9


@acis.register
class EllipseCurve(acis.Curve):
    """A circle or an ellipse."""

    type: str = "ellipse-curve"
    centre, normal, major, ratio = Vec3(), Vec3(0, 0, 1), Vec3(1, 0, 0), 1.0

    def restore_data(self, loader: Any) -> None:
        """Take the data of a record."""
        self.centre, self.normal, self.major = (Vec3(loader.read_vec3()) for _ in range(3))
        self.ratio = float(loader.read_double())
        super().restore_data(loader)

    def evaluate(self, param: float) -> Vec3:
        """The place at an angle, radians from the major axis on."""
        return self.centre + self.major * np.cos(param) + self._minor * np.sin(param)

    @property
    def _minor(self) -> Vec3:
        return self.normal.normalize().cross(self.major) * self.ratio

    def angle_of(self, place: Vec3) -> float:
        """The angle of a place on it, radians."""
        off, minor = place - self.centre, self._minor
        along, across = off.dot(self.major) / self.major.magnitude_square, off.dot(minor) / minor.magnitude_square
        return float(np.arctan2(across, along))


def region_rings(entity: DXFGraphic) -> list[list[Vec3]] | None:
    """The closed rings of a region's faces, drawing units; None where one cannot be read.

    A place inside an odd number of rings lies in the region.
    """
    try:
        bodies = load_dxf(entity)
        rings = [ring for body in bodies for ring in _rings(body)]
    except (AcisException, ValueError, TypeError, ArithmeticError, LookupError, AttributeError):
        return None
    moved: Matrix44 | None = entity._temporary_transformation.get_matrix()  # type: ignore[attr-defined]
    rings = [ring if moved is None else list(moved.transform_vertices(ring)) for ring in rings]
    return rings or None


def _rings(body: acis.Body) -> Iterator[list[Vec3]]:
    placed = None if body.transform.is_none else body.transform.matrix
    faces = (
        face
        for lump in _linked(body.lump, "next_lump")
        for shell in _linked(lump.shell, "next_shell")
        for face in _linked(shell.face, "next_face")
    )
    for face in faces:
        if not isinstance(face.surface, acis.Plane):
            raise ValueError(f"faces of a {face.surface.type} are not read")
        for loop in _linked(face.loop, "next_loop"):
            coedges = list(_linked(loop.coedge, "next_coedge"))
            if coedges and coedges[-1].next_coedge is not loop.coedge:
                raise ValueError("a loop is not closed")
            ring = [place for coedge in coedges for place in _places(coedge)]
            yield ring if placed is None else list(placed.transform_vertices(ring))


def _linked(first: Any, link: str) -> Iterator[Any]:
    """An entity and all that it leads to, until there is no more or the first one comes again."""
    one = first
    for _ in range(MOST_LINKS):
        if one.is_none:
            return
        yield one
        one = getattr(one, link)
        if one is first:
            return
    raise ValueError("entities lead to each other without end")


def _places(coedge: acis.Coedge) -> list[Vec3]:
    """The vertices of an edge as its loop runs, but for the last one."""
    edge = coedge.edge
    ends = [edge.start_vertex.point.location, edge.end_vertex.point.location]
    if isinstance(edge.curve, acis.StraightCurve):
        places = ends
    elif isinstance(edge.curve, EllipseCurve):
        places = _arc(edge.curve, ends[::-1] if edge.sense else ends)
        places = places[::-1] if edge.sense else places
    else:
        raise ValueError(f"curves of kind {edge.curve.type} are not read")
    return places[:0:-1] if coedge.sense else places[:-1]


def _arc(curve: EllipseCurve, ends: list[Vec3]) -> list[Vec3]:
    """The vertices of an arc from one end to the other, in the direction of the curve."""
    begun, ended = (curve.angle_of(place) for place in ends)
    if ends[0].isclose(ends[1], abs_tol=SAME_PLACE * curve.major.magnitude):
        ended = begun
    turn = (ended - begun) % (2.0 * np.pi) or 2.0 * np.pi
    pieces = max(int(np.ceil(ELLIPSE_VERTICES * turn / (2.0 * np.pi))), 2)
    inner = [curve.evaluate(begun + turn * step / pieces) for step in range(1, pieces)]
    return [ends[0], *inner, ends[1]]
