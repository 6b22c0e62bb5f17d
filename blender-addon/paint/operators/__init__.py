"""The operators of this package, one a file."""

from . import clear_fills, fill_drawings, next_doubtful_region, paint_bucket, recolour, remove_recolour

_MODULES = (paint_bucket, fill_drawings, recolour, remove_recolour, next_doubtful_region, clear_fills)

CLASSES = tuple(cls for module in _MODULES for cls in module.CLASSES)
