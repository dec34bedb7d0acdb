"""What every cut file says about how it was made."""

from __future__ import annotations

import re
from collections.abc import Mapping

from kirigami_studio import __version__
from kirigami_studio.export.profile import Profile
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.joints import joint_count

#: What some kind of file cannot have in a name.
NOT_IN_NAMES = re.compile(r"[^A-Z0-9_]")
#: Stands for a character that some kind of file cannot hold.
REPLACEMENT = "\N{REPLACEMENT CHARACTER}"


def facts_of(plan: CutPlan, profile: Profile) -> dict[str, str]:
    """What a file says about how it was made."""
    kerf = 0.0 if profile.slots else plan.kerf_mm
    paths = "beam centre lines, kerf already allowed for: apply no kerf offset"
    return {
        "KIRIGAMI_STUDIO": __version__,
        "DESIGN": plan.design_hash,
        "SIZE_MM": f"{plan.size_mm[0]:.4f} x {plan.size_mm[1]:.4f}",
        "CONNECTOR_MM": f"{plan.connector_mm:g}",
        "KERF_MM": f"{kerf:g}",
        "MATERIAL": plan.material.key,
        "PATHS": "edges of the finished part: apply the kerf offset of the machine" if profile.slots else paths,
        **({} if profile.slots else _deliberate(plan)),
        **origin_facts(plan.origin),
    }


def origin_facts(origin: Mapping[str, str]) -> dict[str, str]:
    """Where a design comes from, under names that no fact about the cutting has."""
    return {f"FROM_{NOT_IN_NAMES.sub('_', name.upper())}": _one_line(text) for name, text in sorted(origin.items())}


def _one_line(text: str) -> str:
    """The text as every kind of file can hold it; names of files may have characters that XML or UTF-8 cannot."""
    return "".join(letter if letter.isprintable() else REPLACEMENT for letter in " ".join(text.split()))


def _deliberate(plan: CutPlan) -> dict[str, str]:
    """What a check of the file would otherwise take for faults: gaps of the outline, cuts that end on other cuts."""
    facts: dict[str, str] = {}
    if plan.options.tabs:
        facts |= {"TABS": f"{plan.options.tabs}", "TAB_MM": f"{plan.options.tab_mm:g}"}
    if joints := joint_count(plan):
        facts["JOINS"] = f"{joints}"
    return facts
