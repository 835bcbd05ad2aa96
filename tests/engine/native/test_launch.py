"""Programs for a GPU call the kernel, and what cannot be one is told and left to XLA."""

import warnings

import jax
import jax.numpy as jnp
import pytest

from kinetix.engine.batch import worlds_last
from kinetix.engine.native import launch
from kinetix.engine.native.kernel import FEW_WORLDS, GOOD_NEAR, kernel_text
from kinetix.errors import KinetixError


@pytest.fixture
def gpu(monkeypatch):
    """A GPU as far as lowering needs one; what was compiled for it."""
    seen = []

    def compiled(source, target):
        seen.append((source, target))
        return "// assembly"

    monkeypatch.setattr(launch, "architecture", lambda: "sm_90")
    monkeypatch.setattr(launch, "compiled", compiled)
    monkeypatch.delenv(launch.SWITCH, raising=False)
    launch._kernel.cache_clear()
    yield seen
    launch._kernel.cache_clear()


def lowered(function, *shapes):
    arguments = [jax.ShapeDtypeStruct(shape, jnp.float32) for shape in shapes]
    traced = jax.jit(jax.vmap(function)).trace(*arguments)
    return traced.lower(lowering_platforms=("cuda",)).as_text()


def doubled():
    return worlds_last(lambda x: 2 * x)


def test_a_batch_is_one_call(gpu):
    text = lowered(doubled(), (100, 3, 2))
    assert text.count("@__gpu$xla.gpu.ptx") == 1
    assert "multiply" not in text
    ((source, target),) = gpu
    assert target == "sm_90"
    assert 'extern "C" __global__' in source


def test_what_belongs_to_a_world_lies_together(gpu):
    text = lowered(doubled(), (100, 3, 2))
    # Worlds are the slowest axis there, as callers have them: nothing is moved.
    assert "dense<[1, 0, 2]> : tensor<3xindex>" in text


def test_batches_of_any_number_share_a_kernel(gpu):
    function = doubled()
    lowered(function, (100, 3, 2))
    lowered(function, (200, 3, 2))
    assert len(gpu) == 1
    lowered(function, (FEW_WORLDS + 1, 3, 2))
    assert len(gpu) == 2
    assert "LANE_COUNT 32" in gpu[0][0]
    assert "LANE_COUNT 8" in gpu[1][0]


def test_large_worlds_keep_all_lanes():
    shape = jax.ShapeDtypeStruct((GOOD_NEAR // 8, 2), jnp.float32)
    text = kernel_text(lambda x: [x[::-1] * x], [shape], many=True)
    assert text.lanes == 8
    assert text.far > 0


def test_what_is_no_kernel_is_told_and_left_to_xla(gpu):
    ordered = worlds_last(lambda x: jnp.sort(x, axis=0))
    with pytest.warns(UserWarning, match="no rule for sort.*KINETIX_GPU_KERNEL=0"):
        text = lowered(ordered, (100, 3))
    assert "gpu.ptx" not in text
    assert "stablehlo.sort" in text


def test_a_missing_compiler_is_told(gpu, monkeypatch):
    def refuses(source, target):
        raise launch.CannotCompile("pip install it")

    monkeypatch.setattr(launch, "compiled", refuses)
    with pytest.warns(UserWarning, match="pip install it"):
        assert "multiply" in lowered(doubled(), (100, 3, 2))


def test_kernels_can_be_switched_off(gpu, monkeypatch):
    monkeypatch.setenv(launch.SWITCH, "0")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert "gpu.ptx" not in lowered(doubled(), (100, 3, 2))
    assert not gpu


def test_strict_promotion_of_the_caller_does_not_matter(gpu):
    counted = worlds_last(lambda x: x * jnp.arange(3)[:, None], like=lambda x: x)
    with jax.numpy_dtype_promotion("strict"):
        assert "gpu.ptx" in lowered(counted, (9, 3))


def test_no_worlds_are_no_call(gpu):
    assert "gpu.ptx" not in lowered(doubled(), (0, 3, 2))


def test_what_all_worlds_share_is_read_by_each(gpu):
    def scaled(x, y):
        return worlds_last(lambda x, y: x * y)(x, y)

    arguments = [jax.ShapeDtypeStruct(shape, jnp.float32) for shape in ((50, 6), (6,))]
    traced = jax.jit(jax.vmap(scaled, in_axes=(0, None))).trace(*arguments)
    traced.lower(lowering_platforms=("cuda",))
    assert "in0 = a0 + world * 6" in gpu[0][0]
    assert "in1 = a1;" in gpu[0][0]


def test_kernels_have_no_derivative(gpu):
    with pytest.raises(KinetixError, match="no derivative"):
        jax.grad(lambda x: doubled()(x).sum())(jnp.ones(3))
