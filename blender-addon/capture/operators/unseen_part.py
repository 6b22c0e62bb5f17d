"""Parts that can probably not be seen on some frames: the way to them, and the answer that it is so."""

import bpy

from ...blender import guard
from ...blender.errors import Problem
from ...common.operators import Guarded, OnContours
from .. import contours, unseen
from ..polls import OnTracked
from .hide_part import hide, need_open

NONE = "Track found no frames on which a part cannot be seen"


class Asked:
    """An operator on one of the questions in the panel Track."""

    question: bpy.props.IntProperty(name="Question", description="Which part, in the order of the panel Track", default=0, min=0)

    @classmethod
    def lacking(cls, ob, changes: str) -> str:
        """As `OnDrawing.lacking`."""
        return super().lacking(ob, changes) or ("" if unseen.questions(ob) else NONE)

    def asked(self, ob) -> unseen.Question:
        """The question."""
        questions = unseen.questions(ob)
        return questions[min(self.question, len(questions) - 1)]


class ROTOTOON_OT_unseen_part(Asked, Guarded, OnTracked, bpy.types.Operator):
    bl_idname = "rototoon.unseen_part"
    bl_label = "Go to Unseen Part"
    bl_description = "Choose a part in the list that can probably not be seen on some frames, and go to the first of them"
    bl_options = {"REGISTER", "UNDO"}
    changes = guard.NOTHING

    def run(self, context) -> str:
        ob = context.object
        question = self.asked(ob)
        ob.rototoon.active_part = question.index
        context.scene.frame_set(question.frames[0])
        return f"Frame {question.frames[0]}: {question}"


class ROTOTOON_OT_hide_unseen(Asked, Guarded, OnContours, bpy.types.Operator):
    bl_idname = "rototoon.hide_unseen"
    bl_label = "Hide Unseen Part"
    bl_description = (
        "Say that the picture does not show a part on the frames on which it can probably not be seen: Track then draws no contour of it there. "
        "Keys stay. On hidden layers too, not on locked ones"
    )
    bl_options = {"REGISTER", "UNDO"}

    def run(self, context) -> str:
        ob = context.object
        question = self.asked(ob)
        item = ob.rototoon.parts[question.index]
        found = contours.read(ob)
        part = found.part(item.number)
        need_open(ob, found, part)
        pictures = [frame - ob.rototoon.frame_offset for frame in question.frames if frame not in part.keys]
        if not pictures:
            raise Problem(f'"{item.name}" has keys on these frames: remove them first if the part is hidden there')
        return hide(self, ob, found, item, pictures)


CLASSES = (ROTOTOON_OT_unseen_part, ROTOTOON_OT_hide_unseen)
