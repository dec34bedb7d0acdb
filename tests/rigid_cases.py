"""Forty exports for the rigid reader: every connector style and profile, trims, starts, names, materials and sizes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kirigami_studio.export.profile import PROFILES
from kirigami_studio.project.store import load
from kirigami_studio.settings.fabrication import with_choices
from kirigami_studio.studio.as_cut import AsCut
from kirigami_studio.studio.making import CutRequest, Output, closed, planned, written
from kirigami_studio.studio.verdict import Verdict

DATA = Path(__file__).parent / "data"
#: Designs of ``design SHAPE --k 1``, see the note beside them, and one that failed before.
DESIGNS = DATA / "cut_designs"
STAR = DATA / "making" / "star_trim4.kiri"

Options = dict[str, Any]
#: Foil is made of tiles on a hinge layer unless asked for.
ONE_SHEET: Options = {"construction": "one-sheet"}
#: Project, and the options that it is exported with.
CASES: tuple[tuple[str, Options], ...] = (
    ("heart", {}),
    ("heart", {"style": "straight"}),
    ("heart", {"style": "round", "material": "pet-co2"}),
    ("heart", {"style": "teardrop", "material": "pet-co2", "profile": "lightburn"}),
    ("heart", {"style": "arc", "connector_mm": 0.3}),
    ("heart", {"style": "double", "connector_mm": 0.3, "profile": "layers"}),
    ("heart", {"profile": "slots"}),
    ("heart", {"profile": "k40", "connector_mm": 0.5, "engrave": True}),
    ("heart", {"connector_mm": 1.0, "kerf_mm": 0.1, "width_mm": 150.0}),
    ("heart", {"style": "straight", "connector_mm": 0.5, "profile": "single"}),
    ("hexagon", {"profile": "layers"}),
    ("hexagon", {"style": "straight", "profile": "slots"}),
    ("hexagon", {"style": "straight", "connector_mm": 1.0, "width_mm": 200.0, "material": "pet-co2"}),
    ("hexagon", {"style": "arc", "material": "card-05-co2", "width_mm": 250.0}),
    (
        "hexagon",
        {"material": "foil-uv", "construction": "one-sheet", "width_mm": 60.0, "profile": "glowforge", "engrave": True},
    ),
    ("hexagon", {"copies": 2, "connector_mm": 0.5, "dxf_version": "R12"}),
    ("house", {"profile": "cricut", "connector_mm": 0.3}),
    ("house", {"style": "straight", "connector_mm": 0.3, "profile": "silhouette"}),
    ("house", {"style": "teardrop", "kerf_mm": 0.0, "width_mm": 120.0}),
    ("house", {"style": "double", "connector_mm": 0.4, "width_mm": 150.0}),
    ("house", {"material": "paper-hand", "width_mm": 180.0}),
    ("letter-l", {"profile": "xtool", "engrave": True}),
    ("letter-l", {"style": "straight", "width_mm": 80.0, "kerf_mm": 0.0}),
    ("letter-l", {"style": "round", "material": "polypropylene-co2", "width_mm": 200.0}),
    ("letter-l", {"material": "card-co2", "connector_mm": 1.0, "width_mm": 200.0, "profile": "slots"}),
    ("circle", {"connector_mm": 0.8, "profile": "lightburn", "engrave": True}),
    ("circle", {"style": "straight", "connector_mm": 0.2, "order": "rows"}),
    ("disk", {}),
    ("disk", {"style": "straight", "profile": "slots", "connector_mm": 0.3}),
    ("disk", {"style": "round", "material": "pet-co2", "profile": "k40", "width_mm": 140.0}),
    ("hexagon_of_hexagon", {"connector_mm": 0.5, "profile": "single"}),
    ("hexagon_of_hexagon", {"style": "arc", "connector_mm": 0.2, "width_mm": 120.0}),
    ("star_trim", {}),
    ("star_trim", {"style": "straight", "profile": "lightburn"}),
    ("star_trim", {"profile": "slots", "connector_mm": 0.3}),
    ("heart_trim", {"connector_mm": 0.5, "engrave": True, "profile": "k40"}),
    ("heart_trim", {"style": "teardrop", "material": "pet-co2", "width_mm": 150.0}),
    ("butterfly_trim", {"profile": "layers", "dxf_version": "R12"}),
    ("butterfly_trim", {"style": "straight", "connector_mm": 0.4}),
    ("star_trim4", {"profile": "slots"}),
)


@dataclass(frozen=True)
class Exported:
    """A file and the verdict of its export.

    Attributes
    ----------
    path : Path
    verdict : Verdict
    as_cut : AsCut or None
    kerf_mm, connector_mm, narrowest_mm : float
    copies : int
    slots : bool
    panels, connectors : int
        That are there by the plan.
    """

    path: Path
    verdict: Verdict
    as_cut: AsCut | None
    kerf_mm: float
    connector_mm: float
    narrowest_mm: float
    copies: int
    slots: bool
    panels: int
    connectors: int


def exported(number: int, folder: Path) -> Exported:
    """Export a case as the command line does."""
    name, options = CASES[number]
    document = load(STAR if name == "star_trim4" else DESIGNS / f"{name}.kiri")
    request = CutRequest.of(document, with_choices(document.fabrication, options))
    made = planned(request)
    as_cut = closed(request, made)
    settings = request.settings
    layered = PROFILES[settings.profile].file_per_layer
    path = folder / "cut.dxf"
    found = written(request, made, Output(path), as_cut)
    assert found.verdict is not None
    plan = made.plan
    return Exported(
        path.with_suffix("") if layered else path,
        found.verdict,
        as_cut if isinstance(as_cut, AsCut) else None,
        plan.kerf_mm,
        float(plan.hinges.asked_mm.max()),
        float(plan.hinges.finished_mm[plan.hinges.finished_mm > 0.0].min()),
        len(plan.copies),
        PROFILES[settings.profile].slots,
        sum(len(panel) > 0 for panel in plan.panels),
        int((plan.hinges.finished_mm > 0.0).sum()),
    )
