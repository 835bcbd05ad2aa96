"""Uniform numbers, drawn once per level in one piece and handed out under names."""

import math
from collections.abc import Callable

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int, Key, UInt

from kinetix.engine.batch import worlds_first
from kinetix.engine.promotion import usual_promotion
from kinetix.environment.checks import check_draw
from kinetix.environment.state import EnvState
from kinetix.pytree import pytree

PER_SHAPE = 14
"""Uniform numbers that one proposal for a shape uses."""
PER_JOINT = 8
"""Uniform numbers that the details of one joint use."""
PER_THRUSTER = 7
"""Uniform numbers that one thruster uses."""


@pytree
class ShapeDraws:
    """Uniform numbers in [0, 1) for one proposal of a new shape."""

    kind: Float[Array, "q n"]
    role: Float[Array, "q n"]
    size_x: Float[Array, "q n"]
    """Half width of a rectangle, or radius of a circle."""
    size_y: Float[Array, "q n"]
    long: Float[Array, "q n"]
    """True where one side is lengthened."""
    long_axis: Float[Array, "q n"]
    corners: Float[Array, "q n"]
    """Triangle or rectangle."""
    rotation: Float[Array, "q n"]
    further: Float[Array, "6 q n"]
    """Six more: a shape is either free or connected, so the same numbers serve both."""


@pytree
class JointDraws:
    """Uniform numbers for the details of one joint."""

    weld: Float[Array, " n"]
    binding: Float[Array, " n"]
    motor_on: Float[Array, " n"]
    speed: Float[Array, " n"]
    power: Float[Array, " n"]
    limited: Float[Array, " n"]
    limit_min: Float[Array, " n"]
    limit_max: Float[Array, " n"]


@pytree
class ThrusterDraws:
    """Uniform numbers for `t` thrusters."""

    body: Float[Array, "t n"]
    place_x: Float[Array, "t n"]
    place_y: Float[Array, "t n"]
    aligned: Float[Array, "t n"]
    angle: Float[Array, "t n"]
    power: Float[Array, "t n"]
    binding: Float[Array, "t n"]


def shape_draws(rows: Float[Array, "14 q n"]) -> ShapeDraws:
    """Name the numbers of one proposal."""
    return ShapeDraws(
        kind=rows[0],
        role=rows[1],
        size_x=rows[2],
        size_y=rows[3],
        long=rows[4],
        long_axis=rows[5],
        corners=rows[6],
        rotation=rows[7],
        further=rows[8:],
    )


def joint_draws(rows: Float[Array, "8 n"]) -> JointDraws:
    """Name the numbers of one joint."""
    return JointDraws(
        weld=rows[0],
        binding=rows[1],
        motor_on=rows[2],
        speed=rows[3],
        power=rows[4],
        limited=rows[5],
        limit_min=rows[6],
        limit_max=rows[7],
    )


def thruster_draws(rows: Float[Array, "7 t n"]) -> ThrusterDraws:
    """Name the numbers of some thrusters."""
    return ThrusterDraws(
        body=rows[0],
        place_x=rows[1],
        place_y=rows[2],
        aligned=rows[3],
        angle=rows[4],
        power=rows[5],
        binding=rows[6],
    )


def raw_keys(keys: Key[Array, " n"] | UInt[Array, "n 2"]) -> UInt[Array, "n 2"]:
    """Return keys of either kind as the numbers behind them."""
    if jnp.issubdtype(keys.dtype, jax.dtypes.prng_key):
        return jax.random.key_data(keys)
    return keys


def sampler_of(
    batched: Callable[[UInt[Array, "n 2"]], EnvState],
) -> Callable[[Key[Array, ""]], EnvState]:
    """Return the function from one key to what is drawn; under `vmap` `batched` runs once.

    Called from Python it is one program too: operation by operation a thousand would be compiled.

    Args:
        batched: Draws a level from each row of numbers.
    """
    single = worlds_first(batched)

    @jax.jit
    def program(key: Key[Array, ""]) -> EnvState:
        with usual_promotion():
            return single(raw_keys(key))

    def draw(key: Key[Array, ""]) -> EnvState:
        check_draw(key)
        return program(key)

    return draw


class Tape:
    """Uniform numbers of many worlds, handed out piece by piece.

    One call of the random generator per level keeps both the compilation and the run short, and
    makes a level a function of its own key alone, whatever batch it is drawn in.
    """

    def __init__(self, keys: UInt[Array, "n 2"], length: int) -> None:
        typed = jax.random.wrap_key_data(keys)  # JAX can be configured to refuse numbers as keys
        rows = jax.vmap(lambda key: jax.random.uniform(key, (length,), jnp.float32))(typed)
        self._rows = rows.T
        self._next = 0

    def take(self, *shape: int) -> Float[Array, "*r n"]:
        """Return the next numbers, in this shape and the worlds last."""
        count = math.prod(shape)
        start, self._next = self._next, self._next + count
        if self._next > self._rows.shape[0]:
            raise ValueError(f"the tape has {self._rows.shape[0]} numbers, asked for {self._next}")
        return self._rows[start : self._next].reshape(*shape, self._rows.shape[1])


def among(u: Float[Array, "*r n"], count: int) -> Int[Array, "*r n"]:
    """Uniform integer 0 … count − 1."""
    return jnp.minimum((u * count).astype(jnp.int32), count - 1)


def between(
    u: Float[Array, "*r n"],
    low: float | Float[Array, "*r n"],
    high: float | Float[Array, "*r n"],
) -> Float[Array, "*r n"]:
    """Return uniform real in [low, high)."""
    return low + u * (high - low)


def choose(u: Float[Array, "*q n"], weights: Float[Array, "b n"]) -> Int[Array, "*q n"]:
    """Return the row drawn with these weights; meaningless where all weights of a world are 0.

    Args:
        u: Uniform numbers; a leading axis `q` draws several times from the same weights.
        weights: At least 0, one column per world.
    """
    # Summing row by row keeps the running sum monotone, so that a row of weight 0 is never drawn.
    running = [weights[0]]
    for row in range(1, weights.shape[0]):
        running.append(running[-1] + weights[row])
    if u.ndim == 2:
        running = [level[None] for level in running]
    threshold = u * running[-1]
    index = jnp.zeros(u.shape, jnp.int32)
    for level in running[:-1]:
        index = index + (level <= threshold).astype(jnp.int32)
    return index
