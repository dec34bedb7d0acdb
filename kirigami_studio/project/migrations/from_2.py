"""Version 2 -> 3: connector style, order of cutting, tabs, single hinges, machine profile and DXF dialect."""

from __future__ import annotations

import json
from collections.abc import Mapping

DESIGN = "design.json"


def with_cut_options(members: Mapping[str, bytes]) -> Mapping[str, bytes]:
    """Add what version 2 did not know; a damaged design is left for the reader to name."""
    try:
        design = json.loads(members[DESIGN])
        options = {"style": "straight", "order": "shortest", "tabs": 0, "tab_mm": 0.5, "hinge_mm": [], "removed": []}
        design["fabrication"] |= {"options": options, "profile": "any", "dxf_version": "R2010"}
    except (KeyError, ValueError, TypeError, AttributeError, RecursionError):
        return members
    return {**members, DESIGN: json.dumps(design).encode()}
