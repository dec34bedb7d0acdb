"""Cut plan -> DXF in millimetres: one polyline for each cut, in cutting order, the same bytes every time.

The file is read back with ezdxf and compared with the plan before it takes its name.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from io import StringIO
from pathlib import Path

import numpy as np
from ezdxf import units, zoom
from ezdxf._options import options
from ezdxf.document import Drawing
from ezdxf.entities.dxfentity import DXFEntity
from ezdxf.entities.lwpolyline import LWPolyline
from ezdxf.entities.polyline import Polyline
from ezdxf.filemanagement import new, readfile

from kirigami_studio import __version__
from kirigami_studio.export.dxf_content import PARSER_FAULTS
from kirigami_studio.export.profile import DEFAULT_PROFILE, Profile, find_profile
from kirigami_studio.export.verified import write_verified
from kirigami_studio.fabricate.cut_plan import CutPath, CutPlan
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.lattice.ratio_field import FloatArray

VERSIONS = ("R2010", "R12")
#: Layers that every DXF document has whether wanted or not.
UNAVOIDABLE_LAYERS = frozenset({"0", "Defpoints"})
#: Coordinates survive the text form exactly; anything above this (mm) is a fault.
SAME_MM = 1e-9

_FIXED_METADATA = threading.Lock()


@contextmanager
def _fixed_metadata() -> Iterator[None]:
    """Let ezdxf write a fixed date and identity, so that the same plan gives the same bytes."""
    with _FIXED_METADATA:
        before = options.write_fixed_meta_data_for_testing
        options.write_fixed_meta_data_for_testing = True
        try:
            yield
        finally:
            options.write_fixed_meta_data_for_testing = before


def write_dxf(
    plan: CutPlan, path: str | Path, version: str = "R2010", profile: str | Profile = DEFAULT_PROFILE
) -> None:
    """Write a plan, read it back and compare.

    Parameters
    ----------
    plan : CutPlan
    path : str or Path
    version : str
        "R2010", or "R12" for old programs; an R12 file cannot say its unit: import it as mm.
    profile : str or Profile
        Colour scheme.

    Raises
    ------
    ExportError
        Unknown version or profile, unwritable place, or a file that did not come back as it was meant.
    """
    chosen = find_profile(profile) if isinstance(profile, str) else profile
    content = dxf_bytes(plan, version, chosen)
    write_verified(Path(path), content, lambda written: _verify(written, plan, version, chosen))


def dxf_bytes(plan: CutPlan, version: str, profile: Profile) -> bytes:
    """Return the DXF file's bytes.

    Raises
    ------
    ExportError
        Unknown version.
    """
    if version not in VERSIONS:
        raise ExportError(f"The DXF version must be {' or '.join(VERSIONS)}, got {version!r}.")
    with _fixed_metadata():
        # R12 knows no units, and ezdxf.new would log that at every export.
        document = Drawing.new("R12") if version == "R12" else new(version, units=units.MM)
        document.header["$MEASUREMENT"] = 1
        for layer in plan.layers:
            document.layers.add(layer.value, color=profile.colour[layer])
        _draw(document, plan, version, profile)
        _describe(document, plan, version)
        if version != "R12":
            _sort_classes(document)
        text = StringIO()
        document.write(text)
    return document.encode(text.getvalue())


def _sort_classes(document: Drawing) -> None:
    """Put the CLASSES section in a fixed order; ezdxf fills it from a set, whose order differs between runs."""
    section = document.classes
    section.add_required_classes(document.dxfversion)
    section.classes = dict(sorted(section.classes.items()))


def _draw(document: Drawing, plan: CutPlan, version: str, profile: Profile) -> None:
    modelspace = document.modelspace()
    for path in plan.paths:
        points = [(float(x), float(y)) for x, y in path.points]
        attributes = {"layer": path.layer.value, "color": profile.colour[path.layer]}
        if version == "R12":
            modelspace.add_polyline2d(points, close=path.closed, dxfattribs=attributes)
        else:
            modelspace.add_lwpolyline(points, close=path.closed, dxfattribs=attributes)
    width, height = plan.bounds_mm
    modelspace.reset_extents((0.0, 0.0, 0.0), (width, height, 0.0))
    # ezdxf takes a corner at the origin for a missing one and would leave the header's extents empty.
    document.header["$EXTMIN"] = (0.0, 0.0, 0.0)
    document.header["$EXTMAX"] = (width, height, 0.0)
    modelspace.reset_limits((0.0, 0.0), (width, height))
    zoom.window(modelspace, (0.0, 0.0), (width, height))


def _describe(document: Drawing, plan: CutPlan, version: str) -> None:
    """Say in the file how it was made; R12 has no custom variables, only ezdxf's own records."""
    facts = {
        "KIRIGAMI_STUDIO": __version__,
        "DESIGN": plan.design_hash,
        "SIZE_MM": f"{plan.size_mm[0]:.4f} x {plan.size_mm[1]:.4f}",
        "CONNECTOR_MM": f"{plan.connector_mm:g}",
        "KERF_MM": f"{plan.kerf_mm:g}",
        "MATERIAL": plan.material.key,
        "PATHS": "beam centre lines, kerf already allowed for: apply no kerf offset",
    }
    record = document.ezdxf_metadata()
    for key, value in facts.items():
        record[key] = value
        if version != "R12":
            document.header.custom_vars.append(key, value)


def _verify(path: Path, plan: CutPlan, version: str, profile: Profile) -> None:
    """Read a written file back and compare everything that a cutter sees with the plan.

    Raises
    ------
    ExportError
        With the first difference.
    """
    try:
        document = readfile(path)
    except PARSER_FAULTS as error:
        raise ExportError(f"The DXF did not read back: {error}. Nothing was written; please report it.") from error
    if fault := _first_difference(document, plan, version, profile):
        raise ExportError(f"The DXF did not pass its own check: {fault}. Nothing was written; please report it.")


def _first_difference(document: Drawing, plan: CutPlan, version: str, profile: Profile) -> str | None:
    if version != "R12" and document.header.get("$INSUNITS") != units.MM:
        return f"its unit is {document.header.get('$INSUNITS')} instead of 4 (mm)"
    if tuple(document.header["$EXTMIN"])[:2] != (0.0, 0.0) or tuple(document.header["$EXTMAX"])[:2] != plan.bounds_mm:
        return f"its extents are {document.header['$EXTMIN']} to {document.header['$EXTMAX']}"
    layers = {layer.dxf.name for layer in document.layers}
    if layers - UNAVOIDABLE_LAYERS != {layer.value for layer in plan.layers}:
        return f"its layers are {', '.join(sorted(layers))}"
    if errors := document.audit().errors:
        return f"ezdxf's audit found {len(errors)} errors, the first: {errors[0].message}"
    entities = list(document.modelspace())
    if len(entities) != len(plan.paths):
        return f"it holds {len(entities)} entities instead of {len(plan.paths)}"
    for number, (entity, path) in enumerate(zip(entities, plan.paths, strict=True)):
        if fault := _entity_difference(entity, path, profile):
            return f"entity {number} {fault}"
    return None


def _entity_difference(entity: DXFEntity, path: CutPath, profile: Profile) -> str | None:
    if isinstance(entity, LWPolyline):
        points: FloatArray = np.array(list(entity.vertices()), dtype=np.float64)
        closed = bool(entity.closed)
    elif isinstance(entity, Polyline):
        points = np.array([(point.x, point.y) for point in entity.points()], dtype=np.float64)
        closed = bool(entity.is_closed)
    else:
        return f"is a {entity.dxftype()} instead of a polyline"
    if (entity.dxf.layer, entity.dxf.color) != (path.layer.value, profile.colour[path.layer]):
        return f"is on layer {entity.dxf.layer} in colour {entity.dxf.color}"
    if closed != path.closed:
        return f"is {'closed' if closed else 'open'}"
    if points.shape != path.points.shape or not np.all(np.abs(points - path.points) <= SAME_MM):
        return f"has the points {points.tolist()} instead of {path.points.tolist()}"
    return None
