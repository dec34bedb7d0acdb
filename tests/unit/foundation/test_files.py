"""A file appears whole or not at all."""

from __future__ import annotations

import contextlib
import os
import socket
import stat
from pathlib import Path

import pytest

from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically
from tests.refusals import refused


def test_that_a_file_is_written_into_folders_that_did_not_exist(tmp_path: Path) -> None:
    path = tmp_path / "a" / "b" / "cut.dxf"
    write_atomically(path, b"0\nEOF\n")
    assert path.read_bytes() == b"0\nEOF\n"
    assert stat.S_IMODE(path.stat().st_mode) == 0o644


def test_that_a_file_keeps_its_permissions(tmp_path: Path) -> None:
    path = tmp_path / "private.kiri"
    path.write_bytes(b"old")
    path.chmod(0o600)
    write_atomically(path, b"new")
    assert path.read_bytes() == b"new"
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    link = tmp_path / "link.kiri"
    link.symlink_to(path)
    write_atomically(link, b"newer")
    assert stat.S_IMODE(path.stat().st_mode) == 0o600


def test_that_a_name_may_be_as_long_as_the_file_system_allows(tmp_path: Path) -> None:
    path = tmp_path / f"{'a' * 251}.dxf"
    write_atomically(path, b"new")
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]


def test_that_an_older_file_is_replaced_and_nothing_else_is_left(tmp_path: Path) -> None:
    path = tmp_path / "cut.dxf"
    path.write_bytes(b"old")
    write_atomically(path, b"new")
    assert path.read_bytes() == b"new"
    assert [entry.name for entry in tmp_path.iterdir()] == ["cut.dxf"]


def test_that_an_old_file_survives_a_failure_on_the_last_step(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "cut.dxf"
    path.write_bytes(b"old")

    def disk_full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", disk_full)
    with pytest.raises(ExportError, match=r"cut\.dxf: No space left on device"):
        write_atomically(path, b"new")
    assert path.read_bytes() == b"old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["cut.dxf"]


def test_that_a_folder_in_the_way_is_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "cut.dxf").mkdir()
    with refused(ExportError, "file.is_a_folder"):
        write_atomically(tmp_path / "cut.dxf", b"x")
    (tmp_path / "file").write_bytes(b"")
    with refused(ExportError, "file.not_written"):
        write_atomically(tmp_path / "file" / "cut.dxf", b"x")
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["cut.dxf", "file"]


def test_that_a_link_stays_and_the_file_behind_it_is_written(tmp_path: Path) -> None:
    kept = tmp_path / "kept"
    kept.mkdir()
    (kept / "real.kiri").write_bytes(b"old")
    (kept / "middle.kiri").symlink_to("real.kiri")
    link = tmp_path / "link.kiri"
    link.symlink_to(Path("kept") / "middle.kiri")
    write_atomically(link, b"new")
    assert link.is_symlink() and (kept / "middle.kiri").is_symlink()
    assert link.read_bytes() == b"new" and not (kept / "real.kiri").is_symlink()
    assert sorted(entry.name for entry in kept.iterdir()) == ["middle.kiri", "real.kiri"]
    assert [entry.name for entry in tmp_path.iterdir() if entry.name.startswith(".")] == []


def test_that_a_file_behind_a_link_survives_a_failure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real, link = tmp_path / "real.kiri", tmp_path / "link.kiri"
    real.write_bytes(b"old")
    link.symlink_to(real)

    def disk_full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", disk_full)
    with pytest.raises(ExportError, match=r"link\.kiri: No space left"):
        write_atomically(link, b"new")
    assert real.read_bytes() == b"old" and link.is_symlink() and len(list(tmp_path.iterdir())) == 2


def test_that_links_to_nothing_and_in_circles_are_refused_in_a_sentence(tmp_path: Path) -> None:
    broken, one, other = (tmp_path / name for name in ("broken.kiri", "one.kiri", "other.kiri"))
    broken.symlink_to("gone.kiri")
    one.symlink_to(other)
    other.symlink_to(one)
    with pytest.raises(ExportError, match=r"broken\.kiri: it is a link to gone\.kiri, which does not exist\. Delete"):
        write_atomically(broken, b"x")
    with pytest.raises(ExportError, match=r"one\.kiri: the link leads back to itself\. Delete"):
        write_atomically(one, b"x")
    assert all(link.is_symlink() for link in (broken, one, other)) and len(list(tmp_path.iterdir())) == 3


def special_files(folder: Path) -> dict[str, Path]:
    """A pipe, a socket and, where this user may make one, a device that is always full; links to each."""
    made = {"pipe": folder / "pipe", "socket": folder / "socket"}
    os.mkfifo(made["pipe"])
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(made["socket"]))
    with contextlib.suppress(OSError):
        os.mknod(folder / "device", stat.S_IFCHR | 0o600, os.makedev(1, 7))
        made["device"] = folder / "device"
    for name, path in tuple(made.items()):
        made[f"link to a {name}"] = folder / f"link_{name}"
        made[f"link to a {name}"].symlink_to(path)
    return made


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names here")
def test_that_pipes_sockets_and_devices_are_refused_and_stay(tmp_path: Path) -> None:
    for name, path in special_files(tmp_path).items():
        before = path.stat()
        assert not stat.S_ISREG(before.st_mode), f"the {name} is one, so this test can fail"
        with pytest.raises(ExportError) as refused:
            write_atomically(path, b"a drawing")
        assert refused.value.code == "file.not_a_file" and str(path) in str(refused.value)
        after = path.stat()
        assert (after.st_mode, after.st_ino) == (before.st_mode, before.st_ino)
        assert path.is_symlink() == name.startswith("link")
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == []
