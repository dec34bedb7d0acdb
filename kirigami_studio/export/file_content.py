"""The findings of a reader in a cut file, and its differences from the plan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from kirigami_studio.export.strokes import Stroke, total_length

#: Code of millimetres in ``$INSUNITS``.
MILLIMETRES = 4


@dataclass(frozen=True, slots=True, eq=False)
class FileContent:
    """A cut file as one reader sees it."""

    reader: str  #: what read it, for the report
    strokes: tuple[Stroke, ...]  #: in file order
    unit: int | None  #: Code of the file's unit as in ``$INSUNITS``; None when the file has none.
    extent: tuple[float, float] | None  #: (width, height), mm; what the header says
    layers: Mapping[str, int] = field(default_factory=dict)  #: colour of each layer
    others: tuple[str, ...] = ()  #: kinds of entities that are no polylines

    @property
    def length(self) -> float:
        """Length of all strokes, mm."""
        return total_length(self.strokes)


def one_drawing(files: Sequence[FileContent]) -> FileContent:
    """Lay files of one origin upon each other; what they do not share (unit, extent) is lost."""
    first = files[0]
    return FileContent(
        reader=first.reader,
        strokes=tuple(stroke for content in files for stroke in content.strokes),
        unit=first.unit if len({content.unit for content in files}) == 1 else None,
        extent=first.extent if len({content.extent for content in files}) == 1 else None,
        layers={name: colour for content in files for name, colour in content.layers.items()},
        others=tuple(kind for content in files for kind in content.others),
    )


def largest_shift(found: Sequence[Stroke], meant: Sequence[Stroke]) -> float:
    """Largest distance (mm) of a point from where it was meant; infinite when the points do not pair up."""
    if [stroke.points.shape for stroke in found] != [stroke.points.shape for stroke in meant]:
        return float("inf")
    if not found:
        return 0.0
    places, wanted = (np.concatenate([stroke.points for stroke in strokes]) for strokes in (found, meant))
    return float(np.linalg.norm(places - wanted, axis=1).max())


def bent_otherwise(found: Sequence[Stroke], meant: Sequence[Stroke], tolerance: float) -> int:
    """Number of strokes whose arcs differ by more than ``tolerance`` in a bulge."""
    bent = [
        (_bulges(one), _bulges(other))
        for one, other in zip(found, meant, strict=True)
        if one.bulges is not None or other.bulges is not None
    ]
    if not bent:
        return 0
    ones, others = (np.concatenate(sides) for sides in zip(*bent, strict=True))
    owner = np.repeat(np.arange(len(bent)), [len(one) for one, _ in bent])
    return len(np.unique(owner[~(np.abs(ones - others) <= tolerance)]))


def _bulges(stroke: Stroke) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    bulges = np.zeros(len(stroke.points)) if stroke.bulges is None else np.array(stroke.bulges)
    if not stroke.closed:
        bulges[-1] = 0.0
    return bulges
