"""Artwork: read from a picture, laid on the sheet as one undo step, and painted for the design on the stage."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from PySide6.QtCore import QObject, Signal

from kirigami_studio.export.artwork import ArtPicture, Artwork, Laid
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.steps import Cancel
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.queue import JobCallbacks, LatestJob
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.stage.artwork_painting import (
    ShownArtwork,
    ShownPrint,
    painting_artwork,
    painting_on_pieces,
    reading_artwork,
)
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project import edits
from kirigami_studio.project.edits import LaidChange
from kirigami_studio.studio.making import CutRequest, MadePieces, Planned, has_pieces, printed_pieces

if TYPE_CHECKING:
    from kirigami_studio.evaluate.candidate import Candidate
    from kirigami_studio.export.artwork_pieces import PrintedPieces


class ArtworkKeeper(QObject):
    """Changes the document's artwork, and keeps the painted sheet of the design on the stage up to date."""

    painted = Signal(object)  #: ShownArtwork or ShownPrint, or None without artwork or design

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._reading = LatestJob[ArtPicture](session.queue)
        self._painting = LatestJob["ShownArtwork | ShownPrint"](session.queue)
        self._wanted: tuple[Artwork, object, Outline | None] | None = None
        self._pieces: tuple[Candidate, PrintedPieces | None] | None = None  # of the design that was planned last
        session.document_changed.connect(self._follow)
        session.display.stage_changed.connect(self._follow)

    def take(self, request: CutRequest, made: Planned | MadePieces) -> None:
        """The design on the stage was planned: where it is made of pieces, they show the artwork."""
        printed = printed_pieces(request, made) if request.has_layers else None
        self._pieces = (request.candidate, printed) if request.has_layers else None
        self._follow()

    def open(self, path: Path) -> None:
        """Read a picture and lay it where the one before lay, or over the opened sheet."""
        self._session.set_status(tr("Reading {name} …", name=path.name))
        callbacks = JobCallbacks(self._on_result, on_failed=self._refuse)
        self._reading.start(tr("reading {name}", name=path.name), partial(reading_artwork, path), callbacks)

    def open_second(self, path: Path) -> None:
        """Read a picture that shares the sheet with the first one by stripes."""
        self._session.set_status(tr("Reading {name} …", name=path.name))
        callbacks = JobCallbacks(self._on_second, on_failed=self._refuse)
        self._reading.start(tr("reading {name}", name=path.name), partial(reading_artwork, path), callbacks)

    def share(self, stripes: int) -> None:
        """Change the number of stripes."""
        artwork = self._session.document.artwork
        if artwork is not None:
            self._share(artwork.second, stripes)

    def remove_second(self) -> None:
        """Print the first picture alone."""
        artwork = self._session.document.artwork
        if artwork is not None:
            self._share(None, artwork.stripes)

    def place(self, **changes: Unpack[LaidChange]) -> None:
        """Lay the picture otherwise."""
        try:
            self._session.apply(edits.place_artwork(self._session.document, **changes))
        except KirigamiError as error:
            self._session.refuse(error)

    def remove(self) -> None:
        """Print nothing any more."""
        self._reading.stop()
        self._session.apply(edits.set_artwork(self._session.document, None))

    def stop(self) -> None:
        """Forget what is still being read: another document comes."""
        self._reading.stop()

    def _on_result(self, picture: ArtPicture) -> None:
        before = self._session.document.artwork
        if before is None:
            artwork = Artwork(Laid(picture))
        else:
            artwork = replace(before, first=replace(before.first, picture=picture))
        self._session.apply(edits.set_artwork(self._session.document, artwork))

    def _on_second(self, picture: ArtPicture) -> None:
        artwork = self._session.document.artwork
        if artwork is not None:
            self._share(picture, artwork.stripes)

    def _share(self, second: ArtPicture | None, stripes: int) -> None:
        try:
            self._session.apply(edits.share_artwork(self._session.document, second, stripes))
        except KirigamiError as error:
            self._session.refuse(error)

    def _refuse(self, sentence: str, trace: str) -> None:
        self._session.post(Message(sentence, Tone.ERROR, trace))
        self._session.set_status(tr("Nothing changed."))

    def _follow(self) -> None:
        """Paint again if artwork, design or target have changed."""
        stage, document = self._session.stage, self._session.document
        if document.artwork is None or stage is None:
            if self._wanted is not None:
                self._wanted = None
                self._painting.stop()
                self.painted.emit(None)
            return
        steps: Callable[[Cancel], Iterator[ShownArtwork | ShownPrint]]
        if has_pieces(document.fabrication):
            candidate, printed = self._pieces or (None, None)
            if printed is None or candidate is not stage.candidate:
                return
            on: object = printed.posed.assembly.deployment
            steps = partial(painting_on_pieces, document.artwork, printed)
        else:
            on, steps = stage.design, partial(painting_artwork, document.artwork, stage.design, document.target)
        wanted, before = (document.artwork, on, document.target), self._wanted
        if before is not None and all(one is other for one, other in zip(wanted, before, strict=True)):
            return
        self._wanted = wanted
        callbacks = JobCallbacks(self.painted.emit, on_failed=self._session.report_failure)
        self._painting.start(tr("painting the artwork"), steps, callbacks)
