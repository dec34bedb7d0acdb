"""``artwork``: print a picture on the sheet, or the pieces, of a project."""

from __future__ import annotations

import argparse
import math
from dataclasses import replace
from importlib import import_module
from typing import Any

from kirigami_studio.cli.console import print_json, say
from kirigami_studio.cli.fabrication import overridden
from kirigami_studio.export.artwork import ArtPicture, Artwork, Laid, PictureFit, SheetState
from kirigami_studio.export.artwork_files import ArtworkJob, write_artwork
from kirigami_studio.export.artwork_picture import read_picture
from kirigami_studio.export.paper import page_notes
from kirigami_studio.foundation.errors import ExportError, UsageError
from kirigami_studio.foundation.words import tr
from kirigami_studio.project.document import Document
from kirigami_studio.project.store import load_all, save
from kirigami_studio.studio.making import CutRequest, printed_parts

#: Below this resolution (dpi) a print looks coarse at arm's length.
COARSE_DPI = 150.0
#: A picture that leaves more than this share of the sheet bare is told.
BARE_SHARE = 0.005


def artwork(arguments: argparse.Namespace) -> int:
    """Write the printed sheet, or pieces, of a project's chosen design, and how it opens."""
    opened = load_all(arguments.project)
    document = opened.document
    request = CutRequest.of(document, overridden(document.fabrication, arguments))
    printed = _artwork(arguments, document)
    if arguments.keep:
        document = replace(document, artwork=printed)
        save(document, arguments.project, opened.picture)
        request = CutRequest.of(document, request.settings)
    job, beds = printed_parts(request)
    try:
        works = [ArtworkJob(printed, job, arguments.dpi, arguments.bleed_mm, arguments.margin_mm, bed) for bed in beds]
        files = list(dict.fromkeys(path for work in works for path in write_artwork(work, arguments.out)))
    except ExportError as error:
        if error.code.startswith("artwork.impossible"):
            raise UsageError(error.code, **error.fields) from error
        raise
    work = works[0]
    warnings = list(dict.fromkeys(warning for work in works for warning in _warnings(work)))
    if arguments.json:
        print_json(
            {
                "files": [str(path) for path in files],
                "frame_mm": work.frame_mm,
                "page_mm": work.page_mm,
                "pages": 1 if work.tiling is None else len(work.tiling.tiles),
                "pixels": work.page.pixels,
                "dpi": work.dpi,
                "bleed_mm": work.bleed_mm,
                "margin_mm": work.margin_mm,
                "on": printed.first.state.value,
                **({} if printed.second is None else {"stripes": printed.stripes}),
                "picture_dpi": work.picture_dpi,
                "covered": work.covered,
                "copies": len(work.places),
                **({} if work.bed is None else {"beds": [_bed_json(one) for one in works]}),
                "lines": sum(len(laid.picture.lines) for laid in printed.laid),
                "warnings": warnings,
            }
        )
        return 0
    say(
        tr(
            "{files}: page {width:.2f} x {height:.2f} mm, cut file {frame_width:.2f} x {frame_height:.2f} mm with its "
            "lower left corner {margin:g} mm from the page's, the picture has {dpi:.0f} dpi",
            files=", ".join(str(path) for path in files),
            width=work.page_mm[0],
            height=work.page_mm[1],
            frame_width=work.frame_mm[0],
            frame_height=work.frame_mm[1],
            margin=work.margin_mm,
            dpi=work.picture_dpi,
        )
    )
    for warning in warnings:
        say("  " + tr("note: {text}", text=warning))
    return 0


def _bed_json(work: ArtworkJob) -> dict[str, object]:
    """Names and sizes of the print of a bed."""
    return {
        "files": [f"{work.stem}{end}" for end in (".svg", ".pdf", ".png")],
        "frame_mm": work.frame_mm,
        "page_mm": work.page_mm,
        "pages": 1 if work.tiling is None else len(work.tiling.tiles),
        "pixels": work.page.pixels,
    }


def _artwork(arguments: argparse.Namespace, document: Document) -> Artwork:
    """The pictures that were named, and how they lie; what was not named is the project's."""
    try:
        found = Artwork(_laid(arguments, document))
        if arguments.picture is None and document.artwork is not None:
            found = replace(document.artwork, first=found.first)
        if arguments.second is not None:
            found = replace(found, second=_picture(arguments.second))
        return found if arguments.stripes is None else replace(found, stripes=arguments.stripes)
    except ExportError as error:
        raise UsageError(error.code, **error.fields) from error


def _laid(arguments: argparse.Namespace, document: Document) -> Laid:
    """The first picture, and where it lies."""
    stored = None if document.artwork is None else document.artwork.first
    changes: dict[str, Any] = {}
    if arguments.on is not None:
        changes["state"] = SheetState(arguments.on)
    if arguments.place is not None:
        changes["fitting"] = PictureFit(arguments.place)
    if arguments.scale is not None:
        changes["scale"] = arguments.scale
    if arguments.turn_deg is not None:
        changes["turn"] = math.radians(arguments.turn_deg)
    if arguments.shift is not None:
        changes["shift"] = (arguments.shift[0], arguments.shift[1])
    if arguments.picture is not None:
        picture = _picture(arguments.picture)
        stored = Laid(picture) if stored is None else replace(stored, picture=picture)
    if stored is None:
        raise UsageError("artwork.name_a_picture")
    return replace(stored, **changes)


def _picture(path: str) -> ArtPicture:
    """Read a picture; only for an SVG Qt is loaded, which draws it."""

    def draw(content: bytes, side: int) -> bytes:
        drawn: bytes = import_module("kirigami_studio.gui.stage.artwork_painting").svg_to_png(content, side)
        return drawn

    return read_picture(path, draw)


def _warnings(work: ArtworkJob) -> list[str]:
    copies = work.job.required_plan.copies.notes if work.bed is None else ()
    notes = (*copies, *page_notes(work.page_mm, work.job.paper))
    found = [note.text for note in notes]
    if work.picture_dpi < COARSE_DPI:
        found.append(
            tr("The picture has only {dpi:.0f} dpi on the sheet: use one with more pixels.", dpi=work.picture_dpi)
        )
    if work.covered < 1.0 - BARE_SHARE:
        found.append(
            tr(
                "{percent:.0f} % of the sheet gets no picture. Use --place fill or a larger --scale to cover it.",
                percent=100.0 * (1.0 - work.covered),
            )
        )
    return found
