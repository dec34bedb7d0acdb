"""The candidates as a list for Qt: best first, growing while a run goes on."""

from __future__ import annotations

import bisect
import math
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING

from PySide6.QtCore import QAbstractListModel, QModelIndex, QObject, QPersistentModelIndex, Qt, Signal

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.fabricate.panel_sizes import least_panel_share
from kirigami_studio.foundation.words import mark, tr, tr_n
from kirigami_studio.gui.gallery.gallery_selection import (
    GalleryItem,
    Selection,
    SortOrder,
    format_value,
    places_in_order,
)
from kirigami_studio.gui.run.look_alikes import Stacks
from kirigami_studio.gui.session.session import Entry, same_sample
from kirigami_studio.gui.widgets.readable import readable_mm, readable_width
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.project.document import Mark
from kirigami_studio.project.labels import Label
from kirigami_studio.studio.two_states import TwoStates, shown_match, start_of

if TYPE_CHECKING:
    from kirigami_studio.fabricate.material import Material
    from kirigami_studio.studio.as_cut import AsCut
    from kirigami_studio.studio.verdict import Verdict

CANDIDATE_ROLE = Qt.ItemDataRole.UserRole + 1
DESIGN_ROLE = Qt.ItemDataRole.UserRole + 2
RISE_ROLE = Qt.ItemDataRole.UserRole + 3
NAME_ROLE = Qt.ItemDataRole.UserRole + 4  #: what it is called; its number while it has no name
MARK_ROLE = Qt.ItemDataRole.UserRole + 5
FRESH_ROLE = Qt.ItemDataRole.UserRole + 7  #: whether the last further run has added it
NOTE_ROLE = Qt.ItemDataRole.UserRole + 14  #: what the user has noted of it
VALUE_ROLE = Qt.ItemDataRole.UserRole + 6  #: words for the number that is sorted by
UNCHECKED_ROLE = Qt.ItemDataRole.UserRole + 19  #: by rank, words in its place for a design that nobody has checked
ALIKE_ROLE = Qt.ItemDataRole.UserRole + 9  #: how many designs look like this card and belong to it
OPEN_ROLE = Qt.ItemDataRole.UserRole + 10  #: whether those are shown
VERDICT_ROLE = Qt.ItemDataRole.UserRole + 12  #: Verdict: that of the stage where it is known, else an estimate
GRID_ROLE = Qt.ItemDataRole.UserRole + 8  #: words for the grid where designs of several grids are there, else ""
START_ROLE = Qt.ItemDataRole.UserRole + 13  #: what it starts as where designs of several starts are there, else ""

FEATURE_ROLE = Qt.ItemDataRole.UserRole + 17  #: its smallest panel edge or neck, mm
MATCH_ROLE = Qt.ItemDataRole.UserRole + 18  #: 0..1; its match, of its pieces where they are known
THIN_ROLE = Qt.ItemDataRole.UserRole + 16  #: whether panels are too thin for the material

Index = QModelIndex | QPersistentModelIndex


class GalleryModel(QAbstractListModel):
    """The designs in the order of the document, or of the ranking while a run goes on; rows are those that are shown.

    Which ones are shown, and in which order, is a :class:`~kirigami_studio.gui.gallery.gallery_selection.Selection`;
    the number of a design is its place among all of them, whatever is shown, and its name stays whatever its place is.
    """

    arranged = Signal()  #: what is shown, or its order, has changed

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._all: list[Entry] = []
        self._shown: list[Entry] = []
        self._marks: dict[Candidate, Mark] = {}
        self._fresh: frozenset[Candidate] = frozenset()
        self._taken: list[Entry] = []
        self._stacks = Stacks()
        self._reasons: dict[int, Note] | None = None  # of the ranking, once they are asked for
        self._selection = Selection()
        self.ranking = Ranking()  #: puts designs that are inserted into their places
        self._width_mm = 100.0
        self._target: Outline | None = None
        self._starts_differ: bool | None = None  # once it is asked for
        self._as_cut: Mapping[Candidate, AsCut] = {}
        self._material: Material | None = None
        self._judged: Mapping[Candidate, Verdict] = {}
        self._expected: dict[Candidate, Verdict] = {}  # of those that were asked for
        self._labels: Mapping[Candidate, Label] = {}

    @property
    def entries(self) -> tuple[Entry, ...]:
        """Those that are shown, row by row."""
        return tuple(self._shown)

    @property
    def taken(self) -> tuple[Entry, ...]:
        """Those that the selection takes, in their order; some may lie under others that look the same."""
        return tuple(self._taken)

    @property
    def all_entries(self) -> tuple[Entry, ...]:
        """All of them by their numbers, shown or not."""
        return tuple(self._all)

    @property
    def selection(self) -> Selection:
        return self._selection

    def rowCount(self, parent: Index = QModelIndex()) -> int:  # noqa: N802, B008 - Qt's name and signature
        return 0 if parent.isValid() else len(self._shown)

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> object:
        if not index.isValid() or not 0 <= index.row() < len(self._shown):
            return None
        entry = self._shown[index.row()]
        if role == Qt.ItemDataRole.ToolTipRole:
            return f"{self._described(entry)}\n{self._placed(entry)}"
        if role == Qt.ItemDataRole.AccessibleTextRole:
            return self._spoken(entry)
        if role == Qt.ItemDataRole.AccessibleDescriptionRole:
            return f"{self._described(entry)}\n{self._placed(entry)}"
        known = self._facts.get(role)
        return None if known is None else known(entry)

    @cached_property
    def _facts(self) -> dict[int, Callable[[Entry], object]]:
        """What each role asks of a design."""
        return {
            CANDIDATE_ROLE: lambda entry: entry.candidate,
            DESIGN_ROLE: lambda entry: entry.design,
            RISE_ROLE: lambda entry: entry.rise,
            VALUE_ROLE: lambda entry: format_value(self._as_item(entry, 0), self._selection, self._width_mm),
            UNCHECKED_ROLE: self._unchecked,
            NAME_ROLE: lambda entry: self.name_of(entry.candidate),
            NOTE_ROLE: lambda entry: self.note_of(entry.candidate),
            MARK_ROLE: lambda entry: self.mark_of(entry.candidate),
            MATCH_ROLE: lambda entry: self.match_of(entry.candidate),
            VERDICT_ROLE: lambda entry: self.verdict_of(entry.candidate),
            FEATURE_ROLE: lambda entry: entry.candidate.score.evenness.least_feature_mm(self._width_mm),
            THIN_ROLE: lambda entry: not self.ranking.wide_enough(entry.candidate),
            ALIKE_ROLE: lambda entry: self._stacks.under(entry.candidate),
            OPEN_ROLE: lambda entry: self._stacks.is_open(entry.candidate),
            GRID_ROLE: self._grid,
            START_ROLE: lambda entry: start_of(entry.candidate) if self._several_starts() else "",
            FRESH_ROLE: lambda entry: entry.candidate in self._fresh,
        }

    def _unchecked(self, entry: Entry) -> str:
        verdict = self.verdict_of(entry.candidate)
        return verdict.words if self._selection.order is SortOrder.RANK and not verdict.is_checked else ""

    def _grid(self, entry: Entry) -> str:
        rows, columns = entry.candidate.sheet.grid
        several = any(one.candidate.sheet.grid != self._all[0].candidate.sheet.grid for one in self._all)
        return f"{rows} \N{MULTIPLICATION SIGN} {columns}" if several else ""

    def _several_starts(self) -> bool:
        if self._starts_differ is None:
            self._starts_differ = len({start_of(entry.candidate) for entry in self._all}) > 1
        return self._starts_differ

    def _spoken(self, entry: Entry) -> str:
        """Name, match and verdict: the card in one line, for screen readers."""
        candidate = entry.candidate
        words = [
            tr(
                "Design {name}: match {match:.1f} %, {verdict}",
                name=self.name_of(candidate),
                match=100 * self.match_of(candidate),
                verdict=self.verdict_of(candidate).words,
            )
        ]
        mark, alike = self.mark_of(candidate), self._stacks.under(candidate)
        if mark is not Mark.NONE:
            words.append(tr("Pinned") if mark is Mark.PINNED else tr("Rejected"))
        if alike:
            words.append(tr("+{count} alike", count=alike))
        return ", ".join(words)

    def _described(self, entry: Entry) -> str:
        lines = [described(entry.candidate, self.name_of(entry.candidate), self.as_cut_of(entry.candidate))]
        if entry.rise > 0:
            lines.append(tr("Polishing raised sIoU by {rise:.2f} points so far", rise=100 * entry.rise))
        mark = self.mark_of(entry.candidate)
        if mark is not Mark.NONE:
            lines.append(tr("Pinned") if mark is Mark.PINNED else tr("Rejected"))
        if entry.candidate in self._fresh:
            lines.append(tr("Added by the last run"))
        note = self.note_of(entry.candidate)
        if note:
            lines.append(tr("Note: {note}", note=note))
        return "\n".join(lines)

    def _placed(self, entry: Entry) -> str:
        """How small its panels are, why it has its rank, and what lies under its card."""
        lines, reason = [*self._states(entry), self._size(entry)], self._rank_reason(entry)
        if reason:
            lines.append(tr("Rank: {reason}", reason=reason))
        verdict = self.verdict_of(entry.candidate)
        lines += [
            tr("Verdict: {level}", level=verdict.words),
            *(problem.text for problem in verdict.problems),
            verdict.summary,
        ]
        alike = self._stacks.under(entry.candidate)
        if alike:
            lines.append(alike_tip(alike, self._stacks.is_open(entry.candidate)))
        return "\n".join(lines)

    def _rank_reason(self, entry: Entry) -> str:
        """Why a design has its place in the ranking, in one sentence."""
        if self._reasons is None:
            ranked = self.ranking.ranked(one.candidate for one in self._all)
            notes = self.ranking.reasons(ranked)
            self._reasons = {id(one): note for one, note in zip(ranked, notes, strict=True)}
        note = self._reasons.get(id(entry.candidate))
        return "" if note is None else note.text

    def _states(self, entry: Entry) -> tuple[str, ...]:
        """What it starts as and what it opens into, how large, and how well it matches both."""
        if self._target is None:
            return ()
        known = self.as_cut_of(entry.candidate)
        return TwoStates.of(entry.candidate, entry.design, self._target, self._width_mm, known).lines()

    def set_target(self, target: Outline | None) -> None:
        """Set what the designs open into, for their tooltips."""
        self._target = target

    def _size(self, entry: Entry) -> str:
        size = self._width_mm * least_panel_share(entry.design.deployment)
        width = readable_mm(self._width_mm)
        return tr("Smallest feature: {size} on a sheet {width} wide", size=readable_width(size), width=width)

    def verdict_of(self, candidate: Candidate) -> Verdict:
        """The verdict on a design as it is cut now, an estimate until it was made."""
        from kirigami_studio.studio.verdict import expected

        known = self._judged.get(candidate) or self._expected.get(candidate)
        if known is None:
            known = expected(candidate, self.ranking, self._as_cut.get(candidate), self._material)
            self._expected[candidate] = known
        return known

    def set_as_cut(
        self,
        known: Mapping[Candidate, AsCut],
        material: Material | None = None,
        judged: Mapping[Candidate, Verdict] = MappingProxyType({}),
    ) -> None:
        """Take what is known of designs as cut, their material, and the verdicts made of some."""
        self._as_cut, self._material, self._judged = known, material, judged
        self._show_verdicts()

    def _show_verdicts(self) -> None:
        self._expected.clear()
        selection = self._selection
        if selection.works_only or selection.least_match > 0.0 or selection.order is SortOrder.MATCH:
            self._rearrange()
        elif self._shown:
            self.dataChanged.emit(self.index(0, 0), self.index(len(self._shown) - 1, 0))

    def as_cut_of(self, candidate: Candidate) -> AsCut | None:
        """Findings on a design as cut, estimated or made, as far as there are any."""
        return self._as_cut.get(candidate)

    def match_of(self, candidate: Candidate) -> float:
        """The match of a design, 0..1: of its pieces where they are known."""
        return shown_match(candidate, self.as_cut_of(candidate))

    def set_ranking(self, ranking: Ranking) -> None:
        """Tell what can be cut, and why a design has its rank, by a ranking; the order stays."""
        if ranking != self.ranking:
            self.ranking, self._reasons = ranking, None
            self._show_verdicts()

    def rank_by(self, ranking: Ranking) -> None:
        """Put all designs into the order of a ranking, and later ones that are inserted."""
        self.set_ranking(ranking)
        after = sorted(self._all, key=lambda entry: ranking.key(entry.candidate))
        if [id(one) for one in after] != [id(one) for one in self._all]:
            self._all = after
            self._stacks.regroup(after, ranking)
            self._rearrange()

    def set_groups(self, candidates: Sequence[Candidate], groups: Sequence[int]) -> None:
        """Stack designs by groups that were found in the worker."""
        self._stacks.set_groups(candidates, groups)
        self._rearrange()

    def toggle_alike(self, head: Candidate) -> None:
        """Show the designs under a card, or hide them again."""
        self._stacks.toggle(head)
        self._rearrange()

    def reveal(self, candidate: Candidate) -> bool:
        """Show a design that lies under another; whether it did."""
        found = self._stacks.reveal(candidate)
        if found:
            self._rearrange()
        return found

    def head_of(self, candidate: Candidate) -> Candidate | None:
        """The card that a design lies under, None where it lies under none."""
        return self._stacks.head_of(candidate, self._shown)

    def replace(self, entries: list[Entry]) -> None:
        """Show other candidates, best first; those that are the same samples as before keep their cards."""
        before = self._shown
        self._all = list(entries)
        self._stacks.regroup(self._all, self.ranking)
        after = self._arranged()
        same = len(before) == len(after) and all(
            same_sample(old.candidate, new.candidate) for old, new in zip(before, after, strict=True)
        )
        if same and after:
            self._shown = after
            self.dataChanged.emit(self.index(0, 0), self.index(len(after) - 1, 0))
        else:
            self._reset(after)
        self.arranged.emit()

    def insert(self, entry: Entry) -> int:
        """Add one candidate at its rank, in the place of an earlier state of the same sample; return its row.

        -1 when the selection leaves it out.  A design that was there before the run keeps its card, whatever its seed
        and number: it is no earlier state of what the run finds.
        """
        for old, known in enumerate(self._all):
            if not known.kept and same_sample(known.candidate, entry.candidate):
                del self._all[old]
                break
        key = self.ranking.key
        place = bisect.bisect_right(self._all, key(entry.candidate), key=lambda one: key(one.candidate))
        self._all.insert(place, entry)
        self._stacks.regroup(self._all, self.ranking)
        self._rearrange()
        return next((row for row, one in enumerate(self._shown) if one is entry), -1)

    def select(self, selection: Selection) -> None:
        """Show another part, or in another order."""
        if selection != self._selection:
            self._selection = selection
            self._rearrange()

    def set_marks(self, marks: Mapping[Candidate, Mark]) -> None:
        """Set which designs are pinned or rejected; the others are neither."""
        wanted: dict[Candidate, Mark] = {candidate: mark for candidate, mark in marks.items() if mark is not Mark.NONE}
        if wanted != self._marks:
            self._marks = wanted
            self._rearrange()

    def set_fresh(self, fresh: frozenset[Candidate]) -> None:
        """Set which designs the last further run has added."""
        if fresh != self._fresh:
            self._fresh = fresh
            self._rearrange()

    def set_labels(self, labels: Mapping[Candidate, Label]) -> None:
        """Set what the designs are called, and what is noted of them."""
        if labels != self._labels:
            self._labels = dict(labels)
            if self._shown:
                self.dataChanged.emit(self.index(0, 0), self.index(len(self._shown) - 1, 0))

    def set_width_mm(self, width_mm: float) -> None:
        """Set the width of the sheet, for sizes of panels."""
        if width_mm != self._width_mm:
            self._width_mm = width_mm
            if self._selection.least_feature_mm > 0.0:
                self._rearrange()
            elif self._shown:
                self.dataChanged.emit(self.index(0, 0), self.index(len(self._shown) - 1, 0))

    def mark_of(self, candidate: Candidate) -> Mark:
        return self._marks.get(candidate, Mark.NONE) if self._marks else Mark.NONE

    def name_of(self, candidate: Candidate | None) -> str:
        """What a design is called, its number while the run that finds it goes on; "" when there is no such design."""
        label = None if candidate is None else self._labels.get(candidate)
        if label is not None:
            return label.text
        number = self.number_of(candidate)
        return str(number) if number else ""

    def note_of(self, candidate: Candidate) -> str:
        """The user's note on a design."""
        label = self._labels.get(candidate)
        return "" if label is None else label.note

    def number_of(self, candidate: Candidate | None) -> int:
        """The number of a design among all, from 1; 0 when there is no such design."""
        return 1 + _place_of(self._all, candidate)

    def row_of(self, candidate: Candidate | None) -> int:
        """Row of a candidate, -1 when it is not shown."""
        return _place_of(self._shown, candidate)

    def _arranged(self) -> list[Entry]:
        self._reasons = self._starts_differ = None
        designs = [self._as_item(entry, place) for place, entry in enumerate(self._all)]
        self._taken = [self._all[place] for place in places_in_order(designs, self._selection)]
        if self._selection.grouped:
            return self._stacks.stacked(self._taken)
        self._stacks.flat()
        return list(self._taken)

    def _as_item(self, entry: Entry, place: int) -> GalleryItem:
        mark, fresh = self.mark_of(entry.candidate), bool(self._fresh) and entry.candidate in self._fresh
        feature_mm = entry.candidate.score.evenness.least_feature_mm(self._width_mm)
        works = not self._selection.works_only or self.verdict_of(entry.candidate).level.value != "will_not_work"
        match = self.match_of(entry.candidate)
        return GalleryItem(place, entry.candidate, mark, entry.design.deployment, match, fresh, works, feature_mm)

    def _rearrange(self) -> None:
        after = self._arranged()
        stay, known = {id(one) for one in after}, {id(one) for one in self._shown}
        staying = [id(one) for one in after if id(one) in known]
        if [id(one) for one in self._shown if id(one) in stay] == staying and (staying or not known):
            self._leave_out(stay)
            self._put_in(after)
        else:
            self._reset(after)
        self.arranged.emit()

    def _leave_out(self, stay: set[int]) -> None:
        """Remove rows one by one, so that the others keep their places on the screen."""
        for row in reversed(range(len(self._shown))):
            if id(self._shown[row]) not in stay:
                self.beginRemoveRows(QModelIndex(), row, row)
                del self._shown[row]
                self.endRemoveRows()
        if self._shown:
            self.dataChanged.emit(self.index(0, 0), self.index(len(self._shown) - 1, 0))

    def _put_in(self, after: list[Entry]) -> None:
        """Insert the rows that are missing, one by one."""
        for row, entry in enumerate(after):
            if row >= len(self._shown) or self._shown[row] is not entry:
                self.beginInsertRows(QModelIndex(), row, row)
                self._shown.insert(row, entry)
                self.endInsertRows()

    def _reset(self, entries: list[Entry]) -> None:
        self.beginResetModel()
        self._shown = entries
        self.endResetModel()


def _place_of(entries: list[Entry], candidate: Candidate | None) -> int:
    if candidate is None:
        return -1
    for place, entry in enumerate(entries):
        if entry.candidate is candidate:
            return place
    return next((place for place, entry in enumerate(entries) if entry.candidate == candidate), -1)


def described(candidate: Candidate, name: str, as_cut: AsCut | None = None) -> str:
    """Describe a candidate, with its findings as cut, for tooltips and screen readers."""
    score = candidate.score
    values = {"name": name, "siou": 100 * score.siou, "iou_exact": 100 * score.iou_exact}
    lines = [
        tr("Design {name}: match {iou_exact:.2f} % (exact IoU; sIoU {siou:.2f} %)", **values)
        if as_cut is None or not as_cut.of_pieces
        else tr(
            "Design {name}: match {match:.2f} % (its pieces; lattice {iou_exact:.2f} %, sIoU {siou:.2f} %)",
            match=100 * shown_match(candidate, as_cut),
            **values,
        ),
        tr(
            "Evenness: panel sizes vary by {percent:.0f} % (coefficient of variation of their areas)",
            percent=100 * score.evenness.area_cv,
        ),
        rim_text(candidate),
        *symmetry_text(candidate),
        tr(
            "Match gained over a sheet of equal cuts: {siou_gain:+.2f} points (that has {uniform_siou:.2f} %)",
            siou_gain=100 * score.siou_gain,
            uniform_siou=100 * score.uniform_siou,
        ),
        tr("Total variation (TV) of the ratios: {tv:.3f}", tv=score.tv),
        *trimming(candidate),
        motion(candidate),
        *came_from(candidate),
    ]
    return "\n".join([*lines, *problems(candidate)])


def rim_text(candidate: Candidate) -> str:
    """Where the cuts meet the rim, and how large the grid is."""
    sheet = candidate.final_sheet
    if sheet.has_even_rim:
        return tr("{rows} \N{MULTIPLICATION SIGN} {columns} voids, even rim", rows=sheet.rows, columns=sheet.columns)
    return tr("{rows} \N{MULTIPLICATION SIGN} {columns} voids, free rim", rows=sheet.rows, columns=sheet.columns)


def alike_tip(count: int, opened: bool) -> str:
    """What lies under a card, and what a click on its mark does."""
    if opened:
        return tr_n(
            "{count} design that looks the same is shown after it. Click the mark or press Enter to hide it.",
            "{count} designs that look the same are shown after it. Click the mark or press Enter to hide them.",
            count,
        )
    return tr_n(
        "{count} more design looks the same. Click the mark or press Enter to show it.",
        "{count} more designs look the same. Click the mark or press Enter to show them.",
        count,
    )


def symmetry_text(candidate: Candidate) -> list[str]:
    """Which symmetry a design keeps, if any."""
    symmetry = candidate.symmetry
    return [] if symmetry is None else [tr(SYMMETRY_TEXTS[symmetry])]


#: What each symmetry means for the eye.
SYMMETRY_TEXTS = {
    Symmetry.LEFT_RIGHT: mark("Symmetric: its own mirror image at every angle"),
    Symmetry.TOP_BOTTOM: mark("Symmetric: its own mirror image at every angle"),
    Symmetry.TWO_MIRRORS: mark("Symmetric: its own mirror image both ways at every angle"),
    Symmetry.HALF_TURN: mark("Symmetric: the same after half a turn"),
    Symmetry.QUARTER_TURN: mark("Symmetric: the same after a quarter turn"),
}


def came_from(candidate: Candidate) -> list[str]:
    """Which model generated a design, from which seed, and how."""
    origin = {
        Origin.SAMPLED: tr("Seed {seed}, sample {index}", seed=candidate.seed, index=candidate.index),
        Origin.GUIDED: tr("Fitted from the uniform sheet"),
        Origin.SEARCHED: tr("Seed {seed}, found by the search", seed=candidate.seed),
        Origin.RESAMPLED: tr("Seed {seed}, generated near another design", seed=candidate.seed),
        Origin.COVERED: tr("Fitted to cover the target; what sticks out of it is cut away"),
        Origin.EDITED: tr("Seed {seed}, sample {index}, edited by hand", seed=candidate.seed, index=candidate.index),
    }[candidate.origin]
    polished = [tr("Polished")] if candidate.polished else []
    return [origin, *polished, *([tr("Model: {name}", name=candidate.variant)] if candidate.variant else [])]


def trimming(candidate: Candidate) -> list[str]:
    """How a trimmed design scores, apart from the untrimmed one."""
    trim = candidate.trim
    if trim is None:
        return []
    return [
        tr(
            "Trimmed: IoU {iou:.2f} % ({untrimmed_iou:.2f} % untrimmed); {removed_share:.1f} % of the sheet is cut off",
            iou=100 * trim.iou,
            untrimmed_iou=100 * trim.untrimmed_iou,
            removed_share=100 * trim.removed_share,
        )
    ]


def motion(candidate: Candidate) -> str:
    """How far the sheet opens before it touches itself."""
    score = candidate.score
    if score.contact is None:
        return tr("Opens from 180° to {phi:.1f}° without contact", phi=math.degrees(score.phi))
    return tr("Touches itself at {phi:.1f}° while opening", phi=math.degrees(score.contact.phi))


def problems(candidate: Candidate) -> list[str]:
    """Sentences on what keeps a candidate from being feasible; empty when nothing does."""
    score = candidate.score
    found = []
    if score.n_invalid:
        found.append(tr("Invalid panels or voids: {n_invalid}.", n_invalid=score.n_invalid))
    if score.contact is not None:
        x, y = score.contact.where
        found.append(tr("First contact near ({x:.2f}, {y:.2f}) unit cells.", x=x, y=y))
    if not score.feasible and not found:
        found.append(
            tr("Panels overlap by {overlap_ratio:.2f} % of their area.", overlap_ratio=100 * score.overlap_ratio)
        )
    return found
