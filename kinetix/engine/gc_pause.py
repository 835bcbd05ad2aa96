"""The garbage collector, held back while a program is traced and lowered.

Both make hundreds of thousands of objects and next to no garbage; looking for it takes up to a
third of their time.
"""

import gc
from collections.abc import Callable
from typing import Final

from kinetix.shared_setting import Meanwhile


def _off() -> Callable[[], None]:
    before = gc.isenabled()
    gc.disable()
    return gc.enable if before else gc.disable


uncollected: Final = Meanwhile(_off)
"""Collect no garbage."""
