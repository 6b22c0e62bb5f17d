"""Where the pictures are, from files, images, clips and movies."""

import os
import shutil
from pathlib import Path

import bpy
import numpy as np
import pytest
import shots

pytestmark = pytest.mark.every_version


def touch(folder, *names):
    for name in names:
        (folder / name).write_bytes(b"")


def test_sequence_around_a_file(addon, tmp_path):
    footage = addon("blender.footage")
    touch(tmp_path, "a_008.png", "a_009.png", "a_010.png", "a_011.png", "a_020.png", "b_010.png", "a_010.jpg", "a_10.png")
    found = footage.sequence_around(str(tmp_path / "a_010.png"))
    assert found.pattern == str(tmp_path / "a_%03d.png")
    assert (found.first, found.last, found.picked, found.missing) == (8, 11, 10, 1)


def test_sequence_without_padding(addon, tmp_path):
    footage = addon("blender.footage")
    touch(tmp_path, *(f"s2_{n}.png" for n in range(7, 13)))
    found = footage.sequence_around(str(tmp_path / "s2_9.png"))
    assert found.pattern == str(tmp_path / "s2_%d.png")
    assert (found.first, found.last) == (7, 12)


def test_numbers_that_outgrow_their_padding(addon, tmp_path):
    footage = addon("blender.footage")
    touch(tmp_path, "f098.png", "f099.png", "f100.png", "f999.png", "f1000.png")
    found = footage.sequence_around(str(tmp_path / "f099.png"))
    assert (found.pattern, found.first, found.last) == (str(tmp_path / "f%03d.png"), 98, 100)


def test_names_that_cannot_be(addon, tmp_path):
    footage, problem = addon("blender.footage"), addon("blender.errors").Problem
    touch(tmp_path, "still.png")
    with pytest.raises(problem, match="no number in its name"):
        footage.sequence_around(str(tmp_path / "still.png"))
    with pytest.raises(problem, match="No file"):
        footage.sequence_around(str(tmp_path / "gone_1.png"))


def test_from_file_shows_the_first_picture_on_the_first_frame(addon, tmp_path):
    bpy.context.scene.frame_start = 11
    picked = shots.draw_sequence(tmp_path, first=100)
    ob = shots.set_up(tmp_path / "other", match_scene=False)
    bpy.ops.rototoon.footage_from_file(filepath=str(picked.with_name("shot_104.png")))
    settings = ob.rototoon
    assert (settings.first, settings.last, settings.width, settings.height) == (100, 108, 160, 90)
    assert settings.frame_offset == 11 - 100
    bpy.ops.rototoon.footage_from_file(filepath=str(picked), at_scene_start=False, frame=5)
    assert settings.frame_offset == 5 - 100


def test_from_camera_background_with_its_timing(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    entry = bpy.context.scene.camera.data.background_images[0]
    entry.image_user.frame_start, entry.image_user.frame_offset = 21, 3
    bpy.ops.rototoon.footage_from_camera()
    # Picture 4 is shown on frame 21.
    assert ob.rototoon.frame_offset == 17
    assert (ob.rototoon.first, ob.rototoon.last) == (1, 9)


def test_from_a_movie_clip_in_the_background(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    entry = bpy.context.scene.camera.data.background_images[0]
    entry.source = "MOVIE_CLIP"
    entry.use_camera_clip = False
    entry.clip = bpy.data.movieclips.load(str(tmp_path / "frames/shot_003.png"))
    entry.clip.frame_start = 30
    bpy.ops.rototoon.footage_from_camera()
    assert ob.rototoon.frame_offset == 27


def test_from_reference_image(addon, tmp_path):
    ob = shots.set_up(tmp_path, plane="REFERENCE")
    empty = ob.rototoon.reference
    ob.rototoon.reference = None
    empty.image_user.frame_start = 7
    empty.select_set(True)
    bpy.ops.rototoon.footage_from_reference()
    assert ob.rototoon.reference == empty and ob.rototoon.plane == "REFERENCE"
    assert ob.rototoon.frame_offset == 6
    corners = np.array([[0.0, 0.0], [160.0, 90.0]])
    world = np.array(ob.matrix_world)
    points = shots.mapping(addon, ob).to_layer(corners) @ world[:3, :3].T + world[:3, 3]
    assert np.abs(points - [[-5, 0, 2.8125], [5, 0, -2.8125]]).max() < 1e-5


def test_object_fills_an_existing_camera(addon, tmp_path):
    data = bpy.data.cameras.new("c")
    camera = bpy.data.objects.new("c", data)
    camera.location, camera.rotation_euler = (3, -5, 2), (1.2, 0.1, 0.4)
    data.shift_x = 0.2
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    bpy.context.view_layer.update()
    ob = shots.set_up(tmp_path)
    points = shots.mapping(addon, ob).to_layer(np.array([[0.0, 0.0], [160.0, 0.0], [160.0, 90.0], [80.0, 45.0]]))
    assert np.linalg.norm(points[1] - points[0]) == pytest.approx(10, abs=1e-4)
    assert np.abs(points[3]).max() < 1e-5
    assert points[0][0] < points[1][0] and points[2][2] < points[1][2]


def make_movie(path, frames):
    """Renders a picture sequence to a movie with Blender itself."""
    scene = bpy.data.scenes.new("maker")
    strips = scene.sequence_editor_create().strips
    strip = strips.new_image("pictures", str(frames[0]), 1, 1)
    for frame in frames[1:]:
        strip.elements.append(frame.name)
    render = scene.render
    render.resolution_x, render.resolution_y = shots.SIZE
    render.fps = 12
    scene.view_settings.view_transform = "Standard"
    scene.frame_start, scene.frame_end = 1, len(frames)
    if hasattr(render.image_settings, "media_type"):
        render.image_settings.media_type = "VIDEO"
    render.image_settings.file_format = "FFMPEG"
    render.ffmpeg.format, render.ffmpeg.codec = "MPEG4", "H264"
    render.ffmpeg.constant_rate_factor = "PERC_LOSSLESS"
    render.filepath = str(path)
    bpy.ops.render.render(animation=True, scene=scene.name)
    bpy.data.scenes.remove(scene)


def read_pixels(path):
    image = bpy.data.images.load(str(path))
    pixels = np.empty(image.size[0] * image.size[1] * 4, np.float32)
    image.pixels.foreach_get(pixels)
    size = tuple(image.size)
    bpy.data.images.remove(image)
    return pixels.reshape(size[1], size[0], 4)[::-1, :, :3]


def test_movie_becomes_a_sequence_in_the_cache(addon, tmp_path):
    first = shots.draw_sequence(tmp_path / "frames")
    frames = sorted(first.parent.iterdir())
    movie_path = tmp_path / "shot.mp4"
    make_movie(movie_path, frames)
    addon("blender.preferences").preferences().cache_folder = str(tmp_path / "cache")
    shutil.rmtree(tmp_path / "cache", ignore_errors=True)
    scenes = len(bpy.data.scenes)
    bpy.ops.rototoon.setup(filepath=str(movie_path))
    settings = bpy.context.object.rototoon
    assert (settings.first, settings.last, settings.fps) == (1, 9, 12.0)
    assert (settings.width, settings.height) == shots.SIZE
    assert len(bpy.data.scenes) == scenes
    for number in (1, 5, 9):
        got, want = read_pixels(bpy.path.abspath(settings.pattern) % number), read_pixels(frames[number - 1])
        assert np.abs(got - want).mean() < 0.03, number
    made = [path.stat().st_mtime_ns for path in (tmp_path / "cache").rglob("*.png")]
    bpy.ops.rototoon.footage_from_file(filepath=str(movie_path))
    assert made == [path.stat().st_mtime_ns for path in (tmp_path / "cache").rglob("*.png")]
    addon("blender.preferences").preferences().cache_folder = ""


@pytest.mark.parametrize("fps", [23.976, 24000 / 1001, 29.97, 12.0, 59.94])
def test_rates_are_written_as_they_were_given(addon, tmp_path, fps):
    ob = shots.set_up(tmp_path)
    ob.rototoon.fps = fps
    assert addon("blender.footage").rate(ob) == float(f"{fps:.7g}")


@pytest.fixture
def movie_shot(addon, tmp_path):
    """An object with a movie as footage, with a cache of its own."""
    preferences = addon("blender.preferences").preferences()
    make_movie(tmp_path / "shot.mp4", sorted(shots.draw_sequence(tmp_path / "frames").parent.iterdir()))
    preferences.cache_folder = str(tmp_path / "cache")
    bpy.ops.rototoon.setup(filepath=str(tmp_path / "shot.mp4"))
    yield bpy.context.object
    preferences.cache_folder = ""


def test_frames_of_a_movie_that_left_the_cache_are_made_again(addon, movie_shot, tmp_path):
    footage, movie = addon("blender.footage"), addon("blender.movie")
    before = footage.pattern_of(movie_shot)
    shutil.rmtree(tmp_path / "cache")
    assert footage.pattern_of(movie_shot) == before, "tests run without a window"
    assert Path(before % 9).is_file()
    # Another machine keeps them elsewhere.
    addon("blender.preferences").preferences().cache_folder = str(tmp_path / "other")
    shutil.rmtree(tmp_path / "cache")
    assert Path(footage.pattern_of(movie_shot)).parent.parent == tmp_path / "other"
    shutil.rmtree(tmp_path / "other")
    Path(tmp_path / "shot.mp4").unlink()
    with pytest.raises(addon("blender.errors").Problem, match=r"No movie .*shot\.mp4, and its frames are not in the cache"):
        footage.pattern_of(movie_shot)
    assert movie.PICTURE in before


def test_a_farm_is_told_of_frames_in_the_cache(addon, fake, movie_shot, tmp_path):
    shots.draw(addon, movie_shot, 1, [shots.diamond(0)])
    shots.draw(addon, movie_shot, 9, [shots.diamond(8)])
    bpy.ops.rototoon.match_contours()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    bpy.ops.rototoon.send_to_farm(directory=str(tmp_path / "farm"))
    report = addon("scripting").take_reports()[-1]
    assert f'the footage of "{movie_shot.name}" is a movie' in str(report), report


def test_broken_off_movie_leaves_nothing(addon, tmp_path):
    first = shots.draw_sequence(tmp_path / "frames")
    movie_path = tmp_path / "shot.mp4"
    make_movie(movie_path, sorted(first.parent.iterdir()))
    movie = addon("blender.movie")
    steps = movie.extract(str(movie_path), str(tmp_path / "cache"))
    next(steps)
    steps.close()
    assert list((tmp_path / "cache").iterdir()) == []
    assert movie.cached(str(movie_path), str(tmp_path / "cache")) is None


def test_not_a_movie(addon, tmp_path):
    bpy.ops.rototoon.setup(filepath=str(shots.draw_sequence(tmp_path / "frames")))
    (tmp_path / "broken.mp4").write_bytes(b"no movie")
    addon("blender.preferences").preferences().cache_folder = str(tmp_path / "cache")
    with pytest.raises(RuntimeError, match="Cannot read the movie"):
        bpy.ops.rototoon.footage_from_file(filepath=str(tmp_path / "broken.mp4"))
    addon("blender.preferences").preferences().cache_folder = ""


def test_cache_keeps_its_limit(addon, tmp_path):
    movie = addon("blender.movie")
    new, middle, old, used = names = [letter * 24 for letter in "cbad"]
    for age, name in enumerate(names):
        lay_files(tmp_path / name, 1_000_000 - age, "frame_000001.png", "movie.txt")
    assert movie.shrink(str(tmp_path), 500, {used}) == 2
    assert {p.name for p in tmp_path.iterdir()} == {new, used}


def lay_files(folder, time, *names):
    """A folder that was last changed long ago, with files of 100 bytes."""
    folder.mkdir()
    for name in names:
        (folder / name).write_bytes(b"x" * 100)
    os.utime(folder, (time, time))


def test_folders_of_the_artist_in_the_cache_folder_stay(addon, tmp_path):
    """The artist may choose a folder as Cache Folder that has other things in it; they do not count, and they do not vanish."""
    movie = addon("blender.movie")
    hex_name, random = "0123456789abcdef" * 2, "0" * 12
    own = {
        "sh010 renders": ("frame_000001.png", "movie.txt"),
        "sh020.unfinished": ("work.blend",),
        "notes.unfinished": (),
        f"killed.{random}.unfinished": ("frame_000001.png",),
        hex_name[:24]: ("frame_000001.png",),
        hex_name[1:25]: ("frame_000001.png", "movie.txt", "notes.txt"),
        f"{hex_name[:24]}.{random}.unfinished": ("frame_000001.png", "work.blend"),
        hex_name[:23]: ("frame_000001.png", "movie.txt"),
    }
    for name, files in own.items():
        lay_files(tmp_path / name, 1_000_000, *files)
    (tmp_path / hex_name[1:25] / "deep").mkdir()
    lay_files(tmp_path / hex_name[2:26], 1_000_000, "frame_000001.png", "movie.txt")
    lay_files(tmp_path / f"{hex_name[2:26]}.{random}.unfinished", 1_000_000, "frame_000001.png")
    assert movie.shrink(str(tmp_path), 200, set()) == 0, "what is the artist's does not count"
    assert not (tmp_path / f"{hex_name[2:26]}.{random}.unfinished").exists()
    assert movie.shrink(str(tmp_path), 0, set()) == 1
    assert {path.name: {file.name for file in path.iterdir()} - {"deep"} for path in tmp_path.iterdir()} == {
        name: set(files) for name, files in own.items()
    }


def test_two_blenders_share_a_cache(addon, tmp_path, monkeypatch):
    """Both make the frames of one movie at the same time; one removes movies while the other shows them."""
    first = shots.draw_sequence(tmp_path / "frames")
    movie_path, cache = tmp_path / "shot.mp4", tmp_path / "cache"
    make_movie(movie_path, sorted(first.parent.iterdir())[:2])
    movie = addon("blender.movie")
    steps = [movie.extract(str(movie_path), str(cache)) for _ in range(2)]
    for at_work in (*steps, *steps):
        next(at_work)
    assert len(list(cache.iterdir())) == 2
    assert [list(at_work) for at_work in steps] == [[], []]
    assert [path.name for path in cache.iterdir()] == [movie.key(str(movie_path))]
    frames = movie.cached(str(movie_path), str(cache))
    assert all((cache / movie.key(str(movie_path)) / (movie.PICTURE % number)).is_file() for number in (1, 2))

    assert movie.shrink(str(cache), 0, set()) == 0, "used within a day"
    os.utime(Path(frames.pattern).parent, (1_000_000, 1_000_000))
    killed = cache / f"{'0' * 24}.{'0' * 12}{movie._UNFINISHED}"
    killed.mkdir()
    os.utime(killed, (1_000_000, 1_000_000))

    def vanished(folder):
        raise FileNotFoundError(folder)

    with monkeypatch.context() as patch:
        patch.setattr(movie, "_size", vanished)
        assert movie.shrink(str(cache), 0, set()) == 0
    assert not killed.exists()
    assert movie.shrink(str(cache), 0, set()) == 1
    assert list(cache.iterdir()) == []


def test_an_opened_file_marks_its_movie_as_used(addon, tmp_path):
    first = shots.draw_sequence(tmp_path / "frames")
    movie_path, cache = tmp_path / "shot.mp4", tmp_path / "cache"
    make_movie(movie_path, sorted(first.parent.iterdir())[:2])
    preferences = addon("blender.preferences").preferences()
    preferences.cache_folder = str(cache)
    bpy.ops.rototoon.setup(filepath=str(movie_path))
    preferences.cache_folder = ""
    blend = tmp_path / "shot.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    folder = next(cache.iterdir())
    os.utime(folder, (1_000_000, 1_000_000))
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    assert folder.stat().st_mtime > 1_000_000


def test_work_on_a_movie_marks_it_as_used(addon, fake, movie_shot, tmp_path):
    """A file may be open for days; another Blender that shares the cache must not remove its pictures meanwhile."""
    shots.draw(addon, movie_shot, 1, [shots.diamond(0)])
    shots.draw(addon, movie_shot, 9, [shots.diamond(8)])
    folder = next((tmp_path / "cache").iterdir())
    blend = str(tmp_path / "shot.blend")
    for work in (bpy.ops.rototoon.track, lambda: bpy.ops.wm.save_as_mainfile(filepath=blend)):
        os.utime(folder, (1_000_000, 1_000_000))
        assert work() == {"FINISHED"}
        noted = folder.stat().st_mtime_ns
        assert noted > 1_000_000 * 10**9
        bpy.ops.wm.save_as_mainfile(filepath=blend)
        assert folder.stat().st_mtime_ns == noted, "once an hour is enough"


def test_a_scene_with_other_footage_keeps_its_size_and_says_so(addon, tmp_path):
    shots.set_up(tmp_path)
    shots.write_png(tmp_path / "wide_1.png", np.zeros((80, 200, 3), np.uint8))
    reports = addon("common.reports")
    said = reports.take()[-1].text
    assert "the scene keeps" not in said
    bpy.ops.rototoon.setup(filepath=str(tmp_path / "wide_1.png"))
    width, height = shots.SIZE
    assert f"; the scene keeps its {width}x{height}, since other footage uses it" in reports.take()[-1].text
    assert (bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y) == (width, height)
    bpy.ops.rototoon.setup(filepath=str(tmp_path / "wide_1.png"), match_scene=False)
    assert "the scene keeps" not in reports.take()[-1].text


def test_the_place_of_footage_in_the_background_is_known_though_it_is_not_shown(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    placement, data = addon("blender.placement"), bpy.context.scene.camera.data
    entry = data.background_images[0]
    entry.scale, entry.offset = 0.8, (0.05, 0.02)

    def corner():
        return placement.Mapper(ob, [1], {}, ["Contours"]).at(0, 1).to_layer(np.array([[0.0, 0.0]]))[0]

    expected = corner()
    entry.show_background_image = False
    assert np.allclose(corner(), expected)
    # A still of the layout before the footage in the list.
    layout = bpy.data.images.new("layout", 8, 8)
    layout.filepath_raw, layout.file_format = str(tmp_path / "layout.png"), "PNG"
    layout.save()
    more = data.background_images.new()
    entry.show_background_image = True
    more.image, entry.image = entry.image, bpy.data.images.load(layout.filepath_raw)
    more.scale, more.offset, entry.scale, entry.offset = 0.8, (0.05, 0.02), 1.0, (0.0, 0.0)
    assert np.allclose(corner(), expected)
    # Of two that have the footage, the one that is shown counts.
    entry.image, entry.show_background_image = more.image, False
    assert np.allclose(corner(), expected)
