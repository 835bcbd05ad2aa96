"""Films of a player's episodes, moment by moment as an evaluation plays them."""

import itertools
from pathlib import Path
from typing import Final

import jax
import numpy as np
from jaxtyping import UInt8

from kinetix.agents.card import EnvironmentCard
from kinetix.agents.evaluate import NamedLevel, Settings, record
from kinetix.agents.player import Player
from kinetix.environment.state import EnvState
from kinetix.files.atomic import replacing
from kinetix.render.camera import fit_arena
from kinetix.render.film import write_film
from kinetix.render.scene import draw

TAIL: Final = 0.5
"""For how long a film's last frame stands, so that the end can be seen [s]."""

_drawing = jax.jit(draw, static_argnames=("width", "height"))


def steps_per_second(card: EnvironmentCard) -> float:
    """Return how many environment steps a second of the world has: pictures of a film."""
    return 1 / (card.dt * card.frame_skip)


def picture_of(state: EnvState, pixels: int) -> UInt8[np.ndarray, "h w 3"]:
    """Draw a state.

    Args:
        state: One state (not a batch).
        pixels: Width and height.
    """
    labels = state.labels
    picture = _drawing(
        state.world,
        state.physics,
        labels.role,
        labels.motor_binding,
        labels.thruster_binding,
        fit_arena(pixels, pixels),
        width=pixels,
        height=pixels,
    )
    return np.asarray(picture)


def film_episode(
    path: Path,
    player: Player,
    level: NamedLevel,
    settings: Settings | None = None,
    *,
    pixels: int,
    every: int = 1,
) -> None:
    """Film the first attempt of an evaluation as a GIF.

    Args:
        path: The file.
        player: Who plays.
        level: What it plays.
        settings: Of the evaluation.
        pixels: Width and height.
        every: Environment steps between two frames; the last one is always there.

    Raises:
        CheckpointError: The player cannot play the level.
        LevelError: The level is bad.
    """
    moments = record(player, level, 0, settings)
    frames = [
        picture_of(moment.state, pixels)
        for step, moment in enumerate(moments)
        if step % every == 0 or moment.result is not None
    ]
    rate = steps_per_second(player.card.environment) / every
    frames += itertools.repeat(frames[-1], round(TAIL * rate))
    with replacing(path) as file:
        write_film(file, frames, kind=".gif", per_second=rate)
