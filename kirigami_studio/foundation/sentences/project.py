"""Sentences of ``project``, by the code of the problem: documents, files, preferences."""

from __future__ import annotations

from kirigami_studio.foundation.words import mark, mark_n

SENTENCES: dict[str, str | tuple[str, str]] = {
    # Fixes that were tried on a design
    "fix.style": mark("Use {style} connectors."),
    "fix.connector": mark("Use connectors of {connector_mm:g} mm."),
    "fix.width": mark("Make it {width_mm:.1f} mm wide."),
    "fix.combined": mark("Use {style} connectors of {connector_mm:g} mm on a sheet {width_mm:.1f} mm wide."),
    "fix.material": mark("Cut {material}."),
    "fix.design": mark("Choose design {name}."),
    "fix.grid": mark("Use {rows} x {columns} voids: match {match_percent:.1f} %."),
    "fix.removed": mark("Put the removed connectors back."),
    "fix.hinges": mark("Give all connectors the same width."),
    "fix.strain": mark("{change}: strain {strain_percent:.1f} %."),
    "fix.then": mark("{change} Then: {level}."),
    "fix.ear": mark("Use ears of {ear_mm:g} mm."),
    "fix.fastener": mark("Use other pins: {fastener}."),
    "fix.clearance": mark("Use a clearance of {clearance_mm:g} mm."),
    "fix.pins_combined": mark("Make it {width_mm:.0f} mm wide, with other pins: {fastener}."),
    "fix.none_of_pieces": mark_n(
        "Nothing that was tried works: {count} change of pins, ears, clearance, design and grid, on sheets "
        "{least_mm:.0f} to {largest_mm:.0f} mm wide, with ears of {smallest_ear_mm:.1f} to {largest_ear_mm:.1f} mm.",
        "Nothing that was tried works: {count} changes of pins, ears, clearance, design and grid, on sheets "
        "{least_mm:.0f} to {largest_mm:.0f} mm wide, with ears of {smallest_ear_mm:.1f} to {largest_ear_mm:.1f} mm.",
    ),
    "fix.none": mark_n(
        "Nothing that was tried works: {count} change, with {styles} styles, connectors of {narrowest_mm:g} to "
        "{widest_mm:g} mm, sheets {least_mm:.0f} to {largest_mm:.0f} mm wide and {materials} other materials.",
        "Nothing that was tried works: {count} changes, with {styles} styles, connectors of {narrowest_mm:g} to "
        "{widest_mm:g} mm, sheets {least_mm:.0f} to {largest_mm:.0f} mm wide and {materials} other materials.",
    ),
    # The photo behind a target
    "photo.too_large": mark("{name} has {size_mb:.0f} MB; the limit is {most_mb} MB."),
    "photo.not_read": mark("Cannot read {name}: {reason}."),
    # What a document cannot hold
    "project.no_design_in_file": mark(
        "{path} does not hold the design that it was cut from. Open the project, or a cut file that this program wrote."
    ),
    "project.designs_without_target": mark("A project with designs also needs the target they were made for."),
    "project.no_such_part": mark(
        "There is no part {number} of this target: it has {parts} parts, counted from 0, and can have {limit}."
    ),
    "parts.no_such_part": mark("The project has no part called '{name}'. It has {names}."),
    "parts.not_designed": mark("These parts have no design yet: {names}. Design them first, or choose a part."),
    "project.part_without_target": mark("Every part of a target needs a shape, and has no parts of its own."),
    "project.part_nowhere": mark("A part has no place in its drawing: ({x}, {y})."),
    "project.grids_differ": mark(
        "All designs of a project must have the same grid, got {rows} x {columns} and {other_rows} x {other_columns}."
    ),
    "project.no_design_chosen": mark("No design is chosen in {path}. Open the project and choose one."),
    "project.no_such_design": mark(
        "There is no design with index {index!s:.40}; the project has {designs}, from 0 on."
    ),
    "project.marks_do_not_match": mark("Every design needs one mark: got {marks} for {designs} designs."),
    "project.labels_do_not_match": mark("Every design needs one name: got {labels} for {designs} designs."),
    "labels.not_a_code": mark("A design's own name is letters and a number, such as A1, got {value!r:.40}."),
    "labels.name_too_long": mark("The name has {letters} letters; the limit is {most}."),
    "labels.note_too_long": mark("The note has {letters} letters; the limit is {most}."),
    "labels.not_printable": mark("The name or note of design {code} has characters that cannot be shown."),
    "labels.taken": mark("Another design is already called {name}."),
    "project.no_such_void": mark(
        "Void ({row}, {column}) cannot be locked: it is outside of the designs' {rows} x {columns} voids."
    ),
    "history.no_such_step": mark("There is no step {position} in the history; the last one is {last}."),
    # Settings
    "settings.grid_not_two_numbers": mark("A grid is two whole numbers (rows, columns), got {value!r:.60}."),
    "settings.does_not_fit": mark("{name} cannot be {value!r:.40}; the command line's help says what it can be."),
    "settings.no_such_choice": mark("There is no {name} {value!r:.40}. Choose one of {choices}."),
    "settings.variant_not_a_name": mark("The generator variant must be a name, got {value!r:.40}."),
    "project.no_such_second_target": mark("Second target {number} is not among the {targets} that the project has."),
    "settings.sheet_width": mark("The sheet's width must be above 0 and at most {most:g} mm, got {value!r:.40}."),
    "settings.opened_size": mark(
        "The size of the opened shape must be above 0 and at most {most:g} mm, got {value!r:.40}."
    ),
    "settings.material_not_a_name": mark("The material must be the name of a preset, got {value!r:.40}."),
    "settings.machine_not_a_name": mark("The machine must be the name of one, got {value!r:.40}."),
    "settings.profile_not_a_name": mark("The machine profile must be a name, got {value!r:.40}."),
    "settings.dxf_version_not_a_name": mark("There is no DXF version {value!r:.40}. Choose one of {choices}."),
    "settings.paper_not_a_name": mark("There is no paper {value!r:.40}. Choose one of {choices}."),
    "settings.engrave_not_true_or_false": mark("Engraving the name is on or off (true or false), got {value!r:.40}."),
    "settings.markers_not_true_or_false": mark("Connector markers are on or off (true or false), got {value!r:.40}."),
    "settings.connector_width": mark("The connector width must be above 0 and at most {most:g} mm, got {value!r:.40}."),
    "settings.length_out_of_range": mark("{name} must be from {least:g} to {most:g} mm, got {value!r:.40}."),
    "settings.ear_within_hole": mark(
        "An ear of {ear_mm:g} mm leaves no wall round a hole of {pin_mm:g} mm. Make the ear wider or the hole smaller."
    ),
    "settings.kerf_width": mark("The kerf must be from 0 to {most:g} mm, got {value!r:.40}."),
    # Project files
    "project.not_readable": mark("Cannot read the project {path}: {reason}. Check its name."),
    "project.not_a_file_name": mark("{path!r} is not a file name. Choose a .kiri file."),
    "project.file_too_large": mark("{path} is too large for a project (more than {limit} MB). Choose a .kiri file."),
    "project.damaged": mark("Cannot open {path}: the file is damaged. {reason} Try an earlier copy of the file."),
    "project.newer_format": mark(
        "Cannot open {path}: it was saved by a newer Kirigami Studio (format {version}; this one reads up to "
        "{current}). Update Kirigami Studio."
    ),
    "project.format_too_old": mark(
        "Cannot open {path}: its format {version} is older than anything this Kirigami Studio can read."
    ),
    "project.not_a_zip": mark("It is not a project file, or part of it is missing ({reason:.80})."),
    "project.too_many_members": mark("It contains {members} members; projects have at most {limit}."),
    "project.foreign_compression": mark("Its member {name:.40} is compressed in a way that projects do not use."),
    "project.content_too_large": mark("It unpacks to more than {limit} MB; projects are smaller."),
    "project.member_missing": mark("Its member {name} is missing."),
    "project.not_a_manifest": mark("Its member {name} does not describe a project."),
    "project.not_a_connector_number": mark("{value!r:.60} is not the number of a connector."),
    "project.not_a_connector_with_width": mark("{value!r:.60} is not the number of a connector with its width."),
    "project.not_a_connector_width": mark("{value!r:.60} is not the width of a connector."),
    "project.not_a_void": mark("{value!r:.60} is not the row and column of a void."),
    "project.guide_too_far": mark("Guides of the drawing board lie within {limit:g} mm of its middle."),
    "project.too_many_guides": mark("A drawing board has at most {limit} guides along one axis."),
    "project.no_such_run": mark("A design belongs to run {number}, but the number of runs in the file is {runs}."),
    "project.array_not_readable": mark("Its member {name} is not a NumPy array file ({reason:.80})."),
    "project.array_of_wrong_shape": mark(
        "Its member {name} must hold one table of numbers for each of {designs} designs, got an array of shape "
        "{shape!s:.60} and type {dtype:.40}."
    ),
    "project.array_of_wrong_size": mark("Its member {name} should hold {bytes} bytes of ratios, got {found}."),
    # JSON inside project files
    "json.not_readable": mark("{place} is not valid JSON ({reason:.80})."),
    "json.not_an_object": mark("{place} must be a JSON object."),
    "json.entry_missing": mark("{place} has no entry '{name}'."),
    "json.not_a_number": mark("{place} must be a number, got {value!r:.60}."),
    "json.not_a_whole_number": mark("{place} must be a whole number, got {value!r:.60}."),
    "json.not_true_or_false": mark("{place} must be true or false, got {value!r:.60}."),
    "json.not_a_text": mark("{place} must be text, got {value!r:.60}."),
    "json.not_a_list": mark("{place} must be a list, got {value!r:.60}."),
    "json.not_a_table_of_texts": mark("{place} must be a table of texts, got {value!r:.60}."),
    "json.not_two_numbers": mark("{place} must be two numbers, got {value!r:.60}."),
    "json.not_two_whole_numbers": mark("{place} must be two whole numbers, got {value!r:.60}."),
    "json.not_whole_numbers": mark("{place} must be a list of whole numbers."),
    "json.not_all_true_or_false": mark("{place} must be a list of true and false."),
    "json.not_a_table_of_numbers": mark("{place} must be a table of numbers."),
    "json.not_a_choice": mark("{value!r:.60} is none of {choices}."),
    # The picture that a target was traced from
    "picture.not_a_picture_name": mark("{name!r:.60} is not the name of a picture ({extensions})."),
    "picture.too_large": mark("{name} has {megabytes:.0f} MB; projects store pictures of at most {limit} MB."),
    "picture.impossible_number": mark("The picture {name:.60} has an impossible threshold, scale or size."),
    "artwork.left_out": mark("The artwork in this project cannot be read and was left out. {reason}"),
    "picture.left_out": mark("The picture in this project cannot be read and was left out. {reason}"),
    # Preferences, recent files, recovery files
    "preferences.not_a_name": mark("The preference {name} must be a name, got {value!r:.40}."),
    "preferences.not_true_or_false": mark("The preference {name} must be true or false, got {value!r:.40}."),
    "preferences.unknown_choice": mark("The preference {name} must be one of {choices}, got {value!r:.40}."),
    "preferences.not_a_length": mark("A length among the preferences cannot be used: {reason:.120}"),
    "preferences.not_readable": mark(
        "Cannot read the preferences in {path}: {reason:.80}. Correct or delete the file."
    ),
    "preferences.unknown_entries": mark("The preferences in {path} have unknown entries: {names:.80}. Remove them."),
    "recent.not_paths": mark("In the list of recent files, {name} must be paths, got {value!r:.60}."),
    "recent.not_readable": mark("Cannot read the list of recent files {path}: {reason:.80}. Delete the file."),
    "recent.unknown_entries": mark("The list of recent files {path} has unknown entries: {names:.80}. Remove them."),
    "recovery.not_readable": mark("Cannot read the recovery file {path}: {reason}."),
    "recovery.damaged": mark("The recovery file {path} is damaged ({reason:.80})."),
    "recovery.no_time_zone": mark("{name} does not name a time zone."),
}
