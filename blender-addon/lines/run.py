"""Trace Drawing and Carry Strokes as one run, for the operators and for scripts: from the layers that it takes to what is told of it."""

from __future__ import annotations

from dataclasses import dataclass

from ..blender import guard, preferences
from ..common import jobs
from ..common.wording import counted, listed
from . import choosing, doubts, properties, tracing
from . import drawings as dr
from . import plan as pl

LEAST, MOST = 0.1, 10.0
"""The least and the greatest sensitivity. 0 means that of the panel."""


@dataclass(frozen=True)
class Choices:
    """What is chosen for a run; empty and 0 are as in the panel."""

    style: str = ""
    """``auto``, ``clean`` or ``rough``."""
    sensitivity: float = 0.0
    hold: bool = True
    """Whether a frame with the same picture as the one before holds its drawing."""


@dataclass
class Run:
    """A run that was begun."""

    plan: pl.Plan
    worker: jobs.Worker
    home: str
    """The layer of new strokes."""


def begin(ob, chosen: choosing.Chosen, span: tuple[int, int], choices: Choices) -> Run:
    """A run for some layers on the scene frames from the first to the last of `span`. Its worker is not started. Changes nothing."""
    plan = plan_of(ob, chosen.layers, *span, chosen.home if chosen.new else "")
    plan.hold = choices.hold
    settings = ob.rototoon
    style = choices.style or settings.line_style.lower()
    options = tracing.Options(style, sensitivity(settings, choices.sensitivity), preferences.threads(), properties.left_out_of_lines(settings))
    return Run(plan, tracing.worker(plan, options), chosen.home)


def sensitivity(settings, own: float) -> float:
    """A sensitivity of one's own, or that of the panel if it is 0."""
    return max(own, LEAST) if own else settings.line_sensitivity


def plan_of(ob, names: list[str], first: int, last: int, home: str) -> pl.Plan:
    """The plan for some layers and scene frames; `home` is as for `plan.make`. Reads the layers, and changes nothing."""
    guard.need_apart(ob, names)
    wanted = {frame for layer in dr.read(ob, names) for frame in pl.needed(layer, first, last)}
    return pl.make(ob, dr.read(ob, names, wanted), first, last, home)


def warnings(done: tracing.Done) -> list[str]:
    """What needs attention after a run."""
    said = (where_to_look(done), where_nothing_is(done), where_another_picture_is(done), doubts.told(done.confidence))
    return [text for text in said if text]


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
