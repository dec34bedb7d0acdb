"""DXF drawings -> Outline: the largest closed contour in model space."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
from ezdxf import recover, units
from ezdxf.document import Drawing
from ezdxf.entities.dxfentity import DXFEntity
from ezdxf.entities.dxfgfx import DXFGraphic
from ezdxf.entities.insert import Insert
from ezdxf.enums import InsertUnits
from ezdxf.filemanagement import readfile
from ezdxf.lldxf.const import DXFError
from ezdxf.path import make_path

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import tr
from kirigami_studio.outlines.contour import thinned
from kirigami_studio.outlines.joining import join
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.pieces import largest_piece
from kirigami_studio.outlines.source_file import decoding, read_bytes

#: Entities that are lines of a contour; everything else in a drawing is text, measures and decoration.
CURVES = frozenset({"LINE", "ARC", "LWPOLYLINE", "POLYLINE", "SPLINE", "CIRCLE", "ELLIPSE", "HELIX"})

TEXTS = frozenset({"TEXT", "MTEXT", "ATTRIB", "ATTDEF"})

#: Gaps up to this share of the drawing's size are closed: sloppy snapping, not a missing line.
WIDEST_GAP = 0.005

#: Deviation of flattened curves from the true ones, share of the drawing's size.
FLATNESS = 1.0 / 4000.0

#: Blocks nest and repeat; a drawing that unfolds to more entities than this is no outline.
MOST_ENTITIES = 100_000
DEEPEST_BLOCK = 16


def read_dxf(path: str | Path) -> Outline:
    """Outline of the largest closed contour of a DXF file.

    LINE, ARC, LWPOLYLINE, POLYLINE, SPLINE, CIRCLE and ELLIPSE entities on visible layers of model
    space, blocks included, are joined where their ends meet; gaps up to 0.5 % of the size are closed.

    Returns
    -------
    Outline
        ``size`` in mm when the file states its unit ($INSUNITS), otherwise without unit.

    Raises
    ------
    TargetError
        Not a DXF file, damaged beyond repair, no lines, or an open contour (with the gap and its place).
    """
    path = Path(path)
    content = read_bytes(path, most_megabytes=50)
    with decoding(path, "source.dxf_damaged"):
        drawing, notes = _opened(path, content)
        curves, texts = _visible(drawing)
        if not curves:
            raise TargetError("dxf.no_lines_but_text" if texts else "dxf.no_lines")
        # A file that does not state its unit is given metres by ezdxf; here it stays without unit.
        has_unit = b"$INSUNITS" in content and drawing.units != InsertUnits.Unitless
        to_mm = units.conversion_factor(InsertUnits(drawing.units), InsertUnits.Millimeters) if has_unit else 1.0
        unit = "mm" if has_unit else ""
        region, joints = join([chain * to_mm for chain in _flattened(curves)], WIDEST_GAP, unit)
        ring, dropped = largest_piece(region)
        return Outline.from_points(thinned(ring), name=path.stem, notes=(*notes, *joints, *dropped), unit=unit)


def _opened(path: Path, content: bytes) -> tuple[Drawing, tuple[str, ...]]:
    """Read strictly, then with ezdxf's recover mode."""
    try:
        return readfile(path), ()
    except (DXFError, OSError, ValueError, LookupError, TypeError, AttributeError):
        drawing, _ = recover.read(io.BytesIO(content))
        return drawing, (tr("The file was damaged and was repaired while reading. Check the shape."),)


def _visible(drawing: Drawing) -> tuple[list[DXFGraphic], int]:
    """Curves on visible layers of model space, blocks unfolded, and the number of texts."""
    hidden = {layer.dxf.name.lower() for layer in drawing.layers if layer.is_off() or layer.is_frozen()}
    curves: list[DXFGraphic] = []
    texts = 0
    for count, entity in enumerate(_unfolded(drawing.modelspace(), 0)):
        if count >= MOST_ENTITIES:
            raise TargetError("dxf.too_many_entities", limit=MOST_ENTITIES)
        if not isinstance(entity, DXFGraphic) or entity.dxf.layer.lower() in hidden or entity.dxf.invisible:
            continue
        texts += entity.dxftype() in TEXTS
        if entity.dxftype() in CURVES:
            curves.append(entity)
    return curves, texts


def _unfolded(entities: Iterable[DXFEntity], depth: int) -> Iterator[DXFEntity]:
    if depth > DEEPEST_BLOCK:
        raise TargetError("dxf.blocks_too_deep", limit=DEEPEST_BLOCK)
    for entity in entities:
        if not isinstance(entity, Insert):
            yield entity
            continue
        if entity.mcount > MOST_ENTITIES:
            raise TargetError("dxf.block_repeated", times=entity.mcount)
        for single in entity.multi_insert() if entity.mcount > 1 else (entity,):
            yield from _unfolded(single.virtual_entities(), depth + 1)


def _flattened(curves: Iterable[DXFGraphic]) -> list[FloatArray]:
    """Curves as chains of (P, 2) vertices, drawing units; z is dropped."""
    paths = [path for path in map(make_path, curves) if len(path) > 0]
    if not paths:
        raise TargetError("dxf.no_length")
    corners = np.array([(corner.x, corner.y) for path in paths for corner in path.control_vertices()])
    if not np.isfinite(corners).all():
        raise TargetError("drawing.not_finite")
    distance = float(np.max(np.ptp(corners, axis=0))) * FLATNESS
    if distance == 0.0:
        raise TargetError("dxf.one_point")
    return [np.array([(vertex.x, vertex.y) for vertex in path.flattening(distance, segments=4)]) for path in paths]
