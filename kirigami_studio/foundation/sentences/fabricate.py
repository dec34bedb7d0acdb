"""Sentences of ``fabricate``, by the code of the problem: widths, materials, checks."""

from __future__ import annotations

from kirigami_studio.foundation.words import mark, mark_n

SENTENCES: dict[str, str | tuple[str, str]] = {
    # Lengths that make no sense
    "sheet.width_not_positive": mark("The sheet width must be a number of millimetres above 0, got {value!r:.40}."),
    "sheet.size_out_of_range": mark(
        "A sheet of {width_mm:g} x {height_mm:g} mm cannot be planned: both sides must be between {smallest_mm:g} and "
        "{largest_mm:g} mm. Change the sheet width."
    ),
    "connector.width_not_positive": mark(
        "The connector width must be a number of millimetres above 0, got {value!r:.40}."
    ),
    "hinge.width_not_positive": mark(
        "The width of connector {hinge} must be a number of millimetres above 0, got {value!r:.40}."
    ),
    "kerf.negative": mark("The kerf must be 0 mm or more, got {value!r:.40}."),
    "pieces.hole_within_kerf": mark(
        "A hole of {hole_mm:g} mm in piece {piece:.20} is no wider than the kerf of {kerf_mm:g} mm. Choose a wider "
        "hole or another machine."
    ),
    "pieces.narrower_than_kerf": mark(
        "Piece {piece:.20} has an opening narrower than the kerf of {kerf_mm:g} mm. Choose a larger sheet or more "
        "clearance."
    ),
    "pieces.larger_than_bed": mark_n(
        "Piece {piece:.20} is {long_mm:.0f} x {short_mm:.0f} mm, larger than the bed of {width_mm:g} x {height_mm:g} "
        "mm. Make the sheet {largest_mm} mm wide at most, or choose a finer grid or a machine with a larger bed.",
        "{count} pieces are larger than the bed of {width_mm:g} x {height_mm:g} mm, {piece:.20} with {long_mm:.0f} x "
        "{short_mm:.0f} mm. Make the sheet {largest_mm} mm wide at most, or choose a finer grid or a machine with a "
        "larger bed.",
    ),
    "pieces.bed_below_ear": mark_n(
        "Piece {piece:.20} is {long_mm:.0f} x {short_mm:.0f} mm: the bed of {width_mm:g} x {height_mm:g} mm has no "
        "room even for its ears. Choose another machine.",
        "{count} pieces, {piece:.20} with {long_mm:.0f} x {short_mm:.0f} mm, are larger than the bed: {width_mm:g} x "
        "{height_mm:g} mm has no room even for their ears. Choose another machine.",
    ),
    "pieces.several_beds": mark_n(
        "The pieces of layer {layer} take {count} bed of {width_mm:g} x {height_mm:g} mm.",
        "The pieces of layer {layer} take {count} beds of {width_mm:g} x {height_mm:g} mm, one file each.",
    ),
    "overcut.not_positive": mark("The overcut must be a number of millimetres above 0, got {value!r:.40}."),
    "tabs.width_not_positive": mark("The tab width must be a number of millimetres above 0, got {value!r:.40}."),
    # Choices about the cuts
    "tabs.too_many": mark("The outline can have 0 to {most} tabs, got {tabs}."),
    "tabs.no_room": mark_n(
        "The outline of {length_mm:.1f} mm has no room for {tabs} tabs of {gap_mm:g} mm away from its corners, "
        "edge slits and connectors. Use {count} tab at most, or narrower ones.",
        "The outline of {length_mm:.1f} mm has no room for {tabs} tabs of {gap_mm:g} mm away from its corners, "
        "edge slits and connectors. Use {count} tabs at most, or narrower ones.",
    ),
    "tabs.no_room_for_any": mark(
        "The outline of {length_mm:.1f} mm has no room for a tab of {gap_mm:g} mm away from its corners, edge slits "
        "and connectors. Use narrower tabs or none."
    ),
    "hinge.unknown": mark("There is no connector {hinge}: this sheet has connectors 0 to {last}."),
    "hinge.named_twice": mark(
        "A connector can be given a width or removed only once; name connectors in ascending order."
    ),
    "hinge.width_and_removed": mark("Connector {hinge} is given a width and also removed. Choose one."),
    "style.needs_relief_radius": mark(
        "The connector style {style!r} needs a relief radius, but that of {material!r} is 0 mm. Choose straight, arc "
        "or double connectors, or a material with a relief radius."
    ),
    # Cuts without room
    "slit.no_room": mark_n(
        "The slit of the void in row {row}, column {column} is {length_mm:.2f} mm long, but connectors of "
        "{connector_mm:g} mm and a kerf of {kerf_mm:g} mm need {needed_mm:.2f} mm. Make the sheet at least "
        "{times:.2f} times wider or the connectors narrower.",
        "The slit of the void in row {row}, column {column} is {length_mm:.2f} mm long, but connectors of "
        "{connector_mm:g} mm and a kerf of {kerf_mm:g} mm need {needed_mm:.2f} mm. Make the sheet at least "
        "{times:.2f} times wider or the connectors narrower ({count} cuts are too short).",
    ),
    "edge_cut.no_room": mark_n(
        "The edge cut at the void in row {row}, column {column} is {length_mm:.2f} mm long, but a connector of "
        "{connector_mm:g} mm and a kerf of {kerf_mm:g} mm need {needed_mm:.2f} mm. Make the sheet at least "
        "{times:.2f} times wider or the connectors narrower.",
        "The edge cut at the void in row {row}, column {column} is {length_mm:.2f} mm long, but a connector of "
        "{connector_mm:g} mm and a kerf of {kerf_mm:g} mm need {needed_mm:.2f} mm. Make the sheet at least "
        "{times:.2f} times wider or the connectors narrower ({count} cuts are too short).",
    ),
    # Trimmed sheets
    "hinge.no_cut_left": mark("No cut is left at x = {x:.2f}, y = {y:.2f} mm. Keep more material when trimming."),
    "trimmed.panel_count": mark("This sheet has {panels} panels, but {given} trimmed ones were given."),
    "trimmed.falls_apart": mark(
        "The trimmed sheet falls into {parts} parts. Keep more material at the hinges when trimming."
    ),
    "trimmed.connector_lost": mark(
        "Trimming leaves too little material for the connector at x = {x:.2f}, y = {y:.2f} mm. Keep more material at "
        "the hinges, make the sheet wider or the connectors narrower."
    ),
    # Materials
    "material.wrong_type": mark(
        "Material {key!r:.60}: {name} must be of type {kind}, got {value!r:.40}. Correct its file."
    ),
    "material.number_not_positive": mark(
        "Material {key!r:.60}: {name} must be a number above 0, got {value!r:.40} (from {least:g} to "
        "{most:g} is taken). Correct its file."
    ),
    "material.number_negative": mark(
        "Material {key!r:.60}: {name} must be a number of 0 or more, got {value!r:.40} (up to {most:g} is "
        "taken). Correct its file."
    ),
    "material.power_above_full": mark(
        "Material {key!r:.40}: power_percent must be 0 to 100, got {power_percent:g}. Give the share of full power."
    ),
    "material.no_passes": mark("Material {key!r:.60}: passes must be 1 or more, got {passes}. Correct its file."),
    "material.not_a_day": mark(
        "Material {key!r:.60}: measured_on must be a day such as 2026-11-21, got {value!r:.40}. Correct its file."
    ),
    "material.unknown": mark("There is no material {name!r:.60}. Choose one of {known}."),
    "material.folder_not_readable": mark("Cannot read your own materials in {folder}: {reason}."),
    "material.file_not_readable": mark("Cannot read the material file {path}: {reason!s:.200}. Correct or remove it."),
    "material.entries_missing": mark_n(
        "The material file {path} lacks the entry {names}. Add it.",
        "The material file {path} lacks the entries {names}. Add them.",
    ),
    "material.entries_unknown": mark_n(
        "The material file {path} has an unknown entry: {names:.80}. Remove it.",
        "The material file {path} has unknown entries: {names:.80}. Remove them.",
    ),
    "material.key_not_usable": mark(
        "A material's key has 1 to 40 of the characters a-z, 0-9, - and _ and is not the name of a device, got "
        "{key!r:.60}. Choose another, for example 'my-film'."
    ),
    "material.bundled_not_deleted": mark("{key!r:.60} is a bundled material and cannot be deleted."),
    "material.not_own": mark("You have no material {key!r:.60} of your own. Your own materials: {own}."),
    "material.none_own": mark("You have no materials of your own, so {key!r:.60} cannot be deleted."),
    "material.not_deleted": mark("Cannot delete {path}: {reason}."),
    "material.no_such_entry": mark("A material has no entry {name!r:.40}. Choose from {known}."),
    "material.not_a_number": mark("{name} must be a number, got {value!r:.40}."),
    "material.not_a_whole_number": mark("{name} must be a whole number, got {value!r:.40}."),
    "material.no_author": mark("A calibration needs the name of the person who measured. Give an author."),
    "material.folder_is_bundled": mark(
        "Your own materials cannot be kept in {folder}, where the bundled ones are. Choose another folder."
    ),
    # Machines
    "machine.wrong_type": mark(
        "Machine {key!r:.60}: {name} must be of type {kind}, got {value!r:.40}. Correct its file."
    ),
    "machine.no_such_kind": mark("Machine {key!r:.60}: there is no kind {value!r:.40}. Choose one of {choices}."),
    "machine.no_such_profile": mark("Machine {key!r:.60}: there is no profile {value!r:.40}. Choose one of {choices}."),
    "machine.no_such_file": mark(
        "Machine {key!r:.60}: files are not written as {value!r:.40}. Choose one of {choices}."
    ),
    "machine.number_not_positive": mark(
        "Machine {key!r:.60}: {name} must be a number above 0, got {value!r:.40} (from {least:g} to "
        "{most:g} is taken). Correct its file."
    ),
    "machine.number_negative": mark(
        "Machine {key!r:.60}: {name} must be a number of 0 or more, got {value!r:.40} (up to {most:g} is "
        "taken). Correct its file."
    ),
    "machine.unknown": mark("There is no machine {name!r:.60}. Choose one of {known}."),
    "machine.folder_not_readable": mark("Cannot read your own machines in {folder}: {reason}."),
    "machine.file_not_readable": mark("Cannot read the machine file {path}: {reason!s:.200}. Correct or remove it."),
    "machine.entries_missing": mark_n(
        "The machine file {path} lacks the entry {names}. Add it.",
        "The machine file {path} lacks the entries {names}. Add them.",
    ),
    "machine.entries_unknown": mark_n(
        "The machine file {path} has an unknown entry: {names:.80}. Remove it.",
        "The machine file {path} has unknown entries: {names:.80}. Remove them.",
    ),
    "machine.key_not_usable": mark(
        "A machine's key has 1 to 40 of the characters a-z, 0-9, - and _ and is not the name of a device, got "
        "{key!r:.60}. Choose another, for example 'my-laser'."
    ),
    "machine.bundled_not_deleted": mark("{key!r:.60} is a bundled machine and cannot be deleted."),
    "machine.not_own": mark("You have no machine {key!r:.60} of your own. Your own machines: {own}."),
    "machine.none_own": mark("You have no machines of your own, so {key!r:.60} cannot be deleted."),
    "machine.no_such_entry": mark("A machine has no entry {name!r:.40}. Choose from {known}."),
    "machine.folder_is_bundled": mark(
        "Your own machines cannot be kept in {folder}, where the bundled ones are. Choose another folder."
    ),
    "plan.machine_unknown": mark(
        "You do not have the machine {name!r:.60}. Bed and times are those of {machine}; choose your machine."
    ),
    "plan.machine_differs": mark("Your machine {name} differs from the project's; yours is used."),
    "plan.material_differs": mark("Your material {name} differs from the project's; yours is used."),
    "plan.machine_does_not_cut": mark(
        "{machine} is not known to cut {material}, whose figures are for another kind of machine. Choose a material "
        "that it cuts, or another machine."
    ),
    "plan.too_thick_for_machine": mark(
        "{machine} takes sheets up to {thickest_mm:g} mm, {material} has {thickness_mm:g} mm. Choose a thinner "
        "material or another machine."
    ),
    # The coupon
    "coupon.gap_negative": mark("The gap beside the comb must be 0 mm or more, got {value!r:.40}."),
    "coupon.no_reading": mark("Measure the gap beside the comb at least once."),
    "coupon.kerf_too_wide": mark("The coupon suits kerfs up to {widest_mm:g} mm, got {kerf_mm:g} mm."),
    "coupon.ligament_out_of_range": mark(
        "The coupon tries connectors of {narrowest_mm:g} to {widest_mm:g} mm, but the smallest ligament of {key!r} is "
        "{ligament_mm:g} mm. Correct the material."
    ),
    "coupon.flap_too_narrow": mark(
        "A flap of {flap_mm:g} mm has no room for two connectors of {connector_mm:g} mm and a kerf of {kerf_mm:g} mm."
    ),
    "coupon.how_to_read_kerf": mark(
        "Kerf: push the {fingers} fingers of the comb and the material beside them together. The gap that opens, "
        "divided by {slits}, is the kerf."
    ),
    "coupon.how_to_read_ligament": mark(
        "Ligament: lift the flaps. From left to right the connectors are {widths} mm wide (short slits count the "
        "columns); from bottom to top the flaps are {flaps} mm wide (short cuts at the left edge count the rows)."
    ),
    # What to know before cutting
    "plan.stopped": mark("Planning the cuts was stopped."),
    "plan.material_uncalibrated": mark("The material {material!r} is uncalibrated: cut a test piece first."),
    "plan.connectors_may_tear": mark(
        "Connectors of {width_mm:g} mm may tear: {material!r} needs {least_mm:g} mm or more."
    ),
    "plan.no_room_to_centre": mark(
        "The connectors cannot be centred on their nodes: the cuts are too near to each other. They are straight "
        "instead. Use a larger sheet, narrower connectors or a more regular design."
    ),
    "plan.off_centre": mark_n(
        "{count} of {total} connectors has no room to be centred, and a void misses being a parallelogram by "
        "{miss_mm:.3f} mm: the sheet jams before it closes. Use a larger sheet, narrower connectors or a more "
        "regular design.",
        "{count} of {total} connectors have no room to be centred, and voids miss being parallelograms by up to "
        "{miss_mm:.3f} mm: the sheet jams before it closes. Use a larger sheet, narrower connectors or a more "
        "regular design.",
    ),
    "plan.room_made": mark(
        "To make room for the connectors, the panels that are cut differ from the design by up to {moved_mm:.2f} mm. "
        "The closed shape keeps its outline to within {share_percent:g} % of its area."
    ),
    "plan.no_room_made_in_trimmed": mark(
        "This sheet is trimmed, so its panels cannot be changed to make room for the connectors, and some are crowded: "
        "the sheet may jam. Use a larger sheet, narrower connectors or a design that is not trimmed."
    ),
    "plan.connectors_narrowed": mark_n(
        "{count} of {total} connectors is narrower than asked for, {width_mm:.3f} instead of {asked_mm:.3f} mm, at "
        "x = {x:.1f}, y = {y:.1f} mm: a wider one has no room there. Use a larger sheet or a more regular design.",
        "{count} of {total} connectors are narrower than asked for, the narrowest {width_mm:.3f} instead of "
        "{asked_mm:.3f} mm, at x = {x:.1f}, y = {y:.1f} mm: wider ones have no room there. Use a larger sheet or a "
        "more regular design.",
    ),
    "plan.straight_because_slanted": mark_n(
        "{count} of {total} slit ends is straight instead of {style}: the slit is too slanted, or the cut it ends "
        "on too short. Use a larger sheet, narrower connectors or a more regular design.",
        "{count} of {total} slit ends are straight instead of {style}: the slits are too slanted, or the cuts they "
        "end on too short. Use a larger sheet, narrower connectors or a more regular design.",
    ),
    "plan.straight_because_short": mark_n(
        "{count} of {total} slit ends is straight instead of {style}: the slit is too short. Use a larger sheet, "
        "narrower connectors or a more regular design.",
        "{count} of {total} slit ends are straight instead of {style}: the slits are too short. Use a larger "
        "sheet, narrower connectors or a more regular design.",
    ),
    "plan.straight_because_crowded": mark_n(
        "{count} of {total} slit ends is straight instead of {style}: another cut is too near. Use a larger sheet, "
        "narrower connectors or a more regular design.",
        "{count} of {total} slit ends are straight instead of {style}: other cuts are too near. Use a larger "
        "sheet, narrower connectors or a more regular design.",
    ),
    "plan.connectors_wider": mark_n(
        "{count} of {total} connectors is wider than asked for, because the slit it rests on ends before it: "
        "{widest_mm:.3f} mm near x = {x:.1f}, y = {y:.1f} mm. Use a larger sheet or narrower connectors.",
        "{count} of {total} connectors are wider than asked for, because the slits they rest on end before them: "
        "up to {widest_mm:.3f} mm near x = {x:.1f}, y = {y:.1f} mm. Use a larger sheet or narrower connectors.",
    ),
    "plan.gaps_may_be_joined": mark(
        "Cut ends are {gap_mm:.3f} mm apart, and programs that join gaps up to {tolerance_mm:g} mm may close them. "
        "Switch joining off when importing."
    ),
    # What a check of a plan finds
    "plan.name_without_room": mark(
        "The name {name!r} is not engraved: no whole panel has room for letters of {least_mm:g} mm."
    ),
    "plan.name_without_letters": mark("The name {name!r} is not engraved: the engraving font has none of its letters."),
    "plan.name_letters_left_out": mark(
        "The name {name!r} is engraved without {letters}: the engraving font has no strokes for that."
    ),
    "plan.refused": mark("{reason}"),
    "plan.nothing_left": mark("Nothing is left of the sheet with a kerf of {kerf_mm:g} mm. Use a smaller kerf."),
    "plan.falls_apart": mark(
        "With a kerf of {kerf_mm:g} mm the sheet falls into {pieces} pieces, one of them at x = {x:.2f}, y = {y:.2f} "
        "mm. Widen the connectors or use a smaller kerf."
    ),
    "plan.falls_apart_after_removal": mark_n(
        "With a kerf of {kerf_mm:g} mm the sheet falls into {pieces} pieces, one of them at x = {x:.2f}, y = "
        "{y:.2f} mm. {count} connector was removed: put it back.",
        "With a kerf of {kerf_mm:g} mm the sheet falls into {pieces} pieces, one of them at x = {x:.2f}, y = "
        "{y:.2f} mm. {count} connectors were removed: put some of them back.",
    ),
    "plan.connectors_narrower": mark_n(
        "{count} connector is narrower than asked for: {finished_mm:.3f} instead of {asked_mm:.3f} mm at x = "
        "{x:.2f}, y = {y:.2f} mm. Plan the cuts with the kerf that the machine really has.",
        "{count} connectors are narrower than asked for, the worst {finished_mm:.3f} instead of {asked_mm:.3f} mm "
        "at x = {x:.2f}, y = {y:.2f} mm. Plan the cuts with the kerf that the machine really has.",
    ),
    "plan.connector_gone": mark(
        "Nothing is left of the connector at x = {x:.2f}, y = {y:.2f} mm: the sheet would fall into pieces there. "
        "Widen the connectors."
    ),
    "plan.connector_may_tear": mark(
        "The connector at x = {x:.2f}, y = {y:.2f} mm is {finished_mm:.3f} mm wide and may tear: {material!r} needs "
        "{least_mm:g} mm or more."
    ),
    "plan.removed_not_cut_through": mark_n(
        "{count} removed connector is not cut through, at x = {x:.2f}, y = {y:.2f} mm. Keep it or make the sheet "
        "larger.",
        "{count} removed connectors are not cut through, the first at x = {x:.2f}, y = {y:.2f} mm. Keep them or "
        "make the sheet larger.",
    ),
    "plan.cut_twice": mark(
        "{length_mm:.4f} mm would be cut twice near x = {x:.2f}, y = {y:.2f} mm. This should not happen: please "
        "report this design."
    ),
    "plan.cuts_too_near": mark(
        "Two cuts leave only {width_mm:.3f} mm of material at x = {x:.2f}, y = {y:.2f} mm, less than the connectors. "
        "Use a larger sheet or a more regular design."
    ),
    "copies.number": mark(
        "A file holds 1 to {most} copies of a sheet, or 0 for as many as fit on the bed; got {copies}."
    ),
    "copies.gap_not_positive": mark("The gap between copies must be a length above 0 mm, got {value}."),
    "copies.gap_too_narrow": mark(
        "A gap of {gap_mm:g} mm between copies is not wider than the kerf of {kerf_mm:g} mm. Make the gap wider."
    ),
    "copies.only_of_sheets": mark("Copies are made of one-sheet designs only: each piece is cut once."),
    "copies.no_bed": mark(
        "As many copies as fit were asked for, but the bed of the machine is not known: the file holds one. Choose "
        "your machine or enter its bed, or ask for a number."
    ),
    "copies.none_fits": mark(
        "Not one copy fits on the bed of {bed_width_mm:g} x {bed_height_mm:g} mm; the file holds one."
    ),
    "copies.fewer_fit": mark_n(
        "Of {asked} copies {count} fits on the bed of {bed_width_mm:g} x {bed_height_mm:g} mm with gaps of "
        "{gap_mm:g} mm; the file holds {count}.",
        "Of {asked} copies {count} fit on the bed of {bed_width_mm:g} x {bed_height_mm:g} mm with gaps of "
        "{gap_mm:g} mm; the file holds {count}.",
    ),
    "plan.larger_than_bed": mark(
        "The cuts cover {width_mm:.1f} x {height_mm:.1f} mm, but the machine reaches {bed_width_mm:g} x "
        "{bed_height_mm:g} mm. Make the sheet less than {largest_mm:.1f} mm wide or set the bed of your machine."
    ),
    "construction.pinned": mark("{material}: made of two layers of pieces that turn on pins ({fastener})."),
    "construction.backed": mark("Tiles of {board} are glued on a hinge layer of {hinge}."),
    "construction.printed": mark(
        "{material}: pieces and their pins are printed at once and turn on each other, without support or assembly."
    ),
    "plan.material_does_not_hold": mark(
        "{material}: one sheet cannot close, its connectors break whatever their style and width. Two layers on pins "
        "can: choose that construction. For one sheet cut film, paper or polypropylene."
    ),
    "plan.material_needs_printed_pins": mark(
        "{material}: one sheet cannot close, its connectors break whatever their style and width. Pieces that are "
        "printed on their pins can: choose that construction."
    ),
    "plan.material_needs_backing": mark(
        "{material}: one sheet cannot close, its connectors break whatever their style and width. Tiles of it glued on "
        "a hinge layer can: choose that construction. For one sheet cut film, paper or polypropylene."
    ),
    "plan.material_is_hinge_layer": mark(
        "{material} is a hinge layer: alone it is too limp for panels. Tiles of board, or printed ones, glued on make "
        "it stiff: choose that construction."
    ),
    "material.near_its_limit": mark(
        "{material}: one sheet closes only with large panels, because connectors narrower than {least_mm:g} mm break. "
        "Tiles of it glued on a hinge layer close in any design."
    ),
    "strain.escapes": mark(
        "The sheet is {ratio:.2f} times as thick as the connector is wide, below {threshold:g}: it bends out of the "
        "plane, across its thickness."
    ),
    "strain.held_by_tiles": mark(
        "The hinge layer is {ratio:.2f} times as thick as the connector is wide, below {threshold:g}, but the tiles "
        "leave it too short to bend out of the plane: it bends across its width."
    ),
    "strain.stays_flat": mark(
        "The sheet is {ratio:.2f} times as thick as the connector is wide, not below {threshold:g}: it bends in the "
        "plane, across its width."
    ),
    "material.no_such_word": mark(
        "Material {key!r:.60}: {name} must be one of {choices}, got {value!r:.40}. Correct its file."
    ),
    "plan.slits_short": mark_n(
        "{count} cut is shorter than the {least_mm:g} mm that {material!r} needs: {length_mm:.3f} mm at x = "
        "{x:.2f}, y = {y:.2f} mm. Use a larger sheet or a more regular design.",
        "{count} cuts are shorter than the {least_mm:g} mm that {material!r} needs, the shortest {length_mm:.3f} "
        "mm at x = {x:.2f}, y = {y:.2f} mm. Use a larger sheet or a more regular design.",
    ),
    "plan.panel_edge_small": mark(
        "A panel at x = {x:.2f}, y = {y:.2f} mm has a finished edge of {size_mm:.3f} mm; {material!r} needs "
        "{least_mm:g} mm or more. Use a larger sheet, a more regular design or a least panel size in the fit."
    ),
    "plan.panel_neck_small": mark(
        "A panel at x = {x:.2f}, y = {y:.2f} mm has a finished neck of {size_mm:.3f} mm; {material!r} needs "
        "{least_mm:g} mm or more. Use a larger sheet, a more regular design or a least panel size in the fit."
    ),
    "plan.trimmed_neck_small": mark(
        "A trimmed panel at x = {x:.2f}, y = {y:.2f} mm has a neck below the {least_mm:g} mm that {material!r} needs. "
        "Keep more material when trimming or make the sheet larger."
    ),
    "plan.tab_count": mark(
        "The outline has {paths} paths, {open_paths} of them open, but the plan has {tabs} tabs. This should not "
        "happen: please report this design."
    ),
    "plan.tab_width": mark(
        "The tab at x = {x:.2f}, y = {y:.2f} mm is {width_mm:.3f} mm wide instead of {asked_mm:g} mm. This should not "
        "happen: please report this design."
    ),
    "plan.strain_choose_style": mark(
        "Opened to the target angle, every connector turns by {turn_deg:.0f} degrees. The one at x = {x:.2f}, y = "
        "{y:.2f} mm is then strained by about {strain_percent:.0f} %, but {material!r} breaks at {limit_percent:g} % "
        "(an estimate with the assumption that it bends evenly over {flexure_mm:.3f} mm). {why} "
        "Choose arc or double connectors, thinner material or a target angle nearer to flat."
    ),
    "plan.strain_larger_sheet": mark(
        "Opened to the target angle, every connector turns by {turn_deg:.0f} degrees. The one at x = {x:.2f}, y = "
        "{y:.2f} mm is then strained by about {strain_percent:.0f} %, but {material!r} breaks at {limit_percent:g} % "
        "(an estimate with the assumption that it bends evenly over {flexure_mm:.3f} mm). {why} "
        "Choose a larger sheet, so that every slit end has room for its style, thinner material or "
        "a target angle nearer to flat."
    ),
    # Backed and printed sheets
    "backed.gap_negative": mark("The gap round tiles must be 0 mm or more, got {value!r:.40}."),
    "backed.relief_negative": mark(
        "The radius that tiles leave free round a connector must be 0 mm or more, got {value!r:.40}."
    ),
    "backed.frame_not_positive": mark(
        "The frame round the tiles must be a number of millimetres above 0, got {value!r:.40}."
    ),
    "backed.pin_not_positive": mark("Registration holes must be a number of millimetres above 0, got {value!r:.40}."),
    "backed.pin_too_wide": mark(
        "Registration holes of {pin_mm:g} mm are too wide for a frame of {frame_mm:g} mm. Make the frame wider."
    ),
    "backed.cuts_merge": mark(
        "A gap of {gap_mm:g} mm leaves nothing between the cuts of two tiles, whose kerf is {kerf_mm:g} mm. Make the "
        "gap larger."
    ),
    "backed.tiles_missing": mark_n(
        "{count} panel is too small for a tile: nothing stiffens it. Make the sheet larger or the gap smaller.",
        "{count} panels are too small for tiles: nothing stiffens them. Make the sheet larger or the gap smaller.",
    ),
    "backed.tile_narrow": mark_n(
        "{count} tile is narrower than {least_mm:g} mm: {piece} is {width_mm:.2f} mm wide at its narrowest place. "
        "Make the sheet larger, or the gap or the connectors smaller.",
        "{count} tiles are narrower than {least_mm:g} mm: {piece} is {width_mm:.2f} mm wide at its narrowest place. "
        "Make the sheet larger, or the gap or the connectors smaller.",
    ),
    "backed.frame_larger_than_bed": mark(
        "The frame round the tiles is {width_mm:.0f} x {height_mm:.0f} mm, more than the bed of {machine}. Make the "
        "sheet smaller."
    ),
    "backed.kiss_cut": mark(
        "Layer {layer} of the board is to be cut to the liner only: set its power or depth; all else is cut through."
    ),
    "printed.thickness_not_positive": mark(
        "The thickness of a print must be a number of millimetres above 0, got {value!r:.40}."
    ),
    "printed.pins_not_positive": mark(
        "Printed pins need sizes in millimetres above 0, and ears wider than their pins, got ear {ear_mm!r:.40}, pin "
        "{pin_mm!r:.40}, clearance {clearance_mm!r:.40}."
    ),
    "printed.cone_too_flat": mark(
        "The cones of printed pins must rise by 45 to 80 degrees to need no support, got {cone_deg!r:.40}."
    ),
    "printed.ear_too_small": mark(
        "An ear of {ear_mm:g} mm has no room for a pin of {pin_mm:g} mm that cannot come out, and for its wall. Make "
        "it at least {least_mm:.2f} mm wide."
    ),
    "printed.too_thin_for_pins": mark(
        "Panels of {thickness_mm:g} mm are too thin for pins that are printed in place: with ears of {ear_mm:g} mm "
        "they have to be at least {least_mm:.2f} mm thick."
    ),
    "printed.pieces_too_near": mark(
        "At {angle_deg:.0f} degrees pieces come nearer to each other than their clearance of {clearance_mm:g} mm, and "
        "may fuse or rub. Choose another design."
    ),
    "printed.material_is_cut": mark("{material} is cut, not printed. Choose a material of a 3D printer, such as PLA."),
    "printed.assembly_larger_than_bed": mark(
        "The print is {width_mm:.1f} x {depth_mm:.1f} mm, and cannot be divided into plates of {bed_width_mm:g} x "
        "{bed_depth_mm:g} mm. Make the sheet smaller, or choose a larger printer."
    ),
    "printed.joined_by_hand": mark(
        "The print takes {count} plates, which are joined by hand at {caps} pins, with caps glued on. Make the sheet "
        "narrower, or choose a larger printer, to print it at once."
    ),
    "printed.falls_apart": mark(
        "The sheet is in {pieces} pieces after cutting, and cannot be printed as one. Widen the connectors."
    ),
    "printed.no_tiles": mark(
        "No panel is large enough for a tile with a gap of {gap_mm:g} mm. Make the sheet larger or the gap smaller."
    ),
    "printed.not_one_body": mark(
        "The body {name:.40} is in {pieces} parts or does not close. Make the sheet larger or its slits narrower."
    ),
    "printed.larger_than_bed": mark(
        "The body {name:.40} is {width_mm:.1f} x {depth_mm:.1f} mm, larger than the bed of {bed_width_mm:g} x "
        "{bed_depth_mm:g} mm. Make the sheet smaller."
    ),
    "pins.out_of_range": mark("{name} of pinned pieces must be from {least:g} to {most:g}, got {value!r:.40}."),
    "pins.ear_within_hole": mark(
        "An ear of {ear_mm:g} mm does not hold a hole of {pin_mm:g} mm and necks of {neck_mm:g} mm. Make the ear "
        "wider, or holes and necks smaller."
    ),
    "pins.sheet_too_narrow": mark(
        "A sheet of {width_mm:g} mm has no room for a margin of {margin_mm:g} mm. Make the sheet wider or the pins "
        "smaller."
    ),
    "pinned.pins_left_out": mark_n(
        "{count} pin is left out, which would have no wall or show in a hole; the pieces move in one way all the same.",
        "{count} pins are left out, which would have no wall or show in a hole; the pieces move in one way all the "
        "same.",
    ),
    "hold.marks_for_magnets": mark(
        "Engraved marks with numbers, two of each, meet as the sheet moves: {open} keep it open, {flat} flat. Glue a "
        "magnet on each, with opposite poles up at the two of a number."
    ),
    "hold.marks_for_eyelets": mark(
        "Engraved marks with numbers, two of each, meet as the sheet moves: {open} keep it open, {flat} flat. Punch "
        "each, set an eyelet, and tie the two of a number."
    ),
    "hold.marks_for_stitches": mark(
        "Engraved crosses with numbers, two of each, meet as the sheet moves: {open} keep it open, {flat} flat. Pierce "
        "them, and sew the two of a number together."
    ),
    "hold.marks_for_tabs": mark(
        "Engraved marks with numbers, two of each, meet as the sheet moves: {open} keep it open, {flat} flat. Stick "
        "tape over the two of a number."
    ),
    "drive.only_on_pins": mark("A board with arms moves two layers on pins only: this sheet has none."),
    "drive.needs_screws": mark(
        "A board needs screws as pins, through spacers: holes of {hole_mm:g} mm have none. Choose M2 or M3 screws."
    ),
    "drive.no_room": mark(
        "There is no place for a board: no piece has two pins beside which an arm of {shortest_mm:g} to "
        "{longest_mm:g} mm turns freely. Choose another size or another design."
    ),
    "hold.no_room_open": mark(
        "Nothing keeps the sheet open: where parts meet only then, there is no room for holes or tabs beside pins, "
        "cuts and walls. Take smaller magnets, another kind, or a larger sheet."
    ),
    "hold.no_room_flat": mark(
        "Nothing keeps the sheet flat: where parts meet only then, there is no room for holes or tabs beside pins, "
        "cuts and walls. Take smaller magnets, another kind, or a larger sheet."
    ),
    "hold.nothing_meets_open": mark(
        "Nothing keeps the sheet open: at the angle of its target no voids are closed, so that no edges meet."
    ),
    "hold.nothing_meets_flat": mark("Nothing keeps the sheet flat: no edges meet there that are long enough."),
    "pinned.not_made": mark("The pieces of this design could not be made ({reason:.200}). Choose another design."),
    "pinned.hole_too_small": mark_n(
        "{count} of {total} holes stays closed, for it is smaller than an ear, at x = {x:.1f}, y = {y:.1f} mm. Make "
        "the sheet larger, or fill it.",
        "{count} of {total} holes stay closed, for they are smaller than an ear, as at x = {x:.1f}, y = {y:.1f} mm. "
        "Make the sheet larger, or fill them.",
    ),
    "pinned.falls_apart": mark_n(
        "Piece {piece} falls apart: the ears of its neighbours cut it through. Make the ears smaller or the sheet "
        "larger.",
        "{count} pieces, {piece} first, fall apart: the ears of their neighbours cut them through. Make the ears "
        "smaller or the sheet larger.",
    ),
    "pinned.ears_meet": mark_n(
        "{count} pair of pins of one layer comes as near as {gap_mm:.1f} mm; ears and clearance need {needed_mm:.1f}"
        " mm. Make the ears smaller or the sheet larger, or fit the design for these pins.",
        "{count} pairs of pins of one layer come as near as {gap_mm:.1f} mm; ears and clearance need {needed_mm:.1f}"
        " mm. Make the ears smaller or the sheet larger, or fit the design for these pins.",
    ),
    "pinned.pieces_collide": mark(
        "Pieces of one layer overlap by {overlap_mm2:.2f} mm2 at {angle_deg:.0f} degrees. Choose another design."
    ),
    "pinned.wall_too_thin": mark_n(
        "A hole of piece {piece} has a wall of {wall_mm:.1f} mm, {needed_mm:.1f} mm are asked for. Make the holes "
        "smaller or the sheet larger.",
        "Holes of {count} pieces have less wall than {needed_mm:.1f} mm; one of piece {piece} has {wall_mm:.1f} mm. "
        "Make the holes smaller or the sheet larger.",
    ),
    "pinned.neck_too_narrow": mark_n(
        "Piece {piece} has a neck of {neck_mm:.1f} mm, {needed_mm:.1f} mm are asked for. Make the ears smaller or "
        "the sheet larger.",
        "{count} pieces have necks narrower than {needed_mm:.1f} mm; that of piece {piece} is {neck_mm:.1f} mm wide. "
        "Make the ears smaller or the sheet larger.",
    ),
    "pinned.heads_meet": mark(
        "Two pins come as near as {apart_mm:.1f} mm, and their heads are {head_mm:.1f} mm wide. Use smaller heads or"
        " a larger sheet."
    ),
    "pinned.flat_outline_spoilt": mark(
        "The flat outline lacks {lost:.1f} % of its area, and {beyond:.1f} % stick out of it."
    ),
    "pinned.target_missed": mark(
        "The target lacks {lost:.1f} % of its area, and {beyond:.1f} % stick out of it. Choose another design or a "
        "finer grid."
    ),
}
