"""Play a notebook in an empty folder and keep what its cells show, but not when they did: ``make notebook``.

Jupyter's own command does the same but always keeps the times, so that every play would change the file.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from tempfile import TemporaryDirectory

import nbformat
from nbclient import NotebookClient


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("notebook", type=Path)
    path = parser.parse_args().notebook
    notebook = nbformat.read(path, as_version=4)
    with TemporaryDirectory() as folder:  # cells may write files
        NotebookClient(notebook, record_timing=False, resources={"metadata": {"path": folder}}).execute()
    for key in [key for key in notebook.metadata.language_info if key not in ("name", "file_extension", "mimetype")]:
        del notebook.metadata.language_info[key]
    for cell in notebook.cells:
        cell.metadata.clear()
    nbformat.write(notebook, path)


if __name__ == "__main__":
    main()
