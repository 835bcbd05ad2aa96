"""The collector of garbage is as it was once a program is lowered."""

import gc
import sys
import threading

import jax
import jax.numpy as jnp
import pytest

from kinetix.engine.batch import worlds_last
from kinetix.engine.gc_pause import uncollected


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


def test_it_is_on_again_after_many_threads() -> None:
    before, interval = gc.isenabled(), sys.getswitchinterval()
    gc.enable()
    sys.setswitchinterval(1e-6)

    def enter() -> None:
        for _ in range(300):
            with uncollected():
                pass

    try:
        for _ in range(100):
            threads = [threading.Thread(target=enter) for _ in range(4)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            assert gc.isenabled()
    finally:
        sys.setswitchinterval(interval)
        (gc.enable if before else gc.disable)()


def test_it_is_on_again_after_an_error() -> None:
    before = gc.isenabled()
    with pytest.raises(KeyError), uncollected():
        raise KeyError
    assert gc.isenabled() == before
