"""Numbers of the paper's tables and figures, each once (arXiv:2605.08098)."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class PaperRow:
    """A row of a table of the paper; None for what the table does not have.

    Attributes
    ----------
    siou, siou_sd, success : float, 0..1
        Mean sIoU, its spread over evaluation targets and seeds, and the share of successes.
    evaluations : float
        Forward evaluations (Table 1).
    milliseconds, inception : float
        Time of a sample, and the Inception-style score (Table 2).
    tv : float
        Total variation of the ratios (Table 3).
    """

    siou: float
    siou_sd: float | None = None
    success: float | None = None
    evaluations: float | None = None
    milliseconds: float | None = None
    inception: float | None = None
    tv: float | None = None


#: Training of each of its generators: steps, and designs in a step.
TRAINING_STEPS, TRAINING_BATCH = 31_250, 64
#: The flow-matching prior, a row of all three tables.
PRIOR = PaperRow(0.942, 0.007, 0.987, 1.0, 159.64, 1.89, 0.95)
#: Table 1, by method.
SOLVERS = {
    "cma-es": PaperRow(0.938, 0.029, 0.970, 986.0),
    "swarm": PaperRow(0.926, 0.033, 0.972, 625.1),
    "local-search": PaperRow(0.912, 0.049, 0.898, 1000.0),
    "powell": PaperRow(0.871, 0.059, 0.760, 1000.0),
    "sample": PRIOR,
}
#: Table 3, by reward, after this many forward evaluations.
GRPO = {
    "accuracy": PaperRow(0.9491, tv=0.98),
    "regularity": PaperRow(0.9367, tv=0.60),
    "balanced": PaperRow(0.9483, tv=0.81),
}
GRPO_CALLS = 10_000
#: Table 2, by generator: trained here, or bundled as the paper's; its GRPO variants are rows of Table 3.
GENERATORS = {
    "cvae": PaperRow(0.836, 0.060, 0.510, milliseconds=14.06, inception=1.62),
    "cgan": PaperRow(0.876, 0.003, 0.778, milliseconds=20.62, inception=1.74),
    "diffusion": PaperRow(0.855, 0.003, 0.762, milliseconds=473.30, inception=2.05),
    "ot-cfm": PRIOR,
    "paper": PRIOR,
    **{f"paper-{reward}": row for reward, row in GRPO.items()},
}
#: sIoU by method and K.  The paper says in words: the prior at K = 4 is a little above 96 % in less than 1 s, the swarm
#: a little below 95 % in tens of seconds; at K = 1 they are the rows of Table 1.
BEST_OF_K = {
    ("sample", 1): PRIOR.siou,
    ("sample", 4): 0.96,
    ("swarm", 1): SOLVERS["swarm"].siou,
    ("swarm", 4): 0.95,
    ("cma-es", 1): SOLVERS["cma-es"].siou,
}
#: Grid sweep, in the paper's words.
GRID_SWEEP = "Paper: solvers take a few seconds at 6 x 6 and a few tens of seconds at 24 x 24, a sample about 0.1 s."
