"""Observations for tests of networks: plain named tuples, no environment needed."""

import json
from pathlib import Path
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np


class Entities(NamedTuple):
    circles: Any
    polygons: Any
    joints: Any
    thrusters: Any
    circle_mask: Any
    polygon_mask: Any
    joint_mask: Any
    thruster_mask: Any
    attention_mask: Any
    joint_indexes: Any
    thruster_indexes: Any


class Picture(NamedTuple):
    image: Any
    global_info: Any


def with_axes(tree: Any, steps: int = 1, batch: int = 1) -> Any:
    """Put the axes time and batch in front."""
    return jax.tree.map(lambda x: jnp.broadcast_to(x, (steps, batch, *x.shape)), tree)


def entities(fields: dict[str, Any]) -> Entities:
    """An entity observation from lists of numbers."""
    made = {}
    for name in Entities._fields:
        values = np.asarray(fields[name])
        if name.endswith("mask"):
            made[name] = values.astype(bool)
        elif name.endswith("indexes"):
            made[name] = values.astype(np.int32)
        else:
            made[name] = values.astype(np.float32)
    return Entities(**made)


def published(peer: Path) -> dict[str, Any]:
    """The recorded initial observations: level -> form -> observation."""
    with (peer / "fixtures" / "initial_observations.json").open() as file:
        recorded = json.load(file)
    return {
        level: {
            "symbolic_entity": entities(forms["entity"]),
            "symbolic_flat": np.asarray(forms["symbolic_flat"], np.float32),
            "symbolic_flat_padded": np.asarray(forms["symbolic_flat_padded"], np.float32),
        }
        for level, forms in recorded.items()
    }


def random_entities(
    seed: int, *, polygons: int = 6, circles: int = 3, joints: int = 2, thrusters: int = 2
) -> Entities:
    """A made-up scene: the first bodies, joints and thrusters are active, the last are not."""
    random = np.random.default_rng(seed)
    bodies = polygons + circles
    polygon_mask = np.arange(polygons) < polygons - 1
    circle_mask = np.arange(circles) < circles - 1
    active = np.concatenate([polygon_mask, circle_mask])
    planes = random.random((4, bodies, bodies)) < 0.4
    pairs = random.choice(np.flatnonzero(active), (2 * joints, 2)).astype(np.int32)
    joint_mask = np.tile(np.arange(joints) < max(joints - 1, 1), 2)
    return Entities(
        circles=random.normal(size=(circles, 19)).astype(np.float32),
        polygons=random.normal(size=(polygons, 27)).astype(np.float32),
        joints=random.normal(size=(2 * joints, 22)).astype(np.float32),
        thrusters=random.normal(size=(thrusters, 8)).astype(np.float32),
        circle_mask=circle_mask,
        polygon_mask=polygon_mask,
        joint_mask=joint_mask,
        thruster_mask=np.arange(thrusters) < max(thrusters - 1, 1),
        attention_mask=planes & active[:, None] & active[None, :],
        joint_indexes=np.where(joint_mask[:, None], pairs, 0),
        thruster_indexes=random.choice(np.flatnonzero(active), thrusters).astype(np.int32),
    )
