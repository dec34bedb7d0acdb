"""Where the bundled files are, in an installed wheel and in an editable checkout alike."""

from __future__ import annotations

import errno
from functools import cache
from pathlib import Path


@cache
def resource_root() -> Path:
    """Return the folder that holds ``models/``, ``silhouettes/``, ``icons/`` and the rest.

    A wheel carries them as ``kirigami_studio/resources``; a checkout has them beside the package.

    Raises
    ------
    FileNotFoundError
        Neither place exists: the installation is incomplete.  Not one of the program's own errors, whose sentences are
        made of catalogues that stand here.
    """
    package = Path(__file__).resolve().parents[1]
    for root in (package / "resources", package.parent / "resources"):
        if (root / "silhouettes").is_dir():
            return root
    raise FileNotFoundError(errno.ENOENT, "bundled files are missing; install Kirigami Studio again", str(package))


def resource(*parts: str) -> Path:
    """Return the path of a bundled file or folder, ``resource("models", "prior.safetensors")``."""
    return resource_root().joinpath(*parts)
