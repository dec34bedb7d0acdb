"""Reading with limits: regular files only, no more than can be meant, settings without traps."""

from __future__ import annotations

import os
import tracemalloc
from pathlib import Path

import pytest

from kirigami_studio.foundation.files import LARGEST_SETTINGS, read_at_most, read_toml


def test_that_a_file_is_read_up_to_its_limit(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"12345")
    assert read_at_most(path, 5) == b"12345"
    with pytest.raises(OSError, match="too large"):
        read_at_most(path, 4)


def test_that_a_short_file_takes_little_memory_however_long_one_may_be(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"12345")
    tracemalloc.start()
    try:
        assert read_at_most(path, 2**28) == b"12345"
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert most < 2**20


def test_that_a_link_leads_to_its_file(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"content")
    (tmp_path / "link").symlink_to(tmp_path / "file")
    assert read_at_most(tmp_path / "link", 100) == b"content"


def test_that_folders_and_missing_files_are_told_as_such(tmp_path: Path) -> None:
    with pytest.raises(IsADirectoryError):
        read_at_most(tmp_path, 100)
    with pytest.raises(FileNotFoundError):
        read_at_most(tmp_path / "none", 100)
    with pytest.raises(ValueError, match="null"):
        read_at_most(Path("a\0b"), 100)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names here")
def test_that_a_pipe_is_refused_at_once(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OSError, match="pipe or a device"):
        read_at_most(tmp_path / "pipe", 100)


@pytest.mark.parametrize(
    "text",
    ["a = " + "9" * 400, "a = -9223372036854775809", "a = " + "[" * 5000, "a = [[1], [18446744073709551616]]",
     "b = {c = {d = 99999999999999999999}}", "a = 1\na = 2", "a = \xff", "a" * (LARGEST_SETTINGS + 1)],
)  # fmt: skip
def test_that_settings_that_cannot_be_meant_are_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "settings.toml"
    path.write_bytes(text.encode("latin-1"))
    with pytest.raises((ValueError, OSError)):
        read_toml(path)


def test_that_settings_are_read(tmp_path: Path) -> None:
    path = tmp_path / "settings.toml"
    path.write_text('size = 9223372036854775807\nname = "ä"\nlist = [1.5, true]\n', encoding="utf-8")
    assert read_toml(path) == {"size": 2**63 - 1, "name": "ä", "list": [1.5, True]}
