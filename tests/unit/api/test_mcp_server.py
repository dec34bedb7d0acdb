"""Assistants design, judge, export and look at sheets over the Model Context Protocol, in one folder."""

from __future__ import annotations

import base64
import io
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from command_line import refusal
from PIL import Image

import kirigami_studio as ks

BOX = '<svg xmlns="http://www.w3.org/2000/svg"><rect width="30" height="20"/></svg>'
#: Tools and their arguments, one after the other, in a folder with box.svg and way-out.kiri, a link to another folder.
CALLS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("design", {"target": "box.svg", "project": "box.kiri", "k": 2, "grid": [3, 3], "polish": False, "regular": 0.0}),
    ("verdict", {"project": "box.kiri", "name": "A2", "material": "film-uv", "width_mm": 60}),
    ("export", {"project": "box.kiri", "file": "cut/box.dxf", "material": "film-uv", "width_mm": 60}),
    ("picture", {"project": "box.kiri", "phi_deg": 180}),
    ("export", {"project": "box.kiri", "file": "../box.dxf"}),
    ("export", {"project": "way-out.kiri", "file": "box.dxf"}),
    ("design", {"target": "heart", "project": "box.txt"}),
    ("design", {"target": "outside.svg"}),
    ("design", {"target": "heart", "symmetry": "miror"}),
)


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory, repository: Path) -> tuple[Path, dict[str, Any], list[Any]]:
    """The folder, the tools of the server, and its answers to the calls, by the client of the official SDK."""
    pytest.importorskip("mcp")
    import anyio
    from mcp import ClientSession, StdioServerParameters, stdio_client

    root = tmp_path_factory.mktemp("served")
    folder = root / "sheets"
    (folder / "cut").mkdir(parents=True)
    (folder / "box.svg").write_text(BOX, encoding="utf-8")
    for name in ("outside.svg", "way-out.kiri"):
        (root / name).write_text(BOX, encoding="utf-8")
    (folder / "way-out.kiri").symlink_to(root / "way-out.kiri")
    environment = {**os.environ, "PYTHONPATH": str(repository), "OMP_NUM_THREADS": "1"}
    words = ["-m", "kirigami_studio", "mcp", "--folder", str(folder)]
    program = StdioServerParameters(command=sys.executable, args=words, env=environment, cwd=root)

    async def talk() -> tuple[dict[str, Any], list[Any]]:
        # The client hands its standard error on, which is no file where a test before has captured it.
        with (tmp_path_factory.mktemp("errors") / "errors.txt").open("w", encoding="utf-8") as errors:
            async with stdio_client(program, errlog=errors) as (read, write), ClientSession(read, write) as session:
                await session.initialize()
                tools = {tool.name: tool for tool in (await session.list_tools()).tools}
                return tools, [await session.call_tool(name, options) for name, options in CALLS]

    return folder, *anyio.run(talk)


Served = tuple[Path, Mapping[str, Any], list[Any]]


def test_that_the_tools_say_what_they_take(served: Served) -> None:
    _, tools, _ = served
    assert set(tools) == {"design", "verdict", "export", "picture"}
    taken = tools["design"].input_schema["properties"]
    assert taken["symmetry"]["enum"] == ["auto", "none", "mirror", "turn"] and "library" in tools["design"].description


def test_that_an_assistant_designs_judges_exports_and_looks(served: Served) -> None:
    folder, _, (made, judged, written, shown, *_) = served
    assert not made.is_error, made.content
    found = ks.load_project(folder / "box.kiri")
    assert made.structured_content["designs"] == found.table() and len(found) == 2
    cuts = found["A2"].plan_cuts(material="film-uv", width_mm=60)
    assert judged.structured_content["verdict"] == cuts.verdict.to_json()
    assert judged.structured_content["cut_length_mm"] == pytest.approx(cuts.cut_length_mm)
    assert written.structured_content["files"] == ["cut/box.dxf"] and written.structured_content["as_planned"]
    assert ks.check(folder / "cut" / "box.dxf", found.chosen).sound
    (picture,) = shown.content
    with Image.open(io.BytesIO(base64.b64decode(picture.data))) as image:
        assert image.format == "PNG" and max(image.size) == 900


def test_that_nothing_outside_the_folder_is_read_or_written(served: Served) -> None:
    folder, _, (*_, out, link, kind, target, word) = served
    for answer, told in (
        (out, "'../box.dxf' is not in the folder"),
        (link, "'way-out.kiri' is not in the folder"),
        (kind, "'box.txt' has another extension"),
        (target, "no file and no library silhouette called 'outside.svg'"),
        (word, "symmetry"),
    ):
        assert answer.is_error and told in answer.content[0].text, answer.content
    assert {path.name for path in folder.parent.iterdir()} == {"sheets", "outside.svg", "way-out.kiri"}


def test_that_the_server_says_which_package_it_needs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "mcp.server.mcpserver", None)
    code, told = refusal(capsys, "mcp", "--folder", tmp_path)
    assert code == 2 and "pip install 'kirigami-studio[mcp]'" in told


def test_that_a_folder_that_is_not_there_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("mcp")
    code, told = refusal(capsys, "mcp", "--folder", tmp_path / "gone")
    assert code == 2 and "no folder" in told
