"""Version 3 -> 4: marks, locked voids, how each design came to be, own materials."""

from __future__ import annotations

import json
from collections.abc import Mapping

DESIGN = "design.json"


def with_marks(members: Mapping[str, bytes]) -> Mapping[str, bytes]:
    """Add what version 3 did not know; a damaged design is left for the reader to name."""
    try:
        design = json.loads(members[DESIGN])
        candidates, known = design["candidates"], design["provenance"]
        design["fabrication"] |= {"own": None}
        design |= {"marks": ["none" for _ in candidates], "locked": []}
        # A search adds one design, with the last number.
        last = max((entry["index"] for entry in candidates), default=0) if "search" in known else None
        for entry in candidates:
            origin = "searched" if entry["index"] == last else "sampled"
            entry |= {"variant": known.get("model", ""), "origin": origin}
    except (KeyError, ValueError, TypeError, AttributeError, RecursionError):
        return members
    return {**members, DESIGN: json.dumps(design).encode()}
