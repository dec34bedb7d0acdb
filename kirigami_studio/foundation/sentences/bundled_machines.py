"""Names and notes of bundled machines and profiles, and of materials on other kinds of machines, for translators."""

from __future__ import annotations

from kirigami_studio.foundation.words import mark

#: Names of machines, and of materials on them.
NAMES = (
    mark("CO2 laser, 40 to 60 W"),
    mark("Cricut Explore"),
    mark("Cricut Maker"),
    mark("Cutting plotter, drag knife"),
    mark("Diode laser, 10 W"),
    mark("Glowforge"),
    mark("Scissors or knife, by hand"),
    mark("K40, CO2 laser 40 W"),
    mark("Universal or Epilog class, CO2 laser"),
    mark("Silhouette Cameo"),
    mark("Silhouette Portrait"),
    mark("LPKF ProtoLaser, UV laser"),
    mark("xTool D1 Pro, diode laser"),
    mark("xTool S1, diode laser"),
    mark("Card 0.3 mm, diode laser"),
    mark("Wool felt 2 mm, diode laser"),
    mark("Leather 1.5 mm, diode laser"),
    mark("Birch plywood 3 mm, diode laser"),
    mark("Card 0.5 mm, diode laser"),
    mark("Card 0.3 mm, scissors or knife"),
    mark("Wool felt 2 mm, scissors or knife"),
    mark("Card 0.5 mm, scissors or knife"),
    mark("Wool felt 3 mm, scissors or knife"),
    mark("Card 0.3 mm, drag knife"),
    mark("PET film 75-125 \N{MICRO SIGN}m, drag knife"),
    mark("Polypropylene 0.5 mm, drag knife"),
    mark("Leather 1.5 mm, drag knife"),
    mark("Card 0.5 mm, drag knife"),
    mark("EVA foam 2 mm, drag knife"),
    mark("diode laser"),
    mark("another machine"),
)
#: Where their numbers come from.
NOTES = (
    mark("A usual machine of this kind; all numbers are estimates. Copy it and enter those of yours."),
    mark(
        "Mat of 12 x 24 inch; Design Space cuts 11.5 x 23.5 inch of it (292 x 596 mm), of wood 10.5 x 23.5 "
        "(craftingfromhome.com). It has no knife blade; thickest sheet, speeds and delays: estimates."
    ),
    mark(
        "Mat of 12 x 24 inch; Design Space cuts 11.5 x 23.5 inch of it (292 x 596 mm), of wood 10.5 x 23.5 "
        "(craftingfromhome.com). Thickest sheet: the maker's figure for the knife blade, not checked here. Speeds"
        " and delays: estimates."
    ),
    mark(
        "A mat of 12 x 12 inch. Delays: a guess at lowering and lifting the blade; the other numbers are "
        "estimates, too."
    ),
    mark(
        "A usual machine of this kind; all numbers are estimates. LaserGRBL's developers advise accelerations of "
        "1000 to 2000 mm/s2 (discussion 2118)."
    ),
    mark(
        "Bed: 19.5 x 11 inch, thickest sheet 0.5 inch: the maker's figures, not checked here. Largest speed: 4000"
        " mm/min for cuts and 8500 mm/min otherwise, as measured by users (community.glowforge.com, topic 11768)."
        " Acceleration: an estimate. Its program takes SVG and no DXF."
    ),
    mark("Bed: a cutting mat of A3. Speed and delays: guesses. Print the PDF at 100 % and cut along its lines."),
    mark(
        "Bed: 300 x 200 mm, as these machines are sold. Thickest sheet: hflaser.com advises against acrylic above"
        " 4 mm at 40 W. Speed and acceleration: estimates."
    ),
    mark(
        "Bed: 24 x 12 inch, as of several models of both makers; travel and acceleration: estimates. Their "
        "programs are printed to, and cut lines of less than 0.1 mm in pure red."
    ),
    mark(
        "Width: 300 mm (manual of TkkrLab for the Cameo 3); length: a mat of 12 x 24 inch. Its basic program "
        "opens DXF and no SVG. Speeds, delays and thickest sheet: estimates."
    ),
    mark("Mat of 8 x 12 inch. Its basic program opens DXF and no SVG. Speeds, delays and thickest sheet: estimates."),
    mark(
        "Bed: 305 x 229 mm, data sheet of the ProtoLaser R4; that of your machine may differ. Travel, "
        "acceleration and thickest sheet: estimates; a scanner draws within its field, and the table moves "
        "between fields. CircuitPro wants one file for each layer."
    ),
    mark(
        "Bed and largest speed: the maker's figures, not checked here. Travel, acceleration and thickest sheet: "
        "estimates for the module of 10 W."
    ),
    mark(
        "Bed and largest speed: the maker's figures, not checked here. Travel, acceleration and thickest sheet: "
        "estimates for the module of 20 W."
    ),
    mark(
        "Figures for a diode laser of 10 W are estimates: kerf of its spot, speed and power as starting values. "
        "Cut the coupon before trusting it."
    ),
    mark(
        "Figures for a diode laser of 10 W are estimates; light felt takes up less of the beam than dark felt. "
        "Cut the coupon before trusting it."
    ),
    mark("Figures for a diode laser of 10 W are estimates. Cut the coupon before trusting it."),
    mark(
        "Speed, power and passes: 4.2 mm/s, 90 % and 4 to 6 passes for basswood plywood of 3 mm at 10 W with air "
        "assist (lasertinkerer.com). Kerf: an estimate. Cut the coupon before trusting it."
    ),
    mark(
        "Widths: those of paper that is cut by hand, which leave room for cuts that run over by 0.5 mm. Speed: a "
        "guess. Print the PDF at 100 % and cut along its lines."
    ),
    mark(
        "All figures are guesses: felt frays less than cloth, and a rotary cutter or a knife on a mat follows a "
        "printed line to about 0.5 mm."
    ),
    mark("Speed, shortest slit and smallest panel: guesses. Print the PDF at 100 % and cut along its lines."),
    mark(
        "A blade removes no material, so the kerf is 0. Speed and shortest slit: estimates for a blade set to "
        "cardstock. Cut the coupon before trusting it."
    ),
    mark(
        "A blade removes no material, so the kerf is 0. Widths: those of the preset for a drag knife; speed: an "
        "estimate for a blade set to acetate. Cut the coupon before trusting it."
    ),
    mark(
        "A blade removes no material, so the kerf is 0. Speed and passes: estimates; try whether your blade comes"
        " through. Cut the coupon before trusting it."
    ),
    mark(
        "For machines with a blade for thick sheets. A blade removes no material, so the kerf is 0. Speed, passes"
        " and shortest slit: estimates. Cut the coupon before trusting it."
    ),
)
#: Titles of profiles for one program each.
PROFILES = (
    mark("Cricut Design Space: SVG in one colour, counted at 72 dpi"),
    mark("Silhouette Studio: everything red, arcs as chords"),
    mark("Glowforge: SVG with one colour for each layer"),
    mark("xTool Studio: SVG with one colour for each layer"),
)
