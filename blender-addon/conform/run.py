"""One run of Conform: the comparison, and then everything that follows from it. The operator and scripts share it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from ..blender import guard, stage
from ..blender.errors import Problem
from ..common import jobs
from . import comparing, layers, telling, times, writing


@dataclass
class Done:
    """What a run did."""

    found: comparing.Conformed
    times: times.Times
    offset: int
    """The scene shows picture n of the new footage on frame n + offset."""
    text: str
    warnings: list[str] = field(default_factory=list)


def begin(ob, shot: stage.Shot, asked: comparing.Asked) -> jobs.Worker:
    """Makes the comparison. Raises a `Problem` if the object cannot be moved, whatever it gives."""
    need(ob)
    return comparing.worker(ob, shot, asked)


def need(ob) -> None:
    """Raises a `Problem` if the object has no footage, if what shows it belongs to another file, or if a layer that goes along is locked."""
    if not ob.rototoon.pattern:
        raise Problem("Choose the footage first, in the panel Footage")
    stage.need_shown(ob)
    guard.need_open(layers.ours(ob), hidden=True)


def finishing(ob, shot: stage.Shot, compared: comparing.Compared, begins: int | None) -> Iterator[float]:
    """Moves the object, in steps. Returns a `Done`. `begins` is the scene frame of the first new picture; `None` lets most drawings stay on their frames.

    What may be refused is refused before the first change."""
    need(ob)
    old = comparing.pictures_of(ob)
    stays = times.stay(compared.found, old)
    offset = stays if begins is None else begins - shot.first
    shot = replace(shot, frame_of_first=shot.first + offset)
    there = times.Times(compared.found, old, offset)
    ready = yield from writing.preparing(ob, compared, there, (shot.width, shot.height))
    moved = any("position" in each for each in ready.changes.values())
    warnings = [*telling.warnings(ready.plan, there), *telling.of_surroundings(ob, there, moved, ready.still)]
    yield from writing.writing(ob, ready, compared, there, shot)
    text = "; ".join(filter(None, (telling.of_footage(compared.found, there), telling.of_scene(shot))))
    return Done(compared.found, there, offset, text, warnings)


