"""Names in files may hold anything; whatever reads them gives bounded, printable lines."""

from __future__ import annotations

import json
import zipfile
from dataclasses import replace
from pathlib import Path

import ezdxf
import pytest
import tomli_w

from kirigami_studio.fabricate.material import presets, read_preset
from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.foundation.files import read_toml
from kirigami_studio.foundation.plain_text import LONGEST_NAME, LONGEST_NOTE
from kirigami_studio.foundation.resources import resource
from kirigami_studio.outlines.read import read_parts, read_target
from kirigami_studio.outlines.starts import StartShape
from kirigami_studio.project import preferences, recent
from kirigami_studio.project.document import Document
from kirigami_studio.project.store import load, save

ATTACKS = Path(__file__).resolve().parents[1] / "data" / "attacks"
HOSTILE = ("fox\x1b]0;owned\x07", "left\u202eright", "two\nlines", "n" * 20_000, "\x9b31mred", "a" + "\u2028" * 300)


def are_plain(*texts: str, longest: int = LONGEST_NAME) -> bool:
    return all(text.isprintable() and len(text) <= longest for text in texts)


def names_of(document: Document) -> list[str]:
    """Every name of a document that was not made by the program itself."""
    outlines = [document.target, document.settings.start.outline, *document.drawing]
    names = [outline.name for outline in outlines if outline is not None]
    cut = document.fabrication
    return [*names, document.settings.start.name, cut.material, cut.profile, cut.dxf_version, cut.paper]


@pytest.mark.parametrize("case", ["name10M.kiri", "rich_text_dev_zero.kiri"])
def test_that_a_project_from_outside_has_plain_names_and_opens_the_same_again(case: str, tmp_path: Path) -> None:
    document = load(ATTACKS / case)
    assert are_plain(*names_of(document))
    save(document, tmp_path / "again.kiri")
    assert names_of(load(tmp_path / "again.kiri")) == names_of(document)


@pytest.mark.parametrize("hostile", HOSTILE)
def test_that_every_text_of_a_project_is_plain(hostile: str, tmp_path: Path) -> None:
    with zipfile.ZipFile(ATTACKS / "rich_text_dev_zero.kiri") as packed:
        members = {name: packed.read(name) for name in packed.namelist()}
    design = json.loads(members["design.json"])
    outlines = (design["target"], design["settings"]["start"]["outline"])
    for record in (*outlines, design["settings"]["start"]):
        record["name"] = hostile
    design["target"]["notes"] = [hostile] * 300
    design["fabrication"]["material"] = design["fabrication"]["profile"] = hostile
    design["provenance"] = {"model": hostile, hostile: "1"}
    design["runs"] = [{"model": hostile}]
    path = tmp_path / "hostile.kiri"
    with zipfile.ZipFile(path, "w") as packed:
        for name, content in (members | {"design.json": json.dumps(design).encode()}).items():
            packed.writestr(name, content)
    document = load(path)
    assert are_plain(*names_of(document))
    assert document.target is not None and len(document.target.notes) <= 100
    facts = [*document.provenance.items(), *document.candidates[0].made_with]
    assert are_plain(*document.target.notes, *(text for fact in facts for text in fact), longest=LONGEST_NOTE)


@pytest.mark.parametrize("hostile", HOSTILE)
def test_that_names_layers_and_facts_of_a_drawing_are_plain(hostile: str, tmp_path: Path) -> None:
    # XML has no control characters but these; others as references.
    written = "".join(f"&#{ord(letter)};" for letter in hostile if ord(letter) > 31 or letter in "\t\n")
    label = 'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" inkscape:groupmode="layer" inkscape:label'
    svg, dxf, table = tmp_path / "a.svg", tmp_path / "a.dxf", tmp_path / "a.json"
    shapes = f'<rect id="{written}" width="50" height="40"/><circle r="9"/>'
    svg.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg"><g {label}="{written}">{shapes}</g></svg>', encoding="utf-8"
    )
    drawing = ezdxf.new()
    drawing.layers.add("L" + "n" * 250)
    drawing.modelspace().add_lwpolyline([(0, 0), (50, 0), (50, 40)], close=True, dxfattribs={"layer": "L" + "n" * 250})
    drawing.header.custom_vars.append("MADE_BY", hostile.replace("\n", " ")[:2_500])
    drawing.saveas(dxf)
    table.write_text(json.dumps({"name": hostile, "points": [[0, 0], [5, 0], [5, 4]]}), encoding="utf-8")
    for source in (read_parts(svg), read_parts(dxf)):
        parts = source.parts
        assert are_plain(source.name, *(part.name for part in parts), *(part.layer for part in parts))
        assert are_plain(*source.facts, *source.facts.values(), *source.left_out, longest=LONGEST_NOTE)
        assert are_plain(*source.layers)
    assert are_plain(read_target(table).name)


@pytest.mark.parametrize("hostile", HOSTILE)
def test_that_settings_and_materials_have_plain_names(hostile: str, tmp_path: Path) -> None:
    path = tmp_path / "entries.toml"
    path.write_text(tomli_w.dumps({"profile": hostile, "material": hostile}), encoding="utf-8")
    read = preferences.load(path)
    assert are_plain(read.profile, read.material)
    path.write_text(tomli_w.dumps({"paper": hostile}), encoding="utf-8")
    with pytest.raises(ProjectError) as unknown:
        preferences.load(path)
    assert unknown.value.code == "preferences.unknown_choice" and are_plain(str(unknown.value), longest=LONGEST_NOTE)
    path.write_text(tomli_w.dumps({"projects": [hostile, "/home/fox.kiri"], "targets": [hostile]}), encoding="utf-8")
    known = recent.load(path)
    assert known.projects[-1] == "/home/fox.kiri" and are_plain(*known.projects, *known.targets, longest=4096)
    entries = read_toml(resource("materials") / "film-uv.toml")
    path.write_text(tomli_w.dumps({**entries, "name": hostile, "machine": hostile, "note": hostile}), encoding="utf-8")
    material = read_preset(path)
    assert are_plain(material.name, material.machine)
    assert are_plain(*material.note.split("\n"), longest=LONGEST_NOTE) and len(material.note) <= LONGEST_NOTE


def test_that_names_that_are_plain_stay_as_they_are(tmp_path: Path) -> None:
    for key, material in presets().items():
        assert replace(material) == material
        assert material.note == str(read_toml(resource("materials") / f"{key}.toml")["note"])
    assert StartShape("Fox & Söhne  <b>").name == "Fox & Söhne  <b>"
