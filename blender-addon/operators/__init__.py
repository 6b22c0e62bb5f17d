"""The operators `bpy.ops.rototoon.*`, one a file."""

from . import (
    clear_generated,
    contours_to_mask,
    export_document,
    fit_strokes,
    footage_from_camera,
    footage_from_file,
    footage_from_reference,
    hidden_lines,
    import_document,
    in_between,
    match_contours,
    match_strokes,
    new_key,
    release_pins,
    setup,
    show_confidence,
    snap,
    track,
    weakest_frame,
)

_MODULES = (
    setup,
    footage_from_file,
    footage_from_camera,
    footage_from_reference,
    new_key,
    match_contours,
    track,
    release_pins,
    snap,
    show_confidence,
    weakest_frame,
    clear_generated,
    fit_strokes,
    hidden_lines,
    match_strokes,
    in_between,
    import_document,
    export_document,
    contours_to_mask,
)

CLASSES = tuple(cls for module in _MODULES for cls in module.CLASSES)
