"""The part of the report that says, row by row, where we are ahead of the paper, where not, and why."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from kirigami_studio.lab.benchmark.report.cells import Figures, share

#: Why a row may be behind the paper's, by the row's name.
SOLVER = "run with the paper's settings as far as it gives them, on our own targets, see *Table 1*"
BUDGET = "smaller networks and fewer training steps than the paper's, see *Training*"
GRPO = (
    "what the run began with decides the level; *over start* and *over control* tell what the reward did, see *Table 3*"
)
REASONS = {
    **dict.fromkeys(("cma-es", "swarm", "local-search", "powell"), SOLVER),
    **dict.fromkeys(("cvae", "cgan", "diffusion", "ot-cfm"), BUDGET),
}


@dataclass(frozen=True, slots=True)
class Compared:
    """A row of ours that the paper has, too: sIoU from 0 to 1, and why ours may be behind."""

    table: str
    family: str
    name: str
    siou: float
    paper: float
    reason: str

    @property
    def points(self) -> float:
        """Our lead in percentage points."""
        return 100.0 * (self.siou - self.paper)


def beside_paper_section(solvers: Figures | None, generators: Figures | None, grpo: Figures | None) -> Iterator[str]:
    """Every row that the paper has, too; nothing where there is none."""
    rows = [
        *_rows("1, solvers", solvers),
        *_rows("2, generators", generators),
        *_aligned_rows(grpo),
    ]
    if not rows:
        return
    behind = [row for row in rows if row.points < 0.0]
    yield "## Beside the paper"
    yield ""
    yield (
        f"{len(rows) - len(behind)} of {len(rows)} rows of Tables 1 to 3 that the paper has, too, are ahead of it. "
        "sIoU in percent; the lead is in points. Targets are those of our splits, since the paper's are not "
        "published; it does not say which family it used."
    )
    yield ""
    yield "| table | family | row | ours | paper | lead |"
    yield "|---|---|---|---|---|---|"
    for row in rows:
        numbers = f"{share(row.siou)} | {share(row.paper)} | {row.points:+.1f}"
        yield f"| {row.table} | {row.family} | {row.name} | {numbers} |"
    if behind:
        yield ""
        yield "Why rows are behind:"
        yield ""
        for reason in dict.fromkeys(row.reason for row in behind):
            names = ", ".join(dict.fromkeys(row.name for row in behind if row.reason == reason))
            yield f"- {names}: {reason}."
    yield ""


def _rows(table: str, figures: Figures | None) -> Iterator[Compared]:
    """Rows of Tables 1 and 2."""
    families = {} if figures is None else figures["families"]
    for family, found in families.items():
        for name, row in found["rows"].items():
            if row["paper"]:
                reason = REASONS.get(name, "not looked into")
                yield Compared(table, family, name, row["siou"], row["paper"]["siou"], reason)


def _aligned_rows(figures: Figures | None) -> Iterator[Compared]:
    """The last rows of Table 3's runs."""
    families = {} if figures is None else figures["families"]
    for family, found in families.items():
        for start, runs in found["starts"].items():
            for name, snapshots in runs.items():
                row = snapshots[-1]
                if row["paper"]:
                    yield Compared("3, GRPO", family, f"{name} (from {start})", row["siou"], row["paper"]["siou"], GRPO)
