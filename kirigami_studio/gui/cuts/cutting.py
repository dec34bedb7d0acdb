"""From the design on the stage to its cut plan and cut file, planned anew whenever a number changes."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Unpack

from PySide6.QtCore import QObject, QTimer, Signal

from kirigami_studio.fabricate.material import Material, library
from kirigami_studio.fabricate.material_copies import save_copy
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.jobs import steps
from kirigami_studio.gui.jobs.queue import JobCallbacks, JobQueue
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.project import edits
from kirigami_studio.project.cutting import stored_material
from kirigami_studio.project.document import Document
from kirigami_studio.project.edits import Edit, FabricationChange, OptionsChange
from kirigami_studio.project.settings import FabricationSettings

#: Changes that follow each other faster than this (ms) lead to one plan.
PLAN_DELAY_MS = 120
TRIM_AGAIN = tr(" Or untrim and trim again to make room for these widths.")


class Cutting(QObject):
    """Keeps one plan up to date and writes files."""

    planned = Signal(object)  #: Planned or None
    refused = Signal(str)
    exported = Signal(object)  #: Exported
    message = Signal(object)  #: Message
    status = Signal(str)

    def __init__(self, queue: JobQueue, parent: QObject) -> None:
        super().__init__(parent)
        self._queue = queue
        self._job: int | None = None
        self._wanted: steps.CutRequest | None = None
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(PLAN_DELAY_MS)
        self._timer.timeout.connect(self._plan)

    def plan_soon(self, request: steps.CutRequest | None) -> None:
        """Plan this design, unless another wish comes first; None means that there is nothing to cut."""
        self._wanted = request
        self._timer.start()

    def close(self) -> None:
        """Plan no more."""
        self._timer.stop()

    def _plan(self) -> None:
        if self._job is not None:
            self._queue.abandon(self._job)
            self._job = None
        if self._wanted is None:
            self.planned.emit(None)
            return
        again = "" if self._wanted.candidate.trim is None else TRIM_AGAIN
        callbacks = JobCallbacks(self.planned.emit, on_failed=lambda sentence, _: self.refused.emit(sentence + again))
        self._job = self._queue.start(tr("planning the cuts"), partial(steps.planning, self._wanted), callbacks)

    def export(self, request: steps.CutRequest, path: Path) -> None:
        """Write a cut file or a picture, by the extension."""
        self.status.emit(tr("Exporting {name} …", name=path.name))
        callbacks = JobCallbacks(self._written, on_failed=self._not_written)
        self._queue.start(tr("exporting {name}", name=path.name), partial(steps.exporting, request, path), callbacks)

    def export_all(self, request: steps.CutRequest, folder: Path, name: str) -> None:
        """Write everything that there is of a design into a folder."""
        self.status.emit(tr("Exporting to {name} …", name=folder.name))
        work = partial(steps.exporting_all, request, folder, name)
        self._queue.start(
            tr("exporting to {name}", name=folder.name), work, JobCallbacks(self._written, on_failed=self._not_written)
        )

    def export_coupon(self, material: Material, path: Path, settings: FabricationSettings) -> None:
        """Write the calibration coupon of a material."""
        self.status.emit(tr("Exporting {name} …", name=path.name))
        work = partial(steps.exporting_coupon, material, path, settings)
        self._queue.start(
            tr("exporting {name}", name=path.name), work, JobCallbacks(self._written, on_failed=self._not_written)
        )

    def _written(self, report: object) -> None:
        if not isinstance(report, steps.Exported):
            return
        path, made = report.path, report.planned
        if made is None:
            self.status.emit(tr("Exported {path}.", path=path))
            message = Message(tr("{name} exported.", name=path.name), Tone.DONE, str(path))
        else:
            self.status.emit(
                tr(
                    "Exported {path}: {count} cuts, {cut_length_mm:.0f} mm.",
                    path=path,
                    count=len(made.plan.paths),
                    cut_length_mm=made.plan.cut_length_mm,
                )
            )
            message = told(path, made)
        self.message.emit(message)
        self.exported.emit(report)

    def _not_written(self, sentence: str, trace: str) -> None:
        self.status.emit(tr("Export failed."))
        self.message.emit(Message(sentence, Tone.ERROR, trace))


def told(path: Path, made: steps.Planned) -> Message:
    """Say what a written cut file holds, and whether cutting it would succeed."""
    plan, check = made.plan, made.report
    details = "\n".join([str(path), *(problem.text for problem in check.problems), *plan.notes])
    if check.ok:
        trimmed = tr(", trimmed outline") if made.removed_share else ""
        sentence = tr(
            "{name} exported and checked: {count} cuts{trimmed}, no faults.",
            name=tr("Folder “{name}”", name=path.name) if path.is_dir() else path.name,
            count=len(plan.paths),
            trimmed=trimmed,
        )
        return Message(sentence, Tone.DONE, details)
    sentence = tr("{name} exported, but cutting it would fail: {text}", name=path.name, text=check.problems[0].text)
    return Message(sentence, Tone.WARNING, details)


class Fabricating(QObject):
    """Proposes the edit that a gesture leads to, or says why there is none."""

    edited = Signal(object)  #: Edit
    refused = Signal(object)  #: KirigamiError

    def __init__(self, document: Callable[[], Document], parent: QObject) -> None:
        super().__init__(parent)
        self._document = document

    def change(self, **changes: Unpack[FabricationChange]) -> None:
        """Change sheet, material, widths or what files are written for."""
        self._propose(lambda document: edits.set_fabrication(document, **changes))

    def cut_at_drawn_size(self, width_mm: float) -> None:
        """Let the flat sheet be as wide as opens to the size that the target was drawn with."""
        self._propose(
            lambda document: Edit(
                tr("Cut at the drawn size"), edits.set_fabrication(document, width_mm=width_mm).document
            )
        )

    def change_options(self, **changes: Unpack[OptionsChange]) -> None:
        """Change connector style, order or tabs."""
        self._propose(lambda document: edits.set_cut_options(document, **changes))

    def set_hinge_width(self, hinges: frozenset[int], width_mm: float) -> None:
        """Give connectors a width of their own."""
        if hinges:
            self._propose(lambda document: edits.set_hinge_width(document, hinges, width_mm))

    def remove_hinges(self, hinges: frozenset[int]) -> None:
        """Leave no connector at these hinges."""
        if hinges:
            self._propose(lambda document: edits.remove_hinges(document, hinges))

    def reset_hinges(self, hinges: frozenset[int]) -> None:
        """Give connectors the usual width again."""
        if hinges:
            self._propose(lambda document: edits.reset_hinges(document, hinges))

    def _propose(self, make: Callable[[Document], Edit]) -> None:
        try:
            edit = make(self._document())
        except KirigamiError as error:
            self.refused.emit(error)
        else:
            self.edited.emit(edit)


class MaterialStore(QObject):
    """Compares what a project carries with what is in stock."""

    stocked = Signal(str)  #: key of a material that is in stock now
    message = Signal(object)  #: Message
    status = Signal(str)

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)

    def welcome(self, document: Document) -> None:
        """A project was opened."""
        material = stored_material(document.fabrication)
        if material is None:
            return
        known = library().materials.get(material.key)
        if known is None:
            sentence = tr(
                "You don't have the material {name}; the project's own values are used.",
                name=material.name,
            )
            keep = (tr("Add to my materials"), partial(self.keep, material))
            self.message.emit(Message(sentence, Tone.WARNING, actions=(keep,)))
        elif known != material:
            sentence = tr("Your material {name} differs from the project's; yours is used.", name=known.name)
            self.message.emit(Message(sentence, Tone.WARNING, differences(material, known)))

    def keep(self, material: Material) -> None:
        """Save what a project carries among the own materials."""
        try:
            save_copy(material)
        except KirigamiError as error:
            self.message.emit(Message(str(error), Tone.ERROR))
            return
        self.status.emit(tr("Added {name} to your materials.", name=material.name))
        self.stocked.emit(material.key)


def differences(carried: Material, known: Material) -> str:
    """One line for every entry in which two materials differ."""
    entries = [name for name in Material.__dataclass_fields__ if getattr(carried, name) != getattr(known, name)]
    return "\n".join(
        tr(
            "{entry}: {theirs} in the project, {ours} in your materials",
            entry=name,
            theirs=_told(carried, name),
            ours=_told(known, name),
        )
        for name in entries
    )


def _told(material: Material, name: str) -> str:
    value = getattr(material, name)
    return f"{value:g}" if isinstance(value, float) else str(value)
