"""The fit's speed against its slow reference, central differences, with one generous bound in processor seconds."""

from __future__ import annotations

import numpy as np
import pytest
from stopwatch import fastest, paced

from kirigami_studio.foundation.threads import one_blas_thread
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.polish import levenberg
from kirigami_studio.polish.even_panels import USUAL_WEIGHT
from kirigami_studio.polish.factor import Factor, factored
from kirigami_studio.polish.levenberg import Fit, polish
from kirigami_studio.polish.normal_equations import Damped
from kirigami_studio.polish.sensitivity import NodeMotion, OutlineModel


def test_that_the_derivative_costs_a_small_part_of_central_differences() -> None:
    model = OutlineModel(10, 10, 0.0)
    z = np.random.default_rng(0).uniform(-1, 1, 100)

    def differences() -> None:
        for index in range(z.size):
            step = np.zeros_like(z)
            step[index] = 1e-6
            model.outline(z + step) - model.outline(z - step)

    with one_blas_thread():  # as the pipeline does
        exact, slow = fastest(lambda: model.linearised(z)), fastest(differences, 2)
    print(f"\nderivative {1e3 * exact:.2f} ms, central differences {1e3 * slow:.1f} ms")
    assert exact < slow / 10


def test_that_ten_steps_at_24_x_24_end_within_seconds() -> None:
    target = load("heart")
    pose = polish(RatioField.uniform(24, 24), target, steps=0).pose
    fits: list[Fit] = []
    with one_blas_thread():  # as the pipeline does
        spent = paced(lambda: fits.append(polish(RatioField.uniform(24, 24), target, steps=10, pose=pose)), 1)
    (fit,) = fits
    print(f"\n24 x 24: {fit.steps} steps, {fit.evaluations} decodings, {spent:.2f} s")
    assert fit.steps == 10
    assert spent < 6.0


def test_how_often_a_fit_does_what_takes_long(monkeypatch: pytest.MonkeyPatch) -> None:
    """Large sheets spend their time on three things: none is done for every trial."""
    counts = {"curvature": 0, "factored": 0, "damped": 0}
    curvature, damped = NodeMotion.curvature, Damped.of

    def counted_curvature(motion: NodeMotion, *arguments: object) -> object:
        counts["curvature"] += 1
        return curvature(motion, *arguments)  # type: ignore[arg-type]

    def counted_damped(*arguments: object) -> Damped:
        counts["damped"] += 1
        return damped(*arguments)  # type: ignore[arg-type]

    def counted_factored(*arguments: object) -> Factor:
        counts["factored"] += 1
        return factored(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(NodeMotion, "curvature", counted_curvature)
    monkeypatch.setattr(Damped, "of", counted_damped)
    monkeypatch.setattr("kirigami_studio.polish.sensitivity.factored", counted_factored)
    levenberg._stiffness.cache_clear()
    levenberg._large_stiffness.cache_clear()
    fit = polish(Sheet.uniform(10, 10), load("heart"), steps=15, free_rim=True, even=USUAL_WEIGHT)
    assert fit.steps > 8
    assert fit.evaluations > 2.5 * fit.steps, "trials and corrections beside the steps, so this test can fail"
    # The second derivative at the uniform sheet is one more, and serves all fits of small sheets.
    assert counts == {"curvature": 1, "factored": fit.steps + 1, "damped": fit.steps}
    polish(Sheet.uniform(10, 10), load("star"), steps=2, free_rim=True, even=USUAL_WEIGHT)
    assert counts["curvature"] == 1
    assert levenberg.LARGEST_KEPT < 21 * 21
    for name in ("heart", "star"):
        polish(Sheet.uniform(21, 21), load(name), steps=2, free_rim=True, even=USUAL_WEIGHT)
        assert counts["curvature"] == 2


def test_that_even_panels_and_a_free_rim_do_not_multiply_the_time_of_a_fit() -> None:
    target = load("heart")
    pose = polish(Sheet.uniform(24, 24), target, steps=0).pose

    def fit(even: float, free_rim: bool) -> None:
        polish(Sheet.uniform(24, 24), target, steps=8, pose=pose, even=even, free_rim=free_rim)

    with one_blas_thread():  # as the pipeline does
        plain = fastest(lambda: fit(0.0, False), 2)
        whole = fastest(lambda: fit(USUAL_WEIGHT, True), 2)
    print(f"\n24 x 24, 8 steps: match alone {plain:.2f} s, even panels and free rim {whole:.2f} s")
    assert whole < 4.0 * plain
