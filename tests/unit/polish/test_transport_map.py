"""The transport map between tabulated places is the one of the affine fits that the table holds."""

from __future__ import annotations

import numpy as np
import pytest

from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.polish import transport_map
from kirigami_studio.polish.transport_map import TransportMap


def test_that_a_finer_table_has_the_same_images(monkeypatch: pytest.MonkeyPatch) -> None:
    sheet, places = Sheet.uniform(6, 8), np.random.default_rng(0).uniform((0.5, -6.5), (8.5, -0.5), (200, 2))
    usual = TransportMap.of(sheet, load("heart"), 0.3).at(places)
    monkeypatch.setattr(transport_map, "TABULATED", 4 * transport_map.TABULATED - 3)
    finer = TransportMap.of(sheet, load("heart"), 0.3).at(places)
    assert np.hypot(*(usual - finer).T).max() < 0.02
    assert np.ptp(usual, axis=0).min() > 0.5


def test_that_tabulated_places_have_their_own_images() -> None:
    found = TransportMap.of(Sheet.uniform(3, 4), load("star"), 0.0)
    number = np.array([[0, 0], [5, 9], [transport_map.TABULATED - 1] * 2])
    np.testing.assert_allclose(found.at(found.low + number * found.step), found.table[*number.T], atol=1e-12)
