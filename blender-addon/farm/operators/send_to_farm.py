"""Send to Farm: writes the contours, the lines and the paint of many shots as a batch."""

import os

import bpy

from ...blender import guard
from ...blender.errors import Problem
from ...common import jobs
from ...common.operators import Long
from ...common.wording import counted
from .. import batch, files, sending, tracing

NAMED = 3
"""Largest number of objects that a message names."""


class ROTOTOON_OT_send_to_farm(Long, bpy.types.Operator):
    bl_idname = "rototoon.send_to_farm"
    bl_label = "Send to Farm"
    bl_description = (
        "Write the contours, the lines and the paint of many shots as documents, with a manifest for the command rototoon batch and job files for render "
        "farms. Collect Results takes the finished tracks, traced strokes and painted regions in"
    )
    bl_options = {"REGISTER"}
    changes = guard.NOTHING

    directory: bpy.props.StringProperty(
        name="Folder",
        description="The folder that gets the batch. The farm's machines must see it",
        subtype="DIR_PATH",
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
    )
    which: bpy.props.EnumProperty(
        name="Shots",
        description="What is sent",
        items=(
            ("SCENE", "Scene", "Every Grease Pencil object of the scene that has footage, and contours, lines or shapes of paint"),
            ("SELECTED", "Selected Objects", "The selected Grease Pencil objects that have footage, and contours, lines or shapes of paint"),
            ("FOLDER", "Files of a Folder", "The scene of every Blender file of a folder, as the files were saved"),
        ),
    )
    source: bpy.props.StringProperty(
        name="Files",
        description="The folder of the Blender files, for Files of a Folder. If empty, the folder of this file",
        subtype="DIR_PATH",
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
    )
    use_snap: bpy.props.BoolProperty(name="Snap to Ink", description="Also lay the tracked contours along the drawn lines", default=False)
    use_mattes: bpy.props.BoolProperty(
        name="Mattes", description="Also write a matte of the closed parts for every frame, as PNG files", default=False
    )
    lines: bpy.props.EnumProperty(
        name="Lines",
        description="Which lines are traced. The kind of drawing and the sensitivity are those of the panel Lines",
        items=(
            ("DRAWN", "Where You Drew", "As Trace Drawing, for objects with strokes of yours on the layer of Trace Drawing"),
            ("TRACE", "Trace Drawing", "As Trace Drawing, for every object with footage"),
            (
                "CARRY",
                "Carry Strokes",
                "As Carry Strokes, for objects with strokes of yours on any layer that is neither locked nor hidden, but for those with contours, snapped "
                "lines and paint",
            ),
            ("NONE", "None", "No lines"),
        ),
    )
    new_lines: bpy.props.BoolProperty(
        name="New Lines",
        description="With Carry Strokes: lines of the footage that no stroke explains become new strokes, on the active layer. "
        "On the layer of Trace Drawing they always do",
        default=False,
    )
    hold: bpy.props.BoolProperty(
        name="Hold", description="A frame with the same picture as the one before, as in films on twos, holds its traced drawing", default=True
    )
    engine: bpy.props.EnumProperty(
        name="Jobs",
        description="The job files that are written beside the manifest",
        items=(
            ("ALL", "All", "Job files for all farms below"),
            ("OPENJD", "OpenJD", "template.json, for AWS Deadline Cloud and other farms that run OpenJD"),
            ("FLAMENCO", "Flamenco", "rototoon-batch.js, a job type for Flamenco"),
            ("OPENCUE", "OpenCue", "send_to_opencue.py, a script that sends the job to OpenCue"),
            ("NONE", "None", "Only the manifest, for the command rototoon batch"),
        ),
    )
    chunk: bpy.props.IntProperty(name="Shots per Task", description="Shots that a worker gets at a time, with OpenJD and OpenCue", default=4, min=1, max=1000)
    filter_folder: bpy.props.BoolProperty(default=True, options={"HIDDEN"})

    def invoke(self, context, _event):
        """Called by Blender: asks for the folder."""
        self._picked = True
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def begin(self, context):
        self._folder = folder_of(self.directory, "Choose a folder for the batch")
        lines = tracing.Wanted(self.lines, self.new_lines, self.hold)
        if self.which == "FOLDER":
            paths = files.blend_files(folder_of(self.source or "//", "Save this file, or choose the folder of the Blender files"))
            return jobs.Worker(lambda progress: files.shots_of(paths, lines, progress))
        objects = context.scene.objects if self.which == "SCENE" else context.selected_objects
        found = sending.shots_of(objects, bpy.data.filepath, lines)
        return jobs.Worker(lambda _progress: found)

    def finish(self, _context, work) -> str:
        shots, left = work.result
        if not shots:
            raise Problem("; ".join(["Nothing to send", *_first(left)]))
        choices = batch.Choices(self.use_snap, self.use_mattes, self.engine, self.chunk)
        batch.write(self._folder, shots, choices)
        if left:
            self.warn("left out: " + "; ".join(_first(left)))
        movies = sending.of_movies(shots)
        if movies:
            names = ", ".join(f'"{name}"' for name in _first(movies))
            self.warn(
                f"the footage of {names} is a movie, whose frames are in the cache of this machine: for workers on others set the Cache Folder "
                "in the preferences to one that all see under the same path, choose the movie again, and send"
            )
        if any(not shot["blend"] for shot in shots):
            self.warn("this file was never saved: save it, so that the results find it again")
        return f"{counted(len(shots), 'shot')} in {os.path.join(self._folder, batch.MANIFEST)}"


def _first(texts: list[str]) -> list[str]:
    more = len(texts) - NAMED
    return texts if more <= 0 else [*texts[:NAMED], f"and {more} more"]


def folder_of(path: str, otherwise: str) -> str:
    """An absolute folder; a `Problem` with the text `otherwise` if there is none."""
    if not path or (path.startswith("//") and not bpy.data.filepath):
        raise Problem(otherwise)
    return os.path.abspath(os.path.expanduser(bpy.path.abspath(path)))


CLASSES = (ROTOTOON_OT_send_to_farm,)
