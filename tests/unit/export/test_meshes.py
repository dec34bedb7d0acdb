"""Solids in STL, 3MF and OBJ: closed, as large as planned, the same for other readers, whole or not there."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import shapely
from refusals import refused
from shapely.geometry import Polygon
from solid_reader import ReadBody, read_3mf, read_stl

from kirigami_studio.assembly.backed import TileSizes
from kirigami_studio.assembly.solids import PrintForm, Printing, Solid
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.meshes import KINDS, LAYER_COLOURS, check_bodies, write_meshes
from kirigami_studio.export.registry import export, export_files
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.fabricate.material import find_material, presets
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.foundation.errors import ExportError, FabricationError
from kirigami_studio.lattice.deployment import Deployment
from tests.cut_sheets import burned

MakeDesign = Callable[..., Deployment]
THICKNESS = 1.6
SHEET, TILES = Printing(PrintForm.SHEET, THICKNESS), Printing(PrintForm.TILES, THICKNESS)
#: A blade's slit is at least this wide in a solid (mm).
LEAST_SLIT = 0.01


def job_of(design: Deployment, printing: Printing, width_mm: float = 120.0, kerf_mm: float = 0.4) -> ExportJob:
    return ExportJob(design, plan=plan_cuts(design, width_mm, 1.5, kerf_mm), printing=printing)


def finished_area(job: ExportJob) -> float:
    """Area of the finished sheet, from what is burned along its paths."""
    plan = job.required_plan
    kerf = max(plan.kerf_mm, LEAST_SLIT)
    area = Polygon(plan.outline).buffer(-0.5 * kerf, join_style="mitre")
    inner = [path for path in plan.paths if path.layer.value != "OUTLINE"]
    return float(area.difference(shapely.union_all([burned(path, kerf) for path in inner])).area)


def top_of(body: ReadBody) -> shapely.Geometry:
    """The area at the top of a body."""
    top = body.triangles[np.all(body.triangles[:, :, 2] > THICKNESS - 1e-3, axis=1)][:, :, :2]
    return shapely.union_all(shapely.polygons(top), grid_size=1e-6)


@pytest.fixture(scope="module")
def design(make_design: MakeDesign) -> Deployment:
    return make_design(3, 4, seed=2, spread=0.3)


def test_that_a_sheet_is_one_closed_body_of_its_area_times_its_thickness(design: Deployment, tmp_path: Path) -> None:
    job = job_of(design, SHEET)
    body = read_stl(export(job, tmp_path / "sheet.stl"))
    assert body.closed
    assert body.volume == pytest.approx(finished_area(job) * THICKNESS, rel=1e-3)
    low, high = body.bounds
    np.testing.assert_allclose(low, 0.0, atol=1e-4)
    width, height = job.required_plan.size_mm
    np.testing.assert_allclose(high, [width, height, THICKNESS], atol=0.01)


def test_that_a_sheet_is_as_thick_as_its_material_unless_asked_for(design: Deployment, tmp_path: Path) -> None:
    card = find_material("card-co2")
    job = ExportJob(design, plan=plan_cuts(design, 200.0, material=card))
    assert read_stl(export(job, tmp_path / "sheet.stl")).bounds[1, 2] == pytest.approx(card.thickness_mm)


def test_that_tiles_are_named_bodies_in_the_colours_of_the_checkerboard(design: Deployment, tmp_path: Path) -> None:
    bodies = read_3mf(export(job_of(design, TILES), tmp_path / "tiles.3mf"))
    assert list(bodies) == [f"A{number}" for number in range(1, 21)]
    colours = [colour[:7] for _, colour in LAYER_COLOURS.values()]
    expected = [colours[(row + column) % 2] for row in range(4) for column in range(5)]
    assert [body.colour for body in bodies.values()] == expected
    for body in bodies.values():
        assert body.closed and body.volume == pytest.approx(top_of(body).area * THICKNESS, rel=1e-3)
    assert np.min([body.bounds[0] for body in bodies.values()], axis=0) == pytest.approx([0.0, 0.0, 0.0], abs=1e-5)


def test_that_tiles_leave_the_gap_between_them(design: Deployment, tmp_path: Path) -> None:
    wide = Printing(PrintForm.TILES, THICKNESS, TileSizes(gap_mm=1.25, relief_mm=0.0))
    bodies = read_3mf(export(job_of(design, wide), tmp_path / "tiles.3mf"))
    areas = [top_of(body) for body in bodies.values()]
    tree = shapely.STRtree(areas)
    _, distance = tree.query_nearest(areas, exclusive=True, return_distance=True)
    assert distance.min() >= 2.9 - 1e-3 and distance.max() <= 2.9 + 1.0


def test_that_stl_3mf_and_obj_hold_the_same_bodies(design: Deployment, tmp_path: Path) -> None:
    job = job_of(design, TILES)
    stl, threemf, obj = (export(job, tmp_path / f"tiles{extension}") for extension in (".stl", ".3mf", ".obj"))
    bodies, alone = read_3mf(threemf), read_stl(stl)
    assert alone.closed and alone.volume == pytest.approx(sum(body.volume for body in bodies.values()), rel=1e-5)
    lines = [line.split() for line in obj.read_text().splitlines() if line]
    assert [line[1] for line in lines if line[0] == "o"] == list(bodies)
    assert sum(line[0] == "f" for line in lines) == len(alone.triangles)


def test_that_the_same_job_gives_the_same_bytes(design: Deployment, tmp_path: Path) -> None:
    for extension in KINDS:
        one, other = (export(job_of(design, TILES), tmp_path / f"{name}{extension}") for name in "ab")
        assert one.read_bytes() == other.read_bytes()


def test_that_tiles_are_divided_into_plates_that_fit_on_the_bed(design: Deployment, tmp_path: Path) -> None:
    bed = (70.0, 50.0)
    whole = read_3mf(export(job_of(design, TILES), tmp_path / "whole.3mf"))
    small = Printing(PrintForm.TILES, THICKNESS, bed_mm=bed)
    paths = export_files(job_of(design, small), tmp_path / "tiles.3mf")
    later = [f"tiles-{number}.3mf" for number in range(2, len(paths) + 1)]
    assert [path.name for path in paths] == ["tiles.3mf", *later]
    assert len(paths) >= 4
    found: dict[str, ReadBody] = {}
    for path in paths:
        bodies = read_3mf(path)
        low = np.min([body.bounds[0] for body in bodies.values()], axis=0)
        high = np.max([body.bounds[1] for body in bodies.values()], axis=0)
        assert low == pytest.approx([0.0, 0.0, 0.0], abs=1e-5) and np.all(high[:2] <= np.array(bed) + 1e-5)
        found |= bodies
    assert {name: round(body.volume, 2) for name, body in found.items()} == {
        name: round(body.volume, 2) for name, body in whole.items()
    }


def test_that_a_body_larger_than_the_bed_is_refused(design: Deployment, tmp_path: Path) -> None:
    small = Printing(PrintForm.SHEET, THICKNESS, bed_mm=(100.0, 200.0))
    with refused(FabricationError, "printed.larger_than_bed", name="sheet", bed_width_mm=100.0):
        export(job_of(design, small), tmp_path / "sheet.stl")
    assert list(tmp_path.iterdir()) == []


def test_that_copies_are_bodies_of_their_own(design: Deployment, tmp_path: Path) -> None:
    plan = plan_cuts(design, 60.0, 1.0, 0.3, options=CutOptions(ConnectorStyle.STRAIGHT, copies=3))
    bodies = read_3mf(export(ExportJob(design, plan=plan, printing=SHEET), tmp_path / "sheet.3mf"))
    assert list(bodies) == ["sheet", "sheet 2", "sheet 3"]


def test_that_a_sheet_in_pieces_and_a_gap_without_tiles_are_refused(design: Deployment, tmp_path: Path) -> None:
    loose = plan_cuts(design, 60.0, 0.5, 0.1, options=CutOptions(ConnectorStyle.STRAIGHT, removed=tuple(range(8))))
    with refused(FabricationError, "printed.falls_apart"):
        export(ExportJob(design, plan=loose, printing=SHEET), tmp_path / "sheet.stl")
    with refused(FabricationError, "printed.no_tiles", gap_mm=30.0):
        export(job_of(design, Printing(PrintForm.TILES, 1.0, TileSizes(30.0))), tmp_path / "tiles.stl")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("length", [0.0, -1.0, math.nan])
def test_that_lengths_that_make_no_sense_are_refused(length: float) -> None:
    with refused(FabricationError, "printed.thickness_not_positive"):
        Printing(thickness_mm=length)
    if length != 0.0:
        with refused(FabricationError, "backed.gap_negative"):
            TileSizes(gap_mm=length)


CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
CUBE_FACES = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
     [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
)  # fmt: skip


def test_that_a_body_that_reads_back_otherwise_is_refused() -> None:
    solid = Solid("A1", 1, CUBE, CUBE_FACES, 1.0)
    for encode, decode in KINDS.values():
        whole = decode(encode((solid,), ""))
        check_bodies(whole, (solid,))
        for planned, code in (
            ((solid, Solid("A2", 1, CUBE + 3.0, CUBE_FACES, 1.0)), None),
            ((Solid("A1", 1, CUBE, CUBE_FACES, 1.01),), "mesh.other_volume"),
            ((solid.moved(np.array([0.1, 0.0, 0.0])),), "mesh.other_place"),
        ):
            with pytest.raises(ExportError) as caught:
                check_bodies(whole, planned)
            assert code is None or caught.value.code == code
        opened = decode(encode((Solid("A1", 1, CUBE, CUBE_FACES[1:], 1.0),), ""))
        with refused(ExportError, "mesh.not_closed", name="A1"):
            check_bodies(opened, (solid,))


def test_that_what_does_not_close_leaves_the_old_file(
    design: Deployment, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    goal = tmp_path / "sheet.stl"
    goal.write_bytes(b"old")
    opened = Solid("sheet", 1, CUBE, CUBE_FACES[1:], 1.0)
    monkeypatch.setattr("kirigami_studio.export.meshes.print_plates", lambda *_: ((opened,),))
    with refused(ExportError, "mesh.not_closed"):
        write_meshes(job_of(design, SHEET), goal)
    assert goal.read_bytes() == b"old" and list(tmp_path.iterdir()) == [goal]


def random_job(seed: int, make_design: MakeDesign) -> ExportJob:
    """A sheet or tiles of 2 x 2 to 4 x 4 voids in some material, style and size, cut by a beam or a blade."""
    random = np.random.default_rng(seed)
    design = make_design(*random.integers(2, 5, 2).tolist(), seed=seed, spread=float(random.uniform(0.1, 0.5)))
    materials = [one for one in presets().values() if one.relief_radius_mm > 0.0]
    material, styles = materials[seed % len(materials)], list(ConnectorStyle)
    options, width = CutOptions(styles[seed % len(styles)]), float(random.uniform(120.0, 600.0))
    plan = plan_cuts(design, width, None, (None, 0.4, 0.0)[seed % 3], material, options)
    return ExportJob(design, plan=plan, printing=(SHEET, TILES)[seed // 6 % 2])


@pytest.mark.parametrize("seeds", [range(4), range(4, 40)], ids=["4", "36 more"])
def test_that_forty_designs_are_closed_for_other_readers_and_as_large_as_planned(
    seeds: range, make_design: MakeDesign, tmp_path: Path
) -> None:
    for seed in seeds:
        job = random_job(seed, make_design)
        body = read_stl(export(job, tmp_path / "solid.stl"))
        bodies = read_3mf(export(job, tmp_path / "solid.3mf"))
        assert body.closed and all(one.closed for one in bodies.values()), seed
        area = (
            finished_area(job)
            if job.printing.form is PrintForm.SHEET
            else sum(top_of(one).area for one in bodies.values())
        )
        assert body.volume == pytest.approx(area * THICKNESS, rel=1e-3), seed
        assert sum(one.volume for one in bodies.values()) == pytest.approx(body.volume, rel=1e-4), seed
