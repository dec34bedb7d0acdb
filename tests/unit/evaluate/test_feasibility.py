"""Invalid quads, overlap and contact: none where the geometry says so, and found where it is planted."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest
import shapely
from lattice_strategies import local_rule_residual

from kirigami_studio.evaluate.boundary import as_plane
from kirigami_studio.evaluate.crossing import deepest_crossing
from kirigami_studio.evaluate.feasibility import (
    CONTACT_ACCURACY,
    TAU_OVERLAP,
    invalid_quads,
    outline_path,
    overlap_ratio,
    path_contact,
    shared_area,
)
from kirigami_studio.foundation.errors import AngleError
from kirigami_studio.lattice.deployment import Deployment, deploy, even_panel_part
from kirigami_studio.lattice.ratio_field import RatioField, frozen
from kirigami_studio.project.store import load

#: An input that failed, from the maintainers' collection: GEOS 3.14 unites its closed panels and loses one of 25.
LOST_PANEL = Path(__file__).parents[2] / "data" / "projects" / "geos_union_loses_a_panel.kiri"


def random_deployment(seed: int, grid: tuple[int, int] = (10, 10), spread: float = 1.0) -> Deployment:
    return deploy(RatioField.from_log10(np.random.default_rng(seed).uniform(-spread, spread, grid)))


def shared_areas(deployment: Deployment, phi: float) -> tuple[float, float]:
    """Area that quads share, summed pair by pair, and their total area: the slow oracle."""
    quads = [deployment.panels(phi).reshape(-1, 4, 2)]
    if phi > 0:
        quads.append(deployment.voids(phi).reshape(-1, 4, 2))
    polygons = shapely.polygons(np.concatenate(quads))
    first, second = np.triu_indices(len(polygons), 1)
    shared = shapely.area(shapely.intersection(polygons[first], polygons[second])).sum()
    return float(shared), float(shapely.area(polygons).sum())


@pytest.mark.parametrize("grid", [(2, 2), (3, 7), (10, 10), (9, 12)])
@pytest.mark.parametrize("phi", [0.0, 1e-6, 0.4, 3.0, math.pi])
def test_that_the_uniform_sheet_is_sound_at_every_angle(grid: tuple[int, int], phi: float) -> None:
    sheet = deploy(RatioField.uniform(*grid))
    assert (path_contact(sheet, phi), overlap_ratio(sheet, phi), invalid_quads(sheet, phi)) == (None, 0.0, 0)


@pytest.mark.parametrize("seed", range(60))
def test_that_random_fields_on_a_rectangle_make_no_contact(seed: int) -> None:
    sheet = random_deployment(seed)
    assert path_contact(sheet, 0.0) is None
    assert overlap_ratio(sheet, 0.0) == 0.0
    assert invalid_quads(sheet, 0.5) == 0


@pytest.mark.parametrize("seed", [3, 4])
def test_that_no_crossing_means_no_overlap_pair_by_pair(seed: int) -> None:
    sheet = random_deployment(seed, (3, 12), 2.0)
    assert deepest_crossing(as_plane(sheet.outline(0.0))) is None
    assert shared_areas(sheet, 0.0)[0] < 1e-9


def test_that_the_colliding_sheet_is_true_kirigami(colliding: Deployment) -> None:
    assert local_rule_residual(colliding.field, colliding.voids(1.0), 1.0) < 1e-12


def test_that_a_contact_is_found_where_and_when_the_outline_crosses(colliding: Deployment) -> None:
    contact = path_contact(colliding, 0.0)
    assert contact is not None
    before = shapely.Polygon(colliding.outline(contact.phi + 2 * CONTACT_ACCURACY))
    after = shapely.LinearRing(colliding.outline(contact.phi))
    assert before.is_valid
    assert not after.is_simple
    ring = np.array(after.coords)
    edges = shapely.linestrings(np.stack([ring[:-1], ring[1:]], axis=1))
    meeting = np.flatnonzero(shapely.distance(edges, shapely.Point(contact.where)) < 1e-9)
    assert len(meeting) == 2
    assert 1 < meeting[1] - meeting[0] < len(edges) - 1
    assert edges[meeting[0]].crosses(edges[meeting[1]])


def test_that_a_target_before_the_contact_is_free(colliding: Deployment) -> None:
    contact = path_contact(colliding, 0.0)
    assert contact is not None
    assert path_contact(colliding, contact.phi + 0.01) is None
    later = path_contact(colliding, contact.phi - 0.3)
    assert later is not None
    assert later.phi == pytest.approx(contact.phi, abs=2 * CONTACT_ACCURACY)


def test_that_overlap_is_the_area_shared_by_colliding_quads(colliding: Deployment) -> None:
    contact = path_contact(colliding, 0.0)
    assert contact is not None
    assert overlap_ratio(colliding, contact.phi + 0.01) == 0.0
    phi = contact.phi - 0.5
    shared, total = shared_areas(colliding, phi)
    # Nothing lies three deep there, so the union lacks exactly what is shared.
    assert shared > 0.01
    assert overlap_ratio(colliding, phi) == pytest.approx(shared / total, rel=1e-6)
    assert overlap_ratio(colliding, phi) < TAU_OVERLAP


def test_that_a_folded_sheet_has_inverted_panels() -> None:
    sheet = deploy(RatioField.uniform(2, 2))
    # Fold the compact sheet over: its right half mirrored onto the left one.
    folded = np.array(sheet.compact)
    folded[:, 0] = np.abs(folded[:, 0] - 1.5)
    even = frozen(even_panel_part(folded, sheet.topology))
    doubled = dataclasses.replace(sheet, even_part=even, odd_part=frozen(folded - folded[0] - even))
    assert invalid_quads(doubled, math.pi) >= 3


def test_that_a_collapsed_panel_is_counted() -> None:
    sheet = deploy(RatioField.uniform(4, 4))
    nodes = sheet.topology.panel_nodes[2, 2]
    even, odd = np.array(sheet.even_part), np.array(sheet.odd_part)
    even[nodes], odd[nodes] = even[nodes[0]], odd[nodes[0]]
    assert invalid_quads(sheet, 1.0) == 0
    assert invalid_quads(dataclasses.replace(sheet, even_part=frozen(even), odd_part=frozen(odd)), 1.0) > 0


def test_that_voids_count_as_invalid_only_while_they_are_open() -> None:
    sheet = deploy(RatioField.uniform(3, 3))
    assert [invalid_quads(sheet, phi) for phi in (0.0, 1e-12, math.pi)] == [0, 0, 0]
    assert invalid_quads(sheet, 1e-12 + 1e-8) == 0


def test_that_a_touch_is_not_a_crossing_and_a_cut_of_a_millionth_is() -> None:
    def bar_with_spike(reach: float) -> np.ndarray:
        corners = [
            (0, 0),
            (6, 0),
            (6, 3),
            (4, 3),
            (3, 1 - reach),
            (2, 3),
            (0, 3),
            (0, 2),
            (1, 2),
            (1, 1),
            (5, 1),
            (5, 0.5),
            (0, 0.5),
        ]
        return as_plane(np.array(corners, dtype=float))

    assert deepest_crossing(bar_with_spike(0.0)) is None
    place = deepest_crossing(bar_with_spike(1e-6))
    assert place is not None
    assert abs(place - (3 + 1j)) < 1e-5


def test_that_the_path_shows_the_same_outlines_as_the_deployment() -> None:
    sheet = random_deployment(7)
    angles = np.array([0.3, 1.1, 2.9])
    expected = [as_plane(sheet.outline(float(phi))) for phi in angles]
    np.testing.assert_allclose(outline_path(sheet, angles), expected, atol=1e-12)


@pytest.mark.parametrize("phi", [-0.1, 4.0, math.nan])
def test_that_impossible_angles_are_refused(phi: float) -> None:
    with pytest.raises(AngleError):
        path_contact(random_deployment(0), phi)


@pytest.mark.parametrize("phi", [0.0, 0.5, math.pi])
def test_that_uniting_panels_loses_none_where_their_edges_differ_by_rounding(phi: float) -> None:
    for candidate in load(LOST_PANEL).candidates:
        sheet = deploy(candidate.sheet)
        assert shared_area(sheet.panels(phi).reshape(-1, 4, 2)) < 1e-8
        assert overlap_ratio(sheet, phi) == 0.0
