"""A change of the target puts its designs away; this says so, and brings them back when asked."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.gui.designs.design_run import request_of
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.events import Result
from kirigami_studio.pipeline.rank import rank_key, ranked
from kirigami_studio.pipeline.request import Request
from kirigami_studio.project import candidate_edits
from kirigami_studio.project.candidate_edits import Brought
from kirigami_studio.project.document import Document, Mark
from kirigami_studio.project.edits import Edit
from kirigami_studio.project.history import History

#: Angles closer than this (radians) are one.
SAME_ANGLE = 1e-9


@dataclass(frozen=True, slots=True)
class Plan:
    """A run that is to start.

    Attributes
    ----------
    request : Request
    kept : tuple of Candidate
        Designs of the document that stay in sight, best first.
    joins : bool
        Whether what it brings joins those there are, and the choice stays.
    seed : int or None
        Seed that the settings show afterwards.
    says : str
    """

    request: Request
    kept: tuple[Candidate, ...]
    joins: bool
    seed: int | None
    says: str


class Collecting(QObject):
    """Plans runs for the present document and turns their results into edits."""

    message = Signal(object)  #: Message

    def __init__(self, document: Callable[[], Document], parent: QObject) -> None:
        super().__init__(parent)
        self._document = document
        self._plan: Plan | None = None
        self.added: frozenset[Candidate] = frozenset()  #: what the last run has added to designs that were there
        self.keeps_seed = True  #: whether Generate draws from the seed that is shown

    @property
    def plan(self) -> Plan | None:
        """The run that was planned last."""
        return self._plan

    def anew(self, target: Outline) -> Plan:
        """New designs in the place of all but the pinned ones.

        Raises
        ------
        KirigamiError
            The settings do not go together.
        """
        document = self._document()
        settings = document.settings
        seed = settings.seed if self.keeps_seed else next_seed(document)
        request = request_of(target, replace(settings, seed=seed))
        says = tr("Generating {k} designs for {name} …", k=request.k, name=target.name)
        return self._planned(Plan(request, ranked(_staying(document, request)), False, seed, says))

    def more(self, target: Outline) -> Plan:
        """More designs for the same grid and angle, from the next seed.

        Raises
        ------
        KirigamiError
            There are no designs to add to.
        """
        request = self._joining(target)
        says = tr("Generating {count} more designs from seed {seed} …", count=request.k, seed=request.seed)
        return self._joined(request, says)

    def alike(self, target: Outline, nearness: float) -> Plan:
        """More designs, drawn near the chosen one.

        Raises
        ------
        KirigamiError
            No design is chosen, or it cannot be drawn near.
        """
        chosen = self._document().candidate
        if chosen is None:
            raise UsageError(tr("Choose a design first, then generate more like it."))
        request = replace(self._joining(target), near=chosen.field, nearness=nearness, search=0)
        number = (self._document().chosen or 0) + 1
        says = tr("Generating {count} designs like design {number} …", count=request.k, number=number)
        return self._joined(request, says)

    def _joining(self, target: Outline) -> Request:
        document = self._document()
        if not document.candidates:
            raise UsageError(tr("No designs to add to yet. Press Generate first."))
        first = document.candidates[0]
        same = replace(document.settings, grid=first.field.ratio.shape, phi=first.score.phi, seed=next_seed(document))
        return request_of(target, same)

    def _joined(self, request: Request, says: str) -> Plan:
        seed = None if self.keeps_seed else request.seed
        return self._planned(Plan(request, ranked(self._document().candidates), True, seed, says))

    def _planned(self, plan: Plan) -> Plan:
        self._plan = plan
        return plan

    def edit_for(self, result: Result, provenance: dict[str, str], preview: Candidate | None) -> Edit:
        """What a finished run leads to; where it joins, its result holds new designs alone.

        ``preview`` is the design that the user looked at meanwhile.
        """
        document, plan = self._document(), self._plan
        seed = None if plan is None else plan.seed
        if plan is not None and plan.joins:
            self.added = frozenset(result.candidates)
            brought = Brought(result.candidates, provenance, seed)
            edit = candidate_edits.add_candidates(document, brought, rank_key)
            return _choosing(edit, preview)
        self.added = frozenset()
        staying = _staying(document, result.request)
        if not staying and Mark.PINNED in document.marks:
            sentence = tr("Pinned designs for another grid or angle were removed. Undo restores them.")
            self.message.emit(Message(sentence, Tone.HINT))
            document = replace(document, marks=())
        brought = Brought(result.candidates, provenance, seed, result.request.target)
        chosen = preview if preview is not None and preview in (*staying, *result.candidates) else None
        return candidate_edits.renew_candidates(document, brought, rank_key, chosen)

    def told(self, result: Result, before: Document) -> str:
        """What the status line says of a finished run."""
        plan, document = self._plan, self._document()
        if plan is None or not plan.joins:
            score = result.best.score
            return tr(
                "Generated {count} in {seconds:.1f} s. Best: sIoU {siou:.1f} %, {siou_gain:+.1f} over "
                "the uniform sheet.",
                count=len(result.candidates),
                seconds=result.seconds,
                siou=100 * score.siou,
                siou_gain=100 * score.siou_gain,
            )
        added = len(set(document.candidates) - set(before.candidates))
        if not added:
            return tr("No new designs; {count} already in the gallery.", count=result.repeats)
        best = tr("best sIoU {siou:.1f} %", siou=100 * result.best.score.siou)
        parts = [tr_n("{count} design added", "{count} designs added", added)]
        if result.repeats:
            parts.append(tr_n("{count} already there", "{count} already there", result.repeats))
        return ", ".join([*parts, best]) + "."


def next_seed(document: Document) -> int:
    """The first seed from the settings' own on that no design of the document was drawn from."""
    used = {candidate.seed for candidate in document.candidates}
    seed = document.settings.seed
    while seed in used:
        seed += 1
    return seed


def _staying(document: Document, request: Request) -> tuple[Candidate, ...]:
    """Pinned designs that share target, grid and angle with a run for the present target."""
    return tuple(
        one
        for one, mark in zip(document.candidates, document.marks, strict=True)
        if mark is Mark.PINNED
        and one.field.ratio.shape == request.grid
        and abs(one.score.phi - request.phi) < SAME_ANGLE
    )


def _choosing(edit: Edit, preview: Candidate | None) -> Edit:
    """The edit with the design that was looked at on the stage."""
    candidates = edit.document.candidates
    if preview is None or preview not in candidates:
        return edit
    return Edit(edit.label, replace(edit.document, chosen=candidates.index(preview)))


class Marking(QObject):
    """Proposes the edits that pin and reject, and take that back."""

    edited = Signal(object)  #: Edit
    message = Signal(object)  #: Message
    status = Signal(str)

    def __init__(self, document: Callable[[], Document], parent: QObject) -> None:
        super().__init__(parent)
        self._document = document

    def pin(self, candidate: Candidate | None) -> None:
        """Pin a design, or unpin it."""
        self._toggle(candidate, Mark.PINNED, None)

    def reject(self, candidate: Candidate | None, beside: Candidate | None) -> None:
        """Reject a design, or take it back; ``beside`` goes to the stage where the rejected one was chosen."""
        self._toggle(candidate, Mark.REJECTED, beside)

    def _toggle(self, candidate: Candidate | None, mark: Mark, beside: Candidate | None) -> None:
        document = self._document()
        if candidate is None or candidate not in document.candidates:
            sentence = tr("Only finished designs can be pinned or rejected. Wait for the run to finish.")
            self.message.emit(Message(sentence, Tone.HINT))
            return
        index = document.candidates.index(candidate)
        wanted = Mark.NONE if document.marks[index] is mark else mark
        moves = wanted is Mark.REJECTED and index == document.chosen and beside in document.candidates
        chosen = document.candidates.index(beside) if moves and beside is not None else None
        edit = candidate_edits.set_mark(document, index, wanted, chosen)
        self.edited.emit(edit)
        self.status.emit(tr("{what}. Undo to revert.", what=edit.label))


class StoppedRun(QObject):
    """Holds what a stopped run had drawn for as long as it belongs to the document."""

    message = Signal(object)  #: Message
    withdrawn = Signal(object)  #: Message that no longer holds
    kept = Signal(object, dict)  #: Result and its provenance

    def __init__(self, document: Callable[[], Document], parent: QObject) -> None:
        super().__init__(parent)
        self._document = document
        self._open: Message | None = None
        self._drawn: tuple[Result, dict[str, str]] | None = None
        self._held: tuple[Outline | None, tuple[Candidate, ...]] = (None, ())

    def offer(self, drawn: tuple[Result, dict[str, str]] | None) -> None:
        """Ask whether the designs shall stay; the document is as it was until then."""
        self.withdraw()
        if drawn is None:
            return
        document = self._document()
        self._drawn, self._held = drawn, (document.target, document.candidates)
        count = len(drawn[0].candidates)
        sentence = tr_n(
            "Stopped after {count} design; it may be unfinished.",
            "Stopped after {count} designs; some may be unfinished.",
            count,
        )
        action = tr_n("Keep it", "Keep these designs", count)
        self._open = Message(sentence, Tone.HINT, actions=((action, self._keep),))
        self.message.emit(self._open)

    def follow(self, document: Document) -> None:
        """Another document holds now: designs for another target, or beside other designs, are of no use."""
        target, candidates = self._held
        if self._open is not None and (document.target != target or document.candidates is not candidates):
            self.withdraw()

    def withdraw(self) -> None:
        """Forget the designs."""
        message, self._open, self._drawn = self._open, None, None
        if message is not None:
            self.withdrawn.emit(message)

    def _keep(self) -> None:
        drawn = self._drawn
        self.withdraw()
        if drawn is not None:
            self.kept.emit(*drawn)


class LostDesigns(QObject):
    """Watches documents come and go."""

    message = Signal(object)  #: Message
    found = Signal(object)  #: Message that no longer holds
    undo_wanted = Signal()

    def __init__(self, history: History, parent: QObject) -> None:
        super().__init__(parent)
        self._history = history
        self._before = history.document
        self._open: Message | None = None

    def follow(self, document: Document) -> None:
        """Another document holds now."""
        before, self._before = self._before, document
        lost = bool(before.candidates) and not document.candidates and before.target != document.target
        if lost and self._history.undo_label is not None:
            count = len(before.candidates)
            sentence = tr_n(
                "The design for the old target was removed. Undo restores it.",
                "The {count} designs for the old target were removed. Undo restores them.",
                count,
            )
            self._open = Message(sentence, Tone.HINT, actions=((tr("Restore"), self.bring_back),))
            self.message.emit(self._open)
        elif self._open is not None and (document.candidates or self._history.undo_label is None):
            self.found.emit(self._open)
            self._open = None

    def bring_back(self) -> None:
        """Undo until there are designs again: all changes of the target since then."""
        while not self._history.document.candidates and self._history.undo_label is not None:
            self.undo_wanted.emit()
