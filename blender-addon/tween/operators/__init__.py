"""The operators of this package, one a file."""

from . import clear_in_betweens, in_between, match_strokes, suggest_breakdown, update_in_betweens

_MODULES = (match_strokes, in_between, update_in_betweens, suggest_breakdown, clear_in_betweens)

CLASSES = tuple(cls for module in _MODULES for cls in module.CLASSES)
