"""What the worker is asked to do, as Qt-free generators.

The rooms that cost time to import (torch, scikit-image, ezdxf) are imported here inside the functions: the first
import then happens in the worker, after the window is shown.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.gui.file_kinds import kind_of
from kirigami_studio.gui.jobs.worker import Cancel
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.pipeline.events import CandidateFound, CandidateImproved, Event
from kirigami_studio.pipeline.request import Request
from kirigami_studio.project.document import Document
from kirigami_studio.project.settings import FabricationSettings
from kirigami_studio.target.outline import Outline

if TYPE_CHECKING:
    from kirigami_studio.fabricate.checks import Report
    from kirigami_studio.fabricate.cut_plan import CutPlan

#: Extensions of targets that are traced at a threshold.
PICTURES = (".png", ".jpg", ".jpeg", ".bmp")


@dataclass(frozen=True, slots=True, eq=False)
class Decoded:
    """A candidate with its exact motion."""

    candidate: Candidate
    deployment: Deployment


@dataclass(frozen=True, slots=True, eq=False)
class Planned:
    """A cut plan and what its check found."""

    plan: CutPlan
    report: Report


@dataclass(frozen=True, slots=True, eq=False)
class Exported:
    """A file that is on disk, with the plan that it holds; pictures hold none."""

    path: Path
    planned: Planned | None


@dataclass(frozen=True, slots=True, eq=False)
class Order:
    """The design that is to be exported, and how it is cut."""

    candidate: Candidate
    deployment: Deployment
    target: Outline | None
    settings: FabricationSettings


@dataclass(frozen=True, slots=True)
class Loaded:
    """A room of the program that is in memory now."""

    room: str


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture that a target is traced from; grey levels run from 0 (black) to 1 (white)."""

    path: Path
    automatic: float
    threshold: float


@dataclass(frozen=True, slots=True)
class ModelFound:
    """The generator that a run uses: SHA-256 of its weights."""

    digest: str


def generating(request: Request, cancel: Cancel) -> Iterator[Event | ModelFound | Decoded]:
    """Run the pipeline; every new or improved candidate is followed by its decoded motion."""
    from kirigami_studio.generator.weights import digest_of
    from kirigami_studio.pipeline.run import run

    yield ModelFound(digest_of(request.variant))
    for event in run(request, cancel):
        yield event
        if isinstance(event, CandidateFound | CandidateImproved):
            yield Decoded(event.candidate, deploy(event.candidate.field))


def decoding(candidates: tuple[Candidate, ...], cancel: Cancel) -> Iterator[Decoded]:
    """Decode the candidates of an opened project."""
    for candidate in candidates:
        yield Decoded(candidate, deploy(candidate.field))


def reading_target(source: str, cancel: Cancel) -> Iterator[Picture | Outline]:
    """Read a file or a library silhouette; a picture tells first which threshold it is read at."""
    from kirigami_studio.target.read import read_target

    path = Path(source)
    if path.suffix.lower() in PICTURES:
        from kirigami_studio.target.read_image import automatic_threshold

        level = automatic_threshold(path)
        yield Picture(path, level, level)
    yield read_target(source)


def tracing(picture: Picture, cancel: Cancel) -> Iterator[Outline]:
    """Trace a picture at its threshold."""
    from kirigami_studio.target.read_image import read_image

    yield read_image(picture.path, picture.threshold)


def planning(deployment: Deployment, settings: FabricationSettings, cancel: Cancel) -> Iterator[Planned]:
    """Plan the cuts and check them."""
    yield planned(deployment, settings)


def planned(deployment: Deployment, settings: FabricationSettings) -> Planned:
    """Plan the cuts and check them, in one go."""
    from kirigami_studio.fabricate.checks import check_plan
    from kirigami_studio.fabricate.cut_plan import plan_cuts
    from kirigami_studio.fabricate.material import find_material

    plan = plan_cuts(
        deployment,
        width_mm=settings.width_mm,
        connector_mm=settings.connector_mm,
        kerf_mm=settings.kerf_mm,
        material=find_material(settings.material),
    )
    return Planned(plan, check_plan(plan))


def exporting(order: Order, path: Path, cancel: Cancel) -> Iterator[Exported]:
    """Write one file of the kind that its extension names; cut files are planned, checked and read back."""
    from kirigami_studio.export.exporter import ExportJob
    from kirigami_studio.export.registry import export, find_exporter

    find_exporter(path)  # an unknown kind is refused before anything is planned
    job = planned(order.deployment, order.settings) if kind_of(path.suffix).cuts else None
    score = order.candidate.score
    export(
        ExportJob(
            order.deployment,
            score.phi,
            None if job is None else job.plan,
            None if order.target is None else order.target.points,
            score.transform,
        ),
        path,
    )
    yield Exported(path, job)


def saving(document: Document, path: Path, cancel: Cancel) -> Iterator[Path]:
    """Write the project file."""
    from kirigami_studio.project import store

    store.save(document, path)
    yield path


def loading(path: Path, cancel: Cancel) -> Iterator[Document]:
    """Read a project file."""
    from kirigami_studio.project import store

    yield store.load(path)


def warming(cancel: Cancel) -> Iterator[Loaded | tuple[str, ...]]:
    """Import what the first run needs, before anyone waits for it; at last yield the generators on offer.

    It reports after every import, so that a file which is opened meanwhile need not wait for all of them.
    """
    from kirigami_studio.target import read_image as _read_image  # noqa: F401

    yield Loaded("pictures")
    from kirigami_studio.export import registry as _registry  # noqa: F401

    yield Loaded("exporters")
    from kirigami_studio.generator.weights import variants

    yield Loaded("generator")
    from kirigami_studio.pipeline import run as _run  # noqa: F401

    yield variants()
