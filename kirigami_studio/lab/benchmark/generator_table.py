"""Table 2 of the paper: one sample a target from every conditional generator, by the same geometry and evaluator.

Generators are bundled variants, flow priors trained here, and the baselines (``baselines.stored``).  Each sees the
target upright, draws one field for the table, and ``k`` fields for what is said about their variety.

The paper's Inception-style score does not name its features.  Here a field's class is how near it lies to each of
``CLASSES`` centres of training fields, in the space of their main components; the score of a target is
exp(mean KL(p(class | sample) || mean of these)) over its samples (Salimans et al. 2016), and its mean over targets is
told.  It compares the rows of one table, not ours with the paper's.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cache, partial
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import torch
from scipy.cluster.vq import kmeans2
from scipy.special import rel_entr, softmax

from kirigami_studio import __version__
from kirigami_studio.evaluate.score import evaluate_many
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ModelError, UsageError
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.foundation.processes import HERE, Workers
from kirigami_studio.generator.sampler import one_pose, one_torch_thread, posed, sample_fields
from kirigami_studio.generator.velocity import UNET, backbone_of
from kirigami_studio.generator.weights import Model, load_model, model_folder
from kirigami_studio.lab.baselines.conditional import ConditionalGenerator
from kirigami_studio.lab.baselines.stored import load_generator
from kirigami_studio.lab.benchmark import paper_tables
from kirigami_studio.lab.benchmark.match_table import FamilyTable, MethodRow, method_figures, success_share
from kirigami_studio.lab.benchmark.run_store import Key, Record, RunStore, mean_of, target_key
from kirigami_studio.lab.paper_evaluator import released_floor, released_match
from kirigami_studio.lab.trained_weights import load_weights, variants_about
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load

#: Fields of a target by (target, count, seed, steps).
Draw = Callable[[Outline, int, int, int], Sequence[RatioField]]

CLASSES = 32
COMPONENTS = 8


#: Steps of the flow in the paper, which its U-Net takes here, too, and of the other variants as the program uses them.
PAPER_FLOW_STEPS, BUNDLED_STEPS = 8, 4


@dataclass(frozen=True, slots=True)
class Trained:
    """How weights were trained, as their record has it.

    Attributes
    ----------
    family : str
        Of the designs; ``mixed`` for a mixture of families.
    steps, batch : int
        Optimiser steps done, and designs or targets in each.
    calls : int
        Environment calls done, of weights that GRPO aligned; else 0.
    latent : int
        Pixels each way into which fields are drawn; 0 where the record lacks it.
    """

    family: str
    steps: int
    batch: int
    calls: int
    latent: int

    @classmethod
    def of(cls, about: Mapping[str, Any]) -> Trained:
        """Read the record that training wrote; missing numbers are 0."""
        settings, reached = about.get("settings", {}), about.get("validation", {})
        shape = settings.get("shape", settings.get("network", {}))
        return cls(
            str(settings.get("family", "mixed")),
            int(reached.get("step", 0)),
            int(settings.get("batch", 0)),
            int(reached.get("calls", 0)),
            int(shape.get("latent", 0)),
        )


@dataclass(frozen=True, slots=True)
class Generator:
    """A row of the table.

    Attributes
    ----------
    name : str
        A bundled variant's; of a training run ``ot-cfm`` for a prior, the aligned variant's, or a baseline's kind.
    steps : int
        Network evaluations of a sample.
    digest : str
        SHA-256 of the weights.
    draw : callable
    trained : Trained
    """

    name: str
    steps: int
    digest: str
    draw: Draw
    trained: Trained


@cache
def generator_named(source: str) -> Generator:
    """Load a bundled variant, or weights of a training run (``.safetensors``).

    Raises
    ------
    UsageError
        No such variant.
    ModelError
        Weights that cannot be read.
    """
    if not source.endswith(".safetensors"):
        model = load_model(source)
        steps = PAPER_FLOW_STEPS if backbone_of(model.network.shape) == UNET else BUNDLED_STEPS
        trained = Trained.of(variants_about(model_folder())[source])
        return Generator(source, steps, model.digest, partial(_flow_fields, model), trained)
    path = Path(source)
    try:
        stored = load_generator(path)
    except ModelError:
        # Weights of a flow lie beside a manifest that names their network.
        model = load_weights(path)
        name = "ot-cfm" if model.variant == "prior" else model.variant
        trained = Trained.of(variants_about(path.parent)[model.variant])
        return Generator(name, PAPER_FLOW_STEPS, model.digest, partial(_flow_fields, model), trained)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    draw = partial(_baseline_fields, stored.network)
    return Generator(stored.kind, stored.network.usual_steps, digest, draw, Trained.of(stored.about))


def _flow_fields(model: Model, target: Outline, count: int, seed: int, steps: int) -> Sequence[RatioField]:
    shape = model.network.shape
    return sample_fields(model, target, (shape.rows, shape.columns), count, seed, steps, poses=one_pose)


def _baseline_fields(
    network: ConditionalGenerator, target: Outline, count: int, seed: int, steps: int
) -> Sequence[RatioField]:
    pixels = network.pixels
    with torch.inference_mode(), one_torch_thread():
        masks = pixels.masks(posed(target, range(1), one_pose)).expand(count, -1, -1, -1)
        z = network.draw(masks, torch.Generator().manual_seed(seed), steps).clamp(-LOG_RATIO_LIMIT, LOG_RATIO_LIMIT)
    return [RatioField.from_log10(field) for field in z.double().numpy().reshape(count, pixels.rows, pixels.columns)]


@dataclass(frozen=True, slots=True)
class TableSettings:
    """What all runs of a table share.

    Attributes
    ----------
    k : int, 2 or more
        Samples of a target by which variety is measured; with the first seed only.

    Raises
    ------
    UsageError
        Fewer than two.
    """

    k: int = 16

    def __post_init__(self) -> None:
        if self.k < 2:
            raise UsageError("benchmark.spread_of_one", k=self.k)

    def to_json(self) -> dict[str, object]:
        """Plain values, with the version and the constants that figures depend on."""
        classes = {"classes": CLASSES, "components": COMPONENTS}
        return {**asdict(self), **classes, "version": __version__}


@dataclass(frozen=True, slots=True)
class SampleRun:
    """One sample of one generator for one target; with ``k`` samples for variety where that is above 1."""

    source: str
    digest: str
    steps: int
    family: str
    seed: int
    number: int
    k: int
    target: Outline

    @property
    def key(self) -> Key:
        """What the run is found by again; other weights, and another target in the same place, are other runs."""
        own = self.digest[:16], self.source, self.steps
        return *own, self.family, self.seed, self.number, self.k, target_key(self.target)


@dataclass(frozen=True, slots=True)
class StepsRow:
    """Figures of a generator at another number of steps, with the first seed; shares from 0 to 1."""

    siou: float
    success: float


@dataclass(frozen=True, slots=True, kw_only=True)
class GeneratorRow(MethodRow):
    """A generator's figures on one family.

    Attributes
    ----------
    steps : int
        Network evaluations of a sample.
    milliseconds : float
        Mean processor time of a sample.
    distance : float
        Root mean square difference of z of two samples for one target.
    inception : float
        The Inception-style score.
    by_steps : dict of int to StepsRow
        Empty unless other numbers of steps were measured.
    """

    HEADING: ClassVar[str] = (
        f"  {'':15}{'sIoU %':>21}{'exact %':>8}{'success %':>17}{'ms a sample':>18}{'TV':>7}{'distance':>10}"
        f"{'IS (ours)':>11}"
    )
    steps: int
    milliseconds: float
    distance: float
    inception: float
    by_steps: dict[int, StepsRow]

    def sentences(self, name: str) -> Iterator[str]:
        """The row for people: percentages, the paper's number in brackets."""
        siou, success, time_of_one = ("", "", "")
        if self.paper is not None:
            siou = f"({100 * self.paper.siou:.1f})"
            success = "" if self.paper.success is None else f"({100 * self.paper.success:.1f})"
            time_of_one = "" if self.paper.milliseconds is None else f"({self.paper.milliseconds:.0f})"
        yield (
            f"  {name:15}{100 * self.siou:7.1f} +- {100 * self.siou_sd:4.1f} {siou:6}{100 * self.iou_exact:8.1f}"
            f"{100 * self.success:9.1f} {success:7}{self.milliseconds:10.1f} {time_of_one:7}"
            f"{self.tv:7.2f}{self.distance:10.3f}{self.inception:11.2f}"
        )
        for steps, row in self.by_steps.items():
            yield f"    {steps:4} steps   {100 * row.siou:7.1f}{'':21}{100 * row.success:9.1f}"


@dataclass(frozen=True, slots=True)
class GeneratorFigures:
    """Tables by family; SHA-256 of the weights, and their training, by generator."""

    settings: dict[str, object]
    seeds: tuple[int, ...]
    weights: dict[str, str]
    trained: dict[str, Trained]
    families: dict[str, FamilyTable[GeneratorRow]]

    def sentences(self) -> Iterator[str]:
        """The tables for people."""
        for family, table in self.families.items():
            yield f"{family}: {table.targets} targets, {len(self.seeds)} seeds"
            yield from table.sentences()


def measure_generators(
    targets: Mapping[str, Sequence[Outline]],
    sources: Sequence[str],
    seeds: Sequence[int],
    settings: TableSettings,
    reference: FloatArray,
    store: RunStore,
    sweep: Mapping[str, Sequence[int]] | None = None,
    workers: Workers = HERE,
    report: Callable[[int, int], None] = lambda done, total: None,
) -> GeneratorFigures:
    """Do the runs that ``store`` does not have yet, and make the table of all that were asked for.

    Parameters
    ----------
    targets : mapping of str to sequence of Outline
        By family.
    sources : sequence of str
        Bundled variants, or weight files.
    seeds : sequence of int
    settings : TableSettings
    reference : (N, m n) float
        z of training fields, which the classes are made of.
    store : RunStore
        With ``settings.to_json()``.
    sweep : mapping of str to sequence of int, optional
        Further numbers of steps of generators by their name, measured with the first seed.
    workers : Workers
        Who does runs.
    report : callable
        Told (done, total) runs.

    Raises
    ------
    UsageError
        No targets, or two generators of one name.
    """
    if not targets or not all(targets.values()):
        raise UsageError("benchmark.no_targets")
    names = [generator_named(source).name for source in sources]
    if len(set(names)) < len(names):
        raise UsageError("benchmark.generators_alike", names=", ".join(names))
    sweep = sweep or {}
    runs = list(_runs(targets, sources, seeds, settings, sweep))
    store.complete(runs, partial(sampled, classes=FieldClasses.of(reference)), workers, report)
    families = {family: _table([run for run in runs if run.family == family], sources, store) for family in targets}
    loaded = list(map(generator_named, sources))
    weights = {one.name: one.digest for one in loaded}
    trained = {one.name: one.trained for one in loaded}
    return GeneratorFigures(settings.to_json(), tuple(seeds), weights, trained, families)


def sampled(run: SampleRun, classes: FieldClasses) -> Record:
    """Carry out one run; the same run gives the same record but for the milliseconds."""
    generator = generator_named(run.source)
    _warmed_up(run.source, run.steps)
    began = time.process_time()
    fields = generator.draw(run.target, 1, run.seed, run.steps)
    milliseconds = 1e3 * (time.process_time() - began)
    record: Record = {**score_record(fields[0], run.target), "milliseconds": milliseconds}
    if run.k > 1:
        z = np.array([field.log10.ravel() for field in generator.draw(run.target, run.k, run.seed, run.steps)])
        record |= {"distance": mean_distance(z), "inception": classes.inception_score(z)}
    return record


def score_record(field: RatioField, target: Outline) -> Record:
    """What a table keeps of the score of one sample."""
    sheet = deploy(field)
    (score,) = evaluate_many([sheet], target)
    return {
        "siou": score.siou,
        "siou_released": released_match(sheet, target),
        "iou_exact": score.iou_exact,
        "uniform_siou": score.uniform_siou,
        "uniform_iou": score.uniform_iou,
        "uniform_siou_released": released_floor(*field.ratio.shape, target),
        "feasible": score.feasible,
        "tv": score.tv,
        "tv_log10": score.tv_log10,
    }


def mean_distance(z: FloatArray) -> float:
    """Root mean square difference of two fields, mean over all pairs of the rows of z (K, m n)."""
    first, second = np.triu_indices(len(z), 1)
    return float(np.sqrt(np.square(z[first] - z[second]).mean(axis=1)).mean())


@dataclass(frozen=True, slots=True)
class FieldClasses:
    """Centres of training fields in the space of their main components.

    Attributes
    ----------
    mean : (m n,) float
        Of the training fields.
    components : (COMPONENTS, m n) float
    centres : (CLASSES, COMPONENTS) float
    variance : float
        Of the fields about their centres, mean over components.
    """

    mean: FloatArray
    components: FloatArray
    centres: FloatArray
    variance: float

    @classmethod
    def of(cls, z: FloatArray) -> FieldClasses:
        """Classes of training fields z (N, m n)."""
        mean = z.mean(axis=0)
        _, _, directions = np.linalg.svd(z - mean, full_matrices=False)
        components = directions[:COMPONENTS]
        seen = (z - mean) @ components.T
        centres, nearest = kmeans2(seen, CLASSES, minit="++", seed=0)
        variance = float(np.square(seen - centres[nearest]).sum(axis=1).mean() / COMPONENTS)
        return cls(mean, components, centres, variance)

    def inception_score(self, z: FloatArray) -> float:
        """exp(mean KL(p(class | row) || mean over rows)) of z (K, m n): from 1, all alike, to min(K, CLASSES)."""
        seen = (z - self.mean) @ self.components.T
        exponent = -0.5 * np.square(seen[:, None] - self.centres[None]).sum(axis=2) / self.variance
        likely = softmax(exponent, axis=1)
        return float(np.exp(rel_entr(likely, likely.mean(axis=0)).sum(axis=1).mean()))


@cache
def _warmed_up(source: str, steps: int) -> Sequence[RatioField]:
    """One sample for nothing: what a process loads and tabulates once belongs to no run."""
    return generator_named(source).draw(load("circle"), 1, 0, steps)


def _runs(
    targets: Mapping[str, Sequence[Outline]],
    sources: Sequence[str],
    seeds: Sequence[int],
    settings: TableSettings,
    sweep: Mapping[str, Sequence[int]],
) -> Iterator[SampleRun]:
    """Target by target, so that what is there after a while is a table of fewer targets."""
    for number in range(max(len(outlines) for outlines in targets.values())):
        for family, outlines in targets.items():
            if number >= len(outlines):
                continue
            for source in sources:
                one = generator_named(source)
                for seed in seeds:
                    k = settings.k if seed == seeds[0] else 1
                    yield SampleRun(source, one.digest, one.steps, family, seed, number, k, outlines[number])
                for steps in sweep.get(one.name, ()):
                    if steps != one.steps:
                        yield SampleRun(source, one.digest, steps, family, seeds[0], number, 1, outlines[number])


def _table(runs: Sequence[SampleRun], sources: Sequence[str], store: RunStore) -> FamilyTable[GeneratorRow]:
    rows = {generator_named(one).name: _row([run for run in runs if run.source == one], store) for one in sources}
    return FamilyTable.of([store.records[run.key] for run in runs], len({run.number for run in runs}), rows)


def _row(runs: Sequence[SampleRun], store: RunStore) -> GeneratorRow:
    generator = generator_named(runs[0].source)
    usual = [run for run in runs if run.steps == generator.steps]
    records = [store.records[run.key] for run in usual]
    varied = [record for run, record in zip(usual, records, strict=True) if run.k > 1]
    return GeneratorRow(
        **method_figures(records, [run.number for run in usual], [run.seed for run in usual]),
        steps=generator.steps,
        milliseconds=mean_of(records, "milliseconds"),
        distance=mean_of(varied, "distance"),
        inception=mean_of(varied, "inception"),
        by_steps=_by_steps([run for run in runs if run.seed == usual[0].seed], store),
        paper=paper_tables.GENERATORS.get(generator.name),
    )


def _by_steps(runs: Sequence[SampleRun], store: RunStore) -> dict[int, StepsRow]:
    """Figures by number of steps, where there is more than one."""
    found: dict[int, list[Record]] = {}
    for run in sorted(runs, key=lambda one: one.steps):
        found.setdefault(run.steps, []).append(store.records[run.key])
    if len(found) == 1:
        return {}
    return {steps: StepsRow(mean_of(records, "siou"), success_share(records)) for steps, records in found.items()}
