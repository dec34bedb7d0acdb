"""The counts beside the paper: what is like for like, what is ahead, why rows are behind, and the released measure."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from kirigami_studio.generator.weights import digest_of
from kirigami_studio.lab.benchmark.generator_table import Trained
from kirigami_studio.lab.benchmark.report.beside_paper import beside_paper_section, counts, rows_beside_paper
from kirigami_studio.lab.benchmark.report.cells import start_of
from kirigami_studio.lab.benchmark.report.whole import falling, made_from
from kirigami_studio.lab.paper_evaluator import released_floor, released_match
from kirigami_studio.lab.training.fields import checkerboard
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load

pytestmark = pytest.mark.torch

AT_BUDGET = {"family": "released", "steps": 31_250, "batch": 64, "calls": 0, "latent": 10}


def row(siou: float, paper: float | None, spread: float | None = None, **more: float) -> dict[str, Any]:
    given = None if paper is None else {"siou": paper, "siou_sd": spread, "success": None, "milliseconds": None}
    numbers = dict.fromkeys(("siou_sd", "success", "iou_exact", "milliseconds", "tv", "distance", "inception"), 0.5)
    return {**numbers, "siou": siou, "siou_interval": [0.4, 0.6], "steps": 8, "by_steps": {}, "paper": given, **more}


def suite(family: str, rows: dict[str, Any], trained: dict[str, Any] | None = None, **table: float) -> dict[str, Any]:
    found = {"targets": 7, "uniform_siou": 0.752, "uniform_iou": 0.75, "rows": rows, **table}
    shared = {"settings": {"k": 4, "classes": 32}, "seeds": [0], "weights": {}, "trained": trained or {}}
    return {**shared, "families": {family: found}}


def compared(*lines: str) -> dict[str, list[str]]:
    """Cells of the section's table by row and family."""
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("| ")]
    return {f"{found[3]}, {found[1]}": found for found in cells}


def test_that_only_networks_at_the_papers_budget_on_their_family_count_like_for_like() -> None:
    trained = {
        "paper": AT_BUDGET,
        "brief": {**AT_BUDGET, "steps": 3000},
        "mixed": {**AT_BUDGET, "family": "mixed"},
        "aligned": {**AT_BUDGET, "steps": 313, "batch": 8, "calls": 10_000},
        "stopped": {**AT_BUDGET, "steps": 179, "batch": 8, "calls": 5728},
    }
    rows = {name: row(0.95, 0.94) for name in (*trained, "unrecorded")}
    found = rows_beside_paper([], [suite("released", rows, trained), suite("sobol", rows, trained)], None)
    cells = compared(*beside_paper_section(found))
    assert [name for name, found in cells.items() if found[-1] == "yes"] == ["paper, released", "aligned, released"]
    for name, part in (("brief", "3000 of 31250"), ("mixed", "mixture"), ("stopped", "5728 of 10000")):
        assert part in cells[f"{name}, released"][-1]
    assert "released" in cells["paper, sobol"][-1] and cells["unrecorded, released"][-1].startswith("no: ")
    assert counts(found).startswith("Like for like 2 of 2 ") and "12 of 12" in counts(found)


def test_that_solvers_count_like_for_like_and_samples_of_the_bundled_prior_do_not() -> None:
    rows = {"cma-es": row(0.917, 0.938, 0.029), "swarm": row(0.88, 0.926, 0.033), "sample": row(0.99, 0.942)}
    told = rows_beside_paper([suite("structured", rows)], [], None)
    lines = list(beside_paper_section(told))
    cells = compared(*lines)
    assert [found[-1] == "yes" for found in list(cells.values())[1:]] == [True, True, False]
    # Behind within the paper's spread, behind by more, and ahead but of another kind.
    assert counts(told).startswith("Like for like 0 of 2 ") and " 1 of 2 " in counts(told) and "1 of 3 " in counts(told)
    within, beyond = (line for line in lines if line.startswith("- "))
    assert "cma-es (structured)" in within and "spread" in within
    assert "swarm (structured)" in beyond and "spread" not in beyond


def test_that_reasons_come_from_how_a_network_was_trained() -> None:
    trained = {
        "cvae": {**AT_BUDGET, "family": "mixed", "steps": 3000, "latent": 16},
        "fine": {**AT_BUDGET, "steps": 3000},
        "slow": AT_BUDGET,
        "paper": AT_BUDGET,
    }
    rows = {name: row(0.7, 0.84) for name in trained}
    lines = list(
        beside_paper_section(rows_beside_paper([], [suite("released", rows, trained)], None, {"cvae", "slow"}))
    )
    reasons = {line.partition(" ")[2].partition(" ")[0]: line for line in lines if line.startswith("- ")}
    assert all(part in reasons["cvae"] for part in ("3000 of 31250", "mixture", "16 x 16", "falls", "divergence"))
    assert "16 x 16" not in reasons["fine"] and "falls" not in reasons["fine"]
    assert "falls" in reasons["slow"] and "divergence" not in reasons["slow"]
    assert "not looked into" in reasons["paper"]
    logs = {
        "up": [{"structured_iou": 0.6}, {"structured_iou": 0.7}],
        "down": [{"structured_iou": 0.6}, {"structured_iou": 0.5}],
    }
    assert falling(logs) == {"down"}


def test_that_tables_of_several_runs_stand_in_one_report_with_a_dash_where_a_measure_was_not_taken(
    tmp_path: Path,
) -> None:
    new = suite("released", {"paper": row(0.97, 0.942, siou_released=0.9764)}, {"paper": AT_BUDGET})
    new["families"]["released"]["uniform_siou_released"] = 0.8837
    for folder, figures in (("generators", new), ("generators-older", suite("sobol", {"cgan": row(0.89, 0.876)}))):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "generators.json").write_text(json.dumps(figures))
    text = made_from(tmp_path).text
    table_2 = text.partition("## Table 2")[2]
    newer, older = table_2.partition("Sobol, 7 targets")[::2]
    assert "| uniform sheet | | 75.2 | | 88.4 |" in newer and "| 97.6 |" in newer and "earlier run" not in newer
    assert "| uniform sheet | | 75.2 | | - |" in older and older.startswith("; seed 0") and "earlier run" in older
    assert "| 2, generators | released | 7 | paper | 75.2 | 97.0 | 97.6 | 94.2 | +2.8 | yes |" in text
    assert "| 2, generators | sobol | 7 | cgan | 75.2 | 89.0 | - | 87.6 |" in text
    first = text.split("\n\n")[1]
    assert all(part in first for part in ("*Uniform sheet*", "*As released*", "Like for like 1 of 1 ", "2 of 2 are"))


def test_that_calls_that_differ_in_nothing_but_rows_stand_in_one_table_and_the_later_row_counts(tmp_path: Path) -> None:
    calls = {
        "generators": {"paper": row(0.97, 0.942), "prior": row(0.99, None)},
        "generators-more": {"paper": row(0.98, 0.942), "diffusion": row(0.95, 0.855)},
        "generators-other": {"cgan": row(0.89, 0.876)},
    }
    for folder, rows in calls.items():
        figures = suite("released", rows, dict.fromkeys(rows, AT_BUDGET))
        figures["seeds"] = [0, 1] if folder == "generators-other" else [0]
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "generators.json").write_text(json.dumps(figures))
    text = made_from(tmp_path).text
    one, other = text.partition("Released, 7 targets; seed 0;")[2].partition("Released, 7 targets; seeds 0, 1;")[::2]
    assert "Released, 7 targets" not in other
    assert [line.split("|")[1].strip() for line in one.splitlines() if "**" in line] == ["paper", "prior", "diffusion"]
    assert "**98.0**" in one and "**97.0**" not in text and "| cgan |" in other
    assert "3 of 3" in text.split("\n\n")[1], "each row counts once"


def test_that_runs_of_grpo_from_weights_that_are_no_longer_bundled_are_not_beside_the_paper() -> None:
    runs = {start: {"accuracy": [row(0.95, 0.9491, calls=10_000)]} for start in ("bundled paper", "bundled prior")}
    starts = {"bundled paper": "0" * 64, "bundled prior": digest_of("prior")}
    training = {start: {"accuracy": {"family": "mixed", "start": digest}} for start, digest in starts.items()}
    families = {"sobol": {"targets": 7, "uniform_siou": 0.8, "starts": runs}}
    found = rows_beside_paper([], [], {"families": families, "training": training})
    assert [one.name for one in found] == ["accuracy (from the bundled prior)"]


def test_that_the_released_measure_gives_the_uniform_sheet_more_and_a_design_itself_all() -> None:
    z = 0.3 * checkerboard(4, 4)
    sheet = deploy(RatioField.from_log10(z))
    own = Outline.from_points(sheet.outline(0.0), "own")
    assert released_match(sheet, own) > 0.98
    circle = load("circle")
    floor = released_floor(4, 4, circle)
    assert floor == released_match(deploy(RatioField.uniform(4, 4)), circle) > 0.84


def test_that_a_record_of_training_tells_family_budget_and_calls() -> None:
    settings = {"batch": 8, "family": "released", "shape": {"latent": 10}}
    assert Trained.of({"settings": settings, "validation": {"step": 179.0, "calls": 5728.0}}) == Trained(
        "released", 179, 8, 5728, 10
    )
    assert Trained.of({"settings": {"network": {"latent": 16}}}) == Trained("mixed", 0, 0, 0, 16)


def test_that_a_run_of_grpo_tells_what_it_had_where_its_variation_was_the_papers() -> None:
    early, last = row(0.947, None, calls=2528, tv=0.61), row(0.913, 0.9367, calls=10_000, tv=0.33)
    last["paper"]["tv"] = 0.60
    families = {"structured": {"targets": 7, "uniform_siou": 0.6, "starts": {"unet 0": {"regularity": [early, last]}}}}
    training = {"unet 0": {"regularity": {"family": "structured", "start": "0" * 64}}}
    (found,) = rows_beside_paper([], [], {"families": families, "training": training})
    assert not found.ahead and found.reason.endswith(
        "after 2528 calls its TV is 0.61 (the paper's 0.60, ours in the end 0.33), and sIoU 94.7"
    )


def test_that_a_run_of_grpo_says_when_its_start_is_no_longer_bundled() -> None:
    assert start_of("bundled paper", {"start": digest_of("paper")}) == "the bundled paper"
    assert start_of("bundled paper", {"start": "0" * 64}) == "an earlier paper"
    assert start_of("unet 01234567", {"start": "0" * 64}) == "the unet 01234567"


def test_that_a_run_of_grpo_from_weights_of_table_2_names_their_row() -> None:
    measured = {**suite("structured", {}), "weights": {"ot-cfm": "0" * 64, "prior": digest_of("prior")}}
    assert start_of("unet 01234567", {"start": "0" * 64}, [measured]) == "`ot-cfm` of Table 2"
    assert start_of("bundled prior", {"start": digest_of("prior")}, [measured]) == "the bundled prior"
