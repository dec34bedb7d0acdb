"""Sentences of ``outlines``, by the code of the problem: files, contours and drawings."""

from __future__ import annotations

from kirigami_studio.foundation.words import mark, mark_n

SENTENCES: dict[str, str | tuple[str, str]] = {
    # Sources of any kind
    "target.not_a_source": mark("A target is a file or the name of a library silhouette, got {value!r:.60}."),
    "target.folder": mark("{path} is a folder. Choose a file in it ({kinds})."),
    "target.not_a_file_name": mark("{name!r:.80} cannot be the name of a file. Choose another one."),
    "target.unknown_kind": mark("{name} is of an unknown kind. Choose a file of one of these kinds: {kinds}."),
    "target.folder_not_readable": mark(
        "Cannot read the folder {folder}. Check its name, and that you have permission to read it."
    ),
    "target.none_in_folder": mark("The folder {folder} has no target files ({kinds})."),
    "silhouette.unknown": mark(
        "There is no file and no library silhouette called {name!r:.80}. The library has {names}."
    ),
    "silhouette.unknown_but_near": mark(
        "There is no file and no library silhouette called {name!r:.80}. The nearest names are: {near}."
    ),
    "silhouette.damaged": mark("The bundled silhouette {path} is damaged. Install Kirigami Studio again."),
    "source.folder": mark("{path} is a folder. Choose a file in it."),
    "source.missing": mark("There is no file {path}. Check the name and the folder."),
    "source.not_readable": mark("Cannot read {path}: {reason}."),
    "source.empty": mark("{name} is empty. Save it again from the program that made it."),
    "source.too_large": mark("{path} has {megabytes:.1f} MB, more than {limit} MB. Save a simpler version of it."),
    "source.too_slow": mark(
        "The drawing takes longer than {seconds:.1f} s to read. Export only the outline, as a simpler drawing."
    ),
    "source.not_usable": mark("{name}: {reason}"),
    # JSON
    "source.json_damaged": mark("{name} is damaged or not a JSON outline ({reason:.100}). Save it again."),
    "json_outline.no_vertices": mark('The file has neither "outline": [[x, y], ...] nor "points": [[x, y], ...].'),
    "json_outline.not_finite": mark("The file contains {constant}; every coordinate must be a finite number."),
    "json_outline.not_a_list": mark("The outline must be a list of [x, y] pairs, got {value!r:.40}."),
    "json_outline.not_a_pair": mark("Vertex {number} must be a pair [x, y] of numbers, got {value!r:.40}."),
    # Pictures and masks
    "source.image_damaged": mark(
        "{name} is damaged or not a picture (PNG, JPG, BMP, WebP, TIFF, GIF or AVIF): {reason:.100}. Open it in the "
        "program that made it and save it again."
    ),
    "image.too_many_pixels": mark(
        "The picture has {width} x {height} pixels, more than {limit} million. Save it smaller."
    ),
    "image.far_too_many_pixels": mark("The picture has far too many pixels. Save it with at most 10000 x 10000."),
    "image.blank": mark(
        "The picture is blank: its grey levels differ by only {percent:.1f} %. Draw a dark shape on light paper."
    ),
    "image.one_colour": mark("At threshold {threshold:.2f} the picture is all one colour. Try another threshold."),
    "image.threshold": mark("The threshold must be between 0 (black) and 1 (white), got {value!r:.40}."),
    "object.no_place": mark("Say where the object is: at least one place on it."),
    "object.outside": mark("({x:g}, {y:g}) is outside the picture, which has {width} x {height} pixels."),
    "object.nothing_there": mark("There is only background at that place. Click on the object."),
    "object.no_picture": mark("'{source:.80}' is no picture. A place on the object is for pictures: {kinds}."),
    "object.not_a_place": mark("A place is two numbers, X,Y, in pixels from the upper left corner, got {value!r:.40}."),
    "mask.wrong_shape": mark("A mask must have shape (height, width), got {shape!s:.60}."),
    "mask.empty": mark("The mask is empty. It must be true inside the shape."),
    "trace.thinner_than_a_pixel": mark("The shape is thinner than a pixel. Use a larger or bolder picture."),
    "trace.specks": mark(
        "The picture has {specks} specks, and none of them is half of the whole. Use a cleaner picture or another "
        "threshold."
    ),
    "trace.too_few_pixels": mark(
        "The largest shape has only {pixels} pixels. Use a picture of at least 64 x 64 pixels."
    ),
    # SVG
    "source.svg_damaged": mark(
        "{name} is damaged or not an SVG drawing ({reason:.100}). Open it in the program that made it and save it "
        "again."
    ),
    "svg.compressed": mark("The file is compressed (SVGZ). Save it as plain SVG."),
    "svg.entities": mark(
        "The file declares XML entities that are no short plain texts, which are not read for safety. Save it as plain "
        "SVG."
    ),
    "svg.style_too_large": mark(
        "The style sheets of the drawing are too long or too complicated. Save it as plain SVG with attributes."
    ),
    "svg.linked_picture": mark(
        "The drawing shows a picture from another file ({link:.60}), which is not opened for safety. Embed it."
    ),
    "svg.picture_inside": mark(
        "The drawing holds a picture that is neither PNG, JPEG, GIF, BMP nor WebP. Embed it as PNG."
    ),
    "svg.not_well_formed": mark("The file is not well-formed SVG ({reason:.80}). Save it again as plain SVG."),
    "svg.other_root": mark("The file is XML but not SVG: its root is <{tag:.40}>. Save it as plain SVG."),
    "svg.inside_itself": mark("The drawing uses <{tag:.40}> inside itself. Save it as plain SVG."),
    "svg.too_many_elements": mark(
        "The drawing unfolds to {elements:.3g} elements, more than {limit}. Export only the outline."
    ),
    "svg.no_shape": mark("The drawing has no visible shape. Draw one filled shape."),
    "svg.no_shape_but_others": mark("The drawing has no visible shape. {left_out} Draw one filled shape."),
    "svg.number_too_long": mark("The drawing has a number of more than {limit} digits. Save it as plain SVG."),
    "svg.too_many_numbers": mark(
        "The paths of the drawing have more than {limit} numbers. Simplify them, or export only the outline."
    ),
    # PDF
    "source.pdf_damaged": mark(
        "{name} is damaged or not a PDF ({reason:.100}). Open it in the program that made it and save it again."
    ),
    "pdf.postscript": mark(
        "The file is PostScript without a PDF inside. Save it with PDF compatibility, or export it as PDF or SVG."
    ),
    "pdf.locked": mark("The PDF is locked by a password. Save it without one."),
    "pdf.unpacks": mark("The PDF unpacks to more than {limit} MB. Export only the outline."),
    "pdf.too_deep": mark("The PDF nests forms more than {limit} deep. Export only the outline."),
    # DXF
    "source.dxf_damaged": mark(
        "{name} is damaged or not a DXF drawing ({reason:.100}). Open it in the program that made it and save it again."
    ),
    "dxf.no_lines": mark(
        "The drawing has no lines in model space. Draw the contour with lines, arcs, polylines or splines."
    ),
    "dxf.no_lines_but_text": mark("The drawing has only text in model space. Convert the text to lines."),
    "dxf.only_regions": mark("The drawing has only regions or solids. Explode them into lines, and save it again."),
    "dxf.too_many_entities": mark("The drawing unfolds to more than {limit} entities. Export only the outline."),
    "dxf.blocks_too_deep": mark("The drawing nests blocks more than {limit} deep. Explode them and save it again."),
    "dxf.block_repeated": mark("A block is repeated {times} times. Export only the outline."),
    "dxf.no_length": mark("The lines of the drawing have no length. Draw one closed contour."),
    "dxf.one_point": mark("All lines of the drawing are in one point. Draw one closed contour."),
    # Parts of a drawing
    "parts.unknown": mark(
        "The file has no part and no layer called '{name:.60}'. It has {names:.300}. 'kirigami-studio parts FILE' "
        "lists them."
    ),
    "parts.none_chosen": mark("No part is chosen. Choose at least one."),
    "parts.no_area": mark(
        "The chosen parts enclose no area. Choose a closed one, or take strokes as they are painted, with a width."
    ),
    "parts.letters": mark(
        "The drawing is a text of {letters} letters that do not touch. Join them in the window, or with --parts all "
        "--join bridge."
    ),
    "parts.stroke_width": mark("A stroke must be {least:.3g} to {most:.3g} wide in this drawing, got {width:.3g}."),
    "parts.bridge_width": mark("A bridge must be {least:.3g} to {most:.3g} wide in this drawing, got {width:.3g}."),
    "parts.too_many_pieces": mark(
        "The chosen parts are {pieces} pieces, and at most {limit} can be bridged. Choose fewer, or a hull."
    ),
    "parts.too_many_sheets": mark(
        "The chosen parts are {pieces} pieces, and at most {limit} can be sheets of their own. Choose fewer, or join "
        "them."
    ),
    "parts.several_targets": mark(
        "The parts are {count} pieces, each a sheet of its own; this takes one shape. Join them by bridges, or choose "
        "one."
    ),
    "parts.each_on_cluster": mark(
        "A scheduler designs single targets: leave --scheduler out, or join the parts of each drawing."
    ),
    "parts.not_a_drawing": mark(
        "'{source:.80}' has no parts to choose from. Options about parts are for files: {kinds}."
    ),
    "parts.or_as_painted": mark("{reason} Or take the lines as painted: --stroke-outline."),
    "option.bridge_without_join": mark("--bridge is the width of bridges: use it with --join bridge, or alone."),
    "option.object_with_parts": mark("Say either where the object is or which parts are meant, not both."),
    "parts.tightness": mark("The tightness of a hull must be between 0 and 1, got {value!r:.40}."),
    # Drawings and loose lines
    "drawing.no_area": mark("The drawing encloses no area. Draw one closed shape."),
    "drawing.not_finite": mark("The drawing has coordinates that are not finite numbers. Draw those lines again."),
    "drawing.too_many_vertices": mark(
        "The lines of the drawing have {vertices} points, more than {limit}. Simplify them, or export only the outline."
    ),
    "drawing.joined_in_a_point": mark(
        "Two large pieces of the drawing meet only in the point near ({x:.4g}, {y:.4g}). Move the lines apart there or "
        "make the joint wider."
    ),
    "lines.none": mark("The drawing has no lines. Draw one closed contour."),
    "lines.not_closed": mark("The lines do not form a closed contour. Draw one closed line around the shape."),
    "lines.open_at": mark(
        "The contour is open: there is a gap of {width} near ({x:.4g}, {y:.4g}), and only gaps up to {closed} are "
        "closed automatically. Join the ends there."
    ),
    # Contours
    "contour.not_pairs": mark("A contour must be a list of [x, y] pairs of numbers."),
    "contour.wrong_shape": mark(
        "A contour must be a list of [x, y] pairs of numbers, got an array of shape {shape!s:.60}."
    ),
    "contour.too_few_vertices": mark("A contour needs at least 3 vertices, got {vertices}."),
    "contour.too_few_different": mark("A contour needs at least 3 different vertices, got {vertices}."),
    "contour.too_many_vertices": mark(
        "The contour has {vertices} vertices, more than {limit}. Simplify it and try again."
    ),
    "contour.not_finite": mark(
        "Vertex {number} of the contour is ({x:g}, {y:g}); every coordinate must be a finite number."
    ),
    "contour.extreme_size": mark(
        "The contour's coordinates reach {largest:.3g} over a width of {span:.3g}. Scale the drawing to an ordinary "
        "size."
    ),
    "contour.one_point": mark("All vertices of the contour are in one point. Draw a closed shape with an area."),
    "contour.no_area": mark(
        "The contour encloses almost no area ({area:.3g} at a length of {length:.3g}). Draw a closed shape, not a line."
    ),
    "contour.runs_back": mark(
        "The contour runs back over itself and encloses no area. Draw a closed shape, not a line."
    ),
    "contour.too_many_crossings": mark(
        "The contour crosses itself at more than {limit} places. Draw one line around the shape."
    ),
    "contour.splits": mark(
        "The contour touches itself and splits into {pieces} pieces, the largest with only {percent:.0f} % of the "
        "area. Draw a line that does not cross itself, or one piece only."
    ),
    "contour.splits_at": mark_n(
        "The contour crosses itself near ({x:.4g}, {y:.4g}) and splits into {pieces} pieces, the largest with only "
        "{percent:.0f} % of the area. Move the vertices so that the line no longer crosses itself, or draw one "
        "piece only.",
        "The contour crosses itself at {count} places, the first near ({x:.4g}, {y:.4g}), and splits into {pieces} "
        "pieces, the largest with only {percent:.0f} % of the area. Move the vertices so that the line no longer "
        "crosses itself, or draw one piece only.",
    ),
    "contour.touches": mark("The contour touches itself. Move the lines apart."),
    "contour.touches_at": mark_n(
        "The contour touches itself near ({x:.4g}, {y:.4g}). Move the lines apart there.",
        "The contour touches itself at {count} places, the first near ({x:.4g}, {y:.4g}). Move the lines apart there.",
    ),
    "outline.not_normalised": mark(
        "An outline must be counter-clockwise with area 1 around the origin, got signed area {area:.6g} around "
        "({x:.6g}, {y:.6g}). Build it with Outline.from_points."
    ),
    "outline.crosses_itself": mark("An outline must not touch or cross itself. Build it with Outline.from_points."),
    "outline.too_many_holes": mark("An outline has at most {limit} holes, got {holes}. Fill the small ones."),
    "outline.no_such_vertex": mark("An outline of {vertices} vertices has no vertex {index}."),
    "nodes.wrong_tables": mark("The nodes of an outline must be at least {fewest}, in tables of the same length."),
    "nodes.not_in_order": mark("The nodes of an outline must follow each other in its order."),
    "nodes.handles_not_finite": mark("The handles of an outline must be finite numbers."),
    "nodes.too_few_left": mark("A target needs at least {fewest} points. Move them instead of deleting one."),
    "resampling.too_few_points": mark("A contour is resampled to at least 3 points, got {value!r:.40}."),
    "resampling.start_not_finite": mark("The start of resampling must be a finite number, got {value!r:.40}."),
    # Drawing on the board
    "figure.flat": mark("The shape needs a width and a height above 0, got {width:.4g} x {height:.4g} mm."),
    "figure.corners": mark("The number of corners must be {fewest} to {most}, got {value!r:.40}."),
    "figure.waist": mark("The waist of a star must be {narrowest:g} to {widest:g} of its size, got {value!r:.40}."),
    "text.no_letters": mark("The text has no letter that could be a target. Type at least one letter or digit."),
    "text.too_many_letters": mark("A target can have at most {limit} letters, got {letters}."),
    "text.flat_box": mark("Drag a box for the text: its width and height must be above 0."),
    "combine.beside_adding": mark(
        "The shape lies beside the target and cannot be added to it. Draw it so that the two overlap."
    ),
    "combine.beside_subtracting": mark(
        "The shape lies beside the target and cannot be subtracted from it. Draw it so that the two overlap."
    ),
    "combine.nothing_shared": mark("The shapes share no area. Move or draw them so that they overlap."),
    "combine.apart": mark("The selected shapes do not touch. Move them together, or bridge them."),
    "combine.nothing_left": mark(
        "The shape would take away the whole target. Draw a smaller one, or clear the target."
    ),
    "combine.no_change": mark(
        "The shape changes nothing: it lies inside the target. Draw it across the target's edge."
    ),
    "combine.half_empty": mark("That half of the target is empty. Choose the other one."),
    "mirror.nothing_on_side": mark("Nothing of the drawing is on the side of the axis that is mirrored."),
    "mirror.images_apart": mark("The shape and its mirror image do not touch. Draw it across the dashed axis."),
    "placed.no_size": mark("A target needs a size above 0 mm and a place, got {scale:g} mm at {centre!s:.60}."),
    "placed.too_large": mark("A target can be at most {limit:g} mm long, got {length:.5g} mm. Draw it smaller."),
    "placed.angle_not_finite": mark("The angle of rotation must be a finite number, got {value!r:.40}."),
    "placed.side_out_of_range": mark(
        "A target must be {smallest:g} to {largest:g} mm wide and high, got {width:.4g} x {height:.4g} mm."
    ),
    "smoothing.strength": mark("The strength of smoothing must be between 0 and 1, got {value!r:.40}."),
    "smoothing.nothing_left": mark("Smoothed this much, nothing of the target is left. Smooth it less."),
    "simplifying.strength": mark("The strength of simplifying must be between 0 and 1, got {value!r:.40}."),
    "symmetry.no_mirror_with_pins": mark(
        "Sheets with pins cannot be their own mirror image. Choose the symmetry auto, turn or none."
    ),
    "symmetry.no_mirror_axis": mark(
        "The target has no mirror axis: it shares {percent:.0f} % of its area with its best mirror image, and "
        "{least:.0f} % are needed. Choose another symmetry, or draw with the mirror."
    ),
    "symmetry.no_turn": mark(
        "The target cannot be turned onto itself: it shares {percent:.0f} % of its area with its turned self, and "
        "{least:.0f} % are needed. Choose another symmetry."
    ),
    "symmetry.no_mirror_on_grid": mark(
        "No sheet of {rows} x {columns} voids is its own mirror image: rows or columns must be odd. Choose "
        "{rows} x {more}, or set the grid to auto."
    ),
    "symmetry.not_of_start": mark(
        "Sheets of {rows} x {columns} voids that start as '{name:.60}' cannot have the symmetry '{symmetry}' with this "
        "target. Choose another start, or grid auto and symmetry auto."
    ),
    "symmetry.no_turn_on_grid": mark(
        "No sheet of {rows} x {columns} voids can be turned onto itself: rows and columns must be both even or both "
        "odd. Choose {rows} x {more}, or set the grid to auto."
    ),
    "symmetry.nothing_in_common": mark(
        "The target and its image share too little area for a symmetric shape. Choose another symmetry."
    ),
    "reach.no_voids": mark("A grid has at least one void in each direction, got {rows} x {columns}."),
}
