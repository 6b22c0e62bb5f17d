"""The first panel: the steps of the work, which tick themselves, and the button for the next one."""

from __future__ import annotations

from dataclasses import dataclass

import bpy

from ..blender import grease_pencil as gp
from ..capture import ends, stand
from .panel import Panel


@dataclass(frozen=True)
class Step:
    """A step of the work and the button that does it."""

    done: bool
    text: str
    operator: str
    icon: str
    hint: str = ""
    """What the artist does with the button or beside it."""


def steps_of(ob) -> list[Step]:
    """The steps of the work on an object; `None` is for no object."""
    now = stand.of(ob) if ob is not None else stand.Stand()
    keys = len(now.keys)
    return [
        Step(now.footage, "Choose footage", "rototoon.setup", "FILE_FOLDER"),
        Step(keys > 0, "Draw contours", "rototoon.draw_contours", "GREASEPENCIL", "One closed line around each part of the character"),
        _second_key(ob, now, keys),
        Step(now.tracked > 0, "Track", "rototoon.track", "TRACKING_FORWARDS"),
        _correction(ob, now),
        Step(now.snapped, "Snap to the ink", "rototoon.snap", "SNAP_ON"),
    ]


def _second_key(ob, now: stand.Stand, keys: int) -> Step:
    text = "Set a second key"
    if now.copied and not now.tracked:
        hint = "Now fit the lines to this frame: Tab for Edit Mode, then move (G), turn (R) and scale (S) them. If nothing moved, Track"
        return Step(False, text, "rototoon.track", "TRACKING_FORWARDS", hint)
    hint = "First go to a later frame"
    if now.footage:
        hint += f", at best the last one you need: the footage ends on {ob.rototoon.last + ob.rototoon.frame_offset}"
    return Step(keys > 1 or (keys > 0 and now.tracked > 0), text, "rototoon.new_key", "KEY_HLT", hint)


def _correction(ob, now: stand.Stand) -> Step:
    if now.moved:
        hint = "You moved points. Track again, and the frames beside follow"
        if now.line_moved and ob.rototoon.moved_line == "KEEP":
            hint = "You moved a line. Track again: it stays as it is here, and the frames beside follow"
        return Step(False, "Correct", "rototoon.track", "TRACKING_FORWARDS", hint)
    lost = _lost(ob) if now.tracked else ""
    if lost:
        return Step(False, "Correct", "rototoon.new_key", "KEY_HLT", f"{lost}. Go there, set a key, fit the line in Edit Mode (Tab), then Track")
    if now.lost:
        hint = f"Contours are lost on {frames(now.lost)}. Go there, move them in Edit Mode (Tab, G, R), then Track"
        return Step(False, "Correct", "rototoon.weakest_frame", "FRAME_NEXT", hint)
    done = now.corrected or (now.snapped and now.tracked > 0)
    hint = "In Edit Mode, press 2 and click a line that is off. Move it (G), turn it (R), then Track"
    return Step(done, "Correct", "rototoon.weakest_frame", "FRAME_NEXT", hint)


def _lost(ob) -> str:
    """Which part needs a key, and where; empty if none does."""
    for part in ob.rototoon.parts:
        for picture in ends.wanted(part):
            return f'"{part.name}" needs a key on frame {picture + ob.rototoon.frame_offset}'
    return ""


def frames(numbers: list[int]) -> str:
    """Frames in words. More than three are counted."""
    if len(numbers) > 3:
        return f"{len(numbers)} frames, first on {numbers[0]}"
    *before, last = map(str, numbers)
    return f"frames {', '.join(before)} and {last}" if before else f"frame {last}"


def next_of(steps: list[Step]) -> Step | None:
    """The first step that is not done."""
    return next((step for step in steps if not step.done), None)


class ROTOTOON_PT_start(Panel, bpy.types.Panel):
    bl_idname = "ROTOTOON_PT_start"
    bl_label = "Steps"
    page = "artist/tutorial.html"

    def draw(self, context):
        layout, ob = self.layout, context.object if gp.is_drawing(context.object) else None
        steps = steps_of(ob)
        following = next_of(steps)
        column = layout.column(align=True)
        for step in steps:
            icon = "CHECKBOX_HLT" if step.done else "RIGHTARROW" if step is following else "CHECKBOX_DEHLT"
            row = column.row()
            row.active = step is following or not step.done
            row.label(text=step.text, icon=icon)
        if following is None:
            layout.label(text="All steps are done", icon="CHECKMARK")
            return
        column = layout.column(align=True)
        row = column.row()
        row.scale_y = 1.5
        row.operator(following.operator, icon=following.icon)
        if not steps[0].done:
            column.operator("rototoon.open_sample", icon="OUTLINER_OB_IMAGE")
        if following.hint:
            wrapped(layout, following.hint)


def wrapped(layout, text: str, width: int = 34) -> None:
    """A text as lines of labels."""
    column = layout.column(align=True)
    for line in lines_of(text, width):
        column.label(text=line)


def lines_of(text: str, width: int = 34) -> list[str]:
    """A text in lines that fit into a sidebar of its usual width, if no word is longer."""
    lines: list[str] = []
    for word in text.split():
        if lines and len(lines[-1]) + len(word) < width:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return lines


CLASSES = (ROTOTOON_PT_start,)
