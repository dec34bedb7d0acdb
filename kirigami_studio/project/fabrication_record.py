"""Fabrication settings <-> their JSON in a project file."""

from __future__ import annotations

from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions, CutOrder
from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.project.json_record import Record, one_of
from kirigami_studio.project.material_record import material_json, material_of
from kirigami_studio.project.settings import FabricationSettings


def fabrication_json(settings: FabricationSettings) -> dict[str, object]:
    """Return what a project file says about cutting."""
    options = settings.options
    return {
        "width_mm": settings.width_mm,
        "material": settings.material,
        "connector_mm": settings.connector_mm,
        "kerf_mm": settings.kerf_mm,
        "options": {
            "style": options.style.value,
            "order": options.order.value,
            "tabs": options.tabs,
            "tab_mm": options.tab_mm,
            "hinge_mm": [list(pair) for pair in options.hinge_mm],
            "removed": list(options.removed),
        },
        "profile": settings.profile,
        "dxf_version": settings.dxf_version,
        "own": None if settings.own is None else material_json(settings.own),
    }


def fabrication_of(record: Record) -> FabricationSettings:
    """Rebuild the settings.

    Raises
    ------
    KirigamiError
        A field is missing, or holds what no settings can hold.
    """
    options = record.record("options")
    return FabricationSettings(
        width_mm=record.number("width_mm"),
        material=record.text("material"),
        connector_mm=record.number("connector_mm") if record.holds("connector_mm") else None,
        kerf_mm=record.number("kerf_mm") if record.holds("kerf_mm") else None,
        options=CutOptions(
            style=one_of(ConnectorStyle, options.text("style")),
            order=one_of(CutOrder, options.text("order")),
            tabs=options.whole("tabs"),
            tab_mm=options.number("tab_mm"),
            hinge_mm=tuple(_hinge_width(entry) for entry in options.list("hinge_mm")),
            removed=tuple(_hinge(entry) for entry in options.list("removed")),
        ),
        profile=record.text("profile"),
        dxf_version=record.text("dxf_version"),
        own=material_of(record.record("own")) if record.holds("own") else None,
    )


def _hinge(entry: object) -> int:
    if isinstance(entry, bool) or not isinstance(entry, int):
        raise ProjectError(f"{entry!r} is no hinge number")
    return entry


def _hinge_width(entry: object) -> tuple[int, float]:
    if not isinstance(entry, list) or len(entry) != 2:
        raise ProjectError(f"{entry!r} is no hinge with its width")
    hinge, width = entry
    if isinstance(width, bool) or not isinstance(width, (int, float)):
        raise ProjectError(f"{width!r} is no width")
    return _hinge(hinge), float(width)
