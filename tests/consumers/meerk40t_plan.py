"""Run by an interpreter that has MeerK40t: load files as its user would, plan the job, print what would be cut.

    python meerk40t_plan.py FILE...

prints one JSON object: for every file the elements found, the operations they went to, and the planned cut length (mm).
This file imports nothing of Kirigami Studio.
"""

from __future__ import annotations

import contextlib
import io
import json
import sys
from collections import Counter
from itertools import pairwise
from typing import Any

from meerk40t.core import core, svg_io
from meerk40t.core.cutcode.cubiccut import CubicCut
from meerk40t.core.cutcode.cutcode import CutCode
from meerk40t.core.cutcode.quadcut import QuadCut
from meerk40t.core.units import UNITS_PER_MM
from meerk40t.device import dummydevice
from meerk40t.dxf.plugin import plugin as dxf_plugin
from meerk40t.extra import lbrn
from meerk40t.fill import fills
from meerk40t.image import imagetools
from meerk40t.kernel import Kernel
from meerk40t.network import kernelserver
from meerk40t.rotary import rotary

#: Chords that a curve is measured with.
CHORDS = 64
PLUGINS = (
    kernelserver.plugin,
    dummydevice.plugin,
    core.plugin,
    imagetools.plugin,
    fills.plugin,
    svg_io.plugin,
    dxf_plugin,
    lbrn.plugin,
    rotary.plugin,
)


def planned(path: str) -> dict[str, Any]:
    """Load one file into a fresh program with its default operations, and plan it."""
    kernel = Kernel("MeerK40t", "0.0.0-testing", "kirigami_consumer", ansi=False, ignore_settings=True)
    for plugin in PLUGINS:
        kernel.add_plugin(plugin)
    kernel(partial=True)
    kernel.console("service device start dummy 0\n")
    elements = kernel.elements
    elements.load_default(performclassify=False)
    if not elements.load(path):
        raise SystemExit(f"MeerK40t did not load {path}")
    kernel.console("plan copy preprocess validate blob preopt optimize\n")
    cuts = [part for part in kernel.planner.default_plan.plan if isinstance(part, CutCode)]
    per_mm = UNITS_PER_MM / kernel.device.view.native_scale_x
    operations = [
        {
            "type": op.type,
            "label": op.label,
            "elements": len(op.children),
            "speed": op.speed,
            "power": op.power,
            "drawn_mm": sum(child.node.as_geometry().length() for child in op.children) / UNITS_PER_MM,
        }
        for op in elements.ops()
        if op.children
    ]
    return {
        "elements": Counter(str(node.type) for node in elements.elems()),
        "operations": operations,
        "cut_mm": sum(_length(piece) for part in cuts for piece in part.flat()) / per_mm,
        "note": elements.note,
        "first_points": [_first_point(node) for node in elements.elems() if node.type != "elem ellipse"],
    }


def _length(piece: Any) -> float:
    """Length of one planned move; MeerK40t itself tells a curve's as that of the polygon of its handles."""
    if not isinstance(piece, (CubicCut, QuadCut)):
        return float(piece.length())
    points = [complex(*piece.point(step / CHORDS)) for step in range(CHORDS + 1)]
    return sum(abs(stop - start) for start, stop in pairwise(points))


def _first_point(node: Any) -> tuple[float, float]:
    point = node.as_geometry().first_point
    return point.real / UNITS_PER_MM, point.imag / UNITS_PER_MM


def main(paths: list[str]) -> None:
    """Print the report; the program's own words go nowhere."""
    found = {}
    with contextlib.redirect_stdout(io.StringIO()):
        for path in paths:
            found[path] = planned(path)
    sys.stdout.write(json.dumps(found) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
