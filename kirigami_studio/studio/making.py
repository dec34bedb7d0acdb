"""Making a sheet: plan and check its cuts, close it on its connectors, judge it, write and verify files, fix."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.export.artwork import Artwork
from kirigami_studio.foundation.errors import Cancelled, ExportError, KirigamiError, ProjectError, UsageError
from kirigami_studio.foundation.steps import Cancel, in_turns
from kirigami_studio.foundation.threads import one_blas_thread
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.settings import FabricationSettings
from kirigami_studio.studio import importing
from kirigami_studio.studio.file_kinds import kind_of

if TYPE_CHECKING:
    from kirigami_studio.export.cut_motion import CutMotion
    from kirigami_studio.export.exporter import ExportJob
    from kirigami_studio.export.strokes import Work
    from kirigami_studio.export.verification import Verification
    from kirigami_studio.fabricate.checks import Report
    from kirigami_studio.fabricate.cut_plan import CutPlan
    from kirigami_studio.fabricate.material import Material
    from kirigami_studio.mechanics.gripping import Gripping
    from kirigami_studio.pipeline.request import Request
    from kirigami_studio.project.document import Document
    from kirigami_studio.studio.as_cut import AsCut, SimulatedSheet
    from kirigami_studio.studio.fixes import Advice
    from kirigami_studio.studio.verdict import Verdict

ANIMATION = ".gif"
#: Plans that are kept: a design that is chosen again, or exported, has its cuts at once.
MOST_PLANS = 16
#: Designs that are estimated between two reports.
AT_ONCE = 4


class Motion(Enum):
    """What an animation shows."""

    AS_CUT = "as_cut"  #: the sheet on its connectors, as far as it comes
    IDEAL = "ideal"  #: connectors of no width, all the way to the target angle


@dataclass(frozen=True, slots=True, eq=False)
class Planned:
    """A cut plan and what its check found.

    Attributes
    ----------
    plan : CutPlan
    report : Report
    removed_share : float, 0..1
        Share of the sheet that was trimmed away.
    work : Work or None
        Length and time where the file holds other cuts than the plan: a closed slot for every slit, or several copies.
    """

    plan: CutPlan
    report: Report
    removed_share: float = 0.0
    work: Work | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Exported:
    """A file, or a folder of files, that is on disk.

    Attributes
    ----------
    path : Path
    planned : Planned or None
        What it holds; pictures hold no plan.
    verifications : tuple of Verification
        What two readers found in each cut file; kinds of file that are not verified this way have none.
    motion : CutMotion or None
        What an animation shows; None for the ideal motion, and for other kinds of file.
    not_as_cut : str
        Why an animation cannot show the sheet as cut, a sentence, or "".
    older, removed : tuple of str
        Names of what an earlier export left in the folder and this one does not have: all of it, and what was removed.
    verdict : Verdict or None
        On the sheet that a cut file holds; coupons and pictures have none.
    """

    path: Path
    planned: Planned | None
    verifications: tuple[Verification, ...] = ()
    motion: CutMotion | None = None
    not_as_cut: str = ""
    older: tuple[str, ...] = ()
    removed: tuple[str, ...] = ()
    verdict: Verdict | None = None


@dataclass(frozen=True, slots=True)
class ManyPages:
    """Nothing was written yet: the PDF would have many pages, which a person has to want.

    Attributes
    ----------
    pages : int
    note : str
        A sentence.
    """

    pages: int
    note: str


@dataclass(frozen=True, slots=True, eq=False)
class CutRequest:
    """The design that is to be cut, and how.

    Attributes
    ----------
    candidate : Candidate
    deployment : Deployment
        Of the candidate's final field: that of the trim, if it is trimmed.
    target : Outline or None
    settings : FabricationSettings
    facts : mapping of str to str
        Where the design comes from.
    as_cut : AsCut or None
        How it does as cut, if that is known already.
    artwork : Artwork or None
        What is printed on the sheet.
    document : Document or None
        The project of the design, which cut files carry with this design alone.
    """

    candidate: Candidate
    deployment: Deployment
    target: Outline | None
    settings: FabricationSettings
    facts: Mapping[str, str] = field(default_factory=dict)
    as_cut: AsCut | None = None
    artwork: Artwork | None = None
    document: Document | None = None

    @property
    def name(self) -> str:
        """What the design is called, "" where nobody knows."""
        return "" if self.document is None else self.document.name_of(self.candidate)


def planning(request: CutRequest, cancel: Cancel) -> Iterator[Planned]:
    """Plan the cuts and check them."""
    importing.import_as_cut()  # the plan is judged in the window's thread, which is not to wait for imports
    yield planned(request, cancel)


_PLANS: OrderedDict[tuple[object, ...], Planned] = OrderedDict()


def planned(request: CutRequest, cancel: Cancel) -> Planned:
    """Plan the cuts and check them, in one go; a trimmed design gets its trimmed outline.

    What was planned lately is not planned again.
    """
    from kirigami_studio.project.settings import material_for

    settings = request.settings
    name = request.name if settings.engrave else ""
    # The target, because what a trim keeps takes no part in comparisons.
    key = (request.candidate, request.target, settings, material_for(settings), name)
    made = _PLANS.pop(key, None) or _planned_anew(request, cancel)
    _PLANS[key] = made
    while len(_PLANS) > MOST_PLANS:
        _PLANS.popitem(last=False)
    return made


def _planned_anew(request: CutRequest, cancel: Cancel) -> Planned:
    from kirigami_studio.fabricate.checks import check_plan
    from kirigami_studio.studio.cutting import plan_of

    trim = request.candidate.trim
    plan = plan_of(request.candidate, request.settings, request.deployment, cancel, request.name)
    report = check_plan(plan, phi=request.candidate.final_phi)
    _ = plan.times  # worked out once and kept: here, so that the window need not
    removed = 0.0 if trim is None else trim.removed_share
    return Planned(plan, report, removed, _work(plan, request.settings.profile))


def _work(plan: CutPlan, profile: str) -> Work | None:
    """What cutting takes if the file holds slots or copies; None where it holds the plan, or cannot hold slots, which
    exporting then explains.
    """
    from kirigami_studio.export.profile import find_profile
    from kirigami_studio.export.strokes import strokes_of, work_of

    found = find_profile(profile)
    if not found.slots and len(plan.copies) == 1:
        return None
    try:
        return work_of(strokes_of(plan, found), plan.material)
    except ExportError:
        return None


def exporting(request: CutRequest, path: Path, many_pages: bool, cancel: Cancel) -> Iterator[Exported | ManyPages]:
    """Write one file of the kind that its extension names; cut files are planned, checked, read back and judged.

    A PDF of many pages is written only where ``many_pages`` are wanted.
    """
    importing.import_exporters()
    from kirigami_studio.export.registry import export, find_exporter

    find_exporter(path)  # an unknown kind is refused before anything is planned
    if not kind_of(path.suffix).cuts:
        yield Exported(export(export_job(request, None), path), None)
        return
    made = planned(request, cancel)
    size, paper = made.plan.copies.spread_mm, request.settings.paper
    if path.suffix.lower() == ".pdf" and not many_pages and (many := _many_pages(size, paper)):
        yield many
        return
    job = export_job(request, made)
    with importing.collecting_between() as collect:
        written = export(job, path)
        collect()
        found = _verified(made.plan, path, request.settings, job.deployment)
        collect()
    yield Exported(written, made, found, verdict=_judging(request, made)(found))


def _many_pages(size: tuple[float, float], paper: str) -> ManyPages | None:
    """What to know before a PDF (width, height; mm) of many pages is written; None for one of few."""
    from kirigami_studio.export.paper import page_notes, tile

    notes = page_notes(size, paper)
    return ManyPages(len(tile(size, paper).tiles), notes[0].text) if notes else None


def exporting_all(
    request: CutRequest, folder: Path, name: str, many_pages: bool, cancel: Cancel
) -> Iterator[Exported | ManyPages]:
    """Write everything that there is of a design into a folder; the cut files are read back.

    Where the PDF has many pages, nothing is written unless ``many_pages`` are wanted.
    """
    importing.import_exporters()
    from kirigami_studio.export.export_set import export_all

    def stop_if_asked(_: Path) -> None:
        collect()
        if cancel():
            raise Cancelled("export.stopped", folder=folder)

    made = planned(request, cancel)
    if not many_pages and (many := _many_pages(made.plan.copies.spread_mm, request.settings.paper)):
        yield many
        return
    judge = _judging(request, made)
    with importing.collecting_between() as collect:
        found = export_all(
            export_job(request, made),
            folder,
            name,
            on_written=stop_if_asked,
            judged=lambda verifications: judge(verifications).to_json(),
        )
        collect()
    left, removed = (tuple(path.name for path in paths) for paths in (found.older, found.removed))
    verdict = judge(found.verifications)
    yield Exported(folder, made, found.verifications, older=left, removed=removed, verdict=verdict)


def _judging(request: CutRequest, made: Planned) -> Callable[[Sequence[Verification]], Verdict]:
    """A function that judges a design by its files; it is closed on its connectors here if nobody did that."""
    from kirigami_studio.studio.verdict import closed_as_cut, judge

    candidate, width = request.candidate, request.settings.width_mm
    known = request.as_cut or closed_as_cut(candidate, request.deployment, made.plan, width)
    return lambda verifications: judge(candidate, made.plan, made.report, known, verifications)


def export_job(request: CutRequest, made: Planned | None) -> ExportJob:
    """What the exporters get about a design."""
    from kirigami_studio.export.exporter import ExportJob
    from kirigami_studio.project.store import packed_design

    target = None if request.target is None else request.target.points
    job = ExportJob.of(request.candidate, target, None if made is None else made.plan)
    return replace(
        job,
        profile=request.settings.profile,
        dxf_version=request.settings.dxf_version,
        paper=request.settings.paper,
        markers=request.settings.markers,
        provenance=request.facts,
        artwork=request.artwork,
        record=b"" if request.document is None else packed_design(request.document, request.candidate),
    )


def exporting_artwork(
    request: CutRequest, folder: Path, many_pages: bool, cancel: Cancel
) -> Iterator[Exported | ManyPages]:
    """Write the printed sheet into a folder: SVG, PDF and PNG in register with the cuts, and a picture of it opened.

    Where the PDF has many pages, nothing is written unless ``many_pages`` are wanted.
    """
    importing.import_exporters()
    from kirigami_studio.export.artwork_files import ArtworkJob, write_artwork

    if request.artwork is None:
        raise ProjectError("artwork.none")
    work = ArtworkJob.usual(request.artwork, export_job(request, planned(request, cancel)))
    if not many_pages and (many := _many_pages(work.page_mm, request.settings.paper)):
        yield many
        return
    with importing.collecting_between():
        write_artwork(work, folder)
    yield Exported(folder, None)


def exporting_coupon(
    material: Material, path: Path, settings: FabricationSettings, cancel: Cancel
) -> Iterator[Exported]:
    """Write the calibration coupon of a material as a cut file, and read it back."""
    from kirigami_studio.export.dxf import write_dxf
    from kirigami_studio.export.profile import find_profile
    from kirigami_studio.fabricate.checks import check_plan
    from kirigami_studio.fabricate.coupon import plan_coupon

    if path.suffix.lower() != ".dxf":
        raise UsageError("coupon.not_dxf", name=path.name)
    plan = plan_coupon(material)
    write_dxf(plan, path, settings.dxf_version, find_profile(settings.profile))
    yield Exported(path, Planned(plan, check_plan(plan)), _verified(plan, path, settings))


def _verified(
    plan: CutPlan, path: Path, settings: FabricationSettings, deployment: Deployment | None = None
) -> tuple[Verification, ...]:
    """Read a cut file again with two readers, if its kind is among those that are verified."""
    from kirigami_studio.export.verification import FORMATS, verify_export

    if path.suffix.lower() not in FORMATS:
        return ()
    return (verify_export(plan, path, settings.profile, settings.dxf_version, deployment),)


# the sheet as cut -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Estimated:
    """What is expected of some designs as cut, and at which strain connectors break.

    Designs that cannot be cut at all are left out.
    """

    found: tuple[tuple[Candidate, AsCut], ...]
    strain_limit: float


def simulating(request: CutRequest, made: Planned, cancel: Cancel) -> Iterator[SimulatedSheet | None]:
    """Close a sheet on the connectors of its plan; None after every step, so that other jobs have their turn."""
    from kirigami_studio.studio.as_cut import simulate

    candidate = request.candidate
    kept = None if candidate.trim is None else candidate.trim.kept
    steps = simulate(
        request.deployment, made.plan, request.settings.width_mm, candidate.final_phi, request.target, kept
    )
    yield from in_turns(steps, cancel)


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
    from kirigami_studio.studio.cutting import plan_of
    from kirigami_studio.studio.fixes import find_fixes
    from kirigami_studio.studio.verdict import refused

    try:
        plan_of(request.candidate, request.settings, request.deployment, cancel)
    except Cancelled:
        raise
    except KirigamiError as error:
        verdict = refused(error)  # with its numbers, which lead to the first changes
    coarser = () if run is None else coarser_designs(request.candidate, run)
    steps = find_fixes(request.candidate, request.settings, verdict, others, coarser)
    yield from in_turns(steps, cancel)


def gripping(
    sheet: SimulatedSheet, deployment: Deployment, width_mm: float, cancel: Cancel
) -> Iterator[Gripping | None]:
    """Find where to hold and pull a sheet as far as it comes; None after every step, so that other jobs have turns."""
    from kirigami_studio.mechanics.closing import CLOSED
    from kirigami_studio.mechanics.gripping import grip_steps

    end = max(sheet.as_cut.reached, CLOSED)
    steps = grip_steps(sheet.made or deployment, sheet.closing.sheet, width_mm, end)
    yield from in_turns(steps, cancel)


def estimating(
    designs: tuple[tuple[Candidate, Deployment, FabricationSettings], ...], cancel: Cancel
) -> Iterator[Estimated]:
    """Estimate whether designs close, each as it would be cut, a few at a time; all are of one material."""
    from kirigami_studio.project.settings import material_for
    from kirigami_studio.studio.as_cut import estimate

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
