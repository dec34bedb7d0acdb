"""Read a target from any source: a file by its content, or the name of a library silhouette.

``KINDS`` is the one table of what is read: readers, file dialogs and sentences follow it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import Any, NoReturn

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.files import opened_file
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.parts import SourceParts
from kirigami_studio.outlines.source_file import decoding, read_bytes

#: Keys under which an object may hold its vertices, the first present one counts; and its rings, the outer one first.
VERTEX_KEYS, RINGS = ("outline", "points"), "rings"
UNITS = ("mm", "px")
#: Bytes at the beginning of a file by which its kind is told.
BEGINNING = 4096
#: Larger files (bytes) are not opened.
LARGEST = 2**40


def read_target(source: str | Path) -> Outline:
    """Return the outline of a file or of a library silhouette.

    Parameters
    ----------
    source : str or Path
        A file of one of ``KINDS``, or a name from the library.

    Raises
    ------
    TargetError
        Neither, a folder, or the file does not hold one closed simple shape.
    """
    if not isinstance(source, str | Path) or not str(source).strip():
        raise TargetError("target.not_a_source", value=source)
    if isinstance(source, str) and source in silhouettes.names():
        return silhouettes.load(source)
    path = Path(source).expanduser()
    kinds = ", ".join(READERS)
    try:
        if path.is_dir():
            raise TargetError("target.folder", path=path, kinds=kinds)
        exists = path.exists()
    except (OSError, ValueError) as error:
        raise TargetError("target.not_a_file_name", name=str(source)) from error
    kind = kind_of_source(path)
    if kind is not None:
        return kind.read(path)
    if exists:
        raise TargetError("target.unknown_kind", name=path.name, kinds=kinds)
    return silhouettes.load(str(source))


def read_parts(source: str | Path) -> SourceParts:
    """Return everything that a file holds, part by part.

    Parameters
    ----------
    source : str or Path
        A file of a kind that can hold several parts.

    Raises
    ------
    TargetError
        Of another kind, missing, damaged or empty.
    """
    path = Path(source).expanduser()
    kind = kind_of_source(path)
    if kind is None or kind.parts is None:
        raise TargetError("parts.not_a_drawing", source=str(source), kinds=", ".join(PART_READERS))
    return kind.parts(path)


def target_files(folder: Path) -> list[Path]:
    """Return the files of a folder that may hold a target, sorted by name.

    Raises
    ------
    TargetError
        The folder cannot be read or holds none.
    """
    try:
        files = sorted(
            (entry for entry in folder.iterdir() if entry.suffix.lower() in READERS and entry.is_file()),
            key=lambda entry: (entry.name.lower(), entry.name),
        )
    except (OSError, ValueError) as error:
        raise TargetError("target.folder_not_readable", folder=folder) from error
    if not files:
        raise TargetError("target.none_in_folder", folder=folder, kinds=", ".join(READERS))
    return files


def read_json(path: str | Path) -> Outline:
    """Read ``[[x, y], ...]``, ``{"outline": [[x, y], ...]}`` or ``{"points": [[x, y], ...]}``, y up.

    ``{"rings": [[[x, y], ...], ...]}`` has holes after its outer ring.  An object may also carry ``"name"`` and
    ``"unit"`` ("mm" or "px").

    Raises
    ------
    TargetError
        Not JSON, not such a table, not finite numbers, or not one simple shape.
    """
    path = Path(path)
    content = read_bytes(path)
    with decoding(path, "source.json_damaged"):
        stored = json.loads(content.decode("utf-8-sig"), parse_constant=_refuse_constant)
        name, unit = path.stem, ""
        while isinstance(stored, dict):
            name = stored["name"] if isinstance(stored.get("name"), str) else name
            unit = stored["unit"] if stored.get("unit") in UNITS else unit
            if RINGS in stored:
                return _ringed(stored[RINGS], name, unit)
            key = next((key for key in VERTEX_KEYS if key in stored), None)
            if key is None:
                raise TargetError("json_outline.no_vertices")
            stored = stored[key]
        return Outline.from_points(_vertices(stored), name=name, unit=unit)


def _ringed(stored: Any, name: str, unit: str) -> Outline:
    """An outer ring, and the holes in it."""
    if not isinstance(stored, list) or not stored:
        raise TargetError("json_outline.not_a_list", value=stored)
    outer, *holes = (_vertices(ring) for ring in stored)
    return Outline.from_points(outer, name=name, unit=unit, holes=holes)


def _refuse_constant(constant: str) -> NoReturn:
    raise TargetError("json_outline.not_finite", constant=constant)


def _vertices(stored: Any) -> list[tuple[float, float]]:
    """Check every vertex by hand: numpy would read the text "1" and the truth value true as numbers."""
    if not isinstance(stored, list):
        raise TargetError("json_outline.not_a_list", value=stored)
    for index, vertex in enumerate(stored, start=1):
        if not (isinstance(vertex, list) and len(vertex) == 2 and all(_is_number(value) for value in vertex)):
            raise TargetError("json_outline.not_a_pair", number=index, value=vertex)
    return [(float(x), float(y)) for x, y in stored]


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _late(module: str, function: str) -> Callable[[Path], Any]:
    """A reader that is imported when it is first called: ezdxf and scikit-image take a while."""

    def read(path: Path) -> Any:
        return getattr(import_module(f"kirigami_studio.outlines.{module}"), function)(path)

    return read


@dataclass(frozen=True, slots=True)
class SourceKind:
    """A kind of file that holds a target."""

    extensions: tuple[str, ...]  #: lower case, with the dot
    begins: Callable[[bytes], bool]  #: whether a file that begins so is of this kind
    read: Callable[[Path], Outline]
    parts: Callable[[Path], SourceParts] | None = None  #: where it can hold several
    is_picture: bool = False  #: traced at a threshold


def _picture(*extensions: str, begins: Callable[[bytes], bool]) -> SourceKind:
    reader, parts = _late("read_image", "read_image"), _late("read_image", "image_parts")
    return SourceKind(extensions, begins, reader, parts, True)


def _is_svg(content: bytes) -> bool:
    return content.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<") and b"<svg" in content


def _is_dxf(content: bytes) -> bool:
    """Whether a file begins with a section, maybe after a comment."""
    words = content[:400].split()
    return content.startswith(b"AutoCAD Binary DXF") or words[:2] == [b"0", b"SECTION"]


def _is_pdf(content: bytes) -> bool:
    return b"%PDF-" in content[:1024]


KINDS = (
    _picture(".png", begins=lambda content: content.startswith(b"\x89PNG")),
    _picture(".jpg", ".jpeg", begins=lambda content: content.startswith(b"\xff\xd8\xff")),
    _picture(".bmp", begins=lambda content: content.startswith(b"BM") and content[6:10] == bytes(4)),
    _picture(".webp", begins=lambda content: content.startswith(b"RIFF") and content[8:12] == b"WEBP"),
    _picture(".tif", ".tiff", begins=lambda content: content[:4] in (b"II*\0", b"MM\0*")),
    _picture(".gif", begins=lambda content: content[:6] in (b"GIF87a", b"GIF89a")),
    _picture(".avif", begins=lambda content: content[4:12] in (b"ftypavif", b"ftypavis")),
    SourceKind((".svg",), _is_svg, _late("read_svg", "read_svg"), _late("read_svg", "svg_parts")),
    SourceKind((".dxf",), _is_dxf, _late("read_dxf", "read_dxf"), _late("read_dxf", "dxf_parts")),
    SourceKind((".pdf", ".ai"), _is_pdf, _late("read_pdf", "read_pdf"), _late("read_pdf", "pdf_parts")),
    SourceKind((".json",), lambda content: False, read_json),
)
#: Kinds by extension; those that can hold several parts; extensions of pictures.
READERS: Mapping[str, SourceKind] = MappingProxyType(
    {extension: kind for kind in KINDS for extension in kind.extensions}
)
PART_READERS: Mapping[str, SourceKind] = MappingProxyType(
    {extension: kind for extension, kind in READERS.items() if kind.parts is not None}
)
PICTURES = tuple(extension for extension, kind in READERS.items() if kind.is_picture)


def kind_of_source(path: Path) -> SourceKind | None:
    """The kind of a file by how it begins, or else by its extension; None for others."""
    by_name = READERS.get(path.suffix.lower())
    try:
        with opened_file(path, LARGEST) as stream:
            content = stream.read(BEGINNING)
    except (OSError, ValueError):  # its reader says what is wrong with it
        return by_name
    return next((kind for kind in KINDS if kind.begins(content)), by_name)


def is_picture(path: Path) -> bool:
    """Whether a file is a picture, which is traced at a threshold."""
    kind = kind_of_source(path)
    return kind is not None and kind.is_picture


def has_parts(path: Path) -> bool:
    """Whether a file is of a kind that can hold several parts."""
    kind = kind_of_source(path)
    return kind is not None and kind.parts is not None
