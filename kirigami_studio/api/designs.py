"""Designs of a project: found by a run for a target, or read from a file."""

from __future__ import annotations

import operator
import os
import reprlib
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack, overload

import numpy as np

from kirigami_studio.api.choices import (
    CUTS,
    SEARCH,
    SearchKeywords,
    checked_choices,
    explicit_docstring,
    explicit_signature,
    keywords_of,
    number,
    values_for,
)
from kirigami_studio.api.design import Design, Sheet, save_project
from kirigami_studio.api.pictures import Thumbnail, contact_sheet
from kirigami_studio.api.target import Target, TargetLike, load_target
from kirigami_studio.api.values import optional_package, read_only
from kirigami_studio.evaluate.second_target import SecondTarget
from kirigami_studio.fabricate.machine import machines
from kirigami_studio.fabricate.material import library
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import GridError, ProjectError, UsageError
from kirigami_studio.outlines.starts import StartShape, outline_start, start_shape
from kirigami_studio.pipeline.events import Progress, Result
from kirigami_studio.project.document import Document
from kirigami_studio.project.store import load
from kirigami_studio.settings.design import DesignChoices, chosen_settings
from kirigami_studio.settings.fabrication import FabricationSettings, StyleName, new_settings
from kirigami_studio.studio.designing import (
    Tell,
    completed,
    document_of,
    gap_of,
    limit_of,
    request_for,
    run_design,
    why_covered,
)
from kirigami_studio.studio.previewing import preview_design, preview_for

if TYPE_CHECKING:
    from pandas import DataFrame

#: Letters of a line of progress; what is left of a longer one before is written over.
LINE = 78
#: Columns of a table of designs.
FIGURES = ("name", "siou", "iou", "tv", "area_cv", "feasible", "symmetry", "trimmed", "family", "given_up")


@read_only
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Designs(Sequence[Design]):
    """The designs of a project, best first: a sequence, by number, slice or name.

    In a notebook they show themselves as a contact sheet.

    Attributes
    ----------
    document : Document
        The project.
    result : Result or None
        Of the run that found them; None for a project that was read.
    """

    document: Document
    result: Result | None = None

    @property
    def target(self) -> Target:
        """Their target.

        Raises
        ------
        ProjectError
            An empty project.
        """
        if self.document.target is None:
            raise ProjectError("export.no_chosen_design")
        return Target(self.document.target)

    @property
    def best(self) -> Design:
        """The first.

        Raises
        ------
        ProjectError
            There is none.
        """
        if not len(self):
            raise ProjectError("export.no_chosen_design")
        return self[0]

    @property
    def chosen(self) -> Design:
        """The one that the project has chosen, the best unless another one was."""
        return self.best if self.document.chosen is None else self[self.document.chosen]

    @property
    def ratios(self) -> FloatArray:
        """Side ratios of all of them: (K, m, n)."""
        return np.array([design.ratios for design in self])

    def why_covered(self) -> str:
        """Why covers, of which parts are cut away, stand beside closed designs; "" without any."""
        document = self.document
        if gap_of(document.fabrication):  # what panels of pinned sheets show says little of their pieces
            return ""
        why = why_covered(document.candidates, document.target, document.settings.start)
        return "" if why is None else why.text

    def closed_limit(self) -> str:
        """Limit of closed sheets for the target, with the most that was found; "" for none."""
        limit = limit_of(self.document)
        return "" if limit is None else limit.text

    def table(self) -> list[dict[str, Any]]:
        """One row of figures for each, for tables of every kind."""
        return [{name: getattr(design, name) for name in FIGURES} for design in self]

    def to_frame(self) -> DataFrame:
        """The table as a pandas ``DataFrame``, one design a row, by name.

        Raises
        ------
        UsageError
            pandas, which the extra ``pandas`` brings, is not installed.
        """
        frame = optional_package("pandas", "pandas").DataFrame(self.table(), columns=list(FIGURES))
        indexed: DataFrame = frame.set_index("name")
        return indexed

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the project (.kiri), which window and command line open.

        Raises
        ------
        ExportError
            Another extension, or a place that cannot be written.
        """
        return save_project(self.document, path)

    def __len__(self) -> int:
        return len(self.document.candidates)

    @overload
    def __getitem__(self, key: int | str) -> Design: ...
    @overload
    def __getitem__(self, key: slice) -> Designs: ...
    def __getitem__(self, key: int | str | slice) -> Design | Designs:
        if isinstance(key, slice):
            return self._some(range(len(self))[key])
        if isinstance(key, str):
            names = [label.text for label in self.document.labels]
            if key not in names:
                raise ProjectError("api.no_such_name", name=key, names=", ".join(names))
            return self[names.index(key)]
        try:
            place = range(len(self))[operator.index(key)]
        except IndexError:  # which also ends loops over a sequence
            raise IndexError(f"design {key} of {len(self)}") from None
        return Design(replace(self.document, chosen=place))

    def _some(self, places: Sequence[int]) -> Designs:
        """Those at some places, as a project of their own."""
        whole = self.document
        some = replace(
            whole,
            candidates=tuple(whole.candidates[place] for place in places),
            chosen=places.index(whole.chosen) if whole.chosen in places else None,
            marks=tuple(whole.marks[place] for place in places),
            labels=tuple(whole.labels[place] for place in places),
            locked=whole.locked if places else frozenset(),
        )
        return Designs(some, self.result)

    def __iter__(self) -> Iterator[Design]:
        return (self[place] for place in range(len(self)))

    def __repr__(self) -> str:
        if not len(self):
            return "<Designs: none>"
        return f"<Designs: {len(self)} for {self.target.name!r}, best IoU {self.best.iou:.4f}>"

    def _repr_svg_(self) -> str:
        heading = repr(self).strip("<>") if not len(self) else f"{len(self)} designs for {self.target.name}"
        cards = [Thumbnail(one.posed, one.target.outline.rings, one.name, f"IoU {one.iou:.3f}") for one in self]
        return contact_sheet(cards, heading)


def load_project(path: str | os.PathLike[str]) -> Designs:
    """Read a project (.kiri), or the design that a DXF or SVG cut file of this program carries.

    Raises
    ------
    ProjectError
        Missing, damaged, of a newer version, or no project.
    """
    return Designs(load(Path(path)))


def material_names() -> tuple[str, ...]:
    """Keys of all materials, bundled and your own.

    Examples
    --------
    >>> import kirigami_studio as ks
    >>> "card-co2" in ks.material_names()
    True
    """
    return tuple(library().items)


def machine_names() -> tuple[str, ...]:
    """Keys of all machines, bundled and your own, as the command line's ``machines`` lists them.

    Examples
    --------
    >>> import kirigami_studio as ks
    >>> "glowforge" in ks.machine_names()
    True
    """
    return tuple(machines().items)


def design(
    target: TargetLike,
    *,
    grid: str | tuple[int, int] = "auto",
    start: TargetLike = "rectangle",
    also: TargetLike | None = None,
    trim: bool = False,
    budget_seconds: float | None = None,
    material: str | None = None,
    machine: str | None = None,
    width_mm: float | None = None,
    connector_mm: float | None = None,
    kerf_mm: float | None = None,
    style: StyleName | None = None,
    least_panel_mm: float = 0.0,
    progress: bool | Callable[[Progress], object] = False,
    **choices: Unpack[SearchKeywords],
) -> Designs:
    """Design sheets that open into a target: sampled, fitted, ranked, best first.

    The same arguments give the same designs, bit by bit, unless a budget ends the run.

    Parameters
    ----------
    target : whatever :func:`load_target` reads
    grid : (rows, columns) or "auto"
        Voids; ``"auto"`` takes as coarse a grid as the shape allows.
    start : str, or whatever :func:`load_target` reads
        The flat sheet: ``rectangle``, ``square``, ``rectangle:3:2``, ``circle``, ``ellipse:3:2``, ``triangle``,
        ``hexagon``, ``polygon:N``, or any shape.
    also : whatever :func:`load_target` reads, optional
        A second target, which the sheet shows on its way.
    trim : bool
        Whether edge panels are trimmed to the target.
    budget_seconds : float, optional
        Time after which the best so far are returned.
    material : str, optional
        One of :func:`material_names`: designs that can be cut in it come first.
    machine : str, optional
        One of :func:`machine_names`; without a material, one that it cuts is taken.
    width_mm, connector_mm, kerf_mm, style : optional
        Size and cuts, as in :meth:`Design.plan_cuts`; the material's usual ones unless given.
    least_panel_mm : float
        Least panel edge and neck that fits keep.
    progress : bool or callable
        True prints one line that changes, in files a line for every tenth; a callable gets every :class:`Progress`
        (``done``, ``total``, ``message``).
    **choices : settings of a search
        Those of :class:`kirigami_studio.settings.design.DesignChoices`, ``start_weight``, and ``also_phi`` and
        ``also_weight``, angle and weight of the second target.

    Raises
    ------
    TargetError, UsageError, GridError, AngleError, SheetError, FabricationError
        With what does not fit.
    """
    outline = load_target(target).outline
    cuts = {
        "material": material,
        "machine": machine,
        "width_mm": width_mm,
        "connector_mm": connector_mm,
        "kerf_mm": kerf_mm,
        "style": style,
    }
    given = {
        name: value for name, value in checked_choices(cuts, keywords_of(*CUTS), "design").items() if value is not None
    }
    fabrication = new_settings(given)
    least = number("least_panel_mm", least_panel_mm)
    chosen = checked_choices({**choices}, keywords_of(*SEARCH), "design")
    wanted = chosen_settings(
        _grid(grid),
        values_for(DesignChoices, chosen),
        start=_start(start, values_for(StartShape, chosen)),
        second=_second(also, values_for(SecondTarget, chosen)),
    )
    budget = None if budget_seconds is None else number("budget_seconds", budget_seconds)
    request = request_for(outline, wanted, fabrication, least_panel_mm=least, trim=trim, budget_seconds=budget)
    line = _Line()
    tell: Tell = progress if callable(progress) else line.show if progress else _quietly
    try:
        run = run_design(request, fabrication, least_panel_mm=least)
        result = completed(run, tell)
    finally:
        line.end()
    return Designs(document_of(result, fabrication), result)


design.__signature__ = explicit_signature(design, keywords_of(*SEARCH))  # type: ignore[attr-defined]
design.__doc__ = explicit_docstring(design, *SEARCH)


def preview(
    target: TargetLike,
    *,
    grid: str | tuple[int, int] = "auto",
    start: TargetLike = "rectangle",
    phi: float = 0.0,
    refined: bool = False,
) -> Design:
    """Fit one sheet to a target in a fraction of a second.

    The window does so while a target is drawn.  It is no design of a run: nothing is sampled, compared or checked as
    cut, and holes stay closed.

    Parameters
    ----------
    target, grid, start
        As in :func:`design`; a grid of more than 16 voids each way gives way to a coarser one.
    phi : float, radians
        At which the sheet is meant to show the target.
    refined : bool
        Whether up to three longer fits follow, which take a few seconds.

    Raises
    ------
    TargetError, UsageError, GridError, AngleError, SheetError
        With what does not fit.
    """
    outline = load_target(target).outline
    wanted = chosen_settings(_grid(grid), {"phi": number("phi", phi)}, start=_start(start, {}))
    found = preview_design(preview_for(outline, wanted, FabricationSettings()), refined=refined)
    return Sheet(found.design.deployment).for_target(outline, phi=phi)


def _grid(grid: object) -> tuple[int, int] | None:
    """None for ``auto``."""
    if isinstance(grid, str) and grid.strip().lower() == "auto":
        return None
    if isinstance(grid, str) or not isinstance(grid, (Sequence, np.ndarray)) or len(grid) != 2:
        raise GridError("api.not_a_grid", value=reprlib.repr(grid))
    rows, columns = (number("grid", count, whole=True) for count in grid)
    return rows, columns


def _start(start: TargetLike, given: dict[str, Any]) -> StartShape:
    shape = start_shape(start) if isinstance(start, str) else outline_start(load_target(start).outline)
    return replace(shape, **given)


def _second(also: TargetLike | None, given: dict[str, Any]) -> SecondTarget | None:
    if also is None:
        if given:
            raise UsageError("api.second_target_not_named")
        return None
    return SecondTarget(load_target(also).outline, **given)


def _quietly(progress: Progress) -> None:
    """Tell nobody."""


class _Line:
    """Progress on standard output: a line written over, or in files a line for every tenth."""

    def __init__(self) -> None:
        self._begun = False
        self._is_rewritten = sys.stdout.isatty() or "ipykernel" in sys.modules
        self._tenth = -1

    def show(self, progress: Progress) -> None:
        if self._is_rewritten:
            self._begun = True
            sys.stdout.write(f"\r{progress.message[:LINE]:<{LINE}}")
            sys.stdout.flush()
        elif (tenth := 10 * progress.done // max(progress.total, 1)) > self._tenth:
            self._tenth = tenth
            sys.stdout.write(f"{progress.message}\n")

    def end(self) -> None:
        if self._begun:
            sys.stdout.write(f"\r{'':<{LINE}}\r")
            sys.stdout.flush()
