"""Lines: line drawings as strokes, the same strokes on every frame.

A stroke carries its number on all frames (`rototoon_track`). Traced frames have the keyframe type "Generated". All other frames are
the artist's and are never written; their strokes are followed.

====================  ==============================================================================
`records`             checksums of traced drawings: they show what the artist has changed since
`moved`               the same records, of drawings that were moved in time
`older_files`         marks for the generated drawings of files of older versions
`drawings`            the drawings of a layer: the artist's, and traced ones
`numbers`             numbers of strokes, from the library's to those of the layers
`choosing`            the layers of a run
`plane`               the plane on which they are drawn
`plan`                which drawings are followed, which frames are traced, as documents
`looks`               material, radius and opacity of strokes
`tracing`             one run: reads, traces in a thread, writes
`run`                 Trace Drawing and Carry Strokes as one run, for operators and scripts
`given`               drawings that a document gives, as a layer
`off_ink`             drawings of the artist whose picture was drawn anew
`explained`           new strokes on lines that another group of layers follows
`doubts`              which traced strokes are in doubt, and where
`aside`               hidden lines of traced drawings, on a layer of their own
`accepting`           doubtful strokes that the artist finds right
`spreading`           an edit of one drawing, done on all frames
`rototoon_changes`    traced strokes that Rototoon itself fits or cuts
`pairing`             the same strokes of two neighbouring drawings, and clicks that change them
`outline`             strokes that bound a part, as a closed contour
====================  ==============================================================================

May import: `rototoon`, `blender`, `common`, `capture`, `tween`.
"""
