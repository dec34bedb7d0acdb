"""Checks on an SVG before it is unfolded: no bombs, no entities but short plain texts."""

from __future__ import annotations

import base64
import contextlib
import re
import xml.etree.ElementTree as ElementTree
from xml.etree.ElementTree import Element
from xml.parsers import expat

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.units import MM_PER_INCH

#: ``use`` elements repeat others; a drawing that unfolds to more elements than this is no outline.
MOST_ELEMENTS = 20_000
#: Numbers of all paths together, and digits of one: decoders take a long time for more.
MOST_NUMBERS = 300_000
MOST_DIGITS = 64
#: Plain entities of a document, letters of one, and letters that all references to them may stand for.
MOST_ENTITIES, LONGEST_ENTITY, MOST_ENTITY_LETTERS = 200, 1_000, 1_000_000
DIGITS = re.compile(rb"\d{%d}" % (MOST_DIGITS + 1))
NUMBER = re.compile(r"\d+(?:\.\d*)?|\.\d+")

#: Elements that show what a link leads to.
PICTURES = frozenset({"image", "feImage"})
#: What files of pixels begin with: PNG, JPEG, GIF, BMP, WebP.
PIXELS = (b"\x89PNG", b"\xff\xd8", b"GIF8", b"BM", b"RIFF")
INSTRUCTION = re.compile(r"<\?.*?\?>", re.DOTALL)
REAL_LENGTH = re.compile(r"\s*\+?(\d+\.?\d*|\.\d+)(mm|cm|in|pt|pc)\s*", re.IGNORECASE)
MM_PER_UNIT = {"mm": 1.0, "cm": 10.0, "in": MM_PER_INCH, "pt": MM_PER_INCH / 72.0, "pc": MM_PER_INCH / 6.0}


class _PrologueEndError(Exception):
    """Everything before the first element was read."""


def checked_svg(content: bytes) -> tuple[Element, float | None]:
    """Return a document that is safe to unfold.

    Returns
    -------
    root : Element
    width_mm : float or None
        Width of the page, when it is stated in mm, cm, in, pt or pc.

    Raises
    ------
    TargetError
        Compressed, with entities that are no short plain texts, not well-formed, not SVG, or unfolding without end.
    """
    if content.startswith(b"\x1f\x8b"):
        raise TargetError("svg.compressed")
    refuse_long_numbers(content)
    try:
        _check_entities(content)
        root = ElementTree.fromstring(content)
    except (ElementTree.ParseError, expat.ExpatError) as error:
        raise TargetError("svg.not_well_formed", reason=str(error)) from error
    if tag_of(root) != "svg":
        raise TargetError("svg.other_root", tag=tag_of(root))
    _refuse_bombs(root)
    width = REAL_LENGTH.fullmatch(root.get("width", ""))
    return root, float(width[1]) * MM_PER_UNIT[width[2].lower()] if width else None


def _check_entities(content: bytes) -> None:
    """Refuse entities that lead to other files or to each other, or stand for a lot."""
    # Without the zero bytes UTF-16 text is searched as well.
    plain = content.replace(b"\0", b"")
    if b"<!entity" not in plain.lower():
        return
    found: dict[str, str] = {}

    def declared(name: str, is_parameter: bool, value: str | None, *_: object) -> None:
        if is_parameter or value is None or "&" in value or "<" in value or len(value) > LONGEST_ENTITY:
            raise TargetError("svg.entities")
        found[name] = value

    def begun(*_: object) -> None:
        raise _PrologueEndError

    parser = expat.ParserCreate()
    parser.EntityDeclHandler = declared
    parser.StartElementHandler = begun
    with contextlib.suppress(_PrologueEndError):
        parser.Parse(content, True)
    letters = sum(plain.count(b"&%s;" % name.encode()) * len(value) for name, value in found.items())
    if len(found) > MOST_ENTITIES or letters > MOST_ENTITY_LETTERS:
        raise TargetError("svg.entities")


def self_contained_svg(content: bytes) -> bytes:
    """Return a document that shows the same and leads to no other file: a drawing program would open them.

    Raises
    ------
    TargetError
        It shows pictures from other files; or as :func:`checked_svg`.
    """
    root, _ = checked_svg(content)
    for element in root.iter():
        reference = next((value for key, value in element.items() if key.rsplit("}", 1)[-1] == "href"), "").strip()
        if tag_of(element) in PICTURES and reference and not reference.startswith("#"):
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


def tag_of(element: Element) -> str:
    """Tag without its namespace; comments and instructions have none."""
    return element.tag.rsplit("}", 1)[-1] if isinstance(element.tag, str) else ""


def reference_of(element: Element) -> str:
    """Id of the element that another one links to; "" without a link."""
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
            raise TargetError("svg.inside_itself", tag=tag_of(element))
        inside.add(element)
        below = [count(child) for child in element]
        if tag_of(element) == "use" and (target := named.get(reference_of(element))) is not None:
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
