"""Pictures that are cut along a drawing's contours and follow a clip: the footage, an image empty, a plane with a texture."""

import math

import bpy
import numpy as np
import pytest
import shots
from mathutils import Matrix
from test_style import figure, performer, second_drawing


@pytest.fixture(autouse=True)
def needs_library(library):
    """All tests here."""


def doll(addon, tmp_path):
    """A library with a walk, and a drawing with limbs."""
    shelf = str(tmp_path / "clips")
    folder = tmp_path / "performer"
    folder.mkdir()
    performer(addon, folder)
    assert bpy.ops.rototoon.save_clip(character="plain", motion="walk", folder=shelf) == {"FINISHED"}
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    ob = second_drawing(addon, tmp_path, shelf)
    names = [part.name for part in ob.rototoon.parts]
    bpy.ops.rototoon.depth_mark(front=names[2], behind=names[1])
    bpy.ops.rototoon.depth_mark(front=names[1], behind=names[0])
    return ob


def shown(addon, ob, mesh, frame):
    """The mesh's vertices on a frame in pixels of the footage, in the world, and by part."""
    bpy.context.scene.frame_set(frame)
    found = mesh.evaluated_get(bpy.context.evaluated_depsgraph_get())
    local = np.array([vertex.co for vertex in found.data.vertices], np.float64)
    matrix = np.array(mesh.matrix_world)
    world = local @ matrix[:3, :3].T + matrix[:3, 3]
    cameras, placement = addon("blender.camera"), addon("blender.placement")
    parts = np.zeros(len(local), np.int32)
    mesh.data.attributes["rototoon_part"].data.foreach_get("value", parts)
    return cameras.Mapping(placement.view_of(ob), np.eye(4)).to_pixels(world), world, parts


def coordinates(mesh):
    """Texture coordinates by vertex."""
    found = np.zeros((len(mesh.data.vertices), 2))
    for loop, uv in zip(mesh.data.loops, mesh.data.uv_layers.active.uv):
        found[loop.vertex_index] = uv.vector
    return found


def reshaped(**settings):
    assert bpy.ops.rototoon.reshape_picture(character="plain", motion="walk", **settings) == {"FINISHED"}
    return next(ob for ob in bpy.data.objects if ob.type == "MESH" and ob.data.shape_keys)


def test_the_footage_follows_as_the_contours_do(addon, tmp_path):
    ob = doll(addon, tmp_path)
    before = shots.snapshot(ob)
    mesh = reshaped(border=0.0)
    assert shots.snapshot(ob) == before, "the drawing stays"
    image = next(n.image for n in mesh.data.materials[0].node_tree.nodes if n.bl_idname == "ShaderNodeTexImage")
    assert image.source == "FILE" and image.name.startswith("shot_001"), "a still picture, not the running footage"
    assert bpy.ops.rototoon.reshape_drawing(character="plain", motion="walk") == {"FINISHED"}
    for frame in (1, 2, 5, shots.COUNT + 1):
        seen, world, parts = shown(addon, ob, mesh, frame)
        for number, points in shots.pixels(addon, ob, frame):
            mine = seen[parts == number - 1]
            assert np.abs(mine[: len(points)] - points).max() < 0.02, (frame, number)
            assert len(mine) > len(points) + 5
        # Nearer parts are nearer to the camera: the arm, the body, the leg.
        away = [world[parts == part, 1].mean() for part in (0, 1, 2)]
        assert away[2] < away[1] < away[0]
    rest, _, _ = shown(addon, ob, mesh, 1)
    width, height = shots.SIZE
    assert coordinates(mesh) == pytest.approx(np.stack([rest[:, 0] / width, 1 - rest[:, 1] / height], 1), abs=1e-4)
    triangles = np.array([polygon.vertices[:] for polygon in mesh.data.polygons])
    a, b, c = (rest[triangles[:, k]] for k in range(3))
    area = lambda ring: abs(np.sum(ring[:, 0] * np.roll(ring[:, 1], -1) - np.roll(ring[:, 0], -1) * ring[:, 1])) / 2  # noqa: E731
    covered = np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]).sum() / 2
    assert covered == pytest.approx(sum(area(ring) for ring in figure()), rel=1e-3)


def test_between_frames_shapes_blend(addon, tmp_path):
    ob = doll(addon, tmp_path)
    mesh = reshaped()
    at = lambda frame, sub=0.0: (bpy.context.scene.frame_set(frame, subframe=sub), shown_now(mesh))[1]  # noqa: E731
    assert at(4, 0.5) == pytest.approx((at(4) + at(5)) / 2, abs=1e-4)
    assert not np.allclose(at(4), at(5), atol=1e-3)
    held, last = at(40), at(shots.COUNT + 1)
    assert held == pytest.approx(last, abs=1e-6)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "shot.blend"))
    again = bpy.data.objects[f"{bpy.context.object.name} walk"]
    bpy.context.scene.frame_set(shots.COUNT + 1)
    assert shown_now(again) == pytest.approx(last, abs=1e-6)


def shown_now(mesh):
    found = mesh.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return np.array([vertex.co for vertex in found.data.vertices], np.float64)


def test_an_image_empty(addon, tmp_path):
    ob = doll(addon, tmp_path)
    image = bpy.data.images.new("cut-out", 400, 200)
    empty = bpy.data.objects.new("Cut-out", None)
    bpy.context.scene.collection.objects.link(empty)
    empty.empty_display_type, empty.data = "IMAGE", image
    empty.empty_display_size, empty.empty_image_offset = 8.0, (-0.5, -0.5)
    empty.matrix_world = Matrix.Translation((0.3, 0.2, 0.1)) @ Matrix.Rotation(math.pi / 2, 4, "X")
    bpy.context.view_layer.update()
    mesh = reshaped(picture="Cut-out", border=0.0)
    assert empty.hide_render and mesh.data.materials[0].node_tree is not None
    seen, world, _ = shown(addon, ob, mesh, 1)
    ring = figure()[0]
    assert np.abs(seen[: len(ring)] - ring).max() < 0.02
    local = (np.linalg.inv(np.array(empty.matrix_world)) @ np.column_stack([world, np.ones(len(world))]).T).T
    # 8 units are 400 pixels, the image's middle is the empty's origin.
    expected = np.stack([local[:, 0] / 8 + 0.5, local[:, 1] / 4 + 0.5], 1)
    assert coordinates(mesh) == pytest.approx(expected, abs=1e-4)


def plane(name="Plane"):
    """A plane before the camera with texture coordinates and an image."""
    mesh = bpy.data.meshes.new(name)
    corners = [(-4, 0, -2), (4, 0, -2), (4, 0, 2), (-4, 0, 2)]
    mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
    layer = mesh.uv_layers.new()
    for loop, uv in enumerate(((0, 0), (1, 0), (1, 1), (0, 1))):
        layer.uv[loop].vector = uv
    ob = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(ob)
    material = bpy.data.materials.new(name)
    if not material.node_tree:
        material.use_nodes = True
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.new(name, 64, 32)
    mesh.materials.append(material)
    return ob


def test_a_plane_with_a_texture(addon, tmp_path):
    ob = doll(addon, tmp_path)
    picture = plane()
    picture.matrix_world = Matrix.Translation((0.5, 0.5, 0.25)) @ Matrix.Rotation(0.2, 4, "Z")
    bpy.context.view_layer.update()
    mesh = reshaped(picture="Plane", border=0.0, hide=False)
    assert not picture.hide_render and mesh.data.materials[0] == picture.data.materials[0]
    seen, world, _ = shown(addon, ob, mesh, 1)
    ring = figure()[0]
    assert np.abs(seen[: len(ring)] - ring).max() < 0.05
    local = (np.linalg.inv(np.array(picture.matrix_world)) @ np.column_stack([world, np.ones(len(world))]).T).T
    assert np.abs(local[:, 1]).max() < 0.02, "the pieces lie on the plane"
    assert coordinates(mesh) == pytest.approx(np.stack([local[:, 0] / 8 + 0.5, local[:, 2] / 4 + 0.5], 1), abs=1e-4)


def test_wrong_pictures_change_nothing(addon, tmp_path):
    ob = doll(addon, tmp_path)
    before, objects = shots.snapshot(ob), set(bpy.data.objects)
    bare = plane("Bare")
    bare.data.materials.clear()
    bent = plane("Bent")
    bent.data.vertices[0].co.y = 1.0
    for picture, said in (
        ("Nothing", 'no object "Nothing"'),
        ("Bare", "has no image texture"),
        ("Bent", "is not flat"),
        ("Camera", "shows no picture"),
    ):
        with pytest.raises(RuntimeError, match=said):
            bpy.ops.rototoon.reshape_picture(character="plain", motion="walk", picture=picture)
    assert shots.snapshot(ob) == before and set(bpy.data.objects) == objects | {bare, bent}


def test_pieces_of_odd_contours(addon):
    pieces = addon("style.picture_pieces")
    ring = np.array([[0, 0], [40, 0], [40, 40], [20, 10], [0, 40]], float)
    made = pieces.triangulated("crown", ring)
    assert np.allclose(made.points[:5], ring) and made.triangles.max() < len(made.points)
    eight = np.array([[0, 0], [30, 30], [30, 0], [0, 30]], float)
    made = pieces.triangulated("eight", eight)
    assert np.allclose(made.points[:4], eight) and len(made.triangles) > 2
    wide = pieces.widened(np.array([[0, 0], [10, 0], [10, 10], [0, 10]], float), 2.0)
    assert wide.min() == pytest.approx(-math.sqrt(2)) and wide.max() == pytest.approx(10 + math.sqrt(2))
    assert pieces.widened(wide[::-1], 2.0).min() < wide.min(), "outward whichever way it is drawn"
    with pytest.raises(addon("blender.errors").Problem, match="single spot"):
        pieces.triangulated("dot", np.ones((4, 2)))


def test_undo_takes_the_mesh_back(addon, tmp_path):
    doll(addon, tmp_path)
    plane()
    bpy.context.view_layer.update()
    bpy.ops.ed.undo_push(message="before")
    settings = {"character": "plain", "motion": "walk", "picture": "Plane"}
    assert bpy.ops.rototoon.reshape_picture("EXEC_DEFAULT", True, **settings) == {"FINISHED"}
    assert any(mesh.shape_keys for mesh in bpy.data.meshes) and bpy.data.objects["Plane"].hide_render
    bpy.ops.ed.undo()
    assert not any(mesh.shape_keys for mesh in bpy.data.meshes) and not bpy.data.objects["Plane"].hide_render
