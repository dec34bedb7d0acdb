"""How a machine's program wants its cut files: colours (AutoCAD colour index, ACI), arcs, layers, closed contours.

Programs choose the operation by colour: MeerK40t cuts pure red only, engraves blue and rasters white; K40 Whisperer
engraves blue; LightBurn makes one cut setting for each colour.  No scheme suits them all, so the user picks one.

A name that is engraved has a layer and a colour of its own, in which no profile cuts, and so have the lines of artwork
on pieces.  Files of profiles that stand for cuts alone have neither.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType

from kirigami_studio.fabricate.cut_plan import Layer
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.frozen_mapping import FrozenMapping
from kirigami_studio.foundation.words import mark

RED, GREEN, CYAN, BLUE, MAGENTA, WHITE, ORANGE = 1, 3, 4, 5, 6, 7, 30


class DxfVersion(StrEnum):
    """Dialects of cut files; the values are the names on the command line and in files."""

    R2010 = "R2010"
    R12 = "R12"  #: for old programs; such files have no unit


#: Millimetres, pixels of old drawing programs, and those of CSS, to the inch.
MM_DPI, POINT_DPI, CSS_DPI = 25.4, 72.0, 96.0
#: Layer of a file that keeps everything together.
ONE_LAYER = "SHEET"
#: Layer of closed contours that stand for slits.
SLOT_LAYER = "SLOTS"
#: Layer of a name that is engraved.
NAME_LAYER = "NAME"
#: Layer of the lines of artwork on pieces, and all layers that are engraved.
ARTWORK_LAYER = "ARTWORK"
ENGRAVED_LAYERS = frozenset({NAME_LAYER, ARTWORK_LAYER})


@dataclass(frozen=True, slots=True)
class Profile:
    """What one kind of program or service wants."""

    #: key, name: for the command line, and for the user.
    key: str
    name: str
    colour: Mapping[Layer, int]  #: AutoCAD colour index
    one_layer: bool = False  #: everything on the layer ``ONE_LAYER``, in file order
    flatten: bool = False  #: arcs as chords
    file_per_layer: bool = False  #: a folder of files instead of one file
    slots: bool = False  #: closed contours only: every slit becomes the outline of the slot that it burns
    note: Note | None = None  #: what to know before importing
    #: AutoCAD colour index of an engraved name; None where everything in a file is cut, so that it has no name.
    name_colour: int | None = BLUE
    #: Units to the inch in which an SVG counts (25.4: mm), for programs that take its numbers for pixels; its width and
    #: height say mm in any case.
    svg_dpi: float = MM_DPI

    @property
    def artwork_colour(self) -> int | None:
        """AutoCAD colour index of lines of artwork; None where everything in a file is cut."""
        return ORANGE if self.name_colour == WHITE else self.name_colour

    def sheet_colour(self, layer: Layer) -> int:
        """Colour of a layer of a sheet, whose holes are no slits; those of pieces are red."""
        by_layer = self.colour[Layer.HOLES] != self.colour[Layer.OUTLINE]
        return CYAN if by_layer and layer is Layer.HOLES else self.colour[layer]

    def layer_name(self, layer: Layer) -> str:
        """Name of a layer in files of this profile."""
        if self.one_layer:
            return ONE_LAYER
        return SLOT_LAYER if self.slots and layer not in (Layer.HOLES, Layer.KISS, Layer.OUTLINE) else layer.value


_ALL_RED = FrozenMapping(dict.fromkeys(Layer, RED))
_BY_LAYER = FrozenMapping(
    {
        Layer.RELIEF: MAGENTA,
        Layer.HOLES: RED,
        Layer.SLITS: RED,
        Layer.EDGE_SLITS: GREEN,
        Layer.KISS: GREEN,
        Layer.OUTLINE: BLUE,
    }
)
_TABLE = (
    Profile("any", mark("Any machine: everything red, cut in file order"), _ALL_RED),
    Profile(
        "lightburn",
        mark("LightBurn: one colour for each layer"),
        _BY_LAYER,
        note=Note.of("profile.only_red_is_cut"),
        name_colour=WHITE,
    ),
    Profile("k40", mark("MeerK40t, K40 Whisperer: everything red, arcs as chords"), _ALL_RED, flatten=True),
    Profile(
        "single",
        mark("One colour, one layer: for programs that sort by colour or layer"),
        _ALL_RED,
        one_layer=True,
        name_colour=None,
    ),
    Profile(
        "layers",
        mark("One file for each layer, in a folder (CircuitPro)"),
        _ALL_RED,
        file_per_layer=True,
        note=Note.of("profile.one_origin"),
    ),
    Profile(
        "slots",
        mark("Cutting service: closed contours only, every slit as a slot"),
        _BY_LAYER,
        slots=True,
        note=Note.of("profile.kerf_is_theirs"),
        name_colour=None,
    ),
    # One colour: Design Space lays every colour on a mat of its own.
    Profile(
        "cricut",
        mark("Cricut Design Space: SVG in one colour, counted at 72 dpi"),
        _ALL_RED,
        one_layer=True,
        note=Note.of("profile.attach_and_measure"),
        name_colour=None,
        svg_dpi=POINT_DPI,
    ),
    Profile(
        "silhouette",
        mark("Silhouette Studio: everything red, arcs as chords"),
        _ALL_RED,
        flatten=True,
        note=Note.of("profile.measure"),
        name_colour=None,
        svg_dpi=POINT_DPI,
    ),
    Profile(
        "glowforge",
        mark("Glowforge: SVG with one colour for each layer"),
        _BY_LAYER,
        note=Note.of("profile.order_of_steps"),
        name_colour=WHITE,
        svg_dpi=CSS_DPI,
    ),
    Profile(
        "xtool",
        mark("xTool Studio: SVG with one colour for each layer"),
        _BY_LAYER,
        note=Note.of("profile.order_of_steps"),
        name_colour=WHITE,
        svg_dpi=CSS_DPI,
    ),
)
PROFILES: Mapping[str, Profile] = MappingProxyType({profile.key: profile for profile in _TABLE})
DEFAULT_PROFILE = "any"


def find_profile(name: str) -> Profile:
    """Return a profile by its key.

    Raises
    ------
    ExportError
        No such profile; the sentence lists the known ones.
    """
    found = PROFILES.get(str(name).strip().casefold())
    if found is None:
        raise ExportError("profile.unknown", name=name, known=", ".join(PROFILES))
    return found
