"""Jobs on designs: generate, decode, score as sampled, fit again, trim.  What they compute is composed in pipeline."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.posed_design import trimmed_parts
from kirigami_studio.fabricate.panel_sizes import least_panel_share
from kirigami_studio.foundation.errors import Cancelled, KirigamiError
from kirigami_studio.foundation.steps import Cancel
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.symmetry import symmetry_of
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.events import CandidateFound, CandidateImproved, Event, Finished
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.variety import distinct, look_alikes
from kirigami_studio.project.document import Void
from kirigami_studio.project.settings import DesignSettings, FabricationSettings
from kirigami_studio.studio import importing


@dataclass(frozen=True, slots=True, eq=False)
class Decoded:
    """A candidate with the exact motion of its final sheet."""

    candidate: Candidate
    deployment: Deployment


@dataclass(frozen=True, slots=True)
class ModelFound:
    """The generator that a run uses: SHA-256 of its weights."""

    digest: str


@dataclass(frozen=True, slots=True)
class Refitted:
    """What a fit from a design's present sheet has found.

    Attributes
    ----------
    decoded : Decoded
        The fitted design with its motion, trimmed if the one it began with was.
    better : bool
        Whether it ranks before the one it began with, both untrimmed.
    untrimmed : str
        Why it could not be trimmed again, "" if that was not to be done or was.
    """

    decoded: Decoded
    better: bool
    untrimmed: str = ""


@dataclass(frozen=True, slots=True)
class GridChosen:
    """The grid that a run has chosen, and why in one sentence."""

    grid: tuple[int, int]
    reason: str


@dataclass(frozen=True, slots=True)
class FittedAgain:
    """How many designs of all were fitted again; one of them before and after, where it became better."""

    done: int
    total: int
    before: Candidate | None
    after: Candidate | None


#: What a run of the generator reports.
RunReport = Event | ModelFound | GridChosen | Decoded


def generating(
    request: Request,
    others: tuple[Candidate, ...] | None,
    cancel: Cancel,
    cut: FabricationSettings | None = None,
) -> Iterator[RunReport]:
    """Run the pipeline; every new or improved candidate is followed by its decoded motion.

    With ``others`` the result keeps only designs that differ from them and from each other.  Comparing a thousand
    designs with a thousand takes a second, which would freeze the window: hence it is done here.  With ``cut`` the
    result is ranked by how designs do as cut, too.
    """
    importing.import_generator()
    from kirigami_studio.generator.weights import digest_of
    from kirigami_studio.pipeline.run import grid_choice, run
    from kirigami_studio.studio.as_cut import jam_angles

    yield ModelFound(digest_of(request.variant))
    if request.grid is None and request.near is None:
        choice = grid_choice(request)
        yield GridChosen(choice.grid, choice.reason)
    for event in run(request, cancel):
        match event:
            case CandidateFound() | CandidateImproved():
                yield event
                yield decoded(event.candidate)
            case Finished(result):
                if others is not None:
                    new = distinct(result.candidates, others)
                    result = replace(result, candidates=new, repeats=len(result.candidates) - len(new))
                yield Finished(result if cut is None else result.ranked_as_cut(jam_angles(result.candidates, cut)))
            case _:
                yield event


def decoding(candidates: tuple[Candidate, ...], cancel: Cancel) -> Iterator[Decoded]:
    """Decode the candidates of an opened project."""
    for candidate in candidates:
        yield decoded(candidate)


def decoded(candidate: Candidate) -> Decoded:
    """A candidate with the motion of its final sheet.

    What the gallery and the stage ask of every design is found out here and kept by who found it: the window does not
    wait for it.
    """
    deployment = deploy(candidate.final_sheet)
    least_panel_share(deployment)
    symmetry_of(candidate.sheet)
    if candidate.trim is not None:
        trimmed_parts(deployment, candidate.trim)
    return Decoded(candidate, deployment)


def grouping(candidates: tuple[Candidate, ...], ranking: Ranking, cancel: Cancel) -> Iterator[tuple[int, ...]]:
    """Find which designs look alike."""
    yield look_alikes(candidates, ranking)


def scoring_sample(candidate: Candidate, target: Outline, cancel: Cancel) -> Iterator[Decoded]:
    """Score a candidate as the generator sampled it, in the pose that suits it best."""
    from kirigami_studio.pipeline.redesign import sampled

    before = sampled(candidate, target)
    if before is not None:
        yield decoded(before)


def refitting(
    candidate: Candidate,
    target: Outline,
    wanted: DesignSettings,
    locked: frozenset[Void],
    settings: FabricationSettings,
    cancel: Cancel,
) -> Iterator[Refitted]:
    """Fit a candidate on the exact geometry from its present sheet, and trim it again if it is trimmed."""
    from kirigami_studio.pipeline.redesign import refitted

    least_mm, room_mm = sizes_of(settings)
    refit = refitted(
        candidate,
        target,
        wanted.prefer,
        locked,
        partial(keep_for, candidate, settings),
        cancel,
        regular=wanted.regular,
        free_rim=wanted.rim == "free",
        width_mm=settings.width_mm,
        least_feature_mm=least_mm,
        room_mm=room_mm,
    )
    untrimmed = "" if refit.trim_problem is None else str(refit.trim_problem)
    yield Refitted(decoded(refit.candidate), refit.better, untrimmed)


def fitting_again(
    request: Request, candidates: tuple[Candidate, ...], cancel: Cancel
) -> Iterator[Decoded | FittedAgain]:
    """Fit designs again by what the request prefers; a better one comes decoded before its report."""
    from kirigami_studio.pipeline.fit_again import fit_again

    for report in fit_again(request, candidates, cancel):
        if report.after is not None:
            yield decoded(report.after)
        yield FittedAgain(report.done, report.total, report.before, report.after)


def trimming(candidate: Candidate, target: Outline, settings: FabricationSettings, cancel: Cancel) -> Iterator[Decoded]:
    """Fit a candidate so that it covers the target, and trim it, with room for the connectors at its hinges."""
    from kirigami_studio.pipeline.redesign import trimmed
    from kirigami_studio.polish.panel_size import least_in_cells

    least_mm, _ = sizes_of(settings)
    least = least_in_cells(least_mm, settings.width_mm, candidate.score.evenness.width)
    found = trimmed(candidate, target, keep_for(candidate, settings), cancel, least_panel=least)
    if cancel():
        raise Cancelled("trim.stopped")
    yield decoded(found.candidate)


def sizes_of(settings: FabricationSettings) -> tuple[float, float]:
    """Panel edge and neck (mm) that the material allows at least, and that leaves connectors their full width.

    Zeros for a material that is not known here.
    """
    from kirigami_studio.studio.cutting import least_feature_mm, room_mm

    try:
        return least_feature_mm(settings), room_mm(settings)
    except KirigamiError:
        return 0.0, 0.0


def keep_for(candidate: Candidate, settings: FabricationSettings) -> float:
    """Depth (unit cells) of the material that trimming has to leave at the hinges of a candidate."""
    from kirigami_studio.pipeline.redesign import keep_for_connectors
    from kirigami_studio.project.settings import material_for

    sheet, material = candidate.sheet, material_for(settings)
    return keep_for_connectors(sheet, material, settings.width_mm, settings.connector_mm, settings.kerf_mm)
