"""The record that a cut file has of how it was made, read from its facts.

A file may come from anywhere: its record is plain text of which only bounded numbers and known words are taken.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, fields

from kirigami_studio.export.dxf_reading import MOST_PIECES
from kirigami_studio.export.profile import Profile, find_profile
from kirigami_studio.export.provenance import ONE_SHEET, PROGRAM, SLOT_KERF, VERDICT
from kirigami_studio.fabricate.cut_plan import LARGEST_SHEET_MM, SMALLEST_SHEET_MM
from kirigami_studio.fabricate.fastener import Fastener
from kirigami_studio.fabricate.material import Construction
from kirigami_studio.fabricate.options import COPY_GAP_MM, TAB_MM, ConnectorStyle, CutOptions, CutOrder
from kirigami_studio.foundation.errors import ExportError, KirigamiError
from kirigami_studio.foundation.plain_text import plain_line

#: Letters of a fact that are looked at and that are repeated, and the largest number of anything.
LONGEST_FACT, LONGEST_SAID, LARGEST_COUNT = 255, 40, 10_000_000
#: The thinnest connector that a record may name, mm.
LEAST_MM = 1e-6
#: A number as records have it; Python reads others, too.
NUMBER = re.compile(r"\d{1,20}(?:\.\d{1,20})?(?:e[-+]?\d{1,3})?", re.ASCII)
#: A connector with a width of its own, and the name of a piece of a list.
SINGLE = re.compile(r"(\d{1,6})=(\d{1,6}(?:\.\d{1,20})?(?:e-?\d{1,2})?)")


@dataclass(frozen=True, slots=True)
class FileRecord:
    """How a cut file says it was made."""

    version: str  #: of the program
    design: str  #: identifies the sheet, see ``CutPlan.design_hash``
    construction: str  #: "one-sheet", or "backed" for a hinge layer
    #: material, machine: keys of the preset, and of the machine that was asked for, "" for the one that the material is
    #: for.
    material: str
    machine: str
    profile: Profile
    options: CutOptions
    #: width_mm, connector_mm, kerf_mm: of the flat sheet, of connectors as asked for, and of the cut that the plan
    #: allowed for.
    width_mm: float
    connector_mm: float
    kerf_mm: float
    least_connector_mm: float  #: width of the narrowest connector
    lines: int  #: lines that are cut
    trimmed: int  #: panels of which something was trimmed off
    name: str  #: that was to be engraved, "" for none
    verdict: str  #: level of the verdict of the export, "" where there was none

    def to_json(self) -> dict[str, object]:
        """For the command line."""
        options = self.options
        return {
            "version": self.version,
            "design": self.design,
            "construction": self.construction,
            "material": self.material,
            "machine": self.machine,
            "profile": self.profile.key,
            "style": options.style.value,
            "order": options.order.value,
            "width_mm": self.width_mm,
            "connector_mm": self.connector_mm,
            "least_connector_mm": self.least_connector_mm,
            "kerf_mm": self.kerf_mm,
            "copies": options.copies,
            "tabs": options.tabs,
            "removed": list(options.removed),
            "hinge_mm": [list(pair) for pair in options.hinge_mm],
            "trimmed_panels": self.trimmed,
            "engraved": self.name,
        }


def record_of(facts: Mapping[str, str]) -> FileRecord | None:
    """The record among a file's facts; None for files of others and of earlier versions.

    Raises
    ------
    ExportError
        A record that no export writes.
    """
    if PROGRAM not in facts or "STYLE" not in facts:
        return None
    read = _Facts(facts)
    return FileRecord(
        version=read.text(PROGRAM),
        design=read.text("DESIGN"),
        construction=read.one_of("CONSTRUCTION", (ONE_SHEET, Construction.BACKED.value)),
        material=read.word("MATERIAL"),
        machine=read.text("MACHINE", ""),
        profile=read.profile(),
        options=read.options(),
        width_mm=read.number("WIDTH_MM", least=SMALLEST_SHEET_MM),
        connector_mm=read.number("CONNECTOR_MM", least=LEAST_MM),
        kerf_mm=read.number(SLOT_KERF if SLOT_KERF in facts else "KERF_MM"),
        least_connector_mm=read.number("LEAST_CONNECTOR_MM"),
        lines=read.count("LINES"),
        trimmed=read.count("TRIMMED", 0),
        name=read.text("NAME", ""),
        verdict=read.one_of(VERDICT, ("", "ready_to_cut", "cut_with_care", "will_not_work"), ""),
    )


class _Facts:
    """Facts that are taken as numbers and words, or refused."""

    def __init__(self, facts: Mapping[str, str]) -> None:
        self._facts = facts

    def _refusal(self, key: str) -> ExportError:
        return ExportError(
            "cut_file.record_not_readable", name=key, value=plain_line(self._facts.get(key, ""), LONGEST_SAID)
        )

    def text(self, key: str, default: str | None = None) -> str:
        """One short line."""
        found = self._facts.get(key, default)
        if found is None or len(found) > LONGEST_FACT:
            raise self._refusal(key)
        return plain_line(found)

    def one_of(self, key: str, known: tuple[str, ...], default: str | None = None) -> str:
        """A known word."""
        found = self.text(key, default)
        if found not in known:
            raise self._refusal(key)
        return found

    def word(self, key: str) -> str:
        """One short line that has something on it."""
        found = self.text(key)
        if not found:
            raise self._refusal(key)
        return found

    def number(self, key: str, default: float | None = None, least: float = 0.0) -> float:
        """A length in mm."""
        if key not in self._facts and default is not None:
            return default
        text = self.text(key)
        if NUMBER.fullmatch(text) is None or not least <= float(text) <= LARGEST_SHEET_MM:
            raise self._refusal(key)
        return float(text)

    def count(self, key: str, default: int | None = None) -> int:
        """A whole number."""
        found = self.text(key, None if default is None else f"{default}")
        if not (found.isascii() and found.isdecimal() and len(found) <= 8 and int(found) <= LARGEST_COUNT):
            raise self._refusal(key)
        return int(found)

    def profile(self) -> Profile:
        """A known machine profile."""
        try:
            return find_profile(self.text("PROFILE"))
        except ExportError:
            raise self._refusal("PROFILE") from None

    def options(self) -> CutOptions:
        """The choices about the cuts."""
        widths = self._pieces("HINGE_MM")
        singles = [SINGLE.fullmatch(word) for word in widths]
        removed = self._pieces("REMOVED")
        if any(match is None for match in singles) or not all(word.isdecimal() and len(word) <= 6 for word in removed):
            raise self._refusal("HINGE_MM_0")
        try:
            return CutOptions(
                style=ConnectorStyle(self.one_of("STYLE", tuple(ConnectorStyle))),
                order=CutOrder(self.one_of("ORDER", tuple(CutOrder))),
                tabs=self.count("TABS", self.count("TABS_ASKED", 0)),
                tab_mm=self.number("TAB_MM", TAB_MM),
                hinge_mm=tuple((int(match[1]), float(match[2])) for match in singles if match is not None),
                removed=tuple(int(word) for word in removed),
                copies=self.count("COPIES_ASKED", 1),
                copy_gap_mm=self.number("COPY_GAP_MM", COPY_GAP_MM),
            )
        except KirigamiError:
            raise self._refusal("STYLE") from None

    def _pieces(self, key: str) -> list[str]:
        """The words of a list that stands in pieces."""
        words: list[str] = []
        for number in range(MOST_PIECES):
            if f"{key}_{number}" not in self._facts:
                break
            words += self.text(f"{key}_{number}").split()
        return words


@dataclass(frozen=True, slots=True)
class PieceRecord:
    """How the file of a bed with pieces says it was made."""

    version: str  #: of the program
    design: str  #: identifies the sheet
    construction: str  #: "pinned", "backed"
    material: str  #: key of the preset
    machine: str  #: key of the machine that was asked for, "" for the one that the material is for
    profile: Profile
    kerf_mm: float  #: that the cuts allow for
    layer: int
    bed: str  #: "1 of 2"
    pieces: int
    #: Diameters of holes and ears, and room between pieces that pass each other.
    pin_mm: float
    ear_mm: float
    clearance_mm: float
    lines: int  #: that are cut
    verdict: str  #: level of the verdict of the export, "" where there was none
    #: width_mm, fastener, order: of the flat sheet, its pins and its cuts; 0 and "" in files of earlier versions.
    width_mm: float = 0.0
    fastener: str = ""
    order: str = ""

    def to_json(self) -> dict[str, object]:
        """For the command line."""
        names = (entry.name for entry in fields(self) if entry.name not in ("profile", "lines", "verdict"))
        return {name: getattr(self, name) for name in names} | {"profile": self.profile.key}


def piece_record_of(facts: Mapping[str, str]) -> PieceRecord | None:
    """The record of a bed with pieces among a file's facts; None for all other files.

    Raises
    ------
    ExportError
        A record that no export writes.
    """
    if PROGRAM not in facts or "PIECES" not in facts:
        return None
    read = _Facts(facts)
    pieces = tuple(one.value for one in Construction if one is not Construction.ONE_SHEET)
    return PieceRecord(
        version=read.text(PROGRAM),
        design=read.text("DESIGN"),
        construction=read.one_of("CONSTRUCTION", pieces),
        material=read.text("MATERIAL"),
        machine=read.text("MACHINE", ""),
        profile=read.profile(),
        kerf_mm=read.number("KERF_MM"),
        layer=read.count("LAYER"),
        bed=read.text("BED"),
        pieces=read.count("PIECES"),
        pin_mm=read.number("PIN_MM"),
        ear_mm=read.number("EAR_MM"),
        clearance_mm=read.number("CLEARANCE_MM"),
        lines=read.count("LINES"),
        verdict=read.one_of(VERDICT, ("", "ready_to_cut", "cut_with_care", "will_not_work"), ""),
        width_mm=read.number("WIDTH_MM", 0.0),
        fastener=read.one_of("FASTENER", ("", *Fastener), ""),
        order=read.one_of("ORDER", ("", *CutOrder), ""),
    )
