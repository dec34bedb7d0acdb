"""What was drawn comes back with its points, handles and place; what no drawing has is a sentence."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.outlines.anchors import Anchors, with_anchors
from kirigami_studio.outlines.figures import BoundingBox, Figure, figure
from kirigami_studio.outlines.nodes import Kind
from kirigami_studio.outlines.placed import Placed
from kirigami_studio.project import store
from kirigami_studio.project.codec import DESIGN, encode
from kirigami_studio.project.document import FARTHEST_GUIDE, Document
from kirigami_studio.project.edits import Edit, set_guides
from kirigami_studio.project.history import History
from tests.refusals import refused


@pytest.fixture
def drawn() -> Placed:
    """A square beside the origin with a smooth and a symmetric corner."""
    square = Placed.from_ring(figure(Figure.RECTANGLE, BoundingBox(10, 0, 50, 40)), "square")
    anchors = Anchors.of(square).with_kind(1, Kind.SMOOTH).with_kind(3, Kind.SYMMETRIC)
    return with_anchors(square, anchors)


def test_that_points_handles_and_place_come_back(drawn: Placed, tmp_path: Path) -> None:
    path = tmp_path / "drawn.kiri"
    store.save(Document(target=drawn.outline), path)
    target = store.load(path).target
    assert target is not None and target.nodes == drawn.outline.nodes and target.place == drawn.centre
    again = Placed.on_board(target)
    np.testing.assert_allclose(again.ring, drawn.ring, atol=1e-9)
    assert Anchors.of(again).kinds == (Kind.CORNER, Kind.SMOOTH, Kind.CORNER, Kind.SYMMETRIC)


def test_that_a_move_is_a_change_although_the_shape_is_the_same(drawn: Placed) -> None:
    history = History(Document(target=drawn.outline))
    moved = drawn.moved((5.0, 0.0)).outline
    assert moved == drawn.outline
    assert history.apply(Edit("Move target", Document(target=moved))) and history.unsaved
    assert not history.apply(Edit("Move target", Document(target=drawn.moved((5.0, 0.0)).outline)))
    assert history.undo() and not history.unsaved


def test_that_a_file_without_points_or_place_opens_as_before(drawn: Placed, tmp_path: Path) -> None:
    target = store.load(changed(drawn, tmp_path, lambda target: (target.pop("nodes"), target.pop("place")))).target
    assert target == drawn.outline and target.nodes is None and target.place is None


@pytest.mark.parametrize(
    "change",
    [
        lambda target: target["nodes"].update(at=[0, 1, 10**9, 2]),
        lambda target: target["nodes"].update(at=[0, 1, "2", 3]),
        lambda target: target["nodes"].update(at=[0, 1]),
        lambda target: target["nodes"].update(kinds=["corner", "smooth", "round", "corner"]),
        lambda target: target["nodes"].update(kinds=["corner"]),
        lambda target: target["nodes"].update(handles=[[0, 1]]),
        lambda target: target["nodes"].update(handles="none"),
        lambda target: target["nodes"].update(kept=[0, 1, 0, 1]),
        lambda target: target["nodes"].pop("kept"),
        lambda target: target.update(place=[1.0]),
        lambda target: target.update(nodes=[]),
    ],
)
def test_that_points_that_no_drawing_has_are_a_sentence(
    change: Callable[[dict[str, Any]], object], drawn: Placed, tmp_path: Path
) -> None:
    with refused(ProjectError, "project.damaged"):
        store.load(changed(drawn, tmp_path, change))


def test_that_guides_come_back_and_a_project_without_any_says_nothing_of_them(drawn: Placed, tmp_path: Path) -> None:
    document = Document(target=drawn.outline, guides=((12.5, -3.0), (7.25,)))
    assert document.guides == ((-3.0, 12.5), (7.25,))
    store.save(document, tmp_path / "guided.kiri")
    assert store.load(tmp_path / "guided.kiri") == document
    assert b"guides" not in encode(Document(target=drawn.outline))[DESIGN]


@pytest.mark.parametrize(
    ("guides", "said"),
    [
        ([1.0], "must be a JSON object"),
        ({"x": [1.0]}, "no entry 'y'"),
        ({"x": ["here"], "y": []}, "must be a number"),
        ({"x": [], "y": [1e9]}, "within 1e"),
        ({"x": list(range(2000)), "y": []}, "at most 1000 guides"),
    ],
)
def test_that_guides_that_no_board_has_are_a_sentence(guides: object, said: str, drawn: Placed, tmp_path: Path) -> None:
    path = changed(drawn, tmp_path, lambda design: design.update(guides=guides), "")
    with pytest.raises(ProjectError, match=said):
        store.load(path)


def test_that_a_guide_that_is_dragged_far_off_stays_within_reach(drawn: Placed) -> None:
    edit = set_guides(Document(target=drawn.outline), ((3e7,), ()), "Add guide")
    assert edit.document.guides == ((FARTHEST_GUIDE,), ())


def changed(drawn: Placed, folder: Path, change: Callable[[dict[str, Any]], object], record: str = "target") -> Path:
    """A project file whose target record, or whole design, was altered by hand."""
    content = store.pack(Document(target=drawn.outline))
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    design = json.loads(members["design.json"])
    change(design[record] if record else design)
    members["design.json"] = json.dumps(design).encode()
    path = folder / "changed.kiri"
    with zipfile.ZipFile(path, "w") as archive:
        for name, member in members.items():
            archive.writestr(name, member)
    return path
