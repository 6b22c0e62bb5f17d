"""Edit on All Frames: what the artist did to strokes on this frame, done to the same strokes on all frames."""

import bpy
import numpy as np

from ...blender import grease_pencil as gp
from ...blender import guard, marks, placement, selection
from ...blender import strokes as st
from ...blender.errors import Problem
from ...common import jobs
from ...common.operators import Long
from ...common.wording import counted
from .. import moved, records, spread_looks, spreading
from .match_lines import nothing_traced, numbered
from .tracing_base import OnFootage


class ROTOTOON_OT_spread_edits(Long, OnFootage, bpy.types.Operator):
    bl_idname = "rototoon.spread_edits"
    bl_label = "Edit on All Frames"
    bl_description = (
        "Do on all frames what you did to strokes on this frame since they were traced: moved points, width, opacity, colour, material, "
        "cuts, joins, and deleted strokes. The edit moves and turns with its stroke"
    )
    bl_options = {"REGISTER", "UNDO"}

    shape: bpy.props.BoolProperty(name="Shape", description="Moved points, cuts and joins", default=True)
    look: bpy.props.BoolProperty(name="Look", description="Width, opacity, colours, material, caps, softness and your own attributes of edited strokes", default=True)
    delete: bpy.props.BoolProperty(name="Deleted Strokes", description="Delete the strokes that you deleted here", default=True)
    selected: bpy.props.BoolProperty(
        name="Selected Strokes Only", description="Only edits of strokes with a selected point; nothing is deleted", default=False
    )

    @classmethod
    def lacking(cls, ob, changes: str) -> str:
        """As `OnDrawing.lacking`."""
        why = super().lacking(ob, changes)
        return why or nothing_traced(ob)

    def begin(self, context):
        self._ob, self._frame = context.object, context.scene.frame_current
        wanted = numbered(self._ob)
        guard.need_some(wanted)
        self.warn(guard.left_out(wanted))
        layers, self._work_on = guard.open_layers(wanted), []
        kept = moved.read(self._ob, [layer.name for layer in layers])
        for layer in layers:
            shown = st.shown_frame(layer, self._frame)
            if shown is not None:
                self._work_on.append(self._read(layer, shown, kept.get(layer.name, records.Layer())))
        self._work_on = [each for each in self._work_on if each[2]]
        if not self._work_on:
            raise Problem("No stroke on this frame differs from what was traced: edit strokes here first, then press this")
        self._done, self._left_out = [], 0
        self._there: dict[tuple[str, int], set[int]] = {}
        """By layer and frame the numbers of what was there before."""
        return jobs.Stepper(self._steps(), "Editing")

    def _read(self, layer, shown: int, record: records.Layer):
        with gp.copied(self._ob.data) as data:
            contents = {
                frame: st.read(handle)
                for frame, (handle, _) in gp.drawings(gp.find_layer_of(data, layer.name)).items()
                if gp.has(handle, gp.LINE) or frame == shown
            }
        points = [each.point["position"] for each in contents.values() if len(each.sizes)]
        points = np.concatenate(points) if points else np.zeros((0, 3))
        frames = range(min(contents), max(contents) + 1)
        mapper = placement.Mapper(self._ob, frames, {0: points[np.isfinite(points).all(1)]}, [layer.name])
        chosen = None
        if self.selected:
            chosen = selection.selected_strokes(gp.drawings(layer)[shown][0])
        edit = spreading.found(contents[shown], record.numbers.get(shown, []), mapper.at(0, shown), marks.Slots(self._ob.data), chosen)
        if not self.delete:
            edit.deleted = set()
        edit.keep(self.shape, self.look)
        return layer.name, shown, edit, contents, mapper

    def _steps(self):
        total = sum(len(contents) for *_, contents, _ in self._work_on)
        done = 0
        for name, shown, edit, contents, mapper in self._work_on:
            highest = max(int(each.strokes(gp.TRACK).max(initial=0)) for each in contents.values())
            numbers = spreading.numbers_after(edit, highest + 1) if self.shape else {}
            for frame, content in contents.items():
                self._there[name, frame] = spreading.present(content)
                if frame != shown:
                    made, left_out = spreading.spread(edit, numbers, content, mapper.at(0, frame), self.shape, self.look)
                    self._left_out += left_out
                    if not made.equals(content):
                        self._done.append((name, frame, made))
                done += 1
                yield done / total
            # Last, since the other frames are made from the marks that change now.
            self._done.append((name, shown, spreading.noted(edit, numbers, self.shape, self.look)))

    def finish(self, _context, _work):
        guard.need_open(gp.find_layer(self._ob, name) for name, *_ in self._work_on)
        kept = moved.read(self._ob, {name for name, *_ in self._done})
        for name in {name: None for name, *_ in self._done}:
            gp.make_own(gp.find_layer(self._ob, name), [frame for of, frame, _ in self._done if of == name])
        for count, (name, frame, content) in enumerate(self._done, 1):
            (handle, kind), record = gp.drawings(gp.find_layer(self._ob, name))[frame], kept.setdefault(name, records.Layer())
            st.write(handle, content)
            if kind == gp.GENERATED:
                # An edit of looks leaves the points, by which the drawing of a version without marks counts as traced.
                marks.make_the_artists(handle)
                record.marked.add(frame)
            record.numbers[frame] = self._numbers_of(name, frame, content, record.numbers.get(frame, []))
            yield count / len(self._done)
        records.write(self._ob.data, kept)
        marks.remember(self._ob.data)
        self._ob.data.update_tag()
        self.warn(self._not_reshaped())
        edited = sum(len(edit.edited) for _, _, edit, *_ in self._work_on)
        deleted = sum(len(edit.deleted) for _, _, edit, *_ in self._work_on)
        frames = len({frame for name, frame, _ in self._done}) - len({shown for _, shown, *_ in self._work_on})
        said = [f"{edited} edited"] if edited else []
        said += [f"{deleted} deleted"] if deleted else []
        return f"{' and '.join(said)} {'stroke' if edited + deleted == 1 else 'strokes'}, on {counted(frames, 'other frame')}"

    def _numbers_of(self, name: str, frame: int, content, before: list[int]) -> list[int]:
        """The numbers that are noted of a drawing: those of its strokes, and of those that the artist deleted and that stay on other frames."""
        shown, edit = next((shown, edit) for of, shown, edit, *_ in self._work_on if of == name)
        there = self._there[name, frame]
        # Without their shape, strokes that were joined are still several on the other frames.
        joined = there & set(before) if frame == shown and not self.shape else set()
        return sorted({*content.strokes(gp.TRACK).tolist(), *(set(before) - there - edit.deleted), *joined})

    def _not_reshaped(self) -> str:
        """Which moved strokes are not reshaped on other frames; empty if all are."""
        curves, pieces = self._left_out, 0
        for _, _, edit, *_ in self._work_on if self.shape else ():
            left = int(spread_looks.left_by_rototoon(edit.content)[edit.not_reshaped()].sum())
            curves, pieces = curves + len(edit.not_reshaped()) - left, pieces + left
        said = []
        if curves:
            said.append(f"{'1 stroke is a curve' if curves == 1 else f'{curves} strokes are curves'} with handles or knots")
        if pieces:
            said.append(f"{'1 stroke is' if pieces == 1 else f'{pieces} strokes are'} what Remove Hidden Lines left: move the points on another frame")
        return f"not reshaped: {', and '.join(said)}" if said else ""


CLASSES = (ROTOTOON_OT_spread_edits,)
