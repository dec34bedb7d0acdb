"""Damaged copies of files: bytes flipped, left out, repeated, crossed with others; and by what each kind is made of.

A mutation keeps so much of the structure that it gets past the first check: a PNG's checksums and a zip's directory
are made anew, JSON stays JSON.  Same draw, same file.

Why no fuzzing library: what is damaged are whole files of eight kinds, so a library would only bring the loop.
Hypothesis searches values a test can state and shrinks them; a file of 20 kB mutated token by token is none, and its
database and health checks cost more than the readers.  Atheris follows branches in Python code, but most of the work
here is done in C (zlib, expat, Pillow, NumPy, Qt), it has no wheels for all Pythons and systems that the program is
tested on, and its finds would need this runner anyway, for the limits of time and memory.
"""

from __future__ import annotations

import io
import json
import random
import re
import struct
import zipfile
import zlib
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

#: Longest damaged file; longer ones only take longer.
LONGEST = 300_000
NUMBER = re.compile(rb"-?\d+(?:\.\d+)?")
#: What numbers become.
NUMBERS = (b"0", b"-1", b"1e400", b"-1e308", b"1e-320", b"nan", b"inf", b"9" * 400, b"2147483648", b"0x10", b"1e9", b"")
#: What words and values become.
WORDS = (
    "", " ", "0", "-1", "1e400", "NaN", "-Infinity", "nan", "none", "null", "true", "\0", "\ufeff", "\U0001f600",
    "../../etc/passwd", "file:///etc/passwd", "http://localhost:9/", "%s%n", "{0}", "x" * 70_000, "9" * 5000, "-" * 300,
)  # fmt: skip
#: Archives that unpack to more (bytes) are only damaged as they are.
MOST_UNPACKED = 2_000_000
#: How deep lists and elements are nested.
DEPTHS = (10, 900, 5_000)

Mutation = Callable[[bytes, bytes, random.Random], bytes]


def mutated(content: bytes, others: Sequence[bytes], draw: random.Random) -> bytes:
    """A damaged copy, at times crossed with another file."""
    for _ in range(draw.choice((1, 1, 2, 4))):
        own = KINDS.get(kind_of(content), ())
        chosen = draw.choice(own) if own and draw.random() < 0.6 else draw.choice(PLAIN)
        content = chosen(content, draw.choice(others), draw)
    return content[:LONGEST]


def kind_of(content: bytes) -> str:
    """What a file seems to be by its first bytes."""
    beginnings = {b"PK": "zip", b"\x89PNG": "png", b"\x93NUMPY": "npy", b"{": "json", b"[[": "json"}
    for beginning, kind in beginnings.items():
        if content.startswith(beginning):
            return kind
    if content[8:9] == b"{" and content[3:8] == bytes(5):
        return "safetensors"
    if b"<svg" in content[:2000]:
        return "svg"
    if content.lstrip()[:2] in (b"0\n", b"0\r", b"99"):
        return "dxf"
    return "toml" if re.search(rb"^\w+ = ", content, re.MULTILINE) else ""


# bytes ----------------------------------------------------------------------------------------------------------------


def _flipped(content: bytes, _: bytes, draw: random.Random) -> bytes:
    found = bytearray(content)
    for _number in range(draw.choice((1, 3, 10)) if found else 0):
        found[draw.randrange(len(found))] = draw.randrange(256)
    return bytes(found)


def _span(content: bytes, draw: random.Random) -> tuple[int, int]:
    first = draw.randrange(len(content) + 1)
    return first, min(len(content), first + draw.choice((1, 4, 20, 100, 1000)))


def _without(content: bytes, _: bytes, draw: random.Random) -> bytes:
    first, last = _span(content, draw)
    return content[:first] + content[last:]


def _repeated(content: bytes, _: bytes, draw: random.Random) -> bytes:
    first, last = _span(content, draw)
    return content[:last] + content[first:last] * draw.choice((1, 5, 200)) + content[last:]


def _crossed(content: bytes, other: bytes, draw: random.Random) -> bytes:
    first, last = _span(other, draw)
    place = draw.randrange(len(content) + 1)
    return content[:place] + other[first:last] + content[place:]


def _spliced(content: bytes, other: bytes, draw: random.Random) -> bytes:
    """The beginning of one file and the end of another."""
    return content[: draw.randrange(len(content) + 1)] + other[draw.randrange(len(other) + 1) :]


def _renumbered(content: bytes, _: bytes, draw: random.Random) -> bytes:
    found = list(NUMBER.finditer(content))
    if not found:
        return content
    chosen = draw.choice(found)
    return content[: chosen.start()] + draw.choice(NUMBERS) + content[chosen.end() :]


def _cut(content: bytes, _: bytes, draw: random.Random) -> bytes:
    return content[: draw.randrange(len(content) + 1)]


def _filled(content: bytes, _: bytes, draw: random.Random) -> bytes:
    """A stretch of one byte in the place of what was there."""
    first, last = _span(content, draw)
    return content[:first] + draw.choice((b"\0", b"\xff", b" ", b"\n", b"9")) * (last - first) + content[last:]


PLAIN: tuple[Mutation, ...] = (
    _flipped, _flipped, _without, _repeated, _crossed, _spliced, _renumbered, _renumbered, _cut, _filled
)  # fmt: skip


# JSON -----------------------------------------------------------------------------------------------------------------

_NEST = "\ue000nest\ue000"


def _json_changed(content: bytes, other: bytes, draw: random.Random) -> bytes:
    """One entry of a JSON text dropped, doubled, renamed, nested or made something else."""
    try:
        root = json.loads(content)
    except (ValueError, RecursionError):
        return _flipped(content, b"", draw)
    places = _json_places(root)
    if not places:
        return content
    holder, key = draw.choice(places)
    change = draw.randrange(6)
    if change == 0:
        del holder[key]
    elif change == 1 and isinstance(holder, list):
        holder[key:key] = [holder[key]] * draw.choice((1, 3, 500))
    elif change == 2 and isinstance(holder, dict):
        holder[draw.choice(WORDS)] = holder.pop(key)
    elif change == 3:
        holder[key] = _NEST
    elif change == 4:
        from_holder, from_key = draw.choice(places)
        holder[key] = json.loads(json.dumps(from_holder[from_key]))
    else:
        holder[key] = draw.choice(_json_values())
    depth = draw.choice(DEPTHS)
    try:
        text = json.dumps(root)
    except RecursionError:  # an entry was put into a copy of itself, nested already
        return content
    text = text.replace(json.dumps(_NEST), "[" * depth + "]" * depth)
    return text.encode()


def _json_values() -> tuple[object, ...]:
    return (
        *WORDS, None, True, False, 0, -1, 1, 2**63, 10**400, -(10**18), 1e308, -1e308, 5e-324, float("nan"),
        float("inf"), [], {}, [[]], [None], [float("nan")] * 3, {"": {}}, list(range(2000)), [[0.0, 0.0]] * 500,
    )  # fmt: skip


def _json_places(root: Any) -> list[tuple[Any, Any]]:
    """Every (holder, key or index) of a JSON value, up to a few thousand."""
    places, waiting = list[tuple[Any, Any]](), [root]
    while waiting and len(places) < 5000:
        value = waiting.pop()
        if isinstance(value, dict):
            places += [(value, key) for key in value]
            waiting += value.values()
        elif isinstance(value, list):
            places += [(value, index) for index in range(min(len(value), 50))]
            waiting += value[:50]
    return places


# SVG ------------------------------------------------------------------------------------------------------------------

TAG = re.compile(r"<[^<>]*>")
ATTRIBUTE = re.compile(r'([\w:-]+)="([^"]*)"')
SVG_PIECES = (
    '<image href="file:///etc/passwd" width="9" height="9"/>', '<use href="#a"/>', '<g id="a"><use href="#a"/></g>',
    '<style>@import url("http://localhost:9/a.css");path{fill:url(file:///etc/passwd)}</style>', "<text>a</text>",
    '<path d="M0 0A1e9 1e-9 0 1 1 9 9Z"/>', '<path d="M0,0C1e300,1e300 -1e300,0 1,1Z"/>', '<path d="M0 0 L"/>',
    '<circle r="1e300"/>', '<ellipse rx="-1" ry="nan"/>', '<polygon points="0,0 1,0 1"/>', '<rect width="1e-320"/>',
    '<svg viewBox="0 0 0 0"><path d="M0 0h9v9z"/></svg>', '<g transform="matrix(0 0 0 0 0 0)">', "<g>", "</g>",
    "<![CDATA[", '<linearGradient id="a"/>',
    '<!DOCTYPE svg [<!ENTITY a SYSTEM "file:///etc/passwd">]>', "&a;", "<?xml-stylesheet href='file:///etc/passwd'?>",
    '<symbol id="b" viewBox="0 0 1 1"><path d="M0 0h1v1z"/></symbol><use href="#b" width="1e9"/>',
)  # fmt: skip
SVG_WORDS = (
    "1e400mm", "-1px", "0", "100%", "1em", "nanmm", "url(#a)", "url(file:///etc/passwd)", "rotate(1e308)", "scale(0)",
    "matrix(1 0 0 1 1e300 nan)", "skewX(90)", "translate(", "M0 0", "M0 0Q1 1", "MZMZ", "A1 1 0 2 2 3 3", "none",
    "currentColor", "0 0 0 0", "0 0 -5 1e9", "M" + "0 " * 9000, "rotate(1)" * 4000,
)  # fmt: skip


def _svg_changed(content: bytes, other: bytes, draw: random.Random) -> bytes:
    """An element dropped, doubled, nested in itself, put in; or an attribute made something else."""
    text = content.decode("latin-1")
    tags = list(TAG.finditer(text))
    if not tags:
        return content
    tag = draw.choice(tags)
    first, last = tag.span()
    change = draw.randrange(6)
    if change == 0:
        text = text[:first] + text[last:]
    elif change == 1:
        text = text[:last] + tag[0] * draw.choice((1, 5, 500)) + text[last:]
    elif change == 2:
        depth = draw.choice(DEPTHS)
        text = text[:last] + "<g>" * depth + "</g>" * depth + text[last:]
    elif change == 3:
        text = text[:last] + draw.choice(SVG_PIECES) + text[last:]
    else:
        attributes = list(ATTRIBUTE.finditer(tag[0]))
        if attributes:
            value = draw.choice(attributes)
            word = draw.choice(SVG_WORDS if draw.random() < 0.7 else WORDS)
            text = text[: first + value.start(2)] + word + text[first + value.end(2) :]
    return text.encode("utf-8" if not text.isascii() and draw.random() < 0.5 else "latin-1", "replace")


# DXF ------------------------------------------------------------------------------------------------------------------

DXF_ENTITIES = (
    b"LINE", b"LWPOLYLINE", b"POLYLINE", b"VERTEX", b"SEQEND", b"SPLINE", b"ARC", b"CIRCLE", b"ELLIPSE", b"INSERT",
    b"HATCH", b"SOLID", b"3DFACE", b"MTEXT", b"IMAGE", b"DIMENSION", b"XREF", b"BLOCK", b"ENDBLK", b"SECTION",
    b"ENDSEC", b"TABLE", b"EOF",
)  # fmt: skip
DXF_CODES = tuple(b"0 1 2 5 8 10 20 30 40 41 42 62 70 71 73 90 100 330 -5 1071 x 99999".split())
DXF_VALUES = (
    *NUMBERS, *DXF_ENTITIES, b"*U1", b"/etc/passwd", b"0", b"-32768", b"1000000", b"1e300", b"1e-300", b"3.4028235e38",
    b"FFFFFFFFFFFFFFFFFF", b"\xff\xfe", b"x" * 3000, b"%%U",
)  # fmt: skip


def _dxf_changed(content: bytes, other: bytes, draw: random.Random) -> bytes:
    """Pairs of code and value dropped, doubled, moved, or made others."""
    ending = b"\r\n" if b"\r\n" in content else b"\n"
    lines = content.split(ending)
    if len(lines) < 4:
        return _flipped(content, b"", draw)
    pair = 2 * draw.randrange(len(lines) // 2)
    count = 2 * draw.choice((1, 1, 3, 10))
    change = draw.randrange(7)
    if change == 0:
        del lines[pair : pair + count]
    elif change == 1:
        lines[pair:pair] = lines[pair : pair + count] * draw.choice((1, 4, 300))
    elif change == 2:
        there = 2 * draw.randrange(len(lines) // 2)
        lines[there:there] = lines[pair : pair + count]
    elif change == 3:
        lines[pair] = draw.choice(DXF_CODES)
    elif change == 4:
        lines[pair + 1 : pair + 2] = [draw.choice(DXF_VALUES)]
    elif change == 5:  # another kind of entity with the same entries
        named = [k + 1 for k in range(0, len(lines) - 1, 2) if lines[k].strip() == b"0"]
        if named:
            lines[draw.choice(named)] = draw.choice(DXF_ENTITIES)
    else:
        lines[pair:pair] = [draw.choice(DXF_CODES), draw.choice(DXF_VALUES)]
    return ending.join(lines)


# TOML and lines -------------------------------------------------------------------------------------------------------

TOML_VALUES = (
    "nan", "-inf", "1e400", "9" * 5000, "0x" + "f" * 300, "1979-05-27T07:32:00Z", "07:32:00", "[]", "[[]]", "{}",
    "{a = 1}", "''", "true", '"\\U00110000"', "[nan, nan, nan]", "-0.0", "1e-320", "0", "-1", '"x"', "[1, 'a', {}]",
    "1_000_000_000", "{a = {b = {c = {}}}}", '"' + "x" * 70_000 + '"', "[" * 900 + "]" * 900, "[" * 5000 + "]" * 5000,
)  # fmt: skip


def _toml_changed(content: bytes, other: bytes, draw: random.Random) -> bytes:
    """A line dropped, doubled, moved, renamed, or with another value."""
    lines = content.decode("utf-8", "replace").splitlines()
    if not lines:
        return content
    place = draw.randrange(len(lines))
    key, equals, _value = lines[place].partition("=")
    change = draw.randrange(7)
    if change == 0:
        del lines[place]
    elif change == 1:
        lines.insert(draw.randrange(len(lines)), lines[place])
    elif change == 2 and equals:
        lines[place] = f"{draw.choice(WORDS)} = {_value}"
    elif change == 3:
        lines.insert(
            place,
            draw.choice(
                ("[[a]]", "[a.b.c]", "[a]", "a.b = 1", "[", "=", "\t", '"" = 1', "." * 2000, "a" + ".a" * 2000 + "=1")
            ),
        )
    elif equals:
        lines[place] = f"{key}= {draw.choice(TOML_VALUES)}"
    return "\n".join(lines).encode("utf-8", "replace")


# PNG ------------------------------------------------------------------------------------------------------------------


def _png_changed(content: bytes, other: bytes, draw: random.Random) -> bytes:
    """Chunks dropped, doubled, swapped or changed, with right checksums; pixels changed before they are packed."""
    chunks = _png_chunks(content)
    if not chunks:
        return _flipped(content, b"", draw)
    place = draw.randrange(len(chunks))
    name, body = chunks[place]
    change = draw.randrange(6)
    if change == 0:
        del chunks[place]
    elif change == 1:
        chunks[place:place] = [(name, body)] * draw.choice((1, 30))
    elif change == 2 and chunks[0][0] == b"IHDR" and len(chunks[0][1]) == 13:
        head = bytearray(chunks[0][1])
        if draw.random() < 0.6:
            side = draw.choice((0, 1, 7, 1000, 60_000, 2**31 - 1, 2**32 - 1))
            struct.pack_into(">I", head, draw.choice((0, 4)), side)
        else:
            head[draw.randrange(8, 13)] = draw.choice((0, 1, 2, 3, 4, 6, 8, 16, 255))
        chunks[0] = (b"IHDR", bytes(head))
    elif change == 3:
        extra = draw.choice(
            (b"tEXt", b"zTXt", b"iTXt", b"iCCP", b"eXIf", b"PLTE", b"tRNS", b"gAMA", b"acTL", b"fcTL", b"fdAT")
        )
        text = draw.choice(
            (b"a\0b", b"a\0\0" + zlib.compress(bytes(9_000_000)), bytes(768), b"II*\0\xff\xff\xff\x7f", b"")
        )
        chunks.insert(draw.randrange(1, len(chunks) + 1), (extra, text))
    elif name == b"IDAT" and change == 4:
        try:
            chunks[place] = (name, zlib.compress(draw.choice(PLAIN)(zlib.decompress(body), b"\0", draw)))
        except zlib.error:
            chunks[place] = (name, zlib.compress(bytes(draw.choice((0, 1, 9_000_000)))))
    else:
        chunks[place] = (name, draw.choice(PLAIN)(body, other[:1000], draw))
    return content[:8] + b"".join(
        struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body)) for name, body in chunks
    )


def _png_chunks(content: bytes) -> list[tuple[bytes, bytes]]:
    chunks, place = [], 8
    while place + 12 <= len(content):
        (length,) = struct.unpack_from(">I", content, place)
        chunks.append((content[place + 4 : place + 8], content[place + 8 : place + 8 + length]))
        place += 12 + length
    return chunks


# arrays and archives --------------------------------------------------------------------------------------------------

NPY_TYPES = (
    "<f8",
    ">f4",
    "<i8",
    "|b1",
    "|O",
    "<U9",
    "<c16",
    "|V7",
    "<f2",
    "<M8[s]",
    "|S0",
    "[('a', '<f8')]",
    "f" * 999,
)
NPY_SHAPES = (
    "()",
    "(0,)",
    "(3, 4)",
    "(-1,)",
    "(2**62,)",
    "(4611686018427387904, 4)",
    "(1,)" * 3,
    "(1.5,)",
    "(" * 300,
    "3",
)


def _npy_changed(content: bytes, other: bytes, draw: random.Random) -> bytes:
    """Another type or shape in the header, which stays as long as it says; or other numbers."""
    length = int.from_bytes(content[8:10], "little")
    header, numbers = content[10 : 10 + length].decode("latin-1"), content[10 + length :]
    change = draw.randrange(4)
    if change == 0:
        header = re.sub(r"'descr': '[^']*'", lambda _: f"'descr': '{draw.choice(NPY_TYPES)}'", header)
    elif change == 1:
        header = re.sub(r"'shape': \([^)]*\)", lambda _: f"'shape': {draw.choice(NPY_SHAPES)}", header)
    elif change == 2:
        header = draw.choice(PLAIN)(header.encode("latin-1"), other[:200], draw).decode("latin-1")
    else:
        special = draw.choice((float("nan"), float("inf"), -1e308, 0.0, 5e-324, 1e300))
        place = 8 * draw.randrange(max(1, len(numbers) // 8))
        numbers = numbers[:place] + struct.pack("<d", special) + numbers[place + 8 :]
    packed = header.encode("latin-1")[:60_000]
    return content[:8] + len(packed).to_bytes(2, "little") + packed + numbers


def _zip_changed(content: bytes, other: bytes, draw: random.Random) -> bytes:
    """A member changed by its own kind, dropped, renamed, doubled, packed otherwise, or unpacking to a lot."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            if sum(entry.file_size for entry in archive.infolist()) > MOST_UNPACKED:  # damaged to be vast already
                return _flipped(content, b"", draw)
            members = [(name, archive.read(name)) for name in archive.namelist()]
    except Exception:
        return _flipped(content, b"", draw)
    packing = zipfile.ZIP_DEFLATED
    if members:
        place = draw.randrange(len(members))
        name, member = members[place]
        change = draw.randrange(12)
        if change == 0:
            del members[place]
        elif change == 1:
            members[place] = (
                draw.choice(("", "a/b", "../a", "/etc/a", "picture.png", "artwork.json", "a.npy", "\0")),
                member,
            )
        elif change == 2:
            members += members[place : place + 1] * draw.choice((1, 40))
        elif change == 3:
            packing = draw.choice((zipfile.ZIP_STORED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA))
        elif change == 4 and draw.random() < 0.1:
            return _vast(name)
        else:
            own = KINDS.get(kind_of(member), ()) or PLAIN
            for _ in range(draw.choice((1, 1, 2))):
                chosen = draw.choice(own) if draw.random() < 0.8 else draw.choice(PLAIN)
                member = chosen(member, members[draw.randrange(len(members))][1], draw)
            members[place] = (name, member)
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", packing) as archive:
        for name, member in members:
            if name not in archive.NameToInfo or draw.random() < 0.5:
                archive.writestr(zipfile.ZipInfo(name or "a"), member, packing)
    return stream.getvalue()


@cache
def _vast(name: str) -> bytes:
    """A member that unpacks to a thousand times as much."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(name or "a", bytes(200 * 2**20))
    return stream.getvalue()


def _tensors_changed(content: bytes, other: bytes, draw: random.Random) -> bytes:
    """Another header of a safetensors file, with its length; or another length."""
    length = int.from_bytes(content[:8], "little")
    header, rest = content[8 : 8 + length], content[8 + length :]
    change = draw.randrange(4)
    if change == 0:
        return draw.choice((0, 1, len(content), 2**32, 2**63, 2**64 - 1)).to_bytes(8, "little") + content[8:]
    if change == 1:
        return content[:-1] if draw.random() < 0.5 else content + b"\0"
    header = (_json_changed if change == 2 else draw.choice(PLAIN))(header, other[:500], draw)
    return len(header).to_bytes(8, "little") + header + rest


KINDS: dict[str, tuple[Mutation, ...]] = {
    "json": (_json_changed,),
    "svg": (_svg_changed,),
    "dxf": (_dxf_changed,),
    "toml": (_toml_changed,),
    "png": (_png_changed,),
    "npy": (_npy_changed,),
    "zip": (_zip_changed, _zip_changed, _zip_changed, _flipped),
    "safetensors": (_tensors_changed,),
}
