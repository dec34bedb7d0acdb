"""Files as the programs of machines read them: by their units, or by numbers that are taken for pixels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from ezdxf import bbox
from ezdxf.entities import LWPolyline
from ezdxf.filemanagement import readfile
from svgelements import SVG
from svgelements import Path as SvgPath

from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.profile import CSS_DPI, NAME_LAYER, PROFILES, find_profile
from kirigami_studio.export.registry import export
from kirigami_studio.export.verification import FORMATS, verify_export
from kirigami_studio.fabricate.cut_plan import CutPlan, plan_cuts
from kirigami_studio.fabricate.engraving import engraved
from kirigami_studio.fabricate.machine import Machine, cuttable, find_machine, machines, usual_material
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.lattice.deployment import Deployment

MakeDesign = Callable[..., Deployment]
NAMESPACE = "{http://www.w3.org/2000/svg}"
#: Sizes are told to a hundredth of a millimetre.
SAME_MM = 0.01


def planned(design: Deployment, machine: Machine, width_mm: float = 150.0) -> CutPlan:
    taken = cuttable(machine)
    return plan_cuts(design, width_mm, material=taken[usual_material(machine, taken)], machine=machine)


def written(design: Deployment, plan: CutPlan, profile: str, path: Path) -> Path:
    return export(ExportJob(design, plan=plan, profile=profile), path)


def lengths(path: Path) -> tuple[str, str, list[float]]:
    """Width, height and view box of an SVG as they stand there."""
    root = ElementTree.parse(path).getroot()
    return str(root.get("width")), str(root.get("height")), [float(one) for one in str(root.get("viewBox")).split()]


def drawn_mm(path: Path) -> tuple[float, float]:
    """What a program that honours units draws: the box around all paths, mm."""
    boxes = [element.bbox() for element in SVG.parse(path, reify=True).elements() if isinstance(element, SvgPath)]
    table = np.array(boxes) * 25.4 / 96.0
    width, height = table[:, 2:].max(axis=0) - table[:, :2].min(axis=0)
    return float(width), float(height)


def counted_mm(path: Path, dpi: float) -> tuple[float, float]:
    """What a program makes of an SVG that takes its numbers for pixels and looks at no unit."""
    root = ElementTree.parse(path).getroot()
    root.attrib.pop("width"), root.attrib.pop("height")
    root.set("width", str(lengths(path)[2][2]))
    root.set("height", str(lengths(path)[2][3]))
    bare = path.with_name(f"bare-{path.name}")
    ElementTree.ElementTree(root).write(bare)
    width, height = drawn_mm(bare)  # at 96 to the inch
    return width * 96.0 / dpi, height * 96.0 / dpi


@pytest.mark.parametrize("key", sorted(machines().items))
def test_that_every_machine_gets_a_file_in_its_profile_that_is_as_planned(
    key: str, make_design: MakeDesign, tmp_path: Path
) -> None:
    machine, design = find_machine(key), make_design(4, 5)
    plan = planned(design, machine)
    path = written(design, plan, machine.profile, tmp_path / f"sheet{machine.file}")
    assert path.exists()
    if machine.file in FORMATS:
        assert verify_export(plan, path, machine.profile).ok


@pytest.mark.parametrize("profile", [key for key, one in PROFILES.items() if not one.slots])
def test_that_every_svg_has_its_size_where_units_are_honoured(
    profile: str, make_design: MakeDesign, tmp_path: Path
) -> None:
    design = make_design(4, 5)
    plan = planned(design, find_machine("co2-laser"))
    path = written(design, plan, profile, tmp_path / "sheet.svg")
    assert drawn_mm(path) == pytest.approx(plan.bounds_mm, abs=SAME_MM)
    assert lengths(path)[0].endswith("mm") and lengths(path)[1].endswith("mm")
    assert verify_export(plan, path, profile).ok


@pytest.mark.parametrize(
    ("machine", "dpi", "share"),
    [
        ("cricut-maker", 72.0, 1.0),
        ("cricut-maker", 96.0, 0.75),
        ("silhouette-cameo", 72.0, 1.0),
        ("glowforge", 96.0, 1.0),
        ("xtool-d1", 96.0, 1.0),
    ],
)
def test_that_pixels_give_the_size_or_the_share_that_the_recipe_names(
    machine: str, dpi: float, share: float, make_design: MakeDesign, tmp_path: Path, repository: Path
) -> None:
    chosen, design = find_machine(machine), make_design(4, 5)
    plan = planned(design, chosen)
    path = written(design, plan, chosen.profile, tmp_path / "sheet.svg")
    width, height = counted_mm(path, dpi)
    assert (width / plan.bounds_mm[0], height / plan.bounds_mm[1]) == pytest.approx((share, share), abs=1e-4)
    recipe = (repository / "docs" / "how-to" / "your-machine.md").read_text(encoding="utf-8")
    if share != 1.0:
        assert f"{dpi:g} pixels to the inch shows {100 * share:g} %" in recipe and "type the width" in recipe
        assert "profile.attach_and_measure" in {
            note.code for note in verify_export(plan, path, chosen.profile).warnings
        }


def test_that_an_svg_without_such_a_profile_is_a_third_as_large_in_pixels(
    make_design: MakeDesign, tmp_path: Path
) -> None:
    """The fault that the profiles are for, and the proof that the reader of pixels sees it."""
    design = make_design(4, 5)
    plan = planned(design, find_machine("co2-laser"))
    path = written(design, plan, "any", tmp_path / "sheet.svg")
    assert counted_mm(path, 72.0)[0] / plan.bounds_mm[0] == pytest.approx(25.4 / 72.0, abs=1e-4)


def test_that_design_space_gets_one_colour_on_one_layer(make_design: MakeDesign, tmp_path: Path) -> None:
    design = make_design(4, 5)
    path = written(design, planned(design, find_machine("cricut-maker")), "cricut", tmp_path / "sheet.svg")
    root = ElementTree.parse(path).getroot()
    assert len(root.findall(f"{NAMESPACE}g")) == 1
    assert {one.get("stroke") for one in root.iter(f"{NAMESPACE}path")} == {"#ff0000"}
    assert {one.get("fill") for one in root.iter(f"{NAMESPACE}path")} == {"none"}


def test_that_silhouette_studio_gets_lines_in_mm_without_arcs(make_design: MakeDesign, tmp_path: Path) -> None:
    design = make_design(4, 5)
    plan = planned(design, find_machine("silhouette-portrait"))
    path = written(design, plan, "silhouette", tmp_path / "sheet.dxf")
    drawing = readfile(path)
    entities = list(drawing.modelspace())
    assert drawing.header["$INSUNITS"] == 4 and {one.dxftype() for one in entities} == {"LWPOLYLINE"}
    assert not any(one.has_arc for one in entities if isinstance(one, LWPolyline)) and {
        one.dxf.color for one in entities
    } == {1}
    size = bbox.extents(entities).size
    assert (size.x, size.y) == pytest.approx(plan.bounds_mm, abs=SAME_MM)


@pytest.mark.parametrize("machine", ["glowforge", "xtool-s1"])
def test_that_steps_are_told_apart_by_colour_with_the_outline_last(
    machine: str, make_design: MakeDesign, tmp_path: Path
) -> None:
    chosen, design = find_machine(machine), make_design(4, 5)
    assert find_profile(chosen.profile).svg_dpi == CSS_DPI
    path = written(design, planned(design, chosen), chosen.profile, tmp_path / "sheet.svg")
    groups = ElementTree.parse(path).getroot().findall(f"{NAMESPACE}g")
    colours = [{one.get("stroke") for one in group} for group in groups]
    assert all(len(one) == 1 for one in colours) and len({frozenset(one) for one in colours}) == len(groups) >= 2
    assert groups[-1].get("id") == "OUTLINE"


def test_that_circuitpro_gets_one_file_for_each_layer_and_nothing_else(make_design: MakeDesign, tmp_path: Path) -> None:
    chosen, design = find_machine("uv-laser"), make_design(4, 5)
    plan = planned(design, chosen)
    folder = written(design, plan, chosen.profile, tmp_path / "sheet.dxf")
    names = sorted(path.name for path in folder.iterdir())
    assert len(names) == len(plan.layers) and all(name.endswith(".dxf") for name in names)
    for path in folder.iterdir():
        layers = {one.dxf.layer for one in readfile(path).modelspace()} - {"REGISTRATION"}
        assert len(layers) == 1


def test_that_a_sheet_larger_than_the_canvas_is_told_how_wide_it_may_be(make_design: MakeDesign) -> None:
    from kirigami_studio.fabricate.checks import check_plan

    chosen = find_machine("cricut-maker")
    plan = planned(make_design(4, 4), chosen, 400.0)
    (found,) = [one for one in check_plan(plan).problems if one.code == "plan.larger_than_bed"]
    assert (found.fields["bed_width_mm"], found.fields["bed_height_mm"]) == (292.0, 596.0)
    narrower = planned(make_design(4, 4), chosen, 0.98 * float(str(found.fields["largest_mm"])))
    assert not [one for one in check_plan(narrower).problems if one.code == "plan.larger_than_bed"]


# what the page of recipes says ----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def recipes(repository: Path) -> str:
    return (repository / "docs" / "how-to" / "your-machine.md").read_text(encoding="utf-8")


def test_that_the_table_of_programs_has_the_files_and_sizes_of_their_machines(recipes: str) -> None:
    rows = {row[2].strip(" `"): row for row in (line.split("|")[1:-1] for line in recipes.splitlines() if "`" in line)
            if len(row) == 5}  # fmt: skip
    assert set(rows) == {"cricut", "silhouette", "glowforge", "xtool", "lightburn", "layers"}
    for machine in machines().items.values():
        if machine.profile not in rows:
            continue
        _, file, profile, read_at, largest = rows[machine.profile]
        dpi = find_profile(profile.strip(" `")).svg_dpi
        assert f"`{machine.file}`" in file, machine.key
        assert machine.file != ".svg" or f"{dpi:g} dpi" in read_at
        width, height = machine.reach_mm
        if "bed" not in largest and machine.key != "silhouette-portrait":
            assert f"{width:g} x {height:g} mm" in largest


def test_that_colours_of_layers_and_names_are_those_of_the_recipe(
    make_design: MakeDesign, tmp_path: Path, recipes: str
) -> None:
    assert "`RELIEF` magenta, `SLITS` red, `EDGE_SLITS` green, `HOLES` cyan, `OUTLINE` blue" in recipes
    assert "An engraved name is black" in recipes
    colours = {"RELIEF": "#ff00ff", "SLITS": "#ff0000", "EDGE_SLITS": "#00ff00", "OUTLINE": "#0000ff"}
    colours[NAME_LAYER] = "#000000"
    design, seen = make_design(4, 5), list[str]()
    for style in (ConnectorStyle.CENTRED, ConnectorStyle.ROUND):
        card = find_material("card-co2")
        plan = plan_cuts(design, 250.0, material=card, options=CutOptions(style=style))
        path = written(design, engraved(plan, "Ada"), "glowforge", tmp_path / f"{style.value}.svg")
        for group in ElementTree.parse(path).getroot().findall(f"{NAMESPACE}g"):
            assert {one.get("stroke") for one in group} == {colours[str(group.get("id"))]}
            seen.append(str(group.get("id")))
    assert set(seen) == set(colours)


@pytest.mark.parametrize("key", ["cricut", "silhouette"])
def test_that_a_blade_gets_no_name(key: str, make_design: MakeDesign, tmp_path: Path, recipes: str) -> None:
    assert "A name is not engraved: the blade would cut it." in recipes
    design = make_design(4, 5)
    plan = engraved(plan_cuts(design, 250.0, material=find_material("card-co2")), "Ada")
    assert plan.engraving is not None
    found = [
        written(design, one, key, tmp_path / f"{one.engraving is None}.svg")
        for one in (plan, replace(plan, engraving=None))
    ]
    drawn = [len(list(ElementTree.parse(path).getroot().iter(f"{NAMESPACE}path"))) for path in found]
    assert drawn[0] == drawn[1] == len(plan.paths)


def test_that_files_of_circuitpro_lie_upon_each_other_in_the_order_of_their_numbers(
    make_design: MakeDesign, tmp_path: Path, recipes: str
) -> None:
    design, chosen = make_design(4, 5), find_machine("uv-laser")
    plan = planned(design, chosen)
    folder = written(design, plan, chosen.profile, tmp_path / "sheet.dxf")
    marks, order = [], []
    for path in sorted(folder.iterdir()):
        entities = list(readfile(path).modelspace())
        marks.append(bbox.extents([one for one in entities if one.dxf.layer == "REGISTRATION"]))
        order.append(path.stem.split("_", 1)[1])
    assert all(one.extmin.isclose(marks[0].extmin) and one.extmax.isclose(marks[0].extmax) for one in marks)
    assert order == list(dict.fromkeys(one.layer.value for one in plan.paths)) and order[-1] == "OUTLINE"
    film = find_material("film-uv")
    assert f"the preset says {film.passes} at {film.speed_mm_s:g} mm/s" in recipes
