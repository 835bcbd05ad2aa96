"""The environment in the form of Gymnasium, one level at a time or a batch (extra `gymnasium`).

`gymnasium.make("Kinetix/s-random-v0")` and `gymnasium.make("Kinetix/level-v0", level="m/leapfrog")`
make the first, `gymnasium.make_vec(…, num_envs=64)` the second, once this package is imported.
"""

from typing import TYPE_CHECKING

from kinetix.gymnasium.registration import register_envs
from kinetix.lazy import lazy_names

if TYPE_CHECKING:
    from kinetix.gymnasium.env import KinetixGymEnv
    from kinetix.gymnasium.vector import KinetixVectorEnv

_HOME = {
    "KinetixGymEnv": "kinetix.gymnasium.env",
    "KinetixVectorEnv": "kinetix.gymnasium.vector",
    "register_envs": "kinetix.gymnasium.registration",
}

__all__ = ["KinetixGymEnv", "KinetixVectorEnv", "register_envs"]

register_envs()

__getattr__, __dir__ = lazy_names(__name__, _HOME)
