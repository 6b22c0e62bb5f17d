"""Accept Stroke: the artist has looked at a doubtful stroke, and it is right."""

import bpy

from ...blender import grease_pencil as gp
from ...blender import guard, selection
from ...blender.errors import Problem
from ...common.operators import Guarded, OnDrawing
from ...common.wording import counted
from .. import accepting, doubts
from .match_lines import nothing_traced


class ROTOTOON_OT_accept_doubt(Guarded, OnDrawing, bpy.types.Operator):
    bl_idname = "rototoon.accept_doubt"
    bl_label = "Accept Stroke"
    bl_description = (
        "Say that a doubtful stroke of this frame is right: the one to which Next Doubtful Stroke went, or the selected ones. When nothing on a "
        "drawing is in doubt any more, the drawing is yours"
    )
    bl_options = {"REGISTER", "UNDO"}

    every: bpy.props.BoolProperty(name="All on This Frame", description="Accept all doubtful strokes of this frame", default=False, options={"SKIP_SAVE"})

    @classmethod
    def lacking(cls, ob, changes: str) -> str:
        """As `OnDrawing.lacking`."""
        why = super().lacking(ob, changes)
        return why or nothing_traced(ob)

    def run(self, context) -> str:
        ob, frame = context.object, context.scene.frame_current
        found = accepting.shown(ob, frame)
        if not found:
            raise Problem("No stroke is in doubt on this frame: press Next Doubtful Stroke")
        chosen = self._open(ob, found) if self.every else _chosen(ob, found)
        own = accepting.accept(ob, chosen)
        what = f"Stroke {chosen[0].number} is" if len(chosen) == 1 else f"{len(chosen)} strokes are"
        said = f"{what} accepted on frame {chosen[0].frame}"
        if own:
            said += f", and the {'drawing is' if len(own) == 1 else 'drawings are'} yours now"
        left = len({(place.layer, place.number) for place in doubts.places(ob)})
        return f"{said}. {counted(left, 'stroke')} still in doubt" if left else f"{said}. No other stroke is in doubt"

    def _open(self, ob, found: list[doubts.Place]) -> list[doubts.Place]:
        """The strokes on layers that may be written; the others are named."""
        layers = [gp.find_layer(ob, name) for name in sorted({place.layer for place in found})]
        guard.need_some(layers)
        self.warn(guard.left_out(layers))
        names = {layer.name for layer in guard.open_layers(layers)}
        return [place for place in found if place.layer in names]


def _chosen(ob, found: list[doubts.Place]) -> list[doubts.Place]:
    """The stroke to which Next Doubtful Stroke went, if it is among the strokes; otherwise the selected ones, or the only one."""
    settings = ob.rototoon
    went = settings.doubt_frame, settings.doubt_layer, settings.doubt_number
    chosen = [place for place in found if (place.frame, place.layer, place.number) == went]
    if not chosen and ob.mode == "EDIT":
        chosen = [place for place in found if _is_selected(ob, place)]
    chosen = chosen or (found if len(found) == 1 else [])
    if not chosen:
        raise Problem(f"{len(found)} strokes are in doubt on this frame: press Next Doubtful Stroke until it comes to the one that is right")
    return chosen


def _is_selected(ob, place: doubts.Place) -> bool:
    layer = gp.find_layer(ob, place.layer)
    return not guard.closed(layer) and bool(selection.selected_strokes(gp.drawings(layer)[place.frame][0])[place.index])


CLASSES = (ROTOTOON_OT_accept_doubt,)
