"""From a project to what the files of its chosen design are made of: cut files, pictures and animations."""

from __future__ import annotations

from dataclasses import replace

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.project.design_facts import design_facts
from kirigami_studio.project.document import Document
from kirigami_studio.project.settings import FabricationSettings
from kirigami_studio.project.store import packed_design


def chosen_candidate(document: Document) -> Candidate:
    """The project's design.

    Raises
    ------
    ProjectError
        It has none.
    """
    candidate = document.candidate
    if candidate is None or document.target is None:
        raise ProjectError("export.no_chosen_design")
    return candidate


def cut_job(document: Document, plan: CutPlan, settings: FabricationSettings) -> ExportJob:
    """What files of the chosen design are made of, cut by this plan."""
    record = packed_design(replace(document, fabrication=settings), chosen_candidate(document))
    return replace(picture_job(document), plan=plan, record=record, dxf_version=settings.dxf_version,
                   profile=settings.profile, paper=settings.paper, markers=settings.markers,
                   artwork=document.artwork)  # fmt: skip


def picture_job(document: Document) -> ExportJob:
    """What pictures and animations of the chosen design are made of."""
    chosen = chosen_candidate(document)
    job = ExportJob.of(chosen, None if document.target is None else document.target.points)
    return replace(job, provenance=design_facts(document, chosen))
