"""Fit Strokes."""

import bpy
import numpy as np

from ...blender import grease_pencil as gp
from ...blender import guard, marks, placement, projection, seen, selection
from ...blender import strokes as st
from ...blender.errors import Problem
from ...blender.frames import kept
from ...common import jobs
from ...common.operators import Long, OnDrawing
from ...common.wording import counted, joined
from ...lines import rototoon_changes as traced_changes
from ...tween import rototoon_changes
from .. import fitting, weights


class ROTOTOON_OT_fit_strokes(Long, OnDrawing, bpy.types.Operator):
    bl_idname = "rototoon.fit_strokes"
    bl_label = "Fit Strokes"
    bl_description = (
        "Turn strokes into smooth curves with few points, within the tolerance. "
        "Radius, opacity, colours and other attributes are carried over"
    )
    bl_options = {"REGISTER", "UNDO"}

    tolerance: bpy.props.FloatProperty(
        name="Tolerance",
        description="Largest distance between the stroke and the curve",
        default=1.0,
        min=1e-6,
        soft_min=0.05,
        soft_max=20.0,
    )
    unit: bpy.props.EnumProperty(
        name="Unit",
        description="Unit of the tolerance",
        items=(
            ("PIXELS", "Pixels", "Pixels of the footage. Without footage, of the camera's picture"),
            ("WORLD", "World", "Units of the scene"),
        ),
    )
    frames: bpy.props.EnumProperty(
        name="Frames",
        description="Which drawings are fitted",
        items=(
            ("CURRENT", "Current", "The drawings that show on the current frame"),
            ("SELECTED", "Selected", "The drawings of the selected keyframes"),
            ("ALL", "All", "All drawings"),
        ),
    )
    layers: bpy.props.EnumProperty(
        name="Layers",
        description="Layers to fit. Locked and hidden layers are not changed",
        items=(("ACTIVE", "Active", "The active layer"), ("ALL", "All", "All layers")),
        default="ALL",
    )
    selected: bpy.props.BoolProperty(
        name="Selected Strokes Only", description="In edit mode, only strokes with a selected point", default=False
    )

    def invoke(self, context, event):
        """Called by Blender. It asks first where weights of vertex groups may be lost."""
        if bpy.app.background or context.window is None or not weights.groups(context.object):
            return super().invoke(context, event)
        # The answer calls `execute`.
        self._picked = True
        title = "Fit strokes with weights of vertex groups?"
        return context.window_manager.invoke_confirm(self, event, title=title, message=weights.LOST, confirm_text="Fit")

    def begin(self, context):
        self._ob = context.object
        self.warn(guard.left_out(st.drawn_layers(self._ob, self.layers == "ACTIVE")))
        layers = st.editable_layers(self._ob, self.layers == "ACTIVE")
        self._drawings = [(layer.name, number) for layer in layers for number in self._numbers(layer, context.scene.frame_current)]
        self._travels = self.unit == "PIXELS" and self.frames != "CURRENT" and placement.moves(self._ob, layers)
        if self._travels:
            self._drawings.sort(key=lambda each: each[1])
        if not self._drawings:
            raise Problem(
                "No drawings to fit on these frames: choose other frames or layers, or unlock the layers. "
                "Contours are not changed"
            )
        self._done, self._seen, self._deep = [], seen.Seen(self._ob), 0
        return jobs.Stepper(self._steps(context.scene), "Fitting")

    def _numbers(self, layer, current: int) -> list[int]:
        if self.frames == "CURRENT":
            shown = st.shown_frame(layer, current)
            return [] if shown is None else [shown]
        return gp.frame_numbers(layer, selected=self.frames == "SELECTED")

    def _steps(self, scene):
        slots = marks.Slots(self._ob.data)
        with kept(scene):
            for index, (name, number) in enumerate(self._drawings):
                if self._travels and number != scene.frame_current:
                    # A pixel is as large as the camera shows it there.
                    scene.frame_set(number)
                layer = gp.find_layer(self._ob, name)
                handle = gp.drawings(layer)[number][0]
                content = st.read(handle)
                fitted = fitting.fit(content, self._wanted(handle, content), *self._scale(layer, content))
                self._deep += 0 if fitted is None else fitted.deep
                if fitted is not None and fitted.fitted:
                    traced_changes.follow(content, fitted.content, np.arange(len(content.sizes)), slots)
                    self._done.append((name, number, fitted))
                    self._seen.note(name, number, content)
                yield (index + 1) / len(self._drawings)

    def _wanted(self, handle, content: st.Content) -> np.ndarray:
        if not self.selected or self._ob.mode != "EDIT" or not len(content.sizes):
            return np.ones(len(content.sizes), bool)
        starts = content.starts[:-1]
        some = np.add.reduceat(np.append(selection.selected_points(handle), False).astype(int), starts)
        return (some > 0) & (content.sizes > 0)

    def _scale(self, layer, content: st.Content) -> tuple[float, float]:
        """Pixels per unit of the layer, and the tolerance in pixels."""
        if self.unit == "WORLD":
            # The pixel is the tolerance, so the units of the scene do not matter.
            return max(projection.world_scale(self._ob, layer), 1e-12) / self.tolerance, 1.0
        points = content.point["position"]
        points = points[np.isfinite(points).all(1)]
        if not len(points):
            return 1.0, self.tolerance
        scale = projection.Projection(self._ob).scale(layer, points)
        if not scale > 0:
            raise Problem("The drawing cannot be seen: set its scale or the camera's, or measure in world units")
        return scale, self.tolerance

    def finish(self, context, work) -> str:
        guard.need_open(gp.find_layer(self._ob, name) for name in sorted({name for name, *_ in self._done}))
        self._seen.need((name, number) for name, number, _ in self._done)
        with traced_changes.kept(self._ob) as traced, rototoon_changes.kept(self._ob) as made:
            for name, number, fitted in self._done:
                st.write(gp.drawings(gp.find_layer(self._ob, name))[number][0], fitted.content)
        marks.remember(self._ob.data)
        self._ob.data.update_tag()
        if self._deep:
            stay = "1 stroke lies in no plane and stays" if self._deep == 1 else f"{self._deep} strokes lie in no plane and stay"
            self.warn(f"{stay}: a curve would be farther away than the tolerance")
        strokes = sum(fitted.fitted for *_, fitted in self._done)
        if not strokes:
            return "No stroke became lighter"
        self.warn(weights.warning(self._ob))
        before, after = (sum(getattr(f, side) for *_, f in self._done) for side in ("before", "after"))
        skipped = sum(fitted.skipped for *_, fitted in self._done)
        layers = {name for name, *_ in self._done}
        lighter = {layer: {number for name, number, fitted in self._done if name == layer and fitted.fitted} for layer in layers}
        said = f"{counted(strokes, 'stroke')} fitted: {before} points became {after}"
        return joined(said, f"{skipped} not changed" if skipped else "", made.said(lighter), traced.said(lighter))


CLASSES = (ROTOTOON_OT_fit_strokes,)
