"""FOLD, MuJoCo models and tables of sheets and of pieces on pins, read back and compared with the exact motion."""

from __future__ import annotations

import csv
import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from kirigami_studio.assembly.pieces import Assembly
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.fold import fold_of
from kirigami_studio.export.linkage import linkage_of
from kirigami_studio.export.mjcf import INSET_MM, convex_shapes
from kirigami_studio.export.registry import export_files
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.project.store import load
from kirigami_studio.studio.making import CutRequest, picture_job
from tests.refusals import refused

DESIGNS = Path(__file__).parents[2] / "data" / "cut_designs"
NAMES = ("heart", "star_trim", "heart_pinned")


@pytest.fixture(scope="module")
def jobs() -> dict[str, ExportJob]:
    return {name: picture_job(CutRequest.of(load(DESIGNS / f"{name}.kiri"))) for name in NAMES}


def far_apart(linkage: Assembly, phi: float) -> float:
    """Largest distance, mm, of the two places of a hinge, each carried by its own part."""
    places = [
        [linkage.placed(linkage.by_id[name], at, phi) for name, at in zip(hinge.pieces, hinge.at, strict=True)]
        for hinge in linkage.hinges
    ]
    return float(np.abs(np.diff(places, axis=1)).max())


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("degrees", [180.0, 77.0, 0.0])
def test_that_both_parts_of_every_hinge_stay_together(jobs: dict[str, ExportJob], name: str, degrees: float) -> None:
    linkage = linkage_of(jobs[name])
    assert len(linkage.hinges) > len(linkage.pieces)
    assert far_apart(linkage, math.radians(degrees)) < 1e-9


def test_that_the_parts_of_a_sheet_are_those_that_a_picture_shows(jobs: dict[str, ExportJob]) -> None:
    job = jobs["star_trim"]
    linkage, shown = linkage_of(job), PosedDesign(job.posed.deployment, Similarity(), 0.0, job.trim)
    own = [linkage.placed(piece, piece.outline, 1.0) / linkage.cell_mm for piece in linkage.pieces]
    parts = shown.parts(1.0)
    shift = parts[0][0] - own[0][0]
    assert len(own) == len(parts) == len({piece.id for piece in linkage.pieces})
    for one, other in zip(own, parts, strict=True):
        np.testing.assert_allclose(one + shift, other, atol=1e-9)


def read_fold(job: ExportJob, folder: Path) -> dict[str, Any]:
    (path,) = export_files(job, folder / "design.fold")
    found: dict[str, Any] = json.loads(path.read_text())
    return found


@pytest.mark.parametrize("name", NAMES)
def test_that_faces_of_fold_are_rigid_and_end_where_the_motion_ends(
    jobs: dict[str, ExportJob], name: str, tmp_path: Path
) -> None:
    job = jobs[name]
    data, linkage = read_fold(job, tmp_path), linkage_of(job)
    flat = np.array(data["vertices_coords"])
    edges = np.array(data["edges_vertices"])
    length = np.linalg.norm(np.diff(flat[edges], axis=1), axis=-1)
    for frame in data["file_frames"]:
        assert frame["frame_parent"] == 0 and frame["frame_inherit"]
        moved = np.array(frame["vertices_coords"])
        np.testing.assert_allclose(np.linalg.norm(np.diff(moved[edges], axis=1), axis=-1), length, rtol=1e-6, atol=1e-8)
    for face, piece in zip(data["faces_vertices"], linkage.pieces, strict=True):
        placed = shapely.Polygon(linkage.placed(piece, piece.outline, linkage.phi_target))
        assert placed.symmetric_difference(shapely.Polygon(moved[face])).area < 1e-6 * placed.area
    assert data["file_spec"] == 1.2 and data["file_frames"][-1]["kirigami:phi"] == linkage.phi_target


def test_that_edges_of_fold_are_the_rim_of_the_flat_sheet_or_cuts(jobs: dict[str, ExportJob], tmp_path: Path) -> None:
    data = read_fold(jobs["heart"], tmp_path)
    flat, edges = np.array(data["vertices_coords"]), np.array(data["edges_vertices"])
    length = np.linalg.norm(np.diff(flat[edges], axis=1), axis=-1).ravel()
    rim = np.array(data["edges_assignment"]) == "B"
    width, height = np.ptp(flat, axis=0)
    assert width == pytest.approx(jobs["heart"].width_mm)
    assert length[rim].sum() == pytest.approx(2.0 * (width + height))
    assert set(data["edges_assignment"]) == {"B", "C"}
    # Hinges are vertices of two faces; nothing else is shared.
    corners = [number for face in data["faces_vertices"] for number in face]
    assert len(corners) - len(flat) == len(data["kirigami:hinges"])


@pytest.mark.parametrize("name", NAMES)
def test_that_tables_have_a_row_for_each_part_and_hinge(jobs: dict[str, ExportJob], name: str, tmp_path: Path) -> None:
    linkage = linkage_of(jobs[name])
    tables = []
    for path in export_files(jobs[name], tmp_path / "design.csv"):
        with path.open(newline="") as stream:
            tables.append(list(csv.DictReader(stream)))
    parts, hinges = tables
    assert [part["part"] for part in parts] == [piece.id for piece in linkage.pieces]
    for part, piece in zip(parts, linkage.pieces, strict=True):
        assert float(part["area_mm2"]) == pytest.approx(shapely.Polygon(piece.outline, piece.openings).area)
        corners = np.array([corner.split() for corner in part["corners"].split(";")], dtype=float)
        np.testing.assert_allclose(corners, linkage.placed(piece, piece.outline, math.pi), rtol=1e-6, atol=1e-6)
    at = {part["part"]: part for part in parts}
    for hinge in hinges:
        # The same place by either part's own row.
        for name_ in (hinge["part"], hinge["other_part"]):
            row, node = at[name_], next(one for one in linkage.hinges if one.node == int(hinge["node"]))
            own = np.array(node.at[node.pieces.index(name_)])
            turn = np.exp(1j * math.radians(float(row["target_turn_deg"]))) * complex(*own)
            place = turn + complex(float(row["target_x_mm"]), float(row["target_y_mm"]))
            assert abs(place - complex(float(hinge["target_x_mm"]), float(hinge["target_y_mm"]))) < 1e-6


@pytest.fixture(scope="module", params=["heart", "heart_pinned"])
def model(request: pytest.FixtureRequest, jobs: dict[str, ExportJob], tmp_path_factory: pytest.TempPathFactory) -> Any:
    mujoco = pytest.importorskip("mujoco")
    job = jobs[request.param]
    (path,) = export_files(job, tmp_path_factory.mktemp("model") / "design.xml")
    return mujoco, mujoco.MjModel.from_xml_path(str(path)), linkage_of(job)


@pytest.mark.parametrize("key", ["flat", "half", "target"])
def test_that_mujoco_has_every_part_where_the_motion_has_it(model: Any, key: str) -> None:
    mujoco, read, linkage = model
    phi = {"flat": math.pi, "half": 0.5 * (math.pi + linkage.phi_target), "target": linkage.phi_target}[key]
    data = mujoco.MjData(read)
    mujoco.mj_resetDataKeyframe(read, data, read.key(key).id)
    mujoco.mj_forward(read, data)
    found = np.array([data.body(piece.id).xpos[:2] * 1e3 for piece in linkage.pieces])
    turned = np.array([np.arctan2(*data.body(piece.id).xmat.reshape(3, 3)[1::-1, 0]) for piece in linkage.pieces])
    planned = linkage.poses(phi)
    # The part in the middle stays where it is, as it stands half open.
    fixed = int(np.argmin(read.body_parentid[[read.body(piece.id).id for piece in linkage.pieces]]))
    turn = np.exp(1j * (turned[fixed] - planned[fixed, 2]))
    z = (planned[:, :2] - planned[fixed, :2]) @ (1, 1j) * turn
    np.testing.assert_allclose((found - found[fixed]) @ (1, 1j), z, atol=1e-6 * np.ptp(found))
    np.testing.assert_allclose(np.angle(np.exp(1j * (turned - planned[:, 2])) / turn), 0.0, atol=1e-6)


def test_that_mujoco_closes_it_to_within_two_degrees_and_opens_it_again(model: Any) -> None:
    mujoco, read, linkage = model
    data = mujoco.MjData(read)
    mujoco.mj_resetDataKeyframe(read, data, read.key("half").id)
    half, goal = float(data.qpos[0]), math.pi - linkage.phi_target
    for end in (goal, half):
        begun, ctrl = data.time, float(data.ctrl[0])
        while data.time < begun + 0.8:
            data.ctrl[0] = ctrl + (end - ctrl) * min(1.0, (data.time - begun) / 0.5)
            mujoco.mj_step(read, data)
        # Panels at the rim of a sheet hang loosely near its closed state.
        middle = np.abs(np.degrees(data.qpos - end))
        assert np.median(middle) < 2.0
        if end == goal and len({piece.layer for piece in linkage.pieces}) > 1:
            assert middle.max() < 2.0


def test_that_shapes_for_contacts_fill_a_part_without_leaving_it(jobs: dict[str, ExportJob]) -> None:
    for piece in linkage_of(jobs["heart_pinned"]).pieces[:6]:
        part = shapely.Polygon(piece.outline, piece.openings)
        shapes = convex_shapes(piece)
        together = shapely.union_all(shapes)
        assert all(shape.convex_hull.area - shape.area < 1e-9 * shape.area for shape in shapes)
        assert together.difference(part.buffer(1e-6)).area == 0.0
        assert part.buffer(-2.0 * INSET_MM).difference(together).area < 1e-3 * part.area


def test_that_parts_that_do_not_hang_together_are_no_model(jobs: dict[str, ExportJob], tmp_path: Path) -> None:
    job = jobs["heart_pinned"]
    assert job.pieces is not None
    assembly = replace(job.pieces.assembly, hinges=job.pieces.assembly.hinges[:5])
    with refused(ExportError, "linkage.apart"):
        export_files(replace(job, pieces=replace(job.pieces, assembly=assembly)), tmp_path / "apart.xml")
    assert not list(tmp_path.iterdir())


def test_that_hinges_of_fold_name_the_faces_that_they_hold(jobs: dict[str, ExportJob]) -> None:
    data = fold_of(jobs["heart_pinned"])
    flat = np.array(data["vertices_coords"])
    for hinge in data["kirigami:hinges"]:
        for face in hinge["faces"]:
            assert shapely.Polygon(flat[data["faces_vertices"][face]]).contains(shapely.Point(hinge["at"]))
