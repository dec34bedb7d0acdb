"""Standard input and output in the place of files, silence where that is asked for, completion in shells."""

from __future__ import annotations

import io
import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from command_line import answer, refusal

import kirigami_studio as ks
from kirigami_studio.cli import main

BOX = b'<svg xmlns="http://www.w3.org/2000/svg"><rect id="box" width="30" height="20"/></svg>'
EMPTY = b'<svg xmlns="http://www.w3.org/2000/svg"></svg>'
RATIOS = np.exp(np.random.default_rng(3).normal(0.0, 0.2, (4, 5)))

Pipe = Callable[[bytes], None]


@pytest.fixture
def pipe(monkeypatch: pytest.MonkeyPatch) -> Pipe:
    """Puts content on standard input."""

    def put(content: bytes) -> None:
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(content)))

    return put


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return ks.decode(RATIOS).for_target("square").save(tmp_path_factory.mktemp("projects") / "square.kiri")


def array_file(**arrays: np.ndarray) -> bytes:
    stream = io.BytesIO()
    if arrays:
        np.savez(stream, **arrays)
    else:
        np.save(stream, RATIOS)
    return stream.getvalue()


@pytest.mark.parametrize("kind", ["svg", "outline", "project"])
def test_that_a_target_comes_from_standard_input_as_from_its_file(
    kind: str, pipe: Pipe, project: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "ratios.json").write_text(json.dumps({"ratio": RATIOS.tolist()}), encoding="utf-8")
    if kind == "project":
        pipe(project.read_bytes())
        assert answer(capsys, "score", "-", "square", "--json") == answer(capsys, "score", project, "square", "--json")
        return
    content, suffix = (BOX, ".svg") if kind == "svg" else (b"[[0, 0], [3, 0], [3, 2], [0, 2]]", ".json")
    (tmp_path / f"target{suffix}").write_bytes(content)
    pipe(content)
    found = answer(capsys, "score", tmp_path / "ratios.json", "-", "--json")
    assert found == answer(capsys, "score", tmp_path / "ratios.json", tmp_path / f"target{suffix}", "--json")


@pytest.mark.parametrize("content", [json.dumps(RATIOS.tolist()).encode(), array_file()])
def test_that_a_sheet_comes_from_standard_input(content: bytes, pipe: Pipe, capsys: pytest.CaptureFixture[str]) -> None:
    pipe(content)
    found = np.array(answer(capsys, "decode", "-", "--json")["panels_flat"])
    assert np.allclose(found, ks.decode(RATIOS).panels(np.pi).reshape(-1, 4, 2))


def test_that_an_archive_on_standard_input_is_a_batch(pipe: Pipe, capsys: pytest.CaptureFixture[str]) -> None:
    pipe(array_file(ratios=np.array([RATIOS, RATIOS])))
    assert main(["decode", "-"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 2


def test_that_what_is_wrong_with_standard_input_is_said_of_a_dash(
    pipe: Pipe, project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pipe(EMPTY)
    assert main(["score", str(project), "-", "--json"]) == 1
    out, err = capsys.readouterr()
    assert json.loads(out)["error"].startswith("-: ") and " -: " in err and "stdin" not in out + err
    for content in (b"", b"hello", b"\0\1\2"):
        pipe(content)
        code, told = refusal(capsys, "score", "-", "heart")
        assert code == 2 and "Standard input" in told


def test_that_a_cut_file_goes_to_standard_output_and_its_report_to_standard_error(
    project: Path, pipe: Pipe, tmp_path: Path, capfdbinary: pytest.CaptureFixture[bytes]
) -> None:
    words = ["export", str(project), "--material", "film-uv", "--out"]
    assert main([*words, str(tmp_path / "cut.dxf")]) == 0
    capfdbinary.readouterr()
    assert main([*words, "-", "--format", "dxf"]) == 0
    out, err = capfdbinary.readouterr()
    assert out == (tmp_path / "cut.dxf").read_bytes()
    assert b"-: verified by two readers" in err and b"cut.dxf" not in err
    assert main([*words, "-", "--format", "dxf", "--quiet"]) == 0
    assert capfdbinary.readouterr() == (out, b"")
    pipe(out)
    assert main(["check", "-", "--json"]) == 0
    checked = json.loads(capfdbinary.readouterr().out)
    assert checked["file"] == "-" and checked["sound"] and checked["record"]["material"] == "film-uv"


@pytest.mark.parametrize("more", [["--json"], ["--all"], ["--construction", "pinned", "--material", "card-co2"]])
def test_that_standard_output_takes_one_file_alone(
    more: list[str], project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code, _ = refusal(capsys, "export", project, "--out", "-", *more)
    assert code == 2


def test_that_a_quiet_command_says_nothing_but_errors_and_json(
    project: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    loud = ["export", str(project), "--out", str(tmp_path / "cut.svg"), "--material", "card-co2"]
    assert main(loud) == 0 and "verified" in capsys.readouterr().out
    assert main([*loud, "--quiet"]) == 0 and capsys.readouterr() == ("", "")
    assert "siou" in answer(capsys, "score", project, "square", "--quiet", "--json")
    assert main(["score", "gone.json", "heart", "--quiet"]) == 1
    assert capsys.readouterr().err.startswith("kirigami-studio: ")
    assert main(["targets"]) == 0 and "heart" in capsys.readouterr().out  # silence ends with its command


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
@pytest.mark.parametrize(
    ("words", "found"),
    [
        (["des"], {"design"}),
        (["design", "--sym"], {"--symmetry"}),
        (["design", "--symmetry", "mir"], {"mirror"}),
        (["export", "squ"], {"square.kiri"}),
        (["completion", "z"], {"zsh"}),
    ],
)
def test_that_bash_completes_commands_options_choices_and_files(
    words: list[str], found: set[str], project: Path, completion: Path
) -> None:
    line = " ".join(f"'{word}'" for word in ["kirigami-studio", *words])
    script = (
        f"shopt -s progcomp; source '{completion}'; COMP_WORDS=({line}); COMP_CWORD={len(words)}; "
        f"_shtab_kirigami_studio kirigami-studio; printf '%s\\n' \"${{COMPREPLY[@]}}\""
    )
    done = subprocess.run(
        ["bash", "-c", script], capture_output=True, text=True, cwd=project.parent, timeout=60, check=False
    )
    assert set(done.stdout.split()) == found, done.stderr


@pytest.fixture(scope="module")
def completion(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What bash reads, as the command prints it."""
    path = tmp_path_factory.mktemp("shell") / "completion.bash"
    with pytest.MonkeyPatch.context() as patch, path.open("w", encoding="utf-8") as stream:
        patch.setattr(sys, "stdout", stream)
        assert main(["completion", "bash"]) == 0
    return path
