"""Where designs come from: what a project and every export repeats so that a run can be repeated."""

from __future__ import annotations

import hashlib

from kirigami_studio import __version__
from kirigami_studio.pipeline.request import Request


def provenance(request: Request, digest: str) -> dict[str, str]:
    """Describe the run of ``request`` with the weights of SHA-256 ``digest``; what was not asked for is left out.

    A design that samples were drawn near is named by the start of the SHA-256 of its ratios, row by row, as doubles.
    """
    known = {
        "application": f"kirigami-studio {__version__}",
        "model": request.variant,
        "model_sha256": digest,
        "k": str(request.k),
        "steps": str(request.steps),
        "polish": str(request.polish),
    }
    if request.polish or request.search:
        known["prefer"] = request.prefer
    if request.least_panel:
        known["least_panel"] = f"{request.least_panel:g}"
    if request.trim:
        known["trim_keep"] = f"{request.keep:g}"
    if request.search:
        known["search"] = str(request.search)
    if request.near is not None:
        known["near"] = hashlib.sha256(request.near.ratio.tobytes()).hexdigest()[:16]
        known["nearness"] = f"{request.nearness:g}"
    if request.budget_seconds is not None:
        known["budget_seconds"] = f"{request.budget_seconds:g}"
    return known
