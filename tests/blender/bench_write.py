"""How long tracked contours take into Blender and out of it: 100 frames x 50 strokes x 64 points.

Beside it, in the same process, Blender's own `grease_pencil.interpolate_sequence` on two keys as large, which makes as
many frames, and in-betweens written as tracked contours are, with the attributes that Blender's have. Run with the Python that has `bpy`: `python bench_write.py`. Prints the best of several runs in processor time.
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
    beside_blender(addon)


def clock(function, prepare, runs=10):
    """The median time in milliseconds on the wall, after one run that does not count."""
    times = []
    for _ in range(runs + 1):
        prepare()
        start = time.perf_counter()
        function()
        times.append(1000 * (time.perf_counter() - start))
    return sorted(times[1:])[runs // 2]


def beside_blender(addon):
    """Blender's in-betweens, and ours written."""
    gp, writing = addon("grease_pencil"), addon("writing")
    ob = gp.new_object("Two Keys", bpy.context.collection)
    bpy.context.view_layer.objects.active = ob
    layer = ob.data.layers.new("Lines")
    turn = np.linspace(0, 2 * np.pi, POINTS, endpoint=False)
    shape = np.stack([np.cos(turn), 0 * turn, np.sin(turn)], 1)
    total = PARTS * POINTS
    for frame in (0, FRAMES + 1):
        drawing = layer.frames.new(frame).drawing
        drawing.add_strokes([POINTS] * PARTS)
        gp.put(drawing, "position", np.concatenate([shape + [i + 0.01 * frame, 0, 0] for i in range(PARTS)]))
        for name in ("radius", "opacity", "vertex_color"):
            gp.put(drawing, name, gp.blank(name, total))
        for name in ("cyclic", "material_index"):
            gp.put(drawing, name, gp.blank(name, PARTS))
        drawing.tag_positions_changed()

    def clear():
        gp.remove_frames(layer, [number for number in gp.drawings(layer) if 0 < number <= FRAMES])
        bpy.context.view_layer.update()

    bpy.context.scene.frame_set(FRAMES // 2)
    bpy.ops.object.mode_set(mode="EDIT")
    blender = clock(lambda: bpy.ops.grease_pencil.interpolate_sequence(step=1), clear)
    assert len(layer.frames) == FRAMES + 2
    bpy.ops.object.mode_set(mode="OBJECT")
    columns = [slice(i * POINTS, (i + 1) * POINTS) for i in range(PARTS)]
    present = np.ones((FRAMES, PARTS), bool)
    block = writing.Block(np.arange(1, FRAMES + 1), np.full(PARTS, POINTS, np.int32), present, columns)
    block.point["position"] = np.random.default_rng(1).random((FRAMES, total, 3), np.float32)
    for name in ("radius", "opacity", "vertex_color"):
        block.point[name] = np.repeat(gp.blank(name, total)[None], FRAMES, 0)
    for name in ("cyclic", "material_index", gp.PART, gp.MADE):
        block.curve[name] = np.repeat(gp.blank(name, PARTS)[None], FRAMES, 0)
    block.curve[gp.MADE][:] = True
    ours = clock(lambda: writing.write(layer, block, []), clear)
    clear()
    in_between(addon, ob, layer, clear)
    print(f"  interpolate_sequence        {blender:7.1f} ms (median of ten, on the wall)")
    print(f"  in-betweens as many, written {ours:6.1f} ms (the same)")


def in_between(addon, ob, layer, clear):
    """The operator In-between as a whole: read, match, compute, write; and its steps."""
    data, kept = ob.data, addon("tween_records").PROPERTY

    def forget():
        clear()
        if kept in data:
            del data[kept]

    whole = clock(lambda: bpy.ops.rototoon.in_between(), forget)
    assert len(layer.frames) == FRAMES + 2
    tweening, charts = addon("tweening"), addon("charts")
    choose = lambda name, found, record: {(0, FRAMES + 1): charts.Choices()}  # noqa: E731
    steps = {"plan": [], "compute": [], "write": []}
    for _ in range(11):
        forget()
        marks = [time.perf_counter()]
        plan = tweening.plan(ob, [layer], choose)
        marks.append(time.perf_counter())
        tweening.draw(plan, lambda share, step: True)
        marks.append(time.perf_counter())
        tweening.finish(ob, plan)
        marks.append(time.perf_counter())
        for times, start, end in zip(steps.values(), marks, marks[1:]):
            times.append(1000 * (end - start))
    parts = ", ".join(f"{name} {sorted(times)[5]:.1f}" for name, times in steps.items())
    print(f"  In-between, the whole operator {whole:5.1f} ms (the same; {parts})")


def tracked(session, part, writing):
    """A part's track as the operator takes it."""
    found = session.tracks(part.name)
    return writing.Track(np.asarray(found.frames), np.asarray(found.points), np.asarray(session.confidence(part.name)))


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)
