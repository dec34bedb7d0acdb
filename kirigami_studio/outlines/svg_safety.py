"""Checks on an SVG document before it is unfolded: no entities, no bombs, no parts that are never painted."""

from __future__ import annotations

import base64
import re
import xml.etree.ElementTree as ElementTree
from xml.etree.ElementTree import Element

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.units import MM_PER_INCH
from kirigami_studio.foundation.words import tr

#: ``use`` elements repeat others; a drawing that unfolds to more elements than this is no outline.
MOST_ELEMENTS = 20_000
#: Numbers of all paths together, and digits of one: decoders take a long time for more.
MOST_NUMBERS = 300_000
MOST_DIGITS = 64
DIGITS = re.compile(rb"\d{%d}" % (MOST_DIGITS + 1))
NUMBER = re.compile(r"\d+(?:\.\d*)?|\.\d+")

#: Elements that show what a link leads to.
PICTURES = frozenset({"image", "feImage"})
#: What files of pixels begin with: PNG, JPEG, GIF, BMP, WebP.
PIXELS = (b"\x89PNG", b"\xff\xd8", b"GIF8", b"BM", b"RIFF")
INSTRUCTION = re.compile(r"<\?.*?\?>", re.DOTALL)
#: Parts that paint nothing by themselves; svgelements would draw the shapes inside some of them.
UNPAINTED = frozenset({"mask", "marker", "pattern", "clipPath", "foreignObject", "script", "metadata", "filter"})

REAL_LENGTH = re.compile(r"\s*\+?(\d+\.?\d*|\.\d+)(mm|cm|in|pt|pc)\s*", re.IGNORECASE)
MM_PER_UNIT = {"mm": 1.0, "cm": 10.0, "in": MM_PER_INCH, "pt": MM_PER_INCH / 72.0, "pc": MM_PER_INCH / 6.0}


def checked_svg(content: bytes) -> tuple[bytes, float | None, tuple[str, ...]]:
    """Return a document that is safe to unfold.

    Returns
    -------
    content : bytes
        The document without unpainted parts, symbols moved into definitions.
    width_mm : float or None
        Width of the page, when it is stated in mm, cm, in, pt or pc.
    notes : tuple of str

    Raises
    ------
    TargetError
        Compressed, with entity declarations, not well-formed, not SVG, or unfolding without end.
    """
    if content.startswith(b"\x1f\x8b"):
        raise TargetError("svg.compressed")
    # Without the zero bytes UTF-16 text is searched as well.
    if b"<!entity" in content.replace(b"\0", b"").lower():
        raise TargetError("svg.entities")
    refuse_long_numbers(content)
    try:
        root = ElementTree.fromstring(content)
    except ElementTree.ParseError as error:
        raise TargetError("svg.not_well_formed", reason=str(error)) from error
    if _tag(root) != "svg":
        raise TargetError("svg.other_root", tag=_tag(root))
    _refuse_bombs(root)
    clipped = any(element.get("clip-path") or element.get("mask") for element in root.iter())
    _drop_unpainted(root)
    notes = (tr("Clip paths and masks are ignored. Cut the shape itself if it looks different."),) if clipped else ()
    width = REAL_LENGTH.fullmatch(root.get("width", ""))
    width_mm = float(width[1]) * MM_PER_UNIT[width[2].lower()] if width else None
    return ElementTree.tostring(root), width_mm, notes


def self_contained_svg(content: bytes) -> bytes:
    """Return a document that shows the same and leads to no other file: a drawing program would open them.

    Raises
    ------
    TargetError
        It shows pictures from other files; or as :func:`checked_svg`.
    """
    checked_svg(content)
    root = ElementTree.fromstring(content)
    for element in root.iter():
        reference = next((value for key, value in element.items() if key.rsplit("}", 1)[-1] == "href"), "").strip()
        if _tag(element) in PICTURES and reference and not reference.startswith("#"):
            _refuse_link(reference)
    # Written canonically, "<?" begins nothing but an instruction, such as one for the style sheet of another file.
    return INSTRUCTION.sub("", ElementTree.canonicalize(content)).encode()


def _refuse_link(reference: str) -> None:
    """Refuse to show anything but pixels that the document holds itself."""
    head, _, packed = reference.partition(",")
    if not head.lower().startswith("data:"):
        raise TargetError("svg.linked_picture", link=reference)
    try:
        pixels = base64.b64decode("".join(packed[:64].split())[:24])
    except ValueError:
        pixels = b""
    if not head.lower().endswith(";base64") or not pixels.startswith(PIXELS):
        raise TargetError("svg.picture_inside")


def refuse_long_numbers(content: bytes) -> None:
    """Refuse a document with numbers of more than ``MOST_DIGITS`` digits: svgelements needs hours for them.

    Raises
    ------
    TargetError
        It has one.
    """
    # Without the zero bytes UTF-16 text is searched as well.
    if DIGITS.search(content.replace(b"\0", b"")):
        raise TargetError("svg.number_too_long", limit=MOST_DIGITS)


def _tag(element: Element) -> str:
    """Tag without its namespace; comments and instructions have none."""
    return element.tag.rsplit("}", 1)[-1] if isinstance(element.tag, str) else ""


def _reference(element: Element) -> str:
    return (element.get("href") or element.get("{http://www.w3.org/1999/xlink}href") or "").removeprefix("#")


def _refuse_bombs(root: Element) -> None:
    """Count the elements after every ``use`` is replaced by what it refers to."""
    named = {name: element for element in root.iter() if (name := element.get("id"))}
    counted: dict[Element, tuple[int, int]] = {}
    inside: set[Element] = set()

    def count(element: Element) -> tuple[int, int]:
        """Elements and numbers."""
        if element in counted:
            return counted[element]
        if element in inside:
            raise TargetError("svg.inside_itself", tag=_tag(element))
        inside.add(element)
        below = [count(child) for child in element]
        if _tag(element) == "use" and (target := named.get(_reference(element))) is not None:
            below.append(count(target))
        own = sum(1 for _ in NUMBER.finditer(element.get("d", "") or element.get("points", "")))
        inside.discard(element)
        counted[element] = 1 + sum(one for one, _ in below), own + sum(other for _, other in below)
        return counted[element]

    elements, numbers = count(root)
    if elements > MOST_ELEMENTS:
        raise TargetError("svg.too_many_elements", elements=elements, limit=MOST_ELEMENTS)
    if numbers > MOST_NUMBERS:
        raise TargetError("svg.too_many_numbers", limit=MOST_NUMBERS)


def _drop_unpainted(root: Element) -> None:
    """Remove what paints nothing; a symbol becomes a group in definitions, drawn only where it is used."""
    for parent in list(root.iter()):
        namespace = parent.tag[: parent.tag.index("}") + 1] if isinstance(parent.tag, str) and "}" in parent.tag else ""
        for child in list(parent):
            if _tag(child) in UNPAINTED:
                parent.remove(child)
            elif _tag(child) == "symbol":
                child.tag = f"{namespace}g"
                definitions = Element(f"{namespace}defs")
                definitions.append(child)
                parent[list(parent).index(child)] = definitions
