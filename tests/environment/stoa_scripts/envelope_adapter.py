"""Run by a test with the real envelope: its own adapter for kinetix-env, unmodified."""

import jax
import jax.numpy as jnp
from envelope.adapters.kinetix_envelope import KinetixEnvelope

KEY = jax.random.PRNGKey(0)
assert "s/goalkeeper" in KinetixEnvelope.registered_names()
for name, options in (
    ("s/goalkeeper", {}),
    ("s", {}),
    ("random", {}),
):
    env = KinetixEnvelope.from_name(name, env_kwargs=options)
    assert env.default_max_steps
    state, info = jax.jit(env.init)(KEY)
    assert info.obs.shape == env.observation_space.shape
    action = env.action_space.sample(KEY)
    actions = jnp.stack([action] * 4)
    state, infos = jax.lax.scan(env.step, state, actions)
    assert infos.reward.shape == (4,)
    assert jnp.isfinite(infos.reward).all()

# envelope cuts episodes itself, so that its adapter switches our limit off.
env = KinetixEnvelope.from_name("s/goalkeeper")
assert jnp.isinf(env.env_params.max_timesteps)
