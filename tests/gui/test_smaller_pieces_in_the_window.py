"""A run that takes a finer grid in the end: what is shown, and kept of it when it is stopped, is of that grid alone."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pytest

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.gui.run import generation
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.events import CandidateFound, Progress, Started
from kirigami_studio.studio.designing import GridChosen, decoded


def designs(target: Outline, grid: tuple[int, int], count: int) -> list[Candidate]:
    draw = np.random.default_rng(sum(grid))
    sheets = [deploy(RatioField.from_log10(0.2 * draw.uniform(-1.0, 1.0, grid))) for _ in range(count)]
    return [Candidate(one.sheet, evaluate(one, target), seed=0, index=at) for at, one in enumerate(sheets)]


def test_that_designs_of_the_first_grid_give_way_to_those_of_the_finer_one(
    heart: MainWindow, monkeypatch: pytest.MonkeyPatch, until: Callable[[Callable[[], bool]], None]
) -> None:
    target = heart.session.document.target
    assert target is not None
    first, second = designs(target, (3, 3), 3), designs(target, (4, 4), 2)

    def scripted(*_: object) -> Iterator[object]:
        yield Started(3)
        for grid, found in (((3, 3), first), ((4, 4), second)):
            yield GridChosen(grid, f"{grid[0]} x {grid[1]}")
            for one in found:
                yield CandidateFound(one.index, one)
                yield decoded(one)
        while True:
            yield Progress(1, 2, "Covering")

    monkeypatch.setattr(generation, "generating", scripted)
    run = heart.services.run
    heart.services.settings.change(auto_grid=True, k=3)
    heart.services.generation.generate()

    def reported() -> int:
        so_far = run.so_far()
        return 0 if so_far is None else len(so_far[0].candidates)

    until(lambda: run.grid_reason == "4 x 4" and reported() == len(second))
    so_far = run.so_far()
    assert so_far is not None
    result = so_far[0]
    assert result.request.grid == (4, 4) and result.request.grid_chosen
    assert set(result.candidates) == set(second)
    heart.services.generation.cancel()
    until(lambda: not run.running)
