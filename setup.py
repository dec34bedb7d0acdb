"""Put the bundled files into the wheel: ``resources/`` beside the package becomes ``kirigami_studio/resources``.

Everything else is declared in pyproject.toml, which cannot map a folder outside the package.
"""

from __future__ import annotations

import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

RESOURCES = Path(__file__).resolve().parent / "resources"


class BuildWithResources(build_py):
    """Copy ``resources/`` after the modules; an editable install reads it in place."""

    def run(self) -> None:
        super().run()
        if not self.editable_mode:
            target = Path(self.build_lib) / "kirigami_studio" / "resources"
            shutil.rmtree(target, ignore_errors=True)
            shutil.copytree(RESOURCES, target, ignore=shutil.ignore_patterns("__pycache__", ".*"))

    def get_outputs(self, include_bytecode: bool = True) -> list[str]:
        """List the copied files too, as setuptools records what it installs."""
        target = Path(self.build_lib) / "kirigami_studio" / "resources"
        copied = [str(target / path.relative_to(RESOURCES)) for path in RESOURCES.rglob("*") if path.is_file()]
        return [*super().get_outputs(include_bytecode), *copied]


setup(cmdclass={"build_py": BuildWithResources})
