"""The type of mutations, and random choices of what they act on."""

import dataclasses
from collections.abc import Callable
from typing import Final

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from kinetix.engine.spec import Capacity
from kinetix.engine.types import Joints
from kinetix.environment.generators.draft import Draft, hit
from kinetix.environment.generators.draws import PER_JOINT, PER_SHAPE, choose
from kinetix.environment.generators.figures import movable_rows, pick
from kinetix.environment.generators.params import UEDParams

NUMBERS: Final = PER_SHAPE + PER_JOINT
"""Uniform numbers that any one mutation uses at most."""

Numbers = Float[Array, "22 n"]
Marks = Bool[Array, " n"]
Mutation = Callable[[Draft, Numbers, Marks, UEDParams, Capacity], Draft]


def some(candidates: Bool[Array, "b n"], u: Float[Array, " n"]) -> Int[Array, " n"]:
    """Return the row of a random candidate, all equally likely; any row without candidates."""
    return choose(u, candidates.astype(jnp.float32))


def any_row(candidates: Bool[Array, "b n"]) -> Marks:
    """Return in which worlds there is a candidate."""
    return jnp.any(candidates, axis=0)


def one_body(
    draft: Draft, u: Float[Array, " n"], marked: Marks
) -> tuple[Int[Array, " n"], Bool[Array, "b n"]]:
    """Return a uniform active body besides the arena: its row, and the same as marks."""
    candidates = movable_rows(draft.figures)
    row = some(candidates, u)
    return row, hit(draft.figures.active, row, marked & any_row(candidates))


def with_figures(draft: Draft, **changes: Array) -> Draft:
    """Return the draft with changes of its shapes."""
    return dataclasses.replace(draft, figures=dataclasses.replace(draft.figures, **changes))


def ends(joints: Joints, body: Bool[Array, "b n"]) -> tuple[Array, Array]:
    """Of active joints: whether the marked body is their body a, and their body b."""
    return (
        joints.active & pick(body, joints.body_a),
        joints.active & pick(body, joints.body_b),
    )
