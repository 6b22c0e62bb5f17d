"""Base of the operators that trace: which frames, how the drawings are, and what the report says."""

from __future__ import annotations

import bpy

from ...blender import guard, preferences
from ...common.operators import Long, OnDrawing
from ...common.wording import counted, listed
from .. import choosing, doubts, properties, tracing
from .. import drawings as dr
from .. import plan as pl

FRAMES = (
    ("ALL", "All", "All frames of the footage"),
    ("RANGE", "Scene Range", "The frames that the scene plays: its preview range if it has one"),
    ("CURRENT", "Current", "Only the current frame"),
)


class OnFootage(OnDrawing):
    """An operator that needs an active Grease Pencil object with footage."""

    @classmethod
    def lacking(cls, ob, changes: str) -> str:
        """As `OnDrawing.lacking`."""
        return super().lacking(ob, changes) or ("" if ob.rototoon.pattern else "Choose the footage first, in the panel Footage")


class Framed:
    """An operator that draws on frames of the footage."""

    frames: bpy.props.EnumProperty(name="Frames", description="Which frames are drawn", items=FRAMES)
    hold: bpy.props.BoolProperty(
        name="Hold",
        description="A frame that shows the same drawing as the one before, as in films on twos, holds it. The grain of a scan makes no difference",
        default=True,
    )

    def span(self, context) -> tuple[int, int]:
        """First and last scene frame to draw."""
        scene = context.scene
        if self.frames == "CURRENT":
            return scene.frame_current, scene.frame_current
        if self.frames == "ALL":
            return pl.film(context.object)
        if scene.use_preview_range:
            return scene.frame_preview_start, scene.frame_preview_end
        return scene.frame_start, scene.frame_end


class Sensitive:
    """An operator that looks for ink."""

    sensitivity: bpy.props.FloatProperty(
        name="Sensitivity",
        description="Sensitivity to faint ink: with 2, ink may be half as dark as usual. 0 is that of the panel",
        default=0.0,
        min=0.0,
        max=10.0,
    )

    def chosen_sensitivity(self, settings) -> float:
        """The operator's own sensitivity, or that of the panel. The least one is 0.1, because 0 means the panel's."""
        return max(self.sensitivity, 0.1) if self.sensitivity else settings.line_sensitivity


class Tracing(Framed, Sensitive, Long, OnFootage):
    """Traces in a thread, and writes the strokes in slices."""

    style: bpy.props.EnumProperty(
        name="Drawing",
        description="The kind of drawing",
        items=(("SETTINGS", "As in the Panel", "The kind chosen in the panel"), *properties.STYLES),
    )

    def start(self, context, chosen: choosing.Chosen):
        """The worker for some layers."""
        self._ob, self._home = context.object, chosen.home
        self._plan = plan_of(self._ob, chosen.layers, *self.span(context), chosen.home if chosen.new else "")
        self._plan.hold = self.hold
        settings = self._ob.rototoon
        style = settings.line_style if self.style == "SETTINGS" else self.style
        chosen = style.lower(), self.chosen_sensitivity(settings), preferences.threads(), properties.left_out_of_lines(settings)
        options = tracing.Options(*chosen)
        return tracing.worker(self._plan, options)

    def finish(self, _context, work):
        done = yield from tracing.finishing(self._ob, self._plan, work.result, self._home)
        self.warn(where_to_look(done))
        self.warn(where_nothing_is(done))
        self.warn(where_another_picture_is(done))
        self.warn(doubts.told(done.confidence))
        return told(done)


def plan_of(ob, names: list[str], first: int, last: int, home: str) -> pl.Plan:
    """The plan for some layers and scene frames; `home` is as for `plan.make`. Reads the layers, and changes nothing."""
    guard.need_apart(ob, names)
    wanted = {frame for layer in dr.read(ob, names) for frame in pl.needed(layer, first, last)}
    return pl.make(ob, dr.read(ob, names, wanted), first, last, home)


def where_to_look(done: tracing.Done) -> str:
    """The frames on which many strokes end or begin; empty if there are none."""
    return f"many strokes end or begin on {listed(sorted(done.breaks))}: look there, and give a drawing of yours" if done.breaks else ""


def where_nothing_is(done: tracing.Done) -> str:
    """The frames on which hardly any line was found; empty if there are none."""
    frames = "frame" if len(done.bare) == 1 else "frames"
    return f"no line or hardly any was found on {frames} {listed(sorted(done.bare))}; a higher Sensitivity finds fainter ink" if done.bare else ""


def where_another_picture_is(done: tracing.Done) -> str:
    """The frames on which a drawing of the artist lies beside the lines of its picture; empty if there are none."""
    if not done.off:
        return ""
    which = f"your drawing on frame {min(done.off)} does not lie" if len(done.off) == 1 else f"your drawings on frames {listed(sorted(done.off))} do not lie"
    return f"{which} on the lines of the picture, which may have been drawn anew: the strokes are marked; draw them again, or delete the drawing and trace it"


def told(done: tracing.Done) -> str:
    """What a run has done."""
    if not done.frames:
        return "All of these frames have drawings of yours: nothing was drawn"
    text = f"{counted(len(done.numbers), 'stroke')} on {counted(len(done.frames), 'frame')}"
    return ", ".join(filter(None, (text, keys_now(done.kept))))


def keys_now(kept: int) -> str:
    """That a number of traced drawings are the artist's now; empty if there are none."""
    if kept == 1:
        return "1 drawing that you had changed is a key now"
    return f"{kept} drawings that you had changed are keys now" if kept else ""
