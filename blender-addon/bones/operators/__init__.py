"""The operators of this package, one a file."""

from . import drive_bones, guess_bones, save_clip_from_armature

_MODULES = (guess_bones, save_clip_from_armature, drive_bones)

CLASSES = tuple(cls for module in _MODULES for cls in module.CLASSES)
