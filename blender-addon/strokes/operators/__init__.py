"""The operators of this package, one a file."""

from . import fit_strokes, hidden_lines

_MODULES = (fit_strokes, hidden_lines)

CLASSES = tuple(cls for module in _MODULES for cls in module.CLASSES)
