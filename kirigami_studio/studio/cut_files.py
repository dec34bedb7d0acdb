"""Jobs on cuts: plan and check them, write cut files and pictures, write a material's coupon."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.export.artwork import Artwork
from kirigami_studio.foundation.errors import Cancelled, ExportError, ProjectError, UsageError
from kirigami_studio.foundation.steps import Cancel
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
    from kirigami_studio.project.as_cut import AsCut
    from kirigami_studio.project.document import Document
    from kirigami_studio.project.verdict import Verdict

ANIMATION = ".gif"
#: Plans that are kept: a design that is chosen again, or exported, has its cuts at once.
MOST_PLANS = 16


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
    from kirigami_studio.project.cutting import material_for

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
    from kirigami_studio.project.cutting import plan_of

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
    from kirigami_studio.project.verdict import closed_as_cut, judge

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
