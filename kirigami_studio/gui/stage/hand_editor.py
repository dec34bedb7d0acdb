"""Editing the chosen design by hand: the view follows the pointer at once, the document takes each gesture scored.

A gesture makes a draft: another sheet, decoded exactly and shown instead of the design.  A dragged void slides
one of its corners along its slit (:class:`VoidDrag`), a dragged edge cut slides along its side of the sheet
(:class:`~kirigami_studio.gui.stage.edge_cuts.MouthDrag`).  When the gesture ends, the worker scores the draft, and the
score makes one named edit.  Gestures that follow meanwhile start from the draft and wait for their turn, so that each
becomes an undo step of its own.  Undo, save and the like wait for the last score.

A vertex of the outline follows the pointer in a thread of its own (:mod:`outline_drag`) and may still be on its way
after the release: what the user does next is carried out when it has arrived.
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
from kirigami_studio.evaluate.pins import kept_apart
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.foundation.steps import Cancel, single
from kirigami_studio.foundation.words import mark, tr, tr_n
from kirigami_studio.gui.session.queue import JobCallbacks, LatestJob
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.stage.edge_cuts import MouthDrag, MouthFacts, holds_corner, moved, with_sheet
from kirigami_studio.gui.stage.outline_drag import DragStart, DragStep, OutlineDrag
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Rim, Sheet, replace_sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project import edits
from kirigami_studio.project.document import Void
from kirigami_studio.project.sheet_size import cut_for
from kirigami_studio.settings.fabrication import FabricationSettings, is_pinned
from kirigami_studio.studio.designing import Decoded, decoded, least_gap_of


def ratio_label(void: Void, count: int) -> str:
    """How a change of ``count`` ratios is named; ``void`` is the only one, or one of them."""
    if count > 1:
        return tr_n("Change ratio of {count} void", "Change ratio of {count} voids", count)
    row, column = void
    return tr("Change ratio of the void in row {row}, column {column}", row=row, column=column)


def locked_sentence(count: int) -> str:
    """Why nothing happens to ``count`` voids."""
    return tr_n(
        "{count} void is locked. Unlock it (L) to change its ratio.",
        "{count} voids are locked. Unlock them (L) to change their ratios.",
        count,
    )


def score_sentence(label: str, before: Candidate, after: Candidate) -> str:
    """What a change has done to the match, and what it has cost."""
    match, gain = 100.0 * after.match, 100.0 * (after.match - before.match)
    sentences = [tr("{gesture}: match {match:.1f} % ({gain:+.2f}).", gesture=label, match=match, gain=gain)]
    if not after.score.feasible:
        sentences.append(tr("Panels overlap or touch while it opens."))
    if before.trim is not None:
        again = (
            tr("It is trimmed again.")
            if after.trim is not None
            else tr("Trim removed: it cannot be trimmed like this.")
        )
        sentences.append(again)
    return " ".join(sentences)


#: Why a gesture goes no further.
PINS_STOP_IT = mark(
    "It stops here, where pins are as near to each other as their ears allow, or necks between their ears as narrow."
)
#: Ratios that can be given by hand, the same as those of the generator and the fits.
SMALLEST, LARGEST = 10.0**-LOG_RATIO_LIMIT, 10.0**LOG_RATIO_LIMIT
#: Share of a slit by which the motion of a void's corners is measured.
PROBE = 0.02
#: Corners that move less than this share of the one that moves most are not dragged.
MOVES_ENOUGH = 0.6
#: Least motion (lengths of the world per whole slit) that is believed, in cells of the sheet.
LEAST = 0.25
#: Milliseconds after the last notch of the wheel, or the last press of a key, that end the gesture.
PAUSE_MS = 250
#: Seconds after a notch, or a press, within which the next one on the same voids joins its undo step, scored or not.
JOINS_WITHIN = 1.0


P = ParamSpec("P")
Gesture = Callable[Concatenate["HandEditor", P], None]


def _after_arrival(gesture: Gesture[P]) -> Gesture[P]:
    """Carry a gesture out at once, or when the outline that was released before has arrived."""

    @wraps(gesture)
    def take(hand: HandEditor, /, *args: P.args, **kwargs: P.kwargs) -> None:
        if not hand.defers(partial(take, hand, *args, **kwargs)):
            gesture(hand, *args, **kwargs)

    return take


@dataclass(frozen=True, slots=True, eq=False)
class VoidDrag:
    """A void that is being dragged.

    Its corner slides along its slit with the share s = x / (1 + x), so a motion of the mouse along the slit is a
    change of s.
    """

    void: Void
    place: tuple[float, float]  #: (x, y), world; where the drag began
    share: float  #: s at that time
    motion: FloatArray  #: (2,), world; how far the dragged corner moves when s goes from 0 to 1, to first order
    corner: int  #: which corner, 0..3, is dragged

    @classmethod
    def of(cls, design: PosedDesign, void: Void, place: tuple[float, float], phi: float) -> VoidDrag:
        """Begin to drag a void by the nearest of the corners that move."""
        field = design.deployment.field
        share = share_of(float(field.ratio[void]))
        low, high = max(share - PROBE, share_of(SMALLEST) / 2), min(share + PROBE, (1 + share_of(LARGEST)) / 2)
        motion = (_corners(design, void, high, phi) - _corners(design, void, low, phi)) / (high - low)
        here = _corners(design, void, share, phi)
        length = np.hypot(*motion.T)
        distance = np.hypot(*(here - place).T)
        distance[length < MOVES_ENOUGH * length.max()] = np.inf
        corner = int(distance.argmin())
        least = LEAST * design.pose.scale
        return cls(void, place, share, motion[corner] * max(1.0, least / max(float(length[corner]), 1e-12)), corner)

    def ratio_at(self, place: tuple[float, float]) -> float:
        """The ratio when the pointer is at a place in the world; within the bounds."""
        moved = np.subtract(place, self.place)
        share = self.share + float(moved @ self.motion) / max(float(self.motion @ self.motion), 1e-18)
        share = min(max(share, share_of(SMALLEST)), share_of(LARGEST))
        return share / (1.0 - share)


def share_of(ratio: float) -> float:
    """s = x / (1 + x): how far along its slit a void's corner lies."""
    return ratio / (1.0 + ratio)


def _corners(design: PosedDesign, void: Void, share: float, phi: float) -> FloatArray:
    """Corners (4, 2) of a void in the world, if its ratio were that of ``share``."""
    table = design.deployment.field.ratio.copy()
    table[void] = share / (1.0 - share)
    changed = PosedDesign(deploy(design.deployment.sheet.with_field(RatioField(table))), design.pose, design.phi_target)
    corners: FloatArray = changed.nodes(phi)[changed.deployment.topology.void_nodes[void]]
    return corners


@dataclass(frozen=True, slots=True)
class _Gesture:
    """A draft that waits for its score."""

    sheet: Sheet
    label: str
    merge_key: str | None


def _rescored(candidate: Candidate, sheet: Sheet, target: Outline, cancel: Cancel) -> Decoded:
    """Score a candidate with another sheet; runs in the worker, which may take its time to import."""
    from kirigami_studio.pipeline.redesign import rescored

    return decoded(rescored(candidate, sheet, target))


class HandEditor(QObject):
    """Owns the draft of one design, and makes one edit of each gesture."""

    drafted = Signal(PosedDesign)  #: to be shown instead of the design
    settled = Signal()  #: every gesture has become an edit

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._job = LatestJob[Decoded](session.queue)
        self._base: Candidate | None = None  # as the document holds it
        self._sheet: Sheet | None = None  # as it is shown
        self._last: Sheet | None = None  # as the last complete gesture left it
        self._open: str | None = None  # label of the gesture under way
        self._last_turn: tuple[object, float] = (None, -math.inf)  # what the wheel or a key changed last, and when
        self._turns = 0
        self._key: str | None = None  # merges the gesture under way with the one before it
        self._waiting: deque[_Gesture] = deque()
        self._postponed: list[Callable[[], object]] = []
        self._drag: VoidDrag | None = None
        self._mouth: MouthDrag | None = None
        self._outline = OutlineDrag(self)
        self._outline.followed.connect(self._follow)
        self._outline.ended.connect(self._arrive)
        self._outline.failed.connect(self._fail)
        self._dragged_from: Candidate | None = None  # the document's design since the drag of a vertex began
        self._apart: tuple[tuple[Candidate, FabricationSettings], float] | None = None  # of the design, cells
        self._decoded: PosedDesign | None = None  # the draft, if the outline's thread has decoded it
        self._later: deque[Callable[[], None]] = deque()
        self._pause = QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._pause.timeout.connect(self.commit)

    # what is there -------------------------------------------------------------------------------------------------

    @property
    def busy(self) -> bool:
        """Whether a gesture is under way or waits for its score."""
        return self._base is not None or self._outline.active

    @property
    def sheet(self) -> Sheet | None:
        """The sheet as it is shown."""
        candidate = self._session.document.candidate
        return self._sheet if self._sheet is not None else None if candidate is None else candidate.final_sheet

    @property
    def _least_gap(self) -> float:
        """Distance (unit cells) that pins have to keep, the same as in fits; 0 without pins."""
        document = self._session.document
        candidate = document.candidate
        if candidate is None or not is_pinned(document.fabrication):
            return 0.0
        key = candidate, document.fabrication
        if self._apart is None or self._apart[0] != key:
            self._apart = key, least_gap_of(cut_for(document, candidate), candidate.final_sheet)
        return self._apart[1]

    def postpones(self, act: Callable[[], object]) -> bool:
        """Whether an act must wait until all gestures are in the document; it is then carried out by itself."""
        self.commit()
        if not self.busy:
            return False
        self._postponed.append(act)
        return True

    def defers(self, act: Callable[[], None]) -> bool:
        """Whether a gesture must wait until the outline has arrived; it is then carried out by itself."""
        if self._outline.arriving:
            self._later.append(act)
        return self._outline.arriving

    def stop(self) -> None:
        """Another document comes: forget what belongs to the old one."""
        self._job.stop()
        self._waiting.clear()
        self._postponed.clear()
        self._later.clear()
        self._drop()
        self._settle()

    def close(self) -> None:
        """The window is going away."""
        self._outline.close()

    # ratios --------------------------------------------------------------------------------------------------------

    @_after_arrival
    def nudge(self, voids: frozenset[Void], step: float) -> None:
        """Change the log10 of ratios by ``step``; steps that follow one another soon undo together."""
        free = self._free(voids)
        if free and self.sheet is not None:
            self._turns += not self._continues(tuple(free))
            key = f"turn {self._turns}"
            self._change({void: float(self.sheet.field.ratio[void]) * math.pow(10.0, step) for void in free}, key)
            self._pause.start()

    def _continues(self, what: object) -> bool:
        """Whether a notch on these voids, or a key for this edge cut, continues the one before it."""
        (before, when), now = self._last_turn, time.monotonic()
        self._last_turn = what, now
        return what == before and now - when <= JOINS_WITHIN

    @_after_arrival
    def set_ratio(self, voids: frozenset[Void], ratio: float) -> None:
        """Give voids a ratio, as typed."""
        free = self._free(voids)
        if free:
            self._change(dict.fromkeys(free, ratio))
            self._pause.start()

    @_after_arrival
    def begin_drag(self, void: Void, place: tuple[float, float], phi: float) -> None:
        """Begin to drag a void at a place in the world."""
        self._prepare_drag()
        design = self._design()
        if self._free(frozenset({void})) and design is not None:
            self._drag = VoidDrag.of(design, void, place, phi)

    @_after_arrival
    def drag(self, place: tuple[float, float]) -> None:
        """The pointer has moved to a place in the world; what is held follows."""
        if self._drag is not None:
            self._change({self._drag.void: self._drag.ratio_at(place)})
        elif self._mouth is not None:
            self._place_mouth(self._mouth.mouth, self._mouth.position_at(place))
        else:
            self._outline.move(place)

    def _free(self, voids: frozenset[Void]) -> list[Void]:
        """Those that may be changed; when none may, the status line says why."""
        document = self._session.document
        if document.candidate is None or not voids:
            return []
        free = sorted(voids - document.locked)
        if not free:
            self._session.set_status(locked_sentence(len(voids)))
        return free

    def _change(self, wanted: dict[Void, float], merge_key: str | None = None) -> None:
        """Give voids new ratios within the bounds; one that lay beyond them before may stay there."""
        sheet = self.sheet
        if sheet is None:
            return
        table = sheet.field.ratio.copy()
        for void, ratio in wanted.items():
            table[void] = min(max(ratio, min(SMALLEST, table[void])), max(LARGEST, table[void]))
        first = min(wanted)
        label, wished = ratio_label(first, len(wanted)), sheet.with_field(RatioField(table))
        kept = kept_apart(sheet, wished, self._least_gap)
        self._draft(kept, label, merge_key)
        said = tr("{gesture}: x {ratio:.3f}", gesture=label, ratio=float(kept.field.ratio[first]))
        self._session.set_status(said if kept is wished else f"{said}. {tr(PINS_STOP_IT)}")

    # the rim -------------------------------------------------------------------------------------------------------

    @_after_arrival
    def begin_mouth(self, mouth: int, place: tuple[float, float], phi: float) -> None:
        """Begin to drag an edge cut at a place in the world."""
        self._prepare_drag()
        design = self._design()
        if design is not None:
            self._mouth = MouthDrag.of(design, mouth, place, phi)

    @_after_arrival
    def nudge_mouth(self, mouth: int, step: float) -> None:
        """Move an edge cut by ``step`` (unit cells); steps that follow one another soon undo together."""
        if self.sheet is not None:
            self._turns += not self._continues(mouth)
            self._place_mouth(mouth, float(self.sheet.rim.positions[mouth]) + step, f"turn {self._turns}")
            self._pause.start()

    def _place_mouth(self, mouth: int, position: float, merge_key: str | None = None) -> None:
        sheet = self.sheet
        if sheet is not None and holds_corner(sheet, mouth):
            self._session.set_status(tr("This edge cut stays where it is: it holds a corner of the flat sheet."))
        elif sheet is not None:
            wished = moved(sheet, mouth, position)
            placed = kept_apart(sheet, wished, self._least_gap)
            self._draft(placed, tr("Move edge cut"), merge_key)
            said = MouthFacts.of(placed, mouth, self._session.document.fabrication.width_mm).sentence()
            self._session.set_status(said if placed is wished else f"{said} {tr(PINS_STOP_IT)}")

    @_after_arrival
    def even_rim(self) -> None:
        """Put all edge cuts where they are on an even rim."""
        sheet = self.sheet
        if sheet is None or sheet.has_even_rim:
            self._session.set_status(tr("The edge cuts are evenly spaced already."))
            return
        even = replace_sheet(sheet, rim=Rim.even(*sheet.grid))
        if kept_apart(sheet, even, self._least_gap) is not even:
            self._session.set_status(tr("On an even rim pins would be nearer to each other than their ears allow."))
            return
        self._prepare_drag()
        self._draft(even, tr("Even rim"))
        self.commit()

    # locks ---------------------------------------------------------------------------------------------------------

    def lock(self, voids: frozenset[Void], on: bool) -> None:
        """Lock voids against changes by hand, or unlock them."""
        if voids and not self.postpones(lambda: self.lock(voids, on)):
            self._session.apply(edits.lock_voids(self._session.document, voids, on))

    def lock_all(self, on: bool) -> None:
        """Lock every void, or none."""
        if not self.postpones(lambda: self.lock_all(on)):
            self._session.apply(edits.lock_all(self._session.document, on))

    # the outline ---------------------------------------------------------------------------------------------------

    @_after_arrival
    def begin_vertex(self, vertex: int, phi: float) -> None:
        """Begin to drag a vertex of the outline at the angle that is shown."""
        self._prepare_drag()
        design, document = self._design(), self._session.document
        if design is None or phi >= math.pi:
            self._session.set_status(tr("The flat sheet keeps its outline. Open it to move the outline."))
            return
        locked = np.zeros(design.deployment.sheet.grid, dtype=np.bool_)
        for void in document.locked:
            locked[void] = True
        self._dragged_from = document.candidate
        self._outline.begin(DragStart(design, phi, vertex, locked, self._least_gap))
        self._session.set_status(tr("Preparing the outline …"))

    def _follow(self, found: DragStep) -> None:
        """The outline has come a step nearer to the pointer."""
        if self._session.document.candidate != self._dragged_from:  # something else has changed the design meanwhile
            self._drop()
            self._arrive()
            return
        self._decoded = found.design
        self._draft(found.design.deployment.sheet, tr("Move outline"))
        if found.arrived:
            self._session.set_status(tr("The outline follows the pointer."))
        elif found.stuck:
            self._session.set_status(
                tr("The outline can't reach that far: ratio limits, locked voids or panel collisions block it.")
                if not self._least_gap
                else tr(
                    "The outline can't reach that far: ratio limits, locked voids, pins or panel collisions block it."
                )
            )

    def _arrive(self) -> None:
        """The released outline has arrived; now comes what the user has done since."""
        later, self._later = self._later, deque()
        self.commit()
        for act in later:
            act()
        if not self.busy:
            self._settle()

    def _prepare_drag(self) -> None:
        self.commit()
        self._drop()

    def _drop(self) -> None:
        """Nothing is being dragged."""
        self._drag = self._mouth = None
        self._outline.stop()

    @_after_arrival
    def release(self) -> None:
        """The button was released: the gesture is complete, for an outline when it has arrived."""
        if self._outline.active:
            self._outline.release()
        else:
            self.commit()

    @_after_arrival
    def cancel(self) -> None:
        """Cancel the gesture under way."""
        self._pause.stop()
        self._drop()
        if self._open is None:
            return
        self._sheet, self._open = self._last, None
        if not self._job.busy:
            self._discard_draft()
        else:
            self._show_draft()
        self._session.set_status(tr("Drag cancelled."))

    # drafts and edits ----------------------------------------------------------------------------------------------

    def _draft(self, sheet: Sheet, label: str, merge_key: str | None = None) -> None:
        candidate = self._session.document.candidate
        if candidate is None or sheet == self.sheet:
            return
        if self._open is not None and self._open != label:
            self.commit()
        if self._base is None:
            self._base, self._last = candidate, candidate.final_sheet
        if self._open is None:
            self._key = merge_key
        self._sheet, self._open = sheet, label
        self._show_draft()

    def _design(self) -> PosedDesign | None:
        """The design as it is shown: at the pose that it was scored in, until it is scored anew."""
        candidate = self._base or self._session.document.candidate
        if candidate is None or self.sheet is None:
            return None
        if self._sheet is None and candidate.trim is None:
            return self._session.cache.entry(candidate).design
        if self._decoded is not None and self._decoded.deployment.sheet is self._sheet:
            return self._decoded
        if self.sheet.rim != candidate.final_sheet.rim:
            return with_sheet(self._session.cache.entry(candidate).design, self.sheet)
        return PosedDesign(deploy(self.sheet), candidate.final_pose, candidate.final_phi)

    def _show_draft(self) -> None:
        design = self._design()
        if design is not None and self._session.document.candidate == self._base:
            self.drafted.emit(design)

    def commit(self) -> None:
        """The gesture is complete; what follows is another one."""
        if self._outline.arriving:  # it becomes complete by itself
            return
        self._pause.stop()
        self._drop()
        if self._open is None or self._sheet is None:
            return
        gesture, self._open = _Gesture(self._sheet, self._open, self._key), None
        if gesture.sheet != self._last:
            self._last = gesture.sheet
            if gesture.merge_key is not None and self._waiting and self._waiting[-1].merge_key == gesture.merge_key:
                self._waiting.pop()  # it would be one step with this one
            self._waiting.append(gesture)
            self._score_next()
        elif not self._job.busy:  # back where it began
            self._discard_draft()

    def _score_next(self) -> None:
        target = self._session.document.target
        if self._job.busy or not self._waiting or self._base is None or target is None:
            return
        gesture = self._waiting.popleft()
        steps = single(partial(_rescored, self._base, gesture.sheet, target))
        callbacks = JobCallbacks(partial(self._on_result, gesture), on_failed=self._fail)
        self._job.start(tr("scoring the change"), steps, callbacks)

    def _on_result(self, gesture: _Gesture, report: Decoded) -> None:
        self._job.stop()  # the report is the end
        before = self._base
        if before is None:
            return
        edit = edits.take_changed(self._session.document, before, report.candidate, gesture.label, gesture.merge_key)
        if edit is None:
            self._discard_draft()
            return
        self._session.cache.put(report.candidate, report.deployment)
        self._base = self._dragged_from = report.candidate
        self._session.apply(edit)
        self._session.set_status(score_sentence(gesture.label, before, report.candidate))
        if self._waiting or self._open is not None:
            self._show_draft()
            self._score_next()
        else:
            self._settle()

    def _fail(self, sentence: str, trace: str) -> None:
        self._discard_draft()
        self._session.report_failure(sentence, trace)

    def _discard_draft(self) -> None:
        """Drop the draft and show the design as the document has it."""
        postponed = self._postponed
        self._postponed = []
        self.stop()
        candidate = self._session.document.candidate
        if candidate is not None:
            self.drafted.emit(self._session.cache.entry(candidate).design)
        for act in postponed:
            act()

    def _settle(self) -> None:
        """Nothing is under way any more; what was postponed is carried out."""
        self._pause.stop()
        self._base = self._sheet = self._last = self._open = self._decoded = None
        postponed, self._postponed = self._postponed, []
        self.settled.emit()
        for act in postponed:
            act()
