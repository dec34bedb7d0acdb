"""Places that hold a sheet, in the files of its pieces: record, findings and lists."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kirigami_studio.assembly.holding import HoldPlace
from kirigami_studio.export.pieces_read import HOLE_MM, FoundPiece
from kirigami_studio.export.verification import Finding
from kirigami_studio.fabricate.hold import HeldState, HoldKind, HoldOptions
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.lattice.deployment import rotate

#: Holes that come no farther apart than this (mm) in the other end state hold nothing.
LEAST_WAY_MM = 1.0
#: The step of assembly that each kind adds.
HOLD_STEPS = {
    HoldKind.MAGNETS: mark(
        "Glue a magnet into each hole of a numbered place, with the pole in the list towards you (N, S): mark one pole "
        "of the stack first. Where two letters of layers stand there, A and B, the magnets face each other: flush with "
        "the faces between the layers. Else they lie side by side."
    ),
    HoldKind.EYELETS: mark(
        "Set eyelets into the holes of numbered places. Where A and B stand there, a spare pin goes through both "
        "layers; else tie both eyelets with a ring or a cord."
    ),
    HoldKind.STITCHES: mark(
        "Move the sheet to the picture with the numbered places, then sew through the holes of each."
    ),
    HoldKind.TABS: mark(
        "Move the sheet to the picture with the numbered places, then stick tape over the edge of each, on the outer "
        "face; on layer 2 the engraved mark is on the other one."
    ),
}
#: The same where parts of one thickness lie side by side alone: tiles, and what is printed.
SIDE_BY_SIDE_STEPS = HOLD_STEPS | {
    HoldKind.MAGNETS: mark(
        "Glue a magnet into each hole of a numbered place, with the pole in the list towards you (N, S): mark one pole "
        "of the stack first."
    ),
    HoldKind.EYELETS: mark("Set eyelets into the holes of numbered places, and tie both with a ring or a cord."),
    HoldKind.TABS: mark(
        "Move the sheet to the picture with the numbered places, then stick tape over the edge of each."
    ),
}
#: Names of the lines of the parts list, by what they keep.
KEPT = {HeldState.FLAT: mark("keep it flat"), HeldState.OPEN: mark("keep it open")}
#: Parts of each kind at a place.
COUNTS = {HoldKind.MAGNETS: 2, HoldKind.EYELETS: 2, HoldKind.STITCHES: 1, HoldKind.TABS: 1}


def holds_json(places: Sequence[HoldPlace], decimals: int) -> list[dict[str, Any]]:
    """Places as plain lists: middles of holes, or corners of tabs, in each piece's frame, mm."""
    return [
        {
            "number": place.number,
            "state": place.state.value,
            "kind": place.kind.value,
            "pieces": list(place.parts),
            "at": [(points.round(decimals) + 0.0).tolist() for points in place.at],
            "through": place.through,
            "apart_mm": round(place.apart_mm, decimals),
            "poles": list(place.poles) if place.poles[0] else [],
        }
        for place in places
    ]


def hold_findings(pieces: Mapping[str, FoundPiece], record: Mapping[str, Any]) -> list[Finding]:
    """Whether holes that hold a sheet meet in their state, and only there.

    Parameters
    ----------
    pieces : mapping of str to FoundPiece
        As files have them.
    record : mapping
        Content of ``pieces.json``.
    """
    holes = [hold for hold in record.get("holds", ()) if hold["kind"] != HoldKind.TABS]
    if not holes:
        return []
    poses = {HeldState.FLAT: record["motion"][0]["poses"], HeldState.OPEN: record["motion"][-1]["poses"]}
    miss, way = 0.0, np.inf
    for hold in holes:
        ends = []
        for name, at in zip(hold["pieces"], hold["at"], strict=True):
            centres = np.array([hole.centre for hole in pieces[name].holes])
            away = np.linalg.norm(centres[:, None] - np.array(at), axis=2)
            miss = max(miss, float(away.min(axis=0).max()))
            ends.append(centres[away.argmin(axis=0)[0]])
        apart = {
            state: float(np.linalg.norm(np.subtract(*_placed(ends, hold["pieces"], poses[state])))) for state in poses
        }
        held = apart.pop(HeldState(hold["state"]))
        miss = max(miss, abs(held - hold["apart_mm"]))
        way = min(way, *(abs(other - held) for other in apart.values()))
    right = miss <= 2.0 * HOLE_MM and way >= LEAST_WAY_MM
    code = "verify.holds_meet" if right else "verify.holds_miss"
    return [Finding.judged(right, code, count=len(holes), miss_um=round(1e3 * miss, 2))]


def _placed(ends: Sequence[FloatArray], names: Sequence[str], poses: Mapping[str, Sequence[float]]) -> list[FloatArray]:
    return [rotate(end, poses[name][2]) + np.array(poses[name][:2]) for end, name in zip(ends, names, strict=True)]


@dataclass(frozen=True, slots=True)
class PartsEntry:
    """Parts of one state in the parts list: how many, how wide and high, and a note."""

    item: str
    count: int
    diameter_mm: float | None
    length_mm: float | None
    note: str


def hold_lines(places: Sequence[HoldPlace], options: HoldOptions) -> list[PartsEntry]:
    """Lines of the parts list."""
    found = []
    for state in HeldState:
        here = [place for place in places if place.state is state]
        if not here:
            continue
        count, kept = COUNTS[options.kind] * len(here), tr(KEPT[state])
        where = "; ".join(place_words(place) for place in here)
        if options.kind is HoldKind.MAGNETS:
            beside = [place.apart_mm for place in here if not place.through]
            notes = [tr("holes {hole:g} mm", hole=options.hole_mm)]
            if beside:
                notes.insert(0, tr("about {pull:.2f} N a pair side by side", pull=options.pull_n(max(beside))))
            note = f"{kept}: {'; '.join((*notes, where))}"
            found.append(PartsEntry("magnets", count, options.magnet_mm, options.magnet_height_mm, note))
        elif options.kind is HoldKind.TABS:
            tape = tr("adhesive tape")
            found.append(PartsEntry("tabs", count, None, None, f"{kept}: {tape}; {where}"))
        else:
            sewn = options.kind is HoldKind.STITCHES
            means = tr("thread") if sewn else tr("with a spare pin, a ring or a cord")
            note = f"{kept}: {means}; {where}"
            found.append(PartsEntry(options.kind.value, count, options.hole_mm, None, note))
    return found


def place_words(place: HoldPlace) -> str:
    """A place with its number, pieces and poles: ``3 A4+B6 N N``."""
    poles = " ".join(("", *place.poles)) if place.poles[0] else ""
    return f"{place.number} {'+'.join(place.parts)}{poles}"
