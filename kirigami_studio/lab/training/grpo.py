"""Group Relative Policy Optimization, GRPO, as the paper states it (Sec. "OT-CFM prior and GRPO preference alignment").

A step draws G designs x for each of B targets with the current network, lets the evaluator reward them, and regresses
the flow towards them, the better ones more:

    A_g = (r_g - mean r) / (std r + eps)                              within a group    (Eq. 4)
    w_g = exp(A_g / T) / (1/G sum_k exp(A_k / T))                                       (Eq. 5)
    loss = mean over targets of 1/G sum_g w_g |v(x_t, t, y) - (x_g - x_0)|^2            (Eq. 6)

with x_t = (1 - t) x_0 + t x_g, fresh noise x_0 and t uniform.  There is no policy ratio and no log-probability.  The
text is followed where the authors' released code differs from it; what goes beyond the text (pull to the prior, plain
centred advantages, bound on weights, groups left out, averaged weights) is off by default.

Readings, where the text leaves room: std divides by G; the squared error is the mean over cells; a design is clipped to
x in [0.1, 10] before it is rewarded and regressed to, as the studio does; targets are silhouettes of the training
distribution, seen in the pose in which the studio shows them; one update for each rollout, by Adam.

The run folder holds ``checkpoint.pt`` and ``log.jsonl`` as that of ``train_flow`` does, and the weights as they were
after the environment calls that were asked for, which ``benchmark grpo`` judges.
"""

from __future__ import annotations

import copy
import math
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import torch
from torch import Tensor

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ModelError, UsageError
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.generator.conditioning import square_pose, turned
from kirigami_studio.generator.flow import integrate
from kirigami_studio.generator.velocity import Code, Network
from kirigami_studio.generator.weights import Model
from kirigami_studio.lab.paper_evaluator import PaperScore, judge
from kirigami_studio.lab.trained_weights import store_model, variants_about
from kirigami_studio.lab.training.corpus import ChunkBatches
from kirigami_studio.lab.training.dataset import Split, designs_of, digest_of_designs
from kirigami_studio.lab.training.flow_path import ConditionalPath, PathSample, cfm_errors
from kirigami_studio.lab.training.learner import CHECKPOINT, Checkpoint, Learner, logged, opened
from kirigami_studio.lab.training.rewards import Group, GroupReward, Reward, reward_named
from kirigami_studio.outlines.outline import Outline

#: The small constant of Eq. 4.
EPSILON = 1e-6
ADVANTAGES = ("standardised", "centred")
#: Steps' worth of the prior's samples that set the scales of the balanced reward; they count as environment calls.
SCALING_STEPS = 4


@dataclass(frozen=True, slots=True)
class GrpoSettings:
    """Settings of one run; the defaults are the paper's.

    Attributes
    ----------
    reward : str
        See :mod:`kirigami_studio.lab.training.rewards`.
    start : str
        SHA-256 of the weights that the run begins with.
    calls : int
        Environment calls in all (one call: one design decoded, checked and scored).  A reward that compares with the
        start spends half of them on the start's own designs.
    group, batch : int
        Designs of a target, targets of a step; the last step takes as many targets as calls are left for.
    temperature : float
        T; smaller means that only the best of a group counts.
    learning_rate : float
        Constant.
    rollout_steps : int
        Euler steps of the rollouts.
    advantages : str
        ``standardised`` (Eq. 4), or ``centred``: not divided by the standard deviation.  The division turns
        even the evaluator's rounding into full-size advantages where all designs of a group are equally good.
    weight_clip : float
        Largest weight w, at most G by itself; 0 sets no bound.
    reference : float
        Weight of |v - v of the frozen prior|^2 at the same (x_t, t, y).
    least_spread : float
        Groups whose rewards have a smaller standard deviation are left out of the loss.
    average_decay : float
        Of the moving average of weights that is handed over; 0 hands over the last ones.
    family, designs : str
        Whose silhouettes are the targets, see :class:`kirigami_studio.lab.training.train_flow.FlowSettings`.
    seed : int
    """

    reward: str = "accuracy"
    start: str = ""
    calls: int = 10_000
    group: int = 4
    batch: int = 8
    temperature: float = 0.2
    learning_rate: float = 1e-5
    rollout_steps: int = 8
    advantages: str = "standardised"
    weight_clip: float = 0.0
    reference: float = 0.0
    least_spread: float = 0.0
    average_decay: float = 0.0
    family: str = "mixed"
    designs: str = ""
    seed: int = 0

    def __post_init__(self) -> None:
        reward_named(self.reward)
        if self.advantages not in ADVANTAGES:
            raise UsageError("training.unknown_advantages", advantages=self.advantages, choices=", ".join(ADVANTAGES))
        if self.group < 2:
            raise UsageError("training.group_too_small", group=self.group)
        if min(self.batch, self.rollout_steps) < 1:
            raise UsageError("training.rollout_too_small", batch=self.batch, rollout_steps=self.rollout_steps)
        if min(self.temperature, self.learning_rate) <= 0.0:
            raise UsageError(
                "training.rates_not_positive", temperature=self.temperature, learning_rate=self.learning_rate
            )
        if not 0.0 <= self.average_decay < 1.0:
            raise UsageError("training.decay_out_of_range", decay=self.average_decay)
        if min(self.weight_clip, self.reference, self.least_spread) < 0.0:
            raise UsageError(
                "training.negative_bounds",
                weight_clip=self.weight_clip,
                reference=self.reference,
                least_spread=self.least_spread,
            )
        needed = self.scaling_calls + self.calls_of_target
        if self.calls < needed:
            raise UsageError("training.too_few_calls", needed=needed, calls=self.calls)

    @property
    def scaling_calls(self) -> int:
        """Environment calls that measure the scales of the balanced reward."""
        return SCALING_STEPS * self.batch * self.group if self.reward == "balanced" else 0

    @property
    def calls_of_target(self) -> int:
        """Environment calls that each target of a step costs."""
        return self.group * (2 if reward_named(self.reward).compares_with_start else 1)

    def to_json(self) -> dict[str, object]:
        return asdict(self)


def advantages(rewards: Tensor, kind: str = "standardised") -> Tensor:
    """Group-relative advantages (paper, Eq. 4) of rewards (B, G), each row a group; ``centred`` does not divide."""
    centred = rewards - rewards.mean(dim=1, keepdim=True)
    if kind == "centred":
        return centred
    return centred / (rewards.std(dim=1, correction=0, keepdim=True) + EPSILON)


def group_weights(advantage: Tensor, temperature: float, clip: float = 0.0) -> Tensor:
    """Weights (paper, Eq. 5) of advantages (B, G): the mean of each row is 1, before a bound ``clip`` above 0."""
    weights = advantage.shape[1] * torch.softmax(advantage / temperature, dim=1)
    return weights.clamp_max(clip) if clip else weights


def grpo_loss(velocity: Tensor, sample: PathSample, weights: Tensor, groups: int | None = None) -> Tensor:
    """GRPO loss (paper, Eq. 6): the CFM errors of Eq. 3, each times the weight of its design.

    Parameters
    ----------
    velocity : (B * G, C) tensor
        v at the points ``x_t`` of ``sample``, the designs of a group in a row.
    sample : PathSample
    weights : (B, G) tensor
        Eq. 5; 0 for designs of groups that are left out.
    groups : int, optional
        How many groups count; all of them when missing.
    """
    errors = cfm_errors(velocity, sample)
    counted = len(weights) if groups is None else groups
    return (weights.flatten().to(errors) * errors).sum() / max(1, counted * weights.shape[1])


def train_grpo(
    settings: GrpoSettings,
    folder: Path,
    device: torch.device,
    validate: Callable[[Network], dict[str, float]],
    start: Model,
    *,
    designs: Split | None = None,
    seconds: float = math.inf,
    validate_every: int = 50,
    keep_at: Sequence[int] = (),
) -> Iterator[dict[str, float]]:
    """Align, or go on aligning, in ``folder``; yields a record before the first step and one per validation.

    Parameters
    ----------
    settings : GrpoSettings
    folder : Path
        Created if needed; a checkpoint found there is resumed.
    device : torch.device
        Of the network; the evaluator runs on the processor.
    validate : callable
        Maps the network that would be handed over to figures for the log.
    start : Model
        The prior; it is not written to.
    designs : Split, optional
        The data set that the settings name.
    seconds : float
        Stop with a checkpoint after this wall time even if calls remain.
    validate_every : int
        Steps between validations; each also writes a checkpoint.  A run that was finished before is validated again.
    keep_at : sequence of int
        Environment calls; as soon as a run has made so many, its weights are kept, see :func:`kept_name`.

    Yields
    ------
    record : dict
        ``step``, ``calls``, ``seconds``, the figures of ``validate`` and, since the last record: ``loss``, and means
        over designs of ``reward``, ``siou``, ``tv``, ``infeasible``, ``spread`` (of z within a group) and ``used``
        (share of designs whose group took part).

    Raises
    ------
    ExportError
        The folder cannot be made or written.
    ModelError
        The checkpoint belongs to other settings, or ``start`` does, or training diverged.
    UsageError
        Weights are to be kept after more calls than there are, or a resumed run has passed them.
    """
    if max(keep_at, default=0) > settings.calls:
        raise UsageError("training.kept_after_end", kept=max(keep_at), calls=settings.calls)
    if (start.digest, digest_of_designs(designs)) != (settings.start, settings.designs):
        raise ModelError("training.other_start")
    run = GrpoRun(settings, opened(folder), device, start, designs)
    waiting = _to_keep(folder, run, keep_at)
    began = time.perf_counter()

    def record() -> dict[str, float]:
        run.save()
        figures = {"step": float(run.step), "calls": float(run.calls), **run.taken_means()}
        figures |= {"seconds": time.perf_counter() - began} | validate(run.averaged())
        return logged(folder, figures)

    if run.step == 0 or not run.targets_left:
        yield record()
    while run.targets_left:
        run.advance()
        # Before the checkpoint: a run that is resumed from one made earlier keeps the same weights again.
        while waiting and (run.calls >= waiting[0] or not run.targets_left):
            _keep(folder, run, waiting.pop(0), run.averaged())
        out_of_time = time.perf_counter() - began > seconds
        if run.step % validate_every == 0 or not run.targets_left or out_of_time:
            yield record()
        if out_of_time:
            break


def kept_name(calls: int) -> str:
    """Variant, and name of the file without its ending, of weights that are kept after so many environment calls."""
    return f"calls-{calls}"


def _keep(folder: Path, run: GrpoRun, wanted: int, network: Network) -> None:
    about = {"calls": run.calls if wanted else 0, "settings": run.settings.to_json()}
    store_model(kept_name(wanted), network, folder, about)


def _to_keep(folder: Path, run: GrpoRun, keep_at: Sequence[int]) -> list[int]:
    """Calls after which weights are still to be kept, rising; those before the first call are kept at once."""
    known = variants_about(folder)
    waiting = [calls for calls in sorted(set(keep_at)) if run.step == 0 or kept_name(calls) not in known]
    if 0 in waiting:
        _keep(folder, run, 0, run.prior)
        waiting.remove(0)
    passed = [calls for calls in waiting if calls <= run.calls and run.step > 0]
    if passed:
        raise UsageError("training.kept_too_late", folder=folder, kept=passed[0], calls=run.calls)
    return waiting


def aligned_network(folder: Path, start: Model) -> Network:
    """The network of the checkpoint in ``folder``: what is handed over."""
    network = copy.deepcopy(start.network)
    network.load_state_dict(Checkpoint.load(folder / CHECKPOINT).average)
    return network.eval()


class GrpoRun:
    """The mutable part of a run: one rollout, its rewards and one update a step."""

    def __init__(
        self, settings: GrpoSettings, path: Path, device: torch.device, start: Model, designs: Split | None = None
    ) -> None:
        self.settings, self.path, self.device = settings, path, device
        self.prior = copy.deepcopy(start.network).to(device).eval().requires_grad_(False)
        self.network = copy.deepcopy(self.prior).requires_grad_(True)
        optimiser = torch.optim.Adam(self.network.parameters(), lr=settings.learning_rate)
        self.generator = torch.Generator(device=device).manual_seed(settings.seed)
        self.learner = Learner(self.network, optimiser, self.generator, device)
        shape = start.network.shape
        self.grid, self.z_scale = (shape.rows, shape.columns), shape.z_scale
        corpus = designs_of(settings.family, designs, *self.grid, settings.seed, settings.batch, device)
        self.batches = ChunkBatches(corpus, settings.batch, passes=1)
        self.reward: GroupReward = reward_named(settings.reward)
        self.calls = 0
        self._totals: Counter[str] = Counter()
        if path.exists():
            self._resume()
        elif settings.scaling_calls:
            self._measure_scales()

    @property
    def step(self) -> int:
        """Finished steps."""
        return self.learner.step

    @property
    def targets_left(self) -> int:
        """Targets of the next step: as many as the remaining environment calls allow, 0 at the end."""
        return min(self.settings.batch, (self.settings.calls - self.calls) // self.settings.calls_of_target)

    def advance(self) -> None:
        """One step: roll out, reward, regress."""
        seen, outlines = self._targets(self.step, self.targets_left)
        noise = self._noise(len(seen))
        designs = self._rollout(self.network, seen, noise)
        verdicts = self._judged(designs, outlines)
        rewards = torch.tensor(self._rewards(seen, noise, designs, outlines, verdicts), dtype=torch.float64)
        used = rewards.std(dim=1, correction=0) >= self.settings.least_spread
        loss = math.nan
        if used.any() or self.settings.reference:
            loss = self._update(seen, designs, self._weights(rewards) * used[:, None], int(used.sum()))
        self.learner.step += 1
        self._note(rewards, verdicts, designs, used, loss)

    def averaged(self) -> Network:
        """A copy of the network with the weights that would be handed over."""
        return self.learner.averaged(copy.deepcopy(self.prior))

    def taken_means(self) -> dict[str, float]:
        """Means over the designs since the last call; nothing before the first step."""
        totals, self._totals = self._totals, Counter()
        found = {"loss": totals["loss"] / totals["updates"]} if totals["updates"] else {}
        names = ("reward", "siou", "tv", "infeasible", "spread", "used")
        return found | {name: totals[name] / totals["designs"] for name in names if totals["designs"]}

    def save(self) -> None:
        self.learner.save(self.path, self.settings.to_json(), {"calls": self.calls, **self.reward.state()})

    def _resume(self) -> None:
        more = self.learner.resume(self.path, self.settings.to_json())
        self.calls = int(more["calls"])
        self.reward = self.reward.restored(more)

    def _measure_scales(self) -> None:
        """Scales of the balanced reward from the prior's own samples."""
        groups: list[list[PaperScore]] = []
        for number in range(SCALING_STEPS):
            seen, outlines = self._targets(number, self.settings.batch)
            groups += self._judged(self._rollout(self.network, seen, self._noise(len(seen))), outlines)
        self.reward = Reward(self.settings.reward).scaled(groups)

    def _targets(self, number: int, count: int) -> tuple[Tensor, list[Outline]]:
        """Training silhouettes of step ``number``: as the network sees them (B, L, 2), and for the evaluator."""
        polygons = self.batches.at(number).polygons[:count]
        outlines = [Outline.from_points(polygon) for polygon in polygons.cpu().double().numpy()]
        return turned(polygons, -square_pose(polygons)), outlines

    def _noise(self, targets: int) -> Tensor:
        """Where the flow starts for G designs of each target: (B * G, m * n)."""
        return self._normal((targets * self.settings.group, math.prod(self.grid))) * self.z_scale

    def _rollout(self, network: Network, seen: Tensor, noise: Tensor) -> Tensor:
        """G designs of each target by a network: (B, G, m * n), z = log10 x."""
        with torch.no_grad():
            code = network.code(seen).repeated(self.settings.group)
            z = integrate(network, noise, code, self.settings.rollout_steps)
        return z.clamp(-LOG_RATIO_LIMIT, LOG_RATIO_LIMIT).view(len(seen), self.settings.group, -1)

    def _judged(self, designs: Tensor, outlines: list[Outline]) -> list[list[PaperScore]]:
        """The evaluator's word on every design; each counts as one environment call."""
        self.calls += designs.shape[0] * designs.shape[1]
        return [judge(group, outline) for group, outline in zip(self._fields(designs), outlines, strict=True)]

    def _fields(self, designs: Tensor) -> FloatArray:
        """Designs (B, G, m * n) as the evaluator takes them: (B, G, m, n)."""
        fields: FloatArray = designs.cpu().double().numpy().reshape(*designs.shape[:2], *self.grid)
        return fields

    def _rewards(
        self, seen: Tensor, noise: Tensor, designs: Tensor, outlines: list[Outline], verdicts: list[list[PaperScore]]
    ) -> list[list[float]]:
        """R of every design; where the start is asked, it draws its own designs from the same noise."""
        usual = [math.nan] * len(outlines)
        if self.reward.compares_with_start:
            start = self._judged(self._rollout(self.prior, seen, noise), outlines)
            usual = [math.fsum(verdict.siou for verdict in group) / len(group) for group in start]
        groups = zip(self._fields(designs), verdicts, usual, strict=True)
        return [self.reward.of(Group(*group)) for group in groups]

    def _weights(self, rewards: Tensor) -> Tensor:
        advantage = advantages(rewards, self.settings.advantages)
        return group_weights(advantage, self.settings.temperature, self.settings.weight_clip)

    def _update(self, seen: Tensor, designs: Tensor, weights: Tensor, groups: int) -> float:
        """One Adam step on the GRPO loss over ``groups`` groups that count, and the pull to the prior."""
        group = self.settings.group
        code = self.network.code(seen).repeated(group)
        design = designs.flatten(0, 1)
        noise = self._normal(design.shape) * self.z_scale
        t = torch.rand(len(design), generator=self.generator, device=self.device)
        path = ConditionalPath.sample(noise, design, t)
        velocity = self.network(path.x_t, t, code)
        loss = grpo_loss(velocity, path, weights, groups)
        if self.settings.reference:
            wanted = self._prior_velocity(path.x_t, t, self.prior.code(seen).repeated(group))
            loss = loss + self.settings.reference * (velocity - wanted).square().mean()
        if not torch.isfinite(loss):
            raise ModelError("training.diverged")
        self.learner.learn(loss, self.settings.average_decay)
        return float(loss.detach())

    def _prior_velocity(self, x_t: Tensor, t: Tensor, code: Code) -> Tensor:
        with torch.no_grad():
            return self.prior(x_t, t, code)

    def _note(
        self, rewards: Tensor, verdicts: list[list[PaperScore]], designs: Tensor, used: Tensor, loss: float
    ) -> None:
        """Add a step to the sums that ``taken_means`` divides."""
        said = [verdict for group in verdicts for verdict in group]
        step = {
            "designs": len(said),
            "reward": float(rewards.sum()),
            "siou": sum(verdict.siou for verdict in said),
            "tv": sum(verdict.tv for verdict in said),
            "infeasible": sum(not verdict.feasible for verdict in said),
            "spread": float(designs.std(dim=1).mean()) * len(said),
            "used": int(used.sum()) * self.settings.group,
        }
        if not math.isnan(loss):
            step |= {"updates": 1, "loss": loss}
        for name, value in step.items():
            self._totals[name] += value  # type: ignore[assignment]

    def _normal(self, shape: tuple[int, ...]) -> Tensor:
        return torch.randn(shape, generator=self.generator, device=self.device)
