"""``decode``, ``score`` and ``siou``: one stage each, on any number of inputs."""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path

from kirigami_studio.cli.console import plain, print_json, say
from kirigami_studio.cli.inputs import (
    Named,
    are_many_targets,
    for_each,
    is_batch,
    read_fields,
    read_mask,
    read_targets,
)
from kirigami_studio.cli.option_types import parse_grid
from kirigami_studio.evaluate.feasibility import invalid_quads, overlap_ratio, path_contact
from kirigami_studio.evaluate.mask_siou import mask_siou
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.foundation.errors import AngleError, RatioError, UsageError
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.foundation.words import tr
from kirigami_studio.lattice.deployment import check_phi, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline


def decode(arguments: argparse.Namespace) -> int:
    """Print the exact layout of each ratio field."""
    phi = check_phi(arguments.phi)
    batch = is_batch(arguments.ratios)

    def one(name: str, field: RatioField) -> None:
        _check_grid(arguments.grid, field, name)
        answer = decoded(field, phi)
        _deliver(arguments, {"source": name} | answer if batch else answer, name, batch, "layout")
        if not arguments.json and not batch:
            say(
                tr(
                    "{rows} x {columns} voids at {angle:.1f} degrees: area {area:.4f} unit cells, {invalid} invalid, "
                    "overlap {overlap:.4f}",
                    rows=field.rows,
                    columns=field.columns,
                    angle=math.degrees(phi),
                    area=answer["area"],
                    invalid=answer["n_invalid"],
                    overlap=answer["overlap_ratio"],
                )
            )

    return for_each(read_fields(arguments.ratios), batch, one)


def decoded(field: RatioField, phi: float) -> dict[str, object]:
    """The JSON answer of ``decode`` for one field at ``phi`` radians, in unit cells."""
    deployment = deploy(field)
    contact = path_contact(deployment, phi)
    return {
        "phi": phi,
        "grid": [field.rows, field.columns],
        "void_corners": deployment.voids(phi),
        "panels": deployment.panels(phi).reshape(-1, 4, 2),
        "outline": deployment.outline(phi),
        "area": deployment.area(phi),
        "n_invalid": invalid_quads(deployment, phi),
        "overlap_ratio": overlap_ratio(deployment, phi),
        "contact": None if contact is None else contact.to_json(),
    }


def score(arguments: argparse.Namespace) -> int:
    """Print how well each field shows its target."""
    *ratio_sources, target_source = arguments.inputs
    if not ratio_sources:
        raise UsageError("score.nothing_to_score")
    phi = target_angle(arguments.phi)
    fields = list(read_fields(ratio_sources))
    targets = list(read_targets([target_source]))
    if 1 not in (len(fields), len(targets)) and len(fields) != len(targets):
        raise UsageError("score.numbers_differ", fields=len(fields), targets=len(targets))
    pairs = max(len(fields), len(targets))
    fields = fields * (pairs if len(fields) == 1 else 1)
    targets = targets * (pairs if len(targets) == 1 else 1)
    batch = is_batch(ratio_sources) or are_many_targets([target_source])

    def one(name: str, pair: tuple[RatioField, Named[Outline]]) -> None:
        field, target = pair
        result = evaluate(deploy(field), target.read(), phi)
        if batch:
            print_json({"source": name, "target": target.name} | result.to_json())
        elif arguments.json:
            print_json(result.to_json())
        else:
            figures = tr(
                "sIoU {siou:.4f} ({gain:+.4f} over the uniform layout), exact IoU {iou:.4f}, TV {tv:.3f}.",
                siou=result.siou,
                gain=result.siou_gain,
                iou=result.iou_exact,
                tv=result.tv,
            )
            say(f"{figures} {tr('Feasible.') if result.feasible else tr('Not feasible.')}")

    return for_each((_paired(*pair) for pair in zip(fields, targets, strict=True)), batch, one)


def _paired(field: Named[RatioField], target: Named[Outline]) -> Named[tuple[RatioField, Named[Outline]]]:
    """A field with the target that it is scored against, under the field's name."""
    return Named(field.name, lambda: (field.read(), target))


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
        raise AngleError("settings.angle_out_of_range", value=phi)
    return phi


def _check_grid(grid: str | None, field: RatioField, name: str) -> None:
    if grid is not None and parse_grid(grid) != (field.rows, field.columns):
        raise RatioError("decode.other_grid", name=name, rows=field.rows, columns=field.columns, grid=grid)


def _deliver(arguments: argparse.Namespace, answer: dict[str, object], name: str, batch: bool, kind: str) -> None:
    """Print, and write a file where one was asked for."""
    if arguments.json or batch:
        print_json(answer)
    if arguments.out is not None:
        stem = Path(name).stem.replace("[", "_").replace("]", "")
        target = Path(arguments.out) / f"{stem}.{kind}.json" if batch else Path(arguments.out)
        write_atomically(target, (json.dumps(plain(answer)) + "\n").encode())
