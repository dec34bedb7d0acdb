"""Sentences of command line and window, and of files and folders that cannot be used."""

from __future__ import annotations

from kirigami_studio.foundation.words import mark

SENTENCES: dict[str, str | tuple[str, str]] = {
    # cli
    "option.angle_in_degrees": mark(
        "An angle of '{text:.40}' radians is more than a whole turn. For degrees write {text:.40}deg."
    ),
    "cli.interrupted": mark("Stopped. No file was left half written."),
    "cli.out_of_memory": mark("Not enough memory. Ask for fewer or smaller inputs."),
    "cli.file_not_usable": mark("Cannot read or write {path}: {reason}."),
    "cli.output_not_usable": mark("Cannot read or write the output: {reason}."),
    # Options
    "option.name_reads_as_code": mark(
        "The name {name} would be taken for another design's: choose one that is more than letters and a number."
    ),
    "option.grid": mark("A grid is written ROWSxCOLUMNS, for example 10x10; got '{text:.40}'."),
    "option.angle": mark("An angle is a number of radians (0.5, pi/3) or degrees (30deg); got '{text:.40}'."),
    "option.angle_divided_by_zero": mark("An angle cannot be divided by zero: '{text:.40}'."),
    "option.threshold": mark("The threshold must be between 0 and 1, got {value:g}."),
    # Python API
    "api.not_a_target": mark(
        "A target is a library name, a file, points (L, 2), a mask (H, W) or a Shapely polygon; got {value:.60}."
    ),
    "api.not_a_grid": mark("A grid is a pair (rows, columns) or 'auto'; got {value:.40}."),
    "api.not_a_number": mark("{name} must be a finite number; got {value:.40}."),
    "api.not_whole": mark("{name} must be a whole number; got {value:.40}."),
    "api.not_connector_widths": mark(
        "Widths of connectors are given by their numbers, as hinge_mm={{3: 0.8}}; got {value:.40}."
    ),
    "api.not_connectors": mark("Connectors are given by their numbers, as removed=[3, 7]; got {value:.40}."),
    "api.not_panels": mark("Panels are given by their numbers, as {name}=[0, 10]; got {value:.40}."),
    "api.package_missing": mark(
        "This needs the package {package}. Install it with pip install 'kirigami-studio[{extra}]'."
    ),
    "api.not_a_page_name": mark("A page to share is saved as a {suffix} file; got {path}."),
    "api.no_pieces_on_pins": mark(
        "A design of the construction {construction} has no pieces on pins: plan_cuts and export make its files."
    ),
    "api.not_a_project_name": mark("A project is saved as a {suffix} file; got {path}."),
    "api.no_such_name": mark("There is no design '{name:.40}'; there are {names:.80}."),
    "api.second_target_not_named": mark("Name the second target that the angle and the weight are for: also=TARGET."),
    # Inputs
    "input.not_valid": mark("{name}: {reason}"),
    "input.unknown_content": mark(
        "Standard input is of no kind that is read: drawing, picture, JSON file, array, project or cut file."
    ),
    "export.output_is_the_file": mark("With --out - standard output is the file: leave --json and --all out."),
    "export.several_files": mark("This design is made of several files. Name a folder for them with --out."),
    "mcp.outside_folder": mark("'{name:.80}' is not in the folder that is served. Name a file in it."),
    "mcp.wrong_extension": mark("'{name:.80}' has another extension than {kinds}."),
    "mcp.no_folder": mark("There is no folder {folder} to serve. Make it first."),
    "batch.some_inputs_failed": mark("{failed} of {total} inputs failed. The entry 'error' on their lines says why."),
    "ratios.none_in_folder": mark("The folder {folder} has no sheets (.json, .npy, .npz or .kiri)."),
    "ratios.unknown_extension": mark("Sheets are read from .json, .npy, .npz or .kiri files, got {name}."),
    "ratios.file_too_large": mark("{path} is larger than {limit} MB; sheets are smaller."),
    "ratios.not_readable": mark("Cannot read a sheet from {path}: {reason}."),
    "ratios.damaged": mark("Cannot read a sheet from {path}: the file is damaged or of another kind."),
    "ratios.not_a_table": mark('{name} must contain {{"ratio": [[...], ...]}}, the top row first.'),
    "mask.not_readable": mark(
        "Cannot read the mask image {name}: it is damaged or not an image. Save it again as PNG."
    ),
    "input.mask_not_finite": mark("The mask is not finite in row {row}, column {column}. Every pixel must be finite."),
    "archive.not_readable": mark("Cannot read {path}: it is missing, damaged or not an .npz archive."),
    "archive.too_large": mark("{path} is larger than {limit} MB. Split it."),
    "archive.array_missing": mark("{name} has no array named '{key}', only: {found:.80}."),
    "archive.not_numbers": mark(
        "The array '{key}' in {name} must be numbers of shape (N, rows, columns), got {dtype:.40} of shape "
        "{shape!s:.60}."
    ),
    "archive.no_entries": mark("The array '{key}' in {name} has no entries."),
    # Sub-commands
    "design.trimming_cut_short": mark("The budget ended before a design was trimmed, so none is. Allow more time."),
    "design.none_trimmed": mark(
        "No design could be trimmed, because all of them cross themselves, so none is. Try another seed."
    ),
    "design.other_is_cut": mark("The best design cannot be cut, so '{name}' is. {reason}"),
    "design.not_cut": mark("No design can be cut, so there is no cut file; {project} has the designs. {reason}"),
    "decode.other_grid": mark("{name} has {rows} x {columns} voids, not {grid}."),
    "score.nothing_to_score": mark("Name sheets and then a target: score SHEET [SHEET ...] TARGET."),
    "score.numbers_differ": mark(
        "Give as many sheets as targets, or one of either; got {sheets} sheets and {targets} targets."
    ),
    "export.cannot_be_cut": mark("{reason}"),
    "export.no_chosen_design": mark("This project has no chosen design. Generate designs and choose one first."),
    "export.no_such_connector": mark("There is no connector {number}: this sheet has connectors 0 to {last}."),
    "export.connector_and_width": mark(
        "--hinge-mm takes a connector and its width in mm, for example 3=0.8; got '{text}'."
    ),
    "picture.angle": mark("A sheet cannot be shown at {angle:g} degrees: 180 is flat, 0 fully turned."),
    "picture.none": mark("These choices are for pictures ({kinds}, or the whole set of --all), not for {path}."),
    "animate.not_a_gif": mark("animate writes .gif files, got {name}."),
    "licences.no_such_part": mark(
        "{part!r:.60} does not come with the program; kirigami-studio licences lists what does."
    ),
    "materials.copy_and_delete": mark("Either copy a material or delete one, not both."),
    "materials.options_without_copy": mark(
        "--as, --set and --calibrated need --copy KEY, which names the material to copy."
    ),
    "materials.calibrated_by_nobody": mark("--calibrated needs --by NAME: who measured the coupon."),
    "materials.not_name_and_value": mark("--set takes NAME=VALUE, for example kerf_mm=0.03; got '{entry:.60}'."),
    "machines.copy_and_delete": mark("Either copy a machine or delete one, not both."),
    "machines.options_without_copy": mark("--as and --set need --copy KEY, which names the machine to copy."),
    "coupon.nothing_to_do": mark("Give --out FILE to write a coupon, or --gap-mm with the gaps measured on one."),
    "coupon.unknown_extension": mark("A coupon is written as .dxf, .svg or .pdf, got {name}."),
    # gui
    "designs.none_chosen": mark("Choose a design first, then generate more like it."),
    "designs.none_to_add_to": mark("No designs to add to yet. Press Generate first."),
    "coupon.not_dxf": mark("Coupons are exported as .dxf, not {name}. The command line supports other types."),
    "export.stopped": mark("Export to {folder} stopped; files already written are kept."),
    # foundation
    "file.not_written": mark("Cannot write {path}: {reason}. Choose another folder or free some space."),
    "file.folder_in_use": mark(
        "Cannot write into {folder}: another export is writing there. Wait for it or choose another folder."
    ),
    "file.is_a_folder": mark("Cannot write {path}: it is a folder. Give a file name."),
    "file.not_a_file": mark("Cannot write {path}: it is a device, a pipe or a socket. Give the name of a file."),
    "file.link_to_nothing": mark(
        "Cannot write {path}: it is a link to {target}, which does not exist. Delete the link or choose another name."
    ),
    "file.link_in_circle": mark(
        "Cannot write {path}: the link leads back to itself. Delete it or choose another name."
    ),
    "file.folder_not_writable": mark("Cannot write to {folder}. Choose a folder where you have permission to write."),
    # Programs and processes
    "training.needs_python": mark(
        "This packaged program designs but does not train. Install the wheel of the same version for that."
    ),
    "cluster.package_missing": mark(
        "A cluster needs the package distributed. Install it with pip install 'kirigami-studio[cluster]', or leave out "
        "--scheduler."
    ),
    "cluster.no_answer": mark(
        "Nobody answers at {address} within {seconds:g} seconds. Start 'dask scheduler', or correct the address."
    ),
    "cluster.no_workers": mark(
        "The scheduler at {address} has no workers. Start some with 'dask worker {address} --nthreads 1'."
    ),
    "cluster.lost": mark(
        "The scheduler at {address} went away. Finished runs are kept: start it again, and repeat this call."
    ),
    "processes.work_ends_them": mark(
        "A process was ended from outside {times} times at one piece of work. If memory ran short, use fewer processes."
    ),
    "cluster.work_ends_workers": mark(
        "One piece of work ended several workers of {address}, one after the other. They may be short of memory."
    ),
}
