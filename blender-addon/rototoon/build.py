"""Which build of the Python package this is. The packer writes the version in the place of the word."""

BUILD = "source"
