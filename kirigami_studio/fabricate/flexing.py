"""How far connectors turn and how much that strains them.

Panels turn by +a and -a with ``2 a = pi - phi``, neighbours in opposite senses, and every connector joins two
neighbours: all connectors of a sheet turn by ``pi - phi`` between the flat sheet and the angle phi.  The estimate takes
the connector for a strip that bends evenly over its flexure length about its softer axis, so that its outer fibre is
strained by ``turn * min(thickness, width) / (2 * length)``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.findings import Problem, Severity
from kirigami_studio.fabricate.options import ConnectorStyle
from kirigami_studio.foundation.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Flexing:
    """What the connectors go through.

    Attributes
    ----------
    turn : float, radians
        By which every connector turns.
    strain : float
        Estimate for the connector that is strained most.
    where : (x, y), mm
        That connector.
    flexure_mm, softer_mm : float
        Length over which it bends, and the smaller of its width and its thickness.
    """

    turn: float
    strain: float
    where: tuple[float, float]
    flexure_mm: float
    softer_mm: float


def hinge_turn(phi: float) -> float:
    """Angle (radians) by which every connector turns between the flat sheet and ``phi``."""
    return math.pi - phi


def hinge_strains(plan: CutPlan, phi: float) -> FloatArray:
    """Estimated strain of every connector (H,) at an angle (radians); 0 for removed ones."""
    hinges = plan.hinges
    softer = np.minimum(hinges.finished_mm, plan.material.thickness_mm)
    strain: FloatArray = np.where(
        hinges.removed, 0.0, hinge_turn(phi) * np.maximum(softer, 0.0) / (2.0 * _lengths(plan))
    )
    return strain


def flexing(plan: CutPlan, phi: float) -> Flexing | None:
    """Estimate what opening the sheet to an angle (radians) does to its connectors; None for a sheet without any."""
    if np.all(plan.hinges.removed):
        return None
    strains = hinge_strains(plan, phi)
    worst = int(np.argmax(strains))
    x, y = plan.hinges.position[worst]
    softer = min(float(plan.hinges.finished_mm[worst]), plan.material.thickness_mm)
    return Flexing(hinge_turn(phi), float(strains[worst]), (float(x), float(y)), float(_lengths(plan)[worst]), softer)


def strain_problems(plan: CutPlan, found: Flexing, strain_limit: float) -> list[Problem]:
    """Warn when the estimate is above what the material bears (breaking strain, 0.05 for 5 %)."""
    if found.strain <= strain_limit:
        return []
    x, y = found.where
    return [
        Problem(
            f"Opened to the target angle, every connector turns by {math.degrees(found.turn):.0f} degrees. If the one "
            f"at x = {x:.2f}, y = {y:.2f} mm bends evenly over {found.flexure_mm:.3f} mm about its softer side of "
            f"{found.softer_mm:g} mm (the assumption of this estimate), it is strained by about "
            f"{100.0 * found.strain:.0f} %; {plan.material.name!r} is taken to break at {100.0 * strain_limit:g} %. "
            f"{_advice(plan)}, thinner material or a target angle nearer to flat.",
            Severity.WARNING,
            found.where,
        )
    ]


def _lengths(plan: CutPlan) -> FloatArray:
    lengths: FloatArray = np.maximum(plan.hinges.flexure_mm, 1e-9)
    return lengths


def _advice(plan: CutPlan) -> str:
    """What to try first: another style, or room for the ends that this style could not be made at."""
    if plan.options.style in (ConnectorStyle.ARC, ConnectorStyle.DOUBLE):
        return "Choose a larger sheet, so that every slit end has room for its style"
    return "Choose arc or double connectors"
