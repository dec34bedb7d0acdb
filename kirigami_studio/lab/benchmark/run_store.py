"""Finished runs of a suite, one JSON line each, so that a suite that was stopped goes on where it ended."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Protocol, TypeVar

import numpy as np

import kirigami_studio
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ExportError, KirigamiError
from kirigami_studio.foundation.files import folder_of_one_writer, read_at_most
from kirigami_studio.foundation.processes import Workers, results_of
from kirigami_studio.outlines.outline import Outline

#: Largest file of runs that is read (bytes).
LARGEST_FILE = 256 * 2**20
#: Packages that compute no record: faces, files, and texts about finished figures.
NOT_COMPUTING = frozenset(("gui", "cli", "api", "studio", "project", "export", "report", "demonstrations"))
#: What a suite tells its runs by, such as method, family, seed and target.
Key = tuple[str | int, ...]
Record = dict[str, object]


class Keyed(Protocol):
    """A run that a suite wants done."""

    @property
    def key(self) -> Key:
        """What it is found by again."""


Run = TypeVar("Run", bound=Keyed)


class RunStore:
    """Records of finished runs by key.

    The first line of the file has the settings that all of them share, and a digest of the code that computes them, so
    that records of other code are not mixed with new ones.  What a killed process left half written at the
    end is dropped: that run is done again.

    Parameters
    ----------
    settings : dict
        Plain values.
    path : Path, optional
        The file; without one, records last as long as the process.
    """

    def __init__(self, settings: Mapping[str, object], path: Path | None = None) -> None:
        self.records: dict[Key, Record] = {}
        self._path = path
        # As they come back from a file: lists for tuples.
        self._settings: object = json.loads(json.dumps({**settings, "code": code_digest()}))

    @classmethod
    @contextmanager
    def opened(cls, settings: Mapping[str, object], path: Path | None = None) -> Iterator[RunStore]:
        """The store at ``path``, which nobody else may write meanwhile.

        Raises
        ------
        KirigamiError
            The file there has runs with other settings, or cannot be read.
        ExportError
            Somebody else is writing in that folder, or it cannot be written.
        """
        store = cls(settings, path)
        if path is None:
            yield store
            return
        with folder_of_one_writer(path.parent):
            store._read(path)
            yield store

    def add(self, key: Key, record: Record) -> None:
        """Keep one finished run, on disk before this returns."""
        if self._path is not None:
            self._append(self._path, {"key": list(key), **record})
        self.records[key] = record

    def complete(
        self, runs: Sequence[Run], work: Callable[[Run], Record], workers: Workers, report: Callable[[int, int], None]
    ) -> None:
        """Have the runs that are missing done; ``report`` is told (done, total)."""
        waiting = [run for run in runs if run.key not in self.records]
        done = len(runs) - len(waiting)
        report(done, len(runs))
        for run, record in results_of(work, iter(waiting), workers):
            self.add(run.key, record)
            done += 1
            report(done, len(runs))

    def _read(self, path: Path) -> None:
        try:
            content = read_at_most(path, LARGEST_FILE) if path.exists() else b""
            whole = content[: content.rfind(b"\n") + 1]
            if len(whole) < len(content):
                os.truncate(path, len(whole))
            lines = [json.loads(line) for line in whole.splitlines()]
            if lines and lines[0]["settings"] != self._settings:
                raise KirigamiError("benchmark.runs_differ", path=path)
            for line in lines[1:]:
                self.records[tuple(line.pop("key"))] = line
        except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
            raise KirigamiError("benchmark.runs_unreadable", path=path) from error
        if not lines:
            self._append(path, {"settings": self._settings})

    def _append(self, path: Path, line: Record) -> None:
        try:
            with path.open("a", encoding="utf-8") as stream:
                stream.write(json.dumps(line) + "\n")
                stream.flush()
                os.fsync(stream.fileno())
        except OSError as error:
            raise ExportError("file.not_written", path=path, reason=error.strerror or str(error)) from error


@cache
def code_digest() -> str:
    """First digits of the SHA-256 of all modules that records may depend on."""
    root = Path(kirigami_studio.__file__).parent
    found = hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        if NOT_COMPUTING.isdisjoint(path.relative_to(root).parts):
            found.update(path.relative_to(root).as_posix().encode() + path.read_bytes())
    return found.hexdigest()[:16]


def target_key(target: Outline) -> str:
    """Short name of a target's polygon, so that runs of another target in the same place are other runs."""
    return hashlib.sha256(b"".join(np.round(ring, 9).tobytes() for ring in target.rings)).hexdigest()[:16]


def values_of(records: Sequence[Record], name: str) -> FloatArray:
    """One number of every record: (N,)."""
    return np.array([record[name] for record in records], dtype=np.float64)


def mean_of(records: Sequence[Record], name: str) -> float:
    """Mean of one number over records."""
    return float(values_of(records, name).mean())


def group_means(values: FloatArray, groups: Sequence[int]) -> FloatArray:
    """Mean of the values of each group, in the order of the groups' first members."""
    of = np.array(groups)
    return np.array([values[of == group].mean() for group in dict.fromkeys(groups)])
