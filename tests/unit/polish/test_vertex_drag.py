"""A dragged vertex arrives, little else moves, locked ratios stay, and the sheet stays physical."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from uneven_sheets import uneven_sheet

from kirigami_studio.evaluate.feasibility import invalid_quads, path_contact
from kirigami_studio.evaluate.pins import GAP_ROUNDING, checkerboard, least_pin_distance
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import AngleError, UsageError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.polish.sensitivity import OutlineModel
from kirigami_studio.polish.vertex_drag import ARRIVED, CHANGE, HOLD, VertexDrag
from tests.refusals import refused

GRIDS = st.tuples(st.integers(2, 7), st.integers(2, 7))


#: Of the sheets that are dragged: the paper's, one with an uneven rim, one that starts round and has higher cells.
KINDS = ("even", "uneven", "round")


def gentle_field(rows: int, columns: int, seed: int, spread: float = 0.08) -> RatioField:
    return RatioField.from_log10(spread * np.random.default_rng(seed).normal(size=(rows, columns)))


def gentle_sheet(grid: tuple[int, int], seed: int, kind: str) -> Sheet:
    field = gentle_field(*grid, seed)
    if kind == "even":
        return Sheet(field)
    other = uneven_sheet(*grid, seed, start=kind == "round")
    return Sheet(field, other.rim, other.start, (1.0, 1.2) if kind == "round" else (1.0, 1.0))


def outward(outline: np.ndarray, vertex: int) -> np.ndarray:
    way: np.ndarray = outline[vertex] - outline.mean(axis=0)
    return way / np.hypot(*way)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("phi", [0.0, 0.7])
def test_that_the_gradient_is_the_one_of_finite_differences(phi: float, kind: str) -> None:
    sheet = gentle_sheet((4, 5), 3, kind)
    drag = VertexDrag(sheet, phi, 6)
    z = sheet.field.log10.ravel() + 0.05 * np.random.default_rng(1).normal(size=20)
    place = deploy(sheet).outline(phi)[6] + (0.2, -0.1)
    model = OutlineModel.of(sheet, phi)
    outline, slopes = model.linearised(z)
    moved = sheet.with_field(RatioField.from_log10(z.reshape(4, 5)))
    np.testing.assert_allclose(outline, deploy(moved).outline(phi), atol=1e-12)
    step = 1e-6

    def cost(z: FloatArray) -> float:
        return drag.cost(z, model.outline(z), place)

    numeric = [(cost(z + step * unit) - cost(z - step * unit)) / (2 * step) for unit in np.eye(20)]
    assert drag.gradient(z, outline, place, slopes) == pytest.approx(np.array(numeric), rel=1e-5, abs=1e-9)


@pytest.mark.parametrize(("grid", "phi"), [((4, 5), 0.0), ((7, 6), 0.7), ((12, 12), 1.2)])
def test_that_the_step_is_the_one_of_the_normal_equations(grid: tuple[int, int], phi: float) -> None:
    field, vertex = gentle_field(*grid, 3), 6
    locked = np.zeros(grid, dtype=bool)
    locked[1, 1:3] = True
    outline, slopes = OutlineModel(*grid, phi).linearised(field.log10.ravel())
    drag = VertexDrag(field, phi, vertex, locked)
    for near in (0.01, 0.013):  # from the start, then from where z differs from it; one derivative serves both
        z, place = drag.deployment.field.log10.ravel(), outline[vertex] + near * outward(outline, vertex)
        free = np.flatnonzero(~locked.ravel())
        weight = np.full(len(outline), HOLD / len(outline))
        weight[vertex] = 1.0
        rows = (np.sqrt(weight)[:, None, None] * slopes[..., free]).reshape(-1, free.size)
        here = drag.deployment.outline(phi)
        half = 0.5 * drag.gradient(z, here, place, slopes)[free]
        wanted = z.copy()
        wanted[free] -= np.linalg.solve(rows.T @ rows + CHANGE / z.size * np.eye(free.size), half)
        assert np.abs(wanted - z).max() < 0.25  # a step that is not shortened
        drag.move(place, steps=1)
        assert drag.deployment.field.log10.ravel() == pytest.approx(wanted, abs=2e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_that_the_motion_at_hand_is_the_one_of_the_sheet(kind: str) -> None:
    sheet = gentle_sheet((5, 4), 8, kind)
    drag = VertexDrag(sheet, 0.4, 3)
    assert np.array_equal(drag.deployment.outline(0.4), deploy(sheet).outline(0.4))
    found = drag.move(drag.place + 0.1)
    assert found != sheet and np.array_equal(drag.deployment.outline(0.4), deploy(found).outline(0.4))
    assert found == sheet.with_field(found.field), "the rim, the start outline and the cell stay"


@settings(max_examples=25, deadline=None)
@given(GRIDS, st.integers(0, 1000), st.sampled_from([0.0, 0.5, 1.5]), st.floats(-0.1, 0.1), st.sampled_from(KINDS))
def test_that_a_vertex_arrives_where_it_can_be(
    grid: tuple[int, int], seed: int, phi: float, far: float, kind: str
) -> None:
    # Where another field of the neighbourhood has the vertex, it can be brought to.
    sheet = gentle_sheet(grid, seed, kind)
    change = far * np.random.default_rng(seed + 1).normal(size=grid)
    there = sheet.with_field(RatioField.from_log10(sheet.field.log10 + change))
    vertex = seed % len(deploy(sheet).outline(phi))
    place = deploy(there).outline(phi)[vertex]
    drag = VertexDrag(sheet, phi, vertex)
    for share in np.linspace(0.1, 1.0, 10):
        drag.move((1.0 - share) * deploy(sheet).outline(phi)[vertex] + share * place)
    for _ in range(5):
        drag.move(place)
    assert drag.gap(place) <= 2 * ARRIVED
    assert drag.deployment.outline(phi)[vertex] == pytest.approx(drag.place, abs=1e-7)


@settings(max_examples=25, deadline=None)
@given(GRIDS, st.integers(0, 1000), st.sampled_from([0.0, 0.6]), st.floats(-4.0, 4.0), st.sampled_from(KINDS))
def test_that_no_drag_however_wild_leaves_the_physical(
    grid: tuple[int, int], seed: int, phi: float, far: float, kind: str
) -> None:
    sheet = gentle_sheet(grid, seed, kind)
    sound = not invalid_quads(deploy(sheet), phi) and path_contact(deploy(sheet), phi) is None
    outline = deploy(sheet).outline(phi)
    vertex = seed % len(outline)
    drag = VertexDrag(sheet, phi, vertex)
    for share in (0.25, 0.5, 1.0):
        found = drag.move(outline[vertex] + share * far * outward(outline, vertex))
    assert np.all((found.field.ratio >= 0.1 - 1e-9) & (found.field.ratio <= 10.0 + 1e-9))
    if sound:
        assert not invalid_quads(deploy(found), phi) and path_contact(deploy(found), phi) is None


@settings(max_examples=20, deadline=None)
@given(GRIDS, st.integers(0, 1000))
def test_that_held_voids_keep_every_digit(grid: tuple[int, int], seed: int) -> None:
    field, draw = gentle_field(*grid, seed), np.random.default_rng(seed)
    locked = draw.random(grid) < 0.5
    outline = deploy(field).outline(0.0)
    vertex = int(draw.integers(len(outline)))
    found = VertexDrag(field, 0.0, vertex, locked).move(outline[vertex] + 0.3 * outward(outline, vertex))
    assert np.array_equal(found.field.ratio[locked], field.ratio[locked])


def test_that_nothing_moves_when_everything_is_held() -> None:
    field = gentle_field(4, 4, 1)
    place = deploy(field).outline(0.0)[3] + (0.5, 0.5)
    assert VertexDrag(field, 0.0, 3, np.ones((4, 4), dtype=bool)).move(place) == Sheet(field)


def test_that_the_outline_far_from_the_vertex_hardly_moves() -> None:
    field = gentle_field(10, 10, 2)
    before = deploy(field).outline(0.0)
    vertex = 8
    place = before[vertex] + 0.3 * outward(before, vertex)
    drag = VertexDrag(field, 0.0, vertex)
    for _ in range(4):
        drag.move(place)
    moved = np.hypot(*(drag.deployment.outline(0.0) - before).T)
    assert moved[vertex] == pytest.approx(0.3, abs=0.01)
    assert float(np.median(moved)) < 0.03


def test_that_small_steps_of_the_hand_end_where_one_large_one_does() -> None:
    field = gentle_field(6, 6, 4)
    outline = deploy(field).outline(0.0)
    place = outline[5] + 0.25 * outward(outline, 5)
    small, large = VertexDrag(field, 0.0, 5), VertexDrag(field, 0.0, 5)
    for share in np.linspace(0.02, 1.0, 50):
        small.move((1.0 - share) * outline[5] + share * place)
    for drag in (small, large):
        for _ in range(20):
            drag.move(place)
    far = np.abs(small.deployment.field.log10 - large.deployment.field.log10).max()
    assert far < 0.03


def test_that_senseless_drags_are_refused() -> None:
    field = gentle_field(3, 3, 0)
    with pytest.raises(AngleError):
        VertexDrag(field, math.pi, 0)
    with refused(UsageError, "drag.no_such_vertex", last=15, vertex=16):
        VertexDrag(field, 0.0, 16)
    with refused(UsageError, "fit.locks_wrong_table"):
        VertexDrag(field, 0.0, 0, np.zeros((2, 2), dtype=bool))


def test_that_pins_keep_their_distance_while_a_vertex_is_dragged() -> None:
    sheet, least = Sheet(RatioField.from_log10(0.15 * checkerboard(4, 4))), 0.2
    assert least_pin_distance(deploy(sheet)) > least
    found = []
    for gap in (0.0, least):
        drag = VertexDrag(sheet, 0.6, 5, least_gap=gap)
        start = drag.place
        goal = start + 1.2 * outward(drag.deployment.outline(0.6), 5)
        for _ in range(6):
            drag.move(goal)
        found.append((least_pin_distance(drag.deployment), drag.gap(goal), float(np.hypot(*(start - goal)))))
    (free, near, _), (held, left, way) = found
    assert free < 0.9 * least <= held / 0.9 and held >= least - 2 * GAP_ROUNDING
    assert near < left < way
