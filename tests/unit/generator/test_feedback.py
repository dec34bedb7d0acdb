"""What the network is told about a field: its outline, the displacements to the target, the Gauss-Newton direction."""

from __future__ import annotations

import pytest
import torch

from kirigami_studio.generator.conditioning import contour_points, normalised
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.generator.feedback import CHUNK, DIRECTION_SCALE, GAP_SCALE, PLACE_SCALE, Feedback
from kirigami_studio.generator.feedback import _normalised_slopes as normalised_slopes
from kirigami_studio.lab.training.corpus import deployed_outline
from kirigami_studio.lattice.batched import BatchedLattice, BatchedSlopes
from kirigami_studio.lattice.symmetry import Symmetry

pytestmark = pytest.mark.torch
CPU = torch.device("cpu")
OWN = 6, 6
SHEET = DeployedGrid(*OWN)
#: Outline features of the own grid: coordinates of its 28 vertices.
PLACES = 2 * 28


def own_loop(z: torch.Tensor, points: int, grid: DeployedGrid = SHEET) -> torch.Tensor:
    lattice = BatchedLattice(grid.rows, grid.columns)
    return contour_points(normalised(deployed_outline(lattice, grid, z.view(-1, grid.rows, grid.columns))), points)


def smooth_noise(count: int, cells: int, scale: float = 0.3) -> torch.Tensor:
    return scale * torch.randn((count, cells), generator=torch.Generator().manual_seed(0))


def gaps_of(features: torch.Tensor, points: int) -> torch.Tensor:
    """Displacements out of 56 vertices and middles, then back from every other target point."""
    wide = 4 * 28 + points
    return features[:, PLACES : PLACES + wide].view(len(features), -1, 2) * GAP_SCALE


@pytest.mark.parametrize("direction", [False, True])
def test_that_a_field_is_no_distance_away_from_its_own_outline(direction: bool) -> None:
    z = smooth_noise(3, 36)
    sight = Feedback(OWN, SHEET, CPU)(z, own_loop(z, 960), direction)
    assert float(gaps_of(sight.features, 960).abs().max()) < 2e-3
    assert sight.direction.shape == (3, 36 if direction else 0)
    if direction:
        assert float(sight.direction.abs().max()) < 0.02


def test_that_feedback_points_from_the_outline_to_the_target() -> None:
    z = torch.zeros(1, 36)
    moved = own_loop(z, 960) + torch.tensor([0.02, 0.0])
    gaps = gaps_of(Feedback(OWN, SHEET, CPU)(z, moved, True).features, 960)[0]
    out, back = gaps[:56], gaps[56:]
    upright_sides = out[:, 1].abs() < 1e-4
    assert float(out[upright_sides, 0].max()) == pytest.approx(0.02, abs=1e-3)
    assert float(out[:, 0].min()) > -1e-3
    # Target points are asked the other way round: from them, the outline lies to the left.
    assert float(back[:, 0].min()) == pytest.approx(-0.02, abs=1e-3)
    assert float(back[:, 0].max()) < 1e-3


def test_that_the_first_features_are_the_outline() -> None:
    z = smooth_noise(2, 36)
    features = Feedback(OWN, SHEET, CPU)(z, own_loop(z, 64), False).features
    outline = normalised(deployed_outline(BatchedLattice(*OWN), SHEET, z.view(-1, 6, 6)))
    torch.testing.assert_close(features[:, :PLACES].view(2, 28, 2) * PLACE_SCALE, outline, atol=1e-5, rtol=0)


@pytest.mark.parametrize("direction", [False, True])
@pytest.mark.parametrize(
    "grid", [SHEET, DeployedGrid(6, 6, 0.7), DeployedGrid(4, 7), DeployedGrid(4, 7, 0.7), DeployedGrid(9, 8)], ids=str
)
def test_that_the_promised_feature_count_is_delivered_on_every_sheet(grid: DeployedGrid, direction: bool) -> None:
    cells = grid.rows * grid.columns
    z = smooth_noise(2, cells)
    sight = Feedback(OWN, grid, CPU)(z, own_loop(-z, 64, grid), direction)
    assert sight.features.shape == (2, Feedback.width(*OWN, 64, direction))
    assert sight.direction.shape == (2, cells if direction else 0)
    assert torch.isfinite(sight.features).all()
    # Near unit variance, whatever the sheet.
    assert 0.5 < float(sight.features[:, :PLACES].std()) < 1.5


@pytest.mark.parametrize("grid", [DeployedGrid(4, 7), DeployedGrid(9, 8, 0.7)], ids=str)
def test_that_gaps_vanish_on_another_sheets_own_outline_too(grid: DeployedGrid) -> None:
    z = smooth_noise(2, grid.rows * grid.columns)
    sight = Feedback(OWN, grid, CPU)(z, own_loop(z, 960, grid), True)
    gaps = gaps_of(sight.features, 960)
    # Stations lie on the outline; the middles between them may cut its corners.
    assert float(gaps[:, 0:56:2].abs().max()) < 4e-3
    assert float(gaps[:, 56:].abs().max()) < 4e-3
    assert float(sight.direction.abs().max()) < 0.02


def test_that_the_direction_reaches_the_features_on_the_networks_grid() -> None:
    z = smooth_noise(2, 36)
    own = Feedback(OWN, SHEET, CPU)(z, own_loop(-z, 64), True)
    assert torch.equal(own.features[:, -36:] * DIRECTION_SCALE, own.direction)
    grid = DeployedGrid(9, 8)
    feedback = Feedback(OWN, grid, CPU)
    other = feedback(smooth_noise(2, 72), own_loop(-smooth_noise(2, 72), 64, grid), True)
    torch.testing.assert_close(other.features[:, -36:] * DIRECTION_SCALE, feedback.transfer.down(other.direction))


def test_that_many_fields_are_described_like_few() -> None:
    z = smooth_noise(CHUNK + 5, 36)
    loop, feedback = own_loop(-z, 64), Feedback(OWN, SHEET, CPU)
    together = feedback(z, loop, True)
    alone = [feedback(z[row : row + 1], loop[row : row + 1], True) for row in (0, CHUNK - 1, CHUNK, CHUNK + 4)]
    rows = [0, CHUNK - 1, CHUNK, CHUNK + 4]
    places = slice(0, PLACES)
    for row, one in zip(rows, alone, strict=True):
        torch.testing.assert_close(together.features[row, places], one.features[0, places], atol=1e-4, rtol=0)
        torch.testing.assert_close(together.direction[row], one.direction[0], atol=1e-2, rtol=0)


def test_that_noise_out_of_bounds_is_described_in_numbers() -> None:
    z = 4.0 * smooth_noise(4, 36, 1.0)
    sight = Feedback(OWN, SHEET, CPU)(z, own_loop(torch.zeros(4, 36), 64), True)
    assert torch.isfinite(sight.features).all() and torch.isfinite(sight.direction).all()


def test_that_slopes_of_unit_area_outlines_are_those_of_finite_differences() -> None:
    phi = 0.8
    slopes_of = BatchedSlopes(BatchedLattice(3, 4, dtype=torch.float64), zipped=False)
    z = smooth_noise(1, 12).double().view(1, 3, 4)
    outline, slopes = slopes_of(z, phi)
    ours = normalised_slopes(outline, slopes)[0]
    step = 1e-6
    moved = z + step * torch.cat([torch.eye(12), -torch.eye(12)]).double().view(24, 3, 4)
    shapes = normalised(slopes_of(moved, phi)[0])
    expected = ((shapes[:12] - shapes[12:]) / (2 * step)).permute(1, 2, 0)
    # The outline's shift is left open: compare what differs from vertex to vertex.
    gap = (ours - ours.mean(dim=0)) - (expected - expected.mean(dim=0))
    assert float(gap.abs().max()) < 1e-7
    # At this angle ratios change the area: without its part the slopes would be far off.
    unscaled = slopes[0] / _area(outline).sqrt()
    assert float(((unscaled - unscaled.mean(dim=0)) - (expected - expected.mean(dim=0))).abs().max()) > 1e-3


def _area(outline: torch.Tensor) -> torch.Tensor:
    after = outline.roll(-1, dims=1)
    return 0.5 * (outline[..., 0] * after[..., 1] - outline[..., 1] * after[..., 0]).sum()


@pytest.mark.parametrize("phi", [0.0, 0.7])
def test_that_free_mouths_bring_an_outline_nearer_than_ratios_alone(phi: float) -> None:
    even, free = (DeployedGrid(5, 6, phi, free_rim=free) for free in (False, True))
    generator = torch.Generator().manual_seed(3)
    offsets = 0.3 * torch.randn((6, free.mouths), generator=generator)
    lattice = BatchedLattice(5, 6)
    z = smooth_noise(6, 30, 0.2)
    outline = lattice.outline(torch.pow(10.0, z.view(-1, 5, 6)), phi, offsets)
    loop = contour_points(normalised(outline[:, lattice.unzipped] if even.zipped else outline), 960)

    def left(grid: DeployedGrid, design: torch.Tensor) -> float:
        """Mean gap after one step."""
        feedback = Feedback(OWN, grid, CPU)
        seen = feedback(design, loop, True)
        assert seen.features.shape[1] == Feedback.width(*OWN, 960, True)
        after = feedback(design + seen.direction, loop, True)
        return float(after.features[:, PLACES:-36].abs().mean())

    began = Feedback(OWN, even, CPU)(z, loop, True).features[:, PLACES:-36].abs().mean()
    with_mouths = left(free, torch.cat([z, torch.zeros_like(offsets)], dim=1))
    assert with_mouths < 0.4 * float(began)
    assert with_mouths < 0.85 * left(even, z)


def test_that_the_direction_of_a_symmetric_sheet_moves_its_mouths_symmetrically() -> None:
    symmetry = Symmetry.LEFT_RIGHT
    grid = DeployedGrid(4, 5, 0.0, symmetry, free_rim=True)
    z = torch.tensor(symmetry.symmetric(smooth_noise(3, 20).view(3, 4, 5).numpy())).flatten(1)
    design = torch.cat([z, torch.zeros(3, grid.mouths)], dim=1)
    target = own_loop(-z, 192, DeployedGrid(4, 5))
    seen = Feedback(OWN, grid, CPU)(design, target, True, torch.tensor([0.0, 1e-3, 1e-3])).direction
    offsets = seen[:, 20:].numpy()
    assert abs(offsets).max() > 0.05
    assert symmetry.on(4, 5).symmetric_offsets(offsets) == pytest.approx(offsets, abs=1e-4)
