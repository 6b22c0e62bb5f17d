#!/usr/bin/env python3
"""Works in background Blender for a long time, as an artist would: random edits, tracks, undos, saves and reopens.

    ROTOTOON_ZIP=target/rototoon-VERSION-linux_x64.zip target/venv-bpy-5.3.0/bin/python tests/blender/soak.py --minutes 120

It fails where

- the memory of the process grows: after a fifth of the time it may grow by a tenth and 32 MB more,
- an operator changes a contour that the artist drew,
- an operator fails that should not,
- a track with a new session gives other contours than the one that was kept. That is looked at after every reopening
  and at the end.

It prints the counts of what it did and the memory over time. The seed makes a run repeatable up to Blender's own
differences between versions.
"""

from __future__ import annotations

import argparse
import os
import random
import sys
import tempfile
import time
import traceback
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import conftest  # noqa: E402 - sets Blender's folders before it is loaded
import bpy  # noqa: E402
import numpy as np  # noqa: E402
import shots  # noqa: E402

WORK = {
    "move_point": 8,
    "move_part": 3,
    "track": 8,
    "new_key": 3,
    "drop_key": 2,
    "release": 2,
    "clear": 1,
    "snap": 2,
    "fit": 1,
    "undo": 3,
    "reopen": 1,
}
"""What the artist does, and how often."""

CHANGES_KEYS = {"move_point", "move_part", "drop_key", "fit", "undo"}
"""The work that may change the artist's contours."""

REFUSED = ["is a key already", "Nothing to snap", "Nothing to clear", "Nothing to release", "No drawings to fit"]
"""Refusals that may follow from what the artist did before. Fitted contours, for example, are the artist's, even on a
frame that is still marked as generated."""

MOST_KEYS = 5


def memory() -> int:
    """Memory of this process in bytes, without what is swapped out."""
    fields = Path("/proc/self/statm").read_text().split()
    return int(fields[1]) * os.sysconf("SC_PAGE_SIZE")


class Artist:
    """Works in the open file, and keeps count."""

    def __init__(self, folder: Path, seed: int) -> None:
        self.random = random.Random(seed)
        self.file = str(folder / "shot.blend")
        self.counts: dict[str, int] = {}
        shots.two_keys(conftest.module, folder)
        bpy.ops.rototoon.track()
        self.remember()

    @property
    def ob(self):
        """The object with the contours. Undo and loading make a new one."""
        return bpy.context.view_layer.objects.active

    def drawings(self):
        """The drawings of the contours by frame, with their kinds."""
        return conftest.module("blender.grease_pencil").drawings(shots.layer_of(self.ob))

    def frames(self, kind: str) -> list[int]:
        return [frame for frame, (_, found) in self.drawings().items() if found == kind]

    def keys(self) -> dict[tuple[int, int], list]:
        """The points of the artist's contours by frame and part. A key frame may have generated contours of other parts."""
        found = conftest.module("capture.contours").read(self.ob)
        own = [(frame, part.number, stroke) for part in found.parts for frame, stroke in part.keys.items()]
        return {(frame, number): stroke.points.tolist() for frame, number, stroke in own}

    def remember(self) -> None:
        """A step to which Undo can return."""
        bpy.ops.ed.undo_push(message="soak")

    def work(self) -> None:
        """Does one random thing."""
        name = self.random.choices(list(WORK), weights=list(WORK.values()))[0]
        before = self.keys()
        try:
            done = getattr(self, name)()
        except RuntimeError as error:
            if not any(reason in str(error) for reason in REFUSED):
                raise
            done = False
        if name != "undo":
            self.remember()
        if name not in CHANGES_KEYS:
            after = self.keys()
            for place, points in before.items():
                assert after.get(place) == points, f"{name}: frame and part {place}: the artist's contour was changed"
        name += "" if done is not False else " (nothing to do)"
        self.counts[name] = self.counts.get(name, 0) + 1

    def move(self, which, reach: float):
        """Moves points of a part on a generated frame."""
        frames = self.frames("GENERATED")
        if not frames:
            return False
        frame, part = self.random.choice(frames), self.random.choice([1, 2])
        if part not in dict(shots.pixels(conftest.module, self.ob, frame)):
            return False
        shift = np.array([self.random.uniform(-reach, reach), self.random.uniform(-reach, reach)])
        shots.move(conftest.module, self.ob, frame, part, shift, which)
        return True

    def move_point(self):
        return self.move([self.random.randrange(4)], 3.0)

    def move_part(self):
        return self.move(None, 2.0)

    def track(self) -> None:
        assert bpy.ops.rototoon.track() == {"FINISHED"}

    def new_key(self):
        if len(self.frames("KEYFRAME")) >= MOST_KEYS or not self.frames("GENERATED"):
            return False
        bpy.context.scene.frame_set(self.random.choice(self.frames("GENERATED")))
        bpy.ops.rototoon.new_key()
        return True

    def drop_key(self):
        keys = [frame for frame in self.frames("KEYFRAME") if frame not in (1, shots.COUNT)]
        if not keys:
            return False
        shots.layer_of(self.ob).frames.remove(self.random.choice(keys))
        return True

    def release(self):
        bpy.context.scene.frame_set(self.random.randint(2, shots.COUNT - 1))
        if not bpy.ops.rototoon.release_pins.poll():
            return False
        bpy.ops.rototoon.release_pins()
        return True

    def clear(self):
        if not bpy.ops.rototoon.clear_generated.poll():
            return False
        bpy.ops.rototoon.clear_generated()
        return True

    def snap(self):
        if not bpy.ops.rototoon.snap.poll() or not self.frames("GENERATED"):
            return False
        assert bpy.ops.rototoon.snap() == {"FINISHED"}
        return True

    def fit(self):
        if not bpy.ops.rototoon.fit_strokes.poll():
            return False
        assert bpy.ops.rototoon.fit_strokes() == {"FINISHED"}
        return True

    def undo(self):
        if not bpy.ops.ed.undo.poll():
            return False
        bpy.ops.ed.undo()
        return True

    def reopen(self) -> None:
        self.compare()
        bpy.ops.wm.save_as_mainfile(filepath=self.file)
        bpy.ops.wm.open_mainfile(filepath=self.file)
        self.remember()

    def compare(self) -> None:
        """Requires that a new session finds the same contours as the one that was kept."""
        self.track()
        kept = {frame: shots.pixels(conftest.module, self.ob, frame) for frame in self.drawings()}
        conftest.module("capture.sessions").clear()
        self.track()
        for frame, strokes in kept.items():
            for (number, points), (again, same) in zip(strokes, shots.pixels(conftest.module, self.ob, frame), strict=True):
                assert number == again and np.array_equal(points, same), f"frame {frame}: a new session differs"
        self.counts["compared"] = self.counts.get("compared", 0) + 1


def soak(folder: Path, minutes: float, seed: int) -> int:
    """Works for the given time. Returns the exit status."""
    artist = Artist(folder, seed)
    start, length = time.monotonic(), 60 * minutes
    warm, most, shown = 0, 0, 0.0
    while (now := time.monotonic() - start) < length:
        artist.work()
        used = memory()
        if now < length / 5:
            warm = max(warm, used)
        most = max(most, used)
        if now >= shown:
            print(f"{now / 60:6.1f} min  {used / 2**20:7.1f} MB  {sum(artist.counts.values())} actions", flush=True)
            shown += length / 20
    artist.compare()
    print(", ".join(f"{name} {count}" for name, count in sorted(artist.counts.items())))
    print(f"memory: {warm / 2**20:.1f} MB after a fifth of the time, {most / 2**20:.1f} MB at most")
    return 0 if most <= 1.1 * warm + 32 * 2**20 else 1


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=120)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    conftest.install()
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with tempfile.TemporaryDirectory() as folder:
        try:
            return soak(Path(folder), given.minutes, given.seed)
        except Exception:  # noqa: BLE001 - the process ends by itself below
            traceback.print_exc()
            return 1


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    sys.stderr.flush()
    # Blender 4.5 never returns from its exit once something was undone.
    os._exit(status)
