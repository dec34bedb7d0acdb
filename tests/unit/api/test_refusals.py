"""Bad input of every kind gets one clear sentence, before any work."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import shapely

import kirigami_studio as ks

NAN = float("nan")
BOW_TIE = [(0, 0), (1, 1), (1, 0), (0, 1)]


def code_of(wrong: Callable[[], object]) -> str:
    """The code of the refusal, whose sentence is one for a person."""
    with pytest.raises(ks.KirigamiError) as refused:
        wrong()
    sentence = str(refused.value)
    assert sentence != refused.value.code and "\n" not in sentence and sentence.endswith((".", ")"))
    return refused.value.code


@pytest.mark.parametrize(
    ("source", "code"),
    [
        ([(0, 0), (1, NAN), (1, 1)], "contour.not_finite"),
        ([(0, 0), (1, math.inf), (1, 1)], "contour.not_finite"),
        ([(0, 0), (1, 1)], "contour.too_few_vertices"),
        ([(0, 0), (1, 1), (2, 2)], "contour.runs_back"),
        (np.zeros((9, 3)), "contour.wrong_shape"),
        (np.zeros((2, 9)), "contour.wrong_shape"),
        (BOW_TIE, None),
        (shapely.Polygon(BOW_TIE), None),
        (shapely.Polygon(), "drawing.no_area"),
        (shapely.Point(0, 0), "drawing.no_area"),
        (shapely.GeometryCollection(), "drawing.no_area"),
        (np.zeros((8, 8), dtype=bool), "input.not_valid"),
        (np.full((8, 8), NAN), "input.not_valid"),
        ([], "api.not_a_target"),
        (np.zeros((4, 4, 3)), "api.not_a_target"),
        (np.full((9, 9), "a"), "api.not_a_target"),
        ([(0, 0), (1,), (1, 1)], "api.not_a_target"),
        (None, "api.not_a_target"),
        (3.5, "api.not_a_target"),
        ({"points": 3}, "api.not_a_target"),
        ([("a", "b"), ("c", "d"), ("e", "f")], "api.not_a_target"),
        ("no-such-name", "silhouette.unknown"),
        ("", "target.not_a_source"),
        ("gone.svg", "source.missing"),
        ("a\0b", "silhouette.unknown"),
        (Path("zzzz.xyz"), "silhouette.unknown"),
    ],
)
def test_that_what_is_no_target_is_refused(source: object, code: str | None) -> None:
    found = code_of(lambda: ks.load_target(source))  # type: ignore[arg-type]
    assert code is None or found == code


def test_that_options_that_a_target_does_not_have_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "box.svg"
    path.write_text('<svg xmlns="http://www.w3.org/2000/svg"><rect width="9" height="9"/></svg>', encoding="utf-8")
    assert code_of(lambda: ks.load_target(path, join="glue")) == "settings.no_such_choice"
    assert code_of(lambda: ks.load_target(path, join="hull", bridge=1.0)) == "option.bridge_without_join"
    assert code_of(lambda: ks.load_target(path, threshold=2.0)) == "option.threshold"
    assert code_of(lambda: ks.load_target(np.eye(8), parts="all")) == "parts.not_a_drawing"


@pytest.mark.parametrize(
    ("ratios", "code"),
    [
        ([[1.0, NAN], [1.0, 1.0]], "ratio.not_finite"),
        ([[1.0, -1.0], [1.0, 1.0]], "ratio.not_positive"),
        ([[1.0, 1e9], [1.0, 1.0]], "ratio.out_of_range"),
        (np.ones(9), "ratios.wrong_shape"),
        (np.ones((2, 3, 4)), "ratios.wrong_shape"),
        (np.ones((1, 4)), "grid.out_of_range"),
        (np.ones((65, 65)), "grid.out_of_range"),
        ([[1.0, 2.0], [1.0]], "ratios.not_numbers"),
        ([["1", "2"], ["3", "4"]], "ratios.not_numbers"),
        (np.ones((3, 3), dtype=complex), "ratios.not_numbers"),
        (None, "ratios.not_numbers"),
        ("gone.npy", "ratios.not_readable"),
        ("gone.kiri", "project.not_readable"),
        ("sheet.xyz", "ratios.unknown_extension"),
    ],
)
def test_that_what_is_no_sheet_is_refused(ratios: object, code: str) -> None:
    assert code_of(lambda: ks.decode(ratios)) == code  # type: ignore[arg-type]


def test_that_impossible_rims_starts_cells_and_angles_are_refused(uneven: ks.Sheet) -> None:
    even = np.ones((3, 3))
    assert code_of(lambda: ks.decode(even, rim={"above": [1.0]})) == "rim.not_four_sides"
    assert code_of(lambda: ks.decode(even, rim={"top": [NAN]})) == "rim.not_numbers"
    assert code_of(lambda: ks.decode(even, cell=(0.0, 1.0))) == "cell.not_positive"
    assert code_of(lambda: ks.decode(even, start=[(0, 0), (1, 0)])).startswith("start.")
    for phi, code in ((NAN, "angle.out_of_range"), (4.0, "angle.out_of_range"), ("flat", "angle.not_a_number")):
        assert code_of(lambda phi=phi: uneven.panels(phi)) == code  # type: ignore[misc]
        assert code_of(lambda phi=phi: uneven.feasibility(phi)) == code  # type: ignore[misc]
        assert code_of(lambda phi=phi: ks.score(uneven, "heart", phi=phi)) == code  # type: ignore[misc]
        assert code_of(lambda phi=phi: uneven.for_target("heart", phi=phi)) == code  # type: ignore[misc]
    assert code_of(lambda: uneven.for_target("heart", phi=math.pi)) == "request.angle_out_of_range"
    assert code_of(lambda: uneven.mask(0.0, 1)) == "raster.size_out_of_range"
    assert code_of(lambda: ks.siou(np.zeros((4, 4)), np.ones((4, 4)))) == "siou.mask_empty"


@pytest.mark.parametrize(
    ("options", "code"),
    [
        ({"k": 0}, "request.k_out_of_range"),
        ({"k": 2.5}, "api.not_whole"),
        ({"k": "8"}, "api.not_whole"),
        ({"seed": -1}, "request.seed_out_of_range"),
        ({"grid": (1, 1)}, "grid.out_of_range"),
        ({"grid": "10x10"}, "api.not_a_grid"),
        ({"grid": 10}, "api.not_a_grid"),
        ({"grid": (4.5, 4)}, "api.not_whole"),
        ({"phi": 4.0}, "request.angle_out_of_range"),
        ({"phi": NAN}, "api.not_a_number"),
        ({"phi": "0"}, "api.not_a_number"),
        ({"symmetry": "odd"}, "request.unknown_symmetry"),
        ({"rim": "round"}, "request.unknown_rim"),
        ({"prefer": "speed"}, "request.unknown_preference"),
        ({"regular": 2.0}, "request.regular_out_of_range"),
        ({"variant": "gan", "k": 1, "grid": (3, 3)}, "model.unknown_variant"),
        ({"budget_seconds": 0.0}, "request.budget_not_positive"),
        ({"material": "cheese"}, "material.unknown"),
        ({"material": 5}, "material.unknown"),
        ({"style": "curly"}, "settings.no_such_choice"),
        ({"width_mm": -3.0}, "settings.sheet_width"),
        ({"width_mm": "wide"}, "api.not_a_number"),
        ({"least_panel_mm": NAN}, "api.not_a_number"),
        ({"start": "polygon:2"}, "start.wrong_numbers"),
        ({"start": "zzzzzz"}, "silhouette.unknown"),
        ({"start": 5}, "api.not_a_target"),
        ({"start": "circle", "start_weight": 0.0}, "start.weight_out_of_range"),
        ({"also_phi": 1.0}, "api.second_target_not_named"),
        ({"also": "star", "also_phi": 5.0}, "second_target.angle_out_of_range"),
        ({"also": "star", "also_weight": NAN}, "api.not_a_number"),
        ({"also": "zzzzzz"}, "silhouette.unknown"),
    ],
)
def test_that_impossible_designs_are_refused_before_any_work(
    options: dict[str, object], code: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if "variant" not in options:
        monkeypatch.setattr("kirigami_studio.pipeline.run.run", lambda *_, **__: pytest.fail("the run was started"))
    assert code_of(lambda: ks.design("heart", **options)) == code  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("options", "code"),
    [
        ({"material": "cheese"}, "material.unknown"),
        ({"width_mm": 0.0}, "settings.sheet_width"),
        ({"width_mm": NAN}, "api.not_a_number"),
        ({"connector_mm": 0.0}, "settings.connector_width"),
        ({"kerf_mm": "thin"}, "api.not_a_number"),
        ({"style": "curly"}, "settings.no_such_choice"),
        ({"order": "random"}, "settings.no_such_choice"),
        ({"profile": "plasma"}, "profile.unknown"),
        ({"tabs": -1}, "tabs.too_many"),
        ({"tabs": 1.5}, "api.not_whole"),
        ({"copies": "fit"}, "api.not_whole"),
        ({"hinge_mm": 3.0}, "api.not_connector_widths"),
        ({"hinge_mm": {"a": 1.0}}, "api.not_whole"),
        ({"hinge_mm": {9999: 1.0}}, "export.no_such_connector"),
        ({"hinge_mm": {3: 1.0}, "removed": [3]}, "hinge.width_and_removed"),
        ({"removed": 3}, "api.not_connectors"),
        ({"removed": [-1]}, "hinge.named_twice"),
        ({"paper": 7}, "settings.paper_not_a_name"),
        ({"engrave": "yes"}, "settings.engrave_not_true_or_false"),
    ],
)
def test_that_impossible_cuts_are_refused(design: ks.Design, options: dict[str, object], code: str) -> None:
    assert code_of(lambda: design.plan_cuts(**options)) == code  # type: ignore[arg-type]


def test_that_options_of_another_name_are_python_s_own_errors(design: ks.Design) -> None:
    with pytest.raises(TypeError, match="widht_mm"):
        design.export("cut.dxf", widht_mm=80)


def test_that_files_that_cannot_be_written_or_read_are_told(
    design: ks.Design, cuts: ks.Cuts, hearts: ks.Designs, tmp_path: Path
) -> None:
    taken = tmp_path / "taken"
    taken.write_text("a file", encoding="utf-8")
    assert code_of(lambda: design.export(tmp_path / "cut.xyz")) == "export.unknown_kind"
    assert code_of(lambda: design.export(tmp_path / "cut")) == "export.no_extension"
    for suffix in ("dxf", "svg", "png", "pdf"):
        assert code_of(lambda suffix=suffix: cuts.export(taken / f"cut.{suffix}")) == "file.not_written"  # type: ignore[misc]
    assert code_of(lambda: design.export(taken / "closed.png")) == "file.not_written"
    assert code_of(lambda: hearts.save(taken / "hearts.kiri")) == "file.not_written"
    assert code_of(lambda: hearts.save(tmp_path / "hearts.zip")) == "api.not_a_project_name"
    assert code_of(lambda: ks.load_project(taken)) == "project.damaged"
    assert code_of(lambda: ks.load_project(tmp_path / "gone.kiri")) == "project.not_readable"
    assert code_of(lambda: ks.check(tmp_path / "gone.dxf"))
    (tmp_path / "broken.dxf").write_text("nonsense", encoding="utf-8")
    assert code_of(lambda: ks.check(tmp_path / "broken.dxf"))
    assert taken.read_text(encoding="utf-8") == "a file"


def test_that_designs_that_are_not_there_are_told(hearts: ks.Designs) -> None:
    assert code_of(lambda: hearts["Z9"]) == "api.no_such_name"
    with pytest.raises(IndexError, match="design 99 of 8"):
        hearts[99]
    with pytest.raises(TypeError):
        hearts[1.5]  # type: ignore[call-overload]


@pytest.mark.parametrize("angle", [np.array([0.1, 0.2]), [0.1, 0.2], np.zeros((2, 2)), "far"])
def test_that_an_angle_that_is_no_number_is_refused_in_a_sentence_that_can_be_read(angle: object) -> None:
    sheet = ks.decode(np.ones((3, 3)))
    for ask in (lambda: sheet.outline(angle), lambda: sheet.for_target("heart", phi=angle)):
        with pytest.raises(ks.KirigamiError) as refused:
            ask()
        assert "must be a number in radians, got " in str(refused.value)
