"""The operators of this package, one a file."""

from . import (
    apply_motion,
    choose_body,
    define_limbs,
    depth_mark,
    import_motion,
    refresh_clips,
    reshape_drawing,
    reshape_picture,
    save_clip,
)

_MODULES = (
    choose_body,
    define_limbs,
    refresh_clips,
    save_clip,
    import_motion,
    reshape_drawing,
    apply_motion,
    reshape_picture,
    depth_mark,
)

CLASSES = tuple(cls for module in _MODULES for cls in module.CLASSES)
