"""How long tracked contours take into Blender and out of it: 100 frames x 50 strokes x 64 points.

Beside it, in the same process, Blender's own `grease_pencil.interpolate_sequence` and our In-between, both from the call of
the operator to the last stroke, on two keys as large, which make as many frames. Run with the Python that has `bpy`:
`python bench_write.py [--between]`. Prints the best of several runs in processor time, where no other is named; with
`--between` the in-betweens alone.
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
    print(f"Blender {bpy.app.version_string}: {FRAMES} frames x {PARTS} strokes x {POINTS} points")
    if "--between" in sys.argv:
        beside_blender(addon)
        return
    import stand_in

    sessions = addon("capture.sessions")
    sessions.make = stand_in.Session.from_document
    # Strokes are drawn in the same order on both keys.
    sessions.matcher = lambda request: {
        "matches": [{"reference": i, "drawn": i, "points": r["points"]} for i, r in enumerate(request["drawn"])]
    }
    ob = scene(addon)
    gp, writing, document = addon("blender.grease_pencil"), addon("capture.writing"), addon("capture.document")
    tracking, jobs = addon("capture.tracking"), addon("common.jobs")
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
    print(f"  lay out (plane, style)      {best(lambda: writing.lay_out(*arguments)):7.1f} ms")
    print(f"  write, new frames           {min(fresh.times):7.1f} ms")
    print(f"  write, frames there already {best(lambda: writing.write(layer, block, list(gp.drawings(layer)))):7.1f} ms")
    print(f"  read strokes                {best(lambda: addon('capture.contours').read(ob)):7.1f} ms")
    print(f"  read as document            {best(lambda: document.read(ob)):7.1f} ms")
    whole = best(lambda: jobs.drained(tracking.writing_tracks(ob, reading, session)))
    print(f"  track and write, session's own time apart: {whole:7.1f} ms")
    beside_blender(addon)


def clocks(rivals, runs=10):
    """Median times in milliseconds on the wall of pairs (prepare, work), taken in turns, after one round that does not count."""
    times = [[] for _ in rivals]
    for _ in range(runs + 1):
        for (prepare, work), mine in zip(rivals, times):
            prepare()
            start = time.perf_counter()
            work()
            mine.append(1000 * (time.perf_counter() - start))
    return [sorted(mine[1:])[runs // 2] for mine in times]


def two_keys(addon):
    """An object with 50 circles on the first and last of 102 frames."""
    gp = addon("blender.grease_pencil")
    ob = gp.new_object("Two Keys", bpy.context.collection)
    bpy.context.view_layer.objects.active = ob
    layer = ob.data.layers.new("Lines")
    turn = np.linspace(0, 2 * np.pi, POINTS, endpoint=False)
    shape = np.stack([np.cos(turn), 0 * turn, np.sin(turn)], 1)
    total = PARTS * POINTS
    for frame in (0, FRAMES + 1):
        drawing = layer.frames.new(frame).drawing
        drawing.add_strokes([POINTS] * PARTS)
        gp.put(drawing, "position", np.concatenate([shape + [i, 0, 0.01 * frame] for i in range(PARTS)]))
        for name in ("radius", "opacity", "vertex_color"):
            gp.put(drawing, name, gp.blank(name, total))
        for name in ("cyclic", "material_index"):
            gp.put(drawing, name, gp.blank(name, PARTS))
        drawing.tag_positions_changed()
    bpy.context.scene.frame_set(FRAMES // 2)
    return ob, layer


def written(addon):
    """In-betweens as many as tracked contours are laid out."""
    gp, writing = addon("blender.grease_pencil"), addon("capture.writing")
    total = PARTS * POINTS
    columns = [slice(i * POINTS, (i + 1) * POINTS) for i in range(PARTS)]
    present = np.ones((FRAMES, PARTS), bool)
    block = writing.Block(np.arange(1, FRAMES + 1), np.full(PARTS, POINTS, np.int32), present, columns)
    block.point["position"] = np.random.default_rng(1).random((FRAMES, total, 3), np.float32)
    for name in ("radius", "opacity", "vertex_color"):
        block.point[name] = np.repeat(gp.blank(name, total)[None], FRAMES, 0)
    for name in ("cyclic", "material_index", gp.PART, gp.MADE):
        block.curve[name] = np.repeat(gp.blank(name, PARTS)[None], FRAMES, 0)
    block.curve[gp.MADE][:] = True
    return block


def beside_blender(addon):
    """Blender's in-betweens, ours, each the whole operator; and as many strokes written as tracking writes them."""
    gp, writing = addon("blender.grease_pencil"), addon("capture.writing")
    ob, layer = two_keys(addon)
    kept = addon("tween.records").PROPERTY

    def clear(mode="OBJECT"):
        bpy.ops.object.mode_set(mode=mode)
        gp.remove_frames(layer, [number for number in gp.drawings(layer) if 0 < number <= FRAMES])
        if kept in ob.data:
            del ob.data[kept]
        bpy.context.view_layer.update()

    block = written(addon)
    rivals = [
        (lambda: clear("EDIT"), lambda: bpy.ops.grease_pencil.interpolate_sequence(step=1)),
        (clear, lambda: bpy.ops.rototoon.in_between()),
        (clear, lambda: writing.write(layer, block, [])),
    ]
    for prepare, work in rivals:
        prepare()
        work()
        assert len(layer.frames) == FRAMES + 2
    blender, whole, ours = clocks(rivals)
    print(f"  interpolate_sequence        {blender:7.1f} ms (median of ten, on the wall, in turns)")
    print(f"  In-between                  {whole:7.1f} ms (the same; {steps(addon, ob, layer, clear)})")
    print(f"  tracked contours as many    {ours:7.1f} ms (the same, writing alone)")


def steps(addon, ob, layer, clear):
    """Median times of the steps of In-between, in words."""
    tweening, charts = addon("tween.tweening"), addon("tween.charts")
    choose = lambda name, found, record: {(0, FRAMES + 1): charts.Choices()}  # noqa: E731
    times = {"read": [], "compute": [], "write": []}
    for _ in range(10):
        clear()
        marks = [time.perf_counter()]
        plan = tweening.plan(ob, [layer], choose)
        marks.append(time.perf_counter())
        tweening.draw(plan, lambda share, step: True)
        marks.append(time.perf_counter())
        tweening.finish(ob, plan)
        marks.append(time.perf_counter())
        for mine, start, end in zip(times.values(), marks, marks[1:]):
            mine.append(1000 * (end - start))
    return ", ".join(f"{name} {sorted(mine)[5]:.1f}" for name, mine in times.items())


def tracked(session, part, writing):
    """A part's track as the operator takes it."""
    found = session.tracks(part.name)
    return writing.Track(np.asarray(found.frames), np.asarray(found.points), np.asarray(session.confidence(part.name)))


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)
