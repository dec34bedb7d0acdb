"""The fit's speed against its slow reference, central differences, with one generous bound in seconds."""

from __future__ import annotations

import time

import numpy as np
from stopwatch import fastest

from kirigami_studio.foundation.threads import one_blas_thread
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.polish.levenberg import polish
from kirigami_studio.polish.sensitivity import OutlineModel


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
    with one_blas_thread():  # as the pipeline does
        began = time.process_time()
        fit = polish(RatioField.uniform(24, 24), target, steps=10, pose=pose)
        spent = time.process_time() - began
    print(f"\n24 x 24: {fit.steps} steps, {fit.evaluations} decodings, {spent:.2f} s")
    assert fit.steps == 10
    assert spent < 6.0
