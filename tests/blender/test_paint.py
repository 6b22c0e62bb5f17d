"""Paint Bucket, Fill Drawings, Next Doubtful Region and Clear Paint on the small line film, with the real library."""

import json
from dataclasses import replace
from types import SimpleNamespace

import bpy
import line_shots as ls
import numpy as np
import pytest
import stand_in
from line_stage import film, pictures  # noqa: F401 - fixtures
from line_stage import attribute, handle_of, kinds, opened, rendered, said

PAPER, SKIN, EYE, GREEN = (1.0, 1.0, 1.0), (0.93, 0.76, 0.62), (0.2, 0.4, 0.9), (0.1, 0.7, 0.2)
LAYER = "Paint"


def places(frame):
    """A place in the paper, in the body and in each eye on scene frame `frame`, and the colour of each."""
    x = 140.0 + 4 * (frame - 1)
    at = [(8.0, 8.0), (x, 160.0), (x - 16, 105.0), (x + 16, 105.0)]
    pixels = [at[0], *[(a * ls.SCALE, b * ls.SCALE) for a, b in at[1:]]]
    return list(zip(pixels, (PAPER, SKIN, EYE, EYE)))


def click(ob, place, colour):
    ob.rototoon.fill_colour = colour
    return bpy.ops.rototoon.paint_bucket(place=place)


@pytest.fixture
def clicked(film, pictures):  # noqa: F811
    """The film with all regions of frame 1 filled by the bucket."""

    def fill():
        for place, colour in places(1):
            assert click(film, place, colour) == {"FINISHED"}

    return opened(pictures, "clicked", fill)


@pytest.fixture
def painted(addon, clicked, pictures):  # noqa: F811
    """The film, painted."""

    def paint():
        assert bpy.ops.rototoon.fill_drawings() == {"FINISHED"}
        assert said(addon).text == "24 regions on 6 frames"

    return opened(pictures, "painted", paint)


def colour_at(addon, ob, frame, place):
    return addon("paint.bucket").colour_at(ob, frame, place)


def read(addon, ob, frame):
    return addon("blender.strokes").read(handle_of(addon, ob, LAYER, frame))


def test_shapes_without_a_line_between_them_are_told(addon, clicked):
    assert bpy.ops.rototoon.fill_drawings(sensitivity=0.1) == {"FINISHED"}
    between, bare, *_ = said(addon).warnings
    assert between == "no line was found between shapes of yours of other colours, so one of them fills both: frame 1"
    assert bare == "hardly any region was found: frames 2 to 6; a higher Sensitivity finds fainter lines"


def test_the_bucket_fills_regions_of_the_picture(addon, clicked):
    assert kinds(addon, clicked, LAYER) == {1: "KEYFRAME"}
    names = [layer.name for layer in clicked.data.layers]
    assert names[0] == LAYER, "paint is below all lines"
    content = read(addon, clicked, 1)
    assert content.strokes("cyclic").all() and not content.strokes("rototoon_generated").any()
    for place, colour in places(1):
        assert colour_at(addon, clicked, 1, place) == pytest.approx(colour, abs=1e-3)
    used = [clicked.data.materials[int(i)].name for i in content.strokes("material_index")]
    assert sorted(used) == ["Paint 3366e6", "Paint 3366e6", "Paint edc29e", "Paint ffffff"], "one material for each colour"
    assert click(clicked, places(1)[1][0], GREEN) == {"FINISHED"}
    assert colour_at(addon, clicked, 1, places(1)[1][0]) == pytest.approx(GREEN, abs=1e-3)
    assert len(read(addon, clicked, 1).sizes) == 4, "a second click replaces the first"


def test_a_click_on_a_line_changes_nothing(addon, film):  # noqa: F811
    body = ls.lines(0)[0][0]
    with pytest.raises(RuntimeError, match="There is a line here"):
        click(film, tuple(body[0]), SKIN)
    assert film.data.layers.get(LAYER) is None
    bpy.context.scene.frame_set(99)
    with pytest.raises(RuntimeError, match="There is no picture on frame 99: the footage is on frames 1 to 6"):
        click(film, (8, 8), SKIN)


def test_colours_are_on_every_frame(addon, painted):
    assert kinds(addon, painted, LAYER) == {1: "KEYFRAME", **dict.fromkeys(range(2, 7), "GENERATED")}
    for frame in range(1, 7):
        for place, colour in places(frame):
            assert colour_at(addon, painted, frame, place) == pytest.approx(colour, abs=1e-3), frame
        assert sorted(attribute(addon, painted, LAYER, frame, "rototoon_track").tolist()) == [1, 2, 3, 4]
        assert len(set(attribute(addon, painted, LAYER, frame, "material_index").tolist())) == 3
    assert [m.name for m in painted.data.materials if m.name.startswith("Paint")] == ["Paint ffffff", "Paint edc29e", "Paint 3366e6"]


def test_the_picture_shows_paint_with_holes_below_the_lines(addon, painted, tmp_path):
    bpy.ops.rototoon.trace_drawing()
    bpy.context.scene.view_settings.view_transform = "Standard"
    seen = rendered(painted, 5, tmp_path)
    for (x, y), colour in places(5):
        assert seen[int(y), int(x), :3] == pytest.approx(colour, abs=0.03)
    # No gap shows beside a line: at this size paint goes one pixel under it. The edge of the picture is soft.
    assert (seen[2:-2, 2:-2, 3] > 0.98).mean() > 0.997
    # Without the eyes, the body shows through at their places.
    handle = handle_of(addon, painted, LAYER, 5)
    numbers = attribute(addon, painted, LAYER, 5, "rototoon_track")
    addon("blender.grease_pencil").remove_strokes(handle, np.flatnonzero(numbers >= 3).tolist())
    seen = rendered(painted, 5, tmp_path)
    assert all(seen[int(y), int(x), 3] < 0.02 for (x, y), _ in places(5)[2:])


def test_the_artists_shapes_stay_as_they_are(addon, clicked):
    before = read(addon, clicked, 1)
    bpy.ops.rototoon.fill_drawings()
    after = read(addon, clicked, 1)
    after.curve = {name: values for name, values in after.curve.items() if name in before.curve and name != "rototoon_track"}
    before.curve.pop("rototoon_track")
    after.point = {name: after.point[name] for name in before.point}
    assert before.equals(after)


def test_a_region_changed_on_a_later_frame_mends_what_follows(addon, painted):
    bpy.context.scene.frame_set(4)
    eye = places(4)[2][0]
    click(painted, eye, GREEN)
    assert kinds(addon, painted, LAYER)[4] == "KEYFRAME"
    assert len(read(addon, painted, 4).sizes) == 4, "the generated region gave way"
    bpy.ops.rototoon.fill_drawings()
    found = [colour_at(addon, painted, frame, places(frame)[2][0]) for frame in range(1, 7)]
    assert found == [pytest.approx(EYE, abs=1e-3)] * 3 + [pytest.approx(GREEN, abs=1e-3)] * 3
    assert all(colour_at(addon, painted, frame, places(frame)[3][0]) == pytest.approx(EYE, abs=1e-3) for frame in range(1, 7))


def test_another_material_on_a_generated_stroke_is_a_click(addon, painted):
    gp, materials = addon("blender.grease_pencil"), addon("blender.fill_materials")
    handle = handle_of(addon, painted, LAYER, 3)
    numbers = attribute(addon, painted, LAYER, 3, "rototoon_track")
    used = attribute(addon, painted, LAYER, 3, "material_index")
    used[numbers == 2] = materials.material(painted, np.array(GREEN))
    gp.put(handle, "material_index", used)
    bpy.ops.rototoon.fill_drawings()
    body = [colour_at(addon, painted, frame, places(frame)[1][0]) for frame in range(1, 7)]
    assert body == [pytest.approx(SKIN, abs=1e-3)] * 2 + [pytest.approx(GREEN, abs=1e-3)] * 4
    assert kinds(addon, painted, LAYER)[3] == "KEYFRAME" and len(read(addon, painted, 3).sizes) == 4


def test_shapes_of_blenders_fill_tool_are_clicks(addon, film):  # noqa: F811
    turn = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    x, y = places(1)[1][0]
    body = np.stack([140 * ls.SCALE + 45 * ls.SCALE * np.cos(turn), 130 * ls.SCALE + 64 * ls.SCALE * np.sin(turn)], 1)
    eyes = [np.array(place) + 5 * np.stack([np.cos(turn), np.sin(turn)], 1) for place, _ in places(1)[2:]]
    paper = np.array([(2, 2), (30, 2), (30, 30), (2, 30)], float)
    # The shape of the body lies below those of the eyes, as artists paint.
    ls.put(addon, film, LAYER, 1, [(body, True), (eyes[0], True), (eyes[1], True), (paper, True)])
    gp, materials = addon("blender.grease_pencil"), addon("blender.fill_materials")
    handle = handle_of(addon, film, LAYER, 1)
    colours = (SKIN, EYE, EYE, PAPER)
    gp.put(handle, "material_index", np.array([materials.material(film, np.array(colour)) for colour in colours], np.int32))
    if gp.FILL_BY_ID:
        gp.put(handle, "fill_id", np.arange(1, 5, dtype=np.int32))
    assert bpy.ops.rototoon.fill_drawings() == {"FINISHED"}
    for frame in range(2, 7):
        for place, colour in places(frame):
            assert colour_at(addon, film, frame, place) == pytest.approx(colour, abs=1e-3), frame
    # The small shape on the paper is a click; the paper itself is painted below it.
    assert colour_at(addon, film, 1, (210.0, 8.0)) == pytest.approx(PAPER, abs=1e-3)
    assert len(read(addon, film, 1).sizes) > 4


def test_unsure_regions_are_marked_or_left_out(addon, film):  # noqa: F811
    for place, colour in places(1)[:2]:
        click(film, place, colour)
    bpy.ops.rototoon.fill_drawings()
    assert "probably wrong: press Next Doubtful Region" in said(addon).text
    found = addon("paint.doubts").places(film)
    assert found and {place.frame for place in found} <= set(range(2, 7))
    marks = addon("ui.doubts").marked_regions(film, found[0].frame)
    assert marks and all(mark.lost for mark in marks)
    assert bpy.ops.rototoon.next_doubtful_region() == {"FINISHED"}
    assert bpy.context.scene.frame_current == found[0].frame
    assert f"The colour of region {found[0].number} is probably wrong on frame {found[0].frame}" in said(addon).text
    film.rototoon.show_fill_doubts = False
    assert addon("ui.overlay").doubtful(film, found[0].frame) == []
    film.rototoon.fill_confidence = 0.5
    bpy.ops.rototoon.fill_drawings()
    assert addon("paint.doubts").places(film) == [] and "probably wrong" not in said(addon).text
    assert colour_at(addon, film, 3, places(3)[1][0]) == pytest.approx(SKIN, abs=1e-3)
    bpy.ops.rototoon.next_doubtful_region()
    assert said(addon).text == "No region is in doubt"


def test_one_frame_leaves_the_others(addon, clicked):
    bpy.context.scene.frame_set(3)
    bpy.ops.rototoon.fill_drawings(frames="CURRENT")
    assert sorted(kinds(addon, clicked, LAYER)) == [1, 3]
    bpy.context.scene.frame_set(5)
    bpy.ops.rototoon.fill_drawings(frames="CURRENT")
    assert sorted(kinds(addon, clicked, LAYER)) == [1, 3, 5]
    assert sorted(attribute(addon, clicked, LAYER, 5, "rototoon_track").tolist()) == [1, 2, 3, 4]


def test_a_second_run_gives_the_same(addon, painted):
    before = {frame: read(addon, painted, frame) for frame in range(1, 7)}
    bpy.ops.rototoon.fill_drawings()
    assert all(before[frame].equals(read(addon, painted, frame)) for frame in range(1, 7))


def test_locked_layers_and_empty_drawings_of_the_artist_stay(addon, painted):
    gp = addon("blender.grease_pencil")
    layer = painted.data.layers[LAYER]
    layer.lock = True
    for call in (bpy.ops.rototoon.fill_drawings, bpy.ops.rototoon.clear_fills, lambda: click(painted, (8, 8), GREEN)):
        with pytest.raises(RuntimeError, match='the layer "Paint" is locked: unlock it first'):
            call()
    layer.lock = False
    gp.remove_frames(layer, [4])
    gp.make_frames(layer, [4], gp.KEYFRAME)
    bpy.ops.rototoon.fill_drawings()
    assert kinds(addon, painted, LAYER)[4] == "KEYFRAME" and not len(read(addon, painted, 4).sizes)
    painted.rototoon.fills_layer = "Lines"
    with pytest.raises(RuntimeError, match='The layer "Lines" is for lines or contours'):
        bpy.ops.rototoon.fill_drawings()


def test_nothing_to_paint_is_told(addon, film):  # noqa: F811
    with pytest.raises(RuntimeError, match="No region is filled yet"):
        bpy.ops.rototoon.fill_drawings()
    ls.put(addon, film, LAYER, 1, [(ls.lines(0)[4][0], False)])
    with pytest.raises(RuntimeError, match='The strokes on the layer "Paint" have no fill'):
        bpy.ops.rototoon.fill_drawings()


def test_clear_paint_leaves_what_the_artist_made(addon, painted):
    before = read(addon, painted, 1)
    assert bpy.ops.rototoon.clear_fills() == {"FINISHED"}
    assert said(addon).text == "20 painted regions removed"
    assert kinds(addon, painted, LAYER) == {1: "KEYFRAME"} and before.equals(read(addon, painted, 1))


def test_clear_paint_on_frames_that_share_a_drawing(addon, painted):
    gp, layer = addon("blender.grease_pencil"), painted.data.layers[LAYER]
    own, generated = read(addon, painted, 1), read(addon, painted, 2)
    addon("blender.strokes").write(handle_of(addon, painted, LAYER, 2), addon("blender.strokes").joined(generated, own))
    for frame in (3, 4):
        gp.remove_frames(layer, [frame])
        layer.frames.copy(2, frame, instance_drawing=True)
    bpy.ops.rototoon.clear_fills()
    assert list(kinds(addon, painted, LAYER)) == [1, 2, 3, 4]
    assert [len(read(addon, painted, frame).sizes) for frame in (1, 2, 3, 4)] == [len(own.sizes)] * 4


def test_tracing_leaves_paint_alone(addon, painted):
    before = read(addon, painted, 3)
    bpy.ops.rototoon.trace_drawing()
    bpy.ops.rototoon.carry_strokes(layers="ALL")
    assert before.equals(read(addon, painted, 3))


def test_undo_takes_paint_back(addon, clicked):
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.rototoon.fill_drawings()
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    assert kinds(addon, bpy.context.object, LAYER) == {1: "KEYFRAME"}


def test_paint_goes_into_a_document_and_comes_back(addon, painted, tmp_path):
    path = tmp_path / "paint.json"
    assert bpy.ops.rototoon.export_document(filepath=str(path)) == {"FINISHED"}
    assert said(addon).text == "paint of 6 frames in paint.json", "no contours are needed"
    document = json.loads(path.read_text())
    (fills,) = document["fills"]
    for click_, (place, colour) in zip(fills["regions"], places(1), strict=True):
        assert click_["at"] == pytest.approx(place, abs=1e-3) and click_["colour"] == pytest.approx(colour, abs=1e-3)
    for each in document["filled"]:
        assert sorted(region["track"] for region in each["regions"]) == [0, 1, 2, 3]
        holes = {region["track"]: len(region.get("holes", [])) for region in each["regions"]}
        # At this size a line within the body leaves a hole of its own, below it.
        assert holes[1] >= 2 and (holes[0], holes[2], holes[3]) == (1, 0, 0)
    with addon("rototoon").Session.open(path) as session:
        assert len(session.filled().on(4)) == 4, "the library reads it"
    assert bpy.ops.rototoon.import_document(filepath=str(path)) == {"FINISHED"}
    assert said(addon).text == 'paint of 6 frames from paint.json, in the new object "paint"'
    other = bpy.context.object
    assert other != painted and kinds(addon, other, LAYER) == kinds(addon, painted, LAYER)
    for frame in range(1, 7):
        for place, colour in places(frame):
            assert colour_at(addon, other, frame, place) == pytest.approx(colour, abs=1e-3)
    again = tmp_path / "again.json"
    bpy.ops.rototoon.export_document(filepath=str(again))
    assert json.loads(again.read_text())["fills"] == document["fills"]


def test_clicks_of_a_document_without_regions_are_discs(addon, painted, tmp_path):
    path = tmp_path / "paint.json"
    bpy.ops.rototoon.export_document(filepath=str(path))
    document = json.loads(path.read_text())
    del document["filled"]
    path.write_text(json.dumps(document))
    bpy.ops.rototoon.import_document(filepath=str(path))
    other = bpy.context.object
    assert kinds(addon, other, LAYER) == {1: "KEYFRAME"}
    bpy.ops.rototoon.fill_drawings()
    for frame in range(1, 7):
        for place, colour in places(frame):
            assert colour_at(addon, other, frame, place) == pytest.approx(colour, abs=1e-3)
    document["fills"][0]["regions"][0]["colour"] = [2, 0, 0]
    path.write_text(json.dumps(document))
    with pytest.raises(RuntimeError, match=r"fills\[0\] \(frame 1\).regions\[0\].colour\[0\]: found 2"):
        bpy.ops.rototoon.import_document(filepath=str(path))


def test_a_stopped_run_and_one_that_comes_too_late_change_nothing(addon, clicked, monkeypatch):
    filling, library = addon("paint.filling"), addon("rototoon")

    class Stopped(library.Session):
        def fill(self, *_arguments, **_options):
            raise library.Cancelled("cancelled")

    with monkeypatch.context() as patch:
        patch.setattr(filling, "make", Stopped.from_document)
        assert bpy.ops.rototoon.fill_drawings() == {"CANCELLED"}
    assert said(addon).text == "Fill Drawings: stopped, nothing was changed" and kinds(addon, clicked, LAYER) == {1: "KEYFRAME"}
    plan = addon("paint.plan").make(clicked, LAYER, 1, 6)
    worker = filling.worker(plan, filling.Options())
    shares = []
    worker.run_here(lambda share, step: shares.append((share, step)))
    assert shares[-1][0] == 1.0 and {"Painting"} <= {step for _, step in shares}
    bpy.context.scene.frame_set(2)
    click(clicked, places(2)[1][0], GREEN)
    with pytest.raises(addon("blender.errors").Problem, match="The paint changed while the drawings were filled"):
        addon("common.jobs").drained(filling.finishing(clicked, plan, worker.result))
    assert sorted(kinds(addon, clicked, LAYER)) == [1, 2]


def test_a_click_in_the_view_meets_the_pixel_and_is_taken_back(addon, clicked):
    bucket, camera = addon("paint.bucket"), addon("blender.camera")
    mapping = addon("blender.placement").Mapper(clicked, [1], {}, [LAYER]).at(0, 1)
    matrix = camera.layer_to_world(clicked, clicked.data.layers[LAYER])
    eye = np.array(bpy.context.scene.camera.matrix_world.translation)
    for pixel in ((8.0, 8.0), (100.5, 120.25)):
        world = matrix[:3, :3] @ mapping.to_layer(np.array([pixel]))[0] + matrix[:3, 3]
        assert bucket.pixel_of(clicked, 1, eye, world - eye) == pytest.approx(pixel, abs=1e-3)
    before = read(addon, clicked, 1)
    again = bucket.paint(clicked, 1, places(1)[1][0], GREEN, 1.0)
    first = bucket.paint(clicked, 3, (8.0, 8.0), GREEN, 1.0)
    assert sorted(kinds(addon, clicked, LAYER)) == [1, 3]
    bucket.take_back(clicked, first)
    bucket.take_back(clicked, again)
    with pytest.raises(addon("blender.errors").Problem, match="The drawing on frame 1 has changed since the click"):
        bucket.take_back(clicked, again)
    assert kinds(addon, clicked, LAYER) == {1: "KEYFRAME"} and before.equals(read(addon, clicked, 1))


def test_a_held_drawing_is_painted_where_it_begins(addon, clicked, tmp_path, pictures):  # noqa: F811
    for number in (1, 2, 3):
        source = pictures.with_name("line_001.png" if number < 3 else "line_003.png")
        (tmp_path / f"two_{number:03}.png").write_bytes(source.read_bytes())
    film_on_twos = ls.set_up(tmp_path / "two_001.png")
    bpy.context.scene.frame_set(2)
    click(film_on_twos, places(1)[0][0], PAPER)
    assert kinds(addon, film_on_twos, LAYER) == {2: "KEYFRAME"}, "nothing was shown yet"
    bpy.context.scene.frame_set(1)
    click(film_on_twos, places(1)[1][0], SKIN)
    addon("blender.grease_pencil").remove_frames(film_on_twos.data.layers[LAYER], [2])
    bpy.context.scene.frame_set(2)
    click(film_on_twos, places(1)[0][0], PAPER)
    assert kinds(addon, film_on_twos, LAYER) == {1: "KEYFRAME"}
    bpy.ops.rototoon.fill_drawings()
    assert kinds(addon, film_on_twos, LAYER) == {1: "KEYFRAME", 3: "GENERATED"}


def test_clicks_are_taken_until_the_artist_leaves(addon, film, monkeypatch):  # noqa: F811
    module = addon("paint.operators.paint_bucket")
    own = {name: value for name, value in vars(module.ROTOTOON_OT_paint_bucket).items() if not name.startswith("__")}
    bucket = type("Bucket", (module.Reporting, module.OnFootage), own | {"report": lambda *_: None})()
    said_there, spot = [], {}
    space = SimpleNamespace(status_text_set=said_there.append)
    cursor = SimpleNamespace(cursor_modal_set=lambda _: None, cursor_modal_restore=lambda: None)
    context = SimpleNamespace(object=film, scene=bpy.context.scene, workspace=space, window=cursor)
    monkeypatch.setattr(module, "view_at", lambda *_: spot.get("view"))
    monkeypatch.setattr(addon("paint.bucket"), "pixel_of", lambda *_: spot["at"])
    rays = SimpleNamespace(region_2d_to_origin_3d=lambda *_: (0, 0, 0), region_2d_to_vector_3d=lambda *_: (0, 1, 0))
    monkeypatch.setattr(module, "view3d_utils", rays)
    bucket._stack, bucket._undone = [], module.Undone()

    def event(kind, at=None, ctrl=False, view=True):
        spot.update(at=at, view=(SimpleNamespace(x=0, y=0), None) if view else None)
        return bucket.modal(context, SimpleNamespace(type=kind, value="PRESS", ctrl=ctrl, shift=False, mouse_x=0, mouse_y=0))

    (paper, _), (body, _), (eye, _), _ = places(1)
    film.rototoon.fill_colour = SKIN
    assert event("LEFTMOUSE", body) == {"RUNNING_MODAL"} and said_there[-1].startswith("1 region filled.")
    pushed = []
    undo = SimpleNamespace(undo_push=lambda message: pushed.append(message))
    monkeypatch.setattr(module, "bpy", SimpleNamespace(ops=SimpleNamespace(ed=undo)))
    assert event("LEFTMOUSE", paper, view=False) == {"PASS_THROUGH"} == event("MOUSEMOVE", view=False)
    assert pushed == ["Paint Bucket"], "over the panels Blender's Undo is in reach, and takes the click alone"
    assert event("WHEELUPMOUSE") == event("RIGHT_ARROW") == {"PASS_THROUGH"}
    event("LEFTMOUSE", tuple(ls.lines(0)[0][0][0]))
    assert said_there[-1].startswith("There is a line here")
    film.rototoon.fill_colour = EYE
    event("LEFTMOUSE", eye)
    event("LEFTMOUSE", body, ctrl=True)
    assert tuple(film.rototoon.fill_colour) == pytest.approx(SKIN, abs=1e-3), "the colour of the body is taken"
    assert colour_at(addon, film, 1, eye) == pytest.approx(EYE, abs=1e-3)
    assert event("Z", ctrl=True, view=False) == {"RUNNING_MODAL"}, "it takes the click back wherever the mouse is"
    assert colour_at(addon, film, 1, eye) is None and colour_at(addon, film, 1, body) == pytest.approx(SKIN, abs=1e-3)
    context.object = bpy.data.objects["Camera"]
    event("LEFTMOUSE", eye)
    assert said_there[-1].startswith("Make a Grease Pencil object active first")
    # Blender's undo has a step of the one click already.
    assert event("ESC") == {"CANCELLED"} and said(addon).text == "1 region filled" and said_there[-1] is None


def test_holes_are_joined_by_seams_and_parted_again(addon):
    shapes = addon("paint.shapes")
    polygons = addon("common.polygons")
    turn = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    ring = np.stack([np.cos(-turn), np.sin(-turn)], 1)
    outline = np.array([(0.0, 0.0), (200.0, 0.0), (200.0, 100.0), (0.0, 100.0)])
    holes = [np.array([x, y]) + size * ring for x, y, size in ((60, 50, 30), (100, 50, 8), (150, 30, 12), (150, 70, 12), (100, 62, 3))]
    line = shapes.joined(outline, holes)
    assert polygons.area(line) == pytest.approx(polygons.area(outline) + sum(map(polygons.area, holes)), rel=1e-9), "a hole counts less"
    first, *others = shapes.parted(line)
    assert np.array_equal(np.sort(line[first], axis=0), np.sort(outline, axis=0))
    sizes = sorted(abs(polygons.area(line[loop])) for loop in others)
    assert sizes == pytest.approx(sorted(-polygons.area(hole) for hole in holes))
    # No seam crosses another line: a place is inside of the one line where it is inside of the shape.
    places = np.random.default_rng(1).uniform((0, 0), (200, 100), (500, 2))
    assert np.array_equal(polygons.inside([line], places), polygons.inside([outline, *holes], places))
    found = shapes.middles([line])
    assert polygons.inside([outline, *holes], found).all() and shapes.clearance([line], found).max() > 12


def test_scripts_paint_and_read_regions(addon, film):  # noqa: F811
    scripting, polygons = addon("scripting"), addon("common.polygons")
    with pytest.raises(RuntimeError, match='has no layer "Paint"'):
        scripting.regions(film)
    for place, colour in places(1):
        assert scripting.fill_region(film, 1, place, colour) == 1
    for wrong in ((2, 0, 0), (float("nan"), 0, 0)):
        with pytest.raises(RuntimeError, match="colour: found .*, expected three numbers from 0 to 1"):
            scripting.fill_region(film, 1, (8, 8), wrong)
    with pytest.raises(RuntimeError, match="sensitivity: found 0"):
        scripting.fill_drawings(film, sensitivity=0)
    done = scripting.fill_drawings(film, (1, 3))
    assert (done.regions, done.frames, done.doubtful, done.missed, done.unrelated) == (12, (1, 2, 3), {}, (), ())
    found = scripting.regions(film)
    assert sorted(found) == [1, 2, 3] and [region.generated for region in found[1]] == [False] * 4
    for place, colour in places(3):
        (own,) = [each for each in found[3] if polygons.inside([each.outline, *each.holes], np.array([place]))[0]]
        assert own.colour == pytest.approx(colour, abs=1e-3) and own.generated and 0.5 < own.confidence < 1
    assert sorted(region.number for region in found[3]) == [1, 2, 3, 4]


def test_other_drawings_stay_unpainted(addon, painted, monkeypatch):
    class Cut(stand_in.Painter):
        """No picture from the fifth on shows the same."""

        def fill(self, *arguments, **options):
            found = super().fill(*arguments, **options)
            return replace(found, frames=found.frames[:4], unrelated=[5, 6])

    monkeypatch.setattr(addon("paint.filling"), "make", Cut.from_document)
    assert bpy.ops.rototoon.fill_drawings() == {"FINISHED"}
    assert said(addon).text == "16 regions on 6 frames; not painted, since no drawing of yours shows the same: frames 5 and 6"
    assert kinds(addon, painted, LAYER) == {1: "KEYFRAME", **dict.fromkeys(range(2, 7), "GENERATED")}
    assert not len(read(addon, painted, 5).sizes), "the drawing before is not shown there"


def test_a_shape_on_a_line_is_told(addon, clicked):
    gp = addon("blender.grease_pencil")
    mapping = addon("blender.placement").Mapper(clicked, [1], {}, [LAYER]).at(0, 1)
    # A sliver along the arm, far from all regions but the paper: all of it is ink.
    (start, *_, end) = ls.lines(0)[4][0]
    middle, side = (start + end) / 2, (end - start)[::-1] * (1, -1) / np.linalg.norm(end - start)
    sliver = np.stack([middle - 0.3 * side, middle + 0.3 * side, middle + 0.02 * (end - start)])
    rows = addon("blender.stroke_rows").Rows(np.array([3], np.int32))
    rows.values = {"position": mapping.to_layer(sliver).astype(np.float32), "cyclic": np.array([True])}
    rows.values["material_index"] = np.array([addon("blender.fill_materials").material(clicked, np.array(GREEN))], np.int32)
    if gp.FILL_BY_ID:
        rows.values["fill_id"] = np.array([77], np.int32)
    addon("blender.stroke_rows").append(handle_of(addon, clicked, LAYER, 1), rows)
    assert bpy.ops.rototoon.fill_drawings() == {"FINISHED"}
    assert "a shape of yours lies on a line: frame 1" in said(addon).text
    assert len(read(addon, clicked, 1).sizes) == 5
