"""The target: read from a file, traced, drawn, cleared; and the start outline that is read. Each becomes an edit."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections import OrderedDict
from collections.abc import Callable, Iterator
from dataclasses import replace
from enum import Enum
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Generic, TypeVar

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.second_target import USUAL_PHI, SecondTarget
from kirigami_studio.foundation.steps import Cancel, Steps
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.run.generation import DesignRun
from kirigami_studio.gui.run.target_reader import next_run
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.queue import JobCallbacks, LatestJob
from kirigami_studio.gui.session.session import Session
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.read import has_parts, is_picture
from kirigami_studio.outlines.starts import StartShape
from kirigami_studio.project import edits, target_parts
from kirigami_studio.project.document import Document
from kirigami_studio.project.edits import Edit
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.studio.parts import (
    DesignRead,
    PartsRead,
    reading_parts,
    reading_second,
    reading_source,
    reading_start,
)
from kirigami_studio.studio.targets import (
    Picture,
    PieceRead,
    TargetRead,
    checking_start,
    making_start,
    reading_target,
    tracing,
)

if TYPE_CHECKING:
    from kirigami_studio.outlines.read_image import Traced

T = TypeVar("T")
#: Outlines whose picture is remembered, so that undo brings its threshold back too.
CAPACITY = 256


class PictureTracer(QObject):
    """Traces one picture at a time; while it does, only the latest threshold is kept."""

    traced = Signal(Outline)
    refused = Signal(str)
    settled = Signal()  #: the drag is over and its last threshold is traced

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self.pictures: OrderedDict[Outline, Picture] = OrderedDict()
        self._job: LatestJob[Traced] = LatestJob(session.queue)
        self._wanted: Picture | None = None
        self._drag_over = False

    def remember(self, outline: Outline, picture: Picture) -> None:
        """Keep where an outline came from."""
        self.pictures[outline] = picture
        self.pictures.move_to_end(outline)
        while len(self.pictures) > CAPACITY:
            self.pictures.popitem(last=False)

    def picture_of(self, outline: Outline | None) -> Picture | None:
        """The picture behind an outline, None when it was drawn, chosen from the library or read as lines."""
        return None if outline is None else self.pictures.get(outline)

    def retrace(self, picture: Picture, threshold: float | None) -> None:
        """Trace a picture at another threshold (0 black .. 1 white), None for the automatic one."""
        self._wanted = replace(picture, threshold=picture.automatic if threshold is None else threshold)
        if not self._job.busy:
            self._start(self._wanted)

    def end_drag(self) -> None:
        """The slider was let go; its last threshold may still be on its way."""
        self._drag_over = True
        self._settle()

    def stop(self) -> None:
        """Forget what is still being traced: the target is another one now."""
        self._wanted, self._drag_over = None, False
        self._job.stop()

    def _start(self, picture: Picture) -> None:
        callbacks: JobCallbacks[Traced] = JobCallbacks(
            partial(self._on_result, picture), partial(self._go_on, picture), on_failed=partial(self._fail, picture)
        )
        self._job.start(tr("tracing {name}", name=picture.path.name), partial(tracing, picture), callbacks)

    def _on_result(self, picture: Picture, traced: Traced) -> None:
        self.remember(traced.outline, replace(picture, traced=traced))
        self.traced.emit(traced.outline)

    def _fail(self, picture: Picture, sentence: str, trace: str) -> None:
        self.refused.emit(sentence)
        self._go_on(picture)

    def _go_on(self, done: Picture) -> None:
        """Trace again when the slider has moved on in the meantime."""
        if self._wanted is not None and self._wanted != done:
            self._start(self._wanted)
        else:
            self._settle()

    def _settle(self) -> None:
        if self._drag_over and not self._job.busy:
            self._drag_over = False
            self.settled.emit()


class ReadReason(Enum):
    """Why a target is read: at the start, at a wish, or for other parts of the present one."""

    START = "start"
    WANTED = "wanted"
    AGAIN = "again"


class SourceReader(QObject):
    """Reads one target at a time and registers the picture or drawing that it came from.

    A drawing with several parts is a question first: :attr:`choice_wanted` is answered by :meth:`take_chosen`.
    """

    read = Signal(Outline, ReadReason)
    pieces_read = Signal(object, ReadReason)  #: several of :class:`PieceRead`, each a sheet of its own
    choice_wanted = Signal(PartsRead)
    design_read = Signal(Document, str)  #: that a cut file came from, and the file
    failed = Signal(str, str)  #: sentence, trace

    def __init__(self, session: Session, tracer: PictureTracer, parent: QObject) -> None:
        super().__init__(parent)
        self._tracer = tracer
        self._job = LatestJob[TargetRead | PartsRead | DesignRead](session.queue)
        self.drawings: OrderedDict[Outline, str] = OrderedDict()
        self._asked = ("", ReadReason.WANTED)
        self.source = ""  #: of the target that was read last

    def start(self, source: str, reason: ReadReason) -> None:
        """Read a file, or a silhouette of the library by name."""
        self._start(source, reason, partial(reading_source, source))

    def choose_again(self, outline: Outline) -> None:
        """Read the drawing again that an outline came from, and ask for its parts."""
        source = self.drawing_of(outline)
        if source:
            self._start(source, ReadReason.AGAIN, partial(reading_parts, source))

    def drawing_of(self, outline: Outline | None) -> str:
        """The drawing that an outline was read from, "" for none."""
        return "" if outline is None else self.drawings.get(outline, "")

    def take_chosen(self, outline: Outline, usual: bool) -> None:
        """Take the outline that was made of chosen parts; of a picture the usual one has its threshold again."""
        source, reason = self._asked
        if usual and is_picture(Path(source)):
            self._start(source, reason, partial(reading_target, source))
            return
        self._finish(*self._asked, TargetRead(outline))

    def take_pieces(self, pieces: tuple[PieceRead, ...]) -> None:
        """Take the pieces of a drawing, each a sheet of its own."""
        source, reason = self._asked
        for piece in pieces:
            self._remember(source, piece.outline)
        self.source = source
        self.pieces_read.emit(pieces, reason)

    def _start(self, source: str, reason: ReadReason, steps: Steps[TargetRead | PartsRead | DesignRead]) -> None:
        callbacks = JobCallbacks(partial(self._on_result, source, reason), on_failed=self.failed.emit)
        self._job.start(tr("reading {name}", name=Path(source).name), steps, callbacks)

    def stop(self) -> None:
        """Forget what is still being read: something else took its place."""
        self._job.stop()

    def _on_result(self, source: str, reason: ReadReason, found: TargetRead | PartsRead | DesignRead) -> None:
        if isinstance(found, PartsRead):
            self._asked = (source, reason)
            self.choice_wanted.emit(found)
        elif isinstance(found, DesignRead):
            self.design_read.emit(found.document, source)
        else:
            self._finish(source, reason, found)

    def _finish(self, source: str, reason: ReadReason, found: TargetRead) -> None:
        if has_parts(Path(source)):
            self._remember(source, found.outline)
        if found.picture is not None:
            self._tracer.remember(found.outline, found.picture)
        self.source = source
        self.read.emit(found.outline, reason)

    def _remember(self, source: str, outline: Outline) -> None:
        self.drawings[outline] = source
        while len(self.drawings) > CAPACITY:
            self.drawings.popitem(last=False)


class OutlineReader(QObject, Generic[T]):
    """Reads an outline beside the target: a name, a file or a drawing; the newest wins.

    Why one was refused is said until another one is read, or chosen elsewhere.
    """

    choice_wanted = Signal(PartsRead)  #: answered by :meth:`take_chosen`

    def __init__(
        self, session: Session, reading: Callable[[str, Cancel], Iterator[T | PartsRead]], parent: QObject
    ) -> None:
        super().__init__(parent)
        self._session, self._reading = session, reading
        self._job = LatestJob[T | PartsRead](session.queue)
        self._refusal: Message | None = None

    def open(self, source: str) -> None:
        """Read a file, or a silhouette of the library by name."""
        self.read(tr("reading {name}", name=Path(source).name), partial(self._reading, source))

    def read(self, name: str, steps: Steps[T | PartsRead]) -> None:
        """Read it in the worker; ``name`` follows the word "while" in messages."""
        self.stop()
        self._job.start(name, steps, JobCallbacks(self._on_read, on_failed=self._refuse))

    def stop(self) -> None:
        """Forget what is still being read, and why the last one was refused: something else took its place."""
        self._job.stop()
        if self._refusal is not None:
            self._session.withdraw(self._refusal)
            self._refusal = None

    def take_chosen(self, outline: Outline, usual: bool) -> None:
        """Take the outline that was made of chosen parts, the usual one or another."""
        self.take(outline)

    @abstractmethod
    def take(self, outline: Outline) -> None:
        """Take a shape that was drawn, or made of chosen parts."""

    @abstractmethod
    def use(self, found: T) -> None:
        """Bring into the document what was read."""

    def _on_read(self, found: T | PartsRead) -> None:
        if isinstance(found, PartsRead):
            self.choice_wanted.emit(found)
        else:
            self.use(found)

    def _refuse(self, sentence: str, trace: str) -> None:
        self._refusal = Message(sentence, Tone.ERROR, trace)
        self._session.report_failure(sentence, trace)


class StartReader(OutlineReader[StartShape]):
    """Reads the outline that sheets are to have while they are flat; a shape that cannot be one changes nothing."""

    checked = Signal(Outline, str)  #: a shape that is being drawn, and why the next run would refuse it, or ""

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(session, reading_start, parent)
        self._check = LatestJob[str](session.queue)

    def check(self, outline: Outline) -> None:
        """Find out whether the next run would refuse a shape that is being drawn."""
        document = self._session.document
        steps = partial(checking_start, outline, document.settings, next_run(document))
        callbacks: JobCallbacks[str] = JobCallbacks(partial(self.checked.emit, outline))
        self._check.start(tr("checking the start"), steps, callbacks)

    def take(self, outline: Outline) -> None:
        self.read(tr("reading the start"), partial(making_start, outline))

    def use(self, found: StartShape) -> None:
        self._session.apply(edits.set_settings(self._session.document, start=found))
        self._session.history.end_drag()
        self._session.set_status(tr("Sheets start as {name}. Press Generate (Ctrl+G).", name=found.name))


class SecondReader(OutlineReader[TargetRead]):
    """Reads the second target; it is shown at the angle, and with the weight, of the one before."""

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(session, reading_second, parent)

    def use(self, found: TargetRead) -> None:
        self.take(found.outline)

    def take(self, outline: Outline) -> None:
        self.stop()
        session, settings = self._session, self._session.document.settings
        session.apply(edits.set_settings(session.document, second=second_for(settings, outline)))
        session.history.end_drag()
        session.set_status(tr("Sheets pass {name} on their way. Press Generate (Ctrl+G).", name=outline.name))


def second_for(settings: DesignSettings, outline: Outline) -> SecondTarget:
    """A second target as the settings have it, with another outline; the first is shown at the usual angle, or halfway
    to the target's where the sheet does not come so far.
    """
    if settings.second is not None:
        return replace(settings.second, outline=outline)
    phi = USUAL_PHI if settings.phi < USUAL_PHI else 0.5 * (settings.phi + math.pi)
    return SecondTarget(outline, phi)


class Targeting(QObject):
    """Reads and traces targets in the worker; every gesture on the target passes here."""

    replaced = Signal()  #: another target is there, or none
    source_read = Signal(str)  #: where a target was read from
    question_wanted = Signal(Outline)  #: it would take the place of what was drawn by hand

    def __init__(self, session: Session, run: DesignRun, stop_work: Callable[[], None], parent: QObject) -> None:
        super().__init__(parent)
        self._session, self._run, self._stop_work = session, run, stop_work
        self.on_board: Callable[[Outline], Outline] = lambda outline: outline  #: gives a contour its size on the board
        self.tracer = PictureTracer(session, self)
        self.reader = SourceReader(session, self.tracer, self)
        self.reader.read.connect(self._on_read)
        self.reader.pieces_read.connect(self._on_pieces)
        self.reader.failed.connect(session.report_failure)
        self.tracer.traced.connect(self._on_traced)
        self.tracer.refused.connect(session.set_status)
        self.tracer.settled.connect(session.history.end_drag)

    def remember_sources(self, earlier: Targeting) -> None:
        """Know the pictures and drawings that the targets of an earlier window were read from."""
        self.tracer.pictures.update(earlier.tracer.pictures)
        self.reader.drawings.update(earlier.reader.drawings)

    def stop(self) -> None:
        """Forget what is still being read or traced."""
        self.reader.stop()
        self.tracer.stop()

    def open(self, source: str, reason: ReadReason = ReadReason.WANTED) -> None:
        """Read a file, or a silhouette of the library by name."""
        self._session.set_status(tr("Reading {name} …", name=Path(source).name))
        self.reader.start(source, reason)

    def choose_parts(self) -> None:
        """Ask again for the parts of the drawing that the target was read from."""
        target = self._session.document.target
        if target is not None:
            self.reader.choose_again(target)

    def start_with(self, source: str) -> None:
        """Read the first target; in an untouched project it is where the history starts, no change to be undone."""
        self.open(source, ReadReason.START)

    def change_threshold(self, threshold: float | None) -> None:
        """Trace the target's picture again at another grey level, 0..1; None for the automatic one."""
        picture = self.tracer.picture_of(self._session.document.target)
        if picture is not None:
            self.tracer.retrace(picture, threshold)

    def change_holes(self, filled: bool, gesture: str) -> None:
        """Fill the target's holes or open them, by a gesture as it follows the word Undo."""
        target = self._session.document.target
        if target is not None:
            made = self._known_as(target, target.with_holes(filled))
            self.reshape(edits.edit_target(self._session.document, made, gesture))

    def _known_as(self, outline: Outline, made: Outline) -> Outline:
        """The same outline with other holes open, of the same picture or drawing."""
        if (picture := self.tracer.picture_of(outline)) is not None:
            self.tracer.remember(made, picture)
        if source := self.reader.drawing_of(outline):
            self.reader.drawings[made] = source
        return made

    def reshape(self, edit: Edit) -> None:
        """Take an edit of the target that was made by drawing."""
        self._replace(edit)
        self._session.set_status(tr("Done: {label}.", label=edit.label))

    def clear(self) -> None:
        """Start over with an empty target."""
        document = self._session.document
        if document.target is not None:
            cleared = replace(edits.without_designs(document, None), **edits.ALONE)
            self._replace(Edit(tr("Clear target"), cleared))
            self._session.set_status(tr("Target cleared. Undo restores it."))

    def _replace(self, edit: Edit) -> None:
        """Take another target; all work for the old one is pointless now."""
        self._apply(edit, self._stop_work)
        self.replaced.emit()

    def _apply(self, edit: Edit, stop: Callable[[], None]) -> None:
        session, was_running = self._session, self._run.running
        before = session.document
        stop()
        session.apply(edit)
        if was_running and session.document is before:  # the run's designs must not stay in sight
            session.display.show()

    def _on_traced(self, outline: Outline) -> None:
        before = self._session.document.target
        if before is not None and (before.holes or before.filled_holes):  # filled or open as they were
            outline = self._known_as(outline, outline.with_holes(not before.holes))
        edit = edits.edit_target(self._session.document, self.on_board(outline), tr("Change threshold"))
        self._apply(edit, self._run.abandon)
        self._session.set_status(tr("{count} points at this threshold.", count=len(outline.points)))

    def _on_read(self, outline: Outline, reason: ReadReason) -> None:
        document, history = self._session.document, self._session.history
        untouched = document.target is None and self._session.path is None and not history.steps
        if reason is ReadReason.START and untouched:
            document = replace(edits.as_drawn(document, outline), target=outline)
            self._session.restart(document, self._session.path)
            self.source_read.emit(self.reader.source)
            said = tr("Target: {name}. Press Generate (Ctrl+G), or choose another target.", name=outline.name)
            self._session.set_status(said)
        elif document.drawing or (document.drawn_by_hand and reason is not ReadReason.AGAIN):
            self._session.set_status(tr("Read {name}. Nothing has changed yet.", name=tr(outline.name)))
            self.question_wanted.emit(outline)
        else:
            self.set_target(outline)

    def _on_pieces(self, pieces: tuple[PieceRead, ...], reason: ReadReason) -> None:
        """Take the pieces of a drawing as a target of several parts."""
        self._replace(target_parts.set_parts(self._session.document, [(one.outline, one.place) for one in pieces]))
        self.source_read.emit(self.reader.source)
        names = ", ".join(one.outline.name for one in pieces)
        said = tr("Target: {names}. Press Generate (Ctrl+G) to design a sheet for each part.", names=names)
        self._session.set_status(said)

    def set_target(self, outline: Outline) -> None:
        """Take a target that was read in the place of the present one."""
        self._replace(edits.set_target(self._session.document, outline))
        self.source_read.emit(self.reader.source)
        said = tr("Target: {name}. Press Generate (Ctrl+G) to design a sheet for it.", name=outline.name)
        self._session.set_status(said)
