"""Tables of runs: how well designs match their targets, by method and family, over runs, seeds and targets."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, Protocol, TypeVar

import numpy as np

from kirigami_studio.lab.benchmark.generator_suite import SUCCESS_SIOU, bootstrap_interval
from kirigami_studio.lab.benchmark.paper_tables import PaperRow
from kirigami_studio.lab.benchmark.run_store import Record, group_means, mean_of, values_of


@dataclass(frozen=True, slots=True, kw_only=True)
class MatchRow:
    """A row's figures on one family; shares from 0 to 1.

    Attributes
    ----------
    runs : int
    siou, siou_sd : float
        Mean and standard deviation over runs.
    siou_sd_of_seeds : float
        Standard deviation of the seeds' means.
    siou_interval : (float, float)
        Bootstrap 95 % interval over targets.
    siou_released : float
        Mean sIoU as the authors' released code measures it.
    iou_exact : float
        On the polygons.
    success : float
        Share of runs with sIoU >= 0.85 and a feasible design.
    tv : float
        The paper's sum divided by m n.
    paper : PaperRow or None
    """

    runs: int
    siou: float
    siou_sd: float
    siou_sd_of_seeds: float
    siou_interval: tuple[float, float]
    siou_released: float
    iou_exact: float
    success: float
    tv: float
    paper: PaperRow | None


def match_figures(records: Sequence[Record], numbers: Sequence[int], seeds: Sequence[int]) -> dict[str, Any]:
    """All of a :class:`MatchRow` but the paper's; ``numbers`` and ``seeds`` are of the records' targets and runs."""
    siou = values_of(records, "siou")
    return {
        "runs": len(records),
        "siou": float(siou.mean()),
        "siou_sd": float(siou.std()),
        "siou_sd_of_seeds": float(np.std(group_means(siou, seeds))),
        "siou_interval": bootstrap_interval(group_means(siou, numbers)),
        "siou_released": mean_of(records, "siou_released"),
        "iou_exact": mean_of(records, "iou_exact"),
        "success": success_share(records),
        "tv": mean_of(records, "tv"),
    }


def floor_figures(records: Sequence[Record]) -> dict[str, float]:
    """Mean match of the uniform sheet by our measure, the released one, and exactly, 0..1."""
    return {name: mean_of(records, name) for name in ("uniform_siou", "uniform_siou_released", "uniform_iou")}


def success_share(records: Sequence[Record]) -> float:
    """Share of samples with sIoU >= 0.85 and a feasible design (paper, Sec. 3.1)."""
    return float(np.mean((values_of(records, "siou") >= SUCCESS_SIOU) & (values_of(records, "feasible") > 0.0)))


@dataclass(frozen=True, slots=True, kw_only=True)
class MethodRow(MatchRow):
    """A row beside the uniform sheet.

    Attributes
    ----------
    iou_exact_interval : (float, float)
        Bootstrap 95 % interval over targets.
    """

    iou_exact_interval: tuple[float, float]


def method_figures(records: Sequence[Record], numbers: Sequence[int], seeds: Sequence[int]) -> dict[str, Any]:
    """Those of a :class:`MethodRow`, as :func:`match_figures`."""
    exact = group_means(values_of(records, "iou_exact"), numbers)
    return {**match_figures(records, numbers, seeds), "iou_exact_interval": bootstrap_interval(exact)}


class TableRow(Protocol):
    """A row that a table prints below its heading."""

    HEADING: ClassVar[str]

    def sentences(self, name: str) -> Iterator[str]:
        """The row for people: percentages, the paper's number in brackets."""


RowT = TypeVar("RowT", bound=TableRow)


@dataclass(frozen=True, slots=True)
class FamilyTable(Generic[RowT]):
    """The rows of one family of targets, and how well the uniform sheet matches them."""

    targets: int
    uniform_siou: float
    uniform_siou_released: float
    uniform_iou: float
    rows: dict[str, RowT]

    @classmethod
    def of(cls, records: Sequence[Record], targets: int, rows: dict[str, RowT]) -> FamilyTable[RowT]:
        """The table of records that have the uniform sheet's figures."""
        return cls(targets=targets, rows=rows, **floor_figures(records))

    def sentences(self) -> Iterator[str]:
        """The table for people."""
        yield next(iter(self.rows.values())).HEADING
        yield f"  {'uniform sheet':13}{100 * self.uniform_siou:9.1f}{'':15}{100 * self.uniform_iou:8.1f}"
        for name, row in self.rows.items():
            yield from row.sentences(name)
