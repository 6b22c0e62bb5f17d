"""When operators on tracked contours are available."""

from __future__ import annotations

from ..blender import grease_pencil as gp
from ..common.operators import OnContours, OnDrawing
from . import snapping, stand


class OnTracked(OnContours):
    """An operator that needs tracked contours."""

    @classmethod
    def lacking(cls, ob, changes: str) -> str:
        """As `OnDrawing.lacking`."""
        why = super().lacking(ob, changes)
        return why or ("" if stand.has_generated(ob) else "Nothing is tracked yet: press Track first")


class WithGenerated(OnDrawing):
    """An operator that needs anything that Track or Snap to Ink has drawn."""

    @classmethod
    def lacking(cls, ob, changes: str) -> str:
        """As `OnDrawing.lacking`."""
        why = super().lacking(ob, changes)
        if why:
            return why
        snapped = gp.find_layer(ob, ob.rototoon.snapped_layer), snapping.aside(ob)
        generated = stand.has_generated(ob) or any(layer is not None and gp.frame_numbers(layer) for layer in snapped)
        return "" if generated else "Nothing is generated yet: press Track first"
