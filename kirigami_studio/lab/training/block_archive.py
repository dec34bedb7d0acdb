"""Archives of training data that grow by blocks.

Block b of a seed always holds the same rows.  A stopped run is taken up where it was, and several processes make
the rows that one would make.
"""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from itertools import count as count_from
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeVar, cast

import numpy as np

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.files import opened_file, write_atomically
from kirigami_studio.foundation.processes import Workers, results_of

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

#: Largest archive that is read (bytes).
LARGEST_FILE = 2 * 2**30


class BlockArchive:
    """Arrays of equally many rows, a base of dataclasses.

    ``block`` is among the arrays, and the dictionary ``about`` is beside them.
    """

    __slots__ = ()
    #: Names of the arrays that a training run looks at.
    SEEN: ClassVar[tuple[str, ...]]
    about: dict[str, object]

    @classmethod
    def arrays(cls) -> tuple[str, ...]:
        """Names of the arrays."""
        return tuple(one.name for one in fields(cast("type[DataclassInstance]", cls)) if one.name != "about")

    def save(self, path: Path) -> None:
        """Write the archive atomically."""
        buffer = io.BytesIO()
        arrays = {name: getattr(self, name) for name in self.arrays()}
        np.savez(buffer, about=np.array(json.dumps(self.about)), **arrays)
        write_atomically(path, buffer.getvalue())

    @classmethod
    def load(cls, path: Path) -> Self:
        """Read an archive.

        Raises
        ------
        KirigamiError
            It is missing, damaged or holds something else.
        """
        try:
            with opened_file(path, LARGEST_FILE) as file, np.load(file, allow_pickle=False) as archive:
                arrays = {name: archive[name] for name in cls.arrays()}
                about = json.loads(str(archive["about"]))
            found = cls(**arrays, about=about)  # type: ignore[call-arg]  # of a dataclass
            found.check()
        except Exception as error:  # zipfile and NumPy raise a dozen kinds on damaged archives
            raise KirigamiError("training.fits_unreadable", path=path) from error
        return found

    def check(self) -> None:
        """Raise a ValueError where the arrays cannot be rows of one archive."""
        if len({len(getattr(self, name)) for name in self.arrays()}) > 1:
            raise ValueError("arrays of other lengths")

    @property
    def digest(self) -> str:
        """SHA-256 of what a training run sees of the archive."""
        return hashlib.sha256(b"".join(getattr(self, name).tobytes() for name in self.SEEN)).hexdigest()


Archive = TypeVar("Archive", bound=BlockArchive)


def grown(
    path: Path,
    nothing: Archive,
    made_by: dict[str, object],
    made: Callable[[int], Archive],
    workers: Workers,
    size: Callable[[Archive], int],
    wanted: int,
) -> Iterator[int]:
    """Add blocks to an archive until its size is the one wanted; yields the size after each.

    Parameters
    ----------
    path : Path
    nothing : archive without rows
        Begins the archive where there is none.
    made_by : dict
        Settings of the archive.
    made : callable
        Number of a block -> its rows.  A function of a module, or a partial of one.
    workers : Workers
        Who makes blocks.
    size : callable
        Counts what an archive has.
    wanted : int

    Raises
    ------
    KirigamiError
        The archive there was made with other settings.
    """
    archive = type(nothing).load(path) if path.exists() else _replaced(nothing, about={**made_by, "blocks": []})
    other = [name for name, value in made_by.items() if archive.about.get(name) != value]
    if other:
        raise KirigamiError("training.fits_differ", path=path, settings=", ".join(other))
    done = set(cast("list[int]", archive.about["blocks"]))
    blocks = results_of(made, (number for number in count_from(0) if number not in done), workers)
    while size(archive) < wanted:
        number, new = next(blocks)
        archive = _joined(archive, new, number)
        archive.save(path)
        yield size(archive)
    blocks.close()


def _joined(archive: Archive, new: Archive, block: int) -> Archive:
    """Both, in the order of their blocks whatever finished first."""
    blocks = sorted([*cast("list[int]", archive.about["blocks"]), block])
    order = np.argsort(np.concatenate([getattr(archive, "block"), getattr(new, "block")]), kind="stable")  # noqa: B009
    arrays: dict[str, Any] = {
        name: np.concatenate([getattr(archive, name), getattr(new, name)])[order] for name in archive.arrays()
    }
    return _replaced(archive, **arrays, about={**archive.about, "blocks": blocks})


def _replaced(archive: Archive, **values: Any) -> Archive:
    return cast("Archive", replace(cast("DataclassInstance", archive), **values))
