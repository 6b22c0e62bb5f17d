"""Base of the operators that make a drawing follow a clip."""

import bpy
from rototoon.style import Translated, reshape

from ...blender import guard, preferences
from ...blender.errors import Problem
from ...capture import tracking
from ...common import jobs
from ...common.operators import Long, OnContours
from ...common.wording import listed
from .. import reshaping
from ..clip_properties import mirroring, shared


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
    chains: bpy.props.StringProperty(
        name="Chains",
        description="Which chain of the clip's body moves which chain of the drawing's, where their names differ: "
        "l_arm = l_foreleg, r_arm = r_foreleg",
    )
    mirror: shared("mirror")
    folder: shared("folder")

    def invoke(self, context, _event):
        return context.window_manager.invoke_props_dialog(self)

    def work(self, context, clips, before=0.0, more=None):
        """The worker that reshapes the active drawing.

        `clips(progress, threads)` returns clips and options of `reshape`, or a clip that was re-made (`Translated`). `before` is its share of the work. `more(drawing)` returns
        further options.
        """
        self._ob, self._rests_on = context.object, []
        if self.changes == guard.DRAWINGS:
            guard.need_some(tracking.contour_layers(self._ob), hidden=True)
        self._drawing = drawing = reshaping.begin(self._ob, context.scene.frame_current)
        how = {"sub_keys": self.sub_keys, "chains": _pairs(self.chains), "mirror": self.mirror}
        threads = preferences.threads()
        further = more(drawing) if more is not None else {}

        def run(progress):
            chosen, options = clips(lambda done, step: progress(before * done, step), threads), {}
            if isinstance(chosen, Translated):
                chosen, self._rests_on = chosen.clips, chosen.notes
            else:
                chosen, options = chosen
            rest = lambda done, step: progress(before + (1 - before) * done, step)  # noqa: E731 - the rest of the bar
            return reshape(drawing.project, chosen, rest, threads=threads, **how, **options, **further)

        return jobs.Worker(run)

    def finish(self, context, work) -> str:
        """Writes the frames."""
        layers = tracking.contour_layers(self._ob)
        guard.need_some(layers, hidden=True)
        written = reshaping.finish(self._ob, self._drawing, work.result)
        frames, kept, hidden = written.frames, _on_frames(written.kept), _on_frames(written.hidden)
        self.warn(f"your corrections stay: {kept}; Release Pins lets them follow the clip" if kept else "")
        self.warn(f"parts that you marked as hidden have no contour: {hidden}; Part Is Hidden Here shows them again" if hidden else "")
        self.warn(guard.left_out(layers, hidden=True))
        self.tell(context, work.result, frames)
        given = ", ".join(f"{entry['part']}: {entry['follows']}" for entry in work.result.given)
        mirrored = mirroring(work.result.looks, work.result.mirrored)
        return f"{frames} frames after frame {self._drawing.frame}{mirrored}" + (f"; no limb carries {given}" if given else "")

    def tell(self, context, result, frames: int) -> None:
        """Warns of what a person should know about a result of so many frames."""
        self.warn(self._drawing.idle)
        self.warn(unmoved(result.still))
        for note in (*self._rests_on, *result.notes):
            self.warn(note)
        end, last = context.scene.frame_end, self._drawing.frame + frames
        self.warn(f"the frames go on to {last}, beyond the end of the scene ({end})" if last > end else "")


def _on_frames(parts: dict[str, list[int]]) -> str:
    """Parts with their frames, as text."""
    return ", ".join(f'"{part}" on {listed(on)}' for part, on in parts.items())


def _pairs(text: str) -> list[list[str]]:
    """Pairs of chains from a text such as "l_arm = l_foreleg, r_arm = r_foreleg"."""
    pairs = [[name.strip() for name in pair.split("=")] for pair in text.split(",") if pair.strip()]
    for pair in pairs:
        if len(pair) != 2 or not all(pair):
            raise Problem(f'Chains: found {"=".join(pair)!r}, expected pairs such as "l_arm = l_foreleg"')
    return pairs


def unmoved(chains: list[str]) -> str:
    """The warning about chains of the drawing's body that keep their shape; empty if there are none."""
    return f"no chain of the clip moves {', '.join(chains)}: see Chains" if chains else ""
