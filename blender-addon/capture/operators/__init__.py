"""The operators of this package, one a file."""

from . import (
    clear_generated,
    draw_contours,
    exchanged_parts,
    footage_from_camera,
    footage_from_file,
    footage_from_reference,
    hide_part,
    match_contours,
    new_key,
    release_pins,
    setup,
    show_confidence,
    snap,
    track,
    unseen_part,
    weakest_frame,
)

_MODULES = (
    setup,
    footage_from_file,
    footage_from_camera,
    footage_from_reference,
    draw_contours,
    new_key,
    match_contours,
    track,
    release_pins,
    snap,
    show_confidence,
    weakest_frame,
    exchanged_parts,
    unseen_part,
    hide_part,
    clear_generated,
)

CLASSES = tuple(cls for module in _MODULES for cls in module.CLASSES)
