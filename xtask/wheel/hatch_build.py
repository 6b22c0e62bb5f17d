"""Names the wheel after the systems on which its native library runs.

`ROTOTOON_WHEEL_PLATFORM` is the platform tag, such as `manylinux_2_28_x86_64`, `win_amd64`, `macosx_11_0_arm64`. The library is called
through ctypes, so one wheel serves every version of Python: its tag is `py3-none-…`.
"""

import os

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class PlatformHook(BuildHookInterface):
    """Called by hatchling."""

    def initialize(self, version: str, build_data: dict) -> None:
        """Sets the tag of the wheel."""
        platform = os.environ.get("ROTOTOON_WHEEL_PLATFORM")
        if not platform:
            raise ValueError("ROTOTOON_WHEEL_PLATFORM: found nothing, expected a platform tag such as manylinux_2_28_x86_64")
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-{platform}"
