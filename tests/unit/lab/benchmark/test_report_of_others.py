"""The report's sections on published sheets and on the leaderboard."""

from __future__ import annotations

import json
from pathlib import Path

from kirigami_studio.lab.benchmark.report.whole import made_from


def literature_row(
    target: str, panels: int, first: float, published: float | None, state: str = "half"
) -> dict[str, object]:
    return {
        "target": target,
        "state": state,
        "panels": panels,
        "uniform": 0.8,
        "first": first,
        "most": first + 0.01,
        "released": 0.975 if state == "closed" else None,
        "first_cv": 0.4,
        "most_cv": 0.5,
        "first_rim_off": 0.02,
        "processor_seconds": 3.0,
        "published": published,
    }


def test_that_published_sheets_stand_beside_ours_from_all_calls(tmp_path: Path) -> None:
    first = [literature_row("star", 36, 0.868, 0.861), literature_row("star", 64, 0.89, None)]
    more = [literature_row("circle", 25, 0.97, 0.9748, "closed")]
    (tmp_path / "literature.json").write_text(json.dumps({"each": first}))
    (tmp_path / "literature-more.json").write_text(json.dumps({"each": more}))
    text = made_from(tmp_path).text
    assert "Ahead of 1 (first) and 2 (best) of 2 published sheets" in text
    assert "| star | half open | 36 | 86.1 | 80.0 | **86.8** | - | 87.8 | 0.40 | 0.50 | 2.0 | 3.0 |" in text
    assert "| circle | closed | 25 | 97.5 | 80.0 | **97.0** | 97.5 | 98.0 | 0.40 | 0.50 | 2.0 | 3.0 |" in text
    assert "| half open | 64 | 1 | 80.0 | **89.0** |" in text
    assert "| star | half open |  | **86.8** (87.8) | **89.0** (90.0) |" in text
    assert "| circle | closed | **97.0** (98.0) |  |  |" in text


def test_that_pairs_of_shapes_stand_by_start_and_target(tmp_path: Path) -> None:
    pairs = [
        {"start": start, "target": target, "iou_exact": iou, "uniform_iou": 0.75}
        for start, target, iou in (("circle", "star", 0.99), ("heart", "star", 0.985), ("circle", "drop", 0.991))
    ]
    pairs.append(pairs[-1] | {"start": "heart", "iou_exact": 0.98})
    means = {"start_error_worst": 0.005, "iou_exact": 0.9865, "iou_exact_worst": 0.98, "panel_area_cv": 0.5}
    (tmp_path / "starts.json").write_text(json.dumps({**means, "processor_seconds": 4.0, "each": pairs}))
    text = made_from(tmp_path).text
    assert "| heart | **98.5** (75.0) | **98.0** (75.0) |" in text and "worst 98.0" in text


def test_that_the_leaderboard_has_a_table_for_each_set_best_first(tmp_path: Path) -> None:
    figures = {"grid": "10 x 10", "seed": 0, "siou_interval": [0.8, 0.9], "siou_released": 0.91, "iou_exact": 0.9}
    figures |= {"success": 1.0, "tv": 1.0, "area_cv": 0.4, "seconds": 0.1, "version": "1", "targets": 5}
    rows = [
        figures | {"family": "drawn", "generator": "uniform", "siou": 0.7},
        figures | {"family": "drawn", "generator": "mine", "siou": 0.95},
        figures | {"family": "sobol", "generator": "mine", "siou": 0.9},
    ]
    (tmp_path / "leaderboard.json").write_text(json.dumps({"rows": rows}))
    text = made_from(tmp_path).text
    assert text.index("Drawn, 5 targets") < text.index("| mine | 0 | **95.0** | 80.0 - 90.0 | 91.0 |")
    assert text.index("| mine | 0 | **95.0**") < text.index("| uniform |") < text.index("Sobol, 5 targets")


def test_that_training_runs_have_the_minutes_of_all_their_sittings(tmp_path: Path) -> None:
    log = tmp_path / "training" / "diffusion" / "log.jsonl"
    log.parent.mkdir(parents=True)
    figures = {"loss": 1.0, "structured_iou": 0.8, "released_iou": 0.9, "sobol_iou": 0.7, "drawn_iou": 0.6}
    lines = [{"step": step, "seconds": 60.0 * minutes, **figures} for step, minutes in enumerate((5, 9, 2, 4, 1))]
    log.write_text("".join(json.dumps(line) + "\n" for line in lines))
    assert "| diffusion |  |  | 4 |  |  | 14 | 80.0 | 90.0 | 70.0 | 60.0 | 1.0000 |" in made_from(tmp_path).text
