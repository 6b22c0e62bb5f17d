"""Small footage and scenes for the tests, drawn here."""

import struct
import zlib
from functools import cache

import bpy
import numpy as np


def write_png(path, picture):
    """Writes an 8-bit RGB picture (H, W, 3)."""
    path.write_bytes(png(picture))


def png(picture):
    """An 8-bit RGB picture (H, W, 3) as a file."""
    height, width, _ = picture.shape

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + picture[y].tobytes() for y in range(height))
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    body = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + body


SIZE = (160, 90)
COUNT = 9


def square(frame):
    """Corners of the red square on picture `frame` (0 to 8), in pixels."""
    x, y = 20.0 + 8 * frame, 25.0 + 2 * frame
    return np.array([[x, y], [x + 30, y], [x + 30, y + 24], [x, y + 24]])


def diamond(frame):
    """Corners of the blue diamond, in pixels."""
    x, y = 120.0 - 3 * frame, 60.0
    return np.array([[x, y - 14], [x + 16, y], [x, y + 14], [x - 16, y]])


def inside(polygon, xs, ys):
    mask = np.ones(xs.shape, bool)
    for a, b in zip(polygon, np.roll(polygon, -1, 0)):
        mask &= (b[0] - a[0]) * (ys - a[1]) - (b[1] - a[1]) * (xs - a[0]) >= 0
    return mask


def draw_sequence(folder, name="shot_%03d.png", first=1, count=COUNT):
    """Pictures of a red square and a blue diamond with dark outlines, moving over a pale ground."""
    folder.mkdir(parents=True, exist_ok=True)
    for number in range(count):
        (folder / (name % (first + number))).write_bytes(drawn(number))
    return folder / (name % first)


@cache
def drawn(number):
    """Picture `number` as a file. Most tests want the same few."""
    width, height = SIZE
    xs, ys = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    picture = np.full((height, width, 3), (235, 228, 210), np.uint8)
    for shape, colour in ((diamond(number), (50, 90, 200)), (square(number), (205, 50, 45))):
        centre = shape.mean(0)
        picture[inside(shape, xs, ys)] = (25, 20, 30)
        picture[inside(centre + (shape - centre) * 0.88, xs, ys)] = colour
    return png(picture)


SCALE, BORDER = 2, 16
"""Of footage that is delivered again: how much larger the old picture is, and the border around it, in pixels."""


def placed(points):
    """Where places of the old picture are in that of `drawn_again`."""
    return np.asarray(points) * SCALE + BORDER


@cache
def drawn_again(number, redrawn=False):
    """Picture `number` as a file, larger and with a border. If it is `redrawn`, it has a ring in place of the diamond."""
    height, width = (SIZE[k] * SCALE + 2 * BORDER for k in (1, 0))
    xs, ys = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    picture = np.full((height, width, 3), (235, 228, 210), np.uint8)
    for shape, colour in ((diamond(number), (50, 90, 200)), (square(number), (205, 50, 45))):
        centre = shape.mean(0)
        if redrawn and colour[2] == 200:
            away = np.hypot(xs - placed(centre)[0], ys - 60)
            picture[away < 50] = (25, 20, 30)
            picture[away < 44] = (90, 160, 80)
            continue
        picture[inside(placed(shape), xs, ys)] = (25, 20, 30)
        picture[inside(placed(centre + (shape - centre) * 0.88), xs, ys)] = colour
    return png(picture)


def set_up(folder, **options):
    """A scene with the sequence in a camera's background and an object to draw on, made active."""
    picked = draw_sequence(folder / "frames", count=COUNT)
    bpy.ops.rototoon.setup(filepath=str(picked), **options)
    bpy.context.view_layer.update()
    return bpy.context.object


def mapping(addon, ob, frame=1):
    """The mapping of the object's contours layer."""
    placement = addon("blender.placement")
    return placement.Mapper(ob, [frame], {}, [ob.rototoon.contours_layer]).at(0, frame)


def draw(addon, ob, frame, shapes, cyclic=True):
    """Strokes through pixels on a frame of the contours layer, as an artist's: no attribute of the add-on is set."""
    gp = addon("blender.grease_pencil")
    layer = ob.data.layers[ob.rototoon.contours_layer]
    if frame not in gp.drawings(layer):
        layer.frames.new(frame)
    drawing = gp.drawings(layer)[frame][0]
    before = len(gp.offsets(drawing)) - 1
    total = int(gp.offsets(drawing)[-1])
    drawing.add_strokes([len(shape) for shape in shapes])
    points = mapping(addon, ob, frame).to_layer(np.concatenate(shapes)).astype(np.float32)
    every = gp.positions(drawing, total + len(points))
    every[total:] = points
    gp.put(drawing, "position", every)
    flags = gp.value(drawing, "cyclic", before + len(shapes))
    flags[before:] = cyclic
    gp.put(drawing, "cyclic", flags)
    return drawing


def layer_of(ob):
    return ob.data.layers[ob.rototoon.contours_layer]


def pixels(addon, ob, frame):
    """Pixels of each stroke on a frame, by part number, in drawing order."""
    gp = addon("blender.grease_pencil")
    handle, _ = gp.drawings(layer_of(ob))[frame]
    starts = gp.offsets(handle)
    numbers = gp.value(handle, gp.PART, len(starts) - 1)
    points = mapping(addon, ob, frame).to_pixels(gp.positions(handle, int(starts[-1])))
    return [(int(n), points[a:b]) for n, a, b in zip(numbers, starts, starts[1:])]


def move(addon, ob, frame, part, shift, which=None):
    """Moves points of a part's stroke by pixels, as an artist does in edit mode."""
    gp = addon("blender.grease_pencil")
    handle, _ = gp.drawings(layer_of(ob))[frame]
    starts = gp.offsets(handle)
    index = list(gp.value(handle, gp.PART, len(starts) - 1)).index(part)
    points = gp.positions(handle, int(starts[-1]))
    chosen = np.arange(starts[index], starts[index + 1])
    chosen = chosen if which is None else chosen[which]
    m = mapping(addon, ob, frame)
    points[chosen] = m.to_layer(m.to_pixels(points[chosen]) + shift)
    gp.put(handle, "position", points)
    handle.tag_positions_changed()


def limb_line(addon, ob, contours, place, point=None):
    """A line on the limb layer on frame 1, for a key point of the body if one is given.

    `place` is a part's number and the two places along its contour that the line joins.
    """
    gp, limbs, placement = addon("blender.grease_pencil"), addon("style.limbs"), addon("blender.placement")
    layer = ob.data.layers.get(limbs.LAYER) or ob.data.layers.new(limbs.LAYER)
    if 1 not in gp.drawings(layer):
        layer.frames.new(1)
    handle = gp.drawings(layer)[1][0]
    part, *ends = place
    total = int(gp.offsets(handle)[-1])
    handle.add_strokes([2])
    every = gp.positions(handle, total + 2)
    line = np.array([_along(contours[part], end) for end in ends])
    every[total:] = placement.Mapper(ob, [1], {}, [limbs.LAYER]).at(0, 1).to_layer(line)
    gp.put(handle, "position", every.astype(np.float32))
    if point is not None:
        assert bpy.ops.rototoon.define_limbs(point=point) == {"FINISHED"}


def limb_lines(addon, ob, contours, places):
    """Lines for key points of the body, by their names."""
    for point, place in places.items():
        limb_line(addon, ob, contours, place, point)


def _along(contour, place):
    """The point at a place along a contour: 1.5 is halfway from point 1 to point 2."""
    low = int(place)
    return contour[low] + (place - low) * (contour[(low + 1) % len(contour)] - contour[low])


def two_keys(addon, folder):
    """The scene with square and diamond keyed on frames 1 and 9."""
    ob = set_up(folder)
    draw(addon, ob, 1, [diamond(0), square(0)])
    bpy.context.scene.frame_set(9)
    bpy.ops.rototoon.new_key()
    shapes = [diamond(8), square(8)]
    gp = addon("blender.grease_pencil")
    handle, _ = gp.drawings(layer_of(ob))[9]
    points = mapping(addon, ob, 9).to_layer(np.concatenate(shapes))
    gp.put(handle, "position", points.astype(np.float32))
    return ob


def snapshot(ob):
    """Everything in the strokes, the parts and the frames, to compare."""
    state = {}
    for layer in ob.data.layers:
        for frame in layer.frames:
            values = {}
            for attribute in frame.drawing.attributes:
                if attribute.name.startswith("."):
                    continue
                key = {"FLOAT_VECTOR": "vector", "FLOAT_COLOR": "color"}.get(attribute.data_type, "value")
                values[attribute.name] = [
                    tuple(v) if key != "value" else v for v in (getattr(d, key) for d in attribute.data)
                ]
            state[layer.name, frame.frame_number] = (frame.keyframe_type, values)
    parts = [(p.number, p.name, p.closed, p.depth, p.count) for p in ob.rototoon.parts]
    return state, parts
