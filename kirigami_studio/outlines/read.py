"""One door for every source: a file by its extension, or a library name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.outline import Outline


def _image(path: Path) -> Outline:
    from kirigami_studio.outlines.read_image import read_image

    return read_image(path)


def _svg(path: Path) -> Outline:
    from kirigami_studio.outlines.read_svg import read_svg

    return read_svg(path)


def _dxf(path: Path) -> Outline:
    from kirigami_studio.outlines.read_dxf import read_dxf

    return read_dxf(path)


def _json(path: Path) -> Outline:
    from kirigami_studio.outlines.read_json import read_json

    return read_json(path)


#: Reader by lower-case extension.  Readers are imported when first needed: ezdxf and scikit-image take a while.
READERS: Mapping[str, Callable[[Path], Outline]] = MappingProxyType(
    {
        ".png": _image,
        ".jpg": _image,
        ".jpeg": _image,
        ".bmp": _image,
        ".svg": _svg,
        ".dxf": _dxf,
        ".json": _json,
    }
)


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
        raise TargetError(f"A target is a file or the name of a library silhouette, got {source!r}.")
    if isinstance(source, str) and source in silhouettes.names():
        return silhouettes.load(source)
    path = Path(source).expanduser()
    kinds = ", ".join(READERS)
    try:
        if path.is_dir():
            raise TargetError(f"{path} is a folder; choose one file in it ({kinds}).")
        exists = path.exists()
    except (OSError, ValueError) as error:
        raise TargetError(f"{str(source)[:80]!r} cannot be the name of a file; choose another one.") from error
    reader = READERS.get(path.suffix.lower())
    if reader is not None:
        return reader(path)
    if exists:
        raise TargetError(f"{path.name} is of an unknown kind; choose a target of one of these: {kinds}.")
    return silhouettes.load(str(source))


def read_many(source: str | Path) -> list[Outline]:
    """Return the outlines of all readable files of a folder, sorted by name; of one file or name, a list of one.

    Raises
    ------
    TargetError
        The folder holds no target, or one of the files cannot be read (the sentence names it).
    """
    path = Path(source) if isinstance(source, str | Path) else None
    try:
        if path is None or (isinstance(source, str) and source in silhouettes.names()) or not path.is_dir():
            return [read_target(source)]
    except (OSError, ValueError) as error:
        raise TargetError(f"The folder {str(source)[:80]} cannot be read; check its name and your rights.") from error
    return [read_target(entry) for entry in target_files(path)]


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
        raise TargetError(f"The folder {str(folder)[:80]} cannot be read; check its name and your rights.") from error
    if not files:
        raise TargetError(f"The folder {folder} holds no target file ({', '.join(READERS)}).")
    return files
