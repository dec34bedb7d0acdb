"""The documents stay true: links and paths exist, commands are accepted, the guide names what the window shows."""

from __future__ import annotations

import argparse
import ast
import re
import shlex
from collections.abc import Mapping
from pathlib import Path

import pytest

from kirigami_studio.cli.parser import all_commands, build_parser
from tests.catalogues import catalogue, forms

pytestmark = pytest.mark.rule

#: Folders with documents, beside those in the root.
FOLDERS = ("docs", "resources", "tests", "packaging", "kirigami_studio")
#: ``[text](place)`` and ``![text](place)``; the place without its anchor and title.
LINK = re.compile(r"\[[^\]\n]*\]\(\s*<?([^)\s#>]+)")
#: A path with a folder: ``gui/session/session.py``, ``tests/data/oracles``.
PATH = re.compile(r"(?<![\w./:-])(?:[\w-]+/)+[\w-]+(?:\.[\w-]+)*/?(?![\w/*(])")
COMMAND = re.compile(r"kirigami-studio ([^`#\n|]+)")
#: Made by the program or by ``make``.
MADE = ("out/", "runs/", "build/", "dist/")


@pytest.fixture(scope="module")
def documents(repository: Path) -> dict[Path, str]:
    """Text of every Markdown file of the repository."""
    found = [*repository.glob("*.md"), *(path for folder in FOLDERS for path in (repository / folder).rglob("*.md"))]
    assert len(found) > 12
    return {path: path.read_text(encoding="utf-8") for path in found}


@pytest.fixture(scope="module")
def present(documents: dict[Path, str]) -> dict[Path, str]:
    """The documents that describe the present program: all but the changelog, which also tells what was."""
    return {path: text for path, text in documents.items() if path.name != "CHANGELOG.md"}


def dead_links(document: Path, text: str) -> list[str]:
    """Relative links and images of a document that lead to no file."""
    places = [place for place in LINK.findall(text) if not re.match(r"[a-z]+:", place)]
    return [place for place in places if not (document.parent / place).exists()]


def missing_paths(repository: Path, text: str, *beside: Path) -> list[str]:
    """Paths in a document that begin in repository or package, or name a module, and are not there or beside."""
    roots = (repository, repository / "kirigami_studio")
    places = [place.rstrip("/") for place in PATH.findall(text) if not place.startswith(MADE)]
    ours = [
        place
        for place in places
        if place.endswith(".py") or any((root / place.partition("/")[0]).is_dir() for root in roots)
    ]
    return [place for place in ours if not any((root / place).exists() for root in (*roots, *beside))]


def refused_commands(text: str) -> list[str]:
    """Commands in a document that the command line does not take."""
    first_words = {command.name.partition(" ")[0] for command in all_commands()}
    refused = []
    for shown in COMMAND.findall(text.replace("\\\n", " ")):
        words = shlex.split(shown.replace("...", ""))
        # From a redirection on, words are the shell's.
        words = words[: next((place for place, word in enumerate(words) if word in ("<", ">")), None)]
        if words[0] in first_words:
            try:
                build_parser().parse_args(words)
            except (SystemExit, argparse.ArgumentError):
                refused.append(shown.strip())
    return refused


def missing_targets(makefile: str, text: str) -> list[str]:
    """Targets of ``make`` that a document names and the Makefile does not have."""
    named = re.findall(r"(?:`|^ {4})make (\w+)", text, flags=re.MULTILINE)
    return [target for target in named if not re.search(rf"^{target}:", makefile, flags=re.MULTILINE)]


#: Words in bold, which name controls; in italics, which name choices; and keys.
BOLD, ITALIC, CODE = r"\*\*([^*]+)\*\*", r"(?<![*\w])\*([^*]+)\*(?!\*)", r"`([^`]+)`"
PICTURE = r"!\[[^\]]+\]\(([^)]+)\)"
#: What German keyboards call keys, as the German window does.
KEYS = {
    "Ctrl": "Strg",
    "Shift": "Umschalt",
    "Del": "Entf",
    "Delete": "Entf",
    "Enter": "Eingabe",
    "Backspace": "Rücktaste",
    "Space": "Leertaste",
    "PgUp": "Bild auf",
    "PgDn": "Bild ab",
    "Home": "Pos1",
    "End": "Ende",
}


def sections_of(guide: str) -> list[str]:
    """The text from one heading to the next, the headings included."""
    return re.split(r"^(?=#)", guide, flags=re.MULTILINE)[1:]


def blocks_of(section: str) -> list[str]:
    """Paragraphs, entries of lists and rows of tables."""
    return [block for block in re.split(r"\n\n+|\n(?=[|-] |[|-]{3}|\d\. )", section.strip()) if block]


def named(block: str, pattern: str) -> list[str]:
    """What is named in a block, ways through menus step by step, each on one line."""
    return [" ".join(part.split()) for words in re.findall(pattern, block) for part in words.split(" > ")]


def pattern_of(text: str) -> str:
    """A regular expression for what a text of the window becomes once its values are put in."""
    parts = re.split(r"\{[^{}]*\}", re.sub(r"&(?=\w)", "", text))
    return r".+?".join(re.escape(part) for part in parts)


def begins(text: str, words: str) -> bool:
    """Whether words are those that a text begins with, values put in or not."""
    return bool(re.match(rf"{re.escape(words)}(?!\w)", re.sub(r"&(?=\w)", "", text))) or bool(
        "{" in text and len(re.sub(r"\{[^{}]*\}|\W", "", text)) > 3 and re.fullmatch(pattern_of(text), words)
    )


def called_otherwise(english: str, german: str, texts: Mapping[str, tuple[str, ...]], pattern: str) -> list[str]:
    """What a German block names and is not what the window calls a thing that the English block names."""
    ours, theirs = named(german, pattern), named(english, pattern)
    if len(ours) != len(theirs):
        return [f"{theirs} -> {ours}"]
    known = {words: [said for source, said in texts.items() if begins(source, words)] for words in theirs}
    wanted = [text for found in known.values() for said in found for text in said]
    other = [words for words in ours if not any(begins(text, words) for text in wanted)]
    return other if len(other) > sum(not known[words] for words in theirs) else []  # which are no texts of the window


def texts_of_the_window(package: Path) -> set[str]:
    """What the window, and settings, give to ``tr``, ``tr_n`` and ``mark``, without mnemonics and dots."""
    found, sayings = set(), ("tr", "tr_n", "mark")
    for path in package.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        if package / "gui" not in path.parents and "foundation.settings import" not in text:
            continue
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in sayings:
                words = [one.value for one in node.args if isinstance(one, ast.Constant) and isinstance(one.value, str)]
                found |= {re.sub(r"&(?=\w)", "", text) for text in words}
    return found


def not_in_the_window(guide: str, texts: set[str]) -> list[str]:
    """Bold words of the guide with which no text of the window begins."""
    bold = [part for words in re.findall(r"\*\*([^*]+)\*\*", guide) for part in words.split(" > ")]
    return [part for part in bold if not any(re.match(rf"{re.escape(part)}(?!\w)", text) for text in texts)]


def test_that_the_guide_calls_things_as_the_window_does(repository: Path) -> None:
    texts = texts_of_the_window(repository / "kirigami_studio")
    guide = (repository / "resources" / "guide" / "guide.md").read_text(encoding="utf-8")
    assert guide.count("**") > 80
    assert not_in_the_window(guide, texts) == []
    assert not_in_the_window("**File > Open recent**, **Take away**", texts) == ["Take away"]


@pytest.fixture(scope="module")
def guides(repository: Path) -> tuple[str, str]:
    """The English and the German guide."""
    english, german = (repository / "resources" / "guide" / name for name in ("guide.md", "guide.de.md"))
    return english.read_text(encoding="utf-8"), german.read_text(encoding="utf-8")


def test_that_the_german_guide_has_the_sections_pictures_and_tables_of_the_english_one(
    guides: tuple[str, str],
) -> None:
    english, german = (sections_of(guide) for guide in guides)
    assert [section.partition(" ")[0] for section in german] == [section.partition(" ")[0] for section in english]
    for own, other in zip(german, english, strict=True):
        title = own.partition("\n")[0]
        assert re.findall(PICTURE, own) == re.findall(PICTURE, other), title
        assert [kind_of(block) for block in blocks_of(own)] == [kind_of(block) for block in blocks_of(other)], title


def kind_of(block: str) -> str:
    """What a block begins with if it is no plain paragraph; how many columns a row has."""
    return f"| {block.count('|')}" if block.startswith("|") else (re.match(r"[#-]+ |\d\. |!", block) or [""])[0]


def test_that_the_german_guide_names_the_keys_of_the_english_one(guides: tuple[str, str]) -> None:
    english, german = (blocks_of(guide) for guide in guides)
    for own, other in zip(german, english, strict=True):
        keys = [re.sub(r"[A-Z]\w+", lambda found: KEYS.get(found[0], found[0]), keys) for keys in named(other, CODE)]
        assert sorted(named(own, CODE)) == sorted(keys), own


def test_that_the_german_guide_calls_things_as_the_german_window_does(guides: tuple[str, str]) -> None:
    texts = {forms(message.id)[0]: forms(message.string) for message in catalogue("de") if message.id}
    english, german = (blocks_of(guide) for guide in guides)
    for own, other in zip(german, english, strict=True):
        assert called_otherwise(other, own, texts, BOLD) == [], own
        assert called_otherwise(other, own, texts, ITALIC) == [], own
    assert called_otherwise("**Edit > Done**", "**Fertig**, **Bearbeiten**", texts, BOLD) == []
    assert called_otherwise("**Edit > Done**", "**Fertig**, **Ändern**", texts, BOLD) == ["Ändern"]
    assert called_otherwise("**Done**", "Fertig", texts, BOLD) == ["['Done'] -> []"]


def test_that_every_relative_link_and_picture_exists(documents: dict[Path, str]) -> None:
    assert {path.as_posix(): found for path, text in documents.items() if (found := dead_links(path, text))} == {}


def test_that_every_path_in_the_documents_exists(present: dict[Path, str], repository: Path) -> None:
    assert {
        path.as_posix(): found
        for path, text in present.items()
        if (found := missing_paths(repository, text, path.parent))
    } == {}


def test_that_the_command_line_accepts_every_command_shown(present: dict[Path, str]) -> None:
    assert {path.as_posix(): found for path, text in present.items() if (found := refused_commands(text))} == {}


def test_that_every_make_target_shown_exists(present: dict[Path, str], repository: Path) -> None:
    makefile = (repository / "Makefile").read_text(encoding="utf-8")
    assert {
        path.as_posix(): found for path, text in present.items() if (found := missing_targets(makefile, text))
    } == {}


def test_that_planted_faults_are_found(repository: Path) -> None:
    text = (
        "See [the map](docs/map.md), [here](README.md) and ![it](docs/pictures/none.png).\n"
        "`lattice/gone.py` and `lattice/compact.py`, `tests/unit/nowhere`, `kirigami_studio/gone.py`, 10 m/s.\n\n"
        "    kirigami-studio benchmark lattice --json   # fits\n"
        "    kirigami-studio benchmark lattice --json > here.json\n"
        "    kirigami-studio benchmark lattice --variant prior\n"
        "    make demo\n"
        "    make tea\n"
    )
    assert dead_links(repository / "README.md", text) == ["docs/map.md", "docs/pictures/none.png"]
    found = missing_paths(repository, text)
    assert {"lattice/gone.py", "tests/unit/nowhere", "kirigami_studio/gone.py"} <= set(found)
    assert "lattice/compact.py" not in found
    assert refused_commands(text) == ["benchmark lattice --variant prior"]
    assert missing_targets("demo: setup\n", text) == ["tea"]
