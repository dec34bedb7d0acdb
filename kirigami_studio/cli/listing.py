"""``targets`` and ``variants``: what there is to choose from."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from kirigami_studio.cli.console import print_json, say


def targets(arguments: argparse.Namespace) -> int:
    """List the library silhouettes."""
    from kirigami_studio.outlines.silhouettes import names

    return _listing(arguments, "targets", names())


def variants(arguments: argparse.Namespace) -> int:
    """List the generator variants without loading any weights."""
    from kirigami_studio.generator.weights import variants as bundled

    return _listing(arguments, "variants", bundled())


def _listing(arguments: argparse.Namespace, key: str, names: Sequence[str]) -> int:
    if arguments.json:
        print_json({key: list(names)})
    else:
        for name in names:
            say(name)
    return 0
