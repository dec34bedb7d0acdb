"""Style sheets and attributes of an SVG -> the properties of each element.

The cascade is CSS's: selectors by cssselect2, declarations and colours by tinycss2, order and inheritance here.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any
from xml.etree.ElementTree import Element

import cssselect2 as untyped_cssselect2
import tinycss2 as untyped_tinycss2
from tinycss2 import color4 as untyped_color4

from kirigami_studio.foundation.errors import TargetError

#: Their calls carry no types.
cssselect2: Any = untyped_cssselect2
tinycss2: Any = untyped_tinycss2
color4: Any = untyped_color4

#: Letters of all style sheets together without embedded files; rules; tests of selectors that look at many elements.
MOST_STYLE, MOST_RULES, MOST_TESTS = 300_000, 5_000, 3_000_000
#: Spaces of CSS Color 4 that are measured as light, and those of hues; the others have red, green and blue.
OF_LIGHT = frozenset({"lab", "lch", "oklab", "oklch", "xyz", "xyz-d50", "xyz-d65"})
OF_HUE = frozenset({"hsl", "hwb"})
#: How deep variables lead to each other, and how long one value may become.
DEEPEST_VARIABLE, LONGEST_VALUE = 16, 4_000
EMBEDDED = re.compile(r"url\(\s*[\"']?data:[^)]*\)", re.IGNORECASE)
#: Parts of a selector for which a test looks at all ancestors, or at all elements beside or below one.
WIDE = re.compile(r":(?:nth|has|first-of|last-of|only|last)|~(?!=)", re.IGNORECASE)
DEEP = re.compile(r"(?<=[^\s>+~,(])\s+(?=[^\s>+~,)])")
#: Media for which a drawing is painted on a screen in an ordinary window.
MEDIA = re.compile(r"\s*(?:only\s+)?(?:all|screen)?\s*", re.IGNORECASE)

#: Properties that an element takes from the one around it.
INHERITED = frozenset(
    {"clip-rule", "color", "fill", "fill-opacity", "fill-rule", "font-family", "font-size", "font-style", "font-weight"}
    | {"stroke", "stroke-linecap", "stroke-linejoin", "stroke-miterlimit", "stroke-opacity", "stroke-width"}
    | {"text-anchor", "visibility", "marker-start", "marker-mid", "marker-end"}
)
#: Properties that are attributes, too.
PRESENTATION = (
    INHERITED
    | {"clip-path", "display", "filter", "mask", "opacity", "overflow", "stop-color", "stop-opacity", "transform"}
    | {"transform-origin", "vector-effect"}
)
FONT = re.compile(
    r"(?P<style>(?:[\w-]+\s+)*?)(?P<size>[\d.]+[a-z%]*)(?:\s*/\s*\S+)?\s+(?P<family>\S.*)", re.IGNORECASE | re.DOTALL
)
REFERENCE = re.compile(r"\s*url\(\s*[\"']?#(?P<name>[^\"')]*)[\"']?\s*\)\s*(?P<otherwise>.*)", re.DOTALL)

Properties = Mapping[str, str]


class Cascade:
    """The declared properties of every element of a document.

    Raises
    ------
    TargetError
        The style sheets are too long, or their selectors would be tested too often.
    """

    def __init__(self, root: Element) -> None:
        self._attributes: dict[str, list[tuple[str, str, bool]]] = {}
        matcher = cssselect2.Matcher()
        tests = _add_rules(matcher, "".join(_sheets(root)))
        self._ruled: dict[Element, list[tuple[str, str, bool]]] = {}
        if matcher.order == 0:
            return
        count, depth, width = _shape(root)
        for deep, wide in tests:
            if count * float(depth) ** deep * float(width) ** wide > MOST_TESTS:
                raise TargetError("svg.style_too_large")
        for wrapped in cssselect2.ElementWrapper.from_xml_root(root).iter_subtree():
            found = [
                declaration for *_, pseudo, rule in matcher.match(wrapped) if pseudo is None for declaration in rule
            ]
            if found:
                self._ruled[wrapped.etree_element] = found

    def declared(self, element: Element) -> dict[str, str]:
        """The properties that an element has of its own, by name."""
        style = element.get("style", "")
        if style not in self._attributes:
            self._attributes[style] = declarations(tinycss2.parse_blocks_contents(style[:MOST_STYLE]))
        found = {name: element.attrib[name].strip() for name in PRESENTATION & element.attrib.keys()}
        attribute, ruled = self._attributes[style], self._ruled.get(element, ())
        for important in (False, True):
            for name, value, is_important in (*ruled, *attribute) if not important else (*attribute, *ruled):
                if is_important is important:
                    found[name] = value
        return found


def _sheets(root: Element) -> Iterator[str]:
    room = MOST_STYLE
    for element in root.iter():
        if isinstance(element.tag, str) and element.tag.rpartition("}")[2] == "style":
            if element.get("type", "text/css").strip().lower() not in ("", "text/css"):
                continue
            text = EMBEDDED.sub("none", "".join(element.itertext()))
            room -= len(text)
            if room < 0:
                raise TargetError("svg.style_too_large")
            yield text + "\n"


def _shape(root: Element) -> tuple[int, int, int]:
    """Elements of a document, how deep they lie, and how many lie in one at most."""
    count, depth, width, level = 0, 0, 1, [root]
    while level:
        count, depth, width = count + len(level), depth + 1, max(width, *(len(element) for element in level))
        level = [child for element in level for child in element]
    return count, depth, width


def _add_rules(matcher: Any, sheet: str) -> list[tuple[int, int]]:
    """Add the rules of a style sheet; how many ancestors and neighbours each selector looks at."""
    tests = []
    waiting = tinycss2.parse_stylesheet(sheet, skip_comments=True, skip_whitespace=True)
    while waiting:
        inner: list[Any] = []
        for rule in waiting:
            is_media = rule.type == "at-rule" and rule.lower_at_keyword == "media" and rule.content is not None
            if is_media and MEDIA.fullmatch(tinycss2.serialize(rule.prelude)):
                inner += tinycss2.parse_rule_list(rule.content, skip_comments=True, skip_whitespace=True)
            if rule.type != "qualified-rule":
                continue
            found = declarations(tinycss2.parse_blocks_contents(rule.content))
            try:
                selectors = cssselect2.compile_selector_list(rule.prelude)
            except cssselect2.SelectorError:
                continue  # a rule that is not understood does not count, as CSS has it
            for selector in selectors if found else ():
                matcher.add_selector(selector, found)
            if matcher.order > MOST_RULES:
                raise TargetError("svg.style_too_large")
            words = tinycss2.serialize(rule.prelude).strip()
            deep, wide = len(DEEP.findall(words)), len(WIDE.findall(words))
            if deep or wide:
                tests.append((deep, wide))
        waiting = inner
    return tests


def declarations(parsed: Iterable[Any]) -> list[tuple[str, str, bool]]:
    """Name, value and importance of the declarations in a block."""
    found = []
    for one in parsed:
        if one.type == "declaration":
            name, value = (
                one.name if one.name.startswith("--") else one.lower_name,
                tinycss2.serialize(one.value).strip(),
            )
            if name == "font" and (font := FONT.fullmatch(value)):
                found += [(f"font-{part}", font[part], one.important) for part in ("size", "family")]
                for word in font["style"].split():
                    kind = "style" if word in ("italic", "oblique") else "weight"
                    found.append((f"font-{kind}", word, one.important))
            elif name == "marker":
                found += [(f"marker-{end}", value, one.important) for end in ("start", "mid", "end")]
            found.append((name, value, one.important))
    return found


def computed(declared: Properties, outer: Properties) -> dict[str, str]:
    """The properties of an element in one with the properties ``outer``."""
    values = {name: text for name, text in outer.items() if name in INHERITED or name.startswith("--")}
    values.update((name, text) for name, text in declared.items() if name.startswith("--"))
    for name, text in declared.items():
        if name.startswith("--"):
            continue
        known = substituted(text, values) if "var(" in text else text
        word = "unset" if known is None else known.lower()
        if word in ("inherit", "unset", "revert", "revert-layer", "initial"):
            keeps = word == "inherit" or (word != "initial" and name in INHERITED)
            if keeps and name in outer:
                values[name] = outer[name]
            else:
                values.pop(name, None)
        elif known is not None:
            values[name] = known
    return values


def substituted(text: str, values: Properties, depth: int = 0) -> str | None:
    """A value with its variables replaced; None where one is not known."""
    if depth > DEEPEST_VARIABLE or len(text) > LONGEST_VALUE:
        return None
    found = _without_variables(tinycss2.parse_component_value_list(text), values, depth)
    return found if found is None or len(found) <= LONGEST_VALUE else None


def _without_variables(tokens: Sequence[Any], values: Properties, depth: int) -> str | None:
    words: list[str] = []
    for token in tokens:
        if token.type == "function" and token.lower_name == "var":
            name = next((one.value for one in token.arguments if one.type == "ident"), "")
            comma = next((place for place, one in enumerate(token.arguments) if one == ","), None)
            stated = values.get(name)
            if stated is None and comma is not None:
                stated = tinycss2.serialize(token.arguments[comma + 1 :])
            value = None if stated is None else substituted(stated.strip(), values, depth + 1)
        elif token.type == "function":
            inside = _without_variables(token.arguments, values, depth)
            value = None if inside is None else f"{token.name}({inside})"
        else:
            value = token.serialize()
        if value is None or sum(map(len, words)) > LONGEST_VALUE:
            return None
        words.append(value)
    return "".join(words)


def colour_of(text: str, current: str = "black") -> tuple[float, float, float, float] | None:
    """Red, green, blue and opacity, 0..1 each, of a colour of CSS; None where it is none.

    Parameters
    ----------
    current : str
        The colour that ``currentColor`` stands for.
    """
    colour = color4.parse_color(text)
    if isinstance(colour, str):  # currentcolor
        colour = color4.parse_color(current)
    if colour is None or isinstance(colour, str):
        return None
    channels = (*_srgb(colour), float(colour.alpha))
    red, green, blue, opacity = (min(max(value, 0.0), 1.0) if math.isfinite(value) else 0.0 for value in channels)
    return red, green, blue, opacity


def _srgb(colour: color4.Color) -> list[float]:
    """Red, green and blue of a colour in any space of CSS Color 4; white is white in each.

    Channels of other screens' primaries count as those of sRGB: only hues of saturated colours differ.
    """
    if colour.space in OF_LIGHT:
        from skimage.color import lab2rgb  # few drawings need it

        lightness, a, b, _ = colour.to("lab")
        return [float(value) for value in lab2rgb([lightness, a, b])]
    values = [float(value or 0.0) for value in (colour.to("srgb") if colour.space in OF_HUE else colour)][:3]
    if colour.space == "srgb-linear":  # the transfer function of IEC 61966-2-1
        return [12.92 * value if value <= 0.0031308 else 1.055 * value ** (1.0 / 2.4) - 0.055 for value in values]
    return values


def share_of(stated: str | None, otherwise: float = 1.0) -> float:
    """An opacity, 0..1, from a number or a percentage."""
    text = (stated or "").strip()
    try:
        value = float(text.removesuffix("%")) / (100.0 if text.endswith("%") else 1.0)
    except ValueError:
        return otherwise
    return min(max(value, 0.0), 1.0) if math.isfinite(value) else otherwise
