"""A line drawing that moves over some frames, drawn here: a body with eyes, an arm that turns, and a red line of shade."""

from __future__ import annotations

from functools import cache

import bpy
import numpy as np
from shots import write_png

SCALE = 0.7
SIZE = (224, 168)
COUNT = 6
PAPER, INK, RED = (250, 248, 240), (30, 26, 40), (200, 40, 40)


def _arc(centre, radii, start, end, count=80):
    turn = np.linspace(start, end, count)
    return np.stack([centre[0] + radii[0] * np.cos(turn), centre[1] + radii[1] * np.sin(turn)], 1)


def lines(frame: int) -> list[tuple[np.ndarray, float, tuple[int, int, int]]]:
    """The lines of picture `frame` (0 to 5): points in pixels, width, colour. Closed lines end where they begin."""
    x = 140.0 + 4 * frame
    body = _arc((x, 130), (50, 70), 0, 2 * np.pi, 160)
    eyes = [_arc((x + side, 105), (9, 11), 0, 2 * np.pi, 60) for side in (-16, 16)]
    mouth = _arc((x, 135), (22, 14), 0.3, np.pi - 0.3)
    turn = 0.5 - 0.18 * frame
    way = np.linspace(0, 1, 60)[:, None]
    arm = np.array([x + 56, 125.0]) + way * 70 * np.array([np.cos(turn), np.sin(turn)])
    shade = _arc((x, 130), (38, 56), 0.4, 1.4)
    drawn = [(body, 3.5, INK), (eyes[0], 2.5, INK), (eyes[1], 2.5, INK), (mouth, 3.0, INK), (arm, 3.5, INK), (shade, 2.5, RED)]
    return [(points * SCALE, width, colour) for points, width, colour in drawn]


@cache
def picture(frame: int) -> np.ndarray:
    """The drawing as pixels, with smooth edges. It is drawn once: nobody may change it."""
    width, height = SIZE
    xs, ys = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    found = np.tile(np.array(PAPER, float), (height, width, 1))
    for points, line_width, colour in lines(frame):
        away = np.full(xs.shape, np.inf)
        for a, b in zip(points, points[1:]):
            # Only the pixels around the piece.
            low = np.maximum(np.floor(np.minimum(a, b) - 5).astype(int), 0)
            high = np.ceil(np.maximum(a, b) + 5).astype(int)
            box = slice(low[1], high[1]), slice(low[0], high[0])
            x, y, way = xs[box] - a[0], ys[box] - a[1], b - a
            along = ((x * way[0] + y * way[1]) / max(way @ way, 1e-9)).clip(0, 1)
            away[box] = np.minimum(away[box], np.hypot(x - along * way[0], y - along * way[1]))
        cover = (line_width / 2 + 0.5 - away).clip(0, 1)[..., None]
        found += cover * (np.array(colour, float) - found)
    made = found.round().astype(np.uint8)
    made.flags.writeable = False
    return made


def draw_sequence(folder):
    """Writes the pictures. Returns the first one."""
    folder.mkdir(parents=True, exist_ok=True)
    for frame in range(COUNT):
        write_png(folder / f"line_{frame + 1:03}.png", picture(frame))
    return folder / "line_001.png"


def set_up(first):
    """A scene with the film as footage, on frames 1 to 6. Returns the object, which is active."""
    bpy.ops.rototoon.setup(filepath=str(first))
    bpy.context.scene.frame_set(1)
    return bpy.context.object


def strokes(addon, ob, layer, frame):
    """The strokes of a drawing as pixels, by number, in drawing order."""
    gp, placement = addon("blender.grease_pencil"), addon("blender.placement")
    handle, _ = gp.drawings(gp.find_layer(ob, layer))[frame]
    starts = gp.offsets(handle)
    total, count = int(starts[-1]), len(starts) - 1
    mapping = placement.Mapper(ob, [frame], {}, [layer]).at(0, frame)
    points = mapping.to_pixels(gp.positions(handle, total)) if total else np.zeros((0, 2))
    tracks = gp.value(handle, gp.TRACK, count)
    return {int(track): points[a:b] for track, a, b in zip(tracks, starts, starts[1:])}


def put(addon, ob, layer, frame, drawn, radius=0.03, opacity=0.8, material=0):
    """Draws strokes on a frame as the artist does: pixels and whether they are closed."""
    gp, placement, stroke_rows = addon("blender.grease_pencil"), addon("blender.placement"), addon("blender.stroke_rows")
    target = gp.layer(ob, layer)
    gp.make_frames(target, [frame], gp.KEYFRAME)
    handle = gp.drawings(target)[frame][0]
    mapping = placement.Mapper(ob, [frame], {}, [layer]).at(0, frame)
    points = np.concatenate([points for points, _ in drawn])
    rows = stroke_rows.Rows(np.array([len(points) for points, _ in drawn], np.int32))
    along = np.concatenate([np.linspace(0.5, 1.5, len(points)) for points, _ in drawn])
    rows.values = {
        "position": mapping.to_layer(points).astype(np.float32),
        "radius": (radius * along).astype(np.float32),
        "opacity": np.full(len(points), opacity, np.float32),
        "cyclic": np.array([closed for _, closed in drawn]),
        "material_index": np.full(len(drawn), material, np.int32),
    }
    stroke_rows.append(handle, rows)
    target.id_data.layers.active = target
