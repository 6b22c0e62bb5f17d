"""Export Document."""

import os

import bpy

from ...blender import grease_pencil as gp
from ...blender import guard
from ...blender import strokes as st
from ...blender.errors import Problem
from ...capture import document, part_names, snapping
from ...common import kept
from ...common.operators import Guarded, OnShapes
from ...common.wording import counted, listed
from ...lines import drawings
from ...paint import recolours
from .. import drawn, drawn_out, filled, known_files, layers_out, without_footage


class ROTOTOON_OT_export_document(Guarded, OnShapes, bpy.types.Operator):
    bl_idname = "rototoon.export_document"
    bl_label = "Export Document"
    bl_description = (
        "Write keys, corrections, tracks, snapped lines, drawings, traced lines, in-betweens and paint as a Rototoon project document"
    )
    bl_options = {"REGISTER"}
    changes = guard.NOTHING

    filepath: bpy.props.StringProperty(name="File", description="The file to write", subtype="FILE_PATH", options={"PATH_SUPPORTS_BLEND_RELATIVE"})
    layers: bpy.props.EnumProperty(
        name="Lines",
        description="Which layers of lines are written",
        items=(
            ("ONE", "One Layer", "The layer in the panel Lines"),
            ("ALL", "All Layers", "All layers of lines that are to be seen, the lowest first, as one drawing on each frame"),
        ),
    )
    filter_glob: bpy.props.StringProperty(default="*.json", options={"HIDDEN"})
    check_existing: bpy.props.BoolProperty(default=True, options={"HIDDEN"})

    def invoke(self, context, _event):
        if not self.filepath:
            self.filepath = f"{context.object.name}.json"
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def check(self, _context) -> bool:
        """Called by Blender when a name was typed. With the ending in the name, the file browser asks before a file is replaced."""
        path = bpy.path.ensure_ext(self.filepath, ".json") if os.path.basename(self.filepath) else self.filepath
        changed = path != self.filepath
        if changed:
            self.filepath = path
        return changed

    @classmethod
    def lacking(cls, ob, changes: str) -> str:
        """As `OnShapes.lacking`. Drawings need no footage."""
        why = OnShapes.lacking(ob, changes)
        if not why or not gp.is_drawing(ob):
            return why
        found = [layer for layer in drawings.layers(ob) if gp.has_strokes(layer)]
        return "" if found and (ob.rototoon.pattern or without_footage.lacking(ob) == "") else why

    def run(self, context) -> str:
        if not self.filepath:
            raise Problem("No file chosen")
        path = self._path(context.object)
        if not context.object.rototoon.pattern:
            return self._run_without_footage(context.object, path)
        why = OnShapes.lacking(context.object, self.changes) if self.layers == "ONE" else ""
        if why:
            raise Problem(why)
        reading = document.read(context.object, results=True, needed=False, gaps=True)
        document.need_pictures(context.object, reading)
        older = snapping.older(context.object, reading.document)
        if older:
            self.warn(older)
        self.warn(document.leave_out_missing(reading))
        self.warn(f"left out, since a part has no contours: {part_names.listed(reading.left)}" if reading.left else "")
        beyond = document.reach(reading.document)
        document.round_off(reading.document)
        lines = self._add_lines(context.object, reading.document)
        paint = self._add_paint(context.object, reading.document)
        known_files.save(context.object, path, reading.document)
        if beyond:
            self.warn(f"the footage has no picture for the contours of its pictures {listed(beyond)}: they are written, but render and export end with the footage")
        reshaped = snapping.reshaped(context.object)
        if reshaped:
            self.warn(f"left out: snapped lines that were fitted or cut since, on {listed(reshaped)}; Snap to Ink makes them again")
        found = [counted(len(reading.document["parts"]), "part")] if reading.document["parts"] or not (lines or paint) else []
        found += lines
        found += [f"paint of {counted(paint, 'frame')}"] if paint else []
        return f"{' and '.join(found)} in {os.path.basename(path)}"

    def _path(self, ob) -> str:
        """The file to write. Raises a `Problem` where the ending makes it another file than the one that was named, which the object does not know."""
        given = bpy.path.abspath(self.filepath)
        path = bpy.path.ensure_ext(given, ".json")
        if path != given and os.path.exists(path) and not known_files.is_known(ob, path):
            raise Problem(f"There is a file {os.path.basename(path)} already, which is not this object's: to replace it, choose it with its ending")
        return path

    def _run_without_footage(self, ob, path: str) -> str:
        """Writes drawings as the camera sees them."""
        project = without_footage.document(ob)
        size = project["footage"]["width"], project["footage"]["height"]
        others = self._without_lines(ob)
        found = self._add_lines(ob, project, size)
        if not found and others:
            raise Problem(f"Choose the footage first, in the panel Footage: {others} need it")
        if others:
            self.warn(f"left out: {others}, which need footage")
        if not found:
            raise Problem(f'No lines on "{ob.rototoon.lines_layer}": choose the layer of your lines in the panel Lines, or all layers')
        without_footage.fit(project)
        known_files.save(ob, path, project)
        return f"{' and '.join(found)} in {os.path.basename(path)}, without footage"

    def _without_lines(self, ob) -> str:
        """What the object has beside lines, in words; empty if it has nothing else."""
        contours = any(gp.has_strokes(layer) for layer in gp.layers(ob, ob.rototoon.contours_layer))
        paint = any(st.is_paint(ob, layer) for layer in gp.every_layer(ob))
        return " and ".join(filter(None, ("contours" if contours else "", "paint" if paint else "")))

    def _add_lines(self, ob, document: dict, size: tuple[int, int] | None = None) -> list[str]:
        """Puts the drawings of the layers of lines into a document. Returns what they are, for the message."""
        source = layers_out if self.layers == "ALL" else drawn_out
        written = source.of(ob, drawn.pegs(document), size)
        if written.fields:
            drawn_out.put(document, written.fields)
        if self.layers == "ONE":
            self._warn_of_others(ob)
        if written.lost:
            self.warn(f"left out: strokes with a point without a place (not a number), on {listed(sorted(written.lost))}")
        for name, frames in written.as_between.items():
            self.warn(f'traced strokes of "{name}" go out as in-betweens on {listed(sorted(frames))}, where another layer has in-betweens')
        for name, frames in written.as_traced.items():
            self.warn(f'in-betweens of "{name}" go out as traced strokes on {listed(sorted(frames))}, where another layer has traced ones; none of them fades')
        found = [counted(written.keys, "drawing")] if written.keys else []
        found += [f"traced lines of {counted(written.traced, 'frame')}"] if written.traced else []
        return found + ([counted(written.between, "in-between")] if written.between else [])

    def _warn_of_others(self, ob) -> None:
        """Says which layers have lines that are not written."""
        name = ob.rototoon.lines_layer
        others = [f'"{layer.name}"' for layer in drawings.layers(ob) if layer.name != name and gp.has_strokes(layer)]
        if others:
            self.warn(f'left out: lines on {", ".join(others)}; those of "{name}" are written, the layer in the panel Lines')

    def _add_paint(self, ob, written: dict) -> int:
        """Puts paint into a document. Returns the number of frames that have some."""
        fills, regions = filled.of(ob)
        # Files of earlier versions kept the palette with the fields that they did not know.
        named = kept.fields(written.get("palette")) | filled.palette(ob, fills, regions)
        for name, value in (("palette", named), ("fills", fills), ("filled", regions), ("recolours", recolours.fields(ob))):
            if value:
                written[name] = value
        return len({each["frame"] for each in fills + regions})


CLASSES = (ROTOTOON_OT_export_document,)
