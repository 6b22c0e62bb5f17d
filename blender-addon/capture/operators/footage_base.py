"""Base of the operators that set an object's footage. Frames of movies are put into the cache first."""

from __future__ import annotations

import os
from collections.abc import Iterator

import bpy

from ...blender import footage, guard, movie, preferences, stage
from ...blender.errors import Problem
from ...common import jobs
from ...common.operators import Long, OnDrawing
from ...common.wording import counted


class FootageOperator(Long):
    """`source(context)` returns the source of the footage. `apply(context, shot)` uses the footage and returns a message."""

    hold_gaps: bpy.props.BoolProperty(
        name="Hold Gaps",
        description="Take the pictures beyond a gap too: a missing number shows the picture before it, "
        "as in scans that are numbered by their exposure (A0001, A0003, A0005)",
        default=False,
    )

    def begin(self, context):
        """Checks the source. Only a movie that is not in the cache takes long."""
        self._source = self.source(context)
        if not self._source.movie:
            self._sequence = footage.sequence_around(self._source.path, self.hold_gaps)
            return jobs.Stepper(iter(()), "")
        if not os.path.isfile(self._source.path):
            raise Problem(f"No file {self._source.path}: it was moved or renamed")
        self._cache = preferences.cache_folder()
        return jobs.Stepper(self._extract(), os.path.basename(self._source.path))

    def _extract(self) -> Iterator[float]:
        if movie.cached(self._source.path, self._cache) is None:
            yield from movie.extract(self._source.path, self._cache)

    def finish(self, context, _work) -> str:
        """Reads the size of the pictures, and applies them."""
        return self.apply(context, self.shot(context))

    def shot(self, context) -> stage.Shot:
        """The footage, with the size of its pictures. What there is to say of its gaps and of the cache is warned of."""
        shot, note = self._movie_shot(context) if self._source.movie else self._sequence_shot(context)
        self.warn(note)
        return shot

    def _movie_shot(self, context) -> tuple[stage.Shot, str]:
        frames = movie.cached(self._source.path, self._cache)
        if frames is None:
            raise Problem(f"The frames of {self._source.path} are not in the cache {self._cache}")
        width, height = footage.size_of(footage.picture(frames.pattern, frames.first))
        start = context.scene.frame_start if self._source.frame_of_first is None else self._source.frame_of_first
        keep = {os.path.basename(folder) for folder in [os.path.dirname(frames.pattern), *used_folders()]}
        removed = movie.shrink(self._cache, preferences.preferences().cache_limit * 2**20, keep)
        shot = stage.Shot(
            frames.pattern, frames.first, frames.last, width, height, frames.fps, start, self._source.path
        )
        return shot, f"{counted(removed, 'older movie')} {'was' if removed == 1 else 'were'} removed from the cache" if removed else ""

    def _sequence_shot(self, context) -> tuple[stage.Shot, str]:
        sequence, scene = self._sequence, context.scene
        width, height = footage.size_of(footage.picture(sequence.pattern, sequence.picked))
        start = footage.first_frame(self._source, sequence, scene.frame_start)
        fps = scene.render.fps / scene.render.fps_base
        shot = stage.Shot(
            sequence.pattern, sequence.first, sequence.last, width, height, fps, start, hold_gaps=self.hold_gaps
        )
        return shot, _said_of_gaps(sequence)


def _said_of_gaps(sequence: footage.Sequence) -> str:
    """A note about pictures beyond a gap, with the way to have them, or about frames that hold a picture."""
    if sequence.missing:
        verb, them = ("is", "it") if sequence.missing == 1 else ("are", "them")
        return f"{counted(sequence.missing, 'picture')} beyond a gap {verb} left out: Hold Gaps takes {them} in"
    return f"{counted(sequence.held, 'frame')} without a file {'shows' if sequence.held == 1 else 'show'} the picture before" if sequence.held else ""


def used_folders() -> set[str]:
    """Folders with the frames of movies that the objects of this file use."""
    patterns = [footage.absolute(ob, ob.rototoon.pattern) for ob in bpy.data.objects if ob.rototoon.movie]
    return {os.path.dirname(pattern) for pattern in patterns}


def described(shot: stage.Shot) -> str:
    """A message about new footage."""
    count = shot.last - shot.first + 1
    name = os.path.basename(shot.movie or shot.pattern)
    return f"{name}: {count} pictures of {shot.width}x{shot.height}, the first on frame {shot.frame_of_first}"


class FootageOfActive(FootageOperator, OnDrawing):
    """Sets the footage of the object that is active when the operator begins: while a movie is read, another window may make another one active."""

    changes = guard.SETTINGS

    def begin(self, context):
        """As `FootageOperator.begin`."""
        self._ob = context.object
        return super().begin(context)

    def assign(self, shot: stage.Shot) -> str:
        """Sets the footage. Returns a message."""
        guard.need(self._ob, self.changes)
        stage.assign(self._ob, shot)
        return described(shot)
