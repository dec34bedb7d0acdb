"""The candidates as a list for Qt: best first, growing while a run goes on."""

from __future__ import annotations

import bisect
import math
from dataclasses import dataclass

from PySide6.QtCore import QAbstractListModel, QModelIndex, QObject, QPersistentModelIndex, Qt

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.gui.scene.posed import PosedDesign
from kirigami_studio.pipeline.rank import rank_key

CANDIDATE_ROLE = Qt.ItemDataRole.UserRole + 1
DESIGN_ROLE = Qt.ItemDataRole.UserRole + 2
RISE_ROLE = Qt.ItemDataRole.UserRole + 3

Index = QModelIndex | QPersistentModelIndex


@dataclass(frozen=True, slots=True, eq=False)
class Entry:
    """One card: a candidate with its decoded, posed design.

    Attributes
    ----------
    candidate : Candidate
    design : PosedDesign
        As it is finished: trimmed if the candidate is.
    rise : float
        What polishing has added to its sIoU in the run that goes on.
    """

    candidate: Candidate
    design: PosedDesign
    rise: float = 0.0


class GalleryModel(QAbstractListModel):
    """Entries in the order of the document; while a run goes on in that of its ranking."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._entries: list[Entry] = []

    @property
    def entries(self) -> tuple[Entry, ...]:
        return tuple(self._entries)

    def rowCount(self, parent: Index = QModelIndex()) -> int:  # noqa: N802, B008 - Qt's name and signature
        return 0 if parent.isValid() else len(self._entries)

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> object:
        if not index.isValid() or not 0 <= index.row() < len(self._entries):
            return None
        entry = self._entries[index.row()]
        if role == CANDIDATE_ROLE:
            return entry.candidate
        if role == DESIGN_ROLE:
            return entry.design
        if role == RISE_ROLE:
            return entry.rise
        if role in (Qt.ItemDataRole.AccessibleTextRole, Qt.ItemDataRole.ToolTipRole):
            risen = f"\nPolishing has raised sIoU by {100 * entry.rise:.2f} points so far" if entry.rise > 0 else ""
            return described(entry.candidate, index.row() + 1) + risen
        return None

    def replace(self, entries: list[Entry]) -> None:
        """Show other candidates, best first; those that are the same samples as before keep their cards."""
        before, self._entries = self._entries, list(entries)
        kept = len(before) == len(entries) and all(
            same_sample(old.candidate, new.candidate) for old, new in zip(before, entries, strict=True)
        )
        if kept and entries:
            self.dataChanged.emit(self.index(0, 0), self.index(len(entries) - 1, 0))
            return
        self._entries = before
        self.beginResetModel()
        self._entries = list(entries)
        self.endResetModel()

    def insert(self, entry: Entry) -> int:
        """Add one candidate at its rank, in the place of an earlier state of the same sample; return its row."""
        for old, shown in enumerate(self._entries):
            if same_sample(shown.candidate, entry.candidate):
                self.beginRemoveRows(QModelIndex(), old, old)
                del self._entries[old]
                self.endRemoveRows()
                break
        row = bisect.bisect_right(self._entries, rank_key(entry.candidate), key=lambda one: rank_key(one.candidate))
        self.beginInsertRows(QModelIndex(), row, row)
        self._entries.insert(row, entry)
        self.endInsertRows()
        return row

    def row_of(self, candidate: Candidate | None) -> int:
        """Row of a candidate, -1 when it is not shown."""
        for row, entry in enumerate(self._entries):
            if entry.candidate is candidate or entry.candidate == candidate:
                return row
        return -1


def same_sample(one: Candidate, other: Candidate) -> bool:
    """Whether two candidates of a run are one sample, before and after polishing."""
    return (one.seed, one.index) == (other.seed, other.index)


def described(candidate: Candidate, rank: int) -> str:
    """Tell everything about a candidate in words, for tooltips and screen readers."""
    score = candidate.score
    lines = [
        f"Design {rank}: sIoU {100 * score.siou:.2f} % (exact IoU {100 * score.iou_exact:.2f} %)",
        f"Gain over the uniform sheet: {100 * score.siou_gain:+.2f} points (uniform {100 * score.uniform_siou:.2f} %)",
        f"Total variation (TV) of the ratios: {score.tv:.3f}",
        *trimming(candidate),
        motion(candidate),
        f"Seed {candidate.seed}, sample {candidate.index}{', polished' if candidate.polished else ''}",
    ]
    return "\n".join([*lines, *problems(candidate)])


def trimming(candidate: Candidate) -> list[str]:
    """Tell how a trimmed design scores, apart from the untrimmed one."""
    trim = candidate.trim
    if trim is None:
        return []
    share = f"{100 * trim.removed_share:.1f} % of the sheet is cut off"
    return [f"Trimmed: IoU {100 * trim.iou:.2f} % ({100 * trim.untrimmed_iou:.2f} % before the cut); {share}"]


def motion(candidate: Candidate) -> str:
    """Tell how far the sheet opens before it touches itself."""
    score = candidate.score
    if score.contact is None:
        return f"Opens from 180° to {math.degrees(score.phi):.1f}° without contact"
    return f"Touches itself while opening, at {math.degrees(score.contact.phi):.1f}°"


def problems(candidate: Candidate) -> list[str]:
    """Sentences on what keeps a candidate from being feasible; empty when nothing does."""
    score = candidate.score
    found = []
    if score.n_invalid:
        found.append(f"{score.n_invalid} invalid panel(s) or void(s).")
    if score.contact is not None:
        x, y = score.contact.where
        found.append(f"The first contact is near ({x:.2f}, {y:.2f}) unit cells.")
    if not score.feasible and not found:
        found.append(f"Panels overlap by {100 * score.overlap_ratio:.2f} % of their area.")
    return found
