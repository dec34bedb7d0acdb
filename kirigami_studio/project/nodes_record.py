"""Points and handles of a drawn target <-> JSON; files of targets that were not drawn hold none."""

from __future__ import annotations

import numpy as np

from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.outlines.nodes import Kind, Nodes
from kirigami_studio.project.json_record import Record, one_of


def nodes_json(nodes: Nodes) -> dict[str, object]:
    """Return what :func:`nodes_of` reads."""
    return {
        "at": nodes.at.tolist(),
        "kinds": [kind.value for kind in nodes.kinds],
        "handles": nodes.handles.tolist(),
        "kept": nodes.kept.tolist(),
    }


def nodes_of(record: Record) -> Nodes:
    """Rebuild the nodes.

    Raises
    ------
    ProjectError, TargetError
        Something that no outline can have.
    """
    at, kept = record.list("at"), record.list("kept")
    if not all(isinstance(index, int) and not isinstance(index, bool) and abs(index) < 2**31 for index in at):
        raise ProjectError("target.nodes.at must be whole numbers")
    if not all(isinstance(flag, bool) for flag in kept):
        raise ProjectError("target.nodes.kept must be yes or no each")
    try:
        handles = np.array(record.list("handles"), dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise ProjectError("target.nodes.handles is not a table of numbers") from None
    kinds = tuple(one_of(Kind, name) for name in record.list("kinds"))
    return Nodes(np.array(at, dtype=np.int64), kinds, handles, np.array(kept, dtype=np.bool_))
