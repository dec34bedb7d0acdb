"""Version, changelog and names of the files of a release, in one place.

``python packaging/version.py`` prints version and names, with ``--changes`` what the changelog says of the version.
"""

from __future__ import annotations

import platform
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
HEADING = re.compile(r"^## (\S+)(?: - (\d{4}-\d{2}-\d{2}))?\s*$", re.MULTILINE)


class ReleaseError(Exception):
    """Something does not agree, or is not ready for a release."""


def version(root: Path = ROOT) -> str:
    """The program's version, ``kirigami_studio.__version__``, without importing it."""
    text = (root / "kirigami_studio" / "__init__.py").read_text(encoding="utf-8")
    found = re.search(r'^__version__ = "([^"]+)"$', text, re.MULTILINE)
    if found is None:
        raise ReleaseError("kirigami_studio/__init__.py has no __version__")
    return found[1]


def changes(wanted: str, root: Path = ROOT) -> tuple[str, str]:
    """The date of a version's section in the changelog, and what it says.

    Raises
    ------
    ReleaseError
        There is no section ``## VERSION - YYYY-MM-DD``, it is empty, or a newer one stands above it.
    """
    text = (root / "CHANGELOG.md").read_text(encoding="utf-8")
    sections = [section for section in HEADING.finditer(text) if section[1] != "UNRELEASED"]
    if not sections or sections[0][1] != wanted or sections[0][2] is None:
        first = f"the first is '{sections[0][0].strip()}'" if sections else "there is none"
        raise ReleaseError(f"CHANGELOG.md needs a section '## {wanted} - YYYY-MM-DD' below UNRELEASED; {first}")
    end = sections[1].start() if len(sections) > 1 else len(text)
    said = text[sections[0].end() : end].strip()
    if not said:
        raise ReleaseError(f"the section of {wanted} in CHANGELOG.md is empty")
    if unreleased(root):
        raise ReleaseError(f"CHANGELOG.md still has entries under UNRELEASED; move them to {wanted}")
    return sections[0][2], said


def unreleased(root: Path = ROOT) -> str:
    """Entries of the changelog that no version has yet."""
    text = (root / "CHANGELOG.md").read_text(encoding="utf-8")
    found = re.search(r"^## UNRELEASED\s*$(.*?)(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)
    return "" if found is None else found[1].strip()


def file_names(wanted: str, system: str = platform.system(), machine: str = platform.machine()) -> dict[str, str]:
    """Names of the files of a release by what they are: those of Python, then those of one system.

    Parameters
    ----------
    system, machine : str
        As :mod:`platform` calls them, such as ``Linux`` and ``x86_64``.
    """
    machine = {"AMD64": "x86_64", "aarch64": "arm64"}.get(machine, machine)
    python = {
        "wheel": f"kirigami_studio-{wanted}-py3-none-any.whl",
        "sdist": f"kirigami_studio-{wanted}.tar.gz",
    }
    debian = {"x86_64": "amd64"}.get(machine, machine)
    others = {
        "Linux": {
            "bundle": f"kirigami-studio-{wanted}-linux-{machine}.tar.xz",
            "deb": f"kirigami-studio_{wanted}_{debian}.deb",
        },
        "Windows": {
            "bundle": f"kirigami-studio-{wanted}-windows-{machine}.zip",
            "installer": f"kirigami-studio-{wanted}-windows-{machine}-setup.exe",
        },
        "Darwin": {"image": f"kirigami-studio-{wanted}-macos-{machine}.dmg"},
    }
    return python | others.get(system, {})


if __name__ == "__main__":
    try:
        print(
            changes(version())[1]
            if "--changes" in sys.argv
            else "\n".join((version(), *file_names(version()).values()))
        )
    except ReleaseError as error:
        sys.exit(f"version: {error}")
