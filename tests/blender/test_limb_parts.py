"""Which parts a limb carries, by the lines across it."""

import numpy as np
import shots
from test_bodies import lying


def limbs_of(addon, ob, parts, lines):
    """By its end the parts that each limb carries. Lines are given by the place of the joint along the arm."""
    contours = [points for _, points in parts]
    shots.draw(addon, ob, 1, contours)
    for point, part, at in lines:
        # Across the arm at this place: a point on each side of the part.
        low, high = contours[part][:4], contours[part][4:][::-1]
        share = (at - low[0, 0]) / (low[-1, 0] - low[0, 0]) * 3
        shots.limb_line(addon, ob, contours, (part, share, 7 - share), point)
        assert low[0, 0] <= at <= high[-1, 0]
    return {limb["to"]: limb for limb in addon("style.limbs").defined(ob)}


ARM = [
    ("body", lying(10, 42, 44, 16)),
    ("upper", lying(38, 74, 44, 5)),
    ("fore", lying(68, 106, 44, 4.6)),
    ("hand", lying(102, 118, 44, 4.2)),
]


def carried(limb):
    """The parts that a limb carries, also by default."""
    return limb.get("carries") or list(dict.fromkeys(limb[end]["points"][0]["part"] for end in ("start", "end")))


def test_a_limb_carries_what_lies_between_its_lines_and_what_hangs_on_its_end(addon, library, tmp_path):
    # At the elbow and at the wrist two parts overlap, and the lines may lie on either of them.
    for elbow, wrist in [(1, 2), (2, 3), (1, 3), (2, 2)]:
        folder = tmp_path / f"{elbow}{wrist}"
        folder.mkdir()
        ob = shots.set_up(folder)
        lines = [("pelvis", 0, 14.0), ("chest", 0, 34.0), ("r_shoulder", 1, 40.0), ("r_elbow", elbow, 71.0), ("r_wrist", wrist, 104.0)]
        found = limbs_of(addon, ob, ARM, lines)
        names = [part["name"] for part in addon("capture.document").read(ob).document["parts"]]
        named = {end: [names.index(part) for part in carried(limb)] for end, limb in found.items()}
        assert named["r_elbow"] == [1], (elbow, wrist, named)
        assert named["r_wrist"] == [2, 3], (elbow, wrist, named)
        assert named["r_shoulder"] == [0]


def test_a_way_outside_of_all_parts_says_nothing(addon):
    carried = addon("style.carried")
    part = {"name": "arm", "closed": True, "keys": {"1": lying(10, 40, 20, 4).tolist()}}
    way = lambda y: carried.Way(1, np.array([12.0, y]), np.array([38.0, y]), 8.0, True)  # noqa: E731
    assert carried.of([way(20.0), way(60.0), None], [part]) == [["arm"], [], []]
