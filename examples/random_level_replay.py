"""Draw a random level, play it with random actions, and save the film as a GIF."""

import argparse
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

from kinetix import (
    EnvParams,
    make_kinetix_env,
    make_render_pixels,
    make_reset_fn_sample_kinetix_level,
    save_film,
    static_env_params_from_size,
)
from kinetix.errors import one_sentence
from kinetix.files.folders import made_folder
from kinetix.render.film import FILM_SUFFIXES, ffmpeg


def main() -> None:
    """Run the example."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("random_level.gif"))
    parser.add_argument("--steps", type=int, default=128)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--physics", default="balanced")
    arguments = parser.parse_args()
    kind = arguments.out.suffix.lower()
    if kind not in FILM_SUFFIXES:
        parser.error(f"--out {arguments.out}: expected a name that ends in .gif or .mp4")
    if arguments.steps < 1:
        parser.error(f"--steps {arguments.steps}: expected at least 1")
    if kind == ".mp4":
        ffmpeg()  # what is missing is told before the work
    made_folder(arguments.out.parent)

    env_params = EnvParams()
    static_env_params = static_env_params_from_size("m", physics=arguments.physics)
    env = make_kinetix_env(
        action_type="multi_discrete",
        observation_type="symbolic_flat",
        reset_fn=make_reset_fn_sample_kinetix_level(env_params, static_env_params),
        env_params=env_params,
        static_env_params=static_env_params,
    )
    render = make_render_pixels(env_params, static_env_params)

    def step(state, key):
        action = env.action_space(env_params).sample(key)
        _, state, reward, done, _ = env.step(key, state, action, env_params)
        return state, (render(state).astype(jnp.uint8), reward, done)

    reset_key, play_key = jax.random.split(jax.random.PRNGKey(arguments.seed))
    _, state = env.reset(reset_key, env_params)
    keys = jax.random.split(play_key, arguments.steps)
    _, (pictures, rewards, dones) = jax.jit(lambda s, k: jax.lax.scan(step, s, k))(state, keys)

    # Pictures have the axes x, y, channel with y up; image files want rows from the top.
    frames = [picture.transpose(1, 0, 2)[::-1] for picture in np.asarray(pictures)]
    save_film(arguments.out, frames, per_second=30)
    print(f"{arguments.out}: return {rewards.sum():.3f}, {int(dones.sum())} episodes ended")


if __name__ == "__main__":
    with one_sentence():
        main()
