"""What the stage's header says: tips of its switches, and the scores of the design that is shown."""

from __future__ import annotations

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.views.layout_view import Overlay

OVERLAYS = (
    (Overlay.TARGET, "target", tr("Show the target's outline (T).")),
    (
        Overlay.MISMATCH,
        "mismatch",
        tr("Show missing and extra area near the target angle (M). Orange stripes: missing; dark stripes: extra."),
    ),
    (Overlay.FAULTS, "fault", tr("Mark inverted panels and the first contact (F).")),
)
BEFORE = tr("Before polish: show the design as the generator drew it (B).")
NEVER_POLISHED = tr("Before polish (B). Nothing to compare: polishing has not changed this design.")
NEVER_DRAWN = tr("Before polish (B). Nothing to compare: this design was not drawn by the generator.")
TRIM = tr("Trim to target (Ctrl+T). Cuts the edge panels along the target; every hinge keeps its material.")
UNTRIM = tr("Trim to target (Ctrl+T). Press again to bring back what was cut off.")
TRIMMING = tr("Trim to target: at work. Press again, or Esc, to stop.")
CUTS = tr("Cuts: show the cut plan as it will burn (C).")
PLOTS = tr("Plots: match, area, size and gaps at every angle (J).")


def scores_told(candidate: Candidate, drawn: Candidate | None) -> tuple[str, ...]:
    """Scores of a design, beside those of its drawn state if that is shown, longest text first."""
    score, trim = candidate.score, candidate.trim
    siou = f"{100 * score.siou:.1f} %"
    if drawn is not None:
        before = f"{100 * drawn.score.siou:.1f} %"
        long = tr("before polish: sIoU {before}  ·  after: {siou}", before=before, siou=siou)
        return long, tr("before {before}  ·  after {siou}", before=before, siou=siou)
    if trim is not None:
        trimmed = f"{100 * trim.iou:.1f} %"
        long = tr("sIoU {siou}  ·  trimmed IoU {trimmed}", siou=siou, trimmed=trimmed)
        return long, tr("{siou}  ·  trimmed {trimmed}", siou=siou, trimmed=trimmed)
    gain, variation = 100 * score.siou_gain, score.tv
    long = tr("sIoU {siou}   gain {gain:+.1f}   TV {variation:.2f}", siou=siou, gain=gain, variation=variation)
    return long, tr("sIoU {siou}", siou=siou)
