"""Conform: an object moves to footage that was delivered again.

What: a plate comes back at another size, with a border, with handles, in another grade, and with drawings added, left out, held longer or drawn
again. *Conform to New Footage* gives the active object the new footage. What the artist drew goes with its picture, results go to all frames that
show theirs, and what cannot go anywhere is named and kept on a hidden layer.

How: `comparing` lets the library compare both footages, in a thread. It gets a document with everything that Blender keeps as fields of a document
(limbs, marks of depth, times in which a part is hidden), and gives these fields for the new footage, the place of the old picture in the new one, and
what each new frame shows. `times` says the same in scene frames. `plan` decides what becomes of each drawing, and `placing` where its points lie
then; both change nothing. `writing` then does all of it, and `notes` lets the records of in-betweens, lines and holds follow. `telling` has the
texts.

Why so: the other way would be to export a document, conform it and import it again. A document has no place for materials, layers and their groups,
brushes' attributes, the artist's own attributes, curve types, hand-drawn points between control points, or layers side by side, so strokes would come
back as other strokes. Here each drawing stays the drawing that it is: its frame moves, and of its values only those change that are places or
lengths. A point keeps its distance to the plane of the drawing along its ray, so that also strokes off the plane stay what they are. Where a point is
in its place already, as where only frames have other numbers, not one bit changes. Everything that may fail comes before the first change.

Scene frames: by default most drawings stay on the scene frames that they have, and the new footage is laid under them: sound, cameras and other
objects still fit. So handles may lie before the scene's first frame.

Limits: drawings on a layer that has nothing of Rototoon stay where they are, which the report says. So does all animation. A drawing that goes to the
hidden layer loses its vertex groups. Another object with the same footage must be conformed for itself; if both look through one camera, and its
background image is not placed as Blender does by itself, give the other one the same background again before.

May import: `rototoon`, `blender`, `common`, `capture`, `lines`, `paint`, `tween`, `style`, `exchange`.
"""
