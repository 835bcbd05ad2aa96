"""Random programs: loops in loops that change arrays in place, swap and shift what they carry."""

import random

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jax import lax

from tests.engine.native.emulated import Emulated, needs_compiler

FUNCTIONS = 12
"""In a program, so that one compilation tests several."""

SHAPES = [(), (3,), (7,), (4, 5), (5, 4), (2, 3, 4), (40,)]


def bounded(x):
    """The same in ±1, and closer together, so that neither numbers nor rounding errors grow."""
    return 0.6 * jnp.sin(x)


def fitted(x, shape):
    """Some array of another shape, made of the entries of `x`."""
    count = int(np.prod(shape))
    flat = x.ravel()
    return flat[np.arange(count) % flat.size].reshape(shape)


def combined(draw, a, b):
    """One of the things that two arrays can be made into; of the shape of the first."""
    b = fitted(b, a.shape)
    kinds = [
        lambda: a + b,
        lambda: a * b - 0.5,
        lambda: jnp.where(jnp.arange(a.size).reshape(a.shape) % 3 > 0, a, -b),
        lambda: jnp.maximum(a, b),
        lambda: a - b.mean(),
        lambda: jnp.flip(a) + b,
        lambda: jnp.roll(a.ravel(), 1).reshape(a.shape),
        lambda: (a.ravel()[:, None] * b.ravel()[None, :3]).sum(1).reshape(a.shape) / 3,
        lambda: jnp.cumsum(a.ravel()).reshape(a.shape) / a.size,
        lambda: a / (1.5 + b.max()),
        lambda: fitted(jnp.concatenate([b.ravel(), a.ravel()]), a.shape),
        lambda: fitted(a.T + 0.25, a.shape),
    ]
    return bounded(draw.choice(kinds)())


def changed(draw, a, b, k):
    """An array of which a part, at a place that depends on `k`, is replaced."""
    flat, new = a.ravel(), b.ravel()
    place = (k * draw.randint(1, 3) + draw.randint(0, 3)) % flat.size
    kinds = [
        lambda: flat.at[place].set(new[0] * 0.5),
        lambda: flat.at[place].add(flat[place - 1]),
        lambda: lax.dynamic_update_slice(flat, flat[: draw.randint(1, 3)] * 0.5, (place,)),
        lambda: flat.at[place].set(flat.sum() * 0.1),
        lambda: lax.dynamic_update_slice(flat, new[: min(2, flat.size)], (place,)),
    ]
    return bounded(draw.choice(kinds)().reshape(a.shape))


def block(draw, values, k, depth):
    """Some operations, one after the other, on arrays whose shapes stay."""
    values = list(values)
    for _ in range(draw.randint(2, 5)):
        a, b = draw.randrange(len(values)), draw.randrange(len(values))
        kind = draw.random()
        if kind < 0.45 or depth == 0:
            values[a] = combined(draw, values[a], values[b])
        elif kind < 0.65:
            values[a] = changed(draw, values[a], values[b], k)
        elif kind < 0.8:
            values = looped(draw, values, k, depth - 1)
        elif kind < 0.9:
            seed, test = draw.random(), (k + draw.randint(0, 1)) % 2 == 0
            values = lax.cond(
                test,
                lambda v, seed=seed: block(random.Random(seed), v, k, depth - 1),
                list,
                values,
            )
        elif values[a].shape == values[b].shape:
            values[a], values[b] = values[b], values[a]
    return values


def looped(draw, values, k, depth):
    """A loop over a block, of one kind or another."""
    seed, turns, outer = draw.random(), draw.randint(1, 4), draw.choice(values)
    if draw.random() < 0.5:
        return lax.fori_loop(
            0, turns + k % 2, lambda j, v: block(random.Random(seed), v, j, depth), values
        )

    def turn(carried, row):
        new = block(random.Random(seed), [*carried, row], jnp.int32(2), depth)
        return new[:-1], (new[0], bounded(new[-1] + outer.sum()))

    rows = fitted(draw.choice(values), (turns, 5))
    carried, collected = lax.scan(turn, values, rows, reverse=draw.random() < 0.3)
    return [*carried[:-1], bounded(carried[-1] + collected[0].sum() + collected[1].max())]


@needs_compiler
@pytest.mark.parametrize("seed", range(3))
def test_random_programs_compute_what_xla_computes(tmp_path, seed):
    def everything(*arrays):
        results = []
        for number in range(FUNCTIONS):
            draw = random.Random(100 * seed + number)
            chosen = [arrays[draw.randrange(len(arrays))] for _ in range(draw.randint(2, 4))]
            results.extend(looped(draw, block(draw, chosen, jnp.int32(3), 2), jnp.int32(1), 2))
        return results

    source = np.random.default_rng(seed)
    arrays = [source.uniform(-1, 1, shape).astype(np.float32) for shape in SHAPES]
    wanted = jax.jit(everything)(*arrays)
    largest, backwards = (1024, 64, 8)[seed % 3], bool(seed % 2)
    emulated = Emulated(everything, arrays, tmp_path, largest=largest, backwards=backwards)
    for number, (a, b) in enumerate(zip(wanted, emulated(*arrays), strict=True)):
        np.testing.assert_allclose(b, a, rtol=1e-4, atol=1e-4, err_msg=f"result {number}")
