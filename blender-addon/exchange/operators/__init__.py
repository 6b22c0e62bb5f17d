"""The operators of this package, one a file."""

from . import contours_to_mask, export_document, import_document

_MODULES = (import_document, export_document, contours_to_mask)

CLASSES = tuple(cls for module in _MODULES for cls in module.CLASSES)
