"""Reasons for a network's choice: attention, gradients per entity, the value over places."""

import dataclasses
import functools
from typing import Any, Final, Literal, TypeAlias

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from kinetix.agents.networks.distributions import DiagonalNormal
from kinetix.agents.normalisation import normalise
from kinetix.agents.player import Policy
from kinetix.environment.env import KinetixEnv
from kinetix.environment.observations.pixels import PixelObservations
from kinetix.environment.state import EnvState
from kinetix.pytree import pytree

About: TypeAlias = Literal["value", "action"]
"""Target of the explanation: the value, or the log-probability of the likeliest action."""

MOVED: Final = 0.1
"""Displacement for which a gradient is reported [m]."""
TURNED: Final = 0.1
"""Turn for which a gradient is reported [rad]."""
FASTER: Final = 1.0
"""Change of velocity for which a gradient is reported [m/s and rad/s]."""


@pytree
class Saliency:
    """Importance of each entity; slots of the state's arrays, at least 0.

    Linear estimates: how far the number would go if a body were moved by 10 cm, turned by 0.1 rad
    and 1 m/s faster, if a motor or thruster were twice as strong, added up without signs.
    """

    bodies: Float[Array, " b"]
    joints: Float[Array, " j"]
    thrusters: Float[Array, " t"]


@pytree
class Situation:
    """State of an episode, for its player."""

    state: EnvState
    carry: Any
    """The player's memory before this moment's step, a batch of one."""
    begins: Bool[Array, ""]
    """True where this is the first step."""


def saliency(
    env: KinetixEnv, policy: Policy, params: Any, moment: Situation, about: About
) -> Saliency:
    """Return the gradient of a network's output, per entity.

    Of a network that sees pictures it is the gradient by the picture, summed over each body's
    disc; joints and thrusters have none of their own there.

    Args:
        env: The environment.
        policy: Its policy.
        params: Its parameters.
        moment: Where it stands.
        about: What is explained.
    """
    pictures = isinstance(env.observations, PixelObservations)
    return (_of_picture if pictures else _of_state)(env, policy, params, moment, about=about)


def _says(policy: Policy, params: Any, seen: Any, moment: Situation, about: "_Asked") -> Array:
    """Return the number that is explained."""
    observation = jax.tree.map(lambda x: x[None], seen)
    key = jax.random.key(0)[None]  # nothing is drawn
    action, _, said = policy.decide(
        params, moment.carry, observation, key, moment.begins[None], deterministic=True
    )
    if about.what == "value":
        return said["value"][0]
    made = said["policy"]
    one = made.replace(logits=made.logits[0])
    if isinstance(one, DiagonalNormal):
        # The density has no slope at its top: the shift of the means is reported instead.
        return jnp.sum(jnp.where(about.live, one.logits, 0.0))
    return one.restricted(about.live).log_prob(action[0])


@dataclasses.dataclass(frozen=True)
class _Asked:
    what: About
    live: Bool[Array, " u"]
    """Controls that the level has."""


def _asked(env: KinetixEnv, moment: Situation, about: About) -> _Asked:
    return _Asked(about, env.actions.live(moment.state.world, moment.state.labels))


@functools.partial(jax.jit, static_argnums=(0, 1), static_argnames="about")
def _of_state(
    env: KinetixEnv,
    policy: Policy,
    params: Any,
    moment: Situation,
    *,
    about: About,
) -> Saliency:
    state, asked = moment.state, _asked(env, moment, about)

    def number(parts: dict[str, Array]) -> Float[Array, ""]:
        seen = env.observations(_with(state, parts))
        return _says(policy, params, seen, moment, asked)

    joints, thrusters, physics = state.world.joints, state.world.thrusters, state.physics
    slope = jax.grad(number)(
        {
            "position": physics.position,
            "rotation": physics.rotation,
            "velocity": physics.velocity,
            "angular_velocity": physics.angular_velocity,
            "motor_speed": joints.motor_speed,
            "motor_power": joints.motor_power,
            "power": thrusters.power,
            "angle": thrusters.angle,
        }
    )
    bodies = (
        MOVED * jnp.linalg.norm(slope["position"], axis=-1)
        + TURNED * jnp.abs(slope["rotation"])
        + FASTER * jnp.linalg.norm(slope["velocity"], axis=-1)
        + FASTER * jnp.abs(slope["angular_velocity"])
    )
    motors = jnp.abs(slope["motor_speed"] * joints.motor_speed)
    motors += jnp.abs(slope["motor_power"] * joints.motor_power)
    pushes = jnp.abs(slope["power"] * thrusters.power) + TURNED * jnp.abs(slope["angle"])
    return Saliency(
        bodies=jnp.where(state.world.bodies.active, bodies, 0.0),
        joints=jnp.where(joints.active, motors, 0.0),
        thrusters=jnp.where(thrusters.active, pushes, 0.0),
    )


def _with(state: EnvState, parts: dict[str, Array]) -> EnvState:
    physics = {name: parts[name] for name in parts if hasattr(state.physics, name)}
    world = dataclasses.replace(
        state.world,
        joints=dataclasses.replace(
            state.world.joints,
            motor_speed=parts["motor_speed"],
            motor_power=parts["motor_power"],
        ),
        thrusters=dataclasses.replace(
            state.world.thrusters, power=parts["power"], angle=parts["angle"]
        ),
    )
    return dataclasses.replace(
        state, world=world, physics=dataclasses.replace(state.physics, **physics)
    )


@functools.partial(jax.jit, static_argnums=(0, 1), static_argnames="about")
def _of_picture(
    env: KinetixEnv,
    policy: Policy,
    params: Any,
    moment: Situation,
    *,
    about: About,
) -> Saliency:
    state, asked = moment.state, _asked(env, moment, about)
    seen = env.observations(state)

    def number(image: Array) -> Float[Array, ""]:
        return _says(policy, params, seen._replace(image=image), moment, asked)

    slope = jnp.sum(jnp.abs(jax.grad(number)(seen.image)), axis=-1)
    width, height = slope.shape
    static = env.static_env_params
    metre = env.env_params.pixels_per_unit / static.downscale
    x, y = (jnp.arange(width) + 0.5) / metre, (jnp.arange(height) + 0.5) / metre
    centre = state.physics.position
    apart = (x[:, None] - centre[:, 0, None, None]) ** 2
    apart = apart + (y[None, :] - centre[:, 1, None, None]) ** 2
    inside = apart <= _reach(state)[:, None, None] ** 2
    bodies = jnp.sum(jnp.where(inside, slope, 0.0), axis=(1, 2))
    return Saliency(
        bodies=jnp.where(state.world.bodies.active, bodies, 0.0),
        joints=jnp.zeros(state.world.joints.active.shape),
        thrusters=jnp.zeros(state.world.thrusters.active.shape),
    )


def _reach(state: EnvState) -> Float[Array, " b"]:
    """Return the radius of the disc around each body [m]."""
    bodies = state.world.bodies
    corners = jnp.linalg.norm(bodies.vertices, axis=-1)
    exists = jnp.arange(corners.shape[-1]) < bodies.vertex_count[:, None]
    polygons = jnp.max(jnp.where(exists, corners, 0.0), axis=-1)
    return jnp.concatenate([polygons, bodies.radius])


def attention(
    env: KinetixEnv, policy: Any, params: Any, moment: Situation
) -> Float[Array, " b"] | None:
    """Return the share of attention that each body gets; None for networks without attention.

    Attention is followed through all layers: each passes on half of itself and half of what its
    heads, averaged, attend to. What is told is what the network's embedding of the scene is made
    of; shares of the dummy token are left out, so they add up to 1 over the bodies at most.

    Args:
        env: The environment.
        policy: Its policy.
        params: Its parameters.
        moment: Where it stands.

    Source: Abnar & Zuidema, "Quantifying Attention Flow in Transformers" (2020), rollout.
    """
    network = getattr(policy, "network", None)
    if type(network).__name__ != "EntityTransformer":
        return None
    return _attention(env, network, params, moment)


@functools.partial(jax.jit, static_argnums=(0, 1))
def _attention(
    env: KinetixEnv,
    network: Any,
    params: Any,
    moment: Situation,
) -> Float[Array, " b"]:
    state = moment.state
    one = jax.tree.map(lambda x: x[None], env.get_obs(state))
    seen = normalise(params["normalisation"], one)
    inputs = jax.tree.map(lambda x: x[None], (seen, moment.begins[None]))
    variables = {"params": params["params"]}
    _, kept = network.apply(variables, moment.carry, inputs, mutable=["intermediates"])
    layers = kept["intermediates"]["Transformer_0"]
    dummy = int(network.aggregate_mode != "mean")
    bodies = state.world.bodies.active
    active = jnp.concatenate([jnp.ones(dummy, bool), bodies])
    flow = jnp.eye(len(active))
    for index in range(network.layers.depth):
        (weights,) = layers[f"tf_layers_{index}"]["attention1"]["attention_weights"]
        mean = jnp.mean(weights[0, 0], axis=0)
        mean = jnp.where(active[:, None], mean, 0.0)
        flow = (0.5 * jnp.eye(len(active)) + 0.5 * mean) @ flow
    if network.aggregate_mode == "dummy":
        told = flow[0]
    else:
        told = jnp.sum(jnp.where(active[:, None], flow, 0.0), axis=0) / jnp.sum(active)
    return jnp.where(bodies, told[dummy:], 0.0)


@functools.partial(jax.jit, static_argnums=(0, 1))
def values_over_places(
    env: KinetixEnv,
    policy: Policy,
    params: Any,
    moment: Situation,
    moved: Bool[Array, " b"],
    shifts: Float[Array, "k 2"],
) -> Float[Array, " k"]:
    """Return what a network expects if some bodies stood elsewhere.

    Args:
        env: The environment.
        policy: Its policy.
        params: Its parameters.
        moment: Where it stands.
        moved: The bodies, slots of the state: one and what is jointed to it.
        shifts: How far they are moved [m].
    """
    count, state = shifts.shape[0], moment.state

    def place(shift: Float[Array, "2"]) -> Any:
        position = state.physics.position + jnp.where(moved[:, None], shift, 0.0)
        physics = dataclasses.replace(state.physics, position=position)
        return env.get_obs(dataclasses.replace(state, physics=physics))

    seen = jax.vmap(place)(shifts)
    carries = jax.tree.map(lambda x: jnp.broadcast_to(x, (count, *x.shape[1:])), moment.carry)
    keys = jnp.broadcast_to(jax.random.key(0), (count,))  # nothing is drawn
    begin = jnp.broadcast_to(moment.begins, (count,))
    return policy.decide(params, carries, seen, keys, begin, deterministic=True)[2]["value"]
