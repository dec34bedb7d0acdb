"""The page to share: its own script moves it as the program does, in a JavaScript engine that is not the program's."""

from __future__ import annotations

import base64
import hashlib
import io
import json
import math
import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from PySide6.QtQml import QJSEngine

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.export.artwork import Artwork, Laid, SheetState
from kirigami_studio.export.artwork_picture import picture_of
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.registry import export
from kirigami_studio.export.share_page import read_page
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.resources import resource
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.project.store import load
from kirigami_studio.settings.fabrication import with_choices
from kirigami_studio.studio.making import CutRequest, export_job

HEART = resource("examples", "heart.kiri")
TRIMMED = Path(__file__).parents[2] / "data" / "cut_designs" / "star_trim.kiri"


def job_of(project: Path, **choices: object) -> ExportJob:
    document = load(project)
    return export_job(CutRequest.of(document, with_choices(document.fabrication, choices)), None)


class Scripts(HTMLParser):
    """Texts of the scripts and styles of a page, by their id or name, and its policy."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: dict[str, str] = {}
        self.policy = ""
        self.links: list[str] = []
        self._within = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        if tag in ("script", "style"):
            self._within = given.get("id") or tag
            self.found[self._within] = ""
        if given.get("http-equiv") == "Content-Security-Policy":
            self.policy = given["content"] or ""
        self.links += [value for key, value in attrs if key in ("src", "href") and value]

    def handle_data(self, data: str) -> None:
        if self._within:
            self.found[self._within] += data

    def handle_endtag(self, tag: str) -> None:
        self._within = ""


def written(job: ExportJob, folder: Path) -> tuple[Path, Scripts]:
    path = export(job, folder / "page.html")
    return path, Scripts(path.read_text(encoding="utf-8"))


def moved_by_script(page: Scripts, phi: float) -> list[np.ndarray]:
    """Corners of all parts at an angle, by the page's own functions."""
    engine = QJSEngine()
    functions = re.findall(r"^function (?:sheetOf|turns|corners)\(.*?^}", page.found["script"], re.S | re.M)
    assert len(functions) == 3
    target = json.loads(page.found["design"])["phi"]
    share = (math.pi - phi) / (math.pi - target) if target < math.pi else 1.0
    engine.evaluate(f"var design = {page.found['design']};" + "\n".join(functions))
    made = engine.evaluate(f"JSON.stringify(design.parts.map((part) => corners(part, {share!r})))")
    assert not made.isError(), made.toString()
    return [np.reshape(points, (-1, 2)) for points in json.loads(made.toString())]


pytestmark = pytest.mark.usefixtures("qapp")  # a script engine needs one


@pytest.mark.parametrize("project", [HEART, TRIMMED])
@pytest.mark.parametrize("degrees", [0.0, 1.0, 47.0, 122.5, 180.0])
def test_that_the_page_moves_as_the_program_does(project: Path, degrees: float, tmp_path: Path) -> None:
    job = job_of(project)
    _, page = written(job, tmp_path)
    phi, posed = math.radians(degrees), job.posed
    scale, middle = posed.mm_per_world(job.width_mm), posed.nodes(posed.phi_target).mean(axis=0)
    expected = [(part - middle) * scale for part in posed.parts(phi)]
    found = moved_by_script(page, phi)
    assert len(found) == len(expected)
    # A micrometre and a half: what is written has three decimals of a millimetre, in each of the two sums.
    assert max(np.abs(one - other).max() for one, other in zip(found, expected, strict=True)) < 1.5e-3


def test_that_only_its_own_style_and_script_run_and_nothing_is_fetched(tmp_path: Path) -> None:
    path, page = written(job_of(HEART), tmp_path)
    for kind in ("style", "script"):
        digest = base64.b64encode(hashlib.sha256(page.found[kind].encode()).digest()).decode()
        assert f"{kind}-src 'sha256-{digest}'" in page.policy
    assert page.policy.startswith("default-src 'none'") and page.links == []
    assert " style=" not in path.read_text(encoding="utf-8").split("<body>")[1]  # the policy would not allow it
    assert "[hidden] { display: none !important; }" in page.found["style"]
    assert not re.search(r"https?://(?!www\.w3\.org/2000/svg)", path.read_text(encoding="utf-8"))


def test_that_the_project_inside_opens_again(tmp_path: Path) -> None:
    job = job_of(HEART)
    _, page = written(job, tmp_path)
    inside = tmp_path / json.loads(page.found["design"])["file"]
    inside.write_bytes(base64.b64decode(page.found["project"]))
    assert inside.name == "page.kiri"
    assert load(inside).candidates[0].sheet == load(HEART).candidates[load(HEART).chosen or 0].sheet


def test_that_names_stay_text(tmp_path: Path) -> None:
    evil = '</script><img src=x onerror=alert(1)> & "heart" $policy'
    job = job_of(HEART)
    object.__setattr__(job, "provenance", {"target": evil, "</td>": evil})
    path, page = written(job, tmp_path)
    text = path.read_text(encoding="utf-8")
    assert "<img" not in text and page.links == [] and "$policy" in text
    assert set(page.found) == {"style", "design", "project", "picture", "script"}


def test_that_a_sheet_of_16_by_16_voids_takes_less_than_100_kb(tmp_path: Path) -> None:
    ratio = np.exp(0.3 * np.random.default_rng(3).standard_normal((16, 16)))
    job = ExportJob(deploy(RatioField(ratio)), transform=Similarity(0.06))
    path, page = written(job, tmp_path)
    assert path.stat().st_size < 100_000
    posed = PosedDesign(job.deployment, job.transform, job.phi)
    assert len(moved_by_script(page, 1.0)) == len(posed.parts(1.0)) == 289


def test_that_artwork_lies_on_the_flat_sheet_as_it_is_printed(tmp_path: Path) -> None:
    stream = io.BytesIO()
    Image.linear_gradient("L").convert("RGB").save(stream, format="PNG")
    job = job_of(HEART)
    object.__setattr__(job, "artwork", Artwork(Laid(picture_of("grey.png", stream.getvalue()), SheetState.FLAT)))
    path, page = written(job, tmp_path)
    place = read_page(path)["print"]
    picture = Image.open(io.BytesIO(base64.b64decode(page.found["picture"].split(",", 1)[1])))
    assert place["width"] == pytest.approx(job.width_mm, rel=2e-3) and picture.width == 1400
    # The flat sheet's box is where the picture lies: its corners in the page's frame, y down.
    turn, shift = re.match(r"translate\((\S+) (\S+)\) rotate\((\S+)\)", place["transform"]), None
    assert turn is not None
    x, y, degrees = (float(text) for text in turn.groups())
    shift = np.array([x, y])
    way = np.array([math.cos(math.radians(degrees)), math.sin(math.radians(degrees))])
    other = np.array([-way[1], way[0]])
    points = np.concatenate(moved_by_script(page, math.pi)) * (1.0, -1.0) - shift
    for axis, length in ((way, place["width"]), (other, place["height"])):
        along = points @ axis
        assert along.min() == pytest.approx(0.0, abs=0.01) and along.max() == pytest.approx(length, abs=0.1)


def test_that_a_file_that_is_no_page_is_refused(tmp_path: Path) -> None:
    other = tmp_path / "other.html"
    other.write_text("<p>hello</p>")
    with pytest.raises(ExportError) as caught:
        read_page(other)
    assert caught.value.code == "page.not_as_written"
