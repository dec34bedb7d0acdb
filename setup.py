"""Put the bundled files into the wheel: ``resources/`` beside the package becomes ``kirigami_studio/resources``.

Catalogues are compiled for :mod:`gettext` on the way; an editable install has them compiled in place, as ``make`` does.
Everything else is declared in pyproject.toml, which cannot map a folder outside the package.
"""

from __future__ import annotations

import shutil
from pathlib import Path

from babel.messages.mofile import write_mo
from babel.messages.pofile import read_po
from setuptools import setup
from setuptools.command.build_py import build_py

RESOURCES = Path(__file__).resolve().parent / "resources"
#: Catalogues as translators write them stay in the source archive.
SOURCE, COMPILED = ".po", ".mo"


def compile_catalogues(target: Path) -> None:
    """Write every catalogue of the sources, compiled, below another folder of resources."""
    for path in RESOURCES.rglob(f"*{SOURCE}"):
        with path.open("rb") as source:
            catalogue = read_po(source)
        compiled = (target / path.relative_to(RESOURCES)).with_suffix(COMPILED)
        compiled.parent.mkdir(parents=True, exist_ok=True)
        with compiled.open("wb") as out:
            write_mo(out, catalogue)


class BuildWithResources(build_py):
    """Copy ``resources/`` after the modules; an editable install reads it in place."""

    def run(self) -> None:
        super().run()
        if self.editable_mode:
            compile_catalogues(RESOURCES)
        else:
            target = Path(self.build_lib) / "kirigami_studio" / "resources"
            shutil.rmtree(target, ignore_errors=True)
            left_out = shutil.ignore_patterns("__pycache__", ".*", f"*{SOURCE}", f"*{COMPILED}")
            shutil.copytree(RESOURCES, target, ignore=left_out)
            compile_catalogues(target)

    def get_outputs(self, include_bytecode: bool = True) -> list[str]:
        """List the copied files too, as setuptools records what it installs."""
        target = Path(self.build_lib) / "kirigami_studio" / "resources"
        found = {path.relative_to(RESOURCES) for path in RESOURCES.rglob("*") if path.is_file()}
        copied = {path.with_suffix(COMPILED) if path.suffix == SOURCE else path for path in found}
        return [*super().get_outputs(include_bytecode), *(str(target / path) for path in sorted(copied))]


setup(cmdclass={"build_py": BuildWithResources})
