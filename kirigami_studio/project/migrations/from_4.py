"""Version 4 -> 5: the settings of each design's own run."""

from __future__ import annotations

import json
from collections.abc import Mapping

DESIGN = "design.json"


def with_runs(members: Mapping[str, bytes]) -> Mapping[str, bytes]:
    """Say that the runs are not known: version 4 told what all had in common, and not which design was whose."""
    try:
        design = json.loads(members[DESIGN])
        design |= {"runs": []}
        for entry in design["candidates"]:
            entry |= {"run": None}
    except (KeyError, ValueError, TypeError, AttributeError, RecursionError):
        return members
    return {**members, DESIGN: json.dumps(design).encode()}
