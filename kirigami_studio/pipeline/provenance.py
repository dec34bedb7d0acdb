"""Where designs come from: what a project and every export repeats so that a run can be repeated."""

from __future__ import annotations

from kirigami_studio import __version__
from kirigami_studio.pipeline.request import Request


def provenance(request: Request, digest: str) -> dict[str, str]:
    """Describe the run of ``request`` with the weights of SHA-256 ``digest``."""
    return {
        "application": f"kirigami-studio {__version__}",
        "model": request.variant,
        "model_sha256": digest,
        "polish": str(request.polish),
    }
