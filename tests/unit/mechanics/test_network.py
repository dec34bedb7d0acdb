"""What makes no network is refused with one sentence that names it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kirigami_studio.foundation.errors import MechanicsError
from kirigami_studio.foundation.resources import resource
from kirigami_studio.mechanics.drive import Drive, clamped_ends, mean_turn, moved_panels
from kirigami_studio.mechanics.equilibrium import follow
from kirigami_studio.mechanics.network import PanelNetwork
from kirigami_studio.mechanics.network_files import SpringConstants, morpher_drive, read_network, slender_network

SQUARE = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
CONSTANTS = SpringConstants(882.0, 220.5, 3.78e-4)


def row_of_squares(count: int = 3, gap: float = 0.5) -> PanelNetwork:
    """Squares on their tips, side by side, corner to corner."""
    centroids = np.column_stack([(2.0 + gap) * np.arange(count), np.zeros(count)])
    corners = centroids[:, None] + SQUARE
    bonds = np.array([[k, 0, k + 1, 2] for k in range(count - 1)])
    return slender_network(corners, bonds, centroids, np.full((count - 1, 2), 1.5))


@pytest.mark.parametrize(
    ("changes", "code"),
    [
        ({"centroids": np.zeros((3, 3))}, "network.wrong_shape"),
        ({"centroids": np.array([[0.0, 0.0], [np.nan, 0.0], [1.0, 0.0]])}, "network.not_finite"),
        ({"centroids": np.zeros((1, 2))}, "network.too_small"),
        ({"panels": np.array([[0, 1], [1, 7]])}, "network.number_out_of_range"),
        ({"panels": np.array([[0, 1], [-1, 2]])}, "network.number_out_of_range"),
        ({"panels": np.array([[0, 1], [2, 2]])}, "network.joins_itself"),
        ({"panels": np.array([[0, 1], [1, 0]])}, "network.not_connected"),
        ({"turning": np.array([1.0, 0.0])}, "network.stiffness_not_positive"),
        ({"stretching": np.array([1.0, -3.0])}, "network.stiffness_not_positive"),
        ({"shearing": np.array([1.0, np.inf])}, "network.not_finite"),
        ({"points": np.zeros((2, 2, 2))}, "network.slender_without_length"),
        ({"rest": np.array([1.0, 1.0, 0.0, 1.0])}, "network.panels_touch"),
        ({"rest": np.array([1.0, 1.0, 40.0, 1.0])}, "network.panels_touch"),
        ({"centroids": np.array([[0.0, 0.0], [1e9, 0.0], [1.0, 0.0]])}, "network.size_out_of_range"),
        ({"centroids": np.full((3, 2), 5.0)}, "network.size_out_of_range"),
        ({"ligament": np.array([0, 0, 1, 2])}, "network.number_out_of_range"),
        ({"outlines": np.zeros((2, 4, 2))}, "network.wrong_shape"),
    ],
)
def test_that_an_impossible_network_is_refused(changes: dict[str, np.ndarray], code: str) -> None:
    network = row_of_squares()
    joints = {name: value for name, value in changes.items() if hasattr(network.ligaments, name)}
    contacts = {name: value for name, value in changes.items() if name in ("ligament", "rest")}
    others = {name: value for name, value in changes.items() if name not in {**joints, **contacts}}
    with pytest.raises(MechanicsError) as caught:
        replace(
            network,
            ligaments=replace(network.ligaments, **joints),
            contacts=replace(network.contacts, **contacts),
            **others,
        )
    assert caught.value.code == code
    assert str(caught.value) != code


def saved(path: Path, **changes: object) -> Path:
    """The bundled archive with other arrays; None leaves one out."""
    with np.load(resource("mechanics", "panel_network.npz")) as archive:
        arrays = {name: archive[name] for name in archive.files}
    arrays |= changes  # type: ignore[arg-type]
    np.savez(path, **{name: value for name, value in arrays.items() if value is not None})
    return path


def test_that_the_bundled_network_is_read(tmp_path: Path) -> None:
    file = read_network(resource("mechanics", "panel_network.npz"), CONSTANTS)
    network = file.network
    assert (network.panel_count, len(network.ligaments), len(network.contacts)) == (64, 112, 224)
    assert network.ligaments.stretching[0] == pytest.approx(0.882)
    assert network.ligaments.turning[5] == pytest.approx(0.378)
    assert network.contacts.stiffness == pytest.approx(np.full(224, 37.8))
    with np.load(resource("mechanics", "panel_network.npz")) as archive:
        spans = network.ligaments.points[:, 1] - network.ligaments.points[:, 0]
        assert spans == pytest.approx(1e3 * archive["rest_vectors_m"], abs=1e-9)
    bare = read_network(saved(tmp_path / "bare.npz", void_rest_angles=None, quads_without_gap_m=None), CONSTANTS)
    assert len(bare.network.contacts) == 0
    assert bare.without_gap == pytest.approx(network.outlines)


@pytest.mark.parametrize(
    ("changes", "code"),
    [
        ({"quads_m": None}, "network_file.array_missing"),
        ({"bonds": None}, "network_file.array_missing"),
        ({"quads_m": np.zeros((64, 5, 2))}, "network.wrong_shape"),
        ({"quads_m": np.full((64, 4, 2), np.nan)}, "network.not_finite"),
        ({"quads_m": np.full((64, 4, 2), "a")}, "network.not_numbers"),
        ({"quads_m": np.float64(1.0)}, "network.wrong_shape"),
        ({"bonds": np.zeros((112, 4))}, "network_file.bonds_not_corners"),
        ({"bonds": np.full((112, 4), 9)}, "network_file.bonds_not_corners"),
        ({"bonds": np.array([[0, 0, 1, 2]])}, "network.wrong_shape"),
        ({"bonds": np.array([[0, 0, 70, 2]]), "void_rest_angles": None}, "network.number_out_of_range"),
        ({"bonds": np.array([[0, 0, 1, 2]]), "void_rest_angles": None}, "network.not_connected"),
        ({"void_rest_angles": np.zeros((112, 2))}, "network.panels_touch"),
        ({"centroids_m": np.zeros((64, 3))}, "network.wrong_shape"),
        ({"quads_without_gap_m": np.zeros((3, 4, 2))}, "network.wrong_shape"),
    ],
)
def test_that_a_damaged_archive_is_refused(tmp_path: Path, changes: dict[str, object], code: str) -> None:
    path = saved(tmp_path / "changed.npz", **changes)
    with pytest.raises(MechanicsError) as caught:
        read_network(path, CONSTANTS)
    assert caught.value.code == code
    assert str(caught.value) != code


def test_that_what_is_no_archive_is_refused(tmp_path: Path) -> None:
    (tmp_path / "text.npz").write_text("no archive")
    for path, code in (
        (tmp_path / "text.npz", "network_file.not_readable"),
        (tmp_path / "none.npz", "network_file.not_found"),
        (tmp_path, "network_file.not_found"),
    ):
        with pytest.raises(MechanicsError) as caught:
            read_network(path, CONSTANTS)
        assert caught.value.code == code
    with pytest.raises(MechanicsError) as caught:
        read_network(resource("mechanics", "panel_network.npz"), SpringConstants(-1.0, 1.0, 1.0))
    assert caught.value.code == "network.stiffness_not_positive"


def test_that_an_impossible_drive_is_refused(tmp_path: Path) -> None:
    network = row_of_squares()
    still_file = saved(tmp_path / "still.npz", quads_without_gap_m=np.zeros((64, 4, 2)))
    still = np.zeros((2, 3))
    held = np.arange(3)
    cases = (
        (lambda: moved_panels(network, [0], {9: (1.0, 0.0, 0.0)}, 5), "drive.unknown_panel"),
        (lambda: moved_panels(network, [0], {}, 5), "drive.nothing_moves"),
        (lambda: moved_panels(network, [0], {1: (0.0, 0.0, 0.0)}, 5), "drive.nothing_moves"),
        (lambda: moved_panels(network, [0], {1: (np.nan, 0.0, 0.0)}, 5), "drive.not_finite"),
        (lambda: moved_panels(network, [0, 1], {1: (1.0, 0.0, 0.0)}, 5), "drive.prescribed_twice"),
        (lambda: clamped_ends(network, 1, 1, 1.0, 5), "drive.ends_meet"),
        (lambda: Drive(held[:2], still[:, :2], np.arange(2.0), still[:, :2]), "drive.network_adrift"),
        (lambda: Drive(held, still, np.arange(3.0), still), "drive.wrong_shape"),
        (lambda: follow(network, Drive(held + 40, still, np.arange(2.0), still)), "drive.unknown_panel"),
        (lambda: morpher_drive(type("File", (), {"network": network, "without_gap": still})()), "drive.unknown_panel"),
        (lambda: morpher_drive(read_network(still_file, CONSTANTS)), "drive.nothing_moves"),
        (
            lambda: follow(network, mean_turn(row_of_squares(4), np.ones(3), np.linspace(0.0, 0.1, 3))),
            "network.wrong_shape",
        ),
    )
    for attempt, code in cases:
        with pytest.raises(MechanicsError) as caught:
            attempt()
        assert caught.value.code == code
        assert str(caught.value) != code
