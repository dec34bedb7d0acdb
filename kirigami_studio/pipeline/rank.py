"""Which design comes first: what can be cut before what cannot, then the best balance of match and regularity.

The *worth* of a design is its exact IoU less a price for what eyes and cutters mind:

    worth = IoU - JAMMING * share of its way that it misses as cut
                - what it was found to lose as cut
                - weight * (1 - IoU at the second target's angle)
                - s * (EVENNESS * CV of panel areas + THIN * thinness + AT_LIMIT * share of ratios at a limit
                       + GIVEN_UP * share of the sheet that is cut away
                       - SYMMETRY * how far its symmetry is seen),        s = (2 * regular) ** 2

``regular`` runs from 0 (s = 0: match alone) over 0.5 (s = 1) to 1 (s = 4).  Thinness is 0 for panels whose edges and
necks all measure :data:`SLENDER` cells or more, and 1 for a panel without any width.  All figures are those that a
score has, so that ranking again needs no geometry.  A second target counts where designs were made for one.  Where it
is known at which angle designs jam as cut, the share of its way that a design does not come costs :data:`JAMMING`,
whatever ``regular`` is: the match is missed as well.  A design of which parts are cut away has the IoU of what stays,
and its price; where a run was asked to trim its best designs these come first.  Ties keep the lower total variation,
then the sampling order.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.pins import GAP_ROUNDING
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.pipeline.request import Request
from kirigami_studio.polish.preferences import FitPreference

#: IoU (0..1) that a coefficient of variation of panel areas lower by 1 is worth: 0.4 rather than 0.8 is worth 1 %.
EVENNESS = 0.025
#: IoU that a sheet without thin panels is worth over one with a panel of no width.
THIN = 0.005
#: Edges and necks (unit cells) below this count as thin.
SLENDER = 0.2
#: IoU that a sheet without ratios at a limit is worth over one with nothing else.
AT_LIMIT = 0.01
#: IoU that a symmetric sheet may lack and still comes first.  A leaf lacks 0.019, a mushroom 0.0205; above 0.024 clubs
#: and spades would be symmetric at 0.97 instead of 0.99.
SYMMETRY = 0.022
#: Share of that which a turn is worth: eyes see a mirror axis at once, a turn hardly.
TURN_SHARE = 0.5
#: Below the second match a symmetric sheet is worth less, and from the first one down nothing: what it misses is seen
#: before its symmetry is.  An icon was symmetric at 0.950 where 0.970 was found.
SYMMETRY_SEEN = (0.95, 0.975)
#: IoU that a sheet which is cut from whole is worth over one of which everything is cut away: a cover that gives up a
#: tenth of its sheet comes first where it matches better by 1 %.
GIVEN_UP = 0.1
#: The same of pinned sheets: pieces of whole ones are cut along the target, too, and show both ends of the motion.
GIVEN_UP_ON_PINS = 0.2
#: Share of the distance of pins from which on pieces are made and checked: of seven sheets of an hourglass from a disk
#: none kept it, by 1 % at most, and the pieces of the best had nothing to be said of their pins.
NEARLY_APART = 0.97
#: IoU that a sheet which comes to its angle is worth over one that stays flat: jamming at 36 of 180 degrees costs 5 %.
JAMMING = 0.25

#: The IoU that this preference gives away for a total variation (per void) that is lower by 1.
WORTH = {
    FitPreference.ACCURACY: 0.0,
    FitPreference.BALANCED: 0.0,
    FitPreference.REGULARITY: 0.005,
    FitPreference.CALM: 0.03,
}
#: The worth that a fit may lose at most for a lower total variation: less still counts as equal.
MOST_LOST = 0.003
#: What is tried where a fit has lost more than it may.
MILDER = {FitPreference.CALM: FitPreference.REGULARITY}

#: Sorting key of a candidate; smaller is better.
Key = tuple[bool, bool, bool, bool, bool, float, bool, float, int]


@dataclass(frozen=True, slots=True)
class Ranking:
    """What the user wants first."""

    regular: float = 0.5  #: 0..1; from match alone (0) to even panels (1)
    width_mm: float = 100.0  #: Width of the flat sheet
    least_feature_mm: float = 0.0  #: Least panel edge and neck that the material allows, 0 where that is not known
    least_gap_mm: float = 0.0  #: How far apart pins have to stay; 0 for sheets without pins
    #: radians; angles at which designs are expected to jam as cut, 0 for those that close; nothing is known of others
    jam_phi: Mapping[Candidate, float] = field(default_factory=dict, hash=False)
    #: Why designs that were looked at closely cannot be cut; they come after all others that are feasible
    refusals: Mapping[Candidate, Note] = field(default_factory=dict, hash=False)
    #: Worth that designs which were looked at closely lose by being cut
    losses: Mapping[Candidate, float] = field(default_factory=dict, hash=False)
    trimmed_first: bool = False  #: Whether trimmed designs come first, whatever they are worth: they were asked for

    @classmethod
    def of(cls, request: Request) -> Ranking:
        """As a request asks for it."""
        sizes = request.width_mm, request.least_feature_mm, request.least_gap_mm
        return cls(request.regular, *sizes, trimmed_first=request.trims)

    def wide_enough(self, candidate: Candidate) -> bool:
        """Whether all panels are as wide as the material needs them."""
        return candidate.score.evenness.least_feature_mm(self.width_mm) >= self.least_feature_mm

    def pins_apart(self, candidate: Candidate) -> bool:
        """Whether the pins of a pinned sheet stay as far apart as they have to.

        Where its pieces were made these tell.
        """
        return candidate in self.losses or self._pins_at(candidate, 1.0)

    def nearly_cuttable(self, candidate: Candidate) -> bool:
        """Whether a closer look may find that it can be cut.

        Fits ask for more room between pins than ears need.
        """
        fits = self.wide_enough(candidate) and self._pins_at(candidate, NEARLY_APART)
        return candidate.score.feasible and fits and candidate not in self.refusals

    def _pins_at(self, candidate: Candidate, share: float) -> bool:
        """Whether pins keep this share of their distance."""
        least = share * self.least_gap_mm * candidate.score.evenness.width / self.width_mm
        return not least or candidate.least_gap >= least - GAP_ROUNDING

    def pins_note(self, candidate: Candidate) -> Note:
        """Say how near the pins of a pinned sheet come."""
        gap_mm = candidate.least_gap * self.width_mm / candidate.score.evenness.width
        return Note.of("rank.pins_too_near", gap_mm=gap_mm, least_mm=self.least_gap_mm)

    def cuttable(self, candidate: Candidate) -> bool:
        """Whether it can be cut as far as is known.

        It is feasible, its panels are as wide and its pins as far apart as they have to be, and nobody found otherwise.
        """
        fits = self.wide_enough(candidate) and self.pins_apart(candidate)
        return candidate.score.feasible and fits and candidate not in self.refusals

    def missed(self, candidate: Candidate) -> float:
        """Share of its way from flat to its angle that a design does not come as cut, as far as that is known."""
        jam, phi = self.jam_phi.get(candidate, 0.0), candidate.final_phi
        return max(0.0, jam - phi) / (math.pi - phi)

    @property
    def scale(self) -> float:
        """What all prices are multiplied with: 0 for match alone, 1 half way, 4 for regular sheets."""
        return (2.0 * self.regular) ** 2

    def prices(self, candidate: Candidate) -> dict[str, float]:
        """Prices that are taken off the IoU, by the codes of their reasons."""
        scale, figures = self.scale, candidate.score.evenness
        thinness = max(0.0, 1.0 - min(figures.least_edge, figures.least_neck) / SLENDER)
        return {
            "rank.less_even": scale * EVENNESS * figures.area_cv,
            "rank.thinner": scale * THIN * thinness,
            "rank.more_at_limit": scale * AT_LIMIT * figures.at_limit,
            "rank.not_symmetric": scale * SYMMETRY * (1.0 - _seen_symmetry(candidate)),
            "rank.gives_up": scale * (GIVEN_UP_ON_PINS if self.least_gap_mm else GIVEN_UP) * candidate.given_up,
            "rank.jams": JAMMING * self.missed(candidate),
            "rank.less_as_cut": self.losses.get(candidate, 0.0),
            "rank.less_second": 0.0 if candidate.second is None else candidate.second.price,
        }

    def worth(self, candidate: Candidate) -> float:
        """IoU less all prices."""
        return candidate.score.iou_exact - sum(self.prices(candidate).values())

    def worth_as_made(self, candidate: Candidate) -> float:
        """The same with the trimmed IoU of a design that is trimmed."""
        return candidate.match - sum(self.prices(candidate).values())

    def made_match(self, candidate: Candidate) -> float:
        """Exact IoU of a design as made: trimmed, if it is; of its pieces where known."""
        return candidate.match - (self.losses.get(candidate, 0.0) if self.least_gap_mm else 0.0)

    def key(self, candidate: Candidate) -> Key:
        """Sorting key; smaller is better."""
        score = candidate.score
        return (
            not score.feasible,
            candidate in self.refusals,
            self.trimmed_first and candidate.trim is None,
            not self.pins_apart(candidate),
            not self.wide_enough(candidate),
            -self.worth_as_made(candidate),
            candidate.symmetry is None,
            score.tv,
            candidate.index,
        )

    def ranked(self, candidates: Iterable[Candidate]) -> tuple[Candidate, ...]:
        """Candidates sorted best first."""
        return tuple(sorted(candidates, key=self.key))

    def improves(self, after: Candidate, before: Candidate, prefer: FitPreference) -> bool:
        """Whether a fitted design may take the place of the one it came from.

        It has to be worth more, unless only one of the two can be cut.  A fit that prefers low total variation may give
        away some worth for it; that is no more than :data:`MOST_LOST`, and what was gained in total variation outweighs
        it.
        """
        price, can_cut = WORTH[prefer], self.cuttable(after)
        if can_cut is not self.cuttable(before) and after.score.feasible is before.score.feasible:
            return can_cut

        def key(candidate: Candidate) -> tuple[bool, float, float]:
            score = candidate.score
            return not score.feasible, price * score.tv - self.worth(candidate), score.tv

        kept = self.worth(after) >= self.worth(before) - MOST_LOST or not before.score.feasible
        return kept and key(after) < key(before)

    def reasons(self, candidates: Sequence[Candidate]) -> list[Note]:
        """Why each of these candidates, sorted best first, has its place: in one short sentence each."""
        if not candidates:
            return []
        first = candidates[0]
        most = max(self.made_match(one) for one in candidates if (one.trim is None) is (first.trim is None))
        why = self.why_filled(candidates) or self._why_first(first, most)
        return [why, *(self._why_later(one, first) for one in candidates[1:])]

    def why_filled(self, candidates: Sequence[Candidate]) -> Note | None:
        """Why a sheet with filled holes comes before trims with open ones; None where none does."""
        if candidates[0].trim is not None or not self.cuttable(candidates[0]):
            return None
        why = next((self.refusals[one] for one in candidates if one in self.refusals and opens_holes(one)), None)
        if why is None:
            return None
        place = {name: why.fields[name] for name in ("x", "y") if name in why.fields}
        code = "rank.holes_filled_there" if len(place) == 2 else "rank.holes_filled"
        return Note.of(code, why=why.text, **place)

    def _why_first(self, first: Candidate, most: float) -> Note:
        even = first.score.evenness
        if not self.cuttable(first):
            return self._why_not(first)
        if first.trim is not None and opens_holes(first):
            return Note.of("rank.holes_cut_out", match=100 * first.trim.iou, count=first.trim.given_up)
        if first.trim is not None and first.trim.given_up:
            shares = {"match": 100 * self.made_match(first), "percent": 100 * first.given_up}
            return Note.of("rank.notch_cut_out", **shares, count=first.trim.given_up)
        if first.trim is not None:
            code = "rank.best_trimmed" if first.trim.iou >= most else "rank.best_balance_trimmed"
            return Note.of(code, match=100 * first.trim.iou, variation=100 * even.area_cv)
        plain, symmetric = "rank.best_balance", "rank.best_balance_symmetric"
        match = 100 * self.made_match(first)
        if match >= 100 * most:
            plain, symmetric = "rank.best_match", "rank.best_match_symmetric"
        code = plain if first.symmetry is None else symmetric
        if first.second is not None:
            angle, second = math.degrees(first.second.target.phi), 100 * first.second.match.iou_exact
            return Note.of("rank.best_of_both", match=match, second=second, angle=angle)
        return Note.of(code, match=match, variation=100 * even.area_cv)

    def _why_later(self, one: Candidate, first: Candidate) -> Note:
        if not self.cuttable(one):
            return self._why_not(one)
        if self.trimmed_first and first.trim is not None and one.trim is None:
            return Note.of("rank.not_trimmed")
        own, others = self.prices(one), self.prices(first)
        behind = {code: own[code] - others[code] for code in own}
        behind["rank.less_match"] = self.made_match(first) - self.made_match(one)
        if self.least_gap_mm:
            del behind["rank.less_as_cut"]  # it is in the match
        code = max(behind, key=behind.__getitem__)
        if behind[code] < 5e-5:
            return Note.of("rank.equal")
        if code == "rank.less_match" and first.trim is not None and one.trim is not None:
            return Note.of("rank.less_trimmed_match", match=100 * one.match, first=100 * first.match)
        even, best = one.score.evenness, first.score.evenness
        mine, theirs = {
            "rank.less_match": (100 * self.made_match(one), 100 * self.made_match(first)),
            "rank.less_even": (100 * even.area_cv, 100 * best.area_cv),
            "rank.thinner": (even.least_feature_mm(self.width_mm), best.least_feature_mm(self.width_mm)),
            "rank.more_at_limit": (100 * even.at_limit, 100 * best.at_limit),
            "rank.not_symmetric": (0.0, 0.0),
            "rank.gives_up": (100 * one.given_up, 100 * first.given_up),
            "rank.jams": (math.degrees(self.jam_phi.get(one, 0.0)), math.degrees(self.jam_phi.get(first, 0.0))),
            "rank.less_as_cut": (100 * self.losses.get(one, 0.0), 100 * self.losses.get(first, 0.0)),
            "rank.less_second": (_second(one), _second(first)),
        }[code]
        return Note.of(code, own=mine, first=theirs)

    def _why_not(self, one: Candidate) -> Note:
        """Why a design cannot be cut."""
        if not one.score.feasible:
            return Note.of("rank.not_feasible")
        if one in self.refusals:
            return self.refusals[one]
        if not self.pins_apart(one):
            return self.pins_note(one)
        smallest_mm = one.score.evenness.least_feature_mm(self.width_mm)
        return Note.of("rank.too_thin", smallest_mm=smallest_mm, least_mm=self.least_feature_mm)


def opens_holes(candidate: Candidate) -> bool:
    """Whether a design is trimmed to a target with holes."""
    return candidate.trim is not None and bool(candidate.trim.holes)


def _seen_symmetry(candidate: Candidate) -> float:
    """How far the symmetry of a design is seen, from 0 to 1."""
    if candidate.symmetry is None:
        return 0.0
    low, high = SYMMETRY_SEEN
    fair = min(1.0, max(0.0, (candidate.match - low) / (high - low)))
    return fair * (TURN_SHARE if candidate.symmetry is Symmetry.HALF_TURN else 1.0)


def _second(candidate: Candidate) -> float:
    """Match with the second target, %; 100 where there is none."""
    return 100.0 if candidate.second is None else 100.0 * candidate.second.match.iou_exact


#: What a run wants first unless it is asked for something else.
USUAL = Ranking()
