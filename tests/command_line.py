"""The command line as a test calls it: one JSON object as the answer, or one sentence as the refusal."""

from __future__ import annotations

import json

import pytest

from kirigami_studio.cli import main


def answer(capsys: pytest.CaptureFixture[str], *argv: object) -> dict:
    code = main([str(word) for word in argv])
    captured = capsys.readouterr()
    assert code == 0, captured.err
    assert captured.err == ""
    (line,) = captured.out.splitlines()
    return json.loads(line)


def refusal(capsys: pytest.CaptureFixture[str], *argv: object) -> tuple[int, str]:
    code = main([str(word) for word in argv])
    captured = capsys.readouterr()
    if "--json" in argv and captured.out:
        assert json.loads(captured.out).keys() == {"source", "error"}
    else:
        assert captured.out == ""
    assert "Traceback" not in captured.err
    assert len(captured.err.splitlines()) == 1
    return code, captured.err
