"""Draw what an agent saw: from a symbolic observation back to a picture."""

import argparse
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
from PIL import Image

from kinetix import (
    EnvParams,
    make_kinetix_env,
    make_reset_fn_sample_kinetix_level,
    static_env_params_from_size,
)
from kinetix.errors import one_sentence
from kinetix.files.folders import made_folder
from kinetix.render import make_inverse_render_symbolic


def main() -> None:
    """Run the example."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("observed.png"))
    parser.add_argument("--seed", type=int, default=3)
    arguments = parser.parse_args()
    if Image.registered_extensions().get(arguments.out.suffix.lower()) not in Image.SAVE:
        parser.error(f"--out {arguments.out}: expected a name that ends as a picture's, as in .png")
    made_folder(arguments.out.parent)

    env_params = EnvParams()
    static_env_params = static_env_params_from_size("m")
    env = make_kinetix_env(
        action_type="multi_discrete",
        observation_type="symbolic_entity",
        reset_fn=make_reset_fn_sample_kinetix_level(env_params, static_env_params),
        env_params=env_params,
        static_env_params=static_env_params,
    )
    observation, _ = env.reset(jax.random.PRNGKey(arguments.seed), env_params)
    draw = jax.jit(make_inverse_render_symbolic(env_params, static_env_params))
    picture = np.asarray(draw(observation).astype(jnp.uint8))
    Image.fromarray(picture.transpose(1, 0, 2)[::-1]).save(arguments.out)
    print(arguments.out)


if __name__ == "__main__":
    with one_sentence():
        main()
