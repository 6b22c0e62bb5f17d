"""One file on which every operator of the add-on finds something to do: contours, snapped lines, limbs, ink, an armature, clips.

`OPERATORS` says for each operator how to call it there, and which layers it writes. A test compares the table with the registered
operators, so that a new operator needs an entry.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import bpy
import numpy as np
import shots
import test_bones
import test_import_motion
import test_style

OBJECT = "shot"
CONTOURS, SNAPPED, LIMBS, INK, FRONT, LINES, PAINT = "Contours", "Snapped", "Limbs", "Ink", "Front", "Lines", "Paint"


def build(addon, folder, last: int = shots.COUNT, points: tuple[int, int] = (60, 40)) -> str:
    """Writes the file and returns its path. The sessions of `stand_in` must be in place.

    `last` is the frame of the second key of the ink, and `points` are the numbers of points of its line and its disc.
    """
    ob = shots.set_up(folder)
    shots.draw(addon, ob, 1, test_style.figure())
    bpy.ops.rototoon.match_contours()
    shots.limb_lines(addon, ob, test_style.figure(), test_style.LINES)
    bpy.ops.rototoon.track()
    shots.move(addon, ob, 2, 1, (3.0, 1.0), which=[0])
    bpy.ops.rototoon.track()
    bpy.ops.rototoon.snap()
    for layer, lift in ((INK, 0.0), (FRONT, 0.4)):
        _ink(addon, ob, layer, lift, last, points)
    rig = test_bones.armature()
    for who, factor in (("plain", 1.0), ("old", 0.7)):
        for motion, count in (("walk", 8), ("wave", 6)):
            postures = test_bones.walk(addon, count)
            middle = postures.mean((0, 1))
            test_bones.put(addon, folder / "clips", middle + factor * (postures - middle), who, motion)
    ob.rototoon.clips_folder = rig.rototoon.clips_folder = str(folder / "clips")
    (folder / "walk.bvh").write_text(test_import_motion.motion())
    bpy.context.view_layer.objects.active = ob
    bpy.ops.rototoon.export_document(filepath=str(folder / "given.json"))
    ob.name = OBJECT
    bpy.ops.rototoon.send_to_farm(directory=str(folder / "farm"))
    come_back(addon, ob, folder / "farm")
    path = str(folder / "studio.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    return path


def come_back(addon, ob, folder, shift: float = 1.0, name: str = "", **fields) -> None:
    """What `rototoon batch` would write for an object that was sent: its own tracks, a little to the right."""
    document = addon("capture.document").read(ob, results=True).document
    for part in document["parts"]:
        tracks = part.get("tracks", {})
        for frame in tracks.keys() - part["keys"].keys():
            tracks[frame] = [[x + shift, y] for x, y in tracks[frame]]
    results = folder / "results" / (name or addon("farm.batch").shot_names([{"blend": "", "object": ob.name}])[0])
    results.mkdir(parents=True, exist_ok=True)
    (results / "tracked.json").write_text(json.dumps(document))
    record = {"rototoon_record": 1, "steps": [{"step": "track", "outputs": ["tracked.json"]}], "failure": "", **fields}
    (results / "batch.json").write_text(json.dumps(record))


def _ink(addon, ob, name: str, lift: float, last: int, points: tuple[int, int]) -> None:
    """Two keys with a line behind a filled disc; on `FRONT` a little higher."""
    gp = addon("blender.grease_pencil")
    layer = ob.data.layers.new(name)
    way, turn = np.linspace(0, 1, points[0]), np.linspace(0, 2 * np.pi, points[1], endpoint=False)
    for frame, along in ((1, 0.0), (last, 0.7)):
        line = np.stack([4 * way - 2 + along, 0 * way, 0.1 * np.sin(3 * way) + lift], 1)
        disc = np.stack([0.6 * np.cos(turn) + along, 0 * turn, 0.6 * np.sin(turn) + lift], 1)
        drawing = layer.frames.new(frame).drawing
        drawing.add_strokes(list(points))
        gp.put(drawing, "position", np.concatenate([line, disc]))
        gp.put(drawing, "cyclic", np.array([False, True]))
        for each in ("radius", "opacity"):
            gp.put(drawing, each, gp.blank(each, sum(points)))
        gp.put(drawing, "fill_id", np.array([0, 1]))
        drawing.tag_positions_changed()
    if not gp.FILL_BY_ID:
        for frame in layer.frames:
            gp.put(frame.drawing, "material_index", np.array([0, 1]))
        if len(ob.data.materials) < 2:
            ob.data.materials.append(ob.data.materials[0].copy())
            ob.data.materials[1].grease_pencil.show_fill = True


def open_file(path: str):
    """Opens the file. Returns the object, active, on frame 1."""
    bpy.ops.wm.open_mainfile(filepath=path)
    return activate(bpy.data.objects[OBJECT])


def activate(ob):
    """Makes an object the active and only selected one."""
    for other in bpy.context.view_layer.objects:
        other.select_set(other == ob)
    bpy.context.view_layer.objects.active = ob
    bpy.context.scene.frame_set(1)
    return ob


def digests(addon, ob) -> dict[str, str]:
    """By layer a digest of everything that its frames and drawings hold."""
    gp, found = addon("blender.grease_pencil"), {}
    for layer in ob.data.layers:
        summed = hashlib.blake2b(digest_size=12)
        for number, (handle, kind) in gp.drawings(layer).items():
            starts = gp.offsets(handle)
            summed.update(f"{number} {kind}".encode() + starts.tobytes())
            for attribute in sorted(handle.attributes, key=lambda each: each.name):
                if attribute.name == ".selection":
                    # What is selected in Edit Mode is no part of the drawing.
                    continue
                count = int(starts[-1]) if attribute.domain == "POINT" else len(starts) - 1
                values = None if attribute.name.startswith(".") else gp.get(handle, attribute.name, count)
                summed.update(attribute.name.encode() + (b"" if values is None else values.tobytes()))
        found[layer.name] = summed.hexdigest()
    return found


@dataclass(frozen=True)
class Call:
    """How an operator is called."""

    writes: frozenset[str] = frozenset()
    """The layers that it writes."""
    hidden: frozenset[str] = frozenset()
    """Those that it writes even if they are hidden."""
    changes: bool = True
    """Whether it changes anything that belongs to the object: strokes, settings or animation."""
    prepare: Callable = lambda addon, ob: None
    """What the artist does before, `prepare(addon, ob)`."""
    options: dict = field(default_factory=dict)
    """Properties. `{folder}` is the file's folder."""
    on: str = OBJECT
    """Name of the active object."""


def call(name: str, folder) -> set[str]:
    """Calls an operator as the table says."""
    options = {key: placed(value, folder) for key, value in OPERATORS[name].options.items()}
    return getattr(bpy.ops.rototoon, name)(**options)


def placed(value, folder):
    """A value with the folder of the test and the name of the open file in it."""
    if not isinstance(value, str):
        return value
    return value.replace("{folder}", str(folder)).replace("{file}", Path(bpy.data.filepath).stem)


def _loose_stroke(addon, ob):
    shots.draw(addon, ob, 1, [shots.square(0)])


def _not_tracked(addon, ob):
    shots.move(addon, ob, 2, 3, (4.0, 2.0), which=[1])


def _moved_and_tracked(addon, ob):
    _not_tracked(addon, ob)
    bpy.ops.rototoon.track()


def _exchanged(addon, ob):
    numbers = [part.number for part in ob.rototoon.parts][:2]
    addon("capture.exchanged").put(ob, [(*numbers, [2, 3])])


def _unseen(addon, ob):
    addon("capture.unseen").put(ob.rototoon.parts[0], [2, 3])


def _on_generated(addon, ob):
    bpy.context.scene.frame_set(2)


def _beyond_the_end(addon, ob):
    bpy.context.scene.frame_set(30)


def _in_between(addon, ob):
    bpy.ops.rototoon.in_between(frames="ALL")


def _in_between_and_moved(addon, ob):
    _in_between(addon, ob)
    gp = addon("blender.grease_pencil")
    for name in (INK, FRONT):
        handle = list(gp.drawings(ob.data.layers[name]).values())[-1][0]
        points = gp.positions(handle, int(gp.offsets(handle)[-1]))
        points[:, 2] += 0.2
        gp.put(handle, "position", points)


def _line_without_name(addon, ob):
    gp = addon("blender.grease_pencil")
    handle = gp.drawings(ob.data.layers[LIMBS])[1][0]
    strokes = len(gp.offsets(handle)) - 1
    numbers = gp.value(handle, gp.KEY_POINT, strokes)
    numbers[-1] = 0
    gp.put(handle, gp.KEY_POINT, numbers)


def _bones_known(addon, ob):
    bpy.ops.rototoon.guess_bones()


def _to_camera(addon, ob):
    bpy.context.scene.camera.data.show_background_images = True


def _reference(addon, ob):
    image = bpy.data.images.load(bpy.path.abspath("//frames/shot_001.png"), check_existing=True)
    empty = bpy.data.objects.new("reference", None)
    empty.empty_display_type, empty.data = "IMAGE", image
    image.source = "SEQUENCE"
    bpy.context.scene.collection.objects.link(empty)
    empty.select_set(True)


def _one_traced(addon, ob):
    bpy.ops.rototoon.trace_drawing(frames="CURRENT")


def _traced(addon, ob):
    bpy.ops.rototoon.trace_drawing()


def _traced_and_doubted(addon, ob):
    _traced(addon, ob)
    gp = addon("blender.grease_pencil")
    handle = gp.drawings(ob.data.layers[LINES])[3][0]
    gp.put(handle, gp.CONFIDENCE, np.full(int(gp.offsets(handle)[-1]), 0.3))


def _traced_and_doubted_here(addon, ob):
    _traced_and_doubted(addon, ob)
    bpy.ops.rototoon.next_doubt()


def _traced_and_moved(addon, ob):
    _traced(addon, ob)
    gp = addon("blender.grease_pencil")
    handle = gp.drawings(ob.data.layers[LINES])[1][0]
    points = gp.positions(handle, int(gp.offsets(handle)[-1]))
    points[0, 2] += 0.2
    gp.put(handle, "position", points)


def _one_traced_and_reference(addon, ob):
    _one_traced(addon, ob)
    _reference(addon, ob)
    bpy.context.scene.frame_set(3)


def _clicked(addon, ob):
    bpy.ops.rototoon.paint_bucket(place=(20.0, 20.0))


def _painted(addon, ob):
    _clicked(addon, ob)
    bpy.ops.rototoon.fill_drawings()


def _painted_and_chosen(addon, ob):
    _painted(addon, ob)
    paint = [place for place, own in enumerate(ob.data.materials) if own is not None and own.name.startswith("Paint ")]
    ob.active_material_index = paint[-1]


def _recoloured(addon, ob):
    _painted_and_chosen(addon, ob)
    bpy.ops.rototoon.recolour(colour=(0.1, 0.2, 0.3))


def _painted_and_doubted(addon, ob):
    _painted(addon, ob)
    gp = addon("blender.grease_pencil")
    handle = gp.drawings(ob.data.layers[PAINT])[3][0]
    gp.put(handle, gp.CONFIDENCE, np.full(int(gp.offsets(handle)[-1]), 0.3))


def _ink_active(addon, ob):
    ob.data.layers.active = ob.data.layers[INK]


def _delivered_again(addon, ob):
    folder = Path(bpy.path.abspath("//again"))
    folder.mkdir(exist_ok=True)
    for number in range(shots.COUNT):
        (folder / f"new_{number + 101}.png").write_bytes(shots.drawn_again(number))


_C, _I, _L, _P = frozenset({CONTOURS}), frozenset({INK, FRONT}), frozenset({LINES}), frozenset({PAINT})
# The place is given: to find it takes two seconds, and is tested elsewhere.
_PLACED = {
    "filepath": "{folder}/again/new_101.png", "compare": False, "frame_offset": 100, "scale": float(shots.SCALE), "find_shift": False,
    "shift": (shots.BORDER, shots.BORDER),
}  # fmt: skip
_STYLED = {"motion": "walk", "content": "plain", "style": "old"}
OPERATORS = {
    "accept_doubt": Call(_L, prepare=_traced_and_doubted_here, options={"every": True}),
    "apply_motion": Call(_C, _C, options=_STYLED),
    "carry_strokes": Call(frozenset({INK}), prepare=_ink_active),
    "choose_body": Call(frozenset({LIMBS}), options={"body": "quadruped"}),
    "clear_fills": Call(_P, prepare=_painted),
    "clear_generated": Call(_C | {SNAPPED}, options={"corrected": True}),
    "clear_in_betweens": Call(_I, prepare=_in_between),
    "clear_lines": Call(_L, prepare=_traced),
    "collect_results": Call(_C, _C, options={"directory": "{folder}/farm"}),
    "conform": Call(_C | {SNAPPED, LIMBS}, _C | {SNAPPED, LIMBS}, prepare=_delivered_again, options=_PLACED),
    "contours_to_mask": Call(changes=False),
    "define_limbs": Call(frozenset({LIMBS}), prepare=_line_without_name, options={"point": "r_knee"}),
    "depth_mark": Call(options={"front": "Part 1", "behind": "Part 2"}),
    "draw_contours": Call(_C, prepare=_beyond_the_end),
    "drive_bones": Call(on="Rig", options={"content": "plain"}),
    "exchanged_parts": Call(changes=False, prepare=_exchanged),
    "export_document": Call(changes=False, options={"filepath": "{folder}/out.json"}),
    "fill_drawings": Call(_P, prepare=_clicked),
    "fit_strokes": Call(_I | {SNAPPED}, options={"frames": "ALL"}),
    "footage_from_camera": Call(prepare=_to_camera),
    "footage_from_file": Call(options={"filepath": "{folder}/frames/shot_001.png"}),
    "footage_from_reference": Call(prepare=_reference),
    "guess_bones": Call(on="Rig"),
    "help": Call(changes=False),
    "hide_part": Call(_C | {SNAPPED}, _C, prepare=_on_generated),
    "hide_unseen": Call(_C | {SNAPPED}, _C, prepare=_unseen),
    "hidden_lines": Call(_I | {SNAPPED, LIMBS}),
    "import_document": Call(_C | {SNAPPED}, _C | {SNAPPED}, options={"filepath": "{folder}/given.json", "into": "ACTIVE"}),
    "import_motion": Call(changes=False, options={"filepath": "{folder}/walk.bvh", "replace": True}),
    "in_between": Call(_I, options={"frames": "ALL"}),
    "make_part": Call(_C, _C, prepare=_traced, options={"numbers": "2"}),
    "match_contours": Call(_C, _C, prepare=_loose_stroke),
    "match_lines": Call(_L, prepare=_traced, options={"earlier": 1, "later": 2}),
    "match_strokes": Call(_I | {SNAPPED}),
    "next_doubt": Call(prepare=_traced_and_doubted),
    "next_doubtful_region": Call(prepare=_painted_and_doubted),
    "new_key": Call(_C, _C, prepare=_on_generated),
    "open_sample": Call(changes=False),
    "paint_bucket": Call(_P, prepare=_clicked, options={"place": (90.0, 60.0)}),
    "recolour": Call(_P, prepare=_painted_and_chosen, options={"colour": (0.1, 0.2, 0.3)}),
    "remove_recolour": Call(prepare=_recoloured),
    "refresh_clips": Call(changes=False),
    "release_pins": Call(_C, prepare=_moved_and_tracked, options={"which": "ALL"}),
    "reshape_drawing": Call(_C, _C, options={"character": "plain"}),
    "reshape_picture": Call(options={"character": "plain"}),
    "save_clip": Call(changes=False, options={"replace": True}),
    "save_clip_from_armature": Call(on="Rig", changes=False, prepare=_bones_known, options={"first": 1, "last": 4, "replace": True}),
    "send_to_farm": Call(changes=False, options={"directory": "{folder}/farm of {file}"}),
    "setup": Call(changes=False, options={"filepath": "{folder}/frames/shot_001.png"}),
    "show_confidence": Call(),
    "snap": Call(frozenset({SNAPPED}), prepare=_moved_and_tracked),
    "spread_edits": Call(_L, prepare=_traced_and_moved),
    "trace_drawing": Call(_L, prepare=_one_traced),
    "trace_image": Call(_L, prepare=_one_traced_and_reference),
    "suggest_breakdown": Call(changes=False),
    "track": Call(_C, _C, prepare=_not_tracked),
    "unseen_part": Call(changes=False, prepare=_unseen),
    "update_in_betweens": Call(_I, prepare=_in_between_and_moved),
    "weakest_frame": Call(changes=False),
}
