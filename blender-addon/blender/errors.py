"""The error that an operator shows to the artist."""


class Problem(Exception):
    """A message for the artist: what was found, what was expected, what to do. Nothing has changed."""
