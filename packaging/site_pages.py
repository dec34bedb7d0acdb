"""What the documentation site needs beyond ``docs``: MkDocs calls these hooks (``mkdocs.yml``).

Pages that live elsewhere in the repository, such as the guide that the window shows, are pages of the site at once and
are written once.  Links of every page are those of the repository, as GitHub follows them; here they lead to the site's
pages, and what is no part of the site keeps its name without a link.  Formulas become MathML, which browsers draw
without scripts and fonts of other servers.  The table of commands and options is made from the command line's own.
"""

from __future__ import annotations

import argparse
import html
import posixpath
import re
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

from latex2mathml.converter import convert
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page
from pymdownx.slugs import slugify

from kirigami_studio import load_project
from kirigami_studio.cli.parser import about_group, all_commands, build_parser

REPOSITORY = Path(__file__).resolve().parents[1]
#: Place on the site -> file of the repository; ``docs`` itself is there as it is.
ELSEWHERE = {
    "guide/guide.md": "resources/guide/guide.md",
    "guide/de/guide.md": "resources/guide/guide.de.md",
    "models/model-card.md": "resources/models/MODEL_CARD.md",
    "models/measured.md": "resources/models/measured.md",
    "changelog.md": "CHANGELOG.md",
    "architecture.md": "ARCHITECTURE.md",
    "contributing.md": "CONTRIBUTING.md",
    "security.md": "SECURITY.md",
    "pictures/logo.svg": "resources/icons/kirigami-studio.svg",
}
#: Folders whose pictures those pages show.
PICTURES = {"guide": "resources/guide", "guide/de": "resources/guide/de", "models": "resources/models"}
#: Made from the parser of the command line.
COMMANDS = "command-line-options.md"
LINK = re.compile(r"(?P<picture>!?)\[(?P<text>[^\]\n]*)\]\((?P<place>[^)\s#]*)(?P<anchor>#[^)\s]*)?\)")
#: Galleries of the site -> where their projects lie; each project becomes a page that moves.
GALLERIES = {"pairs": "resources/pairs", "pinned": "docs/gallery/pinned", "shapes": "docs/gallery/shapes"}
#: ``<!-- gallery: pairs -->`` stands for the pictures of a gallery, each leading to its page.
GALLERY = re.compile(r"^<!-- gallery: (?P<folder>[\w-]+) -->$", re.MULTILINE)
#: ``<!-- README.md: Install -->`` stands for the text below that heading of the README.
INCLUDED = re.compile(r"^<!-- (?P<file>[\w./-]+\.md): (?P<heading>[^>]+) -->$", re.MULTILINE)
FORMULA = re.compile(r'<(?P<tag>span|div) class="arithmatex">\\[(\[](?P<tex>.*?)\\[)\]]</(?P=tag)>', re.DOTALL)


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Pages of ``docs`` that the navigation does not name come last in its reference: none is lost.  Anchors are those
    of GitHub, so that links hold there and here.
    """
    config.mdx_configs.setdefault("toc", {})["slugify"] = slugify(case="lower")
    named = set(_named(config.nav))
    others = sorted(path.name for path in (REPOSITORY / "docs").glob("*.md") if path.name not in named)
    next(part["Reference"] for part in config.nav or () if "Reference" in part).extend(others)
    return config


def _named(entries: object) -> Iterator[str]:
    """All pages of a navigation."""
    if isinstance(entries, str):
        yield entries
    elif isinstance(entries, dict):
        yield from _named(list(entries.values()))
    elif isinstance(entries, list):
        for entry in entries:
            yield from _named(entry)


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Add the pages and pictures from elsewhere, the table of commands, and the pages of the galleries."""
    pictures = {
        f"{place}/{path.name}": path
        for place, folder in PICTURES.items()
        for path in (REPOSITORY / folder).glob("*.png")
    }
    pages = {place: REPOSITORY / path for place, path in ELSEWHERE.items()}
    for place, path in {**pages, **pictures}.items():
        files.append(File.generated(config, place, abs_src_path=str(path)))
    files.append(File.generated(config, COMMANDS, content=commands_page()))
    for gallery in GALLERIES:
        for name, project in _projects(gallery).items():
            place = f"gallery/{gallery}/{name}.html"
            files.append(File.generated(config, place, content=_page_to_share(project, name)))
    return files


def on_page_markdown(markdown: str, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Take in sections of other documents and galleries, and lead links to the site's pages."""
    whole = INCLUDED.sub(lambda found: _led(_section(found["file"], found["heading"]), found["file"], page), markdown)
    whole = GALLERY.sub(lambda found: _gallery(found["folder"]), whole)
    return _led(whole, source_of(page.file.src_uri), page)


def on_page_content(text: str, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Formulas as MathML."""
    return FORMULA.sub(lambda found: _mathml(html.unescape(found["tex"]), found["tag"] == "div"), text)


def source_of(place: str) -> str:
    """The file of the repository that a page or picture of the site comes from."""
    folder = posixpath.dirname(place)
    if place in ELSEWHERE:
        return ELSEWHERE[place]
    if folder in PICTURES:
        return f"{PICTURES[folder]}/{posixpath.basename(place)}"
    return f"docs/{place}"


def place_of(source: str) -> str | None:
    """The site's page or picture that a file of the repository is, None where it is none."""
    for place, path in ELSEWHERE.items():
        if path == source:
            return place
    for place, folder in PICTURES.items():
        if posixpath.dirname(source) == folder and source.endswith(".png"):
            return f"{place}/{posixpath.basename(source)}"
    if source == "README.md":
        return "index.md"
    inside = source.startswith("docs/") and (REPOSITORY / source).is_file() and not source.endswith((".json", ".jsonl"))
    return source.removeprefix("docs/") if inside else None


def _led(markdown: str, source: str, page: Page) -> str:
    """Markdown of a file of the repository with links that hold on a page of the site."""
    here = posixpath.dirname(page.file.src_uri)
    # The German guide names its pictures as the English one does; its own lie in a folder beside it.
    beside = "resources/guide/de" if source == "resources/guide/guide.de.md" else posixpath.dirname(source)

    def lead(found: re.Match[str]) -> str:
        if not found["place"] or re.match(r"[a-z]+:", found["place"]):
            return found[0]
        named = posixpath.normpath(posixpath.join(beside, found["place"]))
        place = place_of(named)
        if place is None:
            # Not on the site: code and data of the repository keep their name.  What is nowhere stays, and is refused.
            return found["text"] if (REPOSITORY / named).exists() else found[0]
        return f"{found['picture']}[{found['text']}]({posixpath.relpath(place, here or '.')}{found['anchor'] or ''})"

    return LINK.sub(lead, markdown)


def _section(file: str, heading: str) -> str:
    """The text below a heading of a document, up to the next heading of its level."""
    text = (REPOSITORY / file).read_text(encoding="utf-8")
    found = re.search(rf"^(#+) {re.escape(heading.strip())}\n(.*?)(?=^\1 |\Z)", text, re.MULTILINE | re.DOTALL)
    if found is None:
        raise PluginError(f"{file} has no heading {heading.strip()!r}.")
    return found[2]


def _projects(gallery: str) -> dict[str, Path]:
    """Names of the pages of a gallery, and the projects that they show."""
    paths = sorted((REPOSITORY / GALLERIES[gallery]).glob("*.kiri"))
    return {re.sub(r"^\d+-", "", path.stem): path for path in paths}


def _gallery(gallery: str) -> str:
    """Pictures of a gallery, of a page beside ``gallery``."""
    shown = (
        f'<a href="gallery/{gallery}/{name}.html"><img src="gallery/{gallery}/{name}.png" alt="" loading="lazy">'
        f"{name.replace('-', ' ').capitalize()}</a>"
        for name in _projects(gallery)
    )
    return '<div class="gallery">\n' + "\n".join(shown) + "\n</div>"


def _page_to_share(project: Path, name: str) -> bytes:
    """The page of a project's design, as the program exports it."""
    with TemporaryDirectory() as folder:
        page = Path(folder) / f"{name}.html"
        load_project(project).best.export(page)
        return page.read_bytes()


def _mathml(tex: str, block: bool) -> str:
    return convert(tex.strip(), display="block" if block else "inline")


def commands_page() -> str:
    """Markdown with every sub-command, its options and examples."""
    lines = [
        "# Commands and options",
        "",
        "Made from the program itself; `kirigami-studio COMMAND --help` prints the same. What they are for, and what "
        "their JSON holds, is told in [The command line](command-line.md).",
        "",
    ]
    parsers = dict(_parsers(build_parser()))
    group = ""
    for command in all_commands():
        first, _, second = command.name.partition(" ")
        if second and first != group:
            lines += [f"## {first}", "", f"{about_group(first)[0].upper()}{about_group(first)[1:]}.", ""]
        group = first if second else ""
        lines += [
            f"{'###' if second else '##'} {command.name}",
            "",
            f"{command.about[0].upper()}{command.about[1:]}.",
            "",
        ]
        lines += ["| Option | Meaning |", "|---|---|", *_rows(parsers[command.name]), ""]
        lines += [f"    {example}" for example in command.examples]
        lines.append("")
    return "\n".join(lines)


def _parsers(parser: argparse.ArgumentParser, name: str = "") -> Iterator[tuple[str, argparse.ArgumentParser]]:
    """All parsers of sub-commands by their names."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for word, child in action.choices.items():
                whole = f"{name} {word}".strip()
                yield whole, child
                yield from _parsers(child, whole)


def _rows(parser: argparse.ArgumentParser) -> Iterator[str]:
    """One row for each argument of a parser."""
    formatter = parser._get_formatter()
    for action in parser._actions:
        if action.dest == "help":
            continue
        shown = (
            formatter._format_action_invocation(action)
            if action.option_strings
            else formatter._metavar_formatter(action, action.dest)(1)[0]
        )
        meaning = html.escape(formatter._expand_help(action) if action.help else "", quote=False)
        yield "| `{}` | {} |".format(*(text.replace("|", r"\|") for text in (shown, meaning)))
