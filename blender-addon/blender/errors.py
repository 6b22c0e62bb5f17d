"""The error that an operator shows to the artist."""


class Problem(Exception):
    """A message for the artist: what was found, what was expected, what to do. Nothing has changed."""


class Changed(Problem):
    """The drawings changed while they were read or written in steps. What was written before is a part of the result."""

    def __init__(self):
        super().__init__("The drawings changed meanwhile: do it again")
