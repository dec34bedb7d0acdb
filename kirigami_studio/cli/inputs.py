"""Targets and sheets that a command line names: files, folders, archives, library names.

Sub-commands take one input or a batch: in a batch, an input that fails is reported in its place and the others still
get their answer.
"""

from __future__ import annotations

import argparse
import io
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Generic, TypeVar
from zipfile import BadZipFile, ZipFile

import numpy as np
import numpy.typing as npt

from kirigami_studio.cli.console import STREAM, as_typed, print_json, remark, standing_in
from kirigami_studio.foundation.arrays import BoolArray
from kirigami_studio.foundation.errors import KirigamiError, ProjectError, RatioError, UsageError
from kirigami_studio.foundation.files import opened_file
from kirigami_studio.foundation.words import tr
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.sheet_files import SUFFIXES, named_sheet, read_sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.read import BEGINNING, KINDS, PART_READERS, has_parts, read_target, target_files
from kirigami_studio.outlines.read_image import opened_image
from kirigami_studio.outlines.silhouettes import names
from kirigami_studio.outlines.source_file import decoding, read_bytes
from kirigami_studio.project.store import CUT_FILES, load
from kirigami_studio.project.store import SUFFIX as PROJECT
from kirigami_studio.studio.targets import PartChoice, PieceRead, inside_of, mask_outline, read_drawing

SHEET_SUFFIXES = (*SUFFIXES, ".npz", PROJECT)
#: What masks may be, as Pillow calls them, how many pixels, and how many megabytes: 64 bits a pixel, uncompressed.
MASK_FORMATS, MOST_MASK_PIXELS, MOST_MASK_MEGABYTES = ("PNG", "JPEG", "BMP", "TIFF", "GIF", "PPM"), 25_000_000, 220
#: Largest .npz archive (bytes).
LARGEST_ARCHIVE = 512 * 2**20
#: What has a chosen design.
PROJECTS = (PROJECT, *CUT_FILES)

#: Arguments that name an input, which may be standard input.
INPUTS = (
    *("targets", "sheets", "inputs", "file", "project", "source", "also", "start", "design", "picture"),
    *("mask_a", "mask_b"),
)
#: Beginnings of arrays and of archives.
NUMPY, ZIP = b"\x93NUMPY", b"PK"

Value = TypeVar("Value")


@dataclass(frozen=True, slots=True)
class Named(Generic[Value]):
    """One input, read when it is asked for, with the name that batch output repeats."""

    name: str
    read: Callable[[], Value]  #: reads and validates it; raises a KirigamiError that names it


@contextmanager
def standard_input(arguments: argparse.Namespace) -> Iterator[None]:
    """Put the content of standard input into a file wherever an input is ``-``.

    Raises
    ------
    UsageError
        Content of no kind that is read.
    """
    named = {name: getattr(arguments, name, None) for name in INPUTS}
    asked = [name for name, value in named.items() if value == STREAM or (isinstance(value, list) and STREAM in value)]
    if not asked:
        yield
        return
    # A program without a console has no standard input.
    content = b"" if sys.stdin is None else sys.stdin.buffer.read(LARGEST_ARCHIVE + 1)
    if len(content) > LARGEST_ARCHIVE:
        raise UsageError("archive.too_large", path=STREAM, limit=LARGEST_ARCHIVE >> 20)
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"stdin{kind_of_content(content)}"
        path.write_bytes(content)
        for name in asked:
            given = named[name]
            files = [str(path) if one == STREAM else one for one in given] if isinstance(given, list) else str(path)
            setattr(arguments, name, files)
        with standing_in(path):
            try:
                yield
            except KirigamiError as error:
                # Outside nobody knows what the file stands for.
                fields = {name: as_typed(str(value)) if isinstance(value, (str, Path)) else value
                          for name, value in error.fields.items()}  # fmt: skip
                raise type(error)(error.code, **fields) from error


def kind_of_content(content: bytes) -> str:
    """Extension of the kind of file that bytes are.

    Raises
    ------
    UsageError
        Of no kind that is read.
    """
    for kind in KINDS:
        if kind.begins(content[:BEGINNING]):
            return kind.extensions[0]
    if content.startswith(NUMPY):
        return ".npy"
    if content.startswith(ZIP):
        try:
            members = ZipFile(io.BytesIO(content)).namelist()
        except BadZipFile:
            members = []
        return ".npz" if members and all(member.endswith(".npy") for member in members) else PROJECT
    text = content[:BEGINNING].decode("utf-8-sig", "replace").lstrip()
    if text.startswith(("{", "[")):
        return ".json"
    if "<LightBurnProject" in text:
        return ".lbrn2"
    raise UsageError("input.unknown_content")


def is_batch(sources: Sequence[str]) -> bool:
    """Whether these sources stand for many inputs (several paths, a folder or an archive)."""
    return len(sources) > 1 or (len(sources) == 1 and (_is_folder(sources[0]) or sources[0].lower().endswith(".npz")))


def are_many_targets(sources: Sequence[str]) -> bool:
    """``is_batch`` for targets: a library silhouette wins over a folder of its name."""
    return is_batch(sources) and not (len(sources) == 1 and sources[0] in names())


def _is_folder(source: str) -> bool:
    # os.path answers False for names that no file can have, and Path("") would be the current folder.
    return bool(source) and os.path.isdir(source)  # noqa: PTH112


def for_each(
    inputs: Iterable[Named[Value]], batch: bool, work: Callable[[str, Value], None], *, as_json: bool = False
) -> int:
    """Read and work through the inputs; returns the exit code 0.

    What fails has a line ``{"source", "error"}`` on standard output where answers are JSON: those of a batch always
    are, that of a single input ``as_json``.

    Raises
    ------
    UsageError
        At once: the request itself is wrong, whatever the input.
    KirigamiError
        A single input failed; or, after the whole batch, some did.
    """
    total = failed = 0
    for named in inputs:
        total += 1
        try:
            work(named.name, named.read())
        except UsageError:
            raise
        except KirigamiError as error:
            if batch or as_json:
                print_json({"source": named.name, "error": str(error)})
            if not batch:
                raise
            failed += 1
    if failed:
        raise KirigamiError("batch.some_inputs_failed", failed=failed, total=total)
    return 0


def part_choice(arguments: argparse.Namespace) -> PartChoice | None:
    """The choice of parts that the options make; None where they make none."""
    return PartChoice.of(
        arguments.parts,
        arguments.join,
        arguments.bridge,
        arguments.stroke_outline,
        arguments.object,
        arguments.not_object,
    )


def warn(name: str, target: Outline) -> list[str]:
    """Print on standard error all that was changed in a target; return it for JSON."""
    for note in target.notes:
        remark(f"{tr('warning')}: {name}: {note}")
    return list(target.notes)


def read_targets(
    sources: Sequence[str],
    threshold: float | None = None,
    choice: PartChoice | None = None,
    fill_holes: bool | None = None,
) -> Iterator[Named[Outline]]:
    """Yield every target that the sources name, in order.

    ``threshold`` (grey level, 0..1) replaces the automatic one for images that are named singly; a ``choice`` is that
    of parts, for drawings.  All holes are filled, or none, where ``fill_holes`` says so.
    """
    for named in _targets(sources, threshold, choice):
        yield Named(named.name, partial(_with_holes, named.read, fill_holes))


def read_pieces(
    sources: Sequence[str], threshold: float | None, choice: PartChoice, fill_holes: bool | None = None
) -> Iterator[Named[tuple[PieceRead, ...]]]:
    """Yield the pieces of every drawing that the sources name, in order."""
    if threshold is not None and not 0.0 < threshold < 1.0:
        raise UsageError("option.threshold", value=threshold)
    for source in sources:
        path = Path(source)
        if source not in names() and _is_folder(source):
            for file in target_files(path):
                yield Named(file.stem, partial(_pieces, file, threshold, choice, fill_holes))
        elif has_parts(path):
            yield Named(source, partial(_pieces, path, threshold, choice, fill_holes))
        else:
            raise UsageError("parts.not_a_drawing", source=source, kinds=", ".join(PART_READERS))


def _pieces(path: Path, threshold: float | None, choice: PartChoice, filled: bool | None) -> tuple[PieceRead, ...]:
    found = choice.pieces(path, threshold)
    return tuple(replace(piece, outline=piece.outline.with_holes(filled)) for piece in found)


def _with_holes(read: Callable[[], Outline], filled: bool | None) -> Outline:
    return read().with_holes(filled)


def _targets(sources: Sequence[str], threshold: float | None, choice: PartChoice | None) -> Iterator[Named[Outline]]:
    """The targets with the holes that are seen as such."""
    if threshold is not None and not 0.0 < threshold < 1.0:
        raise UsageError("option.threshold", value=threshold)
    for source in sources:
        path = Path(source)
        if path.suffix.lower() == ".npz":
            for index, mask in enumerate(_archive(path, "masks", 3)):
                name = f"{path.name}[{index}]"
                yield Named(name, partial(mask_outline, mask, name))
        elif source not in names() and _is_folder(source):
            for file in target_files(path):
                yield Named(file.stem, partial(read_drawing, file, choice))
        elif has_parts(path):
            yield Named(source, partial(read_drawing, path, choice, threshold))
        elif choice is not None:
            raise UsageError("parts.not_a_drawing", source=source, kinds=", ".join(PART_READERS))
        else:
            yield Named(source, partial(read_target, source))


def read_sheets(sources: Sequence[str]) -> Iterator[Named[Sheet]]:
    """Yield every sheet that the sources name, in order."""
    for source in sources:
        path = Path(source)
        if path.suffix.lower() == ".npz":
            for index, ratio in enumerate(_archive(path, "ratios", 3)):
                name = f"{path.name}[{index}]"
                yield Named(name, partial(named_sheet, {"ratio": ratio}, name))
        elif _is_folder(source):
            files = sorted(file for file in path.iterdir() if file.suffix.lower() in SHEET_SUFFIXES)
            if not files:
                raise RatioError("ratios.none_in_folder", folder=path)
            yield from read_sheets([str(file) for file in files])
        elif path.suffix.lower() in PROJECTS:
            yield Named(source, partial(read_chosen_sheet, path))
        else:
            yield Named(source, partial(read_sheet, path))


def read_chosen_sheet(path: Path) -> Sheet:
    """Read the sheet of a project's chosen design, as it is shown and cut.

    Raises
    ------
    ProjectError
        No project can be read, or none of its designs is chosen.
    """
    candidate = load(path).candidate
    if candidate is None:
        raise ProjectError("project.no_design_chosen", path=path)
    return candidate.final_sheet


def read_mask(path: Path) -> BoolArray:
    """Read a mask image as a bool array; inside is brighter than half of its brightest pixel.

    Files with the values 0 and 1, 0 and 255, or 16 bits all say the same.

    Raises
    ------
    TargetError
        Missing, damaged, or not an image.
    """
    content = read_bytes(path, MOST_MASK_MEGABYTES)
    with decoding(path, "mask.not_readable"):
        image = opened_image(content, MASK_FORMATS, MOST_MASK_PIXELS)
        deep = image.mode.startswith(("I", "F"))
        return inside_of(np.asarray(image if deep else image.convert("L")))


def _archive(path: Path, key: str, dimensions: int) -> npt.NDArray[np.generic]:
    """Read one array of an .npz archive."""
    try:
        if path.stat().st_size > LARGEST_ARCHIVE:
            raise UsageError("archive.too_large", path=path, limit=LARGEST_ARCHIVE >> 20)
        with opened_file(path, LARGEST_ARCHIVE) as file, np.load(file, allow_pickle=False) as archive:
            if key not in archive:
                raise UsageError("archive.array_missing", name=path.name, key=key, found=", ".join(archive))
            values = np.asarray(archive[key])
    except (OSError, ValueError, EOFError, KeyError) as error:
        raise KirigamiError("archive.not_readable", path=path) from error
    except Exception as error:
        if isinstance(error, KirigamiError):
            raise
        raise KirigamiError("archive.not_readable", path=path) from error
    if values.ndim != dimensions or values.dtype.kind not in "biuf":
        raise UsageError("archive.not_numbers", key=key, name=path.name, shape=values.shape, dtype=str(values.dtype))
    if not len(values):
        raise UsageError("archive.no_entries", key=key, name=path.name)
    return values
