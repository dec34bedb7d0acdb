"""Sentences about designs on their way: fields, scores, fits, runs and models."""

from __future__ import annotations

from kirigami_studio.foundation.words import mark, mark_n

SENTENCES: dict[str, str | tuple[str, str]] = {
    # lattice
    "grid.not_whole_numbers": mark("The grid must be two whole numbers of voids, got {rows!r:.40} x {columns!r:.40}."),
    "grid.out_of_range": mark("The grid must have {least} to {most} voids each way, got {rows} x {columns}."),
    "symmetry.not_on_grid": mark(
        "Sheets of {rows} x {columns} voids cannot have the symmetry {symmetry}. A mirror needs odd rows or odd "
        "columns, a half turn rows and columns that are both even or both odd, a quarter turn a square grid with "
        "even rows."
    ),
    "ratios.not_numbers": mark("Ratios must be an (m, n) table of numbers."),
    "ratios.wrong_shape": mark("Ratios must have shape (m, n), got {shape}."),
    "ratios.wrong_batch_shape": mark("Ratios must have shape (B, {rows}, {columns}), got {shape}."),
    "ratio.not_finite": mark("The ratio at void ({row}, {column}) is {ratio}; it must be finite."),
    "ratio.not_positive": mark("The ratio at void ({row}, {column}) is {ratio:g}; it must be above 0."),
    "ratio.out_of_range": mark(
        "The ratio at void ({row}, {column}) is {ratio:g}; it must be {least:g} to {most:g}, where the layout is exact."
    ),
    "angle.not_a_number": mark("The deployment angle must be a number in radians, got {phi!r:.80}."),
    "angle.out_of_range": mark("The deployment angle must be 0 to pi radians (pi is the compact sheet), got {phi:g}."),
    "second_target.angle_out_of_range": mark(
        "A second target needs an angle between 0 and pi radians, got {phi:g}. The flat sheet's own outline is its "
        "start: give that instead."
    ),
    "second_target.not_named": mark("Name the second target that the angle and the weight are for: --also TARGET."),
    "second_target.not_on_the_way": mark(
        "The sheet is not at {second:.1f} degrees on its way from flat to {first:.1f} degrees. Ask for the second "
        "target at a larger angle."
    ),
    "second_target.weight_out_of_range": mark(
        "The weight of a second target must be above 0 and at most {most:g}, got {weight:g}."
    ),
    "porosity.not_a_share": mark("A porosity must be a share from 0 to below 1, got {value!r:.40}."),
    "porosity.never_so_open": mark(
        "Voids are never {wanted:.1%} of this sheet's area: at most {largest:.1%}, at 90 degrees. Ask for less, or use "
        "a sheet whose panels are closer to squares."
    ),
    "rim.not_numbers": mark("The rim's {side} side must be a list of finite numbers: positions of mouths in cells."),
    "rim.hinges_not_numbers": mark(
        "The rim's hinges must be a list of finite numbers: how far edge hinges are from halfway between two mouths."
    ),
    "rim.wrong_hinges": mark(
        "Edge hinges on the rim: {got}; a sheet of {rows} x {columns} voids needs {wanted}, or none named."
    ),
    "rim.hinge_too_far": mark(
        "Edge hinges must lie at most {farthest:g} of the way between two mouths from its middle."
    ),
    "rim.not_four_sides": mark('A rim must be {{"top": [...], "right": [...], "bottom": [...], "left": [...]}}.'),
    "rim.wrong_count": mark(
        "Mouths on the rim's {side} side: {got}; a sheet of {rows} x {columns} voids needs {wanted} there."
    ),
    "rim.wrong_batch_shape": mark("Rim offsets must have shape (B, {mouths}), got {shape}."),
    "rim.not_in_order": mark(
        "Mouths on the rim's {side} side must lie between 0 and {length:g} cells, in rising order and at least "
        "{least:g} cells apart."
    ),
    "start.few_corners": mark(
        "The flat sheet is a rectangle: the shape needs no other corners, and is expected to match {percent:.0f} %."
    ),
    "start.rectangle_tried": mark(
        "The flat sheet is a rectangle: of {count} starts that were tried none is clearly better."
    ),
    "start.other_tried": mark(
        "The flat sheet is '{name}', the best of {count} starts that were tried: the shape needs {sides} sides."
    ),
    "start.not_points": mark("A start outline must be a list of at least three points [x, y] with finite numbers."),
    "start.crosses_itself": mark("The start outline crosses itself or has no area. Use one simple closed shape."),
    "start.not_convex": mark(
        "The start outline is not convex enough: {percent:.0f} % of its hull is missing. Use a shape with smaller "
        "hollows."
    ),
    "start.folds": mark(
        "No sheet of {rows} x {columns} voids was found that has this start: panels fold over around its hollow, "
        "deepest at {across:.0f} % of its width from the left and {up:.0f} % of its height from below. Fill it, or use "
        "another grid."
    ),
    "start.too_many_points": mark("A start outline has at most {most} points, got {count}. Simplify it."),
    "start.size_out_of_range": mark(
        "A start outline must be {least:g} to {most:g} cells across, got {width:g} x {height:g}. Scale it."
    ),
    "start.wrong_numbers": mark(
        "Got the start '{text:.60}'. Give rectangle:W:H or ellipse:W:H with sides that differ by at most {longest:g} "
        "times, as in ellipse:3:2, or polygon:N with 3 to {most} sides."
    ),
    "start.weight_out_of_range": mark(
        "Got a weight of {weight:g} for the start. Give one above 0 and up to {most:g}; 1 holds the start firmly."
    ),
    "start.too_long": mark(
        "The start '{name:.60}' is {length:.3g} times as long as wide, and a sheet may be {longest:g} times as long. "
        "Use a shape that is less long."
    ),
    "start.hollow": mark(
        "The start '{name:.60}' is hollow: {percent:.0f} % of its hull is missing, deepest at {across:.0f} % of its "
        "width from the left and {up:.0f} % of its height from below. Fill the hollow, or start from another shape."
    ),
    "start.too_far_away": mark("A start outline must lie within {most:g} cells of the origin. Move it there."),
    "cell.not_positive": mark("A cell needs a width and a height above 0, got {cell!r:.80}."),
    "cell.out_of_range": mark(
        "A cell's width and height must be {least:g} to {most:g} times the unit cell's, got {width:g} x {height:g}."
    ),
    # evaluate
    "silhouette.not_a_table": mark("A silhouette must be a table of numbers, one x, y pair per row."),
    "silhouette.too_few_points": mark(
        "A silhouette needs at least three points, one x, y pair per row; got an array of shape {shape}."
    ),
    "silhouette.not_finite": mark("Point {point} of the silhouette is ({x}, {y}); its coordinates must be finite."),
    "silhouette.no_area": mark("The silhouette has no area: its points lie on one line, or its parts cancel out."),
    "siou.mask_too_thin": mark("Mask {number} shows only lines thinner than 1/{size} of its length. Draw them bolder."),
    "siou.mask_ragged": mark("Mask {number} must be a 2-D array of numbers; its rows have different lengths."),
    "siou.mask_not_a_table": mark("Mask {number} must be a 2-D array of numbers, got shape {shape} of type {kind}."),
    "siou.mask_not_finite": mark("Mask {number} holds {value} at row {row}, column {column}; use 0 and 1."),
    "siou.mask_empty": mark("Mask {number} is empty: none of its {rows} x {columns} pixels is foreground."),
    "raster.size_out_of_range": mark("The mask size must be a whole number from 2 to {most} pixels, got {size!r:.80}."),
    "opened_size.width_not_positive": mark("The width of the sheet must be above 0 mm, got {width_mm:g}."),
    "similarity.not_finite": mark(
        "A similarity needs a positive scale and finite numbers, got scale {scale:g}, angle {angle:g}, shift "
        "({x:g}, {y:g})."
    ),
    "trim.crosses_itself": mark(
        "This design crosses itself at the target angle, so it cannot be trimmed. Choose another design."
    ),
    "trim.hole_too_small": mark_n(
        "{count} of {total} holes stays closed, for it is smaller than the panels at x = {x:.1f}, y = {y:.1f} mm. "
        "Choose more rows and columns, or fill it.",
        "{count} of {total} holes stay closed, for they are smaller than the panels there, as at x = {x:.1f}, "
        "y = {y:.1f} mm. Choose more rows and columns, or fill them.",
    ),
    "trim.hole_holds_sheet": mark_n(
        "{count} of {total} holes stays closed, for the sheet would fall apart there, near x = {x:.1f}, "
        "y = {y:.1f} mm. Choose more rows and columns, make it smaller, or fill it.",
        "{count} of {total} holes stay closed, for the sheet would fall apart there, as near x = {x:.1f}, "
        "y = {y:.1f} mm. Choose more rows and columns, make them smaller, or fill them.",
    ),
    "trim.nothing_left": mark("No part of the sheet lies mostly on the target. Lay the sheet over the target first."),
    "trim.keep_out_of_range": mark(
        "The material kept at hinges must be {least:g} to {most:g} cells deep, got {keep!r:.80}."
    ),
    # polish
    "drag.no_such_vertex": mark("The outline has vertices 0 to {last}, got {vertex}."),
    "fit.angle_compact": mark(
        "A fit needs an angle below pi radians: at pi the sheet is compact and shows a rectangle whatever its ratios."
    ),
    "fit.excess_out_of_range": mark("The weight of what sticks out must be a number from 0 to 1, got {excess!r:.80}."),
    "fit.least_panel_out_of_range": mark("The least panel size must be 0 to {most:g} cells, got {least!r:.80}."),
    "fit.least_gap_out_of_range": mark("The least distance of pins must be 0 to {most:g} cells, got {gap!r:.80}."),
    "grid.coarsest_expected": mark(
        "{rows} x {columns}: as coarse as the shape allows. Expected match: {percent:.1f} %."
    ),
    "grid.coarsest_with_mirror_axis": mark(
        "{rows} x {columns}: as coarse as the shape allows, with odd columns for its mirror axis. "
        "Expected match: {percent:.1f} %."
    ),
    "grid.coarsest_with_two_mirror_axes": mark(
        "{rows} x {columns}: as coarse as the shape allows, with odd rows and columns for its two mirror axes. "
        "Expected match: {percent:.1f} %."
    ),
    "grid.coarsest_with_turn": mark(
        "{rows} x {columns}: as coarse as the shape allows, with rows and columns that keep its turn. "
        "Expected match: {percent:.1f} %."
    ),
    "grid.best_expected": mark(
        "{rows} x {columns}: finer grids are not expected to match much better. Expected match: {percent:.1f} %."
    ),
    "grid.best_tried": mark(
        "{rows} x {columns}: matched best in short fits on {count} grids. Expected match: {percent:.1f} %."
    ),
    "grid.finer_tried": mark(
        "{rows} x {columns}: in short fits on {count} grids, coarser ones matched noticeably less. "
        "Expected match: {percent:.1f} %."
    ),
    "grid.finer_for_holes": mark(
        "{rows} x {columns}: finer than the outline needs, so that holes and the walls beside them are no smaller than "
        "panels allow. Expected match: {percent:.1f} %."
    ),
    "grid.smaller_pieces": mark("{rows} x {columns}: larger pieces on pins show less of the shape."),
    "grid.panels_would_be_too_small": mark(
        "{rows} x {columns}: on a finer grid, panels of a sheet {width_mm:.0f} mm wide would be smaller than "
        "{least_mm:.2g} mm. Expected match: {percent:.1f} %."
    ),
    "grid.pins_would_be_too_near": mark(
        "{rows} x {columns}: on a finer grid, pins of a sheet {width_mm:.0f} mm wide would come nearer than "
        "{least_mm:.2g} mm. Expected match: {percent:.1f} %."
    ),
    "fit.locks_and_symmetry": mark(
        "A fit cannot keep locked voids and a symmetry at the same time. Choose one of them."
    ),
    "fit.locks_wrong_table": mark(
        "Locked voids must be a table of truth values of shape {shape}, got {got} of type {kind}."
    ),
    "fit.steps_not_whole": mark("The number of steps must be a whole number of at least 0, got {steps!r:.80}."),
    "fit.trust_not_positive": mark("The trusted distance must be a finite number above 0, got {trust:g}."),
    "fit.weights_out_of_range": mark(
        "The weights of a fit must be finite numbers of at least 0, got {start:g} for the start, {smooth:g} "
        "for smoothness and {total_variation:g} for total variation."
    ),
    "search.effort_out_of_range": mark(
        "The search effort must be a whole number from 1 to {most}, got {effort!r:.80}."
    ),
    # generator
    "model.unet_channels": mark(
        "The U-Net needs even numbers of at least 4 as channels, one for each level, got {channels}."
    ),
    "model.unet_levels": mark(
        "A U-Net of {levels} levels cannot halve {latent} pixels {halvings} times, or its mask of {mask} "
        "pixels is not a multiple of {latent}. Give it fewer levels."
    ),
    "model.unknown_backbone": mark(
        "This version does not know the network '{backbone:.40}' of these weights. Install the latest version of "
        "Kirigami Studio."
    ),
    "model.weights_missing": mark(
        "The weights {file} of the model '{variant:.40}' are missing. Install Kirigami Studio again."
    ),
    "model.weights_damaged": mark(
        "The weights {file} are damaged (checksum {found}, expected {expected}). Install Kirigami Studio again."
    ),
    "model.weights_do_not_fit": mark(
        "The weights {file} do not fit the network that their list describes. Install Kirigami Studio again."
    ),
    "model.weights_not_finite": mark(
        "The weights {file} hold numbers that are not finite. Install Kirigami Studio again, or train them anew."
    ),
    "model.weights_not_listed": mark(
        "The list of models in {folder} does not name {file}. Choose a file that training wrote."
    ),
    "model.list_unreadable": mark("Cannot read the list of models in {folder}. Install Kirigami Studio again."),
    "model.list_of_other_format": mark(
        "The list of models in {folder} has a format that this version cannot read. Install the latest "
        "version of Kirigami Studio."
    ),
    "model.unknown_variant": mark("There is no generator variant '{variant:.40}'. Choose one of {choices}."),
    # pipeline
    "covers.better": mark(
        "Closed sheets match by {closed:.1f} % at most; with parts cut away {cover:.1f} %, {given_up:.0f} % of the "
        "sheet."
    ),
    "covers.many_arms": mark(
        "No closed sheet of {sides:.0f} sides shows so many arms: {closed:.1f} % is the most found; with notches "
        "{cover:.1f} %, {given_up:.0f} % of the sheet cut away."
    ),
    "covers.turns_back_ahead": mark(
        "No closed sheet shows the notch at {across:.0f} % of the width and {up:.0f} % of the height, where the "
        "outline turns back by {degrees:.0f} degrees: a run also makes "
        "sheets with notches cut out."
    ),
    "covers.turns_back_closed": mark(
        "No closed sheet shows the notch at {across:.0f} % of the width and {up:.0f} % of the height, where the "
        "outline turns back by {degrees:.0f} degrees: {closed:.1f} % is the most found."
    ),
    "covers.turns_back_cover": mark(
        "No closed sheet shows the notch at {across:.0f} % of the width and {up:.0f} % of the height, where the "
        "outline turns back by {degrees:.0f} degrees: with notches "
        "{cover:.1f} %, {given_up:.0f} % of the sheet cut away."
    ),
    "covers.many_arms_ahead": mark(
        "No closed sheet of {sides:.0f} sides shows so many arms: a run also makes sheets with notches cut out."
    ),
    "covers.many_arms_closed": mark(
        "No closed sheet of {sides:.0f} sides shows so many arms: {closed:.1f} % is the most found."
    ),
    "covers.many_arms_cover": mark(
        "No closed sheet of {sides:.0f} sides shows so many arms: with notches {cover:.1f} %, "
        "{given_up:.0f} % of the sheet cut away."
    ),
    "covers.turns_back": mark(
        "No closed sheet shows the notch at {across:.0f} % of the width and {up:.0f} % of the height, where the "
        "outline turns back by {degrees:.0f} degrees: {closed:.1f} % is the most found; with notches {cover:.1f} %, "
        "{given_up:.0f} % of the sheet cut away."
    ),
    "fit.stopped": mark("Fitting stopped; nothing changed."),
    "rank.best_balance": mark("Best balance: match {match:.1f} %, panel sizes vary by {variation:.0f} %."),
    "rank.best_balance_symmetric": mark(
        "Best balance: match {match:.1f} %, panel sizes vary by {variation:.0f} %, symmetric."
    ),
    "rank.best_match": mark("Best match: {match:.1f} %, panel sizes vary by {variation:.0f} %."),
    "rank.best_match_symmetric": mark("Best match: {match:.1f} %, panel sizes vary by {variation:.0f} %, symmetric."),
    "rank.best_balance_trimmed": mark(
        "Best balance: match once trimmed {match:.1f} %, panel sizes vary by {variation:.0f} %."
    ),
    "rank.best_trimmed": mark("Best match once trimmed: {match:.1f} %."),
    "rank.best_of_both": mark(
        "Best of both targets: match {match:.1f} %, and {second:.1f} % with the second one at {angle:.0f} degrees."
    ),
    "rank.equal": mark("As good as the first design."),
    "rank.gives_up": mark("It cuts {own:.0f} % of the sheet away, the first design {first:.0f} %."),
    "rank.jams": mark("As cut, it is estimated to jam at {own:.0f} degrees."),
    "rank.less_as_cut": mark(
        "As cut, it loses {own:.2f} % of its match and by stretched connectors, the first design {first:.2f} %."
    ),
    "rank.less_even": mark("Panel sizes vary by {own:.0f} %, in the first design by {first:.0f} %."),
    "rank.less_match": mark("It matches {own:.1f} %, the first design {first:.1f} %."),
    "rank.less_second": mark("It matches the second target {own:.1f} %, the first design {first:.1f} %."),
    "rank.less_trimmed_match": mark("Trimmed, it matches {match:.1f} %, the first design {first:.1f} %."),
    "rank.more_at_limit": mark("Ratios at a limit: {own:.0f} %, in the first design {first:.0f} %."),
    "rank.not_feasible": mark("Panels touch, overlap or collapse before the sheet reaches its angle."),
    "rank.not_looked_at": mark_n(
        "Not looked at closely: {count} design before it cannot be cut.",
        "Not looked at closely: {count} designs before it cannot be cut.",
    ),
    "rank.not_symmetric": mark("The first design is symmetric, this one is not."),
    "rank.not_trimmed": mark("It is not trimmed."),
    "rank.notch_cut_out": mark_n(
        "Match {match:.1f} %, gives up {percent:.0f} % of the sheet: it covers the notches, and they are cut out of it "
        "with {count} panel.",
        "Match {match:.1f} %, gives up {percent:.0f} % of the sheet: it covers the notches, and they are cut out of it "
        "with {count} panels.",
    ),
    "rank.holes_cut_out": mark_n(
        "Match once trimmed: {match:.1f} %. The sheet covers its holes; they are cut out of it with {count} panel.",
        "Match once trimmed: {match:.1f} %. The sheet covers its holes; they are cut out of it with {count} panels.",
    ),
    "rank.holes_filled": mark("Its holes stay filled, as no design with open ones can be cut: {why}"),
    "rank.holes_filled_there": mark(
        "Its holes stay filled, as no design with open ones can be cut, for a reason near x = {x:.1f}, y = {y:.1f} mm: "
        "{why}"
    ),
    "rank.pins_too_near": mark("Pins come as near as {gap_mm:.1f} mm; their ears need {least_mm:.1f} mm."),
    "rank.thinner": mark("Its narrowest panel measures {own:.2f} mm, in the first design {first:.2f} mm."),
    "rank.too_thin": mark("Its narrowest panel measures {smallest_mm:.2f} mm; the material needs {least_mm:.2f} mm."),
    "request.angle_out_of_range": mark(
        "The target angle must be at least 0 and below pi radians, got {value!r:.40}. The usual choice is 0."
    ),
    "request.budget_not_positive": mark(
        "The time budget must be a finite number of seconds above 0, got {value!r:.80}."
    ),
    "request.grid_not_chosen": mark(
        "No grid is chosen yet: the run does that when it starts. Name a grid, such as 10x11."
    ),
    "request.least_feature_out_of_range": mark(
        "The smallest panel that the material allows must be a number of at least 0 mm, got {value!r:.80}."
    ),
    "request.least_gap_out_of_range": mark(
        "The least distance of pins must be a number of at least 0 mm, got {value!r:.80}."
    ),
    "request.k_out_of_range": mark(
        "The number of candidates (k) must be a whole number from {least} to {most}, got {value!r:.80}."
    ),
    "request.near_other_grid": mark(
        "Samples near a design have its grid of {near_rows} x {near_columns} voids, not {rows} x {columns}."
    ),
    "request.nearness_out_of_range": mark("The nearness must be a number from 0 to less than 1, got {nearness!r:.80}."),
    "request.nearness_without_design": mark("A nearness needs the design that the samples should be near."),
    "request.polish_out_of_range": mark(
        "The number of polishing steps must be a whole number from {least} to {most}, got {value!r:.80}."
    ),
    "request.regular_out_of_range": mark(
        "The balance must be a number from 0 (the closest match) to 1 (even panels), got {regular!r:.80}."
    ),
    "request.search_out_of_range": mark(
        "The search effort must be a whole number from {least} to {most}, got {value!r:.80}."
    ),
    "request.seed_out_of_range": mark("The seed must be a whole number from {least} to {most}, got {value!r:.80}."),
    "request.steps_out_of_range": mark(
        "The number of sampling steps must be a whole number from {least} to {most}, got {value!r:.80}."
    ),
    "request.unknown_preference": mark("A fit can prefer {choices}, not {prefer!r:.80}."),
    "request.unknown_rim": mark("The rim can be {choices}, not {rim!r:.80}."),
    "request.unknown_symmetry": mark("The symmetry of designs can be {choices}, not {symmetry!r:.80}."),
    "request.width_not_positive": mark("The width of the sheet must be a number above 0 mm, got {width_mm!r:.80}."),
    "run.no_result": mark("The run ended without a result."),
    "run.stopped_polishing": mark("Stopped while polishing, with {done} of {total} done; nothing changed."),
    "run.stopped_scoring": mark("Stopped after {done} of {total} candidates; nothing changed."),
    "run.stopped_searching": mark("Stopped while searching, with {done} of {total} done; nothing changed."),
    "run.stopped_trimming": mark("Stopped while trimming, with {done} of {total} done; nothing changed."),
    "trim.connectors_too_wide": mark(
        "Connectors of {connector_mm:g} mm leave nothing to trim on a sheet {width_mm:g} mm wide. Make the "
        "sheet at least {least_mm} mm wide or the connectors narrower."
    ),
    "trim.stopped": mark("Trimming stopped; nothing changed."),
}
