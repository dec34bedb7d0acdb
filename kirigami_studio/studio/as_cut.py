"""Jobs on sheets as cut: close the chosen one on its connectors, write its motion, estimate for all designs whether
they close.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.errors import Cancelled, KirigamiError
from kirigami_studio.foundation.steps import Cancel
from kirigami_studio.foundation.threads import one_blas_thread
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.project.settings import FabricationSettings
from kirigami_studio.studio import importing
from kirigami_studio.studio.cut_files import CutRequest, Exported, Motion, Planned, export_job, planned

if TYPE_CHECKING:
    from kirigami_studio.mechanics.gripping import Gripping
    from kirigami_studio.pipeline.request import Request
    from kirigami_studio.project.as_cut import AsCut, SimulatedSheet
    from kirigami_studio.project.fixes import Advice
    from kirigami_studio.project.verdict import Verdict

Found = TypeVar("Found")
#: Designs that are estimated between two reports.
AT_ONCE = 4


@dataclass(frozen=True, slots=True)
class Estimated:
    """What is expected of some designs as cut, and at which strain connectors break.

    Designs that cannot be cut at all are left out.
    """

    found: tuple[tuple[Candidate, AsCut], ...]
    strain_limit: float


def _in_turns(steps: Generator[None, None, Found], cancel: Cancel) -> Iterator[Found | None]:
    """None after every step, so that other jobs have their turn; at last the result."""
    while True:
        if cancel():
            raise Cancelled("run.no_result")
        try:
            next(steps)
        except StopIteration as end:
            yield end.value
            return
        yield None


def simulating(request: CutRequest, made: Planned, cancel: Cancel) -> Iterator[SimulatedSheet | None]:
    """Close a sheet on the connectors of its plan; None after every step, so that other jobs have their turn."""
    from kirigami_studio.project.as_cut import simulate

    candidate = request.candidate
    kept = None if candidate.trim is None else candidate.trim.kept
    steps = simulate(
        request.deployment, made.plan, request.settings.width_mm, candidate.final_phi, request.target, kept
    )
    yield from _in_turns(steps, cancel)


def animating(
    request: CutRequest, path: Path, motion: Motion, sheet: SimulatedSheet | None, cancel: Cancel
) -> Iterator[Exported | None]:
    """Write an animation; None after every step of the simulation that it may need.

    Parameters
    ----------
    request : CutRequest
    path : Path
    motion : Motion
        A sheet whose cuts cannot be planned or closed is shown in its ideal motion, and the report says why.
    sheet : SimulatedSheet or None
        The design as cut, if it is known already.
    cancel : function
    """
    importing.import_exporters()
    from kirigami_studio.export.registry import export

    why = ""
    if motion is Motion.AS_CUT and sheet is None:
        try:
            for found in simulating(request, planned(request, cancel), cancel):
                sheet = found
                yield None
        except Cancelled:
            raise
        except KirigamiError as error:
            why = str(error)
    shown = None if sheet is None or motion is Motion.IDEAL else sheet.motion(request.settings.width_mm)
    written = export(replace(export_job(request, None), motion=shown), path)
    yield Exported(written, None, motion=shown, not_as_cut=why)


def fixing(
    request: CutRequest, verdict: Verdict, others: Mapping[str, Candidate], run: Request | None, cancel: Cancel
) -> Iterator[Advice | None]:
    """Try changes on a design that is not ready to cut; None after every step, so that other jobs have their turn.

    ``others`` are the designs by their names.  ``run`` is what designs on coarser grids are asked for by; without one
    there are none.
    """
    from kirigami_studio.pipeline.coarser import coarser_designs
    from kirigami_studio.project.cutting import plan_of
    from kirigami_studio.project.fixes import find_fixes
    from kirigami_studio.project.verdict import refused

    try:
        plan_of(request.candidate, request.settings, request.deployment, cancel)
    except Cancelled:
        raise
    except KirigamiError as error:
        verdict = refused(error)  # with its numbers, which lead to the first changes
    coarser = () if run is None else coarser_designs(request.candidate, run)
    steps = find_fixes(request.candidate, request.settings, verdict, others, coarser)
    yield from _in_turns(steps, cancel)


def gripping(
    sheet: SimulatedSheet, deployment: Deployment, width_mm: float, cancel: Cancel
) -> Iterator[Gripping | None]:
    """Find where to hold and pull a sheet as far as it comes; None after every step, so that other jobs have turns."""
    from kirigami_studio.mechanics.closing import CLOSED
    from kirigami_studio.mechanics.gripping import grip_steps

    end = max(sheet.as_cut.reached, CLOSED)
    steps = grip_steps(sheet.made or deployment, sheet.closing.sheet, width_mm, end)
    yield from _in_turns(steps, cancel)


def estimating(
    designs: tuple[tuple[Candidate, Deployment, FabricationSettings], ...], cancel: Cancel
) -> Iterator[Estimated]:
    """Estimate whether designs close, each as it would be cut, a few at a time; all are of one material."""
    from kirigami_studio.project.as_cut import estimate
    from kirigami_studio.project.cutting import material_for

    material = material_for(designs[0][2])
    for start in range(0, len(designs), AT_ONCE):
        found = []
        for candidate, deployment, settings in designs[start : start + AT_ONCE]:
            try:
                # On several threads, narrow matrices wait for each other, and the window for them.
                with one_blas_thread():
                    found.append((candidate, estimate(deployment, settings, candidate.final_phi, material)))
            except KirigamiError:
                continue  # its cuts cannot be planned, which planning explains once it is chosen
        yield Estimated(tuple(found), material.strain_limit)
