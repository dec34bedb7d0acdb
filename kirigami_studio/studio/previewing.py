"""Preview a design of a target at once, before any run, and better ones as they are found."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.steps import Cancel, never
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.request import Request
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.designing import request_for


@dataclass(frozen=True, slots=True, eq=False)
class Preview:
    """A quick fit to a target: no design of a run, and not checked as cut."""

    design: PosedDesign  #: over the target, at the angle that it is fitted for
    match: float  #: exact IoU with the target, its holes filled

    @property
    def grid(self) -> tuple[int, int]:
        """Rows and columns of voids."""
        return self.design.deployment.sheet.grid


def preview_for(target: Outline, wanted: DesignSettings, cut: FabricationSettings) -> Request:
    """The request to preview for these settings, equal where previews are the same.

    Raises
    ------
    KirigamiError
        The settings do not go together.
    """
    from kirigami_studio.pipeline.preview import preview_request

    return preview_request(request_for(target, wanted, cut))


def previewing(request: Request, cancel: Cancel) -> Iterator[Preview]:
    """Report a first design of a request, then better ones.

    See :func:`kirigami_studio.pipeline.preview.preview`.

    Raises
    ------
    Cancelled
        ``cancel`` returned true.
    KirigamiError
        There is no sheet for the request.
    """
    from kirigami_studio.pipeline.preview import preview

    for found in preview(request, cancel):
        yield Preview(PosedDesign(deploy(found.fit.sheet), found.fit.pose, request.phi), found.match)


def preview_design(request: Request, cancel: Cancel = never, *, refined: bool = False) -> Preview:
    """The first design of a request, or the last and best where ``refined``; raises as above."""
    found = previewing(request, cancel)
    first = next(found)
    if not refined:
        return first
    return [first, *found][-1]
