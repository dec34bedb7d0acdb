"""The Model Context Protocol over the API: tools for assistants, with files in one folder.

``kirigami-studio mcp --folder DIR`` speaks it on standard input and output.  The official SDK, which the extra ``mcp``
brings, is imported when the server starts.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import wraps
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal

import kirigami_studio
from kirigami_studio.api.design import Cuts, Design, Pieces
from kirigami_studio.api.designs import design, load_project
from kirigami_studio.api.target import Target, load_target, target_names
from kirigami_studio.api.values import optional_package
from kirigami_studio.export.registry import export
from kirigami_studio.foundation.errors import KirigamiError, UsageError
from kirigami_studio.lattice.deployment import check_phi
from kirigami_studio.outlines import silhouettes
from kirigami_studio.project.store import CUT_FILES, SUFFIX
from kirigami_studio.settings.fabrication import is_pinned, with_choices
from kirigami_studio.studio.making import CutRequest, picture_job

INSTRUCTIONS = (
    "Kirigami Studio designs cut sheets that open into a silhouette.  `design` makes a project of a library silhouette "
    "(heart, star, circle, butterfly, ...), a drawing in the folder, or points; `verdict` says whether a design of a "
    "project can be cut in a material, and why not; `export` writes cut files and pages; `picture` shows a design.  "
    "Files are named relative to the folder."
)
#: Rows of figures in the answer of a run.
ROWS = 5


@dataclass(frozen=True, slots=True)
class FolderTools:
    """Tools of the server, all of whose files are in one folder.

    Attributes
    ----------
    folder : Path
        Resolved.
    """

    folder: Path

    def design(
        self,
        target: str | list[tuple[float, float]],
        project: str = "design.kiri",
        k: int = 8,
        grid: tuple[int, int] | Literal["auto"] = "auto",
        symmetry: Literal["auto", "none", "mirror", "turn"] = "auto",
        regular: float = 0.5,
        start: Literal["auto", "rectangle", "square", "circle", "triangle", "hexagon"] = "rectangle",
        material: str | None = None,
        width_mm: float | None = None,
        trim: bool = False,
        polish: bool = True,
        seed: int = 0,
        budget_seconds: float | None = None,
    ) -> dict[str, Any]:
        """Design sheets that open into a target, and save them as a project (.kiri).

        target: a library silhouette, a drawing or picture in the folder (.svg .dxf .png ...), or points [[x, y], ...],
        y up.  k: number of designs (8 take some ten seconds).  grid: [rows, columns], or auto.  regular: 0 for the best
        match to 1 for even panels.  start: shape of the flat sheet.  material: such as card-co2, film-uv, paper-hand.
        Answers with the figures of the best designs: iou is the match of the panels, 1 at best; that of pieces on pins
        is in their verdict.
        """
        goal = self._inside(project, SUFFIX)
        found = design(
            self._target(target),
            k=k,
            grid=grid,
            symmetry=symmetry,
            regular=regular,
            start=start,
            material=material,
            width_mm=width_mm,
            trim=trim,
            polish=15 if polish else 0,
            seed=seed,
            budget_seconds=budget_seconds,
        )
        found.save(goal)
        return {
            "project": self._name(goal),
            "count": len(found),
            "designs": found[:ROWS].table(),
            "warnings": list(found.target.notes),
            "closed_limit": found.closed_limit(),
        }

    def verdict(
        self,
        project: str,
        name: str = "",
        material: str | None = None,
        width_mm: float | None = None,
        connector_mm: float | None = None,
        construction: Literal["one-sheet", "pinned", "backed", "printed"] | None = None,
    ) -> dict[str, Any]:
        """Judge whether a design can be cut: it matches, fits the material, closes.

        Answers with the problems, worst first.  name: of a design of the project (A1, A2, ...); the chosen one unless
        given.  What is left out is as in the project.
        """
        one = self._design(project, name)
        given = _given(material=material, width_mm=width_mm, connector_mm=connector_mm, construction=construction)
        pinned = is_pinned(with_choices(one.document.fabrication, given))
        made: Cuts | Pieces = one.make_pieces(**given) if pinned else one.plan_cuts(**given)
        return {"name": one.name, **_figures(made), "verdict": made.verdict.to_json()}

    def export(
        self,
        project: str,
        file: str,
        name: str = "",
        material: str | None = None,
        width_mm: float | None = None,
        connector_mm: float | None = None,
        construction: Literal["one-sheet", "pinned", "backed", "printed"] | None = None,
    ) -> dict[str, Any]:
        """Write a design as a file of the folder, by its extension, and read cut files back.

        file: .dxf .svg .pdf .lbrn2 for cutters, .html for a page that moves in a browser, .stl .3mf .obj solids, .fold,
        .xml (MuJoCo), .inp (finite elements), .png, .gif.  Designs of several pieces become a folder of this name.
        """
        goal = self._inside(file)
        one = self._design(project, name)
        given = _given(material=material, width_mm=width_mm, connector_mm=connector_mm, construction=construction)
        found = one.export(goal, **given)
        verdict = found.verdict
        return {
            "files": [self._name(path) for path in found.files],
            "as_planned": found.ok,
            "verdict": None if verdict is None else verdict.to_json(),
        }

    def picture(self, project: str, name: str = "", phi_deg: float | None = None) -> Any:
        """Show a design over its target as a picture.

        phi_deg: 180 is the flat sheet, 0 fully turned; the target angle unless given.
        """
        shown = None if phi_deg is None else check_phi(math.radians(phi_deg))
        job = picture_job(CutRequest.of(self._design(project, name).document))
        with TemporaryDirectory() as folder:
            content = export(replace(job, picture_phi=shown), Path(folder) / "design.png").read_bytes()
        return optional_package("mcp.server.mcpserver", "mcp").Image(data=content, format="png")

    def _inside(self, name: str, *suffixes: str) -> Path:
        """Path of a file of the folder.

        Raises
        ------
        UsageError
            Another place, or another extension.
        """
        path = (self.folder / name).resolve()
        if not name.strip() or path == self.folder or not path.is_relative_to(self.folder):
            raise UsageError("mcp.outside_folder", name=name)
        if suffixes and path.suffix.lower() not in suffixes:
            raise UsageError("mcp.wrong_extension", name=name, kinds=", ".join(suffixes))
        return path

    def _name(self, path: Path) -> str:
        return path.resolve().relative_to(self.folder).as_posix()

    def _target(self, target: str | list[tuple[float, float]]) -> Target:
        if not isinstance(target, str):
            return load_target(target)
        if target in target_names():
            return load_target(target)
        path = self._inside(target)
        # Elsewhere there may be a file of that name: what is not in the folder is a name of the library, or nothing.
        return load_target(path) if path.exists() else Target(silhouettes.load(target))

    def _design(self, project: str, name: str) -> Design:
        found = load_project(self._inside(project, SUFFIX, *CUT_FILES))
        return found[name] if name else found.chosen


def _given(**options: Any) -> dict[str, Any]:
    return {name: value for name, value in options.items() if value is not None}


def _figures(made: Cuts | Pieces) -> dict[str, Any]:
    settings = made.settings
    known: dict[str, Any] = {"material": settings.material, "width_mm": settings.width_mm, "seconds": made.seconds}
    if isinstance(made, Pieces):
        return known | {"pieces": made.count, "pins": made.pins}
    return known | {"cut_length_mm": made.cut_length_mm, "min_connector_mm": made.min_connector_mm}


def make_server(folder: Path) -> Any:
    """Make the server whose tools work in a folder.

    Raises
    ------
    UsageError
        The SDK is not installed, or there is no such folder.
    """
    sdk = optional_package("mcp.server.mcpserver", "mcp")
    refused = optional_package("mcp.server.mcpserver.exceptions", "mcp").ToolError
    if not folder.is_dir():
        raise UsageError("mcp.no_folder", folder=folder)
    tools = FolderTools(folder.resolve())

    def anticipating(tool: Callable[..., Any]) -> Callable[..., Any]:
        """The tool, whose refusals are sentences for the assistant."""

        @wraps(tool)
        def call(*values: Any, **options: Any) -> Any:
            try:
                return tool(*values, **options)
            except KirigamiError as error:
                raise refused(str(error)) from error

        return call

    server = sdk.MCPServer(
        "kirigami-studio",
        title="Kirigami Studio",
        instructions=INSTRUCTIONS,
        version=kirigami_studio.__version__,
        log_level="WARNING",
    )
    for tool in (tools.design, tools.verdict, tools.export):
        server.add_tool(anticipating(tool))
    server.add_tool(anticipating(tools.picture), structured_output=False)
    return server


def serve(folder: Path) -> int:
    """Serve on standard input and output until the other side ends; returns the exit code 0."""
    make_server(folder).run()
    return 0
