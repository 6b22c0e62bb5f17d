"""Remove Hidden Lines."""

import bpy

from ...blender import grease_pencil as gp
from ...blender import guard, marks, seen
from ...blender import strokes as st
from ...blender.errors import Problem
from ...blender.frames import kept
from ...common import jobs
from ...common.operators import Long, OnDrawing
from ...common.wording import counted, joined, listed
from ...lines import rototoon_changes as traced_changes
from ...tween import rototoon_changes
from .. import hidden, weights


BEFORE = "In-betweens that are drawn later come from the cut keys. Finish them first, or work on a copy of the object"


class ROTOTOON_OT_hidden_lines(Long, OnDrawing, bpy.types.Operator):
    bl_idname = "rototoon.hidden_lines"
    bl_label = "Remove Hidden Lines"
    bl_description = (
        "Cut lines exactly where filled strokes in front cover them, on the frames that you choose, in your own drawings too: only undo "
        "brings the lines back. Do it last, or on a copy of the object: in-betweens that are drawn later come from the cut drawings. Locked "
        "and hidden layers are not cut"
    )
    bl_options = {"REGISTER", "UNDO"}

    order: bpy.props.EnumProperty(
        name="In Front",
        description="What covers what",
        items=(
            ("STROKES", "Layers and Strokes", "Higher layers cover lower ones. In a layer, later strokes cover earlier ones"),
            ("LAYERS", "Layers", "Higher layers cover lower ones. Strokes of one layer do not cover each other"),
        ),
    )
    covers: bpy.props.EnumProperty(
        name="Covers",
        description="Which strokes cover",
        items=(
            ("FILLED", "Filled", "Strokes with a fill"),
            ("CLOSED", "Closed", "Closed strokes too, filled or not"),
        ),
    )
    action: bpy.props.EnumProperty(
        name="Hidden Lines",
        description="What to do with hidden lines",
        items=(
            ("REMOVE", "Remove", "Delete them"),
            ("MOVE", "Move to Layer", "Move them to a layer of their own"),
        ),
    )
    frames: bpy.props.EnumProperty(
        name="Frames",
        description="Frames to cut",
        items=(
            ("CURRENT", "Current", "The drawings that show on the current frame"),
            ("RANGE", "Scene Range", "All frames of the scene. A held drawing gets a new frame where its hidden lines change"),
        ),
    )

    def invoke(self, context, event):
        """Called by Blender. It asks first where in-betweens depend on drawings that it would cut."""
        if bpy.app.background or context.window is None or not self._cuts_own_keys(context.object):
            return super().invoke(context, event)
        # The answer calls `execute`.
        self._picked = True
        return context.window_manager.invoke_confirm(self, event, title="Cut the keys of in-betweens?", message=BEFORE, confirm_text="Cut")

    @staticmethod
    def _cuts_own_keys(ob) -> bool:
        """Whether a layer that would be cut has in-betweens. Closed layers are no error here: the work names them."""
        return rototoon_changes.has_own_keys(ob, guard.open_layers(st.drawn_layers(ob, active=False)))

    def begin(self, context):
        self._ob, scene = context.object, context.scene
        self._frames, self._after = [scene.frame_current], None
        if self.frames == "RANGE":
            self._frames = hidden.frames_between(self._ob, scene.frame_start, scene.frame_end)
            self._after = hidden.next_change(self._ob, scene.frame_end)
        if not any(not guard.is_hidden(layer) and gp.frame_numbers(layer) for layer in gp.every_layer(self._ob)):
            raise Problem("No drawings are visible: draw something, or show a layer")
        if not st.editable_layers(self._ob, active=False):
            raise Problem("No layer can be cut: unlock one. Contours are not changed, since tracking needs their points")
        self._need_open()
        self.warn(guard.left_out(st.drawn_layers(self._ob, active=False)))
        self._cuts, self._seen, self._noted = [], seen.Seen(self._ob), hidden.Noted()
        return jobs.Stepper(self._steps(scene), "Looking at frames")

    def _need_open(self) -> None:
        """Raises a `Problem` if a layer that gets hidden lines may not be written."""
        if self.action == "MOVE":
            layers = st.editable_layers(self._ob, active=False)
            guard.need_named(self._ob, [layer.name + hidden.SUFFIX for layer in layers])

    def _steps(self, scene):
        choices = hidden.Choices(closed=self.covers == "CLOSED", by_stroke=self.order == "STROKES")
        with kept(scene):
            for index, frame in enumerate(self._frames):
                if frame != scene.frame_current:
                    scene.frame_set(frame)
                self._cuts.extend(hidden.cut_frame(self._ob, frame, choices, self._seen, self._noted))
                yield (index + 1) / len(self._frames)

    def finish(self, context, work) -> str:
        guard.need_open(gp.find_layer(self._ob, name) for name in sorted({cut.layer for cut in self._cuts if cut.changed}))
        self._need_open()
        hidden.need_unchanged(self._ob, self._cuts, self._seen)
        own = hidden.own(self._ob, self._cuts, self.frames == "CURRENT")
        gone = hidden.gone(self._cuts, self.frames == "CURRENT")
        with traced_changes.kept(self._ob, gone) as traced, rototoon_changes.kept(self._ob) as made:
            drawings, parts = hidden.write(self._ob, self._cuts, self.action == "MOVE", self.frames == "CURRENT", self._after)
        marks.remember(self._ob.data)
        self._ob.data.update_tag()
        self.warn(self._through())
        self.warn(self._uncut())
        if not drawings:
            return "Nothing is hidden"
        self.warn(weights.warning(self._ob))
        return joined(f"{counted(parts, 'hidden line')} on {counted(drawings, 'drawing')}", self._said(own, made), traced.said(self._cut_frames()))

    def _through(self) -> str:
        """Which layers have fills that hide nothing; empty if none has."""
        if not self._noted.clear or self.covers == "CLOSED":
            return ""
        names = ", ".join(f'"{name}"' for name in sorted(self._noted.clear))
        return f"lines behind fills that do not hide them stay, on {names}: the fills are transparent, masked or blended"

    def _uncut(self) -> str:
        """How many hidden lines cannot be cut; empty if all can."""
        count = len(self._noted.uncut)
        if not count:
            return ""
        lines = "1 hidden line is a curve" if count == 1 else f"{count} hidden lines are curves"
        return f"not cut: {lines} of a kind that cannot be cut; give it the type Poly in Edit Mode (Set Curve Type), then Fit Strokes makes a curve that can"

    def _cut_frames(self) -> dict[str, set[int]]:
        """The frames of the drawings that were cut, by layer."""
        found: dict[str, set[int]] = {}
        for each in self._cuts:
            if each.changed:
                found.setdefault(each.layer, set()).add(each.source)
        return found

    def _said(self, own: dict[str, set[int]], made: rototoon_changes.Kept) -> str:
        """Which of the cut drawings are the artist's, and what that means for in-betweens."""
        between, mine = made.among(self._cut_frames()), sum(map(len, own.values()))
        frames = sorted(set().union(*own.values()))
        on = f"on frame{'' if len(frames) == 1 else 's'} {listed(frames)}" if frames else ""
        if mine and own.keys() & made.frames.keys():
            self.warn(
                f"{counted(mine, 'drawing')} of yours {'was' if mine == 1 else 'were'} cut {on}, and in-betweens that are drawn anew come from what is left: "
                "undo this before you change a key or press Update In-betweens, or work on a copy of the object"
            )
            on = ""
        said = f"{counted(between, 'in-between')} among them" if between else ""
        return joined(said, f"{counted(mine, 'drawing')} of yours among them, {on}" if on else "")


CLASSES = (ROTOTOON_OT_hidden_lines,)
