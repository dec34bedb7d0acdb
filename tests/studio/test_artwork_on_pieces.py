"""Artwork on pieces, read by libraries alone: put together, its lines and pixels are the drawing again."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
import shapely
from piece_reader import artwork_of, posed_artwork, recognise
from PIL import Image
from pinned_assemblies import plain_pinwheel
from shapely.geometry import LineString, MultiLineString, Polygon

from kirigami_studio.__main__ import main
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.export.artwork import ArtPicture, Artwork, Laid, PictureFit, SheetState
from kirigami_studio.export.artwork_picture import read_picture
from kirigami_studio.export.pdf import read_pages
from kirigami_studio.export.picture import NAME_COLOUR
from kirigami_studio.export.profile import find_profile
from kirigami_studio.export.registry import export
from kirigami_studio.export.svg import write_layout_svg
from kirigami_studio.fabricate.options import BoardCut
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.steps import never
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.project import store
from kirigami_studio.project.document import Document
from kirigami_studio.settings.fabrication import new_settings
from kirigami_studio.studio.making import (
    CutRequest,
    Output,
    exporting,
    exporting_artwork,
    picture_job,
    pieces_of,
    posed_pieces,
    printed_parts,
)
from tests.square_documents import square_document

#: A ring, a star of straight lines, a wave, and an area that counts by its edge; 200 x 160.
SVG = b"""<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 200 160" fill="none" stroke="#000">
<circle cx="70" cy="80" r="55"/><path d="M100 5 L130 150 L20 40 L180 60 L60 155 Z"/>
<path d="M5 100 C60 40 120 150 195 70"/><rect x="120" y="90" width="60" height="50" fill="#123" stroke="none"/>
<text x="10" y="20">no line</text></svg>"""
SIZE = (200, 160)
#: How far a point may be off, and lines of single shapes by which the drawing is known, mm and pixels.
NEAR_MM = 0.01
KINDS = (".dxf", ".svg", ".lbrn2")


def drawing_lines() -> list[np.ndarray]:
    """The lines of ``SVG`` from its numbers, pixels."""
    turn = np.linspace(0.0, 2.0 * math.pi, 1441)
    t = np.linspace(0.0, 1.0, 1001)[:, None]
    wave = ((5, 100), (60, 40), (120, 150), (195, 70))
    weights = ((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3)
    return [
        np.column_stack([70.0 + 55.0 * np.cos(turn), 80.0 + 55.0 * np.sin(turn)]),
        np.array([[100, 5], [130, 150], [20, 40], [180, 60], [60, 155], [100, 5]], dtype=float),
        sum(weight * np.array(point, dtype=float) for weight, point in zip(weights, wave, strict=True)),
        np.array([[120, 90], [180, 90], [180, 140], [120, 140], [120, 90]], dtype=float),
    ]


@pytest.fixture(scope="module")
def picture(tmp_path_factory: pytest.TempPathFactory) -> ArtPicture:
    """The SVG as it is read, drawn white: its lines are looked at alone."""
    path = tmp_path_factory.mktemp("artwork") / "drawing.svg"
    path.write_bytes(SVG)

    def white(content: bytes, side: int) -> bytes:
        stream = BytesIO()
        Image.new("RGB", (2000, 1600), (255, 255, 255)).save(stream, format="PNG")
        return stream.getvalue()

    return read_picture(path, white)


@pytest.fixture(scope="module")
def plain() -> Document:
    return plain_pinwheel()


@pytest.fixture(scope="module")
def uneven(plain: Document) -> Document:
    """A plain pinwheel whose pieces are all different, so that each is recognised by its shape."""
    random = np.random.default_rng(3).uniform(0.16, 0.24, (3, 3))
    sheet = Sheet(RatioField.from_log10(random * (-1.0) ** np.add.outer(range(3), range(3))))
    return replace(plain, candidates=(Candidate(sheet, evaluate(deploy(sheet), plain.target), 0, 0),))


def with_picture(document: Document, picture: ArtPicture, state: SheetState, **laid: object) -> Document:
    return replace(document, artwork=Artwork(Laid(picture, state, PictureFit.FIT, **laid)))


def mapped(folder: Path, areas: list[Polygon], target: np.ndarray | None, angle: float, laid: Laid) -> MultiLineString:
    """The drawing where it should lie: in the middle of the box round pieces that are seen turned by an angle."""
    turned = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    points = np.vstack([np.asarray(area.exterior.coords) for area in areas] + ([] if target is None else [target]))
    low, high = (points @ turned.T).min(axis=0), (points @ turned.T).max(axis=0)
    scale = laid.scale * min((high - low) / SIZE)
    middle = 0.5 * (low + high) + np.array(laid.shift) * (high - low)
    own = np.array([[math.cos(laid.turn), -math.sin(laid.turn)], [math.sin(laid.turn), math.cos(laid.turn)]])
    lines = [((line - np.array(SIZE) / 2.0) * (1.0, -1.0) * scale) @ own.T + middle for line in drawing_lines()]
    return MultiLineString([line @ turned for line in lines])


@pytest.mark.parametrize("state", list(SheetState))
def test_that_the_lines_of_all_pieces_put_together_are_the_drawing_again(
    state: SheetState, uneven: Document, picture: ArtPicture, tmp_path: Path
) -> None:
    document = with_picture(uneven, picture, state, turn=0.3, scale=1.1, shift=(0.02, -0.03))
    assert document.artwork is not None
    request = CutRequest.of(document)
    (written,) = exporting(request, Output(tmp_path / "pinned", "pinned"), True, never)
    made, step = pieces_of(request), 0 if state is SheetState.FLAT else -1
    folder = written.path
    record = json.loads((folder / "pieces.json").read_text())
    for kind in KINDS if state is SheetState.TARGET else KINDS[:1]:
        read = recognise(folder, kind, made.job.kerf_mm)
        assert read.outline_mm < 1.5e-3, "artwork changes no piece"
        poses = record["motion"][step]["poses"]
        wanted = {piece["id"]: piece for piece in record["pieces"]}

        def posed(points: np.ndarray, name: str, poses: dict = poses) -> np.ndarray:
            x, y, turn = poses[name]
            turned = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
            return np.asarray(points) @ turned.T + (x, y)

        solid = {name: Polygon(posed(area.exterior.coords, name)) for name, (area, _) in read.found.items()}
        bored = {
            name: area.difference(shapely.union_all([Polygon(posed(ring, name)) for ring in wanted[name]["holes"]]))
            for name, area in solid.items()
        }
        layer = {name: piece["layer"] for name, piece in wanted.items()}
        front = shapely.union_all([area for name, area in solid.items() if layer[name] == 1])
        behind = shapely.union_all([area for name, area in bored.items() if layer[name] == 2]).difference(front)
        seen = shapely.union_all([behind, *(area for name, area in bored.items() if layer[name] == 1)])
        pose = made.posed.design.pose
        target, angle = None, 0.0
        if state is SheetState.TARGET:
            angle = pose.angle
            target = (pose.inverse().apply(document.target.points)) * made.made.assembly.cell_mm
        meant = mapped(folder, list(solid.values()), target, angle, document.artwork.first)
        lines = posed_artwork(folder, read, step)
        away = shapely.distance(shapely.points(np.vstack(lines)), meant)
        assert float(away.max()) < NEAR_MM
        length = sum(LineString(line).length for line in lines)
        assert length == pytest.approx(meant.intersection(seen).length, rel=0.01)
        assert length == pytest.approx(shapely.union_all([LineString(line) for line in lines]).length, rel=1e-3)
        assert {layer[name] for name, (path, *_) in read.beams.items() if artwork_of(path)} == {1, 2}
    reports = [tmp_path / "pinned" / f"layer-{number}.dxf" for number in (1, 2)]
    store.save(document, tmp_path / "square.kiri")
    assert main(["check", *map(str, reports), "--design", str(tmp_path / "square.kiri")]) == 0


def test_that_tiles_get_lines_unless_the_faces_that_get_them_are_glued_on(picture: ArtPicture, tmp_path: Path) -> None:
    square = square_document({"material": "plywood-co2", "construction": "backed", "width_mm": 160.0})
    document = with_picture(square, picture, SheetState.TARGET)
    (written,) = exporting(CutRequest.of(document), Output(tmp_path / "backed", "backed"), True, never)
    lines = artwork_of(written.path / "layer-2.dxf")
    read = recognise_tiles(written.path)
    assert lines and all(any(tile.buffer(0.2).contains(LineString(line)) for tile in read) for line in lines)
    assert not artwork_of(written.path / "layer-1.dxf"), "the cloth behind the tiles gets none"
    kissed = replace(document, fabrication=replace(document.fabrication, board_cut=BoardCut.KISS))
    (written,) = exporting(CutRequest.of(kissed), Output(tmp_path / "kissed", "kissed"), True, never)
    assert not artwork_of(written.path / "layer-2.dxf")
    with pytest.raises(ExportError) as refused:
        printed_parts(CutRequest.of(kissed))
    assert refused.value.code == "artwork.kiss_cut"


def recognise_tiles(folder: Path) -> list[Polygon]:
    """Outlines of the tiles of a board, as they are cut."""
    from piece_reader import dxf_rings

    return [Polygon(ring) for ring, is_circle in dxf_rings(folder / "layer-2.dxf") if not is_circle]


def test_that_lines_are_on_a_layer_of_their_own_in_an_own_colour(plain: Document, picture: ArtPicture) -> None:
    made = pieces_of(CutRequest.of(with_picture(plain, picture, SheetState.FLAT)))
    for key, colour in (("any", 5), ("lightburn", 30), ("glowforge", 30), ("single", None), ("slots", None)):
        strokes = [one for bed in made.job.beds for one in bed.strokes(find_profile(key)) if one.layer == "ARTWORK"]
        assert {stroke.colour for stroke in strokes} == (set() if colour is None else {colour})
    without = pieces_of(CutRequest.of(plain))
    assert not [one for bed in without.job.beds for one in bed.strokes(find_profile("any")) if one.layer == "ARTWORK"]
    assert made.cut_length_mm == pytest.approx(without.cut_length_mm), "engraving is no cutting"


def test_that_pictures_show_the_lines(plain: Document, picture: ArtPicture, tmp_path: Path) -> None:
    document = with_picture(plain, picture, SheetState.TARGET)
    posed = posed_pieces(CutRequest.of(document))
    assert posed is not None
    far = np.vstack([line for lines in posed.drawn(0.0) for line in lines])
    assert np.ptp(far, axis=0) == pytest.approx(np.ptp(posed.points(0.0), axis=0), rel=0.3)
    with_lines, plain = (picture_job(CutRequest.of(one)) for one in (document, plain))
    export(with_lines, tmp_path / "with.png")
    export(plain, tmp_path / "without.png")
    images = [np.asarray(Image.open(tmp_path / name), dtype=int) for name in ("with.png", "without.png")]
    darker = (images[0] - images[1]).min(axis=2) < -40
    assert darker.sum() > 1000, "lines are dark on light faces"
    write_layout_svg(with_lines, tmp_path / "with.svg", 160.0)
    assert all(f'id="ARTWORK_{layer}"' in (tmp_path / "with.svg").read_text() for layer in (1, 2))


def test_that_the_assembly_sheet_shows_the_lines(plain: Document, picture: ArtPicture, tmp_path: Path) -> None:
    lengths = []
    for document in (with_picture(plain, picture, SheetState.FLAT), plain):
        folder = tmp_path / f"{len(lengths)}"
        (written,) = exporting(CutRequest.of(document), Output(folder / "layer.dxf"), True, never)
        page = read_pages(written.path / "assembly.pdf")[0]
        lengths.append(sum(LineString(line.points).length for line in page.lines if line.colour == NAME_COLOUR))
    assert lengths[0] > 500.0 and lengths[1] == 0.0


def test_that_a_print_of_each_bed_lies_on_its_cut_file(plain: Document, tmp_path: Path) -> None:
    red, blue = (200, 30, 30), (30, 30, 200)
    image = Image.new("RGB", (200, 200), red)
    image.paste(blue, (100, 0, 200, 200))
    stream = BytesIO()
    image.save(stream, format="PNG")
    document = with_picture(plain, ArtPicture("half.png", stream.getvalue(), (200, 200)), SheetState.FLAT)
    request = CutRequest.of(document)
    list(exporting_artwork(request, tmp_path, True, never))
    made = pieces_of(request)
    names = [bed.name for bed in made.job.beds]
    ends = (".pdf", ".png", ".svg")
    assert {path.name for path in tmp_path.iterdir()} == {
        "artwork_opened.png",
        *(f"artwork-{name}{end}" for name in names for end in ends),
    }
    middle = 0.5 * (made.made.plan.flat.bounds[0] + made.made.plan.flat.bounds[2])
    flat = {
        piece.id: at for piece, at in zip(made.made.assembly.pieces, made.made.assembly.poses(math.pi), strict=True)
    }
    for bed in made.job.beds:
        with Image.open(tmp_path / f"artwork-{bed.name}.png") as shown:
            pixels, per_mm = np.asarray(shown.convert("RGB")), shown.info["dpi"][0] / 25.4
        for cuts, place in bed.placed:
            # A point well inside the piece, left or right of the middle of the flat assembly.
            inner = np.asarray(shapely.Polygon(cuts.piece.outline).buffer(-4.0).representative_point().coords[0])
            x = inner[0] + flat[cuts.piece.id][0]
            if any(np.linalg.norm(inner - hole.centre) < 4.0 for hole in cuts.piece.holes) or abs(x - middle) < 2.0:
                continue
            across, up = (place.put(inner) + 8.0) * per_mm
            found = pixels[round(pixels.shape[0] - up), round(across)]
            assert np.abs(found.astype(int) - (red if x < middle else blue)).max() < 12


def test_that_a_printed_design_gets_no_picture_and_says_why(plain: Document, picture: ArtPicture) -> None:
    printed = replace(plain, fabrication=new_settings({"material": "pla-print", "construction": "printed"}))
    with pytest.raises(ExportError) as refused:
        printed_parts(CutRequest.of(with_picture(printed, picture, SheetState.TARGET)))
    assert refused.value.code == "artwork.printer"


def test_that_a_project_keeps_the_lines_of_a_picture(
    plain: Document, picture: ArtPicture, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    project, drawing = tmp_path / "square.kiri", tmp_path / "drawing.svg"
    store.save(plain, project)
    drawing.write_bytes(SVG)
    words = ["artwork", str(project), "--picture", str(drawing), "--out", str(tmp_path / "out"), "--dpi", "40"]
    assert main([*words, "--keep", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["lines"] == len(picture.lines) == 4 and len(told["beds"]) == 2
    kept = store.load(project).artwork
    assert kept is not None
    for line, other in zip(kept.first.picture.lines, picture.lines, strict=True):
        # Pixels of 3000 and of 2000 along the longer side.
        assert line == pytest.approx(other * 1.5, abs=2e-3)
