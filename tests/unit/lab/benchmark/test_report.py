"""The report: whole from small runs, the same from the same files, refused from broken ones."""

from __future__ import annotations

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
from command_line import answer
from PIL import Image

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.generator.weights import digest_of
from kirigami_studio.lab.benchmark.line_chart import Curve, LineChart
from kirigami_studio.lab.benchmark.report.cells import rows_of_older_weights
from kirigami_studio.lab.benchmark.report.whole import made_from

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Both suites on two targets of each family, and the log of a training run."""
    folder = tmp_path_factory.mktemp("runs")
    log = folder / "training" / "cgan" / "log.jsonl"
    log.parent.mkdir(parents=True)
    lines = [
        {"step": step, "seconds": step, "loss": 9.0 / step, "structured_iou": match, "sobol_iou": 0.8, "drawn_iou": 0.7}
        for step, match in ((10.0, 0.6), (20.0, 0.7))
    ]
    log.write_text("".join(json.dumps(line) + "\n" for line in lines))
    about = {"parameters": 123_456, "settings": {"batch": 64, "learning_rate": 0.0005}}
    (log.parent / "about.json").write_text(json.dumps(about))
    return folder


@pytest.mark.torch
def test_that_a_quick_report_has_every_table_with_numbers_that_hold(
    runs: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = runs / "report.md"
    files = answer(capsys, "benchmark", "report", "--quick", "--runs", runs, "--out", out, "--json")["files"]
    text = out.read_text()
    sections = ("Table 1: solvers", "Best of K", "Sizes of the grid", "Table 2: conditional generators", "Training")
    assert all(f"## {section}" in text for section in (*sections, "Shape by shape", "As cut"))
    assert all(f"](report/{Path(picture).name})" in text for picture in files[1:]) and len(files) == 10
    solvers = json.loads((runs / "solvers" / "solvers.json").read_text())["families"]
    generators = json.loads((runs / "generators" / "generators.json").read_text())["families"]
    for family in ("structured", "sobol"):
        rows, uniform = solvers[family]["rows"], solvers[family]["uniform_siou"]
        assert rows["sample-fit"]["siou"] >= rows["sample"]["siou"] > 0.9
        assert rows["fit"]["siou"] > uniform
        assert max(rows[name]["most_evaluations"] for name in ("cma-es", "swarm", "local-search", "powell")) <= 40
        assert rows["sample-fit"]["siou"] > rows["cma-es"]["siou"]
        assert generators[family]["rows"]["prior"]["success"] == 1.0
        assert f"**{100 * rows['fit']['siou']:.1f}**" in text
    assert "(93.8)" in text and "| cgan |  | 0.12 M | 20 | 64 | 0.0005 |" in text
    assert "Measured on " in text and json.loads((runs / "machine.json").read_text())["cores"] >= 1
    for name, row in solvers["structured"]["rows"].items():
        if row["paper"]:
            lead = 100.0 * (row["siou"] - row["paper"]["siou"])
            floor, own, released = (
                f"{100 * value:.1f}"
                for value in (solvers["structured"]["uniform_siou"], row["siou"], row["siou_released"])
            )
            assert f"| 1, solvers | structured | 2 | {name} | {floor} | {own} | {released} |" in text
            assert f" {lead:+.1f} |" in text
    behind = [
        name for name, row in solvers["sobol"]["rows"].items() if row["paper"] and row["siou"] < row["paper"]["siou"]
    ]
    assert behind and all(name in text.partition("Why rows are behind:")[2].partition("##")[0] for name in behind)
    with Image.open(out.with_suffix("") / "benchmark-samples.png") as picture:
        assert picture.width > 6 * 150 and picture.height > 150, "three samples for a target of each family"
    curves = json.loads((runs / "solvers" / "best-of-k.json").read_text())["families"]["sobol"]
    assert [at["k"] for at in curves["sample-fit"]] == [1, 2]
    assert curves["sample-fit"][1]["siou"] >= curves["sample-fit"][0]["siou"] > 0.9
    sizes = json.loads((runs / "grid-sweep" / "grid-sweep.json").read_text())["sizes"]
    assert sizes[0]["marching"]["wrong"] == 0.0 and sizes[-1]["marching"]["wrong"] > 0.5
    assert max(at["marching"]["local_rule_most"] for at in sizes) < 1e-9
    shapes = json.loads((runs / "shapes" / "quick.json").read_text())["targets"]["shapes"]
    assert min(row["iou_exact"] for row in shapes.values()) > 0.975 and all(row["symmetry"] for row in shapes.values())
    (sheet,) = json.loads((runs / "as-cut.json").read_text())["sheets"]
    assert sheet["passed"] and sheet["pieces"] == 1 and sheet["jam_deg"] == 0.0 and sheet["iou_as_cut"] > 0.97
    assert 0.5 < generators["sobol"]["uniform_siou"] < generators["sobol"]["uniform_siou_released"] < 1.0
    assert generators["sobol"]["rows"]["prior"]["siou_released"] > 0.9
    assert made_from(runs) == made_from(runs)


@pytest.mark.torch
def test_that_the_report_in_the_docs_is_that_of_its_runs_and_its_counts_stand_among_what_was_measured(
    tmp_path: Path,
) -> None:
    docs = Path(__file__).parents[4] / "docs"
    made_from(docs / "benchmark").save(tmp_path / "benchmark.md")
    text = (tmp_path / "benchmark.md").read_text()
    assert text == (docs / "benchmark.md").read_text()
    first = text.split("\n\n")[1]
    (measured,) = (line for line in (docs / "measured.md").read_text().splitlines() if "Tables 1 to 3" in line)
    counts = re.findall(r"\d+ of \d+", first)
    assert len(counts) == 3 and counts == re.findall(r"\d+ of \d+", measured)
    (quoted,) = (line for line in (docs.parent / "README.md").read_text().splitlines() if "like for like" in line)
    assert counts[:2] == re.findall(r"\d+ of \d+", quoted)


def test_that_rows_of_weights_that_are_no_longer_bundled_are_named() -> None:
    measured = {"paper": "0" * 64, "prior": digest_of("prior"), "ot-cfm": "1" * 64}  # that one was never bundled
    assert rows_of_older_weights(measured) == ["paper"]


def test_that_a_chart_shows_every_curve_with_its_name() -> None:
    curves = [Curve("one", ((1.0, 90.0), (2.0, 95.0))), Curve("two", ((1.0, 80.0), (2.0, 85.0)))]
    root = ElementTree.fromstring(LineChart("steps", "match (%)", curves, logarithmic=True).svg())
    words = [text.text for text in root.iter(f"{SVG}text")]
    assert {"one", "two", "steps", "match (%)"} <= set(words)
    lines = [line for line in root.iter(f"{SVG}polyline") if "fill: none" in line.get("style", "")]
    assert len(lines) >= 2


def test_that_an_empty_folder_and_broken_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(KirigamiError) as empty:
        made_from(tmp_path)
    assert empty.value.code == "benchmark.nothing_to_report"
    (tmp_path / "solvers").mkdir()
    for content in ("[1]", "{}", '{"families": {"a": 3}}', "no json"):
        (tmp_path / "solvers" / "solvers.json").write_text(content)
        with pytest.raises(KirigamiError) as broken:
            made_from(tmp_path)
        assert broken.value.code == "benchmark.report_unreadable"
