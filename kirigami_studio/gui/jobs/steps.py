"""What the worker is asked to do, as Qt-free generators.

The rooms that cost time to import (torch, scikit-image, ezdxf) are imported here inside the functions: the first
import then happens in the worker, after the window is shown.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.errors import Cancelled, ExportError, UsageError
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.file_kinds import kind_of
from kirigami_studio.gui.jobs import importing
from kirigami_studio.gui.jobs.picture_reading import reduced_picture
from kirigami_studio.gui.jobs.queue import Cancel
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.events import CandidateFound, CandidateImproved, Event
from kirigami_studio.pipeline.request import Request
from kirigami_studio.project.settings import FabricationSettings

if TYPE_CHECKING:
    from PySide6.QtGui import QImage

    from kirigami_studio.export.exporter import ExportJob
    from kirigami_studio.export.verification import Verification
    from kirigami_studio.fabricate.checks import Report
    from kirigami_studio.fabricate.cut_plan import CutPlan
    from kirigami_studio.fabricate.material import Material
    from kirigami_studio.outlines.read_image import Traced

#: Extensions of targets that are traced at a threshold.
PICTURES = (".png", ".jpg", ".jpeg", ".bmp")


@dataclass(frozen=True, slots=True, eq=False)
class Decoded:
    """A candidate with its exact motion."""

    candidate: Candidate
    deployment: Deployment


@dataclass(frozen=True, slots=True, eq=False)
class Planned:
    """A cut plan and what its check found.

    Attributes
    ----------
    plan : CutPlan
    report : Report
    removed_share : float, 0..1
        Share of the sheet that was trimmed away.
    slots_mm : float or None
        Cut length where the machine profile makes a closed slot of every slit; the plan knows that of open cuts.
    """

    plan: CutPlan
    report: Report
    removed_share: float = 0.0
    slots_mm: float | None = None


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
    """

    path: Path
    planned: Planned | None
    verifications: tuple[Verification, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class CutRequest:
    """The design that is to be cut, and how.

    Attributes
    ----------
    candidate : Candidate
    deployment : Deployment
        Of the finished field: that of the trim, if the candidate is trimmed.
    target : Outline or None
    settings : FabricationSettings
    facts : mapping of str to str
        Where the design comes from.
    """

    candidate: Candidate
    deployment: Deployment
    target: Outline | None
    settings: FabricationSettings
    facts: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Loaded:
    """A room of the program that is in memory now."""

    room: str


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture that a target is traced from; grey levels run from 0 (black) to 1 (white).

    ``traced`` says where the target lies in it, ``seen`` is the picture reduced for drawing.
    """

    path: Path
    automatic: float
    threshold: float
    traced: Traced | None = None
    seen: QImage | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class ModelFound:
    """The generator that a run uses: SHA-256 of its weights."""

    digest: str


def generating(request: Request, cancel: Cancel) -> Iterator[Event | ModelFound | Decoded]:
    """Run the pipeline; every new or improved candidate is followed by its decoded motion."""
    importing.import_generator()
    from kirigami_studio.generator.weights import digest_of
    from kirigami_studio.pipeline.run import run

    yield ModelFound(digest_of(request.variant))
    for event in run(request, cancel):
        yield event
        if isinstance(event, CandidateFound | CandidateImproved):
            yield decoded(event.candidate)


def decoding(candidates: tuple[Candidate, ...], cancel: Cancel) -> Iterator[Decoded]:
    """Decode the candidates of an opened project."""
    for candidate in candidates:
        yield decoded(candidate)


def decoded(candidate: Candidate) -> Decoded:
    """A candidate with the motion of its final field."""
    return Decoded(candidate, deploy(candidate.final_field))


def comparing(candidate: Candidate, target: Outline, cancel: Cancel) -> Iterator[Decoded]:
    """Score a candidate as the generator sampled it, in the pose that suits it best."""
    from kirigami_studio.pipeline.redesign import sampled

    before = sampled(candidate, target)
    if before is not None:
        yield decoded(before)


def trimming(candidate: Candidate, target: Outline, settings: FabricationSettings, cancel: Cancel) -> Iterator[Decoded]:
    """Fit a candidate so that it covers the target, and trim it, with room for the connectors at its hinges."""
    from kirigami_studio.pipeline.redesign import trimmed

    found = trimmed(candidate, target, keep_for(candidate, settings), cancel)
    if cancel():
        raise Cancelled("trim.stopped")
    yield decoded(found.candidate)


def keep_for(candidate: Candidate, settings: FabricationSettings) -> float:
    """Depth (unit cells) of the material that trimming has to leave at the hinges of a candidate."""
    from kirigami_studio.pipeline.redesign import keep_for_connectors
    from kirigami_studio.project.cutting import material_for

    grid, material = (candidate.field.rows, candidate.field.columns), material_for(settings)
    return keep_for_connectors(grid, material, settings.width_mm, settings.connector_mm, settings.kerf_mm)


def reading_target(source: str, cancel: Cancel) -> Iterator[Picture | Outline]:
    """Read a file or a library silhouette; a picture tells first which threshold it is read at."""
    from kirigami_studio.outlines.read import read_target

    path = Path(source)
    if path.suffix.lower() in PICTURES:
        from kirigami_studio.outlines.read_image import automatic_threshold, trace_image

        level = automatic_threshold(path)
        traced = trace_image(path)
        yield Picture(path, level, level, traced, reduced_picture(path))
        yield traced.outline
    else:
        yield read_target(source)


def tracing(picture: Picture, cancel: Cancel) -> Iterator[Traced]:
    """Trace a picture at its threshold."""
    from kirigami_studio.outlines.read_image import trace_image

    yield trace_image(picture.path, picture.threshold)


def planning(request: CutRequest, cancel: Cancel) -> Iterator[Planned]:
    """Plan the cuts and check them."""
    yield planned(request)


def planned(request: CutRequest) -> Planned:
    """Plan the cuts and check them, in one go; a trimmed design gets its trimmed outline."""
    from kirigami_studio.fabricate.checks import check_plan
    from kirigami_studio.project.cutting import plan_of

    trim = request.candidate.trim
    plan = plan_of(request.candidate, request.settings, request.deployment)
    report = check_plan(plan, phi=request.candidate.final_phi)
    _ = plan.times  # worked out once and kept: here, so that the window need not
    removed = 0.0 if trim is None else trim.removed_share
    return Planned(plan, report, removed, _slots_length(plan, request.settings.profile))


def _slots_length(plan: CutPlan, profile: str) -> float | None:
    """Length of the file's cuts if it holds slots; None where it does not, or cannot, which exporting then explains."""
    from kirigami_studio.export.profile import find_profile
    from kirigami_studio.export.strokes import strokes_of

    found = find_profile(profile)
    if not found.slots:
        return None
    try:
        return sum(stroke.length for stroke in strokes_of(plan, found))
    except ExportError:
        return None


def exporting(request: CutRequest, path: Path, cancel: Cancel) -> Iterator[Exported]:
    """Write one file of the kind that its extension names; cut files are planned, checked and read back."""
    importing.import_exporters()
    from kirigami_studio.export.registry import export, find_exporter

    find_exporter(path)  # an unknown kind is refused before anything is planned
    made = planned(request) if kind_of(path.suffix).cuts else None
    written = export(export_job(request, made), path)
    yield Exported(written, made, () if made is None else _verified(made.plan, path, request.settings))


def exporting_all(request: CutRequest, folder: Path, name: str, cancel: Cancel) -> Iterator[Exported]:
    """Write everything that there is of a design into a folder; the cut files are read back."""
    importing.import_exporters()
    from kirigami_studio.export.export_set import export_all

    def stop_if_asked(_: Path) -> None:
        if cancel():
            raise Cancelled(tr("Export to {folder} stopped; files already written are kept.", folder=folder))

    made = planned(request)
    found = export_all(export_job(request, made), folder, name, tell=stop_if_asked)
    yield Exported(folder, made, found.verifications)


def export_job(request: CutRequest, made: Planned | None) -> ExportJob:
    """What the exporters get about a design."""
    from kirigami_studio.export.exporter import ExportJob

    target = None if request.target is None else request.target.points
    job = ExportJob.of(request.candidate, target, None if made is None else made.plan)
    return replace(
        job, profile=request.settings.profile, dxf_version=request.settings.dxf_version, provenance=request.facts
    )


def exporting_coupon(
    material: Material, path: Path, settings: FabricationSettings, cancel: Cancel
) -> Iterator[Exported]:
    """Write the calibration coupon of a material as a cut file, and read it back."""
    from kirigami_studio.export.dxf import write_dxf
    from kirigami_studio.export.profile import find_profile
    from kirigami_studio.fabricate.checks import check_plan
    from kirigami_studio.fabricate.coupon import plan_coupon

    if path.suffix.lower() != ".dxf":
        raise UsageError(
            tr("Coupons are exported as .dxf, not {name}. The command line supports other types.", name=path.name)
        )
    plan = plan_coupon(material)
    write_dxf(plan, path, settings.dxf_version, find_profile(settings.profile))
    yield Exported(path, Planned(plan, check_plan(plan)), _verified(plan, path, settings))


def _verified(plan: CutPlan, path: Path, settings: FabricationSettings) -> tuple[Verification, ...]:
    """Read a cut file again with two readers, if its kind is among those that are verified."""
    from kirigami_studio.export.verification import FORMATS, verify_export

    if path.suffix.lower() not in FORMATS:
        return ()
    return (verify_export(plan, path, settings.profile, settings.dxf_version),)


def warming(cancel: Cancel) -> Iterator[Loaded | tuple[str, ...]]:
    """Import what the first run needs, before anyone waits for it; at last yield the generators on offer.

    It reports after every import, so that a file which is opened meanwhile need not wait for all of them.
    """
    importing.import_pictures()
    yield Loaded("pictures")
    importing.import_exporters()
    yield Loaded("exporters")
    importing.import_generator()
    yield Loaded("generator")
    from kirigami_studio.generator.weights import variants

    yield variants()
