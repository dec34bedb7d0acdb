"""Area and porosity in closed form, against polygons that an independent library measures."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from uneven_sheets import uneven_sheet

from kirigami_studio.evaluate.porosity import Porosity
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.starts import start_shape
from kirigami_studio.polish.flat_sheet import uniform_sheet

SHEETS = [uneven_sheet(5, 4), uniform_sheet((6, 5), start_shape("circle")), uniform_sheet((4, 4))]


@pytest.mark.parametrize("sheet", SHEETS)
@pytest.mark.parametrize("phi", [0.0, 0.4, 0.5 * math.pi, 2.2, math.pi])
def test_that_areas_are_those_of_the_polygons(sheet: Sheet, phi: float) -> None:
    deployment = deploy(sheet)
    figures = Porosity.of(deployment)
    voids = shapely.area(shapely.polygons(deployment.voids(phi).reshape(-1, 4, 2))).sum()
    panels = shapely.area(shapely.polygons(deployment.panels(phi).reshape(-1, 4, 2))).sum()
    assert figures.panels == pytest.approx(panels, rel=1e-9)
    assert figures.voids(phi) == pytest.approx(voids, abs=1e-9)
    assert figures.area(phi) == pytest.approx(shapely.Polygon(deployment.outline(phi)).area, rel=1e-9)
    assert figures.at(phi) == pytest.approx(voids / (voids + panels), abs=1e-9)


@pytest.mark.parametrize("share", [0.0, 0.1, 0.3])
def test_that_the_angles_of_a_porosity_have_it(share: float) -> None:
    figures = Porosity.of(deploy(SHEETS[0]))
    nearer, farther = figures.angles(share)
    assert nearer + farther == pytest.approx(math.pi) and nearer >= farther
    assert [figures.at(phi) for phi in (nearer, farther)] == pytest.approx([share, share])


def test_that_uniform_squares_are_half_open_at_most_and_nothing_more_is_found() -> None:
    """Rotating squares: as many voids as panels, but for the rim, each as large as a panel at 90 degrees."""
    figures = Porosity.of(deploy(SHEETS[2]))
    assert figures.panels == pytest.approx(25.0)
    assert figures.largest == max(figures.at(phi) for phi in np.linspace(0.0, math.pi, 181))
    assert figures.angles(figures.largest) == pytest.approx((0.5 * math.pi, 0.5 * math.pi), abs=1e-5)
    with pytest.raises(KirigamiError) as problem:
        figures.angles(figures.largest + 0.01)
    assert problem.value.code == "porosity.never_so_open"
    with pytest.raises(KirigamiError) as problem:
        figures.angles(1.0)
    assert problem.value.code == "porosity.not_a_share"
