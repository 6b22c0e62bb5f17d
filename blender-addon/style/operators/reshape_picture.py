"""Reshape Picture: a picture, cut along contours, follows a clip of the library."""

import bpy

from ...blender import guard, picture_mesh, picture_source
from ...blender.errors import Problem
from .. import picture_pieces
from ..clip_library import clip_of, folder_of
from ..clip_properties import Manner, mirroring, shared
from .reshaping_base import Reshaping


class ROTOTOON_OT_reshape_picture(Manner, Reshaping, bpy.types.Operator):
    bl_idname = "rototoon.reshape_picture"
    bl_label = "Reshape Picture"
    bl_description = (
        "Cut a picture along the contours of the drawing at the playhead, and make the pieces follow a clip of the library, as it "
        "is or in another character's style. The result is a mesh with a shape key for each frame. Picture and drawing stay"
    )
    bl_options = {"REGISTER", "UNDO"}
    changes = guard.SETTINGS

    picture: bpy.props.StringProperty(
        name="Picture", description="An image empty, or a plane with an image texture. If empty, the footage"
    )
    character: shared("character")
    motion: shared("motion")
    border: bpy.props.FloatProperty(
        name="Border",
        description="Distance of the cut from the contours, in pixels of the picture",
        default=2.0,
        min=0,
        soft_max=20,
    )
    hide: bpy.props.BoolProperty(name="Hide Picture", description="Hide the picture that was cut", default=True)

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop_search(self, "picture", context.scene, "objects")
        for name in ("character", "motion", "style", "preset", "strength", "border", "sub_keys", "chains", "mirror", "hide"):
            layout.prop(self, name)

    def begin(self, context):
        folder = folder_of(context.object, self.folder)
        picture = context.scene.objects.get(self.picture) if self.picture else None
        if self.picture and picture is None:
            raise Problem(f'The scene has no object "{self.picture}"')
        character, motion = self.character, self.motion
        remake = self.remake(folder, self.motion, self.character) if self.style else None

        def clips(progress, threads):
            return remake(progress, threads) if remake is not None else clip_of(folder, character, motion)

        worker = self.work(context, clips, 0.5 if self.style else 0.0, self._cut)
        self._source = picture_source.of(context.object, picture, self._drawing.frame)
        return worker

    def _cut(self, drawing):
        self._pieces = picture_pieces.pieces(drawing.project, self.border)
        return {"points": {piece.part: piece.points.tolist() for piece in self._pieces}}

    def finish(self, context, work) -> str:
        """Makes the mesh."""
        name = f"{self._ob.name} {self.motion}"
        made = picture_mesh.write(self._ob, self._source, self._pieces, work.result, self._drawing.frame, name)
        shapes = len(made.data.shape_keys.key_blocks) - 1
        self.tell(context, work.result, shapes)
        if self.hide and self._source.ob is not None:
            _hide(self._source.ob)
        mirrored = mirroring(work.result.looks, work.result.mirrored)
        return f'{len(self._pieces)} pieces, {shapes} frames after frame {self._drawing.frame}: "{made.name}"{mirrored}'


def _hide(picture) -> None:
    """Hides a picture with the eye: disabled in viewports it would not be evaluated any more, and drawings may be placed by it."""
    if picture.visible_get():
        picture.hide_set(True)
    picture.hide_render = True


CLASSES = (ROTOTOON_OT_reshape_picture,)
