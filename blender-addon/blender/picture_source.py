"""The picture of a drawing and its place in the scene: an image empty, a plane with an image texture, or the drawing's
footage."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from . import camera as cameras
from . import footage, placement, world
from . import grease_pencil as gp
from .errors import Problem


@dataclass
class Source:
    """A picture in the scene."""

    matrix: np.ndarray
    """4×4: the picture's space to the world."""
    mapping: cameras.Mapping
    """Footage pixels ↔ points in the picture's space."""
    uv: np.ndarray
    """4×2: (x, y, z, 1) in the picture's space to texture coordinates."""
    material: bpy.types.Material | None
    image: bpy.types.Image
    ob: bpy.types.Object | None

    @property
    def towards(self) -> np.ndarray:
        """The picture's normal, towards the viewer."""
        normal = self.mapping.normal / np.linalg.norm(self.mapping.normal)
        return normal * (np.sign(normal @ self.mapping.from_view[:3, 2]) or 1.0)


def of(ob, picture: bpy.types.Object | None, frame: int) -> Source:
    """The picture of a drawing on a frame: that of the object `picture`, or the footage."""
    if picture is None:
        return _of_footage(ob, frame)
    if picture.type == "EMPTY" and picture.empty_display_type == "IMAGE" and picture.data is not None:
        return _of_empty(ob, picture)
    if picture.type == "MESH":
        return _of_plane(ob, picture)
    raise Problem(f'"{picture.name}" shows no picture: expected an image empty, or a plane with an image texture')


def _of_footage(ob, frame: int) -> Source:
    settings = ob.rototoon
    path = footage.picture(footage.pattern_of(ob), frame - settings.frame_offset)
    image = _still(path)
    layer = gp.layers(ob, settings.contours_layer)[0]
    mapping = placement.Mapper(ob, [frame], {}, [layer.name]).at(0, frame)
    size = np.array([settings.width, settings.height], np.float64)
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float64)
    uv = _fitted(mapping.to_layer(corners * size), np.stack([corners[:, 0], 1 - corners[:, 1]], 1))
    return Source(cameras.layer_to_world(ob, layer), mapping, uv, None, image, None)


def _still(path: str) -> bpy.types.Image:
    """One picture of the footage as an image of its own. The footage's image changes with the scene's frame."""
    for image in bpy.data.images:
        if image.source == "FILE" and image.filepath and bpy.path.abspath(image.filepath) == path:
            return image
    try:
        return bpy.data.images.load(path, check_existing=False)
    except RuntimeError as error:
        raise Problem(f"{path}: {error}") from error


def _of_empty(ob, empty) -> Source:
    width, height = empty.data.size
    if not width or not height:
        raise Problem(f'The image of "{empty.name}" cannot be read')
    own = cameras.reference_view(empty, width, height).to_pixel
    uv = np.zeros((4, 2))
    uv[[0, 1, 3], 0] = own[0] / width
    uv[[0, 1, 3], 1] = -own[1] / height
    uv[3, 1] += 1
    plane = np.zeros(3), np.array([0.0, 0.0, 1.0])
    return _seen(ob, empty, plane, uv, None, empty.data)


def _of_plane(ob, mesh) -> Source:
    layer = mesh.data.uv_layers.active
    material, image = _texture(mesh)
    if layer is None or not mesh.data.polygons or image is None:
        raise Problem(f'"{mesh.name}" has no image texture: expected a plane with texture coordinates and an image in its material')
    loops = np.zeros(2 * len(mesh.data.loops), np.float32)
    layer.uv.foreach_get("vector", loops)
    corners = np.array([mesh.data.vertices[loop.vertex_index].co for loop in mesh.data.loops], np.float64)
    normal = np.array(mesh.data.polygons[0].normal, np.float64)
    middle = corners.mean(0)
    if np.abs((corners - middle) @ normal).max() > 1e-3 * np.ptp(corners, axis=0).max():
        raise Problem(f'"{mesh.name}" is not flat: expected a plane')
    return _seen(ob, mesh, (middle, normal), _fitted(corners, loops.reshape(-1, 2)), material, image)


def _seen(ob, picture, plane, uv, material, image) -> Source:
    matrix = np.array(world.matrix_of(picture), np.float64)
    return Source(matrix, cameras.Mapping(placement.view_of(ob), matrix, plane), uv, material, image, picture)


def _fitted(points: np.ndarray, uv: np.ndarray) -> np.ndarray:
    """The affine map from points to texture coordinates."""
    return np.linalg.lstsq(np.column_stack([points, np.ones(len(points))]), uv.astype(np.float64), rcond=None)[0]


def _texture(mesh):
    for material in mesh.data.materials:
        tree = material.node_tree if material is not None else None
        for node in tree.nodes if tree is not None else ():
            if node.bl_idname == "ShaderNodeTexImage" and node.image is not None:
                return material, node.image
    return None, None


def shadeless(image: bpy.types.Image) -> bpy.types.Material:
    """A material that shows an image in its own colours, without shading, and transparent where the image is."""
    material = bpy.data.materials.new(image.name)
    if not material.node_tree:
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    texture, light, clear, mix, output = (
        tree.nodes.new(f"ShaderNode{kind}")
        for kind in ("TexImage", "Emission", "BsdfTransparent", "MixShader", "OutputMaterial")
    )
    texture.image = image
    tree.links.new(texture.outputs["Color"], light.inputs["Color"])
    tree.links.new(texture.outputs["Alpha"], mix.inputs[0])
    tree.links.new(clear.outputs[0], mix.inputs[1])
    tree.links.new(light.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    return material
