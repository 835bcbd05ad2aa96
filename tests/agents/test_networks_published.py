"""The networks give the numbers that were recorded for them elsewhere."""

import dataclasses
import json
import zlib
from collections.abc import Iterator
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from kinetix.agents.networks.build import build_network
from kinetix.agents.networks.config import NETWORK_PRESETS, NetworkConfig
from kinetix.agents.networks.distributions import MultiCategorical, action_head
from kinetix.agents.networks.recurrent import initial_carry
from tests.agents.observations import Picture, published, with_axes

pytestmark = pytest.mark.peer

_PAPER = NETWORK_PRESETS["tf-paper"]
_INVARIANT = NETWORK_PRESETS["perm-inv"]
CASES: dict[str, tuple[NetworkConfig, str]] = {
    "entity_tf_paper": (_PAPER, "symbolic_entity"),
    "entity_tf_paper_legacy_entity_id": (
        dataclasses.replace(_PAPER, legacy_entity_id=True),
        "symbolic_entity",
    ),
    "entity_tf_paper_full_attention": (
        dataclasses.replace(_PAPER, full_attention_mask=True),
        "symbolic_entity",
    ),
    "entity_tf_paper_aggregate_dummy": (
        dataclasses.replace(_PAPER, aggregate_mode="dummy"),
        "symbolic_entity",
    ),
    "entity_tf_s": (NETWORK_PRESETS["tf-s"], "symbolic_entity"),
    "entity_perm_inv_mlp": (_INVARIANT, "symbolic_entity"),
    "entity_perm_inv_mlp_separate": (
        dataclasses.replace(_INVARIANT, separate_actor_critic=True),
        "symbolic_entity",
    ),
    "flat_padded_perm_inv_mlp": (_INVARIANT, "symbolic_flat_padded"),
    "flat_mlp": (NETWORK_PRESETS["flat"], "symbolic_flat"),
    "flat_gru_T3_reset_at_t2": (
        dataclasses.replace(NETWORK_PRESETS["flat"], recurrent_model=True),
        "symbolic_flat",
    ),
    "pixels_impala_fast": (NETWORK_PRESETS["pixels"], "pixels"),
}


def _leaves(tree: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, tuple[int, ...]]]:
    for key, value in tree.items():
        name = f"{prefix}{key}"
        if isinstance(value, dict):
            yield from _leaves(value, f"{name}/")
        else:
            yield name, value.shape


def _made_up(shapes: dict[str, Any]) -> tuple[dict[str, Any], int]:
    """Weights that depend on nothing but a leaf's name and shape."""
    params: dict[str, Any] = {}
    count = 0
    for name, shape in _leaves(shapes):
        random = np.random.RandomState(zlib.crc32(name.encode()))
        values = (0.1 * random.standard_normal(shape)).astype(np.float32)
        node = params
        *parents, leaf = name.split("/")
        for parent in parents:
            node = node.setdefault(parent, {})
        node[leaf] = values + 1 if leaf == "scale" else values
        count += values.size
    return {"params": params}, count


def _picture() -> Picture:
    x, y, c = np.meshgrid(np.arange(125), np.arange(125), np.arange(3), indexing="ij")
    image = (((7 * x + 13 * y + 29 * c) % 256) / 255).astype(np.float32)
    return Picture(image=image, global_info=np.array([-0.981], np.float32))


@pytest.fixture(scope="module")
def recorded(peer):
    with (peer / "fixtures" / "synthetic_weight_outputs.json").open() as file:
        return json.load(file)


@pytest.mark.parametrize("case", CASES)
def test_made_up_weights(case, peer, recorded):
    config, form = CASES[case]
    expected = recorded["results"][case]
    level = published(peer)[recorded["level"]]
    observation = _picture() if form == "pixels" else level[form]
    steps = len(expected["value"])
    observation = with_axes(observation, steps)
    dones = jnp.arange(steps)[:, None] == 2
    network = build_network(config, action_head("multi_discrete"))
    shapes = jax.eval_shape(network.init, jax.random.key(0), initial_carry(1), (observation, dones))
    params, count = _made_up(shapes["params"])
    assert count == expected["n_params"]
    _, policy, value = jax.jit(network.apply)(params, initial_carry(1), (observation, dones))
    assert isinstance(policy, MultiCategorical)
    log_probs = jnp.concatenate(policy.log_probs(), axis=-1)
    np.testing.assert_allclose(
        log_probs.reshape(-1), np.reshape(expected["log_probs"], -1), atol=1e-5
    )
    np.testing.assert_allclose(value.reshape(-1), np.reshape(expected["value"], -1), atol=1e-5)
