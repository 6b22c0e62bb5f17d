"""The operators of this package, one a file."""

from . import accept_doubt, carry_strokes, clear_lines, make_part, match_lines, next_doubt, spread_edits, trace_drawing, trace_image

_MODULES = (trace_drawing, trace_image, carry_strokes, next_doubt, accept_doubt, match_lines, spread_edits, make_part, clear_lines)

CLASSES = tuple(cls for module in _MODULES for cls in module.CLASSES)
