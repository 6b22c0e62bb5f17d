"""Update In-betweens: draws spans again where something has changed."""

import bpy

from .. import charts
from ..charts import Choices
from .tweening_base import Tweening


class ROTOTOON_OT_update_in_betweens(Tweening, bpy.types.Operator):
    bl_idname = "rototoon.update_in_betweens"
    bl_label = "Update In-betweens"
    bl_description = (
        "Draw the spans again that your changes of keys and pairs affect, each with its own choices. Everything else stays. An "
        "in-between that you changed becomes a key"
    )
    bl_options = {"REGISTER", "UNDO"}

    def choose(self, name, found, record):
        if found.made and not record.spans:
            self.warn(f'the in-betweens of "{name}" stay as they were, since it is not known from what they were drawn: press In-between there')
        spans = zip(found.keys, found.keys[1:])
        held = {span: record.choices(*span) or _swallowed(record, span) or _left_in(record, span, found) for span in spans}
        return {span: choices for span, choices in held.items() if choices is not None}


def _swallowed(record, span: tuple[int, int]) -> Choices | None:
    """The choices of the recorded spans inside a span, where keys between them were removed."""
    inside = [known.choices for start, known in sorted(record.spans.items()) if span[0] <= start and known.last <= span[1]]
    return charts.joined(inside) if inside else None


def _left_in(record, span: tuple[int, int], found) -> Choices | None:
    """The choices of the recorded span with most frames in a span that has in-betweens and neither holds nor is held: its keys were moved and
    redrawn, or an earlier version recorded it."""
    known = record.overlapping(*span) if any(span[0] < frame < span[1] for frame in found.made) else None
    return known.choices if known is not None else None


CLASSES = (ROTOTOON_OT_update_in_betweens,)
