"""How a large drawing works in Blender: 200 frames x 300 strokes x 100 points, tracked.

    target/venv-bpy-5.3.0/bin/python tests/blender/bench_large.py [FRAMES STROKES POINTS] [--check]

Measures processor time of the main thread, in background, without the tracker's own (a stand-in blends the keys):

- what Track does on the main thread: reading the object before, reading it again and writing after,
- Live: each call of its timer's step after a moved point, the longest one told,
- a frame change: what our handlers add to `frame_set`, and what the overlay reads for its marks,
- undo: memory of the process for each step with an edit and its result.

With `--check` it ends with status 1 where our handlers take more than 8 ms of a frame change, where one step of Live takes more than 200 ms,
or where an undo step takes more memory than the drawings that it changes, ten times over.
"""

import gc
import math
import os
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import conftest  # sets Blender's folders, so it comes before bpy  # isort: skip
import bpy
import numpy as np
import shots

SIZES = [int(word) for word in sys.argv[1:] if word.isdigit()] or [200, 300, 100]
FRAMES, PARTS, POINTS = SIZES
MOST_OF_A_FRAME_CHANGE = 8.0
"""Milliseconds."""
MOST_OF_A_STEP = 200.0
"""Milliseconds."""
STEPS = 10


def memory() -> float:
    """Memory of this process in MB."""
    gc.collect()
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


def clock(function, runs=1) -> float:
    """Median milliseconds of this thread: other work on the machine does not count."""
    times = []
    for _ in range(runs):
        start = time.thread_time()
        function()
        times.append(1000 * (time.thread_time() - start))
    return sorted(times)[len(times) // 2]


class Blend:
    """In the place of the native session: blends the keys of a part linearly, as arrays."""

    def __init__(self, document, _folder):
        self.state = document

    @classmethod
    def from_document(cls, document, folder):
        return cls(document, folder)

    def set_document(self, document):
        self.state = document

    def track(self, preset="rototoon", progress=None, *, threads=0):
        import stand_in

        return stand_in.Summary(len(self.state["parts"]), 0)

    def part(self, name):
        return next(part for part in self.state["parts"] if part["name"] == name)

    def tracks(self, name):
        import stand_in

        part = self.part(name)
        keys = {int(frame): np.array(points) for frame, points in part["keys"].items()}
        first, last = min(keys), max(keys)
        share = np.linspace(0, 1, last - first + 1)[:, None, None]
        points = keys[first] * (1 - share) + keys[last] * share
        for frame, pins in part.get("pins", {}).items():
            for index, place in pins.items():
                points[int(frame) - first, int(index)] = place
        return stand_in.Track(np.arange(first, last + 1), points)

    def confidence(self, name):
        return np.full(self.tracks(name).points.shape[:2], 0.5)


def scene(addon):
    """An object with circles keyed on the first and last frame."""
    sessions = addon("capture.sessions")
    sessions.make = Blend.from_document
    # Strokes are drawn in the same order on both keys.
    sessions.matcher = lambda request: {
        "matches": [{"reference": i, "drawn": i, "points": r["points"]} for i, r in enumerate(request["drawn"])]
    }
    picked = shots.draw_sequence(Path(tempfile.mkdtemp()), count=FRAMES)
    bpy.ops.rototoon.setup(filepath=str(picked))
    ob = bpy.context.object
    bpy.context.view_layer.update()
    turn = np.linspace(0, 2 * np.pi, POINTS, endpoint=False)
    circle = np.stack([np.cos(turn), np.sin(turn)], 1)
    for frame in (1, FRAMES):
        shots.draw(addon, ob, frame, [(5 + 150 * i / PARTS, 40 + 0.1 * frame) + 4 * circle for i in range(PARTS)])
    return ob


def of_track(addon, ob) -> None:
    document, tracking = addon("capture.document"), addon("capture.tracking")
    start = memory()
    reading = document.read(ob)
    run = tracking.begin(ob, reading, "rototoon")
    run.worker.run_here()
    tracking.finish(ob, run)
    print(f"  memory of the drawings              {memory() - start:8.0f} MB")
    reading = document.read(ob)
    run = tracking.begin(ob, reading, "rototoon")
    run.worker.run_here()
    print(f"  Track: read before                  {clock(lambda: document.read(ob), 3):8.0f} ms")
    print(f"  Track: read again and write, equal  {clock(lambda: tracking.finish(ob, run), 3):8.0f} ms")
    writing, gp = addon("capture.writing"), addon("blender.grease_pencil")
    layer = shots.layer_of(ob)
    times = []
    for _ in range(3):
        writing.clear(layer, list(gp.drawings(layer)))
        times.append(clock(lambda: tracking.finish(ob, run)))
    print(f"  Track: read again and write, new    {sorted(times)[1]:8.0f} ms")


def of_live(addon, ob) -> float:
    """Returns the milliseconds of the longest step."""
    live = addon("capture.live")
    ob.rototoon.live = True
    settle(live)
    all_longest = []
    for what, frame in (("a pin", FRAMES // 2), ("a key", FRAMES)):
        totals, longest = [], []
        for _ in range(3):
            shots.move(addon, ob, frame, PARTS // 2, (3.0, 1.0), which=[0])
            bpy.context.view_layer.update()
            steps = settle(live)
            totals.append(sum(steps))
            longest.append(max(steps))
        print(f"  Live: {what}, on the main thread    {sorted(totals)[1]:8.0f} ms, longest step {sorted(longest)[1]:.0f} ms")
        all_longest.append(sorted(longest)[1])
    return max(all_longest)


def settle(live) -> list[float]:
    """Has Live do all that is due. Returns the milliseconds of each step."""
    bpy.context.view_layer.update()
    steps = []
    while True:
        start = time.thread_time()
        ended = live.step(math.inf) is None
        steps.append(1000 * (time.thread_time() - start))
        if ended:
            return steps
        time.sleep(0.001)


def of_frames(addon, ob) -> float:
    """Returns the milliseconds that the add-on adds to a frame change, with Live on."""
    handlers, overlay = addon("handlers"), addon("ui.overlay")
    frames = [1 + (7 * k) % FRAMES for k in range(60)]
    scene = bpy.context.scene
    spent = []

    def timed(hook):
        def call(*args):
            start = time.thread_time()
            hook(*args)
            spent[-1] += 1000 * (time.thread_time() - start)

        return call

    wrapped = [(name, hook, timed(hook)) for name, hook in handlers._HOOKS if "frame" in name or "depsgraph" in name]
    for name, hook, call in wrapped:
        hooks = getattr(bpy.app.handlers, name)
        hooks.remove(hook)
        hooks.append(call)
    whole = []
    for frame in frames:
        spent.append(0.0)
        whole.append(clock(lambda frame=frame: scene.frame_set(frame)))
    for name, hook, call in wrapped:
        hooks = getattr(bpy.app.handlers, name)
        hooks.remove(call)
        hooks.append(hook)
    ob.rototoon.show_confidence = True
    marks = [clock(lambda frame=frame: overlay.gather(ob, frame)) for frame in frames]
    ob.rototoon.show_confidence = False
    ours = sorted(spent)[-3]
    print(f"  frame change: Blender and we        {sorted(whole)[30]:8.1f} ms (median of 60)")
    print(f"  frame change: our handlers          {ours:8.2f} ms (the third longest of 60)")
    print(f"  overlay: marks of a frame           {sorted(marks)[30]:8.1f} ms (median), {max(marks):.1f} ms (longest)")
    return ours + sorted(marks)[30]


def of_undo(addon, ob) -> float:
    """Returns the MB of a step."""
    live = addon("capture.live")
    bpy.ops.ed.undo_push(message="begin")
    bpy.ops.ed.undo_push(message="begin")
    before, times = memory(), []
    for step in range(STEPS):
        shots.move(addon, ob, FRAMES // 2 + step % 3, PARTS // 3, (1.0 + step, 0.5), which=[1])
        ob.data.update_tag()
        bpy.context.view_layer.update()
        times.append(clock(lambda: bpy.ops.ed.undo_push(message="move")))
        settle(live)
    each = (memory() - before) / STEPS
    back = clock(lambda: bpy.ops.ed.undo())
    print(f"  undo: memory of a step              {each:8.1f} MB (mean of {STEPS})")
    print(f"  undo: a step, push and take back    {sorted(times)[STEPS // 2]:8.0f} ms, {back:.0f} ms")
    return each


def main() -> int:
    conftest.install()
    addon = conftest.module
    print(f"Blender {bpy.app.version_string}: {FRAMES} frames x {PARTS} strokes x {POINTS} points")
    ob = scene(addon)
    of_track(addon, ob)
    longest = of_live(addon, ob)
    ours = of_frames(addon, ob)
    step = of_undo(addon, ob)
    one = PARTS * POINTS * 50 / 1e6
    if "--check" in sys.argv and (ours > MOST_OF_A_FRAME_CHANGE or longest > MOST_OF_A_STEP or step > 10 * 3 * one):
        print(f"too much: {ours:.1f} ms of a frame change, {longest:.0f} ms of a step of Live, {step:.1f} MB of an undo step")
        return 1
    return 0


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    os._exit(status)
