"""Designs that look the same as one card: which lie under which, and which stacks are open."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.queue import JobCallbacks, LatestJob
from kirigami_studio.gui.session.session import Entry, Session
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.variety import look_alikes
from kirigami_studio.studio.designing import grouping

#: So many designs are compared at once while the window waits; more are compared in the worker.
COMPARED_AT_ONCE = 128
#: The same in ratios, of which designs of a fine grid have more: 40 000 take 25 ms.
RATIOS_AT_ONCE = 15_000


class Stacks:
    """The groups of the gallery's designs; of each the first one shown is the card, the others lie under it."""

    def __init__(self) -> None:
        self._group: dict[int, int] = {}  # by the identity of the candidate
        self._opened: set[int] = set()
        self._under: dict[int, tuple[Entry, ...]] = {}

    def regroup(self, entries: Sequence[Entry], ranking: Ranking) -> None:
        """Compare designs, unless they are so many that the worker has to do it."""
        candidates = [entry.candidate for entry in entries]
        ratios = sum(candidate.sheet.rows * candidate.sheet.columns for candidate in candidates)
        few = len(candidates) <= COMPARED_AT_ONCE and ratios <= RATIOS_AT_ONCE
        self.set_groups(candidates, look_alikes(candidates, ranking) if few and candidates else ())

    def set_groups(self, candidates: Sequence[Candidate], groups: Sequence[int]) -> None:
        """Take the group of each candidate; without groups each design is its own."""
        self._group = {id(candidate): group for candidate, group in zip(candidates, groups, strict=False)}
        self._opened &= {id(candidate) for candidate in candidates}

    def stacked(self, entries: Sequence[Entry]) -> list[Entry]:
        """The cards, in the order given: the first of every group, followed by the others where its stack is open."""
        groups: dict[int, list[Entry]] = {}
        for place, entry in enumerate(entries):
            groups.setdefault(self._group.get(id(entry.candidate), -1 - place), []).append(entry)
        self._under = {id(head.candidate): tuple(rest) for head, *rest in groups.values() if rest}
        cards: list[Entry] = []
        for members in groups.values():
            cards += members if self._is_open(members) else members[:1]
        return cards

    def flat(self) -> None:
        """Nothing lies under anything."""
        self._under = {}

    def _is_open(self, members: Sequence[Entry]) -> bool:
        return any(id(entry.candidate) in self._opened for entry in members)

    def under(self, candidate: Candidate) -> int:
        """How many designs look like the one on a card and belong to it."""
        return len(self._under.get(id(candidate), ()))

    def is_open(self, candidate: Candidate) -> bool:
        """Whether the designs that belong to a card are shown."""
        return id(candidate) in self._opened or self._is_open(self._under.get(id(candidate), ()))

    def toggle(self, head: Candidate) -> None:
        """Show the designs under a card, or hide them again."""
        members = {id(head), *(id(entry.candidate) for entry in self._under.get(id(head), ()))}
        if self.is_open(head):
            self._opened -= members
        else:
            self._opened.add(id(head))

    def head_of(self, candidate: Candidate, cards: Sequence[Entry]) -> Candidate | None:
        """The card that a design lies under, None where it lies under none."""
        for entry in cards:
            if any(one.candidate is candidate for one in self._under.get(id(entry.candidate), ())):
                return entry.candidate
        return None

    def reveal(self, candidate: Candidate) -> bool:
        """Open the stack that hides a design; whether one did."""
        for rest in self._under.values():
            if not self._is_open(rest) and any(entry.candidate is candidate for entry in rest):
                self._opened.add(id(candidate))
                return True
        return False


class LookAlikes(QObject):
    """Groups more designs than can be compared while the window waits."""

    known = Signal(tuple, tuple)  #: of Candidate; of int, their groups

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._job = LatestJob[tuple[int, ...]](session.queue)

    def look_at(self, candidates: tuple[Candidate, ...], ranking: Ranking) -> None:
        """Group these designs, unless the gallery has done so itself."""
        self._job.stop()
        ratios = sum(candidate.sheet.rows * candidate.sheet.columns for candidate in candidates)
        if len(candidates) > COMPARED_AT_ONCE or ratios > RATIOS_AT_ONCE:
            callbacks = JobCallbacks(partial(self.known.emit, candidates), on_failed=self._session.report_failure)
            self._job.start(tr("comparing the designs"), partial(grouping, candidates, ranking), callbacks)
