"""Errors as scripts get them: `RuntimeError`, with the texts that operators report."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

import bpy
from rototoon import Cancelled, RototoonError

from ..blender import grease_pencil as gp
from ..blender import guard
from ..blender.errors import Problem
from ..common.operators import OnDrawing

P = ParamSpec("P")
R = TypeVar("R")


def told(function: Callable[P, R]) -> Callable[P, R]:
    """Makes a `Problem`, `RototoonError` or `Cancelled` a `RuntimeError` with the same text."""

    @functools.wraps(function)
    def call(*args: P.args, **options: P.kwargs) -> R:
        try:
            return function(*args, **options)
        except (Cancelled, Problem, RototoonError) as problem:
            raise RuntimeError(str(problem)) from problem

    return call


def need(ob: Any, kind: type[OnDrawing], changes: str = guard.DRAWINGS) -> None:
    """Raises a `Problem` where an operator of this kind would not be available for the object."""
    why = kind.lacking(ob, changes)
    if not why and gp.is_drawing(ob) and ob.name not in bpy.context.scene.objects:
        why = f'"{ob.name}" is not in the scene "{bpy.context.scene.name}": make its scene the current one'
    if why:
        raise Problem(why)
    if gp.is_drawing(ob):
        guard.need(ob, changes)
    # Blender does the same before it runs an operator: what the script has moved is where it put it.
    bpy.context.view_layer.update()
