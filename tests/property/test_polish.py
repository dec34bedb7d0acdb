"""Properties of the fit's objective on random designs of every parity."""

from __future__ import annotations

import numpy as np
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from lattice_strategies import grids, ratio_fields

from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.polish.boundary_target import BoundaryTarget
from kirigami_studio.polish.even_panels import EvenPanels
from kirigami_studio.polish.levenberg import SAMPLES, polish
from kirigami_studio.polish.objective import FitPhase, Objective, SecondTerm
from kirigami_studio.polish.preferences import FieldPreferenceTerms, Preference
from kirigami_studio.polish.sensitivity import OutlineModel

STEP = 1e-6


@settings(max_examples=15)
@given(ratio_fields(grids(6)), st.sampled_from([0.0, 0.7, 2.2]), st.integers(0, 999), st.booleans(), st.booleans())
def test_that_the_gradient_is_the_slope_of_the_cost(
    field: RatioField, phi: float, seed: int, twice: bool, wide: bool
) -> None:
    sheet = Sheet(field, None, None, (1.5, 0.8) if wide else (1.0, 1.0))
    model = OutlineModel.of(sheet, phi, free_rim=True)
    z = field.log10.ravel()
    terms = FieldPreferenceTerms(Preference(1e-3, 1e-3, 1e-3), np.zeros_like(z), field.rows, field.columns)
    stage, even = FitPhase(0, even=1e-2), EvenPanels.of(sheet)
    second = SecondTerm(model.at(phi + 0.4), BoundaryTarget.of(load("star"), SAMPLES), 0.7) if twice else None
    heart = BoundaryTarget.of(load("heart"), SAMPLES)
    objective = Objective(model, heart, terms, stage, 0.1, even=even, second=second)
    rng = np.random.default_rng(seed)
    offsets = rng.uniform(-0.4, 0.4, field.rows + field.columns)
    scale = -np.log(field.rows + field.columns)
    poses = [[scale, *rng.uniform(-0.5, 0.5, 3)] for _ in range(2 if twice else 1)]
    state = np.concatenate([z, offsets, *poses])
    look = objective.look(state)
    gradient = objective.gradient(look, objective.slopes(look))
    direction = rng.normal(size=state.size)
    direction /= np.linalg.norm(direction)
    slopes = [
        (objective.look(state + h * direction).cost - objective.look(state - h * direction).cost) / (2 * h)
        for h in (STEP, 0.5 * STEP)
    ]
    # Where a nearest point jumps inside the interval the slope has no single value: such draws contradict themselves.
    assume(abs(slopes[0] - slopes[1]) < 1e-4 * np.linalg.norm(gradient))
    assert abs(slopes[1] - gradient @ direction) < 5e-3 * np.linalg.norm(gradient)


@settings(max_examples=15)
@given(ratio_fields(grids(6)), st.sampled_from([0.0, 0.7]))
def test_that_a_fit_never_gets_worse_and_never_crosses_itself(field: RatioField, phi: float) -> None:
    target = load("drop")
    before = polish(field, target, phi, steps=0)
    after = polish(field, target, phi, steps=4, pose=before.pose)
    assert after.cost <= before.cost
    assert np.abs(after.field.log10).max() <= 1.0 + 1e-9
    if shapely.is_simple(shapely.linearrings(deploy(before.field).outline(phi))):
        assert shapely.is_simple(shapely.linearrings(deploy(after.field).outline(phi)))
