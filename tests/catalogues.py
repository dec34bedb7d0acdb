"""The program's sentences as translators get them, and catalogues as Babel reads and compiles them."""

from __future__ import annotations

import importlib.util
import os
from functools import cache
from pathlib import Path

from babel.messages.catalog import Catalog
from babel.messages.mofile import write_mo
from babel.messages.pofile import read_po

ROOT = Path(__file__).resolve().parents[1]
LOCALE = ROOT / "resources" / "locale"
DOMAIN = "kirigami_studio"


@cache
def template() -> Catalog:
    """All sentences of the program, without translations, as `make messages` collects them."""
    spec = importlib.util.spec_from_file_location("messages", ROOT / "packaging" / "messages.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    found: Catalog = module.template()
    return found


def write_compiled(found: Catalog, folder: Path, language: str) -> None:
    """Put a compiled catalogue where gettext looks for it below a folder."""
    path = folder / language / "LC_MESSAGES" / f"{DOMAIN}.mo"
    path.parent.mkdir(parents=True, exist_ok=True)
    new = path.with_suffix(f".{os.getpid()}")
    with new.open("wb") as stream:
        write_mo(stream, found)
    new.replace(path)  # another process may read it, or write it too


def compile_stale() -> None:
    """Compile the bundled catalogues that have changed since, as `make setup` does."""
    for path in LOCALE.glob(f"*/LC_MESSAGES/{DOMAIN}.po"):
        compiled = path.with_suffix(".mo")
        if not compiled.is_file() or compiled.stat().st_mtime < path.stat().st_mtime:
            language = path.parts[-3]
            write_compiled(catalogue(language), LOCALE, language)


def source_of(language: str) -> Path:
    """The catalogue of a language as translators write it."""
    return LOCALE / language / "LC_MESSAGES" / f"{DOMAIN}.po"


@cache
def catalogue(language: str) -> Catalog:
    """The catalogue of a bundled language."""
    with source_of(language).open("rb") as stream:
        return read_po(stream)


def forms(text: object) -> tuple[str, ...]:
    """The singular and the plural, or the one form there is."""
    return tuple(text) if isinstance(text, tuple | list) else (str(text),)
