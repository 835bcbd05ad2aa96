"""Networks that look at pictures: axes x, y, channel; values 0 … 1."""

from typing import Any

import jax
import jax.numpy as jnp
from flax import linen as nn
from jaxtyping import Array, Bool, Float

from kinetix.agents.networks.distributions import ActionHead
from kinetix.agents.networks.heads import HEAD, ActorCriticHead, HeadOptions, Output
from kinetix.agents.networks.recurrent import Carry

_STAGES = (64, 128, 256, 512)
"""Channels of the four stages of the residual encoder."""


class ResNetBasicBlock(nn.Module):
    """Two 3 × 3 convolutions with group norms around a shortcut.

    Source: He et al., "Deep Residual Learning for Image Recognition" (2015), fig. 2, with group
    instead of batch normalisation, so that nothing depends on the rest of the batch.
    """

    channels: int
    stride: int

    @nn.compact
    def __call__(self, x: Float[Array, "n w h c"]) -> Float[Array, "n v g d"]:
        """Return the block's output."""

        def convolve(value: Array, size: int, stride: int, index: int) -> Array:
            value = nn.Conv(
                self.channels, (size, size), stride, use_bias=False, name=f"Conv_{index}"
            )(value)
            return nn.GroupNorm(min(32, self.channels), name=f"GroupNorm_{index}")(value)

        y = jax.nn.relu(convolve(x, 3, self.stride, 0))
        y = convolve(y, 3, 1, 1)
        if x.shape != y.shape:
            x = convolve(x, 1, self.stride, 2)
        return jax.nn.relu(x + y)


def _impala_fast(image: Float[Array, "n w h c"]) -> Float[Array, "n f"]:
    """Two strided convolutions, flattened. To be called while a module is being set up."""
    x = jax.nn.relu(nn.Conv(16, (8, 8), strides=4, name="Conv_0")(image))
    x = jax.nn.relu(nn.Conv(32, (4, 4), strides=2, name="Conv_1")(x))
    return x.reshape(x.shape[0], -1)


def _resnet_18(image: Float[Array, "n w h c"]) -> Float[Array, "n f"]:
    """Return the 18-layer residual encoder; the mean over the picture's area. As `_impala_fast`."""
    x = nn.Conv(64, (7, 7), strides=2, use_bias=False, name="Conv_0")(image)
    x = jax.nn.relu(nn.GroupNorm(32, name="GroupNorm_0")(x))
    x = nn.max_pool(x, (3, 3), strides=(2, 2), padding="SAME")
    for stage, channels in enumerate(_STAGES):
        for block in range(2):
            stride = 2 if stage > 0 and block == 0 else 1
            name = f"ResNetBasicBlock_{2 * stage + block}"
            x = ResNetBasicBlock(channels, stride, name=name)(x)
    return jnp.mean(x, axis=(-3, -2))


_ENCODERS = {"impala_fast": _impala_fast, "resnet_18": _resnet_18}


class PixelNetwork(nn.Module):
    """A convolutional encoder, gravity beside it, then the shared head."""

    mode: str
    shared: HeadOptions
    head: ActionHead

    @nn.compact
    def __call__(
        self, carry: Carry, inputs: tuple[Any, Bool[Array, "k n"]], *, train: bool = False
    ) -> Output:
        """See `heads.ActorCriticHead`; `train` changes nothing here."""
        del train
        observation, dones = inputs
        image = observation.image
        flat = image.reshape(-1, *image.shape[-3:])
        features = _ENCODERS[self.mode](flat).reshape(*image.shape[:-3], -1)
        embedding = jnp.concatenate([features, observation.global_info], axis=-1)
        shared = ActorCriticHead(self.shared, self.head, name=HEAD)
        return shared(carry, (embedding,), dones)
