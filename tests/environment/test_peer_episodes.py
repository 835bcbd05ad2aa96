"""Whole episodes against kinetix-env's recordings, under the preset `jax2d`."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.environment.env import make_kinetix_env
from kinetix.environment.params import EnvParams
from tests.environment.conftest import Recording, by_size, stacked
from tests.optimised import optimised

SAMPLED_STEPS = (1, 2, 5, 10)
SCRIPTS = ("noop", "random")


@dataclasses.dataclass(frozen=True, kw_only=True)
class Played:
    """One recorded script, played by us."""

    recording: Recording
    script: str
    reward: np.ndarray
    done: np.ndarray
    goal: np.ndarray
    distance: np.ndarray
    flat: np.ndarray
    """Flat observations after the first ten steps."""

    @property
    def theirs(self) -> dict[str, np.ndarray]:
        """The recorded arrays of the same script, without its prefix."""
        prefix = f"{self.script}_"
        arrays = self.recording.arrays.items()
        return {key[len(prefix) :]: value for key, value in arrays if key.startswith(prefix)}


@pytest.fixture(scope="module")
def played(recordings: list[Recording]) -> list[Played]:
    """Both scripts of every level, a batch a size."""
    found = []
    for static, group in by_size(recordings).items():
        env = make_kinetix_env(
            "multi_discrete", "symbolic_flat", None, EnvParams(), static, auto_reset=False
        )
        scripts = [recording.arrays["env_actions"] for recording in group]
        actions = jnp.stack([jnp.zeros_like(script) for script in scripts] + scripts, axis=1)
        start = jax.tree.map(lambda x: jnp.concatenate([x, x]), stacked(group))

        @jax.jit
        def rollout(state, actions, env=env):
            def step(carry, action):
                state, ended = carry
                keys = jax.random.split(jax.random.key(0), ended.shape[0])
                obs, state, reward, done, info = jax.vmap(env.step)(keys, state, action)
                out = (
                    jnp.where(ended, 0.0, reward),
                    done | ended,
                    info["GoalR"] & ~ended,
                    info["distance"],
                    obs,
                )
                return (state, done | ended), out

            ended = jnp.zeros(actions.shape[1], bool)
            return jax.lax.scan(step, (state, ended), actions)[1]

        with optimised():
            whole = rollout(start, actions)
        reward, done, goal, distance, flat = (np.asarray(x) for x in whole)
        for index in range(2 * len(group)):
            found.append(
                Played(
                    recording=group[index % len(group)],
                    script=SCRIPTS[index // len(group)],
                    reward=reward[:, index],
                    done=done[:, index],
                    goal=goal[:, index],
                    distance=distance[:, index],
                    flat=flat[:10, index],
                )
            )
    return found


def outcome(done: np.ndarray, goal: np.ndarray, reward: np.ndarray) -> tuple[str, int]:
    """Return how an episode ended, and in which step (counted from 1)."""
    last = int(np.argmax(done))
    if goal[last]:
        return "won", last + 1
    return ("lost" if reward[last] < -0.5 else "timeout"), last + 1


@pytest.mark.peer
@pytest.mark.slow
def test_flat_observations_after_some_steps(played: list[Played]) -> None:
    for index, step in enumerate(SAMPLED_STEPS[:3]):
        worst = [np.abs(run.flat[step - 1] - run.theirs["flat"][index]).max() for run in played]
        close = np.mean(np.array(worst) <= 1e-3)
        assert close >= 0.9, (step, close)


@pytest.mark.peer
@pytest.mark.slow
def test_outcomes_and_their_steps(played: list[Played]) -> None:
    wrong = []
    for run in played:
        ours = outcome(run.done, run.goal, run.reward)
        theirs = outcome(run.theirs["done"], run.theirs["goal"], run.theirs["reward"])
        if ours[0] != theirs[0] or abs(ours[1] - theirs[1]) > 2:
            wrong.append((run.recording.name, run.script, ours, theirs))
    assert len(wrong) <= 0.1 * len(played), wrong


@pytest.mark.peer
@pytest.mark.slow
def test_dense_reward_follows_from_the_distance(played: list[Played]) -> None:
    """In kinetix-env's recordings and in our runs alike; sparse rewards aside."""
    for run in played:
        for reward, distance, done in (
            (run.reward, run.distance, run.done),
            (run.theirs["reward"], run.theirs["distance"], run.theirs["done"]),
        ):
            last = int(np.argmax(done))
            assert reward[0] == 0.0 or last == 0
            dense = -0.1 * np.diff(distance[: last + 1])
            sparse = np.round(reward[1 : last + 1] - dense)
            np.testing.assert_allclose(reward[1 : last + 1] - sparse, dense, atol=2e-6)
            assert not sparse[:-1].any()
