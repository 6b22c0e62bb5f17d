"""Where scene frames of the old footage are in the new one."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

from rototoon import Conformed

from ..blender.errors import Problem


@dataclass(frozen=True)
class Pictures:
    """The numbers of the pictures of a footage. The scene shows picture n on frame n + offset."""

    first: int
    last: int
    offset: int


class Times:
    """The map of scene frames. Everything that is asked and answered is a scene frame."""

    def __init__(self, found: Conformed, old: Pictures, offset: int):
        """`offset` is that of the new footage."""
        self._old, self._offset = old, offset
        self._went = {picture + old.offset: new + offset for picture, new in found.went.items()}
        self._own = {picture + old.offset for picture in [*found.same.values(), *found.redrawn.values()]}
        self._shown: dict[int, list[int]] = {}
        for new, picture in found.same.items():
            self._shown.setdefault(picture + old.offset, []).append(new + offset)
        self.redrawn = {new + offset for new in found.redrawn}
        """New frames whose drawing was drawn again."""
        self.new = [new + offset for new in found.new]
        """New frames with a drawing that the old footage does not have."""
        self.gone = [picture + old.offset for picture in found.gone]
        """Old frames whose drawing is gone."""
        self.shift = offset - stay(found, old)
        """By how many frames most drawings move."""

    def went(self, frame: int) -> int | None:
        """Where the artist's work on an old frame goes; `None` if its drawing is gone. Beyond the footage it goes along with the nearest picture."""
        first, last = self._old.first + self._old.offset, self._old.last + self._old.offset
        if first <= frame <= last:
            return self._went.get(frame)
        end = min(self._went) if frame < first else max(self._went)
        return self._went[end] + frame - end

    def went_while(self, frame: int, before: int | None) -> list[int]:
        """Where the artist's work on an old frame may go that is shown until the frame `before`, or to the end of the footage: first where its own
        picture is, then where the pictures are on which it is held, rising."""
        own, last = self.went(frame), self._old.last + self._old.offset
        held = range(max(frame + 1, self._old.first + self._old.offset), min(last + 1, last + 1 if before is None else before))
        others = {new for each in held if (new := self.went(each)) is not None}
        return [*([] if own is None else [own]), *sorted(others - {own})]

    def has_own(self, frame: int) -> bool:
        """Whether an old frame goes to a frame of its own, and not to another one that shows the same drawing."""
        return frame in self._own or not self._old.first <= frame - self._old.offset <= self._old.last

    def shown(self, frame: int) -> list[int]:
        """The new frames that show the drawing of an old frame as it was, rising."""
        if self._old.first <= frame - self._old.offset <= self._old.last:
            return self._shown.get(frame, [])
        return [self.went(frame)]

    def picture(self, number: int) -> int | None:
        """The number of the new picture for what was kept for an old one."""
        found = self.went(number + self._old.offset)
        return None if found is None else found - self._offset

    @property
    def moves(self) -> bool:
        """Whether any drawing gets another frame."""
        return any(old != new for old, new in self._went.items())


def stay(found: Conformed, old: Pictures) -> int:
    """The offset of the new footage with which most drawings stay on their scene frames. Of several the least change."""
    pairs = found.same or found.redrawn
    if not pairs:
        raise Problem("No picture of the new footage stands for one of the old footage: look at the numbers of both, and at Frame Offset")
    wanted = Counter(picture + old.offset - new for new, picture in pairs.items())
    return min(wanted, key=lambda offset: (-wanted[offset], abs(offset - old.offset), offset))
