"""Cut plan -> a folder with one DXF for each layer and nothing else, numbered in the order of cutting.

All files share one origin and one extent: each begins with the same three marks in corners around the sheet, on a layer
of their own, so that programs that place a file by what is drawn in it lay the files upon each other too.  The folder
appears whole or not at all.
"""

from __future__ import annotations

import contextlib
import re
import shutil
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from kirigami_studio.export.dxf import SAME_MM, check_written, strokes_dxf
from kirigami_studio.export.file_content import FileContent, one_drawing
from kirigami_studio.export.profile import BLUE, Profile
from kirigami_studio.export.provenance import facts_of
from kirigami_studio.export.strokes import Stroke, extent, file_strokes
from kirigami_studio.fabricate.cut_plan import DECIMALS, CutPlan
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically

#: Letters of the folder's name in that of a temporary folder: the name may already be as long as a name can be.
NAME_PART = 40
REGISTRATION_LAYER = "REGISTRATION"
#: Length (mm) of the arms of a registration mark, and distance of the marks' frame from everything that is cut.
MARK_MM, MARK_GAP_MM = 3.0, 2.0
#: Marks lie where the sheet ends, which an arc may do between the coordinates of points.
MARK_DECIMALS = 10
OWN_NAME = re.compile(r"[1-9]_[A-Z_]+\.dxf")


def layer_folder(path: Path) -> Path:
    """The folder that stands for a cut file of this name: ``cut.dxf`` -> ``cut``."""
    return path.with_suffix("") if path.suffix.lower() == ".dxf" else path


def write_layer_files(plan: CutPlan, path: str | Path, version: str, profile: Profile, record: bytes = b"") -> Path:
    """Write the folder and return it.

    Parameters
    ----------
    path : str or Path
        The folder, or a ``.dxf`` name whose stem names it.
    record : bytes
        The design that the plan cuts, see ``design_record``; the first file has it.

    Raises
    ------
    ExportError
        A folder that holds other files, a place that cannot be written, or a file that did not read back.
    """
    folder = layer_folder(Path(path))
    _refuse_strange_content(folder)
    strokes = file_strokes(plan, profile)
    marks, facts = registration_marks(extent(strokes)), facts_of(plan, profile)
    size, parts = extent(marks), by_layer(strokes)
    fresh: Path | None = None
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        fresh = Path(tempfile.mkdtemp(prefix=f".{folder.name[:NAME_PART]}.", dir=folder.parent))
        for number, (name, part) in enumerate(parts.items(), start=1):
            drawn = [*marks, *(_moved(stroke, MARK_GAP_MM) for stroke in part)]
            said = facts | {"PART": f"{number} of {len(parts)}"}
            verify = partial(check_written, strokes=drawn, size=size, version=version)
            enclosed = record if number == 1 else b""
            write_atomically(fresh / name, strokes_dxf(drawn, size, version, said, record=enclosed), verify)
        fresh.chmod(0o755)
        _put_in_place(fresh, folder)
        fresh = None
    except OSError as error:
        raise ExportError("file.not_written", path=folder, reason=error.strerror or str(error)) from error
    finally:
        if fresh is not None:
            shutil.rmtree(fresh, ignore_errors=True)
    return folder


def layer_paths(folder: Path) -> list[Path]:
    """The files of such a folder in the order of cutting.

    Raises
    ------
    ExportError
        No such folder, or other files in it.
    """
    if not folder.is_dir():
        raise ExportError("layers.not_a_folder", folder=folder)
    _refuse_strange_content(folder)
    return sorted(folder.iterdir())


def by_layer(strokes: Sequence[Stroke]) -> dict[str, list[Stroke]]:
    """Strokes by the name of their file; layers in the order in which they begin."""
    parts: dict[str, list[Stroke]] = {}
    for stroke in strokes:
        parts.setdefault(stroke.layer, []).append(stroke)
    return {f"{number}_{name}.dxf": part for number, (name, part) in enumerate(parts.items(), start=1)}


def registration_marks(size: tuple[float, float]) -> tuple[Stroke, ...]:
    """Marks in three corners around a sheet (width, height), mm, that lies ``MARK_GAP_MM`` from the origin.

    Three tell a file that is turned or mirrored; none of them comes nearer to the sheet than the gap.
    """
    width, height = (side + 2.0 * MARK_GAP_MM for side in size)
    arms = (
        [[MARK_MM, 0.0], [0.0, 0.0], [0.0, MARK_MM]],
        [[width - MARK_MM, 0.0], [width, 0.0], [width, MARK_MM]],
        [[0.0, height - MARK_MM], [0.0, height], [MARK_MM, height]],
    )
    return tuple(Stroke(np.array(arm).round(MARK_DECIMALS), False, REGISTRATION_LAYER, BLUE) for arm in arms)


def laid_together(contents: Sequence[FileContent], folder: Path) -> FileContent:
    """The files of a folder as one drawing, without their registration marks and where the plan has it.

    Raises
    ------
    ExportError
        The files do not have the same marks.
    """
    drawing = one_drawing(contents)
    marks = [[s.points.tolist() for s in content.strokes if s.layer == REGISTRATION_LAYER] for content in contents]
    if not marks or any(len(found) != 3 or found != marks[0] for found in marks):
        raise ExportError("layers.not_registered", folder=folder)
    size = drawing.extent
    return replace(
        drawing,
        strokes=tuple(_moved(s, -MARK_GAP_MM) for s in drawing.strokes if s.layer != REGISTRATION_LAYER),
        extent=None if size is None else (size[0] - 2.0 * MARK_GAP_MM, size[1] - 2.0 * MARK_GAP_MM),
        layers={name: colour for name, colour in drawing.layers.items() if name != REGISTRATION_LAYER},
    )


def _moved(stroke: Stroke, by: float) -> Stroke:
    """A stroke moved along both axes (mm), on the grid of the plan's coordinates if it was on it."""
    moved = stroke.points + by
    near = moved.round(DECIMALS) + 0.0
    return replace(stroke, points=near if np.allclose(near, moved, rtol=0.0, atol=SAME_MM) else moved)


def _refuse_strange_content(folder: Path) -> None:
    """A folder of ours may be replaced; nothing else may be lost or mixed in."""
    if not folder.exists():
        return
    if not folder.is_dir():
        raise ExportError("layers.file_in_the_way", folder=folder)
    strange = sorted(entry.name for entry in folder.iterdir() if not OWN_NAME.fullmatch(entry.name))
    if strange:
        raise ExportError("layers.other_files", folder=folder, name=strange[0])


def _put_in_place(fresh: Path, folder: Path) -> None:
    """Exchange the folders; an older one comes back if that fails."""
    if not folder.exists():
        fresh.replace(folder)
        return
    old = Path(tempfile.mkdtemp(prefix=f".{folder.name[:NAME_PART]}.old.", dir=folder.parent)) / folder.name
    folder.replace(old)
    try:
        fresh.replace(folder)
    except OSError:
        old.replace(folder)
        raise
    finally:
        with contextlib.suppress(OSError):
            shutil.rmtree(old.parent)
