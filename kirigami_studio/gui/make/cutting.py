"""Cutting: the plan and files of the design on the stage, the numbers it is cut with, the materials of a project."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from PySide6.QtCore import QObject, QTimer, Signal

from kirigami_studio.fabricate.machine import SHELF as MACHINES
from kirigami_studio.fabricate.machine import Machine
from kirigami_studio.fabricate.material import SHELF as MATERIALS
from kirigami_studio.fabricate.material import Material
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.steps import Cancel, Steps
from kirigami_studio.foundation.words import mark, number, tr, tr_n
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.queue import JobCallbacks, LatestJob
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.session.user_preferences import UserPreferences
from kirigami_studio.gui.stage.as_cut import AsCutReader
from kirigami_studio.gui.stage.hand_editor import HandEditor
from kirigami_studio.project import edits
from kirigami_studio.project.document import Document
from kirigami_studio.project.edits import Edit
from kirigami_studio.project.sheet_size import set_opened_size
from kirigami_studio.settings.fabrication import FabricationChange, OptionsChange, stored_values, unlike
from kirigami_studio.studio.file_kinds import kind_of
from kirigami_studio.studio.making import (
    ANIMATION,
    CutRequest,
    ExportedFiles,
    MadePieces,
    ManyPages,
    Motion,
    Output,
    Planned,
    animating,
    exporting_artwork,
    exporting_coupon,
    planning,
)
from kirigami_studio.studio.part_sheets import exporting_all

if TYPE_CHECKING:
    from kirigami_studio.studio.verdict import Verdict

#: Changes that follow each other faster than this (ms) lead to one plan.
PLAN_DELAY_MS = 120
#: Files that open in LightBurn.
LIGHTBURN = ".lbrn2"
#: What is said of a machine or a material that a project carries and the user does not have.
NOT_KNOWN = {
    Machine: mark("You don't have the machine {name}; the project's own values are used."),
    Material: mark("You don't have the material {name}; the project's own values are used."),
}
KEEP = {Machine: mark("Add to my machines"), Material: mark("Add to my materials")}
ADDED = {Machine: mark("Added {name} to your machines."), Material: mark("Added {name} to your materials.")}
TRIM_AGAIN = mark("Untrimming and trimming again may also make room for these widths.")


class CutPlanner(QObject):
    """Keeps the cut plan of the design on the stage up to date."""

    planned = Signal(object)  #: Planned or MadePieces, or None without a design
    answered = Signal(CutRequest, object)  #: what was to be planned, and the same
    refused = Signal(str)
    not_planned = Signal(CutRequest, str)  #: what was to be planned, and why it cannot be

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._job = LatestJob[Planned | MadePieces](session.queue)
        self._wanted: CutRequest | None = None
        self.made: Planned | MadePieces | None = None  #: the last plan; None where there is none, or it was refused
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(PLAN_DELAY_MS)
        self._timer.timeout.connect(self._plan)
        session.display.settled.connect(self.plan_soon)
        session.fabrication_changed.connect(self.plan_soon)
        session.document_changed.connect(self._take_name)
        session.document_changed.connect(self._take_artwork)

    @property
    def request(self) -> CutRequest | None:
        """The design on the stage and how it is to be cut."""
        stage, document = self._session.stage, self._session.document
        if stage is None:
            return None
        return CutRequest(
            stage.candidate, stage.design.deployment, document.target, document.fabrication, document=document
        )

    def plan_soon(self) -> None:
        """Plan the cuts of the design on the stage, unless something changes again before."""
        self._wanted = self.request
        self._timer.start()

    def _take_name(self, document: Document) -> None:
        """Plan again where the design on the sheet is called otherwise now."""
        before = self._wanted
        if not document.fabrication.engrave or before is None:
            return
        now = self.request
        if now is not None and now.candidate is before.candidate and now.name != before.name:
            self.plan_soon()

    def _take_artwork(self, document: Document) -> None:
        """Plan pieces again that get other lines engraved."""
        before = self._wanted
        if before is None or not before.has_layers:
            return
        now = self.request
        if now is not None and now.candidate is before.candidate and now.artwork != before.artwork:
            self.plan_soon()

    def close(self) -> None:
        """Plan no more."""
        self._timer.stop()

    def _plan(self) -> None:
        self._job.stop()
        if self._wanted is None:
            self._tell(None)
            return
        callbacks = JobCallbacks(partial(self._take, self._wanted), on_failed=partial(self._refuse, self._wanted))
        self._job.start(tr("planning the cuts"), partial(planning, self._wanted), callbacks)

    def _take(self, request: CutRequest, made: Planned | MadePieces) -> None:
        self._tell(made)
        self.answered.emit(request, made)

    def _tell(self, made: Planned | MadePieces | None) -> None:
        self.made = made
        self.planned.emit(made)

    def _refuse(self, request: CutRequest, sentence: str, trace: str) -> None:
        self.made = None
        told = sentence if request.candidate.trim is None else f"{sentence} {tr(TRIM_AGAIN)}"
        self.refused.emit(told)
        self.not_planned.emit(request, told)


class DesignExporter(QObject):
    """Writes files of the design on the stage; a PDF of many pages only after asking."""

    exported = Signal(ExportedFiles)
    open_wanted = Signal(Path)  #: in the program that the desktop has for it

    def __init__(
        self,
        session: Session,
        planner: CutPlanner,
        as_cut: AsCutReader,
        hand: HandEditor,
        preferences: UserPreferences,
        parent: QObject,
    ) -> None:
        super().__init__(parent)
        self._session, self._planner, self._as_cut = session, planner, as_cut
        self._hand, self._preferences = hand, preferences

    def export(self, path: Path, motion: Motion = Motion.AS_CUT) -> None:
        """Write a cut file or picture, by the extension; ``motion`` is what an animation shows."""
        if self._hand.postpones(lambda: self.export(path, motion)):
            return
        request, session = self._planner.request, self._session
        if request is None:
            session.post(Message(tr("No design to export yet. Generate one first."), Tone.HINT))
            return
        name, status = tr("exporting {name}", name=path.name), tr("Exporting {name} …", name=path.name)
        if path.suffix.lower() == ANIMATION and not session.document.other_parts:
            session.set_status(status)
            self._write(name, partial(animating, request, path, motion, self._as_cut.state.sheet))
            return
        if kind_of(path.suffix).cuts:
            self._preferences.remember(session.document)
        self._write_pages(name, status, partial(exporting_all, self._with_as_cut(request), Output(path)))

    def export_all(self, folder: Path, name: str) -> None:
        """Write everything that there is of the design into a folder."""
        if self._hand.postpones(lambda: self.export_all(folder, name)):
            return
        request = self._planner.request
        if request is not None:
            steps = partial(exporting_all, self._with_as_cut(request), Output(folder, name, record=True))
            status = tr("Exporting to {name} …", name=folder.name)
            self._write_pages(tr("exporting to {name}", name=folder.name), status, steps)

    def export_artwork(self, folder: Path) -> None:
        """Write the printed sheet into a folder."""
        if self._hand.postpones(lambda: self.export_artwork(folder)):
            return
        request = self._planner.request
        if request is not None:
            steps = partial(exporting_artwork, request, folder)
            self._write_pages(tr("exporting the artwork"), tr("Exporting the artwork …"), steps)

    def _with_as_cut(self, request: CutRequest) -> CutRequest:
        """The request with how the design does as cut, if that is known."""
        sheet = self._as_cut.state.sheet
        return request if sheet is None else replace(request, as_cut=sheet.as_cut)

    def export_coupon(self, material: Material, path: Path) -> None:
        """Write the calibration coupon of a material."""
        self._session.set_status(tr("Exporting {name} …", name=path.name))
        steps = partial(exporting_coupon, material, path, self._session.document.fabrication)
        self._write(tr("exporting {name}", name=path.name), steps)

    def _write_pages(
        self,
        name: str,
        status: str,
        steps: Callable[[bool, Cancel], Iterator[ExportedFiles | ManyPages]],
        many: bool = False,
    ) -> None:
        """Start a job that asks before it writes ``many`` pages."""
        self._session.set_status(status)
        self._write(name, partial(steps, many), partial(self._write_pages, name, status, steps, True))

    def _write(
        self, name: str, steps: Steps[ExportedFiles | ManyPages | None], with_pages: Callable[[], None] | None = None
    ) -> None:
        """Start a job; ``with_pages`` starts it once more, for as many pages as it takes."""
        callbacks = JobCallbacks(partial(self._take_written, with_pages), on_failed=self._report_failure)
        self._session.queue.start(name, steps, callbacks)

    def _take_written(self, with_pages: Callable[[], None] | None, report: ExportedFiles | ManyPages | None) -> None:
        match report:
            case ExportedFiles():
                self._report(report)
            case ManyPages() if with_pages is not None:
                self._session.set_status(tr("Not exported yet: {count} pages.", count=report.pages))
                write = (tr("Write all pages"), with_pages)
                self._session.post(Message(report.note, Tone.WARNING, actions=(write,)))

    def _report(self, exported: ExportedFiles) -> None:
        path, made = exported.path, exported.planned
        if exported.parts:
            self._session.set_status(tr("Exported {path}.", path=path))
            message = message_of_parts(path, exported)
        elif exported.pieces is not None:
            self._session.set_status(tr("Exported {path}.", path=path))
            message = message_of_pieces(path, exported.pieces, exported.verdict)
        elif made is None:
            self._session.set_status(tr("Exported {path}.", path=path))
            message = Message(picture_sentence(exported), Tone.DONE, str(path))
        else:
            self._session.set_status(
                tr_n(
                    "Exported {path}: {count} cut, {cut_length_mm:.0f} mm.",
                    "Exported {path}: {count} cuts, {cut_length_mm:.0f} mm.",
                    len(made.plan.copies) * len(made.plan.paths),
                    path=path,
                    cut_length_mm=len(made.plan.copies) * made.plan.cut_length_mm,
                )
            )
            message = message_of(path, made, exported.verdict)
        if not exported.verifications:  # a report offers the same
            message = replace(message, actions=((words_to_open(path), partial(self.open_wanted.emit, path)),))
        self._session.post(message)
        for about in older_messages(exported):
            self._session.post(about)
        self.exported.emit(exported)

    def _report_failure(self, sentence: str, trace: str) -> None:
        self._session.set_status(tr("Export failed."))
        self._session.post(Message(sentence, Tone.ERROR, trace))


def words_to_open(path: Path) -> str:
    """The button that opens a written file or folder."""
    if path.is_dir():
        return tr("Open folder")
    return tr("O&pen in LightBurn") if path.suffix == LIGHTBURN else tr("O&pen file")


def older_messages(exported: ExportedFiles) -> list[Message]:
    """What became of files that an earlier export left in the folder."""
    found = []
    if exported.removed:
        names = ", ".join(exported.removed)
        sentence = tr("Removed files of an earlier export that this one does not have: {names}.", names=names)
        found.append(Message(sentence, Tone.HINT))
    if left := ", ".join(name for name in exported.older if name not in exported.removed):
        sentence = tr(
            "The folder has files of an earlier export: {names}. Delete what you do not want to cut.", names=left
        )
        found.append(Message(sentence, Tone.WARNING))
    return found


def picture_sentence(exported: ExportedFiles) -> str:
    """Say that a picture was written, and which motion an animation shows."""
    name, motion = exported.path.name, exported.motion
    if exported.path.suffix.lower() != ANIMATION:
        return tr("{name} exported.", name=name)
    if motion is None:
        sentence = tr("{name} exported: the ideal motion, with connectors of no width.", name=name)
        why = tr("Not as cut: {reason}", reason=exported.not_as_cut)
        return f"{sentence} {why}" if exported.not_as_cut else sentence
    if motion.jams:
        return tr("{name} exported: as cut, it jams at {jam:.0f}°.", name=name, jam=math.degrees(motion.jam_phi))
    return tr("{name} exported: as cut, to {reached:.0f}°.", name=name, reached=math.degrees(motion.reached))


def message_of(path: Path, made: Planned, verdict: Verdict | None) -> Message:
    """Say what a written cut file holds, and whether cutting it would succeed; a coupon has no verdict."""
    plan, check = made.plan, made.report
    if verdict is not None and verdict.problems:
        sentence = tr(
            "{name} exported. {level}: {text}", name=path.name, level=verdict.level_words, text=verdict.problems[0].text
        )
        return Message(sentence, Tone.WARNING, "\n".join([str(path), *verdict.lines]))
    details = "\n".join([str(path), *(note.text for note in (*check.problems, *plan.notes))])
    if check.ok:
        name = tr("Folder “{name}”", name=path.name) if path.is_dir() else path.name
        count = len(plan.copies) * len(plan.paths)
        if made.removed_share:
            sentence = tr_n(
                "{name} exported and checked: {count} cut, trimmed outline, no faults.",
                "{name} exported and checked: {count} cuts, trimmed outline, no faults.",
                count,
                name=name,
            )
        else:
            sentence = tr_n(
                "{name} exported and checked: {count} cut, no faults.",
                "{name} exported and checked: {count} cuts, no faults.",
                count,
                name=name,
            )
        return Message(sentence, Tone.DONE, details)
    sentence = tr("{name} exported, but cutting it would fail: {text}", name=path.name, text=check.problems[0].text)
    return Message(sentence, Tone.WARNING, details)


def message_of_parts(path: Path, exported: ExportedFiles) -> Message:
    """Say what the files of all parts hold; the part that does worst decides."""
    name = tr("Folder “{name}”", name=path.name) if path.is_dir() else path.name
    lines = [str(path)]
    for part in exported.parts:
        lines += [part.part, *(() if part.verdict is None else part.verdict.lines)]
    found = [part for part in exported.parts if part.verdict is not None and part.verdict.problems]
    if found:
        worst = next((part for part in found if part.verdict == exported.verdict), found[0])
        assert worst.verdict is not None  # that is how they were found
        level, text = worst.verdict.level_words, worst.verdict.problems[0].text
        sentence = tr("{name} exported. {part}: {level}: {text}", name=name, part=worst.part, level=level, text=text)
        return Message(sentence, Tone.WARNING, "\n".join(lines))
    sentence = tr_n(
        "{name} exported and checked: {count} sheet, no faults.",
        "{name} exported and checked: {count} sheets, no faults.",
        len(exported.parts),
        name=name,
    )
    return Message(sentence, Tone.DONE, "\n".join(lines))


def message_of_pieces(path: Path, pieces: MadePieces, verdict: Verdict | None) -> Message:
    """Say which files of pieces were written, and whether they would work."""
    details = "\n".join([str(path), *(() if verdict is None else verdict.lines)])
    if verdict is not None and verdict.problems:
        level, text = verdict.level_words, verdict.problems[0].text
        sentence = tr("{name} exported. {level}: {text}", name=path.name, level=level, text=text)
        return Message(sentence, Tone.WARNING, details)
    assembly = pieces.made.assembly
    counts = {"name": path.name, "pieces": len(assembly.pieces), "pins": len(assembly.hinges)}
    if pieces.printing is not None:
        sentence = tr(
            "Folder “{name}” exported and checked: {pieces} pieces and {pins} joints to print, no faults.", **counts
        )
    else:
        sentence = tr(
            "Folder “{name}” exported and checked: {pieces} pieces, {pins} pins, {beds} beds, no faults.",
            beds=len(pieces.beds),
            **counts,
        )
    return Message(sentence, Tone.DONE, details)


class FabricationEditor:
    """Changes the numbers that the design is cut with, or says why it cannot.

    ``chosen`` gets the names of the fields that a person has set.
    """

    def __init__(self, session: Session, chosen: Callable[[Collection[str]], None]) -> None:
        self._session = session
        self._chosen = chosen

    def change(self, **changes: Unpack[FabricationChange]) -> None:
        """Change sheet, material, widths or what files are written for."""
        self._apply(lambda document: edits.set_fabrication(document, **changes))
        self._chosen(changes.keys())

    def set_opened_size(self, longer_mm: float) -> None:
        """Let the flat sheet be as wide as opens to a shape whose longer side is so long."""
        self._apply(lambda document: set_opened_size(document, longer_mm))
        self._chosen(("opened_mm",))

    def cut_at_drawn_size(self, longer_mm: float) -> None:
        """Let the flat sheet be as wide as opens to the size that the target was drawn with."""
        self._apply(lambda document: Edit(tr("Cut at the drawn size"), set_opened_size(document, longer_mm).document))

    def change_options(self, **changes: Unpack[OptionsChange]) -> None:
        """Change connector style, order or tabs."""
        self._apply(lambda document: edits.set_cut_options(document, **changes))

    def set_hinge_width(self, hinges: frozenset[int], width_mm: float) -> None:
        """Give connectors a width of their own."""
        if hinges:
            self._apply(lambda document: edits.set_hinge_width(document, hinges, width_mm))

    def remove_hinges(self, hinges: frozenset[int]) -> None:
        """Leave no connector at these hinges."""
        if hinges:
            self._apply(lambda document: edits.remove_hinges(document, hinges))

    def reset_hinges(self, hinges: frozenset[int]) -> None:
        """Give connectors the usual width again."""
        if hinges:
            self._apply(lambda document: edits.reset_hinges(document, hinges))

    def _apply(self, make: Callable[[Document], Edit]) -> None:
        try:
            edit = make(self._session.document)
        except KirigamiError as error:
            self._session.refuse(error)
        else:
            self._session.apply(edit)


class ProjectStock(QObject):
    """Compares machine and material that a project carries with the user's own."""

    added = Signal(str)  #: key of one that the user's own have by now

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session

    def compare(self, document: Document) -> None:
        """A project was opened: say where its machine or material is unknown or differs."""
        for stored, used in stored_values(document.fabrication):
            if used is None:
                keep = (tr(KEEP[type(stored)]), partial(self.keep, stored))
                sentence = tr(NOT_KNOWN[type(stored)], name=tr(stored.name))
                self._session.post(Message(sentence, Tone.WARNING, actions=(keep,)))
            elif (note := unlike(stored, used)) is not None:
                self._session.post(Message(note.text, Tone.WARNING, differences(stored, used)))

    def keep(self, stored: Machine | Material) -> None:
        """Save what a project carries among the user's own."""
        try:
            if isinstance(stored, Machine):
                MACHINES.save(stored)
            else:
                MATERIALS.save(stored)
        except KirigamiError as error:
            self._session.post(Message(str(error), Tone.ERROR))
            return
        self._session.set_status(tr(ADDED[type(stored)], name=stored.name))
        self.added.emit(stored.key)


def differences(stored: Machine | Material, used: Machine | Material) -> str:
    """One line for every entry in which two machines or materials differ."""
    theirs, ours = asdict(stored), asdict(used)
    return "\n".join(
        tr(
            "{entry}: {theirs} in the project, {ours} in yours",
            entry=name,
            theirs=_text(value),
            ours=_text(ours[name]),
        )
        for name, value in theirs.items()
        if value != ours[name]
    )


def _text(value: object) -> str:
    return number(value, "g") if isinstance(value, float) else str(value)
