"""What a newcomer meets: Set Up Footage, the steps, parts that appear while drawing, the sample, menus, help, grey buttons."""

from types import SimpleNamespace

import bpy
import layouts
import numpy as np
import press_scenes
import pytest
import shots
from conftest import ROOT


def new_file():
    """Blender's own new file, with its cube, camera and lamp."""
    bpy.ops.wm.read_homefile(use_empty=False, use_factory_startup=True)


def test_default_cube_and_camera_are_out_of_the_way(addon, tmp_path):
    new_file()
    old = bpy.context.scene.camera
    before = old.matrix_world.copy()
    ob = shots.set_up(tmp_path)
    cube, camera = bpy.data.objects["Cube"], bpy.context.scene.camera
    assert cube.hide_get() and cube.hide_render
    assert camera != old and ob.rototoon.camera == camera
    assert old.matrix_world == before and not len(old.data.background_images)
    # The new camera looks along the front view, in which Blender's drawing plane lies.
    corners = shots.mapping(addon, ob).to_layer(np.array([[0.0, 0.0], [160.0, 90.0]]))
    assert np.abs(corners - [[-5, 0, 2.8125], [5, 0, -2.8125]]).max() < 1e-4


def test_a_cube_that_somebody_uses_stays(addon, tmp_path):
    new_file()
    bpy.data.objects["Cube"].location.x = 1.0
    bpy.context.view_layer.update()
    shots.set_up(tmp_path)
    assert not bpy.data.objects["Cube"].hide_get()


def test_second_footage_leaves_the_first_alone(addon, tmp_path):
    first = shots.set_up(tmp_path / "one")
    camera, size = bpy.context.scene.camera, bpy.context.scene.render.resolution_x
    first.rototoon.camera = None  # a file of an earlier version
    before = shots.mapping(addon, first).to_layer(np.array([[10.0, 20.0], [150.0, 80.0]]))
    second = shots.set_up(tmp_path / "two", at_scene_start=False, frame=50)
    assert bpy.context.scene.camera not in {None, camera} and second.rototoon.camera == bpy.context.scene.camera
    assert first.rototoon.camera == camera
    after = shots.mapping(addon, first).to_layer(np.array([[10.0, 20.0], [150.0, 80.0]]))
    assert np.array_equal(before, after) and bpy.context.scene.render.resolution_x == size
    assert (bpy.context.scene.frame_start, bpy.context.scene.frame_end) == (1, 58)


def test_a_moving_camera_is_taken(addon, tmp_path):
    new_file()
    camera = bpy.context.scene.camera
    camera.name = "Shot"
    camera.keyframe_insert("location", frame=1)
    shots.set_up(tmp_path)
    assert bpy.context.scene.camera != camera and not len(camera.data.background_images)


def ticks(addon, ob):
    return [step.done for step in addon("ui.start").steps_of(ob)]


def test_steps_tick_themselves(addon, fake, tmp_path):
    start = addon("ui.start")
    assert not any(ticks(addon, None)) and start.next_of(start.steps_of(None)).operator == "rototoon.setup"
    ob = shots.set_up(tmp_path)
    stand = addon("capture.stand")
    done = []
    for change in (
        lambda: None,
        lambda: shots.draw(addon, ob, 1, [shots.diamond(0), shots.square(0)]),
        lambda: (bpy.context.scene.frame_set(9), bpy.ops.rototoon.new_key()),
        bpy.ops.rototoon.track,
        lambda: (bpy.context.scene.frame_set(4), shots.move(addon, ob, 4, 2, (5.0, -3.0), which=[1])),
        bpy.ops.rototoon.track,
        bpy.ops.rototoon.snap,
    ):
        change()
        stand.forget(ob)
        done.append((sum(ticks(addon, ob)), getattr(start.next_of(start.steps_of(ob)), "operator", None)))
    names = ["draw_contours", "new_key", "track", "weakest_frame", "track", "snap", None]
    assert done == list(zip([1, 2, 2, 4, 4, 5, 6], [name and f"rototoon.{name}" for name in names]))
    said = layouts.labels(layouts.draw(bpy.types.ROTOTOON_PT_start))
    assert "All steps are done" in said


@pytest.mark.parametrize("name", [name for name, work in press_scenes.STEPS.items() if work])
def test_the_scenes_of_the_press_come_to_their_step(addon, library, tmp_path, name):
    ob, start = shots.set_up(tmp_path), addon("ui.start")
    for work in press_scenes.STEPS[name]:
        work(addon, ob)
    addon("capture.stand").read(ob)
    step = start.next_of(start.steps_of(ob))
    assert step.operator == f"rototoon.{name}", step.hint


def test_panels_say_what_waits(addon, fake, tmp_path):
    ob = shots.set_up(tmp_path)
    text, stand = addon("ui.panels").said_of_contours, addon("capture.stand")
    assert "Nothing is drawn" in text(ob.rototoon, stand.read(ob))
    for frame in (1, 9):
        shots.draw(addon, ob, frame, [shots.diamond(frame - 1)])
    assert "2 new contours on 2 frames" in text(ob.rototoon, stand.read(ob))
    bpy.ops.rototoon.match_contours()
    assert text(ob.rototoon, stand.read(ob)) == ""


def test_contours_become_parts_while_drawing(addon, fake, tmp_path):
    ob = shots.set_up(tmp_path)
    arrivals, stand = addon("capture.arrivals"), addon("capture.stand")
    shape = np.concatenate([shots.square(0), shots.square(0)[:1] + 1.0])
    shots.draw(addon, ob, 1, [shape], cyclic=False)
    assert arrivals.look(ob) and [part.name for part in ob.rototoon.parts] == ["Part 1"]
    drawing = shots.layer_of(ob).frames[0].drawing
    # Its ends nearly meet.
    assert ob.rototoon.parts[0].closed and drawing.strokes[0].cyclic
    shots.draw(addon, ob, 1, [shots.diamond(0)])
    assert arrivals.look(ob) and len(ob.rototoon.parts) == 2
    assert not arrivals.look(ob)
    # On another frame the first stroke alone could be either part.
    shots.draw(addon, ob, 9, [shots.diamond(8)])
    assert not arrivals.look(ob) and stand.read(ob).loose == {9: 1}
    shots.draw(addon, ob, 9, [shots.square(8)])
    assert arrivals.look(ob) and not stand.read(ob).loose
    assert len(ob.rototoon.parts) == 2


def test_locked_layers_are_not_marked(addon, fake, tmp_path):
    ob = shots.set_up(tmp_path)
    shots.draw(addon, ob, 1, [shots.square(0)])
    shots.layer_of(ob).lock = True
    before = shots.snapshot(ob)
    assert not addon("capture.arrivals").look(ob) and shots.snapshot(ob) == before


def test_buttons_without_anything_to_act_on_say_why(addon, fake, tmp_path):
    ob = shots.set_up(tmp_path)
    with pytest.raises(RuntimeError, match='Draw contours on the layer "Contours"'):
        bpy.ops.rototoon.track()
    shots.draw(addon, ob, 1, [shots.square(0)])
    for name in ("weakest_frame", "show_confidence", "release_pins"):
        with pytest.raises(RuntimeError, match="press Track first"):
            getattr(bpy.ops.rototoon, name)()
    with pytest.raises(RuntimeError, match="press Track first"):
        bpy.ops.rototoon.clear_generated()


def test_track_tells_where_to_look(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    tracking = addon("capture.tracking")
    bpy.ops.rototoon.track()
    entry = addon("capture.sessions").known(ob)
    sure = entry.session.confidence
    entry.session.confidence = lambda name: np.where(np.arange(9)[:, None] == 4, 0.1, sure(name))
    summary = SimpleNamespace(ends=[], solved=2, footage_changed=False)
    run = SimpleNamespace(entry=entry, inputs=entry.inputs, moved={}, worker=SimpleNamespace(result=summary))
    assert tracking.told(run, 14) == "14 contours drawn on 7 frames"
    changed = SimpleNamespace(ends=[], solved=0, footage_changed=True)
    again = SimpleNamespace(entry=entry, inputs=entry.inputs, moved={}, worker=SimpleNamespace(result=changed))
    assert tracking.told(again, 14) == "14 contours drawn on 7 frames; the pictures have changed and were read again"
    assert tracking.where_to_look(ob, run) == '"Part 1" is most likely off on 5; "Part 2" is most likely off on 5'
    assert addon("common.wording").listed([3, 4, 5, 9, 12, 13]) == "3 to 5, 9 and 12 and 13"


def test_writing_goes_in_steps(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    document, tracking = addon("capture.document"), addon("capture.tracking")
    run = tracking.begin(ob, document.read(ob), "rototoon")
    run.worker.start()
    run.worker.join()
    shares = list(tracking.finishing(ob, run))
    assert len(shares) > 9 and shares[-1] == 1.0 and shares == sorted(shares)


def test_a_chain_of_work(addon):
    jobs = addon("common.jobs")
    chain = jobs.Chain(jobs.Worker(lambda _: 1), lambda: jobs.Worker(lambda progress: progress(0.5, "second") and 2))
    chain.start()
    while not chain.advance():
        chain.wait()
    assert (chain.result, chain.error, chain.step) == (2, None, "second")

    def fails():
        raise ValueError("no second")

    chain = jobs.Chain(jobs.Worker(lambda _: 1), fails)
    chain.start()
    while not chain.advance():
        chain.wait()
    assert str(chain.error) == "no second" and chain.result is None


def test_the_sample_has_one_mistake_to_correct(addon, library):
    assert bpy.ops.rototoon.open_sample() == {"FINISHED"}
    ob, cartoon, penguin = bpy.context.object, addon("sample.cartoon"), addon("sample.penguin")
    assert [part.name for part in ob.rototoon.parts] == list(penguin.PARTS)
    bpy.ops.rototoon.track()

    def off(name, frame):
        number = penguin.PARTS.index(name) + 1
        truth = penguin.outlines((frame - cartoon.FIRST) // penguin.HOLD)[name]
        return np.linalg.norm(dict(shots.pixels(addon, ob, frame))[number] - truth, axis=1).mean()

    frames = range(2, 24)
    wrong = [(name, frame) for name in penguin.PARTS for frame in frames if off(name, frame) > 20]
    assert wrong == [("near wing", 11), ("near wing", 12)]
    bpy.ops.rototoon.weakest_frame()
    assert bpy.context.scene.frame_current in {11, 12}
    # The artist moves the wing.
    frame = bpy.context.scene.frame_current
    strokes = dict(shots.pixels(addon, ob, frame))
    number = penguin.PARTS.index("near wing") + 1
    truth = penguin.outlines((frame - cartoon.FIRST) // penguin.HOLD)["near wing"]
    shots.move(addon, ob, frame, number, truth - strokes[number])
    bpy.ops.rototoon.track()
    assert max(off("near wing", frame) for frame in frames) < 5


def test_a_line_of_the_sample_that_is_moved_keeps_its_shape(addon, library):
    """With the tracker itself: by 7 pixels, as a newcomer did it, and farther than the part's size."""
    bpy.ops.rototoon.open_sample()
    ob, penguin = bpy.context.object, addon("sample.penguin")
    bpy.ops.rototoon.track()
    for name, frame, shift in (("body", 8, (7.0, 0.0)), ("near wing", 12, (-40.0, 25.0))):
        number = penguin.PARTS.index(name) + 1
        beside = {at: dict(shots.pixels(addon, ob, at))[number] for at in (frame - 1, frame + 1)}
        shots.move(addon, ob, frame, number, shift)
        placed = dict(shots.pixels(addon, ob, frame))[number]
        bpy.ops.rototoon.track()
        assert np.array_equal(dict(shots.pixels(addon, ob, frame))[number], placed), name
        assert any(np.abs(dict(shots.pixels(addon, ob, at))[number] - was).max() > 0.01 for at, was in beside.items())


def test_the_sample_is_drawn_once(addon, tmp_path):
    cartoon = addon("sample.cartoon")
    assert not cartoon.write(tmp_path, lambda share, step: share < 0.1)
    assert len(list(tmp_path.glob("*.png"))) == 4
    assert cartoon.write(tmp_path, lambda share, step: True)
    times = [path.stat().st_mtime_ns for path in sorted(tmp_path.iterdir())]
    assert cartoon.write(tmp_path, lambda share, step: True)
    assert times == [path.stat().st_mtime_ns for path in sorted(tmp_path.iterdir())] and len(times) == 24


def drawn_menu(name):
    layout, menu = layouts.Layout(), getattr(bpy.types, name)
    menu.draw(SimpleNamespace(layout=layout, names=getattr(menu, "names", ())), bpy.context)
    return layout.said


def test_every_operator_is_in_a_menu(addon):
    """Search finds only what menus contain."""
    names = [f"ROTOTOON_MT_{name}" for name in ("main", "footage", "strokes", "tween", "lines", "paint", "style", "armature", "pie")]
    found = {entry[1] for name in names for entry in drawn_menu(name) if entry[0] == "operator"}
    known = {f"rototoon.{name}" for name in dir(bpy.ops.rototoon)}
    assert known - found == set() and {entry[1] for entry in drawn_menu("ROTOTOON_MT_main") if entry[0] == "menu"} <= set(names)


def test_every_panel_has_a_page(addon):
    panels = [addon(name) for name in ("ui.start", "ui.panels", "ui.bones")]
    pages = {cls.page for module in panels for cls in module.CLASSES} | {page for _, page in addon("ui.help").PAGES}
    for page in pages:
        path, _, anchor = page.partition("#")
        text = (ROOT / "docs/src" / path).with_suffix(".md").read_text(encoding="utf-8")
        headings = {line.lstrip("# ").strip().lower() for line in text.splitlines() if line.startswith("#")}
        assert not anchor or anchor in headings, page


def test_help_opens_shipped_pages_or_an_address(addon, tmp_path, monkeypatch):
    help_ = addon("ui.help")
    monkeypatch.setattr(help_, "SHIPPED", tmp_path)
    assert bpy.ops.rototoon.help() == {"CANCELLED"} and help_.address("artist/panels.html") == ""
    (tmp_path / "artist").mkdir()
    (tmp_path / "artist/panels.html").write_text("page")
    assert bpy.ops.rototoon.help(page="artist/panels.html#track") == {"FINISHED"}
    assert help_.address("artist/panels.html#track").endswith("/artist/panels.html#track")
    preferences = addon("blender.preferences").preferences()
    preferences.help_address = "https://example.org/book/"
    assert help_.address("artist/keys.html") == "https://example.org/book/artist/keys.html"
    preferences.help_address = ""


def test_dropped_footage_is_taken_at_once(addon, tmp_path):
    handler = bpy.types.ROTOTOON_FH_footage
    assert ".png" in handler.bl_file_extensions.split(";") and handler.bl_import_operator == "rototoon.setup"
    for name in ("setup", "import_document"):
        assert getattr(bpy.ops.rototoon, name).get_rna_type().properties["filepath"].is_skip_save


def test_a_copied_key_waits_until_it_is_fitted(addon, fake, tmp_path):
    ob = shots.set_up(tmp_path)
    start, stand = addon("ui.start"), addon("capture.stand")
    shots.draw(addon, ob, 1, [shots.square(0)])
    bpy.context.scene.frame_set(9)
    assert "ends on 9" in start.next_of(start.steps_of(ob)).hint
    bpy.ops.rototoon.new_key()
    stand.forget(ob)
    step = start.next_of(start.steps_of(ob))
    assert step.text == "Set a second key" and "Edit Mode" in step.hint
    shots.move(addon, ob, 9, 1, (64.0, 16.0))
    stand.forget(ob)
    assert start.next_of(start.steps_of(ob)).text == "Track"


def test_track_says_that_the_footage_goes_on(addon, fake, tmp_path):
    ob = shots.set_up(tmp_path)
    for frame in (1, 5):
        shots.draw(addon, ob, frame, [shots.square(frame - 1)])
    bpy.ops.rototoon.track()
    said = addon("common.reports").take()[-1].text
    assert said == "3 contours drawn on 3 frames; nothing after your last key on frame 5: the footage goes on to frame 9"


def test_steps_name_the_part_that_needs_a_key(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    addon("capture.ends").put(ob.rototoon.parts[1], [(4, "lost")])
    start = addon("ui.start")
    step = start.next_of(start.steps_of(ob))
    assert step.text == "Correct" and step.hint.startswith('"Part 2" needs a key on frame 4')


def test_steps_name_the_frames_with_lost_contours(addon, fake, library, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    start, stand, gp = addon("ui.start"), addon("capture.stand"), addon("blender.grease_pencil")
    assert stand.read(ob).lost == [], "half sure is not lost"
    layer = gp.layers(ob, ob.rototoon.contours_layer)[0]
    made = [frame for frame, (_, kind) in gp.drawings(layer).items() if kind == gp.GENERATED]
    for count in (1, 2, 4):
        for frame in made[:count]:
            handle = gp.drawings(layer)[frame][0]
            strokes = gp.offsets(handle)
            sure = gp.value(handle, gp.CONFIDENCE, int(strokes[-1]))
            sure[strokes[-2] :] = 0.2
            gp.put(handle, gp.CONFIDENCE, sure)
        found = stand.read(ob)
        assert found.lost == made[:count]
        step = start.next_of(start.steps_of(ob))
        assert (step.text, step.operator) == ("Correct", "rototoon.weakest_frame")
        assert f"lost on {start.frames(made[:count])}." in step.hint
    assert start.frames(made[:1]) == f"frame {made[0]}"
    assert start.frames(made[:2]) == f"frames {made[0]} and {made[1]}"
    assert start.frames(made[:4]) == f"4 frames, first on {made[0]}"


@pytest.mark.parametrize(
    ("path", "name"),
    [
        ("/films/penguin/frames/frame_%03d.png", "penguin"),
        ("/films/penguin/image%d.png", "penguin"),
        ("/films/frames/walk_%04d.png", "walk"),
        ("/frames/%d.png", "Contours"),
    ],
)
def test_objects_are_called_as_the_footage(addon, path, name):
    shot = SimpleNamespace(movie="", pattern=path)
    assert addon("capture.operators.setup")._name(shot) == name


def test_a_dialog_that_is_closed_ends_quietly(addon):
    """Blender calls `cancel` when a dialog or the file browser of an operator is closed, before there is any work."""
    long = addon("common.operators").Long
    assert long.cancel(SimpleNamespace(_work=None), bpy.context) is None
