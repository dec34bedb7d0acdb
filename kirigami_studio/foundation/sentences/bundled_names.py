"""Names and notes of silhouettes, materials and machine profiles, for translators.

They are data, kept in files and records in English, and translated where they are shown.
"""

from __future__ import annotations

from kirigami_studio.foundation.words import mark

#: Names, titles and what is told about the silhouettes of the library.
SILHOUETTES = (
    (mark("arrow"), mark("Arrow"), mark("A shaft with a wide head.")),
    (mark("bean"), mark("Bean"), mark("A rounded shape with one shallow bay.")),
    (mark("bell"), mark("Bell"), mark("A flared skirt with a clapper.")),
    (mark("bone"), mark("Bone"), mark("Four knobs on a narrow shaft.")),
    (mark("butterfly"), mark("Butterfly"), mark("Two pairs of wings around a body.")),
    (mark("circle"), mark("Circle"), mark("Smooth and convex; corners of the sheet have to vanish.")),
    (mark("cloud"), mark("Cloud"), mark("Round puffs on a flat base.")),
    (mark("clover"), mark("Clover"), mark("Three heart-shaped leaves on a stem.")),
    (mark("crescent"), mark("Crescent"), mark("A moon with two thin horns: hard.")),
    (mark("cross"), mark("Cross"), mark("An upright with a crossbar above the middle.")),
    (mark("drop"), mark("Drop"), mark("A circle with one sharp tip.")),
    (mark("egg"), mark("Egg"), mark("An oval with a blunt and a narrow end.")),
    (mark("ellipse"), mark("Ellipse"), mark("A circle stretched 8 to 5.")),
    (mark("fir"), mark("Fir tree"), mark("Three tiers on a short trunk.")),
    (mark("fish"), mark("Fish"), mark("Body, fins and a forked tail.")),
    (mark("flower"), mark("Flower"), mark("Five round petals.")),
    (mark("gear"), mark("Gear"), mark("Ten teeth: fine detail for fine grids.")),
    (mark("heart"), mark("Heart"), mark("One notch and one point on a smooth curve.")),
    (mark("hexagon"), mark("Hexagon"), mark("Six equal sides.")),
    (mark("hourglass"), mark("Hourglass"), mark("Two bulbs joined by a narrow waist.")),
    (mark("house"), mark("House"), mark("A gable with a chimney.")),
    (mark("leaf"), mark("Leaf"), mark("A slanting blade with a stem.")),
    (mark("letter-l"), mark("Letter L"), mark("Two bars meeting in one inner corner.")),
    (mark("letter-t"), mark("Letter T"), mark("A bar on a stem.")),
    (mark("mushroom"), mark("Mushroom"), mark("A wide cap on a stalk.")),
    (mark("octagon"), mark("Octagon"), mark("Eight equal sides, nearly a circle.")),
    (mark("pear"), mark("Pear"), mark("A belly, a shoulder and a stem.")),
    (mark("pentagon"), mark("Pentagon"), mark("Five equal sides.")),
    (mark("pick"), mark("Guitar pick"), mark("A rounded triangle.")),
    (mark("plus"), mark("Plus"), mark("Four equal arms.")),
    (mark("puzzle"), mark("Puzzle piece"), mark("Two tabs and two sockets: hard.")),
    (mark("rectangle"), mark("Rectangle"), mark("A square stretched 8 to 5.")),
    (mark("shield"), mark("Shield"), mark("Straight shoulders and a pointed foot.")),
    (mark("six-point-star"), mark("Six-point star"), mark("Two triangles, one upside down.")),
    (mark("speech-bubble"), mark("Speech bubble"), mark("A rounded box with a pointed tail.")),
    (mark("square"), mark("Square"), mark("The easiest target: the uniform sheet itself.")),
    (mark("star"), mark("Star"), mark("Five points and five deep notches.")),
    (mark("triangle"), mark("Triangle"), mark("Three sharp corners; a sheet has four.")),
    (mark("vase"), mark("Vase"), mark("A belly under a narrow neck.")),
    (mark("wave"), mark("Wave"), mark("A ribbon between two parallel waves.")),
)
#: Names of materials, and the machines that they are cut with.
MATERIALS = (
    mark("Acrylic 3 mm, CO2 laser"),
    mark("Card 0.5 mm, CO2 laser"),
    mark("Card 0.3 mm, CO2 laser"),
    mark("Cotton 0.3 mm, CO2 laser"),
    mark("Paper 0.15 mm, drag knife"),
    mark("EVA foam 2 mm, CO2 laser"),
    mark("Wool felt 3 mm, CO2 laser"),
    mark("Wool felt 2 mm, CO2 laser"),
    mark("Polyimide film 50 \N{MICRO SIGN}m, UV laser"),
    mark("Aluminium foil 50 \N{MICRO SIGN}m, UV laser"),
    mark("Leather 1.5 mm, CO2 laser"),
    mark("Polyamide film 50 \N{MICRO SIGN}m, UV laser"),
    mark("Paper 120-160 g/m2, scissors or knife"),
    mark("PET film 75-125 \N{MICRO SIGN}m, CO2 laser"),
    mark("Birch plywood 3 mm, CO2 laser"),
    mark("Polypropylene 0.5 mm, CO2 laser"),
    mark("Ripstop nylon 0.08 mm, CO2 laser"),
    mark("Silicone rubber 1 mm, CO2 laser"),
    mark("Packing tape 50 \N{MICRO SIGN}m, drag knife"),
    mark("TPU film 0.5 mm, CO2 laser"),
    mark("Tulle 0.2 mm, CO2 laser"),
    mark("CO2 laser"),
    mark("cutting plotter"),
    mark("UV or green pulsed laser"),
    mark("by hand"),
)
#: What is told about the materials.
NOTES = (
    mark(  # acrylic-co2
        "Connectors break before a sheet is closed: no style, width and size up to the bed is known that holds. "
        "Kerf: 0.009 inch at 1/8 inch (table of laser504.com). Connector and smallest panel: as wide as the sheet "
        "is thick, as cutlasercut.com advises; it calls details below 1 mm very fragile. Power and speed: starting "
        "values for 40 to 60 W. Cut the coupon before trusting it."
    ),
    mark(  # card-05-co2
        "Kerf: the upper end of what card has in practice. Power, speed and widths: starting values. Crease or "
        "bend connectors slowly: the outer ply of thick card may crack. Cut the coupon before trusting it."
    ),
    mark(  # card-co2
        "Kerf between 0.10 and 0.15 mm in practice. Crease or bend connectors slowly: the outer ply of thick card "
        "may crack. Cut the coupon before trusting it."
    ),
    mark(  # cotton-co2
        "The hinge layer of a backed sheet: glue tiles on it. Alone it is too limp to be a sheet. Starch or fray "
        "check keeps its edges. Kerf, widths, power and speed: starting values. Cut the coupon before trusting it."
    ),
    mark(  # drag-knife
        "A blade removes no material, so the kerf is 0. Set the blade offset (often 0.25 mm) in the plotter's own "
        "program. For Mylar take PET film."
    ),
    mark(  # eva-foam-co2
        "Craft foam. Panels bend easily: expect a soft sheet. Kerf, widths, power and speed: starting values; "
        "edges melt back. Cut the coupon before trusting it."
    ),
    mark("Kerf, power, speed and widths: starting values. Cut the coupon before trusting it."),  # felt-3-co2
    mark(  # felt-co2
        "Thickness and kerf: those of the felt profile in dayangac/kirigami-deployment. Connectors as wide as they "
        "must be to bend out of the plane. Power and speed: starting values. Cut the coupon before trusting it."
    ),
    mark(  # film-uv
        "Kerf from published polyimide cuts (20 \N{MICRO SIGN}m); speed and passes: 0.2 mm of polycarbonate takes "
        "15 cuts at 40 mm/s of a UV laser (abstract of a study of thermal ablation of PC film), so 50 "
        "\N{MICRO SIGN}m take 4; the paper's parts then take the 5 minutes that it tells. Cut the coupon before "
        "trusting it."
    ),
    mark(  # foil-uv
        "The aluminium sheet that the paper tried could be cut, but its connectors broke instead of letting the "
        "panels turn. Kerf, widths, power and speed: guesses from film of this thickness. Cut the coupon before "
        "trusting it."
    ),
    mark(  # leather-co2
        "Kerf: the upper end of the usual 0.15 to 0.2 mm (lasercutco.com). Leather differs by hide, place and "
        "direction. Power, speed and widths: starting values. Cut the coupon before trusting it."
    ),
    mark(  # pa-film-uv
        "The film of the paper's specimens. Kerf, speed and passes as in polyimide film. Moist air makes it "
        "softer. Cut the coupon before trusting it."
    ),
    mark(  # paper-hand
        "Print the PDF at 100 % and cut along its lines. A hand follows a printed line to about 0.5 mm: a "
        "connector of 2 mm keeps at least 1 mm when both of its cuts run over by that much. Panels below 4 mm and "
        "cuts below 3 mm are hard to hold and to see; a guess, as is speed."
    ),
    mark(  # pet-co2
        "Kerf as commonly reported for CO2 on thin sheet. Mylar is such a film. Cut the coupon before trusting it."
    ),
    mark(  # plywood-co2
        "Connectors break before a sheet is closed: no style, width and size up to the bed is known that holds. "
        "Kerf: 0.008 inch for birch plywood of 1/8 inch (table of laser504.com). Connector and smallest panel: as "
        "wide as the sheet is thick, as cutlasercut.com advises; it calls details below 1 mm very fragile. Power "
        "and speed: starting values for 40 to 60 W. Cut the coupon before trusting it."
    ),
    mark(  # polypropylene-co2
        "Living hinges are made of it: connectors stay bent but do not break. Kerf, widths, power and speed: "
        "starting values; cut edges melt. Cut the coupon before trusting it."
    ),
    mark(  # ripstop-co2
        "The hinge layer of a backed sheet: glue tiles on it. Alone it is too limp to be a sheet. The laser seals "
        "its edges. Kerf, widths, power and speed: starting values. Cut the coupon before trusting it."
    ),
    mark(  # silicone-co2
        "Shore 50A. Panels bend as easily as connectors do: expect a soft sheet. Notches tear on: cut clean ends. "
        "Kerf, widths, power and speed: starting values; the cut leaves white ash. Cut the coupon before trusting "
        "it."
    ),
    mark(  # tape-knife
        "The hinge layer of a backed sheet: it glues itself under tiles. Alone it sticks to itself. A blade "
        "removes no material, so the kerf is 0. Film of 28 \N{MICRO SIGN}m and glue; stick it to its liner to cut "
        "it."
    ),
    mark(  # tpu-co2
        "Panels bend as easily as connectors do: expect a soft sheet. Kerf, widths, power and speed: starting "
        "values; cut edges melt. Cut the coupon before trusting it."
    ),
    mark(  # tulle-co2
        "The hinge layer of a backed sheet: glue tiles on it. Alone it is too limp to be a sheet. Tiles may be "
        "printed straight onto it. A connector is several meshes wide. Kerf, widths, power and speed: starting "
        "values. Cut the coupon before trusting it."
    ),
)
#: Titles of machine profiles.
PROFILES = (
    mark("Any machine: everything red, cut in file order"),
    mark("LightBurn: one colour for each layer"),
    mark("MeerK40t, K40 Whisperer: everything red, arcs as chords"),
    mark("One colour, one layer: for programs that sort by colour or layer"),
    mark("One file for each layer, in a folder (CircuitPro)"),
    mark("Cutting service: closed contours only, every slit as a slot"),
)
