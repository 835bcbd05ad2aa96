"""The collector of garbage is as it was once a program is lowered."""

import gc

import jax
import jax.numpy as jnp
import pytest

from kinetix.engine.batch import worlds_last


@pytest.mark.parametrize("wanted", [True, False])
def test_the_collector_rests_while_a_kernel_is_lowered(wanted: bool) -> None:
    found = []

    def kernel(x: jax.Array) -> jax.Array:
        found.append(gc.isenabled())
        return x + 1.0

    before = gc.isenabled()
    (gc.enable if wanted else gc.disable)()
    try:
        jax.jit(worlds_last(kernel, like=lambda x: x)).lower(jnp.zeros(3))
        assert gc.isenabled() == wanted
    finally:
        (gc.enable if before else gc.disable)()
    assert found
    assert not any(found)
