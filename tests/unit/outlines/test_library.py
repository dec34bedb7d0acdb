"""The bundled silhouettes and the script that makes them."""

from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path
from types import ModuleType

import pytest

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.resources import resource
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.outline import Outline

SCRIPT = Path(__file__).resolve().parents[3] / "packaging" / "make_silhouettes.py"


@pytest.fixture(scope="module")
def maker() -> ModuleType:
    spec = importlib.util.spec_from_file_location("make_silhouettes", SCRIPT)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_that_the_library_holds_the_shapes_people_ask_for_first() -> None:
    wanted = {"circle", "square", "triangle", "hexagon", "star", "heart", "flower", "crescent", "letter-l", "gear"}
    assert wanted <= set(silhouettes.names())
    assert len(silhouettes.names()) >= 24


@pytest.mark.parametrize("name", silhouettes.names())
def test_that_every_silhouette_needs_no_repair_and_few_vertices(name) -> None:
    outline = silhouettes.load(name)
    assert outline.notes == ()
    assert outline.name == name
    assert 3 <= len(outline.points) <= 300
    assert silhouettes.entry(name).title
    assert silhouettes.entry(name).about.endswith(".")


def test_that_the_script_makes_the_stored_files(maker, iou) -> None:
    made = {silhouette.name: silhouette for silhouette in maker.SILHOUETTES}
    assert sorted(made) == sorted(path.stem for path in resource("silhouettes").glob("*.json"))
    for name, silhouette in made.items():
        fresh = json.loads(maker.text(silhouette))
        entry = silhouettes.entry(name)
        assert (fresh["title"], fresh["about"]) == (entry.title, entry.about)
        # Vertices may differ where another GEOS version buffers differently; the shape may not.
        made_now = Outline.from_points(fresh["points"], holes=fresh.get("holes", ()))
        assert iou(made_now, silhouettes.load(name)) > 0.9999


def test_that_shapes_with_holes_keep_all_of_them() -> None:
    holes = {name: len(silhouettes.load(name).holes) for name in silhouettes.names()}
    assert {name: count for name, count in holes.items() if count} == {
        "face": 3,
        "frame": 1,
        "gear-with-bore": 1,
        "letter-a": 1,
        "letter-b": 2,
        "letter-o": 1,
        "ring": 1,
        "washer": 1,
    }


def test_that_no_two_silhouettes_are_alike(iou) -> None:
    outlines = [silhouettes.load(name) for name in silhouettes.names()]
    pairs = [(a.name, b.name) for k, a in enumerate(outlines) for b in outlines[:k] if iou(a, b) > 0.985]
    assert pairs == []


@pytest.mark.parametrize("spelling", ["six-point-star", "Six-Point-Star", "six point star", " six_point_star "])
def test_that_spelling_is_forgiven(spelling) -> None:
    assert silhouettes.load(spelling).name == "six-point-star"


def test_that_an_unknown_name_is_answered_with_the_nearest() -> None:
    with pytest.raises(TargetError, match=r"'hart'.*heart"):
        silhouettes.load("hart")
    with pytest.raises(TargetError, match=r"library has arrow, bean"):
        silhouettes.load("qqqqqq")
