"""What notebooks show: whole SVG of a useful size, with nothing cut off and nothing of the page's own colours."""

from __future__ import annotations

import math
import re
from xml.etree import ElementTree

import numpy as np
import pytest

import kirigami_studio as ks
from kirigami_studio.api.design import LEVELS
from kirigami_studio.api.pictures import AngleCurve, curves_picture
from kirigami_studio.project.document import Document

SVG = "{http://www.w3.org/2000/svg}"


def drawn(text: str) -> ElementTree.Element:
    """The picture, checked: all points are inside."""
    root = ElementTree.fromstring(text)
    width, height = (float(root.get(side, "0")) for side in ("width", "height"))
    assert 40 < width < 1200 and 40 < height < 1200
    for path in root.iter(f"{SVG}path"):
        points = np.array([pair.split(",") for pair in re.findall(r"-?[\d.]+,-?[\d.]+", path.get("d", ""))], float)
        assert points.min() >= 0.0 and points[:, 0].max() <= width and points[:, 1].max() <= height
        assert path.get("fill") is not None
    return root


def words(root: ElementTree.Element) -> list[str]:
    return [element.text or "" for element in root.iter(f"{SVG}text")]


def test_that_a_target_shows_its_outline_and_name() -> None:
    root = drawn(ks.load_target([(0, 0), (9, 0), (9, 1), (0, 1)], name="a & b < c")._repr_svg_())
    assert words(root) == ["a & b < c"]


def test_that_sheets_and_designs_show_three_states(uneven: ks.Sheet, design: ks.Design) -> None:
    assert words(drawn(uneven._repr_svg_())) == ["4 × 5 voids", "flat", "90°", "0°"]
    title, figures, *states = words(drawn(design._repr_svg_()))
    assert title == "A1  ·  square" and f"IoU {design.iou:.3f}" in figures and states == ["flat", "90°", "0°"]
    crossing = ks.decode(np.array([[10.0, 0.1], [0.1, 10.0]])).for_target("circle", phi=0.5)
    assert ("not feasible" in crossing._repr_svg_()) is not crossing.feasible


def test_that_designs_show_a_contact_sheet_with_their_matches(hearts: ks.Designs, design: ks.Design) -> None:
    said = words(drawn(hearts._repr_svg_()))
    assert said[0] == f"{len(hearts)} designs for heart"
    assert [f"IoU {one.iou:.3f}" for one in hearts] == said[2::2] and [one.name for one in hearts] == said[1::2]
    many = ks.Designs(
        type(hearts.document)(
            design.document.target, candidates=(design.candidate,) * 30, fabrication=design.document.fabrication
        )
    )
    assert words(drawn(many._repr_svg_()))[-1] == "and 6 more"
    assert words(ElementTree.fromstring(ks.Designs(Document())._repr_svg_())) == ["Designs: none"]


def test_that_cuts_show_their_lines_and_the_verdict(cuts: ks.Cuts) -> None:
    page = cuts._repr_html_()
    root = drawn(page[page.index("<svg") : page.index("</svg>") + 6])
    assert {"slits", "edge slits", "outline"} <= set(words(root))
    assert f'<b style="color:{LEVELS[cuts.verdict.level]}">{cuts.verdict.lines[0]}</b>' in page
    assert page.count("<li>") == len(cuts.verdict.lines) - 1


def test_that_a_simulation_shows_force_and_stretch(cuts: ks.Cuts) -> None:
    said = words(drawn(cuts.simulate()._repr_svg_()))
    assert said[0].startswith("As cut: closes") and {"force (N)", "largest stretch (connector widths)"} <= set(said)


@pytest.mark.parametrize("values", [[0.0, 0.0, 0.0], [-3.2, 0.0, 1e-3], [1e6, 2e6, 5.1e6], [0.004, 0.001, 0.0]])
def test_that_numbers_beside_a_curve_are_round_and_around_it(values: list[float]) -> None:
    phi = np.array([np.pi, 1.0, 0.0])
    said = words(drawn(curves_picture([AngleCurve(phi, np.array(values), "figure")], "heading", 0.4)))
    ticks = [float(text) for text in said if re.fullmatch(r"-?[\d.]+(e[+-]?\d+)?", text)]
    assert min(ticks) <= min(values) and max(ticks) >= max(values) and 0.0 in ticks and 2 <= len(ticks) <= 7


def test_that_plain_texts_are_short(hearts: ks.Designs, cuts: ks.Cuts, uneven: ks.Sheet) -> None:
    values = (hearts, hearts[0], hearts.target, uneven, cuts, cuts.simulate())
    assert all(len(repr(value)) < 100 and repr(value).startswith(f"<{type(value).__name__}") for value in values)


def test_that_a_design_is_drawn_by_matplotlib_over_its_target(design: ks.Design) -> None:
    figures = pytest.importorskip("matplotlib.figure")
    ax = figures.Figure().subplots()
    assert design.plot(ax) is ax
    panels, target = ax.collections
    assert len(panels.get_paths()) == len(design.panels())
    low, high = ax.dataLim.min, ax.dataLim.max
    drawn = np.concatenate([*design.panels(), design.target.points])
    assert np.allclose(low, drawn.min(axis=0)) and np.allclose(high, drawn.max(axis=0))
    assert np.allclose(target.get_paths()[0].vertices[:-1], design.target.points) and ax.get_title() == design.name
    flat = design.plot(figures.Figure().subplots(), phi=math.pi)
    assert np.allclose(flat.collections[0].get_paths()[0].vertices[:-1], design.panels(math.pi)[0])
