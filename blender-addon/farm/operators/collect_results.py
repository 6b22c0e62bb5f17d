"""Collect Results: takes finished tracks and paint of a batch in."""

from collections.abc import Mapping
from typing import Any

import bpy

from ...blender.errors import Problem
from ...common import jobs
from ...common.operators import Long
from ...common.wording import counted, listed
from .. import collecting, painting
from .send_to_farm import folder_of

NAMED = 3
"""Largest number of parts that a message names."""


class ROTOTOON_OT_collect_results(Long, bpy.types.Operator):
    bl_idname = "rototoon.collect_results"
    bl_label = "Collect Results"
    bl_description = (
        "Take the tracks, snapped lines and paint of a batch into the objects that were sent. What you changed since then stays: there the results "
        "are left out, and Track or Fill Drawings makes them anew. Contours on hidden layers are taken too, locked layers are not changed"
    )
    bl_options = {"REGISTER", "UNDO"}

    directory: bpy.props.StringProperty(name="Folder", description="The folder that Send to Farm wrote to", subtype="DIR_PATH")
    filter_folder: bpy.props.BoolProperty(default=True, options={"HIDDEN"})

    def invoke(self, context, _event):
        """Called by Blender: asks for the folder."""
        self._picked = True
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def begin(self, context):
        folder = folder_of(self.directory, "Choose the folder that Send to Farm wrote to")
        self._scene, path = context.scene, bpy.data.filepath
        return jobs.Worker(lambda _progress: collecting.results_of(folder, path))

    def finish(self, _context, work):
        results = work.result
        if not results:
            raise Problem("This file has no shot in the batch: open one of the files that were sent")
        shots = contours = regions = 0
        failed: list[str] = []
        for result in results:
            ob = self._scene.objects.get(result.object)
            why = result.failure if result.document is None else "" if ob is not None else "no such object in the scene"
            whys, taken, painted = ([why], None, None) if why else (yield from _take(ob, result.document))
            failed += [f'"{result.object}": {why}' for why in whys]
            if taken is not None:
                contours += taken.contours
                self._say_kept(result.object, taken)
            regions += painted.regions if painted is not None else 0
            shots += taken is not None or painted is not None
        if not shots:
            raise Problem("Nothing was taken: " + "; ".join(failed))
        self.warn("; ".join(failed))
        found = [counted(contours, "contour")] if contours or not regions else []
        found += [counted(regions, "painted region")] if regions else []
        return f"{' and '.join(found)} taken into {counted(shots, 'object')}"

    def _say_kept(self, name: str, taken: collecting.Taken) -> None:
        said = [f'"{part}" on {listed(frames)}' for part, frames in taken.kept.items()]
        if len(said) > NAMED:
            said[NAMED:] = [f"{counted(len(said) - NAMED, 'more part')}"]
        if said:
            self.warn(f'"{name}" was changed since it was sent, and stays as it is: {", ".join(said)}; press Track')
        self.warn(taken.left)


def _take(ob, result: Mapping[str, Any]):
    """Takes contours and paint in, each though the other could not be taken. Returns why something was not, and what was taken of each."""
    works = []
    if result.get("parts"):
        works.append(collecting.collecting)
    if result.get("filled"):
        works.append(painting.taking)
    failed, taken = [], {}
    for work in works:
        try:
            taken[work] = yield from work(ob, result)
        except Problem as problem:
            failed.append(str(problem))
    if not works:
        failed.append("its result is empty")
    return failed, taken.get(collecting.collecting), taken.get(painting.taking)


CLASSES = (ROTOTOON_OT_collect_results,)
