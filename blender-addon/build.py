"""Which build of Rototoon this is. The packer writes the version in the place of the word."""

BUILD = "source"
