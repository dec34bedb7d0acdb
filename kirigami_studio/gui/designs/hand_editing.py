"""Changing the chosen design by hand: what is seen follows the hand at once, the document takes each gesture scored.

A gesture makes a draft: another ratio field, decoded exactly and shown in the place of the design.  When the gesture
ends, the worker scores the draft; with the score comes one named edit.  Gestures that follow meanwhile go on from the
draft and wait for their turn, so that each becomes a step of its own.  Undo, save and the like wait for the last score.

A vertex of the outline follows the hand in a thread of its own (:mod:`outline_drag`) and may still be on its way when
the hand has let go: what the hand does next is carried out when it has arrived.
"""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial, wraps
from typing import Concatenate, ParamSpec

import numpy as np
from PySide6.QtCore import QObject, QTimer, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.gui.designs.design_cache import DesignCache
from kirigami_studio.gui.designs.hand_pull import LARGEST, SMALLEST, Pull
from kirigami_studio.gui.designs.outline_drag import OutlineDrag
from kirigami_studio.gui.jobs import hand_steps
from kirigami_studio.gui.jobs.drag_steps import Followed, Grasp
from kirigami_studio.gui.jobs.queue import JobCallbacks, JobQueue, LatestJob
from kirigami_studio.gui.jobs.steps import Decoded
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.project import edits
from kirigami_studio.project.document import Document, Void


def ratio_label(void: Void, count: int) -> str:
    """How a change of ``count`` ratios is named; ``void`` is the only one, or one of them."""
    if count > 1:
        return tr_n("Change ratio of {count} void", "Change ratio of {count} voids", count)
    row, column = void
    return tr("Change ratio of void ({row}, {column})", row=row, column=column)


def locked_sentence(count: int) -> str:
    """Why nothing happens to ``count`` voids."""
    return tr_n(
        "{count} void is locked. Unlock it (L) to change its ratio.",
        "{count} voids are locked. Unlock them (L) to change their ratios.",
        count,
    )


def score_sentence(label: str, before: Candidate, after: Candidate) -> str:
    """What a change has done to the match, and what it has cost."""
    gain = 100.0 * (after.score.siou - before.score.siou)
    told = tr("{gesture}: sIoU {siou:.1f} % ({gain:+.2f}).", gesture=label, siou=100 * after.score.siou, gain=gain)
    if not after.score.feasible:
        told = tr("{told} The design is not feasible.", told=told)
    if before.trim is not None:
        told = tr("{told} Trim removed; trim again when you are done.", told=told)
    return told


#: Milliseconds after the last notch of the wheel, or the last press of a key, that end the gesture.
PAUSE_MS = 250
#: Seconds after a notch, or a press, within which the next one on the same voids joins its undo step, scored or not.
JOINS_WITHIN = 1.0


P = ParamSpec("P")
Gesture = Callable[Concatenate["HandEditing", P], None]


def _in_turn(gesture: Gesture[P]) -> Gesture[P]:
    """Carry a gesture out at once, or when the outline has arrived that the hand has let go of before."""

    @wraps(gesture)
    def take(hand: HandEditing, /, *args: P.args, **kwargs: P.kwargs) -> None:
        if not hand.defers(partial(take, hand, *args, **kwargs)):
            gesture(hand, *args, **kwargs)

    return take


@dataclass(frozen=True, slots=True)
class _Gesture:
    """A draft that waits for its score."""

    field: RatioField
    label: str
    merge_key: str | None


class HandEditing(QObject):
    """Owns the draft of one design, and hands over an edit for each gesture."""

    drafted = Signal(object)  #: PosedDesign to be shown in the design's place
    edited = Signal(object)  #: Edit
    settled = Signal()  #: every gesture has become an edit
    failed = Signal(str, str)  #: sentence, trace
    status = Signal(str)

    def __init__(self, queue: JobQueue, cache: DesignCache, document: Callable[[], Document], parent: QObject) -> None:
        super().__init__(parent)
        self._cache, self._document = cache, document
        self._slot = LatestJob(queue)
        self._base: Candidate | None = None  # as the document holds it
        self._field: RatioField | None = None  # as it is seen
        self._last: RatioField | None = None  # as the last complete gesture left it
        self._open: str | None = None  # label of the gesture under way
        self._turned: tuple[tuple[Void, ...], float] = ((), -math.inf)  # what the wheel or a key changed last, and when
        self._turns = 0
        self._key: str | None = None  # merges the gesture under way with the one before it
        self._waiting: deque[_Gesture] = deque()
        self._wishes: list[Callable[[], object]] = []
        self._pull: Pull | None = None
        self._outline = OutlineDrag(self)
        self._outline.followed.connect(self._follow)
        self._outline.ended.connect(self._arrive)
        self._outline.failed.connect(self._fail)
        self._grasped: Candidate | None = None  # the document's design since a vertex was taken hold of
        self._seen: PosedDesign | None = None  # the draft, where the outline's thread has decoded it
        self._later: deque[Callable[[], None]] = deque()
        self._pause = QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._pause.timeout.connect(self.commit)

    # what is there -------------------------------------------------------------------------------------------------

    @property
    def busy(self) -> bool:
        """Whether a gesture is under way or waits for its score."""
        return self._base is not None or self._outline.active

    @property
    def field(self) -> RatioField | None:
        """The ratios as they are seen."""
        candidate = self._document().candidate
        return self._field if self._field is not None else None if candidate is None else candidate.final_field

    def postpones(self, wish: Callable[[], object]) -> bool:
        """Whether a wish must wait until all gestures are in the document; it is then carried out by itself."""
        self.commit()
        if not self.busy:
            return False
        self._wishes.append(wish)
        return True

    def defers(self, act: Callable[[], None]) -> bool:
        """Whether an act of the hand must wait until the outline has arrived; it is then carried out by itself."""
        if self._outline.arriving:
            self._later.append(act)
        return self._outline.arriving

    def stop(self) -> None:
        """Another document comes: forget what belongs to the old one."""
        self._slot.stop()
        self._waiting.clear()
        self._wishes.clear()
        self._later.clear()
        self._put_down()
        self._over()

    def close(self) -> None:
        """The window is going away."""
        self._outline.close()

    # ratios --------------------------------------------------------------------------------------------------------

    @_in_turn
    def nudge(self, voids: frozenset[Void], step: float) -> None:
        """Change the log10 of ratios by ``step``; steps that follow one another soon undo together."""
        free = self._free(voids)
        if free and self.field is not None:
            self._turns += not self._goes_on(tuple(free))
            key = f"turn {self._turns}"
            self._change({void: float(self.field.ratio[void]) * math.pow(10.0, step) for void in free}, key)
            self._pause.start()

    def _goes_on(self, voids: tuple[Void, ...]) -> bool:
        """Whether a notch on these voids continues the one before it."""
        (before, when), now = self._turned, time.monotonic()
        self._turned = voids, now
        return voids == before and now - when <= JOINS_WITHIN

    @_in_turn
    def set_ratio(self, voids: frozenset[Void], ratio: float) -> None:
        """Give voids a ratio, as typed."""
        free = self._free(voids)
        if free:
            self._change(dict.fromkeys(free, ratio))
            self._pause.start()

    @_in_turn
    def begin_pull(self, void: Void, place: tuple[float, float], phi: float) -> None:
        """Take hold of a void at a place in the world."""
        self._begin_drag()
        design = self._design()
        if self._free(frozenset({void})) and design is not None:
            self._pull = Pull.of(design, void, place, phi)

    @_in_turn
    def pull(self, place: tuple[float, float]) -> None:
        """The hand has moved to a place in the world; the void follows."""
        if self._pull is not None:
            self._change({self._pull.void: self._pull.ratio_at(place)})

    def _free(self, voids: frozenset[Void]) -> list[Void]:
        """Those that may be changed; when none may, the status line says why."""
        document = self._document()
        if document.candidate is None or not voids:
            return []
        free = sorted(voids - document.locked)
        if not free:
            self.status.emit(locked_sentence(len(voids)))
        return free

    def _change(self, wanted: dict[Void, float], merge_key: str | None = None) -> None:
        """Give voids new ratios within the bounds; one that lay beyond them before may stay there."""
        field = self.field
        if field is None:
            return
        table = field.ratio.copy()
        for void, ratio in wanted.items():
            table[void] = min(max(ratio, min(SMALLEST, table[void])), max(LARGEST, table[void]))
        first = min(wanted)
        label = ratio_label(first, len(wanted))
        self._draft(RatioField(table), label, merge_key)
        self.status.emit(tr("{gesture}: x {ratio:.3f}", gesture=label, ratio=float(table[first])))

    def lock(self, voids: frozenset[Void], on: bool) -> None:
        """Lock voids against changes by hand, or unlock them."""
        if voids and not self.postpones(lambda: self.lock(voids, on)):
            self.edited.emit(edits.lock_voids(self._document(), voids, on))

    def lock_all(self, on: bool) -> None:
        """Lock every void, or none."""
        if not self.postpones(lambda: self.lock_all(on)):
            self.edited.emit(edits.lock_all(self._document(), on))

    # the outline ---------------------------------------------------------------------------------------------------

    @_in_turn
    def begin_vertex(self, vertex: int, phi: float) -> None:
        """Take hold of a vertex of the outline at the angle that is shown."""
        self._begin_drag()
        design, document = self._design(), self._document()
        if design is None or phi >= math.pi:
            self.status.emit(tr("The flat sheet is always a rectangle. Open it to move its outline."))
            return
        held = np.zeros(design.deployment.field.ratio.shape, dtype=np.bool_)
        for void in document.locked:
            held[void] = True
        self._grasped = document.candidate
        self._outline.begin(Grasp(design, phi, vertex, held))
        self.status.emit(tr("Preparing the outline …"))

    @_in_turn
    def move_vertex(self, place: tuple[float, float]) -> None:
        """The hand has moved to a place in the world; the newest place wins."""
        self._outline.move(place)

    def _follow(self, found: Followed) -> None:
        """The outline has come a step nearer to the hand."""
        if self._document().candidate != self._grasped:  # something else has changed the design meanwhile
            self._put_down()
            self._arrive()
            return
        self._seen = found.design
        self._draft(found.design.deployment.field, tr("Move outline"))
        if found.arrived:
            self.status.emit(tr("The outline follows the pointer."))
        elif found.stuck:
            self.status.emit(
                tr("The outline can't reach that far: ratio limits, locked voids or panel collisions block it.")
            )

    def _arrive(self) -> None:
        """The outline is where the hand has let go of it; now comes what the hand has done since."""
        later, self._later = self._later, deque()
        self.commit()
        for act in later:
            act()
        if not self.busy:
            self._over()

    def _begin_drag(self) -> None:
        self.commit()
        self._put_down()

    def _put_down(self) -> None:
        """Nothing is in the hand."""
        self._pull = None
        self._outline.stop()

    @_in_turn
    def let_go(self) -> None:
        """The hand has let go: the gesture is complete, for an outline when it has arrived."""
        if self._outline.active:
            self._outline.let_go()
        else:
            self.commit()

    @_in_turn
    def take_back(self) -> None:
        """The gesture under way never was."""
        self._pause.stop()
        self._put_down()
        if self._open is None:
            return
        self._field, self._open = self._last, None
        if not self._slot.busy:
            self._restore()
        else:
            self._show_draft()
        self.status.emit(tr("Drag cancelled."))

    # drafts and edits ----------------------------------------------------------------------------------------------

    def _draft(self, field: RatioField, label: str, merge_key: str | None = None) -> None:
        candidate = self._document().candidate
        if candidate is None or field == self.field:
            return
        if self._open is not None and self._open != label:
            self.commit()
        if self._base is None:
            self._base, self._last = candidate, candidate.final_field
        if self._open is None:
            self._key = merge_key
        self._field, self._open = field, label
        self._show_draft()

    def _design(self) -> PosedDesign | None:
        """The design as it is seen: at the pose that it was scored in, until it is scored anew."""
        candidate = self._base or self._document().candidate
        if candidate is None or self.field is None:
            return None
        if self._field is None and candidate.trim is None:
            return self._cache.entry(candidate).design
        if self._seen is not None and self._seen.deployment.field is self._field:
            return self._seen
        return PosedDesign(deploy(self.field), candidate.final_pose, candidate.final_phi)

    def _show_draft(self) -> None:
        design = self._design()
        if design is not None and self._document().candidate == self._base:
            self.drafted.emit(design)

    def commit(self) -> None:
        """The gesture is complete; what follows is another one."""
        if self._outline.arriving:  # it becomes complete by itself
            return
        self._pause.stop()
        self._put_down()
        if self._open is None or self._field is None:
            return
        gesture, self._open = _Gesture(self._field, self._open, self._key), None
        if gesture.field != self._last:
            self._last = gesture.field
            if gesture.merge_key is not None and self._waiting and self._waiting[-1].merge_key == gesture.merge_key:
                self._waiting.pop()  # it would be one step with this one
            self._waiting.append(gesture)
            self._score_next()
        elif not self._slot.busy:  # back where it began
            self._restore()

    def _score_next(self) -> None:
        target = self._document().target
        if self._slot.busy or not self._waiting or self._base is None or target is None:
            return
        gesture = self._waiting.popleft()
        work = partial(hand_steps.scoring, self._base, gesture.field, target)
        callbacks = JobCallbacks(partial(self._take, gesture), on_failed=self._fail)
        self._slot.start(tr("scoring the change"), work, callbacks)

    def _take(self, gesture: _Gesture, report: object) -> None:
        self._slot.stop()  # the report is the end
        before = self._base
        if not isinstance(report, Decoded) or before is None:
            return
        edit = edits.take_changed(self._document(), before, report.candidate, gesture.label, gesture.merge_key)
        if edit is None:
            self._restore()
            return
        self._cache.put(report.candidate, report.deployment)
        self._base = self._grasped = report.candidate
        self.edited.emit(edit)
        self.status.emit(score_sentence(gesture.label, before, report.candidate))
        if self._waiting or self._open is not None:
            self._show_draft()
            self._score_next()
        else:
            self._over()

    def _fail(self, sentence: str, trace: str) -> None:
        self._restore()
        self.failed.emit(sentence, trace)

    def _restore(self) -> None:
        """Drop the draft and show the design as the document has it."""
        wishes = self._wishes
        self._wishes = []
        self.stop()
        candidate = self._document().candidate
        if candidate is not None:
            self.drafted.emit(self._cache.entry(candidate).design)
        for wish in wishes:
            wish()

    def _over(self) -> None:
        """Nothing is under way any more; wishes that waited for this are carried out."""
        self._pause.stop()
        self._base = self._field = self._last = self._open = self._seen = None
        wishes, self._wishes = self._wishes, []
        self.settled.emit()
        for wish in wishes:
            wish()
