"""What the documents say of files is what the program writes: the project format, the citation, the issue forms."""

from __future__ import annotations

import io
import json
import re
import zipfile
from pathlib import Path

import pytest

from kirigami_studio import __version__
from kirigami_studio.cli.parser import QUIET, all_commands
from kirigami_studio.foundation.resources import resource
from kirigami_studio.project.migrations import CURRENT_VERSION
from kirigami_studio.project.picture_record import LARGEST_PICTURE
from kirigami_studio.project.store import LARGEST_CONTENT, LARGEST_FILE, MANIFEST, MOST_MEMBERS, load, pack

pytestmark = pytest.mark.rule

#: Tables of texts by the user's and the run's own words.
FREE = {"provenance", "runs", "made_with"}


@pytest.fixture(scope="module")
def page(repository: Path) -> str:
    """The page on the project format."""
    return (repository / "docs" / "file-format.md").read_text(encoding="utf-8")


def written_names(value: object) -> set[str]:
    """All names in a JSON value, but for those in tables of free words."""
    if isinstance(value, list):
        return set().union(*map(written_names, value)) if value else set()
    if not isinstance(value, dict):
        return set()
    names = set(value)
    for name, inside in value.items():
        names |= set() if name in FREE else written_names(inside)
    return names


def told_names(page: str) -> set[str]:
    """All names in the page's section on the design: words of code without dots and blanks."""
    section = page.partition("## `design.json`")[2].partition("## Limits")[0]
    return {name for name in re.findall(r"`([a-z_0-9]+)`", section)}


def examples() -> list[Path]:
    """The bundled projects."""
    found = [resource("examples", "heart.kiri"), *sorted(resource("pairs").glob("*.kiri"))]
    assert len(found) > 10
    return found


def test_that_the_page_tells_every_name_that_the_program_writes(page: str) -> None:
    written = set()
    for path in examples():
        with zipfile.ZipFile(io.BytesIO(pack(load(path)))) as archive:
            written |= written_names(json.loads(archive.read("design.json")))
    assert {"target", "start", "score", "least_neck"} <= written
    assert sorted(written - told_names(page)) == []


def test_that_the_program_knows_every_name_that_the_page_tells(page: str, repository: Path) -> None:
    package = repository / "kirigami_studio"
    files = [*(package / "project").glob("*.py"), *(package / "settings").glob("*.py")]
    files += [package / "fabricate" / "options.py", package / "lattice" / "sheet_files.py"]
    classes = ("evaluate/score.py", "evaluate/evenness.py", "evaluate/similarity.py", "evaluate/feasibility.py")
    text = "\n".join(path.read_text(encoding="utf-8") for path in (*files, *(package / name for name in classes)))
    unknown = [name for name in told_names(page) if not re.search(rf'"{name}"|^    {name}: ', text, re.MULTILINE)]
    words = {"none", "pinned", "rejected", "design", "runs", "sampled"}  # values, a command, and names of members
    assert sorted(set(unknown) - words) == []


def test_that_the_example_on_the_page_runs(page: str, repository: Path, monkeypatch: pytest.MonkeyPatch,
                                           capsys: pytest.CaptureFixture[str]) -> None:  # fmt: skip
    (program,) = re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)
    monkeypatch.chdir(repository)
    exec(compile(program, "docs/file-format.md", "exec"), {})
    name, *_, match = capsys.readouterr().out.split()
    assert name == "heart"
    assert float(match) > 0.9


def test_that_versions_and_limits_on_the_page_are_those_of_the_program(page: str) -> None:
    assert f"now {CURRENT_VERSION})" in page
    assert f"| file | {LARGEST_FILE // 2**20} MB |" in page
    assert f"| all members unpacked | {LARGEST_CONTENT // 2**20} MB |" in page
    assert f"| members | {MOST_MEMBERS} |" in page
    assert f"| a picture | {LARGEST_PICTURE // 2**20} MB |" in page
    members = set(re.findall(r"`([a-z0-9]+\.(?:json|npy|png))`", page))
    with zipfile.ZipFile(resource("examples", "heart.kiri")) as archive:
        assert set(archive.namelist()) <= members
    assert MANIFEST in members


def test_that_the_command_line_page_names_every_command_and_no_option_that_there_is_not(repository: Path) -> None:
    text = (repository / "docs" / "command-line.md").read_text(encoding="utf-8")
    assert [one.name for one in all_commands() if one.name.split()[0] not in text] == []
    known = {name for one in all_commands() for names, _ in one.options for name in names}
    known |= {"--help", "--version", *QUIET[0]}
    known |= {f"--no-{name[2:]}" for name in known}
    theirs = {"--nproc-per-node", "--nthreads", "--nworkers", "--rcfile"}  # of torchrun and dask
    docs = repository / "docs"  # other pages tell of other programs' options, too, as that on releasing does
    ours = [docs / "command-line.md", docs / "training.md", *docs.glob("tutorials/*.md"), *docs.glob("how-to/*.md")]
    assert len(ours) > 10
    for path in ours:
        named = set(re.findall(r"(?<![\w-])--[a-z][a-z-]+", path.read_text(encoding="utf-8")))
        assert sorted(named - known - theirs) == [], path


def test_that_the_citation_is_complete_and_of_this_version(repository: Path) -> None:
    yaml = pytest.importorskip("yaml")
    citation = yaml.safe_load((repository / "CITATION.cff").read_text(encoding="utf-8"))
    assert {"cff-version", "message", "title", "authors"} <= set(citation)
    assert citation["cff-version"] == "1.2.0"
    assert citation["version"] == __version__
    assert citation["license"] == "MIT"
    (paper,) = citation["references"]
    assert {"type", "title", "authors"} <= set(paper)
    assert "2605.08098" in paper["identifiers"][0]["value"]
    assert all("name" in one or "family-names" in one for one in (*citation["authors"], *paper["authors"]))


def test_that_issue_forms_are_forms(repository: Path) -> None:
    yaml = pytest.importorskip("yaml")
    forms = [path for path in (repository / ".github" / "ISSUE_TEMPLATE").glob("*.yml") if path.name != "config.yml"]
    assert len(forms) == 3
    for path in forms:
        form = yaml.safe_load(path.read_text(encoding="utf-8"))
        assert {"name", "description", "body"} <= set(form), path.name
        fields = [one for one in form["body"] if one["type"] != "markdown"]
        assert all(one["type"] in {"input", "textarea", "dropdown", "checkboxes"} for one in fields), path.name
        assert len({one["id"] for one in fields}) == len(fields), path.name
        assert all(one["attributes"].get("label") for one in fields), path.name
        assert all(one["attributes"].get("options") for one in fields if one["type"] == "dropdown"), path.name
