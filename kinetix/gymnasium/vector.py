"""A batch of levels in one compiled step, for Gymnasium."""

import functools
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import gymnasium
import jax
import jax.numpy as jnp
import numpy as np
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from jaxtyping import Array, Bool, Int

from kinetix.bounds import LAST_SEED
from kinetix.environment.env import KinetixEnv
from kinetix.environment.named import (
    FIRST_LEVEL,
    Levels,
    level_names,
    make_named_env,
    one_by_one,
)
from kinetix.errors import KinetixError
from kinetix.gymnasium.checks import (
    check_count,
    check_fits,
    check_render_mode,
    check_render_size,
    checked_options,
    checked_seed,
    checked_words,
    numbers_of,
    refuse_fork,
)
from kinetix.gymnasium.convert import gymnasium_space, numpy_observation
from kinetix.gymnasium.draws import Draws
from kinetix.gymnasium.env import RENDER_FPS, drawn_levels, steps_per_second, with_pictures
from kinetix.programs import make_room
from kinetix.render.pixels import make_render_pixels


class KinetixVectorEnv(gymnasium.vector.VectorEnv[Any, Any, Any]):
    """Many environments at once; rewards, ends and what `info` tells as for `KinetixGymEnv`.

    In the autoreset mode `NEXT_STEP` (the default) the step after an end starts the next episode
    and ignores its action; in `SAME_STEP` the step that ends an episode returns the start of the
    next one, and `info["final_obs"]` and `info["final_info"]` the last of the old; in `DISABLED`
    `reset(options={"reset_mask": …})` does it, and a step of an episode that is over is warned of,
    once each.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 (Gymnasium's own is one, too)
        "render_modes": ["rgb_array"],
        "render_fps": RENDER_FPS,
        "autoreset_mode": AutoresetMode.NEXT_STEP,
    }
    MODES: ClassVar[tuple[AutoresetMode, ...]] = tuple(AutoresetMode)

    def __init__(
        self,
        num_envs: int = 1,
        level: Levels = FIRST_LEVEL,
        *,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        max_episode_steps: int | None = None,
        render_mode: str | None = None,
        render_size: int | None = None,
        **options: Any,
    ) -> None:
        """Make the environments.

        Args:
            num_envs: How many.
            level: As for `KinetixGymEnv`.
            autoreset_mode: `NextStep`, `SameStep` or `Disabled`.
            max_episode_steps: Truncates episodes that last longer, besides the levels' own limits.
            render_mode: `rgb_array`, or None.
            render_size: As for `KinetixGymEnv`.
            **options: As for `KinetixGymEnv`.

        Raises:
            KinetixError: A word is unknown; the message lists those that are known. Or the process
                was forked from one in which JAX runs.
        """
        refuse_fork()
        check_render_mode(render_mode, self.metadata["render_modes"])
        check_render_size(render_size)
        check_count("num_envs", num_envs)
        check_count("max_episode_steps", max_episode_steps, optional=True)
        try:
            self.mode = AutoresetMode(autoreset_mode)
        except ValueError:
            known = ", ".join(mode.value for mode in self.MODES)
            raise KinetixError(f"autoreset_mode={autoreset_mode!r}: expected {known}") from None
        self.autoreset_mode = self.mode  # where Gymnasium's own have it, and TorchRL looks
        self.num_envs = num_envs
        self.render_mode = render_mode
        self.render_size = render_size
        self._most_steps = max_episode_steps
        words, levels = checked_words(options), one_by_one(level)
        self.level_names = level_names(levels)
        self.kinetix_env = make_named_env(levels, auto_reset=False, **words)
        self.metadata = {
            **self.metadata,
            "autoreset_mode": self.mode,
            "render_fps": steps_per_second(self.kinetix_env),
        }
        self.single_action_space = gymnasium_space(self.kinetix_env.action_space())
        self.single_observation_space = gymnasium_space(self.kinetix_env.observation_space())
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self._state: Any = None
        self._ended = np.zeros(num_envs, bool)
        self._over = np.zeros(num_envs, bool)
        self._just_over = np.zeros(num_envs, bool)
        self._draws: Draws | None = None
        self._levels = np.zeros(num_envs, int)

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Any, dict[str, Any]]:
        """Start episodes, all or those of a mask.

        Args:
            seed: One for all (environment i gets seed + i), or one each. Each environment draws
                its levels as a `KinetixGymEnv` with its seed does.
            options: `{"reset_mask": mask}`: which environments restart.

        Raises:
            KinetixError: An option is unknown, the mask or the seeds are of another number, a seed
                is out of range, or the process was forked since the batch was made.
        """
        refuse_fork()
        make_room()
        mask = self._mask(checked_options(options, "reset_mask").get("reset_mask"))
        if self._state is None:
            mask = None  # All of them begin.
        draws = self._seeded(seed, mask)
        observation, state = _begin(self.kinetix_env, draws.keys())
        begun = np.ones(self.num_envs, bool) if mask is None else mask
        self._use(draws, begun)
        if mask is not None:
            chosen = jnp.asarray(mask)
            observation, state = _select(
                chosen, (observation, state), (self._observation, self._state)
            )
        left = np.zeros(self.num_envs, bool) if mask is None else ~mask
        self._ended, self._over = self._ended & left, self._over & left
        self._just_over = self._just_over & left
        self._observation, self._state = observation, state
        return numpy_observation(observation), self._level_info(begun)

    def step(self, actions: Any) -> tuple[Any, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Play one action in every environment."""
        refuse_fork()
        if self._state is None:
            raise KinetixError("step: call reset first")
        actions = numbers_of(actions)
        if actions.shape[:1] != (self.num_envs,):
            raise KinetixError(
                f"actions of shape {actions.shape}: expected {self.num_envs} of them, one per "
                "environment"
            )
        check_fits(actions, self.action_space)
        self._check_choices(actions)
        if self._just_over.any():
            rows = np.flatnonzero(self._just_over).tolist()
            gymnasium.logger.warn(
                f"step: the episodes of the environments {rows!s:.60} are over, and rewards "
                "repeat; call reset with a reset_mask"
            )
        assert self._draws is not None
        keys, before = self._draws.keys(), self._ended
        self._observation, self._state, told, final = _advance(
            (self.kinetix_env, self.mode, self._most_steps),
            (keys, self._state, actions, jnp.asarray(self._ended)),
        )
        # Copies: wrappers write into them.
        reward, terminated, truncated, solved, *others = map(np.array, told)
        told = {"solved": solved, "is_success": solved.copy()}
        told |= zip(("distance", "nan", "overflow"), others, strict=True)
        played = ~before
        info: dict[str, Any] = told | _masks(told, played) if played.any() else {}
        ended = terminated | truncated
        if self.mode is AutoresetMode.SAME_STEP:
            if ended.any():
                final = {"final_obs": numpy_observation(final), "final_info": told}
                info |= final | _masks(final, ended)
                info["final_info"] = told | _masks(told, ended) | self._level_info(ended)
            self._use(self._draws, ended)
        elif self.mode is AutoresetMode.NEXT_STEP:
            self._use(self._draws, before)
            self._ended = ended
        else:
            self._just_over = ended & ~self._over
            self._over = self._over | ended
        info |= self._level_info(np.ones(self.num_envs, bool))
        return numpy_observation(self._observation), reward, terminated, truncated, info

    def _use(self, draws: Draws, begun: np.ndarray) -> None:
        """Note the levels of the environments that have begun, and draw anew for them."""
        if len(self.level_names) > 1 and begun.any():
            drawn = np.asarray(_drawn(self.kinetix_env, draws.keys()))
            self._levels = np.where(begun, drawn, self._levels)
        draws.use(begun)

    def _level_info(self, about: np.ndarray) -> dict[str, np.ndarray]:
        """Say which levels some environments play, as places in `level_names`."""
        if not self.level_names:
            return {}
        told = {"level": self._levels.copy()}
        return told | _masks(told, about)

    def _check_choices(self, actions: np.ndarray) -> None:
        """Refuse what no action means; reals are clipped, as agents that draw them expect."""
        space: Any = self.single_action_space
        if isinstance(space, gymnasium.spaces.Box):
            return
        choices = space.nvec if isinstance(space, gymnasium.spaces.MultiDiscrete) else space.n
        if ((actions < 0) | (actions >= choices)).any():
            raise KinetixError(f"actions: expected whole numbers from 0 and below {choices}")

    def render(self) -> tuple[np.ndarray, ...] | None:
        """Return one picture per environment, (height, width, 3); None without a render mode."""
        if self.render_mode is None or self._state is None:
            return None
        drawn = with_pictures(self.kinetix_env, self.render_size)
        pixels = np.asarray(_draw(drawn, self._state).astype(jnp.uint8))
        # A copy, as of one environment.
        return tuple(np.array(pixels.transpose(0, 2, 1, 3)[:, ::-1], order="C"))

    def call(self, name: str, *args: Any, **words: Any) -> tuple[Any, ...]:
        """Ask every environment for an attribute, or call it; all are one here, and answer alike.

        Gymnasium's own batches have this, and libraries such as skrl draw by it.

        Args:
            name: Of an attribute or method.
            *args: For the method.
            **words: For the method.

        Returns:
            An answer per environment. Its spaces are those of one, as in Gymnasium's own batches.

        Raises:
            KinetixError: The method exists on single environments only: here all play together.
        """
        if name in ("reset", "step"):
            raise KinetixError(f"call: {name!r} plays the whole batch; call env.{name}(…)")
        if name in ("action_space", "observation_space"):
            name = f"single_{name}"
        found: Any = getattr(self, name)
        answer: Any = found(*args, **words) if callable(found) else found
        if name == "render" and answer is not None:
            return tuple(answer)
        return (answer,) * self.num_envs

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """Return an attribute of every environment. See `call`."""
        return self.call(name)

    def set_attr(self, name: str, values: Any) -> None:
        """Set an attribute of every environment; all are one here.

        Args:
            name: Of the attribute, such as `render_mode`.
            values: One for all; or a list or tuple of one per environment, all equal.

        Raises:
            KinetixError: The values differ, or are of another number.
        """
        if isinstance(values, list | tuple):
            first, *others = values or [None]
            equal = all(one is first or np.array_equal(one, first) for one in others)
            if len(values) != self.num_envs or not equal:
                raise KinetixError(
                    f"set_attr: {name!r} is one for all environments here: expected one value, or "
                    f"{self.num_envs} equal ones"
                )
            values = first
        setattr(self, name, values)

    def _mask(self, mask: Any) -> np.ndarray | None:
        if mask is None:
            return None
        if np.shape(mask) != (self.num_envs,):
            raise KinetixError(
                f"reset_mask of shape {np.shape(mask)}: expected {self.num_envs} truth values"
            )
        truths = np.asarray(mask)
        if truths.dtype.kind not in "biuf" or not ((truths == 0) | (truths == 1)).all():
            raise KinetixError(f"reset_mask {mask!r}: expected truth values, True or False each")
        return truths.astype(bool)

    def _seeded(self, seed: Any, mask: np.ndarray | None) -> Draws:
        """Return the random numbers; with seeds, those of a mask or all restart."""
        seeds = self._seeds(seed)
        if self._draws is None:
            self._draws = Draws.of(self.np_random, self.num_envs)
        self._draws.seed(seeds, np.ones(self.num_envs, bool) if mask is None else mask)
        return self._draws

    def _seeds(self, seed: Any) -> list[int | None]:
        """Return a seed for each environment, or None."""
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, Sequence | np.ndarray) and not isinstance(seed, str):
            if len(seed) != self.num_envs:
                raise KinetixError(f"{len(seed)} seeds: expected {self.num_envs}, or one for all")
            return [None if one is None else checked_seed(one) for one in seed]
        first = checked_seed(seed)
        super().reset(seed=first)
        return [(first + index) % (LAST_SEED + 1) for index in range(self.num_envs)]


# Batches of equal environments share what is compiled, so nothing here belongs to one of them.
@functools.partial(jax.jit, static_argnums=0)
def _begin(env: KinetixEnv, keys: Array) -> tuple[Any, Any]:
    return jax.vmap(env.reset)(keys)


@functools.partial(jax.jit, static_argnums=0)
def _drawn(env: KinetixEnv, keys: Array) -> Int[Array, " n"]:
    return jax.vmap(functools.partial(drawn_levels, env))(keys)


@functools.partial(jax.jit, static_argnums=0)
def _draw(env: KinetixEnv, states: Any) -> Array:
    return jax.vmap(make_render_pixels(env.env_params, env.static_env_params))(states)


@functools.partial(jax.jit, static_argnums=0)
def _advance(
    how: tuple[KinetixEnv, AutoresetMode, int | None],
    played: tuple[Array, Any, Array, Bool[Array, " n"]],
) -> tuple[Any, Any, tuple[Array, ...], Any]:
    """Step all; restart where the mode says so.

    Args:
        how: The environment, when an episode restarts, and after how many steps it ends.
        played: Keys, states and actions, and which environments had ended.
    """
    env, mode, most_steps = how
    keys, state, actions, ended = played
    final, stepped, reward, done, info = jax.vmap(env.step)(keys, state, actions)
    truncated = info["truncated"]
    if most_steps is not None:
        truncated = truncated | (~done & (stepped.timestep >= most_steps))
        done = done | truncated
    same = mode is AutoresetMode.SAME_STEP
    renew = done if same else ended
    if mode is AutoresetMode.DISABLED:
        observation, after = final, stepped
    else:
        observation, after = jax.lax.cond(
            jnp.any(renew),
            lambda: _select(renew, jax.vmap(env.reset)(keys), (final, stepped)),
            lambda: (final, stepped),
        )
    silent = jnp.zeros_like(renew) if same else ended
    told = (
        jnp.where(silent, 0.0, reward),
        done & ~truncated & ~silent,
        truncated & ~silent,
        info["GoalR"] & ~silent,
        jnp.where(silent, 0.0, info["distance"]),
        info["nan"] & ~silent,
        info["overflow"] & ~silent,
    )
    return observation, after, told, final if same else None


def _masks(info: Mapping[str, Any], mask: np.ndarray) -> dict[str, np.ndarray]:
    """Mark the environments that the entries of an info are about, as Gymnasium does."""
    return {f"_{name}": mask.copy() for name in info}


def _select(mask: Bool[Array, " n"], new: Any, old: Any) -> Any:
    """Return every leaf from the one tree where the mask is true, else from the other."""

    def pick(a: Array, b: Array) -> Array:
        return jnp.where(mask.reshape(mask.shape + (1,) * (jnp.ndim(a) - 1)), a, b)

    return jax.tree.map(pick, new, old)
