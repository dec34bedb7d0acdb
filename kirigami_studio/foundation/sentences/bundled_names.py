"""Names of what comes with the program, for translators: bundled silhouettes, materials and machine profiles.

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
    mark("Card 0.3 mm, CO2 laser"),
    mark("Mylar or paper, drag knife"),
    mark("Wool felt 2 mm, CO2 laser"),
    mark("PA/PI film 50 um, UV laser"),
    mark("Aluminium foil 50 um, UV laser"),
    mark("Leather 1.5 mm, CO2 laser"),
    mark("Paper 120-160 g/m2, scissors or knife"),
    mark("PET film 75-125 um, CO2 laser"),
    mark("Birch plywood 3 mm, CO2 laser"),
    mark("Polypropylene 0.5 mm, CO2 laser"),
    mark("TPU film 0.5 mm, CO2 laser"),
    mark("CO2 laser"),
    mark("cutting plotter"),
    mark("UV or green pulsed laser"),
    mark("by hand"),
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
