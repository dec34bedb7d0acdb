"""No reader follows a file to other files or to the network, and no file is run as code."""

from __future__ import annotations

import ast
import base64
import io
import socket
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from attacked_readers import READERS, outcome
from PIL import Image

SVG = (
    '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="9mm" viewBox="0 0 9 9">'
)
SHAPE = '<path d="M0 0h9v5h-4v4h-5z" fill="#000"/></svg>'


@pytest.fixture
def secret(tmp_path: Path) -> Path:
    """A file that nobody asked for."""
    path = tmp_path / "secret.png"
    Image.new("RGB", (9, 9), (250, 10, 10)).save(path)
    return path


def linking(to: str) -> dict[str, str]:
    """Files that lead to another one, by name."""
    packed = base64.b64encode(f'{SVG}<image xlink:href="{to}" width="9" height="9"/></svg>'.encode()).decode()
    return {
        "image.svg": f'{SVG}<image xlink:href="{to}" width="9" height="9"/>{SHAPE}',
        "plain_href.svg": f'{SVG}<image href="{to}" width="9" height="9"/>{SHAPE}',
        "inner.svg": f'{SVG}<image href="data:image/png;base64,{packed}" width="9" height="9"/>{SHAPE}',
        "filter.svg": f'{SVG}<filter id="f"><feImage href="{to}"/></filter><g filter="url(#f)">{SHAPE[:-6]}</g></svg>',
        "use.svg": f'{SVG}<use href="{to}#a"/>{SHAPE}',
        "style.svg": f'<?xml-stylesheet type="text/css" href="{to}"?>{SVG}<style>@import url("{to}");</style>{SHAPE}',
        "entity.svg": f'<!DOCTYPE svg [<!ENTITY a SYSTEM "{to}">]>{SVG}<text>&a;</text>{SHAPE}',
        "dtd.svg": f'<!DOCTYPE svg SYSTEM "{to}">{SVG}{SHAPE}',
        "include.svg": f'{SVG}<i:include xmlns:i="http://www.w3.org/2001/XInclude" href="{to}"/>{SHAPE}',
        "reference.dxf": drawing(to),
    }


def drawing(to: str) -> str:
    """A DXF with a block that lies in another file, a picture in one, and a closed line."""
    import ezdxf
    from ezdxf.document import Drawing

    document: Drawing = ezdxf.new("R2010")  # type: ignore[attr-defined]
    document.add_xref_def(to, "other")
    space = document.modelspace()
    space.add_blockref("other", (0, 0))
    space.add_image(document.add_image_def(to, (9, 9)), (0, 0), (9, 9))
    space.add_lwpolyline([(0, 0), (9, 0), (9, 5), (5, 5), (5, 9), (0, 9)], close=True)
    text = io.StringIO()
    document.write(text)
    return text.getvalue()


#: Reads files in a process where opening the secret, or any connection, is written down.
WATCHED = """
import sys
secret, seen = sys.argv[1], []
def watch(event, arguments):
    if event == "open" and secret in str(arguments[0]):
        seen.append(event)
    elif event.startswith(("socket.connect", "socket.getaddrinfo", "urllib", "subprocess", "os.system", "os.exec")):
        seen.append(event)
sys.addaudithook(watch)
from pathlib import Path
from attacked_readers import READERS, outcome
for word in sys.argv[2:]:
    reader, _, path = word.partition("=")
    said = outcome(READERS[reader], Path(path))
    print(reader, Path(path).name, seen, said, sep="\\t")
    seen.clear()
"""


def test_that_no_reader_opens_what_a_file_refers_to(tmp_path: Path, secret: Path) -> None:
    asked = []
    for kind, to in {"path": str(secret), "url": secret.as_uri(), "web": "http://127.0.0.1:9/secret.png"}.items():
        for name, content in linking(to).items():
            path = tmp_path / f"{kind}_{name}"
            path.write_text(content, encoding="utf-8")
            # Artwork is drawn by Qt, past this watch: see the next test.
            readers = (name for name in READERS if path.suffix in READERS[name].endings and name != "artwork")
            asked += [f"{reader}={path}" for reader in readers]
    tests = str(Path(__file__).parents[1])
    done = subprocess.run(
        [sys.executable, "-c", WATCHED, str(secret), *asked],
        env={"PATH": "", "QT_QPA_PLATFORM": "offscreen", "PYTHONPATH": ":".join([tests, *sys.path])},
        capture_output=True, text=True, check=True, timeout=200,
    )  # fmt: skip
    lines = [line.split("\t") for line in done.stdout.splitlines()]
    assert len(lines) == len(asked)
    assert [line for line in lines if line[2] != "[]"] == []
    assert [line for line in lines if line[3].startswith("UNCAUGHT")] == []


@pytest.mark.parametrize("name", ["image.svg", "plain_href.svg", "inner.svg", "filter.svg", "use.svg", "style.svg"])
def test_that_artwork_shows_no_pixel_of_another_file(tmp_path: Path, secret: Path, name: str) -> None:
    """Qt opens files itself, past Python's audit."""
    from kirigami_studio.export.artwork_picture import read_picture
    from kirigami_studio.foundation.errors import TargetError
    from kirigami_studio.gui.stage.artwork_painting import svg_to_png

    path = tmp_path / name
    path.write_text(linking(str(secret))[name], encoding="utf-8")
    try:
        picture = read_picture(path, svg_to_png)
    except TargetError as refusal:
        assert "other file" in str(refusal) or "PNG" in str(refusal)
        return
    with Image.open(io.BytesIO(picture.content)) as image:
        pixels = np.asarray(image.convert("RGBA"))
    red = (pixels[..., 0] > 100) & (pixels[..., 1] < 100) & (pixels[..., 3] > 0)
    assert not red.any()


def test_that_artwork_with_an_embedded_picture_is_drawn(tmp_path: Path, secret: Path) -> None:
    from kirigami_studio.export.artwork_picture import read_picture
    from kirigami_studio.gui.stage.artwork_painting import svg_to_png

    packed = base64.b64encode(secret.read_bytes()).decode()
    path = tmp_path / "embedded.svg"
    path.write_text(f'{SVG}<image xlink:href="data:image/png;base64,{packed}" width="9" height="9"/></svg>')
    with Image.open(io.BytesIO(read_picture(path, svg_to_png).content)) as image:
        assert image.convert("RGB").getpixel((image.width // 2, image.height // 2)) == (250, 10, 10)


class _Runs:
    """What a pickle would do where somebody loads it."""

    def __init__(self, marker: Path) -> None:
        self._marker = marker

    def __reduce__(self) -> tuple[Callable[..., object], tuple[object, ...]]:
        return Path.touch, (self._marker,)


@pytest.mark.torch
def test_that_no_reader_runs_a_pickle(tmp_path: Path) -> None:
    import pickle

    marker = tmp_path / "ran"
    stream = io.BytesIO()
    np.save(stream, np.array([_Runs(marker)], dtype=object), allow_pickle=True)
    pickled, raw = stream.getvalue(), pickle.dumps(_Runs(marker))
    names = ("ratios", "masks", "about", "z", "quads_m", "bonds", "sampled")
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w") as packed:
        for name in names:
            packed.writestr(f"{name}.npy", pickled)
    tensors = io.BytesIO()
    with zipfile.ZipFile(tensors, "w") as packed:
        packed.writestr("archive/data.pkl", raw)
        packed.writestr("archive/version", "3\n")
        packed.writestr("archive/byteorder", "little")
    project = io.BytesIO()
    example = Path(__file__).parents[2] / "resources" / "examples" / "heart.kiri"
    with zipfile.ZipFile(example) as whole, zipfile.ZipFile(project, "w") as packed:
        for name in whole.namelist():
            packed.writestr(name, pickled if name.endswith(".npy") else whole.read(name))
    contents = {
        ".npy": (pickled, raw), ".npz": (archive.getvalue(), pickled), ".kiri": (project.getvalue(), raw),
        ".pt": (tensors.getvalue(), raw), ".safetensors": (raw,),
    }  # fmt: skip
    count = 0
    for ending, files in contents.items():
        for number, content in enumerate(files):
            path = tmp_path / f"pickle{number}{ending}"
            path.write_bytes(content)
            for reader in (reader for reader in READERS.values() if ending in reader.endings):
                assert outcome(reader, path).startswith("refused: ")
                count += 1
    assert count >= 12
    assert not marker.exists()
    np.load(io.BytesIO(pickled), allow_pickle=True)  # the trap itself snaps
    assert marker.exists()


def calls_in(code: str) -> list[str]:
    """Calls that could run what a file says: NumPy and torch with pickles, pickle itself, eval and exec."""
    found = []
    for call in (node for node in ast.walk(ast.parse(code)) if isinstance(node, ast.Call)):
        last = getattr(call.func, "attr", getattr(call.func, "id", ""))
        if last not in ("load", "loads", "open", "eval", "exec", "read_array"):
            continue
        name = ast.unparse(call.func)
        given = {word.arg: ast.unparse(word.value) for word in call.keywords}
        if name in ("np.load", "numpy.load") or last == "read_array":
            if given.get("allow_pickle") != "False":
                found.append(ast.unparse(call))
        elif name == "torch.load":
            if given.get("weights_only") != "True":
                found.append(ast.unparse(call))
        elif name in ("eval", "exec", "pickle.load", "pickle.loads", "marshal.loads", "shelve.open", "yaml.load"):
            found.append(ast.unparse(call))
    return found


def test_that_no_code_of_the_program_loads_pickles_or_evaluates_text(repository: Path) -> None:
    # Worker processes that the program started itself send their answers through pipes.
    own = {"kirigami_studio/pipeline/pool.py", "kirigami_studio/pipeline/worker.py"}
    found = {
        path.relative_to(repository).as_posix(): calls
        for path in sorted((repository / "kirigami_studio").rglob("*.py"))
        if (calls := calls_in(path.read_text(encoding="utf-8")))
    }
    assert set(found) == own
    assert calls_in("np.load(path)\ntorch.load(path)\neval(text)") == [
        "np.load(path)",
        "torch.load(path)",
        "eval(text)",
    ]


def test_that_nothing_listens_where_the_web_links_point() -> None:
    """Else the test above would not tell a refused connection from none."""
    with socket.socket() as probe:
        assert probe.connect_ex(("127.0.0.1", 9)) != 0
