"""Freeze the installed program into a folder that needs no Python, and pack it: ``python packaging/bundle.py``.

Run with an interpreter that has the wheel and PyInstaller (``packaging/constraints-bundle.txt``) and nothing else:
what is installed beside them could get into the bundle.  ``packaging/release.py`` makes such an environment.  Writes
``build/bundle/kirigami-studio`` (on macOS an application) and, on Linux and Windows, the archive into ``--out``.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Iterable, Iterator, Sequence
from datetime import date
from importlib.metadata import Distribution, distribution, packages_distributions
from pathlib import Path, PurePosixPath

sys.path.insert(0, str(Path(__file__).resolve().parent))
from version import ROOT, ReleaseError, changes, file_names, version

BUILD = ROOT / "build" / "bundle"
IDENTIFIER = "local.kirigami-studio"
METAINFO = "local.kirigami_studio.kirigami_studio.metainfo.xml"

#: Modules that nothing in the program reaches, though something that it uses names them.
UNUSED_MODULES = [
    *("tkinter", "_tkinter", "curses", "_curses", "readline", "dbm", "_gdbm", "_dbm", "sqlite3", "_sqlite3"),
    # The program opens no connection; without these, no OpenSSL has to be kept up to date.
    *("ssl", "_ssl", "_hashlib"),
    *("ensurepip", "idlelib", "lib2to3", "pydoc_data", "turtledemo", "test"),
    *("setuptools", "pkg_resources", "_distutils_hack", "distutils", "pip", "wheel"),
    *("IPython", "matplotlib", "pandas", "pytest", "_pytest", "hypothesis", "distributed", "dask", "cma"),
    # What torch compiles and exports models with; only optimisers need some of it, and training needs Python anyway.
    *("torch._dynamo", "torch._inductor", "torch.onnx", "torch.utils.tensorboard", "torch.utils.benchmark"),
    *(
        "torch.utils.cpp_extension",
        "torch.utils.hipify",
        "sympy",
        "mpmath",
        "networkx",
        "jinja2",
        "markupsafe",
        "fsspec",
    ),
    *("PySide6.QtNetwork", "PySide6.QtOpenGL", "PySide6.QtOpenGLWidgets", "PySide6.QtTest", "PySide6.QtQml"),
    *("PySide6.QtQuick", "PySide6.QtSql", "PySide6.QtDBus", "PySide6.QtUiTools"),
    *("scipy.datasets", "pyqtgraph.examples", "pyqtgraph.opengl"),
]
#: Plugins of Qt that are kept.
PLUGINS = re.compile(
    r"platforms/(lib)?q(xcb|wayland|offscreen|windows|cocoa)|imageformats/(lib)?q(svg|jpeg|gif|ico|icns|webp|tiff)|"
    r"iconengines/|printsupport/|platformthemes/|platforminputcontexts/lib(compose|ibus)|styles/|xcbglintegrations/|wayland-"
)
#: Libraries of Qt that only left out plugins need.
QT_LIBRARIES = re.compile(
    r"(lib)?Qt6?(Qml|Quick|Pdf|VirtualKeyboard|Network|Sql|EglFs|EglFS|Designer|Help|UiTools|Test|Labs|Lottie|"
    r"WaylandCompositor|WaylandEglCompositor|Concurrent|Xml)\w*(\.|$)"
)
#: Files that are read by compilers and tests alone, and pictures to try scikit-image with.
UNREAD = re.compile(
    r"\.(h|hpp|c|cc|cpp|cu|cuh|pxd|pyx|pxi|a|lib|cmake|whl)$|(^|/)tests?/|^skimage/data/.*\.(png|jpg|gif|tif|tiff)$|"
    r"^torch/(include|share|test)/|lib(jitbackend_test|backend_with_compiler|torchbind_test|aoti_custom_ops)|"
    r"\.dist-info/|^PySide6/Qt/(qml|metatypes|libexec)/|^PySide6/(glue|include|typesystems|scripts)/"
)
#: Libraries of a Linux system that go along: Python's own, and the small ones of X that are often not installed.
#: All others (X, OpenGL, fonts, the C and C++ libraries) belong to the desktop and its drivers.
KEPT_SYSTEM_LIBRARIES = re.compile(r"lib(ffi|z|bz2|lzma|xcb-(cursor|icccm|image|keysyms|render-util|util))\.so")
SYSTEM = ("/lib", "/usr/lib")


def left_out(target: str, source: str) -> bool:
    """Whether a file that PyInstaller found stays out of the bundle.

    Parameters
    ----------
    target : str
        Its place in the bundle.
    source : str
        Where it comes from.
    """
    place = target.replace("\\", "/")
    name = PurePosixPath(place).name
    if sys.platform.startswith("linux") and source.startswith(SYSTEM) and not is_python(source):
        return not KEPT_SYSTEM_LIBRARIES.match(name)
    if place.startswith("PySide6/"):
        plugin = re.search(r"/plugins/(.*)", place)
        if plugin is not None and not PLUGINS.match(plugin[1]):
            return True
        if "/translations/" in place and name != "qtbase_de.qm":
            return True
        if QT_LIBRARIES.match(name):
            return True
    if place.endswith(".pyi"):  # lazy_loader reads those of scikit-image
        return not place.startswith("skimage/")
    return bool(UNREAD.search(place)) and not place.startswith("kirigami_studio/")


def is_python(source: str) -> bool:
    """Whether a file belongs to the interpreter's own library."""
    return any(source.startswith(sysconfig.get_path(name)) for name in ("stdlib", "platstdlib"))


# licences ------------------------------------------------------------------------------------------------------------


def licence_files(*tables: Iterable[tuple[str, str, str]]) -> list[tuple[str, str, str]]:
    """Metadata and licences of all that is in the bundle, as further files of it.

    Parameters
    ----------
    tables : iterables of (target, source, kind)
        Modules, binaries and files that PyInstaller found.

    Raises
    ------
    SystemExit
        Something would be shipped without a licence.
    """
    entries = [entry for table in tables for entry in table]
    found: list[tuple[str, str, str]] = []
    for package in shipped_packages(entries):
        folder = Path(str(package.locate_file(""))) / metadata_folder(package)
        files = [path for path in folder.rglob("*") if path.is_file() and is_licence(path.relative_to(folder))]
        files.append(folder / "METADATA")
        found += [(f"{folder.name}/{path.relative_to(folder).as_posix()}", str(path), "DATA") for path in files]
    texts = BUILD / "licences"
    shutil.rmtree(texts, ignore_errors=True)
    texts.mkdir(parents=True)
    table = []
    for name, number, licence, homepage, source in other_parts(entries):
        file = f"bundle-{re.sub(r'[^a-z0-9.]+', '-', name.lower())}.txt"
        shutil.copyfile(source, texts / file)
        table.append({"name": name, "version": number, "licence": licence, "homepage": homepage, "texts": [file]})
    (texts / "bundle.json").write_text(json.dumps(table, indent=2) + "\n", encoding="utf-8")
    target = "kirigami_studio/resources/licences"
    return found + [(f"{target}/{path.name}", str(path), "DATA") for path in sorted(texts.iterdir())]


def is_licence(path: Path) -> bool:
    """Whether a file of a package's metadata is a licence, wherever it lies there."""
    return path.parts[0] == "licenses" or re.match(r"(LICEN[CS]E|COPYING|NOTICE|AUTHORS)", path.name) is not None


def metadata_folder(package: Distribution) -> str:
    """Name of the ``dist-info`` folder of a package."""
    files = (str(path) for path in package.files or ())
    return next(path.partition("/")[0] for path in files if path.partition("/")[0].endswith(".dist-info"))


def shipped_packages(entries: Sequence[tuple[str, str, str]]) -> list[Distribution]:
    """The Python packages that any entry comes from."""
    owners = packages_distributions()
    tops = {re.split(r"[./\\]", target)[0] for target, _, _ in entries}
    names = {owner for top in tops for owner in owners.get(top, ())}
    return [distribution(name) for name in sorted(names) if name.lower() != "pyinstaller"]


def other_parts(entries: Sequence[tuple[str, str, str]]) -> Iterator[tuple[str, str, str, str, Path]]:
    """Name, version, licence, homepage and licence file of what is no Python package."""
    python = Path(sysconfig.get_path("stdlib")) / "LICENSE.txt"
    places = (python, Path(sys.base_prefix) / "LICENSE.txt", Path(sys.base_prefix) / "LICENSE")
    licence = next((place for place in places if place.is_file()), None)
    if licence is None:
        sys.exit("bundle: the licence of Python was not found beside its library")
    yield "Python", sys.version.split()[0], "PSF-2.0", "https://www.python.org", licence
    start = distribution("pyinstaller")
    text = next(path for path in start.files or () if path.name.startswith("COPYING"))
    kind = "GPL-2.0-or-later WITH Bootloader-exception"
    yield "PyInstaller's starter", start.version, kind, "https://pyinstaller.org", Path(str(start.locate_file(text)))
    if sys.platform.startswith("linux"):
        sources = {source for _, source, _ in entries if source.startswith(SYSTEM) and not is_python(source)}
        for package in sorted({debian_package(Path(source)) for source in sources}):
            yield (package, debian_version(package), "see its text", "", Path("/usr/share/doc") / package / "copyright")


def debian_package(library: Path) -> str:
    """The package that a library of the system comes from."""
    real = library.resolve()
    for place in (real, Path("/", *real.parts[2:])):  # before or after /lib became a part of /usr
        done = subprocess.run(["dpkg", "-S", str(place)], capture_output=True, text=True, check=False)
        if done.returncode == 0:
            return done.stdout.partition(":")[0]
    sys.exit(f"bundle: no package, and so no licence, is known for {library}")


def debian_version(package: str) -> str:
    """The version of an installed package."""
    return subprocess.run(
        ["dpkg-query", "-W", "-f", "${Version}", package], capture_output=True, text=True, check=True
    ).stdout  # fmt: skip


# icons, macOS --------------------------------------------------------------------------------------------------------


def icon_pictures(edges: Iterable[int] = (16, 24, 32, 48, 64, 128, 256, 512)) -> dict[int, Path]:
    """The program's icon as PNG, by the length of its edges in pixels."""
    from PySide6.QtCore import QRectF
    from PySide6.QtGui import QImage, QPainter
    from PySide6.QtSvg import QSvgRenderer

    drawing = QSvgRenderer(str(ROOT / "resources" / "icons" / "kirigami-studio.svg"))
    folder = BUILD.parent / "icons"
    folder.mkdir(parents=True, exist_ok=True)
    pictures = {}
    for edge in edges:
        picture = QImage(edge, edge, QImage.Format.Format_ARGB32_Premultiplied)
        picture.fill(0)
        painter = QPainter(picture)
        drawing.render(painter, QRectF(0, 0, edge, edge))
        painter.end()
        pictures[edge] = folder / f"kirigami-studio-{edge}.png"
        picture.save(str(pictures[edge]))
    return pictures


def icon_file() -> Path:
    """The icon in the format of this system."""
    from PIL import Image

    pictures = icon_pictures()
    largest = Image.open(pictures[512])
    if sys.platform == "win32":
        path = pictures[512].with_name("kirigami-studio.ico")
        largest.save(path, sizes=[(edge, edge) for edge in pictures if edge <= 256])
    elif sys.platform == "darwin":
        path = pictures[512].with_name("kirigami-studio.icns")
        largest.save(path)
    else:
        path = pictures[512]
    return path


def signing_identity() -> str | None:
    """Who signs on macOS: the name of a certificate in the keychain; nobody if it is not given."""
    return os.environ.get("KIRIGAMI_SIGN_IDENTITY") or None


def entitlements() -> str | None:
    """What the signed application may do on macOS."""
    return str(ROOT / "packaging" / "macos" / "entitlements.plist") if signing_identity() else None


def information() -> dict[str, object]:
    """What macOS is told about the application and its projects."""
    return {
        "CFBundleDisplayName": "Kirigami Studio",
        "CFBundleShortVersionString": version(),
        "LSMinimumSystemVersion": "12.0",
        "LSApplicationCategoryType": "public.app-category.graphics-design",
        "NSHighResolutionCapable": True,
        "NSHumanReadableCopyright": "MIT licence",
        "CFBundleLocalizations": ["en", "de"],
        "CFBundleDocumentTypes": [
            {
                "CFBundleTypeName": "Kirigami Studio project",
                "CFBundleTypeRole": "Editor",
                "LSHandlerRank": "Owner",
                "LSItemContentTypes": [f"{IDENTIFIER}.project"],
            },
            {
                "CFBundleTypeName": "Drawing or picture",
                "CFBundleTypeRole": "Viewer",
                "LSHandlerRank": "Alternate",
                "LSItemContentTypes": ["public.svg-image", "public.png", "public.jpeg"],
            },
        ],
        "UTExportedTypeDeclarations": [
            {
                "UTTypeIdentifier": f"{IDENTIFIER}.project",
                "UTTypeDescription": "Kirigami Studio project",
                "UTTypeConformsTo": ["public.data"],
                "UTTypeTagSpecification": {
                    "public.filename-extension": ["kiri"],
                    "public.mime-type": ["application/x-kirigami-studio"],
                },
            }
        ],
    }


# the bundle ----------------------------------------------------------------------------------------------------------


def freeze() -> Path:
    """Run PyInstaller; return the folder, or on macOS the application, that it has made."""
    command = [sys.executable, "-m", "PyInstaller", "--noconfirm", "--log-level", "WARN"]
    places = ["--distpath", str(BUILD / "dist"), "--workpath", str(BUILD / "work")]
    # Not in the checkout: its package must not be taken for the installed one.
    subprocess.run([*command, *places, str(ROOT / "packaging" / "kirigami-studio.spec")], cwd=BUILD, check=True)
    return frozen()


def frozen() -> Path:
    """What PyInstaller makes: a folder, or on macOS the application."""
    return BUILD / "dist" / ("Kirigami Studio.app" if sys.platform == "darwin" else "kirigami-studio")


def strip(folder: Path) -> None:
    """Take symbols out of torch's libraries and of Python's; those of other wheels were patched and do not bear it."""
    own = ("torch/lib/*.so*", "libpython*", "python*/lib-dynload/*.so")
    for library in (path for pattern in own for path in folder.glob(f"_internal/{pattern}")):
        subprocess.run(["strip", "--strip-unneeded", str(library)], check=True)


def needed_libraries(folder: Path) -> set[str]:
    """Libraries that files of a Linux bundle need and that are not in it.

    GTK's look is taken where GTK is installed, Wayland where it runs: what only these plugins need is not counted.
    """
    files = [path for path in folder.rglob("*") if path.is_file() and (".so" in path.name or os.access(path, os.X_OK))]
    sure = [path for path in files if not re.search("qgtk3|wayland|Wayland|WlShell", str(path))]
    said = subprocess.run(["readelf", "-d", *map(str, sure)], capture_output=True, text=True, check=False).stdout
    return set(re.findall(r"\(NEEDED\).*\[(.+)\]", said)) - {path.name for path in files}


def pack(folder: Path, out: Path) -> Path:
    """Pack a folder as the archive of a release; xz -9 takes twice as long to save 2 %."""
    out.mkdir(parents=True, exist_ok=True)
    archive = out / file_names(version())["bundle"]
    archive.unlink(missing_ok=True)
    if archive.suffix == ".zip":
        shutil.make_archive(str(archive.with_suffix("")), "zip", folder.parent, folder.name)
        return archive
    ordered = ["--sort=name", "--owner=0", "--group=0", "--numeric-owner", "-C", str(folder.parent), folder.name]
    subprocess.run(
        ["tar", "-c", "-I", "xz -T2", "-f", str(archive), *ordered], check=True, env=os.environ | {"LC_ALL": "C"}
    )
    return archive


def add_desktop_files(folder: Path) -> None:
    """Put the installer of the Linux archive, and what it registers with the desktop, into the folder."""
    linux = ROOT / "packaging" / "linux"
    share = folder / "share"
    shutil.rmtree(share, ignore_errors=True)
    for name, place in desktop_files().items():
        (share / place).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(name, share / place)
    for place, content in shell_files(folder / "kirigami-studio").items():
        (share / place).parent.mkdir(parents=True, exist_ok=True)
        (share / place).write_text(content, encoding="utf-8")
    about = share / "metainfo" / METAINFO
    about.write_text(dated(about.read_text(encoding="utf-8")), encoding="utf-8")
    for name in ("install.sh", "README.txt"):
        shutil.copy(linux / name, folder)
    shutil.copy(ROOT / "LICENSE", folder)


def shell_files(program: Path) -> dict[str, str]:
    """Completion and manual page of the frozen program, by their places below ``share``."""
    places = {"bash": "bash-completion/completions/kirigami-studio", "zsh": "zsh/site-functions/_kirigami-studio"}
    printed = {
        place: subprocess.run([program, "completion", shell], capture_output=True, text=True, check=True).stdout
        for shell, place in places.items()
    }
    return printed | {"man/man1/kirigami-studio.1": manual()}


def manual() -> str:
    """The manual page, made of the parser by argparse-manpage."""
    from argparse_manpage.manpage import Manpage

    from kirigami_studio.cli import parser

    parser.has_lab = lambda: False  # as in the frozen program
    data = {"project_name": "Kirigami Studio", "version": version(), "manual_title": "Kirigami Studio"}
    page = str(Manpage(parser.build_parser(), _data=data))
    # A line that begins with an extension is no macro; those of troff that lack capitals have two letters.
    return re.sub(r"(?m)^\.(?=[a-z0-9]{3})", r"\\&.", page)


def dated(text: str) -> str:
    """A text with the version and the day of its release, or today before there is one, in their places."""
    try:
        day = changes(version())[0]
    except ReleaseError:
        day = date.today().isoformat()
    return text.replace("@version@", version()).replace("@date@", day)


def desktop_files() -> dict[Path, str]:
    """What a Linux desktop is told about the program: the files, and their places below ``share``."""
    linux = ROOT / "packaging" / "linux"
    icons = {path: f"icons/hicolor/{edge}x{edge}/apps/kirigami-studio.png" for edge, path in icon_pictures().items()}
    return icons | {
        linux / "kirigami-studio.desktop": "applications/kirigami-studio.desktop",
        linux / "kirigami-studio.xml": "mime/packages/kirigami-studio.xml",
        linux / METAINFO: f"metainfo/{METAINFO}",
        linux
        / "application-x-kirigami-studio.svg": "icons/hicolor/scalable/mimetypes/application-x-kirigami-studio.svg",
        ROOT / "resources" / "icons" / "kirigami-studio.svg": "icons/hicolor/scalable/apps/kirigami-studio.svg",
    }


def main() -> int:
    """Freeze, cut, pack."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=ROOT / "dist", help="folder of the archive (default: dist)")
    steps = parser.add_mutually_exclusive_group()
    steps.add_argument("--no-archive", action="store_true", help="only make the folder")
    steps.add_argument("--archive-only", action="store_true", help="only pack the folder that was made")
    arguments = parser.parse_args()
    BUILD.mkdir(parents=True, exist_ok=True)
    if arguments.archive_only:
        print(pack(frozen(), arguments.out))
        return 0
    folder = freeze()
    if sys.platform.startswith("linux"):
        strip(folder)
        add_desktop_files(folder)
        print("needs from the system:", *sorted(needed_libraries(folder)))
    print(folder)
    if not arguments.no_archive and sys.platform != "darwin":
        print(pack(folder, arguments.out))
    return 0


if __name__ == "__main__":
    sys.exit(main())
