"""The named changes to single connectors: a width of their own, none at all, back to the usual."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from kirigami_studio.fabricate.options import CutOptions
from kirigami_studio.foundation.words import tr
from kirigami_studio.project.document import Document
from kirigami_studio.project.edits import Edit

#: Widths are kept to this many decimals of a millimetre.
DECIMALS = 4


def set_hinge_width(document: Document, hinges: Collection[int], width_mm: float) -> Edit:
    """Give connectors a finished width of their own; the steps of one drag undo together.

    Removed ones among others stay removed; they come back only where all of these hinges are.

    Parameters
    ----------
    document : Document
    hinges : collection of int
        Numbered as in ``slits.CutTable``.
    width_mm : float

    Raises
    ------
    FabricationError
        The width is not above 0, or a number is negative.
    """
    gone = set(document.fabrication.options.removed)
    hinges = [hinge for hinge in hinges if hinge not in gone] or hinges
    options = _without(document.fabrication.options, hinges)
    widths = dict(options.hinge_mm) | dict.fromkeys(hinges, round(float(width_mm), DECIMALS))
    changed = replace(options, hinge_mm=tuple(sorted(widths.items())))
    numbers = ",".join(str(hinge) for hinge in sorted(hinges))
    return _edit(
        document,
        changed,
        tr("Set {named} to {width_mm:g} mm", named=_named(hinges), width_mm=width_mm),
        f"hinges:{numbers}",
    )


def remove_hinges(document: Document, hinges: Collection[int]) -> Edit:
    """Leave no connector at these hinges."""
    options = _without(document.fabrication.options, hinges)
    changed = replace(options, removed=tuple(sorted({*options.removed, *hinges})))
    return _edit(document, changed, tr("Cut through {named}", named=_named(hinges)))


def reset_hinges(document: Document, hinges: Collection[int]) -> Edit:
    """Give connectors the sheet's usual width again."""
    return _edit(document, _without(document.fabrication.options, hinges), tr("Reset {named}", named=_named(hinges)))


def _without(options: CutOptions, hinges: Collection[int]) -> CutOptions:
    """The options without any choice about these hinges."""
    chosen = set(hinges)
    return replace(
        options,
        hinge_mm=tuple(pair for pair in options.hinge_mm if pair[0] not in chosen),
        removed=tuple(hinge for hinge in options.removed if hinge not in chosen),
    )


def _edit(document: Document, options: CutOptions, label: str, merge_key: str | None = None) -> Edit:
    fabrication = replace(document.fabrication, options=options)
    return Edit(label, replace(document, fabrication=fabrication), merge_key)


def _named(hinges: Collection[int]) -> str:
    return (
        tr("connector {hinges}", hinges=min(hinges))
        if len(hinges) == 1
        else tr("{count} connectors", count=len(hinges))
    )
