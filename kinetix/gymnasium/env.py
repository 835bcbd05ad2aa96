"""One level at a time, for Gymnasium."""

import dataclasses
from collections.abc import Mapping
from typing import Any

import gymnasium
import jax

from kinetix.environment.env import KinetixEnv
from kinetix.environment.named import (
    FIRST_LEVEL,
    Levels,
    level_names,
    make_named_env,
    one_by_one,
)
from kinetix.environment.reset import level_state, static_env_params_with_level
from kinetix.errors import KinetixError
from kinetix.gymnasium.checks import (
    check_fits,
    check_render_mode,
    check_render_size,
    checked_options,
    checked_words,
    numbers_of,
    refuse_fork,
)
from kinetix.gymnasium.convert import gymnasium_space, numpy_observation
from kinetix.gymnasium.draws import SEEDS
from kinetix.level.geometry import ARENA_WIDTH

RENDER_FPS = 30
"""Environment steps per second, at two physics steps each, before an environment is made."""


def steps_per_second(env: KinetixEnv) -> float:
    """Return how many steps of an environment a second of its world has; whole where it can be.

    Args:
        env: Whose frame skip and time step count.
    """
    rate = round(1 / (float(env.env_params.dt) * env.static_env_params.frame_skip), 3)
    return int(rate) if rate.is_integer() else rate


def with_pictures(env: KinetixEnv, size: int | None) -> KinetixEnv:
    """Return the environment with pictures of a size; it is for drawing alone.

    Args:
        env: Whose states are drawn.
        size: Width and height [px]; None: its own.
    """
    if size is None:
        return env
    params: Any = dataclasses.replace(env.env_params, pixels_per_unit=size // int(ARENA_WIDTH))
    static: Any = dataclasses.replace(env.static_env_params, screen_dim=(size, size), downscale=1)
    return dataclasses.replace(env, env_params=params, static_env_params=static)


def drawn_levels(env: KinetixEnv, key: Any) -> Any:
    """Return the place of the level that an episode begins with.

    Args:
        env: It plays levels that have places, not random ones.
        key: What the episode begins with.
    """
    reset_fn: Any = env.reset_fn
    return reset_fn.index(key)


class KinetixGymEnv(gymnasium.Env[Any, Any]):
    """Play levels through `reset`, `step` and `render`.

    The reward is +1 when green touches blue, −1 when green touches red, plus the distance reward; a
    touch terminates the episode, the time limit truncates it. `info["solved"]` tells a win; so does
    `info["is_success"]`, of which stable-baselines3 makes its success rate. `info["level"]` is the
    place of the level in `level_names`; levels that are random or given to `reset` have none.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 (Gymnasium's own is one, too)
        "render_modes": ["rgb_array"],
        "render_fps": RENDER_FPS,
    }

    def __init__(
        self,
        level: Levels = FIRST_LEVEL,
        *,
        render_mode: str | None = None,
        render_size: int | None = None,
        **options: Any,
    ) -> None:
        """Make the environment.

        Args:
            level: A level, its file, or the name of a bundled one; `s-random`, `m-random`,
                `l-random`; or several: a folder, a level set, a list of levels.
            render_mode: `rgb_array`, or None.
            render_size: Width and height of pictures [px]; multiples of 5 are filled to the edge.
                None: 125, as agents see them.
            **options: `action_type`, `observation_type`, `physics`, `dense_reward_scale`,
                `frame_skip`; see `kinetix.environment.named.make_named_env`.

        Raises:
            KinetixError: A word is unknown; the message lists those that are known. Or the process
                was forked from one in which JAX runs.
        """
        refuse_fork()
        check_render_mode(render_mode, self.metadata["render_modes"])
        check_render_size(render_size)
        self.render_mode = render_mode
        self.render_size = render_size
        words, levels = checked_words(options), one_by_one(level)
        self.level_names = level_names(levels)
        self.kinetix_env = make_named_env(levels, auto_reset=False, **words)
        # Wrappers that film and show it go by this.
        self.metadata = {**self.metadata, "render_fps": steps_per_second(self.kinetix_env)}
        self.action_space = gymnasium_space(self.kinetix_env.action_space())
        self.observation_space = gymnasium_space(self.kinetix_env.observation_space())
        self._state: Any = None
        self._level: dict[str, Any] = {}
        self._over = False

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Start an episode.

        Args:
            seed: Draws this level and all later ones.
            options: `{"level": …}`: a level of the same size instead of a drawn one. The step is
                recompiled where it has what the environment's own levels lack.

        Raises:
            KinetixError: An option is unknown, the level does not fit, or the process was forked
                since the environment was made.
        """
        refuse_fork()
        level = checked_options(options, "level").get("level")
        super().reset(seed=seed)
        key = jax.random.key(int(self.np_random.integers(SEEDS)))
        override = None
        if level is not None:
            static = static_env_params_with_level(level, self.kinetix_env.static_env_params)
            self.kinetix_env = dataclasses.replace(self.kinetix_env, static_env_params=static)
            override = level_state(level, static)
        observation, self._state = self.kinetix_env.reset(key, None, override)
        self._over = False
        drawn = override is None and self.level_names
        self._level = {"level": int(drawn_levels(self.kinetix_env, key))} if drawn else {}
        return numpy_observation(observation), self._level.copy()

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Play one action."""
        refuse_fork()
        if self._state is None:
            raise KinetixError("step: call reset first")
        if self._over:
            gymnasium.logger.warn("step: the episode is over, and rewards repeat; call reset")
        numbers = numbers_of(action)
        check_fits(numbers, self.action_space)
        observation, self._state, reward, done, info = self.kinetix_env.step(
            _NO_KEY, self._state, numbers
        )
        truncated = bool(info["truncated"])
        self._over = bool(done)
        return (
            numpy_observation(observation),
            float(reward),
            bool(done) and not truncated,
            truncated,
            _plain(info) | self._level,
        )

    def render(self) -> Any:
        """Return the picture, (height, width, 3); None without a render mode."""
        if self.render_mode is None or self._state is None:
            return None
        return with_pictures(self.kinetix_env, self.render_size).render(self._state)


_NO_KEY = jax.random.key(0)
"""Without auto-reset a step draws nothing."""


def _plain(info: Mapping[str, Any]) -> dict[str, Any]:
    """Return the info of a step as Python numbers."""
    return {
        "solved": bool(info["GoalR"]),
        "is_success": bool(info["GoalR"]),
        "distance": float(info["distance"]),
        "nan": bool(info["nan"]),
        "overflow": bool(info["overflow"]),
    }
