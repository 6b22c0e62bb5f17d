"""Drawings between keys, drawn again where something has changed."""

import bpy

from .tweening_base import Tweening


class ROTOTOON_OT_update_in_betweens(Tweening, bpy.types.Operator):
    bl_idname = "rototoon.update_in_betweens"
    bl_label = "Update In-betweens"
    bl_description = (
        "Draw again what your changes of keys and pairs touch, each span as you chose it; all else stays as it is. A drawing "
        "between that you changed becomes a key"
    )
    bl_options = {"REGISTER", "UNDO"}

    def choose(self, _name, found, record):
        spans = zip(found.keys, found.keys[1:])
        held = {span: record.holding(*span) or _swallowed(record, span) for span in spans}
        return {span: known.choices for span, known in held.items() if known is not None}


def _swallowed(record, span: tuple[int, int]):
    """The first of the spans that lie in another one, where a key between them is gone."""
    inside = [start for start, known in record.spans.items() if span[0] <= start and known.last <= span[1]]
    return record.spans[min(inside)] if inside else None


CLASSES = (ROTOTOON_OT_update_in_betweens,)
