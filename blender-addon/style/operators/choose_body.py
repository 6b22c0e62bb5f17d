"""Choose Body: which key points the object's limbs have."""

import bpy

from ...blender import grease_pencil as gp
from ...blender import guard
from ...blender.errors import Problem
from ...capture import document
from ...common.operators import Guarded, OnDrawing
from .. import bodies, limbs

FILE = "file"
ITEMS = (
    ("human", "Human", "17 key points: pelvis, chest, neck, head, and shoulder, elbow, wrist, hip, knee and ankle of each side"),
    ("quadruped", "Quadruped", "An animal that walks on four legs and its toes, with a neck and a tail: a dog, a cat, a horse"),
    ("bird", "Bird", "A bird with wings, legs, a neck and a tail"),
    (FILE, "From File…", "A body of your own, from a JSON file with its definition, or from a document or clip of that body"),
)


class ROTOTOON_OT_choose_body(Guarded, OnDrawing, bpy.types.Operator):
    bl_idname = "rototoon.choose_body"
    bl_label = "Choose Body"
    bl_description = (
        "Choose the body whose key points the lines across limbs mark. Lines and limbs stay where both bodies have their key points"
    )
    bl_options = {"REGISTER", "UNDO"}

    body: bpy.props.EnumProperty(name="Body", description="The body of the object's limbs", items=ITEMS)
    filepath: bpy.props.StringProperty(
        name="File", description="A JSON file with the body, for From File", subtype="FILE_PATH", options={"SKIP_SAVE", "PATH_SUPPORTS_BLEND_RELATIVE"}
    )
    filter_glob: bpy.props.StringProperty(default="*.json", options={"HIDDEN"})

    def invoke(self, context, _event):
        """Called by Blender: a body of one's own is chosen in the file browser."""
        if self.body != FILE or self.filepath:
            return self.execute(context)
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def run(self, context) -> str:
        ob = context.object
        if self.body == FILE and not self.filepath:
            raise Problem("No file chosen")
        given = bodies.from_file(bpy.path.abspath(self.filepath)) if self.body == FILE else self.body
        layer = gp.find_layer(ob, limbs.LAYER)
        guard.need_open([layer] if layer is not None else [])
        before = len(limbs.defined(ob))
        lost = limbs.change_body(ob, given)
        if layer is not None and limbs.count_lines(ob) > 1:
            try:
                limbs.define(ob, document.read(ob, results=True))
            except Problem as problem:
                self.warn(str(problem))
        if lost:
            self.warn(f"this body has no {', '.join(lost)}: their lines mark nothing now")
        gone = before - len(limbs.defined(ob))
        if gone > 0:
            told = "limb does not fit this body and is gone; undo brings it back"
            if gone > 1:
                told = "limbs do not fit this body and are gone; undo brings them back"
            self.warn(f"{gone} {told}")
        body = bodies.of(ob)
        return f"{body.name}: {len(body.points)} key points"


CLASSES = (ROTOTOON_OT_choose_body,)
