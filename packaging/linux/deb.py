"""Pack the frozen program as a Debian package: ``python packaging/linux/deb.py [--out dist]``, after ``bundle.py``.

The package asks for the libraries that the bundle needs and does not carry, by the packages that they come from here.
Menu, icons and file type need no script: Debian's own packages for them watch the folders, and are recommended.
"""

from __future__ import annotations

import argparse
import gzip
import os
import shutil
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from bundle import BUILD, debian_package, needed_libraries
from version import ROOT, file_names, version

CONTROL = """\
Package: kirigami-studio
Version: {version}
Architecture: {architecture}
Maintainer: Kirigami Studio contributors <maintainers@localhost>
Installed-Size: {size}
Depends: {depends}
Recommends: desktop-file-utils, shared-mime-info, hicolor-icon-theme, xdg-utils
Section: graphics
Priority: optional
Description: Design kirigami sheets that open into a silhouette
 Draw or load a silhouette, get a flat sheet with cuts that opens into it, and
 send the file to your laser or blade cutter. A bundled generative model draws
 designs, and all are fitted on the exact geometry. Two independent readers
 check every cut file.
"""
COPYRIGHT = """\
Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: Kirigami Studio
Comment: Everything else that the package contains has its licence beside it, in
 /usr/lib/kirigami-studio/_internal/*.dist-info and
 /usr/lib/kirigami-studio/_internal/kirigami_studio/resources/licences.
 "kirigami-studio licences" lists all of it.

Files: *
Copyright: 2026 Kirigami Studio contributors
License: MIT
"""


def library_paths() -> dict[str, Path]:
    """Where the loader finds each library of this system."""
    listed = subprocess.run(["/sbin/ldconfig", "-p"], capture_output=True, text=True, check=True).stdout
    lines = [line.strip().partition(" ") for line in listed.splitlines() if " => " in line and "x32" not in line]
    return {name: Path(rest.rpartition(" => ")[2]) for name, _, rest in reversed(lines)}


def dependencies(folder: Path) -> str:
    """The packages that the bundle needs, as a line of the control file."""
    known = library_paths()
    wanted = {name for name in needed_libraries(folder) if not name.startswith("ld-linux")}
    missing = sorted(wanted - set(known))
    if missing:
        sys.exit(f"deb: install these to learn their packages: {', '.join(missing)}")
    packages = {debian_package(known[name]) for name in wanted}
    libc = subprocess.run(["sh", "-c", "readelf -V $(find . -name '*.so*' -type f) kirigami-studio | "
                           "grep -o 'GLIBC_2\\.[0-9]*' | sort -uV | tail -n 1"],
                          cwd=folder, capture_output=True, text=True, check=True).stdout.strip()  # fmt: skip
    return ", ".join(f"libc6 (>= {libc[6:]})" if name == "libc6" else name for name in sorted(packages))


def make(folder: Path, out: Path) -> Path:
    """Write the package and return it."""
    name = file_names(version())["deb"]
    root = BUILD / "deb"
    shutil.rmtree(root, ignore_errors=True)
    home = root / "usr" / "lib" / "kirigami-studio"
    shutil.copytree(folder, home, symlinks=True, copy_function=os.link)
    shutil.move(home / "share", root / "usr" / "share")
    for left in ("install.sh", "README.txt", "LICENSE"):
        (home / left).unlink()
    (root / "usr" / "bin").mkdir()
    (root / "usr" / "bin" / "kirigami-studio").symlink_to("../lib/kirigami-studio/kirigami-studio")
    documents = root / "usr" / "share" / "doc" / "kirigami-studio"
    documents.mkdir(parents=True)
    licence = "".join(f" {line or '.'}\n" for line in (ROOT / "LICENSE").read_text(encoding="utf-8").splitlines()[4:])
    (documents / "copyright").write_text(COPYRIGHT + licence, encoding="utf-8")
    with gzip.GzipFile(documents / "changelog.gz", "wb", 9, mtime=0) as changelog:
        changelog.write((ROOT / "CHANGELOG.md").read_bytes())
    size = sum(path.lstat().st_size for path in root.rglob("*")) // 1024
    control = root / "DEBIAN" / "control"
    control.parent.mkdir()
    architecture = name.rpartition("_")[2].removesuffix(".deb")
    control.write_text(
        CONTROL.format(version=version(), architecture=architecture, size=size, depends=dependencies(folder)),
        encoding="utf-8",
    )
    out.mkdir(parents=True, exist_ok=True)
    subprocess.run(["dpkg-deb", "--root-owner-group", "-Zxz", "-z6", "--build", str(root), str(out / name)], check=True)
    return out / name


def main() -> int:
    """Pack what ``bundle.py`` has made."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=ROOT / "dist", help="folder of the package (default: dist)")
    folder = BUILD / "dist" / "kirigami-studio"
    if not folder.is_dir():
        sys.exit("deb: run packaging/bundle.py first")
    print(make(folder, parser.parse_args().out))
    return 0


if __name__ == "__main__":
    sys.exit(main())
