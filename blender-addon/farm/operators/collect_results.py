"""Collect Results: takes finished tracks, lines and paint of a batch in."""

from contextlib import suppress
from dataclasses import dataclass, field

import bpy

from ...blender import footage
from ...blender import grease_pencil as gp
from ...blender.errors import Problem
from ...common import jobs
from ...common.operators import Long
from ...common.wording import counted, listed, stayed
from ...lines import doubts
from ...lines import tracing as lines_tracing
from ...lines.run import keys_now, where_to_look
from ...paint import filling
from .. import collecting, painting, tracing
from .send_to_farm import folder_of

NAMED = 3
"""Largest number of parts that a message names."""


class ROTOTOON_OT_collect_results(Long, bpy.types.Operator):
    bl_idname = "rototoon.collect_results"
    bl_label = "Collect Results"
    bl_description = (
        "Take the tracks, snapped and traced lines and paint of a batch into the objects that were sent. What you changed since then stays: there the "
        "results are left out, and Track, Trace Drawing, Carry Strokes or Fill Drawings makes them again. Contours on hidden layers are taken too, locked "
        "layers are not changed"
    )
    bl_options = {"REGISTER", "UNDO"}

    directory: bpy.props.StringProperty(
        name="Folder",
        description="The folder that Send to Farm wrote to",
        subtype="DIR_PATH",
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
    )
    sent_from: bpy.props.StringProperty(
        name="Sent From",
        description="Name of the file that was sent, such as shot_v001.blend, if this file is a later version of it. If empty, this file's name",
        options={"SKIP_SAVE"},
    )
    filter_folder: bpy.props.BoolProperty(default=True, options={"HIDDEN"})

    def invoke(self, context, _event):
        """Called by Blender: asks for the folder."""
        self._picked = True
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def begin(self, context):
        folder = folder_of(self.directory, "Choose the folder that Send to Farm wrote to")
        self._scene, path, patterns = context.scene, self.sent_from or bpy.data.filepath, _patterns(context.scene)

        def read(progress) -> list[collecting.Result]:
            results = collecting.results_of(folder, path)
            if not results:
                raise collecting.not_sent(folder, path)
            tracing.find_held(results, patterns, progress)
            return results

        return jobs.Worker(read)

    def finish(self, _context, work):
        results = work.result
        found = _Found()
        failed: list[str] = []
        for result in results:
            ob = self._scene.objects.get(result.object)
            why = result.failure if result.document is None else "" if ob is not None else "no such object in the scene"
            whys = [why] if why else (yield from self._take(ob, result, results, found))
            failed += [f'"{result.object}": {why}' for why in whys]
        if not found.objects:
            raise Problem("Nothing was taken: " + "; ".join(failed))
        self.warn("; ".join(failed))
        if not (found.contours or found.strokes or found.regions) and not self._warnings:
            self.warn("the results have no contour beside your keys, no line and no paint")
        return str(found)

    def _take(self, ob, result: collecting.Result, results: list[collecting.Result], found: "_Found"):
        """Takes contours, lines and paint of one of the results in, each though the others could not be taken. Returns why something was not."""
        works = []
        if result.document.get("parts"):
            works.append((collecting.collecting(ob, result.document, result.numbers), self._count_contours))
        if result.lines:
            works.append((tracing.taking(ob, result, results), self._count_lines))
        if result.document.get("filled"):
            works.append((painting.taking(ob, result.document), self._count_paint))
        failed = [] if works else ["its result is empty"]
        for work, count in works:
            try:
                done = yield from work
            except Problem as problem:
                failed.append(str(problem))
                continue
            found.objects.add(ob.name)
            count(ob.name, done, found)
        return failed

    def _count_contours(self, name: str, taken: collecting.Taken, found: "_Found") -> None:
        found.contours += taken.contours
        self._say_kept(name, taken)

    def _count_lines(self, name: str, done: lines_tracing.Done, found: "_Found") -> None:
        found.strokes += len(done.numbers)
        found.kept += done.kept
        for text in (where_to_look(done), doubts.told(done.confidence)):
            self.warn(f'"{name}": {text}' if text else "")

    def _count_paint(self, _name: str, done: filling.Done, found: "_Found") -> None:
        found.regions += done.regions

    def _say_kept(self, name: str, taken: collecting.Taken) -> None:
        if taken.kept:
            self.warn(f'"{name}" was changed since it was sent, and stays as it is: {_parts(taken.kept)}; press Track')
        if taken.hidden:
            self.warn(f'"{name}" has parts that are hidden since it was sent, and stay so: {_parts(taken.hidden)}')
        self.warn(f'"{name}" has no such parts any more, so their results were left out: {_named(taken.missing)}' if taken.missing else "")
        self.warn(f'"{name}" has parts that are not in the results: {_named(taken.new)}; press Track' if taken.new else "")
        self.warn(f'"{name}": {stayed("snapped drawing", taken.edited)}' if taken.edited else "")
        self.warn(taken.left)


def _parts(frames: dict[str, list[int]]) -> str:
    """Parts with their frames, in words."""
    return _shortened([f'"{part}" on {listed(own)}' for part, own in frames.items()])


def _named(parts: list[str]) -> str:
    """Parts, in words."""
    return _shortened([f'"{part}"' for part in parts])


def _shortened(said: list[str]) -> str:
    if len(said) > NAMED:
        said[NAMED:] = [f"{counted(len(said) - NAMED, 'more part')}"]
    return ", ".join(said)


@dataclass
class _Found:
    """What was taken."""

    contours: int = 0
    strokes: int = 0
    regions: int = 0
    kept: int = 0
    """Number of traced drawings that the artist had changed before they were sent: they are keys now."""
    objects: set[str] = field(default_factory=set)

    def __str__(self) -> str:
        """What the artist is told."""
        nouns = (self.contours, "contour"), (self.strokes, "traced stroke"), (self.regions, "painted region")
        said = [counted(number, noun) for number, noun in nouns if number] or ["Nothing was"]
        told = ", ".join(said[:-1]) + " and " + said[-1] if len(said) > 1 else said[0]
        into = counted(len(self.objects), "object")
        if not any(number for number, _ in nouns) and len(self.objects) <= NAMED:
            into = " and ".join(f'"{name}"' for name in sorted(self.objects))
        return ", ".join(filter(None, (f"{told} taken into {into}", keys_now(self.kept))))


def _patterns(scene) -> dict[str, str]:
    """The footage of the objects of a scene whose pictures are there."""
    found = {}
    for ob in scene.objects:
        if gp.is_drawing(ob) and ob.rototoon.pattern:
            with suppress(Problem):
                found[ob.name] = footage.pattern_of(ob)
    return found


CLASSES = (ROTOTOON_OT_collect_results,)
