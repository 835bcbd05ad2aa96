"""Plans: one multi-discrete action per environment step, with controls held as a player would."""

from typing import Any, Final

import numpy as np
from jaxtyping import Int

from kinetix.level.model import MOTOR_BINDINGS, THRUSTER_BINDINGS

Plans = Int[np.ndarray, "n k 6"]
"""One multi-discrete action per plan and environment step."""

HOLD: Final = (2, 48)
"""Fewest and most environment steps for which a control is held (1/30 s each)."""


def random_plans(
    random: np.random.Generator, count: int, steps: int, channels: tuple[int, ...]
) -> Plans:
    """Plans that hold a random value of each used control for a random while."""
    plans = np.zeros((count, steps, MOTOR_BINDINGS + THRUSTER_BINDINGS), np.int32)
    for channel in channels:
        values = 3 if channel < MOTOR_BINDINGS else 2
        # Each plan has its own tempo, so that both taps and long holds are tried.
        longest = random.integers(HOLD[0] + 1, HOLD[1] + 1, (count, 1))
        holds = random.integers(HOLD[0], longest + 1, (count, steps // HOLD[0] + 1))
        segment = np.array([np.repeat(np.arange(h.size), h)[:steps] for h in holds])
        drawn = random.integers(0, values, holds.shape)
        plans[:, :, channel] = np.take_along_axis(drawn, segment, axis=1)
    return plans


def runs_of(actions: Int[np.ndarray, "k 6"]) -> tuple[tuple[int, Any], ...]:
    """Run-length encoding of an action sequence, as a solution records it."""
    changes = np.flatnonzero(np.any(np.diff(actions, axis=0) != 0, axis=1)) + 1
    pieces = np.split(actions, changes)
    return tuple((len(piece), tuple(int(value) for value in piece[0])) for piece in pieces)
