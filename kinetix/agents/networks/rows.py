"""Linear layers over rows: the last axis is multiplied, all others together count as one of rows.

XLA's gradient of a product with several axes of rows moves them about on a processor: flattened, a
transformer's gradient takes a third less time.
"""

import math
from typing import Any, Final

import jax
from flax import linen as nn
from flax.typing import Initializer
from jaxtyping import Array, Float

_WEIGHTS: Final = nn.initializers.lecun_normal()


def rows_dot(rows: Array, kernel: Array, dimensions: Any, **options: Any) -> Array:
    """`jax.lax.dot_general` for layers, with all axes of rows as one.

    Args:
        rows: Its last axes are multiplied.
        kernel: Its first axes are.
        dimensions: As layers pass them: ((axes of rows, axes of the kernel), ((), ())).
        **options: As for `jax.lax.dot_general`.
    """
    (of_rows, _), _ = dimensions
    count = len(of_rows)
    before, after = rows.shape[: rows.ndim - count], kernel.shape[count:]
    inner = math.prod(kernel.shape[:count])
    product = jax.lax.dot_general(
        rows.reshape(math.prod(before), inner),
        kernel.reshape(inner, math.prod(after)),
        (((1,), (0,)), ((), ())),
        **options,
    )
    return product.reshape(*before, *after)


def linear(
    features: int,
    *,
    kernel_init: Initializer = _WEIGHTS,
    use_bias: bool = True,
    name: str | None = None,
) -> nn.Dense:
    """Make a linear layer.

    Args:
        features: Number of outputs.
        kernel_init: Draws the weights.
        use_bias: Whether there is a bias, zero at first.
        name: Name in the parameter tree.
    """
    return nn.Dense(
        features, use_bias=use_bias, kernel_init=kernel_init, dot_general=rows_dot, name=name
    )


def flat(x: Float[Array, "*n e"]) -> Float[Array, "m e"]:
    """Return all axes of rows as one."""
    return x.reshape(math.prod(x.shape[:-1]), x.shape[-1])
