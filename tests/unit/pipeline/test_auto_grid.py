"""The grid that is chosen for a target: its parities, its proportions, its size, and the reason."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest
from shapely.geometry import LineString, Point, Polygon, box
from stopwatch import paced

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.proportions import Proportions
from kirigami_studio.outlines.silhouettes import load, names
from kirigami_studio.outlines.starts import start_shape
from kirigami_studio.outlines.symmetry import turned
from kirigami_studio.pipeline import auto_grid
from kirigami_studio.pipeline.auto_grid import (
    GOAL,
    GridChoice,
    ShapeFigures,
    choose_grid,
    chosen_for,
    known_for,
    predicted_for,
    predicted_match,
)
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import with_grid
from kirigami_studio.pipeline.tasks import TrialTask
from kirigami_studio.polish.continuation import first_angles
from kirigami_studio.polish.flat_sheet import width_in_cells


@pytest.fixture(autouse=True)
def nothing_remembered(monkeypatch) -> None:
    monkeypatch.setattr(auto_grid, "_CHOSEN", {})


@pytest.mark.parametrize("start", ["rectangle:5:1", "rectangle:1:4", "ellipse:4:1"])
def test_that_a_start_longer_than_any_grid_gets_the_longest_grids(start: str) -> None:
    shape = start_shape(start)
    rows, columns = choose_grid(load("heart"), start=shape).grid
    wide = shape.proportion(1, 1) < 0.0
    assert (columns if wide else rows) >= 2 * (rows if wide else columns)


@pytest.mark.parametrize("name", names())
def test_that_the_grid_has_what_the_shape_asks_for(name: str) -> None:
    choice = choose_grid(load(name))
    rows, columns = choice.grid
    assert min(rows, columns) >= 6 and max(rows, columns) <= 16
    assert choice.reason.startswith(f"{rows} x {columns}: ")
    symmetries = [pose.symmetry for pose in choice.poses]
    if not symmetries:
        assert rows % 2 == columns % 2 == 0
    assert all(pose.fits(choice.grid) for pose in choice.poses)
    if Symmetry.LEFT_RIGHT in symmetries:
        assert columns % 2 == 1


@pytest.mark.parametrize(
    ("name", "symmetry", "code"),
    [
        ("circle", Symmetry.TWO_MIRRORS, "grid.coarsest_with_two_mirror_axes"),
        ("hexagon", Symmetry.TWO_MIRRORS, "grid.coarsest_with_two_mirror_axes"),
        ("drop", Symmetry.LEFT_RIGHT, "grid.coarsest_with_mirror_axis"),
        ("egg", Symmetry.LEFT_RIGHT, "grid.coarsest_with_mirror_axis"),
        ("puzzle", Symmetry.LEFT_RIGHT, "grid.best_expected"),
        ("clover", None, "grid.best_expected"),
    ],
)
def test_that_the_first_symmetry_and_the_reason_are_those_of_the_shape(
    name: str, symmetry: Symmetry | None, code: str
) -> None:
    choice = choose_grid(load(name))
    assert (choice.poses[0].symmetry if choice.poses else None) is symmetry
    assert choice.code == code
    assert (choice.predicted_match >= GOAL) == ("coarsest" in code)


def test_that_easy_shapes_get_coarse_grids_and_hard_ones_fine_grids() -> None:
    def panels(name: str) -> int:
        rows, columns = choose_grid(load(name)).grid
        return (rows + 1) * (columns + 1)

    assert max(panels(name) for name in ("circle", "hexagon", "square", "egg")) <= 144
    assert min(panels(name) for name in ("puzzle", "butterfly", "star")) >= 200


def test_that_a_sheet_is_long_where_the_shape_is_long() -> None:
    rows, columns = choose_grid(load("leaf")).grid
    assert rows > columns
    rows, columns = choose_grid(load("wave")).grid
    assert columns > rows
    lying = Outline.from_points(turned(load("leaf").points, 1.0))
    assert choose_grid(lying).grid == choose_grid(load("leaf")).grid


def test_that_a_setting_decides_which_symmetry_counts() -> None:
    heart, cloud = load("heart"), load("cloud")
    free = choose_grid(heart, symmetry="none")
    assert free.poses == () and free.code in ("grid.coarsest_expected", "grid.best_expected")
    assert choose_grid(cloud).poses == ()
    forced = choose_grid(cloud, symmetry="mirror")
    assert forced.poses[0].symmetry is Symmetry.LEFT_RIGHT and forced.grid[1] % 2 == 1
    assert forced.predicted_match < 0.96, "half of what the sketch and its image do not share is lost"
    with pytest.raises(TargetError) as refused:
        choose_grid(load("letter-l"), symmetry="mirror")
    assert refused.value.code == "symmetry.no_mirror_axis"


def test_that_panels_are_kept_from_becoming_too_small_to_cut() -> None:
    star = load("star")
    wide, narrow = choose_grid(star), choose_grid(star, width_mm=40.0, least_feature_mm=1.0)
    assert narrow.grid[1] < wide.grid[1] and narrow.predicted_match < wide.predicted_match
    assert narrow.code == "grid.panels_would_be_too_small"
    assert "40 mm wide would be smaller than 1 mm" in narrow.reason
    circle = choose_grid(load("circle"), width_mm=60.0, least_feature_mm=1.0)
    assert circle.code == "grid.coarsest_with_two_mirror_axes"
    assert choose_grid(star, width_mm=1.0, least_feature_mm=5.0).grid[1] <= 9


def test_that_grids_of_pinned_sheets_have_room_for_their_pins_and_no_parity_of_mirrors() -> None:
    for name in ("heart", "star", "hexagon"):
        choice = choose_grid(load(name), width_mm=240.0, least_gap_mm=9.8)
        rows, columns = choice.grid
        assert 7 <= columns <= 9 and 9.8 * (columns + 1) / 240.0 <= 0.42 and rows <= 10
        assert all(not pose.symmetry.mirrors for pose in choice.poses)
    heart, small = choose_grid(load("heart"), width_mm=240.0, least_gap_mm=9.8), 100.0
    assert heart.grid == (8, 8) and heart.code == "grid.pins_would_be_too_near"
    assert "nearer than 9.8 mm" in heart.reason
    assert choose_grid(load("heart"), width_mm=small, least_gap_mm=9.8).grid[1] <= 4
    # Somebody has to put the pieces together: large sheets get large panels.
    assert max(choose_grid(load("star"), width_mm=900.0, least_gap_mm=9.8).grid) <= 10
    disk = choose_grid(load("square"), width_mm=240.0, least_gap_mm=9.8, start=start_shape("circle"))
    assert 9.8 * width_in_cells(disk.grid, start_shape("circle")) / 240.0 <= 0.42
    request = Request(load("heart"), None, k=4, polish=0, width_mm=240.0, least_gap_mm=9.8)
    assert predicted_for(request) == chosen_for(request) == heart


def test_that_sheets_on_pins_are_upright_for_long_shapes_and_have_no_more_pieces() -> None:
    # Width limits how many cells pins leave room for, height does not.
    for name in ("letter-l", "crescent", "bone", "wave"):
        rows, columns = choose_grid(load(name), width_mm=240.0, least_gap_mm=9.0, upright=True).grid
        assert rows > 1.4 * columns and (rows + 1) * (columns + 1) <= 91
    # Prints are made as a whole, and lie on one plate.
    rows, columns = choose_grid(load("letter-l"), width_mm=240.0, least_gap_mm=9.0).grid
    assert rows <= columns


@pytest.mark.parametrize(
    ("name", "worth", "lost"), [("bone", 0.42, True), ("bone", 0.77, False), ("clover", 0.42, False)]
)
def test_that_cells_of_a_disk_on_pins_are_long_where_fits_of_a_long_target_are_lost(name, worth, lost) -> None:
    asked: list[tuple[int, int]] = []

    def trials(request: Request, tasks: Sequence[TrialTask]) -> list[float]:
        asked.extend(task.grid for task in tasks)
        return [0.84 if task.grid == (5, 9) else worth for task in tasks]

    disk = {"start": start_shape("circle"), "width_mm": 240.0, "least_gap_mm": 9.0, "two_layers": True}
    request = Request(load(name), None, k=4, polish=0, **disk)
    predicted = predicted_for(request).grid
    assert predicted[0] == predicted[1]
    assert chosen_for(request, trials).grid == ((5, 9) if lost else predicted)
    others = set(asked) - {predicted}
    if lost:
        assert others and all(rows < columns and (rows + 1) * (columns + 1) <= 64 for rows, columns in others)
    else:
        assert all(abs(rows - columns) <= 1 for rows, columns in others), "none of long cells"


@pytest.mark.parametrize(("worth", "gained"), [(0.77, True), (0.76, False)])
def test_that_short_fits_decide_between_grids_of_a_disk_on_pins_where_little_is_expected(worth, gained) -> None:
    def trials(request: Request, tasks: Sequence[TrialTask]) -> list[float]:
        return [worth if task.grid == (8, 7) else 0.75 for task in tasks]

    disk = {"start": start_shape("circle"), "width_mm": 240.0, "least_gap_mm": 9.0, "two_layers": True}
    request = Request(load("clover"), None, k=4, polish=0, **disk)
    assert predicted_for(request).grid == (7, 7), "odd grids, too, as few fit"
    choice = chosen_for(request, trials)
    assert choice.grid == ((8, 7) if gained else (7, 7)) and dict(choice.fields)["count"] == 3
    print_of = Request(load("clover"), None, k=4, polish=0, **(disk | {"two_layers": False}))
    assert predicted_for(print_of).grid == (6, 6), "prints keep even ones"
    assert choose_grid(load("cloud"), limit=6, start=start_shape("circle")).grid == (6, 6), "so does one sheet"
    # Of an arrow enough is expected.
    arrow = Request(load("arrow"), None, k=4, polish=0, **disk)
    assert chosen_for(arrow, trials) == predicted_for(arrow)


def test_that_short_fits_decide_whether_a_sheet_on_pins_is_square_or_upright() -> None:
    def chosen(name: str) -> GridChoice:
        return chosen_for(Request(load(name), None, k=4, polish=0, width_mm=240.0, least_gap_mm=9.0, two_layers=True))

    cross, arrow = chosen("cross"), chosen("arrow")
    assert cross.grid == (8, 8) and cross.code == arrow.code == "grid.best_tried"
    assert choose_grid(load("cross"), width_mm=240.0, least_gap_mm=9.0, upright=True).grid != (8, 8)
    assert arrow.grid[0] > 1.4 * arrow.grid[1]


def test_that_a_limit_is_kept() -> None:
    assert max(choose_grid(load("puzzle"), limit=10).grid) <= 10
    assert max(choose_grid(load("puzzle"), limit=24).grid) > 16


def test_that_more_panels_and_simpler_shapes_are_expected_to_match_better() -> None:
    star, egg = ShapeFigures.of(load("star")), ShapeFigures.of(load("egg"))
    assert predicted_match(star, (10, 11), 0.0) < predicted_match(star, (14, 15), 0.0)
    assert predicted_match(star, (10, 11), 0.0) < predicted_match(egg, (10, 11), 0.0)
    assert predicted_match(egg, (10, 11), 1.0) < predicted_match(egg, (16, 7), 1.0)


def star(points: int, inner: float) -> Polygon:
    angle = np.arange(2 * points) * math.pi / points + math.pi / 2
    radius = np.where(np.arange(2 * points) % 2, inner, 1.0)
    return Polygon(np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1))


#: Shapes that had no part in the calibration, a grid, and the exact IoU that fits from the uniform sheet reached on it.
REACHED = [
    (star(7, 0.6), (10, 9), 0.982),
    (star(7, 0.6), (14, 13), 0.992),
    (Point(0, 1).buffer(0.8).union(Polygon([[-0.3, 1], [0.3, 1], [0.7, -1.2], [-0.7, -1.2]])), (16, 7), 0.994),
    (box(0, 0, 2, 2.4).union(Point(2, 1.2).buffer(0.8)), (10, 9), 0.995),
    (Polygon([[0, 2], [1, 0], [0, -3], [-1, 0]]), (16, 5), 0.992),
    (Polygon([[-2, 0], [2, 0], [1, 1.6], [-1, 1.6]]), (6, 13), 0.997),
    (Point(0, 0).buffer(1).intersection(box(-1, 0, 1, 1)), (6, 13), 0.995),
    (LineString([[-1.6, 0], [1.6, 0]]).buffer(0.8), (5, 15), 0.988),
    (Point(0, 0).buffer(2).difference(Point(0, 0).buffer(1)).intersection(box(-3, 0, 3, 3)), (7, 15), 0.986),
    (box(0, 0, 1, 4).union(box(2.5, 0, 3.5, 4)).union(box(0, 1.5, 3.5, 2.5)), (13, 13), 0.903),
]


def test_that_shapes_that_were_not_fitted_match_as_predicted() -> None:
    predicted, reached = [], []
    for shape, grid, match in REACHED:
        target = Outline.from_points(shape.exterior.coords[:-1])
        upright = Proportions.of(target).along(0.5 * math.pi)
        predicted.append(predicted_match(ShapeFigures.of(target), grid, upright))
        reached.append(match)
    off = np.abs(np.array(predicted) - reached)
    assert np.median(off) < 0.004 and off.mean() < 0.006
    assert np.corrcoef(np.log(1.0 - np.array(predicted)), np.log(1.0 - np.array(reached)))[0, 1] > 0.8


def test_that_the_choice_does_not_delay_the_first_design() -> None:
    shapes = [Outline.from_points(turned(load(name).points, 0.1)) for name in ("gear", "clover", "butterfly", "heart")]
    choose_grid(load("circle"))
    assert paced(lambda: [choose_grid(shape) for shape in shapes], 1) < 0.15 * len(shapes)


def test_that_a_run_takes_the_chosen_grid_unless_one_is_given() -> None:
    heart = load("heart")
    chosen = with_grid(Request(heart, None, polish=0))
    assert chosen.grid == choose_grid(heart).grid and chosen_for(chosen).reason == choose_grid(heart).reason
    assert with_grid(Request(heart, (7, 8), polish=0)).grid == (7, 8)
    assert with_grid(Request(heart, None, width_mm=40.0, least_feature_mm=1.0, polish=0)).chosen_grid[1] <= 9
    assert math.isclose(chosen_for(chosen).predicted_match, choose_grid(heart).predicted_match)


def test_that_a_hard_shape_with_an_axis_takes_the_grid_that_short_fits_rank_first(monkeypatch) -> None:
    star = load("star")
    tried: list[tuple[int, int]] = []

    def worth(request, grids, trials) -> dict:
        tried.extend(one.grid for one in grids)
        return {one: 0.9 if one.grid == max(tried) else 0.5 + 0.001 * place for place, one in enumerate(grids)}

    monkeypatch.setattr(auto_grid, "_worth", worth)
    assert known_for(Request(star, None, polish=0)) == predicted_for(Request(star, None, polish=0)), (
        "nothing has been tried"
    )
    choice = chosen_for(Request(star, None, polish=0))
    assert known_for(Request(star, None, polish=0)) == choice
    assert 2 <= len(tried) <= auto_grid.MOST_TRIED
    assert choice.grid == max(tried) and choice.code == "grid.best_tried"
    assert str(len(tried)) in choice.reason
    proportions = sorted(math.log((rows + 1) / (columns + 1)) for rows, columns in tried)
    assert all(after - before > auto_grid.TRIED_APART for before, after in pairwise(proportions))


def test_that_easy_shapes_and_shapes_without_an_axis_take_the_predicted_grid(monkeypatch) -> None:
    monkeypatch.setattr(auto_grid, "_worth", lambda *given: pytest.fail("a trial"))
    for name in ("heart", "hexagon", "letter-l"):
        request = Request(load(name), None, polish=0)
        assert chosen_for(request) == predicted_for(request)


def test_that_finer_grids_are_tried_where_none_of_the_others_will_do(monkeypatch) -> None:
    butterfly = load("butterfly")
    tried: list[tuple[int, int]] = []
    gain = auto_grid.FINER_GAIN

    def worth(request, grids, trials) -> dict:
        tried.extend(one.grid for one in grids)
        return {one: 0.96 + (gain if max(one.grid) > auto_grid.FINEST else 0.0) + 1e-5 * one.grid[1] for one in grids}

    monkeypatch.setattr(auto_grid, "_worth", worth)
    choice = chosen_for(Request(butterfly, None, polish=0))
    finer = [grid for grid in tried if max(grid) > auto_grid.FINEST]
    coarser = [grid for grid in tried if grid not in finer]
    assert 1 <= len(finer) <= 3 and choice.grid == max(finer, key=lambda grid: grid[1])
    assert choice.code == "grid.finer_tried" and str(len(tried)) in choice.reason
    assert all(max(grid) <= auto_grid.FINER_LIMIT for grid in finer)
    assert all((rows + 1) * (columns + 1) <= auto_grid.FINER_PANELS for rows, columns in finer)
    # A cut in the middle of the sheet's upper and lower edge, in one of them, or in none: each kind once.
    kinds = [(rows % 2, columns % 4 if rows % 2 else 0) for rows, columns in finer]
    assert len(set(kinds)) == len(kinds)
    monkeypatch.setattr(auto_grid, "FINER_GAIN", 2 * gain)
    auto_grid._CHOSEN.clear()
    kept = chosen_for(Request(butterfly, None, polish=0))
    assert kept.code == "grid.best_tried" and kept.grid in coarser, "a finer grid has to be worth its cuts"


@pytest.mark.parametrize(("worth", "start"), [(0.9, "rectangle"), (0.98, "rectangle"), (0.96, "circle")])
def test_that_no_finer_grid_is_tried_where_one_would_not_help_or_is_not_needed(
    worth: float, start: str, monkeypatch
) -> None:
    tried: list[tuple[int, int]] = []
    monkeypatch.setattr(
        auto_grid, "_worth", lambda request, grids, trials: {one: tried.append(one.grid) or worth for one in grids}
    )
    chosen_for(Request(load("butterfly"), None, start=start_shape(start), polish=0))
    assert tried and max(max(grid) for grid in tried) <= auto_grid.FINEST


def test_that_the_predicted_grid_is_taken_where_all_short_fits_are_lost(monkeypatch) -> None:
    monkeypatch.setattr(
        auto_grid, "_worth", lambda request, grids, trials: {one: 0.3 + 0.01 * one.grid[0] for one in grids}
    )
    request = Request(load("bone"), None, polish=0)
    assert chosen_for(request) == predicted_for(request)


def test_that_trials_rank_the_grids_of_a_fir_as_whole_fits_do() -> None:
    # Whole runs end at an exact IoU of 0.984 on the second grid, and of 0.977 on the first.
    wish = Request(load("fir"))
    worth: list[float] = []
    for grid in ((16, 13), (16, 15)):
        angle, kept = first_angles(wish.silhouette, grid)[1]
        worth.append(TrialTask(grid, angle, kept, auto_grid.TRIAL).carry_out(wish, lambda: False).worth)
    assert worth[1] > worth[0] + 0.005
