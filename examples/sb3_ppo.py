"""Train stable-baselines3's PPO on a level: its `VecEnv` over our compiled batch.

Needs `pip install "kinetix-editor[gymnasium]" stable-baselines3`.
"""

import argparse
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecEnv, VecMonitor

from kinetix.errors import one_sentence
from kinetix.gymnasium import KinetixVectorEnv


class KinetixVecEnv(VecEnv):
    """Many levels in one compiled step, in the form of stable-baselines3."""

    def __init__(self, num_envs: int, **options: Any) -> None:
        self.batch = KinetixVectorEnv(
            num_envs, autoreset_mode=AutoresetMode.SAME_STEP, render_mode="rgb_array", **options
        )
        self.render_mode = "rgb_array"
        super().__init__(
            num_envs, self.batch.single_observation_space, self.batch.single_action_space
        )

    def reset(self) -> Any:
        """Start all episodes."""
        seed = self._seeds[0]
        self._reset_seeds()
        return self.batch.reset(seed=seed)[0]

    def step_async(self, actions: np.ndarray) -> None:
        """Keep the actions."""
        self._actions = actions

    def step_wait(self) -> tuple[Any, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        """Play them."""
        observation, reward, terminated, truncated, told = self.batch.step(self._actions)
        done = terminated | truncated
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for index in np.flatnonzero(done):
            infos[index] = {
                "terminal_observation": told["final_obs"][index],
                "TimeLimit.truncated": bool(truncated[index]),
                "is_success": bool(told["solved"][index]),
            }
        return observation, reward, done, infos

    def get_images(self) -> list[np.ndarray | None]:
        """Return a picture of every environment."""
        return list(self.batch.render() or ())

    def close(self) -> None:
        """Do nothing: nothing is open."""

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute, the same for all environments."""
        return [getattr(self, attr_name)] * self.num_envs

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Set an attribute, the same for all environments."""
        setattr(self, attr_name, value)

    def env_method(self, method_name: str, *arguments: Any, **options: Any) -> list[Any]:
        """There is one batch, and no single environment to call."""
        raise NotImplementedError(method_name)

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> list[bool]:
        """Return that no environment is wrapped."""
        return [False] * self.num_envs


def main() -> None:
    """Run the example."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--level", default="s/goalkeeper")
    parser.add_argument("--steps", type=int, default=400_000)
    parser.add_argument("--envs", type=int, default=64)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    for word in ("steps", "envs"):
        if (count := getattr(arguments, word)) < 1:
            parser.error(f"--{word} {count}: expected at least 1")

    env = VecMonitor(KinetixVecEnv(arguments.envs, level=arguments.level))
    model = PPO("MlpPolicy", env, n_steps=128, batch_size=2048, ent_coef=0.01, seed=arguments.seed)
    model.learn(arguments.steps)

    test = gymnasium.make("Kinetix/level-v0", level=arguments.level)
    solved = []
    for seed in range(20):
        observation, _ = test.reset(seed=seed)
        ended = False
        while not ended:
            action, _ = model.predict(observation)
            observation, _, terminated, truncated, info = test.step(action)
            ended = terminated or truncated
        solved.append(info["solved"])
    print(f"{arguments.level}: {np.mean(solved):.2f} solved")


if __name__ == "__main__":
    with one_sentence():
        main()
