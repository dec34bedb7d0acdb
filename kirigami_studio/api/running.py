"""One run, from a request and fabrication settings to ranked designs and their project, for scripts and command line.

The window does the same step by step, in its job queue.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from kirigami_studio.foundation.errors import Cancelled, FabricationError
from kirigami_studio.foundation.words import tr
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.pipeline.best_as_cut import best_as_cut
from kirigami_studio.pipeline.events import Finished, Progress, Result
from kirigami_studio.pipeline.pool import Pool
from kirigami_studio.pipeline.redesign import keep_for_connectors
from kirigami_studio.pipeline.request import Request, provenance
from kirigami_studio.pipeline.run import run, with_grid
from kirigami_studio.polish.flat_sheet import width_in_cells
from kirigami_studio.project.as_cut import jam_angles
from kirigami_studio.project.cutting import material_for
from kirigami_studio.project.design_facts import with_run
from kirigami_studio.project.document import Document
from kirigami_studio.project.settings import FabricationSettings
from kirigami_studio.project.verdict import look_at

#: Told how far a run has come.
Tell = Callable[[Progress], object]


def result_of_run(
    request: Request,
    fabrication: FabricationSettings,
    tell: Tell,
    *,
    least_panel_mm: float = 0.0,
    as_cut: bool = False,
    pool: Pool | None = None,
) -> Result:
    """Choose the grid, run, and rank.

    Parameters
    ----------
    request : Request
        Its grid may be open.
    fabrication : FabricationSettings
        The sheet's width, and what has to hold.
    tell : callable
        Gets every :class:`~kirigami_studio.pipeline.events.Progress`.
    least_panel_mm : float
        Least panel edge and neck that is asked for.
    as_cut : bool
        Whether designs are ranked by how they do as cut in the material.
    pool : Pool, optional
        Of the fits; the program's own unless given.

    Raises
    ------
    FabricationError
        Designs were to be trimmed and none could be.
    """
    request = _on_its_grid(request, fabrication, least_panel_mm)
    result = _finished(request, tell, pool)
    if as_cut:
        result = cuttable_first(result, fabrication, tell)
    if request.trim and all(one.trim is None for one in result.candidates):
        raise FabricationError("design.trimming_cut_short" if result.budget_ended else "design.none_trimmed")
    return result


def cuttable_first(result: Result, fabrication: FabricationSettings, tell: Tell) -> Result:
    """Rank designs by how they do as cut, the best that can be cut in this material first."""
    target = result.request.target
    jams = jam_angles(result.candidates, fabrication)
    steps = best_as_cut(result, jams, lambda one: look_at(one, fabrication, target))
    while True:
        try:
            one = next(steps)
        except StopIteration as end:
            found: Result = end.value
            return found
        message = tr("Looking for a design that can be cut: {number} of {total}", number=one.number, total=one.total)
        tell(Progress(one.number, one.total, message))


def document_of(result: Result, fabrication: FabricationSettings) -> Document:
    """The project that the window would have after the same run."""
    from kirigami_studio.generator.weights import digest_of

    request = result.request
    source = provenance(request, digest_of(request.variant))
    candidates = tuple(with_run(result.candidates, source))
    return Document(request.target, request.settings, candidates, 0, fabrication, source)


def _finished(request: Request, tell: Tell, pool: Pool | None) -> Result:
    for event in run(request, pool=pool):
        if isinstance(event, Progress):
            tell(event)
        elif isinstance(event, Finished):
            return event.result
    raise Cancelled("run.no_result")


def _on_its_grid(request: Request, fabrication: FabricationSettings, least_panel_mm: float) -> Request:
    """The request with its grid chosen, and with what depends on the size of its cells."""
    request = with_grid(request)
    grid = request.chosen_grid
    least = least_panel_mm * width_in_cells(grid, request.start) / fabrication.width_mm
    return replace(
        request, least_panel=least, keep=_keep(fabrication, request.uniform) if request.trim else request.keep
    )


def _keep(fabrication: FabricationSettings, sheet: Sheet) -> float:
    """How deep (unit cells) material has to stay at the hinges of a trimmed sheet so that its connectors hold."""
    material, numbers = material_for(fabrication), (fabrication.connector_mm, fabrication.kerf_mm)
    return keep_for_connectors(sheet, material, fabrication.width_mm, *numbers)
