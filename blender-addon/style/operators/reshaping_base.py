"""Base of the operators that make a drawing follow a clip."""

import bpy
from rototoon.style import reshape

from ...blender import guard, preferences
from ...capture import tracking
from ...common import jobs
from ...common.operators import Long, OnContours
from .. import reshaping
from ..clip_properties import shared


class Reshaping(OnContours, Long):
    """Reads the drawing, works in a thread, and writes generated frames after the drawing."""

    sub_keys: bpy.props.IntProperty(
        name="Sub-key Points",
        description="Number of points along each limb, between its key points. They let a limb curve; with 0 it stays nearly "
        "straight",
        default=5,
        min=0,
        max=100,
    )
    folder: shared("folder")

    def invoke(self, context, _event):
        return context.window_manager.invoke_props_dialog(self)

    def work(self, context, clips, before=0.0, more=None):
        """The worker that reshapes the active drawing.

        `clips(progress, threads)` returns clips and options of `reshape`. `before` is its share of the work. `more(drawing)` returns
        further options.
        """
        self._ob = context.object
        if self.changes == guard.DRAWINGS:
            guard.need_some(tracking.contour_layers(self._ob), hidden=True)
        self._drawing = drawing = reshaping.begin(self._ob, context.scene.frame_current)
        threads, sub_keys = preferences.threads(), self.sub_keys
        further = more(drawing) if more is not None else {}

        def run(progress):
            chosen, options = clips(lambda done, step: progress(before * done, step), threads)
            rest = lambda done, step: progress(before + (1 - before) * done, step)  # noqa: E731 - the rest of the bar
            return reshape(drawing.project, chosen, rest, sub_keys=sub_keys, threads=threads, **options, **further)

        return jobs.Worker(run)

    def finish(self, context, work) -> str:
        """Writes the frames."""
        layers = tracking.contour_layers(self._ob)
        guard.need_some(layers, hidden=True)
        frames = reshaping.finish(self._ob, self._drawing, work.result)
        self.warn(guard.left_out(layers, hidden=True))
        given = ", ".join(f"{entry['part']}: {entry['follows']}" for entry in work.result.given)
        return f"{frames} frames after frame {self._drawing.frame}" + (f"; no limb carries {given}" if given else "")
