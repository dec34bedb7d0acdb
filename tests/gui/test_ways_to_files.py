"""From a logo, or a shape with a hole, to its cut file: few actions, and no refusal after Generate on the way."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import ezdxf
import pytest
from maker_actions import Maker, begun

from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.outlines.combining import Combine
from kirigami_studio.studio.verdict import Level

Until = Callable[[Callable[[], bool]], None]
pytestmark = pytest.mark.torch
#: A mark drawn with a pen: a triangle and the bar below it, in two colours.
STROKES = """<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="100mm" viewBox="0 0 120 100">
<path id="peak" fill="none" stroke="#c2410c" stroke-width="30" stroke-linejoin="round" d="M24 70 L60 26 L96 70 Z"/>
<path id="base" fill="none" stroke="#1e40af" stroke-width="30" stroke-linecap="round" d="M20 74 H100"/></svg>"""
#: Most actions from the first page to the files.
MOST_ACTIONS = 8


@pytest.fixture
def refusals(window: MainWindow) -> Iterator[list[Message]]:
    """Messages that say no."""
    said: list[Message] = []

    def keep(message: Message) -> None:
        if message.tone is Tone.ERROR:
            said.append(message)

    window.session.message_posted.connect(keep)
    yield said


def made(maker: Maker, until: Until, cut: Path) -> None:
    """Generate, look at the page Make, export."""
    window = maker.window
    maker.click(window.run.generate)
    until(lambda: window.fabrication.export.isEnabled() and not window.services.run.running)
    maker.click(window.page_buttons[WindowPage.MAKE])
    maker.click(window.fabrication.export)
    until(cut.exists)


def judged(window: MainWindow, until: Until) -> Level:
    """The verdict on the design that was exported."""
    until(lambda: window.services.verdict.state.verdict is not None and not window.services.verdict.state.pending)
    state = window.services.verdict.state
    assert state.verdict is not None
    return state.verdict.level


def test_that_an_own_logo_with_strokes_is_a_file_after_eight_actions(
    window: MainWindow, until: Until, files: object, tmp_path: Path, refusals: list[Message]
) -> None:
    maker, logo, cut = begun(window, until, tmp_path), tmp_path / "logo.svg", tmp_path / "logo.dxf"
    logo.write_text(STROKES, encoding="utf-8")
    files.answer = logo  # type: ignore[attr-defined]
    maker.press("Ctrl+O")
    until(lambda: window.session.document.target is not None and window.session.document.target.name == "logo")
    files.answer = cut  # type: ignore[attr-defined]
    made(maker, until, cut)
    target = window.session.document.target
    assert target is not None and target.size is not None and target.size == pytest.approx((110.0, 82.0), rel=0.1)
    assert maker.actions <= MOST_ACTIONS and refusals == []
    assert len(ezdxf.readfile(cut).modelspace()) > 20
    assert judged(window, until) is not Level.FAILS


def test_that_a_drawn_shape_with_a_hole_is_a_file_after_eight_actions(
    window: MainWindow, until: Until, files: object, tmp_path: Path, refusals: list[Message]
) -> None:
    maker, cut = begun(window, until, tmp_path), tmp_path / "ring.dxf"
    files.answer = cut  # type: ignore[attr-defined]
    tools = window.target.tools
    maker.click(window.target.buttons["clearTarget"])
    maker.click(tools.buttons[Tool.RECTANGLE])
    maker.drag((-60.0, -45.0), (60.0, 45.0))
    maker.click(tools.modes[Combine.SUBTRACT])
    maker.drag((-20.0, -15.0), (20.0, 15.0))
    target = window.session.document.target
    assert target is not None and len(target.holes) == 1
    made(maker, until, cut)
    assert maker.actions <= MOST_ACTIONS and refusals == []
    assert "HOLES" in {layer.dxf.name for layer in ezdxf.readfile(cut).layers}
    assert judged(window, until) is not Level.FAILS


def test_that_a_file_with_a_hole_is_a_cut_file_after_eight_keys(
    window: MainWindow, until: Until, files: object, tmp_path: Path, refusals: list[Message]
) -> None:
    maker, cut = begun(window, until, tmp_path), tmp_path / "ring.dxf"
    ring = tmp_path / "ring.svg"
    ring.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="120mm" height="120mm" viewBox="0 0 120 120">'
        '<path fill-rule="evenodd" d="M10 10H110V110H10Z M40 40H80V80H40Z"/></svg>',
        encoding="utf-8",
    )
    files.answer = ring  # type: ignore[attr-defined]
    maker.press("Ctrl+O")
    until(lambda: window.session.document.target is not None and bool(window.session.document.target.holes))
    files.answer = cut  # type: ignore[attr-defined]
    maker.press("Ctrl+G")
    until(lambda: window.fabrication.export.isEnabled() and not window.services.run.running)
    maker.press("3")
    maker.press("Ctrl+E")
    until(cut.exists)
    assert maker.actions <= MOST_ACTIONS and refusals == []
    assert window.pages.page is WindowPage.MAKE
    assert judged(window, until) is not Level.FAILS
