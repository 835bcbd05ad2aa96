"""Keys that drive motors and thrusters."""

import dataclasses
from collections.abc import Collection, Mapping
from typing import Final

from kinetix.level.controls import names_driven_by
from kinetix.level.model import MOTOR_BINDINGS, THRUSTER_BINDINGS, Level

CHANNELS: Final = MOTOR_BINDINGS + THRUSTER_BINDINGS
CHANNEL_NAMES: Final = (
    *(f"motor {k}" for k in range(MOTOR_BINDINGS)),
    *(f"thruster {k}" for k in range(THRUSTER_BINDINGS)),
)
"""Names of the channels on the screen."""
NOOP: Final[tuple[int, ...]] = (0,) * CHANNELS


@dataclasses.dataclass(frozen=True, kw_only=True)
class Drive:
    """Effect of a key while it is held."""

    channel: int
    """0–3: motor bindings, 4–5: thruster bindings."""
    value: int
    """Motors: 1 turns forward (+1), 2 backward (−1); thrusters: 1."""


DEFAULT_KEYS: Final[Mapping[str, Drive]] = {
    "left": Drive(channel=0, value=1),
    "right": Drive(channel=0, value=2),
    "up": Drive(channel=1, value=1),
    "down": Drive(channel=1, value=2),
    "w": Drive(channel=2, value=1),
    "s": Drive(channel=2, value=2),
    "a": Drive(channel=3, value=1),
    "d": Drive(channel=3, value=2),
    "1": Drive(channel=4, value=1),
    "2": Drive(channel=5, value=1),
}
"""The first key of each pair drives its motors at +1."""

PAD: Final[Mapping[str, Drive]] = {
    "pad left": Drive(channel=0, value=1),
    "pad right": Drive(channel=0, value=2),
    "pad up": Drive(channel=1, value=1),
    "pad down": Drive(channel=1, value=2),
    "pad right-stick up": Drive(channel=2, value=1),
    "pad right-stick down": Drive(channel=2, value=2),
    "pad right-stick left": Drive(channel=3, value=1),
    "pad right-stick right": Drive(channel=3, value=2),
    "pad a": Drive(channel=4, value=1),
    "pad b": Drive(channel=5, value=1),
}
"""Controls of a gamepad: sticks drive motors, as arrows and letters do; A and B the thrusters."""
PAD_ACTIONS: Final[Mapping[str, str]] = {
    "pad start": "run.pause",
    "pad back": "run.stop",
    "pad y": "run.reset",
}
"""Other functions of a gamepad in Play; Start begins it."""
PAD_NAMES: Final = frozenset({*PAD, *PAD_ACTIONS})
"""Controls of a gamepad that mean something."""

GLYPHS: Final = {"left": "←", "right": "→", "up": "↑", "down": "↓"}
"""Keys that have a sign instead of a letter."""


def action_of(held: Collection[str], keys: Mapping[str, Drive] = DEFAULT_KEYS) -> tuple[int, ...]:
    """Return the multi-discrete action of the held keys; opposite keys of one motor cancel.

    Args:
        held: Names of the keys that are down.
        keys: What each key does.

    Returns:
        Four motor channels in {0, 1, 2} and two thruster channels in {0, 1}.
    """
    wanted: dict[int, set[int]] = {}
    for key, drive in keys.items():
        if key in held:
            wanted.setdefault(drive.channel, set()).add(drive.value)
    values = [wanted.get(channel, set()) for channel in range(CHANNELS)]
    return tuple(next(iter(value)) if len(value) == 1 else 0 for value in values)


def channel_name(level: Level, channel: int) -> str:
    """Return what a channel is called: by the names of what it drives, or by its number."""
    names = names_driven_by(level, channel)
    return ", ".join(names) if names else CHANNEL_NAMES[channel]


def key_caps(channel: int, keys: Mapping[str, Drive] = DEFAULT_KEYS) -> tuple[str, ...]:
    """Return the labels on the key caps of a channel, the forward key first: `("←", "→")`."""
    driving = sorted((d.value, key) for key, d in keys.items() if d.channel == channel)
    return tuple(GLYPHS.get(key, key.upper()) for _, key in driving)
