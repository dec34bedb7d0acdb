"""Version 1 -> 2: what the fit prefers, the effort of the search, fields as drawn, trimmed designs."""

from __future__ import annotations

import json
from collections.abc import Mapping

DESIGN = "design.json"


def with_preference(members: Mapping[str, bytes]) -> Mapping[str, bytes]:
    """Add what version 1 did not know; a damaged design is left for the reader to name."""
    try:
        design = json.loads(members[DESIGN])
        design["settings"] |= {"prefer": "balanced", "search": 0}
        for candidate in design["candidates"]:
            candidate |= {"drawn": False, "trim": None}
    except (KeyError, ValueError, TypeError, AttributeError, RecursionError):
        return members
    return {**members, DESIGN: json.dumps(design).encode()}
