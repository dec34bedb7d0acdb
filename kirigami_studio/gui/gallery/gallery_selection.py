"""Which designs of the gallery are shown, and in which order: a choice of the view, not of the document."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import Enum

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.fabricate.panel_sizes import least_panel_share
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.gui.widgets.readable import readable_width
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.pipeline.variety import distances
from kirigami_studio.project.document import Mark


class SortOrder(Enum):
    """What the gallery is sorted by; always from the best, the largest or the most regular on."""

    RANK = "rank"
    MATCH = "match"
    EVENNESS = "evenness"
    GAIN = "gain"
    TV = "tv"
    PANEL = "panel"
    NEWEST = "newest"
    UNLIKE = "unlike"


@dataclass(frozen=True, slots=True)
class Selection:
    """What the user wants to see."""

    order: SortOrder = SortOrder.RANK
    pinned_first: bool = False
    pinned_only: bool = False
    works_only: bool = False  #: whether designs are left out whose verdict is that they will not work
    whole_only: bool = False  #: whether designs are left out of which parts are cut away
    show_rejected: bool = False
    least_match: float = 0.0  #: 0..1; exact IoU that a design has at least
    most_variation: float = 0.0  #: coefficient of variation of panel areas that a design has at most; 0 for any
    least_feature_mm: float = 0.0  #: smallest panel edge or neck that a design has at least
    grouped: bool = True  #: whether designs that look the same are one card
    #: Design that :attr:`SortOrder.UNLIKE` measures from; it stays while the user looks from card to card, so that the
    #: cards stay in their places.
    unlike: Sheet | None = None

    @property
    def filters(self) -> bool:
        """Whether more is left out than rejected designs."""
        numbers = (self.least_match, self.most_variation, self.least_feature_mm)
        return self.pinned_only or self.works_only or self.whole_only or max(numbers) > 0.0

    def unfiltered(self) -> Selection:
        """The same order, everything shown."""
        everything = Selection(show_rejected=True)
        kept = (self.order, self.pinned_first, self.grouped, self.unlike)
        return replace(everything, order=kept[0], pinned_first=kept[1], grouped=kept[2], unlike=kept[3])

    def takes(self, item: GalleryItem) -> bool:
        """Whether a design is shown."""
        score, mark = item.candidate.score, item.mark
        return (
            (mark is Mark.PINNED or not self.pinned_only)
            and (item.works or not self.works_only)
            and (item.candidate.trim is None or not self.whole_only)
            and (mark is not Mark.REJECTED or self.show_rejected)
            and item.match >= self.least_match
            and (not self.most_variation or score.evenness.area_cv <= self.most_variation)
            and item.feature_mm >= self.least_feature_mm
        )


@dataclass(frozen=True, slots=True)
class GalleryItem:
    """One design of the gallery: its place in the document counts from 0; fresh are the last run's.

    ``match`` (0..1) is the one that its card shows, ``works`` whether its verdict is not that it will not work, and
    ``feature_mm`` its smallest edge or neck, in material and width chosen.
    """

    place: int
    candidate: Candidate
    mark: Mark
    deployment: Deployment = field(repr=False)
    match: float
    fresh: bool = False
    works: bool = True
    feature_mm: float = math.inf


def places_in_order(designs: Sequence[GalleryItem], selection: Selection) -> list[int]:
    """Places of the designs that are shown, in the order in which they are shown."""
    taken = [one for one in designs if selection.takes(one)]
    values = sorting_values(taken, selection)
    keys = {
        one.place: (selection.pinned_first and one.mark is not Mark.PINNED, value, one.place)
        for one, value in zip(taken, values, strict=True)
    }
    return sorted(keys, key=lambda place: keys[place])


def sorting_values(designs: Sequence[GalleryItem], selection: Selection) -> list[float]:
    """By what each design is sorted; smaller comes first."""
    order = selection.order
    if order is SortOrder.MATCH:
        return [-one.match for one in designs]
    if order is SortOrder.EVENNESS:
        return [one.candidate.score.evenness.area_cv for one in designs]
    if order is SortOrder.GAIN:
        return [-one.candidate.score.siou_gain for one in designs]
    if order is SortOrder.TV:
        return [one.candidate.score.tv for one in designs]
    if order is SortOrder.PANEL:
        return [-least_panel_share(one.deployment) for one in designs]
    if order is SortOrder.NEWEST:
        return [0.0 if one.fresh else 1.0 for one in designs]
    if order is SortOrder.UNLIKE:
        return [-value for value in differences([one.candidate for one in designs], selection.unlike)]
    return [0.0] * len(designs)


def differences(candidates: Sequence[Candidate], origin: Sheet | None) -> list[float]:
    """How different each design is from one: of log10 x and of the mouths, in the best turn."""
    if origin is None or not candidates:
        return [0.0] * len(candidates)
    same = [candidate.sheet.grid == origin.grid for candidate in candidates]
    if not all(same):
        return [0.0] * len(candidates)
    found: list[float] = distances(origin, [candidate.sheet for candidate in candidates]).tolist()
    return found


def format_value(item: GalleryItem, selection: Selection, width_mm: float) -> str:
    """What a card says of the number that it is sorted by."""
    if selection.order is SortOrder.PANEL:
        return tr("smallest {size}", size=readable_width(width_mm * least_panel_share(item.deployment), 1))
    if selection.order is SortOrder.UNLIKE and selection.unlike is not None:
        return tr("differs {value:.2f}", value=differences([item.candidate], selection.unlike)[0])
    if selection.order is SortOrder.TV:
        return tr("roughness {value:.2f}", value=item.candidate.score.tv)
    if selection.order is SortOrder.GAIN:
        return tr("gained {value:+.1f}", value=100.0 * item.candidate.score.siou_gain)
    return tr("panels ±{percent:.0f} %", percent=100.0 * item.candidate.score.evenness.area_cv)


def count_text(shown: int, total: int) -> str:
    """How many cards there are, for the gallery's head; "" where there are none."""
    if total == 0:
        return ""
    if shown == total:
        return tr_n("{count} design", "{count} designs", total)
    return tr("{shown} of {total} shown", shown=shown, total=total)
