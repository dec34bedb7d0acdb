"""Targets of several separate pieces: one sheet for each, designed and cut to one scale."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Unpack

import numpy as np
from shapely import MultiPolygon

from kirigami_studio.api.choices import SearchKeywords
from kirigami_studio.api.design import save_project
from kirigami_studio.api.designs import Designs, design
from kirigami_studio.api.target import Target, TargetLike
from kirigami_studio.api.values import read_only
from kirigami_studio.export.verification import Verification
from kirigami_studio.foundation.errors import ProjectError, UsageError
from kirigami_studio.foundation.steps import never
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.events import Progress
from kirigami_studio.project.document import Document
from kirigami_studio.project.sheet_size import sized
from kirigami_studio.project.target_parts import parts_as_cut, scale_of, with_part, with_parts, with_twins
from kirigami_studio.settings.fabrication import CutChange, StyleName, with_choices
from kirigami_studio.studio.making import ExportedFiles, Output
from kirigami_studio.studio.part_sheets import exporting_parts, part_names, with_settings
from kirigami_studio.studio.targets import PartChoice, PieceRead
from kirigami_studio.studio.verdict import Verdict


class RunKeywords(SearchKeywords, total=False):
    """Types of the keywords of a run."""

    grid: str | tuple[int, int]
    start: TargetLike
    also: TargetLike | None
    trim: bool
    budget_seconds: float | None
    material: str | None
    machine: str | None
    width_mm: float | None
    connector_mm: float | None
    kerf_mm: float | None
    style: StyleName | None
    least_panel_mm: float
    progress: bool | Callable[[Progress], object]


@read_only
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Parts(Sequence[Designs]):
    """The parts of one target, each with its designs: a sequence, by number or name.

    Attributes
    ----------
    document : Document
        The project of all.
    """

    document: Document

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parts, in the order of the drawing."""
        return part_names(self.document)

    @property
    def mm_per_unit(self) -> float:
        """Millimetres of the opened sheets for one unit of the drawing, the same for all."""
        return scale_of(self.document)

    def export(self, path: str | os.PathLike[str], **cuts: Unpack[CutChange]) -> ExportedParts:
        """Write the chosen designs of all parts: one cut file for each bed of the machine.

        Parameters
        ----------
        path : path
            ``.dxf``, ``.svg``, ``.pdf`` or ``.lbrn2``; further beds are written beside it, as ``name-b2.dxf``.  Designs
            that are made of pieces or tiles are written into a folder of this name, one folder for each part.
        **cuts : settings of a sheet and its cuts
            Those of :meth:`Design.plan_cuts`, for all parts; another ``width_mm`` is that of the part that the project
            shows, and the others are to its scale.

        Raises
        ------
        ExportError, FabricationError, ProjectError, UsageError
            A kind of file that holds one sheet alone, a sheet that cannot be cut, or a part without a design.
        """
        given = {name: value for name, value in cuts.items() if value is not None}
        settings = with_choices(self.document.fabrication, given)
        *_, found = exporting_parts(with_settings(self.document, settings), Output(Path(path)), True, never)
        assert isinstance(found, ExportedFiles)  # all pages of a PDF are wanted
        return ExportedParts(found)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the project (.kiri) of all parts, which window and command line open.

        Raises
        ------
        ExportError
            Another extension, or a place that cannot be written.
        """
        return save_project(self.document, path)

    def __len__(self) -> int:
        return len(self.document.parts)

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, slice):
            return tuple(self[place] for place in range(*key.indices(len(self))))
        if isinstance(key, str):
            if key not in self.names:
                raise ProjectError("api.no_such_name", name=key, names=", ".join(self.names))
            key = self.names.index(key)
        return Designs(parts_as_cut(self.document)[key])

    def __iter__(self) -> Iterator[Designs]:
        return (self[place] for place in range(len(self)))

    def __repr__(self) -> str:
        return f"<Parts: {', '.join(self.names)}>"


@read_only
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ExportedParts:
    """Files with the sheets of all parts.

    Attributes
    ----------
    found : ExportedFiles
        The value of the program that it wraps.
    """

    found: ExportedFiles

    @property
    def files(self) -> tuple[Path, ...]:
        return self.found.files

    @property
    def verifications(self) -> tuple[Verification, ...]:
        """Findings of two readers on every sheet; :attr:`Verification.sheet` is its part."""
        return self.found.verifications

    @property
    def verdicts(self) -> dict[str, Verdict]:
        """On the sheet of each part, with what was found in the files."""
        return {part.part: part.verdict for part in self.found.parts if part.verdict is not None}

    @property
    def ok(self) -> bool:
        """Whether every file that was read back is as planned."""
        return self.found.ok

    def __repr__(self) -> str:
        return f"<ExportedParts {', '.join(path.name for path in self.files)}: {', '.join(self.verdicts)}>"


def load_parts(
    source: str | os.PathLike[str] | MultiPolygon,
    *,
    parts: str | None = None,
    stroke: float | None = None,
    threshold: float | None = None,
    fill_holes: bool | None = None,
) -> tuple[Target, ...]:
    """Every piece of a drawing, or of several polygons, as a target of its own.

    Parameters
    ----------
    source : path or MultiPolygon
        An SVG, DXF, PDF or AI file, or a picture.
    parts, stroke, threshold, fill_holes : optional
        As in :func:`load_target`; all parts unless given.

    Raises
    ------
    TargetError, UsageError
        Nothing that is closed, too many pieces, or a source without parts.

    Examples
    --------
    >>> import shapely
    >>> import kirigami_studio as ks
    >>> colon = shapely.MultiPolygon([shapely.box(0, 0, 8, 8), shapely.box(0, 20, 8, 28)])
    >>> ks.load_parts(colon)
    (<Target 'target': 4 points>, <Target 'target 2': 4 points>)
    """
    return tuple(Target(piece.outline) for piece in _pieces(source, parts, stroke, threshold, fill_holes))


def _pieces(
    source: object, parts: str | None, stroke: float | None, threshold: float | None, fill_holes: bool | None
) -> tuple[PieceRead, ...]:
    if isinstance(source, MultiPolygon):
        names = [f"target {number}" if number > 1 else "target" for number in range(1, len(source.geoms) + 1)]
        return tuple(
            PieceRead(
                Outline.from_points(
                    piece.exterior.coords, name, holes=[np.asarray(hole.coords) for hole in piece.interiors]
                ).with_holes(fill_holes),
                (float(piece.centroid.x), float(piece.centroid.y)),
            )
            for piece, name in zip(source.geoms, names, strict=True)
        )
    if not isinstance(source, (str, os.PathLike)):
        raise UsageError("parts.not_a_drawing", source=type(source).__name__, kinds="SVG, DXF, PDF, AI")
    choice = PartChoice.of(parts, "each", None, stroke)
    assert choice is not None  # a way to join was said
    found = choice.pieces(Path(source), threshold)
    return tuple(replace(piece, outline=piece.outline.with_holes(fill_holes)) for piece in found)


def design_parts(
    source: str | os.PathLike[str] | MultiPolygon,
    *,
    parts: str | None = None,
    stroke: float | None = None,
    threshold: float | None = None,
    fill_holes: bool | None = None,
    **choices: Unpack[RunKeywords],
) -> Parts:
    """Design a sheet for every piece of a drawing, all to one scale.

    Parameters
    ----------
    source, parts, stroke, threshold, fill_holes
        As in :func:`load_parts`.
    **choices : optional
        Those of :func:`design`; ``width_mm`` is the width of the sheet of the largest piece.

    Raises
    ------
    TargetError, UsageError, GridError, AngleError, SheetError, FabricationError
        With what does not fit.
    """
    pieces = _pieces(source, parts, stroke, threshold, fill_holes)
    placed = [(piece.outline, piece.place) for piece in pieces]
    largest = with_parts(Document(), placed).part
    first = design(pieces[largest].outline, **choices).document
    whole = with_parts(Document(settings=first.settings, fabrication=first.fabrication), placed)
    whole = sized(with_part(whole, largest, replace(first, place=whole.place, fabrication=whole.fabrication)))
    whole = with_twins(whole, largest)
    for number, part in enumerate(parts_as_cut(whole)):
        if part.target is not None and not whole.parts[number].candidates:
            choices["width_mm"] = part.fabrication.width_mm
            found = replace(design(part.target, **choices).document, place=part.place)
            whole = with_twins(with_part(whole, number, found), number)
    return Parts(whole)
