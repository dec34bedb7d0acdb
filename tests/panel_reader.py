"""A reader of cut files that shares no code with the product: ezdxf has the curves, shapely the areas.

The sheet is what is left inside the outline once every cut has burned its kerf.  Eroding it by half a connector parts
it into panels.  Every connector that breaks joins two holes or makes a part, so that parts less holes count them, and
tell at which width the first one breaks.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import ezdxf
import numpy as np
import numpy.typing as npt
import shapely
from ezdxf.path import make_path
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

FloatArray = npt.NDArray[np.float64]
#: Chord tolerance (mm) of arcs, and half the width (mm) of cuts without a kerf.
CHORD_MM, BLADE_MM = 1e-4, 1e-5
#: Parts smaller than this (mm^2) are rounding.
DUST_MM2 = 1e-4
#: Chords of a quarter circle of a burned tip.
ROUND = 32


@dataclass(frozen=True)
class ReadSheet:
    """The sheet that a file leaves.

    Attributes
    ----------
    area : Polygon or MultiPolygon, mm
    """

    area: BaseGeometry

    def parts(self, eroded_mm: float = 0.0) -> list[Polygon]:
        """Its parts after erosion, crumbs left out."""
        left = shapely.buffer(self.area, -eroded_mm, quad_segs=ROUND) if eroded_mm else self.area
        return [part for part in shapely.get_parts(left) if part.area > DUST_MM2]

    def broken(self, width_mm: float) -> int:
        """How many connectors are narrower than a width (mm): each one that breaks opens a hole or makes a part."""
        return self._parts_less_holes(0.5 * width_mm) - self._parts_less_holes(0.0)

    def _parts_less_holes(self, eroded_mm: float) -> int:
        return sum(1 - len(part.interiors) for part in self.parts(eroded_mm))

    def narrowest(self, up_to_mm: float, within_mm: float = 5e-4) -> float:
        """Width (mm) of the narrowest connector; ``up_to_mm`` where none is narrower."""
        low_mm, high_mm = 0.0, up_to_mm
        while high_mm - low_mm > within_mm:
            middle = 0.5 * (low_mm + high_mm)
            low_mm, high_mm = (low_mm, middle) if self.broken(middle) else (middle, high_mm)
        return high_mm

    def panels_and_hinges(self, connector_mm: float) -> tuple[int, int]:
        """Panels that connectors of at most this width hold together, and how many of these there are."""
        return len(self.parts(0.51 * connector_mm)), self.broken(1.02 * connector_mm)


def read_sheet(path: Path, kerf_mm: float, copies: int = 1) -> ReadSheet:
    """Cut the sheet of a DXF of centre lines: its first copy.

    Parameters
    ----------
    path : Path
        A file, or a folder of one for each layer.
    kerf_mm : float
    copies : int
        That the file holds, one after the other.
    """
    lines, closed = _curves(path, copies)
    half = max(0.5 * kerf_mm, BLADE_MM)
    outline = shapely.buffer(Polygon(lines[-1]), -half, join_style="mitre")
    burned = [shapely.buffer(LineString(line), half, quad_segs=ROUND) for line in lines[:-1]]
    burned += [Polygon(line) for line, shut in zip(lines[:-1], closed, strict=False) if shut]
    return ReadSheet(shapely.difference(outline, shapely.union_all(burned)))


def edge_cuts(path: Path) -> tuple[list[LineString], LineString]:
    """Centre lines of the cuts of a DXF that cross its outline, each from the outside inwards, and the outline's."""
    curves, _ = _curves(path, 1)
    lines = [LineString(curve) for curve in curves]
    outline = lines[-1]
    crossing = [line for line in lines[:-1] if line.intersects(outline)]
    far = Polygon(outline)
    return [line if not far.contains(Point(line.coords[0])) else line.reverse() for line in crossing], outline


def _curves(path: Path, copies: int) -> tuple[list[FloatArray], list[bool]]:
    """The curves of the first copy, (P, 2) mm each, and which are closed; names and marks are none."""
    files = sorted(path.glob("*.dxf")) if path.is_dir() else [path]
    entities = [entity for file in files for entity in ezdxf.readfile(file).modelspace()]
    entities = [entity for entity in entities if entity.dxf.layer not in ("NAME", "REGISTRATION")]
    entities = entities[: len(entities) // copies]
    lines = [np.array([(v.x, v.y) for v in make_path(entity).flattening(CHORD_MM)]) for entity in entities]
    return lines, [bool(getattr(one, "closed", False) or getattr(one, "is_closed", False)) for one in entities]
