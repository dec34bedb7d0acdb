"""Table 3 of the paper and its budget curves: what GRPO made of a prior, after 0 to 10000 environment calls.

It judges weights that ``train grpo --keep-at`` wrote, by one sample a target and seed as Table 2 does, in eight steps.
Beside the paper's figures stands what its rule is silent about: the paired difference to the start and to a run without
any reward, and whether the designs can be made (:mod:`kirigami_studio.lab.fabricability`).

A *good first design* can be cut, comes within 10 degrees of being closed, has a CV of panel areas of at most 0.6, and
lacks no more than 0.005 of the exact IoU that the start's sample from the same noise has.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kirigami_studio import __version__
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.processes import HERE, Workers
from kirigami_studio.generator.velocity import backbone_of
from kirigami_studio.generator.weights import digest_of
from kirigami_studio.lab.benchmark import paper_tables
from kirigami_studio.lab.benchmark.generator_suite import bootstrap_interval
from kirigami_studio.lab.benchmark.generator_table import (
    SampleRun,
    generator_named,
    mean_distance,
    score_record,
)
from kirigami_studio.lab.benchmark.match_table import MatchRow, floor_figures, match_figures
from kirigami_studio.lab.benchmark.run_store import Record, RunStore, group_means, mean_of, values_of
from kirigami_studio.lab.fabricability import TRIAL, Fabricability, fabricability
from kirigami_studio.lab.trained_weights import load_weights, variants_about
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.outlines.outline import Outline

#: Exact IoU that a good first design may lack beside the start's sample.
MAY_LACK = 0.005
#: The reward of a run that shows what happens without one.
CONTROL = "none"
#: Samples of a target by which variety is measured: as many as the sampler draws together anyway.
SAMPLES = 8
#: Bundled variants that runs of GRPO begin with.
STARTS = ("prior", "paper")


@dataclass(frozen=True, slots=True)
class Snapshot:
    """Weights of a run of GRPO after some environment calls.

    Attributes
    ----------
    name : str
        Names the calls that were asked for; the step that made them may have made a few more.
    calls : int
    source : str
        The file.
    digest : str
        SHA-256 of the weights.
    """

    name: str
    calls: int
    source: str
    digest: str


@dataclass(frozen=True, slots=True)
class AlignedRun:
    """A run of GRPO, read from its folder.

    Attributes
    ----------
    name : str
        That of the folder.
    start : str
        What it began with: ``bundled prior``, ``bundled paper``, or the network's kind and the first digits of the
        weights' SHA-256.
    reward : str
    settings : dict
        As it was trained.
    snapshots : tuple of Snapshot
        By rising number of calls; the first one is the start.
    """

    name: str
    start: str
    reward: str
    settings: dict[str, object]
    snapshots: tuple[Snapshot, ...]

    def controls(self, other: AlignedRun) -> bool:
        """Whether this run is what another one would be without its reward."""
        own, others = self.settings | {"reward": ""}, other.settings | {"reward": ""}
        return self.reward == CONTROL != other.reward and own == others

    @classmethod
    def read(cls, folder: Path) -> AlignedRun:
        """Read what ``train grpo --keep-at`` wrote.

        Raises
        ------
        UsageError
            No weights were kept there, or not those before the first call.
        ModelError
            The folder's manifest, or weights, are damaged.
        """
        kept = {name: about for name, about in variants_about(folder).items() if "calls" in about}
        snapshots = []
        for name in sorted(kept, key=lambda one: int(kept[one]["calls"])):
            source = str(folder / f"{name}.safetensors")
            snapshots.append(Snapshot(name, int(kept[name]["calls"]), source, generator_named(source).digest))
        if not snapshots or snapshots[0].calls != 0:
            raise UsageError("benchmark.no_weights_kept", path=folder)
        settings = dict(next(iter(kept.values()))["settings"])
        digest = str(settings["start"])
        backbone = backbone_of(load_weights(Path(snapshots[0].source)).network.shape)
        bundled = {digest_of(variant): f"bundled {variant}" for variant in STARTS}
        start = bundled.get(digest, f"{backbone} {digest[:8]}")
        return cls(folder.resolve().name, start, str(settings["reward"]), settings, tuple(snapshots))


@dataclass(frozen=True, slots=True)
class Difference:
    """Mean paired difference and its bootstrap 95 % interval over targets."""

    mean: float
    interval: tuple[float, float]

    @classmethod
    def of(cls, ours: FloatArray, theirs: FloatArray) -> Difference:
        """Of one number a target: (N,) each."""
        return cls(float((ours - theirs).mean()), bootstrap_interval(ours - theirs))


@dataclass(frozen=True, slots=True)
class Beside:
    """Differences to samples of other weights for the same targets from the same noise."""

    siou: Difference
    tv: Difference
    good: Difference


@dataclass(frozen=True, slots=True, kw_only=True)
class SnapshotRow(MatchRow):
    """Figures of one snapshot on one family; shares from 0 to 1.

    Attributes
    ----------
    calls : int
        Environment calls before.
    tv_log10 : float
        Mean ``|d log10 x|`` of neighbours.
    distance : float
        Root mean square difference of z of two samples for one target.
    area_cv : float
        Mean CV of panel areas.
    cuttable, closes, even, good : float
        Shares of samples that can be cut, that close, that are even, and that are good first designs.
    over_start, over_control : Beside or None
        None for the start itself, and where no run without a reward has the same settings and as many calls.
    """

    calls: int
    tv_log10: float
    distance: float
    area_cv: float
    cuttable: float
    closes: float
    even: float
    good: float
    over_start: Beside | None
    over_control: Beside | None

    def sentence(self) -> str:
        """The row for people: percentages, the paper's numbers in brackets."""
        paper = self.paper
        siou, tv = ("", "") if paper is None else (f"({100 * paper.siou:.2f})", f"({paper.tv or 0.0:.2f})")
        return (
            f"    {self.calls:6}{100 * self.siou:8.2f} +- {100 * self.siou_sd:4.2f} {siou:8}{100 * self.iou_exact:8.2f}"
            f"{100 * self.success:10.1f}{self.tv:7.2f} {tv:7}{self.tv_log10:7.3f}{self.distance:9.3f}"
            f"{self.area_cv:7.3f}{100 * self.cuttable:10.1f}{100 * self.closes:8.1f}{100 * self.good:7.1f}"
        )


@dataclass(frozen=True, slots=True)
class SnapshotTable:
    """Rows by start and run, on one family of targets."""

    targets: int
    uniform_siou: float
    uniform_siou_released: float
    uniform_iou: float
    starts: dict[str, dict[str, tuple[SnapshotRow, ...]]]

    def sentences(self) -> Iterator[str]:
        """The table for people."""
        for start, runs in self.starts.items():
            for name, rows in runs.items():
                yield f"  {start}, {name}"
                yield (
                    f"    {'calls':>6}{'sIoU %':>8}{'':17}{'exact %':>8}{'success %':>10}{'TV':>7}{'':8}{'log':>7}"
                    f"{'distance':>9}{'CV':>7}{'cuttable':>10}{'closes':>8}{'good':>7}"
                )
                yield from (row.sentence() for row in rows)


@dataclass(frozen=True, slots=True)
class GrpoFigures:
    """The tables by family, and what their runs share; ``training`` has the settings by start and run."""

    settings: dict[str, object]
    seeds: tuple[int, ...]
    training: dict[str, dict[str, dict[str, object]]]
    families: dict[str, SnapshotTable]

    def sentences(self) -> Iterator[str]:
        """The tables for people."""
        for family, table in self.families.items():
            yield f"{family}: {table.targets} targets, {len(self.seeds)} seeds"
            yield from table.sentences()


def suite_settings() -> dict[str, object]:
    """What all runs of the suite share, for its store."""
    return {
        "k": SAMPLES,
        "material": TRIAL.material,
        "width_mm": TRIAL.width_mm,
        "may_lack": MAY_LACK,
        "version": __version__,
    }


def measure_grpo(
    targets: Mapping[str, Sequence[Outline]],
    runs: Sequence[AlignedRun],
    seeds: Sequence[int],
    store: RunStore,
    workers: Workers = HERE,
    report: Callable[[int, int], None] = lambda done, total: None,
) -> GrpoFigures:
    """Judge every snapshot of every run, as far as ``store`` does not have it, and make the tables.

    Parameters
    ----------
    targets : mapping of str to sequence of Outline
        By family.
    runs : sequence of AlignedRun
        Of one training seed each.
    seeds : sequence of int
        Sampling seeds.
    store : RunStore
        With :func:`suite_settings`.
    workers : Workers
        Who does samples.
    report : callable
        Told (done, total) samples.

    Raises
    ------
    UsageError
        No targets, or two runs of one name from one start.
    """
    if not targets or not all(targets.values()):
        raise UsageError("benchmark.no_targets")
    names = [(run.start, run.name) for run in runs]
    if len(set(names)) < len(names):
        raise UsageError("benchmark.grpo_runs_alike", names=", ".join(f"{start}: {name}" for start, name in names))
    # Runs from one start share its snapshot.
    sources = {one.digest: one.source for run in reversed(runs) for one in reversed(run.snapshots)}
    samples = {
        (family, digest): [
            SampleRun(source, digest, generator_named(source).steps, family, seed, number, SAMPLES, outline)
            for number, outline in enumerate(outlines)
            for seed in seeds
        ]
        for digest, source in reversed(sources.items())
        for family, outlines in targets.items()
    }
    # Target by target, so that what is there after a while is a table of fewer targets.
    waiting = sorted((run for some in samples.values() for run in some), key=lambda run: run.number)
    store.complete(waiting, judged, workers, report)
    training: dict[str, dict[str, dict[str, object]]] = {}
    for run in runs:
        training.setdefault(run.start, {})[run.name] = run.settings
    families = {
        family: _table(
            runs,
            len(outlines),
            {digest: [store.records[one.key] for one in samples[family, digest]] for digest in sources},
            [number for number in range(len(outlines)) for _ in seeds],
            list(seeds) * len(outlines),
        )
        for family, outlines in targets.items()
    }
    return GrpoFigures(suite_settings(), tuple(seeds), training, families)


def judged(run: SampleRun) -> Record:
    """Draw the samples of one target and seed, and judge the first of them."""
    fields = generator_named(run.source).draw(run.target, run.k, run.seed, run.steps)
    (made,) = fabricability([deploy(fields[0])])
    return {
        **score_record(fields[0], run.target),
        "distance": mean_distance(np.array([field.log10.ravel() for field in fields])),
        "area_cv": made.area_cv,
        "least_mm": made.least_mm,
        "needed_mm": made.needed_mm,
        "jam_phi": made.jam_phi,
    }


def _table(
    runs: Sequence[AlignedRun],
    targets: int,
    records: Mapping[str, Sequence[Record]],
    numbers: Sequence[int],
    seeds: Sequence[int],
) -> SnapshotTable:
    """Rows of one family, from the records (target by target, seed by seed) of every snapshot by its digest."""
    first = next(iter(records.values()))
    starts: dict[str, dict[str, tuple[SnapshotRow, ...]]] = {}
    for run in runs:
        start = _Sampled.of(records[run.snapshots[0].digest], records[run.snapshots[0].digest], numbers)
        controls = {one.name: one.digest for other in runs if other.controls(run) for one in other.snapshots}
        rows = []
        for one in run.snapshots:
            own = _Sampled.of(records[one.digest], start.records, numbers)
            control = controls.get(one.name) if one.calls else None
            beside = None if control is None else _Sampled.of(records[control], start.records, numbers)
            rows.append(_row(run.reward, one.calls, own, start, beside, numbers, seeds))
        starts.setdefault(run.start, {})[run.name] = tuple(rows)
    return SnapshotTable(targets=targets, starts=starts, **floor_figures(first))


@dataclass(frozen=True, slots=True, eq=False)
class _Sampled:
    """Samples of one snapshot on one family.

    Attributes
    ----------
    records : sequence of Record
    siou, tv, good : (N,) float
        By target, means over seeds.
    share_good : float, 0..1
    """

    records: Sequence[Record]
    siou: FloatArray
    tv: FloatArray
    good: FloatArray
    share_good: float

    @classmethod
    def of(cls, records: Sequence[Record], start: Sequence[Record], numbers: Sequence[int]) -> _Sampled:
        lacks = values_of(start, "iou_exact") - values_of(records, "iou_exact")
        made = made_of(records)
        fit = [one.cuttable and one.closes and one.even for one in made]
        good = (np.array(fit) & (lacks <= MAY_LACK)).astype(np.float64)
        siou, tv = (group_means(values_of(records, name), numbers) for name in ("siou", "tv"))
        return cls(records, siou, tv, group_means(good, numbers), float(good.mean()))

    def beside(self, other: _Sampled) -> Beside:
        """Differences to other samples."""
        return Beside(
            Difference.of(self.siou, other.siou),
            Difference.of(self.tv, other.tv),
            Difference.of(self.good, other.good),
        )


def made_of(records: Sequence[Record]) -> list[Fabricability]:
    """What the records tell of the sheets' fabrication."""
    names = ("area_cv", "least_mm", "needed_mm", "jam_phi")
    return [Fabricability(*(float(str(record[name])) for name in names)) for record in records]


def _row(
    reward: str,
    calls: int,
    own: _Sampled,
    start: _Sampled,
    control: _Sampled | None,
    numbers: Sequence[int],
    seeds: Sequence[int],
) -> SnapshotRow:
    records, made = own.records, made_of(own.records)
    paper = (
        paper_tables.PRIOR
        if calls == 0
        else paper_tables.GRPO.get(reward)
        if calls == paper_tables.GRPO_CALLS
        else None
    )
    return SnapshotRow(
        **match_figures(records, numbers, seeds),
        calls=calls,
        tv_log10=mean_of(records, "tv_log10"),
        distance=mean_of(records, "distance"),
        area_cv=mean_of(records, "area_cv"),
        cuttable=float(np.mean([one.cuttable for one in made])),
        closes=float(np.mean([one.closes for one in made])),
        even=float(np.mean([one.even for one in made])),
        good=own.share_good,
        over_start=own.beside(start) if calls else None,
        over_control=None if control is None else own.beside(control),
        paper=paper,
    )
