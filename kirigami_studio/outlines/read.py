"""Read a target from any source: a file by its extension, or the name of a library silhouette."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import Any, NoReturn

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.parts import SourceParts
from kirigami_studio.outlines.source_file import decoding, read_bytes

#: Keys under which an object may hold its vertices, the first present one counts.
VERTEX_KEYS = ("outline", "points")
UNITS = ("mm", "px")
#: Extensions of pictures, which are traced at a threshold.
PICTURES = (".png", ".jpg", ".jpeg", ".bmp")


def read_target(source: str | Path) -> Outline:
    """Return the outline of a file or of a library silhouette.

    Parameters
    ----------
    source : str or Path
        A file with one of the extensions in ``READERS`` (any case), or a name from the library.

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
    reader = READERS.get(path.suffix.lower())
    if reader is not None:
        return reader(path)
    if exists:
        raise TargetError("target.unknown_kind", name=path.name, kinds=kinds)
    return silhouettes.load(str(source))


def read_parts(source: str | Path) -> SourceParts:
    """Return everything that a file holds, part by part.

    Parameters
    ----------
    source : str or Path
        A file with one of the extensions in ``PART_READERS`` (any case).

    Raises
    ------
    TargetError
        Of another kind, missing, damaged or empty.
    """
    path = Path(source).expanduser()
    reader = PART_READERS.get(path.suffix.lower())
    if reader is None:
        raise TargetError("parts.not_a_drawing", source=str(source), kinds=", ".join(PART_READERS))
    return reader(path)


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

    An object may also carry ``"name"`` and ``"unit"`` ("mm" or "px").

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
            key = next((key for key in VERTEX_KEYS if key in stored), None)
            if key is None:
                raise TargetError("json_outline.no_vertices")
            stored = stored[key]
        return Outline.from_points(_vertices(stored), name=name, unit=unit)


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


#: Reader by lower-case extension.
READERS: Mapping[str, Callable[[Path], Outline]] = MappingProxyType(
    {
        **dict.fromkeys(PICTURES, _late("read_image", "read_image")),
        ".svg": _late("read_svg", "read_svg"),
        ".dxf": _late("read_dxf", "read_dxf"),
        ".json": read_json,
    }
)
#: Readers of files that can hold several parts.
PART_READERS: Mapping[str, Callable[[Path], SourceParts]] = MappingProxyType(
    {
        ".svg": _late("read_svg", "svg_parts"),
        ".dxf": _late("read_dxf", "dxf_parts"),
        **dict.fromkeys(PICTURES, _late("read_image", "image_parts")),
    }
)
