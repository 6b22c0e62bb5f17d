"""In a Blender with a window: install the zip and photograph every panel, the window, and Match Strokes at work.

Started by `cargo xtask photograph` as `blender --python photograph.py -- ZIP SAMPLE OUT READY`. SAMPLE is the folder of the
sample cartoon, OUT the folder of the pictures. READY is written when all pictures are there, or with what went wrong.

A panel is photographed alone: the other panels of the tab are unregistered meanwhile, and what is below it is cut off.
"""

import math
import random
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import bpy
import numpy as np
import tab
import window
from window import in_view, of_region, screen, view

ZIP, SAMPLE, OUT, READY = (Path(word).absolute() for word in sys.argv[sys.argv.index("--") + 1 :][:4])
TABS_WIDTH = 22
"""Pixels of the tabs beside the panels, at a scale of 1."""
SCALE = 1.3
"""Of the window's texts and buttons."""
EDGE = 8
"""Pixels of a region's lower border."""
CLIPS = OUT / "clips"
BONES = {
    "hips": ("", (0, 0, 1.0), (0, 0, 1.15)),
    "spine": ("hips", (0, 0, 1.15), (0, 0, 1.3)),
    "chest": ("spine", (0, 0, 1.3), (0, 0, 1.5)),
    "neck": ("chest", (0, 0, 1.5), (0, 0, 1.6)),
    "head": ("neck", (0, 0, 1.6), (0, 0, 1.85)),
}
for _side, _way in (("L", 1), ("R", -1)):
    BONES |= {
        f"upper_arm.{_side}": ("chest", (0.18 * _way, 0, 1.45), (0.45 * _way, 0, 1.45)),
        f"forearm.{_side}": (f"upper_arm.{_side}", (0.45 * _way, 0, 1.45), (0.7 * _way, 0, 1.45)),
        f"thigh.{_side}": ("hips", (0.1 * _way, 0, 1.0), (0.1 * _way, 0, 0.55)),
        f"shin.{_side}": (f"thigh.{_side}", (0.1 * _way, 0, 0.55), (0.1 * _way, 0, 0.1)),
    }


# -- scenes ------------------------------------------------------------------------------------------------------


def prepare() -> None:
    """Installs the extension and makes the window plain."""
    window.install(ZIP)
    preferences = bpy.context.preferences
    preferences.view.ui_scale = SCALE
    # Otherwise the view shines through below the panels.
    preferences.system.use_region_overlap = False
    OUT.mkdir(exist_ok=True)


def finished(operator, **properties) -> None:
    """Calls an operator; anything but FINISHED ends the session."""
    if operator(**properties) != {"FINISHED"}:
        raise RuntimeError(f"{operator} did not finish")


def cleared() -> None:
    """Takes all objects away."""
    for ob in list(bpy.data.objects):
        bpy.data.objects.remove(ob)


def imported() -> None:
    """The sample with its keys."""
    finished(bpy.ops.rototoon.import_document, filepath=str(SAMPLE / "project.json"), keep_numbers=True)


def tracked() -> None:
    """The imported sample with its tracks and snapped lines, and its motions in a library."""
    finished(bpy.ops.rototoon.track)
    finished(bpy.ops.rototoon.snap)
    for motion, first, last in (("walk", 0, 11), ("jump", 12, 23)):
        clip = {"character": "boy", "motion": motion, "first": first, "last": last, "folder": str(CLIPS)}
        finished(bpy.ops.rototoon.save_clip, **clip)
    bpy.context.object.rototoon.clips_folder = str(CLIPS)
    bpy.context.scene.frame_set(8)


def ellipse(x, y, across, up, first=0.0, last=math.tau, steps=40):
    """Points of an ellipse or of a part of it, and whether it is closed."""
    closed = last - first >= math.tau
    turns = [first + (last - first) * k / (steps if closed else steps - 1) for k in range(steps)]
    return [(x + across * math.cos(t), y + up * math.sin(t)) for t in turns], closed


def figure() -> list:
    """The strokes of a figure, each with whether it is closed."""
    strokes = [ellipse(0, 1.6, 0.7, 0.8), ellipse(0, 1.35, 0.3, 0.2, 3.5, 5.9)]
    for side in (-1, 1):
        strokes.append(ellipse(0.25 * side, 1.7, 0.14, 0.18))
        strokes.append(ellipse(0.25 * side, 1.68, 0.05, 0.07))
        strokes.append(ellipse(0.25 * side, 2.0, 0.18, 0.1, 0.4, 2.7))
        strokes.append(([(0.3 * side, -0.9), (0.35 * side, -1.6), (0.4 * side, -2.2), (0.7 * side, -2.2)], False))
    lines = [
        [(0, 1.65), (0.1, 1.45), (-0.02, 1.45)],
        [(-0.2, 0.82), (-0.6, 0.6), (-0.5, -0.9), (0.5, -0.9), (0.6, 0.6), (0.2, 0.82)],
        [(-0.6, 0.6), (-1.2, 0.1), (-1.3, -0.6)],
        [(0.6, 0.6), (1.2, 0.1), (1.5, 0.7)],
        [(-0.5, -0.4), (0.5, -0.4)],
    ]
    lines += [[(-0.4 + 0.2 * k, 2.3), (-0.45 + 0.22 * k, 2.7)] for k in range(5)]
    return strokes + [(line, False) for line in lines]


def turned(angle=0.25, right=1.2) -> list:
    """The figure drawn again further on: without its belt, in another order, every other stroke the other way round."""
    cosine, sine = math.cos(angle), math.sin(angle)
    strokes = []
    for k, (points, closed) in enumerate(figure()):
        moved = [(cosine * x - sine * y + right, sine * x + cosine * y + 0.15) for x, y in points]
        if k != 14:
            strokes.append((moved[::-1] if k % 2 else moved, closed))
    random.Random(3).shuffle(strokes)
    return strokes


def drawn(angle=0.25, right=1.2) -> bpy.types.Object:
    """Two drawings of a figure."""
    data = getattr(bpy.data, "grease_pencils_v3", bpy.data.grease_pencils).new("Figure")
    ob = bpy.data.objects.new("Figure", data)
    bpy.context.collection.objects.link(ob)
    layer = data.layers.new("Lines")
    for frame, strokes in ((1, figure()), (13, turned(angle, right))):
        drawing = layer.frames.new(frame).drawing
        drawing.add_strokes([len(points) for points, _ in strokes])
        for stroke, (points, closed) in zip(drawing.strokes, strokes):
            stroke.cyclic = closed
            for point, (x, y) in zip(stroke.points, points):
                point.position, point.radius = (x, 0, y), 0.012
    bpy.context.view_layer.objects.active = ob
    bpy.context.scene.frame_set(6)
    return ob


def tweened() -> bpy.types.Object:
    """Two drawings with in-betweens."""
    ob = drawn(0.8, 5.0)
    finished(bpy.ops.rototoon.in_between, frames="CURRENT", spacing="CURVE", step=3)
    return ob


def shown_together(ob: bpy.types.Object) -> None:
    """An object with the strokes of all frames of another one; those of its keys are thick."""
    data = getattr(bpy.data, "grease_pencils_v3", bpy.data.grease_pencils).new("All")
    shown = bpy.data.objects.new("All", data)
    bpy.context.collection.objects.link(shown)
    target = data.layers.new("Lines").frames.new(1).drawing
    for frame in ob.data.layers[0].frames:
        key = frame.keyframe_type == "KEYFRAME"
        for stroke in list(frame.drawing.strokes):
            target.add_strokes([len(stroke.points)])
            copy = target.strokes[-1]
            copy.cyclic = stroke.cyclic
            for point, source in zip(copy.points, stroke.points):
                point.position, point.radius = source.position, 0.02 if key else 0.008
    ob.hide_set(True)


def armature() -> None:
    """A figure of bones with its arms spread."""
    data = bpy.data.armatures.new("Rig")
    ob = bpy.data.objects.new("Rig", data)
    bpy.context.scene.collection.objects.link(ob)
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")
    for bone, (parent, head, tail) in BONES.items():
        made = data.edit_bones.new(bone)
        made.head, made.tail = head, tail
        made.parent = data.edit_bones.get(parent)
    bpy.ops.object.mode_set(mode="OBJECT")
    ob.rototoon.clips_folder = str(CLIPS)
    finished(bpy.ops.rototoon.guess_bones)


# -- pictures ----------------------------------------------------------------------------------------------------


def save(name: str, pixels: np.ndarray) -> None:
    """Writes `OUT/name.png`."""
    window.save(OUT / f"{name}.png", pixels, *window.SMALL)


def of_panel(pixels: np.ndarray, sidebar) -> np.ndarray:
    """The sidebar without its tabs and without the empty space below its panels."""
    # The last rows are the region's border.
    found = of_region(pixels, sidebar)[:-EDGE, : -round(TABS_WIDTH * SCALE)]
    ground = found[-1, found.shape[1] // 2].astype(np.int16)
    rows = np.flatnonzero((np.abs(found - ground) > 5).any(2).mean(1) > 0.2)
    return found[: rows[-1] + 6] if len(rows) else found


# -- the session: yields the seconds until it goes on -------------------------------------------------------------


def panels_photographed(panels: list, names: list[str]):
    """A picture of each panel alone."""
    for name in names:
        tab.only(panels, next(panel for panel in panels if tab.title(panel) == name))
        yield from tab.shown()
        yield 2.0
        save(f"panel_{name}", of_panel(screen(), view()[2]))
    tab.only(panels, None)


def view_photographed(name: str, box=(0.0, 1.0, 0.0, 1.0)):
    """A picture of a part of the view: shares of its height and of its width, first to last."""
    area, region, _ = view()
    area.tag_redraw()
    yield 2.0
    pixels = of_region(screen(), region)
    top, bottom = (round(share * pixels.shape[0]) for share in box[:2])
    left, right = (round(share * pixels.shape[1]) for share in box[2:])
    save(name, pixels[top:bottom, left:right])


def looked_through_camera() -> None:
    """The view shows what the camera shows, as large as it fits, without outlines and axes."""
    space = view()[0].spaces.active
    space.shading.type = "SOLID"
    space.region_3d.view_perspective = "CAMERA"
    overlay = space.overlay
    overlay.show_outline_selected = overlay.show_cursor = overlay.show_object_origins = False
    overlay.show_axis_x = overlay.show_axis_y = False
    with in_view():
        bpy.ops.view3d.view_center_camera()


def looked_closely() -> None:
    """The camera's picture is larger than the view, the figure in its middle."""
    region = view()[0].spaces.active.region_3d
    region.view_camera_zoom, region.view_camera_offset = 45.0, (0.0, 0.0)


def looked_from_front() -> None:
    """The view shows all strokes from the front."""
    with in_view():
        bpy.ops.view3d.view_axis(type="FRONT")
        bpy.ops.view3d.view_all()


def capture(panels: list):
    """Pictures of the tracked sample."""
    imported()
    yield from panels_photographed(panels, ["start"])
    tracked()
    looked_through_camera()
    yield from tab.shown()
    looked_through_camera()
    yield 2.0
    save("window", screen())
    yield from panels_photographed(panels, ["footage", "parts", "track", "snap", "lines", "paint", "strokes", "document", "style"])
    bpy.context.object.rototoon.show_confidence = True
    bpy.context.object.data.layers["Snapped"].hide = True
    looked_closely()
    yield from view_photographed("confidence", (0.2, 0.87, 0.25, 0.75))


def between(panels: list):
    """Pictures of in-betweens and of pairs."""
    cleared()
    ob = tweened()
    yield from panels_photographed(panels, ["tween"])
    shown_together(ob)
    looked_from_front()
    yield from view_photographed("in_betweens", (0.25, 0.75, 0.08, 0.92))
    cleared()
    drawn()
    yield from tab.shown()
    looked_from_front()
    with in_view():
        bpy.ops.rototoon.match_strokes("INVOKE_DEFAULT")
    yield 5.0
    yield from view_photographed("pairs", (0.1, 0.9, 0.15, 0.88))


def session():
    """Everything, in order. Match Strokes stays at work, so it is last."""
    yield 1.0
    prepare()
    cleared()
    panels = tab.panels()
    yield 1.0
    yield from capture(panels)
    cleared()
    armature()
    yield from panels_photographed(panels, ["bones"])
    yield from between(panels)


window.run(session(), READY)
