"""Rows of ours beside the paper's: where we are ahead, where not, and why.

*Like for like* are rows that the paper could have made: its solvers with its settings, and its networks where they were
trained at its budget on one family of designs and are tested on that family.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

from kirigami_studio.lab.baselines.solvers import SOLVERS
from kirigami_studio.lab.benchmark.paper_tables import GRPO_CALLS, TRAINING_BATCH, TRAINING_STEPS
from kirigami_studio.lab.benchmark.report.cells import Figures, is_replaced, measured, share, start_of

MIXED = "mixed"
#: Pixels each way, with which networks for 10 x 10 ratios smooth their fields.
COARSE = 16
SOLVER = (
    "run with the paper's settings as far as it gives them; how its targets and its measure differ from these is not "
    "known, see *Table 1*"
)
#: Why a network's match falls while it is trained, where a run of *Training* shows it.
SHOWN = {
    "cvae": "the divergence of latent numbers from those that samples draw weighs 1e-4, as in the paper "
    "(*cvae-kl-0.03* differs in nothing but this weight and its steps)",
}
START = (
    "what the run began with decides the level; *over start* and *over control* tell what the reward did, see *Table 3*"
)

#: What no row of ours has as the paper has it.
DEVIATIONS = (
    "Targets are silhouettes of our own splits (families *structured*, *released* and *sobol*, see the "
    "[data card](data-card.md)): the paper's are not published, and its text and its code draw different ones.",
    "Fields are decoded by one exact linear solve, not by marching (`lattice/compact.py`).",
    "The pose of sIoU is searched on polygons, then pixels are counted; *as released* is the search of the released "
    "code.",
    "*Success* also asks that the sheet touches itself nowhere on its way to the target.",
    "Networks and solvers see z = log10 x, with a noise of standard deviation 0.5 for flows.",
    "No positional encodings. Attention is one layer after each residual block, not 12, with two heads "
    "(`generator/unet.py`).",
    "`paper`: 32 and 64 channels on one pixel for each ratio, not 64 to 384 on 32 x 32 pixels; noise and designs "
    "paired at random, not by optimal transport; silhouettes upright, a little turned and moved; an exponential "
    "average of the weights, not a stochastic one; a learning rate that falls from 2e-3 along a cosine, not 2e-5 "
    "throughout.",
    "`ot-cfm` (16 and 32 channels), `diffusion`, `cgan` and `cvae` (8 and 16 each): one pixel for each ratio, too, on "
    "the 5000 designs of one family; `ot-cfm` trained as `paper` was, the others on silhouettes as they lie.",
    "GRPO follows the paper's text (groups of 4, temperature 0.2, penalties), not the settings of its released code.",
    "The classes of the Inception-style score are centres of training fields: the paper does not name its features.",
)


@dataclass(frozen=True, slots=True)
class Compared:
    """A row of ours that the paper has, too: sIoU from 0 to 1.

    Attributes
    ----------
    table, family, name : str
    targets : int
    floor, siou : float
        Of the uniform sheet, and ours.
    released : float or None
        Ours as the released code measures it, where it was measured.
    paper, paper_spread : float
    apart : str
        How it differs from the paper's own; empty for a row like for like.
    reason : str
        Why it may be behind.
    """

    table: str
    family: str
    name: str
    targets: int
    floor: float
    siou: float
    released: float | None
    paper: float
    paper_spread: float
    apart: str
    reason: str

    @property
    def points(self) -> float:
        """Our lead in percentage points."""
        return 100.0 * (self.siou - self.paper)

    @property
    def ahead(self) -> bool:
        """Whether ours is not below the paper's."""
        return self.points >= 0.0

    @property
    def full_reason(self) -> str:
        """Why it may be behind, and whether that is within the paper's spread."""
        return f"{self.reason}; behind by less than the paper's own spread" if self.within_spread else self.reason

    @property
    def within_spread(self) -> bool:
        """Whether ours is ahead, or behind by no more than the spread that the paper gives."""
        return self.siou >= self.paper - self.paper_spread


def rows_beside_paper(
    solvers: Sequence[Figures], generators: Sequence[Figures], grpo: Figures | None, falling: Collection[str] = ()
) -> list[Compared]:
    """Every row that the paper has, too.

    Parameters
    ----------
    solvers, generators : sequence of dict
        Of the suites, one call after the other.
    grpo : dict, optional
    falling : collection of str
        Training runs whose match on validation fell.
    """
    return [
        *(row for figures in solvers for row in _solver_rows(figures)),
        *(row for figures in generators for row in _generator_rows(figures, falling)),
        *_aligned_rows(grpo, generators),
    ]


def counts(rows: Sequence[Compared]) -> str:
    """How many rows are ahead of the paper: those like for like, and all."""
    alike = [row for row in rows if not row.apart]
    return (
        f"Like for like {_count(alike, 'ahead')} rows are ahead of the paper, and {_count(alike, 'within_spread')} are "
        "ahead or behind by no more than the spread that it gives. Of all rows of Tables 1 to 3 that it has, too, "
        f"{_count(rows, 'ahead')} are ahead."
    )


def beside_paper_section(rows: Sequence[Compared]) -> Iterator[str]:
    """Our rows and the paper's, and why some are behind."""
    yield "## Beside the paper"
    yield ""
    yield (
        "*Like for like*: its solvers with its settings; its networks where they were trained at its budget "
        f"({TRAINING_STEPS} steps of {TRAINING_BATCH}, {GRPO_CALLS} calls of GRPO) on one family of designs and are "
        "tested on that family. Where they differ from it all the same, such as in size and in how noise and designs "
        "are paired, is in the [model card](../resources/models/MODEL_CARD.md#paper). sIoU in percent; the lead is "
        "ours over the paper's, in points. Targets are those of our splits, since the paper's are not published; it "
        "does not say which family it used, nor which way round its tables were measured."
    )
    yield ""
    yield "| table | family | targets | row | uniform sheet | ours | as released | paper | lead | like for like |"
    yield "|---|---|---|---|---|---|---|---|---|---|"
    for row in rows:
        numbers = f"{share(row.floor)} | {share(row.siou)} | {measured(row.released)} | {share(row.paper)}"
        like = f"no: {row.apart}" if row.apart else "yes"
        yield f"| {row.table} | {row.family} | {row.targets} | {row.name} | {numbers} | {row.points:+.1f} | {like} |"
    behind = [row for row in rows if not row.ahead]
    if behind:
        yield ""
        yield "Why rows are behind:"
        yield ""
        for reason in dict.fromkeys(row.full_reason for row in behind):
            found = dict.fromkeys((row.name, row.family) for row in behind if row.full_reason == reason)
            names = {name: [family for one, family in found if one == name] for name, _ in found}
            listed = ", ".join(f"{name} ({', '.join(families)})" for name, families in names.items())
            yield f"- {listed}: {reason}."
    yield ""


def deviation_section() -> Iterator[str]:
    """Where our runs differ from the paper's, in one list."""
    yield "## Where ours differs from the paper"
    yield ""
    yield "In every row, like for like or not:"
    yield ""
    yield from (f"- {deviation}" for deviation in DEVIATIONS)
    yield ""


def _count(rows: Sequence[Compared], name: str) -> str:
    return f"{sum(getattr(row, name) for row in rows)} of {len(rows)}"


def _solver_rows(figures: Figures) -> Iterator[Compared]:
    """Rows of Table 1."""
    for family, found in figures["families"].items():
        for name, row in found["rows"].items():
            apart = "" if name in SOLVERS else "the bundled prior"
            yield from _row("1, solvers", family, name, found, row, apart, SOLVER)


def _generator_rows(figures: Figures, falling: Collection[str]) -> Iterator[Compared]:
    """Rows of Table 2, and rows of Table 3 that were measured with them."""
    for family, found in figures["families"].items():
        for name, row in found["rows"].items():
            trained = figures.get("trained", {}).get(name)
            causes = ["how it was trained is not recorded"] if trained is None else _causes(trained, family)
            why = list(causes)
            if trained is not None and trained["latent"] == COARSE:
                why.append(
                    f"fields are resized to {COARSE} x {COARSE} pixels, which smooths the checkerboard that makes the "
                    "shape"
                )
            if name in falling:
                falls = "its match on validation falls while it is trained, see *Training*"
                why.append(f"{falls}: {SHOWN[name]}" if name in SHOWN else falls)
            yield from _row("2, generators", family, name, found, row, "; ".join(causes), "; ".join(why))


def _causes(trained: Figures, family: str) -> list[str]:
    """How a network's training differs from the paper's, for targets of one family."""
    causes = []
    if trained["family"] != family:
        causes.append(f"trained on {'a mixture of families' if trained['family'] == MIXED else trained['family']}")
    if trained["calls"]:
        if trained["calls"] < GRPO_CALLS:
            causes.append(f"{trained['calls']} of {GRPO_CALLS} calls")
    elif trained["steps"] * trained["batch"] < TRAINING_STEPS * TRAINING_BATCH:
        causes.append(f"{trained['steps']} of {TRAINING_STEPS} steps")
    return causes


def _aligned_rows(figures: Figures | None, generators: Sequence[Figures]) -> Iterator[Compared]:
    """The last rows of Table 3's runs, without those of a start that is no longer bundled."""
    if figures is None:
        return
    for family, found in figures["families"].items():
        for start, runs in found["starts"].items():
            for name, snapshots in runs.items():
                settings = figures["training"][start][name]
                if is_replaced(start, settings):
                    continue
                trained = {"calls": snapshots[-1]["calls"], "family": settings.get("family", MIXED)}
                apart = ["the bundled prior"] if start == "bundled prior" else _causes(trained, family)
                why = "; ".join((START, *_at_its_variation(snapshots)))
                full_name = f"{name} (from {start_of(start, settings, generators)})"
                yield from _row("3, GRPO", family, full_name, found, snapshots[-1], "; ".join(apart), why)


def _at_its_variation(snapshots: Sequence[Figures]) -> Iterator[str]:
    """Match of the weights on the way of a GRPO run whose total variation is nearest the paper's."""
    paper = snapshots[-1]["paper"]
    if paper and paper.get("tv"):
        nearest = min(snapshots, key=lambda row: abs(float(row["tv"]) - float(paper["tv"])))
        if nearest is not snapshots[-1]:
            yield (
                f"after {nearest['calls']} calls its TV is {nearest['tv']:.2f} (the paper's {paper['tv']:.2f}, ours in "
                f"the end {snapshots[-1]['tv']:.2f}), and sIoU {share(nearest['siou'])}"
            )


def _row(
    table: str, family: str, name: str, found: Figures, row: Figures, apart: str, reason: str
) -> Iterator[Compared]:
    """The row beside the paper's; nothing where the paper has none."""
    paper = row["paper"]
    if paper:
        yield Compared(
            table,
            family,
            name,
            found["targets"],
            found["uniform_siou"],
            row["siou"],
            row.get("siou_released"),
            paper["siou"],
            paper.get("siou_sd") or 0.0,
            apart,
            reason or "not looked into",
        )
