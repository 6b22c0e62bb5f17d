"""Paint: the regions of line drawings filled with colours, on every frame.

An artist fills regions of a drawing, with Paint Bucket or with Blender's own Fill tool. Each filled shape of the artist is a click of a
painter. The library paints the regions of all other frames. Their strokes are marked as generated; what the artist made or changed is
never written. Each region is one closed stroke: its outline, joined with those of its holes.

====================  ==============================================================================
`properties`          what a file keeps of an object's paint
`shapes`              outlines with holes as one stroke, and places well inside of shapes
`sheets`              the drawings of the layer with paint: the artist's shapes, and generated ones
`clicks`              the artist's shapes as clicks
`painted`             regions as strokes
`plan`                what one run asks the library
`filling`             one run: paints in a thread, writes
`given`               clicks and regions of a document
`bucket`              one click with the bucket
`recolours`           materials that become others on some frames
`palette`             colours of a document's palette, painted with or not
`doubts`              which regions are in doubt, and where
====================  ==============================================================================

May import: `rototoon`, `blender`, `common`, `lines`, `tween`.
"""
