"""Base of the operators that trace: which frames, and how the drawings are."""

from __future__ import annotations

import bpy

from ...common.operators import Long, OnDrawing
from .. import choosing, properties, run, tracing
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
        return run.sensitivity(settings, self.sensitivity)


class Tracing(Framed, Sensitive, Long, OnFootage):
    """Traces in a thread, and writes the strokes in slices."""

    style: bpy.props.EnumProperty(
        name="Drawing",
        description="The kind of drawing",
        items=(("SETTINGS", "As in the Panel", "The kind chosen in the panel"), *properties.STYLES),
    )

    def start(self, context, chosen: choosing.Chosen):
        """The worker for some layers."""
        self._ob = context.object
        choices = run.Choices("" if self.style == "SETTINGS" else self.style.lower(), self.sensitivity, self.hold)
        self._begun = run.begin(self._ob, chosen, self.span(context), choices)
        return self._begun.worker

    def finish(self, _context, work):
        done = yield from tracing.finishing(self._ob, self._begun.plan, work.result, self._begun.home)
        for text in run.warnings(done):
            self.warn(text)
        return run.told(done)
