"""How long cutting takes: a head that speeds up and slows down on every straight run (trapezoid model)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kirigami_studio.fabricate.material import Material
from kirigami_studio.lattice.ratio_field import FloatArray


def run_seconds(lengths: FloatArray, speed: float, acceleration: float) -> FloatArray:
    """Seconds for straight runs from rest to rest.

    ``L >= v^2 / a``: ``L / v + v / a``; shorter runs never reach the speed: ``2 sqrt(L / a)``.
    """
    reaches_speed = lengths >= speed**2 / acceleration
    seconds: FloatArray = np.where(
        reaches_speed, lengths / speed + speed / acceleration, 2.0 * np.sqrt(lengths / acceleration)
    )
    return seconds


def travel_lengths(paths: Sequence[FloatArray]) -> FloatArray:
    """Length of each move with the beam off, from the origin through all paths in order: (paths,) float, mm."""
    exits = np.array([np.zeros(2), *[points[-1] for points in paths[:-1]]])
    entries = np.array([points[0] for points in paths])
    lengths: FloatArray = np.linalg.norm(entries - exits, axis=1)
    return lengths


def segment_lengths(points: FloatArray) -> FloatArray:
    """Lengths of the straight pieces of a polyline (P, 2): (P - 1,) float, mm."""
    lengths: FloatArray = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return lengths


def job_seconds(paths: Sequence[FloatArray], material: Material) -> float:
    """Seconds for a whole job; closed paths come with their first point repeated."""
    cut = np.concatenate([segment_lengths(points) for points in paths])
    acceleration = material.acceleration_mm_s2
    cutting = run_seconds(cut, material.speed_mm_s, acceleration).sum()
    return float(cutting + run_seconds(travel_lengths(paths), material.travel_mm_s, acceleration).sum())
