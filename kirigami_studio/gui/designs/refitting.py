"""Fit again: improve the chosen design from where it is, with locked voids as they are."""

from __future__ import annotations

from functools import partial

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.designs.one_design import OneDesign
from kirigami_studio.gui.jobs import hand_steps
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.project import hand_edits


class Refitting(OneDesign):
    """Fits at most one design at a time, off the window's thread, and proposes the edit that it leads to."""

    stopped = tr("Fitting stopped; nothing was changed.")

    def start(self) -> None:
        """Fit the chosen design by what the settings prefer."""
        document = self._document()
        candidate, target = document.candidate, document.target
        if candidate is None or target is None:
            self.message.emit(Message(tr("Choose a finished design first, then fit it again."), Tone.HINT))
            return
        if len(document.locked) == candidate.field.ratio.size:
            self.message.emit(Message(tr("Every void is locked; unlock those that the fit may change."), Tone.HINT))
            return
        prefer, locked, cuts = document.settings.prefer, document.locked, document.fabrication
        work = partial(hand_steps.refitting, candidate, target, prefer, locked, cuts)
        self.begin(tr("fitting the design"), candidate, work)
        self.status.emit(tr("Fitting {design} … Esc stops.", design=self.name()))

    def take(self, before: Candidate, report: object) -> None:
        """The worker has made something of the design."""
        if not isinstance(report, hand_steps.Refitted):
            return
        after = report.decoded.candidate
        numbers = {"before": 100 * before.score.siou, "after": 100 * after.score.siou}
        if report.better:
            self._replace(before, report, tr("Fitted again: sIoU {before:.1f} % is now {after:.1f} %.", **numbers))
        else:
            told = tr("The fit found nothing better: sIoU {after:.2f} % after {before:.2f} %.", **numbers)
            taken = tr("Taken: sIoU {after:.2f} % after {before:.2f} %.", **numbers)
            actions = ((tr("Take it anyway"), partial(self._replace, before, report, taken)),)
            self.message.emit(Message(told, Tone.HINT, actions=actions))
            self.status.emit(tr("Fitted; the design stays as it was."))

    def _replace(self, before: Candidate, report: hand_steps.Refitted, told: str) -> None:
        """Propose the edit and tell of it, unless the design or its locks have changed since the fit began."""
        after, label = report.decoded.candidate, tr("Fit {design}", design=self.name())
        edit = hand_edits.take_changed(self._document(), before, after, label)
        if edit is None:
            self.status.emit(tr("The design has changed since that fit; press Fit again (Ctrl+F)."))
            return
        if hand_edits.moves_locked(self._document(), before, after):
            self.status.emit(tr("Voids were locked since that fit; press Fit again (Ctrl+F)."))
            return
        self._cache.put(after, report.decoded.deployment)
        self.edited.emit(edit)
        if after.trim is not None:
            told = tr("{told} Trimmed again: IoU {iou:.1f} %.", told=told, iou=100 * after.trim.iou)
        elif report.untrimmed:
            told = tr("{told} Its trim is off: {reason}", told=told, reason=report.untrimmed)
        self.status.emit(told)
