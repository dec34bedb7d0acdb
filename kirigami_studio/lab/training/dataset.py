"""The paper's data protocol: draw fields, keep the feasible ones, render 128 x 128 masks, split, verify.

Every candidate is decoded, laid out at phi = 0, recentred by the midpoint of its bounding box and filled into 128 x 128
pixels (paper, Appendix "Dataset generation").  It is discarded if it has no layout, an invalid quad, an overlap ratio
above 0.02, or a mask with holes, of several pieces, or that fills less than 3 % or more than 97 % of its image.

A split is an .npz archive with ``ratios`` (N, m, n) float64, ``masks`` (N, 128, 128) bool (row 0 on top) and ``about``
(a JSON string: family, seed, counts of discarded candidates by reason, SHA-256 of the content).
"""

from __future__ import annotations

import hashlib
import io
import json
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

import numpy as np
import numpy.typing as npt
import torch
from numpy.random import Generator
from scipy.ndimage import binary_fill_holes, label

from kirigami_studio.evaluate.feasibility import TAU_OVERLAP, invalid_quads, overlap_ratio
from kirigami_studio.evaluate.silhouette import rasterise
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.errors import KirigamiError, UsageError
from kirigami_studio.foundation.files import opened_file, write_atomically
from kirigami_studio.foundation.paper import MASK_SIZE
from kirigami_studio.foundation.processes import HERE, Workers, ordered_results_of
from kirigami_studio.lab.training.corpus import Corpus, FixedDesigns, TrainingDesigns, zero_outline
from kirigami_studio.lab.training.fields import SAMPLERS, sobol_fields
from kirigami_studio.lattice.batched import BatchedLattice
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField

FAMILIES = ("sobol", "structured", "released")
#: Split sizes of the paper (Appendix "Dataset generation") and the seed offsets that keep splits independent.
SPLITS = {"train": (5000, 0), "validation": (500, 1), "test": (500, 2)}
#: A mask that fills less or more of its 128 x 128 image than this is no silhouette (digest: 3-97 %).
FILL_RANGE = (0.03, 0.97)
VERIFIED_SAMPLES = 128
VERIFIED_IOU = 0.999
BATCH = 256
#: Decimals of the ratios that the content hash sees: processors differ in the last bits of a power of ten.
HASHED_DECIMALS = 9
#: Largest archive that is read (bytes).
LARGEST_FILE = 2 * 2**30


@dataclass(frozen=True, slots=True)
class Split:
    """Feasible designs and their silhouettes at phi = 0.

    Attributes
    ----------
    ratios : (N, m, n) float64
    masks : (N, 128, 128) bool
    about : dict
        Provenance: family, seed, grid, how many candidates were discarded and why, ``sha256``.
    """

    ratios: FloatArray
    masks: BoolArray
    about: dict[str, object]

    def save(self, path: Path) -> None:
        """Write the archive atomically."""
        buffer = io.BytesIO()
        np.savez_compressed(buffer, ratios=self.ratios, masks=self.masks, about=np.array(json.dumps(self.about)))
        write_atomically(path, buffer.getvalue())

    @classmethod
    def load(cls, path: Path) -> Split:
        """Read an archive.

        Raises
        ------
        KirigamiError
            It is missing, damaged, or its content is not what its hash names.
        """
        try:
            with opened_file(path, LARGEST_FILE) as file, np.load(file, allow_pickle=False) as archive:
                split = cls(archive["ratios"], archive["masks"], json.loads(str(archive["about"])))
            altered = split.about.get("sha256") != content_hash(split.ratios, split.masks)
        except Exception as error:  # zipfile and NumPy raise a dozen kinds on damaged archives
            raise KirigamiError("training.split_unreadable", path=path) from error
        if altered:
            raise KirigamiError("training.split_altered", path=path)
        return split


def digest_of_designs(designs: Split | None) -> str:
    """SHA-256 of a data set's content, by which settings of training name it; empty for none."""
    return "" if designs is None else str(designs.about["sha256"])


def designs_of(
    family: str, fixed: Split | None, rows: int, columns: int, seed: int, chunk: int, device: torch.device
) -> TrainingDesigns:
    """Training designs: a data set over and over, or endless ones of a family.

    Parameters
    ----------
    family : str
        Of :data:`kirigami_studio.lab.training.fields.SAMPLERS`; not asked where there is a data set.
    fixed : Split, optional
    rows, columns : int
    seed : int
    chunk : int
        Endless designs that are made together.
    device : torch.device

    Raises
    ------
    UsageError
        No such family, or a data set of another grid.
    """
    if family not in SAMPLERS:
        raise UsageError("training.unknown_family", family=family, choices=", ".join(SAMPLERS))
    if fixed is not None:
        return FixedDesigns(fixed.ratios, rows, columns, seed, device)
    return Corpus(SAMPLERS[family], rows, columns, seed, chunk, device)


def content_hash(ratios: FloatArray, masks: BoolArray) -> str:
    """SHA-256 of designs and masks, in their order; the same on every machine.

    Parameters
    ----------
    ratios : (N, m, n) float
        They count to nine decimals.
    masks : (N, H, W) bool
    """
    digest = hashlib.sha256(json.dumps([ratios.shape, masks.shape]).encode())
    digest.update(np.rint(ratios * 10.0**HASHED_DECIMALS).astype("<i8").tobytes())
    digest.update(np.packbits(masks).tobytes())
    return digest.hexdigest()


def generate_split(
    family: str,
    count: int,
    seed: int,
    grid: tuple[int, int] = (10, 10),
    report: Callable[[int], None] = lambda _: None,
    workers: Workers = HERE,
) -> Split:
    """Draw fields until ``count`` of them are feasible.

    Parameters
    ----------
    family : str
        One of ``FAMILIES``, see :mod:`kirigami_studio.lab.training.fields`.
    count : int
    seed : int
        Splits with different seeds are independent; the same seed gives the same content.
    grid : (rows, columns)
    report : callable
        Told the number of designs kept so far.
    workers : Workers
        Who looks at candidates; the content does not depend on it.

    Raises
    ------
    UsageError
        Unknown family or a count below 1.
    """
    if count < 1:
        raise UsageError("training.no_samples_wanted", count_wanted=count)
    discarded: Counter[str] = Counter()
    ratios: list[FloatArray] = []
    masks: list[BoolArray] = []
    work = partial(looked_at, most=count)
    for _, batch in ordered_results_of(work, _batches(family, grid, seed), workers):
        kept_here = 0
        for fault in batch.faults:
            if fault is not None:
                discarded[fault] += 1
                continue
            ratios.append(batch.ratios[kept_here])
            masks.append(np.unpackbits(batch.packed[kept_here], axis=-1).astype(np.bool_))
            kept_here += 1
            if len(ratios) == count:
                kept, shown = np.stack(ratios), np.stack(masks)
                about = {"family": family, "seed": seed, "grid": list(grid), "phi": 0.0, "discarded": dict(discarded)}
                return Split(kept, shown, {**about, "sha256": content_hash(kept, shown)})
        report(len(ratios))
    raise KirigamiError("training.fields_ended")


@dataclass(frozen=True, slots=True, eq=False)
class LookedAt:
    """Candidates of a batch, in order, and those of them that are designs.

    Attributes
    ----------
    faults : tuple of str or None
        Why a candidate is discarded; None for a design.
    ratios : (N, m, n) float64
        Of the designs.
    packed : (N, 128, 16) uint8
        Their masks, eight pixels a byte.
    """

    faults: tuple[str | None, ...]
    ratios: FloatArray
    packed: npt.NDArray[np.uint8]


def looked_at(fields: FloatArray, most: int) -> LookedAt:
    """Decode, render and check candidates z (B, m, n), until ``most`` of them are designs."""
    lattice = _lattice(fields.shape[1], fields.shape[2])
    outlines = zero_outline(lattice, torch.tensor(fields)).numpy()
    faults: list[str | None] = []
    ratios: list[FloatArray] = []
    masks: list[BoolArray] = []
    for z, outline in zip(fields, outlines, strict=True):
        try:
            deployment = deploy(RatioField.from_log10(z))
            mask = rasterise(outline, MASK_SIZE)
        except KirigamiError:
            faults.append("no layout")
            continue
        faults.append(fault_of(deployment, mask))
        if faults[-1] is None:
            ratios.append(deployment.field.ratio)
            masks.append(mask)
            if len(ratios) == most:
                break
    shown = np.array(masks, dtype=np.bool_).reshape(-1, MASK_SIZE, MASK_SIZE)
    return LookedAt(tuple(faults), np.array(ratios).reshape(-1, *fields.shape[1:]), np.packbits(shown, axis=-1))


@cache
def _lattice(rows: int, columns: int) -> BatchedLattice:
    return BatchedLattice(rows, columns, dtype=torch.float64)


def verify(split: Split, seed: int = 0) -> float:
    """Re-render random samples through the single-design decoder; returns the smallest IoU with the stored masks.

    Raises
    ------
    KirigamiError
        A mask differs from its design by more than the protocol allows (IoU below 0.999).
    """
    chosen = np.random.default_rng(seed).choice(
        len(split.ratios), min(VERIFIED_SAMPLES, len(split.ratios)), replace=False
    )
    worst = 1.0
    for index in chosen:
        again = rasterise(deploy(RatioField(split.ratios[index])).outline(0.0), MASK_SIZE)
        stored = split.masks[index]
        worst = min(worst, float((again & stored).sum() / (again | stored).sum()))
    if worst < VERIFIED_IOU:
        raise KirigamiError("training.mask_differs", iou=worst)
    return worst


def _batches(family: str, grid: tuple[int, int], seed: int) -> Iterator[FloatArray]:
    """Endless candidate fields of one family."""
    if family == "sobol":
        taken = 0
        while True:
            yield sobol_fields(BATCH, *grid, seed=seed, skip=taken)
            taken += BATCH
    if family in FAMILIES:
        rng: Generator = np.random.default_rng(seed)
        while True:
            yield SAMPLERS[family](BATCH, *grid, rng)
    raise UsageError("training.unknown_family", family=family, choices=", ".join(FAMILIES))


def fault_of(deployment: Deployment, mask: BoolArray) -> str | None:
    """Why the protocol discards a design with this mask (H, W), or None: see the module's text."""
    if invalid_quads(deployment, 0.0):
        return "invalid quad"
    if overlap_ratio(deployment, 0.0) > TAU_OVERLAP:
        return "overlap"
    if not FILL_RANGE[0] <= mask.mean() <= FILL_RANGE[1]:
        return "fill"
    if label(mask)[1] != 1 or binary_fill_holes(mask).sum() != mask.sum():
        return "topology"
    return None
