"""DXF files byte for byte: ``pytest tests/golden --update-goldens`` writes them anew after a change that is meant."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from kirigami_studio.export.dxf import dxf_bytes
from kirigami_studio.export.profile import find_profile
from kirigami_studio.fabricate.cut_plan import CutPlan, plan_cuts
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField

HERE = Path(__file__).parent
CASES = [
    ("film_any_r2010.dxf", "film-uv", "R2010", "any"),
    ("card_lightburn_r2010.dxf", "card-co2", "R2010", "lightburn"),
    ("pet_any_r12.dxf", "pet-co2", "R12", "any"),
    ("card_k40_r12.dxf", "card-co2", "R12", "k40"),
    ("pet_single_r12.dxf", "pet-co2", "R12", "single"),
    ("film_layers_r12.dxf", "film-uv", "R12", "layers"),
    ("card_slots_r2010.dxf", "card-co2", "R2010", "slots"),
]


def golden_plan(material: str) -> CutPlan:
    """A 3 x 4 design with a smooth field that needs no random numbers.

    Its ratios are rounded: processors disagree in the last bit of a power, and the file tells a digest of all bits.
    """
    row, column = np.mgrid[:3, :4]
    ratio = np.round(10.0 ** (0.4 * np.sin(1.3 * row + 0.7) * np.cos(0.9 * column)), 4)
    return plan_cuts(deploy(RatioField(ratio)), 80.0, material=find_material(material))


def first_difference(got: bytes, want: bytes) -> str | None:
    """Name the first line that differs, None when the files are equal."""
    if got == want:
        return None
    got_lines, want_lines = got.decode().splitlines(), want.decode().splitlines()
    for number, (one, two) in enumerate(zip(got_lines, want_lines, strict=False), start=1):
        if one != two:
            return f"line {number}: got {one!r}, want {two!r}"
    return f"got {len(got_lines)} lines, want {len(want_lines)}"


@pytest.mark.parametrize(("name", "material", "version", "profile"), CASES)
def test_that_the_dxf_equals_its_golden_file(
    name: str, material: str, version: str, profile: str, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    got = dxf_bytes(golden_plan(material), version, find_profile(profile))
    golden = HERE / name
    if request.config.getoption("--update-goldens"):
        golden.write_bytes(got)
    difference = first_difference(got, golden.read_bytes())
    if difference is not None:
        (tmp_path / name).write_bytes(got)
    assert difference is None, f"{difference}; the new file is {tmp_path / name}"


@pytest.mark.parametrize("name", [case[0] for case in CASES])
def test_that_the_comparison_notices_a_last_digit_a_missing_line_and_a_moved_layer(name: str) -> None:
    want = (HERE / name).read_bytes()
    last = want.rindex(b"80.")
    layer = next(name for name in (b"EDGE_SLITS", b"SLOTS", b"SHEET") if name in want)
    assert first_difference(want, want) is None
    for mutated in (
        want[:last] + b"81." + want[last + 3 :],
        want.rstrip().rsplit(b"\n", 1)[0],
        want.replace(layer, b"SLITS", 1),
    ):
        assert first_difference(mutated, want) is not None
