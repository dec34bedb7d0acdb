"""The numbers of a document that a person sets: for the search, and for the cutter."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

from kirigami_studio.evaluate.second_target import SecondTarget
from kirigami_studio.export.paper import NO_PAPER
from kirigami_studio.export.profile import find_profile
from kirigami_studio.fabricate.material import DEFAULT_PRESET, Material, find_material, library
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions, CutOrder
from kirigami_studio.foundation.errors import AngleError, ExportError, FabricationError, GridError, UsageError
from kirigami_studio.lattice.ratio_field import check_grid
from kirigami_studio.outlines.starts import RECTANGLE, StartShape

LARGEST_SHEET_MM = 10_000.0


@dataclass(frozen=True, slots=True)
class DesignSettings:
    """How candidates are searched for.

    Attributes
    ----------
    grid : (rows, columns) voids, 2..64 each
        Where ``auto_grid`` is set, the last one that was chosen.
    phi : float, radians, in [0, pi)
        Angle at which the sheet should show the target.
    k : int, >= 1
        Number of candidates.
    seed : int, >= 0
    variant : str
        Name of the generator variant.
    steps : int, >= 1
        Evaluations of the network for each sample: Euler steps of the flow, then corrections.
    polish : int, >= 0
        Steps of the fit on the exact geometry; 0 leaves candidates as sampled.
    prefer : str
        What the fit prefers, from "accuracy" to "calm".
    search : int, >= 0
        Effort of a search beyond the samples; 0 does without.
    auto_grid : bool
        Whether every run chooses its grid itself.
    symmetry : str
        What designs have to keep: "auto", "none", "mirror" or "turn".
    rim : str
        "free" or "even".
    regular : float, 0..1
        What ranking prefers, from the best match (0) to even panels (1).
    start : StartShape
        What sheets look like while they are flat.
    second : SecondTarget or None
        What they should also show on their way to ``phi``.

    Raises
    ------
    GridError, AngleError, UsageError
        With the number that does not fit.
    """

    grid: tuple[int, int] = (10, 10)
    phi: float = 0.0
    k: int = 32
    seed: int = 0
    variant: str = "balanced"
    steps: int = 4
    polish: int = 15
    prefer: str = "balanced"
    search: int = 0
    auto_grid: bool = True
    symmetry: str = "auto"
    rim: str = "free"
    regular: float = 0.5
    start: StartShape = RECTANGLE
    second: SecondTarget | None = None

    def __post_init__(self) -> None:
        grid = tuple(self.grid)
        if len(grid) != 2 or not all(_is_whole(count) for count in grid):
            raise GridError("settings.grid_not_two_numbers", value=self.grid)
        check_grid(*grid)
        object.__setattr__(self, "grid", grid)
        if not _is_number(self.phi) or not 0.0 <= self.phi < math.pi:
            raise AngleError("request.angle_out_of_range", phi=self.phi)
        for code, value, least, most in (
            ("request.k_out_of_range", self.k, 1, 1024),
            ("request.seed_out_of_range", self.seed, 0, 2**63 - 1),
            ("request.steps_out_of_range", self.steps, 1, 64),
            ("request.polish_out_of_range", self.polish, 0, 200),
            ("request.search_out_of_range", self.search, 0, 8),
        ):
            if not _is_whole(value) or value < least:
                raise UsageError(code, value=value, least=least, most=most)
        _check_name("settings.variant_not_a_name", self.variant)
        _check_name("settings.preference_not_a_name", self.prefer)
        _check_name("settings.symmetry_not_a_name", self.symmetry)
        _check_name("settings.rim_not_a_name", self.rim)
        if not _is_number(self.regular) or not 0.0 <= self.regular <= 1.0:
            raise UsageError("request.regular_out_of_range", regular=self.regular)


@dataclass(frozen=True, slots=True)
class FabricationSettings:
    """How the chosen design is cut.

    Attributes
    ----------
    width_mm : float, > 0
        Width of the flat sheet.
    material : str
        Key of a material preset.
    connector_mm : float or None
        Finished width of a connector; None takes the material's own.
    kerf_mm : float or None
        Width of the cut; None takes the material's own.
    options : CutOptions
        Centred connectors unless chosen otherwise.
    profile : str
        Key of the machine profile that cut files are written for.
    dxf_version : str
        DXF dialect of cut files.
    paper : str
        Key of the paper that PDFs are spread over; "none" for one page as large as the sheet.
    markers : bool
        Whether LightBurn projects mark the connectors, on a layer that LightBurn does not cut.
    engrave : bool
        Whether the design's name is engraved on the sheet.
    opened_mm : float or None
        Longer side of the opened shape, which ``width_mm`` follows; None where the width itself was asked for.
    own : Material or None
        The numbers of ``material`` where that is a person's own and no preset.  Not a choice, so it takes no part in
        comparisons.

    Raises
    ------
    UsageError
        With the number that does not fit.
    """

    width_mm: float = 100.0
    material: str = DEFAULT_PRESET
    connector_mm: float | None = None
    kerf_mm: float | None = None
    options: CutOptions = field(default_factory=partial(CutOptions, style=ConnectorStyle.CENTRED))
    profile: str = "any"
    dxf_version: str = "R2010"
    paper: str = NO_PAPER
    markers: bool = False
    engrave: bool = False
    opened_mm: float | None = None
    own: Material | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        if not _is_number(self.width_mm) or not 0 < self.width_mm <= LARGEST_SHEET_MM:
            raise UsageError("settings.sheet_width", value=self.width_mm, largest_mm=LARGEST_SHEET_MM)
        _check_name("settings.material_not_a_name", self.material)
        _check_name("settings.profile_not_a_name", self.profile)
        _check_name("settings.dxf_version_not_a_name", self.dxf_version)
        _check_name("settings.paper_not_a_name", self.paper)
        if not isinstance(self.markers, bool):
            raise UsageError("settings.markers_not_true_or_false", value=self.markers)
        if not isinstance(self.engrave, bool):
            raise UsageError("settings.engrave_not_true_or_false", value=self.engrave)
        for code, value, zero_allowed in (
            ("settings.opened_size", self.opened_mm, False),
            ("settings.connector_width", self.connector_mm, False),
            ("settings.kerf_width", self.kerf_mm, True),
        ):
            if value is None:
                continue
            if not _is_number(value) or value < 0 or (value == 0 and not zero_allowed) or value > LARGEST_SHEET_MM:
                raise UsageError(code, value=value, largest_mm=LARGEST_SHEET_MM)


def stored_material(settings: FabricationSettings) -> Material | None:
    """The numbers of the settings' material as the project stores them; None for bundled materials."""
    return settings.own if settings.own is not None and settings.own.key == settings.material else None


def material_for(settings: FabricationSettings) -> Material:
    """The material that the settings name: from the library, else as it is stored in the project.

    Raises
    ------
    FabricationError
        Neither has it; the sentence lists the library.
    """
    stored = stored_material(settings)
    if stored is not None and stored.key not in library().materials:
        return stored
    return find_material(settings.material)


#: What :func:`with_choices` takes over as it is: for the sheet and its files, and for its cuts.
SHEET_CHOICES = ("width_mm", "connector_mm", "kerf_mm", "dxf_version", "paper", "engrave", "markers")
CUT_CHOICES = ("tabs", "tab_mm", "copies", "copy_gap_mm")


def with_choices(saved: FabricationSettings, given: Mapping[str, Any]) -> FabricationSettings:
    """The settings of a project with what the command line or a script asks for on top.

    Parameters
    ----------
    saved : FabricationSettings
    given : mapping of str to object
        ``material``, ``profile``, ``style`` and ``order`` by their names; widths of single connectors, ``hinge_mm``
        (pairs of number and width), and those to be ``removed`` are added to the project's own; :data:`SHEET_CHOICES`
        and :data:`CUT_CHOICES`.  Others are left alone.

    Raises
    ------
    UsageError
        What no settings can hold.
    FabricationError
        No such material; the sentence lists the library.
    """
    changes: dict[str, Any] = {name: given[name] for name in SHEET_CHOICES if name in given}
    if "material" in given:
        changes["material"] = find_material(given["material"]).key
    try:
        if "profile" in given:
            changes["profile"] = find_profile(given["profile"]).key
        return replace(saved, **changes, options=_cut_options(saved.options, given))
    except (FabricationError, ExportError) as error:
        raise UsageError(error.code, **error.fields) from error


def _cut_options(saved: CutOptions, given: Mapping[str, Any]) -> CutOptions:
    """The project's choices about the cuts with others on top."""
    changes: dict[str, Any] = {name: given[name] for name in CUT_CHOICES if name in given}
    for name, kind in (("style", ConnectorStyle), ("order", CutOrder)):
        if name in given:
            try:
                changes[name] = kind(given[name])
            except ValueError:
                choices = ", ".join(str(one.value) for one in kind)
                raise UsageError(
                    "settings.no_such_choice", name=name, value=repr(given[name]), choices=choices
                ) from None
    widths = sorted(given.get("hinge_mm", ()))
    removed = sorted(given.get("removed", ()))
    CutOptions(hinge_mm=tuple(widths), removed=tuple(removed))  # refuses what contradicts itself
    named = {hinge for hinge, _ in widths} | set(removed)
    return replace(
        saved,
        **changes,
        hinge_mm=tuple(sorted([*(pair for pair in saved.hinge_mm if pair[0] not in named), *widths])),
        removed=tuple(sorted([*(hinge for hinge in saved.removed if hinge not in named), *removed])),
    )


def _check_name(code: str, value: object) -> None:
    if not isinstance(value, str) or not value:
        raise UsageError(code, value=value)


def _is_whole(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
