"""Reads files that are made to hurt, in a process with little memory; ``READER=FILE ...``, a line of JSON for each."""

from __future__ import annotations

import json
import resource
import sys
import time
from collections.abc import Callable
from pathlib import Path

from kirigami_studio.cli.inputs import read_mask
from kirigami_studio.evaluate.mask_siou import mask_siou
from kirigami_studio.export.dxf_check import check_file
from kirigami_studio.export.dxf_reading import read_with_ezdxf
from kirigami_studio.export.group_codes import read_group_codes
from kirigami_studio.export.svg_reading import read_with_svgelements, read_with_xml
from kirigami_studio.fabricate.material import read_preset
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.sheet_files import read_sheet
from kirigami_studio.outlines.read import read_parts, read_target
from kirigami_studio.project import preferences, recent, recovery, store

#: Memory (bytes) that reading may take beside what the program takes.
MOST_MEMORY = 2**30


def checked(path: Path) -> None:
    check_file(path)


def verified_dxf(path: Path) -> None:
    attempted(path, read_with_ezdxf, read_group_codes)


def verified_svg(path: Path) -> None:
    attempted(path, read_with_svgelements, read_with_xml)


def attempted(path: Path, *readers: Callable[[Path], object]) -> None:
    """Have all read it, and refuse it as the last one that did."""
    refusal: KirigamiError | None = None
    for reader in readers:
        try:
            reader(path)
        except KirigamiError as error:
            refusal = error
    if refusal is not None:
        raise refusal


def target(path: Path) -> None:
    read_target(str(path))


def parts(path: Path) -> None:
    read_parts(str(path))


def mask(path: Path) -> None:
    read = read_mask(path)
    mask_siou(read, read)


def sheet(path: Path) -> None:
    deploy(read_sheet(path)).outline(0.0)


READERS: dict[str, Callable[[Path], object]] = {
    "target": target,
    "parts": parts,
    "check": checked,
    "dxf": verified_dxf,
    "svg": verified_svg,
    "mask": mask,
    "sheet": sheet,
    "material": read_preset,
    "preferences": preferences.load,
    "recent": recent.load,
    "project": store.load,
    "recovery": recovery.read_note,
}


def outcome(reader: Callable[[Path], object], path: Path) -> str:
    """The sentence that a person gets; empty where the file is fine."""
    try:
        reader(path)
    except KirigamiError as error:
        return f"refused: {error}"
    except BaseException as error:
        return f"UNCAUGHT {type(error).__name__}: {error}"
    return "read"


if __name__ == "__main__":
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + MOST_MEMORY, used + MOST_MEMORY))
    for asked in sys.argv[1:]:
        reader, _, name = asked.partition("=")
        begun = time.process_time()
        found = outcome(READERS[reader], Path(name))
        line = {"name": Path(name).name, "seconds": time.process_time() - begun, "outcome": found}
        sys.stdout.write(f"{json.dumps(line)}\n")
        sys.stdout.flush()
