"""Solids -> STL, OBJ and 3MF in mm, read back before they appear.

STL and OBJ are written by trimesh.  3MF is a zip archive with a few lines of XML: trimesh's has no colours and other
identifiers every time, and the same plan gives the same bytes here.  A plate is a file; those after the first have its
number in their names.
"""

from __future__ import annotations

import zipfile
from collections.abc import Callable, Mapping
from io import BytesIO
from pathlib import Path
from types import MappingProxyType
from xml.etree import ElementTree

import numpy as np
import trimesh

from kirigami_studio import __version__
from kirigami_studio.assembly.printed import print_plates
from kirigami_studio.assembly.solids import Plate
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.profile import find_profile
from kirigami_studio.export.provenance import facts_of
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically

#: Names and colours of the layers in 3MF.
LAYER_COLOURS = {1: ("Layer 1", "#E07A3FFF"), 2: ("Layer 2", "#2F6F8FFF")}
#: Share by which a volume may differ from the planned one after reading back.
SAME_VOLUME = 1e-3
#: Extents may differ by this much (mm): single precision has a tenth of it on 3 m.
SAME_PLACE_MM = 2e-3
#: Bytes before the triangles of a binary STL, which programs skip.
STL_HEADER = 80
#: Decimals of coordinates (mm) in 3MF and OBJ.
DECIMALS = 6
#: Name of the object that has all bodies of a plate.
TOGETHER = "Kirigami"
CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
MODEL = "3D/3dmodel.model"
RELATIONSHIPS = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship '
    f'Target="/{MODEL}" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)
CONTENT_TYPES = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>'
)


#: What is read back, by the names of the bodies.
Bodies = Mapping[str, trimesh.Trimesh]


def write_meshes(job: ExportJob, path: Path) -> tuple[Path, ...]:
    """Write the solids of a job, a file for each plate, and read them back.

    Raises
    ------
    FabricationError
        The design cannot be printed like this.
    ExportError
        The place cannot be written, or a file did not read back.
    """
    plan = job.required_plan
    about = "; ".join(f"{key} {value}" for key, value in facts_of(plan, find_profile("any")).items())
    plates = print_plates(plan, job.deployment, job.phi, job.printing)
    written = []
    for number, plate in enumerate(plates, start=1):
        goal = path if number == 1 else path.with_name(f"{path.stem}-{number}{path.suffix}")
        write_plate(plate, goal, about)
        written.append(goal)
    return tuple(written)


def write_plate(plate: Plate, path: Path, about: str) -> None:
    """Write the file of a plate, of the kind of its extension, and read it back.

    Raises
    ------
    ExportError
        The place cannot be written, or the file did not read back.
    """
    encode, decode = KINDS[path.suffix.lower()]
    write_atomically(path, encode(plate, about), lambda draft: check_bodies(decode(draft.read_bytes()), plate))


def check_bodies(found: Bodies, plate: Plate) -> None:
    """Refuse bodies that do not close, or differ in number, volume or place from a plate.

    STL holds no bodies: all of them are one, without a name.

    Raises
    ------
    ExportError
        With the first body that is not as planned.
    """
    planned = {"": plate} if set(found) == {""} else {solid.name: (solid,) for solid in plate}
    if set(found) != set(planned):
        raise ExportError("mesh.other_bodies", found=len(found), planned=len(planned))
    for name, solids in planned.items():
        body = found[name]
        if not (body.is_watertight and body.is_winding_consistent):
            raise ExportError("mesh.not_closed", name=solids[0].name)
        volume = sum(solid.volume_mm3 for solid in solids)
        if not abs(float(body.volume) - volume) <= SAME_VOLUME * volume:
            fields = {"found_mm3": float(body.volume), "planned_mm3": volume}
            raise ExportError("mesh.other_volume", name=solids[0].name, **fields)
        low, high = np.min([solid.low for solid in solids], axis=0), np.max([solid.high for solid in solids], axis=0)
        if not np.allclose(body.bounds, [low, high], atol=SAME_PLACE_MM):
            raise ExportError("mesh.other_place", name=solids[0].name)


# STL, OBJ -------------------------------------------------------------------------------------------------------------


def _scene(plate: Plate) -> trimesh.Scene:
    scene = trimesh.Scene()
    for solid in plate:
        mesh = trimesh.Trimesh(solid.vertices, solid.faces, process=False)
        scene.add_geometry(mesh, node_name=solid.name, geom_name=solid.name)
    return scene


def stl_bytes(plate: Plate, about: str) -> bytes:
    """All bodies of a plate in one binary STL, which has room for few words about itself."""
    content: bytes = trimesh.exchange.stl.export_stl(_scene(plate).to_mesh())
    return f"Kirigami Studio {__version__}, mm".encode().ljust(STL_HEADER) + content[STL_HEADER:]


def _read_stl(content: bytes) -> Bodies:
    return {"": trimesh.load_mesh(BytesIO(content), file_type="stl")}


def obj_bytes(plate: Plate, about: str) -> bytes:
    """An object for each body of a plate."""
    header = f"Kirigami Studio {__version__}, mm\n# {about}"
    text: str = trimesh.exchange.obj.export_obj(_scene(plate), digits=DECIMALS, header=header)
    return text.encode()


def _read_obj(content: bytes) -> Bodies:
    loaded = trimesh.load_scene(BytesIO(content), file_type="obj", split_objects=True, group_material=False)
    return dict(loaded.geometry)


# 3MF ------------------------------------------------------------------------------------------------------------------


def threemf_bytes(plate: Plate, about: str) -> bytes:
    """An object for each body of a plate; several are parts of one object.

    So slicers keep them in their places.
    """
    root = ElementTree.Element("model", {"unit": "millimeter", "xml:lang": "en-US", "xmlns": CORE})
    for name, text in (
        ("Title", "Kirigami"),
        ("Application", f"Kirigami Studio {__version__}"),
        ("Description", about),
    ):
        ElementTree.SubElement(root, "metadata", {"name": name}).text = text
    resources = ElementTree.SubElement(root, "resources")
    build = ElementTree.SubElement(root, "build")
    materials = ElementTree.SubElement(resources, "basematerials", {"id": "1"})
    for name, colour in LAYER_COLOURS.values():
        ElementTree.SubElement(materials, "base", {"name": name, "displaycolor": colour})
    for number, solid in enumerate(plate, start=2):
        head = {"id": f"{number}", "type": "model", "name": solid.name, "pid": "1"}
        head["pindex"] = f"{list(LAYER_COLOURS).index(solid.layer)}"
        mesh = ElementTree.SubElement(ElementTree.SubElement(resources, "object", head), "mesh")
        vertices = ElementTree.SubElement(mesh, "vertices")
        for x, y, z in solid.vertices.tolist():
            place = {"x": f"{x:.{DECIMALS}f}", "y": f"{y:.{DECIMALS}f}", "z": f"{z:.{DECIMALS}f}"}
            ElementTree.SubElement(vertices, "vertex", place)
        triangles = ElementTree.SubElement(mesh, "triangles")
        for a, b, c in solid.faces.tolist():
            ElementTree.SubElement(triangles, "triangle", {"v1": f"{a}", "v2": f"{b}", "v3": f"{c}"})
    whole = len(plate) + 1
    if len(plate) > 1:
        whole += 1
        together = ElementTree.SubElement(resources, "object", {"id": f"{whole}", "type": "model", "name": TOGETHER})
        parts = ElementTree.SubElement(together, "components")
        for number in range(2, whole):
            ElementTree.SubElement(parts, "component", {"objectid": f"{number}"})
    ElementTree.SubElement(build, "item", {"objectid": f"{whole}"})
    model = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    stream = BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name, content in (("[Content_Types].xml", CONTENT_TYPES), ("_rels/.rels", RELATIONSHIPS), (MODEL, model)):
            entry = zipfile.ZipInfo(name)  # of 1980: the same plan gives the same bytes
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, content)
    return stream.getvalue()


def _read_3mf(content: bytes) -> Bodies:
    with zipfile.ZipFile(BytesIO(content)) as archive:
        root = ElementTree.fromstring(archive.read(MODEL))
    found = {}
    for body in root.iter(f"{{{CORE}}}object"):
        if body.find(f"{{{CORE}}}mesh") is None:  # all of them together
            continue
        vertices = [[float(one.attrib[axis]) for axis in "xyz"] for one in body.iter(f"{{{CORE}}}vertex")]
        faces = [[int(one.attrib[f"v{place}"]) for place in (1, 2, 3)] for one in body.iter(f"{{{CORE}}}triangle")]
        found[body.attrib["name"]] = trimesh.Trimesh(vertices, faces, process=False)
    return found


Encoder = Callable[[Plate, str], bytes]
Decoder = Callable[[bytes], Bodies]
#: How a plate is written, with what is said about it, and read back, by extension.
KINDS: Mapping[str, tuple[Encoder, Decoder]] = MappingProxyType(
    {
        ".stl": (stl_bytes, _read_stl),
        ".obj": (obj_bytes, _read_obj),
        ".3mf": (threemf_bytes, _read_3mf),
    }
)
