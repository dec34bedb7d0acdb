"""Document <-> ``.kiri`` file: a zip that is written atomically, and read within limits of size and number."""

from __future__ import annotations

import hashlib
import io
import json
import re
import zipfile
import zlib
from dataclasses import dataclass, replace
from pathlib import Path

from kirigami_studio import __version__
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.export.design_record import record_in
from kirigami_studio.fabricate.machine import machines
from kirigami_studio.fabricate.material import library
from kirigami_studio.fabricate.shelf import Contents, Item
from kirigami_studio.foundation.errors import KirigamiError, ProjectError
from kirigami_studio.foundation.files import read_at_most, write_atomically
from kirigami_studio.project import migrations
from kirigami_studio.project.artwork_record import PICTURES, artwork_members, artwork_of
from kirigami_studio.project.codec import decode, encode
from kirigami_studio.project.document import MOST_PARTS, Document
from kirigami_studio.project.edits import ALONE
from kirigami_studio.project.json_record import Record, read_json
from kirigami_studio.project.migrations import Members, migrate
from kirigami_studio.project.picture_record import TracedPicture, picture_members, picture_of
from kirigami_studio.settings.fabrication import stored_machine, stored_material

SUFFIX = ".kiri"
#: Kinds of cut file that carry the design they came from.
CUT_FILES = (".dxf", ".svg")
MANIFEST = "manifest.json"
FORMAT = "kirigami-studio project"

#: 1024 candidates at 64 x 64 are 34 MB of ratios; whatever unpacks to more is no project.
LARGEST_FILE = 64 * 2**20
LARGEST_CONTENT = 128 * 2**20
MOST_MEMBERS = 16
#: Members of other parts of the target are counted by themselves: each part has its design and two arrays.
OF_A_PART, MOST_OF_PARTS = re.compile(r"part-\d{1,3}-[a-z.]{1,16}"), 3 * (MOST_PARTS - 1)
#: The zip format's first day: the same document gives the same bytes on every day.
_FIXED_DATE = (1980, 1, 1, 0, 0, 0)


@dataclass(frozen=True, slots=True)
class Opened:
    """What a project file holds."""

    document: Document
    picture: TracedPicture | None = None  #: what the target was traced from
    notes: tuple[str, ...] = ()  #: what had to be left out, in sentences
    digest: str = ""  #: SHA-256 of the file


def save(document: Document, path: Path | str, picture: TracedPicture | None = None) -> str:
    """Write the project file with its own material and picture; an older one at ``path`` survives any failure.

    Returns
    -------
    digest : str
        SHA-256 of the file.

    Raises
    ------
    ExportError
        The file cannot be written.
    """
    content = pack(with_stored_values(document), picture)
    write_atomically(Path(path), content)
    return hashlib.sha256(content).hexdigest()


def with_stored_values(document: Document) -> Document:
    """The document as it is saved, with the numbers of an own material and an own machine."""
    settings = document.fabrication
    own = _own(library(), settings.material, stored_material(settings))
    machine = _own(machines(), settings.machine, stored_machine(settings))
    if (own, machine) == (settings.own, settings.own_machine):
        return document
    return replace(document, fabrication=replace(settings, own=own, own_machine=machine))


def _own(known: Contents[Item], key: str, stored: Item | None) -> Item | None:
    """The user's own value of a key, or else the stored one; None for a bundled one."""
    if key not in known.items:
        return stored
    return known.items[key] if key in known.own else None


def digest_on_disk(path: Path) -> str | None:
    """SHA-256 of the file that is there now; None where there is none that could be read."""
    try:
        return hashlib.sha256(read_at_most(path, LARGEST_FILE)).hexdigest()
    except (OSError, ValueError):
        return None


def pack(document: Document, picture: TracedPicture | None = None) -> bytes:
    """Return the project file's bytes; equal documents and pictures give equal bytes."""
    manifest = {"format": FORMAT, "version": migrations.CURRENT_VERSION, "app_version": __version__}
    members = {MANIFEST: json.dumps(manifest, indent=1).encode(), **encode(document)}
    members |= {**artwork_members(document.artwork), **picture_members(picture)}
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name, content in members.items():
            entry = zipfile.ZipInfo(name, _FIXED_DATE)
            # A PNG or JPEG does not get smaller.
            packed = name in PICTURES or (picture is not None and name == picture.member)
            entry.compress_type = zipfile.ZIP_STORED if packed else zipfile.ZIP_DEFLATED
            entry.create_system = 3
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, content)
    return stream.getvalue()


def packed_design(document: Document, candidate: Candidate) -> bytes:
    """The project with this design alone, chosen, as a cut file carries it; without pictures."""
    return pack(with_stored_values(replace(_alone(document, candidate), **ALONE)))


def packed_designs(document: Document) -> bytes:
    """The same with the chosen design of every part of the target."""
    parts = [part if part.candidate is None else _alone(part, part.candidate) for part in document.parts]
    number = document.part
    others = (*parts[:number], *parts[number + 1 :])
    return pack(with_stored_values(replace(parts[number], other_parts=others, part=number)))


def _alone(document: Document, candidate: Candidate) -> Document:
    """The document with one design, chosen, and no picture."""
    label = document.label_of(candidate)
    labels = () if label is None else (label,)
    return replace(document, candidates=(candidate,), chosen=0, marks=(), labels=labels, artwork=None)


def load(path: Path | str) -> Document:
    """Read a project file without its picture, see :func:`load_all`."""
    return load_all(path).document


def load_all(path: Path | str) -> Opened:
    """Read a project file, or the design that a cut file of this program carries.

    A picture or artwork that cannot be read is left out, and a note says so.

    Raises
    ------
    ProjectError
        No such file, no project, damaged (code ``project.damaged``), or of a newer format (``project.newer_format``).
    """
    path = Path(path)
    content = _read_file(path)
    digest = hashlib.sha256(content).hexdigest()
    if path.suffix.lower() in CUT_FILES:
        record = record_in(content)
        if record is None:
            raise ProjectError("project.no_design_in_file", path=path)
        content = record
    try:
        members = _unpack(content)
        version = _version(members)
    except KirigamiError as error:
        raise ProjectError("project.damaged", path=path, reason=error) from error
    members = migrate(members, version, path)
    try:
        document = decode(members)
    except KirigamiError as error:
        raise ProjectError("project.damaged", path=path, reason=error) from error
    notes, picture = [], None
    try:
        document = replace(document, artwork=artwork_of(members))
    except ProjectError as error:
        notes.append(str(error))
    try:
        picture = picture_of(members)
    except ProjectError as error:
        notes.append(str(error))
    return Opened(document, picture, tuple(notes), digest)


def _version(members: Members) -> int:
    """Format version by the manifest."""
    if MANIFEST not in members:
        raise ProjectError("project.member_missing", name=MANIFEST)
    manifest = Record(read_json(members[MANIFEST], MANIFEST), MANIFEST)
    version = manifest.whole("version")
    if manifest.text("format") != FORMAT or version < 1:
        raise ProjectError("project.not_a_manifest", name=MANIFEST)
    return version


def _read_file(path: Path) -> bytes:
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise ProjectError("project.file_too_large", path=path, limit=LARGEST_FILE // 2**20)
        return read_at_most(path, LARGEST_FILE)
    except OSError as error:
        raise ProjectError("project.not_readable", path=path, reason=error.strerror or str(error)) from error
    except ValueError as error:  # a null character in the name
        raise ProjectError("project.not_a_file_name", path=str(path)) from error


def _unpack(content: bytes) -> Members:
    """Read every member of the zip, all of them within one size limit whatever their headers claim."""
    members: dict[str, bytes] = {}
    budget = LARGEST_CONTENT
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            entries = archive.infolist()
            of_parts = sum(OF_A_PART.fullmatch(entry.filename) is not None for entry in entries)
            if len(entries) - of_parts > MOST_MEMBERS or of_parts > MOST_OF_PARTS:
                raise ProjectError("project.too_many_members", members=len(entries), limit=MOST_MEMBERS)
            for entry in entries:
                members[entry.filename] = _read_member(archive, entry, budget)
                budget -= len(members[entry.filename])
    except (zipfile.BadZipFile, zlib.error, EOFError, OSError, ValueError, RuntimeError) as error:
        # RuntimeError: zipfile's word for an encrypted member.
        raise ProjectError("project.not_a_zip", reason=str(error)) from error
    return members


def _read_member(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, budget: int) -> bytes:
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise ProjectError("project.foreign_compression", name=entry.filename)
    with archive.open(entry) as stream:
        content = stream.read(budget + 1)
    if len(content) > budget:
        raise ProjectError("project.content_too_large", limit=LARGEST_CONTENT // 2**20)
    return content
