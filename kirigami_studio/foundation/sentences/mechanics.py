"""Sentences of ``mechanics``, by the code of the problem.

Panels, ligaments and contacts are named by their numbers, counted from 0 as in the arrays that a network is made of.
"""

from __future__ import annotations

from kirigami_studio.foundation.words import mark

SENTENCES: dict[str, str | tuple[str, str]] = {
    # Networks
    "network.too_small": mark(
        "A network needs at least 2 panels and 1 ligament, got {panels} panels and {ligaments} ligaments."
    ),
    "network.wrong_shape": mark("The array '{name}' must have shape {wanted}, got {found}."),
    "network.not_numbers": mark("The array '{name}' must hold numbers."),
    "network.not_finite": mark("The array '{name}' holds a value at {at} that is not a finite number."),
    "network.stiffness_not_positive": mark("The stiffness '{name}' of ligament {at} must be above 0, got {value:g}."),
    "network.panels_touch": mark(
        "The void angle of contact {contact} is {angle_deg:.4g} degrees at rest. Panels must not touch at rest: give "
        "an angle above 0, and no more than a full turn."
    ),
    "network.size_out_of_range": mark(
        "Coordinates must be within {largest_mm:g} mm, and panels farther apart than {smallest_mm:g} mm. Check the "
        "unit."
    ),
    "network.number_out_of_range": mark("A ligament or contact names number {number}, but the last one is {last}."),
    "network.joins_itself": mark("Ligament {ligament} joins panel {panel} to itself. Join two different panels."),
    "network.slender_without_length": mark(
        "Ligament {ligament} is slender, but its two ends coincide. Make it a T-junction or move its ends apart."
    ),
    "network.not_connected": mark(
        "The panels do not hang together: there are {count} parts, and panel {panel} is not joined to panel 0. Add "
        "ligaments between the parts."
    ),
    # Files of networks
    "network_file.not_found": mark("There is no file {path}. Check the path."),
    "network_file.not_readable": mark("Cannot read {path} as an .npz archive of arrays."),
    "network_file.too_large": mark("{path} is larger than {limit} MiB. Networks of panels are smaller."),
    "network_file.array_missing": mark("{path} has no array '{name}', only: {found:.80}."),
    "network_file.too_many_panels": mark("The network has {found} panels. At most {most} are read."),
    "network_file.bonds_not_corners": mark(
        "The array 'bonds' of {path} must hold whole numbers: panel A, corner of A (0 to 3), panel B, corner of B."
    ),
    # Drives
    "drive.wrong_shape": mark("A drive of {steps} steps cannot have values of shape {found}."),
    "drive.not_finite": mark("A drive holds values that are not finite numbers."),
    "drive.prescribed_twice": mark("A drive prescribes one degree of freedom twice. Name every panel once."),
    "drive.network_adrift": mark(
        "The drive prescribes {found} degrees of freedom, so the network can drift away. Hold at least 3."
    ),
    "drive.too_few_steps": mark("A drive needs at least {least} steps, got {found}."),
    "drive.unknown_panel": mark("There is no panel {panel}: the last one is {last}."),
    "drive.nothing_moves": mark("The drive moves nothing. Name a panel to move, and where to."),
    "drive.no_grips": mark("Name at least one panel to hold and one to move."),
    "drive.ends_meet": mark("The network is a single row in that direction, so its two ends are the same panels."),
    # Equilibria
    "equilibrium.not_found": mark(
        "No equilibrium was found at step {step} of the drive (displacement {displacement:.4g}): the panels run into "
        "each other, or the ligaments are torn far apart. Drive the network less far."
    ),
    "equilibrium.singular": mark(
        "The network has a part that nothing holds, so it has no equilibrium. Check stiffnesses and ligaments."
    ),
    # Sheets
    "sheet.constant_not_positive": mark("The sheet's {name} must be a number above 0, got {value}."),
    "sheet.no_junction": mark("No two panels hang together at node {node}. Name nodes inside the sheet."),
    "sheet.widths_wrong": mark(
        "Connector widths must be {count} numbers of 0 mm or more, one for each connector; got shape {found}."
    ),
    "sheet.centres_wrong": mark(
        "Rotation centres must be {count} places in mm, or {count} pairs of places; got shape {found}."
    ),
    # Sheets as cut
    "as_cut.jams_stretched": mark(
        "As cut, the sheet jams at {jam_deg:.0f} degrees and does not come to {phi_deg:.0f}: a connector would be "
        "stretched by {stretch:.1f} of its width."
    ),
    "as_cut.jams_touching": mark(
        "As cut, the sheet jams at {jam_deg:.0f} degrees and does not come to {phi_deg:.0f}: panels run into each "
        "other."
    ),
    "as_cut.jams_while_flat": mark(
        "As cut, the sheet jams at {jam_deg:.0f} degrees instead of {phi_deg:.0f}, {opened_percent:.0f} % of its way. "
        "It is thin and may pass by bending out of the plane."
    ),
    "as_cut.hardly_opens": mark(
        "As cut, the sheet jams at {jam_deg:.0f} degrees instead of {phi_deg:.0f}, {opened_percent:.0f} % of its way. "
        "Thin sheet may bend past a jam only beyond {least_percent:.0f} %."
    ),
    "as_cut.nearly": mark("As cut, the sheet comes to {jam_deg:.0f} degrees instead of {phi_deg:.0f}."),
    "as_cut.file_jams": mark(
        "The connectors read from {name:.80} lie where the sheet would jam, although the planned ones close."
    ),
    "as_cut.loses_match": mark(
        "As cut, it matches the target by {match_percent:.0f} % instead of {designed_percent:.0f} %."
    ),
    "as_cut.does_not_match": mark(
        "As cut, it matches the target by {match_percent:.0f} % instead of {designed_percent:.0f} %. Below "
        "{least_percent:.0f} % it is another shape."
    ),
    "as_cut.breaks": mark(
        "A connector is expected to break: it is strained by {strain_percent:.0f} %, and {material!r} breaks at "
        "{limit_percent:g} %. {why}"
    ),
    "as_cut.survives": mark(
        "Connectors are strained by {strain_percent:.0f} % at most; {material!r} breaks at {limit_percent:g} %. {why}"
    ),
    "as_cut.stays_bent": mark(
        "Connectors stay bent: they are strained by up to {strain_percent:.0f} %, {material!r} yields at "
        "{yield_percent:g} % and breaks at {limit_percent:g} %. {why}"
    ),
    "as_cut.not_known": mark("The sheet could not be closed as cut, in simulation: {reason}"),
    # The command
    "mechanics.one_source": mark("Name either a project or sheet, or a network with --network."),
    "mechanics.one_sheet": mark("{name} holds {found} sheets. Name a single one."),
    "mechanics.no_design_chosen": mark("No design is chosen in {path}. Choose one in the window and save."),
    "mechanics.end_angle": mark("A sheet is closed to an angle below 180 degrees, the flat sheet; got {angle:g}."),
    "mechanics.hold_and_move": mark("Use --hold and --move together: what is held, and what is led along the path."),
    "mechanics.constant_missing": mark("A network needs {option}. Give --ka, --ks (N/m) and --kt (N m)."),
    "mechanics.unknown_drive": mark(
        "There is no drive '{text:.40}'. Use morpher, or clamped:AXIS:MM with AXIS x, y, xy or yx, such as "
        "clamped:y:1.05."
    ),
    "verdict.not_made": mark("The sheet could not be judged: {reason}"),
}
