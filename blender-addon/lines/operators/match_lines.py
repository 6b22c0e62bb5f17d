"""Match Lines: shows which strokes of two drawings are the same, and lets the artist change it."""

import bpy

from ...blender import grease_pencil as gp
from ...blender import guard, memo
from ...blender.errors import Problem
from ...common.operators import OnDrawing
from ...tween.operators.pairs_base import Pairing
from .. import drawings as dr
from .. import pairing


class ROTOTOON_OT_match_lines(Pairing, bpy.types.Operator):
    bl_idname = "rototoon.match_lines"
    bl_label = "Match Lines"
    bl_description = (
        "Show which strokes of this drawing and the next one are the same. Click two strokes to make them the same from the later drawing "
        "on: their numbers change places there and after. Alt-click a stroke to end it before the later drawing"
    )
    # Without REGISTER: repeating the operator with other settings would undo the artist's decisions.
    bl_options = {"UNDO"}
    help = "Click two strokes to make them the same, Alt-click one to part it, Ctrl Z to undo, Esc to leave"

    earlier: bpy.props.IntProperty(
        name="Earlier", description="Number of a stroke on the earlier drawing, for scripts; 0 for none", default=0, min=0
    )
    later: bpy.props.IntProperty(
        name="Later", description="Number of the stroke on the later drawing that is the same, for scripts", default=0, min=0
    )

    @classmethod
    def lacking(cls, ob, changes: str) -> str:
        """As `OnDrawing.lacking`."""
        why = OnDrawing.lacking(ob, changes)
        return why or nothing_traced(ob)

    def make_pairing(self, context) -> pairing.LinePairing:
        ob = context.object
        wanted = numbered(ob)
        guard.need_some(wanted)
        self.warn(guard.left_out(wanted))
        found = pairing.LinePairing(ob, guard.open_layers(wanted), context.scene.frame_current)
        if not len(found):
            raise Problem("There are no two drawings around this frame: go between two drawings that have strokes")
        if self.earlier and not found.pair(self.earlier, self.later):
            raise Problem(f"No stroke {self.earlier} on the earlier drawing, or no stroke {self.later} on the later one")
        return found


def numbered(ob) -> list:
    """The layers with numbered strokes that are no contours, snapped lines or paint."""
    return [layer for layer in dr.layers(ob) if any(gp.has(handle, gp.LINE) for handle in gp.handles(layer))]


def any_numbered(ob) -> bool:
    """Whether a layer has numbered strokes."""
    return any(dr.is_lines(layer) for layer in dr.layers(ob)) or bool(numbered(ob))


def nothing_traced(ob) -> str:
    """Why there is nothing to do for operators on traced strokes; empty if there is something."""
    return "" if memo.kept(ob, any_numbered) else "Nothing is traced yet: press Trace Drawing or Carry Strokes first"


CLASSES = (ROTOTOON_OT_match_lines,)
