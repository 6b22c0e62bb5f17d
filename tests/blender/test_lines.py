"""Trace Drawing, Carry Strokes and Clear Lines on a small line film, with the real library."""

import bpy
import line_shots as ls
import numpy as np
import pytest
from line_stage import film, pictures, traced  # noqa: F401 - fixtures
from line_stage import attribute, away, handle_of, kinds, number_of, rendered, said
from mathutils import Matrix
from shots import write_png


def test_the_film_becomes_strokes_with_the_same_numbers_on_every_frame(addon, traced):
    assert kinds(addon, traced, "Lines") == dict.fromkeys(range(1, 7), "GENERATED")
    first = ls.strokes(addon, traced, "Lines", 1)
    assert sorted(first) == [1, 2, 3, 4, 5, 6]
    truth = {number: min(range(6), key=lambda k: away(points, ls.lines(0)[k][0])) for number, points in first.items()}
    assert sorted(truth.values()) == list(range(6))
    for frame in range(1, 7):
        now = ls.strokes(addon, traced, "Lines", frame)
        assert list(now) == sorted(first), "the index of a stroke is the same too"
        for number, points in now.items():
            # The arm ends beside the body's line, and is traced to the middle of it.
            assert away(points, ls.lines(frame - 1)[truth[number]][0]) < 3.5


def test_radius_and_material_follow_the_ink(addon, traced):
    placement, gp = addon("blender.placement"), addon("blender.grease_pencil")
    mapping = placement.Mapper(traced, [1], {}, ["Lines"]).at(0, 1)
    pixel = np.linalg.norm(np.diff(mapping.to_layer(np.array([[0.0, 0.0], [1.0, 0.0]])), axis=0))
    starts = np.cumsum([0] + [len(points) for points in ls.strokes(addon, traced, "Lines", 1).values()])
    radii = attribute(addon, traced, "Lines", 1, "radius") / pixel
    found = {number: np.median(radii[a:b]) for number, a, b in zip(ls.strokes(addon, traced, "Lines", 1), starts, starts[1:])}
    for number, points in ls.strokes(addon, traced, "Lines", 1).items():
        line = min(ls.lines(0), key=lambda line: away(points, line[0]))
        assert 2 * found[number] == pytest.approx(line[1], abs=0.8)
    assert (attribute(addon, traced, "Lines", 1, "opacity") == 1).all()
    used = attribute(addon, traced, "Lines", 1, "material_index")
    assert len(set(used.tolist())) == 2
    red = [number for number, index in zip(found, used) if traced.data.materials[int(index)].grease_pencil.color[0] > 0.2]
    assert len(red) == 1
    assert np.array_equal(used, attribute(addon, traced, "Lines", 5, "material_index"))
    assert gp.find_layer(traced, "Lines").use_lights is False


def test_lines_on_scaled_layers_and_objects_are_as_wide_as_the_ink(addon, film, tmp_path):
    import json

    layer, found = film.data.layers.new("Lines"), []
    for on_layer, on_object in ((1.0, 1.0), (2.0, 1.0), (1.0, 2.0)):
        layer.scale, film.scale = [on_layer] * 3, [on_object] * 3
        bpy.context.view_layer.update()
        bpy.ops.rototoon.trace_drawing(frames="CURRENT")
        bpy.ops.rototoon.export_document(filepath=str(tmp_path / "lines.json"))
        strokes = json.loads((tmp_path / "lines.json").read_text())["traced"][0]["strokes"]
        found.append((np.median(attribute(addon, film, "Lines", 1, "radius")), np.median(np.concatenate([stroke["widths"] for stroke in strokes]))))
    radii, widths = np.transpose(found)
    # Blender draws a radius at the object's scale.
    assert radii == pytest.approx(radii[0] * np.array([1.0, 1.0, 0.5]), rel=1e-3)
    assert widths == pytest.approx(widths[0], rel=1e-3)


def test_one_frame_and_a_range_join_what_is_there(addon, film):
    scene = bpy.context.scene
    scene.frame_set(2)
    bpy.ops.rototoon.trace_drawing(frames="CURRENT")
    assert list(kinds(addon, film, "Lines")) == [2]
    scene.use_preview_range, scene.frame_preview_start, scene.frame_preview_end = True, 4, 5
    bpy.ops.rototoon.trace_drawing(frames="RANGE")
    assert list(kinds(addon, film, "Lines")) == [2, 4, 5]
    assert list(ls.strokes(addon, film, "Lines", 2)) == list(ls.strokes(addon, film, "Lines", 5))


def test_the_artists_strokes_are_carried_and_kept(addon, film):
    body, *_, arm, _ = ls.lines(0)
    ls.put(addon, film, "Ink", 1, [(body[0][:-1], True), (arm[0], False)])
    gp = addon("blender.grease_pencil")
    strokes = addon("blender.strokes")
    before = strokes.read(gp.drawings(gp.find_layer(film, "Ink"))[1][0])
    assert bpy.ops.rototoon.carry_strokes() == {"FINISHED"}
    assert said(addon).text == "2 strokes on 5 frames"
    after = strokes.read(gp.drawings(gp.find_layer(film, "Ink"))[1][0])
    assert set(after.point) - set(before.point) <= {gp.TRACKED, gp.LINE, gp.ALONG} and set(after.curve) - set(before.curve) <= {gp.TRACK, gp.LOOK}
    after.point = {name: after.point[name] for name in before.point}
    after.curve = {name: after.curve[name] for name in before.curve}
    assert before.equals(after)
    assert kinds(addon, film, "Ink") == {1: "KEYFRAME", **dict.fromkeys(range(2, 7), "GENERATED")}
    for frame in range(2, 7):
        now = ls.strokes(addon, film, "Ink", frame)
        assert list(now) == [1, 2]
        assert away(now[1], ls.lines(frame - 1)[0][0]) < 3 and away(now[2], ls.lines(frame - 1)[4][0]) < 3
        assert attribute(addon, film, "Ink", frame, "cyclic").tolist() == [True, False]
        assert np.allclose(attribute(addon, film, "Ink", frame, "opacity"), 0.8)
        radii = attribute(addon, film, "Ink", frame, "radius")[len(now[1]) :]
        assert radii[0] == pytest.approx(0.015, abs=1e-3) and radii[-1] == pytest.approx(0.045, abs=1e-3)


def test_two_drawings_bind_both_sides_and_new_lines_are_asked_for(addon, film):
    for frame in (1, 6):
        ls.put(addon, film, "Ink", frame, [(ls.lines(frame - 1)[4][0], False)], opacity=0.2 if frame == 1 else 0.7)
    bpy.ops.rototoon.carry_strokes()
    assert list(ls.strokes(addon, film, "Ink", 6)) == list(ls.strokes(addon, film, "Ink", 1)) == [1]
    assert np.allclose(attribute(addon, film, "Ink", 3, "opacity"), 0.4, atol=1e-3)
    bpy.ops.rototoon.carry_strokes(new_lines=True)
    assert len(ls.strokes(addon, film, "Ink", 3)) == 6
    assert list(ls.strokes(addon, film, "Ink", 6)) == [1]


def test_a_changed_traced_drawing_is_the_artists(addon, traced, fake):
    gp = addon("blender.grease_pencil")
    handle = gp.drawings(gp.find_layer(traced, "Lines"))[3][0]
    total = int(gp.offsets(handle)[-1])
    points = gp.positions(handle, total)
    points[:20, 2] += 0.01
    gp.put(handle, "position", points)
    before = ls.strokes(addon, traced, "Lines", 3)
    assert bpy.ops.rototoon.carry_strokes() == {"FINISHED"}
    # The stand-in's picture shows other lines.
    assert said(addon).text.startswith("6 strokes on 5 frames, 1 drawing that you had changed is a key now; your drawing on frame 3 ")
    assert kinds(addon, traced, "Lines")[3] == "KEYFRAME"
    after = ls.strokes(addon, traced, "Lines", 3)
    assert list(after) == list(before) == list(ls.strokes(addon, traced, "Lines", 6))
    assert all(np.array_equal(after[number], before[number]) for number in before)


def test_an_edited_look_on_a_later_frame_leaves_the_first_frame(addon, traced):
    before = ls.strokes(addon, traced, "Lines", 1)
    drawing = next(frame.drawing for frame in traced.data.layers["Lines"].frames if frame.frame_number == 4)
    for point in drawing.strokes[2].points:
        point.opacity = 0.5
    number = list(ls.strokes(addon, traced, "Lines", 4))[2]
    assert bpy.ops.rototoon.trace_drawing() == {"FINISHED"}
    after = ls.strokes(addon, traced, "Lines", 1)
    assert after.keys() == before.keys()
    assert all(np.allclose(after[number], points, atol=1e-3) for number, points in before.items())
    kept = next(frame.drawing for frame in traced.data.layers["Lines"].frames if frame.frame_number == 4)
    assert np.allclose([point.opacity for point in kept.strokes[2].points], 0.5)
    assert list(ls.strokes(addon, traced, "Lines", 4))[2] == number


def test_a_coloured_pencil_is_left_out(addon, film):
    film.rototoon.line_leave_out, film.rototoon.line_left_out = True, (0.9, 0.3, 0.25)
    assert bpy.ops.rototoon.trace_drawing() == {"FINISHED"}
    found = ls.strokes(addon, film, "Lines", 1).values()
    assert sorted(min(range(6), key=lambda k: away(points, ls.lines(0)[k][0])) for points in found) == [0, 1, 2, 3, 4], "all but the red one"


def test_a_pencil_that_only_bounds_paint_is_left_out_of_lines(addon, film):
    film.rototoon.line_paint_only, film.rototoon.line_border = True, (0.9, 0.3, 0.25)
    assert bpy.ops.rototoon.trace_drawing() == {"FINISHED"}
    found = ls.strokes(addon, film, "Lines", 1).values()
    assert sorted(min(range(6), key=lambda k: away(points, ls.lines(0)[k][0])) for points in found) == [0, 1, 2, 3, 4], "all but the red one"


@pytest.mark.parametrize("construction", [False, True])
def test_paint_sees_the_pencil_that_only_bounds_it(addon, film, fake, monkeypatch, construction):
    settings, asked = film.rototoon, []
    settings.line_paint_only, settings.line_border, settings.line_leave_out = True, (1.0, 0.2, 0.2), construction
    for kind, name in ((fake.Painter, "fill"), (fake.Tracer, "trace")):
        call = getattr(kind, name)
        monkeypatch.setattr(kind, name, lambda *args, _call=call, **more: asked.append(more["leave_out"]) or _call(*args, **more))
    bpy.ops.rototoon.trace_drawing()
    ls.put(addon, film, "Paint", 1, [(ls.lines(0)[0][0][:-1], True)], material=addon("blender.fill_materials").material(film, np.array([0.2, 0.4, 0.9])))
    addon("blender.grease_pencil").put(handle_of(addon, film, "Paint", 1), "fill_id", np.array([1]))
    bpy.ops.rototoon.fill_drawings()
    blue, red = ((round(255 * value) / 255 for value in colour) for colour in (settings.line_left_out, settings.line_border))
    both = [tuple(blue)] if construction else []
    assert asked == [(*both, tuple(red)), tuple(both)]


def test_a_deleted_stroke_stays_deleted_on_its_frame(addon, traced, fake):
    gp = addon("blender.grease_pencil")
    gp.remove_strokes(gp.drawings(gp.find_layer(traced, "Lines"))[4][0], [2])
    bpy.ops.rototoon.trace_drawing()
    assert len(ls.strokes(addon, traced, "Lines", 4)) == 5


def test_clear_leaves_the_artists_drawings(addon, film, fake):
    ls.put(addon, film, "Ink", 1, [(ls.lines(0)[4][0], False)])
    bpy.ops.rototoon.carry_strokes()
    bpy.ops.rototoon.trace_drawing()
    gp = addon("blender.grease_pencil")
    gp.remove_strokes(gp.drawings(gp.find_layer(film, "Lines"))[4][0], [1])
    bpy.ops.rototoon.clear_lines()
    assert said(addon).text == "10 traced drawings removed, the traced drawing that you had changed on frame 4 stays, as a key"
    assert list(kinds(addon, film, "Ink")) == [1] and list(kinds(addon, film, "Lines")) == [4]
    assert kinds(addon, film, "Lines") == {4: "KEYFRAME"} and len(ls.strokes(addon, film, "Lines", 4)) == 1
    assert not bpy.ops.rototoon.clear_lines.poll()


def test_a_second_run_changes_nothing(addon, film, fake):
    import studio

    bpy.ops.rototoon.trace_drawing()
    before = studio.digests(addon, film)
    bpy.ops.rototoon.trace_drawing()
    assert studio.digests(addon, film) == before and len(film.data.materials) == 2


def test_held_pictures_become_held_drawings(addon, film, fake, pictures, tmp_path):
    import shutil

    for number, source in enumerate((1, 1, 2, 3, 3, 3), 1):
        shutil.copy(pictures.with_name(f"line_{source:03}.png"), tmp_path / f"line_{number:03}.png")
    film.rototoon.pattern = str(tmp_path / "line_%03d.png")
    bpy.ops.rototoon.trace_drawing(hold=False)
    assert list(kinds(addon, film, "Lines")) == [1, 2, 3, 4, 5, 6]
    bpy.ops.rototoon.trace_drawing()
    assert list(kinds(addon, film, "Lines")) == [1, 3, 4] and said(addon).text == "2 strokes on 3 frames"
    ls.put(addon, film, "Ink", 4, [(ls.lines(0)[4][0], False)])
    bpy.ops.rototoon.carry_strokes()
    assert list(kinds(addon, film, "Ink")) == [1, 3, 4]


def test_a_drawing_that_was_scanned_twice_is_held(addon, film, tmp_path):
    grain = np.random.default_rng(1)
    for number in range(1, 7):
        scan = ls.picture((number - 1) // 2) + grain.normal(0, 2, (*ls.picture(0).shape[:2], 1))
        write_png(tmp_path / f"line_{number:03}.png", scan.clip(0, 255).round().astype(np.uint8))
    film.rototoon.pattern = str(tmp_path / "line_%03d.png")
    bpy.ops.rototoon.trace_drawing(hold=False)
    drawn = [ls.strokes(addon, film, "Lines", frame) for frame in range(1, 7)]
    for once, again in zip(drawn[::2], drawn[1::2], strict=True):
        assert list(once) == list(again) and all(np.array_equal(once[number], again[number]) for number in once)
    bpy.ops.rototoon.trace_drawing()
    assert list(kinds(addon, film, "Lines")) == [1, 3, 5]


def test_frames_without_lines_are_said(addon, film, pictures, tmp_path):  # noqa: F811
    blank = np.full_like(ls.picture(0), 250)
    for number in range(1, 7):
        write_png(tmp_path / f"line_{number:03}.png", blank if number in (3, 5) else ls.picture(number - 1))
    film.rototoon.pattern = str(tmp_path / "line_%03d.png")
    bpy.ops.rototoon.trace_drawing()
    told = "no line or hardly any was found on frames 3 and 5; a higher Sensitivity finds fainter ink"
    assert told in said(addon).warnings
    assert addon("scripting").trace_drawing(film).bare == (3, 5)


def test_frames_on_which_strokes_are_lost_are_said(addon, film, fake, monkeypatch):
    tracer = fake.Tracer

    def lost(self, *args, **options):
        found = tracer_trace(self, *args, **options)
        # From the fourth drawing on the numbers are others.
        found.tracks[found.stroke_offsets[3] :] += 10
        return found

    tracer_trace = tracer.trace
    monkeypatch.setattr(tracer, "trace", lost)
    bpy.ops.rototoon.trace_drawing()
    assert said(addon).warnings == ("many strokes end or begin on 4: look there, and give a drawing of yours",)
    assert addon("scripting").trace_drawing(film).breaks == (4,)


def test_undo_takes_all_back(addon, film, fake):
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.rototoon.trace_drawing()
    bpy.ops.ed.undo_push(message="traced")
    assert bpy.context.object.data.layers.get("Lines") is not None
    bpy.ops.ed.undo()
    assert bpy.context.object.data.layers.get("Lines") is None


def test_cancelled_and_refused_work_changes_nothing(addon, film, monkeypatch):
    import studio

    before = studio.digests(addon, film), len(film.data.materials)
    jobs = addon("common.jobs")
    monkeypatch.setattr(jobs.Worker, "start", lambda self: (self.cancel(), self._thread.start()))
    assert bpy.ops.rototoon.trace_drawing() == {"CANCELLED"}
    assert said(addon).text == "Trace Drawing: stopped, nothing was changed"
    monkeypatch.undo()
    with pytest.raises(RuntimeError, match="no strokes to carry"):
        bpy.ops.rototoon.carry_strokes(layers="ALL") if film.data.layers.new("Ink").frames.new(1) else None
    film.data.layers.remove(film.data.layers["Ink"])
    film.rototoon.pattern = ""
    assert not bpy.ops.rototoon.trace_drawing.poll()
    assert (studio.digests(addon, film), len(film.data.materials)) == before


def test_blank_drawings_of_the_artist_stay_blank(addon, film, fake):
    ls.put(addon, film, "Ink", 1, [(ls.lines(0)[4][0], False)])
    film.data.layers["Ink"].frames.new(3)
    bpy.ops.rototoon.carry_strokes()
    assert kinds(addon, film, "Ink")[3] == "KEYFRAME" and not ls.strokes(addon, film, "Ink", 3)
    assert ls.strokes(addon, film, "Ink", 4)


def reference(path):
    """An empty that shows a picture, selected with the object, turned and moved."""
    ob, image = bpy.context.object, bpy.data.images.load(str(path))
    empty = bpy.data.objects.new("scan", None)
    empty.empty_display_type, empty.data, empty.empty_display_size = "IMAGE", image, 4.0
    empty.matrix_world = Matrix.Translation((3, 2, 1)) @ Matrix.Rotation(1.0, 4, "Z") @ Matrix.Rotation(np.pi / 2, 4, "X")
    bpy.context.scene.collection.objects.link(empty)
    bpy.context.view_layer.update()
    empty.select_set(True)
    return ob, empty


@pytest.mark.parametrize("packed", [False, True])
def test_a_reference_image_is_traced_where_it_is(addon, film, pictures, packed):
    ob, empty = reference(pictures)
    ob.rototoon.pattern = ""
    if packed:
        empty.data.pack()
    bpy.context.scene.frame_set(5)
    assert bpy.ops.rototoon.trace_image() == {"FINISHED"}
    assert said(addon).text == "6 strokes on 1 frame"
    cameras, gp = addon("blender.camera"), addon("blender.grease_pencil")
    layer = gp.find_layer(ob, "Lines")
    handle = gp.drawings(layer)[5][0]
    points = gp.positions(handle, int(gp.offsets(handle)[-1]))
    matrix = cameras.layer_to_world(ob, layer)
    world = points @ matrix[:3, :3].T + matrix[:3, 3]
    local = np.linalg.inv(np.array(empty.matrix_world)) @ np.c_[world, np.ones(len(world))].T
    assert np.allclose(local[2], 1e-3, atol=1e-4), "the strokes lie on the image"
    pixels = cameras.Mapping(cameras.reference_view(empty, *ls.SIZE), matrix).to_pixels(points)
    every = np.concatenate([line for line, _, _ in ls.lines(0)])
    assert away(pixels, every) < 3
    gp.set_keyframe_type(layer, {5: gp.KEYFRAME})
    with pytest.raises(RuntimeError, match="a drawing of yours on frame 5"):
        bpy.ops.rototoon.trace_image()
    empty.select_set(False)
    assert not bpy.ops.rototoon.trace_image.poll()


def test_traced_strokes_go_into_a_document_and_come_back(addon, traced, tmp_path):
    import json

    bpy.ops.rototoon.make_part(numbers=str(number_of(addon, traced, 0)))
    path = tmp_path / "lines.json"
    bpy.ops.rototoon.export_document(filepath=str(path))
    document = json.loads(path.read_text())
    assert [each["frame"] for each in document["traced"]] == [1, 2, 3, 4, 5, 6]
    assert [stroke["track"] for stroke in document["traced"][3]["strokes"]] == [0, 1, 2, 3, 4, 5]
    before = {frame: ls.strokes(addon, traced, "Lines", frame) for frame in range(1, 7)}
    radii = attribute(addon, traced, "Lines", 2, "radius")
    bpy.ops.rototoon.import_document(filepath=str(path))
    assert said(addon).text == '1 part and 6 traced strokes from lines.json, in the new object "lines"'
    ob = bpy.context.object
    assert ob != traced and kinds(addon, ob, "Lines") == dict.fromkeys(range(1, 7), "GENERATED")
    for frame in range(1, 7):
        now = ls.strokes(addon, ob, "Lines", frame)
        assert list(now) == list(before[frame]) and all(np.allclose(now[n], before[frame][n], atol=1e-3) for n in now)
    assert np.allclose(attribute(addon, ob, "Lines", 2, "radius"), radii, atol=1e-4)
    gp = addon("blender.grease_pencil")
    gp.find_layer(ob, "Lines").lock = True
    with pytest.raises(RuntimeError, match='the layer "Lines" is locked'):
        bpy.ops.rototoon.import_document(filepath=str(path), into="ACTIVE")
    document["traced"][2]["strokes"][1]["widths"] = [1]
    path.write_text(json.dumps(document))
    with pytest.raises(RuntimeError, match=r"traced\[2\].strokes\[1\].widths: found \[1\], expected one number for each of the \d+ points"):
        bpy.ops.rototoon.import_document(filepath=str(path))


# -- scripts ---------------------------------------------------------------------------------------------------------------


def test_scripts_trace_carry_and_read(addon, film):
    scripting = addon("scripting")
    shares = []
    done = scripting.trace_drawing(film, (1, 3), progress=lambda share, step: shares.append(share))
    assert (done.strokes, done.frames, done.kept) == (6, (1, 2, 3), 0) and shares[-1] == 1.0
    found = scripting.lines(film)
    assert sorted(found) == [1, 2, 3] and [line.number for line in found[2]] == [1, 2, 3, 4, 5, 6] and found[2][0].traced
    ls.put(addon, film, "Ink", 1, [(ls.lines(0)[4][0], False)])
    assert scripting.carry_strokes(film, ["Ink"], (1, 2)).frames == (2,)
    assert not scripting.lines(film, "Ink")[1][0].traced
    for call, text in [
        (lambda: scripting.carry_strokes(film, ["No"]), 'no layer "No"'),
        (lambda: scripting.carry_strokes(film, ["Contours"]), "has contours"),
        (lambda: scripting.trace_drawing(film, (90, 95)), "the footage is on frames 1 to 6"),
        (lambda: scripting.trace_drawing(film, style="neat"), "unknown variant"),
        (lambda: scripting.trace_drawing(film, progress=lambda share, step: False), "cancelled"),
    ]:
        with pytest.raises(RuntimeError, match=text):
            call()


# -- the line version of the sample ----------------------------------------------------------------------------------------


def test_the_sample_is_traced_carried_edited_and_rendered(addon, library, tmp_path):
    assert bpy.ops.rototoon.open_sample(version="LINES") == {"FINISHED"}
    ob, scripting, penguin = bpy.context.object, addon("scripting"), addon("sample.penguin")
    assert not ob.rototoon.parts
    traced = scripting.trace_drawing(ob, (2, 3))
    assert traced.frames == (2, 3) and 7 <= traced.strokes <= 12
    belly = [penguin.outlines(drawing)["body"].mean(0) + (12, 12) for drawing in (0, 1)]
    turn = np.linspace(-np.pi, np.pi, 160)
    oval = np.stack([34 * np.cos(turn), 50 * np.sin(turn)], 1)
    found = scripting.lines(ob)
    numbers = [{line.number for line in found[2 + k] if lies_on(line.pixels, belly[k] + oval)} for k in (0, 1)]
    assert numbers[0] & numbers[1], "the belly is the same stroke on both drawings"
    # The wing hides the left side.
    arc = oval[np.abs(turn) < 1.3]
    ls.put(addon, ob, "Ink", 2, [(belly[0] + arc, False)])
    assert scripting.carry_strokes(ob, ["Ink"], (2, 3)).frames == (3,)
    carried = scripting.lines(ob, "Ink")[3][0]
    assert away(carried.pixels, belly[1] + oval) < 4
    # The artist makes the belly rounder on one frame.
    gp, mapping = addon("blender.grease_pencil"), addon("blender.placement").Mapper(ob, [2], {}, ["Ink"]).at(0, 2)
    handle = handle_of(addon, ob, "Ink", 2)
    gp.put(handle, "position", mapping.to_layer(belly[0] + arc * (1.5, 1)).astype(np.float32))
    bpy.context.scene.frame_set(2)
    assert bpy.ops.rototoon.spread_edits() == {"FINISHED"}
    edited = scripting.lines(ob, "Ink")[3][0].pixels
    assert edited[:, 0].max() - belly[1][0] == pytest.approx(51, abs=4)
    assert is_seen(addon, ob, 3, tmp_path)


def lies_on(points, line):
    """Whether a good half of a line's points are near another line."""
    return np.mean([np.linalg.norm(line - point, axis=1).min() < 3 for point in points]) > 0.5


def is_seen(addon, ob, frame, folder):
    """Renders a frame, and tells whether its strokes are seen where they are, and nothing else is."""
    seen = rendered(ob, frame, folder)[..., 3] > 0.5
    height, width = seen.shape
    scripting = addon("scripting")
    wanted = np.zeros_like(seen)
    for layer in ("Lines", "Ink"):
        for line in scripting.lines(ob, layer)[frame]:
            x, y = np.floor(line.pixels).astype(int).T
            assert seen[y.clip(0, height - 1), x.clip(0, width - 1)].mean() > 0.9
            for dx in range(-6, 7):
                for dy in range(-6, 7):
                    wanted[(y + dy).clip(0, height - 1), (x + dx).clip(0, width - 1)] = True
    return seen.any() and not (seen & ~wanted).any()


def test_strokes_of_an_object_without_materials_keep_their_look(addon, film):
    layer = film.data.layers.new("Rough")
    layer.frames.new(1).drawing.add_strokes([2])
    film.data.materials.clear()
    bpy.ops.rototoon.trace_drawing(frames="CURRENT")
    rough = attribute(addon, film, "Rough", 1, "material_index")
    assert [film.data.materials[i] for i in rough.tolist()] == [None]
    assert all(film.data.materials[i] is not None for i in attribute(addon, film, "Lines", 1, "material_index").tolist())
