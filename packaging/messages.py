"""Collect the sentences of the program for translators, run by ``make messages``.

Sentences stand in calls of ``tr``, ``mark`` and their plurals; names and notes of materials, machines and silhouettes
are words of the bundled files.
"""

from __future__ import annotations

import json
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from babel.messages.catalog import Catalog
from babel.messages.extract import extract_from_dir
from babel.messages.pofile import write_po

ROOT = Path(__file__).resolve().parents[1]
#: The calls that hold sentences, and which arguments.
KEYWORDS = {"tr": None, "mark": None, "tr_n": (1, 2), "mark_n": (1, 2)}
#: The entries of bundled files that are shown, by the pattern of the files.
WORDS = {
    "figures/*.toml": ("name", "note"),
    "machines/*.toml": ("name", "note"),
    "materials/*.toml": ("name", "machine", "note"),
    "silhouettes/*.json": ("name", "title", "about"),
}


def template() -> Catalog:
    """All sentences of the program, without translations."""
    found = Catalog()
    for _, _, message, _, _ in extract_from_dir(ROOT / "kirigami_studio", [("**.py", "python")], keywords=KEYWORDS):
        found.add(message)
    for pattern, names in WORDS.items():
        for path in (ROOT / "resources").glob(pattern):
            text = path.read_text(encoding="utf-8")
            for record in records(json.loads(text) if path.suffix == ".json" else tomllib.loads(text)):
                for name in names:
                    if record.get(name):
                        found.add(record[name])
    return found


def records(content: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """A file's record, and those in the tables of it."""
    yield content
    yield from (value for value in content.values() if isinstance(value, dict))


if __name__ == "__main__":
    write_po(sys.stdout.buffer, template(), no_location=True, sort_output=True, omit_header=True)
