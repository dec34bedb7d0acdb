"""SHIM until the real one."""
from __future__ import annotations
import math
from dataclasses import dataclass
import shapely
from kirigami_studio.fabricate.findings import Note, Problem

@dataclass(frozen=True, slots=True, eq=False)
class PinnedReport:
    problems: tuple[Problem, ...]
    notes: tuple[Note, ...]
    opened_iou: float
    flat_iou: float
    least_neck_mm: float

def check_pinned(plan) -> PinnedReport:
    def iou(phi, outline):
        a = plan.assembly
        u = shapely.union_all([shapely.Polygon(a.placed(p, p.outline, phi)) for p in a.pieces])
        u = shapely.union_all([shapely.Polygon(g.exterior) for g in shapely.get_parts(u)])
        return u.intersection(outline).area / u.union(outline).area
    return PinnedReport((), (), iou(plan.assembly.phi_target, plan.opened), iou(math.pi, plan.flat), 3.0)
