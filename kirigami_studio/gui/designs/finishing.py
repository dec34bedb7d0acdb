"""The finishing switch: trim the chosen design to the target, or take its trim off."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.designs.one_design import OneDesign
from kirigami_studio.gui.jobs import steps
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.project import edits


class TrimJob(OneDesign):
    """Trims at most one design at a time, off the window's thread, and proposes the edit that it leads to."""

    stopped = tr("Trimming stopped; nothing was changed.")

    def switch(self, on: bool) -> None:
        """Trim the chosen design, or bring back what was cut off; while it is being trimmed, stop that."""
        candidate = self._document().candidate
        if not on and self.busy:
            self.cancel()
        elif candidate is None:
            self.message.emit(Message(tr("Choose a finished design first, then trim it."), Tone.HINT))
        elif on and candidate.trim is None:
            self._start(candidate)
        elif not on and candidate.trim is not None:
            self._replace(replace(candidate, trim=None), tr("Untrim"))
            self.status.emit(tr("The design is whole again."))

    def _start(self, candidate: Candidate) -> None:
        document = self._document()
        if document.target is None:
            return
        work = partial(steps.trimming, candidate, document.target, document.fabrication)
        self.begin(tr("trimming the design"), candidate, work)
        self.status.emit(tr("Trimming {name} …", name=self.name()))

    def take(self, before: Candidate, report: object) -> None:
        """The worker has made something of the design."""
        if not isinstance(report, steps.Decoded) or before != self._document().candidate:
            return
        after, trim = report.candidate, report.candidate.trim
        if trim is None:
            return
        self._cache.put(after, report.deployment)
        self._replace(after, tr("Trim"))
        scores = tr(
            "Trimmed IoU {iou:.1f} %, untrimmed sIoU {siou:.1f} %", iou=100 * trim.iou, siou=100 * after.score.siou
        )
        self.status.emit(
            tr(
                "{scores}; {removed_share:.1f} % of the sheet is cut off.",
                scores=scores,
                removed_share=100 * trim.removed_share,
            )
        )

    def _replace(self, candidate: Candidate, gesture: str) -> None:
        document = self._document()
        if document.chosen is not None:
            label = f"{gesture} {self.name()}"
            self.edited.emit(edits.replace_candidate(document, document.chosen, candidate, label))
