"""Sheets as JSON, for files of scripts, projects, answers and records.

``{"ratio": [[...], ...], "rim": {"top": [...], "right": [...], "bottom": [...], "left": [...]}, "start": [[x, y], ...],
"cell": [width, height]}``.  Row 0 of the ratios is on top; the rim has the positions of the mouths in unit cells along
each side, left to right and top to bottom; ``hinges``, where edge hinges are not halfway between their mouths, has the
shares by which each of them is off, clockwise.  Only ``ratio`` is required: what is missing or null is the paper's.  A
bare table of ratios, as JSON or .npy, is a sheet too.
"""

from __future__ import annotations

import io
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from kirigami_studio.foundation.errors import GridError, RatioError, SheetError, UsageError
from kirigami_studio.foundation.files import read_at_most
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import SIDES, Rim, Sheet

#: What :func:`read_sheet` reads.
SUFFIXES = (".json", ".npy")
#: Entry of the rim beside its sides.
HINGES = "hinges"
LARGEST_FILE = 64 * 1024 * 1024


def sheet_json(sheet: Sheet) -> dict[str, object]:
    """The entries of a sheet, all four: lists and numbers that JSON repeats exactly."""
    return {"ratio": sheet.field.ratio.tolist(), **rim_json(sheet)}


def rim_json(sheet: Sheet) -> dict[str, object]:
    """The entries beside the ratios: ``rim``, ``start`` and ``cell``."""
    return {
        "rim": {side: values.tolist() for side, values in zip(SIDES, sheet.rim.sides, strict=True)}
        | ({} if sheet.rim.folds_shut else {HINGES: sheet.rim.hinges.tolist()}),
        "start": None if sheet.start is None else sheet.start.tolist(),
        "cell": list(sheet.cell),
    }


def sheet_of_json(entries: Mapping[str, Any], field: RatioField | None = None) -> Sheet:
    """The sheet that such entries tell; others are left alone.

    Parameters
    ----------
    entries : mapping of str to object
        As a JSON reader gives them.
    field : RatioField, optional
        The ratios, where they are kept elsewhere; else ``entries["ratio"]``.

    Raises
    ------
    RatioError, GridError, SheetError, UsageError
        Impossible values: ratios, grid, rim or start outline, cell.
    """
    if field is None:
        field = RatioField(entries.get("ratio"))  # type: ignore[arg-type]  # checked by the constructor
    cell = entries.get("cell")
    rim = _rim(entries.get("rim"), field)
    return Sheet(field, rim, entries.get("start"), (1.0, 1.0) if cell is None else cell)


def _rim(entry: object, field: RatioField) -> Rim:
    """The rim of an entry; sides that it does not name are even."""
    even = Rim.even(field.rows, field.columns)
    if entry is None:
        return even
    if not isinstance(entry, dict) or not set(entry) <= {*SIDES, HINGES}:
        raise SheetError("rim.not_four_sides")
    top, right, bottom, left = (entry.get(side, values) for side, values in zip(SIDES, even.sides, strict=True))
    return Rim(top, right, bottom, left, entry.get(HINGES, even.hinges))


def read_sheet(path: Path) -> Sheet:
    """Read a sheet file, or a file with ratios alone.

    Raises
    ------
    RatioError, SheetError
        Missing, damaged, of another kind, or with impossible values; the sentence names the file.
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise RatioError("ratios.unknown_extension", name=path.name)
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise RatioError("ratios.file_too_large", path=path, limit=LARGEST_FILE >> 20)
        if suffix == ".npy":
            content: object = _array(read_at_most(path, LARGEST_FILE))
        else:
            content = json.loads(read_at_most(path, LARGEST_FILE).decode("utf-8-sig"))
    except (OSError, ValueError, RecursionError) as error:
        if isinstance(error, OSError) and error.strerror:
            raise RatioError("ratios.not_readable", path=path, reason=error.strerror) from error
        raise RatioError("ratios.damaged", path=path) from error
    if isinstance(content, (list, np.ndarray)):
        content = {"ratio": content}
    if not isinstance(content, dict) or not isinstance(content.get("ratio"), (list, np.ndarray)):
        raise RatioError("ratios.not_a_table", name=path.name)
    return named_sheet(content, path.name)


def _array(content: bytes) -> npt.NDArray[np.generic]:
    """The table of an .npy file; its header may not claim more numbers than follow."""
    stream = io.BytesIO(content)
    try:
        version = np.lib.format.read_magic(stream)
        header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, _, kind = header(stream)
        if kind.hasobject or math.prod(shape) * kind.itemsize > len(content) - stream.tell():
            raise ValueError("the header claims more than there is")
        stream.seek(0)
        table: npt.NDArray[np.generic] = np.lib.format.read_array(stream, allow_pickle=False)
        return table
    except Exception as error:  # NumPy evaluates the header as Python text: it may raise a dozen kinds
        raise ValueError(str(error)) from error


def named_sheet(entries: Mapping[str, Any], name: str) -> Sheet:
    """:func:`sheet_of_json`, where a refusal names the input.

    Raises
    ------
    RatioError, SheetError
        Impossible values.
    """
    try:
        return sheet_of_json(entries)
    except (RatioError, GridError) as error:
        raise RatioError("input.not_valid", name=name, reason=error) from error
    except (SheetError, UsageError) as error:
        raise SheetError("input.not_valid", name=name, reason=error) from error
