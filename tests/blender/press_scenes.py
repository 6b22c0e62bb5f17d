"""The files on which `press.py` presses buttons: the studio's, made ready for one operator after the other."""

from pathlib import Path

import bpy
import line_shots
import shots
import stand_in
import studio
import window
from window import in_view, view

_kept: dict[str, str] = {}
_real: list = []
"""What makes sessions, matches contours, traces lines and paints in the installed extension."""
STAND_INS = (stand_in.Session.from_document, stand_in.match_contours, stand_in.Tracer.from_document, stand_in.Painter.from_document)
"""What does so on the studio's file."""
INSTEAD = {"apply_motion": {"style": "plain"}}
"""Properties other than those of the table: the button takes the content from the list, in which the first clip is chosen."""


def build(addon, folder: Path) -> None:
    """Writes the studio's file."""
    folder.mkdir(parents=True, exist_ok=True)
    sessions = addon("capture.sessions")
    _real.extend((sessions.make, sessions.matcher, addon("lines.tracing").make, addon("paint.filling").make))
    _track_with(addon, *STAND_INS)
    _kept["folder"] = str(folder)
    _kept["studio"] = studio.build(addon, folder)


def _track_with(addon, make, matcher, tracer, painter) -> None:
    """The studio's figure is not in its footage, so a stand-in tracks and traces there. The steps are done with the library."""
    sessions = addon("capture.sessions")
    sessions.clear()
    sessions.make, sessions.matcher = make, matcher
    addon("lines.tracing").make = tracer
    addon("paint.filling").make = painter


def film(addon, folder: Path):
    """Opens the studio's file with the line film as footage of a new drawing, seen through the camera. It is painted with the library."""
    ready(addon, "setup")
    _track_with(addon, *_real)
    with in_view():
        ob = line_shots.set_up(line_shots.draw_sequence(folder))
        view()[0].spaces.active.region_3d.view_perspective = "CAMERA"
    return ob


def stand_in_again(addon) -> None:
    """After work with the library."""
    _track_with(addon, *STAND_INS)


def options(name: str) -> dict:
    """The properties with which the table calls an operator."""
    found = studio.OPERATORS[name].options
    return {key: studio.placed(value, _kept["folder"]) for key, value in found.items()} | INSTEAD.get(name, {})


def ready(addon, name: str) -> None:
    """Opens the studio and does what the table says before an operator; its button then works with the table's properties."""
    _track_with(addon, *STAND_INS)
    with bpy.context.temp_override(window=window.main_window()):
        bpy.ops.wm.open_mainfile(filepath=_kept["studio"], load_ui=False)
    with in_view():
        call = studio.OPERATORS[name]
        ob = studio.activate(bpy.data.objects[studio.OBJECT])
        studio.activate(bpy.data.objects[call.on])
        if name == "match_contours":
            _second_drawing(addon, ob)
        call.prepare(addon, ob)
        if name == "make_part":
            _select(addon, ob, int(call.options["numbers"]))
    last = bpy.context.window_manager.operator_properties_last(f"rototoon.{name}")
    # The entries of some menus are those of the active object.
    with in_view():
        for key, value in options(name).items():
            if key not in ("filepath", "directory") and last is not None:
                setattr(last, key, value)


def _second_drawing(addon, ob) -> None:
    """Makes a second key frame. With only one, each new contour becomes a part at once, and nothing waits for Match Contours."""
    bpy.context.scene.frame_set(2)
    bpy.ops.rototoon.new_key()
    bpy.context.scene.frame_set(1)


def _select(addon, ob, number: int) -> None:
    """Selects a traced stroke, as an artist does for a button that takes no numbers."""
    gp = addon("blender.grease_pencil")
    handle = gp.drawings(ob.data.layers[studio.LINES])[1][0]
    numbers = gp.value(handle, gp.TRACK, len(gp.offsets(handle)) - 1)
    handle.attributes.new(".selection", "BOOLEAN", "CURVE").data.foreach_set("value", numbers == number)


def step(addon, name: str) -> None:
    """Opens the studio and works there, on an object of its own, until the panel Steps asks for an operator."""
    ready(addon, "setup")
    _track_with(addon, *_real)
    with in_view():
        studio.activate(bpy.data.objects["Rig"])
        if name in ("setup", "open_sample"):
            return
        bpy.ops.rototoon.setup(filepath=options("setup")["filepath"], start_drawing=False)
        ob = bpy.context.object
        for work in STEPS[name]:
            work(addon, ob)
        ob.data.update_tag()
        addon("capture.stand").read(ob)


def _first_key(addon, ob):
    shots.draw(addon, ob, 1, [shots.diamond(0), shots.square(0)])
    bpy.context.scene.frame_set(9)


def _second_key(addon, ob):
    shots.draw(addon, ob, 9, [shots.diamond(8), shots.square(8)])
    bpy.ops.rototoon.match_contours()


def _tracked(addon, ob):
    bpy.ops.rototoon.track()
    bpy.context.scene.frame_set(4)


def _corrected(addon, ob):
    # There the square hides most of the diamond, so the tracker says that it is lost until an artist confirms it.
    shots.move(addon, ob, 8, 1, (0.5, -0.5))
    bpy.ops.rototoon.track()


_WORK = (_first_key, _second_key, _tracked, _corrected)
STEPS = {
    "setup": (),
    "open_sample": (),
    "draw_contours": (),
    "new_key": _WORK[:1],
    "track": _WORK[:2],
    "weakest_frame": _WORK[:3],
    "snap": _WORK,
}
"""By operator what is done before the panel Steps asks for it."""


def aside() -> tuple[int, int]:
    """A place where the mouse changes nothing: the middle of the view."""
    region = view()[1]
    return region.x + region.width // 2, region.y + region.height // 2
