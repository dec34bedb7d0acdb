"""The licences of everything that is shipped with the program, or installed for it.

Python packages say them in their own metadata, which is read where they are installed and inside a frozen program
alike.  What is no Python package (letters, data, and in a frozen program Python itself and system libraries) stands in
the JSON files of ``resources/licences``; ``packaging/bundle.py`` adds one there.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import Distribution, PackageMetadata, PackageNotFoundError, distribution
from pathlib import Path

from kirigami_studio import __version__
from kirigami_studio.foundation.resources import resource, resource_root

#: Our own package, as an installer calls it.
OURS = "kirigami-studio"
#: Names of licence files in wheels whose metadata name none.
USUAL_FILES = ("LICENSE", "LICENSE.txt", "LICENSE.md", "COPYING")
#: Packages that leave the choice of a licence, or come without its text: the one that we take, and what to show.
CHOSEN = {
    **{
        name: ("LGPL-3.0-only", ("qt.txt", "LGPL-3.0-only.txt", "GPL-3.0-only.txt"))
        for name in ("pyside6-essentials", "shiboken6")
    },
    "rectpack": ("Apache-2.0", ("Apache-2.0.txt",)),
}
#: A longer ``License`` field is no name.
LONGEST_NAME = 60


@dataclass(frozen=True, slots=True)
class Component:
    """Something that is shipped under a licence."""

    #: name, version: version is empty for what has none.
    name: str
    version: str
    licence: str  #: an SPDX expression, or what the component's makers call it
    homepage: str  #: empty where it is not known
    text: str  #: the whole licence, or all of them


def components() -> tuple[Component, ...]:
    """All that is installed for the program: the program itself, then the others by name."""
    needed = packages()
    ours = needed.pop(OURS, None)
    checkout = resource_root().parent / "LICENSE"  # whose metadata, if there are any, have no licence beside them
    text = _joined(ours.texts if ours else []) or (checkout.read_text(encoding="utf-8") if checkout.is_file() else "")
    others = [*map(_component, needed.values()), *_listed()]
    own = Component(OURS, __version__, "MIT", "", text.strip())
    return (own, *sorted(others, key=lambda component: component.name.lower()))


@dataclass(frozen=True, slots=True)
class Package:
    """A distribution with its metadata, which takes time to read."""

    distribution: Distribution
    metadata: PackageMetadata

    def all(self, field: str) -> list[str]:
        """The values of a field that may be there several times."""
        return self.metadata.get_all(field) or []

    @property
    def texts(self) -> list[str]:
        """The licence texts that it brings along, the most important first."""
        names = self.all("License-File") or USUAL_FILES
        found = (self._read(f"licenses/{name}") or self._read(name) for name in names)
        return [text.strip("\n") for text in found if text]

    def _read(self, name: str) -> str | None:
        """A file of the metadata, in UTF-8 or else in Latin-1, as old licences are.

        Frozen programs have no list of a package's files, so the folder of the metadata is found by its name.
        """
        try:
            return self.distribution.read_text(name)
        except UnicodeDecodeError:
            ours = normalised(self.metadata["Name"])
            folders = Path(str(self.distribution.locate_file(""))).glob("*.dist-info")
            folder = next(one for one in folders if normalised(one.name.partition("-")[0]) == ours)
            return (folder / name).read_text(encoding="latin-1")


def packages() -> dict[str, Package]:
    """The program's own distribution and all that it needs, by their normalised names.

    What is not installed is not listed: it is needed on other systems only.
    """
    found: dict[str, Package] = {}
    waiting = [OURS]
    while waiting:
        name = normalised(waiting.pop())
        if name in found:
            continue
        try:
            known = distribution(name)
        except PackageNotFoundError:
            continue
        found[name] = Package(known, known.metadata)
        waiting += [line for line in found[name].all("Requires-Dist") if "extra ==" not in line]
    return found


def normalised(requirement: str) -> str:
    """The name in a requirement, as registries compare names."""
    name = re.match(r"\s*([\w.-]+)", requirement)
    return re.sub(r"[-_.]+", "-", name[1] if name else "").lower()


def _component(package: Package) -> Component:
    name = package.metadata["Name"]
    licence, files = CHOSEN.get(normalised(name), (_licence_name(package), ()))
    texts = [*map(_bundled, files), *package.texts]
    return Component(name, package.metadata["Version"], licence, _homepage(package), _joined(texts))


def _licence_name(package: Package) -> str:
    """The licence of a distribution: an expression, else a short field, else its classifiers."""
    expression = package.all("License-Expression")
    field = "".join(package.all("License")).strip().partition("\n")[0]
    short = field if len(field) <= LONGEST_NAME and not re.search("Copyright|:", field) else ""
    classes = [line.rpartition(" :: ")[2] for line in package.all("Classifier") if line.startswith("License ::")]
    return "".join(expression) or short or " AND ".join(classes)


def _homepage(package: Package) -> str:
    """A link for people, the empty text where there is none."""
    links: dict[str, str] = {}
    for line in (*(f"homepage,{link}" for link in package.all("Home-page")), *package.all("Project-URL")):
        label, _, link = line.partition(",")
        links.setdefault(label.strip().lower(), link.strip())
    ways = ("homepage", "website", "repository", "source", "source code", "documentation")
    return next((links[way] for way in ways if way in links), "")


def _listed() -> Iterator[Component]:
    """Content of the JSON files."""
    for table in sorted(resource("licences").glob("*.json")):
        for entry in json.loads(table.read_text(encoding="utf-8")):
            text = _joined([_bundled(name) for name in entry["texts"]])
            yield Component(entry["name"], entry["version"], entry["licence"], entry["homepage"], text)


def _bundled(name: str) -> str:
    return resource("licences", name).read_text(encoding="utf-8").strip("\n")


def _joined(texts: list[str]) -> str:
    return f"\n\n{'-' * 72}\n\n".join(texts)
