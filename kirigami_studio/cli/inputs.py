"""Read targets and ratio fields from whatever the command line names: files, folders, archives, library names."""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Generic, TypeVar

import numpy as np
import numpy.typing as npt

from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.errors import GridError, KirigamiError, RatioError, TargetError, UsageError
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.read import read_target, target_files
from kirigami_studio.outlines.read_image import outline_of_mask, read_image
from kirigami_studio.outlines.silhouettes import names

LARGEST_FILE = 512 * 1024 * 1024
IMAGE_SUFFIXES = (".png", ".jpg", ".jpeg", ".bmp")
RATIO_SUFFIXES = (".json", ".npy", ".npz")

Value = TypeVar("Value")


@dataclass(frozen=True, slots=True)
class Named(Generic[Value]):
    """One input, read when it is asked for, with the name that batch output repeats.

    Attributes
    ----------
    name : str
    read : callable
        Reads and validates it; raises a KirigamiError that names it.
    """

    name: str
    read: Callable[[], Value]


def parse_grid(text: str) -> tuple[int, int]:
    """Read ``10x10`` as (rows, columns).

    Raises
    ------
    GridError
        Not two whole numbers joined by an x.
    """
    match = re.fullmatch(r"\s*(\d{1,4})\s*[xX]\s*(\d{1,4})\s*", text)
    if match is None:
        raise GridError(f"A grid is written ROWSxCOLUMNS, for example 10x10; got '{text}'.")
    return int(match[1]), int(match[2])


def parse_angle(text: str) -> float:
    """Read an angle in radians (``0.5``, ``pi/3``) or in degrees (``30deg``).

    Raises
    ------
    UsageError
        Not such a number.
    """
    match = re.fullmatch(
        r"\s*(?:(\d*\.?\d+(?:e-?\d+)?)\s*(deg)?|(\d*\.?\d+)?\s*\*?\s*pi\s*(?:/\s*(\d*\.?\d+))?)\s*", text
    )
    if match is None:
        raise UsageError(f"An angle is a number of radians (0.5, pi/3) or degrees (30deg), got '{text}'.")
    number, unit, factor, divisor = match.groups()
    if number is not None:
        return math.radians(float(number)) if unit else float(number)
    if divisor is not None and float(divisor) == 0:
        raise UsageError(f"An angle cannot be divided by zero: '{text}'.")
    return float(factor or 1) * math.pi / float(divisor or 1)


def is_batch(sources: Sequence[str]) -> bool:
    """Whether these sources stand for many inputs (several paths, a folder or an archive)."""
    return len(sources) > 1 or (len(sources) == 1 and (_is_folder(sources[0]) or sources[0].lower().endswith(".npz")))


def are_many_targets(sources: Sequence[str]) -> bool:
    """``is_batch`` for targets: the name of a library silhouette wins over a folder of that name."""
    return is_batch(sources) and not (len(sources) == 1 and sources[0] in names())


def _is_folder(source: str) -> bool:
    # os.path answers False for names that no file can have, and Path("") would be the current folder.
    return bool(source) and os.path.isdir(source)  # noqa: PTH112


def read_targets(sources: Sequence[str], threshold: float | None = None) -> Iterator[Named[Outline]]:
    """Yield every target that the sources name, in order.

    ``threshold`` (grey level, 0..1) replaces the automatic one for images that are named singly.
    """
    if threshold is not None and not 0.0 < threshold < 1.0:
        raise UsageError(f"The threshold must lie between 0 and 1, got {threshold:g}.")
    for source in sources:
        path = Path(source)
        if path.suffix.lower() == ".npz":
            for index, mask in enumerate(_archive(path, "masks", 3)):
                name = f"{path.name}[{index}]"
                yield Named(name, partial(_outline_of, mask, name))
        elif source not in names() and _is_folder(source):
            for file in target_files(path):
                yield Named(file.stem, partial(read_target, file))
        elif threshold is not None and path.suffix.lower() in IMAGE_SUFFIXES:
            yield Named(source, partial(read_image, path, threshold))
        else:
            yield Named(source, partial(read_target, source))


def read_fields(sources: Sequence[str]) -> Iterator[Named[RatioField]]:
    """Yield every ratio field that the sources name, in order."""
    for source in sources:
        path = Path(source)
        if path.suffix.lower() == ".npz":
            for index, ratio in enumerate(_archive(path, "ratios", 3)):
                name = f"{path.name}[{index}]"
                yield Named(name, partial(_field_of, ratio, name))
        elif _is_folder(source):
            files = sorted(file for file in path.iterdir() if file.suffix.lower() in RATIO_SUFFIXES)
            if not files:
                raise RatioError(f"The folder {path} holds no ratio fields (.json, .npy or .npz).")
            yield from read_fields([str(file) for file in files])
        else:
            yield Named(source, partial(read_field, path))


def read_field(path: Path) -> RatioField:
    """Read one ratio field: .json ``{"ratio": [[...], ...]}`` or .npy, row 0 on top.

    Raises
    ------
    RatioError
        Missing, damaged, of another kind, or with impossible values.
    """
    suffix = path.suffix.lower()
    if suffix not in RATIO_SUFFIXES:
        raise RatioError(f"Ratio fields are read from .json or .npy files, got {path.name}.")
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise RatioError(f"{path} is larger than {LARGEST_FILE >> 20} MB, which no ratio field is.")
        if suffix == ".npy":
            content: object = np.load(path, allow_pickle=False)
        else:
            content = json.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, EOFError, RecursionError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else "it is damaged or of another kind"
        raise RatioError(f"Cannot read ratios from {path}: {reason}.") from error
    if isinstance(content, dict):
        content = content.get("ratio")
    if not isinstance(content, (list, np.ndarray)):
        raise RatioError(f'{path.name} must hold {{"ratio": [[...], ...]}}, row 0 on top.')
    return _field_of(content, path.name)


def _field_of(values: object, name: str) -> RatioField:
    """Validate ratios; a refusal names the input."""
    try:
        return RatioField(values)  # type: ignore[arg-type]  # checked by the constructor
    except (RatioError, GridError) as error:
        raise RatioError(f"{name}: {error}") from error


def read_mask(path: Path) -> BoolArray:
    """Read a mask image as a bool array; what is brighter than half of its brightest pixel is inside.

    Files with the values 0 and 1, 0 and 255, or 16 bits all say the same.

    Raises
    ------
    TargetError
        Missing, damaged, or not an image.
    """
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(path) as image:
            deep = image.mode.startswith(("I", "F"))
            grey = np.asarray(image if deep else image.convert("L"), dtype=np.float64)
    except (OSError, UnidentifiedImageError, ValueError, Image.DecompressionBombError) as error:
        raise TargetError(f"Cannot read the mask image {path}: it is missing, damaged or not an image.") from error
    return _inside(grey)


def _inside(levels: FloatArray) -> BoolArray:
    """What lies above half of the highest level; of a bool mask or 0 and 1, what is set."""
    highest = max(float(levels.max(initial=0.0)), 0.0)
    inside: BoolArray = levels > 0.5 * highest
    return inside


def _outline_of(mask: npt.NDArray[np.generic], name: str) -> Outline:
    try:
        levels = np.asarray(mask, dtype=np.float64)
        if not np.all(np.isfinite(levels)):
            row, column = np.argwhere(~np.isfinite(levels))[0]
            raise TargetError(f"The mask is not finite in row {row}, column {column}; every pixel must be a number.")
        return outline_of_mask(_inside(levels), name)
    except KirigamiError as error:
        raise TargetError(f"{name}: {error}") from error


def _archive(path: Path, key: str, dimensions: int) -> npt.NDArray[np.generic]:
    """Read one array of an .npz archive."""
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise UsageError(f"{path} is larger than {LARGEST_FILE >> 20} MB; split it.")
        with np.load(path, allow_pickle=False) as archive:
            if key not in archive:
                raise UsageError(f"{path.name} must hold an array '{key}'; it holds {', '.join(archive) or 'nothing'}.")
            values = np.asarray(archive[key])
    except (OSError, ValueError, EOFError, KeyError) as error:
        raise KirigamiError(f"Cannot read {path}: it is missing, damaged or not an .npz archive.") from error
    except Exception as error:
        if isinstance(error, KirigamiError):
            raise
        raise KirigamiError(f"Cannot read {path}: it is damaged or not an .npz archive.") from error
    if values.ndim != dimensions or values.dtype.kind not in "biuf":
        raise UsageError(f"'{key}' in {path.name} must be an (N, rows, columns) array of numbers, got {values.shape}.")
    if not len(values):
        raise UsageError(f"'{key}' in {path.name} has no entries.")
    return values
