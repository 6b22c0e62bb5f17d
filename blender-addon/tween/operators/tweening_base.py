"""Bases of the operators that draw in-betweens."""


from ...blender import grease_pencil as gp
from ...blender import guard, preferences
from ...blender import strokes as st
from ...blender.errors import Problem
from ...common import jobs
from ...common.operators import Long, OnDrawing
from ...common.wording import are, counted, listed
from .. import keys as ks
from .. import tweening
from ..charts import Choices

LAYERS = (("ACTIVE", "Active", "The active layer"), ("ALL", "All", "All layers that are neither locked nor hidden"))

SCOPES = (
    ("CURRENT", "Around the Playhead", "The two keys around the current frame"),
    ("SELECTED", "Selected Keys", "Neighbouring keys that are both selected"),
    ("RANGE", "Scene Range", "All keys within the scene's range"),
    ("ALL", "All", "All keys"),
)


class Scoped:
    """An operator with a property `frames` of the items `SCOPES`: between which keys it works."""

    def note_scope(self, context) -> None:
        """Notes what the scopes mean now."""
        scene = context.scene
        self._range = scene.frame_start, scene.frame_end
        self._selected = {
            layer.name: set(gp.frame_numbers(layer, selected=True)) for layer in gp.every_layer(context.object)
        }
        self._now = scene.frame_current

    def in_scope(self, name: str, found: ks.Frames) -> list[tuple[int, int]]:
        """The spans of a layer within the scope."""
        spans = list(zip(found.keys, found.keys[1:]))
        if self.frames == "CURRENT":
            return [span for span in spans if span == ks.around(found.keys, self._now)]
        if self.frames == "SELECTED":
            return [span for span in spans if set(span) <= self._selected[name]]
        if self.frames == "RANGE":
            return [span for span in spans if self._range[0] <= span[0] and span[1] <= self._range[1]]
        return spans


class OnKeys(OnDrawing):
    """An operator that needs a Grease Pencil object with at least two frames on a layer."""

    @classmethod
    def poll(cls, context) -> bool:
        """Called by Blender."""
        if not super().poll(context):
            return False
        if not any(len(layer.frames) > 1 for layer in gp.every_layer(context.object)):
            cls.poll_message_set("Draw on two keys first")
            return False
        return True


def _without_keys(plan: tweening.Plan) -> str:
    """What is said of in-betweens that no longer lie between two keys; empty if there are none."""
    stale = {
        frame
        for name, found in plan.frames.items()
        for frame in set(found.made) - plan.strays[name]
        if not found.keys or not found.keys[0] < frame < found.keys[-1]
    }
    if not stale:
        return ""
    return f"in-betweens on {listed(sorted(stale))} have no key on one side, and stay as they were: delete them, or draw a key there"


class Tweening(OnKeys, Long):
    """Reads the keys, draws in a thread, and writes the in-betweens."""

    def choose(self, name: str, found: ks.Frames, record) -> dict[tuple[int, int], Choices]:
        """The spans of a layer to draw, with their choices."""
        raise NotImplementedError

    def chosen_layers(self, context) -> list:
        """The layers on which to draw."""
        return st.editable_layers(context.object, active=False)

    def begin(self, context):
        self._ob = context.object
        self._current = context.scene.frame_current
        self.warn(guard.left_out(st.drawn_layers(self._ob, active=getattr(self, "layers", "ALL") == "ACTIVE")))
        self._plan = tweening.plan(self._ob, self.chosen_layers(context), self.choose)
        stale = _without_keys(self._plan)
        kept = any(found.edited for found in self._plan.frames.values())
        if not self._plan.calls and not self._plan.current and not kept:
            raise Problem("; ".join(filter(None, (str(tweening.nothing_to_draw(self._plan)), stale, *self._warnings))))
        self.warn(stale)
        plan, threads = self._plan, preferences.threads()
        return jobs.Worker(lambda progress: tweening.draw(plan, progress, threads))

    def finish(self, context, work) -> str:
        done = tweening.finish(self._ob, self._plan)
        said = f"{counted(done.drawings, 'in-between')} in {counted(done.spans, 'span')}" if done.spans else ""
        if not done.spans:
            said = "No in-between was drawn" if done.keys else "Nothing had changed"
        if done.spans and self._plan.current:
            said += f", {counted(self._plan.current, 'span')} up to date"
        if done.keys:
            frames = sorted(done.key_frames)
            on = f"frame{'' if len(frames) == 1 else 's'} {listed(frames)}"
            said += f", {counted(done.keys, 'drawing')} that you had changed {'is a key' if done.keys == 1 else 'are keys'} now: {on}"
        if self._plan.blank:
            left_out, frames = counted(self._plan.blank, "span"), sorted(self._plan.blank_frames)
            self.warn(
                f"{left_out} with a blank key {'was' if self._plan.blank == 1 else 'were'} left out: "
                f"frame{'' if len(frames) == 1 else 's'} {listed(frames)} {are(frames)} blank"
            )
        if done.held:
            spans = ", ".join(f"{first} to {last}" for first, last in sorted(done.held))
            self.warn(
                f"frames {spans}: no movement between the two drawings can be believed, so the earlier one is held; press Match Strokes, "
                "or draw a breakdown"
            )
        if done.exchanged:
            spans = ", ".join(f"{first} to {last} ({counted(count, 'stroke')})" for (first, last), count in sorted(done.exchanged.items()))
            self.warn(
                f"frames {spans}: strokes of one drawing give way to those of the other half way, because it is not sure which belong together; "
                "press Match Strokes, or draw a breakdown"
            )
        return said
