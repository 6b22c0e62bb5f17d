"""What an operator tells the artist when it cannot go on."""


class Problem(Exception):
    """A message for the artist: what was found, what was expected, what to do. Nothing was changed."""
