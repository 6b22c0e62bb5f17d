"""In a Blender with a window: for how long Track holds the main thread, 120 frames x 50 strokes.

Started by `cargo xtask bench-window` as `blender --python bench_window.py -- ZIP OUT READY`. Writes OUT, a table, and then READY, or
what went wrong. The zip `-` stands for the extension that is enabled already; a fourth word `stand-in` tracks by blending the keys.

Three figures for each stage of the work. *Held* is the longest time between the start and the end of one call of the extension's code:
operator, timer and handlers; *own* is the processor time of the main thread in such a call, without the time in which other work had the
processor. *Gap* is the longest time between two calls of a timer that is always due: it has Blender's redraws and
everything else that ran on the machine in it. For comparison the table has the gaps of the same window before Track.
"""

import sys
import time
import types
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import bpy
import numpy as np
import window
from window import MODULE, in_view

WORDS = sys.argv[sys.argv.index("--") + 1 :]
ZIP, OUT, READY = (Path(word).absolute() if word != "-" else None for word in WORDS[:3])
FRAMES, COLUMNS, ROWS, POINTS = 120, 10, 5, 24
KEYS = (1, 40, 80, 120)
SIZE = (640, 360)
PATIENCE = 3600
"""Seconds until Track must have ended."""


def middle(number: int, frame: int) -> tuple[float, float]:
    """Where a blob is. It drifts, and is drawn on twos."""
    drawing = (frame - 1) // 2
    x = 40 + 58 * (number % COLUMNS) + 10 * np.sin(0.1 * drawing + number)
    return x, 44 + 66 * (number // COLUMNS) + 8 * np.cos(0.13 * drawing + 2 * number)


def radius(number: int, turn: np.ndarray) -> np.ndarray:
    """A blob's radius in a direction."""
    return 17 + 3 * np.sin(3 * turn + number)


def place(number: int, frame: int) -> np.ndarray:
    """Points of a contour."""
    turn = np.arange(POINTS) * (2 * np.pi / POINTS)
    return middle(number, frame) + radius(number, turn)[:, None] * np.stack([np.cos(turn), np.sin(turn)], 1)


def draw_footage(folder: Path) -> Path:
    """The pictures of all frames; returns the first."""
    from importlib import import_module

    painting = import_module(f"{MODULE}.sample.painting")
    folder.mkdir(parents=True, exist_ok=True)
    for frame in range(1, FRAMES + 1, 2):
        picture = np.full((SIZE[1], SIZE[0], 3), (226, 230, 222), np.float32)
        for number in range(COLUMNS * ROWS):
            x, y = middle(number, frame)
            left, top = int(x) - 24, int(y) - 24
            box = picture[top : top + 48, left : left + 48]
            across, down = np.meshgrid(np.arange(48) + left + 0.5 - x, np.arange(48) + top + 0.5 - y)
            inside = radius(number, np.arctan2(down, across)) - np.hypot(across, down)
            hue = np.array([90 + 30 * (number % 5), 80 + 25 * (number % 7), 200 - 20 * (number % 8)])
            for edge, colour in ((1.5, np.array([30, 25, 35])), (-1.5, hue)):
                box += np.clip(inside + edge + 0.5, 0, 1)[..., None] * (colour - box)
        for held in (0, 1):
            painting.write_png(folder / f"blobs_{frame + held:03d}.png", picture)
    return folder / "blobs_001.png"


def draw_keys(ob) -> None:
    """All contours on the key frames."""
    from importlib import import_module

    import shots

    for frame in KEYS:
        shapes = [place(number, frame) for number in range(COLUMNS * ROWS)]
        shots.draw(lambda name: import_module(f"{MODULE}.{name}"), ob, frame, shapes)


class Watch:
    """The longest times of a stage."""

    def __init__(self):
        self.reset()

    def tick(self) -> float:
        """Called by the timer that is always due."""
        now = time.perf_counter()
        self.gap, self._last = max(self.gap, now - self._last), now
        return 0.0

    def wrap(self, owner, name: str) -> None:
        """Measures each call of a method or function."""
        inner = getattr(owner, name)

        def timed(*words, **options):
            start, own = time.perf_counter(), time.thread_time()
            try:
                return inner(*words, **options)
            finally:
                own = time.thread_time() - own
                self.held = max(self.held, time.perf_counter() - start)
                if own > self.own:
                    self.own, self.what = own, name

        setattr(owner, name, timed)

    def reset(self) -> None:
        """Begins another stage."""
        self.held = self.own = self.gap = 0.0
        self.what, self._last = "", time.perf_counter()


def running() -> bool:
    """Whether a modal operator of the extension is at work."""
    return any("ROTOTOON" in op.bl_idname for op in bpy.context.window_manager.windows[0].modal_operators)


def watch_track(watch: Watch) -> None:
    """Measures what the extension does in the main thread while it tracks."""
    from importlib import import_module

    track = import_module(f"{MODULE}.capture.operators.track").ROTOTOON_OT_track
    for name in ("modal", "invoke"):
        inner = getattr(track, name)
        holder = types.SimpleNamespace(**{name: inner})
        watch.wrap(holder, name)
        timed = getattr(holder, name)
        setattr(track, name, (lambda call: lambda self, context, event: call(self, context, event))(timed))
    for kind in ("depsgraph_update_post", "frame_change_post"):
        hooks = getattr(bpy.app.handlers, kind)
        for index, hook in enumerate(list(hooks)):
            if hook.__module__.startswith(MODULE):
                holder = types.SimpleNamespace(**{hook.__name__: hook})
                watch.wrap(holder, hook.__name__)
                hooks[index] = getattr(holder, hook.__name__)


def session():
    """Everything, in order; yields the seconds until it goes on."""
    if ZIP is not None:
        window.install(ZIP)
    from importlib import import_module

    if "stand-in" in WORDS:
        import stand_in

        sessions = import_module(f"{MODULE}.capture.sessions")
        sessions.make = stand_in.Session.from_document
    picked = draw_footage(OUT.parent / "blobs")
    with in_view():
        bpy.ops.rototoon.setup(filepath=str(picked), start_drawing=False)
        ob = bpy.context.object
        draw_keys(ob)
        ob.data.update_tag()
    yield 2.0
    watch, rows = Watch(), []
    tick = watch.tick  # each look-up makes another bound method
    bpy.app.timers.register(tick)
    yield 3.0
    watch.reset()
    yield 5.0
    rows.append(("before Track", watch.own, watch.what, watch.held, watch.gap))
    watch_track(watch)
    for name in ("first Track", "Track again", "Track after a correction"):
        if name == "Track after a correction":
            correct(ob)
        watch.reset()
        started = time.perf_counter()
        with in_view():
            bpy.ops.rototoon.track("INVOKE_DEFAULT")
        while running():
            if time.perf_counter() - started > PATIENCE:
                raise RuntimeError(f"{name} did not end in {PATIENCE} s")
            yield 0.1
        took = time.perf_counter() - started
        yield 0.5
        rows.append((f"{name}, {took:.1f} s", watch.own, watch.what, watch.held, watch.gap))
    strokes = sum(len(frame.drawing.strokes) for frame in ob.data.layers[0].frames)
    bpy.app.timers.unregister(tick)
    write(rows, strokes)


def correct(ob) -> None:
    """Moves a contour on a generated frame."""
    drawing = next(frame for frame in ob.data.layers[0].frames if frame.frame_number == 20).drawing
    points = np.empty(len(drawing.attributes["position"].data) * 3, np.float32)
    drawing.attributes["position"].data.foreach_get("vector", points)
    points[: POINTS * 3] += 0.05
    drawing.attributes["position"].data.foreach_set("vector", points)
    drawing.tag_positions_changed()


def write(rows, strokes: int) -> None:
    """The table."""
    text = f"Blender {bpy.app.version_string}, {FRAMES} frames, {COLUMNS * ROWS} contours of {POINTS} points, {strokes} strokes\n\n"
    text += "| stage | longest own, ms | in | longest held, ms | longest gap, ms |\n| --- | ---: | --- | ---: | ---: |\n"
    for name, own, what, held, gap in rows:
        text += f"| {name} | {1000 * own:.0f} | {what} | {1000 * held:.0f} | {1000 * gap:.0f} |\n"
    OUT.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    window.run(session(), READY)
