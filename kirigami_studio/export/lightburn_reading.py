"""Read back what a LightBurn project would cut: length of each layer's paths, tool layers left out."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ExportError

#: Chords that a Bezier curve of a quarter turn is measured with; they miss 3e-5 of it.
CHORDS = 64
_NUMBER = r"(-?\d+(?:\.\d+)?)"
_VERTEX = re.compile(rf"V{_NUMBER} {_NUMBER}(?:c0x{_NUMBER}(?:c0y{_NUMBER})?)?(?:c1x{_NUMBER}(?:c1y{_NUMBER})?)?")
_PRIMITIVE = re.compile(r"([LB])(\d+) (\d+)")


def layer_lengths(path: Path) -> dict[str, float]:
    """Return the length (mm) that is cut on each layer, by the layer's name.

    Raises
    ------
    ExportError
        No readable project, or a shape on a layer without settings.
    """
    try:
        root = ElementTree.parse(path).getroot()
        names = {
            _value(setting, "index"): _value(setting, "name")
            for setting in root.findall("CutSetting")
            if setting.get("type") == "Cut"
        }
        tools = {_value(setting, "index") for setting in root.findall("CutSetting") if setting.get("type") == "Tool"}
        lengths = dict.fromkeys(names.values(), 0.0)
        for shape in root.findall("Shape"):
            index = str(shape.get("CutIndex"))
            if index not in tools:
                lengths[names[index]] += _length(shape)
    except (OSError, ElementTree.ParseError, KeyError, ValueError, IndexError) as error:
        raise ExportError(f"{path} is not a readable LightBurn project: {error}. Export it again.") from error
    return lengths


def _value(setting: ElementTree.Element, name: str) -> str:
    found = setting.find(name)
    return "" if found is None else str(found.get("Value"))


def _length(shape: ElementTree.Element) -> float:
    if shape.get("Type") != "Path" or shape.findtext("XForm") != "1 0 0 1 0 0":
        raise ValueError(f"a {shape.get('Type')} lies on a layer that is cut")
    rows = [[float(number or "nan") for number in match] for match in _VERTEX.findall(shape.findtext("VertList", ""))]
    vertices: FloatArray = np.array(rows, dtype=np.float64).reshape(-1, 6)
    total = 0.0
    for kind, one, other in _PRIMITIVE.findall(shape.findtext("PrimList", "")):
        start, stop = vertices[int(one)], vertices[int(other)]
        if kind == "L":
            total += float(np.hypot(*(stop[:2] - start[:2])))
        else:
            total += _curve_length(start[:2], start[2:4], stop[4:6], stop[:2])
    return total


def _curve_length(start: FloatArray, first: FloatArray, second: FloatArray, stop: FloatArray) -> float:
    t = np.linspace(0.0, 1.0, CHORDS + 1)[:, None]
    points = (1 - t) ** 3 * start + 3 * t * (1 - t) ** 2 * first + 3 * t**2 * (1 - t) * second + t**3 * stop
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
