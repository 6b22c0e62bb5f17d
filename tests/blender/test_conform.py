"""Conform to New Footage: a small drawn film that is delivered again, and what becomes of the work on it."""

import json

import bpy
import numpy as np
import pytest
import shots
from test_paint_recolours import wet

AGAIN, LOST = 3, 6
"""Steps of the film whose drawing was drawn again, or is gone."""
STEPS = (-2, -1, 0, 1, 2, AGAIN, 4, 5, 7, 8)
FIRST = 1001
MASK = ("studio_mask", "FLOAT", "POINT")
LEFT_OVER = "Left over: Contours"
GIVEN = {"scale": float(shots.SCALE), "find_shift": False, "shift": (shots.BORDER, shots.BORDER)}
"""The place of the old picture in the new one. To find it takes a second or two, so only tests of that do."""


@pytest.fixture(scope="module")
def delivered(tmp_path_factory):
    """The new footage: two handles, one drawing drawn again, one left out. A picture of it."""
    folder = tmp_path_factory.mktemp("again")
    for number, step in enumerate(STEPS, FIRST):
        (folder / f"new_{number}.png").write_bytes(shots.drawn_again(step, redrawn=step == AGAIN))
    return str(folder / f"new_{FIRST + 4}.png")


@pytest.fixture
def film(addon, library, fake, tmp_path):
    """The object with keys on the frames 1, 4, 7 and 9, tracked."""
    ob = shots.set_up(tmp_path)
    for frame in (1, 4, 7, 9):
        shots.draw(addon, ob, frame, [shots.diamond(frame - 1), shots.square(frame - 1)])
    bpy.ops.rototoon.match_contours()
    bpy.ops.rototoon.track()
    assert len(frames(addon, ob)) == 9
    return ob


def frames(addon, ob, layer="Contours"):
    """Keyframe types by frame."""
    return {frame: kind for frame, (_, kind) in addon("blender.grease_pencil").drawings(ob.data.layers[layer]).items()}


def said(addon):
    return addon("common.reports").take()[-1]


def pixels(addon, ob, layer="Contours"):
    """By frame the pixels of all points, and by frame those of each part."""
    gp, placement = addon("blender.grease_pencil"), addon("blender.placement")
    drawings = gp.drawings(ob.data.layers[layer])
    mapper, found = placement.Mapper(ob, drawings, {}, [layer]), {}
    for frame, (handle, _) in drawings.items():
        starts = gp.offsets(handle)
        numbers = gp.value(handle, gp.PART, len(starts) - 1)
        points = mapper.at(0, frame).to_pixels(gp.positions(handle, int(starts[-1])))
        found[frame] = {int(n): points[a:b] for n, a, b in zip(numbers, starts, starts[1:])}
    return found


def away(found, expected):
    """The greatest distance between points."""
    assert found.keys() == expected.keys()
    return max(np.abs(found[part] - shots.placed(expected[part])).max() for part in expected)


def everything(ob):
    """All of an object's strokes and settings, and what shows its footage."""
    settings = ob.rototoon
    names = ("pattern", "first", "last", "width", "height", "fps", "frame_offset", "extra")
    entry = settings.camera.data.background_images[0]
    shown = entry.image.filepath, entry.image_user.frame_start, entry.image_user.frame_offset, entry.image_user.frame_duration
    records = {name: ob.data[name] for name in ob.data.keys() if name.startswith("rototoon_")}
    parts = [(part.name, part.extra, part.ends) for part in settings.parts]
    return shots.snapshot(ob), [getattr(settings, name) for name in names], shown, records, parts


def test_keys_and_results_lie_on_their_drawings(addon, film, delivered):
    before = pixels(addon, film)
    assert bpy.ops.rototoon.conform(filepath=delivered) == {"FINISHED"}
    settings = film.rototoon
    # Most drawings stay on their scene frames; the handles lie before them.
    assert (settings.first, settings.last, settings.frame_offset) == (1001, 1010, -1002)
    assert (settings.width, settings.height) == (352, 212)
    now = frames(addon, film)
    assert [frame for frame, kind in now.items() if kind == "KEYFRAME"] == [1, 4, 8]
    # The frame after the one that is gone moves up; on the one that was drawn again there is the key alone.
    assert list(now) == [1, 2, 3, 4, 5, 6, 7, 8]
    after = pixels(addon, film)
    for new, old in {1: 1, 2: 2, 3: 3, 4: 4, 5: 5, 6: 6, 7: 8, 8: 9}.items():
        assert away(after[new], before[old]) < 0.5
    entry = settings.camera.data.background_images[0]
    assert entry.image.filepath.endswith("new_1001.png") and (entry.image_user.frame_start, entry.image_user.frame_offset) == (-1, 1000)
    assert addon("blender.placement").background_of(settings.camera, film) is not None


def test_what_did_not_simply_go_along_is_named_and_kept(addon, film, delivered):
    before = pixels(addon, film)[7]
    bpy.ops.rototoon.conform(filepath=delivered)
    report = said(addon)
    assert report.kind == "WARNING"
    for text in (
        "scaled by 2 and moved by 16.00, 16.00 px", "drawn again: 4", "new: -1 and 0", "gone: 7",
        'parts "Part 1", "Part 2": the keys on 4: the drawing was drawn again', f'the keys on 7: left over, kept on 7 of the hidden layer "{LEFT_OVER}"',
        "the footage is on frames -1 to 8",
    ):  # fmt: skip
        assert text in report.text, (text, report.text)
    layer = film.data.layers[LEFT_OVER]
    assert layer.hide and list(frames(addon, film, LEFT_OVER)) == [7]
    assert away(pixels(addon, film, LEFT_OVER)[7], before) < 0.5
    # It is no contour any more.
    assert 7 not in [frame for frame, kind in frames(addon, film).items() if kind == "KEYFRAME"]


def test_strokes_stay_the_same_strokes(addon, film, delivered):
    gp = addon("blender.grease_pencil")
    handle = gp.drawings(shots.layer_of(film))[9][0]
    count = len(gp.positions(handle, int(gp.offsets(handle)[-1])))
    mask = np.linspace(0, 1, count, dtype=np.float32)
    handle.attributes.new(*MASK).data.foreach_set("value", mask)
    handle.attributes.new("studio_id", "INT", "CURVE").data.foreach_set("value", np.array([7, 9], np.int32))
    gp.put(handle, "radius", np.full(count, 0.04, np.float32))
    materials = gp.value(handle, "material_index", 2)
    bpy.ops.rototoon.conform(filepath=delivered, **GIVEN)
    handle = gp.drawings(shots.layer_of(film))[8][0]
    assert np.array_equal(gp.get(handle, MASK[0], count), mask)
    assert gp.get(handle, "studio_id", 2).tolist() == [7, 9]
    assert np.array_equal(gp.value(handle, "material_index", 2), materials)
    # The picture is 212 high where it was 90, with the drawing twice as large in it: the line is as thick beside the drawing as it was.
    assert np.allclose(gp.get(handle, "radius", count), 0.04 * 90 / 212 * shots.SCALE, rtol=1e-4)


def test_corrections_absences_and_further_fields_go_along(addon, film, delivered):
    shots.move(addon, film, 8, 2, (4.0, 3.0), which=[1])
    bpy.ops.rototoon.track()
    shots.move(addon, film, 4, 1, (1.0, 0.0), which=[0])
    shots.move(addon, film, 5, 1, (0.0, 5.0), which=[2])
    document = addon("capture.document")
    pins = {part["name"]: part.get("pins") for part in document.read(film).document["parts"]}
    part = film.rototoon.parts[0]
    part.extra = json.dumps({"absent": [[2, 2], [7, 7]], "note": "kept"})
    film.rototoon.extra = json.dumps({"depth_marks": [{"front": "Part 1", "behind": "Part 2", "first": 8, "last": 9}], "studio": 1})
    exchanged = addon("capture.exchanged")
    exchanged.put(film, [(1, 2, [2, 7]), (1, 2, [7])])
    bpy.ops.rototoon.conform(filepath=delivered, **GIVEN)
    assert json.loads(part.extra) == {"absent": [[1004, 1004]], "note": "kept"}
    assert exchanged.rows_of(film) == [(1, 2, [1004])], "the drawing of picture 7 is gone"
    extra = json.loads(film.rototoon.extra)
    assert extra["studio"] == 1 and extra["depth_marks"][0] == {"front": "Part 1", "behind": "Part 2", "first": 1009, "last": 1010}
    after = {part["name"]: part.get("pins") for part in document.read(film).document["parts"]}
    new = {"5": "1007", "8": "1009"}
    for name, own in pins.items():
        assert {new[frame] for frame in own} == after[name].keys()
        for frame, points in own.items():
            for point, place in points.items():
                assert np.allclose(after[name][new[frame]][point], shots.placed(place), atol=0.05)


def test_the_nearest_contour_becomes_the_key_where_an_end_is_gone(addon, film, tmp_path):
    folder = tmp_path / "short"
    folder.mkdir()
    for number, step in enumerate((1, 2, 3, 4, 5, 6, 7), 1):
        (folder / f"cut_{number}.png").write_bytes(shots.drawn(step))
    before = pixels(addon, film)
    bpy.ops.rototoon.conform(filepath=str(folder / "cut_1.png"))
    assert 'part "Part 1": the picture of its key on 1 is gone, and the contour tracked on 2 is its key now' in said(addon).text
    now = frames(addon, film)
    assert [frame for frame, kind in now.items() if kind == "KEYFRAME"] == [2, 4, 7, 8]
    after = pixels(addon, film)
    assert all(np.abs(after[frame][part] - before[frame][part]).max() < 0.01 for frame in range(2, 9) for part in (1, 2))
    assert [sorted(part.keys) for part in addon("capture.contours").read(film).parts] == [[2, 4, 7, 8]] * 2


def test_other_numbers_change_no_bit(addon, film, tmp_path):
    folder = tmp_path / "renamed"
    for step in range(shots.COUNT):
        folder.mkdir(exist_ok=True)
        (folder / f"n_{step + 501}.png").write_bytes(shots.drawn(step))
    state, _ = shots.snapshot(film)
    # The old pictures are gone.
    for path in (tmp_path / "frames").iterdir():
        path.unlink()
    with pytest.raises(RuntimeError, match="the footage was moved or renamed"):
        bpy.ops.rototoon.conform(filepath=str(folder / "n_505.png"))
    bpy.ops.rototoon.conform(filepath=str(folder / "n_505.png"), compare=False, frame_offset=500)
    assert (film.rototoon.first, film.rototoon.frame_offset) == (501, -500)
    assert shots.snapshot(film)[0] == state
    with pytest.raises(RuntimeError, match="frame offset 5000: none of the old frames, 501 to 509, is among the new ones"):
        bpy.ops.rototoon.conform(filepath=str(folder / "n_505.png"), compare=False, frame_offset=5000)


@pytest.mark.parametrize(("options", "first"), [({"timing": "SCENE"}, 1), ({"timing": "FRAME", "frame": 101}, 101)])
def test_the_first_picture_is_on_the_frame_that_the_artist_wants(addon, film, delivered, options, first):
    before = pixels(addon, film)
    bpy.ops.rototoon.conform(filepath=delivered, **GIVEN, **options)
    assert film.rototoon.frame_offset == first - 1001
    after = pixels(addon, film)
    assert [frame for frame, kind in frames(addon, film).items() if kind == "KEYFRAME"] == [first + 2, first + 5, first + 9]
    assert away(after[first + 9], before[9]) < 0.5
    assert list(frames(addon, film, LEFT_OVER)) == [first + 8]


def test_undo_restores_all(addon, film, delivered):
    before, name = everything(film), film.name
    bpy.ops.ed.undo_push(message="the film")
    bpy.ops.rototoon.conform(filepath=delivered, **GIVEN)
    bpy.ops.ed.undo_push(message="conform")
    assert everything(bpy.data.objects[name]) != before
    bpy.ops.ed.undo()
    ob = bpy.data.objects[name]
    assert everything(ob) == before and LEFT_OVER not in ob.data.layers


def test_cancel_changes_nothing(addon, film, delivered):
    before, steps = everything(film), []

    def stop(share, step):
        steps.append(step)
        return share < 0.2

    with pytest.raises(RuntimeError, match="cancelled"):
        addon("scripting").conform(film, delivered, progress=stop)
    assert everything(film) == before and steps


@pytest.mark.parametrize("group", [False, True])
def test_a_locked_layer_is_refused_at_once(addon, film, delivered, group):
    if group:
        holder = film.data.layer_groups.new("holder")
        film.data.layers.move_to_layer_group(shots.layer_of(film), holder)
        holder.lock = True
    else:
        shots.layer_of(film).lock = True
    before = everything(film)
    with pytest.raises(RuntimeError, match='the layer "Contours" is locked: unlock it first'):
        bpy.ops.rototoon.conform(filepath=delivered, **GIVEN)
    assert everything(film) == before


def test_layers_of_the_artist_alone_stay_and_are_named(addon, film, delivered):
    gp = addon("blender.grease_pencil")
    layer = film.data.layers.new("Mine")
    drawing = layer.frames.new(9).drawing
    drawing.add_strokes([2])
    gp.put(drawing, "position", np.array([[0, 0, 0], [1, 0, 1]], np.float32))
    state = shots.snapshot(film)[0]["Mine", 9]
    layer.lock = True
    bpy.ops.rototoon.conform(filepath=delivered, **GIVEN)
    assert shots.snapshot(film)[0]["Mine", 9] == state
    assert 'the layer "Mine" is yours alone and left as before, though the drawings beside it have moved' in said(addon).text


def test_points_off_the_plane_keep_their_distance(addon, film, delivered):
    gp = addon("blender.grease_pencil")
    handle = gp.drawings(shots.layer_of(film))[1][0]
    points = gp.positions(handle, int(gp.offsets(handle)[-1]))
    points[0, 1] = 0.25
    gp.put(handle, "position", points)
    before = pixels(addon, film)[1]
    bpy.ops.rototoon.conform(filepath=delivered, **GIVEN)
    handle = gp.drawings(shots.layer_of(film))[1][0]
    points = gp.positions(handle, int(gp.offsets(handle)[-1]))
    assert abs(points[0, 1]) > 0.2 and np.abs(points[1:, 1]).max() < 1e-5
    assert away(pixels(addon, film)[1], before) < 0.5


def test_through_a_moving_camera(addon, film, delivered):
    camera = film.rototoon.camera
    before = pixels(addon, film)
    camera.keyframe_insert("location", frame=1)
    camera.location.x += 0.7
    camera.keyframe_insert("location", frame=9)
    before = pixels(addon, film)
    bpy.ops.rototoon.conform(filepath=delivered, **GIVEN)
    after = pixels(addon, film)
    for new, old in {1: 1, 3: 3, 7: 8, 8: 9}.items():
        assert away(after[new], before[old]) < 0.5
    assert "what is animated keeps its frames" in said(addon).text


def test_a_script_gets_what_became_of_the_frames(addon, film, delivered):
    scripting = addon("scripting")
    pattern = delivered.replace("new_1005", "new_%d")
    moved = scripting.conform(film, pattern, begins=201)
    assert (moved.scale, moved.shift) == (2.0, (16.0, 16.0))
    assert moved.same == {203: 1, 204: 2, 205: 3, 207: 5, 208: 6, 209: 8, 210: 9}
    assert (moved.redrawn, moved.new, moved.gone) == ({206: 4}, (201, 202), (7,))
    assert any("drawn again" in text for text in moved.warnings)
    with pytest.raises(RuntimeError, match="no file has a name like"):
        scripting.conform(film, pattern.replace("new_", "none_"))


def test_lines_and_in_betweens_stay_what_they_are(addon, library, fake, tmp_path):
    import studio

    ob = studio.open_file(studio.build(addon, tmp_path))
    bpy.ops.rototoon.trace_drawing()
    bpy.ops.rototoon.in_between(frames="ALL")
    drawings, keys, records = addon("lines.drawings"), addon("tween.keys"), addon("tween.records")
    (before,) = drawings.read(ob, ["Lines"])
    assert before.made and not before.edited
    marks = addon("blender.marks")
    snapped = marks.untouched_frames(ob.data, "Snapped")
    between = keys.frames_of(ob.data.layers["Ink"], records.read(ob.data)["Ink"])
    assert between.made and snapped
    folder = tmp_path / "twice"
    folder.mkdir()
    for step in range(shots.COUNT):
        (folder / f"n_{step + 11}.png").write_bytes(shots.drawn_again(step))
    moved = addon("scripting").conform(ob, str(folder / "n_%d.png"), begins=11)
    assert len(moved.same) == shots.COUNT and moved.scale == shots.SCALE
    (after,) = drawings.read(ob, ["Lines"])
    assert [frame - 10 for frame in after.made] == list(before.made) and not after.edited
    assert {frame - 10 for frame in marks.untouched_frames(ob.data, "Snapped")} == snapped
    now = keys.frames_of(ob.data.layers["Ink"], records.read(ob.data)["Ink"])
    assert [frame - 10 for frame in now.made] == between.made and not now.edited
    assert bpy.ops.rototoon.track() == {"FINISHED"}
    assert "look like the keys again" not in said(addon).text



def test_results_end_where_another_drawing_follows(addon, film, delivered):
    """Traced lines on twos: the held frame alone is left of one drawing, and a result is not shown on over what was drawn again."""
    gp, holds, drawings = addon("blender.grease_pencil"), addon("blender.holds"), addon("lines.drawings")
    bpy.ops.rototoon.trace_drawing()
    layer = film.data.layers["Lines"]
    assert list(frames(addon, film, "Lines")) == list(range(1, 10))
    # The drawing of frame 7, whose picture is gone, is held on 8.
    gp.remove_frames(layer, [8])
    holds.note(film.data, "Lines", [8], ())
    bpy.ops.rototoon.conform(filepath=delivered, **GIVEN)
    now = {frame: len(gp.offsets(handle)) - 1 for frame, (handle, _) in gp.drawings(layer).items()}
    assert list(now) == list(range(1, 9)) and [frame for frame, count in now.items() if not count] == [4]
    assert 'layer "Lines": what was generated is left out on 4, since the drawing was drawn again' in said(addon).text
    (found,) = drawings.read(film, ["Lines"])
    assert list(found.made) == list(range(1, 9)) and not found.keys and not found.edited
    assert not holds.read(film.data, "Lines")
    bpy.ops.rototoon.trace_drawing()
    assert all(len(gp.offsets(handle)) > 1 for handle, _ in gp.drawings(layer).values())


def test_a_reference_image_shows_the_new_footage(addon, library, fake, delivered, tmp_path):
    ob = shots.set_up(tmp_path, plane="REFERENCE")
    shots.draw(addon, ob, 1, [shots.diamond(0), shots.square(0)])
    bpy.ops.rototoon.match_contours()
    before = pixels(addon, ob)[1]
    bpy.ops.rototoon.conform(filepath=delivered, **GIVEN)
    empty = ob.rototoon.reference
    assert empty.data.filepath.endswith("new_1001.png") and empty.image_user.frame_start == -1
    assert away(pixels(addon, ob)[1], before) < 0.5


@pytest.mark.parametrize("plane", ["CAMERA", "REFERENCE"])
def test_squeezed_footage_stays_squeezed(addon, library, fake, delivered, tmp_path, plane):
    ob = shots.set_up(tmp_path, plane=plane)
    shower = ob.rototoon.reference or ob.rototoon.camera.data.background_images[0]
    (shower.data if plane == "REFERENCE" else shower.image).display_aspect = (2, 1)
    bpy.context.scene.render.pixel_aspect_x = 2
    shots.draw(addon, ob, 1, [shots.diamond(0), shots.square(0)])
    bpy.ops.rototoon.match_contours()
    before = pixels(addon, ob)[1]
    bpy.ops.rototoon.conform(filepath=delivered, **GIVEN)
    image = shower.data if plane == "REFERENCE" else shower.image
    assert image.filepath.endswith("new_1001.png") and tuple(image.display_aspect) == (2, 1)
    assert away(pixels(addon, ob)[1], before) < 0.5


def test_a_movie_is_new_footage_too(addon, film, tmp_path):
    from test_footage import make_movie

    make_movie(tmp_path / "shot.mp4", sorted((tmp_path / "frames").iterdir())[1:])
    addon("blender.preferences").preferences().cache_folder = str(tmp_path / "cache")
    before = pixels(addon, film)
    assert bpy.ops.rototoon.conform(filepath=str(tmp_path / "shot.mp4")) == {"FINISHED"}
    addon("blender.preferences").preferences().cache_folder = ""
    settings = film.rototoon
    assert settings.movie.endswith("shot.mp4") and (settings.first, settings.last, settings.frame_offset) == (1, 8, 1)
    after = pixels(addon, film)
    assert [frame for frame, kind in frames(addon, film).items() if kind == "KEYFRAME"] == [2, 4, 7, 9]
    assert all(np.abs(after[frame][part] - before[frame][part]).max() < 0.5 for frame in range(2, 10) for part in (1, 2))


def test_another_object_with_the_footage_is_named(addon, film, delivered):
    other = film.copy()
    other.data, other.name = film.data.copy(), "other"
    bpy.context.scene.collection.objects.link(other)
    bpy.ops.rototoon.conform(filepath=delivered, **GIVEN)
    assert '"other" has the old footage still: conform it too' in said(addon).text
    before = pixels(addon, other)
    moved = addon("scripting").conform(other, delivered)
    assert moved.gone == (7,) and away(pixels(addon, other)[8], before[9]) < 0.5


def test_footage_with_nothing_in_common_is_refused(addon, film, tmp_path):
    folder = tmp_path / "other"
    folder.mkdir()
    for number in range(5):
        (folder / f"p_{number}.png").write_bytes(shots.png(np.full((90, 160, 3), 40 * number, np.uint8)))
    before = everything(film)
    with pytest.raises(RuntimeError, match="no frame of the new footage shows a drawing of the old one"):
        bpy.ops.rototoon.conform(filepath=str(folder / "p_1.png"))
    assert everything(film) == before


def test_paint_and_clicks_go_along(addon, film, delivered):
    gp, sheets = addon("blender.grease_pencil"), addon("paint.sheets")
    bpy.ops.rototoon.paint_bucket(place=(30.0, 35.0))
    bpy.ops.rototoon.fill_drawings()
    before = sheets.read(film, "Paint")
    bpy.ops.rototoon.conform(filepath=delivered, **GIVEN)
    after = sheets.read(film, "Paint")
    assert len(before) > 3
    clicks = [content[1].content.strokes(gp.CLICK)[0] for content in (min(before.items()), min(after.items()))]
    assert np.allclose(clicks[1][:2], shots.placed(clicks[0][:2])) and clicks[1][2] == 1
    # A region on a drawing that was drawn again is left out.
    assert list(after) == list(range(1, 9)) and not len(after[4].made)
    for new, old in {1: 1, 2: 2, 3: 3, 5: 5, 6: 6, 7: 8, 8: 9}.items():
        assert after[new].made.tolist() == before[old].made.tolist()


def test_colours_that_become_others_go_along(addon, film, delivered):
    bpy.ops.rototoon.paint_bucket(place=(30.0, 35.0))
    bpy.ops.rototoon.fill_drawings()
    old = film.data.materials[int(addon("paint.sheets").read(film, "Paint")[1].content.strokes("material_index")[0])]
    scripting = addon("scripting")
    for name, first, last in (("Wet", 5, 8), ("Dry", None, 3)):
        wet(name, (0.2, 0.3, 0.1 * first if first else 0.9))
        scripting.recolour(film, old.name, name, first, last)
    bpy.ops.rototoon.conform(filepath=delivered, **GIVEN)
    # The picture of frame 7 is gone, so frame 8 moves up.
    assert scripting.recolours(film) == [(old.name, "Wet", 5, 7), (old.name, "Dry", None, 3)]


def test_in_betweens_of_a_key_that_is_gone_are_left_out(addon, film, tmp_path):
    import studio

    studio._ink(addon, film, "Ink", 0.0, 5, (12, 8))
    film.data.layers["Ink"].frames.copy(1, 9)
    bpy.ops.rototoon.in_between(frames="ALL")
    keys, records = addon("tween.keys"), addon("tween.records")
    folder = tmp_path / "short"
    folder.mkdir()
    for number, step in enumerate(range(1, 9), 101):
        (folder / f"cut_{number}.png").write_bytes(shots.drawn(step))
    bpy.ops.rototoon.conform(filepath=str(folder / "cut_101.png"), timing="FRAME", frame=101)
    assert 'layer "Ink": the in-betweens from 1 to 5 of the old footage are left out, since a key is gone' in said(addon).text
    found = keys.frames_of(film.data.layers["Ink"], records.read(film.data)["Ink"])
    assert (found.keys, found.made) == ([104, 108], [105, 106, 107])
    assert list(frames(addon, film, "Left over: Ink")) == [100]
    spans = records.read(film.data)["Ink"].spans
    assert {first: (span.last, span.ends is not None) for first, span in spans.items()} == {104: (108, True)}


def test_keys_on_two_frames_of_one_picture_join(addon, library, fake, tmp_path):
    """The film is on twos. One part has its key on the first frame of a drawing, the other one on the second; the new film is on ones."""
    folder = tmp_path / "frames"
    folder.mkdir()
    again = tmp_path / "ones"
    again.mkdir()
    for number in range(10):
        (folder / f"shot_{number + 1:03}.png").write_bytes(shots.drawn(number // 2))
    for step in range(5):
        (again / f"one_{step + 1}.png").write_bytes(shots.drawn(step))
    bpy.ops.rototoon.setup(filepath=str(folder / "shot_001.png"))
    ob = bpy.context.object
    for frame in (1, 9):
        shots.draw(addon, ob, frame, [shots.diamond(frame // 2), shots.square(frame // 2)])
    bpy.ops.rototoon.match_contours()
    shots.draw(addon, ob, 5, [shots.diamond(2)])
    shots.draw(addon, ob, 6, [shots.square(2), shots.diamond(2)])
    bpy.ops.rototoon.match_contours()
    bpy.ops.rototoon.conform(filepath=str(again / "one_1.png"), timing="SCENE")
    parts = {part.name: sorted(part.keys) for part in addon("capture.contours").read(ob).parts}
    assert parts == {"Part 1": [1, 3, 5], "Part 2": [1, 3, 5]}
    now = pixels(addon, ob)[3]
    assert np.abs(now[1] - shots.diamond(2)).max() < 0.01 and np.abs(now[2] - shots.square(2)).max() < 0.01
    # The diamond of the other frame is left over.
    assert list(pixels(addon, ob, LEFT_OVER).values())[0].keys() == {1}


def test_there_and_back(addon, film, delivered, tmp_path):
    before = pixels(addon, film)
    bpy.ops.rototoon.conform(filepath=delivered, **GIVEN)
    bpy.ops.rototoon.conform(filepath=str(tmp_path / "frames" / "shot_001.png"))
    settings = film.rototoon
    assert (settings.width, settings.height, settings.first, settings.last) == (*shots.SIZE, 1, 9)
    after = pixels(addon, film)
    keys = [frame for frame, kind in frames(addon, film).items() if kind == "KEYFRAME"]
    assert len(keys) == 3
    for frame, old in zip(keys, (1, 4, 9)):
        assert all(np.abs(after[frame][part] - before[old][part]).max() < 0.5 for part in (1, 2))
    left = pixels(addon, film, LEFT_OVER)
    assert len(left) == 1
    assert all(np.abs(next(iter(left.values()))[part] - before[7][part]).max() < 0.5 for part in (1, 2))
    assert LEFT_OVER + ".001" not in film.data.layers and not any(layer.name.count("Left over") > 1 for layer in film.data.layers)


def test_place_and_scale_may_be_given(addon, film, delivered):
    before = pixels(addon, film)
    with pytest.raises(RuntimeError, match="Scale: found 0.005, expected 0 or a number from 0.01"):
        bpy.ops.rototoon.conform(filepath=delivered, scale=0.005)
    assert pixels(addon, film).keys() == before.keys()
    bpy.ops.rototoon.conform(filepath=delivered, **GIVEN)
    assert "scaled by 2 and moved by 16.00, 16.00 px" in said(addon).text
    assert away(pixels(addon, film)[8], before[9]) < 0.5


def test_footage_that_is_not_shown_gives_way_too(addon, film, delivered):
    film.rototoon.camera.data.background_images[0].show_background_image = False
    assert bpy.ops.rototoon.conform(filepath=delivered, **GIVEN) == {"FINISHED"}
    (entry,) = film.rototoon.camera.data.background_images
    assert entry.image.filepath.endswith("new_1001.png") and not entry.show_background_image
