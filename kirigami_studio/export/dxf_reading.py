"""The first reader of DXF: ezdxf, with its audit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from ezdxf.document import Drawing
from ezdxf.entities.lwpolyline import LWPolyline
from ezdxf.entities.polyline import Polyline
from ezdxf.filemanagement import readfile

from kirigami_studio.export.dxf_content import PARSER_FAULTS
from kirigami_studio.export.file_content import FileContent
from kirigami_studio.export.strokes import Stroke
from kirigami_studio.foundation.errors import ExportError


def read_with_ezdxf(path: Path) -> FileContent:
    """Read a DXF's header, layers and polylines.

    Raises
    ------
    ExportError
        The file does not read, or ezdxf's audit finds an error.
    """
    try:
        document = readfile(path)
        errors = document.audit().errors
    except (OSError, *PARSER_FAULTS) as error:
        raise ExportError(f"{path} is not a readable DXF: {error}. Export it again.") from error
    if errors:
        raise ExportError(f"ezdxf's audit found {len(errors)} errors in {path}, the first: {errors[0].message}.")
    return _content(document)


def _content(document: Drawing) -> FileContent:
    strokes, others = [], []
    for entity in document.modelspace():
        if isinstance(entity, LWPolyline):
            table = np.array(entity.get_points("xyb"), dtype=np.float64).reshape(-1, 3)
            closed = bool(entity.closed)
        elif isinstance(entity, Polyline):
            rows = [(v.dxf.location.x, v.dxf.location.y, v.dxf.bulge) for v in entity.vertices]
            table = np.array(rows, dtype=np.float64).reshape(-1, 3)
            closed = bool(entity.is_closed)
        else:
            others.append(entity.dxftype())
            continue
        bulges = table[:, 2] if table[:, 2].any() else None
        strokes.append(Stroke(table[:, :2], closed, entity.dxf.layer, entity.dxf.color, bulges))
    corner = document.header.get("$EXTMAX")
    old = document.dxfversion == "AC1009"
    return FileContent(
        reader="ezdxf",
        strokes=tuple(strokes),
        unit=None if old else int(document.header.get("$INSUNITS", 0)),
        extent=None if corner is None else (float(corner[0]), float(corner[1])),
        layers={layer.dxf.name: layer.dxf.color for layer in document.layers},
        others=tuple(others),
    )
