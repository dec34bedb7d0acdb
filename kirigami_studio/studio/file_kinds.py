"""The kinds of file that a design can be exported to, as menus and file dialogs name them.

A table of its own, because asking the exporters means importing them, which takes longer than a menu may take to open.
"""

from __future__ import annotations

from dataclasses import dataclass

from kirigami_studio.foundation.words import mark, tr


@dataclass(frozen=True, slots=True)
class FileKind:
    """One row of the table."""

    extension: str  #: lower case, with the dot
    title: str
    tip: str
    cuts: bool  #: it holds the cut plan in mm; the others are pictures

    @property
    def filter(self) -> str:
        """As a line of a file dialog."""
        return f"{tr(self.title)} (*{self.extension})"


FILE_KINDS = (
    FileKind(".dxf", mark("DXF cut file, mm"), mark("Cut file in mm, DXF R2010, read back and checked"), True),
    FileKind(".svg", mark("SVG cut file, mm"), mark("Cut file in mm for laser software and Inkscape"), True),
    FileKind(".pdf", mark("PDF cut sheet, mm"), mark("Cut sheet at 1:1, to print or plot"), True),
    FileKind(".png", mark("PNG picture"), mark("Picture of the opened sheet over its target"), False),
    FileKind(".gif", mark("GIF animation, as cut"), mark("The sheet opening as cut; it stops where it jams"), False),
    FileKind(
        ".html", mark("Page to share"), mark("One file that moves in every browser, with the project inside"), False
    ),
    FileKind(
        ".lbrn2", mark("LightBurn project"), mark("Named layers in cutting order; connectors on the tool layer"), True
    ),
    FileKind(".stl", mark("STL solid, mm"), mark("The sheet as one closed body, to print or to mill"), True),
    FileKind(".3mf", mark("3MF solid, mm"), mark("Closed bodies with names and colours of the layers, to print"), True),
    FileKind(".obj", mark("OBJ solid, mm"), mark("Closed bodies with names, for modelling programs"), True),
    FileKind(".fold", mark("FOLD, mm"), mark("Panels, cuts and hinges at five angles, for origami programs"), False),
    FileKind(".xml", mark("MuJoCo model"), mark("Rigid parts on hinges with contacts (MJCF), to simulate"), False),
    FileKind(".inp", mark("Finite elements, mm"), mark("The finished sheet for Gmsh, CalculiX and Abaqus"), True),
    FileKind(".csv", mark("Tables, mm"), mark("Panels and hinges, for spreadsheets and scripts"), False),
)


def kind_of(extension: str) -> FileKind:
    """Return the row of an extension; the first one for an unknown extension."""
    return next((kind for kind in FILE_KINDS if kind.extension == extension.lower()), FILE_KINDS[0])
