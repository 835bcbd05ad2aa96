"""Linear layers over rows are those of flax."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from flax import linen as nn

from kinetix.agents.networks.rows import linear, rows_dot


@pytest.mark.parametrize("shape", [(5,), (3, 5), (2, 3, 4, 5), (2, 0, 5)])
@pytest.mark.parametrize("bias", [True, False])
def test_a_layer_and_its_gradient_are_those_of_flax(shape, bias):
    x = jax.random.normal(jax.random.key(1), shape)
    theirs, ours = nn.Dense(4, use_bias=bias), linear(4, use_bias=bias)
    params = theirs.init(jax.random.key(0), x)
    jax.tree.map(np.testing.assert_array_equal, params, ours.init(jax.random.key(0), x))

    def loss(layer, params, x):
        return jnp.sum(jnp.sin(layer.apply(params, x)))

    for layer in (theirs, ours):
        assert layer.apply(params, x).shape == (*shape[:-1], 4)
    found, wanted = (jax.grad(loss, (1, 2))(each, params, x) for each in (ours, theirs))
    jax.tree.map(lambda a, b: np.testing.assert_allclose(a, b, rtol=1e-5, atol=1e-6), found, wanted)


def test_several_axes_are_multiplied_and_made():
    rows, kernel = jnp.arange(24.0).reshape(2, 3, 2, 2), jnp.arange(24.0).reshape(2, 2, 3, 2)
    found = rows_dot(rows, kernel, (((2, 3), (0, 1)), ((), ())))
    np.testing.assert_allclose(found, jnp.tensordot(rows, kernel, 2))
