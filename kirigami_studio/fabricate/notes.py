"""Sentences that a person should read before cutting."""

from __future__ import annotations

from collections import Counter

import numpy as np

from kirigami_studio.fabricate.connectors import Hinges
from kirigami_studio.fabricate.material import Material
from kirigami_studio.fabricate.options import ConnectorStyle

#: A connector counts as wider than asked above this difference (mm).
WIDER_MM = 1e-3


def plan_notes(
    hinges: Hinges,
    material: Material,
    connector_mm: float,
    kerf_mm: float,
    style: ConnectorStyle,
    straight: Counter[str],
) -> tuple[str, ...]:
    """Say what is worth knowing about a plan.

    Parameters
    ----------
    hinges : Hinges
    material : Material
    connector_mm, kerf_mm : float
        Finished width asked for, and full cut width.
    style : ConnectorStyle
    straight : Counter of str
        How many hinges stayed straight against the wish, by reason.
    """
    notes = []
    if not material.calibrated:
        notes.append(f"The preset {material.name!r} is uncalibrated: cut a test piece first.")
    narrowest = float(hinges.requested_mm[~hinges.removed].min(initial=np.inf))
    if narrowest < material.min_ligament_mm:
        notes.append(
            f"Connectors of {narrowest:g} mm are below the {material.min_ligament_mm:g} mm that {material.name!r} "
            f"is known to bear; they may tear."
        )
    if straight:
        why = " and ".join(f"{count} because {reason}" for reason, count in sorted(straight.items()))
        notes.append(
            f"{straight.total()} of {len(hinges)} slit ends are straight instead of {style.value}: {why}; a larger "
            f"sheet, narrower connectors or a calmer design make room."
        )
    notes += _wider(hinges)
    if connector_mm + kerf_mm < 2.0 * material.join_tolerance_mm:
        notes.append(
            f"Cut ends lie {connector_mm + kerf_mm:.3f} mm apart: programs that join gaps up to "
            f"{material.join_tolerance_mm:g} mm may close them; switch joining off when importing."
        )
    return tuple(notes)


def _wider(hinges: Hinges) -> list[str]:
    more = np.where(hinges.removed, 0.0, hinges.finished_mm - hinges.requested_mm)
    wider = more > WIDER_MM
    if not np.any(wider):
        return []
    worst = int(np.argmax(more))
    x, y = hinges.position[worst]
    return [
        f"{int(wider.sum())} of {len(hinges)} connectors come out wider than asked, because the slit they rest on "
        f"ends before them (widest {hinges.finished_mm[wider].max():.3f} mm near x = {x:.1f}, "
        f"y = {y:.1f} mm); a larger sheet or narrower connectors avoid it."
    ]
