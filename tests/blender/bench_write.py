"""How long tracked contours take into Blender and out of it: 100 frames x 50 strokes x 64 points.

Run with the Python that has `bpy`: `python bench_write.py`. Prints the best of several runs in processor time.
"""

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

FRAMES, PARTS, POINTS = 100, 50, 64


def scene(addon):
    """An object with 50 circles keyed on the first and last of 100 frames."""
    folder = Path(tempfile.mkdtemp())
    picked = shots.draw_sequence(folder, count=FRAMES)
    bpy.ops.rototoon.setup(filepath=str(picked))
    ob = bpy.context.object
    bpy.context.view_layer.update()
    turn = np.linspace(0, 2 * np.pi, POINTS, endpoint=False)
    circle = np.stack([np.cos(turn), np.sin(turn)], 1)
    for frame in (1, FRAMES):
        shots.draw(addon, ob, frame, [(10 + 2.5 * i, 40 + 0.1 * frame) + 8 * circle for i in range(PARTS)])
    return ob


def best(function, runs=7):
    """The least processor time in milliseconds: other work on the machine does not count."""
    times = []
    for _ in range(runs):
        start = time.process_time()
        function()
        times.append(1000 * (time.process_time() - start))
    return min(times)


def main():
    conftest.install()
    addon = conftest.module
    import stand_in

    sessions = addon("sessions")
    sessions.make = stand_in.Session.from_document
    # Strokes are drawn in the same order on both keys.
    sessions.matcher = lambda request: {
        "matches": [{"reference": i, "drawn": i, "points": r["points"]} for i, r in enumerate(request["drawn"])]
    }
    ob = scene(addon)
    gp, writing, document = addon("grease_pencil"), addon("writing"), addon("document")
    tracking = addon("tracking")
    bpy.ops.rototoon.track()
    reading = document.read(ob)
    session = sessions.known(ob).session
    tracks = {p.number: tracked(session, p, writing) for p in reading.found.parts}
    layer = shots.layer_of(ob)
    arguments = (0, reading.found.parts, tracks, reading.found, reading.mapper, reading.corrections)
    block = writing.lay_out(*arguments)

    def clear():
        writing.clear(layer, list(gp.drawings(layer)))

    def fresh():
        clear()
        start = time.process_time()
        writing.write(layer, block, list(gp.drawings(layer)))
        fresh.times.append(1000 * (time.process_time() - start))

    fresh.times = []
    for _ in range(7):
        fresh()
    print(f"Blender {bpy.app.version_string}: {FRAMES} frames x {PARTS} strokes x {POINTS} points")
    print(f"  lay out (plane, style)      {best(lambda: writing.lay_out(*arguments)):7.1f} ms")
    print(f"  write, new frames           {min(fresh.times):7.1f} ms")
    print(f"  write, frames there already {best(lambda: writing.write(layer, block, list(gp.drawings(layer)))):7.1f} ms")
    print(f"  read strokes                {best(lambda: addon('contours').read(ob)):7.1f} ms")
    print(f"  read as document            {best(lambda: document.read(ob)):7.1f} ms")
    print(f"  track and write, session's own time apart: {best(lambda: tracking.write_tracks(ob, reading, session)):7.1f} ms")


def tracked(session, part, writing):
    """A part's track as the operator takes it."""
    found = session.tracks(part.name)
    return writing.Track(np.asarray(found.frames), np.asarray(found.points), np.asarray(session.confidence(part.name)))


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)
