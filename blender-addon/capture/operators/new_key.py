"""New Key Here: copies contours to the current frame as a key."""

import bpy

from ...blender import grease_pencil as gp
from ...blender import guard
from ...blender import strokes as st
from ...blender.errors import Problem
from ...common.operators import Guarded, OnContours
from ...common.wording import counted
from .. import contours, document, generated, identity


class ROTOTOON_OT_new_key(Guarded, OnContours, bpy.types.Operator):
    bl_idname = "rototoon.new_key"
    bl_label = "New Key Here"
    bl_description = (
        "Copy the contours to this frame as your key: the tracked contours if there are any, otherwise those of the last key. "
        "On hidden layers too, not on locked ones"
    )
    bl_options = {"REGISTER", "UNDO"}

    parts: bpy.props.EnumProperty(
        name="Parts",
        description="Which parts get a key",
        items=(("ALL", "All", "All parts"), ("ACTIVE", "Active", "The part chosen in the list")),
    )

    def run(self, context) -> str:
        ob, frame = context.object, context.scene.frame_current
        found = contours.read(ob)
        # Copies need a part, so new strokes are identified first.
        decisions = identity.decide(found, document.mapper_of(ob, found), ob.rototoon.next_number)
        wanted = self._wanted(ob, found)
        if not wanted:
            raise Problem(f"Frame {frame} is a key already")
        named = [gp.find_layer(ob, found.layer_names[index]) for index in sorted({_source(part, frame).layer for part in wanted})]
        guard.need_some(named, hidden=True)
        identity.write(ob, found, decisions)
        made = 0
        for index, name in enumerate(found.layer_names):
            sources: dict[int, list[contours.Stroke]] = {}
            for part in wanted:
                stroke = _source(part, frame)
                if stroke.layer == index and index not in found.closed:
                    sources.setdefault(stroke.frame, []).append(stroke)
            made += _make_key(gp.find_layer(ob, name), sources, frame)
        ob.data.update_tag()
        for doubt in decisions.doubts:
            self.warn(doubt)
        self.warn(guard.left_out(named, hidden=True))
        return f"Key on frame {frame}: {counted(made, 'contour')}"

    def _wanted(self, ob, found):
        frame = bpy.context.scene.frame_current
        parts = [part for part in found.parts if (part.keys or part.made) and frame not in part.keys]
        if self.parts == "ALL":
            return parts
        active = ob.rototoon.active_part
        number = ob.rototoon.parts[active].number if active < len(ob.rototoon.parts) else 0
        return [part for part in parts if part.number == number]


def _source(part: contours.Part, frame: int) -> contours.Stroke:
    """The part's tracked contour on this frame, otherwise its last key before, otherwise its first key after."""
    if frame in part.made:
        return part.made[frame]
    strokes = part.keys or part.made
    before = [number for number in strokes if number < frame]
    return strokes[max(before) if before else min(strokes)]


def _make_key(layer, sources: dict[int, list[contours.Stroke]], frame: int) -> int:
    """Copies strokes to `frame`, by source frame. Strokes that are on `frame` already become keys. Returns the number of
    strokes."""
    strokes = sum(len(group) for group in sources.values())
    if not strokes:
        return 0
    others = {number: group for number, group in sources.items() if number != frame}
    if frame not in gp.drawings(layer) and others:
        # A copy of the frame keeps everything that Blender knows of its strokes.
        most = max(others, key=lambda number: len(others[number]))
        gp.copy_frame(layer, most, frame)
        copy = gp.drawings(layer)[frame][0]
        gone = sorted(set(range(len(gp.offsets(copy)) - 1)) - {stroke.index for stroke in others.pop(most)})
        if gone:
            gp.remove_strokes(copy, gone)
        _own(copy, None)
    gp.make_frames(layer, [frame], gp.KEYFRAME)
    drawings = gp.drawings(layer)
    target, kind = drawings[frame]
    generated.settle(target, kind)
    if frame in sources:
        _own(target, [stroke.index for stroke in sources[frame]])
    for number, group in others.items():
        before = len(gp.offsets(target)) - 1
        st.add(target, st.chosen(st.read(drawings[number][0]), [stroke.index for stroke in group]))
        _own(target, list(range(before, before + len(group))))
    gp.set_keyframe_type(layer, {frame: gp.KEYFRAME})
    return strokes


def _own(drawing, indices: list[int] | None) -> None:
    """Marks strokes (all by default) as the artist's. Of the marks of tracking only the part's number stays."""
    starts = gp.offsets(drawing)
    strokes, total = len(starts) - 1, int(starts[-1])
    for name in (gp.MADE, gp.BESIDE, gp.CENTER, gp.PIN):
        if not gp.has(drawing, name):
            continue
        values = gp.value(drawing, name, strokes if gp.TYPES[name][1] == "CURVE" else total)
        for index in range(strokes) if indices is None else indices:
            values[index if gp.TYPES[name][1] == "CURVE" else slice(starts[index], starts[index + 1])] = 0
        gp.put(drawing, name, values)


CLASSES = (ROTOTOON_OT_new_key,)
