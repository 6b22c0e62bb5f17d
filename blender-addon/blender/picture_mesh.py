"""A picture that follows a clip: one mesh of all parts' pieces, with a shape key for each frame.

The shape keys are absolute. The evaluation time runs through them, one per frame, and blends between frames for motion blur and
other frame rates. Nearer parts are a little nearer to the viewer, by the depths of each frame.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix
from rototoon.documents import by_frame

from . import actions, picture_source
from .picture_source import Source

GAP = 0.0005
"""Distance from one part to the next, as a share of the picture's size."""


@dataclass
class Piece:
    """A part's mesh at rest."""

    part: str
    points: np.ndarray
    """Pixels (N, 2). The contour's points come first."""
    triangles: np.ndarray
    """Indices of points (T, 3)."""


def write(ob, source: Source, pieces: list[Piece], made, frame: int, name: str) -> bpy.types.Object:
    """Makes the mesh. The drawing is at rest on `frame`, and the motion begins on the frame after it."""
    project = made.document
    first, count = project["footage"]["first"], len(next(iter(made.points.values())))
    rest = _coordinates(source, pieces, [piece.points for piece in pieces], _ranks(pieces, project, first))
    mesh = _mesh(source, pieces, rest, name)
    result = bpy.data.objects.new(name, mesh)
    for collection in ob.users_collection:
        collection.objects.link(result)
    result.matrix_world = Matrix(source.matrix.tolist())
    result.shape_key_add(name="Rest")
    keys = mesh.shape_keys
    keys.use_relative = False
    for k in range(count):
        points = [np.asarray(made.points[piece.part][k], np.float64) for piece in pieces]
        block = result.shape_key_add(name=f"Frame {frame + 1 + k}", from_mix=False)
        places = _coordinates(source, pieces, points, _ranks(pieces, project, first + k))
        block.data.foreach_set("co", places.astype(np.float32).ravel())
    for block in keys.key_blocks:
        block.interpolation = "KEY_LINEAR"
    times = np.array([block.frame for block in keys.key_blocks])
    actions.give(keys, "KEY", name, frame + np.arange(count + 1), {("eval_time", 0): times})
    return result


def _ranks(pieces: list[Piece], project, frame: int) -> np.ndarray:
    """For each piece the number of parts behind it on a frame."""
    entries = {part["name"]: part for part in project["parts"]}

    def depth(piece: Piece) -> float:
        entry = entries[piece.part]
        return by_frame(entry.get("depths")).get(frame, entry.get("depth", 0.0))

    order = np.argsort([depth(piece) for piece in pieces], kind="stable")
    ranks = np.empty(len(pieces))
    ranks[order] = np.arange(len(pieces))
    return ranks


def _coordinates(source: Source, pieces: list[Piece], points: list[np.ndarray], ranks: np.ndarray) -> np.ndarray:
    """Vertices in the picture's space."""
    places = source.mapping.to_layer(np.concatenate(points))
    gap = GAP * float(np.linalg.norm(np.ptp(places, axis=0)))
    return places + np.repeat(ranks * gap, [len(piece.points) for piece in pieces])[:, None] * source.towards


def _mesh(source: Source, pieces: list[Piece], rest: np.ndarray, name: str) -> bpy.types.Mesh:
    starts = np.concatenate([[0], np.cumsum([len(piece.points) for piece in pieces])])
    triangles = np.concatenate([piece.triangles + start for piece, start in zip(pieces, starts)])
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(rest.tolist(), [], triangles.tolist())
    flat = source.mapping.to_layer(np.concatenate([piece.points for piece in pieces]))
    coordinates = np.column_stack([flat, np.ones(len(flat))]) @ source.uv
    layer = mesh.uv_layers.new(name="Picture")
    corners = np.zeros(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    layer.uv.foreach_set("vector", coordinates[corners].astype(np.float32).ravel())
    group = mesh.attributes.new("rototoon_part", "INT", "POINT")
    numbers = np.repeat(np.arange(len(pieces), dtype=np.int32), np.diff(starts))
    group.data.foreach_set("value", numbers)
    mesh.materials.append(source.material or picture_source.shadeless(source.image))
    return mesh
