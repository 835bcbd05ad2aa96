"""Every operation that kernels know computes what XLA computes."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jax import lax

from kinetix.engine.native.from_jaxpr import program
from kinetix.engine.native.launch import CannotTranslate
from kinetix.engine.native.writer import written
from tests.engine.native.emulated import Emulated, needs_compiler

NUMBERS = np.linspace(-2.5, 2.5, 12, dtype=np.float32)
TABLE = np.arange(60, dtype=np.float32).reshape(5, 4, 3) / 7
PLACES = np.array([3, 0, 4, -1, 9, 2], np.int32)
COUNT = np.int32(5)
PAIR = np.array([2.0, -3.0], np.float32)


def swapped(x, n):
    """Two arrays that a loop carries change places."""
    return lax.fori_loop(0, n, lambda _, c: (c[1], c[0] + 1), (x, 2 * x))


def in_place(x, n):
    """An array of which a loop changes one entry after the other, and reads the one before."""
    return lax.fori_loop(1, n, lambda k, c: c.at[k].set(c[k - 1] * 2 + x[k]), x)


def shifted(x, n):
    """What is read of an array lies elsewhere than where it is written."""
    return lax.fori_loop(0, n, lambda _, c: jnp.roll(c, 1) + x, x)


def kept(x, n):
    """A loop starts from what its own body also reads."""
    return lax.fori_loop(0, n, lambda _, c: c * 0.5 + x.sum(), x)


OPERATIONS = {
    "arithmetic": lambda x, t, p, n, v: (x + 2 * x - x / 3, -x, x % 0.7, n % 3, n // 2, p % 4),
    "bits": lambda x, t, p, n, v: (p & 3, p | 1, p ^ n, ~p, (x > 0) & (x < 1), ~(x > 0)),
    "order": lambda x, t, p, n, v: (x > 0, x >= 0, x < 0, x <= 0, p == 3, p != 3),
    "nan": lambda x, t, p, n, v: (
        jnp.maximum(x / 0, jnp.nan),
        jnp.minimum(jnp.nan, x),
        jnp.isfinite(x / jnp.where(x > 0, 0, 1)),
        jnp.clip(x, -1, 1),
    ),
    "functions": lambda x, t, p, n, v: (
        jnp.sin(x),
        jnp.cos(x),
        jnp.tan(x),
        jnp.tanh(x),
        jnp.exp(x),
        jnp.log(jnp.abs(x)),
        jnp.sqrt(jnp.abs(x)),
        lax.rsqrt(jnp.abs(x)),
        jnp.arctan2(x, x[::-1]),
    ),
    "rounding": lambda x, t, p, n, v: (
        jnp.round(x),
        lax.round(x, lax.RoundingMethod.AWAY_FROM_ZERO),
        jnp.floor(x),
        jnp.ceil(x),
        jnp.sign(x),
        jnp.abs(p),
    ),
    "powers": lambda x, t, p, n, v: (x**2, x**3, x**-2, jnp.square(x)),
    "types": lambda x, t, p, n, v: (
        (p.astype(jnp.int8) * jnp.int8(60) + jnp.int8(9) > 0),
        (p.astype(jnp.uint8) - jnp.uint8(5)).astype(jnp.int32),
        x.astype(jnp.int32),
        (1e12 * x).astype(jnp.int32),
        x.astype(bool),
        p.astype(jnp.float32),
        p.astype(jnp.int8),
        p.astype(jnp.uint32),
        (x > 0).astype(jnp.float32),
    ),
    "choices": lambda x, t, p, n, v: (
        jnp.where(x > 0, x, 1),
        lax.select_n(jnp.clip(p, 0, 2), p, 2 * p, 3 * p),
        lax.cond(n > 3, lambda: x * 2, lambda: x),
        lax.switch(n - 4, [lambda: x, lambda: x + 1, lambda: x + 2]),
        lax.cond(n > 9, lambda: v, lambda: v * 2),
    ),
    "shapes": lambda x, t, p, n, v: (
        t.transpose(2, 0, 1),
        t.reshape(15, 4),
        t[::-1, :, ::2],
        t[1:4, 2],
        x[:, None] * x[None],
        jnp.broadcast_to(v, (6, 2)),
        jnp.broadcast_to(t[:, :1], (5, 4, 3)),
        v[:, None] + x[None, :3],
    ),
    "joined": lambda x, t, p, n, v: (
        jnp.concatenate([t, t[:2] + 1]),
        jnp.concatenate([x, v, x[:1]]),
        jnp.stack([x, -x], 1),
        jnp.split(t, [1, 3], axis=1)[1] * 2,
        jnp.pad(t, ((1, 0), (0, 2), (0, 0)), constant_values=7),
        lax.pad(x, jnp.float32(0), [(1, -3, 0)]),
    ),
    "places": lambda x, t, p, n, v: (
        t[jnp.clip(p, 0, 4)],
        t[:, jnp.clip(p, 0, 3), 1],
        t.at[p].get(mode="fill", fill_value=-1),
        t.at[p].get(mode="clip"),
        lax.dynamic_slice(t, (n, 1, n), (2, 2, 2)),
        lax.dynamic_index_in_dim(x, n - 9),
        jnp.take_along_axis(t, jnp.clip(p, 0, 3)[None, :, None], 1),
        jnp.arange(12)[p % 12],
        v[n % 2],
    ),
    "changes": lambda x, t, p, n, v: (
        x.at[n].set(9),
        lax.dynamic_update_slice(t, t[:2, :2] * 3, (n, 0, 0)),
        x.at[jnp.clip(p, 0, 11)].add(1),
        t.at[jnp.clip(p, 0, 4)].add(1),
        v.at[n % 2].set(7),
        x.at[p].set(5, mode="drop"),
    ),
    "sums": lambda x, t, p, n, v: (
        x.sum(),
        t.sum(0),
        t.sum((0, 2)),
        t.max(1),
        t.min(),
        (x > 2).any(),
        (t > 0).any(1),
        (x < 9).all(),
        v.sum(),
        (t * 2 + 1).sum(1),
        p.max(),
    ),
    "best": lambda x, t, p, n, v: (
        jnp.argmax(t, 1),
        jnp.argmin(-x),
        jnp.argmax(jnp.abs(x)),
        jnp.cumsum(x),
        jnp.cumsum(t, 1, dtype=jnp.float32),
        lax.cumsum(x, reverse=True),
    ),
    "products": lambda x, t, p, n, v: (
        t[0] @ t[1].T,
        x @ x,
        jnp.einsum("bij,bkj->bik", t, t),
        t @ t[0, 0],
    ),
    "swapped": lambda x, t, p, n, v: swapped(x, n),
    "in_place": lambda x, t, p, n, v: (in_place(x, n), in_place(x, n) + x),
    "shifted": lambda x, t, p, n, v: (shifted(x, n), kept(x, n)),
    "scans": lambda x, t, p, n, v: (
        *lax.scan(lambda c, r: (c + r.sum(), r * c), 1.0, t),
        *lax.scan(lambda c, r: (c * 0.5 + r, c.sum()), t[0], t, reverse=True),
        lax.while_loop(lambda c: c[0] < 4, lambda c: (c[0] + 1, c[1] * 2), (0, v))[1],
        lax.fori_loop(0, n, lambda k, c: lax.fori_loop(0, k, lambda _, d: d + k, c), x),
    ),
    "nothing": lambda x, t, p, n, v: (x[:0], jnp.zeros((0, 3)).sum(0), x),
}
"""By what they are about."""


@needs_compiler
@pytest.mark.parametrize("backwards", [False, True])
def test_kernels_compute_what_xla_computes(tmp_path, backwards):
    def everything(*arguments):
        return [jnp.asarray(x) for row in OPERATIONS.values() for x in row(*arguments)]

    arguments = NUMBERS, TABLE, PLACES, COUNT, PAIR
    names = [
        f"{name} {k}"
        for name, row in OPERATIONS.items()
        for k, _ in enumerate(jax.eval_shape(row, *arguments))
    ]
    expected = jax.jit(everything)(*arguments)
    emulated = Emulated(everything, arguments, tmp_path, backwards=backwards)
    for name, wanted, found in zip(names, expected, emulated(*arguments), strict=True):
        np.testing.assert_allclose(found, wanted, rtol=2e-6, atol=2e-6, err_msg=name)


@needs_compiler
@pytest.mark.parametrize("name", ["swapped", "in_place", "shifted", "scans", "changes", "joined"])
@pytest.mark.parametrize("backwards", [False, True])
def test_what_changes_in_place_does_so_alone_too(tmp_path, name, backwards):
    """Beside others, arrays have more readers, and fewer are changed in place."""
    arguments = NUMBERS, TABLE, PLACES, COUNT, PAIR
    row = OPERATIONS[name]
    emulated = Emulated(lambda *x: list(row(*x)), arguments, tmp_path, backwards=backwards)
    for wanted, found in zip(jax.jit(row)(*arguments), emulated(*arguments), strict=True):
        np.testing.assert_allclose(found, wanted, rtol=2e-6, atol=2e-6)


def test_an_operation_without_a_rule_is_named():
    one = program(jnp.sort, [jax.ShapeDtypeStruct((8,), jnp.float32)])
    with pytest.raises(CannotTranslate, match="no rule for sort"):
        written(one)
