"""Fill Drawings: the artist's colours on all frames."""

import bpy

from ...blender import preferences
from ...common.operators import Long
from ...common.wording import counted, listed
from ...lines import properties
from ...lines.operators.tracing_base import Framed, OnFootage, Sensitive
from .. import filling, recolours
from .. import plan as pl


class ROTOTOON_OT_fill_drawings(Framed, Sensitive, Long, OnFootage, bpy.types.Operator):
    bl_idname = "rototoon.fill_drawings"
    bl_label = "Fill Drawings"
    bl_description = (
        "Paint the regions of all drawings with the colours of the shapes that you filled on one frame or several, on a layer below the "
        "lines. Your shapes stay as they are. Change a region on a later frame and press it again: what follows has that colour, too"
    )
    bl_options = {"REGISTER", "UNDO"}

    def begin(self, context):
        self._ob = context.object
        settings = self._ob.rototoon
        self._plan = pl.make(self._ob, pl.layer_name(self._ob), *self.span(context))
        self._plan.hold = self.hold
        chosen = self.chosen_sensitivity(settings), settings.fill_confidence, preferences.threads(), properties.left_out(settings)
        options = filling.Options(*chosen)
        return filling.worker(self._plan, options)

    def finish(self, _context, work):
        done = yield from filling.finishing(self._ob, self._plan, work.result)
        self.warn(f"a shape of yours lies on a line: {_named(done.missed)}" if done.missed else "")
        self.warn(f"not painted, since no drawing of yours shows the same: {_named(done.unrelated)}" if done.unrelated else "")
        if done.overruled:
            self.warn(f"no line was found between shapes of yours of other colours, so one of them fills both: {_named(done.overruled)}")
        self.warn(f"hardly any region was found: {_named(done.bare)}; a higher Sensitivity finds fainter lines" if done.bare else "")
        if done.leaking:
            self.warn(f"a shape of yours fills all up to the picture's edge through a gap in a line: {_named(done.leaking)}")
        names = {frame: {click.name for click in own} for frame, own in self._plan.clicks.items()}
        self.warn(recolours.told(recolours.unchanged(recolours.entries(self._ob).values(), names)))
        self.warn(_doubts(done))
        return f"{counted(done.regions, 'region')} on {counted(len(done.frames), 'frame')}"


def _named(frames: set[int]) -> str:
    return f"{'frame' if len(frames) == 1 else 'frames'} {listed(sorted(frames))}"


def _doubts(done: filling.Done) -> str:
    count = sum(done.doubtful.values())
    are = "1 region is" if count == 1 else f"{count} regions are"
    return f"{are} probably wrong: press Next Doubtful Region" if count else ""


CLASSES = (ROTOTOON_OT_fill_drawings,)
