"""``decode``, ``porosity``, ``score`` and ``siou``: one stage each, on any number of inputs."""

from __future__ import annotations

import argparse
import csv
import io
import json
import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from kirigami_studio.cli.console import plain, print_json, say
from kirigami_studio.cli.inputs import (
    Named,
    are_many_targets,
    for_each,
    is_batch,
    part_choice,
    read_mask,
    read_sheets,
    read_targets,
    warn,
)
from kirigami_studio.cli.option_types import parse_grid
from kirigami_studio.evaluate.feasibility import invalid_quads, overlap_ratio, path_contact
from kirigami_studio.evaluate.mask_siou import mask_siou
from kirigami_studio.evaluate.porosity import Porosity
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.foundation.errors import AngleError, RatioError, UsageError
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.foundation.words import tr
from kirigami_studio.lattice.deployment import check_phi, deploy
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline


def decode(arguments: argparse.Namespace) -> int:
    """Print the exact layout of each sheet."""
    phi = check_phi(arguments.phi)
    batch = is_batch(arguments.sheets)

    def one(name: str, sheet: Sheet) -> None:
        if (grid := arguments.grid) is not None and parse_grid(grid) != sheet.grid:
            raise RatioError("decode.other_grid", name=name, rows=sheet.rows, columns=sheet.columns, grid=grid)
        answer = decoded(sheet, phi)
        _deliver(arguments, {"source": name} | answer if batch else answer, name, batch, "layout")
        if not arguments.json and not batch:
            say(
                tr(
                    "{rows} x {columns} voids at {angle:.1f} degrees: area {area:.4f} unit cells, {invalid} invalid, "
                    "overlap {overlap:.4f}",
                    rows=sheet.rows,
                    columns=sheet.columns,
                    angle=math.degrees(phi),
                    area=answer["area"],
                    invalid=answer["n_invalid"],
                    overlap=answer["overlap_ratio"],
                )
            )

    return for_each(read_sheets(arguments.sheets), batch, one, as_json=arguments.json)


def decoded(sheet: Sheet, phi: float) -> dict[str, object]:
    """The JSON answer of ``decode`` for one sheet at ``phi`` radians, in unit cells."""
    deployment = deploy(sheet)
    contact = path_contact(deployment, phi)
    return {
        "phi": phi,
        "grid": list(sheet.grid),
        "void_corners": deployment.voids(phi),
        "panels": deployment.panels(phi).reshape(-1, 4, 2),
        "panels_flat": deployment.panels(math.pi).reshape(-1, 4, 2),
        "outline": deployment.outline(phi),
        "area": deployment.area(phi),
        "n_invalid": invalid_quads(deployment, phi),
        "overlap_ratio": overlap_ratio(deployment, phi),
        "contact": None if contact is None else contact.to_json(),
    }


def porosity(arguments: argparse.Namespace) -> int:
    """Print area and porosity of each sheet at even angles, and the angles of one porosity."""
    batch = is_batch(arguments.sheets)
    degrees = [float(value) for value in np.linspace(180.0, 0.0, arguments.angles)]

    def one(name: str, sheet: Sheet) -> None:
        answer = areas(sheet, degrees, arguments.width_mm, arguments.find)
        if arguments.out is not None and Path(arguments.out).suffix.lower() == ".csv" and not batch:
            write_atomically(Path(arguments.out), _csv(answer).encode())
            if arguments.json:
                print_json(answer)
        else:
            _deliver(arguments, {"source": name} | answer if batch else answer, name, batch, "porosity")
        if not arguments.json and not batch:
            _say_areas(answer)

    return for_each(read_sheets(arguments.sheets), batch, one, as_json=arguments.json)


def areas(sheet: Sheet, degrees: list[float], width_mm: float | None, wanted: float | None) -> dict[str, object]:
    """The JSON answer of ``porosity`` for one sheet: square mm with its width, else unit cells.

    Raises
    ------
    SheetError
        It is never so open as ``wanted``.
    """
    deployment = deploy(sheet)
    figures = Porosity.of(deployment)
    cell = 1.0 if width_mm is None else width_mm / float(np.ptp(deployment.compact[:, 0]))
    angles = [math.radians(value) for value in degrees]
    answer: dict[str, object] = {
        "unit": "unit cells^2" if width_mm is None else "mm^2",
        "panel_area": figures.panels * cell**2,
        "phi_deg": degrees,
        "area": [figures.area(phi) * cell**2 for phi in angles],
        "void_area": [figures.voids(phi) * cell**2 for phi in angles],
        "porosity": [figures.at(phi) for phi in angles],
        "largest_porosity": figures.largest,
    }
    if wanted is not None:
        answer["found"] = {"porosity": wanted, "phi_deg": [math.degrees(phi) for phi in figures.angles(wanted)]}
    return answer


def _columns(answer: Mapping[str, object]) -> list[tuple[float, ...]]:
    """Angle, area, area of the voids and porosity, angle by angle."""
    names = ("phi_deg", "area", "void_area", "porosity")
    return list(zip(*(np.asarray(answer[name]).tolist() for name in names), strict=True))


def _csv(answer: Mapping[str, object]) -> str:
    """The table with its heads and units."""
    text = io.StringIO()
    lines = csv.writer(text, lineterminator="\n")
    lines.writerow(["phi (deg)", f"area ({answer['unit']})", f"void area ({answer['unit']})", "porosity"])
    lines.writerows([f"{value:.9g}" for value in row] for row in _columns(answer))
    return text.getvalue()


def _say_areas(answer: Mapping[str, object]) -> None:
    for degrees, area, voids, share in _columns(answer):
        say(
            tr(
                "{degrees:6.1f} degrees: area {area:.4f} {unit}, voids {voids:.4f}, porosity {percent:.2f} %",
                degrees=degrees,
                area=area,
                unit=answer["unit"],
                voids=voids,
                percent=100.0 * share,
            )
        )
    found = answer.get("found")
    if isinstance(found, dict):
        nearer, farther = found["phi_deg"]
        say(
            tr(
                "Porosity {percent:.2f} % at {nearer:.2f} and {farther:.2f} degrees.",
                percent=100.0 * found["porosity"],
                nearer=nearer,
                farther=farther,
            )
        )


def score(arguments: argparse.Namespace) -> int:
    """Print how well each sheet shows its target."""
    *sheet_sources, target_source = arguments.inputs
    if not sheet_sources:
        raise UsageError("score.nothing_to_score")
    phi = target_angle(arguments.phi)
    sheets = list(read_sheets(sheet_sources))
    targets = list(read_targets([target_source], choice=part_choice(arguments), fill_holes=arguments.fill_holes))
    if 1 not in (len(sheets), len(targets)) and len(sheets) != len(targets):
        raise UsageError("score.numbers_differ", sheets=len(sheets), targets=len(targets))
    pairs = max(len(sheets), len(targets))
    sheets = sheets * (pairs if len(sheets) == 1 else 1)
    targets = targets * (pairs if len(targets) == 1 else 1)
    batch = is_batch(sheet_sources) or are_many_targets([target_source])

    def one(name: str, pair: tuple[Sheet, Named[Outline]]) -> None:
        sheet, target = pair
        outline = target.read()
        result = evaluate(deploy(sheet), outline, phi)
        answer = result.to_json() | {"target_holes": len(outline.holes), "warnings": warn(target.name, outline)}
        if batch:
            print_json({"source": name, "target": target.name} | answer)
        elif arguments.json:
            print_json(answer)
        else:
            figures = tr(
                "sIoU {siou:.4f} ({gain:+.4f} over the uniform layout), exact IoU {iou:.4f}, TV {tv:.3f}.",
                siou=result.siou,
                gain=result.siou_gain,
                iou=result.iou_exact,
                tv=result.tv,
            )
            say(f"{figures} {tr('Feasible.') if result.feasible else tr('Not feasible.')}")

    return for_each((_paired(*pair) for pair in zip(sheets, targets, strict=True)), batch, one, as_json=arguments.json)


def _paired(sheet: Named[Sheet], target: Named[Outline]) -> Named[tuple[Sheet, Named[Outline]]]:
    """A sheet with the target that it is scored against, under the sheet's name."""
    return Named(sheet.name, lambda: (sheet.read(), target))


def siou(arguments: argparse.Namespace) -> int:
    """Print the similarity-aligned IoU of two mask images."""
    value, transform = mask_siou(
        read_mask(Path(arguments.mask_a)), read_mask(Path(arguments.mask_b)), crop=arguments.crop
    )
    if arguments.json:
        print_json({"siou": value, "transform": transform.to_json()})
    else:
        say(f"sIoU {value:.4f}")
    return 0


def target_angle(phi: float) -> float:
    """Accept a target angle in [0, pi)."""
    if not 0.0 <= phi < math.pi:
        raise AngleError("request.angle_out_of_range", value=phi)
    return phi


def _deliver(arguments: argparse.Namespace, answer: dict[str, object], name: str, batch: bool, kind: str) -> None:
    """Print, and write a file where one was asked for."""
    if arguments.json or batch:
        print_json(answer)
    if arguments.out is not None:
        stem = Path(name).stem.replace("[", "_").replace("]", "")
        target = Path(arguments.out) / f"{stem}.{kind}.json" if batch else Path(arguments.out)
        write_atomically(target, (json.dumps(plain(answer)) + "\n").encode())
