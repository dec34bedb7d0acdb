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
    """A cut file that is on disk and was read back, with the plan that it holds."""

    path: Path
    planned: Planned


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


def reading_target(source: str, cancel: Cancel) -> Iterator[Outline]:
    """Read a file or a library silhouette."""
    from kirigami_studio.target.read import read_target

    yield read_target(source)


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


def exporting(deployment: Deployment, settings: FabricationSettings, path: Path, cancel: Cancel) -> Iterator[Exported]:
    """Plan, check and write the DXF file; the writer reads it back."""
    from kirigami_studio.export.dxf import write_dxf

    job = planned(deployment, settings)
    write_dxf(job.plan, path)
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


def warming(cancel: Cancel) -> Iterator[tuple[str, ...]]:
    """Import what the first run needs, before anyone waits for it; yield the generators on offer."""
    from kirigami_studio.export import dxf as _dxf  # noqa: F401
    from kirigami_studio.generator.weights import variants
    from kirigami_studio.pipeline import run as _run  # noqa: F401
    from kirigami_studio.target import read as _read  # noqa: F401

    yield variants()
