"""Update In-betweens: draws spans again where something has changed."""

import bpy

from .tweening_base import Tweening


class ROTOTOON_OT_update_in_betweens(Tweening, bpy.types.Operator):
    bl_idname = "rototoon.update_in_betweens"
    bl_label = "Update In-betweens"
    bl_description = (
        "Draw the spans again that your changes of keys and pairs affect, each with its own choices. Everything else stays. An "
        "in-between that you changed becomes a key"
    )
    bl_options = {"REGISTER", "UNDO"}

    def choose(self, _name, found, record):
        spans = zip(found.keys, found.keys[1:])
        held = {span: record.holding(*span) or _swallowed(record, span) or _left_in(record, span, found) for span in spans}
        return {span: known.choices for span, known in held.items() if known is not None}


def _swallowed(record, span: tuple[int, int]):
    """The first recorded span inside a span, where a key between them was removed."""
    inside = [start for start, known in record.spans.items() if span[0] <= start and known.last <= span[1]]
    return record.spans[min(inside)] if inside else None


def _left_in(record, span: tuple[int, int], found):
    """The recorded span with most frames in a span that has in-betweens and neither holds nor is held: its keys were moved and redrawn, or an
    earlier version recorded it."""
    return record.overlapping(*span) if any(span[0] < frame < span[1] for frame in found.made) else None


CLASSES = (ROTOTOON_OT_update_in_betweens,)
