"""A few random pinned designs, written and read back without the program; ``make pinned`` tries more."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from piece_reader import put_together
from random_assemblies import BOUNDS, faults, random_job

from kirigami_studio.export.assembly_files import write_assembly


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_that_files_of_random_designs_are_put_together_by_another_reader(seed: int, tmp_path: Path) -> None:
    assert faults(seed, tmp_path / "out", most=3) == []


def test_that_the_other_reader_finds_faults(tmp_path: Path) -> None:
    """A hole that is moved by 5 µm in a written file."""
    assert faults(0, tmp_path / "out", most=2) == []
    path = tmp_path / "out" / "layer-1.svg"
    text = path.read_text()
    at = text.index(" A ")
    start = text.rindex("M ", 0, at) + 2
    x = text[start : text.index(",", start)]
    path.write_text(text[:start] + f"{float(x) + 0.01:.4f}" + text[start + len(x) :])
    assert put_together(tmp_path / "out", ".svg", random_job(0, 2).allowed_mm).holes_mm > 1e-3


def test_that_the_other_reader_finds_pieces_that_collide(tmp_path: Path) -> None:
    """A piece that goes astray at one angle, over others of its layer."""
    job = random_job(0, 3)
    assert faults(0, tmp_path / "out", most=3) == []
    motion = tmp_path / "out" / "pieces.json"
    record = json.loads(motion.read_text())
    astray, *others = (piece.id for piece in job.assembly.pieces if piece.layer == 1)
    poses = record["motion"][90]["poses"]
    poses[astray] = poses[others[-1]]
    motion.write_text(json.dumps(record))
    read = put_together(tmp_path / "out", ".dxf", job.allowed_mm)
    assert read.overlap_mm2 > 10.0 and read.pins_mm > 1.0


def test_that_the_other_reader_knows_openings_in_pieces(tmp_path: Path) -> None:
    """Random pinned designs 19 and 59 have such pieces."""
    job = random_job(0, 2)
    first, *others = job.assembly.pieces
    window = np.array([[-1.5, -1.5], [-1.5, 1.5], [1.5, 1.5], [1.5, -1.5]])
    assembly = replace(job.assembly, pieces=(replace(first, openings=(window,)), *others))
    write_assembly(replace(job, assembly=assembly), tmp_path / "out")
    read = put_together(tmp_path / "out", ".svg", job.allowed_mm)
    assert read.pieces == len(assembly.pieces) and read.outline_mm <= BOUNDS.outline_mm
