"""Conform as a function: an object moved to footage that was delivered again, with what became of the frames as data."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass

import bpy
from rototoon.types import Progress

from ..blender import footage, stage
from ..blender.errors import Problem
from ..common import jobs
from ..common.operators import OnDrawing
from ..conform import comparing, run
from .refusing import need, told


@dataclass(frozen=True)
class Moved:
    """Result of `conform`. All frames are scene frames."""

    scale: float
    """Pixels of the new picture for each pixel of the old one."""
    shift: tuple[float, float]
    """The place of the old picture's corner, in pixels of the new one."""
    same: dict[int, int]
    """By new frame the old frame whose drawing it shows."""
    redrawn: dict[int, int]
    """By new frame the old frame whose drawing was drawn again."""
    new: tuple[int, ...]
    """New frames with a drawing that the old footage does not have, rising."""
    gone: tuple[int, ...]
    """Old frames whose drawing is gone, rising."""
    warnings: tuple[str, ...]
    """What the operator would report as a warning: what did not simply go with its drawing, and what stayed as it was."""


@told
def conform(
    ob: bpy.types.Object,
    pattern: str,
    frames: tuple[int, int] | None = None,
    *,
    begins: int | None = None,
    scale: float | None = None,
    shift: Sequence[float] | None = None,
    frame_offset: int | None = None,
    hold_gaps: bool = False,
    progress: Progress | None = None,
) -> Moved:
    """Moves an object to footage that was delivered again, as the operator Conform to New Footage.

    `pattern` is any picture of the sequence, or its name with one ``%d`` or ``%04d``, absolute or relative to the file. `frames` are the numbers of the first and the
    last picture; by default they are found. `begins` is the scene frame of the first picture; by default most drawings stay on their frames. `scale` and
    `shift` are found by the pictures, unless they are given. With `frame_offset`, this number is added to those of the pictures and nothing is compared, so the
    old footage may be gone. `hold_gaps` takes a missing number for the picture before it.

    `progress(fraction, step)` is called on this thread; it returns ``False`` to cancel, which raises `RuntimeError` and changes nothing.
    """
    need(ob, OnDrawing)
    run.need(ob)
    jobs.clear_the_way()
    shot, old = _shot(ob, pattern, frames, hold_gaps), ob.rototoon.frame_offset
    worker = run.begin(ob, shot, comparing.Asked(scale, None if shift is None else tuple(shift), frame_offset))
    worker.run_here(progress)
    done = jobs.drained(run.finishing(ob, shot, worker.result, begins))
    found, offset = done.found, done.offset
    same, redrawn = ({new + offset: picture + old for new, picture in pairs.items()} for pairs in (found.same, found.redrawn))
    return Moved(found.scale, found.shift, same, redrawn, tuple(done.times.new), tuple(done.times.gone), tuple(done.warnings))


def _shot(ob, pattern: str, frames: tuple[int, int] | None, hold_gaps: bool) -> stage.Shot:
    path = bpy.path.abspath(os.fspath(pattern))
    if frames is not None and "%" in path:
        first, last = frames
        if first > last:
            raise Problem(f"frames: found {first} to {last}, expected the first number and then the last one")
    else:
        sequence = footage.sequence_around(_any_of(path) if "%" in path else path, hold_gaps)
        path, (first, last) = sequence.pattern, frames or (sequence.first, sequence.last)
    width, height = footage.size_of(footage.picture(path, first))
    return stage.Shot(path, first, last, width, height, footage.rate(ob), 0, hold_gaps=hold_gaps)


def _any_of(path: str) -> str:
    """The first picture of a pattern."""
    folder, name = os.path.split(path)
    parts = re.split(r"%0?\d*d", name)
    if len(parts) != 2:
        raise Problem(f"pattern: found {path!r}, expected a picture, or a name with one %d or %04d for the number")
    wanted = re.compile(re.escape(parts[0]) + r"(\d+)" + re.escape(parts[1]))
    there = [(int(found[1]), each) for each in (os.listdir(folder) if os.path.isdir(folder) else ()) if (found := wanted.fullmatch(each))]
    if not there:
        raise Problem(f"pattern: no file has a name like {path}")
    return os.path.join(folder, min(there)[1])
