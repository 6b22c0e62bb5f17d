"""Strokes: tools for any drawing. `fitting` is Fit Strokes, `hidden` is Remove Hidden Lines.

May import: `rototoon`, `blender`, `common`.
"""
