"""Screenshots of the target and its drawing board, in all sizes and both themes."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from PIL import Image, ImageDraw
from PySide6.QtCore import QPointF, QSize
from PySide6.QtWidgets import QApplication, QPushButton, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.target.point_tool import PointTool
from kirigami_studio.gui.target.sketch_context import Change, PointerEvent
from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.widgets.theme import DARK, LIGHT
from kirigami_studio.lab.demonstrations.offscreen_session import OffscreenSession, SessionError, click
from kirigami_studio.outlines.combining import Combine, combined
from kirigami_studio.outlines.drawing import Drawing
from kirigami_studio.outlines.figures import BoundingBox, Figure, figure, placed_figure
from kirigami_studio.outlines.merging import Join
from kirigami_studio.outlines.mirroring import Axis
from kirigami_studio.outlines.placed import Placed

#: Sizes of the window: the least and that of a small laptop; at twice the scale that of a screen of 3840 x 2160.
SIZES, SCALED = (QSize(1000, 640), QSize(1280, 720)), (QSize(1920, 1080),)
#: A rectangle with a notch, mm.
HOLLOW = ((-40.0, -30.0), (40.0, -30.0), (40.0, 30.0), (0.0, 0.0), (-40.0, 30.0))
#: A drawing with two layers and a stroke.
LOGO = """<svg xmlns="http://www.w3.org/2000/svg" width="160mm" height="100mm" viewBox="0 0 160 100">
<g id="Badge"><circle id="badge" cx="30" cy="40" r="20" fill="#c03030"/><path id="star" fill="#2050c0"
d="M85 15l6 14 15 1-12 10 4 15-13-8-13 8 4-15-12-10 15-1z"/><path id="frame" fill-rule="evenodd"
d="M120 20h30v40h-30z M127 30h16v20h-16z"/></g><g id="Lines"><path id="swoosh" d="M8 80C40 70 80 70 142 82" fill="none"
stroke="#108040" stroke-width="5" stroke-linecap="round"/></g></svg>"""
LONG_NAME = "a scanned drawing with the long name that scanners like to give, page 3 of 12"


class BoardStates(OffscreenSession):
    """Takes one window through the states of the target, and a screenshot of each in all sizes and themes."""

    def all_sizes(self, name: str, ready: Callable[[], object] = lambda: None) -> None:
        """Take one picture for every size and theme, each after ``ready``."""
        scale = self.window.devicePixelRatioF()
        for palette in (LIGHT, DARK):
            self.window.appearance.set_theme(palette)  # styles every widget anew, which takes longer than another size
            for size in SCALED if scale > 1.0 else SIZES:
                self.window.resize(size)
                for _ in range(3):
                    QApplication.processEvents()
                ready()
                pixels = size * scale
                self.picture(f"{name}-{pixels.width()}x{pixels.height()}-{palette.name}")
        self.window.appearance.set_theme(LIGHT)

    def both_themes(self, name: str, widget: QWidget, ready: Callable[[], object] = lambda: None) -> None:
        """Take one picture of a dialog for each theme, each after ``ready``."""
        for palette in (DARK, LIGHT):
            self.window.appearance.set_theme(palette)
            ready()
            self.picture(f"{name}-{palette.name}", widget)

    def picture_target(self) -> None:
        """Open a blurred grey picture."""
        path = self.out / f"{LONG_NAME}.png"
        page = Image.new("L", (400, 300), 240)
        draw = ImageDraw.Draw(page)
        draw.ellipse((90, 60, 310, 240), fill=60)
        draw.ellipse((40, 110, 150, 190), fill=150)
        page.save(path)
        self.window.services.targeting.clear()  # what was drawn is not replaced without a question
        self.window.services.targeting.open(str(path))
        self.until(lambda: self.window.target.threshold.isVisible(), "the picture was not read")

    def parts(self) -> None:
        """The picker of a logo's parts: as it opens, with all parts bridged as painted, and their tight hull."""
        path = self.out / "logo.svg"
        path.write_text(LOGO, encoding="utf-8")
        dialogs = self.window.dialogs
        self.window.services.targeting.open(str(path))
        self.until(lambda: dialogs.parts is not None and dialogs.parts.complete, "the picker did not open")
        picker = dialogs.parts
        if picker is None:
            raise SessionError("There is no picker.")
        for state in ("largest", "bridges", "hull"):
            if state == "bridges":
                click(picker.all)
                picker.painted.setChecked(True)
            if state == "hull":
                picker.join.choose(Join.TIGHT)
            made = partial(self.until, lambda: picker.complete, "the outline was not made")
            self.both_themes(f"parts-{state}", picker, made)
        picker.reject()

    def editor(self) -> None:
        """A shape with a thin arm on the drawing board, its points, its handles, and a shape about to be taken away."""
        target, reshaping = self.window.target, self.window.presenters.target.reshaping
        body = figure(Figure.ELLIPSE, BoundingBox(-40.0, -25.0, 20.0, 25.0))
        reshaping.take(Change("Draw ellipse", lambda: Placed.from_ring(body, "ladle")))
        arm, now = placed_figure(Figure.RECTANGLE, BoundingBox(15.0, -3.0, 60.0, 3.0)), target.view.context.placed
        reshaping.take(Change("Add rectangle", lambda: combined(now, arm, Combine.ADD)))
        for tool in (Tool.POINTS, Tool.POSE, Tool.STAR, Tool.TEXT):
            target.set_tool(tool)
            target.tools.set_mode(Combine.ADD)
            self.all_sizes(f"editor-{tool.value}")
        target.tools.set_mode(Combine.NEW)
        reshaping.propose("smooth", 0.8)
        self.all_sizes("editor-smoothing")
        target.view.show_proposal(None)

    def objects(self) -> None:
        """Several objects, two of them selected, and one that hangs apart."""
        target, reshaping = self.window.target, self.window.presenters.target.reshaping
        boxes = (
            BoundingBox(-30.0, -20.0, 20.0, 20.0),
            BoundingBox(0.0, 0.0, 45.0, 35.0),
            BoundingBox(52.0, -20.0, 62.0, -10.0),
        )
        kinds = (Figure.RECTANGLE, Figure.ELLIPSE, Figure.STAR)
        shapes = [placed_figure(kind, box) for kind, box in zip(kinds, boxes, strict=True)]
        reshaping.take(Change("Draw shapes", lambda: Drawing(tuple(shapes), frozenset({0, 1}))))
        target.set_tool(Tool.POSE)
        self.all_sizes("editor-objects")
        self.replacing()
        target.view.context.arrange("largest")
        reshaping.take(Change("Draw rectangle", lambda: Drawing((shapes[0],))))

    def replacing(self) -> None:
        """A star was opened while the board holds several objects: the question, and the star beside them."""
        messages = self.window.messages
        self.window.services.targeting.open("star")
        self.until(lambda: any(message.actions for message in messages.messages), "the window did not ask")
        self.all_sizes("replace-question")
        click(next(button for button in messages.findChildren(QPushButton) if button.text() == tr("Add beside")))
        self.all_sizes("added-beside")
        self.window.commands["undo"].trigger()

    def points_and_mirror(self) -> None:
        """Selected points with their handles, a selection box, and a shape that is mirrored as it is drawn."""
        target, reshaping = self.window.target, self.window.presenters.target.reshaping
        disc = placed_figure(Figure.ELLIPSE, BoundingBox(-30.0, -25.0, 30.0, 25.0))
        reshaping.take(Change("Draw ellipse", lambda: disc))
        target.set_tool(Tool.POINTS)
        target.tools.axis.set_axis(Axis.UPRIGHT)
        tool = target.view.active
        if not isinstance(tool, PointTool):
            raise SessionError("The points tool is not in use.")
        tool.select({0, 1}, 0)
        target.view.update()
        self.all_sizes("editor-handles")
        target.tools.axis.set_axis(Axis.BOTH)
        target.set_tool(Tool.ELLIPSE)
        target.tools.set_mode(Combine.ADD)
        for place in ((10.0, 10.0), (45.0, 30.0)):
            pointer = PointerEvent(
                QPointF(*target.view.context.transform.to_pixels(np.array(place)).tolist()), place, place, False
            )
            (target.view.active.press if place[0] < 20 else partial(target.view.active.move, held=True))(pointer)
        self.all_sizes("editor-mirror")
        target.view.active.drop()
        target.tools.set_mode(Combine.NEW)
        target.tools.axis.set_axis(Axis.NONE)

    def lost_designs(self) -> None:
        """A rotated target whose discarded designs can be restored."""
        target, session = self.window.target, self.window.session
        target.set_tool(Tool.POSE)
        target.tools.options.pose.turn.setValue(20.0)
        self.all_sizes("lost-designs")
        self.window.presenters.target.discarded.bring_back()
        target.set_editing(False)
        if not session.document.candidates:
            raise SessionError("The designs did not come back.")
        self.until(self.window.fabrication.export.isEnabled, "the designs came back without a plan")

    def starts(self) -> None:
        """The list of starts, a hollow shape on the start's board, the pairs, and one of them opened."""
        window, tile = self.window, self.window.target.start
        window.session.history.mark_saved()
        tile.open_menu()
        self.picture("start-menu", tile.menu)
        tile.menu.close()
        window.dialogs.show_start_board()
        window.presenters.show_pairs()
        board, gallery = window.dialogs.start_board, window.welcome.pairs
        if board is None:
            raise SessionError("The board did not open.")
        board.view.context.changed.emit(Change("Draw polygon", lambda: Placed.from_ring(HOLLOW, "polygon")))
        self.both_themes("start-board", board)
        self.both_themes("pairs", gallery, lambda: self.until(lambda: gallery.complete, "the pairs were not drawn"))
        board.close()
        gallery.list.itemActivated.emit(gallery.list.item(0))
        self.until(lambda: window.target.start.name == "circle", "the pair did not open")
        self.until(window.fabrication.export.isEnabled, "the pair has no plan")
        self.all_sizes("pair")
