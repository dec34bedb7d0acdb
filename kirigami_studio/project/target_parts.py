"""The parts of a target of several pieces: each has its sheets, all to one scale.

One part is shown and edited; the others wait beside it with their designs.  What holds for all is asked for once: the
settings of the shown part are those of every other, but for its grid, its size and its single connectors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Document
from kirigami_studio.project.edits import Edit, as_drawn, without_designs
from kirigami_studio.project.sheet_size import size_of, sized

#: Parts are alike where less than this share of their area, and of their size, differs.
ALIKE = 1e-6

#: A target and its place in the drawing of all, see :attr:`Document.place`.
PlacedTarget = tuple[Outline, tuple[float, float] | None]


def set_parts(document: Document, pieces: Sequence[PlacedTarget]) -> Edit:
    """Take several targets beside each other in the place of the present one.

    They have the size that they were drawn with, if that is one in mm; else the largest is as large as its sheet makes
    it, and the others are to that scale.
    """
    largest = max((outline for outline, _ in pieces), key=_drawn)
    changed = with_parts(as_drawn(document, largest), pieces)
    label = tr_n("Set a target of {count} part", "Set a target of {count} parts", len(pieces))
    return Edit(label, showing(changed, 0))


def with_parts(document: Document, pieces: Sequence[PlacedTarget]) -> Document:
    """The document with targets beside each other, sized by the largest, which is shown.

    It opens to the size that was asked for, else to the one that its sheet is expected to give it.
    """
    first = max(range(len(pieces)), key=lambda number: _drawn(pieces[number][0]))
    empty = replace(without_designs(document, None), other_parts=(), part=0, runs=0)
    parts = [replace(empty, target=outline, place=place) for outline, place in pieces]
    others = tuple(part for number, part in enumerate(parts) if number != first)
    found = replace(parts[first], other_parts=others, part=first)
    size = size_of(found)
    assert size is not None  # it has a target
    cut = found.fabrication
    return sized(replace(found, fabrication=replace(cut, opened_mm=cut.opened_mm or max(size.opened))))


def show_part(document: Document, number: int) -> Edit:
    """Show another part of the target, with its designs.

    Raises
    ------
    ProjectError
        There is no such part.
    """
    changed = showing(document, number)
    target = changed.target
    return Edit(tr("Show part {name}", name="" if target is None else target.name), changed)


def showing(document: Document, number: int) -> Document:
    """The document with another part shown.

    Raises
    ------
    ProjectError
        There is no such part.
    """
    if not 0 <= number <= len(document.other_parts):
        raise ProjectError("project.no_such_part", number=number, parts=len(document.parts), limit=len(document.parts))
    if number == document.part:
        return document
    shown, kept = parts_as_cut(document)[number], document.parts
    return replace(shown, other_parts=(*kept[:number], *kept[number + 1 :]), part=number)


def showing_target(document: Document, target: Outline) -> Document:
    """The document with the part shown that has a target; as it is where none has it."""
    if document.target == target:
        return document
    found = [number for number, part in enumerate(document.parts) if part.target == target]
    return showing(document, found[0]) if found else document


def with_part(document: Document, number: int, part: Document) -> Document:
    """The document with one part as it is in another one; the same part is shown as before."""
    if number == document.part:
        return replace(part, other_parts=document.other_parts, part=number)
    others = list(document.other_parts)
    others[number - (number > document.part)] = replace(part, other_parts=(), part=0)
    return replace(document, other_parts=tuple(others))


def kept_to_scale(before: Document, after: Document) -> Document:
    """The document after an edit, its other parts to the scale of the shown one.

    A target that is drawn on the board, or given a size, has that size in mm from then on, so the sizes of the others
    are of another unit.  Where the same shape has another size, the whole has; a new shape leaves the others as large
    as they were.
    """
    target, old = after.target, before.target
    same_parts = after.part == before.part and after.other_parts is before.other_parts
    if not after.other_parts or not same_parts or target is old or target is None or old is None:
        return after
    was, now = scale_of(before), scale_of(after)
    opened = now * _drawn(target) / (was * _drawn(old)) if target == old else 1.0
    factor = opened * was / now
    others = tuple(_resized(part, factor, target.unit) for part in after.other_parts)
    return replace(after, other_parts=others, place=_scaled(after.place, factor))


def _resized(part: Document, factor: float, unit: str) -> Document:
    """A part whose target has another size, in another unit."""
    target = part.target
    if target is None or target.size is None:
        return part
    width, height = target.size
    sized_target = replace(target, size=(factor * width, factor * height), unit=unit)
    return replace(part, target=sized_target, place=_scaled(part.place, factor))


def _scaled(place: tuple[float, float] | None, factor: float) -> tuple[float, float] | None:
    return None if place is None else (factor * place[0], factor * place[1])


def parts_as_cut(document: Document) -> tuple[Document, ...]:
    """Every part as a project of its own, with the settings of now, all to one scale."""
    scale = scale_of(document)
    return tuple(
        part if number == document.part else _to_scale(part, document, scale)
        for number, part in enumerate(document.parts)
    )


def twins(parts: Sequence[Document]) -> tuple[int, ...]:
    """Numbers of the first part of each one's shape and size: one design serves all of them."""
    return tuple(
        next(other for other in range(number + 1) if _alike(parts[other].target, part.target))
        for number, part in enumerate(parts)
    )


def for_twin(designed: Document, twin: Document) -> Document:
    """The designs of a part as those of another one of its shape and size."""
    return replace(designed, target=twin.target, place=twin.place, other_parts=(), part=0)


def with_twins(document: Document, number: int) -> Document:
    """The document with designs of a part also in others of its shape and size without any."""
    designed, same = document.parts[number], twins(parts_as_cut(document))
    for other, part in enumerate(document.parts):
        if same[other] == same[number] and not part.candidates:
            document = with_part(document, other, for_twin(designed, part))
    return document


def _alike(one: Outline | None, other: Outline | None) -> bool:
    if one is None or other is None or one is other:
        return one is other
    if abs(_drawn(one) - _drawn(other)) > ALIKE * _drawn(one) or len(one.holes) != len(other.holes):
        return False
    return float(one.polygon.symmetric_difference(other.polygon).area) < ALIKE


def scale_of(document: Document) -> float:
    """Millimetres of the opened sheet for one unit of the drawing; 0 without a target."""
    size = size_of(document)
    return 0.0 if size is None or document.target is None else max(size.opened) / _drawn(document.target)


def _to_scale(part: Document, shown: Document, scale: float) -> Document:
    """A part as it is designed and cut beside the one that is shown."""
    assert part.target is not None  # documents refuse parts without
    settings, cut, own = shown.settings, shown.fabrication, part.fabrication.options
    if settings.auto_grid or part.candidates:
        settings = replace(settings, grid=part.settings.grid)
    options = replace(cut.options, hinge_mm=own.hinge_mm, removed=own.removed)
    cut = replace(cut, options=options, opened_mm=scale * _drawn(part.target))
    return sized(replace(part, settings=settings, fabrication=cut, guides=shown.guides))


def _drawn(target: Outline) -> float:
    """Longer side of a target in the unit of its drawing."""
    return float(np.ptp(target.points, axis=0).max()) if target.size is None else max(target.size)
