"""What is said about a change by hand: the name of its undo step, and the sentences of the status line."""

from __future__ import annotations

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.project.document import Void


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
        told = tr("{told} The design is not feasible now.", told=told)
    if before.trim is not None:
        told = tr("{told} Its trim is off; trim it again when you are done.", told=told)
    return told
