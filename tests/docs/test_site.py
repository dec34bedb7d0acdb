"""The documentation site builds strictly and needs no network: neither to be built nor to be read."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

import kirigami_studio
from kirigami_studio.cli.parser import all_commands
from kirigami_studio.foundation.resources import resource

pytestmark = pytest.mark.rule

pytest.importorskip("mkdocs")

REPOSITORY = Path(__file__).resolve().parents[2]
#: What a browser fetches by itself; links of a page it only follows.
FETCHED = {"img": "src", "script": "src", "source": "src", "video": "src", "iframe": "src", "link": "href"}
#: Kinds of <link> that are only told about.
TOLD = {"prev", "next", "canonical"}


@dataclass
class PageReader(HTMLParser):
    """Collects what a page fetches, where its links lead, and its anchors."""

    fetched: list[str] = field(default_factory=list)
    links: list[str] = field(default_factory=list)
    anchors: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        super().__init__()

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        """Take the attributes that name places."""
        named = {name: value or "" for name, value in attributes}
        self.anchors |= {named[key] for key in ("id", "name") if named.get(key)}
        place = named.get(FETCHED.get(tag, ""), "")
        if place and named.get("rel", "") not in TOLD:
            self.fetched.append(place)
        self.fetched += [named["poster"]] if named.get("poster") else []
        if tag == "a" and named.get("href"):
            self.links.append(named["href"])


def read_page(text: str) -> PageReader:
    """The places in a page."""
    reader = PageReader()
    reader.feed(text)
    return reader


def from_elsewhere(places: list[str]) -> list[str]:
    """Those that another server has."""
    return [place for place in places if urlsplit(place).netloc or urlsplit(place).scheme in ("http", "https")]


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built as ``make site`` does, with a proxy that refuses every connection."""
    folder = tmp_path_factory.mktemp("site")
    refused = dict.fromkeys(("http_proxy", "https_proxy", "HTTP_PROXY", "HTTPS_PROXY"), "http://127.0.0.1:9")
    environment = {**os.environ, **refused, "NO_MKDOCS_2_WARNING": "1", "PYTHONPATH": str(REPOSITORY)}
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)]
    done = subprocess.run(
        command, cwd=REPOSITORY, env=environment, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.fixture(scope="module")
def pages(site: Path) -> dict[Path, PageReader]:
    """Every page by its file; the page for missing pages names places by where the site will be."""
    found = {path: path for path in site.rglob("*.html") if path.name != "404.html"}
    assert len(found) > 30
    return {path: read_page(path.read_text(encoding="utf-8")) for path in found}


def test_that_pages_fetch_nothing_from_other_servers(site: Path, pages: dict[Path, PageReader]) -> None:
    assert {path.name: found for path, page in pages.items() if (found := from_elsewhere(page.fetched))} == {}
    for sheet in site.rglob("*.css"):
        assert re.findall(r"url\(\s*['\"]?https?:|@import\s+['\"]https?:", sheet.read_text(encoding="utf-8")) == []
    assert from_elsewhere(read_page('<script src="https://example.org/a.js">').fetched) == ["https://example.org/a.js"]
    assert from_elsewhere(read_page('<video poster="//example.org/a.jpg">').fetched) == ["//example.org/a.jpg"]


def test_that_all_that_pages_show_and_all_places_of_links_are_there(pages: dict[Path, PageReader]) -> None:
    missing = []
    for path, page in pages.items():
        for place in (*page.fetched, *page.links):
            parts = urlsplit(place)
            if parts.scheme or parts.netloc:
                continue
            file = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            file = file / "index.html" if file.is_dir() else file
            anchor = unquote(parts.fragment)
            if not file.is_file() or (anchor and file in pages and anchor not in pages[file].anchors):
                missing.append((path.name, place))
    assert missing == []


def test_that_the_guide_of_the_site_is_the_file_that_the_window_shows(site: Path) -> None:
    for name, page in (("guide.md", "guide/guide.html"), ("guide.de.md", "guide/de/guide.html")):
        guide = resource("guide", name).read_text(encoding="utf-8")
        text = (site / page).read_text(encoding="utf-8")
        headings = re.findall(r"^#+ (.+)$", guide, flags=re.MULTILINE)
        assert len(headings) > 10
        assert [heading for heading in headings if f">{heading}<a" not in text.replace("&amp;", "&")] == []
        assert text.count("<img") == len(re.findall(r"^!\[", guide, flags=re.MULTILINE))
    assert not list((REPOSITORY / "docs").rglob("guide*.md"))


def test_that_formulas_are_drawn_by_the_browser_alone(site: Path) -> None:
    text = (site / "mathematics.html").read_text(encoding="utf-8")
    formulas = (REPOSITORY / "docs" / "mathematics.md").read_text(encoding="utf-8").count("$$") // 2
    assert formulas > 5
    assert text.count('<math xmlns="http://www.w3.org/1998/Math/MathML" display="block"') == formulas
    assert "arithmatex" not in text
    assert r"\(" not in text


def test_that_every_command_and_its_options_are_in_the_reference(site: Path) -> None:
    text = (site / "command-line-options.html").read_text(encoding="utf-8")
    assert [one.name for one in all_commands() if f">{one.name}<a" not in text] == []
    options = {name for one in all_commands() for names, _ in one.options for name in names if name.startswith("--")}
    assert [option for option in sorted(options) if option not in text] == []


def test_that_public_python_names_are_in_the_reference(site: Path) -> None:
    text = (site / "api-reference.html").read_text(encoding="utf-8")
    for name in ("designs", "targets", "masks", "judge", "baseline", "simulate", "score"):
        assert f'id="kirigami_studio.lab.problem.{name}"' in text
    homes = {name: module for module, names in kirigami_studio._MODULES.items() for name in names}
    assert [name for name in kirigami_studio.__all__ if f'id="kirigami_studio.{homes[name]}.{name}"' not in text] == []


def test_that_every_page_can_be_reached_from_the_start(site: Path, pages: dict[Path, PageReader]) -> None:
    reached, todo = set(), [site / "index.html"]
    while todo:
        page = todo.pop()
        if page in reached or page not in pages:
            continue
        reached.add(page)
        todo += [(page.parent / unquote(urlsplit(link).path)).resolve() for link in pages[page].links]
    assert sorted(page.name for page in set(pages) - reached) == []
