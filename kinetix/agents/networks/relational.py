"""The relational network: an encoder per kind of entity, messages along joints, pooling.

Neither the order of entities nor the room for them means anything to it, so one set of parameters
plays every size. Places are relative to the green and the blue body too, and all motors decide by
the same layers, from the joint that each drives; so do all thrusters.

Source: sets are reduced as in Zaheer et al., "Deep Sets" (2017); joints and thrusters send messages
as in Battaglia et al., "Relational inductive biases, deep learning, and graph networks" (2018).
"""

import dataclasses
from typing import Any, Final

import jax
import jax.numpy as jnp
from flax import linen as nn
from jaxtyping import Array, Bool, Float

from kinetix.agents.networks.distributions import ActionHead
from kinetix.agents.networks.heads import (
    ACTIVATIONS,
    DenseAndActivation,
    HeadOptions,
    Output,
    dense,
)
from kinetix.agents.networks.recurrent import Carry, ScannedRNN

# Columns of the observation's rows (`kinetix.environment.observations.features.Layout`).
_PLACE: Final = slice(0, 2)
_WEIGHTS: Final = slice(4, 7)
"""Inverse mass, inverse inertia and density: they span powers of ten."""
_GREEN: Final = 9
_BLUE: Final = 10
_ROLES: Final = 8
"""First column of the one-hot of the roles; later columns move with the number of roles."""
_CIRCLE_WITHOUT_ROLES: Final = 15
_CORNERS: Final = 8
"""Coordinates of a polygon's corners."""
_ANCHOR: Final = slice(2, 4)
_MOTOR_KEY: Final = 12
_JOINT_WITHOUT_KEYS: Final = 18
_JET: Final = slice(1, 3)
_JET_KEY: Final = 3
_THRUSTER_WITHOUT_KEYS: Final = 6
_NOWHERE: Final = 1e9
"""Subtracted from inactive rows, so that a maximum never takes them."""


@dataclasses.dataclass(frozen=True)
class _Bodies:
    """Features of the bodies that no layer computes; polygons, then circles."""

    rows: Float[Array, "*n b c"]
    """The columns that both kinds have, and radius."""
    active: Float[Array, "*n b"]
    sin: Float[Array, "*n b"]
    cos: Float[Array, "*n b"]
    frames: Float[Array, "*n b 8"]
    """Place, sine and cosine, place seen from green and from blue."""

    def of_role(self, column: int, values: Float[Array, "*n b f"]) -> Float[Array, "*n f"]:
        """Return the sum of the rows of one role: that of the only body that has it."""
        return _of_role(self.rows, self.active, column, values)


_VALUE: Final = "value"


def critic_layers(critic_depth: int) -> tuple[str, ...]:
    """Return the names of the layers of which the value alone is computed.

    Args:
        critic_depth: Hidden layers of the value.
    """
    return (*(f"critic_{index}" for index in range(critic_depth)), _VALUE)


class RelationalNetwork(nn.Module):
    """Encoders, messages and pooling; then a head per motor and per thruster, and the critic."""

    width: int
    rounds: int
    shared: HeadOptions
    head: ActionHead

    @nn.compact
    def __call__(
        self, carry: Carry, inputs: tuple[Any, Bool[Array, "k n"]], *, train: bool = False
    ) -> Output:
        """See `heads.ActorCriticHead`. The observation is a `symbolic_entity` one."""
        del train
        observation, dones = inputs
        known = _bodies(observation)
        bodies = self._encoded(observation, known)
        ends = [_one_hot(observation.joint_indexes[..., side], bodies) for side in (0, 1)]
        base = _one_hot(observation.thruster_indexes, bodies)
        joint_rows = observation.joints
        joints = jnp.concatenate([joint_rows, _pivot(known, ends[0], joint_rows[..., _ANCHOR])], -1)
        jets = _jets(known, base, observation.thrusters)
        joint_mask = observation.joint_mask[..., None].astype(jnp.float32)
        jet_mask = observation.thruster_mask[..., None].astype(jnp.float32)
        for index in range(self.rounds):
            pair = [_picked(end, bodies) for end in ends]
            message = joint_mask * self._layer(f"joint_{index}", *pair, joints)
            push = jet_mask * self._layer(f"thruster_{index}", _picked(base, bodies), jets)
            told = _handed(ends[0], message) + _handed(base, push)
            bodies = bodies + self._layer(f"body_{index}", bodies, told)
        whole = _pooled(known, bodies)
        if self.shared.recurrent:
            memory, whole = ScannedRNN(name="ScannedRNN_0")(carry[0], (whole, dones))
            carry = (memory, carry[1])
        options = self.shared
        actor = self._stack("actor", whole, options.actor_depth, options.actor_width)
        critic = self._stack("critic", whole, options.critic_depth, options.critic_width)
        value = dense(1, gain=1.0, name=_VALUE)(critic)

        # Each joint is listed twice, seen from either body: the first half will do.
        count = joint_rows.shape[-2] // 2
        seen = jnp.concatenate([*(_picked(end, bodies) for end in ends), joints], axis=-1)
        motors = self._said("motor", seen[..., :count, :], actor, 3)
        key = _columns(joint_rows, _MOTOR_KEY, _JOINT_WITHOUT_KEYS) * joint_mask
        seen = jnp.concatenate([_picked(base, bodies), jets], axis=-1)
        pushes = self._said("jet", seen, actor, 2)
        jet_key = _columns(observation.thrusters, _JET_KEY, _THRUSTER_WITHOUT_KEYS) * jet_mask
        logits = self.head.of_controls(
            _handed(key[..., :count, :], motors), _handed(jet_key, pushes)
        )
        log_std = None
        if self.head.needs_log_std:
            log_std = self.param("log_std", nn.initializers.zeros, (self.head.dimension,))
        return carry, self.head(logits, log_std), jnp.squeeze(value, axis=-1)

    def _layer(self, name: str, *parts: Array) -> Array:
        joined = jnp.concatenate(parts, axis=-1)
        return ACTIVATIONS[self.shared.activation](dense(self.width, name=name)(joined))

    def _stack(self, name: str, x: Array, depth: int, width: int) -> Array:
        for index in range(depth):
            x = DenseAndActivation(width, self.shared.activation, name=f"{name}_{index}")(x)
        return x

    def _said(self, name: str, seen: Array, actor: Array, choices: int) -> Array:
        """Return the logits of all controls of one kind, from shared layers."""
        own = dense(self.width, name=f"{name}_seen")(seen)
        common = dense(self.width, name=f"{name}_whole")(actor)[..., None, :]
        hidden = ACTIVATIONS[self.shared.activation](own + common)
        return dense(choices, gain=0.01, name=name)(hidden)

    def _encoded(self, observation: Any, known: _Bodies) -> Float[Array, "*n b e"]:
        rows = known.rows
        even = [rows[..., : _WEIGHTS.start], jnp.log1p(jnp.maximum(rows[..., _WEIGHTS], 0.0))]
        common = jnp.concatenate([*even, rows[..., _WEIGHTS.stop :], known.frames[..., 4:]], -1)
        polygons, width = observation.polygons, rows.shape[-1]
        count = polygons.shape[-2]
        is_triangle = polygons[..., width + _CORNERS :][..., :1]
        corners = polygons[..., width : width + _CORNERS]
        # A triangle's fourth corner is a mark, no place.
        corners = jnp.concatenate([corners[..., :6], corners[..., 6:] * (1 - is_triangle)], axis=-1)
        turned = _turned(corners, known.sin[..., :count], known.cos[..., :count])
        shape = self._layer("polygon", common[..., :count, :], turned, polygons[..., width:])
        disc = self._layer("circle", common[..., count:, :], observation.circles[..., width:])
        return jnp.concatenate([shape, disc], axis=-2)


def _bodies(observation: Any) -> _Bodies:
    polygons, circles = observation.polygons, observation.circles
    width = circles.shape[-1] - 2  # radius included; left out are the constant 1 and gravity
    rows = jnp.concatenate([polygons[..., :width], circles[..., :width]], axis=-2)
    active = jnp.concatenate([observation.polygon_mask, observation.circle_mask], axis=-1)
    active = active.astype(rows.dtype)
    turn = _ROLES + circles.shape[-1] - _CIRCLE_WITHOUT_ROLES
    sin, cos, place = rows[..., turn], rows[..., turn + 1], rows[..., _PLACE]
    green, blue = (
        _of_role(rows, active, column, place)[..., None, :] for column in (_GREEN, _BLUE)
    )
    frames = [place, sin[..., None], cos[..., None], place - green, place - blue]
    return _Bodies(rows, active, sin, cos, jnp.concatenate(frames, axis=-1))


def _of_role(rows: Array, active: Array, column: int, values: Array) -> Array:
    return jnp.einsum("...b,...bf->...f", rows[..., column] * active, values)


def _pooled(known: _Bodies, bodies: Float[Array, "*n b e"]) -> Float[Array, "*n f"]:
    """Return the maximum and the mean over all bodies, then the green and the blue one."""
    chosen = known.active[..., None]
    count = jnp.maximum(jnp.sum(chosen, axis=-2), 1.0)
    parts = [
        jnp.max(bodies - _NOWHERE * (1 - chosen), axis=-2),
        jnp.sum(bodies * chosen, axis=-2) / count,
        known.of_role(_GREEN, bodies),
        known.of_role(_BLUE, bodies),
    ]
    return jnp.concatenate(parts, axis=-1)


def _jets(known: _Bodies, base: Array, thrusters: Array) -> Array:
    """Return the thrusters' rows, with their places and directions in the world."""
    rows = jnp.concatenate([thrusters, _pivot(known, base, thrusters[..., _JET])], axis=-1)
    frame = _picked(base, known.frames)
    at = _JET_KEY + thrusters.shape[-1] - _THRUSTER_WITHOUT_KEYS
    sin, cos = thrusters[..., at], thrusters[..., at + 1]
    body_sin, body_cos = frame[..., 2], frame[..., 3]
    direction = [body_sin * cos + body_cos * sin, body_cos * cos - body_sin * sin]
    return jnp.concatenate([rows, jnp.stack(direction, axis=-1)], axis=-1)


def _pivot(known: _Bodies, where: Array, anchor: Array) -> Array:
    """Return a point of a body in the world, from its body, from green and from blue."""
    frame = _picked(where, known.frames)
    turned = _turned(anchor, frame[..., 2], frame[..., 3])
    places = [frame[..., first : first + 2] + turned for first in (0, 4, 6)]
    return jnp.concatenate([places[0], turned, *places[1:]], axis=-1)


def _turned(points: Array, sin: Array, cos: Array) -> Array:
    """Return points (x, y, x, y, …) of a body's frame with the world's axes; all x, then all y."""
    x, y = points[..., 0::2], points[..., 1::2]
    sin, cos = sin[..., None], cos[..., None]
    return jnp.concatenate([cos * x - sin * y, sin * x + cos * y], axis=-1)


def _columns(rows: Array, first: int, others: int) -> Array:
    """Return the one-hot of the keys: as many columns as the row has besides the others."""
    return rows[..., first : first + rows.shape[-1] - others]


def _one_hot(index: Array, bodies: Float[Array, "*n b e"]) -> Float[Array, "*n m b"]:
    return jax.nn.one_hot(index, bodies.shape[-2])


# Rows find their bodies by sums over one-hot rows: neither gathers nor their gradients, which are
# scatters, nor products of so small matrices run well in batches.


def _picked(where: Float[Array, "*n m b"], rows: Float[Array, "*n b f"]) -> Float[Array, "*n m f"]:
    """Return the rows that one-hot rows point at."""
    return jnp.sum(where[..., None] * rows[..., None, :, :], axis=-2)


def _handed(where: Float[Array, "*n m b"], rows: Float[Array, "*n m f"]) -> Float[Array, "*n b f"]:
    """Sums over the rows that point at each place."""
    return jnp.sum(where[..., None] * rows[..., None, :], axis=-3)
