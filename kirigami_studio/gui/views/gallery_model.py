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

Index = QModelIndex | QPersistentModelIndex


@dataclass(frozen=True, slots=True, eq=False)
class Entry:
    """One card: a candidate with its decoded, posed design."""

    candidate: Candidate
    design: PosedDesign


class GalleryModel(QAbstractListModel):
    """Entries in the order of :func:`kirigami_studio.pipeline.rank.rank_key`."""

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
        if role in (Qt.ItemDataRole.AccessibleTextRole, Qt.ItemDataRole.ToolTipRole):
            return described(entry.candidate, index.row() + 1)
        return None

    def replace(self, entries: list[Entry]) -> None:
        """Show other candidates."""
        self.beginResetModel()
        self._entries = sorted(entries, key=lambda entry: rank_key(entry.candidate))
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
        motion(candidate),
        f"Seed {candidate.seed}, sample {candidate.index}{', polished' if candidate.polished else ''}",
    ]
    return "\n".join([*lines, *problems(candidate)])


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
