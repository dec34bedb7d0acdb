"""From the design on the stage to its cut plan and cut file, planned anew whenever a number changes."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, QTimer, Signal

from kirigami_studio.fabricate.material import Material
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.jobs import steps
from kirigami_studio.gui.jobs.queue import JobCallbacks, JobQueue
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.project.settings import FabricationSettings

#: Changes that follow each other faster than this (ms) lead to one plan.
PLAN_DELAY_MS = 120
TRIM_AGAIN = tr(" Or take the trim off and trim again: it then keeps what these widths need.")


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
        self.status.emit(tr("Writing {name} …", name=path.name))
        callbacks = JobCallbacks(self._written, on_failed=self._not_written)
        self._queue.start(tr("writing {name}", name=path.name), partial(steps.exporting, request, path), callbacks)

    def export_all(self, request: steps.CutRequest, folder: Path, name: str) -> None:
        """Write everything that there is of a design into a folder."""
        self.status.emit(tr("Writing into {name} …", name=folder.name))
        work = partial(steps.exporting_all, request, folder, name)
        self._queue.start(
            tr("writing into {name}", name=folder.name), work, JobCallbacks(self._written, on_failed=self._not_written)
        )

    def export_coupon(self, material: Material, path: Path, settings: FabricationSettings) -> None:
        """Write the calibration coupon of a material."""
        self.status.emit(tr("Writing {name} …", name=path.name))
        work = partial(steps.exporting_coupon, material, path, settings)
        self._queue.start(
            tr("writing {name}", name=path.name), work, JobCallbacks(self._written, on_failed=self._not_written)
        )

    def _written(self, report: object) -> None:
        if not isinstance(report, steps.Exported):
            return
        path, made = report.path, report.planned
        if made is None:
            self.status.emit(tr("Exported {path}.", path=path))
            message = Message(tr("{name} was written.", name=path.name), Tone.DONE, str(path))
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
        self.status.emit(tr("The file was not written."))
        self.message.emit(Message(sentence, Tone.ERROR, trace))


def told(path: Path, made: steps.Planned) -> Message:
    """Say what a written cut file holds, and whether cutting it would succeed."""
    plan, check = made.plan, made.report
    details = "\n".join([str(path), *(problem.text for problem in check.problems), *plan.notes])
    if check.ok:
        trimmed = tr(", trimmed outline") if made.removed_share else ""
        sentence = tr(
            "{name} was written and read back: {count} cuts{trimmed}, no fault.",
            name=tr("Folder “{name}”", name=path.name) if path.is_dir() else path.name,
            count=len(plan.paths),
            trimmed=trimmed,
        )
        return Message(sentence, Tone.DONE, details)
    sentence = tr("{name} was written, but cutting it would fail: {text}", name=path.name, text=check.problems[0].text)
    return Message(sentence, Tone.WARNING, details)
