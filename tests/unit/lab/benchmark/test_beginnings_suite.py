"""The suite of beginnings: every way is measured on the same targets, and compared with the guided fits."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from small_networks import random_network

from kirigami_studio.cli import main
from kirigami_studio.generator.weights import load_model
from kirigami_studio.lab.benchmark.beginnings_suite import begun, measure_beginnings
from kirigami_studio.lab.trained_weights import store_variants
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import sample, with_grid
from kirigami_studio.pipeline.tasks import scored
from kirigami_studio.settings.design import RimRule

pytestmark = pytest.mark.torch


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run's folder with one small network for two preferences."""
    place = tmp_path_factory.mktemp("run")
    network = random_network(preference=True, sheets=True, rims=True)
    store_variants("aligned", {"match": 0.0, "calm": 1.0}, network, place, {})
    return place


def test_that_more_steps_of_the_fit_and_more_beginnings_are_worth_more() -> None:
    """The best of four fits ranks no lower than the first of them alone, which ranks above its sample."""

    def worth(count: int, polish: int) -> float:
        (found,) = begun(load("drop"), ("prior",), count, polish, 0, 1)
        assert found.seconds > 0.0 and found.grid == with_grid(Request(load("drop"), None)).grid
        return found.worth

    request = with_grid(Request(load("drop"), None, k=1, guided=0))
    (drawn,) = scored(request, sample(request, load_model("prior")), 0)
    assert worth(1, 0) == pytest.approx(Ranking.of(request).worth(drawn), abs=1e-9)
    assert worth(1, 0) < worth(1, 6) <= worth(2, 6) + 1e-9


def test_that_the_best_of_more_samples_is_fitted() -> None:
    few, many = (begun(load("letter-l"), ("prior",), 1, 0, 0, drawn)[0].worth for drawn in (1, 8))
    assert few + 0.005 < many


def test_that_each_way_has_its_figures_and_its_difference_to_the_guided_fits(
    folder: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    ways = ["guided", "prior", f"{folder}/calm"]
    words = [
        "benchmark",
        "beginnings",
        "--targets",
        "circle",
        "--ways",
        *ways,
        "--k",
        "1",
        "--drawn",
        "1",
        "--polish",
        "2",
    ]
    assert main([*words, "--processes", "1", "--out", str(tmp_path / "figures.json"), "--json"]) == 0
    figures = json.loads(capsys.readouterr().out)
    assert figures == json.loads((tmp_path / "figures.json").read_text())
    assert list(figures) == ways
    assert "iou_exact_over_guided" not in figures["guided"]
    for way in ways[1:]:
        gap = figures[way]["iou_exact"] - figures["guided"]["iou_exact"]
        assert figures[way]["iou_exact_over_guided"] == pytest.approx(gap)
        low, high = figures[way]["panel_area_cv_interval"]
        assert low <= figures[way]["panel_area_cv"] <= high
        assert figures[way]["shapes"]["circle"]["iou_exact"] == figures[way]["iou_exact"] > 0.8


def test_that_variants_of_a_run_are_measured_by_their_preference(folder: Path) -> None:
    request = Request(load("heart"), (6, 6), k=4, guided=0)
    drawn = [sample(request, load_model(name, folder)) for name in ("match", "calm")]
    assert drawn[0] != drawn[1]
    figures = measure_beginnings([load("heart")], [f"{folder}/match", f"{folder}/calm"], 1, 0, least=1)
    assert figures[f"{folder}/match"]["shapes"] != figures[f"{folder}/calm"]["shapes"]  # type: ignore[index]


@pytest.mark.parametrize(("rim", "start_free"), [(RimRule.FREE, True), (RimRule.EVEN, False)])
def test_that_samples_have_a_free_rim_where_the_request_and_the_model_do(
    folder: Path, rim: str, start_free: bool
) -> None:
    request = Request(load("heart"), (6, 6), k=2, guided=0, rim=rim)
    assert all(sheet.has_even_rim is not start_free for sheet in sample(request, load_model("match", folder)))
    assert all(sheet.has_even_rim for sheet in sample(request, load_model("prior")))


@pytest.mark.parametrize("share", ["nan", "-1", "much"])
def test_that_a_share_that_is_none_is_refused(share: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["benchmark", "beginnings", "--targets", "circle", "--last-share", share])
    assert ended.value.code == 2 and "--last-share" in capsys.readouterr().err
