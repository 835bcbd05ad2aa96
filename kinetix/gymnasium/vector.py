"""A batch of levels in one compiled step, for Gymnasium."""

from collections.abc import Sequence
from typing import Any, ClassVar

import gymnasium
import jax
import jax.numpy as jnp
import numpy as np
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from jaxtyping import Array, Bool

from kinetix.environment.named import FIRST_LEVEL, make_named_env
from kinetix.errors import KinetixError
from kinetix.gymnasium.convert import gymnasium_space, numpy_observation
from kinetix.gymnasium.env import RENDER_FPS, SEEDS
from kinetix.render.pixels import make_render_pixels


class KinetixVectorEnv(gymnasium.vector.VectorEnv[Any, Any, Any]):
    """Many environments at once; rewards and ends as for `KinetixGymEnv`.

    In the autoreset mode `NEXT_STEP` (the default) the step after an end starts the next episode
    and ignores its action; in `SAME_STEP` the step that ends an episode returns the start of the
    next one, and `info["final_obs"]` the last observation of the old; in `DISABLED`
    `reset(options={"reset_mask": …})` does it.
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
        level: str = FIRST_LEVEL,
        *,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        render_mode: str | None = None,
        **options: Any,
    ) -> None:
        """Make the environments.

        Args:
            num_envs: How many.
            level: As for `KinetixGymEnv`.
            autoreset_mode: `NextStep`, `SameStep` or `Disabled`.
            render_mode: `rgb_array`, or None.
            **options: As for `KinetixGymEnv`.

        Raises:
            KinetixError: A word is unknown; the sentence lists those that are known.
        """
        if not isinstance(num_envs, int | np.integer) or num_envs < 1:
            raise KinetixError(f"num_envs={num_envs!r}: expected a whole number from 1")
        try:
            self.mode = AutoresetMode(autoreset_mode)
        except ValueError:
            known = ", ".join(mode.value for mode in self.MODES)
            raise KinetixError(f"autoreset_mode={autoreset_mode!r}: expected {known}") from None
        self.metadata = {**self.metadata, "autoreset_mode": self.mode}
        self.num_envs = num_envs
        self.render_mode = render_mode
        self.kinetix_env = make_named_env(level, auto_reset=False, **options)
        self.single_action_space = gymnasium_space(self.kinetix_env.action_space())
        self.single_observation_space = gymnasium_space(self.kinetix_env.observation_space())
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self._state: Any = None
        self._ended = np.zeros(num_envs, bool)
        self._reset = jax.jit(jax.vmap(self.kinetix_env.reset))
        self._advance = jax.jit(self._step)
        params, static = self.kinetix_env.env_params, self.kinetix_env.static_env_params
        self._draw = jax.jit(jax.vmap(make_render_pixels(params, static)))

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Any, dict[str, Any]]:
        """Start episodes, all or those of a mask.

        Args:
            seed: One for all (environment i gets seed + i), or one each.
            options: `{"reset_mask": mask}`: which environments start anew.
        """
        mask = (options or {}).get("reset_mask")
        first = seed if isinstance(seed, int) else None
        super().reset(seed=first)
        observation, state = self._reset(self._keys(seed))
        if mask is not None and self._state is not None:
            mask = np.asarray(mask, bool)
            chosen = jnp.asarray(mask)
            observation, state = _select(
                chosen, (observation, state), (self._observation, self._state)
            )
            self._ended = self._ended & ~mask
        else:
            self._ended = np.zeros(self.num_envs, bool)
        self._observation, self._state = observation, state
        return numpy_observation(observation), {}

    def step(self, actions: Any) -> tuple[Any, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Play one action in every environment."""
        if self._state is None:
            raise KinetixError("step: call reset first")
        actions = np.asarray(actions)
        if actions.shape[:1] != (self.num_envs,):
            raise KinetixError(
                f"actions of shape {actions.shape}: expected {self.num_envs} of them, one per "
                "environment"
            )
        keys = self._keys(None)
        self._observation, self._state, told, final = self._advance(
            keys, self._state, actions, jnp.asarray(self._ended)
        )
        reward, terminated, truncated, solved, distance = map(np.asarray, told)
        info = {"solved": solved, "distance": distance}
        info |= {f"_{name}": np.ones(self.num_envs, bool) for name in info}
        ended = terminated | truncated
        if self.mode is AutoresetMode.SAME_STEP:
            if ended.any():
                info |= {"final_obs": numpy_observation(final), "_final_obs": ended}
        elif self.mode is AutoresetMode.NEXT_STEP:
            self._ended = ended
        return numpy_observation(self._observation), reward, terminated, truncated, info

    def render(self) -> tuple[np.ndarray, ...] | None:
        """Return one picture per environment, (height, width, 3); None without a render mode."""
        if self.render_mode is None or self._state is None:
            return None
        pixels = np.asarray(self._draw(self._state).astype(jnp.uint8))
        return tuple(pixels.transpose(0, 2, 1, 3)[:, ::-1])

    def _keys(self, seed: int | Sequence[int | None] | None) -> Array:
        if isinstance(seed, int):
            seeds = [seed + index for index in range(self.num_envs)]
        else:
            drawn = self.np_random.integers(SEEDS, size=self.num_envs).tolist()
            given = [None] * self.num_envs if seed is None else list(seed)
            if len(given) != self.num_envs:
                raise KinetixError(f"{len(given)} seeds: expected {self.num_envs}, or one for all")
            seeds = [own if one is None else one for own, one in zip(drawn, given, strict=True)]
        return jax.vmap(jax.random.key)(jnp.array(seeds, jnp.uint32))

    def _step(
        self, keys: Array, state: Any, actions: Array, ended: Bool[Array, " n"]
    ) -> tuple[Any, Any, tuple[Array, ...], Any]:
        """Step all; start anew where the mode says so."""
        step = jax.vmap(self.kinetix_env.step)
        final, played, reward, done, info = step(keys, state, actions)
        same = self.mode is AutoresetMode.SAME_STEP
        renew = done if same else ended
        if self.mode is AutoresetMode.DISABLED:
            observation, after = final, played
        else:
            observation, after = jax.lax.cond(
                jnp.any(renew),
                lambda: _select(renew, jax.vmap(self.kinetix_env.reset)(keys), (final, played)),
                lambda: (final, played),
            )
        silent = jnp.zeros_like(renew) if same else ended
        told = (
            jnp.where(silent, 0.0, reward),
            done & ~info["truncated"] & ~silent,
            info["truncated"] & ~silent,
            info["GoalR"] & ~silent,
            info["distance"],
        )
        return observation, after, told, final if same else None


def _select(mask: Bool[Array, " n"], new: Any, old: Any) -> Any:
    """Every leaf from the one tree where the mask is true, else from the other."""

    def pick(a: Array, b: Array) -> Array:
        return jnp.where(mask.reshape(mask.shape + (1,) * (jnp.ndim(a) - 1)), a, b)

    return jax.tree.map(pick, new, old)
