"""Sentences of ``export``, by the code of the problem: files, and reading them back."""

from __future__ import annotations

from kirigami_studio.foundation.words import mark, mark_n

SENTENCES: dict[str, str | tuple[str, str]] = {
    # What a file is asked for
    "export.no_plan": mark("A cut file needs a cut plan: choose a material and a sheet width first."),
    "export.with_fixes": mark("{reason} {fixes}"),
    "export.unknown_kind": mark("Cannot write {extension:.20} files ({path}). Use one of {known}."),
    "pieces.no_such_file": mark("Pieces on pins are not written as {extension:.20}. Use a folder, or one of {known}."),
    "pieces.not_copied": mark("Pieces on pins are cut from several files. Export a folder of them instead."),
    "export.no_extension": mark("Cannot write a file without extension ({path}). Use one of {known}."),
    "profile.unknown": mark("There is no machine profile {name!r:.40}. Choose one of {known}."),
    "profile.only_red_is_cut": mark(
        "MeerK40t and K40 Whisperer cut red lines only and engrave the others: choose the k40 profile for those."
    ),
    "profile.attach_and_measure": mark(
        "In Design Space, select everything and choose Attach, or cuts move on the mat. Then compare the width with "
        "that of the sheet: where it differs, lock the proportions and type it."
    ),
    "profile.measure": mark(
        "In Silhouette Studio, compare the width with that of the sheet: where it differs, lock the proportions and "
        "type it."
    ),
    "profile.order_of_steps": mark(
        "Drag the steps into the order of the layers, the outline last, and compare the width with that of the sheet."
    ),
    "profile.one_origin": mark(
        "Import all files of the folder at one origin, so that their registration marks (layer REGISTRATION) lie upon "
        "each other, and cut them in the order of their numbers. The marks need not be cut."
    ),
    "profile.name_left_out": mark(
        "The name {name!r} is not in this file: with this machine profile, everything in a file is cut."
    ),
    "profile.marks_left_out": mark(
        "The marks of places that hold the sheet are not in this file: with this machine profile, everything in a file "
        "is cut."
    ),
    "profile.kerf_is_theirs": mark(
        "Contours are the edges of the finished part: the cutting service has to allow for its kerf."
    ),
    "slots.no_kerf": mark(
        "Slots need a width, but the kerf of the plan is 0 mm. Plan the cuts with the width of the slots."
    ),
    "slots.falls_apart": mark(
        "As slots of {kerf_mm:g} mm, the sheet would fall into {pieces} pieces. Widen the connectors."
    ),
    "paper.unknown": mark("There is no paper {name!r:.40}. Choose one of {known}."),
    "paper.none": mark("Pages need a paper size: choose a4 or letter."),
    "paper.too_many_pages": mark("This sheet would need {pages} pages of {paper}. Choose one large page."),
    "lightburn.open_cuts_only": mark(
        "A LightBurn project holds open cuts, not slots. Write DXF or SVG for a cutting service."
    ),
    "lightburn.name_power": mark(
        "The name is engraved in one pass at {percent:g} % of the power that cuts: try it on a scrap first."
    ),
    "lightburn.no_power": mark("The material {material!r} has no power: set it in LightBurn before cutting."),
    "gif.too_few_frames": mark("An animation needs at least 2 frames, got {frames}."),
    "dxf.unknown_version": mark("The DXF version must be R2010 or R12, got {version!r:.40}."),
    "paper.many_pages": mark(
        "The PDF has {pages} pages of {paper} to be glued together. Make the sheet smaller or choose one large page."
    ),
    "set.other_design": mark(
        "The folder {folder} holds the export of {other:.80}, whose pictures this one would replace. Choose another "
        "folder."
    ),
    # Pictures printed on a sheet
    "artwork.picture_damaged": mark(
        "{name} is damaged or not a picture (PNG, JPG, BMP, TIFF, WebP or SVG): {reason:.100}. Open it in the program "
        "that made it and save it again."
    ),
    "artwork.picture_too_large": mark(
        "The picture {name:.80} has {megabytes:.0f} MB, more than {limit} MB. Save it with fewer pixels, or as JPG."
    ),
    "artwork.no_svg_here": mark("{name} cannot be drawn here. Save it as PNG."),
    "artwork.svg_too_slow": mark(
        "It takes longer than {seconds:g} s to draw. Save it as PNG from the program that made it."
    ),
    "artwork.svg_not_drawn": mark("Nothing in it can be drawn. Save it as PNG from the program that made it."),
    "artwork.impossible_place": mark(
        "A picture cannot be laid with the scale {scale:g}. Choose a scale from {smallest:g} to {largest:g}, and "
        "finite numbers for turn and shift."
    ),
    "artwork.stripes": mark("Two pictures share a sheet by {fewest} to {most} stripes, got {stripes}."),
    "artwork.impossible_bleed": mark("The bleed must be 0 to {most:g} mm, got {bleed_mm:g} mm."),
    "artwork.impossible_margin": mark("The margin must be 0 to {most:g} mm, got {margin_mm:g} mm."),
    "artwork.impossible_dpi": mark("The resolution must be above 0 dpi, got {dpi:g}."),
    "artwork.name_a_picture": mark("The project has no artwork. Name a picture with --picture."),
    "artwork.printer": mark(
        "A 3D printer gives each layer one colour and no picture. Choose another construction for artwork."
    ),
    "artwork.kiss_cut": mark(
        "Tiles that are kiss-cut are glued on by the face that gets the picture. Choose tiles that are cut through."
    ),
    "artwork.none": mark("The project has no artwork. Choose a picture first."),
    "artwork.too_many_pixels": mark(
        "At {dpi:g} dpi the printed sheet would have {width} x {height} pixels. Choose {most_dpi} dpi or less."
    ),
    # Folders of layer files
    "layers.file_in_the_way": mark("Cannot write the folder {folder}: a file has that name. Choose another name."),
    "layers.not_a_folder": mark("{folder} is not a folder of layer files. Export it again."),
    "layers.not_registered": mark(
        "The files in {folder} do not have the same registration marks, so they would not lie upon each other. Export "
        "the folder again."
    ),
    "layers.other_files": mark(
        "The folder {folder} holds other files ({name:.60}). Layer files need a folder of their own."
    ),
    # Files that do not read back as they were written
    "dxf.not_read_back": mark("The written DXF cannot be read back: {reason} Nothing was written. Please report it."),
    "dxf.other_unit": mark(
        "The DXF failed its own check: its unit is {unit} instead of 4 (mm). Nothing was written. Please report it."
    ),
    "dxf.other_extent": mark(
        "The DXF failed its own check: its extents go to {extent}. Nothing was written. Please report it."
    ),
    "dxf.other_layers": mark(
        "The DXF failed its own check: its layers are {layers}. Nothing was written. Please report it."
    ),
    "dxf.other_kind": mark(
        "The DXF failed its own check: it holds a {kind} instead of a polyline. Nothing was written. Please report it."
    ),
    "dxf.other_count": mark(
        "The DXF failed its own check: it holds {found} entities instead of {planned}. Nothing was written. Please "
        "report it."
    ),
    "dxf.entity_on_other_layer": mark(
        "The DXF failed its own check: entity {number} is on layer {layer} in colour {colour}. Nothing was written. "
        "Please report it."
    ),
    "dxf.entity_closed": mark(
        "The DXF failed its own check: entity {number} is closed. Nothing was written. Please report it."
    ),
    "dxf.entity_open": mark(
        "The DXF failed its own check: entity {number} is open. Nothing was written. Please report it."
    ),
    "dxf.entity_moved": mark(
        "The DXF failed its own check: the points of entity {number} are not where they were planned. Nothing was "
        "written. Please report it."
    ),
    "dxf.entity_bent": mark(
        "The DXF failed its own check: entity {number} has other arcs than planned. Nothing was written. Please report "
        "it."
    ),
    "dxf.drawing_differs": mark("The drawing did not read back as planned. Nothing was written. Please report it."),
    "svg.not_as_written": mark(
        "The SVG did not read back as planned: {found} paths instead of {planned}, or another size. Nothing was "
        "written. Please report it."
    ),
    "pdf.other_page_size": mark(
        "The PDF did not read back as planned: a page of {width_mm:.2f} x {height_mm:.2f} mm instead of "
        "{planned_width_mm:.2f} x {planned_height_mm:.2f} mm. Nothing was written. Please report it."
    ),
    "pdf.other_page_count": mark(
        "The PDF did not read back as planned: {pages} pages for {parts} parts. Nothing was written. Please report it."
    ),
    "pdf.other_length": mark(
        "The PDF did not read back as planned: {found_mm:.3f} instead of {planned_mm:.3f} mm of {layer}. Nothing was "
        "written. Please report it."
    ),
    "lightburn.other_length": mark(
        "The LightBurn project did not read back as planned: {found_mm:.3f} instead of {planned_mm:.3f} mm of {layer}. "
        "Nothing was written. Please report it."
    ),
    "mesh.as_planned": mark(
        "Read back: {bodies} closed bodies in their places, {volume_cm3:.1f} cm3 as planned, {height_mm:g} mm high."
    ),
    "mesh.other_bodies": mark(
        "The file of solids did not read back as planned: {found} bodies instead of {planned}, or other names. Nothing "
        "was written. Please report it."
    ),
    "mesh.not_closed": mark(
        "The surface of {name:.40} does not close in the file of solids. Nothing was written. Make the sheet larger or "
        "its slits wider."
    ),
    "mesh.other_volume": mark(
        "The file of solids did not read back as planned: {name:.40} has {found_mm3:.3f} instead of {planned_mm3:.3f} "
        "mm³. Nothing was written. Please report it."
    ),
    "mesh.other_place": mark(
        "The file of solids did not read back as planned: {name:.40} is of another size or in another place. Nothing "
        "was written. Please report it."
    ),
    "png.other_size": mark(
        "The PNG did not read back as planned: {width} x {height} pixels instead of {planned_width} x "
        "{planned_height}. Nothing was written. Please report it."
    ),
    "gif.other_frames": mark(
        "The GIF did not read back as planned: {found} frames instead of {planned}, or another size. Nothing was "
        "written. Please report it."
    ),
    "linkage.not_as_written": mark("{name} did not read back as it was written. Write it again, or to another place."),
    "elements.in_pieces": mark(
        "The finished sheet falls into {pieces} pieces, and a finite element model is of one. Mend the cut plan first."
    ),
    "linkage.apart": mark("Only {together} of {parts} parts hang together by hinges. Trim less, then write the model."),
    "page.not_as_written": mark(
        "The page did not read back as planned: {name:.40}. Nothing was written. Please report it."
    ),
    "sidecar.not_as_written": mark(
        "The record {path} did not read back as planned. Nothing was written. Please report it."
    ),
    # Files that cannot be read
    "dxf.not_readable": mark("{path} is not a readable DXF: {reason!s:.200}. Export it again."),
    "dxf.audit": mark_n(
        "The audit of ezdxf found {count} error in {path}: {first:.120}.",
        "The audit of ezdxf found {count} errors in {path}, the first: {first:.120}.",
    ),
    "cut_file.damaged": mark("{path} is a damaged DXF. Export it again from its program."),
    "cut_file.foreign_svg": mark(
        "{path} is an SVG, but no cut file of this program. Choose one that it exported, or a DXF of any program."
    ),
    "dxf.too_large": mark("{path} is larger than {limit} MB and cannot be a cut file."),
    "dxf.cannot_open": mark("Cannot read {path}: {reason}. Choose a DXF file."),
    "dxf.no_dxf": mark("Cannot read {path}: it is not a DXF file. Choose a DXF file."),
    "svg.not_readable": mark("{path} is not a readable SVG: {reason!s:.200}. Export it again."),
    "lightburn.not_readable": mark("{path} is not a readable LightBurn project: {reason!s:.200}. Export it again."),
    "pdf.not_whole": mark("{path} is not a whole PDF. Export it again."),
    "pdf.pages_without_drawing": mark("{path} has {pages} pages but {drawings} drawings. Export it again."),
    "pdf.drawing_not_readable": mark("{path} holds a drawing that cannot be read: {reason!s:.200}. Export it again."),
    "sidecar.file_not_readable": mark("Cannot read {path}: {reason}. Export it again."),
    "verify.unknown_kind": mark("{path} cannot be verified: cut files end in {known}."),
    "cut_file.kerf_not_a_width": mark(
        "The kerf must be a width of 0 mm or more, got {value!r:.40}. Give the full width of the cut."
    ),
    # What a check of any cut file finds
    "cut_file.only_partly_readable": mark("The file is damaged; only a part could be read. Export it again."),
    "cut_file.no_unit": mark("The file has no unit; it was read as mm, and must be imported as mm."),
    "cut_file.unknown_unit": mark("The unit code {unit} of the file is unknown. Set it to 4 (mm)."),
    "cut_file.other_unit": mark(
        "The unit of the file is {unit} instead of mm; many machines ignore that and cut another size."
    ),
    "cut_file.other_entities": mark("The file holds {count} {kind}, which machines drop or burn. Remove them."),
    "cut_file.risky_curves": mark(
        "The file holds {count} {kind}, which some machines read wrongly. Use lines and arcs."
    ),
    "cut_file.no_curve": mark("The {kind} {handle:.20} on layer {layer:.40} cannot be read as a curve. Draw it again."),
    "cut_file.not_a_number": mark(
        "The {kind} {handle:.20} on layer {layer:.40} has a coordinate that is not a number. Draw it again."
    ),
    "cut_file.too_slow": mark(
        "{path} takes longer than {seconds:.0f} s to read. Export it again with fewer or simpler curves."
    ),
    "cut_file.too_large_curve": mark(
        "The {kind} {handle:.20} on layer {layer:.40} is larger than {limit:g} m. Remove it."
    ),
    "cut_file.no_length": mark("The {kind} {handle:.20} on layer {layer:.40} has no length. Remove it."),
    "cut_file.empty": mark("The file holds nothing that can be cut."),
    "cut_file.trap_layers": mark(
        "Layer names with CUT or ENGRAVE in them ({layers:.80}) choose an operation in MeerK40t and K40 Whisperer, so "
        "that lines are cut twice or engraved. Rename them."
    ),
    "cut_file.size_unlikely": mark(
        "The drawing is {width_mm:g} x {height_mm:g} mm, outside {smallest_mm:g} to {largest_mm:g} mm. Its unit is "
        "probably wrong."
    ),
    "cut_file.duplicates": mark_n(
        "{count} line is drawn more than once, at x = {x:.2f}, y = {y:.2f} mm, and would be cut twice. Delete the "
        "duplicate.",
        "{count} lines are drawn more than once, the first at x = {x:.2f}, y = {y:.2f} mm, and would be cut twice. "
        "Delete the duplicates.",
    ),
    "cut_file.overlap": mark("{length_mm:.3f} mm of the cuts overlap other cuts. Join or trim them."),
    "cut_file.outline_of_lines": mark(
        "The outline consists of lines that meet but is not a closed polyline; some machines take it for open."
    ),
    "cut_file.outline_crosses_itself": mark("The outline crosses itself. Draw it again."),
    "cut_file.no_outline": mark(
        "The file has no closed outline, so the sheet would not come free. Add one closed contour."
    ),
    "cut_file.outline_open": mark("The outline is open by {gap_mm:.3f} mm at x = {x:.2f}, y = {y:.2f} mm. Close it."),
    "cut_file.tab_count": mark(
        "The file promises {tabs:.20} tabs, but its outline consists of {paths} paths, {closed} of them closed. Export "
        "it again."
    ),
    "cut_file.tab_gap": mark(
        "The outline is open by {gap_mm:.3f} mm at x = {x:.2f}, y = {y:.2f} mm, where the file promises tabs with gaps "
        "of {promised_mm:.3f} mm. Export it again."
    ),
    "cut_file.below_origin": mark(
        "Coordinates go down to ({low_x:.2f}, {low_y:.2f}) mm; some machines cut off what is below the origin."
    ),
    "cut_file.outside_sheet": mark(
        "The cut at x = {x:.2f}, y = {y:.2f} mm leaves the sheet. Move it inside the outline or delete it."
    ),
    "cut_file.slit_reaches_outline": mark(
        "The slit at x = {x:.2f}, y = {y:.2f} mm reaches the outline: no connector is left at its end."
    ),
    "cut_file.cuts_after_outline": mark(
        "Cuts come after the outline in the file, and the sheet may move once it is free. Cut the outline last."
    ),
    "cut_file.falls_apart": mark(
        "With a kerf of {kerf_mm:g} mm the sheet falls into {pieces} pieces, one of them at x = {x:.2f}, y = {y:.2f} "
        "mm. Leave wider connectors."
    ),
    "cut_file.nothing_left": mark("With a kerf of {kerf_mm:g} mm nothing is left of the sheet. Use a smaller kerf."),
    "cut_file.connector_lost": mark(
        "Cuts run into each other at x = {x:.2f}, y = {y:.2f} mm: no connector is left there."
    ),
    "cut_file.loose_parts": mark_n(
        "{count} closed cut inside the outline lets a part fall out, about {size_mm:.1f} mm across, at x = "
        "{x:.2f}, y = {y:.2f} mm. Make sure that it is meant.",
        "{count} closed cuts inside the outline let a part fall out, the largest about {size_mm:.1f} mm across, at "
        "x = {x:.2f}, y = {y:.2f} mm. Make sure that they are meant.",
    ),
    "cut_file.name_differs": mark(
        "The file promises a name engraved in {promised:.20} lines on layer {layer}, and has {count} there. Export it "
        "again."
    ),
    "cut_file.not_for_cutting": mark("This is no cut file: {purpose}."),
    "cut_file.other_kind": mark(
        "{path} is no file for a cutter. Check the DXF, the SVG or the LightBurn project that was exported with it."
    ),
    "cut_file.record_not_readable": mark(
        "The file's record of how it was made is damaged: its entry {name} is '{value}'. Export it again."
    ),
    "cut_file.lines_differ": mark_n(
        "The file holds {count} cut; its record says {promised}. Export it again.",
        "The file holds {count} cuts; its record says {promised}. Export it again.",
    ),
    "cut_file.piece_open": mark(
        "The cut at x = {x:.2f}, y = {y:.2f} mm is not closed: a piece would not come free. Export it again."
    ),
    "cut_file.pieces_cross": mark(
        "The cut at x = {x:.2f}, y = {y:.2f} mm meets another one: a piece would be cut into. Export it again."
    ),
    "cut_file.pieces_differ": mark_n(
        "The file holds {count} piece; its record says {promised}. Export it again.",
        "The file holds {count} pieces; its record says {promised}. Export it again.",
    ),
    "cut_file.registration_differs": mark(
        "The record promises {promised} holes round the sheet; the file does not begin with them. Export it again."
    ),
    "cut_file.narrower_than_recorded": mark(
        "Two cuts leave only {width_mm:.3f} mm of material between them; the narrowest connector was made "
        "{recorded_mm:.3f} mm wide."
    ),
    "check.other_design": mark(
        "The project does not have the design {design} that the file was made of. Name the project that it was "
        "exported from."
    ),
    "check.bed_unknown": mark(
        "The design has no bed {bed:.40}. Name the project that the file was exported from, or export it again."
    ),
    "check.bed_twice": mark("The bed {bed:.40} was given twice. Give one file of each bed."),
    "check.beds_of_several": mark(
        "The files were made of several designs, or with other sizes. Give the files of one export."
    ),
    "check.beds_missing": mark(
        "Not looked at: {beds:.200}. Give the files of all beds to have the pieces in them put together."
    ),
    "cut_file.name_alone": mark("The file holds only an engraved name and no cuts."),
    "cut_file.name_cuts": mark(
        "The engraved name comes within {clear_mm:.3f} mm of a cut near ({x:.2f}, {y:.2f}) mm. Export it again."
    ),
    "cut_file.sheets_differ": mark(
        "The file says that it holds {promised} sheets, and not where each of them lies. Export again."
    ),
    "cut_file.copies_differ": mark(
        "The file promises {promised:.20} copies of a sheet; those in it are not alike or not apart. Export it again."
    ),
    "cut_file.holes_differ": mark_n(
        "{count} hole of the silhouette is cut, where the file promises {promised}. Export it again.",
        "{count} holes of the silhouette are cut, where the file promises {promised}. Export it again.",
    ),
    "cut_file.joins_differ": mark_n(
        "{count} cut ends on another cut, where the file promises {promised:.20}: a connector is lost or a slit "
        "misses its end. Export it again.",
        "{count} cuts end on another cut, where the file promises {promised:.20}: a connector is lost or a slit "
        "misses its end. Export it again.",
    ),
    # What two readers find in a written file
    "verify.by_one_reader": mark("{reader}: {finding}"),
    "verify.in_file": mark("In {name:.120}: {finding}"),
    "verify.unit_is_mm": mark("The unit of the file is mm."),
    "verify.other_unit": mark("The unit of the file is {unit} instead of 4 (mm)."),
    "verify.no_unit": mark("The file has no unit, but mm was planned."),
    "verify.no_unit_in_r12": mark("An R12 file has no unit: import it as mm."),
    "verify.line_counts": mark(
        "The file holds {open_lines} open and {closed_lines} closed lines; {planned_open} open and {planned_closed} "
        "closed were planned."
    ),
    "verify.other_things": mark(
        "The file holds {others} entities that are no lines ({kind:.40}) beside {open_lines} open and {closed_lines} "
        "closed lines; {planned_open} open and {planned_closed} closed were planned."
    ),
    "verify.layers_as_planned": mark("The layers and their colours are {layers}, in that order."),
    "verify.layers_differ": mark("The layers and their colours are {layers}; planned were {planned}."),
    "verify.no_layers": mark("The file has no layers; planned were {planned}."),
    "verify.points_as_planned": mark("All {points} points are where they were planned, with the same arcs."),
    "verify.points_moved": mark(
        "Points or arcs are not where they were planned: the farthest is {shift_mm:.2g} mm off."
    ),
    "verify.point_count": mark("The file holds another number of points than planned."),
    "verify.length": mark("The cut length is {length_mm:.3f} mm; {planned_mm:.3f} mm were planned."),
    "verify.no_size": mark("The header of the file gives no size."),
    "verify.size": mark(
        "The size of the file is {width_mm:.3f} x {height_mm:.3f} mm; {planned_width_mm:.3f} x {planned_height_mm:.3f} "
        "mm were planned."
    ),
    "verify.cut_once": mark("Nothing is cut twice."),
    "verify.cut_twice": mark("{length_mm:.4f} mm would be cut twice."),
    "verify.project_as_planned": mark("Every path is as the design gives it, on its layer and in its order."),
    "verify.project_differs": mark("Its paths are not those that the design gives. Export it again."),
    "verify.pieces": mark_n(
        "After cutting with a kerf of {kerf_mm:g} mm, the sheet is {count} piece.",
        "After cutting with a kerf of {kerf_mm:g} mm, the sheet is {count} pieces.",
    ),
    "verify.name": mark(
        "The name {name!r} is engraved first, on layer {layer}, {clear_mm:.2f} mm from the nearest cut; it counts as "
        "no cut."
    ),
    "verify.name_differs": mark(
        "The file should engrave the name {name!r} on layer {layer}, before anything is cut, and does not. Export "
        "again."
    ),
    "verify.name_cuts": mark(
        "The engraved name comes within {clear_mm:.3f} mm of a cut, or has its colour. Export again."
    ),
    "verify.pieces_found": mark_n(
        "{count} piece is there, and its outline and holes are right within {miss_um:.2f} µm ({piece}).",
        "All {count} pieces are there once, and their outlines and holes are right within {miss_um:.2f} µm (the worst "
        "is {piece}).",
    ),
    "verify.pieces_differ": mark(
        "Piece {piece} has an outline or a hole that is {miss_um:.2f} µm from its place. Export it again."
    ),
    "verify.pieces_lost": mark("The file has {count} outlines, not those of the {planned} pieces. Export it again."),
    "verify.pieces_open": mark("The file has a cut that is not closed: a piece would not come free. Export it again."),
    "verify.numbers": mark("Numbers are engraved first, {clear_mm:.2f} mm or more from every cut."),
    "verify.numbers_cut": mark(
        "A number comes within {clear_mm:.2f} mm of a cut, or is engraved after one. Export it again."
    ),
    "verify.pins_meet": mark(
        "The holes of all {pins} pins lie on each other within {miss_um:.2f} µm at {angles} angles."
    ),
    "verify.pins_miss": mark(
        "The two holes of a pin lie {miss_um:.2f} µm apart at one of {angles} angles. Export it again."
    ),
    "verify.holds_meet": mark_n(
        "The holes of {count} place that holds the sheet meet in its state, within {miss_um:.2f} µm, and only there.",
        "The holes of {count} places that hold the sheet meet in their state, within {miss_um:.2f} µm, and only there.",
    ),
    "verify.holds_miss": mark_n(
        "The holes of {count} place that holds the sheet miss each other by {miss_um:.2f} µm, or meet in both states. "
        "Export it again.",
        "Of {count} places that hold the sheet, holes miss each other by {miss_um:.2f} µm, or meet in both states. "
        "Export it again.",
    ),
    "verify.pieces_pass": mark("Pieces of one layer pass each other at all {angles} angles."),
    "verify.pieces_collide": mark(
        "Pieces {one} and {other} of one layer share {area_mm2:.4f} mm² at {phi_deg:.0f} degrees. Choose more "
        "clearance or smaller ears."
    ),
    "verify.motion_as_planned": mark("Pieces, pins and their places at {angles} angles are as planned."),
    "verify.motion_differs": mark(
        "Pieces, pins or their places at {angles} angles are not as planned. Export it again."
    ),
    "assembly.not_as_meant": mark("Nothing was written, for {name:.120} is not as it was meant: {finding}"),
    "verify.copies": mark(
        "The file holds {count} copies of the sheet, alike and {gap_mm:g} mm apart: cutting it leaves {pieces} pieces."
    ),
    "verify.sheets": mark("Sheets in the file: {count}, at least {gap_mm:g} mm apart."),
    "verify.sheets_meet": mark(
        "The sheets in the file should be {count}, at least {gap_mm:g} mm apart, and they meet. Export again."
    ),
    "parts.no_such_file": mark(
        "A file of kind '{extension}' cannot hold the sheets of several parts; known are {known}. Choose a part for "
        "other kinds."
    ),
    "verify.copies_differ": mark(
        "The file should hold {count} copies of the sheet, alike and {gap_mm:g} mm apart, and does not. Export again."
    ),
    "verify.smallest_ligament": mark(
        "The smallest ligament is {ligament_mm:.3f} mm; the smallest connector is planned with {planned_mm:.3f} mm."
    ),
    "verify.voids_close": mark(
        "Read back from the file: {connectors} connectors of {narrowest_mm:.3f} mm or more, and {voids} voids that "
        "miss being parallelograms by {miss_um:.1f} \N{MICRO SIGN}m at most."
    ),
    "verify.voids_miss": mark(
        "Read back from the file: {voids} voids miss being parallelograms by up to {miss_um:.0f} \N{MICRO SIGN}m at "
        "x = {x:.2f}, y = {y:.2f} mm, so the sheet stretches its connectors as it closes, or jams. Use centred "
        "connectors, or a larger sheet."
    ),
    "verify.connectors_lost": mark(
        "Read back from the file: {connectors} connectors, the narrowest {narrowest_mm:.3f} mm wide; {planned} were "
        "planned, {planned_mm:.3f} mm wide or more."
    ),
    "verify.connectors_narrower": mark_n(
        "Read back from the file: {count} connector is narrower than planned, {width_mm:.3f} instead of "
        "{planned_mm:.3f} mm, at x = {x:.1f}, y = {y:.1f} mm.",
        "Read back from the file: {count} connectors are narrower than planned, the worst {width_mm:.3f} instead "
        "of {planned_mm:.3f} mm, at x = {x:.1f}, y = {y:.1f} mm.",
    ),
    "verify.tabs_left_out": mark_n(
        "Contours for a cutting service have no gaps: {count} tab is left out.",
        "Contours for a cutting service have no gaps: {count} tabs are left out.",
    ),
    "verify.slots_longer": mark(
        "As slots the cut is {length_mm:.1f} mm long instead of {open_mm:.1f} mm ({times:.2f} times), which is what a "
        "cutting service charges for."
    ),
    "verify.slots_width": mark(
        "The slots are {kerf_mm:g} mm wide, the kerf of the plan. If the cutting service asks for wider ones, plan the "
        "cuts with that kerf."
    ),
}
